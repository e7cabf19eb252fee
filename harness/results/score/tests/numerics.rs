//! Numerics versions that differ.

use octant_score::numerics::{NUMERICS, differs};

#[test]
fn another_version_is_told_and_the_own_is_not() {
    assert_eq!(differs(Some(NUMERICS)), None);
    let told = differs(Some(NUMERICS + 6)).unwrap();
    assert!(told.contains(&format!("version {}", NUMERICS + 6)), "{told}");
    assert!(told.contains(&format!("has numerics version {NUMERICS}")), "{told}");
    assert!(told.contains("verdicts can be compared, bits can't"), "{told}");
    assert!(differs(None).unwrap().contains("from before there was one"));
}
