//! An instrument on a CAN bus as a source, behind a simulated adapter on a serial line.

use octant_link::port::{Bytes, Pty};
use octant_sample::{DeviceTime, GimbalAngles, GimbalCommand, Sample, Status};
use octant_scenario::{Scenario, SourceSpec as Kind};
use octant_source::{Epoch, LiveSource, Source};
use octant_wire::Message;
use octant_wire::can::{CanVersion, segments};
use octant_wire::message::{EndRole, SampleMessage, StepNumber};
use std::fmt::Write as _;
use std::path::Path;
use std::time::{Duration, Instant};

const DATABASE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/can/octant.dbc");

/// Mapping of our own database, whose values are known to the last bit.
const MAPPING: &str = r#"
rotation = { x = "InstrumentSample_3.delta_theta_x", y = "InstrumentSample_3.delta_theta_y", z = "InstrumentSample_4.delta_theta_z" }
velocity = { x = "InstrumentSample_4.delta_velocity_x", y = "InstrumentSample_5.delta_velocity_y", z = "InstrumentSample_5.delta_velocity_z" }
gimbal = { azimuth = "InstrumentSample_6.azimuth", roll = "InstrumentSample_6.roll" }
sequence = { signal = "InstrumentSample_1.sequence" }
stamp = { signal = "InstrumentSample_2.device_time_ns" }
"#;

fn sample(number: u64) -> Sample {
    let k = number as i32;
    Sample {
        sequence: number,
        device_time: DeviceTime { ns: number * 5_000_000 },
        delta_theta: [17_000 + k, -k, 3],
        delta_velocity: [k, 40 - k, -52_600_000],
        gimbal: GimbalAngles { azimuth: 5, roll: -k },
        status: Status::empty(),
    }
}

/// Renders the frames of a sample as the adapter sends them.
fn lines(number: u64) -> String {
    let step = StepNumber::new((number & 0x7FFF) as u16);
    let message = Message::Sample(SampleMessage { step, aided: false, sample: sample(number) });
    let mut text = String::new();
    for frame in segments(&message, EndRole::Instrument, CanVersion::Classic).unwrap() {
        write!(text, "t{:03X}{:X}", frame.id(), frame.data().len()).unwrap();
        for byte in frame.data() {
            write!(text, "{byte:02X}").unwrap();
        }
        text.push('\r');
    }
    text
}

fn scenario(folder: &Path, uri: &str, more: &str) -> Result<Scenario, String> {
    let text = format!(
        "schema = 1\n[procedure.navigation]\nduration = \"0.1 s\"\nrotation = \"none\"\n\
         [source]\nuri = {uri:?}\n[source.live]\n{more}"
    );
    Scenario::parse(&text, "s.toml", folder, &[]).map_err(|error| error.to_string())
}

