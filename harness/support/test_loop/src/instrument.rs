//! Plant and core of the reference instrument, put together without a scenario file.

use nalgebra::UnitQuaternion;
use octant_calibration::config::{self as core, *};
use octant_calibration::positions::{Degrees, SIXTEEN, from_degrees};
use octant_earth::rotation::exp;
use octant_earth::units::*;
use octant_plant::config as plant;
use octant_plant::draw::{Draw, ParameterDraws, alignment_error, parameters};
use octant_sample::Parameters;

/// Sample period, ns: 200 Hz.
pub const PERIOD_NS: u64 = 5_000_000;
/// Latitude of the instrument, rad.
pub const LATITUDE_RAD: f64 = 30.5 * DEG;

/// One method on one seed of the reference instrument.
pub struct InstrumentCase {
    /// Seed of the instrument and its noise.
    pub seed: u64,
    /// Positions, as azimuth and roll.
    pub positions: &'static [Degrees],
    /// Number of passes through the positions.
    pub passes: u32,
    /// Length of the calibration, h.
    pub calibration_h: f64,
    /// Length of the navigation after it, h.
    pub navigation_h: f64,
    /// Standard deviation of the g-dependent gyro biases, °/h/g.
    pub g_dph_per_g: f64,
    /// True if the filter has states for them.
    pub g_states: bool,
    /// Angle random walk, °/√h.
    pub angle_random_walk: f64,
}

impl InstrumentCase {
    /// Four hours of calibration of the instrument of Table 1.
    pub fn table_1(seed: u64, positions: &'static [Degrees]) -> Self {
        Self {
            seed,
            positions,
            passes: 1,
            calibration_h: 4.0,
            navigation_h: 0.0,
            g_dph_per_g: 5e-4,
            g_states: true,
            angle_random_walk: 7e-4,
        }
    }

    /// Configuration of the plant.
    pub fn plant(&self) -> plant::PlantConfig {
        let draws = ParameterDraws {
            g_dependent: Draw::Normal { sigma: self.g_dph_per_g * DEG_PER_HOUR_PER_G },
            ..ParameterDraws::table_1()
        };
        plant::PlantConfig {
            sample_period_ns: PERIOD_NS,
            seed: self.seed,
            calibration_samples: (self.calibration_h * 3600.0 * 200.0) as u64,
            site: plant::PlantSite {
                latitude_rad: LATITUDE_RAD,
                longitude_rad: 2.0,
                height_m: 0.0,
                gravity: plant::GravityDisturbance::default(),
            },
            motion: plant::Motion::Static(plant::CaseAttitude::default()),
            turntable: plant::TurntableConfig {
                rate_radps: 10.0 * DEG,
                acceleration_radps2: 10.0 * DEG,
                encoder_sigma_rad: 18.0 * ARCSEC,
                non_orthogonality_rad: 0.0,
                backlash_rad: 0.0,
                errors: Default::default(),
            },
            imu: plant::Imu {
                parameters: parameters(self.seed, &draws),
                angle_random_walk: self.angle_random_walk * DEG_PER_SQRT_HOUR,
                velocity_random_walk: 50.0 * MICRO_G,
                extensions: plant::Extensions::default(),
            },
            aiding: plant::AidingSource {
                kind: plant::AidingKind::ZeroVelocity { sigma_mps: 1e-3 },
                period_ns: 1_000_000_000,
            },
        }
    }

