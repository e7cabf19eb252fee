//! One sample: from its increments to the output.

use super::estimation::{Estimation, Standstill};
use super::{CalibrationRefusal, Core, Gimbals, increments, strapdown_at};
use crate::monitor::SampleOrder;
use nalgebra::Vector3;
use octant_sample::{Aiding, Health, Mode, Output, Sample};

impl Core {
    /// Takes one sample, and the reference with its stamp, and returns the output.
    ///
    /// The parameters and their σ ([`Self::parameters`], [`Self::sigma`]) have changed if the
    /// output's revision has.
    pub fn step(&mut self, sample: &Sample, aiding: Option<&Aiding>) -> Output {
        let mut output = Output::default();
        self.step_into(sample, aiding, &mut output);
        output
    }

    /// [`Self::step`] in place, for callers that make millions of steps: a copy of an output that
    /// has just been written waits for the stores.
    pub fn step_into(&mut self, sample: &Sample, aiding: Option<&Aiding>, output: &mut Output) {
        let (order, mut health) = self.monitor.check(sample);
        let mut nis = f64::NAN;
        let interval_ns = match order {
            SampleOrder::Behind => return self.answer(sample, health, nis, output),
            SampleOrder::Next(interval_ns) => interval_ns,
            SampleOrder::Gap { missing } => {
                self.bridge(missing, sample);
                self.config.sample_period_ns
            }
        };
        self.tick = self.tick.saturating_add(1);
        let regular = interval_ns == self.config.sample_period_ns;
        let interval_s = if regular { self.sample_s } else { interval_ns as f64 * 1e-9 };
        self.take(sample, interval_s, &mut health);
        match self.mode {
            Mode::Calibrating => {
                if let Some(continuity) = &mut self.continuity {
                    continuity.follow(sample.gimbal);
                }
                if self.tick >= self.block_tick {
                    self.look_for_edges(sample, &mut health);
                }
                if aiding.is_some() || self.tick >= self.due_tick {
                    self.measure(sample, aiding, &mut health, &mut nis);
                }
                if self.tick >= self.calibration_ticks {
                    self.finish_calibration(sample.device_time);
                }
            }
            Mode::Navigating if self.phase_tick() >= self.navigation_ticks => {
                self.mode = Mode::Done;
            }
            _ => {}
        }
        let phase_tick = self.phase_tick();
        if let Some(cursor) = &mut self.cursor {
            cursor.advance(phase_tick);
        }
        self.tell_rest();
        self.compare_gimbals(sample, phase_tick, &mut health);
        if !self.strapdown.is_sound() && self.mode != Mode::Refused {
            // The number that isn't finite was kept out of the solution: the last good one remains.
            health |= Health::NUMERIC;
            self.refuse(CalibrationRefusal::Numeric);
        }
        self.answer(sample, health, nis, output);
    }

    /// Passes the increments of a sample to the alignment, estimator or navigation that runs.
    #[inline]
    fn take(&mut self, sample: &Sample, interval_s: f64, health: &mut Health) {
        let ([x, y, z], [u, v, w]) = (sample.delta_theta, sample.delta_velocity);
        match (self.mode, &self.estimation) {
            (Mode::Navigating, _) | (Mode::Calibrating, Estimation::Kalman(_)) => {
                let valid = !health.contains(Health::INERTIAL_INVALID);
                let moving = self.gimbals_may_move();
                if valid && self.integrate_good(interval_s, moving, x, y, z, u, v, w) {
                    self.bridge.gimbal = sample.gimbal;
                } else {
                    self.doubt(sample, interval_s, health);
                }
            }
            (mode, _) => {
                *health |= self.monitor.stuck(x, y, z, u, v, w);
                match mode {
                    Mode::Aligning => self.align(sample, interval_s),
                    Mode::Calibrating => self.watch(sample, interval_s),
                    _ => {}
                }
            }
        }
    }

