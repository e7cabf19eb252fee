//! The solution of any instrument, scored against a reference trajectory.

use crate::common::program::program;
use octant_earth::ellipsoid::Ellipsoid;
use serde_json::Value;
use std::f64::consts::TAU;
use std::path::Path;
use std::process::Output;

/// A ship on a circle of 2 km around 45° N, 10° E, 5 m/s; one row a second.
const RADIUS_M: f64 = 2000.0;
const SPEED_MPS: f64 = 5.0;

/// Latitude, longitude, deg; velocity north, east, m/s; heading, deg.
pub(crate) fn circle(t_s: f64) -> [f64; 5] {
    let (s, c) = (SPEED_MPS / RADIUS_M * t_s).sin_cos();
    let earth = Ellipsoid::at(45.0_f64.to_radians(), 0.0);
    let north = (RADIUS_M * s / earth.meridian_radius_m).to_degrees();
    let across_m = earth.transverse_radius_m * earth.cos_latitude;
    let east = (RADIUS_M * (1.0 - c) / across_m).to_degrees();
    let heading = (SPEED_MPS / RADIUS_M * t_s).rem_euclid(TAU).to_degrees();
    [45.0 + north, 10.0 + east, SPEED_MPS * c, SPEED_MPS * s, heading]
}

pub(crate) const HEADER: &str = "time_s,latitude_deg,longitude_deg,velocity_north_mps,velocity_east_mps,\
                      roll_deg,pitch_deg,heading_deg\n";

pub(crate) fn rows(
    times_s: impl Iterator<Item = f64>,
    of: impl Fn(f64) -> [f64; 5],
    zero_s: f64,
) -> String {
    let row = |t: f64| {
        let [latitude, longitude, north, east, heading] = of(t);
        let time = t + zero_s;
        format!("{time:.3},{latitude:.12},{longitude:.12},{north:.9},{east:.9},0,0,{heading:.9}\n")
    };
    HEADER.to_owned() + &times_s.map(row).collect::<String>()
}

/// The circle with a drift in latitude of an arcminute an hour, and a heading that is 3′ off.
pub(crate) fn drifting(t: f64) -> [f64; 5] {
    let [latitude, longitude, north, east, heading] = circle(t);
    [latitude + t / 3600.0 / 60.0, longitude, north + 0.01, east, heading + 0.05]
}

pub(crate) fn seconds(from: u32, to: u32) -> impl Iterator<Item = f64> {
    (from..=to).map(f64::from)
}

pub(crate) fn score(folder: &Path, arguments: &[&str]) -> Output {
    let files =
        ["score", "--solution", "ins.csv", "--reference", "ref.csv", "--out", "out", "--force"];
    program(&[&files[..], arguments].concat()).current_dir(folder).output().unwrap()
}

pub(crate) fn summary(folder: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join("out/summary.json")).unwrap()).unwrap()
}

const REQUIRED: &str = "schema = 1\ntitle = \"sea trial\"\n[procedure.navigation]\n\
    [[requirements]]\nid = \"NAV-1\"\ntext = \"Stays near.\"\n\
    measure = \"navigation.radial_error_nmi.max\"\nlimit = \"1.5 nmi\"\n\
    [decision]\nrule = \"simple-acceptance\"\n\
    [source]\nuri = \"solution:ins.csv\"\n[source.trajectory]\nfile = \"ref.csv\"\n";

