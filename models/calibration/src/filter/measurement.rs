//! Use of a reference: gate, update, and feedback into navigation and parameters.

use super::sway::SwayStates;
use super::{AngleResult, CalibrationFilter, Stage};
use crate::config::{AidingMode, ErrorModel, Recovery};
use crate::covariance::{DR, DV, PARAMETERS, PHI, STATE_COUNT};
use crate::error_model::computer_frame_error;
use crate::strapdown::Strapdown;
use nalgebra::{Matrix3, Vector3};
use octant_sample::{GimbalAngles, Innovation, InnovationOf, Parameters, Reference};

/// Result of a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasurementResult {
    /// Normalized innovation squared over three axes; expected mean 3.
    pub nis: f64,
    /// Innovation of each axis.
    pub innovation: Innovation,
    /// True if the gate rejected the measurement.
    pub rejected: bool,
    /// True if the measurement started a recovery.
    pub recovery_started: bool,
    /// Angle by which the measurement turned the attitude, rad.
    pub turned_rad: f64,
}

impl CalibrationFilter {
    /// Uses a reference: gate, update, feedback into navigation and parameters.
    ///
    /// `None` if the reference is not of the kind for which the filter is tuned, or not finite. In
    /// psi-angle form a velocity reference is used as δv without the difference δθ × v between the
    /// forms, which is below 1e-7 m/s for a moored ship.
    pub fn measure(
        &mut self,
        reference: &Reference,
        strapdown: &mut Strapdown,
        parameters: &mut Parameters,
    ) -> Option<MeasurementResult> {
        let (first, sigma, measured) = self.error_against(reference, strapdown)?;
        let expected = self.sway.as_ref().map_or_else(Vector3::zeros, SwayStates::expected_m);
        let error = measured - expected;
        let r = sigma * sigma;
        let (nis, sigma) = self.nis(first, r, &error)?;
        let of = if first == DV { InnovationOf::Velocity } else { InnovationOf::Position };
        let innovation = Innovation { of, value: error.into(), sigma };

        let mut recovery_started = false;
        if let Some(gate) = self.gate
            && nis > gate.nis
        {
            if gate.recovery == Recovery::Widening && !self.is_plausible(&error) {
                self.tally.rejected += 1;
                return Some(MeasurementResult {
                    nis,
                    innovation,
                    rejected: true,
                    recovery_started,
                    turned_rad: 0.0,
                });
            }
            if matches!(self.stage, Stage::Capture(_)) {
                // The cause of the recovery still lasts, or one opening was not wide enough.
                self.open_wide(&gate, &error, strapdown);
            } else {
                self.rejected_in_a_row = self.rejected_in_a_row.saturating_add(1);
                if self.rejected_in_a_row < gate.rejections {
                    self.tally.rejected += 1;
                    return Some(MeasurementResult {
                        nis,
                        innovation,
                        rejected: true,
                        recovery_started,
                        turned_rad: 0.0,
                    });
                }
                self.go_back(parameters);
                self.start_recovery(&gate, &error, strapdown);
                recovery_started = true;
            }
        }
        self.rejected_in_a_row = 0;

        let mut x = [0.0; STATE_COUNT];
        let held = self.stage != Stage::Normal;
        if let Some(further) = &mut self.further
            && !held
        {
            further.expect(&self.covariance, first, r);
        }
        if let Some(sway) = &mut self.sway {
            sway.update(r, &measured, held, &mut self.covariance, &mut x);
        } else {
            for axis in 0..3 {
                let innovation = error[axis] - x[first + axis];
                if let Some(further) = &mut self.further {
                    further.update(&self.covariance, first + axis, r, innovation, held);
                }
                if held {
                    self.covariance.update_moving(first + axis, r, innovation, &mut x);
                } else {
                    self.covariance.update(first + axis, r, innovation, &mut x);
                }
            }
        }
        let turned_rad = self.feed_back(&x, strapdown, parameters);
        self.tally.used += 1;
        self.passage.end();
        if held {
            self.tally.held += 1;
        } else {
            self.tally.nis_sum += nis;
            self.remember(parameters);
            if let Some(drift) = &mut self.drift {
                drift.watch(self.time_s, parameters, &self.covariance);
            }
        }
        Some(MeasurementResult { nis, innovation, rejected: false, recovery_started, turned_rad })
    }

