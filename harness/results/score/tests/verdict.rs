//! Paths that lead nowhere in a summary.

use octant_score::verdict::MeasureError;

#[test]
fn names_that_are_left_out_are_counted() {
    let told = |more: usize| {
        let (place, key, there) = ("a".to_owned(), "b".to_owned(), vec!["c".to_owned()]);
        MeasureError::Missing { place, key, there, more }.to_string()
    };
    assert_eq!(told(0), "a has no `b`; it has c");
    assert_eq!(told(3), "a has no `b`; it has c and 3 more");
}
