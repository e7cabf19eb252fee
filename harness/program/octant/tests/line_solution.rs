//! A solution from a port while the run goes: a unit of another program on a pseudo terminal, which is cut off, comes back, sends
//! nonsense, and falls silent; and the run-ups of a heading test with power cycles and counted pauses.

use crate::common::program::{json, program};
use crate::common::table::Stage;
use octant_test_processes::{Started, command, start};
use octant_turntable::TableAxis;
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Output, Stdio};

/// The bench of another program, with the first line that it prints.
fn bench(folder: &Path, arguments: &[&str]) -> (Started, String) {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/golden/heading_bench.py");
    let mut bench = start(
        command("python3").arg(script).args(arguments).current_dir(folder).stdout(Stdio::piped()),
    );
    let mut line = String::new();
    BufReader::new(bench.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
    (bench, line.trim().to_owned())
}

const NEAR: &str = "schema = 1
title = \"a unit on its line\"
[source]
uri = \"solution:serial:unit\"
[source.solution]
silence = \"2 s\"
[source.trajectory]
true_heading = \"40.1 deg\"
true_heading_uncertainty = \"0.02 deg\"
[procedure.navigation]
duration = \"8 s\"
[[requirements]]
id = \"HDG-1\"
text = \"The heading stays near the surveyed one.\"
measure = \"navigation.heading_error_arcmin.max\"
limit = \"30 arcmin\"
";

fn run(folder: &Path) -> std::process::Command {
    let mut run = program(&["run", "line.toml", "--out", "out", "--force"]);
    run.current_dir(folder).stdout(Stdio::piped()).stderr(Stdio::piped());
    run
}

fn said(output: &Output) -> (Option<i32>, String) {
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    (output.status.code(), text + &String::from_utf8_lossy(&output.stderr))
}

/// The same summary of a run and of its file scored afterwards.
fn assert_scored_alike(folder: &Path) {
    let arguments =
        ["score", "--solution", "out/octant-solution.nmea", "--scenario", "out/scenario.toml"];
    let scored = program(&[&arguments[..], &["--out", "again", "--force"]].concat())
        .current_dir(folder)
        .output()
        .unwrap();
    let [then, now] = ["out", "again"].map(|run| json(&folder.join(run).join("summary.json")));
    for part in
        ["verdict", "requirements", "findings", "reasons", "heading", "navigation", "inputs"]
    {
        assert_eq!(then[part], now[part], "{part}: {scored:?}");
    }
}

fn account(summary: &Value) -> &Value {
    summary["inputs"]
        .as_array()
        .unwrap()
        .iter()
        .find(|input| input["input"].as_str().unwrap().starts_with("solution"))
        .unwrap()
}

#[test]
fn a_unit_on_its_line_is_scored_as_its_file_is() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    std::fs::write(here.join("line.toml"), NEAR).unwrap();
    let (unit, _) = bench(here, &["live", "unit", "30"]);
    let (status, text) = said(&run(here).output().unwrap());
    drop(unit);
    assert_eq!(status, Some(0), "{text}");
    let summary = json(&here.join("out/summary.json"));
    let max = summary["navigation"]["heading_error_arcmin"]["max"].as_f64().unwrap();
    assert!((max - 6.0).abs() < 1e-6, "{max}");
    assert_scored_alike(here);
    // The file is evidence, and the run can be done again from it.
    let manifest = json(&here.join("out/manifest.json"));
    assert!(manifest["bench"]["solution from"].as_str().unwrap().contains("unit"), "{manifest}");
    let verified = program(&["verify", "out", "--reexecute"]).current_dir(here).output().unwrap();
    assert_eq!(verified.status.code(), Some(0), "{verified:?}");
    // An edited file is noticed.
    let file = here.join("out/octant-solution.nmea");
    let edited = std::fs::read_to_string(&file).unwrap().replacen("40.2", "40.1", 1);
    std::fs::write(&file, edited).unwrap();
    let verified = program(&["verify", "out"]).current_dir(here).output().unwrap();
    assert_ne!(verified.status.code(), Some(0), "{verified:?}");
}

#[test]
fn a_unit_that_is_cut_off_and_sends_nonsense_leaves_a_gap_and_an_account() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    std::fs::write(here.join("line.toml"), NEAR).unwrap();
    let (mut unit, _) = bench(here, &["live", "unit", "30"]);
    let running = start(&mut run(here));
    let file = here.join("out.partial/octant-solution.nmea");
    // A second of it is on the disk.
    let begun = std::time::Instant::now();
    while std::fs::metadata(&file).map_or(0, |file| file.len()) < 300 {
        assert!(begun.elapsed() < octant_test_processes::HANGS);
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    unit.kill().unwrap();
    unit.wait().unwrap();
    let (again, _) = bench(here, &["live", "unit", "30", "nonsense"]);
    let (status, text) = said(&running.output());
    drop(again);
    assert_eq!(status, Some(3), "{text}");
    let summary = json(&here.join("out/summary.json"));
    let left_out = &account(&summary)["left_out"];
    for kind in ["wrong checksum", "ROT sentences", "HDG sentences"] {
        assert!(left_out.to_string().contains(kind), "{kind}: {summary}");
    }
    assert!(text.contains("points of the solution are missing"), "{text}");
    assert_scored_alike(here);
}

