//! Ensemble of a scenario's draws: σ of every error, and envelopes of the drift.
//!
//! Linear covariance analysis: one pass instead of many runs (D. K. Geller, *Linear covariance
//! techniques for orbital rendezvous analysis and autonomous onboard mission planning*, Journal of
//! Guidance, Control, and Dynamics 29, 2006). The filter keeps its own prior and noise; the plant's
//! draws and effects are in [`EnsembleTruth`].

pub use super::bands::{ErrorBand, SolutionBands};

use super::border::{FurtherModel, sum};
use super::covariance::{
    AnalysisError, PositionError, PredictedFurther, PredictedResult, arcmin_m, reach, state_name,
};
use super::not_modelled::not_modelled;
use super::platform::{Platform, SAMPLE_S};
use super::truth::{EnsembleTruth, FurtherTruth, Swing, Unseen, Wander};
use nalgebra::{Matrix3, Vector3};
use octant_calibration::config::{CoreConfig, ErrorModel, Estimator, Further, Kalman};
use octant_calibration::covariance::{Covariance, DR, DV, PARAMETERS, PHI, STATE_COUNT};
use octant_calibration::further::{DRIVING_COUNT, FURTHER_COUNT, FURTHER_NAMES, FurtherGroup};
use octant_calibration::schedule::Cursor;
use octant_calibration::sequence::Sequence;
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::frames::c_nc;
use octant_earth::units::{ARCSEC, NAUTICAL_MILE_M};
use octant_plant::config as plant;
use octant_run::SetupError;
use octant_sample::GimbalAngles;
use octant_sample::parameters::ParameterGroup;
use octant_scenario::resolve::{DrawnValues, Seeded};
use octant_scenario::{
    AlignmentSpec, DocksideSpec, Method, MotionSpec, ParameterDistribution, Scenario,
};
use octant_source::configure::configurations;
use octant_statistics::radius::Plane;
use serde::{Deserialize, Serialize};

/// Version of the form of a predicted ensemble.
pub const SCHEMA: u32 = 1;

/// Prediction of an ensemble.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ensemble {
    /// Version of this form: [`SCHEMA`].
    pub schema: u32,
    /// Version of the program.
    pub octant: String,
    /// Name of the scenario.
    pub scenario: String,
    /// Name of the method.
    pub method: String,
    /// Length of the calibration, h.
    pub calibration_h: f64,
    /// Errors of all 39 states at the end of the calibration, and of the further ones that the filter has.
    pub states: Vec<ErrorState>,
    /// Position error in navigation, a point every ten minutes.
    pub drift: Vec<DriftBand>,
    /// Effects of the scenario that are not in the prediction, in plain words.
    pub not_modelled: Vec<String>,
}

/// One error over the ensemble, in its unit: parameters estimated − true, all others computed − true.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorState {
    /// Name.
    pub name: String,
    /// Unit of all values.
    pub unit: String,
    /// σ at the start.
    pub prior: f64,
    /// σ that the filter believes at the end; null where it doesn't estimate the state.
    pub believed: Option<f64>,
    /// Mean at the end: the part that is the same in every run.
    pub mean: f64,
    /// σ about the mean at the end.
    pub sigma: f64,
}

/// Position error over the ensemble at one time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DriftBand {
    /// Time since the start of navigation, h.
    pub hours: f64,
    /// Latitude error, arcmin.
    pub latitude_arcmin: ErrorBand,
    /// Longitude error, arcmin.
    pub longitude_arcmin: ErrorBand,
    /// Radial error, nmi.
    pub radial_nmi: RadialBand,
    /// Attitude and velocity; null in predictions from before they were made.
    #[serde(default)]
    pub solution: Option<SolutionBands>,
}

/// A radial error over the ensemble.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RadialBand {
    /// Median.
    pub p50: f64,
    /// 95th percentile.
    pub p95: f64,
}

/// Reasons why no ensemble can be predicted.
#[derive(Debug, thiserror::Error)]
pub enum EnsembleError {
    /// The scenario can't be set up.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The filter can't be analysed, or there is no calibration.
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
    /// The source draws nothing.
    #[error(
        "predict the ensemble: found another source.uri, without random draws, expected \"plant\""
    )]
    NotSimulated,
    /// A coarse alignment on a ship isn't linear.
    #[error(
        "predict the ensemble: procedure.alignment.method is \"coarse\" with motion.kind \"dockside\": \
         the effect of sway on it is not linear, expected \"given\""
    )]
    CoarseAtSea,
}

