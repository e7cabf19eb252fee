//! Reasons why a text is no address.

/// Error of a text that names no port.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum AddressError {
    /// The text has nothing before a colon.
    #[error("found {found:?}, expected SCHEME:NAME with a scheme of {}", names(known))]
    NoScheme {
        /// The text.
        found: String,
        /// Schemes that there are.
        known: Vec<&'static str>,
    },
    /// The scheme is unknown.
    #[error("found scheme {found:?}, {}", nearest(found, known))]
    Scheme {
        /// The scheme.
        found: String,
        /// Schemes that there are.
        known: Vec<&'static str>,
    },
    /// The name after the scheme isn't one.
    #[error("found {found:?}, expected {expected}")]
    Name {
        /// The text.
        found: String,
        /// Expected form.
        expected: String,
    },
    /// The scheme doesn't have this option.
    #[error("found option {option:?} of {scheme}:, {}", nearest(option, known))]
    Option {
        /// The scheme.
        scheme: &'static str,
        /// The option.
        option: String,
        /// Options of the scheme.
        known: &'static [&'static str],
    },
    /// An option has no value, or is given twice.
    #[error("found {found:?} among the options, expected OPTION=VALUE, each once")]
    Form {
        /// Text found.
        found: String,
    },
    /// The value is invalid.
    #[error("found {option}={found}, expected {expected}")]
    Value {
        /// The option.
        option: &'static str,
        /// Value found.
        found: String,
        /// Expected form.
        expected: String,
    },
}

fn names(known: &[&str]) -> String {
    known.join(", ")
}

/// Suggests the nearest of some names, or lists all of them.
fn nearest(found: &str, known: &[&str]) -> String {
    let near = known
        .iter()
        .map(|name| (strsim::damerau_levenshtein(found, name), name))
        .filter(|(distance, name)| *distance <= name.len().max(2) / 2)
        .min();
    match near {
        Some((_, name)) => format!("expected {name}?"),
        None if known.is_empty() => "it has no options".to_owned(),
        None => format!("known are {}", names(known)),
    }
}
