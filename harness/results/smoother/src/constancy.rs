//! Tests of what the filter takes for constant: jumps, ramps, walks and wandering of the parameters.
//!
//! All of them rest on the adjoint r of the [smoother](crate::backward) at the nodes, which is normal with known covariances
//! while the parameters are constant. Let parameter i change by the course a(t). Then r has the mean C a′, where a′ are the changes
//! at the nodes and C the covariances of rᵢ between the nodes, and the likelihood ratio of a known
//! course is the sum of rᵢ a′. A course that is known but for its size gives a normal variable,
//!
//! ```text
//! z = Σ a′ⱼ rⱼ / √(Σ a′ⱼ Cⱼₗ a′ₗ)
//! ```
//!
//! which is tested for each jump (one change), jump back (two opposite ones) and ramp (equal changes). Of a random course with
//! the covariance q K the changes are unknown, and the best test for a small q is the derivative of the likelihood by it (the
//! score; Nyblom and Mäkeläinen, 1983): Q = rᵀ K r, whose distribution under constant parameters is that of Σ λ z² with the
//! eigenvalues λ of K C. K is the unit matrix for a random walk, and exp(−|tⱼ − tₗ|/τ) over the levels between nodes for a
//! Gauss-Markov process.
//!
//! Parameters that are hardly known better than by their prior at a node aren't tested there: a prior that is too narrow is
//! no change.

use super::store::Row;
use crate::backward::{Smoothed, SmoothedCalibration};
use crate::quadratic::probability_above;
use nalgebra::{SMatrix, SymmetricEigen};
use octant_calibration::covariance::PARAMETERS;
use octant_sample::parameters::PARAMETER_COUNT;
use octant_statistics::normal;

/// Most nodes that are tested.
pub const NODES_MAX: usize = 48;
/// Share of the prior variance below which a parameter is tested.
const KNOWN: f64 = 0.25;
/// Least share of a variance that what follows takes away.
const GAIN_MIN: f64 = 0.01;
/// Correlation times of wandering that are tested, shares of the calibration.
const CORRELATION_TIMES: [f64; 3] = [1.0 / 24.0, 1.0 / 8.0, 1.0 / 3.0];

type Nodes = SMatrix<f64, NODES_MAX, NODES_MAX>;

/// How a parameter changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterChange {
    /// It jumps, and stays.
    Jump,
    /// It jumps, and jumps back.
    Pulse,
    /// It changes evenly from one time to another.
    Ramp,
    /// It walks at random.
    Walk,
    /// It wanders about its value: a Gauss-Markov process with this correlation time, s.
    Wander {
        /// Correlation time, s.
        correlation_time_s: f64,
    },
}

impl ParameterChange {
    /// Result above which a change of this kind isn't noise, σ. The more courses there are, the larger is the largest
    /// of them on clean data: of 1000 clean calibrations of 4 h the largest jump was 4.70, the largest jump and back 5.20, the
    /// largest ramp 4.44, and of the random courses 4.08.
    #[must_use]
    pub fn limit_sigmas(self) -> f64 {
        match self {
            Self::Jump | Self::Ramp => 5.0,
            Self::Pulse => 5.5,
            Self::Walk | Self::Wander { .. } => 4.5,
        }
    }
}

/// What a test found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstancyFinding {
    /// Index of the parameter.
    pub parameter: usize,
    /// How it changes.
    pub change: ParameterChange,
    /// Start and end of the change, s of the filter's time; of all that is tested for a walk or a wandering.
    pub between_s: (f64, f64),
    /// Size in σ of a normal variable, positive: |z|, or that with the same probability on both sides as the tail above Q.
    pub sigmas: f64,
    /// Estimate of the size, SI: the change; the walk per √s; the σ of the wandering. Zero where the estimate of a
    /// variance is negative.
    pub size: f64,
    /// σ of that estimate; none of a variance, which isn't normal.
    pub size_sigma: Option<f64>,
}

/// Covariances of one parameter's adjoint at the nodes from the first that is tested on.
struct Tested<'a> {
    nodes: &'a [Smoothed],
    state: usize,
    first: usize,
    covariance: Nodes,
}

impl Tested<'_> {
    fn len(&self) -> usize {
        self.nodes.len() - self.first
    }

    fn time_s(&self, j: usize) -> f64 {
        self.nodes[self.first + j].time_s
    }

    fn end_s(&self) -> f64 {
        self.nodes.last().map_or(0.0, |node| node.time_s)
    }

    fn adjoint(&self, j: usize) -> f64 {
        self.nodes[self.first + j].adjoint[self.state]
    }

    fn variance(&self, j: usize) -> f64 {
        self.nodes[self.first + j].node.covariance[self.state][self.state]
    }

    /// The course with this weighted sum of adjoints, its variance, and a change of one.
    fn course(
        &self,
        change: ParameterChange,
        at: (usize, usize),
        sum: f64,
        variance: f64,
    ) -> Option<ConstancyFinding> {
        if !(variance * self.variance(at.0) >= GAIN_MIN) {
            return None;
        }
        let until_s = if at.1 < self.len() { self.time_s(at.1) } else { self.end_s() };
        Some(ConstancyFinding {
            parameter: self.state - PARAMETERS,
            change,
            between_s: (self.time_s(at.0), until_s),
            sigmas: sum.abs() / libm::sqrt(variance),
            size: sum / variance,
            size_sigma: Some(1.0 / libm::sqrt(variance)),
        })
    }

    /// A random course: Q and its eigenvalues, with the mean and the slope of Q by the variance of the course.
    fn random(
        &self,
        change: ParameterChange,
        q: f64,
        form: &Nodes,
        mean: f64,
        slope: f64,
    ) -> Option<ConstancyFinding> {
        let weights = SymmetricEigen::new(*form).eigenvalues;
        let p = probability_above(weights.as_slice(), q);
        let size = libm::sqrt(((q - mean) / slope).max(0.0));
        size.is_finite().then(|| ConstancyFinding {
            parameter: self.state - PARAMETERS,
            change,
            between_s: (self.time_s(0), self.end_s()),
            sigmas: -normal::quantile(0.5 * p.max(1e-300)),
            size,
            size_sigma: None,
        })
    }
}

