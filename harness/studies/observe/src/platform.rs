//! Platform of an analysis: it stands at a site and turns as planned.

use super::border::{FurtherModel, Step, integrals};
use nalgebra::{Matrix3, Vector3};
use octant_calibration::config::{CoreConfig, ErrorModel};
use octant_calibration::covariance::{MOVING, Transition};
use octant_calibration::error_model::MotionInterval;
use octant_calibration::filter::FURTHER_ROW;
use octant_calibration::schedule::{Cursor, turned_rad};
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::frames::c_cb;
use octant_plant::config::Temperature;
use octant_sample::GimbalAngles;

/// Sub-step of the transition while a gimbal turns, s.
const SUB_STEP_S: f64 = 0.05;
/// Sample time that the cursors are given, s: far below any time in a plan.
pub(super) const SAMPLE_S: f64 = 1e-6;

/// A platform that stands at a site and turns as planned.
pub(super) struct Platform<'a> {
    config: &'a CoreConfig,
    c_nc: Matrix3<f64>,
    /// Angle by which the gimbal axes deviate from a right angle, rad.
    non_orthogonality_rad: f64,
    pub(super) earth: Ellipsoid,
    pub(super) cursor: Cursor,
    from: [f64; 2],
    to: [f64; 2],
    departed_s: f64,
    /// Course of the temperature, and its age at time 0, s.
    warming: Option<(Temperature, f64)>,
}

impl<'a> Platform<'a> {
    /// Creates a platform whose gimbals are at `home` and, at time 0, depart for the first stop of
    /// `cursor`, which must be planned from the same angles: a phase that doesn't begin where the
    /// previous one ended opens with a move, whose errors from scale factors and misalignments are
    /// carried like any others.
    pub(super) fn new(
        config: &'a CoreConfig,
        c_nc: Matrix3<f64>,
        non_orthogonality_rad: f64,
        home: GimbalAngles,
        cursor: Cursor,
    ) -> Self {
        let angles = |at: GimbalAngles| [at.azimuth_rad(), at.roll_rad()];
        let to = angles(cursor.command().target);
        // A cursor planned with the gimbals already there has no move.
        let from = if cursor.arrival_s() > 0.0 { angles(home) } else { to };
        let earth = Ellipsoid::at(config.site.latitude_rad, config.site.height_m);
        let (departed_s, warming) = (0.0, None);
        Self { config, c_nc, non_orthogonality_rad, earth, cursor, from, to, departed_s, warming }
    }

    /// The same with a temperature that began to change `age_s` before time 0.
    pub(super) fn warmed(self, temperature: Option<Temperature>, age_s: f64) -> Self {
        Self { warming: temperature.map(|temperature| (temperature, age_s)), ..self }
    }

    /// Returns whether a step is another one at another time, though the platform stands.
    pub(super) fn is_warmed(&self) -> bool {
        self.warming.is_some()
    }

    /// Change of the temperature at a time, K.
    fn warmth_k(&self, t_s: f64) -> f64 {
        let Some((temperature, age_s)) = &self.warming else { return 0.0 };
        let (risen, plateau) = (temperature.ramp_kps * (age_s + t_s), temperature.plateau_k);
        if risen.abs() < plateau.abs() { risen } else { plateau }
    }

    /// Returns the commanded gimbal angles.
    pub(super) fn target(&self) -> GimbalAngles {
        self.cursor.command().target
    }

    /// Returns the gimbal angles at `t_s`.
    fn gimbals(&self, t_s: f64) -> [f64; 2] {
        core::array::from_fn(|i| {
            let angle = self.to[i] - self.from[i];
            self.from[i] + turned_rad(angle, t_s - self.departed_s, &self.config.turntable)
        })
    }

