//! Encodings of the text files of other tools.

use octant_verdict::{RequirementsError, RequirementsProblem};

/// Decodes the bytes of a text file: UTF-8 or UTF-16, or another encoding that an XML declaration names.
pub(crate) fn decode(bytes: &[u8], file: &str) -> Result<String, RequirementsError> {
    let wrong = |line: usize, message: String| {
        RequirementsError::one(file, RequirementsProblem::new((line, 1), "", message))
    };
    let wide = match bytes {
        [0xff, 0xfe, ..] => Some(false),
        [0xfe, 0xff, ..] => Some(true),
        // A UTF-16 file without a mark begins with `<` and a zero.
        [0x3c, 0x00, ..] => Some(false),
        [0x00, 0x3c, ..] => Some(true),
        _ => None,
    };
    if let Some(big) = wide {
        let (pairs, rest) = bytes.as_chunks::<2>();
        let units =
            pairs.iter().map(|p| if big { u16::from_be_bytes(*p) } else { u16::from_le_bytes(*p) });
        let text: Result<String, _> = char::decode_utf16(units).collect();
        return match text {
            Ok(text) if rest.is_empty() => Ok(text.trim_start_matches('\u{feff}').to_owned()),
            _ => Err(wrong(1, "the text is no valid UTF-16".to_owned())),
        };
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let error = match std::str::from_utf8(bytes) {
        Ok(text) => return Ok(text.to_owned()),
        Err(error) => error,
    };
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(200)]).to_ascii_lowercase();
    let declared = head.split_once("encoding=").and_then(|(_, rest)| {
        let mut parts = rest.splitn(3, ['"', '\'']);
        parts.nth(1)
    });
    if matches!(declared, Some("iso-8859-1" | "latin1" | "windows-1252" | "cp1252")) {
        return Ok(octant_base::encoding::windows_1252(bytes));
    }
    let line = bytes[..error.valid_up_to()].iter().filter(|b| **b == b'\n').count() + 1;
    let found = bytes[error.valid_up_to()];
    let declared = declared.map_or_else(String::new, |name| format!(", and declares {name:?}"));
    Err(wrong(
        line,
        format!(
            "the text is not UTF-8: found the byte 0x{found:02x}{declared}; expected UTF-8 or UTF-16"
        ),
    ))
}
