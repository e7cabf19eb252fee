//! A recorder that is killed at any moment leaves all but the last second of wall time.

use crate::common::epochs::{push, stream};
use crate::common::program::test_as_process;
use octant::recorder::reader::{Epochs, Recording, contents};
use octant::recorder::{Policy, Recorder, RecorderOptions, Samples};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

const PATH: &str = "OCTANT_TEST_RECORD_TO";

/// The child: records an epoch every 10 ms until it is killed, and says what it has recorded.
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
        let mut child = test_as_process("recording_killed::child_that_records_slowly")
            .env(PATH, &path)
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
        // When each epoch was said to be recorded.
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

        // A host that was busy with others held the child up, and the thread that writes with it.
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
        // And what is there is right.
        let steps = stream(whole.messages["/imu"].max(200));
        let mut epochs = Epochs::new(Recording::open(&path).unwrap());
        for step in steps.iter().take(whole.messages["/imu"] as usize) {
            assert_eq!(epochs.next_epoch().unwrap().unwrap().sample, Some(step.faulted.sample));
        }
    }
}
