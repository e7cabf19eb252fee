//! Watching: a growing recording, a run in another process, and the picture on the terminal.

use crate::common::epochs::{push, record};
use crate::common::program::{ended, octant_in, program};
use crate::common::stream::stream;
use octant_evidence::{Existing, RunFolder};
use octant_recorder::event::Pace;
use octant_recorder::reader::{Item, Recording};
use octant_recorder::{Event, Policy, Recorder, RecorderOptions, Samples};
use octant_test_processes::start;
use octant_watch::follow::{Follow, Stage};
use octant_watch::place::RunPlace;
use octant_watch::tail::{PollEnd, Tail, TailError};
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::{self, Read, Write};
use std::path::Path;
use std::process::{Child, Stdio};

fn full() -> RecorderOptions {
    RecorderOptions {
        policy: Policy { samples: Samples::Full, ..Policy::default() },
        scenario: "schema = 1\ntitle = \"a stream\"\n".into(),
        ..RecorderOptions::default()
    }
}

/// Returns all messages of a complete file.
fn items(bytes: &[u8]) -> Vec<(u64, Item)> {
    let mut recording = Recording::new(bytes).unwrap();
    std::iter::from_fn(|| recording.next_item().unwrap()).collect()
}

/// Compares to the last bit: NaN equals NaN.
#[track_caller]
fn same(found: &[(u64, Item)], expected: &[(u64, Item)]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert_eq!(format!("{found:?}"), format!("{expected:?}"));
    }
}

/// File of which a part is written.
struct Prefix<'a> {
    bytes: &'a [u8],
    written: usize,
    read: usize,
}

impl Read for Prefix<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n = buffer.len().min(self.written - self.read);
        buffer[..n].copy_from_slice(&self.bytes[self.read..self.read + n]);
        self.read += n;
        Ok(n)
    }
}

#[test]
fn a_file_that_grows_by_single_bytes_gives_every_message_once() {
    // Noise doesn't compress: several chunks.
    let (bytes, _) = record(&stream(6000), &full());
    let expected = items(&bytes);
    let mut recording = Recording::growing(Prefix { bytes: &bytes, written: 0, read: 0 });
    let mut found = Vec::new();
    let mut grew = 0;
    for written in 0..=bytes.len() {
        recording.source().written = written;
        let before = found.len();
        while let Some(item) = recording.next_item().unwrap() {
            found.push(item);
        }
        grew += usize::from(found.len() > before);
        assert!(!recording.truncated());
        assert_eq!(recording.ended(), written == bytes.len(), "after {written} bytes");
    }
    assert!(grew >= 2, "the messages came {grew} times");
    same(&found, &expected);
}

#[test]
fn every_prefix_of_a_file_gives_a_prefix_of_its_messages() {
    let (bytes, _) = record(&stream(6000), &full());
    let expected = items(&bytes);
    let mut lengths = Vec::new();
    for written in (0..bytes.len()).step_by(4999).chain([8, 9, bytes.len() - 1, bytes.len()]) {
        let mut recording = Recording::growing(Prefix { bytes: &bytes, written, read: 0 });
        let found: Vec<_> = std::iter::from_fn(|| recording.next_item().unwrap()).collect();
        same(&found, &expected[..found.len()]);
        lengths.push(found.len());
        // The rest comes when it is there.
        recording.source().written = bytes.len();
        let rest: Vec<_> = std::iter::from_fn(|| recording.next_item().unwrap()).collect();
        same(&rest, &expected[found.len()..]);
        assert!(recording.ended());
    }
    lengths.dedup();
    assert!(lengths.len() > 2, "{lengths:?}");
}

