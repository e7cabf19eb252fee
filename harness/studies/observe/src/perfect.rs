//! Posterior σ of a filter with further states, from a run of it on a perfect instrument.
//!
//! The covariance of a Kalman filter doesn't depend on the values that it measures, only on the motion and the times. So
//! the filter itself, run with an instrument without errors and noise, tells what a sequence shows: of the further
//! states too, which [`covariance`](super::covariance) doesn't carry.

use octant_calibration::Core;
use octant_calibration::config::{Alignment, CoreConfig, Estimator, Screening};
use octant_earth::{UnitQuaternion, Vector3};
use octant_plant::Plant;
use octant_plant::config::{AidingKind, Extensions, Imu, Motion, Temperature};
use octant_sample::further::FurtherEstimates;
use octant_sample::parameters::PARAMETER_COUNT;
use octant_sample::{GimbalCommand, Mode, Parameters};
use octant_scenario::{Method, MotionSpec, Scenario};
use octant_source::configure::configurations;

/// σ of a filter at the end of its calibration, SI.
#[derive(Clone, Copy, Debug)]
pub struct FilterSigmas {
    /// σ of the parameters, in their order.
    pub parameters: [f64; PARAMETER_COUNT],
    /// Further states with their σ; `None` without any.
    pub further: Option<FurtherEstimates>,
}

/// Reasons why a filter can't be run on a perfect instrument.
#[derive(Debug, thiserror::Error)]
pub enum PerfectError {
    /// The scenario has no configuration.
    #[error(transparent)]
    Configuration(#[from] octant_source::configure::ConfigurationError),
    /// The plant can't be made.
    #[error("make a perfect instrument: {0}")]
    Plant(#[from] octant_plant::PlantConfigError),
    /// The core can't be made.
    #[error("make the core: {0}")]
    Core(#[from] octant_calibration::state_machine::CoreConfigError),
    /// The core refused its calibration.
    #[error("run the filter on a perfect instrument: its calibration was refused: {0}")]
    Refused(String),
}

/// Runs the filter of a scenario's method to the end of its calibration, with an instrument without errors and noise in
/// a case that stands still. The screens are off: an instrument without noise repeats its counts.
///
/// # Errors
/// If a configuration contradicts itself, or the core refuses its calibration.
pub fn run(scenario: &Scenario, method: Method) -> Result<FilterSigmas, PerfectError> {
    let (mut plant, mut core, _) = perfect_instrument(scenario, method, |screening| Screening {
        base: screening.base,
        ..Screening::none()
    })?;
    let mut command = GimbalCommand::default();
    loop {
        let step = plant.step(&command);
        core.feel(plant.temperature_c());
        let output = core.step(&step.sample, step.aiding.as_ref());
        command = output.gimbal_command;
        if !matches!(output.mode, Mode::Aligning | Mode::Calibrating) {
            break;
        }
    }
    if let Some(refusal) = core.refusal() {
        return Err(PerfectError::Refused(refusal.to_string()));
    }
    Ok(FilterSigmas { parameters: *core.sigma(), further: core.further().copied() })
}

/// An instrument without errors and noise in a case that stands still, and the core of a scenario's method with the
/// screens that `screening` makes of its own; and the configuration of that core.
pub(crate) fn perfect_instrument(
    scenario: &Scenario,
    method: Method,
    screening: impl FnOnce(&Screening) -> Screening,
) -> Result<(Plant, Core, CoreConfig), PerfectError> {
    let (mut plant, config, _) = configurations(scenario, method, scenario.seed)?;
    plant.motion = Motion::Static(match &scenario.motion {
        MotionSpec::Static(mean) => *mean,
        MotionSpec::Dockside(ship) => ship.mean,
    });
    // A filter that knows of it is told the temperature: its course is no error.
    let temperature = plant.imu.extensions.temperature.map(|temperature| Temperature {
        gyro_bias_per_k: [0.0; 3],
        accel_bias_per_k: [0.0; 3],
        gyro_scale_per_k: [0.0; 3],
        accel_scale_per_k: [0.0; 3],
        ..temperature
    });
    plant.imu = Imu {
        parameters: Parameters::default(),
        angle_random_walk: 0.0,
        velocity_random_walk: 0.0,
        extensions: Extensions { temperature, ..Extensions::default() },
    };
    plant.turntable.encoder_sigma_rad = 0.0;
    plant.turntable.errors = Default::default();
    let estimator = config.calibration.as_ref().map(|calibration| &calibration.estimator);
    if matches!(estimator, Some(Estimator::Kalman(kalman)) if kalman.further.attitude_at_rest().is_some())
    {
        plant.turntable.non_orthogonality_rad = 0.0;
    }
    plant.site.gravity = Default::default();
    plant.aiding.kind = match plant.aiding.kind {
        AidingKind::ZeroVelocity { .. } => AidingKind::ZeroVelocity { sigma_mps: 0.0 },
        AidingKind::Velocity { .. } => AidingKind::Velocity { sigma_mps: 0.0 },
        AidingKind::DockPosition { .. } => AidingKind::DockPosition { sigma_m: 0.0 },
    };
    let plant = Plant::new(&plant)?;
    let [w, x, y, z] = plant.truth().q_nb;
    let q_nb = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(w, x, y, z));
    let config = CoreConfig {
        alignment: Alignment::Given { q_nb, velocity_mps: Vector3::zeros() },
        navigation: None,
        initial_parameters: Parameters::default(),
        screening: screening(&config.screening),
        ..config
    };
    let core = Core::new(&config)?;
    Ok((plant, core, config))
}
