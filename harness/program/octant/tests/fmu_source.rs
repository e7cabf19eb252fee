//! FMUs as source and as endpoint, as a user runs them: our own to the bit, and foreign ones.

use crate::common::foreign;
use crate::common::program::{ends, json, octant};
use octant_fmu_build::{Options, build};
use octant_recorder::reader::{Item, Recording};
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{Mode, Output as Answer, Sample, Status, Truth};
use octant_test_processes::command;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Builds our own FMUs once, and returns one.
fn own(name: &str) -> String {
    static FOLDER: OnceLock<tempfile::TempDir> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        build(&Options { out: folder.path().to_owned(), ..Options::default() }).unwrap();
        folder
    });
    folder.path().join(format!("{name}.fmu")).display().to_string()
}

fn file(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path.display().to_string()
}

/// Content of a recording.
#[derive(Default)]
struct Kept {
    truncated: bool,
    samples: Vec<Sample>,
    outputs: Vec<Answer>,
    truths: Vec<Truth>,
}

fn recording(run: &Path) -> Kept {
    let mut recording = Recording::open(&run.join("recording.mcap")).unwrap();
    let mut kept = Kept::default();
    while let Some((_, item)) = recording.next_item().unwrap() {
        match item {
            Item::Sample(sample) => kept.samples.push(sample),
            Item::Output(output) => kept.outputs.push(output),
            Item::Truth(truth) => kept.truths.push(truth),
            _ => {}
        }
    }
    kept.truncated = recording.truncated();
    kept
}

const LOCKSTEP: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/scenarios/lockstep.toml");

/// Text of the reference scenario with half of its time and a quarter of its rate: the same stops, moves
/// and modes. The rig `fmu-bits` has it at its own rate.
fn five_minutes() -> String {
    let text = std::fs::read_to_string(LOCKSTEP).unwrap();
    let text = text.replace("8 min", "4 min").replace("2 min", "1 min");
    format!("{text}\n[imu]\nrate = \"50 Hz\"\n")
}

/// Path of the scenario, which is written once.
fn lockstep() -> &'static str {
    static FILE: OnceLock<(tempfile::TempDir, String)> = OnceLock::new();
    let written = || {
        let folder = tempfile::tempdir().unwrap();
        let path = file(folder.path(), "lockstep.toml", &five_minutes());
        (folder, path)
    };
    &FILE.get_or_init(written).1
}

/// Returns the stream hash of the reference run.
fn in_process() -> &'static (String, Value) {
    static HASH: OnceLock<(String, Value)> = OnceLock::new();
    HASH.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("run");
        ends(&["run", lockstep(), "--out", out.to_str().unwrap()], 0);
        let summary = json(&out.join("summary.json"));
        (summary["stream_hash"].as_str().unwrap().to_owned(), summary)
    })
}

#[test]
fn our_calibrator_gives_the_same_bits_in_both_standards_and_both_processes() {
    let (expected, _) = in_process();
    for name in ["calibrator_fmi2", "calibrator_fmi3"] {
        for process in ["own", "shared"] {
            let fmu = own(name);
            let arguments =
                ["fmu", "run", &fmu, "--source", lockstep(), "--process", process, "--json"];
            let (text, _) = ends(&arguments, 0);
            let told: Value = serde_json::from_str(&text).unwrap();
            assert_eq!(told["samples"], 15_000);
            assert_eq!(told["ended"], "done");
            assert_eq!(told["stream_hash"], expected.as_str(), "{name} {process}");
        }
    }
}

