//! What a whole run costs on one core, without a recorder.
//!
//! The workload: the instrument of Table 1 of the paper, static, four hours of calibration in eight
//! positions, then 24 hours of free navigation with rotation: 28 h at 200 Hz, 20.16 million samples
//! through plant, core and scoring. Nothing is written.
#![allow(missing_docs, clippy::unwrap_used)]

use criterion::{Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use octant::endpoint::InProcess;
use octant::recorder::Recorder;
use octant::run::method::configurations;
use octant::run::{Control, Ended, Watcher, drive};
use octant::scenario::{Method, Scenario};
use octant::source::PlantSource;
use std::path::Path;

const SCENARIO: &str = r#"
schema = 1
title = "28 hours"
[procedure.calibration]
positions = "eight"
duration = "4 h"
[procedure.navigation]
duration = "24 h"
"#;

fn run(c: &mut Criterion) {
    let scenario = Scenario::parse(SCENARIO, "bench", Path::new(""), &[]).unwrap();
    let samples = scenario.samples().unwrap();
    assert_eq!(samples, 20_160_000);
    let (plant, core, _) = configurations(&scenario, Method::Primary, scenario.seed).unwrap();
    let mut group = c.benchmark_group("run");
    group.throughput(Throughput::Elements(samples)).sample_size(10);
    group.sampling_mode(SamplingMode::Flat);
    group.bench_function("28 h, eight positions, static", |b| {
        b.iter(|| {
            let mut source = PlantSource::new(&plant, samples).unwrap();
            let mut endpoint = InProcess::new(&core).unwrap();
            let mut watcher = Watcher::new(4.0 * 3600.0);
            let ended = drive(
                &mut source,
                &mut endpoint,
                &mut Recorder::none(),
                &mut watcher,
                &Control::default(),
            );
            assert_eq!(ended.unwrap(), Ended::Done);
            watcher.elapsed_s()
        });
    });
    group.finish();
}

criterion_group!(benches, run);
criterion_main!(benches);
