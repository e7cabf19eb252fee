//! Second-order model of one axis of a ship's sway, exact over any interval, and its estimate from
//! velocities.
//!
//! `s̈ + 2 ζ ω ṡ + ω² s = w` with white `w` of such a power that s has the standard deviation σ
//! (Gelb, *Applied Optimal Estimation*, 1974, section 2.2; Triantafyllou, Bodson and Athans, 1983,
//! for ships). A damping ζ near zero is a swell that keeps its phase.

use core::f64::consts::PI;

/// Periods of a sway, s: what the estimate accepts.
const PERIODS_S: (f64, f64) = (2.5, 60.0);
/// Dampings of the model.
const DAMPINGS: (f64, f64) = (1e-9, 0.7);
/// Smallest standard deviation, m.
const SIGMA_MIN_M: f64 = 1e-3;

/// One axis of the sway.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Oscillator {
    /// Undamped angular frequency, rad/s.
    pub(super) omega_radps: f64,
    /// Damping ζ, below 1.
    pub(super) damping: f64,
    /// Standard deviation of the displacement, m.
    pub(super) sigma_m: f64,
}

/// Rows of a matrix over displacement and velocity.
pub(super) type OfPair = [[f64; 2]; 2];

impl Oscillator {
    /// The model before anything is known: any period from 5 to 20 s, a metre.
    pub(super) const fn unknown() -> Self {
        Self { omega_radps: 2.0 * PI / 9.0, damping: 0.3, sigma_m: 1.0 }
    }

    /// Covariance of displacement and velocity in the long run; the two don't correlate.
    pub(super) fn stationary(&self) -> [f64; 2] {
        let variance = self.sigma_m * self.sigma_m;
        [variance, self.omega_radps * self.omega_radps * variance]
    }

    /// Transition of displacement and velocity over `elapsed_s`.
    pub(super) fn transition(&self, elapsed_s: f64) -> OfPair {
        let decay = self.damping * self.omega_radps;
        let turning = self.omega_radps * libm::sqrt(1.0 - self.damping * self.damping);
        let (sin, cos) = libm::sincos(turning * elapsed_s);
        let left = libm::exp(-decay * elapsed_s);
        let s = sin / turning;
        [
            [left * (cos + decay * s), left * s],
            [-left * self.omega_radps * self.omega_radps * s, left * (cos - decay * s)],
        ]
    }

    /// Covariance that the driving noise adds in an interval with this transition: what keeps the
    /// long run as it is.
    pub(super) fn noise(&self, transition: &OfPair) -> OfPair {
        let far = self.stationary();
        let t = transition;
        let kept = |i: usize, j: usize| t[i][0] * far[0] * t[j][0] + t[i][1] * far[1] * t[j][1];
        let cross = -kept(0, 1);
        [[(far[0] - kept(0, 0)).max(0.0), cross], [cross, (far[1] - kept(1, 1)).max(0.0)]]
    }

    /// Changes the damping by the factor `exp(exponent)`, within the limits of the model.
    pub(super) fn damp(&mut self, exponent: f64) {
        self.damping = (self.damping * libm::exp(exponent)).clamp(DAMPINGS.0, DAMPINGS.1);
    }
}

/// Sums over equally spaced velocities v₀, v₁, … for the recursion `v_k = a v_{k−1} + b v_{k−2}` that
/// an oscillator obeys but for noise.
///
/// The equations are multiplied by v_{k−3} and v_{k−4} (instruments; Söderström and Stoica, *System
/// Identification*, 1989, chapter 8), which neither the noise of a velocity nor that of the sea within
/// the last two intervals correlates with. Least squares would find a damping where there is none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Recursion {
    before: [f64; 4],
    known: u8,
    count: u32,
    square: f64,
    matrix: [[f64; 2]; 2],
    right: [f64; 2],
}