/// Predicts the ensemble of one method of a scenario.
///
/// # Errors
/// If it is not simulated, or not calibrated by a Kalman filter.
pub fn ensemble(scenario: &Scenario, method: Method) -> Result<Ensemble, EnsembleError> {
    if !scenario.source.is_plant_alone() {
        return Err(EnsembleError::NotSimulated);
    }
    let (_, config, _) =
        configurations(scenario, method, scenario.seed).map_err(SetupError::from)?;
    let Some(calibration) = &config.calibration else {
        return Err(AnalysisError::NotKalman.into());
    };
    let Estimator::Kalman(kalman) = &calibration.estimator else {
        return Err(AnalysisError::NotKalman.into());
    };
    let mean = match &scenario.motion {
        MotionSpec::Static(mean) => *mean,
        MotionSpec::Dockside(ship) => ship.mean,
    };
    let c = c_nc(mean.heading_rad, mean.pitch_rad, mean.roll_rad);
    let truth = truth(scenario, &config, &calibration.sequence, &c)?;
    let attitude = mean;
    let PredictedResult { believed, mean, achieved, drift, motion, further } =
        reach(&config, &c, &truth)?;
    let earth = Ellipsoid::at(config.site.latitude_rad, config.site.height_m);
    let states = (0..STATE_COUNT).map(|state| {
        let (unit, si) = state_unit(state);
        let parameter = state >= PARAMETERS;
        let estimated =
            !parameter || kalman.estimated[ParameterGroup::of(state - PARAMETERS) as usize];
        let sign = if parameter { -1.0 } else { 1.0 };
        ErrorState {
            name: state_name(state),
            unit: unit.to_owned(),
            prior: truth.covariance.sigma(state) / si,
            believed: estimated.then(|| believed.sigma(state) / si),
            // Avoids a negative zero.
            mean: sign * mean[state] / si + 0.0,
            sigma: achieved.sigma(state) / si,
        }
    });
    Ok(Ensemble {
        schema: SCHEMA,
        octant: env!("CARGO_PKG_VERSION").to_owned(),
        scenario: scenario.title.clone(),
        method: scenario.method_label(method),
        calibration_h: calibration.duration_s / 3600.0,
        states: states.chain(further_states(kalman, &truth.further, further.as_ref())).collect(),
        drift: drift
            .iter()
            .zip(&motion)
            .map(|(at, motion)| {
                let solution = SolutionBands::of(motion, attitude.heading_rad, attitude.pitch_rad);
                DriftBand { solution: Some(solution), ..band(at, &earth) }
            })
            .collect(),
        not_modelled: not_modelled(scenario),
    })
}

/// Errors of the further states that the filter considers or estimates. Gauss-Markov biases have no truth that a run
/// could be compared with, and are left out.
fn further_states<'a>(
    kalman: &'a Kalman,
    truth: &'a FurtherTruth,
    found: Option<&'a PredictedFurther>,
) -> impl Iterator<Item = ErrorState> + 'a {
    let is_process =
        |group| matches!(group, FurtherGroup::GyroGaussMarkov | FurtherGroup::AccelGaussMarkov);
    let known = move |group: &FurtherGroup| {
        kalman.further.of(*group).sigma().is_some() && !is_process(*group)
    };
    FurtherGroup::ALL.into_iter().filter(known).flat_map(move |group| {
        let si = group.si_per_unit();
        group.range().zip(core::iter::repeat(found)).filter_map(move |(k, found)| {
            let found = found?;
            Some(ErrorState {
                name: FURTHER_NAMES[k].to_owned(),
                unit: group.unit().to_owned(),
                prior: truth.sigma[k] / si,
                believed: Some(found.believed[k] / si),
                mean: -found.mean[k] / si + 0.0,
                sigma: found.sigma[k] / si,
            })
        })
    })
}

