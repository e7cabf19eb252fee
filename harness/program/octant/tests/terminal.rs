//! Styles of help on a terminal.

use octant::terminal::{styled, with_headings};

#[test]
fn only_headings_are_set_off() {
    let help = "Runs.\n\nUsage: octant run\n\nOptions:\n  -h  a: b\n  note:\n";
    let styled = with_headings(help);
    let plain = styled.replace("\u{1b}[1;4m", "").replace("\u{1b}[0m", "");
    assert_eq!(plain, help);
    assert_eq!(styled.matches("\u{1b}[1;4m").count(), 2);
    assert!(styled.contains("\u{1b}[1;4mUsage:\u{1b}[0m octant run\n"), "{styled:?}");
    assert!(with_headings("error: no\n").starts_with("\u{1b}[1;31merror:\u{1b}[0m no"));
}

#[test]
fn what_is_no_terminal_shows_no_styles() {
    let file = std::fs::File::open(env!("CARGO_MANIFEST_DIR")).expect("is there");
    assert_eq!(styled("Usage: a", &file), "Usage: a");
}
