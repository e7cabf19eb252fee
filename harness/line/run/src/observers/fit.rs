//! Checks that successive answers of a free navigation fit each other: position and height against the
//! velocity, velocity against the accelerometers, attitude against the gyros.
//!
//! A solution that is computed from samples moves as they say, within the errors of an uncalibrated
//! instrument and the resolution of the answers. A part that stays the same is compared when it
//! changes, over all of the time that it stayed. What doesn't fit proves nothing against the unit; it
//! shows that answers don't come from one navigation. Closed-loop corrections move a solution as well:
//! where one is at work, such steps are counted.

use octant_earth::ellipsoid::SEMI_MAJOR_AXIS_M;
use octant_endpoint::Tells;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{Navigation, Sample, Status};

/// Changes from one answer to the next that need no look at velocity and samples: rad, m, m/s, rad.
const NEAR_RAD: f64 = 1e-7;
const NEAR_M: f64 = 0.5;
const NEAR_MPS: f64 = 0.05;
const NEAR_TURN_RAD: f64 = 2e-3;
/// Misfit that is allowed at any time, in metres.
const SLACK_M: f64 = 1.0;
/// Error of an instrument that isn't calibrated: part of what it measures, rad/s, m/s².
const SCALE: f64 = 0.05;
const GYRO_RADPS: f64 = 0.02;
const ACCELEROMETER_MPS2: f64 = 0.5;
/// Acceleration in a second that needs no look at samples, m/s².
const MANOEUVRE_MPS2: f64 = 20.0;
const GRAVITY_MPS2: f64 = 9.8;
/// Steps of the resolution that two rounded answers may be apart.
const ROUNDED: f64 = 4.0;
/// Coarsest resolution that is taken for one, of each part: m, m, m/s, rad.
const COARSEST: [f64; 4] = [200.0, 10.0, 1.0, 0.02];
/// Number of the first changes from which the resolution is taken.
const FIRST: u32 = 16;

/// Parts of a solution.
const POSITION: usize = 0;
const HEIGHT: usize = 1;
const VELOCITY: usize = 2;
const ATTITUDE: usize = 3;
/// Names of the parts, what each is compared with, and its unit.
const PARTS: [(&str, &str, &str); 4] = [
    ("position", "its velocity", "m"),
    ("height", "its velocity", "m"),
    ("velocity", "the accelerometers", "m/s"),
    ("attitude", "the gyros", "rad"),
];

/// Misfits of one part.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Misfits {
    count: u64,
    /// Time of the first one, ns, with its size and the size that fits.
    first: (u64, f64, f64),
    /// The largest one.
    largest: f64,
}

/// Last change of one part, and the motion since.
#[derive(Clone, Copy, Debug, Default)]
struct Since {
    ns: u64,
    velocity_mps: [f64; 3],
    /// Sum of the turns in the gyros' samples, rad, and bound of the changes of velocity in the
    /// accelerometers' samples, m/s.
    turn_rad: f64,
    push_mps: f64,
    /// Path by the velocities that were told since, m; `blind`: one of them was told twice.
    path_m: f64,
    blind: bool,
}

/// Answers of one run, compared with the answer before.
#[derive(Clone, Debug)]
pub(super) struct AnswerFit {
    told: [bool; 4],
    since: [Since; 4],
    /// True if a part was the same in the last two answers.
    holding: bool,
    /// Time between the last two answers, ns.
    period_ns: u64,
    /// Smallest change seen of each part.
    resolution: [f64; 4],
    changes: u32,
    /// True if the next answer is compared in full, whatever its change.
    look: bool,
    /// Solution of about a second ago, and its time, ns.
    second: Option<(u64, Navigation)>,
    misfits: [Misfits; 4],
    /// Steps where a correction was at work.
    pub(super) steps: u64,
}

impl AnswerFit {
    /// Creates the checks of a unit that reports these quantities; `None`: nothing is checked.
    pub(super) fn new(tells: Option<Tells>) -> Self {
        let told = tells.filter(|tells| tells.follows).map_or([false; 4], |tells| {
            let of_velocity = tells.position && tells.velocity;
            [of_velocity, of_velocity, tells.velocity, tells.attitude]
        });
        Self {
            told,
            since: [Since::default(); 4],
            holding: false,
            period_ns: 0,
            resolution: [f64::INFINITY; 4],
            changes: 0,
            look: true,
            second: None,
            misfits: [Misfits::default(); 4],
            steps: 0,
        }
    }

