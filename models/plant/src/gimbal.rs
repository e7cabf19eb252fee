//! One gimbal: a drive that follows set points with a trapezoidal rate, and a body behind a gear
//! with play.

/// A piece of a profile with constant acceleration.
#[derive(Clone, Copy, Debug, Default, serde::Serialize, serde::Deserialize)]
struct Segment {
    /// Start, s since the profile's origin.
    start_s: f64,
    angle: f64,
    rate: f64,
    acceleration: f64,
}

/// State of an axis at an instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct AxisState {
    pub(crate) angle: f64,
    pub(crate) rate: f64,
    pub(crate) acceleration: f64,
}

impl Segment {
    #[inline]
    fn at(&self, time_s: f64) -> AxisState {
        let t = time_s - self.start_s;
        AxisState {
            angle: self.angle + t * (self.rate + 0.5 * self.acceleration * t),
            rate: self.rate + self.acceleration * t,
            acceleration: self.acceleration,
        }
    }
}

/// Motion of an axis over a stretch without a knot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arc {
    /// State at the start of the interval, on the parabola of the stretch.
    pub(crate) origin: AxisState,
}

impl Arc {
    /// State at a time after the start of the interval, s.
    #[inline(always)]
    pub(crate) fn at(&self, time_s: f64) -> (f64, f64) {
        let AxisState { angle, rate, acceleration } = self.origin;
        (angle + time_s * (rate + 0.5 * acceleration * time_s), rate + acceleration * time_s)
    }

    /// Returns whether the axis rests.
    #[inline(always)]
    pub(crate) fn rests(&self) -> bool {
        self.origin.rate == 0.0 && self.origin.acceleration == 0.0
    }
}

/// Largest number of pieces of a drive profile: brake, accelerate, cruise, decelerate; after an
/// overshoot the last three again. The play of the gear can cut each in two.
const SEGMENTS_MAX: usize = 14;

/// Duration beyond that of any run, s.
const FOR_GOOD_S: f64 = 1e9;

/// Angle over time as pieces of parabolas, at rest from `end_s` on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Profile {
    origin_ns: u64,
    segments: [Segment; SEGMENTS_MAX],
    len: usize,
    end_s: f64,
    end_angle: f64,
}

impl octant_state::State for Profile {
    /// Saves only the pieces in use.
    fn save(&self, to: &mut octant_state::Writer) {
        let Self { origin_ns, segments, len, end_s, end_angle } = self;
        to.value("origin_ns", origin_ns);
        to.value("end", &(end_s, end_angle));
        to.value("len", len);
        for segment in &segments[..*len] {
            to.value("segment", segment);
        }
    }

    fn load(
        &mut self,
        from: &mut octant_state::StateReader<'_>,
    ) -> Result<(), octant_state::StateError> {
        self.origin_ns = from.value("origin_ns")?;
        (self.end_s, self.end_angle) = from.value("end")?;
        self.len = from.value("len")?;
        octant_state::check_below("len", self.len as u64, SEGMENTS_MAX as u64)?;
        if self.len == 0 && !(self.end_s <= 0.0) {
            let problem = "a profile without pieces has ended when it begins";
            return Err(octant_state::StateError::value("end", problem));
        }
        for segment in &mut self.segments[..self.len] {
            *segment = from.value("segment")?;
        }
        Ok(())
    }
}

impl Profile {
    fn rest(origin_ns: u64, angle: f64) -> Self {
        let segments = [Segment::default(); SEGMENTS_MAX];
        Self { origin_ns, segments, len: 0, end_s: 0.0, end_angle: angle }
    }

    /// Appends a piece of a duration, starting where the last piece ends.
    fn push(&mut self, duration_s: f64, from: AxisState) {
        if duration_s > 0.0 && self.len < SEGMENTS_MAX {
            self.segments[self.len] = Segment {
                start_s: self.end_s,
                angle: from.angle,
                rate: from.rate,
                acceleration: from.acceleration,
            };
            self.len += 1;
            self.end_s += duration_s;
        }
    }

    /// Seconds since the profile's origin of a time in ns.
    #[inline]
    pub(crate) fn seconds(&self, time_ns: u64) -> f64 {
        (time_ns - self.origin_ns) as f64 * 1e-9
    }

    /// State at a time since the profile's origin, s.
    #[inline]
    pub(crate) fn at(&self, time_s: f64) -> AxisState {
        self.state(time_s, time_s)
    }

    /// The arc of the interval that starts at `start_ns`, on the piece that holds `inside_s`
    /// after it.
    #[inline]
    pub(crate) fn arc(&self, start_ns: u64, inside_s: f64) -> Arc {
        let start_s = self.seconds(start_ns);
        Arc { origin: self.state(start_s + inside_s, start_s) }
    }

