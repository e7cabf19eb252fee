//! Encodings of XML files: those that FMUs are met in, and all of the web's with the feature
//! `encodings`.

use octant_base::encoding::windows_1252;

/// Encoding of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    /// UTF-8.
    Utf8,
    /// UTF-16, the low byte first.
    Utf16Le,
    /// UTF-16, the high byte first.
    Utf16Be,
    /// Windows-1252, a superset of ISO 8859-1 and ASCII, which are read as it.
    Windows1252,
    /// Another encoding of the WHATWG's standard.
    #[cfg(feature = "encodings")]
    Other(&'static encoding_rs::Encoding),
}

/// Encodings that the program was built with, for messages.
pub(super) const EXPECTED: &str = if cfg!(feature = "encodings") {
    "UTF-8"
} else {
    "UTF-8 (read are UTF-16, ISO-8859-1 and Windows-1252 too; the feature `encodings` of the build brings others)"
};

impl Encoding {
    /// Encoding that a byte order mark says, and the mark's length.
    pub(super) fn of_mark(bytes: &[u8]) -> Option<(Self, usize)> {
        match bytes {
            [0xef, 0xbb, 0xbf, ..] => Some((Self::Utf8, 3)),
            [0xff, 0xfe, ..] => Some((Self::Utf16Le, 2)),
            [0xfe, 0xff, ..] => Some((Self::Utf16Be, 2)),
            _ => None,
        }
    }

    /// Encoding of a name; `None` if this program doesn't read it.
    pub(super) fn of_name(name: &str) -> Option<Self> {
        match name.trim().to_ascii_lowercase().as_str() {
            "utf-8" | "utf8" => Some(Self::Utf8),
            "utf-16" | "utf-16le" => Some(Self::Utf16Le),
            "utf-16be" => Some(Self::Utf16Be),
            "windows-1252" | "cp1252" | "iso-8859-1" | "latin1" | "us-ascii" | "ascii" => {
                Some(Self::Windows1252)
            }
            other => Self::of_other(other),
        }
    }

    #[cfg(feature = "encodings")]
    fn of_other(name: &str) -> Option<Self> {
        let found = encoding_rs::Encoding::for_label(name.as_bytes())?;
        Some(match found.name() {
            "UTF-8" => Self::Utf8,
            "UTF-16LE" => Self::Utf16Le,
            "UTF-16BE" => Self::Utf16Be,
            "windows-1252" => Self::Windows1252,
            _ => Self::Other(found),
        })
    }

    #[cfg(not(feature = "encodings"))]
    fn of_other(_: &str) -> Option<Self> {
        None
    }

    /// Name for messages.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Utf8 => "UTF-8",
            Self::Utf16Le => "UTF-16LE",
            Self::Utf16Be => "UTF-16BE",
            Self::Windows1252 => "windows-1252",
            #[cfg(feature = "encodings")]
            Self::Other(other) => other.name(),
        }
    }

    /// Decodes bytes that have no mark; `None` if they aren't valid.
    pub(super) fn decode(self, bytes: &[u8]) -> Option<String> {
        match self {
            Self::Utf8 => std::str::from_utf8(bytes).ok().map(str::to_owned),
            Self::Utf16Le => utf16(bytes, u16::from_le_bytes),
            Self::Utf16Be => utf16(bytes, u16::from_be_bytes),
            Self::Windows1252 => Some(windows_1252(bytes)),
            #[cfg(feature = "encodings")]
            Self::Other(other) => other
                .decode_without_bom_handling_and_without_replacement(bytes)
                .map(std::borrow::Cow::into_owned),
        }
    }
}

fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Option<String> {
    let (units, rest) = bytes.as_chunks::<2>();
    if !rest.is_empty() {
        return None;
    }
    char::decode_utf16(units.iter().map(|two| unit(*two))).collect::<Result<_, _>>().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(feature = "encodings")]
    #[test]
    fn the_library_reads_windows_1252_and_utf_16_the_same() {
        let all: Vec<u8> = (0..=255).collect();
        let (theirs, _) = encoding_rs::WINDOWS_1252.decode_without_bom_handling(&all);
        assert_eq!(windows_1252(&all), theirs);
        for name in ["latin1", "ascii", "cp1252", "utf8", "utf-16", "utf-16be", "utf-16le"] {
            let theirs = encoding_rs::Encoding::for_label(name.as_bytes()).expect(name);
            assert_eq!(Encoding::of_name(name).expect(name).name(), theirs.name());
        }
        let japanese = Encoding::of_name("Shift_JIS").expect("is known");
        assert_eq!(japanese.decode(b"\x8a\xb5\x90\xab").as_deref(), Some("慣性"));
    }

    #[test]
    fn utf_16_of_half_characters_is_refused() {
        assert_eq!(Encoding::Utf16Le.decode(b"a\0b\0").as_deref(), Some("ab"));
        assert_eq!(Encoding::Utf16Le.decode(b"a\0b"), None);
        // Half of a surrogate pair.
        assert_eq!(Encoding::Utf16Be.decode(b"\xd8\x00\0a"), None);
    }
}
