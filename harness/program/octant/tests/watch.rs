//! Watching: a run in another process, one that was killed, and the picture on the terminal.

use crate::common::known::{known, shows};
use crate::common::program::{ended, octant_in, program};
use octant_evidence::{Existing, RunFolder};
use octant_recorder::Event;
use octant_recorder::reader::{Item, Recording};
use octant_test_processes::start;
use octant_watch::follow::{Follow, Stage};
use octant_watch::place::RunPlace;
use serde_json::Value;
use std::path::Path;
use std::process::{Child, Stdio};

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
    let mut recording = Recording::open(&watched.join("recording.mcap")).unwrap();
    let mut frames = Vec::new();
    while let Some((_, item)) = recording.next_item().unwrap() {
        if let Item::Event(Event::Pace(pace)) = item {
            frames.push(pace.frames);
        }
    }
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
    use crate::common::epochs::record;
    use crate::common::stream::stream;
    use octant_recorder::RecorderOptions;
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    std::fs::write(here.join("s.toml"), SECONDS).unwrap();
    let (_, error) = ended(octant_in(here, &["run", "s.toml", "--live"]), 2);
    shows(&error, &["--live", "--features octant/foxglove"]);
    assert!(!here.join("runs").exists(), "nothing was written");
    let (bytes, _) = record(&stream(200), &RecorderOptions::default());
    std::fs::write(here.join("a.mcap"), bytes).unwrap();
    let (_, error) = ended(octant_in(here, &["watch", "a.mcap", "--foxglove"]), 2);
    shows(&error, &["--foxglove", "--features octant/foxglove"]);
}
