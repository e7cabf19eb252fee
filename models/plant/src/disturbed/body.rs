//! The moving body under disturbances: their onset and end, and the integration through them.

use super::motion::felt;
use super::pulse::{Excursion, Shock};
use super::registry::Lasting;
use super::shake::Shake;
use super::span::Span;
use super::turning::{Ring, Slip};
use super::{Active, Motion};
use crate::gimbal::AxisState;
use crate::increments::{Body, GAUSS, Increments, PIECE_MIN_S};
use crate::kinematics::Whereabouts;
use crate::trig::{rx_t, ry_t, rz_t};
use nalgebra::{UnitQuaternion, Vector3};
use octant_sample::disturbance::{Disturbance, GimbalAction, Motor};

/// Time in which a gear's play closes, s.
const CLOSING_S: f64 = 0.1;
/// Shortest duration of a motion, s.
const SHORTEST_S: f64 = 1e-6;

/// Replaces a value that isn't finite by 0, and limits it to ±1e6: kinds of faults refuse such
/// values.
fn finite(value: f64) -> f64 {
    if value.is_finite() { value.clamp(-1e6, 1e6) } else { 0.0 }
}

fn length(value: f64) -> f64 {
    finite(value).max(SHORTEST_S)
}

/// State of motion of the gimballed body in its own axes.
struct Gimballed {
    rate: Vector3<f64>,
    acceleration: Vector3<f64>,
    force: Vector3<f64>,
}

impl Body {
    pub(crate) fn motor(&self, now_ns: u64) -> Motor {
        let state = |gimbal: &crate::gimbal::Gimbal| gimbal.drive.at(gimbal.drive.seconds(now_ns));
        let [azimuth, roll] = [state(&self.azimuth), state(&self.roll)];
        Motor { angle_rad: [azimuth.angle, roll.angle], rate_radps: [azimuth.rate, roll.rate] }
    }

    /// Begins a disturbance; temperature is handled by the sensors.
    pub(crate) fn disturb(&mut self, handle: u32, disturbance: &Disturbance, now_ns: u64) {
        self.look_again();
        let span = Span::from(handle, now_ns);
        match disturbance {
            Disturbance::Vibration { lines, edge_s } => {
                self.active().vibrations.push(Shake::new(span, lines, *edge_s));
            }
            Disturbance::Shock { peak_mps2, width_s, recoil_s } => {
                self.active().shocks.push(Shock {
                    span,
                    peak: Vector3::from(peak_mps2.map(finite)),
                    width_s: length(*width_s),
                    recoil_s: length(*recoil_s),
                });
            }
            Disturbance::Case { lines, edge_s } => {
                self.active().sways.push(Shake::new(span, lines, *edge_s));
            }
            Disturbance::Excursion { displacement_m, angle_rad, length_s } => {
                self.active().excursions.push(Excursion {
                    span,
                    displacement: Vector3::from(displacement_m.map(finite)),
                    turn: Vector3::from(angle_rad.map(finite)),
                    length_s: length(*length_s),
                });
            }
            Disturbance::LeverArm(arms) => {
                self.registry.enter(handle, Lasting::LeverArm(arms.map(|arm| arm.map(finite))));
                self.set_lever_arms(now_ns);
            }
            Disturbance::Gimbal { gimbal, action } => {
                self.disturb_gimbal(handle, gimbal.index(), *action, now_ns);
            }
            // Temperature is handled by the sensors; other kinds are not known here.
            _ => {}
        }
        self.plan();
    }

    /// The disturbance of a handle ends.
    pub(crate) fn calm(&mut self, handle: u32, now_ns: u64) {
        self.look_again();
        match self.registry.leave(handle) {
            Some(Lasting::LeverArm(_)) => self.set_lever_arms(now_ns),
            Some(Lasting::Gimbal(gimbal, action)) => {
                self.calm_gimbal(handle, gimbal, action, now_ns);
            }
            None => {}
        }
        if let Some(active) = &mut self.active {
            active.end(handle, now_ns);
        }
        self.plan();
    }

    /// Returns whether the disturbance of a handle lasts, or a motion that it began is under way.
    pub(crate) fn goes_on(&self, handle: u32, now_ns: u64) -> bool {
        self.registry.holds(handle)
            || self.active.as_ref().is_some_and(|active| active.goes_on(handle, now_ns))
    }

    /// Returns whether both drives move, or rest, as those of another body.
    pub(crate) fn drives_as(&self, other: &Self, now_ns: u64) -> bool {
        self.azimuth.drives_as(&other.azimuth, now_ns) && self.roll.drives_as(&other.roll, now_ns)
    }

    fn active(&mut self) -> &mut Active {
        self.active.get_or_insert_default()
    }

