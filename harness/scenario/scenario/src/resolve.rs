//! Conversion of a scenario to the configurations of plant and core, with values drawn from the seed.
//!
//! Only [`Drawing`] draws; everything else takes the drawn values. Both methods of a scenario use the
//! same draws.

use super::model::{
    AlignmentSpec, DocksideSpec, MOTIONS, Method, MotionSpan, MotionSpec, ParameterDistribution,
    Scenario, case_attitude,
};
use octant_calibration::config as core;
use octant_earth::{UnitQuaternion, Vector3, rotation};
use octant_plant::sea::Spectrum;
use octant_plant::{config as plant, draw};
use octant_sample::Parameters;
use octant_sample::further::FURTHER_COUNT;
#[cfg(doc)]
use octant_sample::further::{FURTHER_NAMES, FurtherGroup};
#[cfg(doc)]
use octant_sample::parameters::ParameterGroup;

/// End of a motion that goes on in a run without an end, s.
const MOTION_ENDS_S: f64 = 1e12;

/// Source of random values. No value depends on whether another one was drawn.
pub trait Drawing {
    /// Draws true parameters from the distribution of each group, in the order of [`ParameterGroup::ALL`].
    fn parameters(&self, distributions: &[ParameterDistribution; 7]) -> Parameters;
    /// Draws errors beside the parameters, in the order of [`FURTHER_NAMES`], from the distribution of each group, in the
    /// order of [`FurtherGroup::ALL`]; zero where there is none.
    fn further(&self, distributions: &[Option<ParameterDistribution>; 15]) -> [f64; FURTHER_COUNT];
    /// Draws attitude error φ (rad) and velocity error (m/s) from the 1σ of tilt (rad), azimuth (rad)
    /// and velocity (m/s).
    fn alignment_error(
        &self,
        tilt_rad: f64,
        azimuth_rad: f64,
        velocity_mps: f64,
    ) -> ([f64; 3], [f64; 3]);
    /// Draws `count` phases of a motion (`roll`, `pitch`, `yaw`, `surge`, `sway`, `heave`), rad.
    fn phases(&self, motion: &str, count: usize) -> Vec<f64>;
    /// Draws sinusoids of a motion with the variance and the shape of a spectrum.
    fn spectrum(&self, motion: &str, spectrum: &Spectrum, count: usize) -> Vec<plant::Sinusoid>;
}

/// Draws from the plant's random streams, with this seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seeded(pub u64);

impl Drawing for Seeded {
    fn parameters(&self, distributions: &[ParameterDistribution; 7]) -> Parameters {
        let [bias, scale, misalignment, g_dependent, accel_bias, accel_scale, accel_misalignment] =
            distributions;
        let draws = draw::ParameterDraws {
            gyro_bias: of_group(bias),
            gyro_scale: of_group(scale),
            gyro_misalignment: of_group(misalignment),
            g_dependent: of_group(g_dependent),
            accel_bias: of_group(accel_bias),
            accel_scale: of_group(accel_scale),
            accel_misalignment: of_group(accel_misalignment),
        };
        draw::parameters(self.0, &draws)
    }

    fn further(&self, distributions: &[Option<ParameterDistribution>; 15]) -> [f64; FURTHER_COUNT] {
        let none = draw::Draw::Constant([0.0; 9]);
        let draws = distributions.each_ref().map(|of| of.as_ref().map_or(none, of_group));
        draw::further(self.0, &draws)
    }

    fn alignment_error(
        &self,
        tilt_rad: f64,
        azimuth_rad: f64,
        velocity_mps: f64,
    ) -> ([f64; 3], [f64; 3]) {
        let error = draw::alignment_error(self.0, tilt_rad, azimuth_rad, velocity_mps);
        (error.phi_rad, error.velocity_mps)
    }

    fn phases(&self, motion: &str, count: usize) -> Vec<f64> {
        draw::phases(self.0, motion, count)
    }

    fn spectrum(&self, motion: &str, spectrum: &Spectrum, count: usize) -> Vec<plant::Sinusoid> {
        // The spectrum has a separate stream, so that single components beside it keep their phases.
        spectrum.components(self.0, &format!("{motion}.spectrum"), count)
    }
}