    /// Configuration of the core.
    pub fn core(&self) -> core::CoreConfig {
        let error = alignment_error(self.seed, 60.0 * ARCSEC, 0.1 * DEG, 0.02);
        let phi = nalgebra::Vector3::from(error.phi_rad);
        let mut estimated = [true; 7];
        estimated[octant_sample::parameters::ParameterGroup::GDependent as usize] = self.g_states;
        core::CoreConfig {
            sample_period_ns: PERIOD_NS,
            site: Site { latitude_rad: LATITUDE_RAD, longitude_rad: 2.0, height_m: 0.0 },
            alignment: Alignment::Given {
                // computed = (I − [φ×]) true
                q_nb: exp(&-phi) * UnitQuaternion::identity(),
                velocity_mps: error.velocity_mps.into(),
            },
            calibration: Some(Calibration {
                sequence: from_degrees(self.positions, self.passes).unwrap(),
                duration_s: self.calibration_h * 3600.0,
                estimator: Estimator::Kalman(Kalman {
                    error_model: ErrorModel::Phi,
                    estimated,
                    prior: Prior {
                        attitude_rad: [60.0 * ARCSEC, 60.0 * ARCSEC, 0.1 * DEG],
                        velocity_mps: 0.02,
                        position_m: 1.0,
                        parameters: [
                            0.005 * DEG_PER_HOUR,
                            30.0 * PPM,
                            40.0 * ARCSEC,
                            self.g_dph_per_g * DEG_PER_HOUR_PER_G,
                            100.0 * MICRO_G,
                            30.0 * PPM,
                            40.0 * ARCSEC,
                        ],
                    },
                    aiding: AidingMode::Velocity { sigma_mps: 1e-3 },
                    aiding_period_ns: 1_000_000_000,
                    sway: SwayNoise::White,
                    refuse_above_mean_nis: 9.0,
                    further: Default::default(),
                    sigma_limits: Default::default(),
                }),
            }),
            navigation: (self.navigation_h > 0.0).then(|| NavigationPlan {
                duration_s: Some(self.navigation_h * 3600.0),
                rotation: from_degrees(SIXTEEN, 1).unwrap(),
                dwell_s: 300.0,
            }),
            turntable: TurntableRates { rate_radps: 10.0 * DEG, acceleration_radps2: 10.0 * DEG },
            noise: Noise {
                angle_random_walk: self.angle_random_walk * DEG_PER_SQRT_HOUR,
                velocity_random_walk: 50.0 * MICRO_G,
            },
            initial_parameters: Parameters::default(),
            screening: Screening::hardened(Base::Still),
        }
    }
}

/// Returns bounds of a moored ship's motion: the sums of its sinusoids' amplitudes, on all axes,
/// doubled.
pub fn base_of(ship: &plant::Dockside) -> Base {
    let bound = |motions: [&Vec<plant::Sinusoid>; 3], order: i32| -> f64 {
        let sum: f64 = motions
            .into_iter()
            .flatten()
            .map(|s| s.amplitude * (2.0 * std::f64::consts::PI / s.period_s).powi(order))
            .sum();
        2.0 * sum
    };
    let angles = [&ship.roll, &ship.pitch, &ship.yaw];
    let shifts = [&ship.surge, &ship.sway, &ship.heave];
    Base::Moving(BaseMotion {
        angle_rad: bound(angles, 0),
        rate_radps: bound(angles, 1),
        acceleration_radps2: bound(angles, 2),
        force_mps2: bound(shifts, 2),
        jerk_mps3: bound(shifts, 3),
    })
}

fn kalman(config: &mut CoreConfig) -> &mut Kalman {
    match &mut config.calibration.as_mut().unwrap().estimator {
        Estimator::Kalman(kalman) => kalman,
        _ => unreachable!(),
    }
}

/// Configures the case on a moored ship: dock position, sway as white noise. The given attitude is
/// level, unlike the ship's at time 0: the case rolls by up to 3°.
pub fn dockside(case: &InstrumentCase) -> (plant::PlantConfig, CoreConfig) {
    let (mut plant, mut core) = (case.plant(), case.core());
    let ship = octant_plant::motion::dockside_default(case.seed);
    core.screening.base = base_of(&ship);
    core.screening.drift_sigmas = Some(octant_calibration::drift::LIMIT_MOVING_SIGMAS);
    plant.motion = plant::Motion::Dockside(ship);
    plant.aiding.kind = plant::AidingKind::DockPosition { sigma_m: 0.01 };
    let truth = octant_plant::Plant::new(&plant).unwrap().truth();
    if let Alignment::Given { q_nb, velocity_mps } = &mut core.alignment {
        let [w, i, j, k] = truth.q_nb;
        *q_nb *= UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(w, i, j, k));
        *velocity_mps += nalgebra::Vector3::from(truth.velocity_mps);
    }
    kalman(&mut core).aiding = AidingMode::Position { sigma_m: 0.15 };
    (plant, core)
}
