//! A reference that comes with a recording: which sample it goes to, and what is refused with its place.

use octant_sample::{GimbalCommand, Reference};
use octant_scenario::resolve::{DrawnValues, Seeded};
use octant_scenario::{FileProblems, Scenario};
use octant_source::{Epoch, Source};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

const ROWS: &str = "
[imu]
rate = \"100 Hz\"
[procedure.alignment]
method = \"given\"
[procedure.calibration]
duration = \"1 min\"
stops = [{ azimuth = \"0 deg\", roll = \"0 deg\" }]
[source]
uri = \"text:imu.csv\"
[source.text]
delimiter = \"comma\"
[source.text.gyro]
x = 2
y = 3
z = 4
[source.text.accelerometer]
x = 5
y = 6
z = 7
";

fn parsed(folder: &Path, more: &str) -> Result<Scenario, FileProblems> {
    Scenario::parse(&format!("schema = 1\n{ROWS}{more}"), "rows.toml", folder, &[])
}

/// Stamps, ms, and references of samples every 10 ms from 10 ms to `samples` times 10 ms.
fn given(samples: u64, more: &str, file: &str) -> Result<Vec<(u64, Reference)>, String> {
    let folder = tempfile::tempdir().unwrap();
    let mut imu = String::new();
    for k in 1..=samples {
        // A gap from 1.00 s to 1.50 s.
        if !(101..150).contains(&k) {
            writeln!(imu, "{:.2},0,0,0,0,0,9.8", k as f64 * 0.01).unwrap();
        }
    }
    std::fs::write(folder.path().join("imu.csv"), imu).unwrap();
    std::fs::write(folder.path().join("ref.csv"), file).unwrap();
    let scenario = parsed(folder.path(), more).map_err(|error| error.to_string())?;
    let plant = scenario.plant(1, &DrawnValues::of(&scenario, &Seeded(1)));
    let said = |error: octant_source::SourceError| {
        error.to_string().replace(&format!("{}/", folder.path().display()), "")
    };
    let mut source = octant_source::open(&scenario, &plant).map_err(said)?.unwrap();
    let (mut epoch, mut all) = (Epoch::default(), Vec::new());
    while source.next(&GimbalCommand::default(), &mut epoch).map_err(said)? {
        if let Some(aiding) = epoch.aiding {
            assert_eq!(aiding.device_time, epoch.sample.device_time);
            all.push((aiding.device_time.ns / 1_000_000, aiding.reference));
        }
    }
    Ok(all)
}

const VELOCITY: &str =
    "[source.reference]\nkind = \"velocity\"\nfile = \"ref.csv\"\nnorth = 2\neast = 3\nup = 4\n";
const POSITION: &str = "[source.reference]\nkind = \"position\"\nfile = \"ref.csv\"\nlatitude = 2\nlongitude = 3\nheight = 4\n";

#[test]
fn it_goes_to_the_sample_within_half_a_period() {
    // Before the samples; early by 5 ms, which is the first of two as near; late by 4 ms; in the gap;
    // repeated by the logger, with its own stamp; an outage; after a minute.
    let file = "# t vn ve vu\n-0,9,9,9\n0.505,1,0,0.5\n1.004,2,0,0\n1.25,3,0,0\n1.9999,4,0,0\n1.9999,4,0,0\n\n\
                2.5,,,\n3.0,5,0,0\n60,6,0,0\n";
    let often = format!("{VELOCITY}[procedure.calibration.aiding]\nperiod = \"0.2 s\"\n");
    let found = given(400, &often, &file.replace("-0,9", "0.001,9")).unwrap();
    let north: Vec<(u64, f64)> = found
        .iter()
        .map(|(ms, reference)| match reference {
            Reference::Velocity([north, ..]) => (*ms, *north),
            Reference::Position { .. } => panic!("{reference:?}"),
        })
        .collect();
    assert_eq!(north, [(500, 1.0), (1000, 2.0), (2000, 4.0), (3000, 5.0)]);
    assert_eq!(found[0].1, Reference::Velocity([1.0, 0.0, -0.5]));
    // Meridians are counted both ways.
    let site = "[site]\nlatitude = \"-33 deg\"\nlongitude = \"-70.5 deg\"\n";
    let found = given(90, &format!("{POSITION}{site}"), "0.5,-33.00001,289.50001,12.5\n").unwrap();
    let Reference::Position { latitude_rad, longitude_rad, height_m } = found[0].1 else {
        panic!("{found:?}")
    };
    assert_eq!((latitude_rad, height_m), (-33.00001 * (std::f64::consts::PI / 180.0), 12.5));
    assert!((longitude_rad.to_degrees() + 70.49999).abs() < 1e-9, "{longitude_rad}");
}

#[test]
fn bad_references_are_refused_with_their_place() {
    let refused = |more: &str, file: &str, expected: &str| {
        let said = given(400, more, file).unwrap_err();
        assert!(said.contains(expected), "found {said:?}, expected {expected:?}");
    };
    let good = "0.5,0,0,0\n";
    let position = "0.5,30.5,120.3,20\n";
    let site = "[site]\nlatitude = \"30.5 deg\"\nlongitude = \"120.3 deg\"\n";
    for (more, file, expected) in [
        (
            VELOCITY,
            "0.5,0,nan,0\n",
            "read ref.csv: line 1: column 3: found \"nan\", expected a finite number",
        ),
        (VELOCITY, "0.5,0,0,1e999\n", "line 1: column 4: found \"1e999\""),
        (VELOCITY, "0.5,0,0,fast\n", "line 1: column 4: found \"fast\""),
        (
            VELOCITY,
            "0.5,0,,0\n",
            "line 1: column 3: found no east beside the others of the reference",
        ),
        (VELOCITY, "0.5,0,0\n", "line 1: found 3 columns, expected 4 or more"),
        (VELOCITY, "-0.5,0,0,0\n", "line 1: column 1: found \"-0.5\", expected a time"),
        (
            VELOCITY,
            "0.5,0,0,0\n\n0.4,0,0,0\n",
            "line 3: the reference's stamp 400000000 ns is not after the one before, 500000000 ns",
        ),
        (
            VELOCITY,
            "0.5,0,0,0\n0.5,0,0,1\n",
            "line 2: the reference's stamp 500000000 ns is not after",
        ),
        (
            VELOCITY,
            "0.5,0,0,0\n0.6,0,0,0\n",
            "line 2: the reference is 0.1 s after the one before, and procedure.calibration.aiding.period is 1 s",
        ),
        (VELOCITY, "", "read ref.csv: found no reference; the samples are from 0.010 s to 4.000 s"),
        (
            VELOCITY,
            "1767225600.5,0,0,0\n",
            "read ref.csv: found no reference at the stamp of a sample: the first is at 1767225600.500 s, the last",
        ),
        (POSITION, "0.5,95,0,0\n", "line 1: latitude is 95 deg, expected -90 to 90 deg"),
        (POSITION, "0.5,30.5,-190,0\n", "line 1: longitude is −190 deg, expected -180 to 360 deg"),
        (POSITION, "0.5,0.532,2.0996,20\n", "line 1: latitude 0.532 deg, longitude 2.0996 deg is "),
        (POSITION, "0.5,120.3,30.5,20\n", "line 1: latitude is 120.3 deg"),
    ] {
        let more = if more == POSITION { format!("{more}{site}") } else { more.to_owned() };
        refused(&more, file, expected);
    }
    refused(&VELOCITY.replace("ref.csv", "none.csv"), good, "read none.csv: ");
    let named = VELOCITY.replace("= 2", "= \"vn\"").replace("north", "header = true\nnorth");
    refused(&named, "t,v,ve,vu\n0.5,0,0,0\n", "line 1: no column \"vn\", found t, v, ve, vu");
    assert!(given(90, &format!("{POSITION}{site}"), position).is_ok());
}

#[test]
fn keys_that_contradict_each_other_are_refused() {
    let aiding =
        |reference: &str| format!("[procedure.calibration.aiding]\nreference = \"{reference}\"\n");
    let own = |from: &str, to: &str| VELOCITY.replace(from, to);
    for (more, expected) in [
        (
            format!("{VELOCITY}{}", aiding("dock-position")),
            "source.reference.kind: found \"velocity\" with procedure.calibration.aiding.reference = \"dock-position\", \
             which measures a position",
        ),
        (
            format!("{POSITION}{}", aiding("zero-velocity")),
            "source.reference.kind: found \"position\" with procedure.calibration.aiding.reference = \"zero-velocity\"",
        ),
        (own("east = 3\n", ""), "source.reference.east: missing with kind = \"velocity\""),
        (own("up = 4\n", ""), "source.reference.down: missing, expected down or up"),
        (own("up", "down = 5\nup"), "source.reference.up: found beside down"),
        (
            own("= 2", "= \"vn\""),
            "source.reference.north: found the name \"vn\" with header = false",
        ),
        (own("north", "unit = \"deg\"\nnorth"), "source.reference.unit: found \"deg\""),
        (
            own("north", "latitude = 7\nnorth"),
            "source.reference.latitude: without effect with kind = \"velocity\"",
        ),
        (own("north", "topic = \"/gnss\"\nnorth"), "source.reference.topic: without effect"),
        (
            own("file = \"ref.csv\"\n", "skip_lines = 3\n"),
            "source.reference.skip_lines: without effect",
        ),
        (
            own("north", "time_column = \"none\"\nnorth"),
            "source.reference.time_column: found \"none\"",
        ),
        (
            format!("{VELOCITY}[procedure.calibration.aiding]\nnoise = \"1 mm/s\"\n"),
            "procedure.calibration.aiding.noise: without effect",
        ),
        (
            "[source.reference]\nnorth = 2\n".to_owned(),
            "source.reference.north: without effect with kind = \"static\"",
        ),
    ] {
        let said = parsed(Path::new(""), &more).unwrap_err().to_string();
        assert!(said.contains(expected), "found {said:?}, expected {expected:?}");
    }
    let squares = ROWS.replace(
        "[procedure.calibration]\n",
        "[procedure.calibration]\nestimator = \"least-squares\"\n",
    );
    let said =
        Scenario::parse(&format!("schema = 1\n{squares}{VELOCITY}"), "f", Path::new(""), &[]);
    let said = said.unwrap_err().to_string();
    assert!(said.contains("no method of this scenario uses estimator = \"kalman\""), "{said}");
    let rows = ROWS.replace("delimiter", "time_column = \"none\"\nrate = \"100 Hz\"\ndelimiter");
    let said = Scenario::parse(&format!("schema = 1\n{rows}{VELOCITY}"), "f", Path::new(""), &[]);
    let said = said.unwrap_err().to_string();
    assert!(said.contains("source.reference.time_column: the samples have no stamps"), "{said}");
    // By default a filter expects what comes.
    for (more, reference, sigma) in
        [(VELOCITY, "velocity", "1 mm/s"), (POSITION, "dock-position", "0.15 m")]
    {
        let scenario = parsed(Path::new(""), more).unwrap();
        let resolved = scenario.to_resolved_toml(1, &DrawnValues::of(&scenario, &Seeded(1)));
        assert!(resolved.contains(&format!("reference = \"{reference}\"")), "{resolved}");
        assert!(resolved.contains(&format!("sigma = \"{sigma}\"")), "{resolved}");
        let again = Scenario::parse(&resolved, "again", Path::new("/elsewhere"), &[]);
        let again = again.unwrap_or_else(|error| panic!("{error}\n{resolved}"));
        assert_eq!(again.reference.is_some(), scenario.reference.is_some());
    }
}

/// Messages of JSON on two topics: samples every 10 ms for 4 s, and `references` at their log times, ms.
fn written(path: &Path, references: &[(u64, &str)]) {
    let mut writer = mcap::Writer::new(std::fs::File::create(path).unwrap()).unwrap();
    let [imu, fix] = ["/imu", "/fix"]
        .map(|topic| writer.add_channel(0, topic, "json", &BTreeMap::new()).unwrap());
    let mut write = |channel_id, ms: u64, data: &[u8]| {
        let (log_time, publish_time) = (ms * 1_000_000, ms * 1_000_000);
        let header =
            mcap::records::MessageHeader { channel_id, sequence: 0, log_time, publish_time };
        writer.write_to_known_channel(&header, data).unwrap();
    };
    for ms in (10..=4000).step_by(10) {
        write(imu, ms, b"{\"w\": [0, 0, 0], \"f\": [0, 0, -9.8]}");
        for (_, message) in references.iter().filter(|(at, _)| *at / 10 == ms / 10) {
            write(fix, ms + 3, message.as_bytes());
        }
    }
    writer.finish().unwrap();
}

const TOPICS: &str = "
[imu]
rate = \"100 Hz\"
[procedure.calibration]
duration = \"1 min\"
stops = [{ azimuth = \"0 deg\", roll = \"0 deg\" }]
[source]
uri = \"replay:both.mcap\"
[source.mcap]
topic = \"/imu\"
gyro = { x = \"w[0]\", y = \"w[1]\", z = \"w[2]\" }
accelerometer = { x = \"f[0]\", y = \"f[1]\", z = \"f[2]\" }
[source.reference]
kind = \"velocity\"
topic = \"/fix\"
north = \"v.n\"
east = \"v.e\"
down = \"v.d\"
";

/// References of the samples of such a file, with their stamps, ms.
fn of_topics(scenario: &str, references: &[(u64, &str)]) -> Result<Vec<(u64, Reference)>, String> {
    let folder = tempfile::tempdir().unwrap();
    written(&folder.path().join("both.mcap"), references);
    let text = format!("schema = 1\n{scenario}");
    let scenario = Scenario::parse(&text, "topics.toml", folder.path(), &[]);
    let scenario = scenario.map_err(|error| error.to_string())?;
    let plant = scenario.plant(1, &DrawnValues::of(&scenario, &Seeded(1)));
    let said = |error: octant_source::SourceError| {
        error.to_string().replace(&format!("{}/", folder.path().display()), "")
    };
    let mut source = octant_source::open(&scenario, &plant).map_err(said)?.unwrap();
    let (mut epoch, mut all) = (Epoch::default(), Vec::new());
    while source.next(&GimbalCommand::default(), &mut epoch).map_err(said)? {
        all.extend(epoch.aiding.map(|of| (of.device_time.ns / 1_000_000, of.reference)));
    }
    Ok(all)
}

#[test]
fn messages_of_another_topic_are_a_reference_and_bad_ones_are_refused() {
    let good = "{\"t\": 1.498, \"v\": {\"n\": 1.5, \"e\": -2, \"d\": 0.25}}";
    // By log time, 3 ms after a sample; by a field, which is earlier: the fix was computed later.
    let reference = Reference::Velocity([1.5, -2.0, 0.25]);
    assert_eq!(of_topics(TOPICS, &[(1700, good)]).unwrap(), [(1700, reference)]);
    let by_field = format!("{TOPICS}time_field = \"t\"\ntime_unit = \"s\"\n");
    let found = of_topics(&by_field, &[(1400, good)]).unwrap();
    assert_eq!(found, [(1500, reference)]);
    // A message that comes after its sample is found all the same: its file is read on its own.
    assert_eq!(of_topics(&by_field, &[(1700, good)]).unwrap(), [(1500, reference)]);
    let refused = |scenario: &str, references: &[(u64, &str)], expected: &str| {
        let said = of_topics(scenario, references).unwrap_err();
        assert!(said.contains(expected), "found {said:?}, expected {expected:?}");
    };
    let without = good.replace("\"e\": -2, ", "");
    refused(TOPICS, &[(100, &without)], "read both.mcap: message 1 on /fix: field v.e is missing");
    let text = good.replace("-2", "\"fast\"");
    refused(TOPICS, &[(100, &text)], "message 1 on /fix: field v.e is \"fast\", expected a number");
    refused(TOPICS, &[(100, good), (300, good)], "message 2 on /fix: the reference is 0.2 s after");
    refused(
        &by_field,
        &[(100, good), (2000, &without.replace("{\"n\"", "{\"e\": 9, \"n\""))],
        "message 2 on /fix: the reference's stamp",
    );
    refused(
        &TOPICS.replace("/fix", "/gnss"),
        &[(100, good)],
        "read both.mcap: no topic \"/gnss\"; the file has /fix, /imu",
    );
    refused(TOPICS, &[], "read both.mcap: found no reference");
    refused(&TOPICS.replace("topic = \"/fix\"\n", ""), &[], "source.reference.topic: missing");
    refused(
        &TOPICS.replace("\"v.e\"", "3"),
        &[],
        "source.reference.east: found the column 3 in an MCAP file",
    );
    refused(
        &format!("{TOPICS}nanoseconds_field = \"ns\"\n"),
        &[],
        "source.reference.nanoseconds_field: found without time_field",
    );
    refused(
        &format!("{TOPICS}file = \"gnss.csv\"\n"),
        &[],
        "source.reference.file: without effect",
    );
    // Beside an instrument on a port nothing is recorded.
    let live = "[source]\nuri = \"udp:127.0.0.1:9\"\n[procedure.calibration]\n";
    refused(
        &format!("{live}[source.reference]\nkind = \"velocity\"\nnorth = 1\neast = 2\ndown = 3\n"),
        &[],
        "source.reference.kind: found \"velocity\" with source.uri",
    );
}
