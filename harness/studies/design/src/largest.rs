//! The largest position error of a navigation, by draws.
//!
//! It is no quadratic form of the errors at the start. So the errors are drawn from their covariance, and
//! the noise of navigation with them, and the largest value of each draw is looked for. The draws are the
//! same for every candidate: their differences have less scatter than their values, and the same candidate
//! always has the same value. The mean square over the same time, whose expectation is known exactly, is the
//! control variate (R. Y. Rubinstein and R. Marcus, *Efficiency of multivariate control variates in Monte
//! Carlo simulation*, Operations Research 33, 1985).

use crate::navigation::{Block, Quadratic, after, round};
use crate::platform::Platform;
use octant_calibration::config::NavigationPlan;
use octant_calibration::covariance::{
    Covariance, CovarianceRow, DR, MOVING, STATE_COUNT, Transition,
};
use octant_earth::units::NAUTICAL_MILE_M;
use octant_observe::covariance::arcmin_m;
use octant_random::normal::Ziggurat;
use octant_random::stream::{Phase, key};
use serde::Serialize;

/// Number of draws.
pub const MEMBERS: usize = 1024;
/// Draws that are carried together.
const LANES: usize = 64;
/// Least time between two points at which errors are looked at, s. The peak of a Schuler oscillation is
/// missed by 0.3 % in the mean, and by 0.8 % at most.
const POINT_S: f64 = 200.0;
/// Hours at which largest errors are told, where navigation lasts longer.
pub const MARKS_H: [f64; 2] = [24.0, 72.0];
/// Seed of the draws.
const SEED: u64 = 1;
/// Latitude, longitude and distance.
const PARTS: usize = 3;

/// A figure from draws.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Sampled {
    /// Value.
    pub value: f64,
    /// Standard error by the number of draws.
    pub error: f64,
}

/// Root mean squares over the draws of the largest errors up to a time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LargestErrors {
    /// Time since the start of navigation, h.
    pub hours: f64,
    /// Latitude, arcmin.
    pub latitude_arcmin: Sampled,
    /// Longitude, arcmin.
    pub longitude_arcmin: Sampled,
    /// Horizontal distance, nmi.
    pub radial_nmi: Sampled,
}

/// A point of time in navigation.
#[derive(Clone, Debug)]
struct Point {
    /// Weights of the errors at the start in the position error, north and east.
    weights: [CovarianceRow; 2],
    /// Variances of the part by noise, m².
    noise_m2: [f64; 2],
    /// That part in each draw, m.
    drawn_m: Vec<[f32; 2]>,
}

/// A time up to which the largest error is told.
#[derive(Clone, Debug)]
struct Span {
    hours: f64,
    /// Points up to it.
    points: usize,
    /// Mean squares over these points, m²: latitude, longitude, distance.
    mean: [Quadratic; PARTS],
}

/// Draws of a navigation.
#[derive(Clone, Debug)]
pub struct LargestDraws {
    points: Vec<Point>,
    spans: Vec<Span>,
    /// Standard normal numbers for the errors at the start, by state and draw.
    normal: Vec<Vec<f64>>,
    /// Units of the three parts, m.
    units_m: [f64; PARTS],
}

/// Largest squares of a draw and where they were, and sums of squares, m².
#[derive(Clone, Copy, Default)]
struct Extremes {
    largest: [f64; PARTS],
    at: [usize; PARTS],
    sum: [f64; PARTS],
}

impl LargestDraws {
    /// Draws the noise of a navigation of `duration_s`.
    #[must_use]
    pub fn new(platform: &Platform, plan: &NavigationPlan, duration_s: f64) -> Self {
        let blocks = round(platform, plan);
        let mut paths = NoisePaths::new(&blocks);
        let (mut weights, mut noise) = start();
        let (mut t, mut last_s) = (0.0, 0.0);
        let (mut points, mut ends): (Vec<Point>, Vec<f64>) = (Vec::new(), Vec::new());
        for (index, block) in blocks.iter().enumerate().cycle() {
            t += block.length_s;
            if t > duration_s + 1e-6 && !points.is_empty() {
                break;
            }
            weights = after(&weights, &block.transition);
            block.come_into(&mut noise);
            paths.advance(index, block);
            let ends_soon = t + POINT_S > duration_s;
            if t - last_s > POINT_S - 1e-6 || ends_soon || points.is_empty() {
                last_s = t;
                points.push(Point {
                    weights: [weights.rows[DR], weights.rows[DR + 1]],
                    noise_m2: [noise.at(DR, DR), noise.at(DR + 1, DR + 1)],
                    drawn_m: paths.positions(),
                });
                ends.push(t);
            }
        }
        let marks = MARKS_H.into_iter().filter(|hours| hours * 3600.0 < duration_s - 1e-6);
        let spans = marks.chain([duration_s / 3600.0]).map(|hours| {
            let within = ends.iter().filter(|end| **end <= hours * 3600.0 + 1e-6).count();
            Span::new(hours, &points[..within.max(1)])
        });
        let [latitude_m, longitude_m] = arcmin_m(&platform.earth);
        Self {
            spans: spans.collect(),
            points,
            normal: normal("design.largest.start", STATE_COUNT, 0),
            units_m: [latitude_m, longitude_m, NAUTICAL_MILE_M],
        }
    }

