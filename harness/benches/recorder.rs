//! What recording costs: on the run loop's thread, and in all.
#![allow(missing_docs, clippy::unwrap_used)]

#[path = "../tests/common/mod.rs"]
mod common;

use common::{PERIOD_NS, Step, push, stream};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use octant::recorder::{Frame, Policy, Recorder, RecorderOptions, Samples, StreamHash};
use std::hint::black_box;

const EPOCHS: u64 = 200 * 600;

fn options(samples: Samples) -> RecorderOptions {
    RecorderOptions {
        policy: Policy { samples, ..Policy::default() },
        ..RecorderOptions::default()
    }
}

/// The stream moved on in time, so that a recorder sees ever later stamps.
fn run(recorder: &mut Recorder, steps: &[Step]) {
    for step in steps {
        push(recorder, step).unwrap();
    }
}

fn recorder(c: &mut Criterion) {
    let steps = stream(EPOCHS);
    let mut group = c.benchmark_group("epoch");
    group.throughput(Throughput::Elements(EPOCHS)).sample_size(10);
    group.bench_function("none", |b| {
        b.iter(|| {
            let mut recorder = Recorder::none();
            run(&mut recorder, &steps);
            recorder.finish().unwrap()
        });
    });
    group.bench_function("stream hash alone", |b| {
        b.iter(|| {
            let mut hash = StreamHash::new();
            for step in &steps {
                hash.epoch(&step.faulted.sample, step.faulted.aiding.as_ref(), &step.output);
            }
            hash.hex()
        });
    });
    group.bench_function("hash only", |b| {
        b.iter(|| {
            let mut recorder = Recorder::hash_only(&options(Samples::Decimated)).unwrap();
            run(&mut recorder, &steps);
            recorder.finish().unwrap()
        });
    });
    for samples in [Samples::Decimated, Samples::Full] {
        group.bench_function(format!("file, {}", samples.name()), |b| {
            b.iter(|| {
                let mut recorder = Recorder::to_writer(std::io::sink(), &options(samples)).unwrap();
                run(&mut recorder, &steps);
                recorder.finish().unwrap()
            });
        });
    }
    group.finish();

    // The loop's own cost: no more blocks are filled than circulate, so it never waits.
    let mut group = c.benchmark_group("loop thread");
    let block = 1024;
    let few = &steps[..16 * block];
    group.throughput(Throughput::Elements(few.len() as u64)).sample_size(20);
    group.bench_function("push", |b| {
        b.iter_batched_ref(
            || {
                let options = RecorderOptions { blocks: 20, ..options(Samples::Decimated) };
                let mut recorder = Recorder::hash_only(&options).unwrap();
                // Touch every buffer once: steady state.
                run(&mut recorder, few);
                recorder
            },
            |recorder| {
                for step in few {
                    let frame =
                        Frame { clean: &step.clean, faulted: &step.clean, output: &step.output };
                    recorder.push(black_box(frame)).unwrap();
                    if recorder.parameters_due() {
                        recorder.extra(&octant::recorder::Extra::Parameters(
                            step.parameters.unwrap_or(octant::endpoint::ParameterEstimate {
                                revision: 0,
                                parameters: Default::default(),
                                sigma: [0.0; 30],
                            }),
                        ));
                    }
                }
            },
            criterion::BatchSize::PerIteration,
        );
    });
    group.finish();

    for samples in [Samples::Decimated, Samples::Full] {
        let mut recorder = Recorder::to_writer(std::io::sink(), &options(samples)).unwrap();
        run(&mut recorder, &steps);
        let summary = recorder.finish().unwrap();
        let hours = (EPOCHS * PERIOD_NS) as f64 * 1e-9 / 3600.0;
        eprintln!("{}: {:.2} MB per hour", samples.name(), summary.bytes as f64 / hours * 1e-6);
    }
}

criterion_group!(benches, recorder);
criterion_main!(benches);
