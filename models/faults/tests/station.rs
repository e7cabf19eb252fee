//! The pipeline: order, receipts, triggers.

use crate::common::{self, EACH, TAIL, clean, fault, run, run_with, setup};
use octant_faults::catalogue::Dimension;
use octant_faults::station::Delivered;
use octant_faults::trigger::{Repeat, Schedule, Signal, ThresholdSide, Trigger};
use octant_faults::{Channels, FaultSpec, Station, Value};
use octant_sample::counts::DELTA_THETA_LSB_RAD;
use octant_sample::{GimbalCommand, Mode, Output};

/// A spike of a number of counts a sample on the x gyro.
fn spike(counts: f64, first: u64, epochs: u64) -> FaultSpec {
    let rate = counts * DELTA_THETA_LSB_RAD / 0.005;
    fault(
        "spike",
        &[
            ("channels", Value::Channels(Channels::gyro(0))),
            ("amplitude", Value::Quantity(rate, Dimension::GyroBias)),
        ],
        first,
        epochs,
    )
}

fn triggered(trigger: Trigger, epochs: u64) -> FaultSpec {
    let mut spec = spike(100.0, 1, epochs);
    spec.schedule.trigger = trigger;
    spec
}

/// Epochs in which the x gyro was altered.
fn altered(outcome: &common::Outcome) -> Vec<u64> {
    let differs = |(k, epoch): &&(u64, octant_sample::Epoch)| *epoch != clean(*k);
    outcome.delivered.iter().filter(differs).map(|(k, _)| *k).collect()
}

#[test]
fn a_spike_adds_its_area_and_nothing_else() {
    let outcome = run(&[spike(0.34, 11, 10)], 40);
    let added: i32 = outcome
        .delivered
        .iter()
        .map(|(k, epoch)| {
            let clean = clean(*k);
            let counts = epoch.sample.delta_theta[0] - clean.sample.delta_theta[0];
            let mut same = *epoch;
            same.sample.delta_theta[0] -= counts;
            assert_eq!(same, clean);
            counts
        })
        .sum();
    assert_eq!(added, 3);
    let receipt = &outcome.receipts[0];
    assert_eq!((receipt.firings, receipt.samples_altered), (1, 3));
    // The remainder passes half a count at the second, the fifth and the eighth sample.
    assert_eq!(altered(&outcome), [12, 15, 18]);
    assert_eq!((receipt.first_sample, receipt.last_sample), (Some(12), Some(18)));
    assert_ne!(receipt.clean_crc32, receipt.faulted_crc32);
}

#[test]
fn a_fault_that_has_not_fired_says_so() {
    let outcome = run(&[spike(5.0, 500, 10)], 400);
    assert!(altered(&outcome).is_empty());
    let receipt = &outcome.receipts[0];
    assert!(receipt.armed && !receipt.fired());
    assert_eq!((receipt.firings, receipt.first_sample), (0, None));
}

#[test]
fn periodic_and_repeated_faults_come_at_their_times() {
    let periodic = triggered(Trigger::Periodic { first: 10, period: 25, last: Some(70) }, 2);
    assert_eq!(altered(&run(&[periodic], 200)), [10, 11, 35, 36, 60, 61]);
    let mut repeated = spike(9.0, 20, 1);
    repeated.schedule.repeat = Repeat::Times { times: 3, every: 7 };
    assert_eq!(altered(&run(&[repeated], 200)), [20, 27, 34]);
}

#[test]
fn poisson_spikes_have_their_rate_and_need_no_history() {
    let poisson = triggered(Trigger::Poisson { first: 1, last: None, mean: 50.0 }, 1);
    let outcome = run(std::slice::from_ref(&poisson), 100_000);
    let count = altered(&outcome).len() as f64;
    // Mean distance: 50 waiting, less half an epoch of rounding down, and one for the spike.
    let expected = 100_000.0 / 50.5;
    assert!((count - expected).abs() < 5.0 * expected.sqrt(), "{count} {expected}");
    let again = run(&[poisson], 50_000);
    let both = altered(&outcome);
    assert_eq!(altered(&again)[..], both[..altered(&again).len()]);
}

/// A core that is at stop 3 from epoch 100 on, moves to 4 from 200 and arrives at 250.
fn core(k: u64) -> Output {
    let (stop, moving) = match k {
        0..100 => (2, true),
        100..200 => (3, false),
        200..250 => (4, true),
        _ => (4, false),
    };
    let mode = if k < 300 { Mode::Calibrating } else { Mode::Navigating };
    let nis = if k == 150 { 30.0 } else { f64::NAN };
    Output { mode, stop, moving, nis, ..Output::default() }
}

#[test]
fn positions_moves_modes_and_conditions_fire() {
    let mode = Mode::Calibrating;
    for (trigger, expected) in [
        // The answer to epoch 100 reports the arrival: epoch 101 is the first that can depend on
        // it.
        (Trigger::Position { stop: 3, mode, delay: 0 }, 101),
        (Trigger::Position { stop: 4, mode, delay: 10 }, 261),
        (Trigger::Move { stop: 4, mode, delay: 0 }, 201),
        (Trigger::Mode { mode: Mode::Navigating, delay: 5 }, 306),
        (
            Trigger::Condition {
                signal: Signal::Nis,
                comparison: ThresholdSide::Above,
                value: 25.0,
                delay: 0,
            },
            151,
        ),
    ] {
        let outcome = run_with(&[triggered(trigger.clone(), 1)], 400, core);
        assert_eq!(altered(&outcome), [expected], "{trigger:?}");
    }
}

