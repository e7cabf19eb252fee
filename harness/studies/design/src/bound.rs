//! The bound: what no attitude history can beat.
//!
//! Split the g-dependent biases into G = γ·1 + G', with γ·1 the isotropic part. Whatever is known of the
//! errors, knowing more can't make the error of a linear estimate larger. So let all parameters but γ be
//! known exactly. What is left are attitude, velocity and γ. At rest the specific force is constant in n,
//! and C (γ·1) Cᵀ f = γ f: the drift by γ is the same vertical drift in every attitude C, at rest and while
//! turning. White noise of three equal gyros and three equal accelerometers looks the same in every
//! attitude, too. So neither the equations of these errors nor those of their estimate contain the
//! attitude, in the calibration or in navigation, and the measure that they leave holds for every sequence,
//! dwelling or continuous, with every rotation.
//!
//! The certificate is the covariance of the six errors that are left, and their weights: the bound is the
//! root of their product's trace plus the noise of navigation.
//!
//! The largest error of a navigation has the same bound, by draws from that covariance. More covariance, in
//! the sense that the difference is positive semidefinite, makes a Gaussian process leave every symmetric
//! convex set more often (T. W. Anderson, *The integral of a symmetric unimodal function over a symmetric
//! convex set*, Proceedings of the American Mathematical Society 6, 1955), and "no error above x" is one.

use super::judge::DIAGONAL;
use crate::judge::Judge;
use crate::largest::Sampled;
use crate::platform::KNOWN_AT_START;
use crate::setup::level;
use octant_calibration::covariance::DV;
use octant_calibration::schedule::DoesNotFit;
use serde::Serialize;

pub use super::judge::known_but_isotropic;

/// A bound with its certificate.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DriftBound {
    /// No sequence has a smaller measure.
    pub value: f64,
    /// Standard error of the value by the draws of a largest error; 0 for all other measures.
    pub sampling: f64,
    /// Names of the errors that are left: attitude north, east, down, rad; velocity north, east, m/s; the
    /// isotropic part of G, rad/s per m/s².
    pub errors: [&'static str; LEFT],
    /// Covariance of these errors after the calibration, with all other parameters known.
    pub covariance: [[f64; LEFT]; LEFT],
    /// Weights of their products in the square of the measure; for a largest error, of the form that stands
    /// for it in the search.
    pub weights: [[f64; LEFT]; LEFT],
    /// Square of the part by white noise of navigation.
    pub noise: f64,
}

/// Number of errors that are left at the start of navigation.
pub const LEFT: usize = 6;
const NAMES: [&str; LEFT] =
    ["phi_north", "phi_east", "phi_down", "velocity_north", "velocity_east", "g_isotropic"];
/// States that the errors stand for; the isotropic part stands for the diagonal of G.
const STATES: [&[usize]; LEFT] = [&[0], &[1], &[2], &[DV], &[DV + 1], &DIAGONAL];

/// Computes the bound of a judge's measure for calibrations of `duration_s`, among all attitude histories.
///
/// # Errors
/// If the duration is shorter than a dwell can be.
pub fn bound(judge: &Judge, duration_s: f64) -> Result<DriftBound, DoesNotFit> {
    let initial = known_but_isotropic(&judge.evaluator.conditions().initial);
    let mut knowing = judge.from_initial(initial);
    let mut left = knowing.evaluator.calibrate(&level(), duration_s)?;
    KNOWN_AT_START.iter().for_each(|state| left.reopen(*state, 0.0));
    let form = judge.form();
    let weight = |i: usize, j: usize| -> f64 {
        STATES[i].iter().flat_map(|a| STATES[j].iter().map(|b| form.at(*a, *b))).sum()
    };
    let square = |of: &dyn Fn(usize, usize) -> f64| -> [[f64; LEFT]; LEFT] {
        core::array::from_fn(|i| core::array::from_fn(|j| of(i, j)))
    };
    let covariance = square(&|i, j| left.at(STATES[i][0], STATES[j][0]));
    let weights = square(&weight);
    let products = covariance.as_flattened().iter().zip(weights.as_flattened());
    let trace: f64 = products.map(|(variance, weight)| variance * weight).sum();
    let of_form = Sampled { value: libm::sqrt((trace + form.constant).max(0.0)), error: 0.0 };
    let Sampled { value, error: sampling } = judge.drawn(&left).unwrap_or(of_form);
    Ok(DriftBound { value, sampling, errors: NAMES, covariance, weights, noise: form.constant })
}
