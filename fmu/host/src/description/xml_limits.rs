//! Limits of an XML file, checked in one pass over its bytes before it is parsed.
//!
//! The parser compares each attribute of an element with all others, copies the namespaces in scope
//! for each element that adds one, and has no limit of depth: without these limits a file of a few
//! megabytes takes minutes or gigabytes. The pass finds the same tags as the parser in every
//! well-formed file; what isn't well-formed is left to the parser, which refuses it.

use std::ops::Range;

/// Largest size of a file, bytes: a description of this size has a million variables.
pub const TEXT_BYTES_MAX: usize = 256 << 20;

/// Largest number of attributes of an element. The standards have at most 30; annotations of vendors
/// have their own.
pub const ATTRIBUTES_MAX: usize = 256;

/// Largest number of namespaces in scope.
pub const NAMESPACES_MAX: usize = 64;

/// Largest depth of nested elements. Only terminals and annotations are nested at all.
pub const DEPTH_MAX: usize = 256;

/// Longest name of an element or attribute, bytes.
pub const NAME_BYTES_MAX: usize = 1024;

/// Longest value of the attribute `name`, bytes: a variable's, a unit's.
pub const NAME_VALUE_BYTES_MAX: usize = 16 << 10;

/// Longest value of any other attribute, bytes: the start values of an array of a million elements
/// have 25 MB.
pub const VALUE_BYTES_MAX: usize = 64 << 20;

/// A part of a file that exceeds a limit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct XmlExcess {
    /// Offset of the part, bytes.
    pub at: usize,
    /// Part found.
    pub found: String,
    /// Limit.
    pub expected: String,
}

/// Checks the limits.
///
/// # Errors
/// If one is exceeded: the first part that does.
pub fn check(text: &str) -> Result<(), XmlExcess> {
    if text.len() > TEXT_BYTES_MAX {
        let found = format!("{} bytes", text.len());
        return Err(XmlExcess { at: 0, found, expected: format!("at most {TEXT_BYTES_MAX}") });
    }
    let mut pass = Pass { text, at: 0, namespaces: Vec::new() };
    while pass.next_markup() {
        pass.markup()?;
    }
    Ok(())
}

struct Pass<'a> {
    text: &'a str,
    at: usize,
    /// Namespaces that each open element has in scope.
    namespaces: Vec<usize>,
}

impl<'a> Pass<'a> {
    fn rest(&self) -> &'a [u8] {
        // A value without its second quote ends behind the file.
        self.text.as_bytes().get(self.at..).unwrap_or_default()
    }

    /// Goes to the next `<`; false: there is none.
    fn next_markup(&mut self) -> bool {
        match self.rest().iter().position(|&byte| byte == b'<') {
            Some(length) => self.at += length,
            None => return false,
        }
        true
    }

    /// Goes behind the next `end`, or to the end of the file.
    fn skip_past(&mut self, end: &str) {
        let length = self.text.get(self.at..).and_then(|rest| rest.find(end));
        self.at = length.map_or(self.text.len(), |length| self.at + length + end.len());
    }

    fn markup(&mut self) -> Result<(), XmlExcess> {
        let rest = self.rest();
        if rest.starts_with(b"<!--") {
            self.at += 4;
            self.skip_past("-->");
        } else if rest.starts_with(b"<![CDATA[") {
            self.skip_past("]]>");
        } else if rest.starts_with(b"<?") {
            self.skip_past("?>");
        } else if rest.starts_with(b"</") {
            self.namespaces.pop();
            self.skip_past(">");
        } else {
            return self.start_tag();
        }
        Ok(())
    }

    /// Reads a start tag. Each attribute has one value in quotes, and no value has its own quotes.
    fn start_tag(&mut self) -> Result<(), XmlExcess> {
        let (start, bytes) = (self.at, self.text.as_bytes());
        let mut namespaces = self.namespaces.last().copied().unwrap_or(0);
        let mut attributes = 0;
        // The last word outside of quotes: first the element's name, then the attributes'.
        let mut word = start + 1..start + 1;
        let mut in_word = true;
        self.at += 1;
        while let Some(&byte) = bytes.get(self.at) {
            match byte {
                b'>' => {
                    self.at += 1;
                    if bytes[self.at - 2] != b'/' {
                        self.namespaces.push(namespaces);
                        self.depth(start)?;
                    }
                    return Ok(());
                }
                b'"' | b'\'' => {
                    let length = bytes[self.at + 1..].iter().position(|&other| other == byte);
                    let length = length.unwrap_or(bytes.len() - self.at - 1);
                    attributes += 1;
                    let name = &bytes[word.clone()];
                    if name.starts_with(b"xmlns") {
                        namespaces += 1;
                    }
                    self.value(length, name == b"name")?;
                    counts(start, attributes, namespaces)?;
                    self.at += length + 1;
                    in_word = false;
                }
                b' ' | b'\t' | b'\r' | b'\n' | b'=' => in_word = false,
                _ if in_word => {
                    word.end = self.at + 1;
                    name(&word)?;
                }
                _ => {
                    word = self.at..self.at + 1;
                    in_word = true;
                }
            }
            self.at += 1;
        }
        Ok(())
    }

    fn depth(&self, start: usize) -> Result<(), XmlExcess> {
        if self.namespaces.len() <= DEPTH_MAX {
            return Ok(());
        }
        let found = format!("an element at a depth of {}", self.namespaces.len());
        Err(XmlExcess { at: start, found, expected: format!("at most {DEPTH_MAX}") })
    }

    fn value(&self, length: usize, is_name: bool) -> Result<(), XmlExcess> {
        let (what, max) = match is_name {
            true => ("a name", NAME_VALUE_BYTES_MAX),
            false => ("a value", VALUE_BYTES_MAX),
        };
        if length <= max {
            return Ok(());
        }
        let found = format!("{what} of {length} bytes");
        Err(XmlExcess { at: self.at, found, expected: format!("at most {max}") })
    }
}