    /// Returns the largest errors after a start with this covariance: to the marks that are reached, then
    /// over the whole navigation.
    #[must_use]
    pub fn of(&self, covariance: &Covariance) -> Vec<LargestErrors> {
        let extremes = self.extremes(covariance);
        let spans = self.spans.iter().zip(&extremes);
        let told = spans.map(|(span, all)| {
            let part = |part: usize| {
                let largest: Vec<f64> = all.iter().map(|draw| draw.largest[part]).collect();
                let count = span.points as f64;
                let mean: Vec<f64> = all.iter().map(|draw| draw.sum[part] / count).collect();
                let found = controlled(&largest, &mean, span.mean[part].of(covariance));
                let unit_m = self.units_m[part];
                Sampled { value: found.value / unit_m, error: found.error / unit_m }
            };
            LargestErrors {
                hours: span.hours,
                latitude_arcmin: part(0),
                longitude_arcmin: part(1),
                radial_nmi: part(2),
            }
        });
        told.collect()
    }

    /// Returns forms for the search, m²: the mean square of each part at the times at which it is the
    /// largest after a start with this covariance.
    #[must_use]
    pub fn forms(&self, covariance: &Covariance) -> [Quadratic; PARTS] {
        let extremes = self.extremes(covariance);
        let share = 1.0 / MEMBERS as f64;
        let all = extremes.last().map(Vec::as_slice).unwrap_or_default();
        core::array::from_fn(|part| {
            let mut counts = vec![0_u32; self.points.len()];
            all.iter().for_each(|draw| counts[draw.at[part]] += 1);
            let mut form = Quadratic::zero();
            let counted = self.points.iter().zip(counts).filter(|(_, count)| *count > 0);
            for (point, count) in counted {
                for axis in axes(part) {
                    let noise = point.noise_m2[axis];
                    form.add(&point.weights[axis], noise, f64::from(count) * share);
                }
            }
            form
        })
    }

    /// Finds the extremes of each draw, by span.
    fn extremes(&self, covariance: &Covariance) -> Vec<Vec<Extremes>> {
        let factor = factor(covariance.rows(), STATE_COUNT);
        let mut all = vec![Vec::with_capacity(MEMBERS); self.spans.len()];
        for first in (0..MEMBERS).step_by(LANES) {
            let mut errors = [[0.0; LANES]; STATE_COUNT];
            for (i, row) in factor.iter().enumerate() {
                for (j, scale) in row.iter().enumerate().filter(|(_, scale)| **scale != 0.0) {
                    let normal = &self.normal[j][first..first + LANES];
                    add(&mut errors[i], *scale, normal);
                }
            }
            let mut found = [Extremes::default(); LANES];
            let mut from = 0;
            for (span, out) in self.spans.iter().zip(&mut all) {
                for (index, point) in self.points[from..span.points].iter().enumerate() {
                    point.look(from + index, first, &errors, &mut found);
                }
                from = span.points;
                out.extend_from_slice(&found);
            }
        }
        all
    }
}

impl Point {
    fn look(
        &self,
        index: usize,
        first: usize,
        errors: &[[f64; LANES]; STATE_COUNT],
        found: &mut [Extremes; LANES],
    ) {
        let mut at = [[0.0; LANES]; 2];
        for (axis, (at, weights)) in at.iter_mut().zip(&self.weights).enumerate() {
            let drawn = &self.drawn_m[first..first + LANES];
            at.iter_mut().zip(drawn).for_each(|(at, drawn)| *at = f64::from(drawn[axis]));
            for (errors, weight) in errors.iter().zip(weights) {
                add(at, *weight, errors);
            }
        }
        for (lane, found) in found.iter_mut().enumerate() {
            let squares = [at[0][lane] * at[0][lane], at[1][lane] * at[1][lane]];
            let parts = [squares[0], squares[1], squares[0] + squares[1]];
            for (part, square) in parts.into_iter().enumerate() {
                found.sum[part] += square;
                if square > found.largest[part] {
                    (found.largest[part], found.at[part]) = (square, index);
                }
            }
        }
    }
}

