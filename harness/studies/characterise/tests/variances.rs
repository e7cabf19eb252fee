//! Variances, closed forms of the terms, degrees of freedom and covariances.

use crate::synthetic::{Coefficients, stream};
use octant_characterise::deviations::Deviations;
use octant_characterise::freedom::{VarianceKind, degrees_of_freedom};
use octant_characterise::kernel::{DifferenceOrder, Kernel, RandomTerm};

const KERNEL: Kernel = Kernel { period_s: 0.01, correlation_time_s: 3.0 };

fn close(a: f64, b: f64, relative: f64) {
    assert!((a - b).abs() <= relative * b.abs(), "{a} against {b}");
}

#[test]
fn terms_have_the_variances_of_the_standard() {
    let (second, third) = (DifferenceOrder::Second, DifferenceOrder::Third);
    for tau in [0.01, 0.08, 1.0, 64.0, 1024.0] {
        let allan = |term| KERNEL.variance(term, second, tau);
        close(allan(RandomTerm::Quantization), 3.0 / (tau * tau), 1e-12);
        close(allan(RandomTerm::RandomWalk), 1.0 / tau, 1e-12);
        close(allan(RandomTerm::BiasInstability), 2.0 * 2f64.ln() / std::f64::consts::PI, 1e-9);
        close(allan(RandomTerm::RateRandomWalk), tau / 3.0, 1e-12);
        // IEEE Std 952, C.1.7: with σ² = q² T / 2.
        let (t, u) = (KERNEL.correlation_time_s, tau / KERNEL.correlation_time_s);
        let markov = 2.0 / u * (1.0 - 0.5 / u * (3.0 - 4.0 * (-u).exp() + (-2.0 * u).exp()));
        if u > 0.02 {
            close(allan(RandomTerm::GaussMarkov), markov, 1e-8);
        } else {
            close(allan(RandomTerm::GaussMarkov), tau * 2.0 / t / 3.0, 0.02);
        }
        let hadamard = |term| KERNEL.variance(term, third, tau);
        close(hadamard(RandomTerm::RandomWalk), 1.0 / tau, 1e-12);
        close(hadamard(RandomTerm::Quantization), 10.0 / 3.0 / (tau * tau), 1e-12);
        close(hadamard(RandomTerm::RateRandomWalk), tau / 6.0, 1e-12);
        let flicker = (4.0 * 2f64.ln() - 1.5 * 3f64.ln()) / std::f64::consts::PI;
        close(hadamard(RandomTerm::BiasInstability), flicker, 1e-9);
        // NIST SP 1065, table of bias functions: modified Allan variance against Allan's of long averages.
        if tau >= 1.0 {
            let ratio = |term| KERNEL.modified_variance(term, tau) / allan(term);
            close(ratio(RandomTerm::RandomWalk), 0.5, 1e-3);
            close(ratio(RandomTerm::BiasInstability), 0.674, 2e-3);
            close(ratio(RandomTerm::RateRandomWalk), 0.824, 2e-3);
        }
    }
}

#[test]
fn estimates_are_those_of_the_terms() {
    let of = Coefficients {
        quantization: 2e-6,
        random_walk: 3e-5,
        bias_instability: 2e-5,
        rate_random_walk: 2e-6,
        gauss_markov: Some((4e-5, 3.0)),
        ramp: 1e-7,
    };
    let mut deviations = Deviations::new(0.01);
    stream(5, &of, 0.01, 1 << 18, |rate| deviations.push(rate));
    deviations.end_stretch();
    let squares = [of.quantization, of.random_walk, of.bias_instability, of.rate_random_walk, 4e-5]
        .map(|x| x * x);
    for v in deviations.variances().iter().filter(|v| v.samples <= 4096) {
        let tau = v.samples as f64 * 0.01;
        let model = |of: &dyn Fn(RandomTerm) -> f64| -> f64 {
            RandomTerm::ALL.iter().zip(&squares).map(|(term, square)| square * of(*term)).sum()
        };
        let kinds = [
            (
                VarianceKind::Allan,
                v.allan,
                model(&|t| KERNEL.variance(t, DifferenceOrder::Second, tau)),
                0.5 * (1e-7 * tau).powi(2),
            ),
            (
                VarianceKind::Hadamard,
                v.hadamard.unwrap(),
                model(&|t| KERNEL.variance(t, DifferenceOrder::Third, tau)),
                0.0,
            ),
            (
                VarianceKind::Modified,
                v.modified.unwrap(),
                model(&|t| KERNEL.modified_variance(t, tau)),
                0.5 * (1e-7 * tau).powi(2),
            ),
        ];
        for (kind, found, expected, ramp) in kinds {
            let freedom = degrees_of_freedom(&KERNEL, kind, v.samples, (&[1 << 18], &squares));
            let mean: f64 = found.iter().sum::<f64>() / 6.0;
            let sigma = (2.0 / freedom / 6.0).sqrt();
            let off = (mean / (expected + ramp) - 1.0) / sigma;
            assert!(off.abs() < 4.5, "{kind:?} at {tau} s: {off} sigma, {mean} against {expected}");
        }
    }
}
