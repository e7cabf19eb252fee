//! Set points on their way between threads.

use octant_sample::GimbalAngles;
use octant_turntable::{packed, unpacked};
use proptest::prelude::*;

proptest! {
    #[test]
    fn a_set_point_crosses_as_it_is(azimuth: i32, roll: i32) {
        let target = GimbalAngles { azimuth, roll };
        prop_assert_eq!(unpacked(packed(target)), target);
    }
}