#[test]
fn a_file_is_followed_through_its_writing_and_its_new_name() {
    let (bytes, _) = record(&stream(6000), &full());
    let expected = items(&bytes);
    let here = tempfile::tempdir().unwrap();
    let path = here.path().join("run");
    let folder = RunFolder::create(&path, Existing::Refuse).unwrap();
    let mut tail = Tail::new(RunPlace::of(&path).unwrap());
    let mut found = Vec::new();
    let mut look = |tail: &mut Tail, most| {
        tail.look(most, |info, time_ns, item| {
            assert_eq!(info.version, 1);
            found.push((time_ns, item));
        })
        .unwrap()
    };
    assert_eq!(look(&mut tail, 10), PollEnd::Present, "there is no file yet");
    let writer = std::thread::spawn(move || {
        let mut file = std::fs::File::create(folder.path().join("recording.mcap")).unwrap();
        let mut left = &bytes[..];
        // Pieces that end within magic, heads, chunks and the summary.
        for size in [1, 6, 2, 100, 7, 1021, 3].into_iter().cycle() {
            let (piece, rest) = left.split_at(left.len().min(size));
            file.write_all(piece).unwrap();
            left = rest;
            if left.is_empty() {
                break;
            }
        }
        drop(file);
        std::fs::write(folder.path().join("manifest.json"), "{}").unwrap();
        folder.finish().unwrap();
    });
    // A limit that can end a poll in the middle of a chunk.
    while look(&mut tail, 777) != PollEnd::End {}
    writer.join().unwrap();
    same(&found, &expected);
    // The end stays the end.
    assert_eq!(tail.look(10, |_, _, _| panic!("a message after the end")).unwrap(), PollEnd::End);
}

#[test]
fn another_file_in_its_place_is_told_and_so_is_damage() {
    let (bytes, _) = record(&stream(6000), &full());
    let here = tempfile::tempdir().unwrap();
    let path = here.path().join("recording.mcap");
    std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    let mut tail = Tail::new(RunPlace::of(&path).unwrap());
    assert_eq!(tail.look(usize::MAX, |_, _, _| {}).unwrap(), PollEnd::Present);
    std::fs::write(&path, &bytes[..100]).unwrap();
    let error = tail.look(10, |_, _, _| {}).unwrap_err();
    assert!(matches!(error, TailError::Replaced { found: 100, .. }), "{error}");

    let mut damaged = bytes.clone();
    let at = bytes.len() / 3;
    damaged[at..at + 100].fill(0);
    std::fs::write(&path, &damaged).unwrap();
    let mut tail = Tail::new(RunPlace::of(&path).unwrap());
    let error = tail.look(usize::MAX, |_, _, _| {}).unwrap_err().to_string();
    assert!(error.contains("damaged after byte"), "{error}");

    std::fs::write(&path, "no recording at all").unwrap();
    let mut tail = Tail::new(RunPlace::of(&path).unwrap());
    let error = tail.look(10, |_, _, _| {}).unwrap_err().to_string();
    assert!(error.contains("not an MCAP file"), "{error}");
}

const SCENARIO: &str = "schema = 1\ntitle = \"a known state\"\nseed = 7\n[realtime]\n\
    pace = \"clock\"\n[procedure.alignment]\nmethod = \"given\"\n\
    [procedure.navigation]\nduration = \"40 s\"\n\
    [[faults]]\nid = \"spike-1\"\nkind = \"spike\"\nchannels = \"gyro x\"\n\
    amplitude = \"1000 deg/h\"\ntrigger = { at = \"5 s\" }\nduration = \"20 samples\"\n\
    [[faults]]\nid = \"late-1\"\nkind = \"late-delivery\"\ndelay = \"3 samples\"\n\
    trigger = { at = \"30 s\" }\nduration = \"20 samples\"\n";

/// Records 20 s of the test stream with an active fault and a report of the time keeping, not yet
/// ended.
pub fn known(folder: &RunFolder) -> Recorder {
    let options = RecorderOptions {
        scenario: SCENARIO.to_owned(),
        metadata: BTreeMap::from([("seed".to_owned(), "7".to_owned())]),
        ..RecorderOptions::default()
    };
    let path = folder.path().join("recording.mcap");
    let mut recorder = Recorder::to_file(&path, &options).unwrap();
    for (k, step) in stream(4000).iter().enumerate() {
        push(&mut recorder, step).unwrap();
        if k == 3000 {
            let (id, kind) = ("spike-1".to_owned(), "spike".to_owned());
            recorder.event(Event::Fault { begins: true, id, kind, sample: 3001 });
            let (frames, latest_us, overruns, late_answers) = (3000, 54.25, 2, 1);
            recorder.event(Event::Pace(Pace { frames, late_answers, latest_us, overruns }));
        }
    }
    recorder
}

#[track_caller]
pub fn shows(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "{part:?} is missing in\n{text}");
    }
}

