//! Escapes of Python in the strings of StrictDoc.

/// Reverts the escapes of Python's `unicode_escape`, with which StrictDoc writes strings.
#[must_use]
pub fn unescape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find('\\') {
        out.push_str(&rest[..at]);
        rest = &rest[at + 1..];
        let Some(first) = rest.chars().next() else {
            out.push('\\');
            break;
        };
        let digits = match first {
            'x' => 2,
            'u' => 4,
            'U' => 8,
            _ => 0,
        };
        let code = rest.get(1..=digits).filter(|_| digits > 0);
        let code = code.and_then(|hex| u32::from_str_radix(hex, 16).ok()).and_then(char::from_u32);
        match (first, code) {
            (_, Some(c)) => {
                out.push(c);
                rest = &rest[1 + digits..];
                continue;
            }
            ('n', _) => out.push('\n'),
            ('r', _) => out.push('\r'),
            ('t', _) => out.push('\t'),
            ('\\', _) => out.push('\\'),
            (other, _) => {
                out.push('\\');
                out.push(other);
            }
        }
        rest = &rest[first.len_utf8()..];
    }
    out.push_str(rest);
    out
}