#[test]
fn a_drift_is_scored_as_it_was_made() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    // The reference has another zero, another rate and begins earlier.
    let halves = (0..=14_600).map(|k| f64::from(k) * 0.5);
    std::fs::write(here.join("ref.csv"), rows(halves, circle, 1000.0)).unwrap();
    std::fs::write(here.join("ins.csv"), rows(seconds(60, 7260), drifting, 0.0)).unwrap();
    std::fs::write(here.join("trial.toml"), REQUIRED).unwrap();
    let ended = score(here, &["--scenario", "trial.toml", "--offset", "1000 s"]);
    assert_eq!(ended.status.code(), Some(1), "{ended:?}");
    let found = summary(here);
    let navigation = &found["navigation"];
    let number = |path: &str| navigation.pointer(path).unwrap().as_f64().unwrap();
    assert!((number("/duration_h") - 2.0).abs() < 1e-3, "{navigation}");
    // The drift is 2′ and 60 s of it at the end.
    let minutes = 7260.0 / 3600.0;
    assert!((number("/latitude_error_arcmin/final") - minutes).abs() < 1e-5, "{navigation}");
    assert!(number("/longitude_error_arcmin/max") < 1e-5, "{navigation}");
    assert!((number("/heading_error_arcmin/rms") - 3.0).abs() < 1e-4, "{navigation}");
    assert!((number("/velocity_north_error_mps/rms") - 0.01).abs() < 1e-6, "{navigation}");
    assert_eq!(found["verdict"], "fail", "{found}");
    // The folder can be rendered, scored and verified again.
    for command in [&["report", "out"][..], &["score", "out/recording.mcap"], &["verify", "out"]] {
        let ended = program(command).current_dir(here).output().unwrap();
        let status = ended.status.code();
        assert!(status == Some(0) || (command[0] == "verify" && status == Some(1)), "{ended:?}");
    }
    // The same within a wider limit, and with clocks that may be a minute apart: 300 m are 0.16 nmi.
    let wider = REQUIRED
        .replace("1.5 nmi", "2.1 nmi")
        .replace("rule = \"simple-acceptance\"", "position = \"1 m\"");
    std::fs::write(here.join("trial.toml"), wider).unwrap();
    for (uncertainty, status) in [("0 s", 0), ("1 s", 0), ("60 s", 3)] {
        let arguments =
            ["--scenario", "trial.toml", "--offset", "1000 s", "--offset-uncertainty", uncertainty];
        let ended = score(here, &arguments);
        assert_eq!(ended.status.code(), Some(status), "{uncertainty}: {ended:?}");
    }
}

#[test]
fn longitudes_a_turn_apart_are_the_same_and_an_offset_may_be_negative() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let turned = |t: f64| {
        let [latitude, longitude, north, east, heading] = drifting(t);
        [latitude, longitude - 360.0, north, east, heading]
    };
    std::fs::write(here.join("ref.csv"), rows(seconds(0, 3700), circle, 0.0)).unwrap();
    std::fs::write(here.join("ins.csv"), rows(seconds(60, 3660), turned, 1000.0)).unwrap();
    std::fs::write(here.join("trial.toml"), REQUIRED).unwrap();
    let ended = score(here, &["--scenario", "trial.toml", "--offset", "-1000 s"]);
    assert_eq!(ended.status.code(), Some(0), "{ended:?}");
    let error = summary(here)["navigation"]["longitude_error_arcmin"]["max"].as_f64().unwrap();
    assert!(error < 1e-5, "{error}");
}

#[test]
fn a_scenario_needs_only_what_is_scored() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    std::fs::write(here.join("ref.csv"), rows(seconds(0, 3700), circle, 0.0)).unwrap();
    std::fs::write(here.join("ins.csv"), rows(seconds(60, 3660), drifting, 0.0)).unwrap();
    let requirement = "schema = 1\n[[requirements]]\nid = \"NAV-1\"\ntext = \"Stays near.\"\n\
        measure = \"navigation.radial_error_nmi.max\"\nlimit = \"1.5 nmi\"\n";
    std::fs::write(here.join("trial.toml"), requirement).unwrap();
    let position = ["--set", "decision.position=1 m"];
    for more in [&[][..], &["--duration", "1 h"]] {
        let arguments = [&["--scenario", "trial.toml", "--offset", "0 s"][..], &position, more];
        let ended = score(here, &arguments.concat());
        assert_eq!(ended.status.code(), Some(0), "{more:?}: {ended:?}");
        let verified = program(&["verify", "out"]).current_dir(here).output().unwrap();
        assert_eq!(verified.status.code(), Some(0), "{verified:?}");
    }
}

