//! Tokens that link a description to the library.

use octant_fmu::c::{ServedStandard, fnv_1a, token};
use octant_fmu::calibrator::table::MODEL;
use octant_fmu::table::Model;

#[test]
fn the_fingerprint_is_the_published_one() {
    // Test vectors of FNV: the empty text, and "foobar".
    assert_eq!(fnv_1a(b""), 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d);
    assert_eq!(fnv_1a(b"foobar"), 0x343e_1662_793c_64bf_6f0d_3597_ba44_6f18);
}

#[test]
fn each_standard_and_each_table_has_its_own() {
    let [two, three] = [ServedStandard::Fmi2, ServedStandard::Fmi3].map(|of| token(&MODEL, of));
    assert_ne!(two, three);
    assert_eq!(two.len(), 38);
    let other = Model { variables: &MODEL.variables[1..], ..MODEL };
    assert_ne!(token(&other, ServedStandard::Fmi2), two);
}
