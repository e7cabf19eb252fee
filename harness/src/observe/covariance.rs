//! Covariance analysis of a procedure: what its filter will reach, before anything is run.
//!
//! The filter's own covariance gives its gains. Beside it runs the true covariance of all 39
//! states, updated by those gains in Joseph form, so that a filter with too few states (six
//! positions without G) is judged by what it really does and not by what it believes. After the
//! calibration the true covariance is carried through free navigation with the vertical channel
//! held, which gives the predicted drift.

use nalgebra::{Matrix3, Vector3};
use octant_calibration::config::{AidingMode, Config, ErrorModel, Estimator, Kalman};
use octant_calibration::covariance::{
    Covariance, DR, DV, PARAMETERS, PHI, STATE_COUNT, Transition,
};
use octant_calibration::error_model::Interval;
use octant_calibration::filter::{add_process_noise, prior_sigmas};
use octant_calibration::schedule::{Cursor, dwell_s, turned_rad};
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::frames::c_cb;
use octant_earth::units::ARCMIN;
use octant_sample::GimbalAngles;

/// Sub-step of the transition while a gimbal turns, s.
const SUB_STEP_S: f64 = 0.05;
/// Longest step of navigation, s.
const NAVIGATION_STEP_S: f64 = 10.0;

/// Predicted one-sigma drift at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// Since the start of navigation, h.
    pub hours: f64,
    /// σ of the latitude error, arcmin.
    pub latitude_arcmin: f64,
    /// σ of the longitude error, arcmin.
    pub longitude_arcmin: f64,
}

/// What a procedure will reach.
#[derive(Clone, Debug)]
pub struct Prediction {
    /// Covariance that the filter believes at the end of the calibration.
    pub believed: Covariance,
    /// True covariance of the filter's errors.
    pub achieved: Covariance,
    /// Drift in navigation, a point every ten minutes.
    pub drift: Vec<Drift>,
}

/// Why a procedure can't be analysed.
#[derive(Debug, thiserror::Error)]
pub enum AnalysisError {
    /// Another estimator than the Kalman filter.
    #[error("predict the covariance: estimator \"kalman\" is expected in procedure.calibration")]
    NotKalman,
    /// The sequence doesn't fit.
    #[error("plan the calibration: {0}")]
    DoesNotFit(#[from] octant_calibration::schedule::DoesNotFit),
}

/// A platform standing at a site and turning by the plan.
struct Platform<'a> {
    config: &'a Config,
    c_nc: Matrix3<f64>,
    earth: Ellipsoid,
    cursor: Cursor,
    from: [f64; 2],
    to: [f64; 2],
    departed_s: f64,
}

impl<'a> Platform<'a> {
    fn new(config: &'a Config, c_nc: Matrix3<f64>, cursor: Cursor) -> Self {
        let command = cursor.command().target;
        let at = [command.azimuth_rad(), command.roll_rad()];
        let earth = Ellipsoid::at(config.site.latitude_rad, config.site.height_m);
        Self { config, c_nc, earth, cursor, from: at, to: at, departed_s: 0.0 }
    }

    /// Gimbal angles at `t_s`.
    fn gimbals(&self, t_s: f64) -> [f64; 2] {
        core::array::from_fn(|i| {
            let angle = self.to[i] - self.from[i];
            self.from[i] + turned_rad(angle, t_s - self.departed_s, &self.config.turntable)
        })
    }

    /// Tells the platform that `t_s` has come, so that it may depart. Sample time is one microsecond
    /// here, finer than any plan.
    fn reach(&mut self, t_s: f64) {
        let departs = self.cursor.departure_s();
        if t_s >= departs - 1e-6 {
            self.from = self.to;
            self.departed_s = departs;
            self.cursor.advance((t_s / SAMPLE_S) as u64);
            let target = self.cursor.command().target;
            self.to = [target.azimuth_rad(), target.roll_rad()];
        }
    }

    /// Next time at which the platform starts or stops turning, or `limit_s`.
    fn next_event_s(&self, t_s: f64, limit_s: f64) -> f64 {
        [self.cursor.arrival_s(), self.cursor.departure_s()]
            .into_iter()
            .filter(|event| *event > t_s + 1e-6)
            .fold(limit_s, f64::min)
    }

