//! The smoother: backward recursion of Bryson and Frazier, in the form that carries no inverse of a covariance.
//!
//! With x the errors that are left in the filter's estimate after measurement k, P their covariance, and ν, S, K the
//! innovations that follow, their covariances and the gains, the adjoint r and its information N come backward by
//!
//! ```text
//! r ← Hᵀ S⁻¹ ν + (I − K H)ᵀ r      N ← Hᵀ S⁻¹ H + (I − K H)ᵀ N (I − K H)      over a measurement
//! r ← Φᵀ r                         N ← Φᵀ N Φ                                 over a transition
//! ```
//!
//! from zero at the end, and the whole calibration knows the errors by x = P r with the covariance P − P N P (Bierman, 1973;
//! de Jong, 1989). Process noise isn't needed: it is in P. The errors of attitude, velocity and position are computed − true, those
//! of the parameters true − estimated, as in the filter.
//!
//! r itself is of use: as a sum of innovations it is normal with the covariance N while the model holds, and a jump by a of
//! state i just after k gives it the mean N e a. rᵢ/√Nᵢᵢ is therefore the likelihood ratio of such a jump (de Jong
//! and Penzer, 1998), whatever the filter believes of P.

use super::store::{Measured, Node, StoreError};
use crate::store::Store;
use crate::{StateVector, States};
use nalgebra::{Matrix3, SMatrix, Vector3};
use octant_calibration::covariance::{MOVING, STATE_COUNT};

/// Least number of measurements to be smoothed.
const LEAST: usize = 60;

type MovingByStates = SMatrix<f64, MOVING, STATE_COUNT>;
type ThreeByStates = SMatrix<f64, 3, STATE_COUNT>;
type StatesByThree = SMatrix<f64, STATE_COUNT, 3>;

/// The filter and the smoother at one time.
#[derive(Clone, Debug)]
pub struct Smoothed {
    /// Time of the filter, s.
    pub time_s: f64,
    /// The filter after the measurement of that time.
    pub node: Box<Node>,
    /// Adjoint r: the innovations after that time, weighted by the effect of each state on them.
    pub adjoint: StateVector,
    /// Its covariance N: the information of what came after that time.
    pub information: States,
}

impl Smoothed {
    /// Covariance of the filter.
    #[must_use]
    pub fn filtered_covariance(&self) -> States {
        States::from_fn(|i, j| self.node.covariance[i][j])
    }

    /// Errors that the whole calibration finds in the estimate.
    #[must_use]
    pub fn errors(&self) -> StateVector {
        self.filtered_covariance() * self.adjoint
    }

    /// Covariance of what is left after these are taken out.
    #[must_use]
    pub fn covariance(&self) -> States {
        let p = self.filtered_covariance();
        let pn = p * self.information;
        p - pn * p
    }
}

/// A calibration smoothed at its nodes, in order of time.
#[derive(Clone, Debug)]
pub struct SmoothedCalibration {
    /// The nodes.
    pub nodes: Vec<Smoothed>,
    /// Mean of the normalized innovations squared, three axes: 3 is expected.
    pub mean_nis: f64,
    /// Covariances of the adjoints of state i at two nodes j and l, at `[i][j * nodes + l]`.
    covariances: Vec<Vec<f64>>,
}

impl SmoothedCalibration {
    /// Covariance of the adjoints of a state at two nodes.
    #[must_use]
    pub fn covariance(&self, state: usize, j: usize, l: usize) -> f64 {
        self.covariances[state][j * self.nodes.len() + l]
    }
}

/// The recursion at one time.
struct Backward {
    adjoint: StateVector,
    information: States,
    /// ParameterChange of the errors from here to the node that was met last.
    onward: States,
    nis: f64,
}

impl Backward {
    /// Goes back over a measurement.
    fn measurement(&mut self, measured: &Measured) {
        let first = measured.first;
        let r = measured.variance;
        let gain = StatesByThree::from_fn(|i, axis| measured.covariance[axis][i] / r);
        let hh = Matrix3::from_fn(|i, j| measured.covariance[i][first + j]);
        // S⁻¹ by what is left of the variance: P = P₋ − P₋ Hᵀ S⁻¹ H P₋ with the gain P Hᵀ R⁻¹.
        let s_inverse = Matrix3::identity() / r - (hh + hh.transpose()) * (0.5 / (r * r));
        let of_gain: ThreeByStates = gain.transpose() * self.information;
        let corner = of_gain * gain + s_inverse;
        let innovation = Vector3::from(measured.innovation);
        self.nis += innovation.dot(&(s_inverse * innovation));
        let change = s_inverse * innovation - gain.transpose() * self.adjoint;
        let onward_gain: StatesByThree = self.onward * gain;
        for axis in 0..3 {
            self.adjoint[first + axis] += change[axis];
            for i in 0..STATE_COUNT {
                self.information[(first + axis, i)] -= of_gain[(axis, i)];
                self.information[(i, first + axis)] -= of_gain[(axis, i)];
                self.onward[(i, first + axis)] -= onward_gain[(i, axis)];
            }
        }
        for i in 0..3 {
            for j in 0..3 {
                self.information[(first + i, first + j)] += corner[(i, j)];
            }
        }
    }

