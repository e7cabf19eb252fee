//! Errors against the information of the samples.

use nalgebra::{Cholesky, Matrix4, Vector4};
use octant_sample::Parameters;
use octant_sample::parameters::NAMES;
use octant_score::information::{Estimated, SampleInformation, TOO_GOOD, against_bound};

const G: f64 = 9.8;
const VRW: f64 = 4.9e-4;

/// A second in each of the positions, 200 times: each axis up and down, and two of them tilted.
fn information() -> SampleInformation {
    let mut information = SampleInformation::default();
    for _ in 0..200 {
        for down in positions() {
            information.take(1.0, [0.0; 3], down.map(|part| -G * part));
        }
    }
    information
}

fn positions() -> [[f64; 3]; 8] {
    [
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
        [0.0, 0.6, 0.8],
        [0.8, 0.0, 0.6],
    ]
}

fn truth() -> Parameters {
    Parameters {
        accel_bias: [1e-3, -1e-3, 1e-3],
        accel_scale: [3e-4, 2e-4, -2e-4],
        accel_misalignment: [2e-4, -3e-4, 2e-4],
        ..Parameters::default()
    }
}

fn check(estimate: &Parameters) -> octant_score::information::AgainstBound {
    let of = Estimated {
        truth: &truth(),
        initial: &Parameters::default(),
        estimate,
        planned: &NAMES,
        random_walks: [2e-7, VRW],
    };
    against_bound(&information(), &of).unwrap()
}

/// Numbers that look normal: sums of twelve uniform ones.
struct Normal(u64);

impl Normal {
    fn next(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

#[test]
fn the_best_estimate_has_squares_of_one_and_raises_nothing() {
    let mut noise = Normal(7);
    let (mut squares, mut least) = (0.0, 1.0_f64);
    let trials = 3000;
    for _ in 0..trials {
        let mut estimate = truth();
        // The z axis has a bias and a full row: least squares in white noise.
        let mut j = Matrix4::zeros();
        for _ in 0..200 {
            for [x, y, z] in positions() {
                let u = Vector4::new(1.0, -G * x, -G * y, -G * z);
                j += u * u.transpose() / (VRW * VRW);
            }
        }
        let factor = Cholesky::new(j).unwrap().l();
        let z = Vector4::from_fn(|_, _| noise.next());
        let e = factor.transpose().try_inverse().unwrap() * z;
        estimate.accel_bias[2] += e[0];
        estimate.accel_misalignment[1] += e[1];
        estimate.accel_misalignment[2] += e[2];
        estimate.accel_scale[2] += e[3];
        // The other two axes have their errors by themselves, as large as the bound alone.
        for axis in 0..2 {
            estimate.accel_bias[axis] += noise.next() * VRW / f64::sqrt(1600.0);
        }
        estimate.accel_scale[0] += noise.next() * VRW / (G * f64::sqrt(1600.0 * 2.64 / 8.0));
        let found = check(&estimate);
        assert_eq!(found.parameters, 9);
        squares += found.squares / f64::from(trials);
        least = least.min(found.probability);
        assert_eq!(found.doubt(), None);
    }
    // Seven of nine errors are as large as the bound, two are zero.
    assert!((0.7..1.0).contains(&squares), "{squares}");
    assert!(least > TOO_GOOD);
}

#[test]
fn a_unit_that_knows_its_parameters_is_found() {
    let mut estimate = truth();
    estimate.accel_bias[0] += 1e-9;
    let found = check(&estimate);
    assert!(found.probability < TOO_GOOD, "{found:?}");
    assert!(found.doubt().unwrap().starts_with("the errors of 9 parameters are"), "{found:?}");
}

#[test]
fn parameters_with_nothing_to_find_do_not_count() {
    let of = Estimated {
        truth: &Parameters::default(),
        initial: &Parameters::default(),
        estimate: &Parameters::default(),
        planned: &NAMES,
        random_walks: [2e-7, VRW],
    };
    assert_eq!(against_bound(&information(), &of), None);
    let known = Estimated { truth: &truth(), initial: &truth(), estimate: &truth(), ..of };
    assert_eq!(against_bound(&information(), &known), None);
}

#[test]
fn one_position_shows_three_parameters_of_the_accelerometers() {
    let mut information = SampleInformation::default();
    (0..1000).for_each(|_| information.take(1.0, [0.0; 3], [0.0, 0.0, -G]));
    let of = Estimated {
        truth: &truth(),
        initial: &Parameters::default(),
        estimate: &truth(),
        planned: &NAMES,
        random_walks: [2e-7, VRW],
    };
    // A bias and the scale factor on the same axis are one.
    assert_eq!(against_bound(&information, &of).unwrap().parameters, 3);
}
