//! Runs with a person at the bench: their scenario, what they say, and how they are answered.

use super::program::OCTANT;
use octant_test_processes::{Started, command, start};
use serde_json::Value;
use std::io::Read;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// 3 s of navigation.
pub const SHORT: &str = "schema = 1\ntitle = \"short\"\nseed = 3\n[procedure.alignment]\nmethod = \"given\"\n\
    [procedure.navigation]\nduration = \"3 s\"\n[record]\nsamples = \"full\"\n[realtime]\noverrun = \"10 s\"\n";

pub const DOOR: &str = "[[operator]]\nid = \"door\"\nask = \"Is the door shut?\"\n";

pub const LEVEL: &str = "[[operator]]\nid = \"level\"\nask = \"Read the level.\"\ntrigger = { at = \"1 s\" }\n\
    answer = \"number\"\nunit = \"mm/m\"\nleast = -0.1\nmost = 0.1\nwho = \"required\"\n";

/// Time after which a run counts as hanging.
const HANGS: Duration = octant_test_processes::HANGS;

pub struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    pub fn new(steps: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("s.toml"), format!("{SHORT}{steps}")).unwrap();
        Self { folder }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The run in the folder `run`.
    pub fn command(&self, more: &[&str]) -> Command {
        let mut command = command(OCTANT);
        command.current_dir(self.folder.path()).env_remove("OCTANT_OPERATOR");
        command.args(["run", "s.toml", "--out", "run"]).args(more);
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// The run with a device in lock-step, which is Octant's core behind a pipe.
    pub fn with_device(&self, more: &[&str]) -> Command {
        let mut command = self.command(more);
        command.args([
            "--endpoint",
            &format!("exec:{OCTANT} serve --silence 3 --endpoint stdio: s.toml"),
        ]);
        command
    }

    pub fn octant(&self, words: &[&str]) -> Output {
        command(OCTANT).current_dir(self.folder.path()).args(words).output().unwrap()
    }

    /// Answers from another process.
    pub fn answer(&self, id: &str, value: &str, by: &str) -> (Option<i32>, String) {
        said(&self.octant(&["answer", "run", id, value, "--by", by]))
    }

    pub fn json(&self, file: &str) -> Value {
        serde_json::from_str(&std::fs::read_to_string(self.path(file)).unwrap()).unwrap()
    }

    /// Acts, steps, values, names and ways of the records of a manifest.
    pub fn acts(&self, folder: &str) -> Vec<[String; 5]> {
        let manifest = self.json(&format!("{folder}/manifest.json"));
        let text = |record: &Value, name: &str| record[name].as_str().unwrap_or("-").to_owned();
        let of =
            |record: &Value| ["act", "step", "value", "by", "way"].map(|name| text(record, name));
        manifest["answers"].as_array().map_or_else(Vec::new, |all| all.iter().map(of).collect())
    }

    /// Stream hash of the same samples in process, with nobody to ask.
    pub fn hash(&self) -> String {
        std::fs::write(self.path("plain.toml"), SHORT).unwrap();
        let output = self.octant(&["run", "plain.toml", "--out", "plain"]);
        assert!(output.status.success(), "{}", said(&output).1);
        self.json("plain/summary.json")["stream_hash"].as_str().unwrap().to_owned()
    }
}

pub fn said(output: &Output) -> (Option<i32>, String) {
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// A run that goes on, and what it said so far.
pub struct Going {
    pub child: Started,
    pub said: Arc<Mutex<String>>,
}

impl Going {
    pub fn start(command: &mut Command) -> Self {
        let mut child = start(command);
        let stderr = child.stderr.take().unwrap();
        Self { said: gather(stderr), child }
    }

    /// Waits until it has said this so often.
    pub fn hears(&self, words: &str, times: usize) -> String {
        let begun = Instant::now();
        loop {
            let said = self.said.lock().unwrap().clone();
            if said.matches(words).count() >= times {
                return said;
            }
            assert!(begun.elapsed() < HANGS, "{words:?} isn't said: {said}");
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    pub fn signal(&self, signal: &str) {
        let pid = self.child.id().to_string();
        assert!(command("kill").args([signal, &pid]).status().unwrap().success());
    }

    /// Waits for its end.
    pub fn end(mut self) -> (Option<i32>, String) {
        let begun = Instant::now();
        while self.child.try_wait().unwrap().is_none() {
            assert!(begun.elapsed() < HANGS, "it doesn't end: {}", self.said.lock().unwrap());
            std::thread::sleep(Duration::from_millis(10));
        }
        let status = self.child.wait().unwrap().code();
        // Its last words are on their way.
        std::thread::sleep(Duration::from_millis(100));
        let said = self.said.lock().unwrap().clone();
        (status, said)
    }
}

/// Gathers what a stream says, on a thread of its own.
pub fn gather(mut from: impl Read + Send + 'static) -> Arc<Mutex<String>> {
    let said = Arc::new(Mutex::new(String::new()));
    let all = Arc::clone(&said);
    std::thread::spawn(move || {
        let mut bytes = [0; 4096];
        while let Ok(count @ 1..) = from.read(&mut bytes) {
            all.lock().unwrap().push_str(&String::from_utf8_lossy(&bytes[..count]));
        }
    });
    said
}

pub fn record(all: [&str; 5]) -> [String; 5] {
    all.map(str::to_owned)
}
