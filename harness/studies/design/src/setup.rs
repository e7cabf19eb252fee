//! Inputs of a design from a scenario, and the scenarios that are refused.

use super::evaluate::{AidingReference, Conditions, PART_S};
use super::navigation::{Drift, drift};
use super::platform::{Platform, TURNING_S};
use nalgebra::Matrix3;
use octant_calibration::config::{
    AidingMode, CoreConfig, Estimator, Further, NavigationPlan, SwayNoise,
};
use octant_calibration::covariance::{Covariance, DR, DV, STATE_COUNT};
use octant_calibration::positions;
use octant_calibration::schedule::DoesNotFit;
use octant_calibration::sequence::{Sequence, Stop};
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::frames::c_nc;
use octant_observe::covariance::{AnalysisError, reach};
use octant_observe::ensemble::{EnsembleError, truth};
use octant_observe::truth::{EnsembleTruth, Swing};
use octant_scenario::{Method, MotionSpec, Scenario};
use octant_source::configure::{ConfigurationError, configurations};

/// Reasons why a scenario can't be designed for.
#[derive(Debug, thiserror::Error)]
pub enum DesignError {
    /// The scenario has no configuration.
    #[error(transparent)]
    Configuration(#[from] ConfigurationError),
    /// The scenario's draws can't be analysed.
    #[error(transparent)]
    Ensemble(#[from] EnsembleError),
    /// The result can't be predicted.
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
    /// A key has a value for which no design is built.
    #[error("design a sequence: {key}: found {found}, expected {expected}")]
    NotBuilt {
        /// The key.
        key: &'static str,
        /// Value found.
        found: String,
        /// Value that a design needs.
        expected: &'static str,
    },
    /// A sequence doesn't fit its duration.
    #[error("plan the calibration: {0}")]
    DoesNotFit(#[from] DoesNotFit),
    /// Limits leave nothing to choose from.
    #[error("design a sequence: {0}")]
    Limits(String),
}

fn not_built<T>(
    key: &'static str,
    found: impl Into<String>,
    expected: &'static str,
) -> Result<T, DesignError> {
    Err(DesignError::NotBuilt { key, found: found.into(), expected })
}

/// Rotation of navigation that a design can choose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rotation {
    /// That of the scenario.
    Given,
    /// Sixteen moves of 180°.
    Sixteen,
    /// Twelve attitudes out and back.
    Tetrahedral,
}

impl Rotation {
    /// Name of the scheme in a scenario; `None`: the scenario's own.
    #[must_use]
    pub fn name(self) -> Option<&'static str> {
        match self {
            Self::Given => None,
            Self::Sixteen => Some("sixteen"),
            Self::Tetrahedral => Some("tetrahedral"),
        }
    }

    fn stops(self, given: &Sequence) -> Sequence {
        let named = match self {
            Self::Given => return given.clone(),
            Self::Sixteen => positions::SIXTEEN,
            Self::Tetrahedral => positions::TETRAHEDRAL,
        };
        // The shipped schemes are sequences, as their own tests show.
        positions::from_degrees(named, 1).unwrap_or_else(|_| given.clone())
    }
}

/// A scenario as a design sees it.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The core's configuration, with the scenario's own calibration.
    pub config: CoreConfig,
    /// Attitude of the case.
    pub c_nc: Matrix3<f64>,
    /// Draws of the instrument, and the conditions of a candidate.
    pub conditions: Conditions,
    /// Navigation after the calibration.
    pub navigation: NavigationPlan,
    /// Its duration, s.
    pub navigation_s: f64,
    /// Duration of the calibration, s.
    pub duration_s: f64,
    pub(crate) truth: EnsembleTruth,
}

impl Setup {
    /// Reads what a design needs from a scenario.
    ///
    /// # Errors
    /// If the scenario has something for which no design is built.
    pub fn of(scenario: &Scenario) -> Result<Self, DesignError> {
        if !scenario.source.is_plant_alone() {
            return not_built("source.uri", "another source", "\"plant\"");
        }
        let mean = match &scenario.motion {
            MotionSpec::Static(mean) => mean,
            MotionSpec::Dockside(ship) => &ship.mean,
        };
        let (_, config, _) = configurations(scenario, Method::Primary, scenario.seed)?;
        let Some(calibration) = &config.calibration else {
            return not_built("procedure.calibration", "nothing", "a calibration");
        };
        let Estimator::Kalman(kalman) = &calibration.estimator else {
            return not_built("procedure.calibration.estimator", "another", "\"kalman\"");
        };
        if kalman.estimated != [true; 7] {
            let key = "procedure.calibration.not_estimated";
            return not_built(
                key,
                "a group that is not estimated",
                "that all groups are estimated",
            );
        }
        if kalman.sway != SwayNoise::White {
            return not_built("procedure.calibration.aiding.sway", "\"coloured\"", "\"white\"");
        }
        if kalman.further.rest.is_some() {
            return not_built("procedure.calibration.aiding.rest", "a case at rest", "none");
        }
        if kalman.further != Further::default() {
            return not_built("procedure.calibration.further", "further states", "none");
        }
        let Some((plan, navigation_s)) =
            config.navigation.as_ref().and_then(|plan| Some((plan, plan.duration_s?)))
        else {
            return not_built("procedure.navigation.duration", "nothing", "a duration");
        };
        let c_nc = c_nc(mean.heading_rad, mean.pitch_rad, mean.roll_rad);
        let level = level();
        let truth = truth(scenario, &config, &level, &c_nc)?;
        check(&truth)?;
        let platform = Platform {
            earth: Ellipsoid::at(config.site.latitude_rad, config.site.height_m),
            c_nc,
            rates: config.turntable,
            non_orthogonality_rad: truth.non_orthogonality_rad,
            error_model: kalman.error_model,
            noise: truth.noise,
            turning_s: TURNING_S,
        };
        let mut initial = truth.covariance.clone();
        add_means(&mut initial, &truth.mean);
        add_displacement(&mut initial, &truth);
        let conditions = Conditions {
            platform,
            initial,
            start_s: truth.start_s,
            reference: reference(scenario, kalman.aiding, &truth)?,
            period_s: kalman.aiding_period_ns as f64 * 1e-9,
            part_s: PART_S,
        };
        let (duration_s, navigation) = (calibration.duration_s, plan.clone());
        Ok(Self { c_nc, conditions, navigation, navigation_s, duration_s, truth, config })
    }

