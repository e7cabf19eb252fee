//! Texts that fit the panels of the dashboard.

use octant_watch::dashboard::fit::{elide, elide_path, wrap, wrap_styled};
use ratatui::style::Style;

#[test]
fn lines_break_between_words_and_a_number_keeps_its_unit() {
    for (text, width, expected) in [
        ("short", 10, &["short"][..]),
        ("", 10, &[""]),
        ("calibrating, moving", 14, &["calibrating,", "moving"]),
        ("fired once, until 10.1 s", 22, &["fired once,", "until 10.1 s"]),
        ("acts since 1 min 30 s", 15, &["acts since", "1 min 30 s"]),
        ("30.5°  114.4°  0.0 m", 16, &["30.5°  114.4°", "0.0 m"]),
        ("a.longitude_error.max", 12, &["a.longitude_", "error.max"]),
        ("indivisible", 5, &["indiv", "isibl", "e"]),
    ] {
        assert_eq!(wrap(text, width), expected, "{text}");
    }
}

#[test]
fn what_is_left_out_is_whole_words_or_folders() {
    assert_eq!(elide("a long title, of many words", 27), "a long title, of many words");
    assert_eq!(elide("a long title, of many words", 26), "a long title …");
    assert_eq!(elide_path("runs/night/clock.partial", 24), "runs/night/clock.partial");
    assert_eq!(elide_path("runs/night/clock.partial", 21), "…/night/clock.partial");
    assert_eq!(elide_path("runs/night/clock.partial", 20), "…/clock.partial");
    assert_eq!(elide_path("runs/night/clock.partial", 5), "…");
}

#[test]
fn styles_stay_with_their_words() {
    let red = Style::new().fg(ratatui::style::Color::Red);
    let lines = wrap_styled(&[("spike-1 ", Style::new()), ("fired once, until 3 s", red)], 16);
    let texts: Vec<String> = lines.iter().map(ToString::to_string).collect();
    assert_eq!(texts, ["spike-1 fired", "  once, until", "  3 s"]);
    assert_eq!(lines[0].spans.last().unwrap().style, red);
    assert_eq!(lines[2].spans.last().unwrap().content, "3 s");
}
