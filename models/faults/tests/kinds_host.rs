//! Faults of the host: raised once at each onset, and fired only if the host accepts them.

use crate::common::seconds;
use octant_faults::catalogue::Acts;
use octant_faults::rule::{HostAction, Hosted};
use octant_faults::station::{Delivered, World};
use octant_faults::trigger::{Repeat, Schedule, Trigger};
use octant_faults::{FaultSpec, Setup, Station, Value, Values, kinds};
use octant_sample::disturbance::Disturbed;
use octant_sample::{Epoch, GimbalCommand, Output, Truth};

/// A host that accepts faults, or has nothing on which they could act.
#[derive(Default)]
struct Host {
    takes: bool,
    epoch: u64,
    begun: Vec<(u64, HostAction)>,
}

impl Hosted for Host {
    fn begin(&mut self, action: &HostAction) -> bool {
        self.begun.push((self.epoch, *action));
        self.takes
    }
}

impl World for Host {
    fn disturbed(&mut self) -> Option<&mut dyn Disturbed> {
        None
    }
    fn host(&mut self) -> Option<&mut dyn Hosted> {
        Some(self)
    }
    fn truth(&self) -> Option<Truth> {
        None
    }
}

fn setup() -> Setup {
    Setup {
        seed: 1,
        sample_period_ns: 5_000_000,
        calibration_samples: 1000,
        angle_random_walk: 0.0,
        velocity_random_walk: 0.0,
        turntable_rate_radps: 0.1,
        id: String::new(),
    }
}

fn spec(kind: &str, values: &[(&'static str, Value)]) -> FaultSpec {
    let mut all = Values::default();
    values.iter().for_each(|(name, value)| all.set(name, *value));
    let schedule = Schedule {
        trigger: Trigger::Epoch(3),
        duration: None,
        recovery: 0,
        repeat: Repeat::Times { times: 2, every: 4 },
    };
    FaultSpec { id: kind.into(), kind: kinds::named(kind).unwrap(), values: all, schedule }
}

fn cases() -> [(FaultSpec, HostAction); 3] {
    [
        (
            spec("host-cpu-starved", &[("length", seconds(0.25)), ("threads", Value::Integer(2))]),
            HostAction::Starve { lasts_s: 0.25, threads: 2 },
        ),
        (spec("host-disk-full", &[]), HostAction::FillDisk),
        (
            spec("host-recorder-stalled", &[("pause", seconds(2.0))]),
            HostAction::StallRecorder { pause_s: 2.0 },
        ),
    ]
}

#[test]
fn each_onset_is_raised_once_and_no_sample_altered() {
    for takes in [true, false] {
        for (spec, action) in cases() {
            let mut station = Station::new(&[spec], &setup()).unwrap();
            let mut host = Host { takes, ..Host::default() };
            for k in 1..=20 {
                host.epoch = k;
                let mut command = GimbalCommand::default();
                station.before(&mut command, &Output::default(), &mut host);
                let delivered =
                    station.after(&Epoch::default(), &Output::default(), &mut host).delivered;
                assert_eq!(delivered, Delivered::Untouched);
                station.told();
            }
            assert_eq!(host.begun, [(3, action), (7, action)]);
            let receipt = &station.receipts()[0];
            assert_eq!((receipt.armed, receipt.firings), (true, 2));
            assert_eq!(receipt.fired(), takes, "one that nobody takes altered nothing");
            let samples = (receipt.first_sample, receipt.last_sample, receipt.samples_altered);
            assert_eq!(samples, if takes { (Some(3), Some(7), 2) } else { (None, None, 0) });
        }
    }
    let of_host = kinds::all().filter(|kind| kind.acts == Acts::Host).map(|kind| kind.name);
    assert!(of_host.eq(cases().map(|(spec, _)| spec.kind.name)));
}

#[test]
fn a_time_of_zero_is_refused() {
    for (kind, values) in [
        ("host-cpu-starved", [("length", seconds(0.0)), ("threads", Value::Integer(1))]),
        ("host-recorder-stalled", [("pause", seconds(0.0)), ("pause", seconds(0.0))]),
    ] {
        let (id, error) = Station::new(&[spec(kind, &values)], &setup()).unwrap_err();
        assert_eq!(id, kind);
        let expected = format!("{}: 0 s, a time above 0 s is expected", values[0].0);
        assert_eq!(error.to_string(), expected);
    }
}