/// Distribution of the plant for a group of N. The check of the scenario has counted the values; the
/// plant would refuse a missing one as not finite.
fn of_group<const N: usize>(distribution: &ParameterDistribution) -> draw::Draw<N> {
    match distribution {
        ParameterDistribution::Normal(sigma) => draw::Draw::Normal { sigma: *sigma },
        ParameterDistribution::Uniform(half_width) => {
            draw::Draw::Uniform { half_width: *half_width }
        }
        ParameterDistribution::Constant(values) => {
            draw::Draw::Constant(std::array::from_fn(|index| {
                values.get(index).copied().unwrap_or(f64::NAN)
            }))
        }
    }
}

/// Values drawn from the seed before a run.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnValues {
    /// True parameters.
    pub parameters: Parameters,
    /// Errors beside the parameters, in the order of [`FURTHER_NAMES`]: they add to those that the scenario gives.
    pub further: [f64; FURTHER_COUNT],
    /// Roll, pitch, yaw, surge, sway, heave of the ship: components with their phases, then those of
    /// the spectrum. Empty if static.
    pub motion: [Vec<plant::Sinusoid>; 6],
    /// Error of the initial attitude, φ north, east, down, rad.
    pub attitude_error_rad: [f64; 3],
    /// Error of the initial velocity, m/s.
    pub velocity_error_mps: [f64; 3],
}

impl DrawnValues {
    /// Draws the values that the scenario leaves open, and takes the given ones.
    pub fn of(scenario: &Scenario, drawing: &impl Drawing) -> Self {
        let mut motion: [Vec<plant::Sinusoid>; 6] = Default::default();
        if let MotionSpec::Dockside(ship) = &scenario.motion {
            for (index, name) in MOTIONS.into_iter().enumerate() {
                motion[index] = sinusoids(ship, index, name, drawing);
            }
        }
        let (attitude_error_rad, velocity_error_mps) = match scenario.alignment {
            AlignmentSpec::Coarse { .. } | AlignmentSpec::Inertial { .. } => ([0.0; 3], [0.0; 3]),
            AlignmentSpec::Given {
                tilt_rad,
                azimuth_rad,
                velocity_mps,
                attitude_error_rad,
                velocity_error_mps,
            } => {
                let drawn = drawing.alignment_error(tilt_rad, azimuth_rad, velocity_mps);
                (attitude_error_rad.unwrap_or(drawn.0), velocity_error_mps.unwrap_or(drawn.1))
            }
        };
        Self {
            parameters: drawing.parameters(&scenario.parameters),
            further: drawing.further(&scenario.further),
            motion,
            attitude_error_rad,
            velocity_error_mps,
        }
    }
}

/// Sinusoids of one of a ship's motions.
fn sinusoids(
    ship: &DocksideSpec,
    index: usize,
    name: &str,
    drawing: &impl Drawing,
) -> Vec<plant::Sinusoid> {
    let components = &ship.components[index];
    // A given phase doesn't change the draws of other components.
    let drawn = drawing.phases(name, components.len());
    let single = components.iter().zip(drawn).map(|(component, drawn)| plant::Sinusoid {
        amplitude: component.amplitude,
        period_s: component.period_s,
        phase_rad: component.phase_rad.unwrap_or(drawn),
    });
    let mut all: Vec<plant::Sinusoid> = single.collect();
    if let Some(spectrum) = ship.spectrum.filter(|spectrum| spectrum.sigma[index] > 0.0) {
        let significant = 4.0 * spectrum.sigma[index];
        let shape = Spectrum::pierson_moskowitz(significant, spectrum.peak_period_s);
        all.extend(drawing.spectrum(name, &shape, spectrum.components));
    }
    all
}

impl Scenario {
    /// Configuration of the plant.
    #[must_use]
    pub fn plant(&self, seed: u64, draws: &DrawnValues) -> plant::PlantConfig {
        let (extensions, gravity, turntable) = self.true_errors(draws);
        plant::PlantConfig {
            sample_period_ns: self.sample_period_ns,
            seed,
            calibration_samples: self.reference_samples(),
            site: plant::PlantSite { gravity, ..self.site },
            motion: self.plant_motion(draws),
            turntable,
            imu: plant::Imu { parameters: draws.parameters, extensions, ..self.imu },
            aiding: self.aiding,
        }
    }

