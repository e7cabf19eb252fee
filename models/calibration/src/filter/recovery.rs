//! Recovery of the filter after a fault: the estimation goes back, and attitude and velocity open.

use super::noise::add_bias_walk;
use super::{CalibrationFilter, Stage};
use crate::config::{AidingMode, Gate, Recovery};
use crate::continuity::Edge;
use crate::covariance::{DR, DV, PHI, Transition};
use crate::strapdown::Strapdown;
use nalgebra::Vector3;
use octant_sample::Parameters;

/// First stage of the widening recovery, s: attitude and velocity converge, and instead of
/// rejecting a measurement the gate opens them again; the stage ends after this time without that.
const CAPTURE_S: f64 = 10.0;
/// Second stage, s: the attitude settles, the parameters are considered but not estimated.
const SETTLE_S: f64 = 120.0;
/// σ with which the second stage starts, rad: linearization errors that the first can have left.
const SETTLE_ATTITUDE_RAD: [f64; 3] = [6e-4, 6e-4, 3e-3];
/// σ of velocity and position with which the second stage starts, m/s and m.
const SETTLE_VELOCITY_MPS: f64 = 0.1;
const RECOVERY_POSITION_M: f64 = 10.0;
/// Smallest σ of the attitude in the first stage, rad: 600″.
const CAPTURE_ATTITUDE_RAD: f64 = 2.9e-3;
/// Smallest σ of azimuth in the first stage, rad: 3°. An azimuth error shows only through Earth
/// rate: by the time that it opens the gate it may be of any size, and the innovation doesn't show
/// the size.
const CAPTURE_AZIMUTH_RAD: f64 = 0.052;
/// σ of an attitude that a disturbance of the accelerometers didn't change, rad: 50″, more than the
/// effect of one measurement that passes the gate.
const KEPT_ATTITUDE_RAD: f64 = 2.4e-4;

/// Largest σ of velocity, m/s, and position, m, in the first stage: a reference further away is not
/// followed.
const CAPTURE_VELOCITY_MAX_MPS: f64 = 1e4;
const CAPTURE_POSITION_MAX_M: f64 = 1e6;

/// Smallest age of a checkpoint to which a recovery returns, s; the largest is twice that. A fault
/// opens the gate within seconds, or within about a minute if it grows slowly; two minutes of
/// estimation are soon repeated.
const CHECKPOINT_S: f64 = 60.0;

impl CalibrationFilter {
    /// Holds the parameters until the attitude, which may be wrong by more than its linear error
    /// model covers, has settled.
    pub fn hold(&mut self) {
        self.keeps_attitude = false;
        self.stage = Stage::Capture(self.time_s + CAPTURE_S);
    }

    /// Undoes the estimation of the last minutes and reopens attitude and velocity, after a fault
    /// in the increments of the last seconds. Returns `false` if the configuration has no such
    /// recovery.
    ///
    /// If the gyros' turn had no edge, the attitude is kept within a minute of arc: otherwise a
    /// false acceleration would be taken for a tilt and carry the azimuth off by degrees.
    pub fn suspect(
        &mut self,
        edge: Edge,
        strapdown: &mut Strapdown,
        parameters: &mut Parameters,
    ) -> bool {
        let Some(gate @ Gate { recovery: Recovery::Widening, .. }) = self.gate else {
            return false;
        };
        if self.checkpoints.is_none() {
            return false;
        }
        self.propagate(strapdown);
        if self.stage == Stage::Normal {
            self.go_back(parameters);
            self.tally.recoveries = self.tally.recoveries.saturating_add(1);
            self.keeps_attitude = true;
        }
        self.keeps_attitude &= edge == Edge::Velocity;
        self.rejected_in_a_row = 0;
        self.open_wide(&gate, &Vector3::zeros(), strapdown);
        true
    }

    /// Returns whether the error is small enough for a recovery towards the reference.
    pub(super) fn is_plausible(&self, error: &Vector3<f64>) -> bool {
        error.norm()
            <= match self.aiding {
                AidingMode::Velocity { .. } => CAPTURE_VELOCITY_MAX_MPS,
                AidingMode::Position { .. } => CAPTURE_POSITION_MAX_M,
            }
    }

    /// Keeps the parameters of one to two minutes ago.
    pub(super) fn remember(&mut self, parameters: &Parameters) {
        let Some([older, newer]) = &mut self.checkpoints else { return };
        if self.time_s - newer.time_s >= CHECKPOINT_S {
            core::mem::swap(older, newer);
            newer.time_s = self.time_s;
            newer.parameters = *parameters;
            newer.covariance.clone_from(&self.covariance);
            if let Some(further) = &mut self.further {
                further.remember();
            }
        }
    }

