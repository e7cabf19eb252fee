//! Indices of the elements of arrays.

use octant_cosim::system::{index_of, position};

#[test]
fn elements_are_counted_from_1_rows_first() {
    assert_eq!(position("2", &[3]), Some(1));
    assert_eq!(position("2, 3", &[2, 3]), Some(5));
    for (index, sizes) in [("0", &[3][..]), ("4", &[3]), ("1", &[2, 2]), ("x", &[3]), ("", &[])] {
        assert_eq!(position(index, sizes), None, "{index}");
    }
    for element in 0..6 {
        assert_eq!(position(&index_of(&[2, 3], element), &[2, 3]), Some(element));
    }
}