#[test]
fn both_ends_as_fmus_give_the_same_run_and_the_manifest_names_them() {
    let (expected, summary) = in_process();
    let folder = tempfile::tempdir().unwrap();
    for (source, endpoint) in [("plant_fmi2", "calibrator_fmi3"), ("plant_fmi3", "calibrator_fmi2")]
    {
        let out = folder.path().join(source);
        let run = out.to_str().unwrap();
        let (source_fmu, endpoint_fmu) = (own(source), own(endpoint));
        let (source_uri, endpoint_uri) =
            (format!("fmu:{source_fmu}"), format!("fmu:{endpoint_fmu}"));
        let shared = ["--set", "source.fmu.process=shared"];
        let arguments =
            ["run", lockstep(), "--out", run, "--source", &source_uri, "--endpoint", &endpoint_uri];
        ends(&[&arguments[..], &shared].concat(), 0);
        let found = json(&out.join("summary.json"));
        assert_eq!(found["stream_hash"], expected.as_str());
        // Also the parts outside the stream: truth, final σ, scores.
        assert_eq!(found["navigation"], summary["navigation"]);
        assert_eq!(found["calibration"]["parameters"], summary["calibration"]["parameters"]);
        assert_eq!(found["calibration"]["nees"], summary["calibration"]["nees"]);
        let manifest = json(&out.join("manifest.json"));
        let [first, second] = manifest["fmus"].as_array().unwrap().as_slice() else {
            panic!("{manifest}")
        };
        assert_eq!((&first["role"], &first["model"]), (&"source".into(), &"Plant".into()));
        assert_eq!((&first["process"], &second["process"]), (&"shared".into(), &"own".into()));
        assert_eq!(second["model"], "Calibrator");
        assert_eq!(second["file"], endpoint_fmu.as_str());
        assert!(second["generation_tool"].as_str().unwrap().starts_with("Octant "));
        let digest = command("sha256sum").arg(&endpoint_fmu).output().unwrap().stdout;
        let digest = String::from_utf8(digest).unwrap();
        assert_eq!(second["sha256"], digest.split_whitespace().next().unwrap());
        // The core on the recording, again in the FMU.
        let replayed = out.join("recording.mcap");
        let (text, _) = ends(&["replay", replayed.to_str().unwrap()], 0);
        assert!(text.contains("is equal to the recorded one") && text.contains(expected), "{text}");
        let (scored, _) = ends(&["score", replayed.to_str().unwrap(), "--json"], 0);
        let scored: Value = serde_json::from_str(&scored).unwrap();
        assert!(scored["parameters"]["g_zz"]["true"].is_number(), "{scored}");
        // The resolved scenario makes the same run.
        let again = folder.path().join(format!("{source}-again"));
        let resolved = out.join("scenario.toml");
        ends(&["run", resolved.to_str().unwrap(), "--out", again.to_str().unwrap()], 0);
        assert_eq!(json(&again.join("summary.json"))["stream_hash"], expected.as_str());
    }
}

#[test]
fn faults_between_fmus_do_what_they_do_in_process() {
    let folder = tempfile::tempdir().unwrap();
    let text = five_minutes();
    let faults = "[[faults]]\nid = \"spike-1\"\nkind = \"spike\"\nchannels = \"gyro x\"\n\
        amplitude = \"1000 deg/h\"\ntrigger = { at = \"100 s\" }\nduration = \"20 samples\"\n\
        [[faults]]\nid = \"out-1\"\nkind = \"dropout\"\ntrigger = { at = \"120 s\" }\n\
        duration = \"0.1 s\"\n\
        [[faults]]\nid = \"table-1\"\nkind = \"stale-table\"\ngyro_bias = [\"0.01 deg/h\", \"0 deg/h\", \
        \"0 deg/h\"]\naccel_bias = [\"200 ug\", \"0 ug\", \"0 ug\"]\ntrigger = { at = \"150 s\" }\n\
        [[faults]]\nid = \"lost-1\"\nkind = \"command-lost\"\ntrigger = { moving_to = 3 }\n\
        duration = \"5 s\"\n";
    let scenario = file(folder.path(), "s.toml", &format!("{text}\n{faults}"));
    let run = |name: &str, more: &[&str]| {
        let out = folder.path().join(name);
        let arguments = ["run", &scenario, "--out", out.to_str().unwrap(), "--json"];
        let output = octant(&[&arguments[..], more].concat());
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        let summary: Value =
            serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{error}"));
        summary
    };
    let inside = run("inside", &[]);
    let (source, endpoint) = (own("plant_fmi3"), own("calibrator_fmi2"));
    let (source, endpoint) = (format!("fmu:{source}"), format!("fmu:{endpoint}"));
    let outside = run("outside", &["--source", &source, "--endpoint", &endpoint]);
    assert_eq!(inside["faults"][3]["fired"], true, "{inside}");
    assert_eq!(outside["stream_hash"], inside["stream_hash"]);
    assert_eq!(outside["faults"], inside["faults"]);
    assert_eq!(outside["counterfactual"], inside["counterfactual"], "against the twin");
}

