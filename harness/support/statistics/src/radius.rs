//! Distance of a two-dimensional normal error from the origin.

/// Number of halvings of an interval: more than the bits of a double.
const HALVINGS: u32 = 60;
/// Number of intervals of Simpson's rule.
const PANELS: u32 = 512;

/// A normal error in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Mean.
    pub mean: [f64; 2],
    /// Variances of the two components.
    pub variances: [f64; 2],
    /// Covariance of the two components.
    pub covariance: f64,
}

/// The same error along the axes of its ellipse: mean and σ, the larger σ first.
struct Axes {
    mean: [f64; 2],
    sigma: [f64; 2],
}

impl Plane {
    fn axes(&self) -> Axes {
        let [a, b] = self.variances;
        let (half, difference) = (0.5 * (a + b), 0.5 * (a - b));
        let root = libm::hypot(difference, self.covariance);
        let turn = 0.5 * libm::atan2(self.covariance, difference);
        let (s, c) = (libm::sin(turn), libm::cos(turn));
        let [x, y] = self.mean;
        Axes {
            mean: [c * x + s * y, c * y - s * x],
            sigma: [libm::sqrt((half + root).max(0.0)), libm::sqrt((half - root).max(0.0))],
        }
    }

    /// P(the distance is at most `radius`).
    #[must_use]
    pub fn within(&self, radius: f64) -> f64 {
        self.axes().within(radius)
    }

    /// Distance that a fraction `p` (0 to 1) of all errors doesn't exceed; NaN for invalid variances.
    #[must_use]
    pub fn quantile(&self, p: f64) -> f64 {
        let axes = self.axes();
        let extent = libm::hypot(axes.mean[0], axes.mean[1]);
        let sigma = axes.sigma[0];
        if !(extent + sigma).is_finite() || !(0.0..1.0).contains(&p) {
            return f64::NAN;
        }
        if sigma == 0.0 {
            return extent;
        }
        // Less than 1e-16 of a normal distribution is farther out.
        let (mut low, mut high) = (0.0, extent + 9.0 * sigma);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if axes.within(middle) < p { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }
}

impl Axes {
    fn within(&self, radius: f64) -> f64 {
        let ([m, n], [s, t]) = (self.mean, self.sigma);
        if !(radius > 0.0) {
            return 0.0;
        }
        if s == 0.0 {
            return if libm::hypot(m, n) <= radius { 1.0 } else { 0.0 };
        }
        // P(|y| <= h) of the minor axis.
        let minor = |h: f64| {
            if t == 0.0 {
                return if n.abs() <= h { 1.0 } else { 0.0 };
            }
            let part = |x: f64| 0.5 * libm::erf(x / (t * core::f64::consts::SQRT_2));
            part(h - n) + part(h + n)
        };
        // Integral along the major axis, within the circle and within 9 σ: x = centre + half sin u
        // removes the square root at the ends.
        let (from, to) = ((-radius).max(m - 9.0 * s), radius.min(m + 9.0 * s));
        if from >= to {
            return 0.0;
        }
        let (centre, half) = (0.5 * (from + to), 0.5 * (to - from));
        let at = |u: f64| {
            let x = centre + half * libm::sin(u);
            let z = (x - m) / s;
            let density = libm::exp(-0.5 * z * z) / (s * libm::sqrt(2.0 * core::f64::consts::PI));
            let h = libm::sqrt((radius * radius - x * x).max(0.0));
            density * minor(h) * half * libm::cos(u)
        };
        let quarter = 0.5 * core::f64::consts::PI;
        let step = 2.0 * quarter / f64::from(PANELS);
        let inner: f64 = (1..PANELS)
            .map(|k| if k % 2 == 1 { 4.0 } else { 2.0 } * at(-quarter + f64::from(k) * step))
            .sum();
        (step / 3.0 * (at(-quarter) + inner + at(quarter))).min(1.0)
    }
}
