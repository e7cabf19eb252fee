//! Instruments by grade for `octant new`: values of published data sheets and tables, as keys of a scenario.

use clap::ValueEnum;

/// Grade of an instrument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum InstrumentGrade {
    /// Laser gyros, the reference instrument of the method's paper.
    #[value(name = "table-1")]
    Table1,
    /// Laser gyros, navigation grade: Honeywell HG9900.
    NavigationLaser,
    /// Fibre-optic gyros, navigation grade: the inertial grade of Yazdi, Ayazi and Najafi.
    NavigationFibreOptic,
    /// Fibre-optic gyros, tactical grade: Northrop Grumman LN-200.
    TacticalFibreOptic,
    /// MEMS gyros, tactical grade: Sensonor STIM300.
    TacticalMems,
}

/// Data of a grade.
#[derive(Debug)]
pub(crate) struct GradeSheet {
    /// Source of the values.
    pub(crate) source: &'static str,
    /// Limits of the description, in lines.
    pub(crate) limits: &'static [&'static str],
    /// Keys of `[imu]`, with their values as TOML and the meaning of each.
    pub(crate) imu: &'static [(&'static str, &'static str, &'static str)],
    /// Keys of `[procedure.calibration.prior]`, with their values as TOML.
    pub(crate) prior: &'static [(&'static str, &'static str)],
}

const REST: &str = "Keys that the source doesn't tell keep the values of table-1.";
const FLICKER: &str = "Bias instability (1/f noise) is left out: the model has constant biases and white noise, \
                       and further processes in [imu.extensions].";

impl InstrumentGrade {
    /// Data of this grade.
    pub(crate) fn sheet(self) -> &'static GradeSheet {
        match self {
            Self::Table1 => &TABLE_1,
            Self::NavigationLaser => &NAVIGATION_LASER,
            Self::NavigationFibreOptic => &NAVIGATION_FIBRE_OPTIC,
            Self::TacticalFibreOptic => &TACTICAL_FIBRE_OPTIC,
            Self::TacticalMems => &TACTICAL_MEMS,
        }
    }
}

static TABLE_1: GradeSheet = GradeSheet {
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
    prior: &[],
};

static NAVIGATION_LASER: GradeSheet = GradeSheet {
    source: "Honeywell, HG9900 inertial measurement unit, brochure N61-1638-000-000, 1 sigma",
    limits: &[REST, FLICKER],
    imu: &[
        ("gyro_bias", r#"{ normal = "0.0035 deg/h" }"#, "bias, 1 sigma"),
        ("gyro_scale", r#"{ normal = "5 ppm" }"#, "scale factors, 1 sigma"),
        ("angle_random_walk", r#""0.002 deg/sqrt(h)""#, "white noise of the gyros"),
        ("accel_bias", r#"{ normal = "25 ug" }"#, "bias, 1 sigma"),
        ("accel_scale", r#"{ normal = "100 ppm" }"#, "scale factors, 1 sigma"),
    ],
    prior: &[
        ("gyro_bias", r#""0.0035 deg/h""#),
        ("gyro_scale", r#""5 ppm""#),
        ("accel_bias", r#""25 ug""#),
        ("accel_scale", r#""100 ppm""#),
    ],
};

static NAVIGATION_FIBRE_OPTIC: GradeSheet = GradeSheet {
    source: "inertial grade of gyros in Yazdi, Ayazi and Najafi, Micromachined inertial sensors, \
             Proceedings of the IEEE 86 (1998), at its limits",
    limits: &[
        "It is a class, not a product, and says nothing of accelerometers: they are those of table-1.",
        REST,
        FLICKER,
    ],
    imu: &[
        ("gyro_bias", r#"{ normal = "0.01 deg/h" }"#, "bias, 1 sigma"),
        ("gyro_scale", r#"{ normal = "10 ppm" }"#, "scale factors, 1 sigma"),
        ("angle_random_walk", r#""0.001 deg/sqrt(h)""#, "white noise of the gyros"),
    ],
    prior: &[("gyro_bias", r#""0.01 deg/h""#), ("gyro_scale", r#""10 ppm""#)],
};

static TACTICAL_FIBRE_OPTIC: GradeSheet = GradeSheet {
    source: "Northrop Grumman, LN-200 inertial measurement unit, data sheet, 1 sigma",
    limits: &[REST, FLICKER],
    imu: &[
        ("gyro_bias", r#"{ normal = "1 deg/h" }"#, "bias repeatability, 1 sigma"),
        ("gyro_scale", r#"{ normal = "100 ppm" }"#, "scale factors, 1 sigma"),
        ("angle_random_walk", r#""0.07 deg/sqrt(h)""#, "white noise of the gyros"),
        ("accel_bias", r#"{ normal = "200 ug" }"#, "bias repeatability, 1 sigma"),
        ("accel_scale", r#"{ normal = "300 ppm" }"#, "scale factors, 1 sigma"),
        ("velocity_random_walk", r#""0.03 m/s/sqrt(h)""#, "white noise of the accelerometers"),
    ],
    prior: &[
        ("gyro_bias", r#""1 deg/h""#),
        ("gyro_scale", r#""100 ppm""#),
        ("accel_bias", r#""200 ug""#),
        ("accel_scale", r#""300 ppm""#),
    ],
};

static TACTICAL_MEMS: GradeSheet = GradeSheet {
    source: "Sensonor, STIM300 inertial measurement unit, data sheet TS1524 r9, accelerometers of 10 g",
    limits: &[
        "The gyro bias is its rms over static temperatures, and the bias per acceleration is that with \
         compensation.",
        REST,
        FLICKER,
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
