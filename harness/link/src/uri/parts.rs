//! Parts of the text of a port: its name and its options.

use octant_wire::can::CanVersion;

/// Error of a text that names no port.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UriError {
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
    /// The name after the scheme is missing.
    #[error("found {found:?}, expected {expected}")]
    Name {
        /// The text.
        found: String,
        /// Expected form.
        expected: &'static str,
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

/// Parts of a text: what is named, and the options as written.
#[derive(Debug)]
pub(super) struct Parts<'a> {
    /// The whole text.
    pub(super) text: &'a str,
    /// Name after the scheme.
    pub(super) name: &'a str,
    options: Vec<(&'a str, &'a str)>,
}

impl<'a> Parts<'a> {
    /// Splits what follows the scheme.
    pub(super) fn read(
        text: &'a str,
        rest: &'a str,
        scheme: &'static str,
        known: &'static [&'static str],
    ) -> Result<Self, UriError> {
        let (name, written) = match rest.split_once('?') {
            Some((name, written)) => (name, Some(written)),
            None => (rest, None),
        };
        let mut options: Vec<(&str, &str)> = Vec::new();
        for part in written.into_iter().flat_map(|written| written.split('&')) {
            let Some((option, value)) = part.split_once('=') else {
                return Err(UriError::Form { found: part.to_owned() });
            };
            if !known.contains(&option) {
                return Err(UriError::Option { scheme, option: option.to_owned(), known });
            }
            if options.iter().any(|(other, _)| *other == option) {
                return Err(UriError::Form { found: part.to_owned() });
            }
            options.push((option, value));
        }
        Ok(Self { text, name, options })
    }

    /// Name of the port, which has to be there.
    pub(super) fn named(&self, expected: &'static str) -> Result<String, UriError> {
        match self.name {
            "" => Err(UriError::Name { found: self.text.to_owned(), expected }),
            name => Ok(name.to_owned()),
        }
    }

    fn get(&self, option: &str) -> Option<&'a str> {
        self.options.iter().find(|(name, _)| *name == option).map(|(_, value)| *value)
    }

    /// Name of a file.
    pub(super) fn file(&self, option: &'static str) -> Result<Option<String>, UriError> {
        match self.get(option) {
            Some("") => Err(UriError::Value {
                option,
                found: String::new(),
                expected: "the name of a file".to_owned(),
            }),
            name => Ok(name.map(str::to_owned)),
        }
    }

    pub(super) fn rate(&self, option: &'static str) -> Result<Option<u32>, UriError> {
        let Some(text) = self.get(option) else { return Ok(None) };
        match text.parse() {
            Ok(rate @ 1..) => Ok(Some(rate)),
            _ => Err(UriError::Value {
                option,
                found: text.to_owned(),
                expected: "a whole number of bits a second".to_owned(),
            }),
        }
    }

    /// Format given by `fd`; `data_bitrate` requires `fd=1`.
    pub(super) fn format(&self) -> Result<CanVersion, UriError> {
        let format = match self.get("fd") {
            None | Some("0") => CanVersion::Classic,
            Some("1") => CanVersion::Fd,
            Some(found) => {
                return Err(UriError::Value {
                    option: "fd",
                    found: found.to_owned(),
                    expected: "0 (classic CAN) or 1 (CAN FD)".to_owned(),
                });
            }
        };
        if let (CanVersion::Classic, Some(found)) = (format, self.get("data_bitrate")) {
            return Err(UriError::Value {
                option: "data_bitrate",
                found: found.to_owned(),
                expected: "fd=1 with it: classic CAN has one bit rate".to_owned(),
            });
        }
        Ok(format)
    }
}