#[test]
fn a_run_that_was_killed_is_told_from_one_that_goes_on() {
    let here = tempfile::tempdir().unwrap();
    let folder = RunFolder::create(&here.path().join("killed"), Existing::Refuse).unwrap();
    let mut recorder = known(&folder);
    recorder.hand_over().unwrap();
    let mut follow = Follow::new(RunPlace::of(folder.path()).unwrap());
    while follow.state.about.title.is_empty() {
        follow.look(|_, _, _| {}).unwrap();
    }
    assert_eq!(follow.stage, Stage::Running);
    recorder.finish().unwrap();
    // State after a kill: a file without its end, and a lock that no process holds.
    let path = folder.path().join("recording.mcap");
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() - 1]).unwrap();
    drop(folder);
    let mut follow = Follow::new(RunPlace::of(&here.path().join("killed")).unwrap());
    // A child that another test starts holds the lock as well, until it is the program that it becomes.
    octant_test_processes::wait_for("the end", || {
        while follow.look(|_, _, _| {}).unwrap() {}
        follow.stage == Stage::BrokenOff
    });
    assert_eq!(follow.state.time_ns, 20_000_000_000, "what it left is shown");
    let (text, error) = ended(octant_in(here.path(), &["watch", "killed.partial", "--plain"]), 4);
    shows(&text, &["20.0 s"]);
    shows(&error, &["nobody writes it any more"]);
}

/// A run that was killed between its summary and its manifest, or before its folder got its name, has no verdict: every
/// command that tells one says so.
#[test]
fn a_run_that_was_killed_before_its_folder_was_whole_has_no_verdict() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let scenario = SECONDS.replace("[realtime]\noverrun = \"10 s\"\n", "");
    std::fs::write(here.join("s.toml"), scenario).unwrap();
    ended(octant_in(here, &["run", "s.toml", "--out", "whole"]), 0);
    ended(octant_in(here, &["watch", "whole", "--plain"]), 0);
    // Without the manifest, under both names.
    let manifest = std::fs::read(here.join("whole/manifest.json")).unwrap();
    std::fs::remove_file(here.join("whole/manifest.json")).unwrap();
    for name in ["whole", "killed.partial"] {
        if name != "whole" {
            std::fs::rename(here.join("whole"), here.join(name)).unwrap();
        }
        for how in ["--plain", "--once"] {
            let (text, error) = ended(octant_in(here, &["watch", name, how]), 4);
            assert!(!text.contains("ended"), "{text}");
            shows(&error, &["without a verdict: its folder isn't whole"]);
        }
        for command in ["report", "rejudge", "verify"] {
            let (text, error) = ended(octant_in(here, &[command, name]), 2);
            assert!(text.is_empty() && error.contains("manifest.json"), "{command}: {text}{error}");
        }
        let (text, _) = ended(octant_in(here, &["diff", name, name]), 0);
        shows(&text, &["has no summary of an ended run"]);
        assert!(!text.contains("pass") && !text.contains("verdict none"), "{text}");
    }
    // Whole but for its name.
    std::fs::write(here.join("killed.partial/manifest.json"), &manifest).unwrap();
    let (_, error) = ended(octant_in(here, &["watch", "killed.partial", "--plain"]), 4);
    shows(&error, &["without a verdict: its folder isn't whole"]);
    let (_, error) = ended(octant_in(here, &["rejudge", "killed.partial"]), 2);
    shows(&error, &["the folder is a .partial"]);
    // A summary that isn't the one of the manifest.
    std::fs::rename(here.join("killed.partial"), here.join("altered")).unwrap();
    let summary = std::fs::read_to_string(here.join("altered/summary.json")).unwrap();
    std::fs::write(here.join("altered/summary.json"), summary.replace("by the clock", "another"))
        .unwrap();
    ended(octant_in(here, &["watch", "altered", "--plain"]), 4);
    let (_, error) = ended(octant_in(here, &["diff", "altered", "altered"]), 2);
    shows(&error, &["it isn't what manifest.json names"]);
}

const SECONDS: &str = "schema = 1\ntitle = \"by the clock\"\n[procedure.alignment]\n\
    method = \"given\"\n[procedure.navigation]\nduration = \"3 s\"\n\
    [realtime]\noverrun = \"10 s\"\n[[faults]]\nid = \"spike-1\"\nkind = \"spike\"\n\
    channels = \"gyro x\"\namplitude = \"1000 deg/h\"\ntrigger = { at = \"0.5 s\" }\n\
    duration = \"20 samples\"\n";

