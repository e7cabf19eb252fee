//! Covariance analysis of a procedure: predicts the result of its filter without a run.
//!
//! The filter's own covariance gives its gains. The true errors of all 39 states ([`EnsembleTruth`]) are
//! carried along and updated by those gains in Joseph form, so that a filter with too few states
//! (six positions without G) is judged by its actual errors and not by the covariance that it
//! believes. After the calibration the true errors are carried through free navigation with the
//! vertical channel held, which gives the predicted drift.

use super::border::{Border, FurtherModel, Step};
use super::platform::{Platform, SAMPLE_S};
use super::truth::{EnsembleTruth, FurtherTruth, Gain, TrueErrors, Unseen};
use nalgebra::{Matrix3, Vector3};
use octant_calibration::config::{
    AidingMode, CoreConfig, ErrorModel, Estimator, Further, Kalman, SwayNoise,
};
use octant_calibration::covariance::{Covariance, DR, DV, PARAMETERS, PHI, STATE_COUNT};
use octant_calibration::filter::{FURTHER_ROW, add_bias_walk, add_process_noise, prior_sigmas};
use octant_calibration::further::DRIVING_COUNT;
use octant_calibration::schedule::{Cursor, dwell_s};
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::units::ARCMIN;
use octant_sample::GimbalAngles;

/// Longest step of navigation, s.
const NAVIGATION_STEP_S: f64 = 10.0;
/// Time between two points of the drift, s.
const DRIFT_EVERY_S: f64 = 600.0;

/// Predicted one-sigma drift at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictedDrift {
    /// Time since the start of navigation, h.
    pub hours: f64,
    /// σ of the latitude error, arcmin.
    pub latitude_arcmin: f64,
    /// σ of the longitude error, arcmin.
    pub longitude_arcmin: f64,
}

/// Predicted result of a procedure.
#[derive(Clone, Debug)]
pub struct Prediction {
    /// Covariance that the filter believes at the end of the calibration.
    pub believed: Covariance,
    /// True covariance of the filter's errors.
    pub achieved: Covariance,
    /// Drift in navigation, a point every ten minutes.
    pub drift: Vec<PredictedDrift>,
}

/// Position error of an ensemble at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionError {
    /// Time since the start of navigation, h.
    pub hours: f64,
    /// Mean, north and east, m.
    pub mean_m: [f64; 2],
    /// Variances, north and east, m².
    pub variances_m2: [f64; 2],
    /// Covariance of north and east, m².
    pub covariance_m2: f64,
}

/// Predicted result of an ensemble.
#[derive(Clone, Debug)]
pub struct PredictedResult {
    /// Covariance that the filter believes at the end of the calibration.
    pub believed: Covariance,
    /// Mean of the true errors: parameters true − estimated, all others computed − true.
    pub mean: [f64; STATE_COUNT],
    /// Covariance of the true errors.
    pub achieved: Covariance,
    /// Position error in navigation, a point every ten minutes.
    pub drift: Vec<PositionError>,
    /// Attitude and velocity error at the same times.
    pub motion: Vec<MotionError>,
    /// Errors beside the parameters at the end of the calibration; `None` where neither the instrument nor the filter has
    /// any.
    pub further: Option<PredictedFurther>,
}

/// Errors beside the parameters at the end of a calibration, SI, true − estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictedFurther {
    /// σ that the filter believes; zero where it doesn't know of the error.
    pub believed: [f64; DRIVING_COUNT],
    /// Mean. Of Gauss-Markov biases minus that of the estimates.
    pub mean: [f64; DRIVING_COUNT],
    /// σ about the mean. Of Gauss-Markov biases that of the estimates.
    pub sigma: [f64; DRIVING_COUNT],
}

/// Attitude and velocity error of an ensemble at one time, computed − true.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionError {
    /// Mean of φ in n, rad.
    pub mean_phi_rad: Vector3<f64>,
    /// Covariance of φ about it, rad².
    pub phi_rad2: Matrix3<f64>,
    /// Mean of the velocity error, north and east, m/s.
    pub mean_mps: [f64; 2],
    /// Its variances, (m/s)².
    pub variances_m2ps2: [f64; 2],
}