    /// Begins anew: the next answer has none before it.
    pub(super) fn begin(&mut self) {
        self.holding = false;
        self.period_ns = 0;
        self.second = None;
        self.look = true;
    }

    /// Compares an answer with the one before; `moves` says that no part is the same in both, `free` that
    /// no correction is at work. Times are those of the samples, ns.
    #[inline(always)]
    pub(super) fn take(
        &mut self,
        (before_ns, before): (u64, &Navigation),
        (now_ns, now): (u64, &Navigation),
        sample: &Sample,
        moves: bool,
        free: bool,
    ) {
        let (before_parts, now_parts) = (parts(before), parts(now));
        let mut far = [0.0; 2];
        for i in 0..SOLUTION {
            let step = (now_parts[i] - before_parts[i]) * PER_NEAR[i];
            far[i % 2] += step * step;
        }
        // Outside of ±n the sum wraps or exceeds 2n.
        let felt = sample
            .delta_theta
            .map(|count| u32::from((count as u32).wrapping_add(NEAR_COUNTS) > 2 * NEAR_COUNTS));
        let stays = now_ns.wrapping_sub(before_ns) == self.period_ns && moves && !self.look;
        if far[0] + far[1] > 1.0 || felt[0] | felt[1] | felt[2] != 0 || !stays {
            self.compare((before_ns, before), (now_ns, now), sample, free);
            self.look = self.holding || self.changes < FIRST;
        }
    }

    /// Compares an answer in full.
    #[inline(never)]
    fn compare(
        &mut self,
        (before_ns, before): (u64, &Navigation),
        (now_ns, now): (u64, &Navigation),
        sample: &Sample,
        free: bool,
    ) {
        let period_ns = now_ns.saturating_sub(before_ns);
        let regular = self.period_ns == 0 || period_ns.abs_diff(self.period_ns) < period_ns / 2;
        if !regular || sample.status.contains(Status::INERTIAL_INVALID) {
            // The samples in between aren't known.
            self.begin();
            self.period_ns = period_ns;
            return;
        }
        self.period_ns = period_ns;
        let period_s = period_ns as f64 * 1e-9;
        let turn_rad = length(sample.delta_theta.map(f64::from)) * DELTA_THETA_LSB_RAD;
        let felt_mps = sample.delta_velocity.map(|count| f64::from(count) * DELTA_VELOCITY_LSB_MPS);
        let push_mps = push(length(felt_mps), period_s);
        let changed = [
            now.latitude_rad != before.latitude_rad || now.longitude_rad != before.longitude_rad,
            now.height_m != before.height_m,
            now.velocity_mps != before.velocity_mps,
            now.q_nb != before.q_nb,
        ];
        let held = self.holding;
        self.holding = false;
        for part in 0..PARTS.len() {
            if !self.told[part] {
                continue;
            }
            let mut since = self.since[part];
            if !held {
                let velocity_mps = before.velocity_mps;
                since = Since { ns: before_ns, velocity_mps, ..Since::default() };
            }
            since.turn_rad += turn_rad;
            since.push_mps += push_mps;
            since.path_m += length(now.velocity_mps) * period_s;
            since.blind |= !changed[VELOCITY];
            if !changed[part] {
                self.since[part] = since;
                // A height that is held never changes.
                self.holding |= part != HEIGHT;
                continue;
            }
            let long = now_ns.saturating_sub(since.ns) > period_ns;
            let felt = (!long && self.told[ATTITUDE]).then_some(felt_mps);
            let (step, misfit, fits) = match part {
                POSITION | HEIGHT => moved(part, before, now, &since, now_ns, long),
                VELOCITY => sped(before, now, &since, felt, period_s),
                _ => turned(before, now, &since, now_ns, long),
            };
            self.judge(part, now_ns, (step, misfit, fits), free);
            let velocity_mps = now.velocity_mps;
            self.since[part] = Since { ns: now_ns, velocity_mps, ..Since::default() };
        }
        if self.holding {
            self.second = None;
        }
        self.changes += 1;
    }

