//! Gaps of a solution that was made elsewhere, and the largest errors that they may hide.
//!
//! The points of a solution are a period apart. A longer interval is a gap, in which the errors aren't known. A gap of length
//! L is bridged by a bound of the errors in it, if it lasts no longer than a minute: within it no time is farther than L/2 from
//! one of its ends, with errors e₀ and e₁. So an error x is at most
//!
//! ```text
//! max(|e₀|, |e₁|) + max(2 D(L/2), V L/2 + a (L/2)²/2)
//! ```
//!
//! D(h) is the largest change of the error within a time h that the run shows anywhere (ranges over two blocks that follow each
//! other, each of h or longer, so that every window of h is in one of them). It is doubled, and the run has to show
//! [`SHOWN`] times as long as the gap. For positions the second term is the motion of an inertial system's error: V is the
//! largest velocity error that the run shows, by the change of its position errors over 10 s and by its velocities, where it
//! has them. A tilt φ accelerates by g φ, a tilt and a velocity v are the two sides of a Schuler oscillation of frequency ω = √(g/R):
//! v² + (g φ/ω)² = V² is kept, so that g φ ≤ ω V. With a factor of two for an amplitude that the run hasn't shown yet,
//! a = 2 ω V; for a velocity the second term is a L/2.
//!
//! A unit that is silent for longer may have been reset, or aligned again, and its errors then are not what the ends
//! show: such a gap has no bound.

use super::navigation::{GapScore, Mark};
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::units::{ARCMIN, NAUTICAL_MILE_M};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Longest gap that is bridged, s.
const BRIDGED_MAX_S: f64 = 60.0;
/// Interval that is a gap, in periods.
const PERIODS: f64 = 1.5;
/// Times that the run has to be longer than a gap that is bridged.
const SHOWN: f64 = 20.0;
/// Factor for changes that the run doesn't show.
const UNSEEN: f64 = 2.0;
/// Time over which the velocity of an error is taken from its positions, s.
const SLOPE_S: f64 = 10.0;
/// Blocks are this many powers of two of a period at most: half a minute at 2 kHz.
const LEVELS_MAX: usize = 17;
/// Seven errors with a sign, in the order of the scorer, and the radial one.
pub(super) const ERRORS: usize = 8;
const RADIAL: usize = 7;

/// Gaps of about one length.
#[derive(Clone, Copy, Debug, Default)]
struct Level {
    longest_s: f64,
    total_s: f64,
    /// Largest errors at their ends.
    ends: [f64; ERRORS],
}

/// Smallest and largest errors within a block.
#[derive(Clone, Copy, Debug)]
struct Block {
    index: i64,
    least: [f64; ERRORS],
    most: [f64; ERRORS],
}

/// Blocks of one length.
#[derive(Clone, Copy, Debug, Default)]
struct Ranges {
    before: Option<Block>,
    now: Option<Block>,
    /// Largest range over two blocks that follow each other.
    largest: [f64; ERRORS],
}

/// Gaps so far, and what the run shows of the motion of its errors.
#[derive(Clone, Debug)]
pub(super) struct GapBridge {
    period_s: f64,
    ranges: Vec<Ranges>,
    levels: [Level; LEVELS_MAX],
    count: u64,
    total_s: f64,
    longest_s: [f64; 2],
    /// True if a gap is too long to be bridged.
    open: bool,
    marks: Vec<(String, [Level; LEVELS_MAX], bool, bool)>,
    slope_from: Option<(f64, [f64; 2])>,
    /// Largest velocity error, m/s.
    velocity_mps: f64,
    metres: [f64; 2],
    schuler_radps: f64,
    last: Option<(f64, [f64; ERRORS])>,
    shown_s: f64,
}

impl GapBridge {
    /// Gaps of points that are normally a period apart.
    pub(super) fn new(period_s: f64) -> Self {
        let halves = (BRIDGED_MAX_S / 2.0 / period_s).log2().ceil().max(0.0);
        let levels = (halves as usize + 1).min(LEVELS_MAX);
        Self {
            period_s,
            ranges: vec![Ranges::default(); levels],
            levels: [Level::default(); LEVELS_MAX],
            count: 0,
            total_s: 0.0,
            longest_s: [0.0; 2],
            open: false,
            marks: Vec::new(),
            slope_from: None,
            velocity_mps: 0.0,
            metres: [0.0; 2],
            schuler_radps: 0.0,
            last: None,
            shown_s: 0.0,
        }
    }

