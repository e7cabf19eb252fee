//! Bridging of samples that are missing, invalid, stuck or rejected.
//!
//! During a calibration on a base at rest the motion is known: the Earth's rotation, the gimbal
//! angles from the encoders, and gravity. An attitude bridged with it is as good as two readings of
//! an encoder; a hold of the last increments would lose the motion of the gimbals. On a ship the
//! last increments are held, and the uncertainty of the attitude grows with the square of the time.
//!
//! A jump may have been real: the attitude is opened along the turn that the jump would have caused
//! (one direction, not three), and the measurements decide.

use super::uncertainty::on;
use super::{Core, increments};
use crate::config::Base;
use crate::continuity::{Edge, c_cb, gimbal_turn, share_of_turn};
use crate::screen::{ACCELEROMETERS, Examined, GYROS, SensorCounts};
use nalgebra::{Matrix3, Vector3};
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS, GIMBAL_LSB_RAD};
use octant_sample::{GimbalAngles, Health, Mode, Parameters, Sample, Status};

/// Smallest turn in one interval that is a motion and not the flicker of a reading, rad: 1″. The
/// first sample of a move may turn by less: if it is rejected, the encoders' turn replaces it.
const TURNS_RAD: f64 = 5e-6;

/// Turn of the gimbals in one step of a gap, rad, and largest number of steps of a gap.
const STEP_RAD: f64 = 5e-4;
const STEPS_MAX: u64 = 12_000;

/// Raw increments of one interval, rad and m/s: measured ones, or those of the known motion.
#[derive(Clone, Copy, Debug)]
struct Increments {
    delta_theta: Vector3<f64>,
    delta_velocity: Vector3<f64>,
}

impl Increments {
    fn of(&[x, y, z, u, v, w]: &SensorCounts) -> Self {
        let (delta_theta, delta_velocity) = increments([x, y, z], [u, v, w]);
        Self { delta_theta, delta_velocity }
    }

    fn counts(&self) -> [f64; 6] {
        let (g, a) =
            (self.delta_theta / DELTA_THETA_LSB_RAD, self.delta_velocity / DELTA_VELOCITY_LSB_MPS);
        [g.x, g.y, g.z, a.x, a.y, a.z]
    }
}

fn counts_of(sample: &Sample) -> SensorCounts {
    let ([x, y, z], [u, v, w]) = (sample.delta_theta, sample.delta_velocity);
    [x, y, z, u, v, w]
}

/// Applies the sensors' error model to true increments.
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

impl Core {
    /// Increments that the sensors measure by true ones, with the errors that are compensated.
    fn measured(&self, theta: &Vector3<f64>, v: &Vector3<f64>, interval_s: f64) -> Increments {
        match &self.further {
            None => measured(&self.parameters, theta, v, interval_s),
            Some((_, further)) => {
                let (theta, v) = further.distort(&self.strapdown, theta, v, interval_s);
                measured(&self.parameters, &theta, &v, interval_s)
            }
        }
    }

    /// Returns whether the motion is known: in a calibration on a base at rest.
    fn knows_its_motion(&self) -> bool {
        self.mode == Mode::Calibrating && self.config.screening.base == Base::Still
    }

    /// True increments over an interval that starts in the strapdown's attitude and in which the
    /// gimbals turn the body by `turn`.
    fn known_motion(&self, turn: &Vector3<f64>, interval_s: f64) -> (Vector3<f64>, Vector3<f64>) {
        let c_bn = self.strapdown.c_nb().transpose();
        let earth = self.strapdown.earth();
        let theta = c_bn * earth.earth_rate() * interval_s + turn;
        let up = c_bn * Vector3::new(0.0, 0.0, -earth.gravity_mps2 * interval_s);
        // At the middle of the interval the body has turned by half.
        (theta, up - theta.cross(&up) * 0.5)
    }

    /// Returns whether the encoders show a turn in this sample's interval, planned or not: a drive
    /// that stalled and goes on, a late set point. Increments of a turn are no jump.
    fn gimbals_turn(&self, sample: &Sample) -> bool {
        let turned = |now: i32, before: i32| {
            f64::from(now.wrapping_sub(before)).abs() * GIMBAL_LSB_RAD > TURNS_RAD
        };
        let before = self.bridge.gimbal;
        !sample.status.contains(Status::GIMBAL_INVALID)
            && (turned(sample.gimbal.azimuth, before.azimuth)
                || turned(sample.gimbal.roll, before.roll))
    }

