//! A dwell as one step: all of its measurements at once.
//!
//! At rest the thirty parameters act through six errors in n alone, constant over the dwell: three of the
//! rates and three of the specific force. With the nine moving states these are fifteen states z whose
//! dynamics are the same in every attitude. A dwell of n measured periods is then a map that depends on n
//! alone, made of
//!
//! - A: the mean of z at the end, given z at the start and all measurements, is A z + a known vector,
//! - N: the covariance of z at the end about it,
//! - J: the information of the measurements about z at the start.
//!
//! Two dwells in a row are (S. Särkkä and Á. F. García-Fernández, *Temporal parallelization of Bayesian
//! smoothers*, IEEE Transactions on Automatic Control 66, 2021):
//! ```text
//! A = A₂ (I + N₁ J₂)⁻¹ A₁    N = A₂ (I + N₁ J₂)⁻¹ N₁ A₂ᵀ + N₂    J = A₁ᵀ J₂ (I + N₁ J₂)⁻¹ A₁ + J₁
//! ```
//! so that doubling gives any n. The result is that of the filter's own recursion, up to rounding.

use super::platform::{CALIBRATING_S, INPUTS, InputRows, PARAMETER_COUNT, Platform};
use nalgebra::{SMatrix, SVector, SymmetricEigen};
use octant_calibration::covariance::{
    Covariance, CovarianceRow, MOVING, PARAMETERS, STATE_COUNT, Transition,
};
use octant_calibration::filter::add_process_noise;
use octant_calibration::sequence::Stop;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Moving states and errors in n.
const SIZE: usize = MOVING + INPUTS;
type Square = SMatrix<f64, SIZE, SIZE>;

/// First column of the gyro biases and of the accelerometer biases in a transition: at the attitude where
/// body and navigation frame agree, they are the errors in n.
const BIASES: [usize; 2] = [PARAMETERS, PARAMETERS + 21];

/// Upper ends of what the fifteen states can be: rad, m/s, m, rad/s, m/s². Information that would not change
/// a variance of this size by a part in 10⁹ is left out.
const SCALES: [f64; SIZE] = {
    let mut scales = [0.0; SIZE];
    let sizes = [1e-2, 1.0, 10.0, 1e-6, 1e-1];
    let mut index = 0;
    while index < SIZE {
        scales[index] = sizes[index / 3];
        index += 1;
    }
    scales
};
const INFORMATION_MIN: f64 = 1e-9;

/// Map of some measured periods.
#[derive(Clone, Debug)]
struct Map {
    transition: Square,
    noise: Square,
    information: Square,
}

impl Map {
    /// Makes the map of one period with a measurement at its end, of three states from `first` on with this
    /// variance.
    fn one(platform: &Platform, period_s: f64, (first, variance): (usize, f64)) -> Self {
        let level = Platform {
            c_nc: nalgebra::Matrix3::identity(),
            non_orthogonality_rad: 0.0,
            ..platform.clone()
        };
        let over = level.standing(&Stop::default(), period_s, CALIBRATING_S, platform.error_model);
        let mut f = Square::identity();
        for i in 0..MOVING {
            for j in 0..MOVING {
                f[(i, j)] = over.rows[i][j];
            }
            for (k, bias) in BIASES.into_iter().enumerate() {
                for axis in 0..3 {
                    f[(i, MOVING + 3 * k + axis)] = over.rows[i][bias + axis];
                }
            }
        }
        let mut noise = Covariance::from_sigmas(&[0.0; STATE_COUNT]);
        add_process_noise(&mut noise, platform.noise, period_s, &(platform.force() * period_s));
        let q = Square::from_fn(|i, j| if i < MOVING && j < MOVING { noise.at(i, j) } else { 0.0 });
        let h = SMatrix::<f64, 3, SIZE>::from_fn(|i, j| if j == first + i { 1.0 } else { 0.0 });
        let innovation = h * q * h.transpose() + SMatrix::<f64, 3, 3>::identity() * variance;
        // A sum of a positive semidefinite matrix and a multiple of the identity has an inverse.
        let inverse = innovation.try_inverse().unwrap_or_else(SMatrix::zeros);
        let kept = Square::identity() - q * h.transpose() * inverse * h;
        Self {
            transition: kept * f,
            noise: kept * q,
            information: f.transpose() * h.transpose() * inverse * h * f,
        }
    }

