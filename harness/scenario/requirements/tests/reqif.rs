//! Escapes in texts of StrictDoc.

use octant_requirements::reqif::unescape;

#[test]
fn escapes_of_python_are_taken_back() {
    assert_eq!(unescape(r"50 \xb5g, \u221ah\na \\ b"), "50 µg, √h\na \\ b");
    assert_eq!(unescape(r"\q \x4 \"), r"\q \x4 \");
}