    /// Compares a solution with that of about a second ago.
    #[inline(never)]
    pub(super) fn second(&mut self, now_ns: u64, now: &Navigation, free: bool) {
        if let Some((then_ns, then)) = self.second
            && now_ns > then_ns
            && !self.holding
        {
            let seconds = (now_ns - then_ns) as f64 * 1e-9;
            let velocity_mps = then.velocity_mps;
            let push_mps = 0.5 * MANOEUVRE_MPS2 * seconds;
            let since = Since { ns: then_ns, velocity_mps, push_mps, ..Since::default() };
            for part in [POSITION, HEIGHT] {
                if self.told[part] && (part == POSITION || then.height_m != now.height_m) {
                    let (_, misfit, fits) = moved(part, &then, now, &since, now_ns, false);
                    self.judge(part, now_ns, (f64::INFINITY, misfit, fits), free);
                }
            }
        }
        self.second = Some((now_ns, *now));
        // Some changes a second show how fine the answers are.
        self.changes = self.changes.min(FIRST - 1);
        self.look = true;
    }

    /// Judges one part: the size of its change, of its misfit, and of the misfit that fits.
    fn judge(
        &mut self,
        part: usize,
        now_ns: u64,
        (step, misfit, fits): (f64, f64, f64),
        free: bool,
    ) {
        if step > 0.0 {
            self.resolution[part] = self.resolution[part].min(step);
        }
        let fits = fits + ROUNDED * self.resolution[part].min(COARSEST[part]);
        if misfit <= fits || misfit.is_nan() {
            return;
        }
        // The solution of a second ago lies before the step.
        self.second = None;
        if !free {
            self.steps += 1;
            return;
        }
        let misfits = &mut self.misfits[part];
        if misfits.count == 0 {
            misfits.first = (now_ns, misfit, fits);
        }
        misfits.count += 1;
        misfits.largest = misfits.largest.max(misfit);
    }

    /// Describes the parts that don't fit, in plain words.
    pub(super) fn reasons(&self) -> Vec<String> {
        let told = PARTS.into_iter().zip(&self.misfits).filter(|(_, misfits)| misfits.count > 0);
        told.map(|((part, with, unit), misfits)| {
            let (first_ns, size, fits) = misfits.first;
            let Misfits { count, largest, .. } = misfits;
            let answers = if *count == 1 { "1 answer" } else { &format!("{count} answers") };
            format!(
                "the {part} of the navigation doesn't fit {with}: {answers}, the first one at {:.3} s \
                 off by {size:.3} {unit}, {fits:.3} {unit} would fit; the largest {largest:.3} {unit}",
                first_ns as f64 * 1e-9
            )
        })
        .collect()
    }
}

/// Numbers of a solution.
const SOLUTION: usize = 10;
/// Reciprocals of the changes that need no look. A turn by δ moves a unit quaternion by δ/2.
const PER_NEAR: [f64; SOLUTION] = {
    let (turn, speed) = (2.0 / NEAR_TURN_RAD, 1.0 / NEAR_MPS);
    let angle = 1.0 / NEAR_RAD;
    [angle, angle, 1.0 / NEAR_M, speed, speed, speed, turn, turn, turn, turn]
};

/// Lists the numbers of a solution.
#[inline(always)]
fn parts(of: &Navigation) -> [f64; SOLUTION] {
    let Navigation { latitude_rad, longitude_rad, height_m, velocity_mps: v, q_nb: q } = *of;
    [latitude_rad, longitude_rad, height_m, v[0], v[1], v[2], q[0], q[1], q[2], q[3]]
}

/// Count of a gyro from which a turn is looked at.
const NEAR_COUNTS: u32 = (NEAR_TURN_RAD / DELTA_THETA_LSB_RAD) as u32;

fn length([x, y, z]: [f64; 3]) -> f64 {
    libm::sqrt(x * x + y * y + z * z)
}

/// Returns the bound of the change of velocity that the specific force of a sample allows, m/s: gravity
/// is upright, and the rest is motion.
fn push(felt_mps: f64, period_s: f64) -> f64 {
    let rest_mps = GRAVITY_MPS2 * period_s;
    let level_mps = libm::sqrt((felt_mps * felt_mps - rest_mps * rest_mps).max(0.0));
    ACCELEROMETER_MPS2 * period_s + (1.0 + SCALE) * level_mps + (felt_mps - rest_mps).abs()
}

/// Difference of two longitudes within half a turn, rad.
fn within_half_turn(difference_rad: f64) -> f64 {
    libm::remainder(difference_rad, 2.0 * core::f64::consts::PI)
}

