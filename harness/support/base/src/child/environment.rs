//! Environment of programs that aren't Octant's own: without the variables that hold secrets.
//!
//! The rule goes by names, because a secret's value can't be recognized. It removes more than it has to: a program that
//! needs such a variable gets it from a file, or from a script of its user that starts it.

use std::ffi::OsStr;

/// Beginnings of names that belong to one holder of secrets: clouds, and the signing key of Octant.
const BEGINNINGS: [&str; 6] = ["AWS_", "AZURE_", "CLOUDSDK_", "GCP_", "GOOGLE_", "OCTANT_SIGNING_"];
/// Ends of a word that names a secret; a word is what stands between underscores.
const ENDS: [&str; 7] =
    ["CREDENTIAL", "KEY", "PASSPHRASE", "PASSWD", "PASSWORD", "SECRET", "TOKEN"];
/// Whole words that name a secret.
const WORDS: [&str; 3] = ["AUTH", "PASS", "PAT"];

/// Returns whether a variable of the environment is taken for a secret.
///
/// It is one if its name, in capitals, begins with one of a few beginnings, has a word that names a secret, or ends with
/// `_PWD`; and if its value is the URL of a user with a password.
#[must_use]
pub fn is_secret(name: &OsStr, value: &OsStr) -> bool {
    let name = name.to_string_lossy().to_uppercase();
    let word = |word: &str| {
        let one = word.strip_suffix('S').filter(|one| ENDS.iter().any(|end| one.ends_with(end)));
        WORDS.contains(&word) || ENDS.iter().any(|end| one.unwrap_or(word).ends_with(end))
    };
    BEGINNINGS.iter().any(|beginning| name.starts_with(beginning))
        || name.split('_').any(word)
        || name.ends_with("_PWD")
        || has_password(&value.to_string_lossy())
}

/// Returns the names of the rule, with the beginnings first.
#[cfg(test)]
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    BEGINNINGS.into_iter().chain(ENDS).chain(WORDS)
}

/// Returns whether a text has `://USER:PASSWORD@`.
fn has_password(text: &str) -> bool {
    text.split("://").skip(1).any(|rest| {
        let authority = rest.split(['/', '?', '#', ' ']).next().unwrap_or_default();
        authority.rsplit_once('@').is_some_and(|(user, _)| user.contains(':'))
    })
}