fn counts(at: usize, attributes: usize, namespaces: usize) -> Result<(), XmlExcess> {
    let (what, max) = if attributes > ATTRIBUTES_MAX {
        ("an element with more than 256 attributes", ATTRIBUTES_MAX)
    } else if namespaces > NAMESPACES_MAX {
        ("an element with more than 64 namespaces in scope", NAMESPACES_MAX)
    } else {
        return Ok(());
    };
    Err(XmlExcess { at, found: what.into(), expected: format!("at most {max}") })
}

fn name(word: &Range<usize>) -> Result<(), XmlExcess> {
    if word.len() <= NAME_BYTES_MAX {
        return Ok(());
    }
    let found = format!("a name of more than {NAME_BYTES_MAX} bytes");
    Err(XmlExcess { at: word.start, found, expected: format!("at most {NAME_BYTES_MAX}") })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> Option<(usize, String)> {
        check(text).err().map(|excess| (excess.at, excess.found))
    }

    /// Makes an element with so many attributes.
    fn element(attributes: usize) -> String {
        let list: String = (0..attributes).map(|i| format!(" a{i} = '>\"{i}'")).collect();
        format!("<a{list}/>")
    }

    #[test]
    fn what_is_within_the_limits_passes() {
        let nested = "<a>".repeat(DEPTH_MAX) + &"</a>".repeat(DEPTH_MAX);
        let siblings = format!("<r>{}</r>", "<a xmlns='u'/>".repeat(1000));
        let name = format!("<a name='{}' value='{}'/>", "n".repeat(16 << 10), "v".repeat(1 << 20));
        let hidden = format!("<a><!-- {0} --><![CDATA[ {0} ]]><?p {0} ?></a>", element(300));
        let wide = element(256);
        let made = [&nested, &siblings, &name, &hidden, &wide].map(String::as_str);
        for text in made.into_iter().chain(["", "text", "<", "<a b='"]) {
            assert_eq!(found(text), None, "{}", &text[..text.len().min(100)]);
        }
    }

    #[test]
    fn every_limit_is_kept() {
        let nested = "<a>".repeat(DEPTH_MAX + 1);
        assert_eq!(found(&nested), Some((3 * DEPTH_MAX, "an element at a depth of 257".into())));
        let wide = format!("<r>\n{}</r>", element(257));
        assert_eq!(found(&wide), Some((4, "an element with more than 256 attributes".into())));
        // Namespaces of the elements around it count.
        let space = |n: usize| {
            format!("<a{}>", (0..n).map(|i| format!(" xmlns:n{i}='u'")).collect::<String>())
        };
        let spaces = space(40) + &space(24);
        assert_eq!(found(&spaces), None);
        let spaces = space(40) + &space(25);
        let at = space(40).len();
        let expected = "an element with more than 64 namespaces in scope";
        assert_eq!(found(&spaces), Some((at, expected.into())));
        let name = format!("<a name='{}'/>", "n".repeat((16 << 10) + 1));
        assert_eq!(found(&name), Some((8, "a name of 16385 bytes".into())));
        let long = "n".repeat(NAME_BYTES_MAX + 1);
        let expected = "a name of more than 1024 bytes";
        assert_eq!(found(&format!("<{long}/>")), Some((1, expected.into())));
        assert_eq!(found(&format!("<a {long}='1'/>")), Some((3, expected.into())));
    }
}