/// Sends bytes every 100 ms until the run is over.
fn during(folder: &Path, mut send: impl FnMut(u32) + Send) -> (Option<i32>, String) {
    let done = std::sync::atomic::AtomicBool::new(false);
    std::thread::scope(|scope| {
        let (done, send) = (&done, &mut send);
        scope.spawn(move || {
            for k in 0.. {
                if done.load(std::sync::atomic::Ordering::Relaxed) {
                    return;
                }
                send(k);
                std::thread::sleep(std::time::Duration::from_millis(100));
            }
        });
        let ended = said(&run(folder).output().unwrap());
        done.store(true, std::sync::atomic::Ordering::Relaxed);
        ended
    })
}

fn ths(k: u32) -> String {
    let body = format!("HETHS,40.{},A", k % 3);
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}")
}

/// Datagrams with a TAG block that tells no time, and without an end of the line.
#[test]
fn datagrams_and_a_server_on_tcp_are_lines_too() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let free = std::net::UdpSocket::bind("127.0.0.1:0").unwrap();
    let to = free.local_addr().unwrap();
    drop(free);
    std::fs::write(here.join("line.toml"), NEAR.replace("serial:unit", &format!("udp:{to}")))
        .unwrap();
    let from = std::net::UdpSocket::bind("127.0.0.1:0").unwrap();
    let (status, text) = during(here, |k| {
        // Nobody listens yet, or any more.
        let _ = from.send_to(format!("UdPbC\0\\s:HE0001*46\\{}", ths(k)).as_bytes(), to);
    });
    assert_eq!(status, Some(0), "{text}");
    let kept = std::fs::read_to_string(here.join("out/octant-solution.nmea")).unwrap();
    let first = kept.lines().next().unwrap();
    assert!(first.contains("Z UdPbC\0\\s:HE0001*46\\$HETHS,40."), "{first}");
    assert_scored_alike(here);
    let server = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let uri = format!("tcp:{}", server.local_addr().unwrap());
    std::fs::write(here.join("line.toml"), NEAR.replace("serial:unit", &uri)).unwrap();
    let mut connection = None;
    let (status, text) = during(here, |k| {
        let to = connection.get_or_insert_with(|| server.accept().unwrap().0);
        let _ = std::io::Write::write_all(to, format!("{}\r\n", ths(k)).as_bytes());
    });
    assert_eq!(status, Some(0), "{text}");
    assert_scored_alike(here);
}

#[test]
fn a_line_that_falls_silent_is_inconclusive() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    std::fs::write(here.join("line.toml"), NEAR).unwrap();
    let (unit, _) = bench(here, &["live", "unit", "1"]);
    let (status, text) = said(&run(here).output().unwrap());
    drop(unit);
    assert_eq!(status, Some(3), "{text}");
    assert!(text.contains("nothing came from"), "{text}");
    assert_scored_alike(here);
}