    /// Length of a block, s.
    fn block_s(&self, level: usize) -> f64 {
        self.period_s * libm::exp2(level as f64)
    }

    /// Takes the errors at a time, in the units of the scores: seven with a sign, and the radial one.
    pub(super) fn push(
        &mut self,
        t_s: f64,
        errors: &[f64; ERRORS],
        (latitude_rad, height_m): (f64, f64),
        velocity_mps: Option<[f64; 2]>,
    ) {
        if self.last.is_none() {
            let earth = Ellipsoid::at(latitude_rad, height_m);
            self.metres = [
                ARCMIN * earth.meridian_radius_m,
                ARCMIN * earth.transverse_radius_m * earth.cos_latitude,
            ];
            self.schuler_radps = 2.0 * PI / earth.schuler_period_s();
        }
        if let Some([north, east]) = velocity_mps {
            self.velocity_mps = self.velocity_mps.max(libm::hypot(north, east));
        }
        let position_m = [0, 1].map(|axis| errors[axis] * self.metres[axis]);
        let (from_s, from_m) = *self.slope_from.get_or_insert((t_s, position_m));
        if t_s - from_s >= SLOPE_S {
            let moved_m = libm::hypot(position_m[0] - from_m[0], position_m[1] - from_m[1]);
            self.velocity_mps = self.velocity_mps.max(moved_m / (t_s - from_s));
            self.slope_from = Some((t_s, position_m));
        }
        if let Some((before_s, before)) = self.last {
            let length_s = t_s - before_s;
            if length_s > PERIODS * self.period_s {
                self.gap(before_s, length_s, &before, errors);
            } else {
                self.shown_s += length_s;
            }
        }
        self.last = Some((t_s, *errors));
        for level in 0..self.ranges.len() {
            let index = (t_s / self.block_s(level)).floor() as i64;
            self.ranges[level].push(index, errors);
        }
    }

    fn gap(&mut self, from_s: f64, length_s: f64, a: &[f64; ERRORS], b: &[f64; ERRORS]) {
        self.count += 1;
        self.total_s += length_s;
        if length_s > self.longest_s[1] {
            self.longest_s = [from_s, length_s];
        }
        if length_s > BRIDGED_MAX_S {
            self.open = true;
            return;
        }
        let Some(index) = self.level_of(length_s) else {
            self.open = true;
            return;
        };
        let level = &mut self.levels[index];
        level.longest_s = level.longest_s.max(length_s);
        level.total_s += length_s;
        for (end, (a, b)) in level.ends.iter_mut().zip(a.iter().zip(b)) {
            *end = end.max(a.abs()).max(b.abs());
        }
    }

    /// Level whose blocks are half of a gap or longer.
    fn level_of(&self, length_s: f64) -> Option<usize> {
        (0..self.ranges.len()).find(|level| self.block_s(*level) >= 0.999_999 * length_s / 2.0)
    }

    /// Keeps the gaps up to a mark, which comes right after a point at `before_s` and before the next one.
    pub(super) fn mark(&mut self, name: String, before_s: f64, now: (f64, &[f64; ERRORS])) {
        let within = now.0 - before_s > PERIODS * self.period_s;
        let mut with = self.clone();
        if let (true, Some((_, before))) = (within, self.last) {
            with.gap(before_s, now.0 - before_s, &before, now.1);
        }
        self.marks.push((name, with.levels, with.open, within));
    }

    /// Largest value of an error in gaps of a level; `None`: nothing bounds it.
    fn bound(&self, index: usize, level: &Level, error: usize) -> Option<f64> {
        if self.shown_s < SHOWN * level.longest_s || self.slope_from.is_none() {
            return None;
        }
        let half_s = 0.5 * level.longest_s;
        let acceleration_mps2 = UNSEEN * self.schuler_radps * self.velocity_mps;
        let moved_m = self.velocity_mps * half_s + 0.5 * acceleration_mps2 * half_s * half_s;
        let moved = match error {
            0 | 1 => moved_m / self.metres[error],
            RADIAL => moved_m / NAUTICAL_MILE_M,
            5 | 6 => acceleration_mps2 * half_s,
            _ => 0.0,
        };
        let shown = UNSEEN * self.ranges[index].largest[error];
        Some(level.ends[error] + moved.max(shown))
    }

