//! One gimbal: a drive that follows set points with a trapezoidal rate, and a body behind a gear
//! with play.

/// A piece of a profile with constant acceleration.
#[derive(Clone, Copy, Debug, Default)]
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

    /// Nothing moves.
    #[inline(always)]
    pub(crate) fn rests(&self) -> bool {
        self.origin.rate == 0.0 && self.origin.acceleration == 0.0
    }
}

/// Pieces that a drive profile can have: brake, accelerate, cruise, decelerate. The play of the
/// gear can cut each in two.
const SEGMENTS_MAX: usize = 8;

/// Angle over time as pieces of parabolas, at rest from `end_s` on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Profile {
    origin_ns: u64,
    segments: [Segment; SEGMENTS_MAX],
    len: usize,
    end_s: f64,
    end_angle: f64,
}

impl Profile {
    fn rest(origin_ns: u64, angle: f64) -> Self {
        let segments = [Segment::default(); SEGMENTS_MAX];
        Self { origin_ns, segments, len: 0, end_s: 0.0, end_angle: angle }
    }

    /// Appends a piece of a duration that begins where the last one ended.
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

    /// The instants at which the pieces meet, s since the profile's origin, the end included.
    pub(crate) fn knots(&self) -> impl Iterator<Item = f64> + '_ {
        let end = (self.len > 0).then_some(self.end_s);
        self.segments[..self.len].iter().map(|segment| segment.start_s).chain(end)
    }

    /// From the present state to rest at `target`, as fast as the limits allow and without
    /// overshoot; where the target is nearer than the brakes can stop, or behind, brake first.
    fn to(target: f64, now: AxisState, origin_ns: u64, rate: f64, acceleration: f64) -> Self {
        let mut profile = Self::rest(origin_ns, target);
        let (mut angle, mut speed) = (now.angle, now.rate);
        let stop = speed * speed / (2.0 * acceleration);
        let ahead = (target - angle) * if speed < 0.0 { -1.0 } else { 1.0 };
        // A move that is followed to its end comes to its stopping distance exactly; rounding
        // must not make it brake and creep back.
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
        // The last piece is laid backwards from the target, so that it ends there exactly.
        let last = AxisState {
            angle: target - sign * fall,
            rate: sign * peak,
            acceleration: -sign * acceleration,
        };
        profile.push(peak / acceleration, last);
        profile
    }

    /// What a body behind a gear with play ±`half` does when the drive follows this profile: it
    /// stands until the drive has crossed the play, then follows at its edge.
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
            // Pieces never change direction inside: they are cut where the rate is zero.
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
                picked_up = (2.0 * to_edge / (v + root)).clamp(0.0, duration);
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

/// A gimbal with its limits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gimbal {
    rate: f64,
    acceleration: f64,
    half_play: f64,
    target: i32,
    /// The drive, which the encoder reads.
    pub(crate) drive: Profile,
    /// The body, which the sensors feel.
    pub(crate) body: Profile,
}

impl Gimbal {
    /// A gimbal at rest at angle 0, in the middle of its play.
    pub(crate) fn new(rate_radps: f64, acceleration_radps2: f64, backlash_rad: f64) -> Self {
        Self {
            rate: rate_radps,
            acceleration: acceleration_radps2,
            half_play: 0.5 * backlash_rad,
            target: 0,
            drive: Profile::rest(0, 0.0),
            body: Profile::rest(0, 0.0),
        }
    }

    /// The set point in counts, from `now_ns` on. True if it is a new one.
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
        let now = self.drive.at(self.drive.seconds(now_ns));
        let body = self.body.at(self.body.seconds(now_ns)).angle;
        let target_rad = f64::from(target) * octant_sample::counts::GIMBAL_LSB_RAD;
        self.drive = Profile::to(target_rad, now, now_ns, self.rate, self.acceleration);
        self.body = self.drive.behind_play(body, self.half_play);
    }

    /// Drive and body rest from a time on.
    #[inline]
    pub(crate) fn rests(&self, from_ns: u64) -> bool {
        self.drive.seconds(from_ns) >= self.drive.end_s
    }
}