/// Returns the unit in which a state is shown, and its SI value.
#[must_use]
pub fn state_unit(state: usize) -> (&'static str, f64) {
    match state {
        s if s < DV => ("arcsec", ARCSEC),
        s if s < DR => ("m/s", 1.0),
        s if s < PARAMETERS => ("m", 1.0),
        s => {
            let group = ParameterGroup::of(s - PARAMETERS);
            (group.unit(), group.si_per_unit())
        }
    }
}

/// Converts a position error into display units.
pub fn band(at: &PositionError, earth: &Ellipsoid) -> DriftBand {
    let one = |axis: usize| {
        let unit_m = arcmin_m(earth)[axis];
        let mean = at.mean_m[axis] / unit_m;
        let sigma = libm::sqrt(at.variances_m2[axis].max(0.0)) / unit_m;
        ErrorBand::of(mean, sigma)
    };
    let square = NAUTICAL_MILE_M * NAUTICAL_MILE_M;
    let plane = Plane {
        mean: at.mean_m.map(|m| m / NAUTICAL_MILE_M),
        variances: at.variances_m2.map(|v| v / square),
        covariance: at.covariance_m2 / square,
    };
    DriftBand {
        hours: at.hours,
        latitude_arcmin: one(0),
        longitude_arcmin: one(1),
        radial_nmi: RadialBand { p50: plane.quantile(0.5), p95: plane.quantile(0.95) },
        solution: None,
    }
}

/// Collects the draws and effects of a scenario's plant: what [`reach`] predicts the result of.
///
/// # Errors
/// If the alignment is coarse on a ship, whose effect isn't linear.
pub fn truth(
    scenario: &Scenario,
    config: &CoreConfig,
    sequence: &Sequence,
    c: &Matrix3<f64>,
) -> Result<EnsembleTruth, EnsembleError> {
    let square = |density: f64| density * density;
    let (mut sigmas, mut mean) = ([0.0; STATE_COUNT], [0.0; STATE_COUNT]);
    for group in ParameterGroup::ALL {
        let first = PARAMETERS + group.range().start;
        let known = &config.initial_parameters.to_array()[group.range()];
        for (i, known) in known.iter().enumerate() {
            let (drawn, sigma) = match &scenario.parameters[group as usize] {
                ParameterDistribution::Normal(sigma) => (0.0, *sigma),
                ParameterDistribution::Uniform(half_width) => (0.0, half_width / libm::sqrt(3.0)),
                ParameterDistribution::Constant(values) => {
                    (values.get(i).copied().unwrap_or(0.0), 0.0)
                }
            };
            sigmas[first + i] = sigma;
            mean[first + i] = drawn - known;
        }
    }
    if let AlignmentSpec::Given { tilt_rad, azimuth_rad, velocity_mps, .. } = scenario.alignment {
        sigmas[PHI..DV].copy_from_slice(&[tilt_rad, tilt_rad, azimuth_rad]);
        sigmas[DV..DR].fill(velocity_mps);
    }
    if let AlignmentSpec::Given { attitude_error_rad, velocity_error_mps, .. } = scenario.alignment
    {
        for (first, given) in [(PHI, attitude_error_rad), (DV, velocity_error_mps)] {
            if let Some(given) = given {
                sigmas[first..first + 3].fill(0.0);
                mean[first..first + 3].copy_from_slice(&given);
            }
        }
    }
    let imu = &scenario.imu;
    let mut further = FurtherTruth {
        sigma: further_sigmas(&scenario.further),
        mean: driving(&octant_plant::further::truth(
            &imu.extensions,
            &scenario.site.gravity,
            &scenario.turntable,
        )),
        ..FurtherTruth::default()
    };
    let noise = (square(imu.angle_random_walk), square(imu.velocity_random_walk));
    let mut covariance = Covariance::from_sigmas(&sigmas);
    let mut start_s = 0.0;
    if let AlignmentSpec::Coarse { duration_s } = scenario.alignment {
        if matches!(scenario.motion, MotionSpec::Dockside(_)) {
            return Err(EnsembleError::CoarseAtSea);
        }
        start_s = duration_s;
        let home = GimbalAngles::default();
        let rates = config.turntable;
        let cursor = Cursor::new(sequence.clone(), home, rates, duration_s, SAMPLE_S, false);
        let leant = scenario.turntable.non_orthogonality_rad;
        let platform = Platform::new(config, *c, leant, home, cursor);
        let coarse = Coarse::of(&platform);
        coarse.apply(&sigmas, noise, duration_s, &mut covariance, &mut mean);
        coarse.tilt_by(&mut further, &mut covariance, &mut mean);
    }
    let extensions = &imu.extensions;
    let mut wanders = Vec::new();
    for (group, process) in [
        (ParameterGroup::GyroBias, &extensions.gyro_gauss_markov),
        (ParameterGroup::AccelBias, &extensions.accel_gauss_markov),
    ] {
        let wander =
            |p: &plant::GaussMarkov| Wander::gauss_markov(group, p.sigma, p.correlation_time_s);
        wanders.extend(process.iter().map(wander));
    }
    for (group, coefficient) in [
        (ParameterGroup::GyroBias, extensions.gyro_bias_instability),
        (ParameterGroup::AccelBias, extensions.accel_bias_instability),
    ] {
        if coefficient > 0.0 {
            let processes = octant_plant::flicker::processes(coefficient);
            let wander =
                |p: plant::GaussMarkov| Wander::gauss_markov(group, p.sigma, p.correlation_time_s);
            wanders.extend(processes.map(wander));
        }
    }
    if extensions.gyro_rate_random_walk > 0.0 {
        let walk = Wander::random_walk(ParameterGroup::GyroBias, extensions.gyro_rate_random_walk);
        wanders.push(Wander { variance: walk.driving * start_s, ..walk });
    }
    let (mooring, sway) = match &scenario.motion {
        MotionSpec::Static(_) => (Vec::new(), Vec::new()),
        MotionSpec::Dockside(ship) => swings(scenario, ship),
    };
    let (reference_sigma, unseen) = match scenario.aiding.kind {
        plant::AidingKind::ZeroVelocity { sigma_mps } => (sigma_mps, Unseen::Velocity),
        plant::AidingKind::Velocity { sigma_mps } => (sigma_mps, Unseen::Nothing),
        plant::AidingKind::DockPosition { sigma_m } => (sigma_m, Unseen::Position),
    };
    Ok(EnsembleTruth {
        covariance,
        mean,
        noise,
        reference_sigma: Some(reference_sigma),
        wanders,
        temperature: extensions.temperature,
        mooring,
        sway,
        unseen,
        start_s,
        non_orthogonality_rad: scenario.turntable.non_orthogonality_rad,
        further,
    })
}

