//! An instrument over TCP as a source: a server of the test's own, which closes the connection.

use super::unit_frames::{FRAME, all, check, frame};
use octant_instruments::{Axes, Protocol};
use octant_sample::{GimbalCommand, Sample};
use octant_scenario::{DescriptionChoice, FileName, Instrument, Speaks};
use octant_source::{Epoch, LiveSource, Source, SourceError};
use std::io::Write as _;
use std::net::{TcpListener, TcpStream};
use std::path::Path;

fn open(uri: &str, speaks: Speaks, folder: &Path) -> Result<LiveSource, SourceError> {
    let instrument = Instrument {
        uri: uri.parse().unwrap(),
        speaks,
        count: None,
        axes: Axes::SAME,
        silence_s: 1.0,
        pulses: None,
        known_stamps: None,
    };
    LiveSource::open(&instrument, folder, 200.0, None)
}

/// The server of an instrument, and a source that is connected to it.
fn served(speaks: Speaks, folder: &Path) -> (LiveSource, TcpListener, TcpStream) {
    let server = TcpListener::bind("127.0.0.1:0").unwrap();
    let uri = format!("tcp:{}", server.local_addr().unwrap());
    let source = open(&uri, speaks, folder).unwrap();
    let connection = server.accept().unwrap().0;
    (source, server, connection)
}

fn next(source: &mut LiveSource) -> Sample {
    let mut epoch = Epoch::default();
    assert!(source.next(&GimbalCommand::default(), &mut epoch).unwrap());
    epoch.sample
}

#[test]
fn a_connection_that_is_closed_is_made_again() {
    let speaks = Speaks::Bytes(Protocol::VectorNav);
    let (mut source, server, mut connection) = served(speaks, Path::new(""));
    let stream: Vec<u8> = (1..=5).flat_map(frame).collect();
    // Ten bytes of the fifth frame don't come any more.
    connection.write_all(&stream[..60]).unwrap();
    connection.write_all(&stream[60..5 * FRAME - 10]).unwrap();
    drop(connection);
    let mut found: Vec<Sample> = (1..=4).map(|_| next(&mut source)).collect();
    let sender = std::thread::spawn(move || {
        let mut connection = server.accept().unwrap().0;
        // What comes is no continuation of what was cut off.
        (7..=9).for_each(|number| connection.write_all(&frame(number)).unwrap());
        connection
    });
    found.extend((7..=9).map(|_| next(&mut source)));
    check(&found, &[1, 2, 3, 4, 7, 8, 9]);
    drop(sender.join().unwrap());
    // Nobody listens there any more.
    let (more, said) = all(&mut source);
    assert!(more.is_empty() && said.contains(": no reading for 1 s; received so far: "), "{said}");
    assert!(said.contains("326 bytes, 7 readings, "), "{said}");
    assert!(said.contains("; 32 bytes belong to no frame of this protocol"), "{said}");
    assert!(said.contains("; 2 connections; no connection: "), "{said}");
    let account = &source.accounts()[0];
    assert_eq!((account.read(), account.used_count(), account.missing_count()), (7, 7, 2));
    let lines = account.lines().join("\n");
    assert!(lines.contains("1 connections that were closed and made again"), "{lines}");
    let told = source.conclude(None).0.unwrap();
    assert_eq!((told.readings.samples, told.readings.missing), (7, 2));
    assert!(told.instrument.contains("; 2 connections"), "{}", told.instrument);
}

#[test]
fn an_instrument_that_connects_itself_is_listened_for() {
    let speaks = Speaks::Bytes(Protocol::VectorNav);
    let mut source = open("tcp:127.0.0.1:0?listen=1", speaks, Path::new("")).unwrap();
    let address = source.reached_at().strip_prefix("tcp:").unwrap().to_owned();
    let mut found = Vec::new();
    for numbers in [1..=3, 5..=8] {
        let mut unit = TcpStream::connect(&address).unwrap();
        for number in numbers.clone() {
            unit.write_all(&frame(number)).unwrap();
        }
        unit.write_all(&frame(100)[..20]).unwrap();
        found.extend(numbers.map(|_| next(&mut source)));
    }
    check(&found, &[1, 2, 3, 5, 6, 7, 8]);
    let told = source.conclude(None).0.unwrap();
    assert_eq!((told.readings.samples, told.readings.missing), (7, 1));
    assert!(told.instrument.ends_with("; 2 connections"), "{}", told.instrument);
}

#[test]
fn readings_without_number_and_stamp_end_with_their_connection() {
    let folder = tempfile::tempdir().unwrap();
    let fields: Vec<String> = ["gyro x", "gyro y", "gyro z", "accel x", "accel y", "accel z"]
        .iter()
        .enumerate()
        .map(|(index, is)| {
            let (at, unit) = (1 + 4 * index, if index < 3 { "rad" } else { "m/s" });
            format!(r#"{{ is = "{is}", at = {at}, type = "f32", unit = "{unit}" }}"#)
        })
        .collect();
    let text = format!(
        "version = 1\nname = \"a unit\"\nchecksum = {{ kind = \"sum8\", at = -1 }}\n[[frame]]\nsync = [0xA5]\n\
         length = 26\nfield = [{}]\n",
        fields.join(", ")
    );
    std::fs::write(folder.path().join("unit.toml"), text).unwrap();
    let speaks = Speaks::Described(DescriptionChoice::File(FileName("unit.toml".to_owned())));
    let (mut source, _server, mut connection) = served(speaks, folder.path());
    let mut bytes = vec![0xA5];
    (1..=6_u8).for_each(|k| bytes.extend((1e-4 * f32::from(k)).to_le_bytes()));
    bytes.push(bytes.iter().fold(0, |sum: u8, byte| sum.wrapping_add(*byte)));
    connection.write_all(&bytes).unwrap();
    let found = next(&mut source);
    assert!((f64::from(found.delta_theta[1]) - 2e-4 * 2f64.powi(36)).abs() < 1.5, "{found:?}");
    drop(connection);
    let said = all(&mut source).1;
    let expected = "the connection was closed, and the readings have neither number nor stamp";
    assert!(said.contains(expected), "{said}");
}

#[test]
fn an_instrument_that_nobody_serves_is_told() {
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let uri = format!("tcp:{}", taken.local_addr().unwrap());
    drop(taken);
    let speaks = Speaks::Bytes(Protocol::VectorNav);
    let said = open(&uri, speaks, Path::new("")).unwrap_err().to_string();
    assert!(said.contains(&format!("open {uri}: ")), "{said}");
}
