//! Child processes that don't inherit secrets, and time limits for them.
//!
//! Octant's own processes don't get the signing key, and need the rest: an access to a storage goes by its environment.
//! Programs that aren't Octant's own get [no secret at all](is_secret).

mod asked;
mod limited;
mod lines;
mod pipe;

pub use asked::{AskedChild, AskedReply, SEPARATOR};
pub use limited::{ChildEnded, ChildOutcome, finish};
pub use lines::{ForeignLines, OutputLimit, PassedOn};
pub use pipe::InputPipe;

use std::ffi::OsStr;
use std::process::Command;

/// Environment variable with the path of the secret key's file.
pub const KEY: &str = "OCTANT_SIGNING_KEY";
/// Environment variable with the key's password, if it has one.
pub const PASSWORD: &str = "OCTANT_SIGNING_PASSWORD";

/// Makes the command of one of Octant's own processes: without the path and password of the signing key in its
/// environment.
pub fn command(program: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(program);
    command.env_remove(KEY).env_remove(PASSWORD);
    command
}

/// Makes the command of a program that isn't Octant's own, or that runs foreign code: without any variable that
/// [is taken for a secret](is_secret).
pub fn foreign(program: impl AsRef<OsStr>) -> Command {
    let mut command = command(program);
    for (name, _) in std::env::vars_os().filter(|(name, value)| is_secret(name, value)) {
        command.env_remove(name);
    }
    command
}

// The rule goes by names, because a secret's value can't be recognized. It removes more than it has to: a program that
// needs such a variable gets it from a file, or from a script of its user that starts it.

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
fn names() -> impl Iterator<Item = &'static str> {
    BEGINNINGS.into_iter().chain(ENDS).chain(WORDS)
}

