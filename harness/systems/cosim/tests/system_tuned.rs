//! Parameters that change while a system runs: `octant run FILE.ssp --tune`.

use super::system::{built, request, with_arrays};
use octant_base::control::Control;
use octant_cosim::run::{PreparedSystem, Request};
use octant_cosim::summary::{SystemEnded, SystemSummary};
use octant_cosim::values::number_of;
use octant_fmu_host::description::VariableType;
use octant_sample::counts::DELTA_THETA_LSB_RAD;
use octant_verdict::Verdict;
use std::path::Path;

/// Inputs of the calibrator at each step, as bits, and the summary.
fn run(request: Request) -> (Vec<Vec<u64>>, SystemSummary) {
    let prepared = PreparedSystem::new(request).unwrap_or_else(|error| panic!("{error}"));
    let mut rows = Vec::new();
    let results = prepared
        .run_watched(&[], &Control::default(), |simulation, system| {
            let node = system.nodes.iter().position(|node| node.name == "calibrator").unwrap();
            // As numbers, so that whole numbers of both standards are alike.
            let groups = &system.nodes[node].inputs.plan.groups;
            let kinds = groups.iter().flat_map(|group| vec![group.kind; group.elements]);
            let number = |(kind, value): (VariableType, &f64)| number_of(kind, *value).unwrap();
            rows.push(
                kinds.zip(simulation.inputs(node)).map(|one| number(one).to_bits()).collect(),
            );
            Ok(())
        })
        .unwrap_or_else(|error| panic!("{error}"));
    (rows, results.summary)
}

fn tuned(path: &Path, tune: &[&str]) -> Request {
    let mut request = request(path.to_owned());
    request.said.stop_s = Some(20.0);
    request.tune = tune.iter().map(|one| (*one).to_owned()).collect();
    request
}

/// The fault adds to the value on the connection. A whole number of counts a sample leaves no remainder in the plant.
#[test]
fn a_bias_at_a_time_is_the_fault_of_that_bias_on_the_connection() {
    let counts = 4096.0;
    let angle_rad = counts * DELTA_THETA_LSB_RAD;
    let system = built().join("octant.ssp");
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("faults.toml");
    // The plant's sample of the step from 10 s on is on the connection at the next point.
    let text = format!(
        "schema = 1\n[[faults]]\nid = \"b\"\nkind = \"bias\"\nvalue = {angle_rad:e}\n\
         connection = \"calibrator.gyro.delta_theta[2]\"\ntrigger = {{ at = \"10.005 s\" }}\n"
    );
    std::fs::write(&file, text).unwrap();
    let mut faulted = tuned(&system, &[]);
    faulted.faults = Some(file);
    let (expected, _) = run(faulted);
    let (plain, untouched) = run(tuned(&system, &[]));
    // Scenarios draw the bias of the plant: the start value is in the parameters that `built` has written.
    let csv = std::fs::read_to_string(built().join("plant_lockstep.csv")).unwrap();
    let row = csv.lines().find(|line| line.starts_with("imu.parameters.gyro_bias[2],")).unwrap();
    let start: f64 = row.split(',').nth(3).unwrap().parse().unwrap();
    let bias = start + angle_rad / 0.005;
    let argument = format!("plant.imu.parameters.gyro_bias[2]={bias:e}@10 s");
    let (rows, summary) = run(tuned(&system, &[&argument]));
    assert_eq!(rows, expected);
    let differ: Vec<usize> = (0..rows.len()).filter(|row| rows[*row] != plain[*row]).collect();
    // Row n holds what was transferred at step n, which is of point n - 1. Sample 2001 is the first.
    assert_eq!((differ[0], differ.len()), (2002, rows.len() - 2002));
    assert_eq!(summary.verdict, Verdict::None);
    let told = &summary.tuned[0];
    assert_eq!((told.at_s, told.fmu.as_str(), told.done), (10.0, "plant", true));
    assert!(
        summary.text().contains("at 10 s plant got imu.parameters.gyro_bias[2]="),
        "{}",
        summary.text()
    );
    assert!(!untouched.to_json().unwrap().contains("tuned"));
    // Arrays of FMI 3.0, whole, set at an event.
    let starts: Vec<&str> = csv
        .lines()
        .filter(|line| line.starts_with("imu.parameters.gyro_bias["))
        .map(|line| line.split(',').nth(3).unwrap())
        .collect();
    let arrays = tempfile::tempdir().unwrap();
    with_arrays(arrays.path());
    let argument =
        format!("plant.imu.parameters.gyro_bias=[{},{bias:e},{}]@10 s", starts[0], starts[2]);
    let (with_arrays, _) = run(tuned(arrays.path(), &[&argument]));
    // The order of the inputs is that of the types: compared as sets of rows.
    let sorted = |rows: &[Vec<u64>]| -> Vec<Vec<u64>> {
        let sort = |row: &Vec<u64>| {
            let mut row = row.clone();
            row.sort_unstable();
            row
        };
        rows.iter().map(sort).collect()
    };
    assert_eq!(sorted(&with_arrays), sorted(&rows));
}

