//! Allan variances, degrees of freedom, intervals and fits against `fixtures/golden/allan.json`, which
//! allantools and scipy made, and against closed forms.

use octant_random::stream::Triad;
use octant_statistics::allan::freedom::interval;
use octant_statistics::allan::{
    AllanCascade, AllanPoint, DifferenceCounts, NoiseTerm, TermEstimate, analyse,
};
use serde_json::Value as Json;
use std::f64::consts::{LN_2, PI};

fn golden(of: &str) -> Json {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/golden/allan.json");
    let all: Json = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    all[of].clone()
}

#[track_caller]
fn assert_near(found: f64, expected: f64, relative: f64) {
    let error = (found / expected - 1.0).abs();
    assert!(error <= relative, "found {found}, expected {expected}, relative error {error:e}");
}

/// The generator of the test suite in NIST SP 1065.
fn suite(count: usize) -> Vec<f64> {
    let mut n = 1_234_567_890u64;
    let mut next = || {
        let number = n as f64 / 2_147_483_647.0;
        n = 16_807 * n % 2_147_483_647;
        number
    };
    (0..count).map(|_| next()).collect()
}

fn counts(octave: &Json) -> DifferenceCounts {
    let pairs = octave["pairs"].as_array().unwrap();
    DifferenceCounts {
        terms: octave["terms"].as_u64().unwrap(),
        pairs: std::array::from_fn(|i| pairs[i].as_u64().unwrap()),
        strides: if octave["samples"] == 1 { 1 } else { 2 },
    }
}

#[track_caller]
fn compare(cascade: &AllanCascade<1>, octaves: &Json) {
    let octaves = octaves.as_array().unwrap();
    let tallies = cascade.tallies();
    assert_eq!(tallies.len(), octaves.len());
    for (tally, octave) in tallies.iter().zip(octaves) {
        assert_eq!(tally.samples, octave["samples"].as_u64().unwrap());
        assert_eq!(tally.counts, counts(octave), "{} samples", tally.samples);
        // The reference takes differences of sums up to 1000.
        assert_near(tally.variance[0], octave["variance"].as_f64().unwrap(), 1e-9);
    }
}

#[test]
fn the_test_suite_of_nist_has_the_variances_of_allantools() {
    let mut cascade = AllanCascade::unlimited();
    suite(1000).iter().for_each(|y| cascade.push(&[*y]));
    compare(&cascade, &golden("suite"));
    // The deviation at one second in the table of the test suite.
    assert_near(cascade.tallies()[0].variance[0].sqrt(), 2.922319e-1, 2e-7);
}

#[test]
fn stretches_are_pooled_by_their_numbers_of_differences() {
    let golden = golden("pooled");
    let numbers = suite(2000);
    let (mut cascade, mut from) = (AllanCascade::unlimited(), 0);
    for length in golden["lengths"].as_array().unwrap() {
        let length = length.as_u64().unwrap() as usize;
        numbers[from..from + length].iter().for_each(|y| cascade.push(&[*y]));
        cascade.end_stretch();
        from += length;
    }
    compare(&cascade, &golden["octaves"]);
}

fn term(name: &str) -> NoiseTerm {
    NoiseTerm::ALL.into_iter().find(|term| term.name() == name).unwrap()
}

fn shares(of: NoiseTerm) -> [f64; NoiseTerm::COUNT] {
    NoiseTerm::ALL.map(|term| f64::from(u8::from(term == of)))
}

#[test]
fn degrees_of_freedom_are_those_of_greenhall_and_riley() {
    for row in golden("freedom").as_array().unwrap() {
        let term = term(row["term"].as_str().unwrap());
        let mut counts = DifferenceCounts::new(2);
        counts.add_stretch(row["terms"].as_u64().unwrap());
        let expected = row["freedom"].as_f64().unwrap();
        // The correlations of bias instability beyond 2 τ, and the reference's own bound of lags.
        let tolerance = if term == NoiseTerm::BiasInstability { 0.012 } else { 1e-12 };
        assert_near(counts.degrees_of_freedom(&shares(term)), expected, tolerance);
    }
    // White noise of the integral: neighbours share −2/3 and 1/6, so ν = M / (1 + 2 (4/9 + 1/36)).
    let mut counts = DifferenceCounts::new(1);
    counts.add_stretch(1_000_000_000);
    let freedom = counts.degrees_of_freedom(&shares(NoiseTerm::Quantization));
    assert_near(freedom, 1e9 * 18.0 / 35.0, 1e-8);
}

