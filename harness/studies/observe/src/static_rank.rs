//! Static algebra of gyro drift: which of b_g, G and azimuth a list of attitudes can separate.
//!
//! The case is level and at rest. In an attitude `C = c_nb` the drift in n is
//! ```text
//! d = C (b_g + G f_b) + (0, Ω cos L · δψ, 0),     f_b = Cᵀ (0, 0, −g)
//! ```
//! Horizontal drift shows as tilt against the accelerometers within minutes; vertical drift only
//! through azimuth wander, so its row is an option. An azimuth error δψ, constant in n through the
//! whole sequence, turns the horizontal Earth rate by `Ω cos L · δψ` to the east: it is the
//! thirteenth unknown.
//!
//! G is scaled by standard gravity and δψ by Ω: all coefficients are then of order one, and those
//! that should be zero are of the order of rounding.

use nalgebra::{Matrix3, SMatrix, SVector, SymmetricEigen, Vector3};
use octant_earth::frames::{c_cb, c_nc};

/// Number of unknowns: b_g (3), G (9), azimuth (1).
pub const UNKNOWNS: usize = 13;

/// Names of the unknowns in the description of a null space.
const NAMES: [&str; UNKNOWNS] =
    ["bx", "by", "bz", "Gxx", "Gxy", "Gxz", "Gyx", "Gyy", "Gyz", "Gzx", "Gzy", "Gzz", "azimuth"];

/// Eigenvalue of the normal matrix, per attitude, above which a direction counts as observed.
///
/// Eigenvalues are squares of sensitivities. Rounding leaves 1e-16; a direction that is unobserved
/// for the exact angles, and seen only because a user wrote them with two decimals of a degree
/// (54.74° for the magic angle), has (1e-4)² = 1e-8; the weakest observed direction of the
/// sequences in use has 1e-2. At the threshold the sensitivity is 1/300 of a plain one: no dwell
/// makes up for that.
const THRESHOLD: f64 = 1e-5;

/// Size below which a component of the null space is zero. Directions just under [`THRESHOLD`]
/// deviate from the exact null space by up to its root, 3e-3; as pivots, such components would be
/// amplified into nonsense.
const COMPONENT: f64 = 1e-2;

/// Distance from a small fraction within which a coefficient is that fraction.
const FRACTION: f64 = 1e-3;

/// Rank and null space of a position sequence.
#[derive(Clone, Debug, PartialEq)]
pub struct StaticRank {
    /// Number of independent combinations of the unknowns that are observed.
    pub rank: usize,
    /// Number of unknowns: always [`UNKNOWNS`].
    pub unknowns: usize,
    /// Unobserved directions, as sums of unknowns: bx by bz (gyro bias), Gxx to Gzz, azimuth. G is
    /// in units of a bias per g and azimuth in units of a bias per Ω.
    pub null_space: Vec<String>,
}

/// Computes rank and null space of the drift rows of `stops`: pairs of gimbal angles (azimuth,
/// roll) in rad, case level at `heading_rad`; `vertical` adds the rows of vertical drift.
///
/// Stops may repeat: the number of times that an attitude is taken doesn't change the observed
/// directions, and is averaged out of the threshold.
#[must_use]
pub fn static_rank(
    stops: &[(f64, f64)],
    latitude_rad: f64,
    heading_rad: f64,
    vertical: bool,
) -> StaticRank {
    let mut normal = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::zeros();
    for &(azimuth_rad, roll_rad) in stops {
        let c_nb = c_nc(heading_rad, 0.0, 0.0) * c_cb(azimuth_rad, roll_rad);
        for row in drift_rows(&c_nb, latitude_rad).iter().take(if vertical { 3 } else { 2 }) {
            normal += row * row.transpose();
        }
    }
    normal /= (stops.len().max(1)) as f64;
    let eigen = SymmetricEigen::new(normal);
    let unseen: Vec<SVector<f64, UNKNOWNS>> = (0..UNKNOWNS)
        .filter(|&i| eigen.eigenvalues[i] < THRESHOLD)
        .map(|i| eigen.eigenvectors.column(i).into_owned())
        .collect();
    let rank = UNKNOWNS - unseen.len();
    StaticRank { rank, unknowns: UNKNOWNS, null_space: words(unseen) }
}

/// Returns north, east and down drift as rows over the unknowns.
fn drift_rows(c_nb: &Matrix3<f64>, latitude_rad: f64) -> [SVector<f64, UNKNOWNS>; 3] {
    let force_g = c_nb.transpose() * Vector3::new(0.0, 0.0, -1.0);
    core::array::from_fn(|axis| {
        let mut row = SVector::zeros();
        for i in 0..3 {
            row[i] = c_nb[(axis, i)];
            for j in 0..3 {
                row[3 + 3 * i + j] = c_nb[(axis, i)] * force_g[j];
            }
        }
        row[12] = if axis == 1 { libm::cos(latitude_rad) } else { 0.0 };
        row
    })
}

/// Reduces the span of `vectors` to row echelon form, each row as a sum of names.
///
/// Pivots are sought among G first, then biases, then azimuth: the null space is expressed in terms
/// of the quantities that the sequence is meant to determine.
fn words(mut vectors: Vec<SVector<f64, UNKNOWNS>>) -> Vec<String> {
    let order = [3, 4, 5, 6, 7, 8, 9, 10, 11, 0, 1, 2, 12];
    let mut done = 0;
    for column in order {
        let best = (done..vectors.len())
            .max_by(|&a, &b| vectors[a][column].abs().total_cmp(&vectors[b][column].abs()));
        let Some(best) = best.filter(|&row| vectors[row][column].abs() > COMPONENT) else {
            continue;
        };
        vectors.swap(done, best);
        let pivot = vectors[done] / vectors[done][column];
        for (row, vector) in vectors.iter_mut().enumerate() {
            if row == done {
                *vector = pivot;
            } else {
                *vector -= pivot * vector[column];
            }
        }
        done += 1;
    }
    vectors.iter().take(done).map(|vector| sentence(vector, &order)).collect()
}

fn sentence(vector: &SVector<f64, UNKNOWNS>, order: &[usize; UNKNOWNS]) -> String {
    let mut text = String::new();
    for &i in order {
        let value = vector[i];
        if value.abs() <= COMPONENT {
            continue;
        }
        let sign = match (text.is_empty(), value < 0.0) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        text.push_str(sign);
        text.push_str(&factor(value.abs()));
        text.push_str(NAMES[i]);
    }
    text
}

/// Renders a coefficient in front of a name: nothing for 1, a small fraction where it is one, else
/// four decimals.
#[must_use]
pub fn factor(value: f64) -> String {
    for denominator in 1..=6u32 {
        let numerator = value * f64::from(denominator);
        let nearest = numerator.round();
        if (1.0..=12.0).contains(&nearest) && (numerator - nearest).abs() < FRACTION {
            return match (nearest as u32, denominator) {
                (1, 1) => String::new(),
                (n, 1) => format!("{n} "),
                (n, d) => format!("{n}/{d} "),
            };
        }
    }
    format!("{value:.4} ")
}