/// Returns the values of errors that drive attitude and velocity; of processes zero.
fn driving(given: &[Option<f64>; FURTHER_COUNT]) -> [f64; DRIVING_COUNT] {
    core::array::from_fn(|k| given[k].unwrap_or(0.0))
}

/// Returns the standard deviations of draws of the errors beside the parameters that drive attitude and velocity.
fn further_sigmas(draws: &[Option<ParameterDistribution>; 15]) -> [f64; DRIVING_COUNT] {
    let mut sigmas = [0.0; DRIVING_COUNT];
    let all = FurtherGroup::ALL.into_iter().zip(draws);
    for (group, draw) in all.filter(|(group, _)| !group.is_of_gimbals()) {
        sigmas[group.range()].fill(match draw {
            Some(ParameterDistribution::Normal(sigma)) => *sigma,
            Some(ParameterDistribution::Uniform(half_width)) => half_width / libm::sqrt(3.0),
            Some(ParameterDistribution::Constant(_)) | None => 0.0,
        });
    }
    sigmas
}

/// Returns a ship's displacements: those that are the same in every run, and those with drawn
/// phases.
fn swings(scenario: &Scenario, ship: &DocksideSpec) -> (Vec<Swing>, Vec<Swing>) {
    let (s, c) = libm::sincos(ship.mean.heading_rad);
    let directions = [Vector3::new(c, s, 0.0), Vector3::new(-s, c, 0.0), Vector3::z()];
    let offset = Swing {
        amplitude_m: Vector3::from(ship.mooring_offset_m),
        period_s: f64::INFINITY,
        phase_rad: core::f64::consts::FRAC_PI_2,
    };
    let (mut same, mut drawn) = (vec![offset], Vec::new());
    // Components of a spectrum are drawn with their periods: those of one seed represent all.
    let draws = DrawnValues::of(scenario, &Seeded(scenario.seed));
    for (direction, motion) in directions.iter().zip(3..) {
        let given = &ship.components[motion];
        for (i, sinusoid) in draws.motion[motion].iter().enumerate() {
            let swing = Swing {
                amplitude_m: direction * sinusoid.amplitude,
                period_s: sinusoid.period_s,
                phase_rad: sinusoid.phase_rad,
            };
            let known = given.get(i).is_some_and(|component| component.phase_rad.is_some());
            if known { same.push(swing) } else { drawn.push(swing) }
        }
    }
    (same, drawn)
}

