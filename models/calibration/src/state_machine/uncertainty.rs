//! Uncertainty of bridged samples.

use super::estimation::Estimation;
use super::stretch::Bridge;
use super::{Core, kalman_of};
use crate::config::{Base, BaseMotion};
use crate::continuity::gimbal_turn;
use crate::screen::{ACCELEROMETERS, GYROS};
use nalgebra::{Matrix3, Vector3};
use octant_sample::GimbalAngles;
use octant_sample::parameters::ParameterGroup;

/// Largest attitude jump that is followed after its rejection, rad: 3°, the limit of the linear
/// error model.
pub(super) const OPEN_MAX_RAD: f64 = 0.052;
/// Largest velocity jump that is followed, m/s.
pub(super) const OPEN_MAX_MPS: f64 = 1.0;
/// Uncertainty of the attitude above which the parameters are held, rad: 600″.
const HOLD_RAD: f64 = 2.9e-3;
/// Largest turn of a gimbal that counts as rest, rad: 20″. Encoders of a gimbal at rest flicker.
const TURNED_RAD: f64 = 1e-4;

/// Components of a vector on these channels; the others are zero.
pub(super) fn on(channels: u8, v: &Vector3<f64>) -> Vector3<f64> {
    Vector3::from_fn(|i, _| if channels & (1 << i) == 0 { 0.0 } else { v[i] })
}

/// Limits the length of a vector and keeps its direction.
fn at_most(v: Vector3<f64>, length: f64) -> Vector3<f64> {
    let norm = v.norm();
    if norm > length { v * (length / norm) } else { v }
}

impl Core {
    pub(super) fn begin_stretch(&mut self) {
        if self.bridge.open == 0 {
            self.bridge.start = self.bridge.gimbal;
            self.bridge.encoders_counted = [false; 2];
            (self.bridge.elapsed_s, self.bridge.accounted_s) = (0.0, 0.0);
        }
    }

    /// Ends the stretch at a good sample.
    pub(super) fn end_stretch(&mut self) {
        if self.bridge.open != 0 {
            self.account();
            self.bridge.open = 0;
        }
    }

    /// Adds the uncertainty of the samples bridged since the last account to the filter.
    pub(super) fn account(&mut self) {
        if self.bridge.open == 0 {
            return;
        }
        let bridge = &mut self.bridge;
        let (turned, moved) = (at_most(bridge.disbelieved.0, OPEN_MAX_RAD), bridge.disbelieved.1);
        bridge.disbelieved = Default::default();
        let moved = at_most(moved, OPEN_MAX_MPS);
        let mut attitude = turned * turned.transpose();
        let mut velocity = moved * moved.transpose();
        match self.config.screening.base {
            Base::Still => attitude += self.encoder_uncertainty(),
            Base::Moving(motion) => {
                let (rotation, speed) = self.hold_uncertainty(&motion);
                for axis in 0..3 {
                    if self.bridge.open & (1 << axis) != 0 {
                        attitude[(axis, axis)] += rotation;
                    }
                }
                if self.bridge.open & ACCELEROMETERS != 0 {
                    velocity += Matrix3::identity() * speed;
                }
            }
        }
        let c = self.strapdown.c_nb();
        let holds =
            attitude.trace() > HOLD_RAD * HOLD_RAD && self.config.screening.base != Base::Still;
        let Estimation::Kalman(filter) = &mut self.estimation else { return };
        filter.disturb(
            &self.strapdown,
            &(c * attitude * c.transpose()),
            &(c * velocity * c.transpose()),
        );
        if holds {
            filter.hold();
        }
    }

    /// Variance of the attitude (rad², in b) from the encoders over the stretch so far: two
    /// readings of each gimbal that has turned, counted once, and the gimbal's axis, which is known
    /// relative to the body axes no better than the gyros' axes before they are calibrated.
    fn encoder_uncertainty(&mut self) -> Matrix3<f64> {
        let axes_rad = kalman_of(&self.config)
            .map_or(0.0, |kalman| kalman.prior.of(ParameterGroup::GyroMisalignment));
        let sigma = self.config.screening.encoder_sigma_rad;
        let Bridge { start, gimbal, open, .. } = self.bridge;
        let turns = [
            gimbal_turn(start, GimbalAngles { azimuth: gimbal.azimuth, ..start }),
            gimbal_turn(start, GimbalAngles { roll: gimbal.roll, ..start }),
        ];
        let mut variance = Matrix3::zeros();
        for (turn, counted) in turns.iter().zip(&mut self.bridge.encoders_counted) {
            let angle = turn.norm();
            if angle < TURNED_RAD || *counted {
                continue;
            }
            *counted = true;
            let along = on(open & GYROS, &(turn / angle));
            variance += along * along.transpose() * (2.0 * sigma * sigma);
            // Across the axis, on the channels that were bridged: the effect of a full quarter
            // turn.
            let across = axes_rad * axes_rad;
            for axis in 0..3 {
                if open & (1 << axis) != 0 {
                    variance[(axis, axis)] +=
                        across * (1.0 - turn[axis] * turn[axis] / (angle * angle));
                }
            }
        }
        variance
    }

    /// Growth of the variances of attitude (rad²) and velocity ((m/s)²), each axis, by a hold since
    /// the last account: the square of the largest departure at its end, less that at the last
    /// account.
    fn hold_uncertainty(&mut self, motion: &BaseMotion) -> (f64, f64) {
        let table =
            if self.gimbals_may_move() { self.config.turntable.acceleration_radps2 } else { 0.0 };
        let at = |t: f64| {
            let departed = 0.5 * motion.acceleration_radps2 * t * t;
            let bounded = departed.min(2.0 * motion.rate_radps * t).min(2.0 * motion.angle_rad);
            let rotation = bounded + 0.5 * table * t * t;
            let force = (0.5 * motion.jerk_mps3 * t * t).min(2.0 * motion.force_mps2 * t);
            (rotation * rotation, force * force)
        };
        let (before, now) = (at(self.bridge.accounted_s), at(self.bridge.elapsed_s));
        self.bridge.accounted_s = self.bridge.elapsed_s;
        ((now.0 - before.0).max(0.0), (now.1 - before.1).max(0.0))
    }

    /// Adds uncertainty to the attitude after a gap on a base that moves: the turn that the base
    /// can have made.
    #[cold]
    pub(super) fn doubt_gap(&mut self, missing: u64) {
        if !self.config.screening.bridging || self.filter().is_none() || missing == 0 {
            return;
        }
        self.begin_stretch();
        self.bridge.open |= GYROS | ACCELEROMETERS;
        self.bridge.elapsed_s += missing as f64 * self.sample_s;
        self.bridge.samples = self.bridge.samples.saturating_add(missing);
        self.end_stretch();
    }
}
