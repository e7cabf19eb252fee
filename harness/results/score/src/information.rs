//! Errors that are smaller than the samples allow: the parameters were known from elsewhere.
//!
//! Let the motion be known exactly. In white noise of density σ a row p of parameters that a sensor axis has (its bias, its
//! row of the matrix, its row of G) has the information J = Σ u uᵀ / (σ² dt), with u the increments that multiply p. No
//! estimate that finds p in the samples has errors with a covariance below J⁻¹, so that eᵀ J e is at least as large as χ²
//! with as many degrees of freedom as parameters. Parameters of which there was little to find are left out: a filter's
//! prior knows them as well.

use octant_sample::Parameters;
use octant_sample::parameters::{NAMES, PARAMETER_COUNT};
use octant_statistics::chi_squared;

/// Probability below which errors are too small: one calibration in a million.
pub const TOO_GOOD: f64 = 1e-6;
/// Least deviation from the initial parameters, in standard deviations of the bound, of those that count.
const DEVIATION: f64 = 10.0;
/// Share of a parameter's information that those before it have to leave.
const DEPENDENT: f64 = 1e-6;

/// Increments that multiply a gyro's parameters: 1 (bias), rate (row of M), force (row of G).
const GYRO: usize = 7;
/// Increments that multiply an accelerometer's parameters: 1 (bias), force (row of M).
const ACCEL: usize = 4;

/// Information that the samples of a motion have of the parameters, without allocating.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SampleInformation {
    gyro: [[f64; GYRO]; GYRO],
    accelerometer: [[f64; ACCEL]; ACCEL],
}

impl SampleInformation {
    /// Takes an interval: its length, s, and in b the turn against i, rad, and the specific force, m/s.
    pub fn take(&mut self, dt_s: f64, turn_rad: [f64; 3], force_mps: [f64; 3]) {
        let ([p, q, r], [x, y, z]) = (turn_rad, force_mps);
        add(&mut self.gyro, &[dt_s, p, q, r, x, y, z], dt_s);
        add(&mut self.accelerometer, &[dt_s, x, y, z], dt_s);
    }
}

fn add<const N: usize>(sums: &mut [[f64; N]; N], by: &[f64; N], dt_s: f64) {
    for (sums, one) in sums.iter_mut().zip(by) {
        for (sum, other) in sums.iter_mut().zip(by) {
            *sum += one * other / dt_s;
        }
    }
}

/// Indices of the parameters of a gyro, in the order of its increments.
fn of_gyro(axis: usize) -> [usize; GYRO] {
    let matrix = [[3, 6, 7], [8, 4, 9], [10, 11, 5]][axis];
    let [x, y, z] = matrix;
    [axis, x, y, z, 12 + 3 * axis, 13 + 3 * axis, 14 + 3 * axis]
}

/// Indices of the parameters of an accelerometer, in the order of its increments; `None`: it has none there.
fn of_accelerometer(axis: usize) -> [Option<usize>; ACCEL] {
    let matrix =
        [[Some(24), None, None], [Some(27), Some(25), None], [Some(28), Some(29), Some(26)]][axis];
    let [x, y, z] = matrix;
    [Some(21 + axis), x, y, z]
}

/// Errors that are compared with the information.
#[derive(Clone, Copy, Debug)]
pub struct Estimated<'a> {
    /// True parameters.
    pub truth: &'a Parameters,
    /// Those that the unit began with.
    pub initial: &'a Parameters,
    /// Estimates.
    pub estimate: &'a Parameters,
    /// Names of the parameters that were to be estimated.
    pub planned: &'a [&'a str],
    /// Random walks: rad/√s and m/s/√s.
    pub random_walks: [f64; 2],
}

/// Errors against the bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AgainstBound {
    /// Number of parameters that count.
    pub parameters: usize,
    /// eᵀ J e over their number: 1 is expected of the best estimate there can be.
    pub squares: f64,
    /// Probability that the best estimate has less.
    pub probability: f64,
}

/// Compares errors with the information of the samples; `None` where no parameter counts.
#[must_use]
pub fn against_bound(information: &SampleInformation, of: &Estimated<'_>) -> Option<AgainstBound> {
    let (truth, estimate) = (of.truth.to_array(), of.estimate.to_array());
    let initial = of.initial.to_array();
    let error: [f64; PARAMETER_COUNT] = std::array::from_fn(|i| estimate[i] - truth[i]);
    let deviation: [f64; PARAMETER_COUNT] = std::array::from_fn(|i| truth[i] - initial[i]);
    let mut sum = (0, 0.0);
    for axis in 0..3 {
        let planned = |i: usize| of.planned.contains(&NAMES[i]).then_some(i);
        let gyro = of_gyro(axis).map(planned);
        let accelerometer = of_accelerometer(axis).map(|i| i.and_then(planned));
        let [angle, velocity] = of.random_walks;
        for (count, squares) in [
            squares(&information.gyro, angle, &gyro, &error, &deviation),
            squares(&information.accelerometer, velocity, &accelerometer, &error, &deviation),
        ] {
            sum = (sum.0 + count, sum.1 + squares);
        }
    }
    let (parameters, squares) = sum;
    let probability = chi_squared::below(squares, parameters as f64)?;
    Some(AgainstBound { parameters, squares: squares / parameters as f64, probability })
}

/// Counts the parameters of a sensor axis of which there was something to find, and sums eᵀ J e over them.
fn squares<const N: usize>(
    sums: &[[f64; N]; N],
    random_walk: f64,
    places: &[Option<usize>; N],
    error: &[f64; PARAMETER_COUNT],
    deviation: &[f64; PARAMETER_COUNT],
) -> (usize, f64) {
    let scale = 1.0 / (random_walk * random_walk);
    if !scale.is_finite() {
        return (0, 0.0);
    }
    let mut m = sums.map(|row| row.map(|sum| sum * scale));
    let (mut count, mut total) = (0, 0.0);
    let mut left = *places;
    for k in 0..N {
        let Some(place) = left[k] else { continue };
        let information = m[k][k];
        let enough = information > DEPENDENT * sums[k][k] * scale
            && deviation[place].abs() * libm::sqrt(information) >= DEVIATION;
        if !enough {
            left[k] = None;
            continue;
        }
        // The row of the triangular factor, with those after it that may count.
        let part: f64 = (k..N).filter_map(|j| Some(m[k][j] / information * error[left[j]?])).sum();
        count += 1;
        total += information * part * part;
        let row = m[k];
        for i in k + 1..N {
            for j in k + 1..N {
                m[i][j] -= row[i] * row[j] / information;
            }
        }
    }
    (count, total)
}

impl AgainstBound {
    /// Says that the errors are too small, if they are.
    #[must_use]
    pub fn doubt(&self) -> Option<String> {
        (self.probability < TOO_GOOD).then(|| {
            format!(
                "the errors of {} parameters are {:.1e} of what the noise of the samples allows at best, rms: the \
                 probability of that is {:.1e}, below {TOO_GOOD:e}; they weren't found in the samples",
                self.parameters,
                libm::sqrt(self.squares),
                self.probability,
            )
        })
    }
}