    /// State at `time_s` on the piece that holds `inside_s`.
    #[inline]
    fn state(&self, inside_s: f64, time_s: f64) -> AxisState {
        if inside_s >= self.end_s {
            return AxisState { angle: self.end_angle, ..AxisState::default() };
        }
        let mut segment = &self.segments[0];
        for later in &self.segments[1..self.len] {
            if later.start_s <= inside_s {
                segment = later;
            }
        }
        segment.at(time_s)
    }

    /// Times at which the pieces meet, s since the profile's origin, the end included.
    pub(crate) fn knots(&self) -> impl Iterator<Item = f64> + '_ {
        let end = (self.len > 0).then_some(self.end_s);
        self.segments[..self.len].iter().map(|segment| segment.start_s).chain(end)
    }

    /// Profile from the present state to rest at `target`, as fast as the limits allow and without
    /// overshoot; if the target lies behind, or within the stopping distance, it brakes first.
    fn to(target: f64, now: AxisState, origin_ns: u64, rate: f64, acceleration: f64) -> Self {
        let mut profile = Self::rest(origin_ns, target);
        let (mut angle, mut speed) = (now.angle, now.rate);
        let stop = speed * speed / (2.0 * acceleration);
        let ahead = (target - angle) * if speed < 0.0 { -1.0 } else { 1.0 };
        // A move that is followed to its end reaches its stopping distance exactly; rounding must
        // not make it brake and creep back.
        let slack = 1e-12 * (1.0 + stop);
        if speed != 0.0 && ahead < stop - slack {
            let brake =
                AxisState { angle, rate: speed, acceleration: -acceleration.copysign(speed) };
            profile.push(speed.abs() / acceleration, brake);
            angle += stop.copysign(speed);
            speed = 0.0;
        }
        let distance = target - angle;
        let sign = 1.0f64.copysign(if speed != 0.0 { speed } else { distance });
        let (distance, speed) = (distance.abs(), speed.abs());
        if distance == 0.0 && speed == 0.0 {
            return profile;
        }
        let peak = libm::sqrt(acceleration * distance + 0.5 * speed * speed).min(rate).max(speed);
        let risen = (peak * peak - speed * speed) / (2.0 * acceleration);
        let fall = peak * peak / (2.0 * acceleration);
        let cruise = (distance - risen - fall).max(0.0);
        profile.push(
            (peak - speed) / acceleration,
            AxisState { angle, rate: sign * speed, acceleration: sign * acceleration },
        );
        angle += sign * risen;
        let flat = AxisState { angle, rate: sign * peak, acceleration: 0.0 };
        profile.push(cruise / peak, flat);
        // The last piece is computed backwards from the target, so that it ends there exactly.
        let last = AxisState {
            angle: target - sign * fall,
            rate: sign * peak,
            acceleration: -sign * acceleration,
        };
        profile.push(peak / acceleration, last);
        profile
    }

    /// Profile that changes to a rate with the given acceleration and keeps that rate.
    fn onward(rate: f64, now: AxisState, origin_ns: u64, acceleration: f64) -> Self {
        let change = rate - now.rate;
        let pull = acceleration.copysign(change);
        let duration_s = change.abs() / acceleration;
        let angle = now.angle + 0.5 * (now.rate + rate) * duration_s;
        let mut profile = Self::rest(origin_ns, angle);
        // A piece must not contain a reversal: the rate passes zero between pieces only.
        let to_stop_s = -now.rate / pull;
        if to_stop_s > 0.0 && to_stop_s < duration_s {
            profile.push(to_stop_s, AxisState { acceleration: pull, ..now });
            let stopped = now.angle + 0.5 * now.rate * to_stop_s;
            let on = AxisState { angle: stopped, rate: 0.0, acceleration: pull };
            profile.push(duration_s - to_stop_s, on);
        } else {
            profile.push(duration_s, AxisState { acceleration: pull, ..now });
        }
        if rate != 0.0 {
            profile.push(FOR_GOOD_S, AxisState { angle, rate, acceleration: 0.0 });
            profile.end_angle = angle + FOR_GOOD_S * rate;
        }
        profile
    }

    /// Extends this profile by an angle beyond its end, and back.
    fn overshooting(&self, beyond: f64, rate: f64, acceleration: f64) -> Self {
        let Some(last) = self.segments[..self.len].last() else { return *self };
        let start = self.at(0.0);
        let passed = self.end_angle - beyond.copysign(last.acceleration);
        let mut profile = Self::to(passed, start, self.origin_ns, rate, acceleration);
        let top = AxisState { angle: passed, ..AxisState::default() };
        let back = Self::to(self.end_angle, top, 0, rate, acceleration);
        for index in 0..back.len {
            let end_s =
                if index + 1 < back.len { back.segments[index + 1].start_s } else { back.end_s };
            let segment = back.segments[index];
            profile.push(end_s - segment.start_s, segment.at(segment.start_s));
        }
        profile.end_angle = self.end_angle;
        profile
    }

    /// Rest of the profile from a time on.
    fn after(&self, now_ns: u64) -> Self {
        let now_s = self.seconds(now_ns);
        let mut profile = Self::rest(now_ns, self.end_angle);
        for index in 0..self.len {
            let segment = self.segments[index];
            let next = index + 1;
            let end_s = if next < self.len { self.segments[next].start_s } else { self.end_s };
            let from_s = segment.start_s.max(now_s);
            profile.push(end_s - from_s, segment.at(from_s));
        }
        profile
    }

    /// The same profile with an offset added to every angle.
    fn shifted(mut self, angle: f64) -> Self {
        if angle != 0.0 {
            self.segments.iter_mut().for_each(|segment| segment.angle += angle);
            self.end_angle += angle;
        }
        self
    }

    /// Motion of a body behind a gear with play ±`half` when the drive follows this profile: it
    /// rests until the drive has crossed the play, then follows at its edge.
    fn behind_play(&self, mut body: f64, half: f64) -> Self {
        if half == 0.0 {
            return *self;
        }
        let mut profile = Self::rest(self.origin_ns, body);
        for i in 0..self.len {
            let segment = self.segments[i];
            let end_s = if i + 1 < self.len { self.segments[i + 1].start_s } else { self.end_s };
            let duration = end_s - segment.start_s;
            let end = segment.at(end_s);
            // Pieces are cut at zero rate, so that none changes direction inside.
            let sign = 1.0f64.copysign(end.angle - segment.angle);
            let to_edge = sign * (body + sign * half - segment.angle);
            let still = AxisState { angle: body, ..AxisState::default() };
            let travel = sign * (end.angle - segment.angle);
            if to_edge >= travel {
                profile.push(duration, still);
                continue;
            }
            let mut picked_up = 0.0;
            if to_edge > 0.0 {
                let (v, a) = (sign * segment.rate, sign * segment.acceleration);
                let root = libm::sqrt((v * v + 2.0 * a * to_edge).max(0.0));
                picked_up = between(2.0 * to_edge / (v + root), 0.0, duration);
                profile.push(picked_up, still);
            }
            let mut follow = segment.at(segment.start_s + picked_up);
            follow.angle -= sign * half;
            profile.push(duration - picked_up, follow);
            body = end.angle - sign * half;
        }
        profile.end_angle = body;
        profile
    }
}

