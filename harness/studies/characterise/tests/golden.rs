//! Deviations and degrees of freedom against those of allantools: `fixtures/golden/deviations.py` made them.

use octant_characterise::deviations::{Deviations, Variances};
use octant_characterise::freedom::{VarianceKind, degrees_of_freedom};
use octant_characterise::kernel::{Kernel, RandomTerm};

const PERIOD_S: f64 = 0.005;

fn golden() -> serde_json::Value {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/golden/deviations.json");
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// The series of the script.
fn series() -> Vec<f64> {
    let mut state = 1u64;
    let values: Vec<f64> = (0..6000)
        .map(|_| {
            state = (1_103_515_245 * state + 12345) % (1 << 31);
            state as f64 / f64::from(1u32 << 31) - 0.5
        })
        .collect();
    let mut sums = vec![0.0];
    for value in &values {
        sums.push(sums[sums.len() - 1] + value);
    }
    let slow = |k: usize| (sums[k + 1] - sums[k.saturating_sub(499)]) / 500.0;
    values.iter().enumerate().map(|(k, value)| value + slow(k)).collect()
}

fn variances() -> Vec<Variances> {
    let mut deviations = Deviations::new(PERIOD_S);
    for rate in series() {
        deviations.push(&[rate, 2.0 * rate, 0.0, 1e-6 * rate, -rate, rate + 1.0]);
    }
    deviations.end_stretch();
    deviations.variances()
}

#[test]
fn deviations_are_those_of_allantools() {
    let all = variances();
    let golden = golden();
    let rows = golden["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 21);
    for row in rows {
        let samples = row[0].as_u64().unwrap();
        let found = all.iter().find(|v| v.samples == samples).unwrap();
        let (modified, hadamard) = (found.modified.unwrap(), found.hadamard.unwrap());
        for (kind, found, at) in
            [("allan", found.allan, 1), ("modified", modified, 2), ("hadamard", hadamard, 3)]
        {
            let expected = row[at].as_f64().unwrap();
            for (channel, factor) in [(0, 1.0), (1, 2.0), (3, 1e-6), (4, 1.0), (5, 1.0)] {
                let off = found[channel].sqrt() / (factor * expected) - 1.0;
                assert!(
                    off.abs() < 1e-10,
                    "{kind} at {samples} samples, channel {channel}: {off:e}"
                );
            }
            assert_eq!(found[2], 0.0);
        }
    }
}

#[test]
fn a_stretch_is_as_if_it_were_alone() {
    // Two stretches of the same samples have the differences of one of them twice.
    let mut deviations = Deviations::new(PERIOD_S);
    for _ in 0..2 {
        for rate in series() {
            deviations.push(&[rate; 6]);
        }
        deviations.end_stretch();
    }
    assert_eq!(deviations.stretches(), [6000, 6000]);
    for (twice, once) in deviations.variances().iter().zip(variances()) {
        assert_eq!(twice.samples, once.samples);
        assert!((twice.allan[0] / once.allan[0] - 1.0).abs() < 1e-12);
        let [twice, once] =
            [twice.hadamard, once.hadamard].map(|hadamard| hadamard.map(|all| all[0]));
        assert!(twice.zip(once).is_none_or(|(a, b)| (a / b - 1.0).abs() < 1e-12));
    }
}

#[test]
fn degrees_of_freedom_are_those_of_greenhall_and_riley() {
    let kernel = Kernel { period_s: 1.0, correlation_time_s: 1.0 };
    let golden = golden();
    for row in golden["freedom"].as_array().unwrap() {
        let term = RandomTerm::ALL.into_iter().find(|term| term.name() == row[0]).unwrap();
        let kind = match row[1].as_str().unwrap() {
            "allan" => VarianceKind::Allan,
            "hadamard" => VarianceKind::Hadamard,
            _ => VarianceKind::Modified,
        };
        let (samples, count) = (row[2].as_u64().unwrap(), row[3].as_u64().unwrap());
        // Theirs is of a phase that is averaged over a sample, which matters where a sample is all there is.
        if samples < 32 {
            continue;
        }
        let mut squares = [0.0; 5];
        squares[term as usize] = 1.0;
        let found = degrees_of_freedom(&kernel, kind, samples, (&[count], &squares));
        let expected = row[4].as_f64().unwrap();
        // From hundred strides on they take a table.
        let off = found / expected - 1.0;
        assert!(off.abs() < 0.03, "{row}: found {found}");
    }
}
