//! Results of navigation.

use super::heading_output::HeadingOutputScore;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Treatment of the vertical channel during free navigation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum HeightChannel {
    /// The height is held at its known value.
    Held,
    /// The height is damped towards a reference.
    Damped,
    /// The height is free: it diverges, and the horizontal channels with it.
    Free,
}

/// Navigation of one method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NavigationScore {
    /// Duration, h.
    pub duration_h: f64,
    /// Treatment of the vertical channel.
    pub height: HeightChannel,
    /// Latitude error, arcmin; null for headings alone. Longitude and radial error likewise.
    #[serde(default)]
    pub latitude_error_arcmin: Option<ErrorScore>,
    /// Longitude error, arcmin.
    #[serde(default)]
    pub longitude_error_arcmin: Option<ErrorScore>,
    /// Horizontal distance from the true position, nmi.
    #[serde(default)]
    pub radial_error_nmi: Option<RadialScore>,
    /// Heading error of the case, arcmin; null without a true attitude, and where the unit doesn't
    /// tell its attitude. Pitch and roll likewise, and for headings alone.
    #[serde(default)]
    pub heading_error_arcmin: Option<ErrorScore>,
    /// Pitch error of the case, arcmin.
    #[serde(default)]
    pub pitch_error_arcmin: Option<ErrorScore>,
    /// Roll error of the case, arcmin.
    #[serde(default)]
    pub roll_error_arcmin: Option<ErrorScore>,
    /// Error of the velocity over ground to the north, m/s; null without a true velocity, and where
    /// the unit doesn't tell its velocity.
    #[serde(default)]
    pub velocity_north_error_mps: Option<ErrorScore>,
    /// Error of the velocity over ground to the east, m/s.
    #[serde(default)]
    pub velocity_east_error_mps: Option<ErrorScore>,
    /// Window of the slopes; null for runs shorter than a Schuler period.
    pub slope_window: Option<SlopeWindow>,
    /// Scores at 24 h and 72 h, for runs that got there, with the keys "24h" and "72h".
    pub marks: BTreeMap<String, Mark>,
    /// Gaps of a solution that was made elsewhere, and what they leave open; left out without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gaps: Option<Box<GapScore>>,
    /// Output of the heading against a reference that turns: latency, follow-up, transmission; left out without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heading_output: Option<Box<HeadingOutputScore>>,
    /// Rows of time (h), latitude error, longitude error (arcmin): at most 2002, including every
    /// extreme.
    pub series_hours: Vec<[f64; 3]>,
}

impl NavigationScore {
    /// Scores of the errors with a sign, with name and unit: position, attitude, velocity. `None`: the
    /// run doesn't have it.
    #[must_use]
    pub fn errors(&self) -> [(&'static str, &'static str, Option<ErrorScore>); 7] {
        [
            ("latitude", "arcmin", self.latitude_error_arcmin),
            ("longitude", "arcmin", self.longitude_error_arcmin),
            ("heading", "arcmin", self.heading_error_arcmin),
            ("pitch", "arcmin", self.pitch_error_arcmin),
            ("roll", "arcmin", self.roll_error_arcmin),
            ("north", "m/s", self.velocity_north_error_mps),
            ("east", "m/s", self.velocity_east_error_mps),
        ]
    }
}

/// Score of one error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorScore {
    /// Largest magnitude.
    pub max: f64,
    /// √(1/T ∫ x² dt).
    pub rms: f64,
    /// Last value, with its sign.
    pub r#final: f64,
    /// Secular slope per day; null for runs shorter than a Schuler period.
    pub slope_per_day: Option<f64>,
    /// Amplitude of the Schuler oscillation, root mean square over whole Schuler periods; null for runs
    /// shorter than one.
    #[serde(default)]
    pub schuler_amplitude: Option<f64>,
}

/// Score of the radial error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RadialScore {
    /// Largest value.
    pub max: f64,
    /// √(1/T ∫ r² dt): time-RMS, as marine systems state it.
    pub rms: f64,
    /// Last value.
    pub r#final: f64,
    /// Regression of radial error on time through the origin, per hour.
    pub rate_per_h: f64,
}

/// Window of secular slopes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SlopeWindow {
    /// "schuler periods" or "sidereal days".
    pub of: String,
    /// Number of periods.
    pub periods: u32,
    /// Total length, h.
    pub hours: f64,
}

/// Errors at a mark, and the largest errors up to it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mark {
    /// Latitude error at the mark, arcmin.
    pub latitude_arcmin: f64,
    /// Longitude error at the mark, arcmin.
    pub longitude_arcmin: f64,
    /// Radial error at the mark, nmi.
    pub radial_nmi: f64,
    /// Largest latitude error up to the mark, arcmin.
    pub latitude_max_arcmin: f64,
    /// Largest longitude error up to the mark, arcmin.
    pub longitude_max_arcmin: f64,
    /// Largest radial error up to the mark, nmi.
    pub radial_max_nmi: f64,
}

/// What gaps leave open of a navigation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GapScore {
    /// Number of gaps.
    pub count: u64,
    /// Their whole length, s.
    pub total_s: f64,
    /// The longest one: its beginning and its length, s.
    pub longest_s: [f64; 2],
    /// Largest value that a score may have with them, by its path below `navigation`; null: nothing bounds it. Scores that gaps
    /// don't change are left out.
    pub bounds: BTreeMap<String, Option<f64>>,
}
