//! A run that was asked for, its folder, and the evidence that is written of it.

use crate::arguments::read_scenario;
use crate::failure::Failure;
use crate::progress::Follower;
use crate::run_folder::{free_name, in_the_way};
use crate::run_request::{RunRequest, rerun};
use crate::source_uri::from_here;
use crate::terminal::{tell_account, write};
use octant_evidence::signature::SigningKey;
use octant_evidence::{
    Existing, FmuFacts, FmuFactsError, InputFacts, Manifest, RunFacts, RunFolder,
};
use octant_fmu_bind::OpenedFmus;
use octant_operator::OperatorRecord;
use octant_recorder::event::PowerRecord;
use octant_report as report;
use octant_run::MethodError;
use octant_run::assemble::{Choice, assemble_with, parameter_text, text};
use octant_run::findings::broken as what_broke;
use octant_run::{Ended, MethodRun, Prepared, Run, raw_counts};
use octant_scenario::resolve::{DrawnValues, Seeded};
use octant_scenario::{Scenario, SourceSpec};
use octant_score::junit::{JunitTimes, junit};
use octant_verdict::Verdict;
use octant_verdict::equipment::Day;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

/// Evidence of a run that has ended.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// Verdict.
    pub verdict: Verdict,
    /// Folder of the run.
    pub folder: PathBuf,
    /// Content of `summary.json`.
    pub summary: String,
    /// Results in words.
    pub text: String,
    /// Reasons for which the run broke off.
    pub broken: Vec<String>,
    /// True if the run was interrupted.
    pub interrupted: bool,
}

/// Records of the operator of a run, and the reasons why they make it no evidence.
#[derive(Debug, Default)]
pub(crate) struct Answers {
    /// The records.
    pub(crate) records: Vec<OperatorRecord>,
    /// The reasons.
    pub(crate) reasons: Vec<String>,
}

/// Scenario of a request, with its changes.
#[derive(Debug)]
pub(crate) struct Asked {
    /// The scenario.
    pub(crate) scenario: Scenario,
    /// Seed of the run.
    pub(crate) seed: u64,
    /// Ids of the faults that were left out.
    left_out: Vec<String>,
}

/// Folder of a run that has begun, with facts of its beginning.
#[derive(Debug)]
pub(crate) struct Begun {
    /// The folder.
    pub(crate) folder: RunFolder,
    started: SystemTime,
    fmus: Vec<FmuFacts>,
    /// Files that are scored or run on.
    pub(crate) inputs: Vec<InputFacts>,
    /// Facts of a bench that isn't part of the runs themselves.
    pub(crate) bench: Option<Value>,
    key: Option<Arc<SigningKey>>,
}

impl Asked {
    /// Reads the scenario of a request.
    pub(crate) fn of(request: &RunRequest) -> Result<Self, Failure> {
        let mut more = Vec::new();
        if let Some(uri) = &request.source {
            more.push(format!("source.uri={}", from_here(uri)?));
        }
        if let Some(uri) = &request.endpoint {
            more.push(format!("endpoint.uri={}", from_here(uri)?));
        }
        if request.realtime {
            more.push("realtime.pace=\"clock\"".to_owned());
        }
        let path = &request.scenario;
        let set = [&*request.set, &*more].concat();
        let mut scenario = match &request.text {
            None => read_scenario(path, &set, &request.fire, &request.places)?,
            Some(text) => {
                let folder = path.parent().unwrap_or(Path::new(""));
                let name = path.display().to_string();
                Scenario::parse_fired(text, &name, folder, &set, &request.fire)
                    .map_err(Failure::input)?
            }
        };
        let mut left_out = Vec::new();
        if let Some(faults) = &request.only_faults {
            // `--only-faults=` gives one empty name.
            let faults: Vec<String> = faults.iter().filter(|id| !id.is_empty()).cloned().collect();
            if !request.planned_faults {
                let all = scenario.faults.iter().map(|fault| fault.spec.id.clone());
                left_out = all.filter(|id| !faults.contains(id)).collect();
            }
            scenario = scenario.with_only(&faults).map_err(|reason| {
                let file = request.scenario.display();
                Failure::input(format!("{file}: --only-faults: {reason}"))
            })?;
        }
        scenario.require(request.requirements.clone());
        let seed = request.seed.unwrap_or(scenario.seed);
        Ok(Self { scenario, seed, left_out })
    }

