//! Cost of model exchange: a hundred steps of 10 ms by Octant's solver, each with one output read. The FMUs
//! are small, so that the solver and the calls are what costs.
//!
//! - `van der Pol`: two states, not linear; the solver goes on from step to step.
//! - `decay`: one state, and an input that is set anew before each step, which is an event: the solver
//!   starts again.
#![allow(missing_docs, clippy::unwrap_used)]

#[allow(dead_code, reason = "a module of the tests, which use all of it")]
#[path = "../tests/common/foreign.rs"]
mod foreign;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use octant_fmu_host::instance::{
    Instance, InterfaceKind, OpenOptions, ProcessPlace, StepOutcome, VariableGroup,
};

const STEPS: u64 = 100;
const STEP_S: f64 = 0.01;
const TOLERANCE: f64 = 1e-6;

/// Opens an FMU in this process and initializes it.
fn started(name: &str) -> Box<dyn Instance> {
    let options = OpenOptions {
        place: ProcessPlace::ThisProcess,
        interface: InterfaceKind::ModelExchange,
        ..OpenOptions::default()
    };
    let mut fmu = octant_fmu_host::open(&foreign::fmu(name), &options).unwrap();
    fmu.enter_initialization(0.0, None, Some(TOLERANCE)).unwrap();
    fmu.exit_initialization().unwrap();
    fmu
}

fn group(fmu: &dyn Instance, name: &str) -> VariableGroup {
    let description = fmu.description();
    VariableGroup::of(description, description.variable(name).unwrap()).unwrap()
}

fn bench(criterion: &mut Criterion) {
    let mut benches = criterion.benchmark_group("model exchange");
    benches.throughput(Throughput::Elements(STEPS));
    for (words, name, output, input) in [
        ("van der Pol, FMI 2.0", "vanderpol_fmi2", "x0", None),
        ("van der Pol, FMI 3.0", "vanderpol_fmi3", "x0", None),
        ("decay with a new input, FMI 3.0", "dahlquist_fmi3", "x", Some("u")),
    ] {
        let mut fmu = started(name);
        let output = group(&*fmu, output);
        let input = input.map(|name| group(&*fmu, name));
        let (mut tick, mut got) = (0u64, [f64::NAN]);
        benches.bench_function(words, |bencher| {
            bencher.iter(|| {
                for _ in 0..STEPS {
                    if let Some(input) = &input {
                        fmu.set(input, &[(tick % 7) as f64 - 3.0]).unwrap();
                    }
                    let stepped = fmu.step(tick as f64 * STEP_S, STEP_S).unwrap();
                    assert_eq!(stepped.outcome, StepOutcome::Done);
                    fmu.get(&output, &mut got).unwrap();
                    tick += 1;
                }
                got
            });
        });
    }
    benches.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