    /// Returns `c_cb` with the true gimbal axes.
    fn c_cb(&self, azimuth: f64, roll: f64) -> Matrix3<f64> {
        if self.non_orthogonality_rad == 0.0 {
            return c_cb(azimuth, roll);
        }
        let (s, c) = libm::sincos(self.non_orthogonality_rad);
        let leant = Matrix3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c);
        c_cb(0.0, roll) * leant * c_cb(azimuth, 0.0)
    }

    /// Advances the platform to `t_s`, so that it may depart. Sample time is one microsecond here,
    /// finer than any plan.
    pub(super) fn reach(&mut self, t_s: f64) {
        let departs = self.cursor.departure_s();
        if t_s >= departs - 1e-6 {
            self.from = self.to;
            self.departed_s = departs;
            self.cursor.advance((t_s / SAMPLE_S) as u64);
            let target = self.cursor.command().target;
            self.to = [target.azimuth_rad(), target.roll_rad()];
        }
    }

    /// Returns whether the platform stands at `t_s`, and for a while after it.
    pub(super) fn stands(&self, t_s: f64) -> bool {
        self.cursor.arrival_s() <= t_s + 1e-6
    }

    /// Returns the next time at which the platform starts or stops turning, or `limit_s`.
    pub(super) fn next_event_s(&self, t_s: f64, limit_s: f64) -> f64 {
        [self.cursor.arrival_s(), self.cursor.departure_s()]
            .into_iter()
            .filter(|event| *event > t_s + 1e-6)
            .fold(limit_s, f64::min)
    }

    fn interval(&self, t_s: f64, h: f64) -> MotionInterval {
        let [azimuth, roll] = self.gimbals(t_s + 0.5 * h);
        let (before, after) = (self.gimbals(t_s), self.gimbals(t_s + h));
        let c_cb = self.c_cb(azimuth, roll);
        let c_nb = self.c_nc * c_cb;
        let force_n = Vector3::new(0.0, 0.0, -self.earth.gravity_mps2 * h);
        let turned_case = Vector3::x() * (after[1] - before[1]);
        let turned_body = Vector3::z() * (after[0] - before[0]);
        MotionInterval {
            interval_s: h,
            c_nb,
            delta_theta: c_nb.transpose() * self.earth.earth_rate() * h
                + c_cb.transpose() * turned_case
                + turned_body,
            delta_velocity: c_nb.transpose() * force_n,
            delta_velocity_n: force_n,
            velocity_mps: Vector3::zeros(),
        }
    }

    /// Returns the step over `[t_s, t_s + length_s]`, in which the platform stands or turns
    /// throughout: the transition, and what the further states do.
    pub(super) fn step(
        &self,
        t_s: f64,
        length_s: f64,
        model: ErrorModel,
        further: Option<&FurtherModel>,
    ) -> Step {
        let step_s = if self.stands(t_s) { 1.0 } else { SUB_STEP_S };
        let steps = (length_s / step_s - 1e-9).ceil().max(1.0);
        let h = length_s / steps;
        let mut transition = Transition::identity();
        let mut columns = further.map(|_| [[0.0; FURTHER_ROW]; MOVING]);
        for k in 0..steps as u32 {
            let since_s = f64::from(k) * h;
            let interval = self.interval(t_s + since_s, h);
            transition.advance(model, &interval, &self.earth);
            if let (Some(further), Some(columns)) = (further, &mut columns) {
                let change = self.rate(t_s + since_s + h) - self.rate(t_s + since_s);
                let middle_s = since_s + 0.5 * h;
                let integrals = integrals(&interval, &change, self.warmth_k(t_s + middle_s));
                further.advance(columns, model, &interval, &integrals, &self.earth, middle_s);
            }
        }
        let further = columns.zip(further.map(|further| further.decay(length_s)));
        Step { transition, further }
    }

    /// Returns the rate of the body in b at a time, rad/s.
    fn rate(&self, t_s: f64) -> Vector3<f64> {
        // Short against the time in which a gimbal gains its rate, long against the resolution of angles.
        const H: f64 = 1e-5;
        self.interval(t_s - 0.5 * H, H).delta_theta / H
    }
}
