//! What stands in for samples that are missing, invalid, stuck or not believed, and how uncertain
//! that is.
//!
//! While a calibration runs on a base that stands, its motion is known: the Earth's rotation, what
//! the encoders say of the gimbals, and gravity. An attitude that is bridged so is as good as two
//! readings of an encoder; a hold of the last increments would lose what the gimbals do. On a ship
//! the last increments are held, and the attitude becomes less sure with the square of the time.
//!
//! What a jump would have turned the attitude by, had it been real, is not known to be wrong: the
//! attitude is opened along it (one direction, not three), and the measurements decide.

use super::estimation::Estimation;
use super::{Core, increments, kalman_of};
use crate::config::{Base, BaseMotion};
use crate::continuity::{Edge, c_cb, gimbal_turn, share_of_turn};
use crate::screen::{ACCELEROMETERS, Counts, Examined, GYROS};
use nalgebra::{Matrix3, Vector3};
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS, GIMBAL_LSB_RAD};
use octant_sample::parameters::Group;
use octant_sample::{GimbalAngles, Health, Mode, Parameters, Sample, Status};

/// Beyond this an attitude jump that wasn't believed isn't followed, rad: 3°, as far as the linear
/// error model bears.
pub(super) const OPEN_MAX_RAD: f64 = 0.052;
/// The same for velocity, m/s.
pub(super) const OPEN_MAX_MPS: f64 = 1.0;
/// Uncertainty of the attitude from which on the parameters are held, rad: 600″.
const HOLD_RAD: f64 = 2.9e-3;
/// Turn of a gimbal that is none, rad: 20″. Encoders of a standing gimbal flicker.
const TURNED_RAD: f64 = 1e-4;
/// Turn in one interval that is a motion and not the flicker of a reading, rad: 1″. Less than that is
/// what the first sample of a move turns: where it isn't believed, the encoders' turn stands in.
const TURNS_RAD: f64 = 5e-6;

/// Turn of the gimbals in one step of a gap, rad, and steps of a gap at most.
const STEP_RAD: f64 = 5e-4;
const STEPS_MAX: u64 = 12_000;

/// What is remembered of the stretch that is being bridged.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Bridge {
    /// Encoder angles of the last sample.
    pub(super) gimbal: GimbalAngles,
    /// Encoder angles before the first of the identical counts of each gyro.
    run_start: [GimbalAngles; 3],
    /// Repeated counts of each channel that were used, before it was found stuck.
    used_repeats: [u32; 6],
    /// Channels that have been bridged since the uncertainty was last accounted for.
    open: u8,
    /// What jumps would have added, had they been believed: rad and m/s, in b.
    disbelieved: (Vector3<f64>, Vector3<f64>),
    /// Channels that were bridged because they jumped, up to the last sample.
    jumps: u8,
    /// Encoder angles before the stretch, and whether their uncertainty is accounted for.
    start: GimbalAngles,
    encoders_counted: [bool; 2],
    /// Length of the stretch so far, and up to the last account, s.
    elapsed_s: f64,
    accounted_s: f64,
    /// Samples bridged so far.
    pub(super) samples: u64,
}

/// Raw increments of one interval, rad and m/s: measured ones, or what the known motion makes.
#[derive(Clone, Copy, Debug)]
struct Increments {
    delta_theta: Vector3<f64>,
    delta_velocity: Vector3<f64>,
}

impl Increments {
    fn of(&[x, y, z, u, v, w]: &Counts) -> Self {
        let (delta_theta, delta_velocity) = increments([x, y, z], [u, v, w]);
        Self { delta_theta, delta_velocity }
    }

    fn counts(&self) -> [f64; 6] {
        let (g, a) =
            (self.delta_theta / DELTA_THETA_LSB_RAD, self.delta_velocity / DELTA_VELOCITY_LSB_MPS);
        [g.x, g.y, g.z, a.x, a.y, a.z]
    }
}

fn counts_of(sample: &Sample) -> Counts {
    let ([x, y, z], [u, v, w]) = (sample.delta_theta, sample.delta_velocity);
    [x, y, z, u, v, w]
}

