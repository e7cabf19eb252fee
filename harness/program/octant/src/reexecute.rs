//! `octant verify --reexecute`: runs the content of a folder of evidence again from that folder
//! alone.

use super::asked::{execute, prepare, texts};
use super::progress::Follower;
use crate::failure::Failure;
use crate::terminal::note;
use octant_base::number::counted;
use octant_campaign::execute::reexecute::{self, CONFIDENCE, altered_at_most};
use octant_campaign::plan::{FILE_NAME, Plan};
use octant_campaign_pages::evidence;
use octant_evidence::InputFacts;
use octant_evidence::manifest::{Manifest, program_sha256};
use octant_evidence::statements::SUMMARY;
use octant_fmu_bind::OpenedFmus;
use octant_recorder::reader::Recording;
use octant_run::assemble::{Choice, assemble_with};
use octant_scenario::Scenario;
use octant_score::numerics::differs;
use octant_verdict::Verdict;
use octant_verdict::equipment::Day;
use serde::Serialize;
use serde_json::Value;
use std::hash::{BuildHasher, RandomState};
use std::path::Path;

/// Number of a campaign's cases to run again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Count(Option<usize>);

impl Count {
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        match (text, text.parse()) {
            ("all", _) => Ok(Self(None)),
            (_, Ok(count)) if count > 0 => Ok(Self(Some(count))),
            _ => Err(format!("found {text:?}, expected a number of cases or all")),
        }
    }

    /// Refuses options of a campaign for a run, which has no cases to draw.
    pub(super) fn refuse_for_run(self, folder: &Path, seed: Option<u64>) -> Result<(), Failure> {
        let option = match (self.0, seed) {
            (Some(count), _) => format!("--reexecute {count}"),
            (None, Some(seed)) => format!("--sample-seed {seed}"),
            (None, None) => return Ok(()),
        };
        Err(Failure::input(format!(
            "{option}: found {}, the folder of a run, expected a campaign: a run has no cases to draw, and --reexecute \
             runs it again as a whole",
            folder.display()
        )))
    }
}

/// Result of the re-execution.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Reexecuted {
    /// `pass`: same results; `fail`: different results; `inconclusive`: no evidence.
    #[serde(skip)]
    pub verdict: Verdict,
    /// True if the program is the same, and all results are the same to the last bit.
    matches: bool,
    /// Actions and findings, as text.
    told: Vec<String>,
    /// Seed of the sample of a campaign's cases; null for a run.
    sample_seed: Option<u64>,
    /// Largest number of altered results of a campaign, with a confidence of 95 %; null for a run.
    altered_at_most: Option<usize>,
}

impl Reexecuted {
    fn of(verdict: Verdict, told: Vec<String>) -> Self {
        Self { verdict, matches: false, told, sample_seed: None, altered_at_most: None }
    }

    /// Renders the result as text.
    pub(super) fn text(&self) -> String {
        self.told.iter().map(|line| format!("re-executed: {line}\n")).collect()
    }
}

/// Runs the folder's content again. The folder was verified.
pub(super) fn command(
    folder: &Path,
    manifest: &Manifest,
    count: Count,
    seed: Option<u64>,
) -> Result<Reexecuted, Failure> {
    let then = match &manifest.campaign {
        Some(facts) => facts.program_sha256.as_deref(),
        None => manifest.program_sha256.as_deref(),
    };
    let now = program_sha256();
    let same_program = then.is_some() && then == now.as_deref();
    let mut found = match &manifest.campaign {
        Some(_) => campaign(folder, manifest, (count, seed), same_program)?,
        None => run(folder, manifest, same_program)?,
    };
    if found.verdict == Verdict::Pass && !same_program {
        let name = |hash: Option<&str>| hash.map_or("unknown".to_owned(), |hash| hash.to_owned());
        found.verdict = Verdict::Inconclusive;
        found.told.push(format!(
            "found another program (SHA-256 {}, that of the evidence is {}): equal numbers are no match",
            name(now.as_deref()),
            name(then)
        ));
    }
    found.matches = found.verdict == Verdict::Pass;
    Ok(found)
}