/// Compares the change of position or height with the velocity: step, misfit and what fits, m.
fn moved(
    part: usize,
    before: &Navigation,
    now: &Navigation,
    since: &Since,
    now_ns: u64,
    long: bool,
) -> (f64, f64, f64) {
    let seconds = now_ns.saturating_sub(since.ns) as f64 * 1e-9;
    // Over several velocities the path is the longest way.
    let by_path = |step: f64| {
        let fits = SLACK_M + SCALE * since.path_m;
        (long && !since.blind).then_some((step, step - since.path_m, fits))
    };
    let mean: [f64; 3] =
        core::array::from_fn(|i| 0.5 * (since.velocity_mps[i] + now.velocity_mps[i]));
    let change: [f64; 3] = core::array::from_fn(|i| now.velocity_mps[i] - since.velocity_mps[i]);
    let bent_m = 0.5 * seconds * (length(change) + since.push_mps);
    let fits = SLACK_M + bent_m + 0.01 * seconds * length(mean);
    if part == HEIGHT {
        let step = now.height_m - before.height_m;
        let by_mean = (step.abs(), (step + mean[2] * seconds).abs(), fits);
        return by_path(step.abs()).unwrap_or(by_mean);
    }
    let radius_m = SEMI_MAJOR_AXIS_M + now.height_m;
    let north_m = (now.latitude_rad - before.latitude_rad) * radius_m;
    let cos = libm::cos(now.latitude_rad);
    let mut east_m = within_half_turn(now.longitude_rad - before.longitude_rad) * radius_m * cos;
    if cos < 0.02 {
        // Close to a pole the longitude says little.
        east_m = mean[1] * seconds;
    }
    let misfit = libm::hypot(north_m - mean[0] * seconds, east_m - mean[1] * seconds);
    let step = libm::hypot(north_m, east_m);
    by_path(step).unwrap_or((step, misfit, fits))
}

/// Compares the change of velocity with the accelerometers, m/s: the vector over one sample, where the
/// attitude is told, the bound over several.
fn sped(
    before: &Navigation,
    now: &Navigation,
    since: &Since,
    felt_mps: Option<[f64; 3]>,
    period_s: f64,
) -> (f64, f64, f64) {
    let change: [f64; 3] = core::array::from_fn(|i| now.velocity_mps[i] - before.velocity_mps[i]);
    let step = length(change);
    let Some(felt) = felt_mps else { return (step, step, NEAR_MPS + since.push_mps) };
    let [x, y, z] = in_n(now.q_nb, felt);
    let expected = [x, y, z + GRAVITY_MPS2 * period_s];
    let misfit = length(core::array::from_fn(|i| change[i] - expected[i]));
    let fits = NEAR_MPS + ACCELEROMETER_MPS2 * period_s + SCALE * length(felt);
    // A vertical channel that is held or damped doesn't follow the accelerometers.
    let level = libm::hypot(change[0] - expected[0], change[1] - expected[1]);
    (step, level.min(misfit), fits)
}

/// Takes a vector of b into n.
fn in_n([w, x, y, z]: [f64; 4], [a, b, c]: [f64; 3]) -> [f64; 3] {
    let t = [2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)];
    [
        a + w * t[0] + (y * t[2] - z * t[1]),
        b + w * t[1] + (z * t[0] - x * t[2]),
        c + w * t[2] + (x * t[1] - y * t[0]),
    ]
}

/// Compares the change of attitude with the gyros, rad. Over several samples it may be any turn up to
/// the sum.
fn turned(
    before: &Navigation,
    now: &Navigation,
    since: &Since,
    now_ns: u64,
    long: bool,
) -> (f64, f64, f64) {
    let ([aw, ax, ay, az], [bw, bx, by, bz]) = (before.q_nb, now.q_nb);
    let w = aw * bw + ax * bx + ay * by + az * bz;
    let aside = [
        aw * bx - ax * bw - ay * bz + az * by,
        aw * by + ax * bz - ay * bw - az * bx,
        aw * bz - ax * by + ay * bx - az * bw,
    ];
    let angle = 2.0 * libm::atan2(length(aside), w.abs());
    let seconds = now_ns.saturating_sub(since.ns) as f64 * 1e-9;
    let misfit = if long { angle - since.turn_rad } else { (angle - since.turn_rad).abs() };
    let fits = NEAR_TURN_RAD + GYRO_RADPS * seconds + SCALE * since.turn_rad;
    (angle, misfit.max(0.0), fits)
}
