//! One part of the page of accounts: its inputs are run, checked, and become rows.

use crate::common::program::program;
use octant_requirements::exchange::Anything;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use std::sync::Mutex;

const REFUSALS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../docs/real-data.md");
const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../docs/accounts.md");
/// Largest change of a published parameter from the run of the undamaged input, in its σ, of a run that passes.
const MOVED_MAX: f64 = 0.3;
/// Longest text of a verdict in the page.
const WORDS: usize = 110;

/// Units of an input by what becomes of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    pub used: u64,
    pub repaired: u64,
    pub left_out: u64,
    pub missing: u64,
}

impl Counts {
    pub const fn used(used: u64) -> Self {
        Self { used, repaired: 0, left_out: 0, missing: 0 }
    }

    pub const fn repaired(self, repaired: u64) -> Self {
        Self { repaired, ..self }
    }

    pub const fn left_out(self, left_out: u64) -> Self {
        Self { left_out, ..self }
    }

    pub const fn missing(self, missing: u64) -> Self {
        Self { missing, ..self }
    }

    pub const fn read(&self) -> u64 {
        self.used + self.repaired + self.left_out
    }
}

/// How a run ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    Pass,
    /// Fail with words of a reason.
    Fail(&'static str),
    /// Inconclusive with words of a reason.
    Inconclusive(&'static str),
    /// The program refuses the input with these words.
    Refused(&'static str),
    /// The run breaks off with these words.
    Broken(&'static str),
}

/// Estimate and σ by parameter.
pub type Parameters = BTreeMap<String, (f64, f64)>;

/// One input.
pub struct Case<'a> {
    /// Kind of input, and its content: the first cells of its row.
    pub input: &'a str,
    pub holds: &'a str,
    /// Files by name, the scenario `s.toml` among them.
    pub files: &'a [(&'a str, &'a [u8])],
    /// Settings of the scenario.
    pub set: &'a [&'a str],
    /// Counts by construction, by the name of the account's input; empty: the input is refused before it is counted.
    pub counts: &'a [(&'a str, Counts)],
    pub ends: Ends,
}

/// A part of the page.
pub struct Part {
    mark: &'static str,
    rows: String,
    count: usize,
    wrong: Vec<String>,
    /// Words of refusals that docs/real-data.md explains.
    refusals: Vec<String>,
    /// Parameters of the undamaged input.
    pub clean: Option<Parameters>,
    /// Name that differs from run to run, as a port of this host, and the one that the page has.
    pub hidden: Option<(String, &'static str)>,
}

impl Part {
    pub fn new(mark: &'static str) -> Self {
        Self {
            mark,
            rows: String::new(),
            count: 0,
            wrong: Vec::new(),
            refusals: refusals(),
            clean: None,
            hidden: None,
        }
    }

    /// Runs an input by `octant run`; returns the parameters of its calibration.
    pub fn run(&mut self, case: &Case<'_>) -> Parameters {
        let set = case.set.iter().flat_map(|set| ["--set", set]);
        let arguments: Vec<&str> =
            ["run", "s.toml", "--out", "out"].into_iter().chain(set).collect();
        self.ends(case, &arguments)
    }

    /// Converts a document of requirements, whose account is in the new file.
    pub fn converts(&mut self, case: &Case<'_>) {
        let (document, _) = case.files[0];
        self.stated(case, &["requirements", "convert", document, "r.toml"], |folder| {
            let text = std::fs::read_to_string(folder.join("r.toml")).ok()?;
            let read = octant_verdict::file::read(&text, "r.toml", &Anything).unwrap();
            let accounts = serde_json::to_value(&read.accounts).unwrap();
            let doubts = read.doubts();
            let verdict = if doubts.is_empty() { "pass" } else { "inconclusive" };
            Some(json!({ "inputs": accounts, "verdict": verdict, "reasons": doubts }))
        });
    }

    /// Runs a command on an input, and checks how it ends.
    pub fn ends(&mut self, case: &Case<'_>, arguments: &[&str]) -> Parameters {
        self.stated(case, arguments, |folder| {
            let summary = std::fs::read(folder.join("out/summary.json")).ok();
            summary.map(|bytes| serde_json::from_slice(&bytes).unwrap())
        })
    }