const RUN_UPS: &str = "schema = 1
title = \"two run-ups\"
[site]
latitude = \"45 deg\"
[source]
uri = \"solution:serial:unit\"
[source.solution]
rehearsal = true
[source.trajectory]
true_heading = \"40 deg\"
true_heading_uncertainty = \"0.02 deg\"
[power]
port = \"tcp:127.0.0.1:PORT\"
relay = 1
rest = \"0 s\"
[procedure.navigation]
duration = \"290 min\"
[procedure.heading_test]
test = \"settle\"
run_ups = 2
off = \"10 min\"
[[operator]]
id = \"level\"
ask = \"Is it level?\"
[[operator]]
id = \"between\"
ask = \"Is the table still level?\"
trigger = { at = \"295 min\" }
[[operator]]
id = \"undisturbed\"
ask = \"Was it left alone?\"
trigger = { at = \"580 min\" }
hold = false
[[requirements]]
id = \"SETTLED\"
text = \"The unit settles within 6 h.\"
measure = \"heading.settling_time_min\"
limit = \"6 h\"
[[requirements]]
id = \"REPEATS\"
text = \"The settle point is the same from run-up to run-up.\"
measure = \"heading.repeatability_deg\"
limit = \"0.5 deg\"
";
const DRIVE: &str = "[turntable.drive]
port = \"TABLE\"
azimuth = [\"-5 deg\", \"25 deg\"]
roll = [\"-5 deg\", \"5 deg\"]
oldest = \"500 ms\"
reply = \"5 s\"
guard = \"6 s\"
";
const ANSWERS: &str = "[[answer]]
id = \"level\"
value = \"yes\"
[[answer]]
id = \"between\"
value = \"yes\"
[[answer]]
id = \"undisturbed\"
value = \"yes\"
";

#[test]
fn run_ups_with_power_cycles_and_a_counted_pause_are_scored_together() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let (unit, port) = bench(here, &["rehearsal", "unit"]);
    std::fs::write(here.join("line.toml"), RUN_UPS.replace("PORT", &port)).unwrap();
    std::fs::write(here.join("answers.toml"), ANSWERS).unwrap();
    let (status, text) = said(&run(here).args(["--answers", "answers.toml"]).output().unwrap());
    drop(unit);
    // A rehearsal is no evidence, whatever its values are.
    assert_eq!(status, Some(3), "{text}");
    assert!(text.contains("a rehearsal with a simulated unit"), "{text}");
    let summary = json(&here.join("out/summary.json"));
    let heading = &summary["heading"];
    let number = |path: &str| heading.pointer(path).and_then(Value::as_f64).unwrap_or(f64::NAN);
    assert!((number("/settling_time_min") - 90.0).abs() < 1e-9, "{heading}");
    for (path, expected) in [
        ("/run_ups/0/settle_point/error_deg", 0.2),
        ("/run_ups/1/settle_point/error_deg", 0.3),
        ("/settle_point_error_deg", 0.3),
        ("/repeatability_deg", 0.1),
    ] {
        assert!((number(path) - expected).abs() < 0.05, "{path}: {heading}");
    }
    assert!((number("/resolution_deg") - 0.1).abs() < 1e-9, "{heading}");
    // Without a heading yet: ten minutes of each run-up, told apart from silence.
    let notes = account(&summary)["notes"].to_string();
    assert!(notes.contains("no heading: the instrument calls it invalid"), "{notes}");
    assert!(summary["inputs"].to_string().contains("without power"), "{summary}");
    let manifest = json(&here.join("out/manifest.json"));
    let switchings = manifest["bench"]["power"]["switchings"].as_array().unwrap();
    assert_eq!(switchings.len(), 4, "{manifest}");
    assert_scored_alike(here);
    // Without a true heading there are scatter, settling and repeatability, and no errors.
    let blind = std::fs::read_to_string(here.join("out/scenario.toml")).unwrap();
    let blind: String = blind
        .lines()
        .filter(|line| !line.starts_with("true_heading"))
        .map(|line| format!("{line}\n"))
        .collect();
    std::fs::write(here.join("blind.toml"), blind).unwrap();
    let arguments = [
        "score",
        "--solution",
        "out/octant-solution.nmea",
        "--scenario",
        "blind.toml",
        "--out",
        "blind",
    ];
    let (_, text) = said(&program(&arguments).current_dir(here).output().unwrap());
    assert!(text.contains("not tested: errors"), "{text}");
    let blind = json(&here.join("blind/summary.json"));
    assert!(blind["heading"]["settle_point_error_deg"].is_null(), "{text}");
    let repeated = blind["heading"]["repeatability_deg"].as_f64().unwrap();
    assert!((repeated - 0.1).abs() < 0.05, "{text}");
    // Half of the second run-up is no run-up.
    let file = std::fs::read_to_string(here.join("out/octant-solution.nmea")).unwrap();
    std::fs::write(here.join("cut.nmea"), &file[..file.len() * 3 / 4]).unwrap();
    let arguments =
        ["score", "--solution", "cut.nmea", "--scenario", "out/scenario.toml", "--out", "cut"];
    let (status, text) = said(&program(&arguments).current_dir(here).output().unwrap());
    assert_eq!(status, Some(3), "{text}");
    let cut = json(&here.join("cut/summary.json"));
    assert!(cut["heading"]["repeatability_deg"].is_null(), "{text}");
}

/// A relay feeds the unit, and a table turns it by 20 deg while it has no power: nobody is asked.
#[test]
fn a_table_turns_the_unit_between_two_run_ups() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let table = Stage::new();
    let (unit, port) = bench(here, &["rehearsal", "unit", "20"]);
    let (before, rest) = RUN_UPS.split_once("[[operator]]").unwrap();
    let (_, required) = rest.split_once("[[requirements]]").unwrap();
    let scenario =
        format!("{before}azimuths = [\"0 deg\", \"20 deg\"]\n{DRIVE}[[requirements]]{required}");
    let scenario = scenario.replace("PORT", &port).replace("TABLE", &table.port);
    std::fs::write(here.join("line.toml"), scenario).unwrap();
    let (status, text) = said(&run(here).output().unwrap());
    drop(unit);
    assert_eq!(status, Some(3), "{text}");
    assert!((table.angle(TableAxis::Azimuth) - 20.0).abs() < 0.1, "{text}");
    let summary = json(&here.join("out/summary.json"));
    let error = |run_up: usize| {
        summary["heading"]["run_ups"][run_up]["settle_point"]["error_deg"].as_f64().unwrap()
    };
    assert!((error(0) - 0.2).abs() < 0.05 && (error(1) - 0.3).abs() < 0.05, "{text}");
    assert_scored_alike(here);
}
