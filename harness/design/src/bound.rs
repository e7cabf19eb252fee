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
//! The certificate is those seven numbers' covariance and weights: the bound is the root of their product's
//! trace plus the noise of navigation.

use super::platform::KNOWN_AT_START;
use super::setup::{Judge, level};
use octant_calibration::covariance::{Covariance, DV, PARAMETERS, STATE_COUNT};
use octant_calibration::schedule::DoesNotFit;
use serde::Serialize;

/// First state of G, by rows.
const G: usize = PARAMETERS + 12;
/// Diagonal of G.
const DIAGONAL: [usize; 3] = [G, G + 4, G + 8];

/// A bound with its certificate.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DriftBound {
    /// No sequence has a smaller measure.
    pub value: f64,
    /// Names of the errors that are left: attitude north, east, down, rad; velocity north, east, m/s; the
    /// isotropic part of G, rad/s per m/s².
    pub errors: [&'static str; LEFT],
    /// Covariance of these errors after the calibration, with all other parameters known.
    pub covariance: [[f64; LEFT]; LEFT],
    /// Weights of their products in the square of the measure.
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

/// Makes the covariance of the same errors with all parameters known but the isotropic part of G.
#[must_use]
pub fn known_but_isotropic(initial: &Covariance) -> Covariance {
    let mut covariance = initial.clone();
    for state in (PARAMETERS..STATE_COUNT).filter(|state| !DIAGONAL.contains(state)) {
        learn(&mut covariance, &[(state, 1.0)]);
    }
    for pair in DIAGONAL.windows(2) {
        learn(&mut covariance, &[(pair[0], 1.0), (pair[1], -1.0)]);
    }
    covariance
}

/// Makes a combination of errors exactly known.
fn learn(covariance: &mut Covariance, combination: &[(usize, f64)]) {
    let row: [f64; STATE_COUNT] = core::array::from_fn(|j| {
        combination.iter().map(|(state, factor)| factor * covariance.at(*state, j)).sum()
    });
    let variance: f64 = combination.iter().map(|(state, factor)| factor * row[*state]).sum();
    if variance > 0.0 {
        for i in 0..STATE_COUNT {
            for j in i..STATE_COUNT {
                covariance.add(i, j, -row[i] * row[j] / variance);
            }
        }
    }
    // Remainder of the rounding.
    if let [(state, _)] = combination {
        covariance.reopen(*state, 0.0);
    }
}

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
    let value = libm::sqrt((trace + form.constant).max(0.0));
    Ok(DriftBound { value, errors: NAMES, covariance, weights, noise: form.constant })
}