#[test]
fn intervals_are_those_of_chi_squared() {
    for row in golden("intervals").as_array().unwrap() {
        let found = interval(1.0, row["freedom"].as_f64().unwrap());
        for (end, found) in found.into_iter().enumerate() {
            assert_near(found, row["interval"][end].as_f64().unwrap(), 3e-6);
        }
    }
}

fn points(octaves: &Json) -> Vec<AllanPoint> {
    let point = |octave: &Json| AllanPoint {
        tau_s: octave["tau_s"].as_f64().unwrap(),
        variance: octave["variance"].as_f64().unwrap(),
        counts: counts(octave),
    };
    octaves.as_array().unwrap().iter().map(point).collect()
}

#[test]
fn fitted_terms_are_those_of_scipy() {
    for case in golden("fits").as_array().unwrap() {
        let expected = case["terms"].as_object().unwrap();
        let terms: Vec<NoiseTerm> = expected.keys().map(|name| term(name)).collect();
        let fit = analyse(&points(&case["octaves"]), &terms).fit.unwrap();
        assert_near(fit.deviance, case["deviance"].as_f64().unwrap(), 1e-6);
        let resolved = expected.values().filter(|term| !term["value"].is_null()).count();
        assert_eq!(fit.freedom + resolved, case["used"].as_u64().unwrap() as usize);
        for (of, found) in NoiseTerm::ALL.iter().zip(fit.terms) {
            let Some(expected) = expected.get(of.name()) else {
                assert_eq!(found, None, "{of:?} wasn't looked for");
                continue;
            };
            let TermEstimate { value, interval: [low, high] } = found.unwrap();
            if let Some(below) = expected["below"].as_f64() {
                assert_eq!((value, low), (None, 0.0), "{of:?}");
                assert_near(high, below, 1e-4);
                continue;
            }
            assert_near(value.unwrap(), expected["value"].as_f64().unwrap(), 1e-5);
            assert_near(low, expected["low"].as_f64().unwrap(), 1e-4);
            assert_near(high, expected["high"].as_f64().unwrap(), 1e-4);
        }
    }
}

/// Variances without scatter, at nearly infinite degrees of freedom: the terms come back.
#[test]
fn the_terms_of_an_exact_curve_come_back() {
    let coefficients = [4e-9, 2e-7, 3e-9, 4e-11, 3e-15];
    let mut counts = DifferenceCounts::new(2);
    counts.add_stretch(1 << 40);
    let points: Vec<AllanPoint> = (0..24)
        .map(|octave| {
            let tau_s = 0.005 * f64::from(1 << octave);
            let [q, n, b, k, r]: [f64; 5] = coefficients;
            let variance = 3.0 * q * q / (tau_s * tau_s)
                + n * n / tau_s
                + 2.0 * LN_2 / PI * b * b
                + k * k * tau_s / 3.0
                + 0.5 * r * r * tau_s * tau_s;
            AllanPoint { tau_s, variance, counts }
        })
        .collect();
    let analysis = analyse(&points, &NoiseTerm::ALL);
    let fit = analysis.fit.unwrap();
    for (expected, found) in coefficients.iter().zip(fit.terms) {
        assert_near(found.unwrap().value.unwrap(), *expected, 1e-4);
    }
    for point in &points {
        assert_near(fit.variance(point.tau_s), point.variance, 1e-6);
    }
}

