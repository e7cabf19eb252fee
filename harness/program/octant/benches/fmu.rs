//! Cost of an FMU: one exchange with all inputs and outputs of the Calibrator, in this process and
//! in one of its own, and a calibration with the core in an FMU beside one with the core called
//! directly.
#![allow(missing_docs, clippy::unwrap_used)]

use criterion::measurement::WallTime;
use criterion::{
    BenchmarkGroup, Criterion, SamplingMode, Throughput, criterion_group, criterion_main,
};
use octant_base::control::Control;
use octant_fmu_host::description::{Causality, VariableType};
use octant_fmu_host::instance::{AccessPlan, Instance, OpenOptions, ProcessPlace};
use octant_run::{StreamKeeping, run_method};
use octant_scenario::{Method, Scenario};
use std::path::{Path, PathBuf};

/// Builds the FMUs of this build.
fn fmus() -> (tempfile::TempDir, [PathBuf; 2]) {
    let folder = tempfile::tempdir().unwrap();
    let options = octant_fmu_build::Options { out: folder.path().into(), ..Default::default() };
    octant_fmu_build::build(&options).unwrap();
    let paths = ["calibrator_fmi2.fmu", "calibrator_fmi3.fmu"].map(|name| folder.path().join(name));
    (folder, paths)
}

/// Steps at 200 Hz, setting all inputs and reading all outputs: each step is one epoch of a static
/// base.
fn exchange(group: &mut BenchmarkGroup<WallTime>, name: &str, path: &Path, place: ProcessPlace) {
    let program = Some(PathBuf::from(env!("CARGO_BIN_EXE_octant")));
    let options = OpenOptions { place, program, ..OpenOptions::default() };
    let mut fmu = octant_fmu_host::open(path, &options).unwrap();
    let number =
        |kind| !matches!(kind, VariableType::String | VariableType::Binary | VariableType::Clock);
    let all = |causality| {
        let description = fmu.description();
        let variables: Vec<_> = description
            .variables
            .iter()
            .filter(|variable| variable.causality == causality && number(variable.kind))
            .collect();
        AccessPlan::new(description, &variables).unwrap()
    };
    let (inputs, outputs) = (all(Causality::Input), all(Causality::Output));
    let mut values = vec![0.0; inputs.elements];
    fill(&*fmu, &inputs, &mut values);
    let mut got = vec![0.0; outputs.elements];
    fmu.enter_initialization(0.0, None, None).unwrap();
    fmu.exit_initialization().unwrap();
    let mut tick = 0u64;
    group.bench_function(name, |bencher| {
        bencher.iter(|| {
            let time_s = tick as f64 * 0.005;
            tick += 1;
            fmu.exchange(&inputs.groups, &values, time_s, 0.005, &outputs.groups, &mut got).unwrap()
        });
    });
    eprintln!("  {} inputs, {} outputs", inputs.elements, outputs.elements);
}

/// Fills in a valid sample: gravity and the Earth's rate, as measured on a table that is switched
/// off.
fn fill(fmu: &dyn Instance, plan: &AccessPlan, values: &mut [f64]) {
    let description = fmu.description();
    let inputs =
        description.variables.iter().filter(|variable| variable.causality == Causality::Input);
    for (variable, place) in inputs.zip(&plan.places) {
        match variable.name.as_str() {
            "imu.valid" => values[place.start] = 1.0,
            "accelerometer.delta_velocity" => values[place.start + 2] = -9.8 * 0.005,
            "accelerometer.delta_velocity[3]" => values[place.start] = -9.8 * 0.005,
            "gyro.delta_theta" | "gyro.delta_theta[1]" => values[place.start] = 6e-5 * 0.005,
            _ => {}
        }
    }
}

/// Runs a calibration as `octant run` does, without a recording.
fn calibration(group: &mut BenchmarkGroup<WallTime>, name: &str, endpoint: &str) {
    let text = format!(
        "schema = 1\n{endpoint}\n[procedure.calibration]\nduration = \"0.5 h\"\n\
         [procedure.navigation]\nduration = \"1 s\"\n"
    );
    let scenario = Scenario::parse(&text, "bench.toml", Path::new(""), &[]).unwrap();
    group.throughput(Throughput::Elements(scenario.samples().unwrap()));
    group.bench_function(name, |bencher| {
        bencher.iter(|| {
            run_method(&scenario, Method::Primary, 1, StreamKeeping::None, &Control::default())
                .unwrap()
        });
    });
}

fn bench(criterion: &mut Criterion) {
    let (_folder, [fmi2, fmi3]) = fmus();
    let mut group = criterion.benchmark_group("exchange");
    for (place, words) in
        [(ProcessPlace::ThisProcess, "this process"), (ProcessPlace::OwnProcess, "own process")]
    {
        exchange(&mut group, &format!("FMI 2.0, {words}"), &fmi2, place);
        exchange(&mut group, &format!("FMI 3.0, {words}"), &fmi3, place);
    }
    group.finish();
    let mut group = criterion.benchmark_group("calibration 0.5 h");
    group.sample_size(10).sampling_mode(SamplingMode::Flat);
    calibration(&mut group, "core", "");
    for (path, standard) in [(&fmi2, "FMI 2.0"), (&fmi3, "FMI 3.0")] {
        for (process, words) in [("shared", "this process"), ("own", "own process")] {
            let endpoint = format!(
                "[endpoint]\nuri = {:?}\n[endpoint.fmu]\nprocess = {process:?}",
                format!("fmu:{}", path.display())
            );
            calibration(&mut group, &format!("{standard}, {words}"), &endpoint);
        }
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
