//! Conversion of other programs' recordings to samples: the mapping of columns and fields.

use std::path::PathBuf;

/// Quantity of a file's inertial columns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RecordedQuantity {
    /// Angular rate, rad/s, and specific force, m/s², taken as constant over the interval that ends at
    /// the stamp.
    #[default]
    Rates,
    /// Angle increments, rad, and velocity increments, m/s, over the interval that ends at the stamp.
    Increments,
}

/// Largest number of samples that a row may be split into.
pub const SPLIT_MAX: u32 = 1000;

/// A column of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RecordedColumn {
    /// Number, from 1.
    Number(usize),
    /// Name in the header line.
    Name(String),
}

/// Column of the time stamp of rows that have none: they follow each other at the nominal rate.
pub(crate) const NO_TIME: &str = "none";

/// A column with its conversion to SI: `(value − offset) · scale`.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisColumn {
    /// Column. The order of the axes assigns columns to body axes.
    pub column: RecordedColumn,
    /// Reading of the instrument at zero, in units of the file.
    pub offset: f64,
    /// SI units per unit of the file; negative reverses the axis.
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
    /// Power of ten from this unit to a nanosecond.
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
    /// Column.
    pub column: RecordedColumn,
    /// Unit.
    pub unit: TimeUnit,
}

/// Unit of a temperature.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TemperatureUnit {
    /// Degrees Celsius.
    #[default]
    Celsius,
    /// Kelvin.
    Kelvin,
}

impl TemperatureUnit {
    /// Name, as in a scenario.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Celsius => "degC",
            Self::Kelvin => "K",
        }
    }

    /// Converts a value to degrees Celsius.
    #[must_use]
    pub fn celsius(self, value: f64) -> f64 {
        match self {
            Self::Celsius => value,
            Self::Kelvin => value - 273.15,
        }
    }
}

/// The column of the instrument's temperature.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TemperatureColumn {
    /// Column, in the file of the gyros.
    pub column: RecordedColumn,
    /// Unit.
    pub unit: TemperatureUnit,
}

/// The field of the instrument's temperature.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TemperatureField {
    /// Path of the field.
    pub path: String,
    /// Unit.
    pub unit: TemperatureUnit,
}

/// Delimiter between two fields.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Delimiter {
    /// Any run of blanks and tabs; leading ones are ignored.
    #[default]
    Blanks,
    /// One ASCII character. Blanks around a field are ignored; a field may be quoted.
    Character(u8),
}

/// Text files of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TextFiles {
    /// Gyros and accelerometers in one file.
    One(PathBuf),
    /// Two files with the same stamps.
    Split {
        /// File of the gyros, and of the gimbals.
        gyro: PathBuf,
        /// File of the accelerometers.
        accelerometer: PathBuf,
    },
}

impl TextFiles {
    /// All files.
    pub fn all(&self) -> impl Iterator<Item = &PathBuf> {
        match self {
            Self::One(file) => [Some(file), None],
            Self::Split { gyro, accelerometer } => [Some(gyro), Some(accelerometer)],
        }
        .into_iter()
        .flatten()
    }
}

/// Gimbal angles, if the file has them.
#[derive(Clone, Debug, PartialEq)]
pub struct GimbalColumns {
    /// Inner gimbal, rad after scaling.
    pub azimuth: AxisColumn,
    /// Outer gimbal, rad after scaling.
    pub roll: AxisColumn,
}

