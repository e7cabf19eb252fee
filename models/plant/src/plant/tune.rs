//! Changes of a plant that runs.
//!
//! The coefficients of the sensors, their white noise and ranges, and the noise of the reference have no memory: a
//! sample follows from their present values alone. Everything else stays. A motion, a mounting or a lever arm that
//! jumped would be a move that no sensor feels; the processes and the quantizers carry a state in units of what would
//! change.

use super::Plant;
use crate::config::{AidingKind, AidingSource, Extensions, Imu, PlantConfig};
use crate::imu::Sensors;
use crate::validate::{PlantConfigError, validate};

impl Plant {
    /// Changes the configuration from the next interval on: the parameters of the sensors, their white noise and
    /// ranges, and the noise of the reference. Random numbers stay those of their samples. A configuration equal to the
    /// present one changes no bit.
    ///
    /// # Errors
    /// If a field is out of its range, or one differs that can't change; then nothing has changed.
    pub fn tune(&mut self, config: &PlantConfig) -> Result<(), PlantConfigError> {
        if *config == *self.config {
            return Ok(());
        }
        validate(config)?;
        let present = &*self.config;
        let tuned = PlantConfig {
            imu: Imu {
                parameters: config.imu.parameters,
                angle_random_walk: config.imu.angle_random_walk,
                velocity_random_walk: config.imu.velocity_random_walk,
                extensions: Extensions {
                    gyro_range_radps: config.imu.extensions.gyro_range_radps,
                    accel_range_mps2: config.imu.extensions.accel_range_mps2,
                    ..present.imu.extensions.clone()
                },
            },
            aiding: AidingSource {
                kind: with_noise_of(present.aiding.kind, config.aiding.kind),
                ..present.aiding
            },
            ..present.clone()
        };
        if tuned != *config {
            return Err(PlantConfigError {
                field: first_difference(&tuned, config).to_owned(),
                found: "another value".to_owned(),
                expected: "that of the start, because it can't change in a plant that runs"
                    .to_owned(),
            });
        }
        let dt = tuned.sample_period_ns as f64 * 1e-9;
        self.sensors.tune(&Sensors::new(&tuned.imu, dt, tuned.seed));
        self.aider.tune(tuned.aiding.kind);
        // At rest it isn't read again.
        self.reading = self.sensors.read(&self.increments);
        *self.config = tuned;
        Ok(())
    }
}

/// The kind of a reference with the noise of another of the same kind.
fn with_noise_of(kind: AidingKind, other: AidingKind) -> AidingKind {
    match (kind, other) {
        (AidingKind::ZeroVelocity { .. }, AidingKind::ZeroVelocity { .. })
        | (AidingKind::Velocity { .. }, AidingKind::Velocity { .. })
        | (AidingKind::DockPosition { .. }, AidingKind::DockPosition { .. }) => other,
        _ => kind,
    }
}

/// Name of the first part of a configuration that differs.
fn first_difference(a: &PlantConfig, b: &PlantConfig) -> &'static str {
    let parts = [
        ("sample_period_ns", a.sample_period_ns != b.sample_period_ns),
        ("seed", a.seed != b.seed),
        ("calibration_samples", a.calibration_samples != b.calibration_samples),
        ("site", a.site != b.site),
        ("motion", a.motion != b.motion),
        ("turntable", a.turntable != b.turntable),
        ("aiding", a.aiding != b.aiding),
    ];
    parts.iter().find(|(_, differs)| *differs).map_or("imu.extensions", |(name, _)| name)
}
