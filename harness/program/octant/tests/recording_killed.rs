//! A recorder that is killed at any moment leaves all but the last second of wall time, and the
//! killed program leaves a part of its run that is the same to the bit.

use crate::common::epochs::push;
use crate::common::program::{ended, octant, program, test_as_process};
use crate::common::stream::stream;
use octant_recorder::reader::{Epochs, Recording, contents};
use octant_recorder::{Policy, Recorder, RecorderOptions, Samples};
use octant_test_processes::start;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

const PATH: &str = "OCTANT_TEST_RECORD_TO";

/// Child process: records an epoch every 10 ms until it is killed, and prints its progress.
#[test]
#[ignore = "run by a_kill_costs_less_than_a_second, which kills it"]
fn child_that_records_slowly() {
    let path = std::env::var_os(PATH).unwrap();
    let options = RecorderOptions {
        policy: Policy { samples: Samples::Full, ..Policy::default() },
        ..RecorderOptions::default()
    };
    let mut recorder = Recorder::to_file(Path::new(&path), &options).unwrap();
    for (k, step) in stream(100_000).iter().enumerate() {
        push(&mut recorder, step).unwrap();
        writeln!(std::io::stderr(), "epoch {}", k + 1).unwrap();
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn a_kill_costs_less_than_a_second() {
    let folder = tempfile::tempdir().unwrap();
    for (round, run_ms) in [1300, 1750, 2100].into_iter().enumerate() {
        let path = folder.path().join(format!("{round}.mcap"));
        let mut child = start(
            test_as_process("recording_killed::child_that_records_slowly")
                .env(PATH, &path)
                .stdout(Stdio::null())
                .stderr(Stdio::piped()),
        );
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
        // Times at which each epoch was reported as recorded.
        let mut said: Vec<(Instant, u64)> = Vec::new();
        let end = loop {
            let line = lines.next().unwrap().unwrap();
            if let Some(epoch) = line.strip_prefix("epoch ") {
                said.push((Instant::now(), epoch.parse().unwrap()));
            }
            if said
                .first()
                .is_some_and(|(start, _)| start.elapsed() > Duration::from_millis(run_ms))
            {
                break Instant::now();
            }
        };
        // SIGKILL on Unix.
        child.kill().unwrap();
        child.wait().unwrap();

        // A busy host delayed the child, and its writing thread.
        let pauses = said.windows(2).map(|pair| pair[1].0 - pair[0].0);
        let held_up = pauses.filter(|pause| *pause > Duration::from_millis(50)).sum::<Duration>();
        let second_before = end - Duration::from_secs(1) - held_up;
        let older = said.iter().take_while(|(at, _)| *at <= second_before);
        let expected = older.last().map_or(0, |(_, epoch)| *epoch);
        let whole = contents(Recording::open(&path).unwrap()).unwrap();
        assert!(whole.truncated);
        assert!(
            whole.messages["/imu"] >= expected,
            "{} of the {expected} epochs that were older than a second, {} in all",
            whole.messages["/imu"],
            said.len()
        );
        // The remaining content is correct.
        let steps = stream(whole.messages["/imu"].max(200));
        let mut epochs = Epochs::new(Recording::open(&path).unwrap());
        for step in steps.iter().take(whole.messages["/imu"] as usize) {
            assert_eq!(epochs.next_epoch().unwrap().unwrap().sample, Some(step.faulted.sample));
        }
    }
}

/// Lists the readable epochs of a recording, each as text.
fn epochs(path: &Path) -> Vec<String> {
    let mut epochs = Epochs::new(Recording::open(path).unwrap());
    let mut all = Vec::new();
    while let Some(epoch) = epochs.next_epoch().unwrap() {
        all.push(format!("{epoch:?}"));
    }
    all
}

#[test]
fn the_program_killed_at_any_moment_leaves_the_beginning_of_its_run() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = folder.path().join("scenario.toml");
    let text = include_str!("../../../../fixtures/scenarios/lockstep.toml");
    // Long enough to be killed well before its end.
    let text = text.replace("duration = \"2 min\"", "duration = \"100 h\"");
    std::fs::write(&scenario, &text).unwrap();
    let scenario = scenario.to_str().unwrap();
    let short = folder.path().join("short.toml");
    let text = include_str!("../../../../fixtures/scenarios/lockstep.toml");
    std::fs::write(&short, text).unwrap();
    let whole = folder.path().join("whole");
    ended(octant(&["run", short.to_str().unwrap(), "--out", whole.to_str().unwrap()]), 0);
    let expected = epochs(&whole.join("recording.mcap"));
    assert_eq!(expected.len(), 120_000);

    // Moments of the kill by the size of the file: in its head, in the first chunk, later; the
    // first few differ with each run.
    for (round, bytes) in
        [1, 1_000, 300_000, 1_500_000, 4_000_000, 9_000_000].into_iter().enumerate()
    {
        let out = folder.path().join(format!("killed-{round}"));
        let recording = folder.path().join(format!("killed-{round}.partial/recording.mcap"));
        let mut child = start(
            program(&["run", scenario, "--out", out.to_str().unwrap()])
                .stdout(Stdio::null())
                .stderr(Stdio::null()),
        );
        while std::fs::metadata(&recording).map_or(0, |file| file.len()) < bytes {
            assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
            std::thread::sleep(Duration::from_millis(1));
        }
        // Content readable by others while it is written.
        let before =
            Recording::open(&recording).map(|file| contents(file).unwrap().messages["/imu"]);
        child.kill().unwrap();
        child.wait().unwrap();
        assert!(!out.exists(), "a part of a run has no name of a whole one");
        let Ok(file) = Recording::open(&recording) else {
            // Killed within its head: nothing was readable before either.
            assert!(before.is_err() && bytes < 1_000, "round {round}");
            continue;
        };
        let left = contents(file).unwrap();
        assert!(left.truncated);
        assert!(left.messages["/imu"] >= before.unwrap_or(0), "round {round}");
        // A chunk has 512 KiB before compression, and is written when it is full.
        assert!(bytes < 1_000_000 || left.messages["/imu"] > 0, "round {round}");
        let found = epochs(&recording);
        let both = found.len().min(expected.len());
        // The last epoch may be incomplete: a chunk ends between two messages.
        let same = found.iter().zip(&expected).take(both.saturating_sub(1)).all(|(a, b)| a == b);
        assert!(same, "round {round}: {} epochs", found.len());
    }
}
