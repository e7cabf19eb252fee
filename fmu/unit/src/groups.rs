//! The thirty calibrated parameters as seven variables, one for each group, under a common prefix.

/// One group: true values, estimates, their σ or start values.
macro_rules! group {
    ($make:ident, $prefix:literal, $group:literal, $elements:literal, $quantity:expr, $nominal:expr, $text:expr) => {
        $crate::table::DeclaredVariable::$make(
            concat!($prefix, ".", $group),
            $crate::table::ElementType::Real,
        )
        .elements($elements)
        .of($quantity)
        .nominal($nominal)
        .described($text)
    };
}
pub(crate) use group;

/// All parameter groups under one prefix, with text before and after that of the group.
macro_rules! groups {
    ($make:ident, $prefix:literal, $before:literal, $after:literal) => {
        [
            $crate::groups::group!(
                $make,
                $prefix,
                "gyro_bias",
                3,
                &$crate::quantities::GYRO_BIAS,
                0.005 * octant_earth::units::DEG_PER_HOUR,
                concat!($before, "constant gyro bias; body axes x, y, z.", $after)
            ),
            $crate::groups::group!(
                $make,
                $prefix,
                "gyro_scale",
                3,
                &$crate::quantities::SCALE_ERROR,
                30.0 * octant_earth::units::PPM,
                concat!(
                    $before,
                    "gyro scale factor error, the diagonal of M_g; body axes x, y, z.",
                    $after
                )
            ),
            $crate::groups::group!(
                $make,
                $prefix,
                "gyro_misalignment",
                6,
                &$crate::quantities::SMALL_ANGLE,
                40.0 * octant_earth::units::ARCSEC,
                concat!(
                    $before,
                    "gyro misalignment, the other entries of M_g: xy, xz, yx, yz, zx, zy (row, \
                     column).",
                    $after
                )
            ),
            $crate::groups::group!(
                $make,
                $prefix,
                "g_dependent",
                9,
                &$crate::quantities::G_DEPENDENT,
                5e-4 * octant_earth::units::DEG_PER_HOUR_PER_G,
                concat!(
                    $before,
                    "g-dependent gyro bias, the matrix G by rows: xx, xy, xz, yx, yy, yz, zx, zy, \
                     zz; it takes specific force in body axes into a gyro error.",
                    $after
                )
            ),
            $crate::groups::group!(
                $make,
                $prefix,
                "accel_bias",
                3,
                &$crate::quantities::ACCEL_BIAS,
                100.0 * octant_earth::units::MICRO_G,
                concat!($before, "constant accelerometer bias; body axes x, y, z.", $after)
            ),
            $crate::groups::group!(
                $make,
                $prefix,
                "accel_scale",
                3,
                &$crate::quantities::SCALE_ERROR,
                30.0 * octant_earth::units::PPM,
                concat!(
                    $before,
                    "accelerometer scale factor error, the diagonal of M_a; body axes x, y, z.",
                    $after
                )
            ),
            $crate::groups::group!(
                $make,
                $prefix,
                "accel_misalignment",
                3,
                &$crate::quantities::SMALL_ANGLE,
                40.0 * octant_earth::units::ARCSEC,
                concat!(
                    $before,
                    "accelerometer misalignment, the lower triangle of M_a: yx, zx, zy (row, \
                     column).",
                    $after
                )
            ),
        ]
    };
}
pub(crate) use groups;
