//! Recordings: the recorded data is read back bit for bit, whatever happens to the file.

use crate::common::bits::bits;
use crate::common::epochs::{Memory, PERIOD_NS, push, record, truth_of};
use crate::common::stream::stream;
use octant_recorder::reader::{self, Epochs, Item, ReadError, Recording};
use octant_recorder::{Event, Policy, Recorder, RecorderError, RecorderOptions, Samples, message};
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{Parameters, Truth};
use proptest::prelude::*;
use std::io::{self, Write};

fn full() -> RecorderOptions {
    RecorderOptions {
        policy: Policy { samples: Samples::Full, ..Policy::default() },
        scenario: "schema = 1\n".into(),
        ..RecorderOptions::default()
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn parameters_and_truth_keep_their_bits(
        p in prop::collection::vec(bits(), 60), t in prop::array::uniform12(bits()), n in any::<u64>(), r in any::<u32>(),
    ) {
        let estimate = ParameterEstimate {
            revision: r,
            parameters: Parameters::from_array(&std::array::from_fn(|i| p[i])),
            sigma: std::array::from_fn(|i| p[30 + i]),
        };
        let (mut bytes, mut again) = (Vec::new(), Vec::new());
        message::encode_parameters(n, &estimate, &mut bytes);
        let (sequence, read) = message::decode_parameters(&bytes).unwrap();
        message::encode_parameters(sequence, &read, &mut again);
        prop_assert_eq!(&bytes, &again);
        prop_assert_eq!(sequence, n);
        prop_assert_eq!(read.sigma.map(f64::to_bits), estimate.sigma.map(f64::to_bits));

        let truth = Truth {
            time: octant_sample::time::SimulatedTime::from_ns(n),
            latitude_rad: t[0], longitude_rad: t[1], height_m: t[2],
            velocity_mps: [t[3], t[4], t[5]], q_nb: [t[6], t[7], t[8], t[9]], gimbal_rad: [t[10], t[11]],
        };
        message::encode_truth(&truth, &mut bytes);
        let read = message::decode_truth(&bytes).unwrap();
        prop_assert_eq!(read.gimbal_rad.map(f64::to_bits), truth.gimbal_rad.map(f64::to_bits));
        message::encode_truth(&read, &mut again);
        prop_assert_eq!(&bytes, &again);
    }

    #[test]
    fn any_bytes_are_read_without_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = reader::read_bytes(&bytes);
        let mut with_magic = b"\x89MCAP0\r\n".to_vec();
        with_magic.extend_from_slice(&bytes);
        let _ = reader::read_bytes(&with_magic);
    }
}

/// Returns a small complete recording, made once.
fn small() -> &'static [u8] {
    static BYTES: std::sync::OnceLock<Vec<u8>> = std::sync::OnceLock::new();
    BYTES.get_or_init(|| record(&stream(100), &full()).0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn a_damaged_recording_is_read_without_panic(
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        head in any::<bool>(),
    ) {
        let mut bytes = small().to_vec();
        let range = if head { 1000 } else { bytes.len() };
        for (at, value) in damage {
            bytes[at.index(range)] = value;
        }
        let _ = reader::read_bytes(&bytes);
    }
}

#[test]
fn the_stream_hash_is_the_same_for_every_block_size_and_policy() {
    let steps = stream(3000);
    let (_, reference) = record(&steps, &RecorderOptions::default());
    assert_eq!(reference.epochs, 3000);
    assert_eq!(reference.aiding, 15);
    for epochs_per_block in [1, 7, 1024, 5000] {
        for samples in [Samples::Full, Samples::Decimated] {
            let options = RecorderOptions {
                epochs_per_block,
                policy: Policy { samples, ..Policy::default() },
                ..RecorderOptions::default()
            };
            assert_eq!(record(&steps, &options).1.stream_hash, reference.stream_hash);
        }
    }
    let mut hash_only = Recorder::hash_only(&RecorderOptions::default());
    for step in &steps {
        push(&mut hash_only, step).unwrap();
    }
    assert_eq!(hash_only.finish().unwrap().stream_hash, reference.stream_hash);
    // The hash depends on these bits: one bit of one sample changes it.
    let mut other = steps.clone();
    other[1234].faulted.sample.delta_theta[1] ^= 1;
    assert_ne!(record(&other, &RecorderOptions::default()).1.stream_hash, reference.stream_hash);
    let mut other = steps;
    other[1399].parameters.as_mut().unwrap().sigma[29] *= 1.0 + f64::EPSILON;
    assert_ne!(record(&other, &RecorderOptions::default()).1.stream_hash, reference.stream_hash);
}