#[test]
fn rates_whose_period_is_no_whole_number_of_nanoseconds_are_scored() {
    for rate_hz in [3.0, 7.0, 12.0, 60.0, 1.0 / 0.273] {
        let folder = tempfile::tempdir().unwrap();
        let here = folder.path();
        let times = (0..600).map(|k| 10.0 + f64::from(k) / rate_hz);
        std::fs::write(here.join("ref.csv"), rows(seconds(0, 300), circle, 0.0)).unwrap();
        std::fs::write(here.join("ins.csv"), rows(times, drifting, 0.0)).unwrap();
        std::fs::write(here.join("trial.toml"), REQUIRED).unwrap();
        let ended = score(here, &["--scenario", "trial.toml", "--offset", "0 s"]);
        assert_eq!(ended.status.code(), Some(0), "{rate_hz} Hz: {ended:?}");
    }
}

/// A line of NovAtel's INSPVAS at a second of the Thursday of GPS week 2345, with the CRC of its manual.
fn inspvas(second: f64, [latitude, longitude, north, east, heading]: [f64; 5]) -> String {
    let second = 345_600.0 + second;
    let text = format!(
        "INSPVASA,2345,{second:.3};2345,{second:.9},{latitude:.12},{longitude:.12},0,{north:.9},{east:.9},0,0,0,\
         {heading:.9},INS_SOLUTION_FREE"
    );
    with_crc(&text)
}

fn with_crc(text: &str) -> String {
    let crc = text.bytes().fold(0_u32, |crc, byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 }
        })
    });
    format!("%{text}*{crc:08x}\r\n")
}

/// The same line of a unit that has no solution.
fn inactive(line: &str) -> String {
    let text = line.trim_start_matches('%').split('*').next().unwrap();
    with_crc(&text.replace("INS_SOLUTION_FREE", "INS_INACTIVE"))
}

/// What a unit sent, among other bytes, against a reference with dates: both clocks are known.
#[test]
fn messages_of_a_unit_are_a_solution() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    // 2024-12-19 is that Thursday, and GPS time was 18 s ahead of UTC.
    let reference: String = (0..=7300)
        .map(|t| {
            let [latitude, longitude, north, east, heading] = circle(f64::from(t));
            let time = format!("{:02}:{:02}:{:02}", t / 3600, t / 60 % 60, t % 60);
            format!("2024-12-19T{time}Z,{latitude:.12},{longitude:.12},{north:.9},{east:.9},0,0,{heading:.9}\n")
        })
        .collect();
    std::fs::write(here.join("ref.csv"), HEADER.to_owned() + &reference).unwrap();
    let sent = |damaged: bool| -> Vec<u8> {
        let lines = seconds(60, 7260).flat_map(|t| {
            let line = inspvas(t + 18.0, drifting(t));
            let line = if damaged && t % 50.0 == 0.0 { line.replace("45.", "54.") } else { line };
            [b"\xaa\x44\x12noise".to_vec(), line.into_bytes()].concat()
        });
        lines.collect()
    };
    std::fs::write(here.join("trial.toml"), REQUIRED.replace("1.5 nmi", "2.1 nmi")).unwrap();
    let format = ["--scenario", "trial.toml", "--set", "source.solution.format=novatel"];
    std::fs::write(here.join("ins.csv"), sent(false)).unwrap();
    let ended = score(here, &format);
    assert_eq!(ended.status.code(), Some(0), "{ended:?}");
    let found = summary(here);
    let number = |path: &str| found["navigation"].pointer(path).unwrap().as_f64().unwrap();
    assert!((number("/latitude_error_arcmin/final") - 7260.0 / 3600.0).abs() < 1e-5, "{found}");
    assert!(number("/longitude_error_arcmin/max") < 1e-5, "{found}");
    assert!((number("/heading_error_arcmin/rms") - 3.0).abs() < 1e-4, "{found}");
    // One line in fifty is damaged: more than one point in a hundred is missing.
    std::fs::write(here.join("ins.csv"), sent(true)).unwrap();
    assert_eq!(score(here, &format).status.code(), Some(3));
    // A unit that gives up, and sends on without a solution: less than the whole of it is there.
    let gives_up: String = seconds(60, 7260)
        .map(|t| {
            let line = inspvas(t + 18.0, drifting(t));
            if t < 3600.0 { line } else { inactive(&line) }
        })
        .collect();
    std::fs::write(here.join("ins.csv"), gives_up).unwrap();
    assert_eq!(score(here, &format).status.code(), Some(3));
    // Another unit's messages.
    let ended = score(here, &["--scenario", "trial.toml", "--set", "source.solution.format=sbg"]);
    let said = String::from_utf8_lossy(&ended.stderr);
    assert!(ended.status.code() == Some(2) && said.contains("expected EKF_NAV"), "{said}");
}