    /// Plans the integration anew, so that every motion under way is integrated finely enough.
    pub(crate) fn plan(&mut self) {
        let (finest_s, period_s) = (self.piece_s, self.period_s);
        if let Some(active) = &mut self.active {
            if active.len() == 0 {
                self.active = None;
                self.case.undisturbed();
                return;
            }
            active.plan(period_s);
            active.piece_s = active.piece_s.min(finest_s);
            self.case.disturbed(active.moves_case());
        }
    }

    /// Removes the motions that are over, and plans the integration without them. A slip that is
    /// over stays as an offset of its gimbal.
    pub(crate) fn settle(&mut self, now_ns: u64) {
        let Some(mut active) = self.active.take() else { return };
        let before = active.len();
        active.settle(now_ns);
        for slip in active.slips.iter().filter(|slip| slip.is_over(now_ns)) {
            self.gimbal_mut(slip.gimbal).slipped(slip.angle_rad, slip.seen);
        }
        active.slips.retain(|slip| !slip.is_over(now_ns));
        let less = active.len() < before;
        self.active = Some(active);
        if less {
            self.plan();
        }
    }

    fn gimbal_mut(&mut self, gimbal: usize) -> &mut crate::gimbal::Gimbal {
        if gimbal == 0 { &mut self.azimuth } else { &mut self.roll }
    }

    fn set_lever_arms(&mut self, now_ns: u64) {
        let mut arms = self.own_lever_arm.unwrap_or_default();
        let mut any = self.own_lever_arm.is_some();
        for more in self.registry.lever_arms() {
            any = true;
            for axis in 0..3 {
                arms[axis] += Vector3::from(more[axis]);
            }
        }
        if any && self.lever_arm.is_none() {
            self.rate_at_end = self.rate_at(now_ns);
        }
        self.lever_arm = any.then_some(arms);
    }

    /// Angular rate of the sensor block at the start of the next interval.
    fn rate_at(&self, now_ns: u64) -> Vector3<f64> {
        let mut copy = self.clone();
        let active = copy.active.take().unwrap_or_default();
        let gimballed = copy.gimballed(&active, now_ns, 0.0, None, 0.0);
        copy.shaken(&active, now_ns, 0.0, None, &gimballed).0
    }

    fn disturb_gimbal(&mut self, handle: u32, gimbal: usize, action: GimbalAction, now_ns: u64) {
        match action {
            GimbalAction::Slip { angle_rad, within_s, seen } => {
                self.active().slips.push(Slip {
                    handle,
                    gimbal,
                    from_ns: now_ns,
                    angle_rad: finite(angle_rad),
                    within_s: length(within_s),
                    seen,
                });
                return;
            }
            _ => self.registry.enter(handle, Lasting::Gimbal(gimbal, action)),
        }
        match action {
            GimbalAction::Stall | GimbalAction::Runaway { .. } => self.hold(gimbal, now_ns),
            GimbalAction::Backlash { .. } => {
                let half = self.half_play(gimbal);
                self.gimbal_mut(gimbal).change_play(half, now_ns);
            }
            _ => {}
        }
        self.set_harm(gimbal);
    }

    fn calm_gimbal(&mut self, handle: u32, gimbal: usize, action: GimbalAction, now_ns: u64) {
        self.set_harm(gimbal);
        match action {
            GimbalAction::Stall | GimbalAction::Runaway { .. } => self.hold(gimbal, now_ns),
            GimbalAction::Backlash { .. } => {
                let half = self.half_play(gimbal);
                let out = self.gimbal_mut(gimbal).change_play(half, now_ns);
                if out != 0.0 {
                    self.active().slips.push(Slip {
                        handle,
                        gimbal,
                        from_ns: now_ns,
                        angle_rad: -out,
                        within_s: CLOSING_S,
                        seen: false,
                    });
                }
            }
            _ => {}
        }
    }

    fn half_play(&self, gimbal: usize) -> f64 {
        let plays = self.registry.of(gimbal).map(|action| match action {
            GimbalAction::Backlash { play_rad } => 0.5 * finite(play_rad).max(0.0),
            _ => 0.0,
        });
        plays.sum()
    }

    /// Lets the latest fault that holds the drive rule it, whatever is commanded; without such a
    /// fault the drive goes to its set point.
    fn hold(&mut self, gimbal: usize, now_ns: u64) {
        let holding = self.registry.of(gimbal).filter_map(|action| match action {
            GimbalAction::Stall => Some(0.0),
            GimbalAction::Runaway { rate_radps } => Some(finite(rate_radps)),
            _ => None,
        });
        let rate = holding.last();
        self.forget_rings(gimbal, now_ns);
        let axis = self.gimbal_mut(gimbal);
        axis.harm.held = rate.is_some();
        match rate {
            Some(rate_radps) => axis.run_on(rate_radps, now_ns),
            None => {
                axis.go(now_ns);
                self.let_ring(gimbal, now_ns);
            }
        }
    }

