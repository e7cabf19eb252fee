//! Texts of requirements, as every format holds them.

/// Normalizes a text: without surrounding space, and with plain line breaks.
pub fn normal(text: &str) -> String {
    text.replace("\r\n", "\n").replace('\r', "\n").trim().to_owned()
}

/// First character that other formats can't hold.
pub fn control(text: &str) -> Option<char> {
    let legal = |c: char| matches!(c, '\n' | '\t') || !c.is_control();
    text.chars().find(|c| !legal(*c) || matches!(c, '\u{fffe}' | '\u{ffff}'))
}