    /// Makes the folder of the run, with the resolved scenario in it.
    pub(crate) fn begin(
        &self,
        request: &RunRequest,
        fmus: Vec<FmuFacts>,
    ) -> Result<Begun, Failure> {
        let inputs = octant_evidence::inputs(&self.scenario)
            .map_err(|error| Failure::input(format!("failed to {error}")))?;
        let key = crate::signing::signing_key()?;
        let (path, existing) = match &request.out {
            Some(path) if request.force => (path.clone(), Existing::Replace),
            Some(path) => (path.clone(), Existing::Refuse),
            None => (free_name(&request.scenario), Existing::Refuse),
        };
        let folder = RunFolder::create(&path, existing)
            .map_err(|error| Failure::input(format!("failed to {}", in_the_way(&error))))?;
        let started = SystemTime::now();
        let draws = DrawnValues::of(&self.scenario, &Seeded(self.seed));
        let resolved = self.scenario.to_resolved_toml(self.seed, &draws);
        write(&folder.path().join("scenario.toml"), resolved)?;
        Ok(Begun { folder, started, fmus, inputs, bench: None, key })
    }

    /// Writes the evidence of runs that have ended.
    pub(crate) fn conclude(
        self,
        request: &RunRequest,
        begun: Begun,
        runs: Vec<MethodRun>,
        answers: Answers,
    ) -> Result<Evidence, Failure> {
        let Self { scenario, seed, left_out } = self;
        let Begun { folder, started, fmus, inputs, bench: around, key } = begun;
        let unfinished = |ended| matches!(ended, Ended::Cancelled | Ended::Broken);
        let interrupted = runs.iter().any(|run| {
            unfinished(run.ended)
                || run.twin.as_ref().is_some_and(|twin| twin.ended == Ended::Broken)
        });
        let broken = runs.iter().find_map(|run| run.bench.broken.as_ref().map(ToString::to_string));
        // With a full disk, there may be no space for the results either.
        let failed = |failure: Failure| match &broken {
            None => failure,
            Some(reason) => {
                let message = format!("failed to {reason}; and {}", failure.message);
                Failure { message, ..failure }
            }
        };
        let mut runs = runs.into_iter();
        let (Some(primary), baseline) = (runs.next(), runs.next()) else {
            return Err(Failure::bench("failed to run the scenario: no method ran"));
        };
        let tables = [
            ("calibration", primary.table.clone()),
            ("baseline", baseline.as_ref().and_then(|b| b.table.clone())),
        ];
        let reasons = what_broke(&primary, baseline.as_ref());
        let link = primary.bench.link.as_ref().and_then(|link| serde_json::to_value(link).ok());
        let instrument = primary.bench.instrument.as_ref();
        let accounts = primary.bench.accounts();
        accounts.iter().for_each(tell_account);
        let bench = instrument.and_then(|bench| serde_json::to_value(bench).ok()).or(around);
        let bench = with_power(bench, primary.bench.power.as_deref());
        let realtime = primary.bench.kept.as_ref().map(|kept| kept.granted.clone());
        let refused = primary.calibration.as_ref().is_some_and(|c| c.refused.is_some());
        let estimate = primary.observed.convergence.last.map(|e| e.parameters).filter(|_| !refused);
        // Certificates are compared with the day in the manifest.
        let ended = SystemTime::now();
        let Answers { records: answers, reasons: operator } = answers;
        let day = Some(Day::of(ended));
        let choice = Choice { require: request.require, left_out, day, operator };
        let run = assemble_with(&scenario, seed, primary, baseline, &choice)
            .map_err(|error| Failure::bench(format!("failed to write the summary: {error}")))?;
        for (name, table) in tables {
            if let Some(table) = table {
                let path = folder.path().join(format!("{name}.octcal"));
                write(&path, table.to_bytes()).map_err(failed)?;
            }
        }
        let facts = RunFacts {
            seed: Some(seed),
            command_line: rerun(request, seed),
            fmus,
            link,
            bench,
            realtime,
            answers,
            key,
            inputs,
            accounts,
            equipment: scenario.equipment.clone(),
            ..RunFacts::between(started, ended)
        };
        let raw = estimate.map_or(String::new(), |e| raw_counts::text(&scenario.source, &e));
        let (verdict, printed) =
            write_results(folder.path(), run, &facts, &scenario.source).map_err(failed)?;
        let folder = if interrupted {
            // An unfinished run keeps the name of a partial folder.
            folder.path().to_owned()
        } else {
            folder.finish().map_err(|error| Failure::bench(format!("failed to {error}")))?
        };
        let (summary, text) = (printed.text, printed.human + &raw);
        Ok(Evidence { verdict, folder, summary, text, broken: reasons, interrupted })
    }
}