    fn interval(&self, t_s: f64, h: f64) -> Interval {
        let [azimuth, roll] = self.gimbals(t_s + 0.5 * h);
        let (before, after) = (self.gimbals(t_s), self.gimbals(t_s + h));
        let c_nb = self.c_nc * c_cb(azimuth, roll);
        let force_n = Vector3::new(0.0, 0.0, -self.earth.gravity_mps2 * h);
        let turned_case = Vector3::x() * (after[1] - before[1]);
        let turned_body = Vector3::z() * (after[0] - before[0]);
        let c_bc = c_cb(azimuth, roll).transpose();
        Interval {
            interval_s: h,
            c_nb,
            delta_theta: c_nb.transpose() * self.earth.earth_rate() * h
                + c_bc * turned_case
                + turned_body,
            delta_velocity: c_nb.transpose() * force_n,
            delta_velocity_n: force_n,
            velocity_mps: Vector3::zeros(),
        }
    }

    /// Transition over `[t_s, t_s + length_s]`, in which the platform stands or turns throughout.
    fn transition(&self, t_s: f64, length_s: f64, model: ErrorModel) -> Transition {
        let standing = self.cursor.arrival_s() <= t_s + 1e-6;
        let step_s = if standing { 1.0 } else { SUB_STEP_S };
        let steps = (length_s / step_s - 1e-9).ceil().max(1.0);
        let h = length_s / steps;
        let mut transition = Transition::identity();
        for k in 0..steps as u32 {
            transition.advance(model, &self.interval(t_s + f64::from(k) * h, h), &self.earth);
        }
        transition
    }
}

/// Sample time that the cursors are given: far below anything in a plan.
const SAMPLE_S: f64 = 1e-6;

/// Predicts what the calibration of `config` reaches and how navigation drifts after it.
///
/// `c_nc` is the attitude of the case; `true_sigmas` the standard deviations of all 39 states in
/// truth (SI), which the filter's prior may know or not.
///
/// # Errors
/// If the calibration isn't by Kalman filter, or its sequence doesn't fit its duration.
pub fn predict(
    config: &Config,
    c_nc: &Matrix3<f64>,
    true_sigmas: &[f64; STATE_COUNT],
) -> Result<Prediction, AnalysisError> {
    let Some(calibration) = &config.calibration else { return Err(AnalysisError::NotKalman) };
    let Estimator::Kalman(kalman) = &calibration.estimator else {
        return Err(AnalysisError::NotKalman);
    };
    let noise = (
        config.noise.angle_random_walk * config.noise.angle_random_walk,
        config.noise.velocity_random_walk * config.noise.velocity_random_walk,
    );
    let rates = config.turntable;
    let dwell = dwell_s(&calibration.sequence, calibration.duration_s, &rates)?;
    let home = GimbalAngles::default();
    let cursor = Cursor::new(calibration.sequence.clone(), home, rates, dwell, SAMPLE_S, false);
    let platform = Platform::new(config, *c_nc, cursor);
    let (believed, mut achieved) =
        calibrate(platform, kalman, noise, calibration.duration_s, true_sigmas);
    let after_calibration = achieved.clone();

    let mut drift = Vec::new();
    if let Some(plan) = &config.navigation
        && let Some(duration_s) = plan.duration_s
    {
        let cursor = Cursor::new(plan.rotation.clone(), home, rates, plan.dwell_s, SAMPLE_S, true);
        let platform = Platform::new(config, *c_nc, cursor);
        drift = navigate(platform, &mut achieved, noise, duration_s);
    }
    Ok(Prediction { believed, achieved: after_calibration, drift })
}