    /// Goes back over a transition, `[A B; 0 I]`.
    fn transition(&mut self, measured: &Measured) {
        let rows = MovingByStates::from_fn(|i, j| measured.transition[i][j]);
        let moving = self.adjoint.fixed_rows::<MOVING>(0).into_owned();
        let carried = rows.transpose() * moving;
        self.adjoint.fixed_rows_mut::<MOVING>(0).fill(0.0);
        self.adjoint += carried;
        // N Φ = N with its moving columns taken out, plus those times the rows; then the same from the left.
        let columns = self.information.fixed_columns::<MOVING>(0).into_owned();
        self.information.fixed_columns_mut::<MOVING>(0).fill(0.0);
        self.information += columns * rows;
        let lines = self.information.fixed_rows::<MOVING>(0).into_owned();
        self.information.fixed_rows_mut::<MOVING>(0).fill(0.0);
        self.information += rows.transpose() * lines;
        self.information = 0.5 * (self.information + self.information.transpose());
        let columns = self.onward.fixed_columns::<MOVING>(0).into_owned();
        self.onward.fixed_columns_mut::<MOVING>(0).fill(0.0);
        self.onward += columns * rows;
    }
}

/// Smooths what a filter measured, at its nodes.
///
/// # Errors
/// If the history is too short, or can't be read.
pub fn smooth(store: &mut Store) -> Result<SmoothedCalibration, SmootherError> {
    if store.len() < LEAST {
        return Err(SmootherError::TooShort { found: store.len(), expected: LEAST });
    }
    let mut at = Backward {
        adjoint: StateVector::zeros(),
        information: States::zeros(),
        onward: States::identity(),
        nis: 0.0,
    };
    let mut nodes: Vec<Smoothed> = Vec::new();
    // Covariances of the last node's adjoint with those of the later ones, that of its own first; and what is kept of all.
    let mut with_later: Vec<States> = Vec::new();
    let mut kept: Vec<Vec<StateVector>> = Vec::new();
    for k in (0..store.len()).rev() {
        let mut measured = store.read(k)?;
        if let Some(node) = measured.node.take() {
            let onward = at.onward.transpose();
            for covariance in &mut with_later {
                *covariance = onward * *covariance;
            }
            with_later.push(at.information);
            kept.push(with_later.iter().map(|covariance| covariance.diagonal()).collect());
            at.onward = States::identity();
            nodes.push(Smoothed {
                time_s: measured.time_s,
                node,
                adjoint: at.adjoint,
                information: at.information,
            });
        }
        at.measurement(&measured);
        at.transition(&measured);
    }
    nodes.reverse();
    let n = nodes.len();
    let mut covariances = vec![vec![0.0; n * n]; STATE_COUNT];
    for (back, row) in kept.iter().enumerate() {
        for (later, values) in row.iter().enumerate() {
            let (j, l) = (n - 1 - back, n - 1 - later);
            for (all, value) in covariances.iter_mut().zip(values.iter()) {
                all[j * n + l] = *value;
                all[l * n + j] = *value;
            }
        }
    }
    let mean_nis = at.nis / store.len() as f64;
    Ok(SmoothedCalibration { nodes, mean_nis, covariances })
}

/// Reasons why a calibration can't be smoothed.
#[derive(Debug, thiserror::Error)]
pub enum SmootherError {
    /// It has no filter.
    #[error("smooth: found estimator = {found:?}, expected \"kalman\"")]
    NoFilter {
        /// Name of the estimator; none if there is no calibration.
        found: &'static str,
    },
    /// The filter has states that the smoother doesn't carry.
    #[error(
        "smooth: found a filter with {found}, expected the 39 states alone: the smoother doesn't carry others"
    )]
    OtherStates {
        /// The states.
        found: &'static str,
    },
    /// The stream has too little of a calibration.
    #[error(
        "smooth: found {found} measurements after the last recovery, expected at least {expected}"
    )]
    TooShort {
        /// Measurements that were used.
        found: usize,
        /// Least number.
        expected: usize,
    },
    /// The history can't be kept.
    #[error(transparent)]
    Store(#[from] StoreError),
}