/// What the sensors make of true increments: their error model, forwards.
fn measured(
    parameters: &Parameters,
    theta: &Vector3<f64>,
    v: &Vector3<f64>,
    interval_s: f64,
) -> Increments {
    let times = |rows: [[f64; 3]; 3], u: &Vector3<f64>| Matrix3::from_fn(|i, j| rows[i][j]) * u;
    Increments {
        delta_theta: theta
            + times(parameters.gyro_matrix(), theta)
            + Vector3::from(parameters.gyro_bias) * interval_s
            + times(parameters.g_matrix(), v),
        delta_velocity: v
            + times(parameters.accel_matrix(), v)
            + Vector3::from(parameters.accel_bias) * interval_s,
    }
}

/// The part of a vector on these channels.
fn on(channels: u8, v: &Vector3<f64>) -> Vector3<f64> {
    Vector3::from_fn(|i, _| if channels & (1 << i) == 0 { 0.0 } else { v[i] })
}

/// Direction kept, length limited.
fn at_most(v: Vector3<f64>, length: f64) -> Vector3<f64> {
    let norm = v.norm();
    if norm > length { v * (length / norm) } else { v }
}

impl Core {
    /// The motion is known: a calibration on a base that stands.
    fn knows_its_motion(&self) -> bool {
        self.mode == Mode::Calibrating && self.config.screening.base == Base::Still
    }

    /// True increments over an interval at whose start the attitude is that of the strapdown, when
    /// the gimbals turn the body by `turn` in it.
    fn known_motion(&self, turn: &Vector3<f64>, interval_s: f64) -> (Vector3<f64>, Vector3<f64>) {
        let c_bn = self.strapdown.c_nb().transpose();
        let earth = self.strapdown.earth();
        let theta = c_bn * earth.earth_rate() * interval_s + turn;
        let up = c_bn * Vector3::new(0.0, 0.0, -earth.gravity_mps2 * interval_s);
        // In the middle of the interval the body has turned by half.
        (theta, up - theta.cross(&up) * 0.5)
    }

    /// The encoders show a turn in this sample's interval, planned or not: a drive that stalled and
    /// goes on, a set point that came late. What turns is no jump.
    fn gimbals_turn(&self, sample: &Sample) -> bool {
        let turned = |now: i32, before: i32| {
            f64::from(now.wrapping_sub(before)).abs() * GIMBAL_LSB_RAD > TURNS_RAD
        };
        let before = self.bridge.gimbal;
        !sample.status.contains(Status::GIMBAL_INVALID)
            && (turned(sample.gimbal.azimuth, before.azimuth)
                || turned(sample.gimbal.roll, before.roll))
    }

    /// Turn of the gimbals in this sample's interval; none where the encoders can't be used. Those of
    /// standing gimbals flicker, which adds up to nothing, or begin to turn.
    fn gimbals_turned(&self, sample: &Sample) -> Vector3<f64> {
        if sample.status.contains(Status::GIMBAL_INVALID) {
            return Vector3::zeros();
        }
        gimbal_turn(self.bridge.gimbal, sample.gimbal)
    }

    /// A sample that isn't plainly good.
    #[cold]
    #[inline(never)]
    pub(super) fn doubt(&mut self, sample: &Sample, interval_s: f64, health: &mut Health) {
        let counts = counts_of(sample);
        let standing = !self.gimbals_may_move() && !self.gimbals_turn(sample);
        let still = self.knows_its_motion();
        let turn = self.gimbals_turned(sample);
        let (theta, v) = self.known_motion(&turn, interval_s);
        let known = still.then(|| measured(&self.parameters, &theta, &v, interval_s));
        let known_counts = known.map(|known| known.counts());
        let found = self.screen.examine(&counts, !standing, known_counts.as_ref(), self.tick);
        self.note_runs();
        if found.jumped | found.expired != 0 {
            *health |= Health::JUMP;
        }
        if found.stuck != 0 {
            self.monitor.note_stuck();
            health.set(Health::GYRO_STUCK, found.stuck & GYROS != 0);
            health.set(Health::ACCELEROMETER_STUCK, found.stuck & ACCELEROMETERS != 0);
        }

        let mut taken = Increments::of(&counts);
        let mut channels = 0;
        if self.config.screening.bridging {
            channels = self.channels_to_bridge(sample, &found);
        }
        if channels != 0 {
            self.disturbed_tick = self.tick;
            self.begin_stretch();
            let bridged = match known {
                Some(known) => known,
                None => self.held_increments(),
            };
            let off = (
                taken.delta_theta - bridged.delta_theta,
                taken.delta_velocity - bridged.delta_velocity,
            );
            self.bridge.disbelieved.0 += on(found.jumped & channels & GYROS, &off.0);
            self.bridge.disbelieved.1 += on((found.jumped & channels) >> 3, &off.1);
            taken.delta_theta -= on(channels & GYROS, &off.0);
            taken.delta_velocity -= on(channels >> 3, &off.1);
            if found.found_stuck & channels != 0 && still {
                self.make_up(&mut taken, found.found_stuck, sample, standing, interval_s);
                // A dead channel says nothing of any motion.
                self.bridge.disbelieved.0 -= on(found.found_stuck, &self.bridge.disbelieved.0);
                self.bridge.disbelieved.1 -= on(found.found_stuck >> 3, &self.bridge.disbelieved.1);
            }
            self.bridge.open |= channels;
            self.bridge.elapsed_s += interval_s;
            self.bridge.samples = self.bridge.samples.saturating_add(1);
            if let Some(filter) = self.filter_mut() {
                filter.bridge(channels);
            }
        }
        self.count_repeats(channels);
        self.bridge.gimbal = sample.gimbal;
        self.integrate_bridged(&taken, interval_s);
        if channels == 0 {
            self.end_stretch();
        }
        // On a base that moves nothing says whether what is believed again is right: a spike that lasts
        // is believed too, and the last increments stood in for it badly.
        if found.jumped != 0 {
            self.bridge.jumps |= found.jumped;
        } else if self.bridge.jumps != 0 {
            let gyros = self.bridge.jumps & GYROS != 0;
            self.bridge.jumps = 0;
            if !still {
                self.mend(if gyros { Edge::Turn } else { Edge::Velocity });
            }
        }
    }

