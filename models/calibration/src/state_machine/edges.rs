//! Handling of discontinuities of rates.

use super::disturbance::Disturbance;
use super::estimation::Estimation;
use super::uncertainty::{OPEN_MAX_MPS, OPEN_MAX_RAD};
use super::{Core, kalman_of};
use crate::config::Base;
use crate::continuity::{Block, Continuity, Edge, TURNS_RAD, gimbal_turn};
use crate::filter::SensorIntegrals;
use nalgebra::{Matrix3, Vector3};
use octant_sample::parameters::ParameterGroup;
use octant_sample::{GimbalAngles, Health, Mode, Sample, Status};

/// Tolerance of the length of a block, as a share; after a gap a block is outside of it.
const LENGTH_SHARE: f64 = 0.02;

/// Time for which a disturbance explains a recovery, s: a recovery goes back by one to two minutes.
const EXPLAINS_S: f64 = 60.0;

/// Time without a sign of a disturbance after which it is over, s, on a base at rest: longer than
/// the step filter is blind after one.
const QUIET_S: f64 = 2.5;
/// Standard gravity, for a bound.
const GRAVITY_MPS2: f64 = 9.81;

/// Returns whether the gimbals have turned by more than the flicker of the encoders.
fn turned(from: GimbalAngles, to: GimbalAngles) -> bool {
    (to.azimuth_rad() - from.azimuth_rad()).abs().max((to.roll_rad() - from.roll_rad()).abs())
        > TURNS_RAD
}

impl Core {
    /// Starts the detection with the first sample of a calibration by a filter.
    pub(super) fn start_edges(&mut self) {
        let screening = &self.config.screening;
        let Some(kalman) = kalman_of(&self.config) else { return };
        if screening.jumps {
            self.continuity = Continuity::new(
                screening,
                kalman,
                &self.config.noise,
                &self.config.turntable,
                self.sample_s,
            );
        }
        if self.continuity.is_some() {
            self.block_tick = 0;
        }
    }

    /// Number of samples for which a disturbance explains a recovery of the filter.
    pub(super) fn explains_ticks(&self) -> u64 {
        super::ticks(EXPLAINS_S, self.sample_s)
    }

    /// Returns whether the gimbals move, or did so within these samples.
    pub(super) fn has_moved_within(&self, ticks: u64) -> bool {
        self.cursor.as_ref().is_some_and(|cursor| {
            self.phase_tick() < cursor.arrival_tick().saturating_add(ticks)
                && cursor.arrival_tick() > 0
        })
    }

    /// Passes a block of increments to the detector, and handles a rate with an edge.
    #[inline(never)]
    pub(super) fn look_for_edges(&mut self, sample: &Sample, health: &mut Health) {
        self.block_tick = (self.tick / self.block_ticks + 1) * self.block_ticks;
        let Some(continuity) = &self.continuity else { return };
        let before = continuity.gimbal();
        // Encoders that slipped are no evidence of moves.
        let invalid = sample.status.contains(Status::GIMBAL_INVALID);
        let blind = invalid || self.slips.count != 0 || continuity.distrusts_encoders();
        let moves = self.gimbals_may_move() || (!invalid && turned(before, sample.gimbal));
        let errors = self.parameters.gyro_matrix();
        let errors = Matrix3::from_fn(|i, j| errors[i][j]);
        let still = self.config.screening.base == Base::Still;
        let Some(filter) = self.filter_mut() else { return };
        let felt = filter.take_turned();
        let settled = !filter.is_recovering();
        let whole_s = self.block_ticks as f64 * self.sample_s;
        // The angles of gimbals at rest don't matter.
        let gimbal = if blind { before } else { sample.gimbal };
        let beyond = if still { self.beyond(&felt, before, gimbal) } else { Default::default() };
        let Some(continuity) = &mut self.continuity else { return };
        if (felt.elapsed_s - whole_s).abs() > LENGTH_SHARE * whole_s
            || (!still && felt.bridged != 0)
            || (blind && moves)
        {
            continuity.restart(sample.gimbal);
            return;
        }
        let block = Block {
            // The measured turn, not the compensated one: the estimate changes with every
            // measurement.
            turn: felt.delta_theta + errors * felt.delta_theta,
            velocity: felt.delta_velocity_n,
            gimbal,
            rests: !moves,
            beyond: (still && settled && !moves).then_some(beyond.0),
        };
        let edge = continuity.add(&block);
        if edge.is_some() {
            *health |= Health::JUMP;
        }
        if still {
            self.follow_disturbance(edge.is_some(), moves, beyond);
        } else if let Some(edge) = edge {
            self.mend(edge);
        }
    }

