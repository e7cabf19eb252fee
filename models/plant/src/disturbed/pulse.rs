//! Motions that happen once: shock of the block, excursion of the case.

use super::motion::Motion;
use super::smooth::{bump, over};
use super::span::Span;
use nalgebra::Vector3;

/// A half-sine pulse of acceleration `A sin(π t / T)`, after which mounts bring the block back.
///
/// At the end of the pulse the block moves with `2 A T / π` at a distance of `A T² / π`; a
/// polynomial of fifth degree brings it from there to rest at the origin, without acceleration at
/// either end.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct Shock {
    pub(super) span: Span,
    pub(super) peak: Vector3<f64>,
    pub(super) width_s: f64,
    pub(super) recoil_s: f64,
}

impl Shock {
    pub(super) fn is_over(&self, now_ns: u64) -> bool {
        self.span.since_s(now_ns, 0.0) >= self.width_s + self.recoil_s
    }

    pub(super) fn piece_s(&self) -> f64 {
        self.width_s.min(self.recoil_s) / 16.0
    }

    pub(super) fn knots(&self, start_ns: u64, cuts: &mut Vec<f64>) {
        let onset = -self.span.since_s(start_ns, 0.0);
        cuts.extend([onset, onset + self.width_s, onset + self.width_s + self.recoil_s]);
    }

    pub(super) fn motion(&self, start_ns: u64, at_s: f64) -> Motion {
        let t = self.span.since_s(start_ns, at_s);
        let (width, recoil) = (self.width_s, self.recoil_s);
        let pi = core::f64::consts::PI;
        let [r, rate, acceleration] = if t <= 0.0 {
            [0.0; 3]
        } else if t < width {
            let (s, c) = libm::sincos(pi * t / width);
            [width / pi * (t - width / pi * s), width / pi * (1.0 - c), s]
        } else {
            let u = (t - width) / recoil;
            if u >= 1.0 {
                return Motion::default();
            }
            let (r0, v0) = (width * width / pi, 2.0 * width / pi);
            let v = 1.0 - u;
            [
                r0 * (v * v * v * (1.0 + u * (3.0 + 6.0 * u)))
                    + v0 * recoil * (u * v * v * v * (1.0 + 3.0 * u)),
                r0 / recoil * (-30.0 * u * u * v * v) + v0 * (v * v * (1.0 + u * (2.0 - 15.0 * u))),
                r0 / (recoil * recoil) * (-60.0 * u * v * (1.0 - 2.0 * u))
                    + v0 / recoil * (u * v * (-36.0 + 60.0 * u)),
            ]
        };
        Motion {
            displacement: [self.peak * r, self.peak * rate, self.peak * acceleration],
            turn: [Vector3::zeros(); 3],
        }
    }
}

/// One excursion of the case, out and back.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct Excursion {
    pub(super) span: Span,
    pub(super) displacement: Vector3<f64>,
    pub(super) turn: Vector3<f64>,
    pub(super) length_s: f64,
}

impl Excursion {
    pub(super) fn is_over(&self, now_ns: u64) -> bool {
        self.span.since_s(now_ns, 0.0) >= self.length_s
    }

    pub(super) fn piece_s(&self) -> f64 {
        self.length_s / 32.0
    }

    pub(super) fn knots(&self, start_ns: u64, cuts: &mut Vec<f64>) {
        let onset = -self.span.since_s(start_ns, 0.0);
        cuts.extend([onset, onset + self.length_s]);
    }

    pub(super) fn motion(&self, start_ns: u64, at_s: f64) -> Motion {
        let t = self.span.since_s(start_ns, at_s);
        let jet = over(bump(t / self.length_s), self.length_s);
        Motion {
            displacement: jet.map(|x| self.displacement * x),
            turn: jet.map(|x| self.turn * x),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that velocity and acceleration are the derivatives of the displacement, also over the
    /// joint, and that pulse and recoil cancel.
    #[test]
    fn a_shock_is_one_motion() {
        let shock = Shock {
            span: Span::from(0, 0),
            peak: Vector3::new(50.0, 0.0, 0.0),
            width_s: 0.011,
            recoil_s: 0.2,
        };
        let h = 1e-6;
        for k in 1..2150 {
            let t = f64::from(k) * 1e-4 + 3e-5;
            let at = |t: f64| shock.motion(0, t).displacement.map(|x| x.x);
            let (before, now, after) = (at(t - h), at(t), at(t + h));
            let slope = |order: usize| (after[order] - before[order]) / (2.0 * h);
            assert!((slope(0) - now[1]).abs() < 1e-7, "{t}");
            assert!((slope(1) - now[2]).abs() < 1e-4, "{t} {} {}", slope(1), now[2]);
        }
        let end = shock.motion(0, 0.011).displacement[1].x;
        assert!((end - 2.0 * 50.0 * 0.011 / core::f64::consts::PI).abs() < 1e-15);
        assert_eq!(shock.motion(0, 0.2111), Motion::default());
        assert!(shock.is_over(211_000_000) && !shock.is_over(210_000_000));
    }
}