    /// Out of line: the integration itself belongs to where good samples are.
    #[inline(never)]
    fn integrate_bridged(&mut self, taken: &Increments, interval_s: f64) {
        self.navigate(&taken.delta_theta, &taken.delta_velocity, interval_s);
    }

    fn channels_to_bridge(&self, sample: &Sample, found: &Examined) -> u8 {
        let mut channels = found.jumped;
        if self.mode == Mode::Calibrating {
            channels |= found.stuck;
            if sample.status.intersects(Status::GYRO_SATURATED | Status::INERTIAL_INVALID) {
                channels |= GYROS;
            }
            if sample.status.intersects(Status::ACCELEROMETER_SATURATED | Status::INERTIAL_INVALID)
            {
                channels |= ACCELEROMETERS;
            }
        }
        // Half of the specific force measured and half of it known has no error model.
        if channels & ACCELEROMETERS != 0 {
            channels |= ACCELEROMETERS;
        }
        channels
    }

    /// Remembers where the gimbals were before a run of identical counts.
    fn note_runs(&mut self) {
        for axis in 0..3 {
            if self.screen.run(axis) == 1 {
                self.bridge.run_start[axis] = self.bridge.gimbal;
            }
        }
    }

    /// Counts the repeats that are used as they are.
    fn count_repeats(&mut self, bridged: u8) {
        for channel in 0..6 {
            let used = &mut self.bridge.used_repeats[channel];
            if self.screen.run(channel) == 0 {
                *used = 0;
            } else if bridged & (1 << channel) == 0 {
                *used = used.saturating_add(1);
            }
        }
    }

    fn begin_stretch(&mut self) {
        if self.bridge.open == 0 {
            self.bridge.start = self.bridge.gimbal;
            self.bridge.encoders_counted = [false; 2];
            (self.bridge.elapsed_s, self.bridge.accounted_s) = (0.0, 0.0);
        }
    }

    /// The last increments that were believed.
    fn held_increments(&self) -> Increments {
        Increments::of(self.screen.last())
    }

    /// A channel is found stuck some samples late: what it missed in these is made up for in this
    /// one. What it gave is known, the same each time.
    fn make_up(
        &self,
        taken: &mut Increments,
        channels: u8,
        sample: &Sample,
        standing: bool,
        interval_s: f64,
    ) {
        let raw = Increments::of(&counts_of(sample));
        for channel in 0..6 {
            if channels & (1 << channel) == 0 {
                continue;
            }
            let (repeats, used) =
                (self.screen.run(channel).saturating_sub(1), self.bridge.used_repeats[channel]);
            if used == 0 || used > repeats {
                continue;
            }
            let late = f64::from(used);
            let share = late / f64::from(repeats);
            let axis = channel % 3;
            let invalid = sample.status.contains(Status::GIMBAL_INVALID);
            let turn = if standing || invalid {
                Vector3::zeros()
            } else {
                gimbal_turn(self.bridge.run_start[axis], self.bridge.gimbal) * share
            };
            let (theta, v) = self.known_motion(&turn, late * interval_s);
            // The attitude is that at the end of them, known_motion goes on from its start.
            let v = v + theta.cross(&v);
            let known = measured(&self.parameters, &theta, &v, late * interval_s);
            if channel < 3 {
                taken.delta_theta[axis] += known.delta_theta[axis] - late * raw.delta_theta[axis];
            } else {
                let missed = known.delta_velocity[axis] - late * raw.delta_velocity[axis];
                taken.delta_velocity[axis] += missed;
            }
        }
    }

