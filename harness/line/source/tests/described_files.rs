//! Records of one length and lines of text by a description, as a file and on a port.

use super::unit_frames::{PERIOD_NS, all};
use octant_instruments::Axes;
use octant_sample::{GimbalCommand, Sample};
use octant_scenario::{DescriptionChoice, FileName, Instrument, InstrumentLog, Speaks};
use octant_source::{Epoch, LiveSource, LogSource, Source, SourceError};
use std::fmt::Write as _;
use std::io::Write as _;
use std::net::TcpListener;
use std::path::Path;

const RATE_HZ: f64 = 200.0;

const FIELDS: [&str; 6] = ["gyro x", "gyro y", "gyro z", "accel x", "accel y", "accel z"];

/// Description of doubles behind a header of 100 bytes: six increments and the time.
fn records(length: usize) -> String {
    let mut text = format!(
        "version = 2\nname = \"a file\"\n[record]\nskip = 100\nlength = {length}\nfield = [\n\
         {{ is = \"stamp\", at = 48, type = \"f64\", unit = \"s\" }},\n"
    );
    for (index, is) in FIELDS.iter().enumerate() {
        let unit = if index < 3 { "rad" } else { "m/s" };
        writeln!(
            text,
            "{{ is = \"{is}\", at = {}, type = \"f64\", unit = \"{unit}\" }},",
            8 * index
        )
        .unwrap();
    }
    text + "]\n"
}

/// Description of comma text: a time, rates, forces.
fn lines() -> String {
    let mut text = "version = 2\nname = \"text\"\n[[line]]\nbegins = \"IMU\"\ncolumns = 8\nchecksum = \"none\"\nfield = [\n\
                    { is = \"stamp\", column = 2, unit = \"s\" },\n"
        .to_owned();
    for (index, is) in FIELDS.iter().enumerate() {
        let unit = if index < 3 { "deg/s" } else { "g" };
        writeln!(text, "{{ is = \"{is}\", column = {}, unit = \"{unit}\" }},", index + 3).unwrap();
    }
    text + "]\n"
}

fn speaks(folder: &Path, description: &str) -> Speaks {
    std::fs::write(folder.join("unit.toml"), description).unwrap();
    Speaks::Described(DescriptionChoice::File(FileName("unit.toml".to_owned())))
}

fn log(folder: &Path, description: &str, bytes: &[u8]) -> LogSource {
    let path = folder.join("unit.bin");
    std::fs::write(&path, bytes).unwrap();
    let (file, speaks) = (FileName("unit.bin".to_owned()), speaks(folder, description));
    let log = InstrumentLog { file, speaks, count: None, axes: Axes::SAME };
    LogSource::open(&path, &log, folder, RATE_HZ).unwrap()
}

/// Samples of a file until its end or its error.
fn read(source: &mut LogSource) -> (Vec<Sample>, Option<String>) {
    let mut found = Vec::new();
    let mut epoch = Epoch::default();
    loop {
        match source.next(&GimbalCommand::default(), &mut epoch) {
            Ok(true) => found.push(epoch.sample),
            Ok(false) => return (found, None),
            Err(error) => return (found, Some(error.to_string())),
        }
    }
}

#[test]
fn records_of_a_file_are_read_and_a_wrong_length_names_the_record() {
    let folder = tempfile::tempdir().unwrap();
    let mut bytes = vec![0x55; 100];
    for k in 0..2000_u32 {
        let k = f64::from(k);
        for value in [1e-6 * k, -2e-7, 3e-8, 1e-5 * k, 2e-6, -0.049, 777.0 + 0.005 * k] {
            bytes.extend(value.to_le_bytes());
        }
    }
    let mut source = log(folder.path(), &records(56), &bytes);
    let (found, error) = read(&mut source);
    assert_eq!((found.len(), error), (2000, None));
    assert_eq!(source.cut_short(), None);
    for (sample, number) in found.iter().zip(1_u32..) {
        assert_eq!(sample.sequence, u64::from(number));
        assert_eq!(sample.device_time.ns, u64::from(number) * PERIOD_NS);
    }
    let counted: f64 = found.iter().map(|sample| f64::from(sample.delta_theta[0])).sum();
    let sent = (0..2000).map(|k| 1e-6 * f64::from(k)).sum::<f64>();
    assert!((counted * 2f64.powi(-36) - sent).abs() < 2f64.powi(-36));
    // Another length, and every second record.
    for (length, expected) in [
        (60, "unit.bin: record 2: "),
        (57, "unit.bin: record 2: "),
        (112, "unit.bin: readings come at 100 Hz by their stamps, expected 200 Hz"),
    ] {
        let (_, error) = read(&mut log(folder.path(), &records(length), &bytes));
        let error = error.unwrap();
        assert!(error.contains(expected), "{length}: {error}");
    }
    // A file that was cut off within a record.
    let mut source = log(folder.path(), &records(56), &bytes[..bytes.len() - 20]);
    assert_eq!(read(&mut source).0.len(), 1999);
    let said = source.cut_short().unwrap();
    assert!(said.ends_with("unit.bin ends with 36 bytes of an incomplete frame"), "{said}");
}

