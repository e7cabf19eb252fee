//! Parts of the text of a port: its name and its options.

use super::error::AddressError;

/// Parts of a text: what is named, and the options as written.
#[derive(Clone, Debug)]
pub struct AddressParts<'a> {
    /// The whole text.
    pub text: &'a str,
    /// Name after the scheme.
    pub name: &'a str,
    options: Vec<(&'a str, &'a str)>,
}

impl<'a> AddressParts<'a> {
    /// Splits `rest`, which follows the scheme in `text`, at the options that the scheme has.
    ///
    /// # Errors
    /// If an option isn't known, has no value or is given twice.
    pub fn read(
        text: &'a str,
        rest: &'a str,
        scheme: &'static str,
        known: &'static [&'static str],
    ) -> Result<Self, AddressError> {
        let (name, written) = match rest.split_once('?') {
            Some((name, written)) => (name, Some(written)),
            None => (rest, None),
        };
        let mut options: Vec<(&str, &str)> = Vec::new();
        for part in written.into_iter().flat_map(|written| written.split('&')) {
            let Some((option, value)) = part.split_once('=') else {
                return Err(AddressError::Form { found: part.to_owned() });
            };
            if !known.contains(&option) {
                return Err(AddressError::Option { scheme, option: option.to_owned(), known });
            }
            if options.iter().any(|(other, _)| *other == option) {
                return Err(AddressError::Form { found: part.to_owned() });
            }
            options.push((option, value));
        }
        Ok(Self { text, name, options })
    }

    /// Name of the port.
    ///
    /// # Errors
    /// If it is missing.
    pub fn named(&self, expected: &str) -> Result<String, AddressError> {
        match self.name {
            "" => Err(self.form(expected)),
            name => Ok(name.to_owned()),
        }
    }

    /// Error of a text that doesn't have the expected form.
    #[must_use]
    pub fn form(&self, expected: impl Into<String>) -> AddressError {
        AddressError::Name { found: self.text.to_owned(), expected: expected.into() }
    }

    /// Value of an option as written.
    #[must_use]
    pub fn get(&self, option: &str) -> Option<&'a str> {
        self.options.iter().find(|(name, _)| *name == option).map(|(_, value)| *value)
    }

    /// Name of a file.
    ///
    /// # Errors
    /// If it is empty.
    pub fn file(&self, option: &'static str) -> Result<Option<String>, AddressError> {
        match self.get(option) {
            Some("") => Err(AddressError::Value {
                option,
                found: String::new(),
                expected: "the name of a file".to_owned(),
            }),
            name => Ok(name.map(str::to_owned)),
        }
    }

    /// A bit rate, bit/s.
    ///
    /// # Errors
    /// If it is no whole number above 0.
    pub fn rate(&self, option: &'static str) -> Result<Option<u32>, AddressError> {
        let Some(text) = self.get(option) else { return Ok(None) };
        match text.parse() {
            Ok(rate @ 1..) => Ok(Some(rate)),
            _ => Err(AddressError::Value {
                option,
                found: text.to_owned(),
                expected: "a whole number of bits a second".to_owned(),
            }),
        }
    }
}
