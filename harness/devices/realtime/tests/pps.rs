//! Pulses from a file, and steps of the realtime clock.

use octant_realtime::host_clocks::{HostClocks, since_1970_ns};
use octant_realtime::pps::{PulseEdge, PulseLooks, PulseReader, StampedPulse};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime};

/// A file of its own, removed at the end.
struct PulseFile(PathBuf);

impl PulseFile {
    fn new(name: &str, text: &str) -> Self {
        let path = std::env::temp_dir().join(format!("octant-pps-{}-{name}", std::process::id()));
        std::fs::write(&path, text).unwrap();
        Self(path)
    }

    fn reader(&self) -> PulseReader {
        PulseReader::open(self.0.to_str().unwrap(), PulseEdge::Assert).unwrap()
    }
}

impl Drop for PulseFile {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

fn line(realtime_ns: i128, sequence: u32) -> String {
    format!("{}.{:09}#{sequence}\n", realtime_ns / 1_000_000_000, realtime_ns % 1_000_000_000)
}

#[test]
fn a_line_of_the_kernel_is_read() {
    let pulse = StampedPulse::parse("1287150563.294983612#2394\n").unwrap();
    assert_eq!(pulse, StampedPulse { realtime_ns: 1_287_150_563_294_983_612, sequence: 2394 });
    for wrong in [
        "",
        "#",
        "1.5#3",
        "1.000000000#",
        "1.000000000",
        "-1.000000000#4",
        "1.+00000000#4",
        "1.000000000#4294967296",
        "1.000000000#5 ",
        "99999999999999999999.000000000#1",
    ] {
        assert_eq!(StampedPulse::parse(wrong), None, "{wrong}");
    }
}

#[test]
fn a_file_that_is_none_is_refused() {
    let error = PulseReader::open("/dev/pps9876", PulseEdge::Clear).unwrap_err().to_string();
    assert!(error.starts_with("/sys/class/pps/pps9876/clear: "), "{error}");
    let file = PulseFile::new("garbage", "12:30\n");
    let error =
        PulseReader::open(file.0.to_str().unwrap(), PulseEdge::Assert).unwrap_err().to_string();
    assert!(
        error.ends_with("found \"12:30\\n\", expected SECONDS.NANOSECONDS#SEQUENCE"),
        "{error}"
    );
}

/// A thread rewrites the file; a reader may find it empty in between.
#[test]
fn pulses_of_a_file_that_is_rewritten_are_those_of_its_thread() {
    let file = PulseFile::new("rewritten", "0.000000000#0\n");
    let mut reader = file.reader();
    let ends = AtomicBool::new(false);
    let came = std::thread::scope(|scope| {
        let writer = scope.spawn(|| {
            let mut came = Vec::new();
            for sequence in 1..=20 {
                std::thread::sleep(Duration::from_millis(20));
                let clocks = HostClocks::read();
                std::fs::write(&file.0, line(clocks.other_ns, sequence)).unwrap();
                came.push((clocks.monotonic, clocks.within));
            }
            ends.store(true, Ordering::SeqCst);
            came
        });
        let mut found = Vec::new();
        loop {
            let last = ends.load(Ordering::SeqCst);
            found.extend(reader.look());
            if last {
                break;
            }
            std::thread::sleep(Duration::from_micros(500));
        }
        (writer.join().unwrap(), found)
    });
    let (written, found) = came;
    let looks = reader.looks();
    assert_eq!(looks.seen + looks.skipped, 20, "{looks:?}");
    assert!(!found.is_empty());
    for pulse in &found {
        // Beyond what a busy host adds to the reading of both clocks by the thread.
        let off = |(at, within): &(Instant, Duration)| {
            (pulse.at.max(*at) - pulse.at.min(*at)).saturating_sub(*within)
        };
        let nearest = written.iter().map(off).min().unwrap();
        assert!(nearest < pulse.within + Duration::from_millis(1), "{nearest:?} {pulse:?}");
    }
    assert_eq!(looks.repeated, 0);
}

/// A reader, and a reading of the clocks that later ones are made from.
fn judged(name: &str) -> (PulseFile, PulseReader, HostClocks) {
    let file = PulseFile::new(name, "0.000000000#5\n");
    let reader = file.reader();
    (file, reader, HostClocks::read())
}

/// The clocks after a time, with the realtime clock set forward by so much.
fn later(clocks: &HostClocks, after: Duration, step_ns: i128) -> HostClocks {
    HostClocks {
        monotonic: clocks.monotonic + after,
        other_ns: clocks.other_ns + after.as_nanos() as i128 + step_ns,
        within: clocks.within,
    }
}

#[test]
fn a_sequence_that_stands_gaps_and_wraps_is_counted() {
    let (_file, mut reader, clocks) = judged("sequence");
    let now = later(&clocks, Duration::from_secs(1), 0);
    let mut pulse = |before_ns: i128, sequence: u32| {
        let realtime_ns = now.other_ns - before_ns;
        reader.found(Ok(StampedPulse { realtime_ns, sequence }), now)
    };
    let first = pulse(1000, 6).unwrap();
    assert_eq!(first.at, now.monotonic - Duration::from_nanos(1000));
    // The same line again is no pulse, another time with the same number is a repetition.
    assert_eq!(pulse(1000, 6), None);
    assert_eq!(pulse(500, 6), None);
    assert_eq!(pulse(400, 5), None);
    assert!(pulse(300, 8).is_some());
    // From the future, and too old.
    assert_eq!(pulse(-1_000_000, 9), None);
    assert_eq!(pulse(3_000_000_000, 10), None);
    let expected =
        PulseLooks { seen: 4, skipped: 2, repeated: 2, untimely: 2, ..PulseLooks::default() };
    assert_eq!(reader.looks(), expected);
    let wrapped = |last| {
        let realtime_ns = now.other_ns - 1;
        let mut reader = reader.clone();
        reader.found(Ok(StampedPulse { realtime_ns, sequence: u32::MAX / 3 }), now).unwrap();
        reader.found(Ok(StampedPulse { realtime_ns, sequence: u32::MAX / 3 * 2 }), now).unwrap();
        reader.found(Ok(StampedPulse { realtime_ns, sequence: u32::MAX }), now).unwrap();
        reader.found(Ok(StampedPulse { realtime_ns: now.other_ns, sequence: last }), now)
    };
    assert!(wrapped(0).is_some() && wrapped(3).is_some());
}

/// The realtime clock is set back by half a second: the pulse about the step is lost, the next ones
/// are at their time.
#[test]
fn a_step_of_the_clock_costs_one_pulse() {
    let (_file, mut reader, clocks) = judged("step");
    let mut pulse = |after_ms: u64, sequence: u32, step_ns: i128| {
        let now = later(&clocks, Duration::from_millis(after_ms), step_ns);
        let realtime_ns = now.other_ns - 7_000;
        (reader.found(Ok(StampedPulse { realtime_ns, sequence }), now), now.monotonic)
    };
    assert!(pulse(1000, 6, 0).0.is_some());
    assert_eq!(pulse(2000, 7, -500_000_000).0, None);
    let (found, now) = pulse(3000, 8, -500_000_000);
    assert_eq!(found.unwrap().at, now - Duration::from_micros(7));
    let looks = reader.looks();
    assert_eq!((looks.steps, looks.about_steps), (1, 1));
    assert!((looks.step_largest_ns + 500_000_000).abs() < 10_000, "{looks:?}");
}

#[test]
fn garbage_is_counted_and_told_and_the_next_pulse_is_taken() {
    let file = PulseFile::new("then-garbage", "0.000000000#0\n");
    let mut reader = file.reader();
    std::fs::write(&file.0, "1.2.3#4").unwrap();
    assert_eq!(reader.look(), None);
    assert_eq!(reader.looks().unread, 1);
    assert!(reader.told().contains("found \"1.2.3#4\""), "{}", reader.told());
    std::fs::write(&file.0, line(since_1970_ns(SystemTime::now()), 1)).unwrap();
    assert!(reader.look().is_some());
}

#[test]
fn a_time_of_the_realtime_clock_lies_between_two_readings_of_the_monotonic_one() {
    let before = Instant::now();
    let realtime_ns = since_1970_ns(SystemTime::now());
    let after = Instant::now();
    let clocks = HostClocks::read();
    let at = clocks.at(realtime_ns).unwrap();
    assert!(at + clocks.within >= before && at <= after + clocks.within, "{clocks:?}");
    assert_eq!(HostClocks::read().step_since_ns(&clocks), None);
}