/// Lines as a unit prints them, with one between them that isn't described.
fn text(numbers: std::ops::Range<u32>) -> String {
    let mut text = String::new();
    for k in numbers {
        let seconds = 0.005 * f64::from(k);
        writeln!(
            text,
            "IMU,{seconds:.3},{},-0.25,0.5,0.01,{},-1.0\r",
            0.01 * f64::from(k),
            1e-4 * f64::from(k)
        )
        .unwrap();
        if k % 10 == 0 {
            text += "GPS,1,2,3\r\n";
        }
    }
    text
}

/// Checks the samples of lines.
fn check(found: &[Sample]) {
    let of = |axis: usize| -> f64 { found.iter().map(|s| f64::from(s.delta_theta[axis])).sum() };
    let degrees = |sum: f64| (sum * 0.005).to_radians() * 2f64.powi(36);
    let numbers = (0..found.len() as u32).map(f64::from);
    assert!((of(0) - degrees(numbers.clone().map(|k| 0.01 * k).sum())).abs() < 1.0);
    assert!((of(1) - degrees(-0.25 * found.len() as f64)).abs() < 1.0);
    let sum: f64 = found.iter().map(|sample| f64::from(sample.delta_velocity[1])).sum();
    let sent = numbers.map(|k| 1e-4 * k).sum::<f64>() * 9.806_65 * 0.005 * 2f64.powi(30);
    assert!((sum - sent).abs() < 1.0);
}

#[test]
fn lines_are_read_from_a_file_and_from_a_port() {
    let folder = tempfile::tempdir().unwrap();
    let mut source = log(folder.path(), &lines(), text(0..300).as_bytes());
    let (found, error) = read(&mut source);
    assert_eq!((found.len(), error), (300, None));
    check(&found);
    let told = source.conclude(None).0.unwrap().instrument;
    assert!(
        told.contains("300 readings, 30 other frames of protocol described by unit.toml"),
        "{told}"
    );
    let server = TcpListener::bind("127.0.0.1:0").unwrap();
    let uri = format!("tcp:{}", server.local_addr().unwrap());
    let mut source = port(&uri, folder.path(), &lines()).unwrap();
    let mut connection = server.accept().unwrap().0;
    for piece in text(0..300).as_bytes().chunks(41) {
        connection.write_all(piece).unwrap();
    }
    let mut epoch = Epoch::default();
    let mut found = Vec::new();
    for _ in 0..300 {
        assert!(source.next(&GimbalCommand::default(), &mut epoch).unwrap());
        found.push(epoch.sample);
    }
    check(&found);
    // A line that begins somewhere in the connection after this one is none.
    drop(connection);
    let sender = std::thread::spawn(move || {
        let mut connection = server.accept().unwrap().0;
        connection.write_all(format!("2,9,9,9\r\n{}", text(301..303)).as_bytes()).unwrap();
        connection
    });
    let (more, said) = all(&mut source);
    assert_eq!(more.iter().map(|sample| sample.sequence).collect::<Vec<_>>(), [302, 303], "{said}");
    drop(sender.join().unwrap());
}

fn port(uri: &str, folder: &Path, description: &str) -> Result<LiveSource, SourceError> {
    let instrument = Instrument {
        uri: uri.parse().unwrap(),
        speaks: speaks(folder, description),
        count: None,
        axes: Axes::SAME,
        silence_s: 1.0,
        pulses: None,
        known_stamps: None,
    };
    LiveSource::open(&instrument, folder, RATE_HZ, None)
}

#[test]
fn records_on_a_port_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let said = port("udp:127.0.0.1:0", folder.path(), &records(56)).unwrap_err().to_string();
    assert!(said.contains("found [record] for a port, expected [[frame]] or [[line]]"), "{said}");
}
