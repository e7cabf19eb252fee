//! Measures of a comparison of methods: the largest errors of a navigation.

use super::floor::MaximumFloor;
use super::summary::NavigationScore;
use serde::{Deserialize, Serialize};

/// Largest errors of one navigation, arcmin and m/s; a mark that the run did not reach is null.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Maxima {
    /// Largest latitude error to 24 h.
    pub latitude_24h: Option<f64>,
    /// Largest longitude error to 24 h.
    pub longitude_24h: Option<f64>,
    /// Largest latitude error to 72 h.
    pub latitude_72h: Option<f64>,
    /// Largest longitude error to 72 h.
    pub longitude_72h: Option<f64>,
    /// Largest heading error of the case over the navigation.
    #[serde(default)]
    pub heading: Option<f64>,
    /// Largest pitch error of the case over the navigation.
    #[serde(default)]
    pub pitch: Option<f64>,
    /// Largest roll error of the case over the navigation.
    #[serde(default)]
    pub roll: Option<f64>,
    /// Largest error of the velocity to the north over the navigation, m/s.
    #[serde(default)]
    pub velocity_north_mps: Option<f64>,
    /// Largest error of the velocity to the east over the navigation, m/s.
    #[serde(default)]
    pub velocity_east_mps: Option<f64>,
}

impl Maxima {
    /// Maxima of a scored navigation.
    #[must_use]
    pub fn of(navigation: &NavigationScore) -> Self {
        let mark = |name: &str| navigation.marks.get(name);
        Self {
            latitude_24h: mark("24h").map(|m| m.latitude_max_arcmin),
            longitude_24h: mark("24h").map(|m| m.longitude_max_arcmin),
            latitude_72h: mark("72h").map(|m| m.latitude_max_arcmin),
            longitude_72h: mark("72h").map(|m| m.longitude_max_arcmin),
            heading: navigation.heading_error_arcmin.map(|e| e.max),
            pitch: navigation.pitch_error_arcmin.map(|e| e.max),
            roll: navigation.roll_error_arcmin.map(|e| e.max),
            velocity_north_mps: navigation.velocity_north_error_mps.map(|e| e.max),
            velocity_east_mps: navigation.velocity_east_error_mps.map(|e| e.max),
        }
    }

    /// Maximum of a measure.
    #[must_use]
    pub const fn get(&self, measure: Measure) -> Option<f64> {
        match measure {
            Measure::Latitude24h => self.latitude_24h,
            Measure::Longitude24h => self.longitude_24h,
            Measure::Latitude72h => self.latitude_72h,
            Measure::Longitude72h => self.longitude_72h,
            Measure::Heading => self.heading,
            Measure::Pitch => self.pitch,
            Measure::Roll => self.roll,
            Measure::VelocityNorth => self.velocity_north_mps,
            Measure::VelocityEast => self.velocity_east_mps,
        }
    }
}

/// Measure of a comparison: the largest error of a run, of the position up to a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// Largest latitude error to 24 h.
    #[serde(rename = "latitude_24h")]
    Latitude24h,
    /// Largest longitude error to 24 h.
    #[serde(rename = "longitude_24h")]
    Longitude24h,
    /// Largest latitude error to 72 h.
    #[serde(rename = "latitude_72h")]
    Latitude72h,
    /// Largest longitude error to 72 h.
    #[serde(rename = "longitude_72h")]
    Longitude72h,
    /// Largest heading error.
    Heading,
    /// Largest pitch error.
    Pitch,
    /// Largest roll error.
    Roll,
    /// Largest error of the velocity to the north.
    VelocityNorth,
    /// Largest error of the velocity to the east.
    VelocityEast,
}

impl Measure {
    /// All measures.
    pub const ALL: [Self; 9] = [
        Self::Latitude24h,
        Self::Longitude24h,
        Self::Latitude72h,
        Self::Longitude72h,
        Self::Heading,
        Self::Pitch,
        Self::Roll,
        Self::VelocityNorth,
        Self::VelocityEast,
    ];

    /// Name of the measure.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Latitude24h => "latitude to 24 h",
            Self::Longitude24h => "longitude to 24 h",
            Self::Latitude72h => "latitude to 72 h",
            Self::Longitude72h => "longitude to 72 h",
            Self::Heading => "heading",
            Self::Pitch => "pitch",
            Self::Roll => "roll",
            Self::VelocityNorth => "velocity north",
            Self::VelocityEast => "velocity east",
        }
    }

    /// Name of the error, as in [`NavigationScore::errors`].
    #[must_use]
    pub const fn error(self) -> &'static str {
        match self {
            Self::Latitude24h | Self::Latitude72h => "latitude",
            Self::Longitude24h | Self::Longitude72h => "longitude",
            Self::Heading => "heading",
            Self::Pitch => "pitch",
            Self::Roll => "roll",
            Self::VelocityNorth => "north",
            Self::VelocityEast => "east",
        }
    }

    /// True for a longitude error.
    #[must_use]
    pub const fn is_longitude(self) -> bool {
        matches!(self, Self::Longitude24h | Self::Longitude72h)
    }

    /// Unit of the values of a comparison.
    pub(super) const fn unit(self) -> &'static str {
        match self {
            Self::VelocityNorth | Self::VelocityEast => "m/s",
            _ => "arcmin",
        }
    }

    /// Value of the measure in a floor.
    pub(super) fn floor(self, floor: &MaximumFloor) -> Option<f64> {
        match self.error() {
            "latitude" => Some(floor.latitude_arcmin),
            "longitude" => Some(floor.longitude_arcmin),
            error => floor.solution.of(error),
        }
    }

    /// Mark of a position error, h; `None`: over the whole navigation.
    pub(super) const fn hours(self) -> Option<f64> {
        match self {
            Self::Latitude24h | Self::Longitude24h => Some(24.0),
            Self::Latitude72h | Self::Longitude72h => Some(72.0),
            _ => None,
        }
    }
}