const IMU: &str = "schema = 1\ntitle = \"foreign\"\n[procedure.calibration]\nduration = \"4 min\"\n\
    estimator = \"least-squares\"\nstops = [{}, { azimuth = \"90 deg\" }]\n\
    [procedure.calibration.least_squares]\nintervals = \"commanded\"\n\
    [record]\nsamples = \"full\"\n[source]\nuri = \"fmu:IMU\"\n[source.fmu.map]\n\
    gyro.rate = \"imu.w\"\n\
    accelerometer.specific_force = [{ variable = \"imu.fx\", unit = \"g\" }, \
    { variable = \"-imu.fy\", unit = \"g\" }, { variable = \"imu.fz\", unit = \"g\" }]\n\
    gimbal.azimuth = \"table.azimuth\"\ngimbal.roll = \"table.elevation\"\n\
    gimbal_command.azimuth = \"table.to_azimuth\"\ngimbal_command.roll = \"table.to_elevation\"\n\
    [source.fmu.parameters]\nbase.omega = 1.5\nbase.rate = \"2 deg/s\"\n";

pub(super) fn imu(more: &str) -> String {
    let fmu = foreign::fmu("imu_fmi2");
    format!("{}{more}", IMU.replace("IMU", fmu.to_str().unwrap()))
}

#[test]
fn a_foreign_instrument_gives_the_counts_of_its_closed_form() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let scenario = file(folder.path(), "imu.toml", &imu(""));
    octant(&["run", &scenario, "--out", out.to_str().unwrap()]);
    let kept = recording(&out);
    let samples = &kept.samples;
    assert_eq!(samples.len(), 48_000);
    let (mut angle, mut sums, mut moved) = (0.0, [0i64; 4], None);
    for (index, sample) in samples.iter().enumerate() {
        let k = index as f64 + 1.0;
        // 2 deg/s · sin(1.5 t) at the end of each interval, held over 5 ms.
        angle += 2f64.to_radians() * (1.5 * k * 0.005).sin() * 0.005;
        sums[0] += i64::from(sample.delta_theta[0]);
        // The factors in the file have fifteen digits.
        assert!(
            (sums[0] as f64 * DELTA_THETA_LSB_RAD - angle).abs() < 1e-13 * k + DELTA_THETA_LSB_RAD
        );
        for (axis, g) in [0.1, -0.2, -1.0].into_iter().enumerate() {
            sums[1 + axis] += i64::from(sample.delta_velocity[axis]);
            let velocity = g * 9.806_65 * k * 0.005;
            let found = sums[1 + axis] as f64 * DELTA_VELOCITY_LSB_MPS;
            assert!((found - velocity).abs() < DELTA_VELOCITY_LSB_MPS, "{index}");
        }
        assert_eq!(sample.status, Status::empty());
        if moved.is_none() && sample.gimbal.azimuth != 0 {
            moved = Some(index);
            assert!((sample.gimbal.azimuth_rad().to_degrees() - 90.0).abs() < 1e-6);
        }
    }
    // The core's set point of output k acts in sample k + 2.
    let told =
        kept.outputs.iter().position(|output| output.gimbal_command.target.azimuth != 0).unwrap();
    assert_eq!(moved, Some(told + 2));
}

/// Runs an FMU that crashes or hangs; returns the message, the summary and the number of samples.
fn broken(folder: &Path, scenario: &str) -> (String, Value, usize) {
    let out = folder.join("run");
    let scenario = file(folder, "s.toml", scenario);
    let (_, error) = ends(&["run", &scenario, "--out", out.to_str().unwrap()], 4);
    assert!(!out.exists(), "an unfinished run keeps its name");
    let partial = folder.join("run.partial");
    assert!(error.contains("the recorded part is in") && error.contains("run.partial"), "{error}");
    let summary = json(&partial.join("summary.json"));
    assert_eq!(summary["verdict"], "error");
    assert!(error.contains(summary["reasons"][0].as_str().unwrap()), "{error}");
    let kept = recording(&partial);
    assert!(!kept.truncated, "the file has its end");
    assert!(partial.join("manifest.json").exists() && partial.join("report.html").exists());
    (error, summary, kept.samples.len())
}