impl MotionError {
    /// Attitude and velocity part of the moments of all errors.
    fn of(mean: &[f64; STATE_COUNT], covariance: &Covariance) -> Self {
        Self {
            mean_phi_rad: Vector3::from_fn(|i, _| mean[PHI + i]),
            phi_rad2: Matrix3::from_fn(|i, j| covariance.at(PHI + i, PHI + j)),
            mean_mps: [mean[DV], mean[DV + 1]],
            variances_m2ps2: [covariance.at(DV, DV), covariance.at(DV + 1, DV + 1)],
        }
    }
}

/// Reasons why a procedure can't be analysed.
#[derive(Debug, thiserror::Error)]
pub enum AnalysisError {
    /// The estimator isn't the Kalman filter.
    #[error(
        "predict the covariance: found another estimator in procedure.calibration, expected \"kalman\""
    )]
    NotKalman,
    /// The filter has states of the sway, which the prediction doesn't.
    #[error(
        "predict the covariance: found procedure.calibration.aiding.sway = \"coloured\", whose estimate isn't \
         linear, expected \"white\""
    )]
    ColouredSway,
    /// Gimbal angles are measurements, which the prediction doesn't have.
    #[error(
        "predict the ensemble: found procedure.calibration.further.gimbal_angles, expected none; \"octant observe\" has \
         the σ of this filter"
    )]
    GimbalAngles,
    /// The case is said to rest, which the prediction doesn't have.
    #[error(
        "predict the ensemble: found procedure.calibration.aiding.rest, expected none; \"octant observe\" has the σ of \
         this filter"
    )]
    Rest,
    /// The filter has states beside the 39, of which true sizes have to be known.
    #[error(
        "predict the covariance from σ of the 39 states: found procedure.calibration.further, expected none"
    )]
    Further,
    /// The sequence doesn't fit.
    #[error("plan the calibration: {0}")]
    DoesNotFit(#[from] octant_calibration::schedule::DoesNotFit),
}

/// Predicts the result of `config`'s calibration, and the drift of navigation after it.
///
/// `c_nc` is the attitude of the case; `true_sigmas` are the true standard deviations of all 39
/// states (SI), which the filter's prior may or may not match. All else is as the filter assumes.
///
/// # Errors
/// If the calibration isn't by Kalman filter, or its sequence doesn't fit its duration.
pub fn predict(
    config: &CoreConfig,
    c_nc: &Matrix3<f64>,
    true_sigmas: &[f64; STATE_COUNT],
) -> Result<Prediction, AnalysisError> {
    let truth = EnsembleTruth {
        covariance: Covariance::from_sigmas(true_sigmas),
        mean: [0.0; STATE_COUNT],
        noise: noise_of(config),
        reference_sigma: None,
        wanders: Vec::new(),
        temperature: None,
        mooring: Vec::new(),
        sway: Vec::new(),
        unseen: Unseen::Nothing,
        start_s: 0.0,
        non_orthogonality_rad: 0.0,
        further: FurtherTruth::default(),
    };
    if let Some(calibration) = &config.calibration
        && let Estimator::Kalman(kalman) = &calibration.estimator
        && kalman.further != Further::default()
    {
        return Err(AnalysisError::Further);
    }
    let PredictedResult { believed, achieved, drift, .. } = reach(config, c_nc, &truth)?;
    let earth = Ellipsoid::at(config.site.latitude_rad, config.site.height_m);
    let drift = drift.iter().map(|at| at.sigmas(&earth)).collect();
    Ok(Prediction { believed, achieved, drift })
}

impl PositionError {
    /// Returns the standard deviations, arcmin.
    fn sigmas(&self, earth: &Ellipsoid) -> PredictedDrift {
        let [north, east] = arcmin_m(earth);
        let [n, e] = self.variances_m2;
        PredictedDrift {
            hours: self.hours,
            latitude_arcmin: libm::sqrt(n.max(0.0)) / north,
            longitude_arcmin: libm::sqrt(e.max(0.0)) / east,
        }
    }
}

/// Returns the metres per arc minute of latitude and of longitude.
#[must_use]
pub fn arcmin_m(earth: &Ellipsoid) -> [f64; 2] {
    [earth.meridian_radius_m * ARCMIN, earth.transverse_radius_m * earth.cos_latitude * ARCMIN]
}