    /// Turn of the gimbals in this sample's interval; zero if the encoders are invalid. Encoders of
    /// gimbals at rest flicker, which sums to zero, or show the beginning of a turn.
    fn gimbals_turned(&self, sample: &Sample) -> Vector3<f64> {
        if sample.status.contains(Status::GIMBAL_INVALID) {
            return Vector3::zeros();
        }
        gimbal_turn(self.bridge.gimbal, sample.gimbal)
    }

    /// Handles a sample that didn't pass the screen.
    #[cold]
    #[inline(never)]
    pub(super) fn doubt(&mut self, sample: &Sample, interval_s: f64, health: &mut Health) {
        let counts = counts_of(sample);
        let standing = !self.gimbals_may_move() && !self.gimbals_turn(sample);
        let still = self.knows_its_motion();
        let turn = self.gimbals_turned(sample);
        let (theta, v) = self.known_motion(&turn, interval_s);
        let known = still.then(|| self.measured(&theta, &v, interval_s));
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
                // A stuck channel carries no information on the motion.
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
        // On a base that moves a return to acceptance may be wrong: a lasting spike is accepted
        // too, and the last increments were a poor replacement for it.
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

    /// Not inlined: the inlined integration is for good samples.
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
        // A specific force that is partly measured and partly known has no error model.
        if channels & ACCELEROMETERS != 0 {
            channels |= ACCELEROMETERS;
        }
        channels
    }

    /// Records the gimbal angles before a run of identical counts.
    fn note_runs(&mut self) {
        for axis in 0..3 {
            if self.screen.run(axis) == 1 {
                self.bridge.run_start[axis] = self.bridge.gimbal;
            }
        }
    }

    /// Counts the repeats that are used unchanged.
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

    /// Last increments that were accepted.
    fn held_increments(&self) -> Increments {
        Increments::of(self.screen.last())
    }

    /// Adds the increments that a channel missed before it was found stuck to this sample. Its
    /// counts in that time are known: they were identical.
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
            // The attitude is that at the end of these samples, whereas `known_motion` starts from
            // it.
            let v = v + theta.cross(&v);
            let known = self.measured(&theta, &v, late * interval_s);
            if channel < 3 {
                taken.delta_theta[axis] += known.delta_theta[axis] - late * raw.delta_theta[axis];
            } else {
                let missed = known.delta_velocity[axis] - late * raw.delta_velocity[axis];
                taken.delta_velocity[axis] += missed;
            }
        }
    }

    /// Bridges `missing` samples before this one by the known motion; `false` if that isn't known
    /// well enough.
    #[cold]
    pub(super) fn bridge_known(&mut self, missing: u64, sample: &Sample) -> bool {
        let has_encoders = !sample.status.contains(Status::GIMBAL_INVALID);
        if !self.config.screening.bridging
            || !self.knows_its_motion()
            || self.filter().is_none()
            || !(has_encoders || self.dwells_over(missing))
        {
            return false;
        }
        let from = self.bridge.gimbal;
        // Gimbal angles at the start of this sample's interval: its own turn is taken back.
        let to = if has_encoders { self.before(sample) } else { from };
        self.begin_stretch();
        let channels = GYROS | ACCELEROMETERS;
        // The turns of both gimbals and of the Earth don't commute. A gap may be long, but it
        // contains few turns.
        let turned_rad =
            (to.azimuth_rad() - from.azimuth_rad()).abs() + (to.roll_rad() - from.roll_rad()).abs();
        let steps = missing.max((turned_rad / STEP_RAD) as u64).min(STEPS_MAX);
        let interval_s = missing as f64 * self.sample_s / steps as f64;
        for step in 0..steps {
            let (start, end) = (step as f64 / steps as f64, (step + 1) as f64 / steps as f64);
            let turn = share_of_turn(from, to, start, end);
            let (theta, v) = self.known_motion(&turn, interval_s);
            let known = self.measured(&theta, &v, interval_s);
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

    /// Returns whether the procedure has the gimbals at rest now and over so many samples more.
    fn dwells_over(&self, missing: u64) -> bool {
        let until = self.phase_tick().saturating_add(missing);
        let dwells = |departure_tick| !self.gimbals_may_move() && until < departure_tick;
        self.cursor.as_ref().is_none_or(|cursor| dwells(cursor.departure_tick()))
    }

    /// Encoder angles at the start of this sample's interval, from the gyros' turn in it.
    fn before(&self, sample: &Sample) -> GimbalAngles {
        let raw = Increments::of(&counts_of(sample));
        // The body's attitude follows from the gimbal angles, not from the strapdown, which is
        // behind.
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