#[test]
fn an_instrument_that_crashes_or_hangs_ends_the_run_with_what_was_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let crash = imu("from = 20.0\ntrouble = 1\n");
    let (_, summary, samples) = broken(folder.path(), &crash);
    assert_eq!(samples, 4000);
    let reason = summary["reasons"][0].as_str().unwrap();
    assert!(reason.starts_with("after 20.000 s: source fmu:"), "{reason}");
    assert!(
        reason.contains("at 20 s") && reason.contains("was ended by SIGSEGV in fmi2DoStep"),
        "{reason}"
    );
    std::fs::remove_dir_all(folder.path().join("run.partial")).unwrap();
    let hang = imu("from = \"5 s\"\ntrouble = 2\n")
        .replace("[source.fmu.map]", "[source.fmu]\ntime_limit = \"5 s\"\n[source.fmu.map]");
    let (_, summary, samples) = broken(folder.path(), &hang);
    assert_eq!(samples, 1000);
    let reason = summary["reasons"][0].as_str().unwrap();
    assert!(reason.contains("fmi2DoStep") && reason.contains("for 5 s"), "{reason}");
}

const CORE: &str = "schema = 1\ntitle = \"another's core\"\n[imu]\nrate = \"100 Hz\"\n\
    [procedure.calibration]\nduration = \"60 s\"\nstops = [{}, { azimuth = \"90 deg\" }]\n\
    [procedure.navigation]\nduration = \"60 s\"\n[record]\nsamples = \"full\"\n\
    [endpoint]\nuri = \"fmu:CORE\"\n[endpoint.fmu]\n\
    modes = { calibrating = [\"standing\", \"turned\"], navigating = 30 }\n\
    [endpoint.fmu.parameters]\nturn_at = \"12 s\"\n[endpoint.fmu.map]\ngyro.rate = \"w\"\n\
    accelerometer.specific_force = \"f\"\nreference.velocity = \"log.v\"\n\
    reference.valid = \"log.fresh\"\ngimbal_command.azimuth = \"table.azimuth\"\n\
    gimbal_command.roll = \"table.roll\"\nmode = \"phase\"\nnavigation.latitude = \"lat\"\n\
    navigation.longitude = \"lon\"\nnavigation.height = \"h\"\nparameters.gyro_bias = \"bias\"\n";

pub(super) fn core(more: &str) -> String {
    let fmu = foreign::fmu("core_fmi2");
    CORE.replace("CORE", fmu.to_str().unwrap()).replace("turn_at", &format!("{more}turn_at"))
}

#[test]
fn a_foreign_core_commands_the_gimbals_and_is_scored() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let scenario = file(folder.path(), "core.toml", &core(""));
    // The FMU reports no navigation: the position stays at its start.
    let (said, _) = ends(&["run", &scenario, "--out", out.to_str().unwrap()], 3);
    assert!(said.contains("the position of the navigation doesn't follow the samples"), "{said}");
    let kept = recording(&out);
    let (samples, outputs) = (&kept.samples, &kept.outputs);
    assert_eq!(outputs.len(), 12_000);
    let told = outputs.iter().position(|o| o.gimbal_command.target.azimuth != 0).unwrap();
    assert_eq!(told + 1, 1200, "at 12 s");
    assert_eq!(outputs[5998].mode, Mode::Calibrating);
    assert_eq!(outputs[5999].mode, Mode::Navigating);
    let last = samples.last().unwrap().gimbal;
    assert!((last.azimuth_rad().to_degrees() - 90.0).abs() < 0.05, "{last:?}");
    assert!((last.roll_rad().to_degrees() + 45.0).abs() < 0.05, "{last:?}");
    // The estimate is the mean of its input rates, at the last reference.
    let mean: f64 = samples[..6000]
        .iter()
        .map(|sample| f64::from(sample.delta_theta[2]) * DELTA_THETA_LSB_RAD / 0.01)
        .sum::<f64>()
        / 6000.0;
    let summary = json(&out.join("summary.json"));
    let bias = &summary["calibration"]["parameters"]["gyro_bias_z"];
    assert_eq!(bias["unit"], "deg/h");
    let found = bias["estimate"].as_f64().unwrap();
    assert!((found / (mean.to_degrees() * 3600.0) - 1.0).abs() < 1e-9, "{bias} {mean}");
    assert!(bias["sigma"].is_null());
    // The reported position doesn't change, and neither does the plant's.
    let radial = summary["navigation"]["radial_error_nmi"]["max"].as_f64().unwrap();
    assert!(radial < 1e-6, "{radial}");
}

