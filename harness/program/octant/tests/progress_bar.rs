//! The bar of progress on a terminal.

use octant::progress_bar::bar_line;

#[test]
fn a_line_has_the_share_that_is_done_and_fits() {
    let line = |done, total, columns| bar_line(done, total, "1 of 4", columns);
    assert_eq!(line(1, Some(4), 15), "██░░░░░░ 1 of 4");
    assert_eq!(line(4, Some(4), 15), "████████ 1 of 4");
    assert_eq!(line(9, Some(4), 15), "████████ 1 of 4");
    assert_eq!(line(0, Some(0), 9), "░░ 1 of 4");
    assert_eq!(line(1, None, 15), "1 of 4");
    assert_eq!(line(1, Some(4), 3), "1 o");
    assert_eq!(bar_line(0, None, "a\u{1b}b", 40).matches('\u{1b}').count(), 0);
}