/// Every point counts: 60 nmi for a tenth of a second between two seconds.
#[test]
fn a_jump_between_two_seconds_is_scored() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let jumps = |t: f64| {
        let mut row = drifting(t);
        row[0] += if (t - 1000.5).abs() < 0.01 { 1.0 } else { 0.0 };
        row
    };
    let tenths = || (0..=18_000).map(|k| f64::from(k) / 10.0);
    std::fs::write(here.join("ref.csv"), rows(seconds(0, 1800), circle, 0.0)).unwrap();
    std::fs::write(here.join("trial.toml"), REQUIRED).unwrap();
    for (solution, status) in [(rows(tenths(), drifting, 0.0), 0), (rows(tenths(), jumps, 0.0), 1)]
    {
        std::fs::write(here.join("ins.csv"), solution).unwrap();
        let ended = score(here, &["--scenario", "trial.toml", "--offset", "0 s"]);
        assert_eq!(ended.status.code(), Some(status), "{ended:?}");
    }
}

/// A run's own solution and truth, as text, have the scores of the run.
#[test]
fn an_exported_run_has_the_scores_of_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let text = "schema = 1\n[procedure.calibration]\nduration = \"30 min\"\n\
        [procedure.navigation]\nduration = \"1 h\"\n";
    std::fs::write(here.join("own.toml"), text).unwrap();
    let run = |arguments: &[&str]| {
        let ended = program(arguments).current_dir(here).output().unwrap();
        assert_eq!(ended.status.code(), Some(0), "{ended:?}");
    };
    run(&["run", "own.toml", "--out", "own"]);
    run(&["export", "own", "--to", "csv", "--tables", "navigation", "--out", "csv"]);
    let file = "csv/navigation.csv";
    let times = ["--offset", "0 s", "--skip", "30 min"];
    run(&[&["score", "--solution", file, "--reference", file, "--out", "out"][..], &times].concat());
    let own: Value =
        serde_json::from_slice(&std::fs::read(here.join("own/summary.json")).unwrap()).unwrap();
    let again = summary(here);
    for path in [
        "/duration_h",
        "/latitude_error_arcmin/max",
        "/longitude_error_arcmin/final",
        "/radial_error_nmi/rms",
        "/radial_error_nmi/rate_per_h",
        "/velocity_east_error_mps/rms",
    ] {
        let of = |summary: &Value| {
            summary["navigation"].pointer(path).and_then(Value::as_f64).expect(path)
        };
        let (own, again) = (of(&own), of(&again));
        assert!((own - again).abs() < 1e-3 * own.abs(), "{path}: {own} {again}");
    }
}

