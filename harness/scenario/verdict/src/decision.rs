//! The decision rule: the verdict on a value near its limit, if the reference it was measured against
//! is itself uncertain (JCGM 106:2012, guarded acceptance and rejection).

use octant_earth::ellipsoid::{meridian_radius_m, transverse_radius_m};
use serde::{Deserialize, Serialize};

/// Length of a nautical mile, m.
const NMI_M: f64 = 1852.0;

/// Rule for a value within the uncertainty of its reference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DecisionRule {
    /// Within the uncertainty of a limit the result is inconclusive: the guard band is as wide as the
    /// expanded uncertainty on both sides (JCGM 106, 8.3.2).
    #[default]
    GuardBand,
    /// A value is compared with its limit as it is (JCGM 106, 8.2.1).
    SimpleAcceptance,
}

/// Uncertainty stated for one measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Uncertainty {
    /// Path of the measure, without bars.
    pub measure: String,
    /// Expanded uncertainty (coverage of 95 %), in the measure's unit.
    pub uncertainty: f64,
}

/// Decision rule of a scenario, with the uncertainties of its references.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Decision {
    /// Rule; `None`: not stated.
    pub rule: Option<DecisionRule>,
    /// Expanded uncertainty (95 %) of the reference position, m, in each direction.
    pub position_m: Option<f64>,
    /// Uncertainties of single measures, which take precedence over derived ones.
    pub uncertainties: Vec<Uncertainty>,
}

/// Place and length of a navigation, and its reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NavigationContext {
    /// True if the truth is simulated, and thus exact.
    pub simulated: bool,
    /// Geodetic latitude, rad.
    pub latitude_rad: f64,
    /// Height, m.
    pub height_m: f64,
    /// Length of the navigation, s.
    pub navigation_s: f64,
    /// Uncertainty of the times of solution and reference.
    pub timing: Option<TimeDoubt>,
}

/// How far two clocks may differ, and how quickly the reference changes meanwhile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeDoubt {
    /// Expanded uncertainty (95 %) of the difference, s.
    pub uncertainty_s: f64,
    /// Largest speed of the reference, m/s.
    pub speed_mps: f64,
    /// Largest acceleration, m/s².
    pub acceleration_mps2: f64,
    /// Largest turning rate of the case, rad/s.
    pub turning_radps: f64,
}

impl TimeDoubt {
    /// Expanded uncertainty that follows for a measure of the navigation, in its unit.
    fn of(&self, bare: &str, against: &NavigationContext) -> f64 {
        let Self { uncertainty_s, speed_mps, acceleration_mps2, turning_radps } = *self;
        if bare.ends_with("heading_output.latency_s") {
            uncertainty_s
        } else if bare.contains("heading_output.") {
            (turning_radps * uncertainty_s).to_degrees()
        } else if is_of_position(bare) {
            of_position(bare, speed_mps * uncertainty_s, against)
        } else if bare.contains("velocity") {
            over_time(bare, acceleration_mps2 * uncertainty_s, against)
        } else {
            over_time(bare, (turning_radps * uncertainty_s).to_degrees() * 60.0, against)
        }
    }
}

/// Description of the decision rule for the readers of a result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Decided {
    /// Rule.
    pub rule: DecisionRule,
    /// Text of the rule and of the references' uncertainties.
    pub text: String,
}

/// A reference whose uncertainty isn't stated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "nobody says how uncertain its reference is: expected decision.position for a position, an \
     uncertainty of the measure in [[decision.uncertainties]], or decision.rule = \"simple-acceptance\""
)]
pub struct UnknownUncertainty;

impl Decision {
    /// Expanded uncertainty of a measure's reference, in the measure's unit.
    ///
    /// # Errors
    /// If a reference is not exact and its uncertainty is not stated.
    pub fn uncertainty(
        &self,
        measure: &str,
        against: &NavigationContext,
    ) -> Result<f64, UnknownUncertainty> {
        let bare = measure.trim_matches('|');
        let is_timed = is_referred(bare) || bare.ends_with("heading_output.latency_s");
        let of_timing = against.timing.filter(|_| is_timed && bare.contains("navigation."));
        let of_timing = of_timing.map_or(0.0, |timing| timing.of(bare, against));
        if let Some(stated) = self.uncertainties.iter().find(|stated| stated.measure == bare) {
            return Ok(libm::hypot(stated.uncertainty, of_timing));
        }
        if !is_referred(bare) {
            return Ok(of_timing);
        }
        match self.position_m {
            Some(position_m) if bare.contains("navigation.") && is_of_position(bare) => {
                // Neither knows of the other.
                Ok(libm::hypot(of_position(bare, position_m, against), of_timing))
            }
            _ if against.simulated || self.rule == Some(DecisionRule::SimpleAcceptance) => Ok(0.0),
            _ => Err(UnknownUncertainty),
        }
    }