#[test]
fn a_fault_can_follow_another() {
    let mut first = spike(7.0, 50, 10);
    first.id = "first".into();
    let after = triggered(Trigger::After { fault: "first".into(), delay: 5 }, 1);
    assert_eq!(altered(&run(&[after.clone(), first.clone()], 100)).last(), Some(&65));
    assert_eq!(altered(&run(&[first, after], 100)).last(), Some(&65));
}

/// A manual fault lasts from its firing to its end, any number of times; a fault that is ended
/// before its onset doesn't set in.
#[test]
fn a_fault_by_hand_lasts_as_long_as_the_hand_says() {
    let mut held = triggered(Trigger::Manual, 1);
    held.schedule = Schedule { duration: None, repeat: Repeat::EveryTime, ..held.schedule };
    let id = held.id.clone();
    let mut station = Station::new(&[held], &setup()).unwrap();
    let (mut world, output) = (common::Log::default(), Output::default());
    let mut altered = Vec::new();
    let mut active = Vec::new();
    for k in 1..=60 {
        match k {
            10 | 30 | 50 => assert!(station.fire(&id)),
            20 | 33 => assert!(station.end(&id)),
            25 => assert!(!station.end(&id), "it doesn't last"),
            _ => {}
        }
        if k == 50 {
            assert!(!station.fire(&id), "it is on its way");
            assert!(station.end(&id));
        }
        station.begin(&output, &mut world);
        station.command(&mut GimbalCommand::default(), &output);
        if station.after(&clean(k), &output, &mut world).delivered != Delivered::Untouched {
            altered.push(k);
        }
        if station.progress(0).unwrap().active {
            active.push(k);
        }
    }
    let expected: Vec<u64> = (10..20).chain(30..33).collect();
    assert_eq!((&altered, &active), (&expected, &expected));
    let progress = station.progress(0).unwrap();
    assert_eq!((progress.firings, progress.samples_altered), (2, 13));
    assert_eq!(station.progress(1), None);
}

/// A fault inside the plant isn't called while it lasts; its effect is compared in every epoch, and goes on after its
/// end. It is over when its effect is, and then the faults that wait for it set in; across saving and loading, and in a
/// second firing.
#[test]
fn a_fault_inside_the_plant_is_over_when_its_effect_is() {
    let mut slip = fault(
        "encoder-slip",
        &[
            ("gimbal", Value::Choice("azimuth")),
            ("angle", Value::Quantity(0.01, Dimension::Angle)),
            ("flagged", Value::Flag(false)),
        ],
        11,
        100,
    );
    slip.schedule.repeat = Repeat::Times { times: 2, every: 200 };
    let mut after = triggered(Trigger::After { fault: slip.id.clone(), delay: 0 }, 1);
    after.id = "after".into();
    after.schedule.repeat = Repeat::EveryTime;
    let specs = [slip, FaultSpec { id: "spike".into(), ..spike(100.0, 50, 3) }, after];
    let mut station = Station::new(&specs, &setup()).unwrap();
    let (mut world, output) = (common::Log::default(), Output::default());
    let (mut expected, mut looked) = (0, Vec::new());
    let mut occurrences = Vec::new();
    let lasts = |k: u64| (11..111 + TAIL).contains(&k) || (211..311 + TAIL).contains(&k);
    for k in 1..=400u64 {
        station.begin(&output, &mut world);
        let epoch = clean(k);
        world.deliver(&epoch);
        let passed = station.after(&epoch, &output, &mut world);
        let spiked = [50, 51, 52, 111 + TAIL, 311 + TAIL].contains(&k);
        assert_eq!(passed.delivered != Delivered::Untouched, spiked, "epoch {k}");
        let mut without = epoch;
        without.sample.delta_theta[0] -= EACH;
        assert_eq!(passed.undisturbed, lasts(k).then_some(&without), "epoch {k}");
        expected += u64::from(lasts(k));
        let progress = station.progress(0).unwrap();
        assert_eq!((progress.active, progress.samples_altered), (lasts(k), expected), "epoch {k}");
        if !station.is_idle() {
            looked.push(k);
        }
        occurrences.extend(station.occurrences().iter().map(|it| (it.fault, it.begins, it.epoch)));
        station.told();
        if k % 7 == 0 {
            let mut bytes = Vec::new();
            station.save(&mut bytes);
            station = Station::load(&specs, &setup(), &bytes).unwrap();
        }
    }
    let receipt = &station.receipts()[0];
    assert_eq!((receipt.first_sample, receipt.last_sample), (Some(11), Some(310 + TAIL)));
    assert_eq!((receipt.firings, receipt.samples_altered), (2, 200 + 2 * TAIL));
    let largest = receipt.largest_change.unwrap();
    assert_eq!(largest.delta_theta, [EACH as u32, 0, 0]);
    assert_eq!(world.ended, [0, 0]);
    let of_slip: Vec<_> = occurrences.into_iter().filter(|it| it.0 == 0).collect();
    let (one, other) = (111 + TAIL, 311 + TAIL);
    assert_eq!(of_slip, [(0, true, 11), (0, false, one), (0, true, 211), (0, false, other)]);
    assert!(
        looked.iter().all(|k| lasts(*k) || (50..54).contains(k) || lasts(*k - 1)),
        "{looked:?}"
    );
}