#[test]
fn a_core_that_crashes_or_hangs_ends_the_run_with_what_was_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let (_, summary, samples) = broken(folder.path(), &core("from = 30\ntrouble = 1\n"));
    assert_eq!(samples, 3000);
    let reason = summary["reasons"][0].as_str().unwrap();
    assert!(reason.starts_with("after 30.000 s: endpoint fmu:"), "{reason}");
    assert!(reason.contains("was ended by SIGSEGV in fmi2DoStep"), "{reason}");
    std::fs::remove_dir_all(folder.path().join("run.partial")).unwrap();
    let hang = core("from = 1\ntrouble = 2\n")
        .replace("[endpoint.fmu]\n", "[endpoint.fmu]\ntime_limit = \"5 s\"\n");
    let (_, _, samples) = broken(folder.path(), &hang);
    assert_eq!(samples, 100);
}

#[test]
fn what_is_wrong_with_an_fmu_is_said_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let here = folder.path();
    std::fs::write(here.join("no.fmu"), "not a zip").unwrap();
    for (scenario, expected) in [
        (
            imu("").replace("\"imu.w\"", "\"imu.ww\""),
            "s.toml:14:13: source.fmu.map.gyro.rate: the FMU has no variable \"imu.ww\"; nearest are \"imu.w[1]\"",
        ),
        (
            imu("").replace("\"-imu.fy\", unit = \"g\"", "\"-imu.fy\", unit = \"m\""),
            "expected an acceleration",
        ),
        (
            imu("").replace("\"table.azimuth\"", "\"imu.w[1]\""),
            "imu.w[1] is in deg/h, an angular rate, and gimbal.azimuth is an angle",
        ),
        (imu("trouble = 3\n"), "found 3, and trouble is at most 2"),
        (
            imu("bas.omega = 3\n"),
            "the FMU has no variable \"bas.omega\"; nearest are \"base.omega\"",
        ),
        (imu("").replace("imu_fmi2.fmu", "nowhere.fmu"), "nowhere.fmu"),
        (imu("").replace(foreign::fmu("imu_fmi2").to_str().unwrap(), "no.fmu"), "no.fmu"),
        (
            imu("").replace(
                "[source.fmu.map]",
                "[source.fmu]\ninterface = \"model-exchange\"\n[source.fmu.map]",
            ),
            "can't run by model exchange: it has co-simulation",
        ),
        (
            core("").replace("\"turned\"", "\"turning\""),
            "modes.calibrating: found \"turning\", expected a value of phase: standing, turned, sailing",
        ),
        (
            core("") + "[baseline]\nstops = [{}, { azimuth = \"90 deg\" }]\n",
            "only the Calibrator takes a second method",
        ),
    ] {
        let path = file(here, "s.toml", &scenario);
        let (_, error) = ends(&["run", &path, "--out", out.to_str().unwrap()], 2);
        assert!(error.contains(expected), "{error}\n{expected}");
        assert!(!here.join("run.partial").exists() && !out.exists());
    }
    // If a process can hold only one FMU of a kind, two are refused.
    let mut fmu = PathBuf::from(own("calibrator_fmi2"));
    fmu.set_extension("nothing");
    let (_, error) = ends(&["run", LOCKSTEP, "--endpoint", &format!("fmu:{}", fmu.display())], 2);
    assert!(error.contains("calibrator_fmi2.nothing"), "{error}");
}