/// Returns the white noise that the filter assumes: gyros, rad²/s, and accelerometers, (m/s)²/s.
fn noise_of(config: &CoreConfig) -> (f64, f64) {
    let square = |density: f64| density * density;
    (square(config.noise.angle_random_walk), square(config.noise.velocity_random_walk))
}

/// Predicts the result of an ensemble with this truth under the filter of `config`.
///
/// # Errors
/// If the calibration isn't by Kalman filter, or its sequence doesn't fit its duration.
pub fn reach(
    config: &CoreConfig,
    c_nc: &Matrix3<f64>,
    truth: &EnsembleTruth,
) -> Result<PredictedResult, AnalysisError> {
    let Some(calibration) = &config.calibration else { return Err(AnalysisError::NotKalman) };
    let Estimator::Kalman(kalman) = &calibration.estimator else {
        return Err(AnalysisError::NotKalman);
    };
    if kalman.sway != SwayNoise::White {
        return Err(AnalysisError::ColouredSway);
    }
    if kalman.further.rest.is_some() {
        return Err(AnalysisError::Rest);
    }
    if kalman.further.angles.is_some() {
        return Err(AnalysisError::GimbalAngles);
    }
    let bordered = kalman.further.has_states() || truth.further.has_errors();
    let further = bordered.then(|| FurtherModel::new(&kalman.further));
    let rates = config.turntable;
    let dwell = dwell_s(&calibration.sequence, calibration.duration_s, &rates)?;
    let home = GimbalAngles::default();
    let cursor = Cursor::new(calibration.sequence.clone(), home, rates, dwell, SAMPLE_S, false);
    let mut platform = Platform::new(config, *c_nc, truth.non_orthogonality_rad, home, cursor)
        .warmed(truth.temperature, 0.0);
    let mut errors = TrueErrors::new(truth, bordered);
    let (start_s, end_s) = (truth.start_s, calibration.duration_s);
    let filter = (kalman, further.as_ref());
    let (believed, believed_further) =
        calibrate(&mut platform, filter, noise_of(config), (start_s, end_s), &mut errors);
    let (mean, achieved) = errors.moments();
    let found = errors.further().zip(believed_further);
    let predicted =
        found.map(|([mean, sigma], believed)| PredictedFurther { believed, mean, sigma });

    let (mut drift, mut motion) = (Vec::new(), Vec::new());
    if let Some(plan) = &config.navigation
        && let Some(duration_s) = plan.duration_s
    {
        let at = platform.target();
        let cursor = Cursor::new(plan.rotation.clone(), at, rates, plan.dwell_s, SAMPLE_S, true);
        let platform = Platform::new(config, *c_nc, truth.non_orthogonality_rad, at, cursor)
            .warmed(truth.temperature, end_s);
        // A step must be shorter than the correlation times, because a wander counts as constant
        // within it.
        let step_s = (truth.wanders.iter())
            .map(|wander| 0.1 * wander.correlation_time_s)
            .fold(NAVIGATION_STEP_S, f64::min)
            .max(1.0);
        let times = (end_s, duration_s, step_s);
        (drift, motion) = navigate(platform, &mut errors, further.as_ref(), times);
    }
    Ok(PredictedResult { believed, mean, achieved, drift, motion, further: predicted })
}