impl Span {
    fn new(hours: f64, points: &[Point]) -> Self {
        let share = 1.0 / points.len() as f64;
        let mean = core::array::from_fn(|part| {
            let mut form = Quadratic::zero();
            for point in points {
                for axis in axes(part) {
                    form.add(&point.weights[axis], point.noise_m2[axis], share);
                }
            }
            form
        });
        Self { hours, points: points.len(), mean }
    }
}

/// North and east components of a part.
fn axes(part: usize) -> core::ops::Range<usize> {
    [0..1, 1..2, 0..2][part].clone()
}

fn start() -> (Transition, Covariance) {
    (Transition::identity(), Covariance::from_sigmas(&[0.0; STATE_COUNT]))
}

/// Noise of navigation in each draw.
struct NoisePaths {
    /// Roots of the noise of the parts of a round.
    roots: Vec<Vec<Vec<f64>>>,
    errors: Vec<[f64; MOVING]>,
    done: u64,
}

impl NoisePaths {
    fn new(blocks: &[Block]) -> Self {
        let roots = blocks.iter().map(|block| factor(block.noise.rows(), MOVING)).collect();
        Self { roots, errors: vec![[0.0; MOVING]; MEMBERS], done: 0 }
    }

    fn advance(&mut self, index: usize, block: &Block) {
        let normal = normal("design.largest.noise", MOVING, self.done);
        self.done += 1;
        for (member, errors) in self.errors.iter_mut().enumerate() {
            let before = *errors;
            for (i, (error, row)) in errors.iter_mut().zip(&block.transition.rows).enumerate() {
                let carried: f64 = row.iter().zip(&before).map(|(a, b)| a * b).sum();
                let root = &self.roots[index][i];
                let came: f64 = root.iter().zip(&normal).map(|(a, n)| a * n[member]).sum();
                *error = carried + came;
            }
        }
    }

    fn positions(&self) -> Vec<[f32; 2]> {
        self.errors.iter().map(|errors| [errors[DR] as f32, errors[DR + 1] as f32]).collect()
    }
}

/// Draws `count` standard normal numbers for each draw: block `number` of a stream.
fn normal(stream: &str, count: usize, number: u64) -> Vec<Vec<f64>> {
    let (key, ziggurat) = (key(SEED, stream, Phase::Draw), Ziggurat::shared());
    let threes = count.div_ceil(3);
    let mut all = vec![vec![0.0; MEMBERS]; threes * 3];
    for member in 0..MEMBERS {
        for three in 0..threes {
            let counter = (number * MEMBERS as u64 + member as u64) * threes as u64 + three as u64;
            for (k, value) in ziggurat.three(key, counter).into_iter().enumerate() {
                all[3 * three + k][member] = value;
            }
        }
    }
    all.truncate(count);
    all
}

fn add(to: &mut [f64; LANES], factor: f64, values: &[f64]) {
    for (out, value) in to.iter_mut().zip(values) {
        *out += factor * value;
    }
}

/// Part of a variance below which it counts as zero: what rounding leaves of one.
const PIVOT_MIN: f64 = 1e-13;

/// Returns the lower triangle whose product with its transpose is a positive semidefinite matrix.
fn factor(rows: &[CovarianceRow; STATE_COUNT], size: usize) -> Vec<Vec<f64>> {
    let mut root = vec![vec![0.0; size]; size];
    for j in 0..size {
        let squares: f64 = root[j][..j].iter().map(|value| value * value).sum();
        let pivot = rows[j][j] - squares;
        if !(pivot > PIVOT_MIN * rows[j][j]) {
            continue;
        }
        root[j][j] = libm::sqrt(pivot);
        for i in j + 1..size {
            let products: f64 = root[i][..j].iter().zip(&root[j][..j]).map(|(a, b)| a * b).sum();
            root[i][j] = (rows[i][j] - products) / root[j][j];
        }
    }
    root
}

/// Returns the root of the mean of `values`, by their regression on a control whose expectation is known.
fn controlled(values: &[f64], control: &[f64], expected: f64) -> Sampled {
    let count = values.len() as f64;
    let mean = |of: &[f64]| of.iter().sum::<f64>() / count;
    let (value, at) = (mean(values), mean(control));
    let products = values.iter().zip(control).map(|(v, c)| (v - value) * (c - at));
    let covariance = products.sum::<f64>();
    let spread: f64 = control.iter().map(|c| (c - at) * (c - at)).sum();
    let slope = if spread > 0.0 { covariance / spread } else { 0.0 };
    let square = (value - slope * (at - expected)).max(0.0);
    let residuals =
        values.iter().zip(control).map(|(v, c)| v - value - slope * (c - at)).map(|r| r * r);
    let variance = residuals.sum::<f64>() / (count - 2.0).max(1.0) / count;
    let root = libm::sqrt(square);
    Sampled { value: root, error: if root > 0.0 { 0.5 * libm::sqrt(variance) / root } else { 0.0 } }
}
