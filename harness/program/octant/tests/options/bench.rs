//! Files of the lines, and the lines run.

use super::Evidence;
use super::sources::mentions;
use crate::common::program::{ended, octant_in, program};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Stdio;

/// Scenario of little more than a minute.
const SHORT: &str = r#"schema = 1
title = "short"
seed = 1
[imu]
rate = "10 Hz"
[record]
samples = "full"
[procedure.calibration]
duration = "70 s"
stops = [{}]
"#;

/// Navigation alone, of the duration in place of `DURATION`.
const NAVIGATION: &str = r#"schema = 1
title = "navigation"
seed = 1
[imu]
rate = "8 Hz"
[record]
rate = "1 Hz"
[procedure.navigation]
duration = "DURATION"
"#;

/// Rest of a scenario with two methods, both of which are refused: no calibration has innovations as small.
const REFUSED: &str = r#"refuse_above_mean_nis = 1e-3
[procedure.navigation]
duration = "24 h"
[baseline]
name = "other"
stops = [{ roll = "45 deg" }]
"#;

/// Faults of `faulty.toml`: one by the clock, one by hand.
const FAULTS: &str = r#"
[[faults]]
id = "step"
kind = "bias-step"
trigger = { at = "20 s" }
channels = "gyro x"
amplitude = "100 deg/h"
[[faults]]
id = "hand"
kind = "bias-step"
trigger = { manual = true }
channels = "gyro y"
amplitude = "100 deg/h"
"#;

const CAMPAIGN: &str = r#"schema = 1
title = "two"
replicates = 2
[[scenarios]]
id = "short"
file = "short.toml"
"#;

/// Power of a supply that isn't there, for a device that isn't either.
const POWER: &str = r#"
[endpoint]
uri = "udp:127.0.0.1:9"
[power]
port = "tcp:127.0.0.1:1"
voltage = "12 V"
current_limit = "1 A"
"#;

/// Turntable that isn't there.
const TABLE: &str = r#"schema = 1
[procedure.navigation]
duration = "10 s"
rotation = "none"
[source]
uri = "udp:127.0.0.1:0"
[turntable.drive]
port = "tcp:127.0.0.1:1"
azimuth = ["-5 deg", "5 deg"]
roll = ["-5 deg", "25 deg"]
"#;

/// Scenario that sequences are designed for.
const DAY: &str = r#"schema = 1
title = "day"
[procedure.calibration]
duration = "2 h"
[procedure.navigation]
duration = "24 h"
"#;

const NEEDS: &str = r#"schema = 1
[[requirements]]
id = "A"
text = "It is safe."
verification = "inspection"
"#;

/// A requirement that fails seldom, for calibrations that are refused more often.
const RISK: &str = r#"refuse_above_mean_nis = 3.2
[[requirements]]
id = "G-1"
text = "Small."
measure = "|calibration.parameters.gyro_bias_x.error|"
limit = "0.006 deg/h"
"#;

/// Longest text of a file that is looked at.
const TEXT_MAX: u64 = 1_000_000;

/// Folder with the files, in which each line gets a folder of its own.
pub(super) struct Bench {
    folder: tempfile::TempDir,
    /// Outcomes of lines.
    found: RefCell<BTreeMap<Vec<String>, String>>,
}