impl Recursion {
    /// Takes the next velocity, m/s.
    pub(super) fn take(&mut self, velocity_mps: f64) {
        let [v1, v2, v3, v4] = self.before;
        if self.known == 4 {
            for (row, instrument) in [v3, v4].into_iter().enumerate() {
                self.matrix[row][0] += instrument * v1;
                self.matrix[row][1] += instrument * v2;
                self.right[row] += instrument * velocity_mps;
            }
            self.square += velocity_mps * velocity_mps;
            self.count += 1;
        } else {
            self.known += 1;
        }
        self.before = [velocity_mps, v1, v2, v3];
    }

    /// Forgets the velocities, after a time without any.
    pub(super) fn interrupt(&mut self) {
        self.known = 0;
    }

    pub(super) fn count(&self) -> u32 {
        self.count
    }

    /// Oscillator with these velocities; where they are those of none, `otherwise` with their
    /// size.
    pub(super) fn solve(&self, spacing_s: f64, otherwise: &Oscillator) -> Oscillator {
        let velocity_mps = libm::sqrt(self.square / f64::from(self.count.max(1)));
        let sized = |omega_radps: f64, damping: f64| Oscillator {
            omega_radps,
            damping: damping.clamp(DAMPINGS.0, DAMPINGS.1),
            sigma_m: (velocity_mps / omega_radps).max(SIGMA_MIN_M),
        };
        let found = self.roots(spacing_s).map(|(decay, turning)| {
            let omega = libm::sqrt(decay * decay + turning * turning);
            (omega, decay / omega)
        });
        match found {
            Some((omega, damping))
                if omega >= 2.0 * PI / PERIODS_S.1
                    && omega <= (2.0 * PI / PERIODS_S.0).min(PI / spacing_s) =>
            {
                sized(omega, damping)
            }
            _ => sized(otherwise.omega_radps, otherwise.damping),
        }
    }

