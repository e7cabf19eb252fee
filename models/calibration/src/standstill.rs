//! What an average over the last standstill can be trusted with, and whether it fits the latitude.
//!
//! Least squares takes the attitude at its end from the compensated means of specific force `f` and rate `ω` over the
//! last standstill ([`crate::alignment`]). Their errors `∇` and `ε`, in n, give to first order
//!
//! `φ_north = ∇_east/g`, `φ_east = −∇_north/g`, `φ_down = ε_east/(Ω cos L) − φ_north tan L`.
//!
//! `∇` and `ε` are white noise over the time of the average, and what the adjustment leaves of the parameters. Both
//! depend on each other: the noise of this standstill is in the parameters too, so that compensation removes a part of
//! it. The adjustment knows that covariance ([`AverageUncertainty`]).
//!
//! An error along east is one of the heading, and shows nowhere in an average. The others show: north in the horizontal
//! rate, which is `Ω cos L`, down in the vertical one, `−Ω sin L`. A base that turns about a horizontal axis, east too,
//! turns the specific force: its slope over the standstill is zero on a base at rest. And the attitude has to be that
//! which the moves carry on from the intervals before: of a better estimate from the same data, with the covariance `P`,
//! an attitude with the covariance `A` differs by `A − P`.
//!
//! What is accepted is widened by residuals above their noise, as σ is, but not by those of the last attitude itself.

use crate::inertial_alignment::{FORCE_SHARE, HEADING_SIGMA_MAX_RAD, RATE_SIGMAS, dph};
use nalgebra::{Matrix3, Matrix6, SMatrix, UnitQuaternion, Vector3};
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::frames::phi_of;

/// Smallest share of an attitude's variance by which it can differ from the joint one.
const DISTINCT: f64 = 1e-3;

/// Compensated means over a standstill, in b.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StandstillAverage {
    /// Specific force, m/s².
    pub force_mps2: Vector3<f64>,
    /// Its slope, m/s³.
    pub slope_mps3: Vector3<f64>,
    /// Rate, rad/s.
    pub rate_radps: Vector3<f64>,
    /// Time averaged, s.
    pub elapsed_s: f64,
}

/// Attitude of the last interval by the whole adjustment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointAttitude {
    /// Attitude.
    pub q_nb: UnitQuaternion<f64>,
    /// Covariance of its error, a rotation vector in b, rad².
    pub covariance: Matrix3<f64>,
}

/// Uncertainty of compensated means over the last standstill of an adjustment, as long as its residuals are their noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AverageUncertainty {
    /// Covariance of force (m/s²) and rate (rad/s) in b by the parameters, less what compensation removes of the
    /// standstill's own noise.
    pub parameters: Matrix6<f64>,
    /// White noise of the specific force, variance times duration, (m/s²)²·s.
    pub force_noise: Vector3<f64>,
    /// White noise of the rate, rad²/s.
    pub rate_noise: Vector3<f64>,
    /// Attitude by all intervals and moves; `None` without Earth rate.
    pub joint: Option<JointAttitude>,
    /// Sum of the squared residuals in units of their noise, and its degrees of freedom.
    pub residuals: (f64, usize),
}

impl AverageUncertainty {
    /// Covariance of force and rate over a time.
    fn over(&self, elapsed_s: f64) -> Matrix6<f64> {
        let mut covariance = self.parameters;
        for axis in 0..3 {
            covariance[(axis, axis)] += self.force_noise[axis] / elapsed_s;
            covariance[(3 + axis, 3 + axis)] += self.rate_noise[axis] / elapsed_s;
        }
        covariance
    }

    /// Factor by which residuals widen variances, without a share of them, `squares` of as many degrees of freedom.
    fn widening(&self, squares: f64, freedom: usize) -> f64 {
        match self.residuals.1.checked_sub(freedom) {
            None | Some(0) => 1.0,
            Some(left) => ((self.residuals.0 - squares) / left as f64).max(1.0),
        }
    }
}