    /// Makes the map of this one with another after it.
    fn then(&self, next: &Self) -> Self {
        let mixed = Square::identity() + self.noise * next.information;
        // Its eigenvalues are 1 and above: a product of two positive semidefinite matrices has none below 0.
        let inverse = mixed.try_inverse().unwrap_or_else(Square::identity);
        let symmetric = |m: Square| (m + m.transpose()) * 0.5;
        let before = inverse * self.transition;
        Self {
            transition: next.transition * before,
            noise: symmetric(
                next.transition * inverse * self.noise * next.transition.transpose() + next.noise,
            ),
            information: symmetric(
                self.transition.transpose() * next.information * before + self.information,
            ),
        }
    }
}

/// A dwell of a number of periods, ready to be applied.
#[derive(Debug)]
pub(crate) struct Dwell {
    /// Rows whose squares add up to the information.
    information: Vec<[f64; SIZE]>,
    transition: [[f64; SIZE]; MOVING],
    noise: [[f64; MOVING]; MOVING],
}

impl Dwell {
    fn of(map: &Map) -> Self {
        let scales = SVector::<f64, SIZE>::from(SCALES);
        let scaled = Square::from_fn(|i, j| scales[i] * map.information[(i, j)] * scales[j]);
        let eigen = SymmetricEigen::new(scaled);
        let information = (0..SIZE)
            .filter(|&k| eigen.eigenvalues[k] > INFORMATION_MIN)
            .map(|k| {
                let root = libm::sqrt(eigen.eigenvalues[k]);
                core::array::from_fn(|i| root * eigen.eigenvectors[(i, k)] / scales[i])
            })
            .collect();
        Self {
            information,
            transition: core::array::from_fn(|i| core::array::from_fn(|j| map.transition[(i, j)])),
            noise: core::array::from_fn(|i| core::array::from_fn(|j| map.noise[(i, j)])),
        }
    }

    /// Applies the dwell to a covariance, at the stop with these errors in n.
    pub(crate) fn apply(&self, covariance: &mut Covariance, inputs: &InputRows) {
        self.update(covariance.rows_mut(), inputs);
        self.propagate(covariance.rows_mut(), inputs);
    }

    /// Takes in the information of all measurements: `P ← P − P Lᵀ Sᵀ (I + S L P Lᵀ Sᵀ)⁻¹ S L P`, where
    /// S are the rows of the information and L makes z of the states.
    fn update(&self, p: &mut [CovarianceRow; STATE_COUNT], inputs: &InputRows) {
        let rank = self.information.len();
        let lifted = lifted(p, inputs);
        let mut x = [[0.0; ROW]; SIZE];
        for (x, s) in x.iter_mut().zip(&self.information) {
            for (row, factor) in lifted.iter().zip(s) {
                add(x, *factor, row);
            }
        }
        // The lower triangle of the Cholesky factor of I + S L P Lᵀ Sᵀ.
        let mut factor = [[0.0; SIZE]; SIZE];
        for i in 0..rank {
            let z = in_z(&x[i], inputs);
            for j in 0..=i {
                let s = &self.information[j];
                let mut sum: f64 = z.iter().zip(s).map(|(a, b)| a * b).sum();
                if i == j {
                    sum += 1.0;
                }
                for k in 0..j {
                    sum -= factor[i][k] * factor[j][k];
                }
                factor[i][j] = if i == j { libm::sqrt(sum.max(1.0)) } else { sum / factor[j][j] };
            }
        }
        for i in 0..rank {
            let (before, rest) = x.split_at_mut(i);
            let row = &mut rest[0];
            for (known, scale) in before.iter().zip(&factor[i]) {
                add(row, -scale, known);
            }
            let scale = 1.0 / factor[i][i];
            row.iter_mut().for_each(|value| *value *= scale);
            for (j, out) in p.iter_mut().enumerate() {
                add(out, -row[j], row);
            }
        }
    }