#[test]
fn the_default_policy_keeps_one_epoch_a_second_and_every_aiding_and_mode() {
    let steps = stream(200 * 60);
    let (bytes, summary) = record(&steps, &RecorderOptions::default());
    // The first epoch, at 5 ms, then those at 1 s, 2 s, ... 60 s, and one more: the first in which
    // the core navigates, 5 ms after a whole second.
    assert_eq!(summary.messages["/imu"], 62);
    assert_eq!(summary.messages["/truth"], 62);
    assert_eq!(summary.messages["/output"], 62);
    assert_eq!(summary.messages["/aiding"], 60);
    assert_eq!(summary.messages["/event"], 2);
    assert_eq!(summary.bytes, bytes.len() as u64);
    let contents = reader::read_bytes(&bytes).unwrap();
    assert_eq!(contents.messages, summary.messages);
    assert!(!contents.truncated);

    let mut recording = Recording::new(&bytes[..]).unwrap();
    let mut modes = Vec::new();
    while let Some((time_ns, item)) = recording.next_item().unwrap() {
        if let Item::Event(Event::Mode { to, .. }) = item {
            modes.push((time_ns, to));
        }
    }
    assert_eq!(
        modes,
        [(PERIOD_NS, "calibrating".into()), (6001 * PERIOD_NS, "navigating".to_owned())]
    );
    // The last parameters are there, whatever the period.
    let mut epochs = Epochs::new(Recording::new(&bytes[..]).unwrap());
    let (mut last, mut rows) = (None, 0);
    while let Some(epoch) = epochs.next_epoch().unwrap() {
        last = epoch.parameters.or(last);
        if let (Some(truth), Some(_)) = (epoch.truth, epoch.output) {
            assert_eq!(truth.time.ns, epoch.time_ns);
            rows += 1;
        }
    }
    assert_eq!(rows, 62, "truth stands beside its output");
    assert_eq!(last, steps.last().unwrap().parameters);
    assert_eq!(truth_of(&steps[0]).time.ns, PERIOD_NS);
}

#[test]
fn a_file_cut_at_any_byte_gives_its_beginning_and_no_panic() {
    let steps = stream(450);
    let options = RecorderOptions {
        scenario: "schema = 1\n".repeat(3),
        epochs_per_block: 100,
        ..RecorderOptions::default()
    };
    let (bytes, _) = record(&steps, &options);
    let (mut readable, mut most) = (0, 0);
    for length in 0..bytes.len() {
        match reader::read_bytes(&bytes[..length]) {
            Ok(contents) => {
                assert!(contents.truncated, "cut at {length} of {}", bytes.len());
                let messages: u64 = contents.messages.values().sum();
                assert!(messages >= most, "a longer file has no less in it");
                most = messages;
                readable += 1;
            }
            Err(ReadError::Records(_) | ReadError::Foreign) => {
                assert_eq!(readable, 0, "cut at {length}: the head was there before");
            }
            Err(error) => panic!("cut at {length}: {error}"),
        }
    }
    let whole = reader::read_bytes(&bytes).unwrap();
    assert!(!whole.truncated);
    assert_eq!(most, whole.messages.values().sum::<u64>());
}

#[test]
fn a_flipped_bit_is_found_or_does_not_matter() {
    let steps = stream(450);
    let (bytes, _) = record(&steps, &full());
    let items = |bytes: &[u8]| -> Result<Vec<(u64, String)>, ReadError> {
        let mut recording = Recording::new(bytes)?;
        let mut items = Vec::new();
        while let Some((time_ns, item)) = recording.next_item()? {
            items.push((time_ns, format!("{item:?}")));
        }
        Ok(items)
    };
    let whole = items(&bytes).unwrap();
    let mut found = 0u32;
    for at in (0..bytes.len()).step_by(bytes.len() / 400) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 1 << (at % 8);
        match items(&damaged) {
            Err(_) => found += 1,
            // Everything that was read is what was written: a prefix, or all of it.
            Ok(read) => assert_eq!(read[..], whole[..read.len()], "bit at byte {at}"),
        }
    }
    assert!(found > 350, "{found} of 400 found");
}

/// Accepts a number of bytes, then the disk is full.
struct SmallDisk {
    memory: Memory,
    left: usize,
}

impl Write for SmallDisk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.left == 0 {
            return Err(io::ErrorKind::StorageFull.into());
        }
        let n = bytes.len().min(self.left);
        self.left -= n;
        self.memory.write(&bytes[..n])
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_full_disk_ends_the_run_and_what_was_written_is_readable() {
    let steps = stream(20_000);
    let memory = Memory::default();
    let disk = SmallDisk { memory: memory.clone(), left: 400_000 };
    let mut recorder = Recorder::to_writer(disk, &full()).unwrap();
    let result = steps
        .iter()
        .try_for_each(|step| push(&mut recorder, step))
        .and_then(|()| recorder.finish().map(|_| ()));
    match result {
        Err(RecorderError::Write { written_bytes, source }) => {
            assert_eq!(source.kind(), io::ErrorKind::StorageFull);
            assert_eq!(written_bytes, 400_000);
        }
        other => panic!("expected a write error, got {other:?}"),
    }
    let contents = reader::read_bytes(&memory.0.lock().unwrap()).unwrap();
    assert!(contents.truncated);
    assert!(contents.messages["/imu"] > 1000, "{:?}", contents.messages);
}