/// Reason why the attitude of an average can't be trusted.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub enum StandstillRefusal {
    /// The specific force isn't that of gravity.
    #[error(
        "the specific force of the last standstill is {found:.4} m/s², and gravity at the site is {expected:.4} m/s²: \
         expected the same within 1 %"
    )]
    Force {
        /// Specific force, m/s².
        found: f64,
        /// Gravity at the site, m/s².
        expected: f64,
    },
    /// The base turned about a horizontal axis.
    #[error(
        "the specific force turned by {:.4} deg/h during the last standstill, expected 0 ± {:.4} deg/h: the base \
         turned, or the accelerometers drifted",
        dph(*found), dph(RATE_SIGMAS * sigma)
    )]
    Turning {
        /// Rate at which the specific force turned, rad/s.
        found: f64,
        /// Its standard deviation, together with that of the rate that finds north, rad/s.
        sigma: f64,
    },
    /// The horizontal rate isn't that of the Earth.
    #[error(
        "the horizontal rate of the last standstill is {:.4} deg/h, expected {:.4} ± {:.4} deg/h at this latitude: the \
         base turned, or the gyros changed",
        dph(*found), dph(*expected), dph(RATE_SIGMAS * sigma)
    )]
    Horizontal {
        /// Horizontal rate found, rad/s.
        found: f64,
        /// Horizontal rate of the Earth, rad/s.
        expected: f64,
        /// Its standard deviation, rad/s.
        sigma: f64,
    },
    /// The vertical rate isn't that of the Earth.
    #[error(
        "the rate about down of the last standstill is {:.4} deg/h, expected {:.4} ± {:.4} deg/h at this latitude: the \
         base turned, or the gyros changed",
        dph(*found), dph(*expected), dph(RATE_SIGMAS * sigma)
    )]
    Vertical {
        /// Rate about down found, rad/s.
        found: f64,
        /// Rate of the Earth about down, rad/s.
        expected: f64,
        /// Its standard deviation, rad/s.
        sigma: f64,
    },
    /// The attitude isn't that of the intervals and moves before.
    #[error(
        "the attitude of the last standstill is {:.2} arcmin about {} from that which the moves carry on from the standstills \
         before, expected 0 ± {:.2} arcmin: the base turned, or the sensors changed",
        found_rad.to_degrees() * 60.0, AXES[*axis % 3], RATE_SIGMAS * sigma_rad.to_degrees() * 60.0
    )]
    Attitude {
        /// Axis of n: 0 north, 1 east, 2 down.
        axis: usize,
        /// Difference about it, rad.
        found_rad: f64,
        /// Its standard deviation, rad.
        sigma_rad: f64,
    },
    /// North can't be found well enough.
    #[error(
        "the last standstill of {duration_s} s finds north with a standard deviation of {:.1} deg only, at most 1 deg is \
         accepted: stand longer at the end",
        sigma_rad.to_degrees()
    )]
    Heading {
        /// Time of the standstill, s.
        duration_s: f64,
        /// Standard deviation of the heading, rad.
        sigma_rad: f64,
    },
}

const AXES: [&str; 3] = ["north", "east", "down"];