    /// Navigates over one interval if its counts pass the screen: x, y, z of delta_theta, then u,
    /// v, w of delta_velocity.
    ///
    /// Each count is an argument of its own, and the call is not inlined, so that each is read with
    /// the width with which it was written. Read in pairs, right after single ones were stored,
    /// they would have to wait for those stores: longer than the rest of the step takes.
    #[inline(never)]
    #[allow(clippy::too_many_arguments, reason = "in registers: see above")]
    fn integrate_good(
        &mut self,
        interval_s: f64,
        moving: bool,
        x: i32,
        y: i32,
        z: i32,
        u: i32,
        v: i32,
        w: i32,
    ) -> bool {
        let good = self.screen.passes(moving, x, y, z, u, v, w);
        if good {
            self.integrate(interval_s, x, y, z, u, v, w);
        }
        good
    }

    #[inline]
    #[allow(clippy::too_many_arguments, reason = "in registers: see above")]
    pub(super) fn integrate(
        &mut self,
        interval_s: f64,
        x: i32,
        y: i32,
        z: i32,
        u: i32,
        v: i32,
        w: i32,
    ) {
        let (theta, velocity) = increments([x, y, z], [u, v, w]);
        self.navigate(&theta, &velocity, interval_s);
    }

    /// Navigates over one interval by its raw increments, rad and m/s.
    #[inline(always)]
    pub(super) fn navigate(
        &mut self,
        theta: &Vector3<f64>,
        velocity: &Vector3<f64>,
        interval_s: f64,
    ) {
        let (mut dtheta, mut dv) = self.compensation.apply(theta, velocity, interval_s);
        let mut warmth_k = None;
        if let Some((_, further)) = &mut self.further {
            (dtheta, dv) = further.apply(&self.strapdown, &dtheta, &dv, interval_s);
            warmth_k = further.warmth_k();
        }
        self.strapdown.step(&dtheta, &dv, interval_s);
        if let Estimation::Kalman(filter) = &mut self.estimation {
            if let Some(warmth_k) = warmth_k {
                filter.feel(warmth_k);
            }
            filter.accumulate(&self.strapdown, &dtheta, &dv, interval_s);
        }
    }

    #[cold]
    #[inline(never)]
    fn align(&mut self, sample: &Sample, interval_s: f64) {
        let Some((alignment, until)) = &mut self.alignment else { return };
        let (theta, velocity) = increments(sample.delta_theta, sample.delta_velocity);
        let (dtheta, dv) = self.compensation.apply(&theta, &velocity, interval_s);
        alignment.step(&dtheta, &dv, interval_s);
        if self.tick < *until {
            return;
        }
        match alignment.finish() {
            Ok(q_nb) => {
                self.strapdown = strapdown_at(&self.config.site, &q_nb, Vector3::zeros());
                self.leave_alignment();
            }
            Err(refusal) => self.refuse(refusal),
        }
    }

    /// Passes a sample to a least-squares calibration, which doesn't navigate: it uses standstills
    /// and the moves between them.
    #[inline(never)]
    fn watch(&mut self, sample: &Sample, interval_s: f64) {
        let Some(cursor) = &self.cursor else { return };
        let tick = self.tick;
        let standing = tick > cursor.arrival_tick() + self.settle_ticks;
        if standing {
            let measured = increments(sample.delta_theta, sample.delta_velocity);
            self.standstill.add(&measured, interval_s);
        } else {
            self.standstill = Standstill::default();
        }
        self.estimation.raw_sample(sample, interval_s, standing);
    }

    #[inline]
    fn answer(&mut self, sample: &Sample, health: Health, nis: f64, output: &mut Output) {
        self.answered = (sample.sequence, sample.device_time);
        if let Some(cursor) = &self.cursor {
            self.gimbals = Gimbals {
                stop: cursor.stop() as u16,
                moving: cursor.moving(self.phase_tick()),
                command: cursor.command(),
            };
        }
        *output = self.output(health, nis);
    }
}