#[test]
fn a_sensor_without_noise_has_no_terms() {
    let mut cascade = AllanCascade::<1>::unlimited();
    (0..5000).for_each(|_| cascade.push(&[17.0]));
    let tallies = cascade.tallies();
    let of = |tally: &octant_statistics::allan::AllanTally<1>| AllanPoint {
        tau_s: tally.samples as f64,
        variance: tally.variance[0],
        counts: tally.counts,
    };
    let points: Vec<AllanPoint> = tallies.iter().map(of).collect();
    let analysis = analyse(&points, &NoiseTerm::ALL);
    assert_eq!(analysis.fit, None);
    assert!(analysis.estimates.iter().all(|estimate| estimate.interval == [0.0, 0.0]));
    assert_eq!(analyse(&[], &NoiseTerm::ALL).fit, None);
    assert_eq!(analyse(&points[..2], &NoiseTerm::ALL).fit, None);
}

/// Coverage of the 95 % intervals, over records of white noise with a rate random walk in twelve stretches:
/// deviations, coefficients, and terms that aren't there.
#[test]
fn intervals_cover_the_truth_as_often_as_they_say() {
    const SEEDS: u64 = 150;
    let (n, k, period_s) = (2e-7f64, 3e-8f64, 0.25f64);
    let (mut estimates, mut covered) = (0u32, 0u32);
    let (mut walks, mut rates, mut false_terms) = (0u32, 0u32, 0u32);
    for seed in 0..SEEDS {
        let (white, walk) = (Triad::new(seed, "white"), Triad::new(seed, "walk"));
        // A sample is the mean over its period: of the walk, too, by ten steps in each.
        let mut cascade = AllanCascade::<3>::unlimited();
        let mut bias = [0.0; 3];
        let mut number = 0;
        for _ in 0..12 {
            for sample in 0..800u64 {
                let mut mean = white.at(number + sample).map(|w| w * n / period_s.sqrt());
                for step in 0..10 {
                    let steps = walk.at((number + sample) * 10 + step);
                    for axis in 0..3 {
                        bias[axis] += steps[axis] * k * (period_s / 10.0).sqrt();
                        mean[axis] += bias[axis] / 10.0;
                    }
                }
                cascade.push(&mean);
            }
            number += 800;
            cascade.end_stretch();
        }
        let tallies = cascade.tallies();
        for axis in 0..3 {
            let points: Vec<AllanPoint> = tallies
                .iter()
                .map(|tally| AllanPoint {
                    tau_s: tally.samples as f64 * period_s,
                    variance: tally.variance[axis],
                    counts: tally.counts,
                })
                .collect();
            let analysis = analyse(&points, &NoiseTerm::ALL);
            for estimate in &analysis.estimates {
                let truth = n * n / estimate.tau_s + k * k * estimate.tau_s / 3.0;
                let [low, high] = estimate.interval;
                estimates += 1;
                covered += u32::from((low..=high).contains(&truth));
            }
            let within = |term: Option<TermEstimate>, truth: f64| {
                let [low, high] = term.unwrap().interval;
                u32::from((low..=high).contains(&truth))
            };
            let [quantization, random_walk, instability, rate, ramp] = analysis.fit.unwrap().terms;
            walks += within(random_walk, n);
            rates += within(rate, k);
            let resolved = |term: &&Option<TermEstimate>| term.unwrap().value.is_some();
            false_terms += [quantization, instability, ramp].iter().filter(resolved).count() as u32;
        }
    }
    let records = 3 * SEEDS as u32;
    let share = |count: u32, of: u32| f64::from(count) / f64::from(of);
    // Standard error of a share of 95 %: 0.4 % of the estimates, 1 % of the records.
    let found = [share(covered, estimates), share(walks, records), share(rates, records)];
    assert!((0.93..0.97).contains(&found[0]), "deviations {found:?}");
    assert!((0.92..0.995).contains(&found[1]), "random walk {found:?}");
    assert!((0.92..0.995).contains(&found[2]), "rate random walk {found:?}");
    // Three terms of each record aren't there; an interval of 95 % excludes zero in 5 % of all cases.
    let resolved = share(false_terms, 3 * records);
    assert!(resolved < 0.05, "terms that aren't there: {resolved}");
}