    /// Sets the encoder error and the overshoot that faults cause in readings and later moves.
    fn set_harm(&mut self, gimbal: usize) {
        let (mut encoder, mut overshoot) = (0.0, 0.0f64);
        for action in self.registry.of(gimbal) {
            match action {
                GimbalAction::EncoderSlip { angle_rad, .. } => encoder += finite(angle_rad),
                GimbalAction::Overshoot { angle_rad } => overshoot += finite(angle_rad).max(0.0),
                _ => {}
            }
        }
        let harm = &mut self.gimbal_mut(gimbal).harm;
        (harm.encoder, harm.overshoot) = (encoder, overshoot);
    }

    /// Plans the rings of gimbals that got new set points, and drops their pending rings.
    #[cold]
    pub(crate) fn set_out(&mut self, new: [bool; 2], now_ns: u64) {
        for gimbal in 0..2 {
            if new[gimbal] && !self.gimbal_mut(gimbal).harm.held {
                self.forget_rings(gimbal, now_ns);
                self.let_ring(gimbal, now_ns);
            }
        }
        self.plan();
    }

    /// Drops the rings of moves that have not ended.
    fn forget_rings(&mut self, gimbal: usize, now_ns: u64) {
        if let Some(active) = &mut self.active {
            active.rings.retain(|ring| ring.gimbal != gimbal || !ring.is_pending(now_ns));
        }
    }

    /// Plans the ring at the end of the move that has just begun.
    fn let_ring(&mut self, gimbal: usize, now_ns: u64) {
        let delay_s = self.gimbal_mut(gimbal).move_left_s(now_ns);
        if delay_s <= 0.0 {
            return;
        }
        let rings: Vec<Ring> = self
            .registry
            .with_handles(gimbal)
            .filter_map(|(handle, action)| match action {
                GimbalAction::Ringing { amplitude_rad, frequency_hz, decay_s } => Some(Ring {
                    handle,
                    gimbal,
                    from_ns: now_ns,
                    delay_s,
                    amplitude_rad: finite(amplitude_rad),
                    frequency_hz: finite(frequency_hz).max(1e-6),
                    decay_s: length(decay_s),
                }),
                _ => None,
            })
            .collect();
        if !rings.is_empty() {
            self.active().rings.extend(rings);
        }
    }

    /// Integrals from `from_s` to `to_s` after the start of the interval, while a fault moves
    /// something.
    pub(crate) fn integrate_disturbed(
        &mut self,
        start_ns: u64,
        from_s: f64,
        to_s: f64,
    ) -> Increments {
        let mut sum = Increments::default();
        let Some(mut active) = self.active.take() else { return sum };
        let mut cuts = core::mem::take(&mut active.cuts);
        cuts.clear();
        active.knots(start_ns, &mut cuts);
        for gimbal in [&self.azimuth, &self.roll] {
            let begin = gimbal.body.seconds(start_ns);
            cuts.extend(gimbal.body.knots().map(|knot| knot - begin));
        }
        cuts.retain(|at| *at > from_s + PIECE_MIN_S && *at < to_s - PIECE_MIN_S);
        cuts.push(to_s);
        cuts.sort_unstable_by(f64::total_cmp);
        let mut a = from_s;
        for b in &cuts {
            self.integrate_stretch(&mut active, &mut sum, start_ns, a, *b);
            a = *b;
        }
        active.cuts = cuts;
        if let Some(arms) = self.lever_arm {
            let gimballed = self.gimballed(&active, start_ns, to_s, None, to_s);
            let (rate, _) = self.shaken(&active, start_ns, to_s, None, &gimballed);
            let change = rate - self.rate_at_end;
            self.rate_at_end = rate;
            for axis in 0..3 {
                sum.delta_velocity[axis] += change.cross(&arms[axis])[axis];
            }
        }
        self.active = Some(active);
        sum
    }

    /// Adds a stretch without a knot inside.
    fn integrate_stretch(
        &mut self,
        active: &mut Active,
        sum: &mut Increments,
        start_ns: u64,
        a: f64,
        b: f64,
    ) {
        if b - a < PIECE_MIN_S {
            return;
        }
        let pieces = libm::ceil((b - a) / active.piece_s - 1e-9).max(1.0);
        let width = (b - a) / pieces;
        active.lay(start_ns, a + 0.5 * width, width, 0.5 * width * GAUSS[2].0);
        for piece in 0..pieces as u64 {
            if piece > 0 {
                active.advance();
            }
            let middle = a + (piece as f64 + 0.5) * width;
            for (node, (x, w)) in (-1..=1).zip(GAUSS) {
                let at = middle + 0.5 * width * x;
                let gimballed = self.gimballed(active, start_ns, at, Some(node), 0.5 * (a + b));
                let (rate, mut force) = self.shaken(active, start_ns, at, Some(node), &gimballed);
                if let Some(arms) = &self.lever_arm {
                    for axis in 0..3 {
                        force[axis] += rate.cross(&rate.cross(&arms[axis]))[axis];
                    }
                }
                sum.delta_theta += rate * (w * width);
                sum.delta_velocity += force * (w * width);
            }
        }
    }