/// Mapping of text files to samples.
#[derive(Clone, Debug, PartialEq)]
pub struct TextMapping {
    /// Files.
    pub files: TextFiles,
    /// Time; without it the stamps follow from the nominal rate.
    pub time: Option<TimeColumn>,
    /// Gyros of body axes x y z: rad/s (rad, for increments) after scaling.
    pub gyro: [AxisColumn; 3],
    /// Accelerometers of body axes x y z: m/s² (m/s) after scaling.
    pub accelerometer: [AxisColumn; 3],
    /// Quantity of these columns.
    pub quantity: RecordedQuantity,
    /// Nominal rate of the rows, Hz: determines the interval of the first row, and all stamps if there
    /// is no time column.
    pub nominal_rate_hz: f64,
    /// Number of samples made from a row, equal parts of its interval, so that counts can hold faster
    /// rates. Gimbal angles are those of the row.
    pub split: u32,
    /// Delimiter.
    pub delimiter: Delimiter,
    /// Beginning of lines that are skipped; empty: none.
    pub comment: String,
    /// Number of lines at the start of a file that are skipped, whatever they contain.
    pub skip_lines: usize,
    /// True if the first line after those, in every file, names the columns.
    pub header: bool,
    /// Gimbal angles.
    pub gimbal: Option<GimbalColumns>,
    /// Temperature, if the file has one.
    pub temperature: Option<TemperatureColumn>,
}

/// A field of a message with its conversion to SI.
#[derive(Clone, Debug, PartialEq)]
pub struct MappedField {
    /// Path of the field: `angular_velocity.x`, `axes[2].rate`.
    pub path: String,
    /// Reading of the instrument at zero, in units of the field.
    pub offset: f64,
    /// SI units per unit of the field, `(value − offset) · scale`; negative reverses the axis.
    pub scale: f64,
}

impl MappedField {
    fn si(path: &str) -> Self {
        Self { path: path.into(), offset: 0.0, scale: 1.0 }
    }
}

/// Stamp of a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MappedStamp {
    /// Log time of the message.
    LogTime,
    /// Publish time of the message.
    PublishTime,
    /// Fields of the message.
    Field {
        /// Path of a number. Whole numbers are exact; others are rounded to f64.
        path: String,
        /// Unit.
        unit: TimeUnit,
        /// Path of whole nanoseconds to add, as in stamps of ROS.
        nanoseconds: Option<String>,
    },
}

/// Mapping of the messages of a foreign MCAP file to samples. Encodings: JSON, and CDR with a `ros2msg`
/// schema.
#[derive(Clone, Debug, PartialEq)]
pub struct McapMapping {
    /// Topic of the inertial messages.
    pub topic: String,
    /// Topic of the accelerometers, where it is another one; `topic` is that of the gyros then.
    pub accelerometer_topic: Option<String>,
    /// Gyros x y z of the body: rad/s (rad, for increments) after scaling.
    pub gyro: [MappedField; 3],
    /// Accelerometers x y z of the body: m/s² (m/s) after scaling.
    pub accelerometer: [MappedField; 3],
    /// Quantity of these fields.
    pub quantity: RecordedQuantity,
    /// Stamps.
    pub stamp: MappedStamp,
    /// Nominal rate of the messages, Hz: determines the interval of the first.
    pub nominal_rate_hz: f64,
    /// Number of samples made from a message, equal parts of its interval, so that counts can hold
    /// faster rates.
    pub split: u32,
    /// Gimbal azimuth and roll, rad after scaling, if the messages have them.
    pub gimbal: Option<[MappedField; 2]>,
    /// Temperature, if the messages have one.
    pub temperature: Option<TemperatureField>,
}

impl McapMapping {
    /// Mapping of `sensor_msgs/msg/Imu`, with the stamps of its header.
    #[must_use]
    pub fn ros_imu(topic: &str, nominal_rate_hz: f64) -> Self {
        let axes =
            |name: &str| ["x", "y", "z"].map(|axis| MappedField::si(&format!("{name}.{axis}")));
        Self {
            topic: topic.into(),
            accelerometer_topic: None,
            gyro: axes("angular_velocity"),
            accelerometer: axes("linear_acceleration"),
            quantity: RecordedQuantity::Rates,
            stamp: MappedStamp::Field {
                path: "header.stamp.sec".into(),
                unit: TimeUnit::Second,
                nanoseconds: Some("header.stamp.nanosec".into()),
            },
            nominal_rate_hz,
            split: 1,
            gimbal: None,
            temperature: None,
        }
    }
}
