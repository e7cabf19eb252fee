//! Text of files whose encoding isn't said.

/// Characters of the bytes 0x80 to 0x9f in Windows-1252; the five that it leaves out are control
/// characters, as the WHATWG has them.
const HIGH: [char; 32] = [
    '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž', '\u{8f}',
    '\u{90}', '‘', '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}', 'ž', 'Ÿ',
];

/// Decodes Windows-1252, in which every byte is valid.
#[must_use]
pub fn windows_1252(bytes: &[u8]) -> String {
    let one = |byte: &u8| match byte {
        0x80..=0x9f => HIGH[usize::from(byte - 0x80)],
        other => char::from(*other),
    };
    bytes.iter().map(one).collect()
}

/// Decodes a text that is UTF-8 or, if its bytes aren't, Windows-1252. UTF-8's byte order mark is
/// left out.
#[must_use]
pub fn utf8_or_windows_1252(bytes: &[u8]) -> String {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    std::str::from_utf8(text).map_or_else(|_| windows_1252(text), str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_of_windows_1252_is_a_character_of_its_own() {
        let all: Vec<u8> = (0..=255).collect();
        let text = windows_1252(&all);
        let mut characters: Vec<char> = text.chars().collect();
        // Unicode's mapping table of Windows-1252: 0x80 is U+20AC, 0x99 U+2122, 0x9f U+0178.
        assert_eq!((characters[0x80], characters[0x99]), ('\u{20ac}', '\u{2122}'));
        assert_eq!((characters[0x9f], characters[0xb0]), ('\u{178}', '°'));
        characters.sort_unstable();
        characters.dedup();
        assert_eq!(characters.len(), 256);
    }

    #[test]
    fn utf_8_comes_first_and_its_mark_is_left_out() {
        assert_eq!(utf8_or_windows_1252("°/s €".as_bytes()), "°/s €");
        assert_eq!(utf8_or_windows_1252("\u{feff}°/s".as_bytes()), "°/s");
        assert_eq!(utf8_or_windows_1252(b"\xb0/s \x80"), "°/s €");
        assert_eq!(utf8_or_windows_1252(b""), "");
    }
}