/// Linear effect of the instrument's errors on a coarse alignment: φ = A · parameters + B · further errors + noise.
struct Coarse {
    rows: [[f64; STATE_COUNT]; 3],
    further: [[f64; DRIVING_COUNT]; 3],
    earth: Ellipsoid,
}

impl Coarse {
    fn of(platform: &Platform<'_>) -> Self {
        // Short enough that attitude errors have no effect on velocity.
        const H: f64 = 1e-4;
        let earth = platform.earth;
        let model = FurtherModel::new(&Further::default());
        let step = platform.step(0.0, H, ErrorModel::Phi, Some(&model));
        let (g, horizontal) = (earth.gravity_mps2, earth.earth_rate().x);
        let tan_latitude = earth.sin_latitude / earth.cos_latitude;
        // Of an error's effect on φ and δv over H.
        let tilts = |effect: &dyn Fn(usize) -> f64| {
            let force = |axis: usize| effect(DV + axis) / H;
            let rate_east = -effect(PHI + 1) / H;
            let north = force(1) / g;
            [north, -force(0) / g, rate_east / horizontal - north * tan_latitude]
        };
        let mut rows = [[0.0; STATE_COUNT]; 3];
        for state in PARAMETERS..STATE_COUNT {
            let tilts = tilts(&|moving| step.transition.rows[moving][state]);
            (0..3).for_each(|i| rows[i][state] = tilts[i]);
        }
        let mut further = [[0.0; DRIVING_COUNT]; 3];
        if let Some((columns, _)) = &step.further {
            for k in 0..DRIVING_COUNT {
                let tilts = tilts(&|moving| columns[moving][k]);
                (0..3).for_each(|i| further[i][k] = tilts[i]);
            }
        }
        Self { rows, further, earth }
    }

    fn apply(
        &self,
        sigmas: &[f64; STATE_COUNT],
        noise: (f64, f64),
        duration_s: f64,
        covariance: &mut Covariance,
        mean: &mut [f64; STATE_COUNT],
    ) {
        let (g, horizontal) = (self.earth.gravity_mps2, self.earth.earth_rate().x);
        let tan_latitude = self.earth.sin_latitude / self.earth.cos_latitude;
        let tilt = noise.1 / duration_s / (g * g);
        let azimuth = noise.0 / duration_s / (horizontal * horizontal);
        covariance.add(PHI, PHI, tilt);
        covariance.add(PHI + 1, PHI + 1, tilt);
        covariance.add(PHI + 2, PHI + 2, azimuth + tilt * tan_latitude * tan_latitude);
        covariance.add(PHI, PHI + 2, -tilt * tan_latitude);
        for i in 0..3 {
            for state in PARAMETERS..STATE_COUNT {
                let variance = sigmas[state] * sigmas[state];
                covariance.add(PHI + i, state, self.rows[i][state] * variance);
                for j in i..3 {
                    let value = self.rows[i][state] * self.rows[j][state] * variance;
                    covariance.add(PHI + i, PHI + j, value);
                }
            }
            mean[PHI + i] = (PARAMETERS..STATE_COUNT).map(|s| self.rows[i][s] * mean[s]).sum();
        }
    }

    /// Adds the effect of errors beside the parameters.
    fn tilt_by(
        &self,
        truth: &mut FurtherTruth,
        covariance: &mut Covariance,
        mean: &mut [f64; STATE_COUNT],
    ) {
        truth.tilt = self.further;
        for i in 0..3 {
            mean[PHI + i] += sum(&self.further[i], &truth.mean);
            for j in i..3 {
                let each = (0..DRIVING_COUNT)
                    .map(|k| self.further[i][k] * self.further[j][k] * truth.sigma[k].powi(2));
                covariance.add(PHI + i, PHI + j, each.sum());
            }
        }
    }
}
