//! Identifiers of C.

use octant_fmu_check::is_c_identifier;

#[test]
fn identifiers_are_those_of_c() {
    for name in ["a", "_", "A_b9"] {
        assert!(is_c_identifier(name), "{name}");
    }
    for name in ["", "9a", "a-b", "a.b", "ä", "int", "a b"] {
        assert!(!is_c_identifier(name), "{name}");
    }
}
