//! Cost of the station per epoch: negligible while its faults wait.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use octant_faults::catalogue::Dimension;
use octant_faults::station::{Delivered, World};
use octant_faults::trigger::{Repeat, Schedule, Trigger};
use octant_faults::{Channels, FaultSpec, Setup, Station, Value, Values, kinds};
use octant_sample::disturbance::Disturbed;
use octant_sample::{Epoch, Mode, Output, Sample, Truth};
use std::hint::black_box;

/// A calibration of this many epochs at one position.
const EPOCHS: u64 = 1000;
const NEVER: Trigger = Trigger::Epoch(u64::MAX);

/// A source of recorded data: no plant, no truth.
struct Recorded;

impl World for Recorded {
    fn disturbed(&mut self) -> Option<&mut dyn Disturbed> {
        None
    }
    fn truth(&self) -> Option<Truth> {
        None
    }
}

fn setup() -> Setup {
    Setup {
        seed: 1,
        sample_period_ns: 5_000_000,
        calibration_samples: u64::MAX,
        angle_random_walk: 2e-7,
        velocity_random_walk: 5e-4,
        turntable_rate_radps: 0.17,
        id: String::new(),
    }
}

fn spec(id: String, kind: &str, trigger: Trigger) -> FaultSpec {
    let mut values = Values::default();
    values.set("channels", Value::Channels(Channels::gyro(0)));
    values.set("amplitude", Value::Quantity(5e-5, Dimension::GyroBias));
    let schedule = Schedule { trigger, duration: None, recovery: 0, repeat: Repeat::Once };
    let kind = kinds::named(kind).expect("a kind of the catalogue");
    FaultSpec { id, kind, values, schedule }
}

fn station(kind: &str, trigger: &Trigger, faults: usize) -> Station {
    let specs: Vec<_> = (0..faults).map(|n| spec(format!("f{n}"), kind, trigger.clone())).collect();
    Station::new(&specs, &setup()).expect("values that fit")
}

fn epochs() -> Vec<Epoch> {
    let epoch = |k: u64| {
        let counts = [k as i32, 2 * k as i32, -3];
        let sample = Sample { sequence: k, delta_theta: counts, ..Sample::default() };
        Epoch { sample, aiding: None }
    };
    (0..EPOCHS).map(epoch).collect()
}

/// Stands in for the endpoint: reads the epoch.
#[inline]
fn take(epoch: &Epoch) {
    black_box(epoch);
}

fn cost(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("station");
    group.throughput(Throughput::Elements(EPOCHS));
    let epochs = epochs();
    let output = Output { mode: Mode::Calibrating, stop: 3, ..Output::default() };
    group.bench_function("none", |bencher| {
        bencher.iter(|| {
            for epoch in &epochs {
                let output = black_box(&output);
                let mut command = output.gimbal_command;
                black_box(&mut command);
                take(epoch);
            }
        });
    });
    let position = Trigger::Position { stop: 17, mode: Mode::Calibrating, delay: 0 };
    for (name, kind, trigger, faults) in [
        ("empty", "spike", NEVER, 0),
        ("waits for its time", "spike", NEVER, 1),
        ("wait for their times, 20", "spike", NEVER, 20),
        ("waits for a position", "spike", position, 1),
        ("looks back, waits for its time", "stuck-at-current", NEVER, 1),
        ("looks back, waits for a sign", "stuck-at-current", Trigger::Manual, 1),
        ("spike active", "spike", Trigger::Epoch(1), 1),
    ] {
        let mut station = station(kind, &trigger, faults);
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                for epoch in &epochs {
                    let output = black_box(&output);
                    let mut command = output.gimbal_command;
                    station.before(&mut command, output, &mut Recorded);
                    black_box(&mut command);
                    match station.after(epoch, output, &mut Recorded).delivered {
                        Delivered::Untouched => take(epoch),
                        Delivered::These(epochs) => epochs.iter().for_each(take),
                    }
                    if !station.occurrences().is_empty() {
                        station.told();
                    }
                }
            });
        });
    }
    group.finish();
}

criterion_group!(benches, cost);
criterion_main!(benches);