/// Runs a run again, with its twin if it had one.
fn run(folder: &Path, manifest: &Manifest, same_program: bool) -> Result<Reexecuted, Failure> {
    let cannot = |reason: String| Reexecuted::of(Verdict::Inconclusive, vec![reason]);
    let bytes = manifest.read_file(folder, SUMMARY).map_err(|e| Failure::input(e).failed())?;
    let then: Value = serde_json::from_slice(&bytes).map_err(Failure::input)?;
    let Some(seed) = manifest.seed.filter(|_| then.get("system").is_none()) else {
        return Ok(cannot("not possible: only runs of a scenario are run again".to_owned()));
    };
    let mut scenario = match Scenario::load(&folder.join("scenario.toml"), &[]) {
        Ok(scenario) => scenario,
        Err(error) => return Ok(cannot(format!("not possible: {error}"))),
    };
    if scenario.source.instrument().is_some() || scenario.endpoint.device().is_some() {
        return Ok(cannot(
            "not possible: the run used a device, which can't be run again".to_owned(),
        ));
    }
    // The clock has no effect on numbers.
    let by_clock = std::mem::take(&mut scenario.realtime.by_clock);
    // Nor have the operator's answers.
    scenario.operator.clear();
    let opened = OpenedFmus::default();
    let fmus = match octant_evidence::fmus(&scenario, 1, &opened) {
        Ok(fmus) => fmus,
        Err(error) => return Ok(cannot(format!("not possible: failed to {error}"))),
    };
    for (then, now) in manifest.fmus.iter().zip(&fmus) {
        if then.sha256 != now.sha256 {
            return Ok(cannot(format!("not possible: the content of {} has changed", now.file)));
        }
    }
    match octant_evidence::inputs(&scenario) {
        Ok(now) => {
            let changed = |(then, now): &(&InputFacts, &InputFacts)| then.sha256 != now.sha256;
            if let Some((_, now)) = manifest.inputs.iter().zip(&now).find(changed) {
                return Ok(cannot(format!(
                    "not possible: the content of {} has changed",
                    now.file
                )));
            }
        }
        Err(reason) => return Ok(cannot(format!("not possible: failed to {reason}"))),
    }
    let twins = !manifest.command_line.iter().any(|word| word == "--no-twin");
    let place = tempfile::tempdir()
        .map_err(|error| Failure::bench(format!("failed to create a folder: {error}")))?;
    let prepared = prepare(&scenario, seed, twins, &opened)?;
    let mut runs = execute(&prepared, &scenario, place.path(), &Follower::Terminal)?.into_iter();
    let (Some(primary), baseline) = (runs.next(), runs.next()) else {
        return Err(Failure::bench("failed to run the scenario: no method ran"));
    };
    let require = manifest.command_line.iter().any(|word| word == "--require");
    let choice = Choice { require, day: Day::of_text(&manifest.ended).ok(), ..Choice::default() };
    let tables = [
        ("calibration.octcal", primary.table.as_ref().map(|table| table.to_bytes().to_vec())),
        (
            "baseline.octcal",
            baseline.as_ref().and_then(|run| Some(run.table.as_ref()?.to_bytes().to_vec())),
        ),
    ];
    let mut now = assemble_with(&scenario, seed, primary, baseline, &choice)
        .map_err(|error| Failure::bench(format!("failed to write the summary: {error}")))?;
    let mut derived = DerivedFiles { by_clock, tables, page: String::new(), junit: String::new() };
    if derived.left_out(manifest).is_none() {
        let (page, junit) = texts(&mut now, manifest)?;
        derived = DerivedFiles { page, junit, ..derived };
    }
    let json = now.summary.to_json().map_err(Failure::bench)?;
    let mut now: Value = serde_json::from_str(&json).map_err(Failure::bench)?;
    let mut then = then;
    // Time keeping depends on the host.
    for summary in [&mut now, &mut then] {
        summary["pacing"] = Value::Null;
    }
    Ok(match reexecute::difference(&then, &now) {
        None => {
            let mut told = vec!["the stream hash and every measure are the same".to_owned()];
            let files = match same_program {
                true => derived.differing(folder, manifest, place.path())?,
                false => Vec::new(),
            };
            let verdict = if files.is_empty() { Verdict::Pass } else { Verdict::Fail };
            let of = |name| format!("{name} isn't what the run gives");
            told.extend(files.into_iter().map(of));
            if let Some(reason) = derived.left_out(manifest).filter(|_| same_program) {
                told.push(format!("report.html and junit.xml were not made again: {reason}"));
            }
            Reexecuted::of(verdict, told)
        }
        // Other numerics are expected to give other bits: this shows nothing, and no alteration.
        // The same program always has the same version, whatever the summary states.
        Some(difference) => match differs(numerics_of(&then)).filter(|_| !same_program) {
            Some(told) => Reexecuted::of(Verdict::Inconclusive, vec![difference, told]),
            None => Reexecuted::of(Verdict::Fail, vec![difference]),
        },
    })
}