    /// Runs a command on an input, and checks how it ends by what it wrote into its folder.
    fn stated(
        &mut self,
        case: &Case<'_>,
        arguments: &[&str],
        summary: impl FnOnce(&Path) -> Option<Value>,
    ) -> Parameters {
        let folder = tempfile::tempdir().unwrap();
        for (name, content) in case.files {
            std::fs::write(folder.path().join(name), content).unwrap();
        }
        let output = program(arguments).current_dir(folder.path()).output().unwrap();
        let here = format!("{}/", folder.path().display());
        let said = String::from_utf8_lossy(&output.stderr).replace(&here, "");
        let summary = summary(folder.path());
        let mut wrong = Vec::new();
        // Also a run in doubt says so wherever its summary is read; a campaign has another one.
        if let Some(summary) = summary.as_ref().filter(|summary| summary.get("schema").is_some()) {
            let stored = octant_score::summary::Summary::from_json(&summary.to_string()).unwrap();
            wrong.extend(octant_score::rederive::contradictions(&stored));
        }
        let found = Found::of(output.status.code(), &said, summary.as_ref());
        let (verdict, words) = match case.ends {
            Ends::Pass => ("pass", ""),
            Ends::Fail(words) => ("fail", words),
            Ends::Inconclusive(words) => ("inconclusive", words),
            Ends::Refused(words) => ("refused", words),
            Ends::Broken(words) => ("broken off", words),
        };
        let reason = found.reasons.iter().find(|reason| reason.contains(words));
        let statuses: &[i32] = match case.ends {
            Ends::Pass => &[0],
            Ends::Inconclusive(_) => &[3],
            _ => &[1, 2, 4],
        };
        if !output.status.code().is_some_and(|status| statuses.contains(&status)) {
            wrong.push(format!(
                "expected a status of {statuses:?}, found {:?}",
                output.status.code()
            ));
        }
        if found.verdict != verdict || (!words.is_empty() && reason.is_none()) {
            wrong.push(format!(
                "expected {verdict} {words:?}, found {} {:?}",
                found.verdict, found.reasons
            ));
        }
        if let Ends::Inconclusive(_) | Ends::Refused(_) | Ends::Broken(_) = case.ends {
            let told = reason.map_or("", String::as_str);
            if !self.refusals.iter().any(|words| told.contains(words)) {
                wrong.push(format!("docs/real-data.md doesn't say what it means: {told}"));
            }
        }
        let mut counted = BTreeMap::new();
        for (name, counts) in case.counts {
            match found.counts.get(*name) {
                Some(found) if found == counts => {}
                found => wrong.push(format!("{name}: expected {counts:?}, found {found:?}")),
            }
            if !said.contains(&format!("{name}: {} ", counts.read())) {
                wrong.push(format!(
                    "the terminal doesn't say that {} units were read",
                    counts.read()
                ));
            }
            counted.insert(*name, *counts);
        }
        let parameters = summary.as_ref().map(parameters).unwrap_or_default();
        if let (Some(clean), "pass") = (&self.clean, &*found.verdict) {
            for (name, (estimate, sigma)) in clean {
                let moved = (parameters.get(name).map_or(f64::NAN, |(now, _)| *now) - estimate)
                    .abs()
                    / sigma;
                if !(moved < MOVED_MAX) {
                    wrong.push(format!("it passes, and {name} moved by {moved:.2} sigma"));
                }
            }
        }
        if !wrong.is_empty() {
            let inputs =
                summary.as_ref().map(|summary| summary["inputs"].to_string()).unwrap_or_default();
            self.wrong.push(format!(
                "{}, {}: {}\n  {}\n  {inputs}",
                case.input,
                case.holds,
                wrong.join("\n  "),
                said.trim()
            ));
        }
        let reason = reason.or(found.reasons.first()).map_or("", String::as_str);
        let reason = match &self.hidden {
            None => reason.to_owned(),
            Some((name, shown)) => reason.replace(name, shown),
        };
        self.row(case, verdict, &reason, &counted);
        parameters
    }

    fn row(
        &mut self,
        case: &Case<'_>,
        verdict: &str,
        reason: &str,
        counts: &BTreeMap<&str, Counts>,
    ) {
        let sum = |of: fn(&Counts) -> u64| {
            let all: Vec<String> = counts.values().map(|counts| of(counts).to_string()).collect();
            all.join(" + ")
        };
        let cells = [
            sum(Counts::read),
            sum(|counts| counts.used),
            sum(|counts| counts.repaired),
            sum(|counts| counts.left_out),
            sum(|counts| counts.missing),
        ];
        let verdict = if reason.is_empty() {
            verdict.to_owned()
        } else {
            format!("{verdict}: {}", first_words(reason))
        };
        writeln!(
            self.rows,
            "| {} | {} | {} | {} |",
            case.input,
            case.holds,
            cells.join(" | "),
            verdict.replace('|', "\\|")
        )
        .unwrap();
        self.count += 1;
    }

