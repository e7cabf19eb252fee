//! A real instrument, its clock, and the table under it.

use serde::{Deserialize, Serialize};

/// A real instrument and the table under it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BenchRecord {
    /// Relation of the clocks of instrument and host, where readings have stamps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clock: Option<BenchClock>,
    /// Port and protocol of the instrument.
    pub instrument: String,
    /// The clock relation in words.
    #[serde(rename = "instrument's clock", skip_serializing_if = "Option::is_none")]
    pub instruments_clock: Option<String>,
    /// Counts of readings.
    pub readings: BenchReadings,
    /// Figures of the table, where one is driven.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub table: Option<BenchTable>,
    /// The table's angles in words.
    #[serde(rename = "table's angles", skip_serializing_if = "Option::is_none")]
    pub tables_angles: Option<String>,
    /// The table in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turntable: Option<String>,
}

/// Clock of an instrument against the host's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BenchClock {
    /// First stamp, ns.
    pub first_stamp_ns: u64,
    /// Host time at that stamp, UTC.
    pub first_stamp_utc: Option<String>,
    /// Mean lateness of readings after the earliest, µs.
    pub late_mean_us: f64,
    /// Standard deviation of the lateness, µs.
    pub late_sigma_us: f64,
    /// Relative rate by which the host is fast; null with too few stamps.
    pub skew_ppm: Option<f64>,
    /// Time between the first and the last stamp, s.
    pub span_s: f64,
    /// Number of stamps accepted.
    pub stamps: u64,
    /// Number of stamps that weren't after the one before.
    pub stamps_behind: u64,
}

/// Counts of an instrument's readings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BenchReadings {
    /// Readings that weren't after the one before.
    pub behind: u64,
    /// Readings at irregular intervals.
    pub irregular: u64,
    /// Missing readings.
    pub missing: u64,
    /// Samples delivered.
    pub samples: u64,
}

/// A table that follows the core.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BenchTable {
    /// Angles that samples were given.
    pub angles: BenchAngles,
    /// Limits of the azimuth.
    pub azimuth: BenchAxis,
    /// Number of set points sent.
    pub commands: u64,
    /// Language of the controller.
    pub dialect: String,
    /// Time after which the guard stops the table, s.
    pub guard_s: Option<f64>,
    /// Number of looks at the table.
    pub looks: u64,
    /// Port of the controller.
    pub port: String,
    /// Limits of the roll.
    pub roll: BenchAxis,
    /// Other runs at the table, where there are some.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shared: Option<BenchShared>,
    /// Reason of an emergency stop.
    pub stopped: Option<String>,
    /// Time after which the controller stops the table, s.
    pub watchdog_s: Option<f64>,
}

/// A table under several units.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BenchShared {
    /// True if another run drove the table.
    pub driven_by_another: bool,
    /// How the others ended that got the table's angles from this run, in the order in which they came.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub others: Vec<String>,
    /// Number of runs, this one included.
    pub units: usize,
}

/// Limits of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BenchAxis {
    /// Acceleration, deg/s².
    pub acceleration_degps2: f64,
    /// Greatest angle, deg.
    pub greatest_deg: f64,
    /// Least angle, deg.
    pub least_deg: f64,
    /// Rate, deg/s.
    pub rate_degps: f64,
}

/// Angles of a table in samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BenchAngles {
    /// Largest time between a sample and the nearest look, ms.
    pub age_max_ms: f64,
    /// Mean of that time, ms.
    pub age_mean_ms: f64,
    /// Number of samples with angles.
    pub samples: u64,
    /// Number of samples without angles.
    pub samples_without: u64,
    /// Bound of the error of a look's time, ms.
    pub time_within_ms: f64,
}