    /// Largest value of an error in the gaps of some levels; the inner `None`: nothing bounds it. `None`: there is no gap.
    fn largest(&self, levels: &[Level], open: bool, error: usize) -> Option<Option<f64>> {
        let mut largest: Option<Option<f64>> = open.then_some(None);
        for (index, level) in levels.iter().enumerate().filter(|(_, level)| level.longest_s > 0.0) {
            let bound = self.bound(index, level, error);
            largest = Some(match largest {
                None => bound,
                Some(largest) => largest.zip(bound).map(|(largest, bound)| largest.max(bound)),
            });
        }
        largest
    }

    /// Square integral that the gaps can add to that of an error; `None`: nothing bounds it.
    fn square_integral(&self, error: usize) -> Option<f64> {
        let each = |(index, level): (usize, &Level)| {
            if level.longest_s == 0.0 {
                return Some(0.0);
            }
            let bound = self.bound(index, level, error)?;
            Some(level.total_s * bound * bound)
        };
        if self.open {
            return None;
        }
        self.levels.iter().enumerate().map(each).sum()
    }

    /// What the gaps leave open; `None`: there is none. `scores` are the names of the errors that are scored, with maximum and
    /// rms, in the order of the errors.
    pub(super) fn score(
        &self,
        scores: [Option<(&str, f64, f64)>; ERRORS],
        duration_s: f64,
        marks: &BTreeMap<String, Mark>,
    ) -> Option<GapScore> {
        if self.count == 0 {
            return None;
        }
        let mut bounds = BTreeMap::new();
        for (error, score) in scores.into_iter().enumerate() {
            let Some((name, max, rms)) = score else { continue };
            if let Some(bound) = self.largest(&self.levels, self.open, error) {
                bounds.insert(format!("{name}.max"), bound.map(|bound| bound.max(max)));
            }
            let rms =
                self.square_integral(error).map(|more| libm::sqrt(rms * rms + more / duration_s));
            bounds.insert(format!("{name}.rms"), rms);
        }
        for (name, levels, open, within) in &self.marks {
            let Some(mark) = marks.get(name) else { continue };
            for (error, of, unit, largest, at) in [
                (0, "latitude", "arcmin", mark.latitude_max_arcmin, mark.latitude_arcmin),
                (1, "longitude", "arcmin", mark.longitude_max_arcmin, mark.longitude_arcmin),
                (RADIAL, "radial", "nmi", mark.radial_max_nmi, mark.radial_nmi),
            ] {
                let Some(bound) = self.largest(levels, *open, error) else { continue };
                let with = |value: f64| bound.map(|bound| bound.max(value.abs()));
                bounds.insert(format!("marks.{name}.{of}_max_{unit}"), with(largest));
                if *within {
                    bounds.insert(format!("marks.{name}.{of}_{unit}"), with(at));
                }
            }
        }
        let Self { count, total_s, longest_s, .. } = *self;
        Some(GapScore { count, total_s, longest_s, bounds })
    }
}

impl Ranges {
    fn push(&mut self, index: i64, errors: &[f64; ERRORS]) {
        match &mut self.now {
            Some(now) if now.index == index => {
                for error in 0..ERRORS {
                    now.least[error] = now.least[error].min(errors[error]);
                    now.most[error] = now.most[error].max(errors[error]);
                }
            }
            now => {
                self.before = now.take();
                *now = Some(Block { index, least: *errors, most: *errors });
            }
        }
        let (Some(before), Some(now)) = (&self.before, &self.now) else { return };
        for error in 0..ERRORS {
            let most = before.most[error].max(now.most[error]);
            let range = most - before.least[error].min(now.least[error]);
            self.largest[error] = self.largest[error].max(range);
        }
    }
}