impl Bench {
    /// Writes the scenarios, runs one, plans a campaign, and builds FMUs.
    pub(super) fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let bench = Self { folder, found: RefCell::default() };
        bench.write("short.toml", SHORT);
        bench.write("faulty.toml", &format!("{SHORT}{FAULTS}"));
        bench.write("campaign.toml", CAMPAIGN);
        bench.write("refused.toml", &format!("{SHORT}{REFUSED}"));
        bench.write("free.toml", &NAVIGATION.replace("DURATION", "24 h"));
        bench.write("nav.toml", &NAVIGATION.replace("DURATION", "10 min"));
        bench.write("old.toml", SHORT);
        bench.write("table.toml", TABLE);
        bench.write("day.toml", DAY);
        bench.write("needs.toml", NEEDS);
        bench.write("old.sdoc", "");
        bench.write("old.mcap", "");
        bench.write("longer.toml", &CAMPAIGN.replace("replicates = 2", "replicates = 3"));
        bench.write("bad.toml", &format!("{SHORT}[endpoint]\nuri = \"exec:/bin/false\"\n"));
        bench.write("bad-campaign.toml", &CAMPAIGN.replace("short.toml", "bad.toml"));
        bench.write("risk.toml", &format!("{SHORT}{RISK}"));
        bench.write("power.toml", &format!("{SHORT}{POWER}"));
        for (line, status) in [
            ("run short.toml --out done", 0),
            ("run short.toml --out again", 0),
            ("run nav.toml --out nav", 0),
            ("export nav --to csv --tables navigation --out csv", 0),
            // The core refuses a calibration with such a fault.
            ("run faulty.toml --out broken", 1),
            ("campaign plan campaign.toml --out planned", 0),
            // No requirement is checked in it.
            ("campaign run planned", 3),
            ("campaign bundle planned --out file://$BENCH/stored", 0),
            ("campaign plan campaign.toml --out grown", 0),
            // Nobody is at the other end.
            ("campaign plan bad-campaign.toml --out bad", 0),
            ("campaign run bad", 4),
            ("nightly campaign.toml --history nights --accept", 3),
            ("fmu build --out fmus", 0),
        ] {
            let words = bench.words(line);
            let words: Vec<&str> = words.iter().map(String::as_str).collect();
            ended(octant_in(bench.folder.path(), &words), status);
        }
        bench
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.folder.path().join(name), text).unwrap();
    }

    /// Describes why evidence isn't any; `None` if it is.
    pub(super) fn failure(&self, option: &str, evidence: &Evidence) -> Option<String> {
        match evidence {
            Evidence::Acts(line, shown) => {
                let parts = line.split_once('[').and_then(|(begin, rest)| {
                    let (bracket, end) = rest.split_once(']')?;
                    mentions(bracket, option).then_some((begin, bracket, end))
                });
                let Some((begin, bracket, end)) = parts else {
                    return Some(format!("octant {line}: expected {option} in the brackets"));
                };
                let with = self.run(&format!("{begin}{bracket}{end}"));
                let without = self.run(&format!("{begin}{end}"));
                let why = match (with.contains(shown), without.contains(shown)) {
                    (true, false) => return None,
                    (false, _) => format!("with the option there is no {shown:?}"),
                    (true, true) => format!("without the option there is {shown:?} too"),
                };
                Some(format!("octant {line}: {why}\n--- with\n{with}\n--- without\n{without}"))
            }
            Evidence::Read(line, words) | Evidence::Refused(line, words) => {
                let found = self.run(line);
                let is_named = matches!(evidence, Evidence::Read(..)) || mentions(&found, option);
                let is_refused = found.starts_with("exit status 2\n") && found.contains(words);
                (!is_refused || !is_named || !mentions(line, option)).then(|| {
                    format!(
                        "octant {line}: expected {option} to be refused with {words:?}\n{found}"
                    )
                })
            }
            Evidence::Tested(_) => None,
        }
    }

    /// Runs a line in a new folder, once: its exit status, what it printed, and the files that it wrote.
    fn run(&self, line: &str) -> String {
        let words = self.words(line);
        if let Some(found) = self.found.borrow().get(&words) {
            return found.clone();
        }
        let found = self.ran(&words);
        self.found.borrow_mut().insert(words, found.clone());
        found
    }

    /// Splits a line into its words; `$BENCH` is the folder.
    fn words(&self, line: &str) -> Vec<String> {
        words(&line.replace("$BENCH", self.folder.path().to_str().unwrap()))
    }

    fn ran(&self, words: &[String]) -> String {
        let folder = self.folder.path().join(format!("line-{}", self.found.borrow().len()));
        std::fs::create_dir(&folder).unwrap();
        let mut command = program(&[]);
        command.args(words).current_dir(&folder).stdin(Stdio::null());
        let output = command.output().unwrap();
        let mut found = format!(
            "exit status {}\n{}{}",
            output.status.code().unwrap_or(-1),
            String::from_utf8_lossy(&output.stdout),
            String::from_utf8_lossy(&output.stderr)
        );
        let mut files = Vec::new();
        files_of(&folder, &mut files);
        for path in files {
            let name = path.strip_prefix(&folder).unwrap().display().to_string();
            let _ = writeln!(found, "file {name}");
            if path.metadata().unwrap().len() <= TEXT_MAX
                && let Ok(text) = std::fs::read_to_string(&path)
            {
                found += &text;
            }
        }
        found
    }
}

/// Splits a line into its words, as a shell does; single quotes hold a word together.
fn words(line: &str) -> Vec<String> {
    let (mut words, mut word, mut is_quoted) = (Vec::new(), None::<String>, false);
    for c in line.chars() {
        match c {
            '\'' => {
                is_quoted = !is_quoted;
                word.get_or_insert_default();
            }
            ' ' if !is_quoted => words.extend(word.take()),
            c => word.get_or_insert_default().push(c),
        }
    }
    words.extend(word);
    words
}

/// Lists the files below a folder, in order.
fn files_of(folder: &Path, all: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() { files_of(&path, all) } else { all.push(path) }
    }
}