/// Files of a run that its content gives.
struct DerivedFiles {
    /// True if the run was by the clock.
    by_clock: bool,
    /// Calibration tables, by their names.
    tables: [(&'static str, Option<Vec<u8>>); 2],
    page: String,
    junit: String,
}

impl DerivedFiles {
    /// Returns why report and JUnit are not made again: they have something that isn't in the folder in that form.
    fn left_out(&self, manifest: &Manifest) -> Option<&'static str> {
        let words = &manifest.command_line;
        if self.by_clock {
            Some("the run was by the clock")
        } else if !manifest.answers.is_empty() {
            Some("a person took part")
        } else if words.iter().any(|word| word.starts_with("--only-faults")) {
            Some("faults of the scenario were left out")
        } else {
            None
        }
    }

    /// Returns the names of the files in a folder that aren't these; `place` has the recordings of the run that was made
    /// again.
    fn differing(
        &self,
        folder: &Path,
        manifest: &Manifest,
        place: &Path,
    ) -> Result<Vec<String>, Failure> {
        let mut differing = Vec::new();
        let mut compare = |name: &str, bytes: &[u8]| -> Result<(), Failure> {
            let path = folder.join(name);
            let then = std::fs::read(&path).map_err(|error| {
                Failure::bench(format!("failed to read {}: {error}", path.display()))
            })?;
            if then != bytes {
                differing.push(name.to_owned());
            }
            Ok(())
        };
        let is_there = |name: &str| manifest.files.iter().any(|file| file.path == name);
        for (name, table) in &self.tables {
            match table {
                Some(bytes) if is_there(name) => compare(name, bytes)?,
                _ => {}
            }
        }
        if self.left_out(manifest).is_none() {
            compare("junit.xml", self.junit.as_bytes())?;
            compare("report.html", self.page.as_bytes())?;
            // In simulated time a recording has nothing of the host.
            for name in ["recording.mcap", "baseline.mcap"] {
                let again = place.join(name);
                if is_there(name) && again.exists() && !is_same(&folder.join(name), &again)? {
                    differing.push(name.to_owned());
                }
            }
        }
        Ok(differing)
    }
}

/// Returns whether two recordings have the same messages at the same times; their parts depend on the clock of the host.
fn is_same(then: &Path, now: &Path) -> Result<bool, Failure> {
    let open = |path: &Path| Recording::open(path).map_err(Failure::bench);
    let (mut then, mut now) = (open(then)?, open(now)?);
    loop {
        let next = [then.next_item(), now.next_item()];
        let [then, now] = next.map(|item| item.map_err(Failure::bench));
        let (then, now) = (then?, now?);
        // A value that isn't a number is equal to none.
        if then != now && format!("{then:?}") != format!("{now:?}") {
            return Ok(false);
        }
        if then.is_none() {
            return Ok(true);
        }
    }
}

/// Reads the numerics version of a summary.
fn numerics_of(summary: &Value) -> Option<u32> {
    summary.get("numerics")?.as_u64()?.try_into().ok()
}

/// Runs a sample of a campaign's cases again.
fn campaign(
    folder: &Path,
    manifest: &Manifest,
    (count, seed): (Count, Option<u64>),
    same_program: bool,
) -> Result<Reexecuted, Failure> {
    let plan = Plan::read(&folder.join(FILE_NAME))?;
    // The sample must not be predictable for anyone who altered a result.
    let drawn = || RandomState::new().hash_one(std::process::id());
    let seed = seed.unwrap_or_else(drawn);
    let tell = |done: usize, of: usize| note!("octant: re-executing case {} of {of}", done + 1);
    let again = reexecute::run(&plan, folder, count.0, seed, tell)
        .map_err(|reason| Failure::bench(format!("failed to {reason}")))?;
    let ran = again.same + again.differing.len() + again.other_numerics.len();
    let mut told = vec![format!(
        "{ran} of {}, drawn with --sample-seed {seed}: {} the same",
        counted(again.of, "case", "cases"),
        again.same
    )];
    told.extend(again.differing.iter().cloned());
    told.extend(again.other_numerics.iter().cloned());
    told.extend(again.not_run.iter().map(|reason| format!("not possible: {reason}")));
    let bound = altered_at_most(again.of, again.same, CONFIDENCE);
    // Another program may write the same results in other words.
    let files = match same_program {
        true => evidence::differing(&plan, folder, manifest)?,
        false => Vec::new(),
    };
    for name in &files {
        told.push(format!("{name} isn't what plan, results and journal give"));
    }
    if same_program && files.is_empty() {
        told.push(
            "statistics, prediction, JUnit and page are what plan, results and journal give"
                .to_owned(),
        );
    }
    let verdict = if !(again.differing.is_empty() && files.is_empty()) {
        Verdict::Fail
    } else if !(again.not_run.is_empty() && again.other_numerics.is_empty()) || ran == 0 {
        Verdict::Inconclusive
    } else {
        told.push(format!(
            "with a confidence of {:.0} %, at most {bound} of {} altered",
            100.0 * CONFIDENCE,
            counted(again.of, "result is", "results are")
        ));
        Verdict::Pass
    };
    let shown = (verdict == Verdict::Pass).then_some(bound);
    let found = Reexecuted::of(verdict, told);
    Ok(Reexecuted { sample_seed: Some(seed), altered_at_most: shown, ..found })
}
