//! A whole run on one core, without a recorder: 4 h of calibration in eight positions (Table 1)
//! and 24 h of navigation by sixteen moves, static, 200 Hz: 20.16 million samples.
#![allow(missing_docs, clippy::unwrap_used)]

use criterion::{Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use octant_base::control::Control;
use octant_run::{StreamKeeping, run_method};
use octant_scenario::{Method, Scenario};
use std::path::Path;

fn bench(criterion: &mut Criterion) {
    let text = "schema = 1\n[procedure.calibration]\nduration = \"4 h\"\n\
                [procedure.navigation]\nduration = \"24 h\"\n";
    let scenario = Scenario::parse(text, "bench.toml", Path::new(""), &[]).unwrap();
    let mut group = criterion.benchmark_group("run");
    group.throughput(Throughput::Elements(scenario.samples().unwrap()));
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    group.bench_function("calibration 4 h, navigation 24 h", |bencher| {
        bencher.iter(|| {
            run_method(&scenario, Method::Primary, 1, StreamKeeping::None, &Control::default())
                .unwrap()
        });
    });
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