    /// Uses the angles of gimbals at rest in a case at rest as a measurement of attitude: gate, update, feedback. The
    /// second value of the result is the angle by which the attitude was turned, rad.
    ///
    /// `None` if angles are no measurements, aren't believed any more, or a recovery is under way.
    pub fn measure_angles(
        &mut self,
        gimbal: GimbalAngles,
        strapdown: &mut Strapdown,
        parameters: &mut Parameters,
    ) -> Option<(AngleResult, f64)> {
        if self.stage != Stage::Normal {
            return None;
        }
        let mut x = [0.0; STATE_COUNT];
        let (further, errors) = (self.further.as_mut()?, &mut self.covariance);
        let result = further.measure_angles(gimbal, strapdown, self.model, errors, &mut x)?;
        let turned_rad =
            if result.rejected { 0.0 } else { self.feed_back(&x, strapdown, parameters) };
        Some((result, turned_rad))
    }

    /// First state, standard deviation and error (computed − reference) of a measurement.
    fn error_against(
        &self,
        reference: &Reference,
        strapdown: &Strapdown,
    ) -> Option<(usize, f64, Vector3<f64>)> {
        let found = match (reference, self.aiding) {
            (Reference::Velocity(velocity), AidingMode::Velocity { sigma_mps }) => {
                (DV, sigma_mps, strapdown.velocity_mps() - Vector3::from(*velocity))
            }
            (
                Reference::Position { latitude_rad, longitude_rad, height_m },
                AidingMode::Position { sigma_m },
            ) => {
                let (earth, navigation) = (strapdown.earth(), strapdown.navigation());
                let error = Vector3::new(
                    (navigation.latitude_rad - latitude_rad) * earth.meridian_radius_m,
                    (navigation.longitude_rad - longitude_rad)
                        * (earth.transverse_radius_m * earth.cos_latitude),
                    height_m - navigation.height_m,
                );
                (DR, sigma_m, error)
            }
            _ => return None,
        };
        found.2.iter().all(|value| value.is_finite()).then_some(found)
    }

    /// Normalized innovation squared, and the standard deviation of each axis.
    fn nis(&self, first: usize, r: f64, error: &Vector3<f64>) -> Option<(f64, [f64; 3])> {
        let errors = match &self.sway {
            Some(sway) => sway.innovation_covariance(&self.covariance),
            None => Matrix3::from_fn(|i, j| self.covariance.at(first + i, first + j)),
        };
        let s = errors + Matrix3::from_diagonal_element(r);
        let nis = error.dot(&(s.try_inverse()? * error));
        nis.is_finite().then(|| (nis, core::array::from_fn(|i| libm::sqrt(s[(i, i)]))))
    }

    fn feed_back(
        &self,
        x: &[f64; STATE_COUNT],
        strapdown: &mut Strapdown,
        parameters: &mut Parameters,
    ) -> f64 {
        let at = |i: usize| Vector3::new(x[i], x[i + 1], x[i + 2]);
        let (mut phi, mut dv, dr) = (at(PHI), at(DV), at(DR));
        if self.model == ErrorModel::Psi {
            let frame = computer_frame_error(&dr, strapdown.earth());
            phi += frame;
            dv -= frame.cross(strapdown.velocity_mps());
        }
        strapdown.correct(&phi, &dv, &dr);
        let mut all = parameters.to_array();
        for (value, change) in all.iter_mut().zip(&x[PARAMETERS..]) {
            *value += change;
        }
        *parameters = Parameters::from_array(&all);
        phi.norm()
    }
}