    /// Checks all of the part: every input as expected, and the rows of the page.
    #[track_caller]
    pub fn finish(self, least: usize) {
        assert!(
            self.wrong.is_empty(),
            "{} of {}:\n{}",
            self.wrong.len(),
            self.count,
            self.wrong.join("\n")
        );
        assert!(self.count >= least, "{} rows, expected {least} or more", self.count);
        is_in_the_page(
            self.mark,
            &format!(
                "\n| input | content | read | used | repaired | left out | missing | verdict |\n|---|---|---|---|---|---|---|---|\n{}\n",
                self.rows
            ),
        );
    }
}

/// Words of the refusals that docs/real-data.md explains.
pub fn refusals() -> Vec<String> {
    let page = std::fs::read_to_string(REFUSALS).unwrap();
    let (_, table) = page.split_once("<!-- refusals -->").unwrap();
    let (table, _) = table.split_once("<!-- end refusals -->").unwrap();
    let rows = table.lines().filter_map(|line| line.strip_prefix("| `"));
    rows.map(|row| row.split('`').next().unwrap().to_owned()).collect()
}

/// Compares the rows between two marks of the page, or writes them.
#[track_caller]
fn is_in_the_page(mark: &str, made: &str) {
    // Tests of several parts write one file.
    static PAGE_LOCK: Mutex<()> = Mutex::new(());
    let _lock = PAGE_LOCK.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let (begin, end) = (format!("<!-- begin {mark} -->\n"), format!("<!-- end {mark} -->"));
    let page = std::fs::read_to_string(Path::new(PAGE)).unwrap();
    let (before, rest) = page.split_once(&begin).unwrap_or_else(|| panic!("no {begin}"));
    let (there, after) = rest.split_once(&end).unwrap_or_else(|| panic!("no {end}"));
    if std::env::var_os("OCTANT_WRITE_FIXTURES").is_some() {
        std::fs::write(PAGE, format!("{before}{begin}{made}{end}{after}")).unwrap();
        return;
    }
    assert!(there == made, "docs/accounts.md, {mark}: OCTANT_WRITE_FIXTURES=1 writes\n{made}");
}

/// Beginning of a reason, up to a whole word.
fn first_words(reason: &str) -> String {
    let reason = reason.lines().next().unwrap_or_default();
    match reason.char_indices().nth(WORDS) {
        None => reason.to_owned(),
        Some((end, _)) => {
            let cut = reason[..end].rfind(' ').unwrap_or(end);
            format!("{}…", reason[..cut].trim_end_matches([',', ';', ':']))
        }
    }
}

/// How a run ended.
struct Found {
    verdict: String,
    reasons: Vec<String>,
    counts: BTreeMap<String, Counts>,
}

impl Found {
    fn of(status: Option<i32>, said: &str, summary: Option<&Value>) -> Self {
        let refused: Vec<String> = said
            .lines()
            .filter_map(|line| line.strip_prefix("error: "))
            .map(|reason| {
                let reason = reason.trim_start_matches("failed to ").trim_start_matches("read ");
                reason.trim_end_matches("; the recorded part is in out.partial").to_owned()
            })
            .collect();
        let Some(summary) = summary else {
            let gone = said.lines().filter_map(|line| line.split_once(" is gone: "));
            let (verdict, reasons) = match status {
                Some(2) => ("refused".to_owned(), refused),
                Some(4) => {
                    ("broken off".to_owned(), gone.map(|(_, reason)| reason.to_owned()).collect())
                }
                status => (format!("status {status:?}"), refused),
            };
            return Self { verdict, reasons, counts: BTreeMap::new() };
        };
        let texts = |value: &Value| -> Vec<String> {
            let all = value.as_array().into_iter().flatten();
            all.map(|reason| reason.as_str().map_or_else(|| reason.to_string(), str::to_owned))
                .collect()
        };
        let mut counts = BTreeMap::new();
        for account in summary["inputs"].as_array().into_iter().flatten() {
            let number = |value: &Value| value.as_u64().unwrap_or(0);
            let sum = |key: &str| -> u64 {
                account[key]
                    .as_array()
                    .into_iter()
                    .flatten()
                    .map(|entry| number(&entry["count"]))
                    .sum()
            };
            let of = Counts {
                used: number(&account["used"]),
                repaired: sum("repaired"),
                left_out: sum("left_out"),
                missing: sum("missing"),
            };
            assert_eq!(number(&account["read"]), of.read(), "{account}");
            counts.insert(account["input"].as_str().unwrap().to_owned(), of);
        }
        let verdict = summary["verdict"].as_str().unwrap().to_owned();
        Self { verdict, reasons: texts(&summary["reasons"]), counts }
    }
}

fn parameters(summary: &Value) -> Parameters {
    let all = summary["calibration"]["parameters"].as_object().into_iter().flatten();
    all.filter_map(|(name, value)| {
        let number = |key: &str| value[key].as_f64();
        Some((name.clone(), (number("estimate")?, number("sigma")?)))
    })
    .collect()
}
