//! End of a calibration: judgement, parameters and attitude, and the table.

use super::estimation::Estimation;
use super::judgement::{judge, judge_sigmas};
use super::{CalibrationRefusal, Core, kalman_of, prior_after_alignment, strapdown_at};
use crate::alignment::CoarseAlignment;
use crate::compensation::Compensation;
use crate::config::{Estimator, Site};
use crate::covariance::{PARAMETERS, SolutionCovariance};
use crate::filter::ExpectedNis;
use crate::standstill::{AverageUncertainty, StandstillAverage};
use crate::table::{CalibrationTable, Provenance, Quality};
use nalgebra::Vector3;
use octant_earth::ellipsoid::Ellipsoid;
use octant_sample::{DeviceTime, Health, Mode, Output};

impl Core {
    /// Ends the stream. A calibration that still runs is concluded with the data so far, as at the
    /// end of its duration; otherwise nothing changes. Returns the last output with mode and
    /// revision brought up to date.
    pub fn end_of_stream(&mut self) -> Output {
        if self.mode == Mode::Calibrating {
            self.finish_calibration(self.answered.1);
        }
        self.output(Health::empty(), f64::NAN)
    }

    /// Mean NIS that is expected of this run, up to its last measurement; `None` where no further state is considered, and 3
    /// is. A core that was loaded from a state has it from its next measurement on.
    #[must_use]
    pub fn expected_nis(&self) -> Option<&ExpectedNis> {
        self.expected_nis.as_ref()
    }

    /// Samples until the calibration ends by its duration; 0 where it has ended, or there is none.
    #[must_use]
    pub fn samples_to_end(&self) -> u64 {
        match self.mode {
            Mode::Aligning | Mode::Calibrating => self.calibration_ticks.saturating_sub(self.tick),
            _ => 0,
        }
    }

    /// Lets the calibration outlast its duration: [`Self::end_of_stream`] alone ends it. So the filter can be looked at after
    /// its last measurement, with which it otherwise ends.
    pub fn outlast(&mut self) {
        self.calibration_ticks = u64::MAX;
    }

    /// Not inlined: the copies that an adjustment makes would give every step a frame of a hundred
    /// kilobytes, each page of which is touched on entry.
    #[cold]
    #[inline(never)]
    pub(super) fn finish_calibration(&mut self, at: DeviceTime) {
        match self.conclude() {
            Err(refusal) => self.refuse(refusal),
            Ok(quality) => {
                self.table = self.export(at, quality);
                if let Some(filter) = self.filter() {
                    self.concluded = Some(filter.covariance().solution());
                }
                self.start_navigation();
            }
        }
    }

    /// Concludes the estimation: judges it, and sets parameters and attitude.
    fn conclude(&mut self) -> Result<Quality, CalibrationRefusal> {
        if let (Estimation::Kalman(filter), Some(kalman)) =
            (&mut self.estimation, kalman_of(&self.config))
        {
            filter.finish_drift(&self.parameters);
            let period = kalman.aiding_period_ns;
            // A stream that ended early could not bring more measurements.
            let ticks = self.calibration_ticks.min(self.tick);
            let expected = ticks * self.config.sample_period_ns / period;
            let (bridged, gimbal_slips) = (self.bridge.samples, self.slips.count);
            let quality = judge(filter, kalman, expected, (bridged, ticks), gimbal_slips)?;
            if self.unrepaired != 0 {
                return Err(CalibrationRefusal::Disturbed { disturbances: self.unrepaired });
            }
            let duration_s = ticks as f64 * self.sample_s;
            let prior = prior_after_alignment(&self.config, kalman);
            let of_grade = self.config.attitude_of_grade(&prior, duration_s);
            judge_sigmas(filter, &kalman.sigma_limits, of_grade)?;
            return Ok(Quality { bridged, gimbal_slips, ..quality });
        }
        let Some(adjusted) = self.estimation.adjust() else {
            return Err(CalibrationRefusal::Numeric);
        };
        let estimate = adjusted?;
        self.parameters = estimate.parameters;
        self.sigma = estimate.sigma;
        self.revision = self.revision.saturating_add(1);
        self.compensation = Compensation::new(&self.parameters);
        if self.config.navigation.is_some() {
            self.align_at_rest(&estimate.average)?;
        }
        let used = estimate.intervals as u64;
        Ok(Quality { nis_mean: f64::NAN, used, ..Quality::default() })
    }

    /// Sets the attitude from the averages of the last standstill, with its uncertainty.
    fn align_at_rest(
        &mut self,
        uncertainty: &AverageUncertainty,
    ) -> Result<(), CalibrationRefusal> {
        let site = self.config.site;
        let still = self.standstill;
        let elapsed_s = still.elapsed_s;
        let (dtheta, dv) =
            self.compensation.apply(&still.delta_theta, &still.delta_velocity, elapsed_s);
        let mut alignment = CoarseAlignment::new(&site);
        alignment.step(&dtheta, &dv, elapsed_s);
        let q_nb = alignment.finish().ok_or(CalibrationRefusal::Alignment)?;
        // The line through increments that are averages themselves; biases have no slope.
        let centred = still.velocity_moment - still.delta_velocity * (0.5 * elapsed_s);
        let average = StandstillAverage {
            force_mps2: dv / elapsed_s,
            slope_mps3: centred * (12.0 / (elapsed_s * elapsed_s * elapsed_s)),
            rate_radps: dtheta / elapsed_s,
            elapsed_s,
        };
        let earth = Ellipsoid::at(site.latitude_rad, site.height_m);
        let phi = average.phi(&q_nb, uncertainty, &earth)?;
        let phi = core::array::from_fn(|i| core::array::from_fn(|j| phi[(i, j)]));
        // The velocity over ground of a base at rest isn't estimated: it is zero.
        self.concluded = Some(SolutionCovariance { phi, velocity_mps: [f64::NAN; 3] });
        self.strapdown = strapdown_at(&site, &q_nb, Vector3::zeros());
        Ok(())
    }

    fn export(&self, at: DeviceTime, quality: Quality) -> Option<CalibrationTable> {
        let calibration = self.config.calibration.as_ref()?;
        let covariance = core::array::from_fn(|i| {
            core::array::from_fn(|j| match &self.estimation {
                Estimation::Kalman(filter) => {
                    filter.covariance().at(PARAMETERS + i, PARAMETERS + j)
                }
                // Least squares provides standard deviations only.
                _ if i == j => self.sigma[i] * self.sigma[i],
                _ => 0.0,
            })
        });
        let Site { latitude_rad, longitude_rad, height_m } = self.config.site;
        Some(CalibrationTable {
            parameters: self.parameters,
            covariance,
            quality,
            provenance: Provenance {
                ended_ns: at.ns,
                duration_s: calibration.duration_s,
                stops: calibration.sequence.stops().len() as u64
                    * u64::from(calibration.sequence.passes()),
                latitude_rad,
                longitude_rad,
                height_m,
                method: match calibration.estimator {
                    Estimator::Kalman(_) => 0,
                    Estimator::LeastSquares(_) => 1,
                    Estimator::ExternalTurntable(_) => 2,
                },
            },
        })
    }
}