/// An oscillator in model exchange rolls the case; the plant on it senses that motion, and its
/// truth contains it.
#[test]
fn a_foreign_ship_in_model_exchange_moves_the_plant() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("run");
    let fmu = foreign::fmu("vanderpol_fmi2");
    let scenario = format!(
        "schema = 1\ntitle = \"on a foreign ship\"\n[motion]\nkind = \"dockside\"\nheading = \"30 deg\"\n\
         [procedure.calibration]\nduration = \"60 s\"\nstops = [{{}}]\n[record]\nsamples = \"full\"\n\
         [source]\nuri = \"fmu:{}\"\n[source.fmu]\nstep = \"10 ms\"\ntolerance = 1e-9\n[source.fmu.map]\n\
         case.roll = {{ variable = \"x0\", unit = \"deg\" }}\n",
        fmu.display()
    );
    let scenario = file(folder.path(), "s.toml", &scenario);
    let output = octant(&["run", &scenario, "--out", out.to_str().unwrap()]);
    assert!(
        matches!(output.status.code(), Some(0 | 1)),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    // The oscillator's motion, from the program's own run of it.
    let rows = folder.path().join("rows.csv");
    let (fmu, rows) = (fmu.to_str().unwrap(), rows.to_str().unwrap());
    ends(
        &[
            "fmu",
            "run",
            fmu,
            "--stop",
            "60",
            "--step",
            "0.01",
            "--tolerance",
            "1e-9",
            "--output",
            "x0",
            "--out",
            rows,
        ],
        0,
    );
    let text = std::fs::read_to_string(rows).unwrap();
    let roll_deg: Vec<f64> =
        text.lines().skip(1).map(|line| line.split(',').nth(1).unwrap().parse().unwrap()).collect();
    assert_eq!(roll_deg.len(), 6001);
    assert!(roll_deg.iter().any(|x| *x > 1.9) && roll_deg.iter().any(|x| *x < -1.9));
    let kept = recording(&out);
    let mut truths = 0;
    for truth in &kept.truths {
        let k = truth.time.ns / 10_000_000;
        let [w, x, y, z] = truth.q_nb;
        let roll = (2.0 * (w * x + y * z)).atan2(1.0 - 2.0 * (x * x + y * y)).to_degrees();
        let heading = (2.0 * (w * z + x * y)).atan2(1.0 - 2.0 * (y * y + z * z)).to_degrees();
        if truth.time.ns % 10_000_000 == 0 {
            assert!((roll - roll_deg[k as usize]).abs() < 1e-6, "{roll} at {k}");
            truths += 1;
        }
        assert!((heading - 30.0).abs() < 1e-9);
    }
    assert!(truths >= 59, "{truths}");
    // The gyro about x measures the roll: its integral is the angle, except for Earth's rate (0.25°
    // in a minute) and the sensor's errors.
    let turned: i64 = kept.samples.iter().map(|sample| i64::from(sample.delta_theta[0])).sum();
    let turned = (turned as f64 * DELTA_THETA_LSB_RAD).to_degrees();
    assert!((turned - (roll_deg[6000] - roll_deg[0])).abs() < 0.3, "{turned}");
}

#[test]
fn any_fmu_is_stepped_with_inputs_from_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let fmu = foreign::fmu("gain_fmi2");
    let fmu = fmu.to_str().unwrap();
    let inputs = file(folder.path(), "in.csv", "time,u,n\n0,1,3\n1,3,4\n");
    let out = folder.path().join("out.csv");
    let out = out.to_str().unwrap();
    let common = ["fmu", "run", fmu, "--input", &inputs, "--set", "gain=0.5"];
    for process in ["own", "shared"] {
        let more = ["--step", "100 ms", "--out", out, "--force", "--process", process];
        let (text, _) = ends(&[&common[..], &more].concat(), 0);
        assert!(
            text.contains("Gain, FMI 2.0, co-simulation")
                && text.contains("10 steps of 0.1 s from 0 s to 1 s"),
            "{text}"
        );
        let rows = std::fs::read_to_string(out).unwrap();
        let lines: Vec<&str> = rows.lines().collect();
        assert!(lines[0].starts_with("\"time\",\"y\",\"n_next\""), "{}", lines[0]);
        assert_eq!(lines.len(), 12);
        let last: Vec<&str> = lines[11].split(',').collect();
        assert_eq!(last[0], "1.0");
        // Integral of half of u, which is sampled at the start of each step: 1, 1.2, … 2.8.
        let y: f64 = last[1].parse().unwrap();
        assert!((y - 0.5 * 0.1 * 19.0).abs() < 1e-12, "{y}");
    }
    let (_, error) = ends(&[&common[..], &["--out", out]].concat(), 2);
    assert!(error.contains("the file exists already; --force replaces it"), "{error}");
    let (text, _) = ends(&[&common[..], &["--json"]].concat(), 0);
    let told: Value = serde_json::from_str(&text).unwrap();
    assert_eq!((&told["steps"], &told["process"]), (&100.into(), &"own".into()));
    for (more, expected) in [
        (
            &["--set", "gian=1"][..],
            "--set gian=1: gian: the FMU has no variable \"gian\"; nearest are \"gain\"",
        ),
        (&["--set", "gain=high"], "--set gain=high: gain: found \"high\", and gain is a Float64"),
        (&["--set", "y=1"], "y can't be set"),
        (&["--set", "ratio=2"], "found 2, and ratio is at most 1"),
        (&["--set", "mode=idle"], ""),
        (&["--set", "mode=off"], "expected one of \"idle\" (1), \"busy\" (2)"),
        (&["--stop", "-1"], "a stop at or after the start"),
        (&["--step", "soon"], "--step: found \"soon\", expected a time"),
        (&["--output", "yy", "--out", "rows.csv"], "the FMU has no variable \"yy\""),
        (&["--output", "y"], "--out"),
        (&["--interface", "me"], "can't run by model exchange"),
        (&["--out", "rows.txt"], "expected a name that ends in .csv or .mcap"),
    ] {
        let status = if expected.is_empty() { 0 } else { 2 };
        let (_, error) = ends(&[&common[..], more].concat(), status);
        assert!(error.contains(expected), "{error}\n{expected}");
    }
    let wrong = file(folder.path(), "wrong.csv", "time,u,n\n0,1,3\n1,x,4\n");
    let (_, error) = ends(&["fmu", "run", fmu, "--input", &wrong], 2);
    assert!(error.contains("wrong.csv:3:2: found \"x\", expected a number"), "{error}");
}