    /// Returns to the older checkpoint: errors that entered the parameters before the gate closed
    /// are undone.
    pub(super) fn go_back(&mut self, parameters: &mut Parameters) {
        let Some([older, newer]) = &mut self.checkpoints else { return };
        self.passage.break_off();
        newer.clone_from(older);
        *parameters = older.parameters;
        self.covariance.clone_from(&older.covariance);
        if let Some(further) = &mut self.further {
            further.go_back(&mut self.covariance);
        }
        if self.walk_variance_per_s > 0.0 {
            let variance = self.walk_variance_per_s * (self.time_s - older.time_s);
            add_bias_walk(&mut self.covariance, variance, &Transition::identity());
        }
        if let Some(drift) = &mut self.drift {
            drift.go_back(older.time_s);
        }
        self.reopen_sway();
    }

    pub(super) fn start_recovery(
        &mut self,
        gate: &Gate,
        error: &Vector3<f64>,
        strapdown: &mut Strapdown,
    ) {
        self.tally.recoveries += 1;
        self.keeps_attitude = false;
        match gate.recovery {
            Recovery::Reset { attitude_rad, velocity_mps, position_m } => {
                self.reopen([attitude_rad; 3], velocity_mps, position_m);
            }
            Recovery::Widening => self.open_wide(gate, error, strapdown),
        }
    }

    /// Starts the first stage of the widening recovery, or starts it over.
    pub(super) fn open_wide(
        &mut self,
        gate: &Gate,
        error: &Vector3<f64>,
        strapdown: &mut Strapdown,
    ) {
        // An attitude error φ has grown into a velocity error g φ t, or a position error g φ t²/2,
        // while the gate rejected; σ is twice that and no less than 600″.
        let t = f64::from(gate.rejections.max(1));
        let reach = match self.aiding {
            AidingMode::Velocity { .. } => error.norm() / t,
            AidingMode::Position { .. } => 2.0 * error.norm() / (t * t),
        };
        let attitude = (2.0 * reach / 9.8).clamp(CAPTURE_ATTITUDE_RAD, 1.0);
        let velocity = (2.0 * reach * t).clamp(1.0, CAPTURE_VELOCITY_MAX_MPS);
        let position = match self.aiding {
            // Velocity doesn't show how far a fault has moved the solution, and 100 m of height are
            // 30 µg of gravity. But the instrument itself is still in its place.
            AidingMode::Velocity { .. } => {
                strapdown.move_to(&self.site);
                RECOVERY_POSITION_M
            }
            AidingMode::Position { .. } => {
                (2.0 * error.norm()).clamp(RECOVERY_POSITION_M, CAPTURE_POSITION_MAX_M)
            }
        };
        let azimuth = attitude.max(CAPTURE_AZIMUTH_RAD);
        let attitude = if self.keeps_attitude {
            self.attitude_at_least([KEPT_ATTITUDE_RAD; 3])
        } else {
            [attitude, attitude, azimuth]
        };
        self.reopen(attitude, velocity, position);
        self.stage = Stage::Capture(self.time_s + CAPTURE_S);
    }

    pub(super) fn advance_recovery(&mut self) {
        match self.stage {
            Stage::Capture(until) if self.time_s >= until => {
                // Azimuth is hardly observable in 10 s: a wide σ has to stay.
                let attitude = self.attitude_at_least(if self.keeps_attitude {
                    [KEPT_ATTITUDE_RAD; 3]
                } else {
                    SETTLE_ATTITUDE_RAD
                });
                self.reopen(attitude, SETTLE_VELOCITY_MPS, RECOVERY_POSITION_M);
                self.stage = Stage::Settle(self.time_s + SETTLE_S);
            }
            Stage::Settle(until) if self.time_s >= until => self.stage = Stage::Normal,
            _ => {}
        }
    }

    /// σ of the attitude, at least these values, rad.
    fn attitude_at_least(&self, least_rad: [f64; 3]) -> [f64; 3] {
        core::array::from_fn(|axis| least_rad[axis].max(self.covariance.sigma(PHI + axis)))
    }

    fn reopen(&mut self, attitude_rad: [f64; 3], velocity_mps: f64, position_m: f64) {
        self.passage.break_off();
        for axis in 0..3 {
            self.covariance.reopen(PHI + axis, attitude_rad[axis]);
            self.covariance.reopen(DV + axis, velocity_mps);
            self.covariance.reopen(DR + axis, position_m);
        }
        if let Some(further) = &mut self.further {
            further.reopen();
        }
        self.reopen_sway();
    }

    /// The sway starts anew with the states that it correlates with.
    fn reopen_sway(&mut self) {
        if let Some(sway) = &mut self.sway {
            sway.reopen();
        }
    }
}
