//! Every kind that fades does so along a straight line, to the last count, in the last sample as in the first.

use super::plain::plain;
use crate::common::counts::{all_counts, strength};
use crate::common::{Outcome, clean, run};
use octant_faults::catalogue::{Acts, Dimension, FaultKind, Lasts};
use octant_faults::trigger::{Repeat, Schedule, Trigger};
use octant_faults::{FaultSpec, Value, kinds};
use octant_sample::{Epoch, Reference};

const FIRST: u64 = 50;
const DURATION: u64 = 160;
const RECOVERY: u64 = 800;
/// After the fade.
const EPOCHS: u64 = FIRST + DURATION + RECOVERY + 40;

/// The fault of a kind that lasts for a number of epochs; the same numbers for any of them.
fn outcome(kind: &'static FaultKind, duration: u64, recovery: u64) -> Outcome {
    let schedule = Schedule {
        trigger: Trigger::Epoch(FIRST),
        duration: Some(duration),
        recovery,
        repeat: Repeat::Once,
    };
    let mut values = plain(kind);
    if kind.name == "dead-zone" {
        // The plain threshold is below every count.
        values.set("threshold", Value::Quantity(1e-2, Dimension::GyroBias));
    }
    if kind.parameter("clock").is_some() {
        values.set("clock", Value::Choice("both"));
    }
    run(&[FaultSpec { id: "f".into(), kind, values, schedule }], EPOCHS)
}

fn one(outcome: &Outcome, k: u64) -> Epoch {
    let [epoch] = outcome.at(k)[..] else { panic!("{k}") };
    epoch
}

/// Numbers of the aiding of an epoch.
fn aiding(epoch: &Epoch) -> Option<[f64; 3]> {
    epoch.aiding.map(|aiding| match aiding.reference {
        Reference::Velocity(velocity) => velocity,
        Reference::Position { latitude_rad, longitude_rad, height_m } => {
            [latitude_rad, longitude_rad, height_m]
        }
    })
}

#[test]
fn every_fade_is_a_straight_line_to_the_last_count() {
    let mut faded = 0;
    for kind in kinds::all().filter(|kind| kind.lasts == Lasts::Fading) {
        assert_eq!(kind.acts, Acts::Samples, "{}", kind.name);
        let (fading, lasting) =
            (outcome(kind, DURATION, RECOVERY), outcome(kind, DURATION + RECOVERY, 0));
        let mut behind = [0.0f64; 6];
        let mut changed = false;
        for k in 1..=EPOCHS {
            let s = strength(k, FIRST, DURATION, RECOVERY);
            let (clean, found, whole) = (clean(k), one(&fading, k), one(&lasting, k));
            let what = format!("{} at {k}", kind.name);
            if s == 0.0 {
                assert!(found.same_bits(&clean), "{what}");
                continue;
            }
            // The whole change is known to half a count in its sum, and so is the fading one: with weights from 1 down
            // to 0 the sum of the first is off by no more than one.
            let [before, now, then] = [&clean, &found, &whole].map(all_counts);
            for channel in 0..6 {
                let change = (then[channel] - before[channel]) as f64;
                behind[channel] += (now[channel] - before[channel]) as f64 - s * change;
                assert!(behind[channel].abs() <= 1.5, "{what}: {channel} {}", behind[channel]);
                changed |= change != 0.0;
            }
            let ns = |epoch: &Epoch| {
                epoch.sample.device_time.ns as f64 - clean.sample.device_time.ns as f64
            };
            assert!((ns(&found) - s * ns(&whole)).abs() <= 1.0, "{what}: {}", ns(&found));
            changed |= ns(&whole).abs() > 10.0;
            if let (Some(was), Some(is), Some(full)) =
                (aiding(&clean), aiding(&found), aiding(&whole))
            {
                for axis in 0..3 {
                    let (change, off) = (full[axis] - was[axis], is[axis] - was[axis]);
                    assert!((off - s * change).abs() <= 1e-12 * (1.0 + change.abs()), "{what}");
                    changed |= change.abs() > 1e-6;
                }
            }
        }
        assert!(changed, "{} changed nothing", kind.name);
        faded += 1;
    }
    assert_eq!(faded, 16, "kinds that fade");
}
