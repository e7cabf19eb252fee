//! How recordings of others become samples: which columns and fields are what.

use std::path::PathBuf;

/// What a file's inertial columns hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quantity {
    /// Angular rate, rad/s, and specific force, m/s², taken as constant over the interval that ends
    /// at the stamp.
    #[default]
    Rates,
    /// Angle increments, rad, and velocity increments, m/s, over that interval.
    Increments,
}

/// Most samples that a row may be split into.
pub const SPLIT_MAX: u32 = 1000;

/// A column of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Column {
    /// Its number, from 1.
    Number(usize),
    /// Its name in the header line.
    Name(String),
}

/// A column and what turns it into SI: `(value − offset) · scale`.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The column. Which column serves which body axis is the order of the axes.
    pub column: Column,
    /// What the instrument shows at zero, in units of the file.
    pub offset: f64,
    /// SI units per unit of the file; negative turns the axis around.
    pub scale: f64,
}

/// Unit of the time column.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeUnit {
    /// Seconds.
    #[default]
    Second,
    /// Milliseconds.
    Millisecond,
    /// Microseconds.
    Microsecond,
    /// Nanoseconds.
    Nanosecond,
}

impl TimeUnit {
    /// Powers of ten from this unit to a nanosecond.
    #[must_use]
    pub const fn nanosecond_exponent(self) -> i32 {
        match self {
            Self::Second => 9,
            Self::Millisecond => 6,
            Self::Microsecond => 3,
            Self::Nanosecond => 0,
        }
    }
}

/// The time column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TimeColumn {
    /// The column.
    pub column: Column,
    /// Its unit.
    pub unit: TimeUnit,
}

/// What stands between two fields.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Delimiter {
    /// Any run of blanks and tabs; leading ones don't count.
    #[default]
    Blanks,
    /// One ASCII character. Blanks around a field don't count; a field may be quoted.
    Character(u8),
}

/// The files.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TextFiles {
    /// Gyros and accelerometers in one file.
    One(PathBuf),
    /// In two files of the same stamps.
    Split {
        /// File of the gyros, and of the gimbals.
        gyro: PathBuf,
        /// File of the accelerometers.
        accelerometer: PathBuf,
    },
}

impl TextFiles {
    /// Each file.
    pub fn all(&self) -> impl Iterator<Item = &PathBuf> {
        match self {
            Self::One(file) => [Some(file), None],
            Self::Split { gyro, accelerometer } => [Some(gyro), Some(accelerometer)],
        }
        .into_iter()
        .flatten()
    }
}

/// Gimbal angles, where the file has them.
#[derive(Clone, Debug, PartialEq)]
pub struct GimbalColumns {
    /// Inner gimbal, rad after scaling.
    pub azimuth: Axis,
    /// Outer gimbal, rad after scaling.
    pub roll: Axis,
}

/// How text becomes samples.
#[derive(Clone, Debug, PartialEq)]
pub struct TextMapping {
    /// The files.
    pub files: TextFiles,
    /// Time; without it the stamps follow from the nominal rate.
    pub time: Option<TimeColumn>,
    /// Gyros of body axes x y z: rad/s (rad, for increments) after scaling.
    pub gyro: [Axis; 3],
    /// Accelerometers of body axes x y z: m/s² (m/s) after scaling.
    pub accelerometer: [Axis; 3],
    /// What these columns are.
    pub quantity: Quantity,
    /// Nominal rate of the rows, Hz: gives the interval of the first, and all stamps where there is
    /// no time column.
    pub nominal_rate_hz: f64,
    /// Samples that a row becomes, equal parts of its interval: counts then hold faster rates.
    /// Gimbal angles are those of the row.
    pub split: u32,
    /// Delimiter.
    pub delimiter: Delimiter,
    /// Lines that begin with this are passed over; empty: none.
    pub comment: String,
    /// Lines at the start of a file that are passed over whatever they hold.
    pub skip_lines: usize,
    /// Gimbal angles.
    pub gimbal: Option<GimbalColumns>,
}

/// A field of a message and what turns it into SI.
#[derive(Clone, Debug, PartialEq)]
pub struct MappedField {
    /// Path of the field: `angular_velocity.x`, `axes[2].rate`.
    pub path: String,
    /// What the instrument shows at zero, in units of the field.
    pub offset: f64,
    /// SI units per unit of the field, `(value − offset) · scale`; negative turns the axis around.
    pub scale: f64,
}

impl MappedField {
    fn si(path: &str) -> Self {
        Self { path: path.into(), offset: 0.0, scale: 1.0 }
    }
}

/// Where the stamp of a message comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MappedStamp {
    /// Log time of the message.
    LogTime,
    /// Publish time of the message.
    PublishTime,
    /// Fields of the message.
    Field {
        /// Path of a number. Whole numbers are exact; others are rounded to what an f64 holds.
        path: String,
        /// Its unit.
        unit: TimeUnit,
        /// Path of whole nanoseconds to add, as stamps of ROS have them.
        nanoseconds: Option<String>,
    },
}

/// How the messages of a foreign MCAP file become samples. Encodings: JSON, and CDR with a
/// `ros2msg` schema.
#[derive(Clone, Debug, PartialEq)]
pub struct McapMapping {
    /// Topic of the inertial messages.
    pub topic: String,
    /// Gyros x y z of the body: rad/s (rad, for increments) after scaling.
    pub gyro: [MappedField; 3],
    /// Accelerometers x y z of the body: m/s² (m/s) after scaling.
    pub accelerometer: [MappedField; 3],
    /// What these fields are.
    pub quantity: Quantity,
    /// Stamps.
    pub stamp: MappedStamp,
    /// Nominal rate of the messages, Hz: gives the interval of the first.
    pub nominal_rate_hz: f64,
    /// Samples that a message becomes, equal parts of its interval: counts then hold faster rates.
    pub split: u32,
    /// Gimbal azimuth and roll, rad after scaling, where the messages have them.
    pub gimbal: Option<[MappedField; 2]>,
}

impl McapMapping {
    /// The mapping of `sensor_msgs/msg/Imu`, stamped by its header.
    #[must_use]
    pub fn ros_imu(topic: &str, nominal_rate_hz: f64) -> Self {
        let axes =
            |name: &str| ["x", "y", "z"].map(|axis| MappedField::si(&format!("{name}.{axis}")));
        Self {
            topic: topic.into(),
            gyro: axes("angular_velocity"),
            accelerometer: axes("linear_acceleration"),
            quantity: Quantity::Rates,
            stamp: MappedStamp::Field {
                path: "header.stamp.sec".into(),
                unit: TimeUnit::Second,
                nanoseconds: Some("header.stamp.nanosec".into()),
            },
            nominal_rate_hz,
            split: 1,
            gimbal: None,
        }
    }
}