#[cfg(target_os = "linux")]
#[test]
fn dev_full_is_a_clear_error() {
    let device = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let error = Recorder::to_writer(device, &full()).unwrap_err();
    assert!(matches!(error, RecorderError::Write { written_bytes: 0, .. }), "{error}");
    assert!(error.to_string().contains("No space left"), "{error}");
}

#[test]
fn a_newer_version_and_a_foreign_file_are_refused_in_plain_words() {
    let (bytes, _) = record(&stream(10), &full());
    // The version is one digit in the metadata at the beginning of the file.
    let at = bytes.windows(8).position(|w| w == b"version\x01").unwrap() + 11;
    assert_eq!(bytes[at], b'1');
    let mut newer = bytes;
    newer[at] = b'2';
    let error = reader::read_bytes(&newer).unwrap_err();
    assert!(matches!(error, ReadError::NewerVersion { found: 2 }), "{error}");

    let mut foreign = io::Cursor::new(Vec::new());
    mcap::Writer::new(&mut foreign).unwrap().finish().unwrap();
    let error = reader::read_bytes(foreign.get_ref()).unwrap_err();
    assert!(matches!(error, ReadError::Foreign), "{error}");
    let error = reader::read_bytes(b"no such thing").unwrap_err();
    assert!(error.to_string().contains("not an MCAP file"), "{error}");
}

/// Hashes without a file are computed in the loop, those of a file by its thread: both agree on
/// altered, lost and added epochs, also with parameters.
#[test]
fn hashes_alone_are_those_of_a_file() {
    let mut steps = stream(3000);
    for k in (700..710).chain([1199, 1200]) {
        steps[k].faulted.sample.delta_theta[1] ^= 1;
    }
    steps[1399].faulted.aiding = None;
    let told = |mut recorder: Recorder| {
        for (k, step) in steps.iter().enumerate() {
            if (1500..1503).contains(&k) {
                recorder.lost(&step.clean).unwrap();
                continue;
            }
            push(&mut recorder, step).unwrap();
            if k == 2001 {
                let step_ns = step.clean.sample.device_time.ns;
                recorder.added(step_ns, &steps[1500].clean, &step.output).unwrap();
            }
        }
        recorder.finish().unwrap()
    };
    let options = RecorderOptions::default();
    let file = told(Recorder::to_writer(std::io::sink(), &options).unwrap());
    let alone = told(Recorder::hash_only(&options));
    assert_eq!((file.epochs, file.aiding, file.altered), (2998, 14, 17));
    assert_eq!((alone.epochs, alone.aiding, alone.altered), (2998, 14, 17));
    assert_eq!(alone.stream_hash, file.stream_hash);
    assert_eq!(file.altered_streams.as_ref().unwrap().first_sample, 701);
    assert_eq!(alone.altered_streams, file.altered_streams);

    let one = told(Recorder::stream_hash_only(&options));
    assert_eq!(one.stream_hash, file.stream_hash);
    assert_eq!((one.altered, one.altered_streams), (17, None));
}

#[test]
fn parameters_that_were_announced_have_to_come() {
    let mut steps = stream(401);
    steps[300].output.parameters_revision = 9;
    let mut recorder = Recorder::hash_only(&RecorderOptions::default());
    let error = steps.iter().find_map(|step| {
        let frame = octant_recorder::EpochFrame {
            clean: &step.clean,
            faulted: &step.faulted,
            output: &step.output,
        };
        recorder.push(frame).err().or_else(|| {
            if let Some(parameters) = step.parameters {
                recorder.extra(&octant_recorder::Extra::Parameters(parameters));
            }
            None
        })
    });
    match error {
        Some(RecorderError::ParametersMissing { sequence: 302, revision: 9 }) => {}
        other => panic!("{other:?}"),
    }
}

#[test]
fn events_and_metadata_come_back() {
    let memory = Memory::default();
    let options =
        RecorderOptions { metadata: [("seed".to_owned(), "42".to_owned())].into(), ..full() };
    let mut recorder = Recorder::to_writer(memory.clone(), &options).unwrap();
    let steps = stream(3);
    push(&mut recorder, &steps[0]).unwrap();
    let event = Event::Other { kind: "other".into(), detail: serde_json::json!({"armed": 1}) };
    recorder.event(event.clone());
    recorder.finish().unwrap();
    let bytes = memory.0.lock().unwrap().clone();
    let mut recording = Recording::new(&bytes[..]).unwrap();
    assert_eq!(recording.info().scenario, "schema = 1\n");
    assert_eq!(recording.info().run["seed"], "42");
    assert_eq!(recording.info().samples, Samples::Full);
    let mut events = Vec::new();
    while let Some((time_ns, item)) = recording.next_item().unwrap() {
        if let Item::Event(event) = item {
            events.push((time_ns, event));
        }
    }
    assert_eq!(events[1], (PERIOD_NS, event), "after the event of the first mode");
}