#[test]
fn samples_from_a_bus_arrive_to_the_last_bit() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("unit.toml"), MAPPING).unwrap();
    let mut line = Pty::open("").unwrap();
    let uri = format!("slcan:{}?bitrate=500000", line.name());
    let files = format!("database = {DATABASE:?}\nmapping = \"unit.toml\"\nsilence = \"60 s\"\n");
    let scenario = scenario(folder.path(), &uri, &files).unwrap();
    let Kind::Live(instrument) = &scenario.source else { panic!() };
    LiveSource::check(&scenario, instrument).unwrap();
    // The adapter answers each command, and starts when its channel is open.
    let adapter = std::thread::spawn(move || {
        let (mut said, mut buffer) = (Vec::new(), [0; 64]);
        let until = Instant::now() + octant_test_processes::HANGS;
        while !said.ends_with(b"O\r") {
            assert!(Instant::now() < until, "{said:?}");
            let count = line.receive(&mut buffer, Duration::from_millis(50)).unwrap();
            said.extend(&buffer[..count]);
            for _ in buffer[..count].iter().filter(|byte| **byte == b'\r') {
                line.send(b"\r", octant_test_processes::HANGS).unwrap();
            }
        }
        for number in 1..=20 {
            // Other frames on the bus, with identifiers of 29 bits, of 11 bits and without data;
            // the sixth sample is never complete.
            let mut text = lines(number) + "T1ABCDEF0411223344\rt7FF81122334455667788\rr1230\r";
            if number == 6 {
                text = text.replacen('\r', "\rx", 3);
            }
            assert!(line.send(text.as_bytes(), octant_test_processes::HANGS).unwrap());
        }
        (line, String::from_utf8(said).unwrap())
    });
    let mut source = LiveSource::of(&scenario, instrument).unwrap();
    let mut epoch = Epoch::default();
    for number in (1..=20).filter(|number| *number != 6) {
        assert!(source.next(&GimbalCommand::default(), &mut epoch).unwrap());
        assert_eq!((epoch.sample, epoch.aiding), (sample(number), None));
    }
    let (_line, said) = adapter.join().unwrap();
    assert_eq!(said, "C\rS6\rO\r");
    let told = source.conclude(None).0.unwrap();
    assert_eq!((told.readings.samples, told.readings.missing), (19, 1));
    assert_eq!(told.clock.unwrap().stamps, 19);
    let name = told.instrument;
    let frames = ": 175 frames, 19 readings, 58 frames of other messages, ";
    assert!(name.starts_with("slcan:") && name.contains(frames), "{name}");
}

#[test]
fn what_does_not_go_together_is_refused_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |uri: &str, more: &str| scenario(folder.path(), uri, more).unwrap_err();
    let files = "database = \"unit.dbc\"\nmapping = \"unit.toml\"\n";
    let error = refused("can:can0", "protocol = \"xsens\"\n");
    assert!(
        error.contains("source.live.protocol: found \"xsens\", expected \"dbc\" on a CAN bus"),
        "{error}"
    );
    let error = refused("udp:127.0.0.1:0", &format!("protocol = \"dbc\"\n{files}"));
    assert!(error.contains("found \"dbc\", expected the protocol of a line of bytes"), "{error}");
    let error = refused("can:can0", "database = \"unit.dbc\"\n");
    assert!(error.contains("source.live.mapping: missing, expected a file"), "{error}");
    let error = refused("udp:127.0.0.1:0", "database = \"unit.dbc\"\n");
    assert!(error.contains("s.toml:8:12: source.live.database: without effect"), "{error}");

    // The files are read before any port is opened.
    let of = |mapping: &str| {
        std::fs::write(folder.path().join("unit.toml"), mapping).unwrap();
        let files = format!("database = {DATABASE:?}\nmapping = \"unit.toml\"\n");
        let scenario = scenario(folder.path(), "can:octant9", &files).unwrap();
        let Kind::Live(instrument) = &scenario.source else { panic!() };
        LiveSource::check(&scenario, instrument).map_err(|error| error.to_string())
    };
    of(MAPPING).unwrap();
    let error =
        of(&MAPPING.replace("InstrumentSample_6.roll", "InstrumentSample_6.rol")).unwrap_err();
    assert!(error.contains("unit.toml: gimbal.roll") && error.contains("`rol`"), "{error}");
    let resolved = {
        let files = "database = \"unit.dbc\"\nmapping = \"unit.toml\"\n";
        let scenario = scenario(folder.path(), "can:can0", files).unwrap();
        let draws = octant_scenario::resolve::DrawnValues::of(
            &scenario,
            &octant_scenario::resolve::Seeded(1),
        );
        scenario.to_resolved_toml(1, &draws)
    };
    // The file is in another folder.
    assert!(
        resolved.contains(&format!("database = {:?}", folder.path().join("unit.dbc"))),
        "{resolved}"
    );
    assert!(resolved.contains("protocol = \"dbc\""), "{resolved}");
}
