//! Instruments by grade, for `imu.model` and `octant new`: values of published data sheets and tables, as
//! keys of a scenario.

/// Data of a grade.
#[derive(Debug)]
pub struct GradeSheet {
    /// Name in `imu.model`.
    pub name: &'static str,
    /// Source of the values.
    pub source: &'static str,
    /// Limits of the description, in lines.
    pub limits: &'static [&'static str],
    /// Keys of `[imu]`, with their values as TOML and the meaning of each.
    pub imu: &'static [(&'static str, &'static str, &'static str)],
    /// Reason why `octant new` writes the keys of bias instability as comments, in lines; empty where it
    /// writes none.
    pub without_flicker: &'static [&'static str],
    /// Keys of `[procedure.calibration.prior]`, with their values as TOML.
    pub prior: &'static [(&'static str, &'static str)],
}

const REST: &str = "Keys that the source doesn't tell keep the values of table-1.";
const NO_FLICKER: &str =
    "The source gives no coefficient of bias instability (1/f noise): it stays zero.";

/// End of the names of the keys of bias instability.
pub const FLICKER: &str = "_bias_instability";

/// All grades, in the order of `imu.model`.
pub static GRADES: [&GradeSheet; 5] =
    [&TABLE_1, &NAVIGATION_LASER, &NAVIGATION_FIBRE_OPTIC, &TACTICAL_FIBRE_OPTIC, &TACTICAL_MEMS];

impl GradeSheet {
    /// Returns the grade of a name; `None` for an unknown one.
    #[must_use]
    pub fn of(name: &str) -> Option<&'static Self> {
        GRADES.into_iter().find(|sheet| sheet.name == name)
    }
}