    /// Turn and velocity beyond the known motion of a base at rest, in n: rad and m/s.
    fn beyond(
        &self,
        felt: &SensorIntegrals,
        from: GimbalAngles,
        to: GimbalAngles,
    ) -> (Vector3<f64>, Vector3<f64>) {
        let (c, earth) = (self.strapdown.c_nb(), self.strapdown.earth());
        let turn = c * (felt.delta_theta - gimbal_turn(from, to));
        let weight = Vector3::new(0.0, 0.0, earth.gravity_mps2 * felt.elapsed_s);
        (turn - earth.earth_rate() * felt.elapsed_s, felt.delta_velocity_n + weight)
    }

    /// Follows a disturbance on a base at rest: attitude and velocity may be wrong by the turn and
    /// velocity beyond the known motion since two seconds before the edge. They are opened along
    /// these, and the measurements decide. The disturbance ends when the gimbals rest and two and a
    /// half seconds were quiet.
    fn follow_disturbance(
        &mut self,
        broke_off: bool,
        moves: bool,
        beyond: (Vector3<f64>, Vector3<f64>),
    ) {
        self.recent.rotate_right(1);
        self.recent[0] = beyond;
        if let Some(disturbance) = &mut self.disturbance {
            disturbance.turned += beyond.0;
            disturbance.moved += beyond.1;
        } else if broke_off {
            let mut disturbance = Disturbance::default();
            for (turned, moved) in &self.recent {
                disturbance.turned += turned;
                disturbance.moved += moved;
            }
            self.disturbance = Some(disturbance);
        }
        if broke_off {
            self.disturbed_tick = self.tick;
        }
        let Some(mut disturbance) = self.disturbance else { return };
        if disturbance.turned.norm() > OPEN_MAX_RAD || disturbance.moved.norm() > OPEN_MAX_MPS {
            self.disturbance = None;
            self.mend(Edge::Turn);
            return;
        }
        let quiet_s = (self.tick - self.disturbed_tick) as f64 * self.sample_s;
        if !moves && quiet_s > QUIET_S {
            self.disturbance = None;
            return;
        }
        let axes = if moves { self.encoders_and_axes() } else { 0.0 };
        let mut attitude = disturbance.open(0, disturbance.turned);
        let more = (axes - disturbance.axes).max(0.0);
        disturbance.axes += more;
        attitude += Matrix3::identity() * more;
        // Velocity by a tilt that has existed for half a second.
        let tilt = disturbance.turned * (0.5 * GRAVITY_MPS2);
        let velocity = disturbance.open(1, disturbance.moved) + disturbance.open(2, tilt);
        self.disturbance = Some(disturbance);
        let Estimation::Kalman(filter) = &mut self.estimation else { return };
        filter.disturb(&self.strapdown, &attitude, &velocity);
    }

    /// Variance of the possible difference between gyros and encoders over a move, rad².
    fn encoders_and_axes(&self) -> f64 {
        let sigma = self.config.screening.encoder_sigma_rad;
        let parameters = |group: ParameterGroup| {
            self.sigma[group.range()].iter().fold(0.0f64, |largest, sigma| largest.max(*sigma))
        };
        let axes =
            parameters(ParameterGroup::GyroScale).max(parameters(ParameterGroup::GyroMisalignment));
        2.0 * sigma * sigma + axes * axes
    }

    /// Undoes the filter's estimation since its checkpoint, after a disturbance of which the edge
    /// is a sign, or that may be in the gyros too; if that is impossible, the calibration will be
    /// refused.
    #[cold]
    #[inline(never)]
    pub(super) fn mend(&mut self, edge: Edge) {
        if self.mode != Mode::Calibrating {
            return;
        }
        self.disturbed_tick = self.tick;
        let mut parameters = self.parameters;
        let mut strapdown = self.strapdown.clone();
        let mended = self
            .filter_mut()
            .is_some_and(|filter| filter.suspect(edge, &mut strapdown, &mut parameters));
        if !mended {
            self.unrepaired = self.unrepaired.saturating_add(1);
            return;
        }
        self.strapdown = strapdown;
        self.parameters = parameters;
        self.compensation = crate::compensation::Compensation::new(&self.parameters);
        self.revision = self.revision.saturating_add(1);
        if let Some(filter) = self.filter() {
            let further = filter.further();
            self.sigma = filter.parameter_sigmas();
            if let (Some(found), Some((estimates, compensation))) = (further, &mut self.further) {
                *estimates = found;
                compensation.set(&found.value);
            }
        }
    }
}
