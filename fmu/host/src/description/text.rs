//! Conversion of an XML file in any encoding to text.

use super::DescriptionError;
use super::encoding::{EXPECTED, Encoding};
use octant_base::encoding::windows_1252;

/// Decodes the text of an XML file, without a byte order mark; also returns the deviations that
/// were tolerated.
///
/// The standards demand UTF-8. Others are decoded by their byte order mark or by the name in the
/// XML declaration; bytes that aren't the declared UTF-8 are read as Windows-1252, the usual cause.
///
/// # Errors
/// If the encoding is unknown, or the bytes aren't valid in it.
pub fn decode(bytes: &[u8], file: &str) -> Result<(String, Vec<String>), DescriptionError> {
    let fail = |found: String, expected: &str| DescriptionError {
        file: file.into(),
        line: None,
        place: "encoding".into(),
        found,
        expected: expected.into(),
    };
    let mut tolerated = Vec::new();
    if let Some((encoding, mark)) = Encoding::of_mark(bytes) {
        if encoding == Encoding::Utf8 {
            tolerated.push("a byte order mark before the text is left out".into());
        } else {
            tolerated.push(format!("{} is decoded, the standards demand UTF-8", encoding.name()));
        }
        return encoding.decode(&bytes[mark..]).map(|text| (text, tolerated)).ok_or_else(|| {
            fail(format!("bytes that aren't {}", encoding.name()), "what its mark says")
        });
    }
    let declared = declared(bytes);
    let label = declared.as_deref().unwrap_or("UTF-8");
    let encoding =
        Encoding::of_name(label).ok_or_else(|| fail(format!("{label:?} is declared"), EXPECTED))?;
    // A declaration that is legible as ASCII isn't in UTF-16: .NET writes this for strings that it
    // holds as UTF-16.
    let utf16 = matches!(encoding, Encoding::Utf16Le | Encoding::Utf16Be);
    if utf16 {
        tolerated.push(format!("{label} is declared, but the file is in UTF-8"));
    }
    if encoding == Encoding::Utf8 || utf16 {
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => text.to_owned(),
            Err(error) => {
                let line = 1 + bytes[..error.valid_up_to()].iter().filter(|&&b| b == b'\n').count();
                tolerated
                    .push(format!("line {line} isn't UTF-8; the file is read as Windows-1252"));
                windows_1252(bytes)
            }
        };
        return Ok((text, tolerated));
    }
    tolerated.push(format!("{label} is decoded, the standards demand UTF-8"));
    encoding
        .decode(bytes)
        .map(|text| (text, tolerated))
        .ok_or_else(|| fail(format!("bytes that aren't {label}"), "what is declared"))
}

/// Returns whether bytes are a description of FMI 1.0, whatever their encoding.
#[must_use]
pub fn is_of_fmi_1(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(16 * 1024)];
    // Zeros are between the letters of UTF-16.
    let text: String = start.iter().filter(|byte| **byte != 0).map(|b| char::from(*b)).collect();
    let Some((_, rest)) = text.split_once("<fmiModelDescription") else { return false };
    let tag = rest.split('>').next().unwrap_or_default();
    let Some((_, value)) = tag.split_once("fmiVersion") else { return false };
    let value = value.trim_start().trim_start_matches('=').trim_start();
    value.trim_start_matches(['"', '\'']).trim_start().starts_with("1.")
}

/// Encoding in the XML declaration. All encodings in which a declaration is legible are supersets
/// of ASCII; the others have a mark.
fn declared(bytes: &[u8]) -> Option<String> {
    let start = bytes.get(..bytes.len().min(200))?;
    let text: String = start.iter().map(|&byte| char::from(byte)).collect();
    let declaration = text.trim_start().strip_prefix("<?xml")?.split("?>").next()?;
    let (_, rest) = declaration.split_once("encoding")?;
    let rest = rest.trim_start().strip_prefix('=')?.trim_start();
    let quote = rest.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    rest[1..].split(quote).next().map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(bytes: &[u8]) -> (String, usize) {
        let (text, tolerated) = decode(bytes, "m.xml").expect("can be decoded");
        (text, tolerated.len())
    }

    #[test]
    fn encodings_are_decoded() {
        assert_eq!(text("<a>°</a>".as_bytes()), ("<a>°</a>".into(), 0));
        assert_eq!(text("\u{feff}<a>°</a>".as_bytes()), ("<a>°</a>".into(), 1));
        let declared = b"<?xml version='1.0' encoding='ISO-8859-1'?><a>\xb0</a>";
        assert!(text(declared).0.ends_with("<a>°</a>"));
        let declared = b"<?xml version=\"1.0\" encoding = \"windows-1252\" ?><a>\x80</a>";
        assert!(text(declared).0.ends_with("<a>€</a>"));
        let utf16: Vec<u8> = "\u{feff}<a>°</a>".encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert_eq!(text(&utf16), ("<a>°</a>".into(), 1));
        let utf16: Vec<u8> = "\u{feff}<a>°</a>".encode_utf16().flat_map(u16::to_be_bytes).collect();
        assert_eq!(text(&utf16), ("<a>°</a>".into(), 1));
    }

    #[test]
    fn bytes_that_are_not_what_is_declared_are_latin_or_an_error() {
        let (read, tolerated) = decode(b"<a>\n\xb0</a>", "m.xml").expect("is read");
        assert_eq!(read, "<a>\n°</a>");
        assert_eq!(tolerated, ["line 2 isn't UTF-8; the file is read as Windows-1252"]);
        let error = decode(b"<?xml version='1.0' encoding='EBCDIC'?><a/>", "m.xml");
        let error = error.expect_err("unknown").to_string();
        assert!(
            error.starts_with("m.xml: encoding: \"EBCDIC\" is declared, expected UTF-8"),
            "{error}"
        );
        assert_eq!(
            error.contains("the feature `encodings`"),
            !cfg!(feature = "encodings"),
            "{error}"
        );
        let error = decode(b"\xff\xfe<\0a\0/\0>", "m.xml").expect_err("half a character");
        assert!(error.to_string().contains("aren't UTF-16LE"), "{error}");
        assert_eq!(text(b""), (String::new(), 0));
        let (read, tolerated) = text(b"<?xml version='1.0' encoding='utf-16'?><a>\xc2\xb0</a>");
        assert!(read.ends_with("<a>°</a>") && tolerated == 1);
    }
}