static TABLE_1: GradeSheet = GradeSheet {
    name: "table-1",
    source: "Zheng, Han and Zheng (2015), Table 1",
    limits: &["The table has no bias instability."],
    imu: &[
        ("gyro_bias", r#"{ normal = "0.005 deg/h" }"#, "constant biases, 1 sigma"),
        ("gyro_scale", r#"{ uniform = "30 ppm" }"#, "scale factors, within plus and minus"),
        ("gyro_misalignment", r#"{ uniform = "40 arcsec" }"#, "misalignments"),
        ("g_dependent", r#"{ normal = "0.0005 deg/h/g" }"#, "bias per acceleration"),
        ("angle_random_walk", r#""0.0007 deg/sqrt(h)""#, "white noise of the gyros"),
        ("accel_bias", r#"{ normal = "100 ug" }"#, "constant biases, 1 sigma"),
        ("accel_scale", r#"{ uniform = "30 ppm" }"#, "scale factors, within plus and minus"),
        ("accel_misalignment", r#"{ uniform = "40 arcsec" }"#, "misalignments"),
        ("velocity_random_walk", r#""50 ug/sqrt(Hz)""#, "white noise of the accelerometers"),
    ],
    without_flicker: &[],
    prior: &[],
};

static NAVIGATION_LASER: GradeSheet = GradeSheet {
    name: "navigation-laser",
    source: "Honeywell, HG9900 inertial measurement unit, brochure N61-1638-000-000, 1 sigma",
    limits: &[REST, NO_FLICKER],
    imu: &[
        ("gyro_bias", r#"{ normal = "0.0035 deg/h" }"#, "bias, 1 sigma"),
        ("gyro_scale", r#"{ normal = "5 ppm" }"#, "scale factors, 1 sigma"),
        ("angle_random_walk", r#""0.002 deg/sqrt(h)""#, "white noise of the gyros"),
        ("accel_bias", r#"{ normal = "25 ug" }"#, "bias, 1 sigma"),
        ("accel_scale", r#"{ normal = "100 ppm" }"#, "scale factors, 1 sigma"),
    ],
    without_flicker: &[],
    prior: &[
        ("gyro_bias", r#""0.0035 deg/h""#),
        ("gyro_scale", r#""5 ppm""#),
        ("accel_bias", r#""25 ug""#),
        ("accel_scale", r#""100 ppm""#),
    ],
};

static NAVIGATION_FIBRE_OPTIC: GradeSheet = GradeSheet {
    name: "navigation-fibre-optic",
    source: "inertial grade of gyros in Yazdi, Ayazi and Najafi, Micromachined inertial sensors, \
             Proceedings of the IEEE 86 (1998), at its limits",
    limits: &[
        "It is a class, not a product, and says nothing of accelerometers: they are those of table-1.",
        "Its bias drift is the peak-to-peak value of a slow function, no coefficient of bias instability.",
        REST,
    ],
    imu: &[
        ("gyro_bias", r#"{ normal = "0.01 deg/h" }"#, "bias, 1 sigma"),
        ("gyro_scale", r#"{ normal = "10 ppm" }"#, "scale factors, 1 sigma"),
        ("angle_random_walk", r#""0.001 deg/sqrt(h)""#, "white noise of the gyros"),
    ],
    without_flicker: &[],
    prior: &[("gyro_bias", r#""0.01 deg/h""#), ("gyro_scale", r#""10 ppm""#)],
};

static TACTICAL_FIBRE_OPTIC: GradeSheet = GradeSheet {
    name: "tactical-fibre-optic",
    source: "Northrop Grumman, LN-200 inertial measurement unit, data sheet, 1 sigma",
    limits: &[REST, NO_FLICKER],
    imu: &[
        ("gyro_bias", r#"{ normal = "1 deg/h" }"#, "bias repeatability, 1 sigma"),
        ("gyro_scale", r#"{ normal = "100 ppm" }"#, "scale factors, 1 sigma"),
        ("angle_random_walk", r#""0.07 deg/sqrt(h)""#, "white noise of the gyros"),
        ("accel_bias", r#"{ normal = "200 ug" }"#, "bias repeatability, 1 sigma"),
        ("accel_scale", r#"{ normal = "300 ppm" }"#, "scale factors, 1 sigma"),
        ("velocity_random_walk", r#""0.03 m/s/sqrt(h)""#, "white noise of the accelerometers"),
    ],
    without_flicker: &[],
    prior: &[
        ("gyro_bias", r#""1 deg/h""#),
        ("gyro_scale", r#""100 ppm""#),
        ("accel_bias", r#""200 ug""#),
        ("accel_scale", r#""300 ppm""#),
    ],
};

static TACTICAL_MEMS: GradeSheet = GradeSheet {
    name: "tactical-mems",
    source: "Sensonor, STIM300 inertial measurement unit, data sheet TS1524 r9, accelerometers of 10 g",
    limits: &[
        "The gyro bias is its rms over static temperatures, and the bias per acceleration is that with \
         compensation.",
        "Its bias instability, 0.5 deg/h and 0.05 mg, is the lowest point of the Allan deviation with the \
         white noise in it (Sensonor, questions on the STIM series): the coefficient is that over 0.664.",
        REST,
    ],
    imu: &[
        ("gyro_bias", r#"{ normal = "5 deg/h" }"#, "bias over temperature, rms"),
        ("gyro_scale", r#"{ normal = "500 ppm" }"#, "scale factor accuracy"),
        ("gyro_misalignment", r#"{ normal = "1 mrad" }"#, "misalignments"),
        ("g_dependent", r#"{ normal = "1 deg/h/g" }"#, "bias per acceleration"),
        ("angle_random_walk", r#""0.15 deg/sqrt(h)""#, "white noise of the gyros"),
        ("accel_bias", r#"{ normal = "750 ug" }"#, "bias from switching on to switching on"),
        ("accel_scale", r#"{ normal = "300 ppm" }"#, "scale factor accuracy"),
        ("accel_misalignment", r#"{ normal = "1 mrad" }"#, "misalignments"),
        ("velocity_random_walk", r#""0.06 m/s/sqrt(h)""#, "white noise of the accelerometers"),
        ("extensions.gyro_bias_instability", r#""0.753 deg/h""#, "0.5 deg/h over 0.664"),
        ("extensions.accel_bias_instability", r#""75.3 ug""#, "0.05 mg over 0.664"),
    ],
    without_flicker: &[
        "Bias instability (1/f noise) of the data sheet, left out here: the filter has no state for it, so that",
        "its standard deviations would be too small by an order of magnitude, and the core refuses nearly every",
        "such calibration. Take the # before the two keys away to see it.",
    ],
    prior: &[
        ("gyro_bias", r#""5 deg/h""#),
        ("gyro_scale", r#""500 ppm""#),
        ("gyro_misalignment", r#""1 mrad""#),
        ("accel_bias", r#""750 ug""#),
        ("accel_scale", r#""300 ppm""#),
        ("accel_misalignment", r#""1 mrad""#),
    ],
};
