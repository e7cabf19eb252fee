//! Covariances in which all parameters are known but the isotropic part of the g-dependent biases.

use octant_calibration::covariance::{Covariance, PARAMETERS, STATE_COUNT};

/// First state of G, by rows.
pub(crate) const G: usize = PARAMETERS + 12;
/// Diagonal of G.
pub(crate) const DIAGONAL: [usize; 3] = [G, G + 4, G + 8];

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
