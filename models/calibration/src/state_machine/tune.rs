//! Changes of a core that runs.
//!
//! The gate, the noise of the reference, the check of its stamp and the limits of refusal are asked at each measurement,
//! or at the end: whatever they were before leaves no trace. Everything else stays: the procedure is planned, and screens
//! and filter carry a state that follows from it.

use super::{Core, CoreConfigError, Estimation, check};
use crate::config::{AidingMode, Calibration, CoreConfig, Estimator, Kalman};

impl Core {
    /// Changes the configuration from the next measurement on: the gate of the innovations and its recovery, the
    /// standard deviation of the reference, the check of the reference's stamp, and the limits of mean NIS and drift
    /// above which the calibration is refused. A configuration equal to the present one changes no bit.
    ///
    /// # Errors
    /// If the configuration contradicts itself, or something differs that can't change; then nothing has changed.
    pub fn tune(&mut self, config: &CoreConfig) -> Result<(), CoreConfigError> {
        if *config == self.config {
            return Ok(());
        }
        check::check(config)?;
        let mut tuned = self.config.clone();
        tuned.screening.gate = config.screening.gate;
        tuned.screening.aiding_stamps = config.screening.aiding_stamps;
        if let (Some(limit), Some(new)) =
            (&mut tuned.screening.drift_sigmas, config.screening.drift_sigmas)
        {
            *limit = new;
        }
        if let (Some(kalman), Some(new)) = (kalman_mut(&mut tuned), super::kalman_of(config)) {
            let limit = new.refuse_above_mean_nis;
            if limit.is_nan() {
                return Err(CoreConfigError::NotFinite {
                    field: "limit of the mean NIS",
                    found: limit,
                });
            }
            kalman.refuse_above_mean_nis = limit;
            match (&mut kalman.aiding, new.aiding) {
                (
                    AidingMode::Velocity { sigma_mps: sigma },
                    AidingMode::Velocity { sigma_mps: new },
                )
                | (
                    AidingMode::Position { sigma_m: sigma },
                    AidingMode::Position { sigma_m: new },
                ) => {
                    *sigma = new;
                }
                _ => {}
            }
        }
        if tuned != *config {
            return Err(CoreConfigError::Fixed { part: first_difference(&tuned, config) });
        }
        if let (Estimation::Kalman(filter), Some(kalman)) =
            (&mut self.estimation, super::kalman_of(&tuned))
        {
            filter.tune(kalman, &tuned.screening);
        }
        self.config = tuned;
        Ok(())
    }
}

fn kalman_mut(config: &mut CoreConfig) -> Option<&mut Kalman> {
    match &mut config.calibration {
        Some(Calibration { estimator: Estimator::Kalman(kalman), .. }) => Some(kalman),
        _ => None,
    }
}

/// Name of the first part of a configuration that differs.
fn first_difference(a: &CoreConfig, b: &CoreConfig) -> &'static str {
    let parts = [
        ("the sample period", a.sample_period_ns != b.sample_period_ns),
        ("the site", a.site != b.site),
        ("the alignment", a.alignment != b.alignment),
        ("the calibration", a.calibration != b.calibration),
        ("the navigation", a.navigation != b.navigation),
        ("the turntable", a.turntable != b.turntable),
        ("the noise", a.noise != b.noise),
        ("an initial parameter", a.initial_parameters != b.initial_parameters),
    ];
    parts.iter().find(|(_, differs)| *differs).map_or("a screen", |(name, _)| name)
}
