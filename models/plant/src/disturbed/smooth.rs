//! Smooth rises and bumps: no jump in value, first and second derivative.

/// A value with its first and second derivative.
pub(super) type Jet = [f64; 3];

/// `10 u³ − 15 u⁴ + 6 u⁵` from 0 to 1, constant outside; derivatives by u.
pub(super) fn rise(u: f64) -> Jet {
    if u >= 1.0 {
        [1.0, 0.0, 0.0]
    } else if u > 0.0 {
        let v = 1.0 - u;
        [
            u * u * u * (10.0 - u * (15.0 - 6.0 * u)),
            30.0 * u * u * v * v,
            60.0 * u * v * (1.0 - 2.0 * u),
        ]
    } else {
        [0.0; 3]
    }
}

/// `64 u³ (1 − u)³`: from 0 to 1 at the middle and back to 0; derivatives by u.
pub(super) fn bump(u: f64) -> Jet {
    if u > 0.0 && u < 1.0 {
        let p = u * (1.0 - u);
        let slope = 1.0 - 2.0 * u;
        [64.0 * p * p * p, 192.0 * p * p * slope, 384.0 * p * (slope * slope - p)]
    } else {
        [0.0; 3]
    }
}

/// The derivatives by time of a jet by `u = t / length_s`.
pub(super) fn over(jet: Jet, length_s: f64) -> Jet {
    [jet[0], jet[1] / length_s, jet[2] / (length_s * length_s)]
}

pub(super) fn product(a: Jet, b: Jet) -> Jet {
    [a[0] * b[0], a[1] * b[0] + a[0] * b[1], a[2] * b[0] + 2.0 * a[1] * b[1] + a[0] * b[2]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_agree_with_differences_and_ends_are_flat() {
        let h = 1e-5;
        for shape in [rise, bump] {
            for k in 1..100 {
                let u = f64::from(k) * 0.01;
                let (before, now, after) = (shape(u - h), shape(u), shape(u + h));
                assert!(((after[0] - before[0]) / (2.0 * h) - now[1]).abs() < 1e-7, "{u}");
                assert!(((after[1] - before[1]) / (2.0 * h) - now[2]).abs() < 1e-6, "{u}");
            }
            for u in [-1.0, 0.0, 1.0, 2.0, f64::NAN] {
                let [_, first, second] = shape(u);
                assert_eq!([first, second], [0.0; 2]);
            }
        }
        assert_eq!([rise(0.5)[0], bump(0.5)[0]], [0.5, 1.0]);
    }
}