fn stream_hash(run: &Path) -> String {
    let bytes = std::fs::read(run.join("summary.json")).unwrap();
    let summary: Value = serde_json::from_slice(&bytes).unwrap();
    summary["stream_hash"].as_str().unwrap().to_owned()
}

/// Waits until a run in another process has a recording.
fn wait_for(path: &Path, child: &mut Child) {
    while !path.is_file() {
        assert!(child.try_wait().unwrap().is_none(), "the run ended before it was recorded");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
}

#[test]
fn a_run_in_another_process_is_watched_to_its_verdict_and_does_not_notice() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    std::fs::write(here.join("s.toml"), SECONDS).unwrap();
    let alone = ["run", "s.toml", "--out", "runs/alone", "--realtime"];
    ended(octant_in(here, &alone), 0);

    let mut run = start(
        program(&["run", "s.toml", "--out", "runs/watched", "--realtime"])
            .current_dir(here)
            .stdout(Stdio::null()),
    );
    wait_for(&here.join("runs/watched.partial/recording.mcap"), &mut run);
    // The file exists before it has content.
    let page = loop {
        let output = octant_in(here, &["watch", "--once"]);
        if !String::from_utf8_lossy(&output.stderr).contains("nothing is recorded yet") {
            break ended(output, 0).0;
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
    };
    // The newest run in progress is the only one.
    let watch = |arguments: &[&str]| {
        start(program(arguments).current_dir(here).stdout(Stdio::piped()).stderr(Stdio::piped()))
    };
    let newest = watch(&["watch", "--plain"]);
    let named = watch(&["watch", "runs/watched"]);
    let mut leaves = watch(&["watch", "runs/watched.partial", "--plain"]);
    shows(&page, &["by the clock", "spike-1"]);
    leaves.kill().unwrap();
    leaves.wait().unwrap();
    assert!(run.wait().unwrap().success());
    for watch in [newest, named] {
        let output = watch.output();
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        shows(&text, &["by the clock: none", "100.0 %", "1 of 1 faults fired", "overruns"]);
    }
    let watched = here.join("runs/watched");
    assert_eq!(stream_hash(&watched), stream_hash(&here.join("runs/alone")));
    // After the run.
    let (text, _) = ended(octant_in(here, &["watch", "runs/watched"]), 0);
    shows(&text, &["by the clock: none", "100.0 %"]);
    shows(
        &ended(octant_in(here, &["watch", "--once", "runs/watched"]), 0).0,
        &["ended: none", "100.0 %"],
    );
    // The time keeping is reported once a second.
    let bytes = std::fs::read(watched.join("recording.mcap")).unwrap();
    let paces = items(&bytes).into_iter().filter_map(|(time_ns, item)| match item {
        Item::Event(Event::Pace(pace)) => Some((time_ns, pace.frames)),
        _ => None,
    });
    let frames: Vec<u64> = paces.map(|(_, frames)| frames).collect();
    assert_eq!(frames, [200, 400, 600]);
}

#[test]
fn what_cannot_be_watched_is_said_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let (_, error) = ended(octant_in(here, &["watch"]), 2);
    shows(&error, &["no folder *.partial", "octant watch runs/NAME"]);
    let (_, error) = ended(octant_in(here, &["watch", "nothing"]), 2);
    shows(&error, &["neither", "nothing.partial"]);
    std::fs::create_dir(here.join("empty")).unwrap();
    let (_, error) = ended(octant_in(here, &["watch", "empty"]), 2);
    shows(&error, &["recording.mcap is missing"]);
    std::fs::write(here.join("text.mcap"), "no recording").unwrap();
    let (_, error) = ended(octant_in(here, &["watch", "--once", "text.mcap"]), 2);
    shows(&error, &["not an MCAP file"]);
}

#[cfg(not(feature = "foxglove"))]
#[test]
fn a_program_without_the_server_says_how_to_build_one() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    std::fs::write(here.join("s.toml"), SECONDS).unwrap();
    let (_, error) = ended(octant_in(here, &["run", "s.toml", "--live"]), 2);
    shows(&error, &["--live", "--features octant/foxglove"]);
    assert!(!here.join("runs").exists(), "nothing was written");
    let (bytes, _) = record(&stream(200), &full());
    std::fs::write(here.join("a.mcap"), bytes).unwrap();
    let (_, error) = ended(octant_in(here, &["watch", "a.mcap", "--foxglove"]), 2);
    shows(&error, &["--foxglove", "--features octant/foxglove"]);
}
