//! The unit under test restarts, loses power, has a wrong table.

use crate::common::{clean, fault, run, run_with, setup};
use octant_faults::catalogue::Dimension;
use octant_faults::rule::UnitEvent;
use octant_faults::trigger::{Repeat, Trigger};
use octant_faults::{FaultSpec, Station, Value};
use octant_sample::{Mode, Output, Parameters};

fn named(id: &str, spec: FaultSpec) -> FaultSpec {
    FaultSpec { id: id.into(), ..spec }
}

#[test]
fn it_restarts_at_its_trigger() {
    let mut spec = fault("restart", &[], 1, 1);
    spec.schedule.trigger = Trigger::Position { stop: 3, mode: Mode::Calibrating, delay: 10 };
    let outcome = run_with(&[spec], 100, |k| Output {
        mode: Mode::Calibrating,
        stop: (k / 10) as u16,
        ..Output::default()
    });
    // The answer to epoch 30 has stop 3: epoch 31 and ten more.
    assert_eq!(outcome.events, [(41, UnitEvent::Restart)]);
    assert!(outcome.delivered.iter().all(|(at, epoch)| epoch.same_bits(&clean(*at))));
    let receipt = &outcome.receipts[0];
    assert_eq!((receipt.samples_altered, receipt.first_sample), (1, Some(41)));
}

#[test]
fn a_watchdog_bites_again() {
    let mut spec = fault("restart", &[], 20, 1);
    spec.schedule.repeat = Repeat::Times { times: 3, every: 15 };
    let events = run(&[spec], 100).events;
    assert_eq!(events, [20, 35, 50].map(|at| (at, UnitEvent::Restart)));
}

#[test]
fn power_goes_and_comes() {
    let outcome = run(&[fault("brown-out", &[], 20, 30)], 100);
    assert_eq!(outcome.events, [(20, UnitEvent::PowerOff), (50, UnitEvent::PowerOn)]);
    let receipt = &outcome.receipts[0];
    assert_eq!(
        (receipt.samples_altered, receipt.first_sample, receipt.last_sample),
        (30, Some(20), Some(49))
    );
    let mut spec = fault("brown-out", &[], 20, 30);
    spec.schedule.duration = None;
    assert_eq!(run(&[spec], 100).events, [(20, UnitEvent::PowerOff)]);
}

#[test]
fn a_dip_is_one_event_and_alters_no_sample() {
    let values = [
        ("voltage", Value::Quantity(9.0, Dimension::Voltage)),
        ("length", Value::Quantity(0.25, Dimension::Time)),
    ];
    let dip = UnitEvent::VoltageDip { voltage_v: 9.0, length_s: 0.25 };
    let outcome = run(&[fault("voltage-dip", &values, 20, 1)], 100);
    assert_eq!(outcome.events, [(20, dip)]);
    assert!(outcome.delivered.iter().all(|(at, epoch)| epoch.same_bits(&clean(*at))));
    let receipt = &outcome.receipts[0];
    assert_eq!((receipt.samples_altered, receipt.first_sample), (1, Some(20)));
    // A unit without power has no voltage to lower.
    let specs = [
        named("dip", fault("voltage-dip", &values, 30, 1)),
        named("cut", fault("brown-out", &[], 20, 30)),
    ];
    let outcome = run(&specs, 100);
    assert_eq!(outcome.events, [(20, UnitEvent::PowerOff), (50, UnitEvent::PowerOn)]);
}

#[test]
fn power_is_back_when_the_last_fault_ends() {
    for swapped in [false, true] {
        let mut specs = [
            named("a", fault("brown-out", &[], 20, 30)),
            named("b", fault("brown-out", &[], 40, 30)),
        ];
        if swapped {
            specs.reverse();
        }
        let events = run(&specs, 100).events;
        assert_eq!(events, [(20, UnitEvent::PowerOff), (70, UnitEvent::PowerOn)]);
    }
    // The second fault begins where the first ends: power never returned in between.
    let specs =
        [named("a", fault("brown-out", &[], 20, 30)), named("b", fault("brown-out", &[], 50, 10))];
    assert_eq!(run(&specs, 100).events, [(20, UnitEvent::PowerOff), (60, UnitEvent::PowerOn)]);
}

#[test]
fn without_power_nothing_restarts() {
    let restart = named("restart", fault("restart", &[], 30, 1));
    let power = named("power", fault("brown-out", &[], 20, 30));
    for specs in [[restart.clone(), power.clone()], [power, restart]] {
        let outcome = run(&specs, 100);
        assert_eq!(outcome.events, [(20, UnitEvent::PowerOff), (50, UnitEvent::PowerOn)]);
        let restart = outcome.receipts.iter().find(|receipt| receipt.id == "restart").unwrap();
        assert_eq!((restart.firings, restart.samples_altered), (1, 0));
    }
}

/// A stale table with a value on one axis of each group.
fn stale(values: [f64; 5], first: u64) -> FaultSpec {
    let [bias, scale, g, accel, accel_scale] = values;
    fault(
        "stale-table",
        &[
            ("gyro_bias", Value::Vector([bias, 0.0, 0.0], Dimension::GyroBias)),
            ("gyro_scale", Value::Vector([0.0, scale, 0.0], Dimension::Ratio)),
            ("g_dependent", Value::Vector([0.0, 0.0, g], Dimension::GDependent)),
            ("accel_bias", Value::Vector([0.0, accel, 0.0], Dimension::AccelBias)),
            ("accel_scale", Value::Vector([accel_scale, 0.0, 0.0], Dimension::Ratio)),
        ],
        first,
        1,
    )
}

#[test]
fn a_stale_table_is_off_by_its_offsets() {
    let outcome = run(&[stale([1e-8, 2e-5, 3e-10, 4e-3, 5e-5], 12)], 30);
    let [(at, UnitEvent::RestartWith { offset })] = outcome.events[..] else {
        panic!("{:?}", outcome.events)
    };
    assert_eq!(at, 12);
    // In the order of the parameters' names.
    let mut expected = [0.0; 30];
    for (name, value) in [
        ("gyro_bias_x", 1e-8),
        ("gyro_scale_y", 2e-5),
        ("g_zz", 3e-10),
        ("accel_bias_y", 4e-3),
        ("accel_scale_x", 5e-5),
    ] {
        let index = octant_sample::parameters::NAMES.iter().position(|n| *n == name).unwrap();
        expected[index] = value;
    }
    assert_eq!(offset, Parameters::from_array(&expected));
}

#[test]
fn a_table_without_an_offset_is_refused() {
    let (id, error) = Station::new(&[stale([0.0; 5], 12)], &setup()).unwrap_err();
    assert_eq!(id, "f");
    assert!(error.to_string().contains("at least one other than 0"), "{error}");
}