/// Limits a value to `low` to `high`; NaN stays NaN.
fn between(value: f64, low: f64, high: f64) -> f64 {
    if value < low {
        low
    } else if value > high {
        high
    } else {
        value
    }
}

/// Damage by faults to a gimbal.
#[derive(Clone, Copy, Debug, Default, serde::Serialize, serde::Deserialize)]
pub(crate) struct Harm {
    /// True if the gimbal doesn't follow set points.
    pub(crate) held: bool,
    /// Angle by which moves go too far, rad.
    pub(crate) overshoot: f64,
    /// Half of the play that faults add to that of the gear, rad.
    pub(crate) half_play: f64,
    /// Angle by which the body has slipped against its drive, rad.
    pub(crate) slipped: f64,
    /// Part of `slipped` that the encoder saw, rad.
    pub(crate) slipped_seen: f64,
    /// Error that faults add to the encoder, rad.
    pub(crate) encoder: f64,
}

/// A gimbal with its limits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gimbal {
    rate: f64,
    acceleration: f64,
    half_play: f64,
    target: i32,
    pub(crate) harm: Harm,
    /// The drive, which the encoder reads.
    pub(crate) drive: Profile,
    /// The body, which the sensors feel.
    pub(crate) body: Profile,
}

octant_state::state! {
    Gimbal { values: target, harm; parts: drive, body; kept: rate, acceleration, half_play }
}

impl Gimbal {
    /// Makes a gimbal at rest at angle 0, in the middle of its play.
    pub(crate) fn new(rate_radps: f64, acceleration_radps2: f64, backlash_rad: f64) -> Self {
        Self {
            rate: rate_radps,
            acceleration: acceleration_radps2,
            half_play: 0.5 * backlash_rad,
            target: 0,
            harm: Harm::default(),
            drive: Profile::rest(0, 0.0),
            body: Profile::rest(0, 0.0),
        }
    }