fn calibrate(
    platform: &mut Platform<'_>,
    (kalman, further): (&Kalman, Option<&FurtherModel>),
    noise: (f64, f64),
    (start_s, end_s): (f64, f64),
    errors: &mut TrueErrors,
) -> (Covariance, Option<[f64; DRIVING_COUNT]>) {
    let mut believed = Covariance::from_sigmas(&prior_sigmas(kalman));
    let mut border = further.map(FurtherModel::believed);
    let (first, r) = match kalman.aiding {
        AidingMode::Velocity { sigma_mps } => (DV, sigma_mps * sigma_mps),
        AidingMode::Position { sigma_m } => (DR, sigma_m * sigma_m),
    };
    let walk = kalman.further.gyro_rate_random_walk;
    let period_s = kalman.aiding_period_ns as f64 * 1e-9;
    let (mut t, mut dwelling) = (start_s, None);
    while t < end_s - 1e-6 {
        let measured_at = ((t / period_s + 1e-6).floor() + 1.0) * period_s;
        let end = platform.next_event_s(t, measured_at.min(end_s));
        let whole = (end - t - period_s).abs() < 1e-6;
        let standing = platform.stands(t);
        // A whole period at rest has the same transition each time.
        let step = match &dwelling {
            Some((stop, step)) if whole && standing && *stop == platform.cursor.stop() => {
                Step::clone(step)
            }
            _ => platform.step(t, end - t, kalman.error_model, further),
        };
        if whole && standing && !platform.is_warmed() {
            dwelling = Some((platform.cursor.stop(), step.clone()));
        }
        let force = Vector3::new(0.0, 0.0, -platform.earth.gravity_mps2 * (end - t));
        believed.propagate(&step.transition);
        if let (Some(model), Some(border), Some(of)) = (further, &mut border, &step.further) {
            border.propagate(&step.transition, of, &mut believed);
            border.add_noise(model, &of.1);
        }
        if walk > 0.0 {
            add_bias_walk(&mut believed, walk * walk * (end - t), &step.transition);
        }
        add_process_noise(&mut believed, noise, end - t, &force);
        errors.propagate(&step, end - t, &force);
        t = end;
        if (t - measured_at).abs() < 1e-6 {
            for axis in 0..3 {
                let state = first + axis;
                let mut gain =
                    Gain { errors: believed.gain(state, r), further: [0.0; FURTHER_ROW] };
                if let (Some(model), Some(border)) = (further, &mut border) {
                    gain.further = border.gain(model, state, believed.at(state, state) + r);
                    border.update(&believed, (state, r), &gain.errors, &gain.further);
                }
                believed.update(state, r, 0.0, &mut [0.0; STATE_COUNT]);
                errors.update(first, axis, r, &gain, t);
            }
        }
        platform.reach(t);
    }
    let sigmas = |border: Border| core::array::from_fn(|k| libm::sqrt(border.variance(k).max(0.0)));
    (believed, border.map(sigmas))
}

/// Carries the errors through navigation. `start_s` is the end of the calibration, where the
/// platform's time starts.
fn navigate(
    mut platform: Platform<'_>,
    errors: &mut TrueErrors,
    further: Option<&FurtherModel>,
    (start_s, duration_s, step_s): (f64, f64, f64),
) -> (Vec<PositionError>, Vec<MotionError>) {
    errors.start_free(start_s);
    let (mut drift, mut motion) = (Vec::new(), Vec::new());
    let (mut t, mut dwelling) = (0.0, None);
    let mut mark_s: f64 = DRIFT_EVERY_S;
    while t < duration_s - 1e-6 {
        let end = platform.next_event_s(t, duration_s).min(t + step_s).min(mark_s.max(t + 1e-3));
        let standing = platform.stands(t);
        let whole = (end - t - step_s).abs() < 1e-6;
        let step = match &dwelling {
            Some((stop, step)) if whole && standing && *stop == platform.cursor.stop() => {
                Step::clone(step)
            }
            _ => {
                let mut step = platform.step(t, end - t, ErrorModel::Phi, further);
                step.hold_vertical();
                step
            }
        };
        if whole && standing && !platform.is_warmed() {
            dwelling = Some((platform.cursor.stop(), step.clone()));
        }
        let force = Vector3::new(0.0, 0.0, -platform.earth.gravity_mps2 * (end - t));
        errors.propagate(&step, end - t, &force);
        errors.hold_vertical();
        t = end;
        if (t - mark_s).abs() < 1e-3 || t >= duration_s - 1e-6 {
            let (mean, covariance) = errors.moments();
            drift.push(PositionError {
                hours: t / 3600.0,
                mean_m: [mean[DR], mean[DR + 1]],
                variances_m2: [covariance.at(DR, DR), covariance.at(DR + 1, DR + 1)],
                covariance_m2: covariance.at(DR, DR + 1),
            });
            motion.push(MotionError::of(&mean, &covariance));
            mark_s += DRIFT_EVERY_S;
        }
        platform.reach(t);
    }
    (drift, motion)
}

/// Returns the name of a state, one of 39, as in golden files and results.
#[must_use]
pub fn state_name(state: usize) -> String {
    let axis = ["north", "east", "down"];
    match state {
        s if s < DV => format!("phi_{}", axis[s - PHI]),
        s if s < DR => format!("velocity_{}", axis[s - DV]),
        s if s < PARAMETERS => format!("position_{}", axis[s - DR]),
        s => octant_sample::parameters::NAMES[s - PARAMETERS].to_string(),
    }
}
