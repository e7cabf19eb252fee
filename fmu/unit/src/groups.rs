//! The thirty calibrated parameters as seven variables, one for each group, under a common prefix.

/// All parameter groups under one prefix: true values, estimates, their σ or start values, with text
/// before and after that of the group.
macro_rules! groups {
    ($make:ident, $prefix:literal, $before:literal, $after:literal) => {
        $crate::groups::groups! { @ $make $prefix $before $after
            "gyro_bias" 3 GYRO_BIAS, 0.005 * DEG_PER_HOUR,
                "constant gyro bias; body axes x, y, z.";
            "gyro_scale" 3 SCALE_ERROR, 30.0 * PPM,
                "gyro scale factor error, the diagonal of M_g; body axes x, y, z.";
            "gyro_misalignment" 6 SMALL_ANGLE, 40.0 * ARCSEC,
                "gyro misalignment, the other entries of M_g: xy, xz, yx, yz, zx, zy (row, column).";
            "g_dependent" 9 G_DEPENDENT, 5e-4 * DEG_PER_HOUR_PER_G,
                "g-dependent gyro bias, the matrix G by rows: xx, xy, xz, yx, yy, yz, zx, zy, zz; \
                 it takes specific force in body axes into a gyro error.";
            "accel_bias" 3 ACCEL_BIAS, 100.0 * MICRO_G,
                "constant accelerometer bias; body axes x, y, z.";
            "accel_scale" 3 SCALE_ERROR, 30.0 * PPM,
                "accelerometer scale factor error, the diagonal of M_a; body axes x, y, z.";
            "accel_misalignment" 3 SMALL_ANGLE, 40.0 * ARCSEC,
                "accelerometer misalignment, the lower triangle of M_a: yx, zx, zy (row, column).";
        }
    };
    (@ $make:ident $prefix:literal $before:literal $after:literal
        $($group:literal $elements:literal $quantity:ident, $nominal:expr, $text:literal;)*) => {{
        #[allow(clippy::wildcard_imports, reason = "the units of the rows")]
        use octant_earth::units::*;
        $crate::table::variables! {$(
            $make(concat!($prefix, ".", $group), $crate::table::ElementType::Real)
                elements($elements) of(&$crate::quantities::$quantity) nominal($nominal):
                concat!($before, $text, $after);
        )*}
    }};
}
pub(crate) use groups;