#[test]
fn an_fmu_that_crashes_under_fmu_run_leaves_its_rows() {
    let folder = tempfile::tempdir().unwrap();
    let fmu = foreign::fmu("trouble_fmi2");
    let out = folder.path().join("out.csv");
    let arguments = ["fmu", "run", fmu.to_str().unwrap(), "--stop", "1", "--step", "0.1", "--out"];
    let more = ["--set", "place=4", "--set", "trouble=1", "--set", "from=0.5"];
    let (_, error) = ends(&[&arguments[..], &[out.to_str().unwrap()], &more].concat(), 4);
    assert!(error.contains("was ended by SIGSEGV in fmi2DoStep"), "{error}");
    assert!(error.contains("the outputs before that are in"), "{error}");
    assert_eq!(
        std::fs::read_to_string(&out).unwrap().lines().count(),
        7,
        "a header, and 0 to 0.5 s"
    );
}

#[test]
fn the_time_limit_holds_while_the_fmu_is_loaded_and_made() {
    let hang = "#include <unistd.h>\n__attribute__((constructor)) static void f(void) { for (;;) pause(); }";
    let instantiate = "#include <unistd.h>\nvoid *fmi2Instantiate(void) { for (;;) pause(); }";
    for (code, replaced, named) in [
        (hang, &[][..], "the loading of its library"),
        (instantiate, &["fmi2Instantiate"], "fmi2Instantiate"),
    ] {
        let folder = foreign::altered("gain_fmi2", code, replaced);
        let fmu = folder.path().to_str().unwrap();
        let (_, error) = ends(&["fmu", "run", fmu, "--stop", "1", "--time-limit", "5 s"], 4);
        assert!(error.contains(&format!("gave no answer to {named} for 5 s")), "{error}");
    }
    let fmu = foreign::fmu("gain_fmi2");
    let arguments = ["fmu", "run", fmu.to_str().unwrap(), "--stop", "1", "--time-limit", "0 s"];
    let (_, error) = ends(&arguments, 2);
    assert!(error.contains("--time-limit: found \"0 s\", expected a time above 0"), "{error}");
}

#[test]
fn an_fmu_that_fails_at_its_end_leaves_all_rows() {
    for (replaced, code, expected) in foreign::BAD_ENDS {
        let fmu = foreign::altered("gain_fmi2", code, replaced);
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out.csv");
        let arguments =
            ["fmu", "run", fmu.path().to_str().unwrap(), "--stop", "1", "--step", "0.1"];
        let more = ["--time-limit", "5 s", "--out", out.to_str().unwrap()];
        let (_, error) = ends(&[&arguments[..], &more].concat(), 4);
        assert!(error.contains(expected), "{error}");
        assert!(error.contains("the outputs before that are in"), "{error}");
        assert_eq!(std::fs::read_to_string(&out).unwrap().lines().count(), 12);
    }
}

#[test]
fn a_source_or_core_that_fails_at_its_end_ends_the_run_with_all_samples() {
    let (replaced, code, expected) = foreign::BAD_ENDS[0];
    for (name, original) in [("core_fmi2", core("")), ("imu_fmi2", imu(""))] {
        let fmu = foreign::altered(name, code, replaced);
        let folder = tempfile::tempdir().unwrap();
        let scenario =
            original.replace(foreign::fmu(name).to_str().unwrap(), fmu.path().to_str().unwrap());
        let (error, summary, samples) = broken(folder.path(), &scenario);
        assert!(samples >= 6000, "{name}: {samples}");
        assert!(error.contains(expected), "{error}");
        assert_eq!(summary["verdict"], "error");
    }
}
