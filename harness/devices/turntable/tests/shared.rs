//! A guest at a table whose driving run says nonsense, or nothing.

#![cfg(target_os = "linux")]

use octant_sample::GimbalCommand;
use octant_turntable::{Error, TableAxis, TableGuest};
use std::io::{Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::PathBuf;
use std::time::{Duration, Instant};

const GREETING: &str = "{\"table\":{\"version\":1,\"units\":2}}\n";

/// A program that answers for the run that drives the table of this name.
fn host(port: &str) -> (UnixListener, PathBuf) {
    // The folder and the name of a stop button: FNV-1a of the port.
    let hash = port.bytes().fold(0xCBF2_9CE4_8422_2325u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3)
    });
    std::fs::create_dir_all("/tmp/octant-tables").unwrap();
    let place = PathBuf::from(format!("/tmp/octant-tables/{hash:016x}"));
    let _ = std::fs::remove_file(&place);
    (UnixListener::bind(&place).unwrap(), place)
}

/// Joins a host that says `lines`; returns the guest and the host's end of the line.
fn joined(port: &str, lines: &[u8]) -> (Result<TableGuest, Error>, Option<UnixStream>) {
    let (listener, place) = host(port);
    let lines = lines.to_vec();
    let thread = std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        let mut knock = [0; 5];
        stream.read_exact(&mut knock).unwrap();
        assert_eq!(&knock, b"join\n");
        // A guest that has heard enough goes.
        let _ = stream.write_all(&lines);
        stream
    });
    let guest = TableGuest::join(port, Duration::from_secs(1));
    let stream = thread.join().ok();
    std::fs::remove_file(place).unwrap();
    (guest, stream)
}

fn refused(port: &str, lines: &[u8]) -> String {
    joined(port, lines).0.unwrap_err().to_string()
}

#[test]
fn nonsense_before_the_start_is_told() {
    let port = |name: &str| format!("tcp:nonsense-{name}-{}:1", std::process::id());
    let because = |name: &str, lines: &[u8], why: &str| {
        let said = refused(&port(name), lines);
        assert!(said.contains(why), "{name}: {said}");
    };
    because("newer", b"{\"table\":{\"version\":2,\"units\":2}}\n", "speaks version 2, expected 1");
    because("text", b"hello\n", "said what can't be read");
    because("bytes", &[0xFF, 0, b'\n'], "said what can't be read");
    because("endless", &[b'a'; 100_000], "a line without an end");
    because("unknown", b"\"go\"\n", "didn't introduce itself");
    because("refused", b"{\"refused\":\"it is full\"}\n", "it is full");
    because("stopped", b"{\"stopped\":\"fence\"}\n", "stopped it: fence");
    because("end", b"\"end\"\n", "ended");
    because("waits", GREETING.as_bytes(), "doesn't begin within 1s");
}

#[test]
fn looks_have_their_times_and_silence_is_the_end() {
    let port = format!("tcp:looks-{}:1", std::process::id());
    let (guest, stream) = joined(&port, format!("{GREETING}\"go\"\n").as_bytes());
    let (mut guest, mut stream) = (guest.unwrap(), stream.unwrap());
    assert_eq!(guest.units(), 2);
    let time = rustix::time::clock_gettime(rustix::time::ClockId::Monotonic);
    let now_ns = time.tv_sec.unsigned_abs() * 1_000_000_000 + time.tv_nsec.unsigned_abs();
    let begun = Instant::now();
    let axis = |at_ns: u64, angle_rad: f64| {
        format!(
            "{{\"at_ns\":{at_ns},\"within_ns\":1000,\"angle_rad\":{angle_rad},\"rate_radps\":0.5}}"
        )
    };
    let target = octant_sample::GimbalAngles::from_rad(0.5, 0.25);
    for (before_ns, angle) in [(300_000_000, 0.1), (200_000_000, 0.2)] {
        let look = axis(now_ns - before_ns, angle);
        let line = format!(
            "{{\"look\":{{\"axes\":[{look},{look}],\"target\":[{},{}]}}}}\n",
            target.azimuth, target.roll
        );
        stream.write_all(line.as_bytes()).unwrap();
    }
    while guest.traffic().looks < 2 {
        assert!(begun.elapsed() < octant_test_processes::HANGS, "the looks did not come");
        std::thread::sleep(Duration::from_millis(5));
    }
    guest.take_looks();
    let middle = guest.at(TableAxis::Roll, begun - Duration::from_millis(250)).unwrap();
    assert!((middle.angle_rad - 0.15).abs() < 0.01, "{middle:?}");
    guest.command(&GimbalCommand { target });
    assert!(!guest.is_stopped());
    while !guest.is_stopped() {
        assert!(begun.elapsed() < octant_test_processes::HANGS, "silence is no end");
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(guest.stopped().unwrap().contains("said nothing for 2s"), "{:?}", guest.stopped());
    guest.leave(Some("no table"));
    let mut said = String::new();
    stream.read_to_string(&mut said).unwrap();
    assert_eq!(said, "{\"left\":\"no table\"}\n");
}