#[test]
fn the_value_that_it_has_changes_no_bit() {
    let system = built().join("octant.ssp");
    let (_, plain) = run(tuned(&system, &[]));
    let csv = std::fs::read_to_string(built().join("calibrator_lockstep.csv")).unwrap();
    let row = csv.lines().find(|line| line.starts_with("screening.gate.nis,")).unwrap();
    let gate = row.split(',').nth(3).unwrap();
    let same = [5, 0].map(|at_s| format!("calibrator.screening.gate.nis={gate}@{at_s} s"));
    let (_, summary) = run(tuned(&system, &same.each_ref().map(String::as_str)));
    assert_eq!(summary.stream_hash, plain.stream_hash);
    assert_eq!(summary.tuned.iter().map(|tuned| tuned.at_s).collect::<Vec<_>>(), [0.0, 5.0]);
}

#[test]
fn what_can_t_be_tuned_is_told_before_the_run() {
    let system = built().join("octant.ssp");
    for (argument, expected) in [
        ("plant.imu.angle_random_walk=1e-6", "expected FMU.VARIABLE=VALUE@TIME, such as"),
        (
            "plant.imu.angle_random_walk=1e-6@soon",
            "found the time \"soon\", expected one such as \"30 s\"",
        ),
        ("plant.imu.angle_random_walk=1e-6@20 s", "before the end at 20 s"),
        ("plant.imu.angle_random_walk=1e-6@-1 s", "from the start at 0 s on"),
        (
            "plant.imu.angle_random_walk=1e-6@1002 ms",
            "expected a communication point: the nearest are 1 s and 1.005",
        ),
        (
            "plant.turntable.rate=0.1@1 s",
            "turntable.rate is a fixed parameter, which can't change in a running FMU; it has no tunable parameters",
        ),
        ("plant.gimbal_command.roll=0.1@1 s", "gimbal_command.roll is an input: a connection or"),
        ("plant.gyro.delta_theta[1]=0.1@1 s", "gyro.delta_theta[1] is no parameter"),
        (
            "plant.imu.angle_random_wolk=1e-6@1 s",
            "the FMU has no variable \"imu.angle_random_wolk\"",
        ),
        ("plant.imu.angle_random_walk=-1@1 s", "imu.angle_random_walk is at least 0"),
        ("plant.imu.angle_random_walk=\"much\"@1 s", "found \"much\""),
        (
            "plan.imu.angle_random_walk=1@1 s",
            "\"plan\" is no FMU of the system, did you mean \"plant\"?",
        ),
    ] {
        let error = PreparedSystem::new(tuned(&system, &[argument])).err().unwrap().to_string();
        let head = expected.split("; it has").next().unwrap();
        assert!(error.contains(head) && error.contains("--tune"), "{argument}: {error}");
    }
}

/// Within its range, and nothing that a core takes: the FMU says so when the time comes.
#[test]
fn a_value_that_the_fmu_refuses_ends_the_run() {
    let system = built().join("octant.ssp");
    let (rows, summary) = run(tuned(&system, &["calibrator.screening.gate.nis=0@10 s"]));
    let SystemEnded::Failed { reason, .. } = &summary.ended else { panic!("{:?}", summary.ended) };
    assert_eq!(summary.verdict, Verdict::Error);
    assert!(
        reason.contains("calibrator refused screening.gate.nis=0 at 10 s")
            && reason.contains("gate of the innovations is 0, a positive number is expected"),
        "{reason}"
    );
    assert_eq!((rows.len(), summary.tuned[0].done), (2001, false));
}