    /// Errors of the instrument beside its parameters, of gravity, and of the turntable, with their draws.
    fn true_errors(
        &self,
        draws: &DrawnValues,
    ) -> (plant::Extensions, plant::GravityDisturbance, plant::TurntableConfig) {
        let (mut extensions, mut gravity) = (self.imu.extensions.clone(), self.site.gravity);
        let mut turntable = self.turntable;
        octant_plant::further::add(&draws.further, &mut extensions, &mut gravity, &mut turntable);
        (extensions, gravity, turntable)
    }

    /// True values of the errors beside the parameters, SI, in the order of [`FURTHER_NAMES`]; `None` for a process that
    /// changes over time, and for the eccentricity of encoders with a drawn curve.
    #[must_use]
    pub fn true_further(&self, draws: &DrawnValues) -> [Option<f64>; FURTHER_COUNT] {
        let (extensions, gravity, turntable) = self.true_errors(draws);
        octant_plant::further::truth(&extensions, &gravity, &turntable)
    }

    fn plant_motion(&self, draws: &DrawnValues) -> plant::Motion {
        let ship = match &self.motion {
            MotionSpec::Static(mean) => return plant::Motion::Static(*mean),
            MotionSpec::Dockside(ship) => ship,
        };
        let [roll, pitch, yaw, surge, sway, heave] = draws.motion.clone();
        let (mean, mooring_offset_m) = (ship.mean, ship.mooring_offset_m);
        plant::Motion::Dockside(plant::Dockside {
            mean,
            roll,
            pitch,
            yaw,
            surge,
            sway,
            heave,
            mooring_offset_m,
            times: ship.span.map_or_else(plant::MotionTimes::default, |span| self.times(&span)),
        })
    }

    /// Times at which the case moves: in each run-up of a heading test, or once.
    fn times(&self, span: &MotionSpan) -> plant::MotionTimes {
        let run_up_s =
            self.run_up_samples().map(|samples| (samples * self.sample_period_ns) as f64 * 1e-9);
        let (from_s, to_s) = span.from_to_s();
        // A motion that goes on ends after the run-up.
        let to_s = to_s.or(run_up_s).unwrap_or(MOTION_ENDS_S);
        let run_ups = self.heading_test.map_or(1, |test| test.run_ups);
        let every_s = self.run_up_every_s().unwrap_or_default();
        let during_s = (0..run_ups).map(|number| {
            let began_s = f64::from(number) * every_s;
            [began_s + from_s, began_s + to_s]
        });
        plant::MotionTimes { during_s: during_s.collect(), ramp_s: span.ramp_s }
    }

    /// Configuration of the core for one of the two methods; `None` if the scenario has no baseline.
    ///
    /// The initial attitude is the true one with the drawn error: `c_nb(computed) =
    /// (I − [φ×]) c_nb(true)`. `true_q_nb` and `true_velocity_mps` are the truth at the start.
    #[must_use]
    pub fn core(
        &self,
        method: Method,
        draws: &DrawnValues,
        true_q_nb: &UnitQuaternion<f64>,
        true_velocity_mps: &Vector3<f64>,
    ) -> Option<core::CoreConfig> {
        let calibration = match method {
            Method::Primary => self.calibration.as_ref(),
            Method::Baseline => Some(self.baseline.as_ref()?),
        };
        Some(core::CoreConfig {
            sample_period_ns: self.sample_period_ns,
            site: core::Site {
                latitude_rad: self.site.latitude_rad,
                longitude_rad: self.site.longitude_rad,
                height_m: self.site.height_m,
            },
            alignment: match self.alignment {
                AlignmentSpec::Coarse { duration_s } => core::Alignment::Coarse { duration_s },
                AlignmentSpec::Inertial { duration_s } => core::Alignment::Inertial { duration_s },
                AlignmentSpec::Given { .. } => core::Alignment::Given {
                    q_nb: with_error(true_q_nb, draws.attitude_error_rad),
                    velocity_mps: true_velocity_mps + Vector3::from(draws.velocity_error_mps),
                },
            },
            calibration: calibration.map(|calibration| core::Calibration {
                sequence: calibration.sequence.clone(),
                duration_s: calibration.duration_s,
                estimator: calibration.estimator,
            }),
            navigation: self.navigation.clone().map(|plan| match self.run_up_every_s() {
                // Of several run-ups each ends by its power, not by itself.
                Some(_) => core::NavigationPlan { duration_s: None, ..plan },
                None => plan,
            }),
            turntable: core::TurntableRates {
                rate_radps: self.turntable.rate_radps,
                acceleration_radps2: self.turntable.acceleration_radps2,
            },
            noise: core::Noise {
                angle_random_walk: self.imu.angle_random_walk,
                velocity_random_walk: self.imu.velocity_random_walk,
            },
            initial_parameters: self.initial_parameters,
            screening: self.screening_for(draws),
        })
    }