    /// Rule that applies.
    #[must_use]
    pub fn rule(&self) -> DecisionRule {
        self.rule.unwrap_or_default()
    }

    /// Description of the rule and the uncertainties.
    #[must_use]
    pub fn decided(&self, against: &NavigationContext) -> Decided {
        let rule = self.rule();
        let how = match rule {
            DecisionRule::GuardBand => {
                "Within the expanded uncertainty (95 %) of its reference a value is inconclusive \
                 (guard band, JCGM 106)"
            }
            DecisionRule::SimpleAcceptance => {
                "A value is held against its limit as it is, whatever its reference is uncertain by (simple \
                 acceptance, JCGM 106)"
            }
        };
        let mut known = Vec::new();
        if let Some(timing) = &against.timing {
            known.push(format!(
                "times of solution and reference ± {} s at up to {:.3} m/s and {:.3} deg/s",
                timing.uncertainty_s,
                timing.speed_mps,
                timing.turning_radps.to_degrees()
            ));
        }
        if let Some(position_m) = self.position_m {
            known.push(format!("reference position ± {position_m} m"));
        }
        known.extend(
            self.uncertainties.iter().map(|u| format!("{} ± {}", u.measure, u.uncertainty)),
        );
        let known = match (known.is_empty(), against.simulated) {
            (false, _) => known.join(", "),
            (true, true) => "the truth is simulated, so the band is zero".to_owned(),
            (true, false) => "no uncertainty of a reference is stated".to_owned(),
        };
        Decided { rule, text: format!("{how}; {known}") }
    }
}

/// True if a measure is a difference from a reference. Counts, σ, innovations and the difference
/// between a run and its twin are not.
fn is_referred(bare: &str) -> bool {
    let own = bare.strip_prefix("baseline.").unwrap_or(bare);
    let name = own.rsplit('.').next().unwrap_or(own);
    // Times of a reference, and the numbers of the output itself.
    let of_itself = matches!(
        name,
        "latency_s"
            | "latency_uncertainty_s"
            | "transmission_uncertainty_deg"
            | "resolution_deg"
            | "points"
            | "rate_max_degps"
    );
    match own.split('.').next() {
        Some("navigation") if own.contains("heading_output.") && of_itself => false,
        Some("navigation") => !own.contains("slope_window") && name != "duration_h",
        Some("alignment") => matches!(name, "error" | "normalized"),
        Some("calibration") => {
            matches!(name, "error" | "estimate" | "normalized" | "worst_normalized_error")
                || own.contains(".nees.")
        }
        _ => false,
    }
}

/// True if the reference of a measure of the navigation is a position.
fn is_of_position(bare: &str) -> bool {
    !["heading", "pitch", "roll", "velocity"].iter().any(|kind| bare.contains(kind))
}

/// Uncertainty of a measure of the navigation that follows from that of the position.
fn of_position(bare: &str, position_m: f64, against: &NavigationContext) -> f64 {
    let (sin, cos) = (libm::sin(against.latitude_rad), libm::cos(against.latitude_rad));
    let arcmin = |radius_m: f64| (position_m / radius_m).to_degrees() * 60.0;
    let band = if bare.contains("radial") {
        position_m / NMI_M
    } else if bare.contains("longitude") {
        arcmin((transverse_radius_m(sin) + against.height_m) * cos)
    } else {
        arcmin(meridian_radius_m(sin) + against.height_m)
    };
    over_time(bare, band, against)
}

/// Uncertainty of a measure over time that follows from that of each value.
fn over_time(bare: &str, band: f64, against: &NavigationContext) -> f64 {
    let hours = (against.navigation_s / 3600.0).max(f64::MIN_POSITIVE);
    // Slope: the reference is wrong by the whole uncertainty at one end, and by the same in the other
    // direction at the other end. Rate: in a regression through the origin, a constant error c leaves
    // 3c/2T.
    match bare.rsplit('.').next() {
        Some("slope_per_day") => 2.0 * band / (hours / 24.0),
        Some("rate_per_h") => 1.5 * band / hours,
        _ => band,
    }
}

/// True if a value is so close to its limit that the result is inconclusive.
#[must_use]
pub fn in_band(value: f64, limit: f64, uncertainty: f64) -> bool {
    uncertainty > 0.0 && (value - limit).abs() < uncertainty
}