    /// The stretch is over: a good sample has come.
    pub(super) fn end_stretch(&mut self) {
        if self.bridge.open != 0 {
            self.account();
            self.bridge.open = 0;
        }
    }

    /// Adds the uncertainty of what has been bridged since the last account to the filter.
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

    /// Variance of the attitude (rad², in b) from the encoders over the stretch so far: two readings
    /// of each gimbal that has turned, once, and its axis, which is known to the body axes no better
    /// than the gyros' are before they are calibrated.
    fn encoder_uncertainty(&mut self) -> Matrix3<f64> {
        let axes_rad =
            kalman_of(&self.config).map_or(0.0, |kalman| kalman.prior.of(Group::GyroMisalignment));
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
            // Across it, on the axes that were bridged: seen from a full quarter turn.
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

    /// Variances of attitude (rad²) and velocity ((m/s)²), each axis, by which a hold became less
    /// sure since the last account: the square of the largest departure at its end, less that at the
    /// last account.
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

    /// Bridges `missing` samples before this one by what is known; `false` if too little is.
    #[cold]
    pub(super) fn bridge_known(&mut self, missing: u64, sample: &Sample) -> bool {
        if !self.config.screening.bridging
            || !self.knows_its_motion()
            || self.filter().is_none()
            || sample.status.contains(Status::GIMBAL_INVALID)
        {
            return false;
        }
        // Where the gimbals were when this sample's interval began: its own turn taken back.
        let (from, to) = (self.bridge.gimbal, self.before(sample));
        self.begin_stretch();
        let channels = GYROS | ACCELEROMETERS;
        // The turns of both gimbals and of the Earth don't commute. A gap may be long, but its turns are few.
        let turned_rad =
            (to.azimuth_rad() - from.azimuth_rad()).abs() + (to.roll_rad() - from.roll_rad()).abs();
        let steps = missing.max((turned_rad / STEP_RAD) as u64).min(STEPS_MAX);
        let interval_s = missing as f64 * self.sample_s / steps as f64;
        for step in 0..steps {
            let (start, end) = (step as f64 / steps as f64, (step + 1) as f64 / steps as f64);
            let turn = share_of_turn(from, to, start, end);
            let (theta, v) = self.known_motion(&turn, interval_s);
            let known = measured(&self.parameters, &theta, &v, interval_s);
            if let Some(filter) = self.filter_mut() {
                filter.bridge(channels);
            }
            self.integrate_bridged(&known, interval_s);
        }
        self.bridge.gimbal = to;
        self.bridge.open |= channels;
        self.bridge.elapsed_s += missing as f64 * self.sample_s;
        self.bridge.samples = self.bridge.samples.saturating_add(missing);
        self.account();
        self.bridge.open = 0;
        true
    }

    /// On a base that moves a gap leaves the attitude less sure by what the base can have done.
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

    /// Encoder angles at the start of this sample's interval, by the turn that the gyros felt in it.
    fn before(&self, sample: &Sample) -> GimbalAngles {
        let raw = Increments::of(&counts_of(sample));
        // The body is where the gimbals have turned it to, not where the strapdown stands.
        let c_cb = |at: GimbalAngles| c_cb(at.azimuth_rad(), at.roll_rad());
        let turned = c_cb(self.bridge.gimbal).transpose() * c_cb(sample.gimbal);
        let c_bn = turned.transpose() * self.strapdown.c_nb().transpose();
        let turn = raw.delta_theta - c_bn * self.strapdown.earth().earth_rate() * self.sample_s;
        let (sin, cos) = libm::sincos(sample.gimbal.azimuth_rad() - 0.5 * turn.z);
        GimbalAngles::from_rad(
            sample.gimbal.azimuth_rad() - turn.z,
            sample.gimbal.roll_rad() - (turn.x * cos - turn.y * sin),
        )
    }
}