    /// Screening with its bounds: motion of the base, noise of the encoders, resolution of the
    /// increments, vibration.
    fn screening_for(&self, draws: &DrawnValues) -> core::Screening {
        let extensions = &self.imu.extensions;
        let vibration = extensions.vibration.map_or((0.0, 0.0), |vibration| {
            // Two increments differ by at most four amplitudes of the angle, and of the velocity;
            // gravity turns with the angle.
            let omega = 2.0 * std::f64::consts::PI * vibration.frequency_hz;
            let angle = Vector3::from(vibration.angle_rad).norm();
            let speed = Vector3::from(vibration.displacement_m).norm() * omega;
            let sample_s = self.sample_period_ns as f64 * 1e-9;
            (4.0 * angle, 4.0 * speed + 2.0 * 9.81 * angle * sample_s)
        });
        core::Screening {
            base: match self.plant_motion(draws) {
                plant::Motion::Static(_) => core::Base::Still,
                plant::Motion::Dockside(ship) => core::Base::Moving(bounds(&ship)),
            },
            encoder_sigma_rad: self.turntable.encoder_sigma_rad,
            resolution: (extensions.gyro_quantization_rad, extensions.accel_quantization_mps),
            vibration,
            ..self.screening
        }
    }

    /// Mean attitude of the case with the gimbals at zero, `q_nb`: the true one when static.
    #[must_use]
    pub fn mean_attitude(&self) -> UnitQuaternion<f64> {
        match &self.motion {
            MotionSpec::Static(mean) => case_attitude(mean),
            MotionSpec::Dockside(ship) => case_attitude(&ship.mean),
        }
    }
}

/// Bounds of a ship's motion: the sum of the amplitudes of all its components on all axes, doubled,
/// because a sway is never known that well.
fn bounds(ship: &plant::Dockside) -> core::BaseMotion {
    let largest = |motions: [&[plant::Sinusoid]; 3], order: i32| {
        let of = |s: &plant::Sinusoid| {
            let omega = 2.0 * std::f64::consts::PI / s.period_s;
            s.amplitude.abs() * (0..order).map(|_| omega).product::<f64>()
        };
        2.0 * motions.into_iter().flatten().map(of).sum::<f64>()
    };
    let angles = [&ship.roll[..], &ship.pitch, &ship.yaw];
    let shifts = [&ship.surge[..], &ship.sway, &ship.heave];
    core::BaseMotion {
        angle_rad: largest(angles, 0),
        rate_radps: largest(angles, 1),
        acceleration_radps2: largest(angles, 2),
        force_mps2: largest(shifts, 2),
        jerk_mps3: largest(shifts, 3),
    }
}

/// Applies an error φ (rad, in n) to an attitude: the rotation whose first order is `I − [φ×]`.
fn with_error(truth: &UnitQuaternion<f64>, phi_rad: [f64; 3]) -> UnitQuaternion<f64> {
    rotation::exp(&-Vector3::from(phi_rad)) * truth
}

#[cfg(test)]
mod tests {
    use super::*;
    use octant_earth::{Matrix3, frames, units::DEG};

    fn drawn(text: &str) -> DrawnValues {
        let text = format!("schema = 1\n[procedure.calibration]\n{text}");
        let scenario = Scenario::parse(&text, "f", std::path::Path::new(""), &[]).unwrap();
        DrawnValues::of(&scenario, &Seeded(7))
    }