impl StandstillAverage {
    /// Covariance of φ in n (north, east, down), rad², of the attitude `q_nb` of this average.
    ///
    /// # Errors
    /// If the average doesn't fit a base at rest at this latitude, or can't tell where north is.
    pub fn phi(
        &self,
        q_nb: &UnitQuaternion<f64>,
        uncertainty: &AverageUncertainty,
        earth: &Ellipsoid,
    ) -> Result<Matrix3<f64>, StandstillRefusal> {
        let (gravity, rate) = (earth.gravity_mps2, earth.earth_rate());
        let found = self.force_mps2.norm();
        if !((found / gravity - 1.0).abs() <= FORCE_SHARE) {
            return Err(StandstillRefusal::Force { found, expected: gravity });
        }
        let c_nb = q_nb.to_rotation_matrix().into_inner();
        let both = {
            let mut both = Matrix6::zeros();
            both.fixed_view_mut::<3, 3>(0, 0).copy_from(&c_nb);
            both.fixed_view_mut::<3, 3>(3, 3).copy_from(&c_nb);
            both
        };
        let in_n = both * uncertainty.over(self.elapsed_s) * both.transpose();

        // Rows: φ north, east, down; horizontal rate; rate about down; rate along east. Columns: ∇, ε.
        let tangent = -rate.z / rate.x;
        let mut of = SMatrix::<f64, 6, 6>::zeros();
        of[(0, 1)] = 1.0 / gravity;
        of[(1, 0)] = -1.0 / gravity;
        of[(2, 1)] = -tangent / gravity;
        of[(2, 4)] = 1.0 / rate.x;
        of[(3, 3)] = 1.0;
        of[(3, 0)] = rate.z / gravity;
        of[(4, 5)] = 1.0;
        of[(4, 0)] = -rate.x / gravity;
        of[(5, 4)] = 1.0;
        let covariance = of * in_n * of.transpose();
        let phi = covariance.fixed_view::<3, 3>(0, 0).into_owned();
        let apart = uncertainty.joint.map(|joint| {
            let apart = phi_of(q_nb, &joint.q_nb);
            // Of the two nothing else is different, so that rounding must not leave a variance below zero.
            let left = phi - c_nb * joint.covariance * c_nb.transpose();
            (apart, Vector3::from_fn(|i, _| left[(i, i)].max(DISTINCT * phi[(i, i)])))
        });
        let squares = apart.map_or(0.0, |(apart, variance)| {
            apart.component_mul(&apart).component_div(&variance).sum()
        });
        let widening = uncertainty.widening(squares, if apart.is_some() { 3 } else { 0 });
        let sigma = |index: usize| libm::sqrt(widening * covariance[(index, index)]);

        let published = phi * uncertainty.widening(0.0, 0);
        let sigma_rad = libm::sqrt(published[(2, 2)]);
        if !(sigma_rad <= HEADING_SIGMA_MAX_RAD) {
            let duration_s = libm::round(self.elapsed_s);
            return Err(StandstillRefusal::Heading { duration_s, sigma_rad });
        }
        let down = -self.force_mps2 / found;
        let turning = self.slope_mps3 - down * down.dot(&self.slope_mps3);
        // A straight line over T has the slope's variance 12 q / T³.
        let noise = uncertainty.force_noise.max();
        let line = widening * 12.0 * noise / (self.elapsed_s * self.elapsed_s * self.elapsed_s);
        let (turned, wander) = (turning.norm() / gravity, libm::sqrt(line) / gravity);
        let turned_sigma = libm::hypot(wander, sigma(5));
        if !(turned <= RATE_SIGMAS * turned_sigma) {
            return Err(StandstillRefusal::Turning { found: turned, sigma: turned_sigma });
        }
        let found = down.cross(&self.rate_radps).norm();
        if !((found - rate.x).abs() <= RATE_SIGMAS * sigma(3)) {
            return Err(StandstillRefusal::Horizontal { found, expected: rate.x, sigma: sigma(3) });
        }
        let found = down.dot(&self.rate_radps);
        if !((found - rate.z).abs() <= RATE_SIGMAS * sigma(4)) {
            return Err(StandstillRefusal::Vertical { found, expected: rate.z, sigma: sigma(4) });
        }
        if let Some((apart, variance)) = apart {
            for axis in 0..3 {
                let sigma_rad = libm::sqrt(widening * variance[axis]);
                if !(apart[axis].abs() <= RATE_SIGMAS * sigma_rad) {
                    let found_rad = apart[axis];
                    return Err(StandstillRefusal::Attitude { axis, found_rad, sigma_rad });
                }
            }
        }
        Ok(published)
    }
}