    /// Carries the moving states to the end of the dwell.
    fn propagate(&self, p: &mut [CovarianceRow; STATE_COUNT], inputs: &InputRows) {
        let lifted = lifted(p, inputs);
        let mut w = [[0.0; ROW]; MOVING];
        for (w, a) in w.iter_mut().zip(&self.transition) {
            for (row, factor) in lifted.iter().zip(a) {
                add(w, *factor, row);
            }
        }
        for i in 0..MOVING {
            let z = in_z(&w[i], inputs);
            for j in i..MOVING {
                let carried: f64 = z.iter().zip(&self.transition[j]).map(|(a, b)| a * b).sum();
                p[i][j] = carried + self.noise[i][j];
                p[j][i] = p[i][j];
            }
            for j in MOVING..STATE_COUNT {
                p[i][j] = w[i][j];
                p[j][i] = w[i][j];
            }
        }
    }
}

/// Length of a row of a covariance.
const ROW: usize = core::mem::size_of::<CovarianceRow>() / core::mem::size_of::<f64>();

fn add(to: &mut CovarianceRow, factor: f64, row: &CovarianceRow) {
    for (out, value) in to.iter_mut().zip(row) {
        *out += factor * value;
    }
}

/// Returns `L P`: rows of the moving states, and of the errors in n.
fn lifted(p: &[CovarianceRow; STATE_COUNT], inputs: &InputRows) -> [CovarianceRow; SIZE] {
    let mut rows = [[0.0; ROW]; SIZE];
    rows[..MOVING].copy_from_slice(&p[..MOVING]);
    for (row, input) in rows[MOVING..].iter_mut().zip(inputs) {
        for (parameter, factor) in p[MOVING..].iter().zip(input) {
            if *factor != 0.0 {
                add(row, *factor, parameter);
            }
        }
    }
    rows
}

/// Returns a row over all states times `Lᵀ`: over the fifteen.
fn in_z(row: &CovarianceRow, inputs: &InputRows) -> [f64; SIZE] {
    core::array::from_fn(|i| {
        if i < MOVING {
            return row[i];
        }
        let parameters = &row[MOVING..MOVING + PARAMETER_COUNT];
        parameters.iter().zip(&inputs[i - MOVING]).map(|(a, b)| a * b).sum()
    })
}

/// Dwells of any number of periods, made when they are asked for.
#[derive(Debug)]
pub(crate) struct Dwells {
    /// Maps of 1, 2, 4 … periods.
    powers: Vec<Map>,
    made: BTreeMap<u32, Arc<Dwell>>,
}

impl Dwells {
    /// Prepares dwells with a measurement each period, of three states from `first` on with this variance.
    pub(crate) fn new(platform: &Platform, period_s: f64, measured: (usize, f64)) -> Self {
        Self { powers: vec![Map::one(platform, period_s, measured)], made: BTreeMap::new() }
    }

    /// Returns the dwell of a number of periods, at least one.
    pub(crate) fn of(&mut self, periods: u32) -> Arc<Dwell> {
        if let Some(dwell) = self.made.get(&periods) {
            return Arc::clone(dwell);
        }
        let periods = periods.max(1);
        let bits = (u32::BITS - periods.leading_zeros()) as usize;
        while self.powers.len() < bits {
            let last = &self.powers[self.powers.len() - 1];
            let doubled = last.then(last);
            self.powers.push(doubled);
        }
        let set = (0..bits).filter(|bit| periods >> bit & 1 == 1).map(|bit| &self.powers[bit]);
        let whole = set.fold(None, |done: Option<Map>, map| {
            Some(done.map_or_else(|| map.clone(), |done| done.then(map)))
        });
        let dwell = Arc::new(whole.as_ref().map_or_else(
            || Dwell { information: Vec::new(), transition: identity(), noise: [[0.0; 9]; 9] },
            Dwell::of,
        ));
        if self.made.len() >= MADE_MAX {
            self.made.clear();
        }
        self.made.insert(periods, Arc::clone(&dwell));
        dwell
    }
}

/// Dwells that are kept, 3 kB each.
const MADE_MAX: usize = 20_000;

fn identity() -> [[f64; SIZE]; MOVING] {
    let one = Transition::identity();
    core::array::from_fn(|i| core::array::from_fn(|j| one.rows[i][j]))
}