    /// Decay and angular frequency, 1/s; the decay of noise alone can be negative and counts as none.
    fn roots(&self, spacing_s: f64) -> Option<(f64, f64)> {
        let [[p, q], [r, s]] = self.matrix;
        let determinant = p * s - q * r;
        let a = (self.right[0] * s - q * self.right[1]) / determinant;
        let b = (p * self.right[1] - r * self.right[0]) / determinant;
        // The roots of z² − a z − b are ρ exp(±i θ).
        let rho = libm::sqrt(-b);
        let cos = a / (2.0 * rho);
        (cos > -1.0 && cos < 1.0).then(|| {
            let decay = -libm::log(rho) / spacing_s;
            (decay.max(0.0), libm::acos(cos) / spacing_s)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEA: Oscillator = Oscillator { omega_radps: 0.7, damping: 0.1, sigma_m: 0.4 };

    fn product(a: &OfPair, b: &OfPair) -> OfPair {
        [0, 1].map(|i| [0, 1].map(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j]))
    }

    /// Φ' = F Φ by a fine Runge-Kutta integration.
    #[test]
    fn the_transition_solves_the_equation() {
        let f = |s: [f64; 2]| {
            let w = SEA.omega_radps;
            [s[1], -w * w * s[0] - 2.0 * SEA.damping * w * s[1]]
        };
        let found = SEA.transition(3.0);
        for (column, start) in [[1.0, 0.0], [0.0, 1.0]].into_iter().enumerate() {
            let (mut s, h) = (start, 1e-3);
            for _ in 0..3000 {
                let along = |k: [f64; 2], by: f64| [s[0] + by * k[0], s[1] + by * k[1]];
                let k1 = f(s);
                let k2 = f(along(k1, 0.5 * h));
                let k3 = f(along(k2, 0.5 * h));
                let k4 = f(along(k3, h));
                for i in 0..2 {
                    s[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
                }
            }
            assert!((found[0][column] - s[0]).abs() < 1e-11);
            assert!((found[1][column] - s[1]).abs() < 1e-11);
        }
    }

    /// The integral ∫ Φ(t) [0 0; 0 q] Φ(t)ᵀ dt with q = 4 ζ ω³ σ², by Simpson's rule.
    #[test]
    fn the_noise_is_the_integral_over_the_interval() {
        let (length, steps) = (2.0, 2000);
        let q = 4.0 * SEA.damping * SEA.omega_radps.powi(3) * SEA.sigma_m * SEA.sigma_m;
        let h = length / f64::from(steps);
        let mut sum = [[0.0; 2]; 2];
        for k in 0..=steps {
            let t = SEA.transition(f64::from(k) * h);
            let weight = match k {
                0 => 1.0,
                k if k == steps => 1.0,
                k if k % 2 == 1 => 4.0,
                _ => 2.0,
            };
            for i in 0..2 {
                for j in 0..2 {
                    sum[i][j] += weight * h / 3.0 * q * t[i][1] * t[j][1];
                }
            }
        }
        let found = SEA.noise(&SEA.transition(length));
        for i in 0..2 {
            for j in 0..2 {
                assert!((found[i][j] - sum[i][j]).abs() < 1e-10, "{found:?} {sum:?}");
            }
        }
        // Two intervals are one of twice the length.
        let one = SEA.transition(0.5 * length);
        let twice = product(&one, &one);
        let whole = SEA.transition(length);
        assert!((0..2).all(|i| (0..2).all(|j| (twice[i][j] - whole[i][j]).abs() < 1e-14)));
    }

    #[test]
    fn a_swell_is_found_without_damping() {
        let omega = 2.0 * PI / 11.3;
        let mut recursion = Recursion::default();
        for k in 0..256 {
            recursion.take(0.5 * libm::cos(omega * f64::from(k) + 0.3));
        }
        let found = recursion.solve(1.0, &Oscillator::unknown());
        assert!((found.omega_radps - omega).abs() < 1e-9, "{found:?}");
        assert!(found.damping <= 1e-9, "{found:?}");
        let sigma = 0.5 / libm::sqrt(2.0) / omega;
        assert!((found.sigma_m / sigma - 1.0).abs() < 0.01, "{found:?} {sigma}");
    }

    /// A sea made by the model itself, from the hashed bits of a counter.
    #[test]
    fn a_sea_is_found_with_its_damping() {
        let (t, q) = (SEA.transition(1.0), SEA.noise(&SEA.transition(1.0)));
        let (l00, l10) = (libm::sqrt(q[0][0]), q[0][1] / libm::sqrt(q[0][0]));
        let l11 = libm::sqrt(q[1][1] - l10 * l10);
        let mut bits = 1u64;
        let mut normal = || {
            // The sum of twelve uniform numbers, less 6: variance one.
            (0..12).fold(-6.0, |sum, _| {
                bits = bits
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                sum + (bits >> 11) as f64 / (1u64 << 53) as f64
            })
        };
        let (mut state, mut recursion) = ([0.0, 0.0], Recursion::default());
        for _ in 0..20_000 {
            let (a, b) = (normal(), normal());
            state = [
                t[0][0] * state[0] + t[0][1] * state[1] + l00 * a,
                t[1][0] * state[0] + t[1][1] * state[1] + l10 * a + l11 * b,
            ];
            recursion.take(state[1]);
        }
        let found = recursion.solve(1.0, &Oscillator::unknown());
        // Five standard deviations of these estimates over 20 000 s.
        assert!((found.omega_radps / SEA.omega_radps - 1.0).abs() < 0.03, "{found:?}");
        assert!((found.damping / SEA.damping - 1.0).abs() < 0.2, "{found:?}");
        assert!((found.sigma_m / SEA.sigma_m - 1.0).abs() < 0.08, "{found:?}");
    }

    #[test]
    fn velocities_of_no_oscillator_keep_the_period_and_give_the_size() {
        let mut recursion = Recursion::default();
        for k in 0..200 {
            recursion.take(if k % 2 == 0 { 1e-3 } else { -1e-3 });
        }
        let found = recursion.solve(1.0, &SEA);
        assert_eq!((found.omega_radps, found.damping), (SEA.omega_radps, SEA.damping));
        assert!((found.sigma_m - 1e-3 / 0.7).abs() < 1e-6, "{found:?}");
        recursion.interrupt();
        recursion.take(f64::from(3));
        assert_eq!(recursion.count(), 196);
    }
}