/// Runs all tests and calls `found` with the result of each.
pub fn test(smoothed: &SmoothedCalibration, prior: &Row, mut found: impl FnMut(ConstancyFinding)) {
    for parameter in 0..PARAMETER_COUNT {
        test_parameter(smoothed, prior, parameter, &mut found);
    }
}

/// Runs the tests of one parameter.
pub fn test_parameter(
    smoothed: &SmoothedCalibration,
    prior: &Row,
    parameter: usize,
    found: &mut impl FnMut(ConstancyFinding),
) {
    let state = PARAMETERS + parameter;
    let known =
        |node: &Smoothed| node.node.covariance[state][state] <= KNOWN * prior[state] * prior[state];
    let Some(first) = smoothed.nodes.iter().position(known) else { return };
    let n = smoothed.nodes.len() - first;
    if prior[state] == 0.0 || n > NODES_MAX {
        return;
    }
    let covariance = Nodes::from_fn(|j, l| {
        if j < n && l < n { smoothed.covariance(state, first + j, first + l) } else { 0.0 }
    });
    let tested = Tested { nodes: &smoothed.nodes, state, first, covariance };
    courses(&tested, found);
    walk(&tested).map(&mut *found);
    let whole_s = tested.end_s();
    for share in CORRELATION_TIMES {
        wander(&tested, share * whole_s).map(&mut *found);
    }
}

/// Jumps, pulses and ramps between all pairs of nodes.
fn courses(tested: &Tested<'_>, found: &mut impl FnMut(ConstancyFinding)) {
    let (n, c) = (tested.len(), &tested.covariance);
    for j in 0..n {
        let jump = tested.course(ParameterChange::Jump, (j, n), tested.adjoint(j), c[(j, j)]);
        jump.map(&mut *found);
        // The ramp changes at j, j + 1, … l − 1.
        let (mut sum, mut variance) = (tested.adjoint(j), c[(j, j)]);
        for l in j + 1..n {
            let back = tested.adjoint(j) - tested.adjoint(l);
            let of_back = c[(j, j)] + c[(l, l)] - 2.0 * c[(j, l)];
            tested.course(ParameterChange::Pulse, (j, l), back, of_back).map(&mut *found);
            if l > j + 1 {
                let steps = (l - j) as f64;
                let mean = (sum / steps, variance / (steps * steps));
                tested.course(ParameterChange::Ramp, (j, l), mean.0, mean.1).map(&mut *found);
            }
            variance += c[(l, l)] + 2.0 * (j..l).map(|m| c[(m, l)]).sum::<f64>();
            sum += tested.adjoint(l);
        }
    }
}

/// Random walk: a change at each node, with a variance as the time to the next.
fn walk(tested: &Tested<'_>) -> Option<ConstancyFinding> {
    let n = tested.len();
    if n < 2 {
        return None;
    }
    let spacing_s = (tested.end_s() - tested.time_s(0)) / (n - 1) as f64;
    let q: f64 = (0..n).map(|j| tested.adjoint(j) * tested.adjoint(j)).sum();
    let c = &tested.covariance;
    tested.random(ParameterChange::Walk, q, c, c.trace(), spacing_s * c.norm_squared())
}

/// Gauss-Markov process: a level between each two nodes.
fn wander(tested: &Tested<'_>, correlation_time_s: f64) -> Option<ConstancyFinding> {
    let n = tested.len();
    if n < 2 {
        return None;
    }
    // A level between two nodes is a change up at the first and one down at the second.
    let differences = Nodes::from_fn(|i, j| {
        let inside = i < n && j < n;
        f64::from(i8::from(inside && i == j) - i8::from(inside && j == i + 1))
    });
    let kernel = Nodes::from_fn(|i, j| {
        if i >= n || j >= n {
            return f64::from(u8::from(i == j));
        }
        let apart_s = (tested.time_s(i) - tested.time_s(j)).abs();
        libm::exp(-apart_s / correlation_time_s)
    });
    let root = kernel.cholesky()?.l();
    let adjoint =
        SMatrix::<f64, NODES_MAX, 1>::from_fn(|j, _| if j < n { tested.adjoint(j) } else { 0.0 });
    let shaped = root.transpose() * differences;
    let q = (shaped * adjoint).norm_squared();
    let form = shaped * tested.covariance * shaped.transpose();
    let form = 0.5 * (form + form.transpose());
    tested.random(
        ParameterChange::Wander { correlation_time_s },
        q,
        &form,
        form.trace(),
        form.norm_squared(),
    )
}