    /// Checks that drive and body began their motions no later than now.
    pub(crate) fn check(&self, now_ns: u64) -> Result<(), octant_state::StateError> {
        for profile in [&self.drive, &self.body] {
            octant_state::check_below("origin_ns", profile.origin_ns, now_ns)?;
        }
        Ok(())
    }

    /// Takes the set point in counts, from `now_ns` on. Returns true if it is a new one.
    #[inline]
    pub(crate) fn command(&mut self, target: i32, now_ns: u64) -> bool {
        if target == self.target {
            return false;
        }
        self.turn_to(target, now_ns);
        true
    }

    #[cold]
    fn turn_to(&mut self, target: i32, now_ns: u64) {
        self.target = target;
        if !self.harm.held {
            self.go(now_ns);
        }
    }

    /// Starts from the present state towards the set point.
    pub(crate) fn go(&mut self, now_ns: u64) {
        let now = self.drive.at(self.drive.seconds(now_ns));
        let target_rad = f64::from(self.target) * octant_sample::counts::GIMBAL_LSB_RAD;
        let mut drive = Profile::to(target_rad, now, now_ns, self.rate, self.acceleration);
        if self.harm.overshoot > 0.0 {
            drive = drive.overshooting(self.harm.overshoot, self.rate, self.acceleration);
        }
        self.take(drive, now_ns);
    }

    /// Starts towards a set point with a rate of its own, even if the set point is the same.
    pub(crate) fn aim(&mut self, target: i32, rate_radps: f64, now_ns: u64) {
        self.rate = rate_radps;
        self.target = target;
        self.go(now_ns);
    }

    /// Turns on with a constant rate; 0 brakes and stops.
    pub(crate) fn run_on(&mut self, rate_radps: f64, now_ns: u64) {
        let now = self.drive.at(self.drive.seconds(now_ns));
        self.take(Profile::onward(rate_radps, now, now_ns, self.acceleration), now_ns);
    }

    fn take(&mut self, drive: Profile, now_ns: u64) {
        let body = self.body.at(self.body.seconds(now_ns)).angle - self.harm.slipped;
        self.drive = drive;
        self.body = self.drive.behind_play(body, self.play()).shifted(self.harm.slipped);
    }

    fn play(&self) -> f64 {
        self.half_play + self.harm.half_play
    }

    /// Changes the play that a fault adds to that of the gear to ±`half`. Returns the angle by
    /// which the body lies outside the new play: the body stays where it is, and has to be brought
    /// back.
    pub(crate) fn change_play(&mut self, half: f64, now_ns: u64) -> f64 {
        self.harm.half_play = half;
        let drive = self.drive.at(self.drive.seconds(now_ns)).angle;
        let body = self.body.at(self.body.seconds(now_ns)).angle - self.harm.slipped;
        let inside = between(body, drive - self.play(), drive + self.play());
        let out = body - inside;
        self.harm.slipped += out;
        let left = self.drive.after(now_ns);
        self.body = left.behind_play(inside, self.play()).shifted(self.harm.slipped);
        out
    }

    /// Adds a slip of the body against its drive.
    pub(crate) fn slipped(&mut self, angle: f64, seen: bool) {
        self.harm.slipped += angle;
        if seen {
            self.harm.slipped_seen += angle;
        }
        self.body = self.body.shifted(angle);
    }

    /// Angle that the encoder reads at a time, rad, without its error curve.
    pub(crate) fn read(&self, now_ns: u64) -> f64 {
        let drive = self.drive.at(self.drive.seconds(now_ns)).angle;
        drive + (self.harm.slipped_seen + self.harm.encoder)
    }

    /// Time for which the move goes on, s.
    pub(crate) fn move_left_s(&self, now_ns: u64) -> f64 {
        self.drive.end_s - self.drive.seconds(now_ns)
    }

    /// Returns whether the drive moves, or rests, as that of another gimbal: at a time, and to the same end.
    pub(crate) fn drives_as(&self, other: &Self, now_ns: u64) -> bool {
        let at = |drive: &Profile| drive.at(drive.seconds(now_ns));
        at(&self.drive) == at(&other.drive) && self.drive.end_angle == other.drive.end_angle
    }

    /// Returns whether drive and body rest from a time on.
    #[inline]
    pub(crate) fn rests(&self, from_ns: u64) -> bool {
        self.drive.seconds(from_ns) >= self.drive.end_s
    }
}