fn calibrate(
    mut platform: Platform<'_>,
    kalman: &Kalman,
    noise: (f64, f64),
    duration_s: f64,
    true_sigmas: &[f64; STATE_COUNT],
) -> (Covariance, Covariance) {
    let mut believed = Covariance::from_sigmas(&prior_sigmas(kalman));
    let mut achieved = Covariance::from_sigmas(true_sigmas);
    let (first, r) = match kalman.aiding {
        AidingMode::Velocity { sigma_mps } => (DV, sigma_mps * sigma_mps),
        AidingMode::Position { sigma_m } => (DR, sigma_m * sigma_m),
    };
    let period_s = kalman.aiding_period_ns as f64 * 1e-9;
    let (mut t, mut dwelling) = (0.0, None);
    while t < duration_s - 1e-6 {
        let measured_at = ((t / period_s + 1e-6).floor() + 1.0) * period_s;
        let end = platform.next_event_s(t, measured_at.min(duration_s));
        let whole = (end - t - period_s).abs() < 1e-6;
        let standing = platform.cursor.arrival_s() <= t + 1e-6;
        // A whole period of standing has the same transition each time.
        let transition = match &dwelling {
            Some((stop, transition)) if whole && standing && *stop == platform.cursor.stop() => {
                Transition::clone(transition)
            }
            _ => platform.transition(t, end - t, kalman.error_model),
        };
        if whole && standing {
            dwelling = Some((platform.cursor.stop(), transition.clone()));
        }
        let force = Vector3::new(0.0, 0.0, -platform.earth.gravity_mps2 * (end - t));
        for covariance in [&mut believed, &mut achieved] {
            covariance.propagate(&transition);
            add_process_noise(covariance, noise, end - t, &force);
        }
        t = end;
        if (t - measured_at).abs() < 1e-6 {
            for axis in 0..3 {
                let gain = believed.gain(first + axis, r);
                believed.update(first + axis, r, 0.0, &mut [0.0; STATE_COUNT]);
                achieved.update_with_gain(first + axis, r, &gain);
            }
        }
        platform.reach(t);
    }
    (believed, achieved)
}

fn navigate(
    mut platform: Platform<'_>,
    covariance: &mut Covariance,
    noise: (f64, f64),
    duration_s: f64,
) -> Vec<Drift> {
    // Navigation starts at the known site, with height and vertical velocity held.
    for state in [DR, DR + 1, DR + 2, DV + 2] {
        covariance.reopen(state, 0.0);
    }
    let mut drift = Vec::new();
    let (mut t, mut dwelling) = (0.0, None);
    let every_s = 600.0;
    let mut mark_s: f64 = every_s;
    while t < duration_s - 1e-6 {
        let end = platform
            .next_event_s(t, duration_s)
            .min(t + NAVIGATION_STEP_S)
            .min(mark_s.max(t + 1e-3));
        let standing = platform.cursor.arrival_s() <= t + 1e-6;
        let whole = (end - t - NAVIGATION_STEP_S).abs() < 1e-6;
        let transition = match &dwelling {
            Some((stop, transition)) if whole && standing && *stop == platform.cursor.stop() => {
                Transition::clone(transition)
            }
            _ => {
                let mut transition = platform.transition(t, end - t, ErrorModel::Phi);
                transition.rows[DV + 2].fill(0.0);
                transition.rows[DR + 2].fill(0.0);
                transition
            }
        };
        if whole && standing {
            dwelling = Some((platform.cursor.stop(), transition.clone()));
        }
        covariance.propagate(&transition);
        let force = Vector3::new(0.0, 0.0, -platform.earth.gravity_mps2 * (end - t));
        add_process_noise(covariance, noise, end - t, &force);
        covariance.reopen(DV + 2, 0.0);
        covariance.reopen(DR + 2, 0.0);
        t = end;
        if (t - mark_s).abs() < 1e-3 || t >= duration_s - 1e-6 {
            let earth = &platform.earth;
            drift.push(Drift {
                hours: t / 3600.0,
                latitude_arcmin: covariance.sigma(DR) / earth.meridian_radius_m / ARCMIN,
                longitude_arcmin: covariance.sigma(DR + 1)
                    / (earth.transverse_radius_m * earth.cos_latitude)
                    / ARCMIN,
            });
            mark_s += every_s;
        }
        platform.reach(t);
    }
    drift
}

/// Names of all 39 states, as in golden files and results.
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
