//! Cost of recording: on the run loop's thread, and in total.
#![allow(missing_docs, clippy::unwrap_used)]

#[path = "../../../results/recorder/tests/common/epochs.rs"]
#[allow(dead_code, reason = "the tests use more of it")]
mod epochs;
#[path = "../../../results/recorder/tests/common/stream.rs"]
mod stream;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use epochs::{PERIOD_NS, Step, push};
use octant_recorder::{EpochFrame, Policy, Recorder, RecorderOptions, Samples, StreamHash};
use std::hint::black_box;
use stream::stream;

const EPOCHS: u64 = 200 * 600;

fn options(samples: Samples) -> RecorderOptions {
    RecorderOptions {
        policy: Policy { samples, ..Policy::default() },
        ..RecorderOptions::default()
    }
}

/// Records the steps with increasing stamps, as a recorder requires.
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
            let mut recorder = Recorder::hash_only(&options(Samples::Decimated));
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

    loop_thread(&steps);
    for samples in [Samples::Decimated, Samples::Full] {
        let mut recorder = Recorder::to_writer(std::io::sink(), &options(samples)).unwrap();
        run(&mut recorder, &steps);
        let summary = recorder.finish().unwrap();
        let hours = (EPOCHS * PERIOD_NS) as f64 * 1e-9 / 3600.0;
        eprintln!("{}: {:.2} MB per hour", samples.name(), summary.bytes as f64 / hours * 1e-6);
    }
}

/// Measures the loop's own cost: the shortest of many rounds in which no more blocks are filled
/// than circulate, so that the loop never waits. The epochs are few, to stay in the cache as in a
/// run.
fn loop_thread(steps: &[Step]) {
    let few = &steps[..64];
    let (blocks, block) = (20, 256);
    let mut shortest = f64::INFINITY;
    for _ in 0..50 {
        let options =
            RecorderOptions { blocks, epochs_per_block: block, ..options(Samples::Decimated) };
        let mut recorder = Recorder::hash_only(&options);
        // Every buffer is touched once before: steady state.
        for round in 0..2 {
            std::thread::sleep(std::time::Duration::from_millis(20));
            let start = std::time::Instant::now();
            for _ in 0..(blocks - 2) * block / few.len() {
                for step in few {
                    let frame = EpochFrame {
                        clean: &step.clean,
                        faulted: &step.faulted,
                        output: &step.output,
                    };
                    recorder.push(black_box(frame)).unwrap();
                }
            }
            if round == 1 {
                let ns = start.elapsed().as_nanos() as f64 / ((blocks - 2) * block) as f64;
                shortest = shortest.min(ns);
            }
        }
    }
    eprintln!("loop thread: {shortest:.1} ns per epoch");
}

criterion_group!(benches, recorder);
criterion_main!(benches);
