//! Alterations of counts by faults, channel by channel.

use super::{Outcome, PERIOD_NS, clean, fault, run};
use octant_faults::catalogue::Dimension;
use octant_faults::{Channels, FaultBuildError, FaultSpec, Station, Value};
use octant_sample::Epoch;
use octant_sample::imu::Status;

/// Sample period, s.
pub const DT: f64 = PERIOD_NS as f64 * 1e-9;
/// rad per count of a gyro.
pub const RAD: f64 = 1.0 / 68_719_476_736.0;
/// m/s per count of an accelerometer.
pub const MPS: f64 = 1.0 / 1_073_741_824.0;

pub fn all_counts(epoch: &Epoch) -> [i64; 6] {
    let ([a, b, c], [d, e, f]) = (epoch.sample.delta_theta, epoch.sample.delta_velocity);
    [a, b, c, d, e, f].map(i64::from)
}

pub fn clean_count(k: u64, channel: usize) -> f64 {
    all_counts(&clean(k))[channel] as f64
}

/// Additions to each channel in each epoch (index 0 is epoch 1), and the status; one sample
/// delivered per step, with only counts and status altered.
pub fn added(outcome: &Outcome) -> Vec<([i64; 6], Status)> {
    let mut steps = Vec::new();
    for (index, (k, epoch)) in outcome.delivered.iter().enumerate() {
        assert_eq!(*k, index as u64 + 1);
        let clean = clean(*k);
        let mut same = *epoch;
        same.sample.delta_theta = clean.sample.delta_theta;
        same.sample.delta_velocity = clean.sample.delta_velocity;
        same.sample.status = clean.sample.status;
        assert!(same.same_bits(&clean), "{k}");
        let (was, is) = (all_counts(&clean), all_counts(epoch));
        steps.push((core::array::from_fn(|c| is[c] - was[c]), epoch.sample.status));
    }
    steps
}

/// Strength according to the documentation: 1 from `first` on for `epochs`, then falling linearly
/// over `recovery`.
pub fn strength(k: u64, first: u64, epochs: u64, recovery: u64) -> f64 {
    if k < first || k >= first + epochs + recovery {
        0.0
    } else if k < first + epochs {
        1.0
    } else {
        let faded = (k - first - epochs) as f64;
        (recovery as f64 - faded) / (recovery as f64 + 1.0)
    }
}

/// Checks that the sum of the additions to the channels follows the sum of `real(k, channel)` to
/// within half a count from epoch to epoch, and that the other channels and the status are
/// unaltered.
pub fn follows(outcome: &Outcome, channels: &[usize], real: impl Fn(u64, usize) -> f64) {
    let (mut whole, mut exact) = ([0i64; 6], [0.0f64; 6]);
    for (index, (step, status)) in added(outcome).iter().enumerate() {
        let k = index as u64 + 1;
        assert_eq!(*status, Status::empty(), "{k}");
        for channel in 0..6 {
            if !channels.contains(&channel) {
                assert_eq!(step[channel], 0, "{k} {channel}");
                continue;
            }
            let change = real(k, channel);
            if change == 0.0 {
                assert_eq!(step[channel], 0, "{k} {channel}");
            }
            whole[channel] += step[channel];
            exact[channel] += change;
            let off = whole[channel] as f64 - exact[channel];
            assert!(off.abs() < 0.5 + 1e-6, "{k} {channel} {off}");
        }
    }
}

pub fn channels(channels: Channels) -> (&'static str, Value) {
    ("channels", Value::Channels(channels))
}

pub fn quantity(name: &'static str, value: f64, dimension: Dimension) -> (&'static str, Value) {
    (name, Value::Quantity(value, dimension))
}

pub fn choice(name: &'static str, value: &'static str) -> (&'static str, Value) {
    (name, Value::Choice(value))
}

pub fn flag(name: &'static str, value: bool) -> (&'static str, Value) {
    (name, Value::Flag(value))
}

/// A rate of `counts` counts a sample.
pub fn rate(counts: f64) -> f64 {
    counts * RAD / DT
}

/// An acceleration of `counts` counts a sample.
pub fn acceleration(counts: f64) -> f64 {
    counts * MPS / DT
}

/// Returns the parameter for which a fault is refused.
pub fn refused(kind: &str, values: &[(&'static str, Value)]) -> &'static str {
    match Station::new(&[fault(kind, values, 1, 1)], &super::setup()) {
        Err((id, FaultBuildError::Value { parameter, problem })) => {
            assert_eq!(id, "f");
            assert!(problem.contains("expected") || problem.contains("channels"), "{problem}");
            parameter
        }
        other => panic!("{kind} {values:?} {:?}", other.is_ok()),
    }
}

/// Adds a recovery.
pub fn fading(mut spec: FaultSpec, recovery: u64) -> FaultSpec {
    spec.schedule.recovery = recovery;
    spec
}

/// Additions by a fault to a channel from `first` on, over a number of epochs.
pub fn series(spec: FaultSpec, channel: usize, first: u64, epochs: u64) -> Vec<f64> {
    let outcome = run(&[spec], first + epochs - 1);
    let steps = added(&outcome);
    steps[first as usize - 1..].iter().map(|(step, _)| step[channel] as f64).collect()
}

/// Mean of `a(i) a(i + lag)`.
pub fn product(series: &[f64], lag: usize) -> f64 {
    let pairs = series.iter().zip(&series[lag..]);
    pairs.map(|(a, b)| a * b).sum::<f64>() / (series.len() - lag) as f64
}