/// Returns whether a text has `://USER:PASSWORD@`.
fn has_password(text: &str) -> bool {
    text.split("://").skip(1).any(|rest| {
        let authority = rest.split(['/', '?', '#', ' ']).next().unwrap_or_default();
        authority.rsplit_once('@').is_some_and(|(user, _)| user.contains(':'))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::{Path, PathBuf};

    #[test]
    fn a_process_hears_nothing_of_the_key() {
        let command = command("program");
        let removed: Vec<_> =
            command.get_envs().filter(|(_, value)| value.is_none()).map(|(name, _)| name).collect();
        assert_eq!(removed, [KEY, PASSWORD].map(std::ffi::OsStr::new));
    }

    #[test]
    fn a_foreign_process_gets_no_secret() {
        let secret = |name: &str, value: &str| is_secret(name.as_ref(), value.as_ref());
        for name in [
            KEY,
            PASSWORD,
            "AWS_ACCESS_KEY_ID",
            "AWS_SESSION_TOKEN",
            "AZURE_CLIENT_ID",
            "GOOGLE_APPLICATION_CREDENTIALS",
            "GITHUB_TOKEN",
            "CARGO_REGISTRIES_HOUSE_TOKEN",
            "apikey",
            "DB_PASS",
            "PGPASSWORD",
            "MYSQL_PWD",
            "SSH_AUTH_SOCK",
            "SIGNING_KEYS",
            "CI_JOB_TOKEN",
            "AZURE_STORAGE_KEY",
            "client_secret",
        ] {
            assert!(secret(name, "x"), "{name}");
        }
        for name in [
            "PATH",
            "HOME",
            "PWD",
            "OLDPWD",
            "LANG",
            "TERM",
            "DISPLAY",
            "XAUTHORITY",
            "LD_LIBRARY_PATH",
            "PYTHONPATH",
            "OCTANT_RECORDINGS",
            "OCTANT_OPERATOR",
            "CI",
            "KEYBOARD",
            "PASSES",
            "AUTHOR",
        ] {
            assert!(!secret(name, "/usr/bin:/bin"), "{name}");
        }
        assert!(secret("https_proxy", "http://ann:hunter2@proxy:3128"));
        assert!(secret("DATABASE", "options postgres://ann:hunter2@host/base?a=b"));
        for value in ["http://proxy:3128", "ssh://git@host:22/a", "https://host/a:b@c", "a:b@c"] {
            assert!(!secret("https_proxy", value), "{value}");
        }
    }

    #[test]
    fn the_page_has_the_names_of_the_rule() {
        let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../docs/endpoints.md");
        let page = std::fs::read_to_string(page).unwrap();
        for name in names() {
            assert!(page.contains(&format!("`{name}`")), "{name}");
        }
    }

    #[test]
    fn foreign_lines_are_marked_escaped_and_limited() {
        let passed = |limit: OutputLimit, pieces: &[&[u8]]| {
            let mut out = Vec::new();
            let mut lines = ForeignLines::new("dev\u{1b}", limit, &mut out);
            pieces.iter().for_each(|piece| lines.take(piece));
            let dropped = lines.end();
            (String::from_utf8(out).unwrap(), dropped)
        };
        let limit = OutputLimit { bytes: 1 << 20, bytes_per_s: 0 };
        let (out, dropped) =
            passed(limit, &[b"one\r\ntw", b"o \x1b[31mpass\x07\n\xff\x9b", b" end"]);
        assert_eq!(
            out,
            "dev\\u001b: one\ndev\\u001b: two \\u001b[31mpass\\u0007\ndev\\u001b: \u{fffd}\u{fffd} end\n"
        );
        assert_eq!(dropped, 0);
        // A line without an end is broken, and between characters.
        let (out, _) = passed(limit, &["ä".repeat(1001).as_bytes()]);
        let lengths: Vec<usize> = out.lines().map(|line| line.chars().count()).collect();
        let mark = "dev\\u001b: ".len();
        assert_eq!(lengths, [mark + 500, mark + 500, mark + 1]);
        assert!(!out.contains('\u{fffd}'));
        // A flood is dropped, and counted.
        let few = OutputLimit { bytes: 10, bytes_per_s: 0 };
        let (out, dropped) = passed(few, &[b"12345678\nabc\n", b"more\n"]);
        assert_eq!((out.as_str(), dropped), ("dev\\u001b: 12345678\ndev\\u001b: a\n", 8));
        // Time allows more, and then what was dropped is told in its place.
        let mut out = Vec::new();
        let mut lines =
            ForeignLines::new("d", OutputLimit { bytes: 4, bytes_per_s: 1_000_000 }, &mut out);
        lines.take(b"one\nlost\n");
        std::thread::sleep(std::time::Duration::from_millis(5));
        lines.take(b"two\n");
        assert_eq!(lines.end(), 5);
        assert_eq!(out, b"d: one\nd: (5 bytes of its output were dropped)\nd: two\n");
    }

    /// No other file of the program starts a process.
    #[test]
    fn every_process_is_started_without_the_key() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..");
        let mut open: Vec<PathBuf> =
            ["models", "fmu", "harness"].map(|name| root.join(name)).into();
        let mut seen = 0;
        while let Some(folder) = open.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    // Tests and benches have a starter of their own.
                    if !["tests", "benches", "target", "testing", "test_processes"]
                        .iter()
                        .any(|name| path.ends_with(name))
                    {
                        open.push(path);
                    }
                    continue;
                }
                if path.extension().is_none_or(|of| of != "rs") || path.ends_with("build.rs") {
                    continue;
                }
                let text = std::fs::read_to_string(&path).unwrap_or_default();
                // Only the program counts, not its unit tests.
                let program = text.split("#[cfg(test)]").next().unwrap();
                let own = path.ends_with("base/src/child.rs");
                // Commands of clap are described, and not started.
                let program = program.replace("clap::Command::", "clap::");
                let found = program.matches(concat!("Command::", "new(")).count();
                assert_eq!(found, usize::from(own), "{}", path.display());
                seen += program.matches("child::command(").count()
                    + program.matches("child::foreign(").count();
            }
        }
        assert!(seen >= 5, "{seen} processes are started");
    }
}