    /// The gimballed body at a time after the start of the present interval; `inside_s` lies on the
    /// stretch of that time.
    fn gimballed(
        &mut self,
        active: &Active,
        start_ns: u64,
        at: f64,
        node: Option<i8>,
        inside_s: f64,
    ) -> Gimballed {
        let case = self
            .case
            .displaced(start_ns as f64 * 1e-9 + at, active.case(start_ns, at, node).as_ref());
        let axis = |gimbal: &crate::gimbal::Gimbal, index: usize| {
            let arc = gimbal.body.arc(start_ns, inside_s);
            let (angle, rate) = arc.at(at);
            let beside = active.gimbal(index, start_ns, at);
            AxisState {
                angle: angle + beside.angle,
                rate: rate + beside.rate,
                acceleration: arc.origin.acceleration + beside.acceleration,
            }
        };
        let (azimuth, roll) = (axis(&self.azimuth, 0), axis(&self.roll, 1));
        let (roll_sincos, azimuth_sincos) = (libm::sincos(roll.angle), libm::sincos(azimuth.angle));
        let (x, z) = (Vector3::x(), Vector3::z());
        let turned = rx_t(&case.rate, roll_sincos);
        let inner = ry_t(&(turned + x * roll.rate), self.tilt_sincos);
        let turned_inner = rz_t(&inner, azimuth_sincos);
        let outer_acceleration = rx_t(&case.acceleration, roll_sincos)
            - x.cross(&turned) * roll.rate
            + x * roll.acceleration;
        let inner = Gimballed {
            rate: turned_inner + z * azimuth.rate,
            acceleration: rz_t(&ry_t(&outer_acceleration, self.tilt_sincos), azimuth_sincos)
                - z.cross(&turned_inner) * azimuth.rate
                + z * azimuth.acceleration,
            force: rz_t(&ry_t(&rx_t(&case.force, roll_sincos), self.tilt_sincos), azimuth_sincos),
        };
        let Some(mounting) = &self.mounting else { return inner };
        Gimballed {
            rate: mounting * inner.rate,
            acceleration: mounting * inner.acceleration,
            force: mounting * inner.force,
        }
    }

    /// Rate and specific force of the sensor block.
    fn shaken(
        &self,
        active: &Active,
        start_ns: u64,
        at: f64,
        node: Option<i8>,
        gimballed: &Gimballed,
    ) -> (Vector3<f64>, Vector3<f64>) {
        if self.vibration.is_none() && !active.moves_block() {
            return (gimballed.rate, gimballed.force);
        }
        let mut motion = active.block(start_ns, at, node);
        if let Some(vibration) = &self.vibration {
            motion.add(&crate::vibration::motion(vibration, start_ns as f64 * 1e-9 + at));
        }
        felt(&motion, &gimballed.rate, &gimballed.acceleration, &gimballed.force)
    }

    /// Position, velocity and attitude of the case at the stamp of the last sample.
    pub(crate) fn whereabouts(&self, now_ns: u64) -> Whereabouts {
        let time_s = now_ns as f64 * 1e-9;
        match self.active.as_ref().and_then(|active| active.case(now_ns, 0.0, None)) {
            Some(motion) => self.case.whereabouts_displaced(time_s, &motion),
            None => self.case.whereabouts(time_s),
        }
    }

    /// Displacement of the sensor block against the gimballed body by faults, and the angular rate
    /// of the body in its own axes; `None` if no fault moves the block.
    pub(crate) fn block(&self, now_ns: u64) -> Option<(Motion, Vector3<f64>)> {
        let active = self.active.as_ref().filter(|active| active.moves_block())?;
        let motion = active.block(now_ns, 0.0, None);
        let mut copy = self.clone();
        let rate = copy.gimballed(active, now_ns, 0.0, None, 0.0).rate;
        Some((motion, rate))
    }

    /// Angle of a gimbal's body against its drive's profile, rad.
    pub(crate) fn beside(&self, gimbal: usize, now_ns: u64) -> f64 {
        self.active.as_ref().map_or(0.0, |active| active.gimbal(gimbal, now_ns, 0.0).angle)
    }
}

impl Motion {
    /// Rotation of the block.
    pub(crate) fn rotation(&self) -> UnitQuaternion<f64> {
        octant_earth::rotation::exp(&self.turn[0])
    }
}