/// Prepares the methods of a scenario.
pub(crate) fn prepare<'a>(
    scenario: &'a Scenario,
    seed: u64,
    twins: bool,
    fmus: &OpenedFmus,
) -> Result<Prepared<'a>, Failure> {
    Prepared::of(scenario, seed, twins, fmus)
        .map_err(|error| Failure::from(MethodError::from(error)).failed())
}

/// Runs the methods of a scenario, followed by the terminal or a host program.
pub(crate) fn execute(
    prepared: &Prepared<'_>,
    scenario: &Scenario,
    folder: &Path,
    follower: &Follower<'_>,
) -> Result<Vec<MethodRun>, Failure> {
    let sample_s = scenario.sample_period_ns as f64 * 1e-9;
    let runs =
        follower.follow(prepared.controls(), prepared.epochs(), sample_s, || prepared.run(folder));
    runs.map_err(|error| {
        let failure = Failure::of(&error);
        let place = folder.display();
        let message = format!("failed to {}; the recorded part is in {place}", failure.message);
        Failure { message, ..failure }
    })
}

/// Failure of a run that can't have its FMUs.
pub(crate) fn without_fmus(error: FmuFactsError) -> Failure {
    Failure::input(error).failed()
}

/// Output of a run, for programs and for readers.
struct Printed {
    text: String,
    human: String,
}

/// Writes summary, JUnit, report and manifest.
fn write_results(
    folder: &Path,
    mut run: Run,
    facts: &RunFacts,
    source: &SourceSpec,
) -> Result<(Verdict, Printed), Failure> {
    let summary = &run.summary;
    let text_json = summary
        .to_json()
        .map_err(|error| Failure::bench(format!("failed to write the summary: {error}")))?;
    write(&folder.join("summary.json"), &text_json)?;
    let (page, xml) = texts(&mut run, &Manifest::of(facts))?;
    let summary = &run.summary;
    write(&folder.join("junit.xml"), xml)?;
    let mut human = text(summary, &run.report.units);
    if run.report.truth.is_none() {
        human += &parameter_text(summary, source);
    }
    write(&folder.join("report.html"), page)?;
    Manifest::write(folder, facts).map_err(|error| Failure::bench(format!("failed to {error}")))?;
    Ok((summary.verdict, Printed { text: text_json, human }))
}

/// Makes report and JUnit of a run that its manifest describes.
pub(crate) fn texts(run: &mut Run, manifest: &Manifest) -> Result<(String, String), Failure> {
    let time = |text: &str| octant_base::utc::parse(text).ok();
    let times = time(&manifest.started).zip(time(&manifest.ended));
    let times = times.map(|(started, ended)| JunitTimes { started, ended });
    let xml = junit(&run.summary, times)
        .map_err(|error| Failure::bench(format!("failed to write junit.xml: {error}")))?;
    run.report.provenance = crate::report::provenance(manifest);
    Ok((report::run::render(&run.report), xml))
}

/// Adds the power of the device to what the manifest tells of the bench.
fn with_power(bench: Option<Value>, power: Option<&PowerRecord>) -> Option<Value> {
    let Some(power) = power else { return bench };
    let mut bench = match bench {
        Some(Value::Object(bench)) => bench,
        _ => serde_json::Map::new(),
    };
    let end = power.end.map_or("in an unknown state", |end| if end.on { "on" } else { "off" });
    let text = format!(
        "{} ({}, {}), switched {} times, left {end}",
        power.identity,
        power.port,
        power.outlet,
        power.switchings.len()
    );
    bench.insert("power of the device".to_owned(), Value::String(text));
    bench.insert("power".to_owned(), serde_json::to_value(power).unwrap_or_default());
    Some(Value::Object(bench))
}