    /// Returns the same with another rotation in navigation.
    #[must_use]
    pub fn with_rotation(&self, rotation: Rotation) -> Self {
        let mut other = self.clone();
        other.navigation.rotation = rotation.stops(&self.navigation.rotation);
        other
    }

    /// Predicts a measure by the full recursion of `octant observe`: the filter as the scenario tunes it,
    /// every measurement at its own time.
    ///
    /// Of a drift over the whole navigation and over its last hours, the points every ten minutes count.
    ///
    /// # Errors
    /// If the sequence doesn't fit.
    pub fn observe(
        &self,
        sequence: &Sequence,
        duration_s: f64,
    ) -> Result<octant_observe::covariance::PredictedResult, DesignError> {
        let mut config = self.config.clone();
        if let Some(calibration) = &mut config.calibration {
            calibration.sequence = sequence.clone();
            calibration.duration_s = duration_s;
        }
        config.navigation = Some(self.navigation.clone());
        Ok(reach(&config, &self.c_nc, &self.truth)?)
    }
}

/// A stop at rest at zero, which every design begins with.
pub(crate) fn level() -> Sequence {
    let stops = [Stop { weight: 1.0, ..Stop::default() }];
    Sequence::new(&stops, 1).unwrap_or_else(|_| unreachable!("one stop of weight 1 is a sequence"))
}

/// Counts a given error as one of that size with a random sign, on its own: a sequence that is designed for
/// one instrument's signs is of no use to another.
fn add_means(covariance: &mut Covariance, mean: &[f64; STATE_COUNT]) {
    for (state, mean) in mean.iter().enumerate() {
        covariance.add(state, state, mean * mean);
    }
}

/// Counts the displacement of a ship at the start as an error of the position, with which the filter starts.
fn add_displacement(covariance: &mut Covariance, truth: &EnsembleTruth) {
    let squares = |swing: &Swing| swing.amplitude_m.component_mul(&swing.amplitude_m);
    for axis in 0..3 {
        let same: f64 = truth.mooring.iter().map(|swing| squares(swing)[axis]).sum();
        let drawn: f64 = truth.sway.iter().map(|swing| 0.5 * squares(swing)[axis]).sum();
        covariance.add(DR + axis, DR + axis, same + drawn);
    }
}

/// Returns what the filter measures. A velocity has the noise of the scenario's reference. A position on a
/// ship has the σ that the filter is tuned to: sway, white noise to the filter, is in it.
fn reference(
    scenario: &Scenario,
    aiding: AidingMode,
    truth: &EnsembleTruth,
) -> Result<AidingReference, DesignError> {
    let key = "procedure.calibration.aiding.reference";
    match (&scenario.motion, aiding) {
        (MotionSpec::Static(_), AidingMode::Velocity { sigma_mps }) => {
            Ok(AidingReference { first: DV, sigma: truth.reference_sigma.unwrap_or(sigma_mps) })
        }
        (MotionSpec::Dockside(_), AidingMode::Position { sigma_m }) => {
            Ok(AidingReference { first: DR, sigma: sigma_m })
        }
        (MotionSpec::Static(_), AidingMode::Position { .. }) => {
            not_built(key, "\"dock-position\" at rest", "\"zero-velocity\"")
        }
        (MotionSpec::Dockside(_), AidingMode::Velocity { .. }) => {
            not_built(key, "a velocity on a moored ship", "\"dock-position\"")
        }
    }
}

/// Refuses what changes the prediction and isn't carried along here.
fn check(truth: &EnsembleTruth) -> Result<(), DesignError> {
    if !truth.wanders.is_empty() {
        let found = "biases that wander (Gauss-Markov, bias instability or rate random walk)";
        return not_built("imu", found, "constant biases");
    }
    if truth.temperature.is_some() {
        return not_built("imu.temperature", "a temperature effect", "none");
    }
    if truth.further.has_errors() {
        let found = "errors beside the parameters (imu.extensions, site)";
        return not_built("imu", found, "none: a dwell is one exact step of the 39 errors alone");
    }
    Ok(())
}

impl Setup {
    /// Computes the weights of navigation.
    #[must_use]
    pub fn drift(&self) -> Drift {
        drift(&self.conditions.platform, &self.navigation, self.navigation_s)
    }
}