#[test]
fn less_than_the_duration_is_no_pass() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let required = REQUIRED.replace("1.5 nmi", "30 nmi");
    std::fs::write(here.join("trial.toml"), required).unwrap();
    let run = |solution: String, reference: String, more: &[&str]| {
        std::fs::write(here.join("ins.csv"), solution).unwrap();
        std::fs::write(here.join("ref.csv"), reference).unwrap();
        let arguments = [&["--scenario", "trial.toml", "--offset", "0 s"], more].concat();
        let ended = score(here, &arguments);
        let text = String::from_utf8_lossy(&ended.stdout).into_owned()
            + &String::from_utf8_lossy(&ended.stderr);
        (ended.status.code(), text)
    };
    let reference = || rows(seconds(0, 3600), circle, 0.0);
    let solution = || rows(seconds(0, 3600), drifting, 0.0);
    let (status, text) = run(solution(), reference(), &[]);
    assert_eq!(status, Some(0), "{text}");
    // The reference ends early.
    let (status, text) = run(solution(), rows(seconds(0, 3000), circle, 0.0), &[]);
    assert_eq!(status, Some(3), "{text}");
    // The solution ends early.
    let (status, text) =
        run(rows(seconds(0, 1800), drifting, 0.0), reference(), &["--duration", "1 h"]);
    assert_eq!(status, Some(3), "{text}");
    // A part is asked for.
    let (status, text) =
        run(solution(), rows(seconds(0, 3000), circle, 0.0), &["--duration", "30 min"]);
    assert_eq!(status, Some(0), "{text}");
    // A gap in the middle.
    let gap = || seconds(0, 1000).chain(seconds(1500, 3600));
    for (solution, reference) in
        [(rows(gap(), drifting, 0.0), reference()), (solution(), rows(gap(), circle, 0.0))]
    {
        let (status, text) = run(solution, reference, &[]);
        assert_eq!(status, Some(3), "{text}");
        assert!(
            text.contains("of the solution are missing, incomplete, or have no reference"),
            "{text}"
        );
    }
    // The reference is its own solution.
    let (status, text) = run(reference(), reference(), &[]);
    assert_eq!(status, Some(3), "{text}");
    assert!(text.contains("exactly those of the reference"), "{text}");
}

#[test]
fn files_that_do_not_fit_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    std::fs::write(here.join("ins.csv"), rows(seconds(0, 100), drifting, 0.0)).unwrap();
    std::fs::write(here.join("ref.csv"), rows(seconds(0, 100), circle, 5000.0)).unwrap();
    for (arguments, words) in [
        (&[][..], "expected source.trajectory.offset"),
        (&["--offset", "0 s"], "found no point that has a reference"),
        (&["--offset", "0 s", "--reference", "none.csv"], "cannot be used multiple times"),
        (&["--offset", "0 s", "--set", "source.solution.latitude=lat"], "found no column \"lat\""),
        (&["--offset", "0 s", "--set", "source.solution.format=nmea"], "found no sentence"),
        (&["--offset", "0 s", "--set", "endpoint.uri=udp:127.0.0.1:9"], "expected no endpoint"),
        (
            &["--offset", "0 s", "--set", "procedure.calibration.duration=1 h"],
            "without a calibration",
        ),
    ] {
        let ended = score(here, arguments);
        let text = String::from_utf8_lossy(&ended.stderr);
        assert_eq!(ended.status.code(), Some(2), "{arguments:?}: {text}");
        assert!(text.contains(words), "{arguments:?}: {text}");
        assert!(!here.join("out").exists(), "{arguments:?}");
    }
    // Rows that are further apart than a second.
    std::fs::write(here.join("ins.csv"), rows((0..9).map(|k| f64::from(k) * 10.0), drifting, 0.0))
        .unwrap();
    let ended = score(here, &["--offset", "5000 s"]);
    let text = String::from_utf8_lossy(&ended.stderr);
    assert!(text.contains("its points are 10 s apart, expected 1 s or less"), "{text}");
}