    #[test]
    fn a_changed_distribution_moves_no_other_draw() {
        use octant_sample::parameters::ParameterGroup;
        let ship = "[motion]\nkind = \"dockside\"\n[motion.ship]\n\
                    roll = [{ amplitude = \"1 deg\", period = \"8 s\" }]\n";
        let all = drawn(ship);
        let changes = [
            "normal = \"1 deg/h\"",
            "uniform = \"7 ppm\"",
            "normal = \"5 arcsec\"",
            "uniform = \"0.1 deg/h/g\"",
            "constant = [\"1 ug\", \"2 ug\", \"3 ug\"]",
            "normal = \"1 ppm\"",
            "normal = \"1 arcsec\"",
        ];
        for (group, change) in ParameterGroup::ALL.into_iter().zip(changes) {
            let other = drawn(&format!("{ship}[imu.{}]\n{change}\n", group.name()));
            let [before, after] = [&all, &other].map(|draws| draws.parameters.to_array());
            for index in 0..before.len() {
                let moved = before[index] != after[index];
                assert_eq!(moved, group.range().contains(&index), "{change}: {index}");
            }
            assert_eq!(DrawnValues { parameters: all.parameters, ..other }, all, "{change}");
        }
        // Errors beside the parameters, all groups of them.
        let drawn_too = "[imu.extensions.drawn]\nlever_arm = { normal = \"3 cm\" }\n\
                         gyro_asymmetry = { uniform = \"30 ppm\" }\naccel_asymmetry = { normal = \"30 ppm\" }\n\
                         accel_quadratic = { normal = \"20 ug/g^2\" }\n\
                         gyro_bias_temperature = { normal = \"0.001 deg/h/K\" }\n\
                         gyro_scale_temperature = { uniform = \"1 ppm/K\" }\n\
                         accel_bias_temperature = { normal = \"5 ug/K\" }\n\
                         accel_scale_temperature = { normal = \"1 ppm/K\" }\n\
                         [imu.extensions.temperature]\nramp = \"1 K/h\"\nplateau = \"2 K\"\n[site.drawn]\n\
                         deflection = { normal = \"10 arcsec\" }\ngravity_anomaly = { normal = \"50 ug\" }\n\
                         [turntable.drawn]\nmounting = { normal = \"1 arcmin\" }\n\
                         non_orthogonality = { normal = \"20 arcsec\" }\neccentricity = { uniform = \"5 arcsec\" }\n";
        let other = drawn(&format!("{ship}{drawn_too}"));
        let processes = 18..24;
        for (index, value) in other.further.iter().enumerate() {
            assert_eq!(*value == 0.0, processes.contains(&index), "{index}");
        }
        assert_eq!(all.further, [0.0; FURTHER_COUNT]);
        assert_eq!(DrawnValues { further: all.further, ..other }, all);
        // A spectrum beside a component, or another alignment, doesn't change other draws either.
        let spectrum = "spectrum = { peak_period = \"9 s\", roll = \"2 deg\", components = 5 }\n";
        let other = drawn(&format!("{ship}{spectrum}[procedure.alignment]\ntilt = \"0.1 deg\"\n"));
        assert_eq!(other.parameters, all.parameters);
        assert_eq!(other.velocity_error_mps, all.velocity_error_mps);
        assert_eq!(other.attitude_error_rad[2], all.attitude_error_rad[2]);
        assert_eq!(other.motion[0][0], all.motion[0][0]);
        assert_eq!(other.motion[0].len(), 6);
        let variance: f64 =
            other.motion[0][1..].iter().map(|s| 0.5 * s.amplitude * s.amplitude).sum();
        assert!((libm::sqrt(variance) / (2.0 * DEG) - 1.0).abs() < 1e-12, "{variance}");
    }

    #[test]
    fn the_attitude_error_has_the_sign_of_phi() {
        let truth = frames::quaternion_from_matrix(&frames::c_nc(0.7, -0.2, 0.1));
        let phi = [2e-4, -3e-4, 1.7e-3];
        let computed = with_error(&truth, phi);
        let expected = (Matrix3::identity() - rotation::skew(&Vector3::from(phi)))
            * truth.to_rotation_matrix().matrix();
        let difference = computed.to_rotation_matrix().matrix() - expected;
        assert!(difference.norm() < (0.1 * DEG).powi(2), "second order: {difference}");
        assert!((frames::phi_of(&computed, &truth) - Vector3::from(phi)).norm() < 1e-12);
    }
}
