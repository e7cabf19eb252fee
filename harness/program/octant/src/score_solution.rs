//! `octant score --solution`: the solution of any instrument, scored against a reference trajectory.

use crate::evidenced;
use crate::failure::Failure;
use crate::run_request::RunRequest;
use crate::solution_keys::keys_of_solution;
use crate::source_uri::from_here;
use clap::Args;
use octant_scenario::{FilePlaces, Scenario, SourceSpec};
use octant_verdict::Verdict;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(super) struct SolutionArguments {
    /// Solution of an instrument, instead of a run: columns of text (.csv), NMEA 0183 (.nmea), RTKLIB (.pos), SBET.
    #[arg(long, value_name = "FILE", conflicts_with = "run")]
    solution: Option<PathBuf>,
    /// Reference trajectory that the solution is scored against, in one of the same forms.
    #[arg(long, value_name = "FILE", requires = "solution")]
    reference: Option<PathBuf>,
    /// True heading of an instrument that stands still, as the reference instead of a file, such as "123.45 deg".
    #[arg(
        long,
        value_name = "ANGLE",
        requires = "solution",
        conflicts_with = "reference",
        allow_hyphen_values = true
    )]
    true_heading: Option<String>,
    /// Scenario with requirements, uncertainties, and the columns of the files.
    #[arg(long, value_name = "SCENARIO", requires = "solution")]
    scenario: Option<PathBuf>,
    /// Duration that is scored, and has to be there, such as "24 h"; by default the whole solution.
    #[arg(long, value_name = "TIME", requires = "solution")]
    duration: Option<String>,
    /// Time at the beginning of the solution that isn't scored, such as its alignment.
    #[arg(long, value_name = "TIME", requires = "solution")]
    skip: Option<String>,
    /// Time added to the solution's times to get those of the reference.
    #[arg(long, value_name = "TIME", requires = "solution", allow_hyphen_values = true)]
    offset: Option<String>,
    /// How far the offset may be wrong (95 %).
    #[arg(long, value_name = "TIME", requires = "solution")]
    offset_uncertainty: Option<String>,
    /// Talker of an NMEA 0183 solution whose sentences count, such as IN; by default all, which have to agree.
    #[arg(long, value_name = "LETTERS", requires = "solution")]
    talker: Option<String>,
    /// Change a key of the scenario, such as source.solution.latitude=lat.
    #[arg(long, value_name = "KEY=VALUE", requires = "solution")]
    set: Vec<String>,
    /// Folder of the evidence; by default a new one in ./runs.
    #[arg(long, value_name = "DIR", requires = "solution")]
    out: Option<PathBuf>,
    /// Replace the folder if it holds a run already.
    #[arg(long, requires = "out")]
    force: bool,
    /// Make a score without requirements inconclusive.
    #[arg(long, requires = "solution")]
    require: bool,
}

/// The scenario of a solution without one of its own.
const SCENARIO: &str = "schema = 1\n[procedure.navigation]\n";

/// Scores a solution, with settings of the scenario for the units.
pub(super) fn command(
    arguments: &SolutionArguments,
    units: Vec<String>,
    json: bool,
) -> Result<Verdict, Failure> {
    let SolutionArguments {
        solution,
        reference,
        true_heading,
        scenario,
        duration,
        skip,
        offset,
        offset_uncertainty,
        talker,
        set: settings,
        out,
        force,
        require,
    } = arguments;
    let Some(solution) = solution else {
        return Err(Failure::input("expected a run, or --solution"));
    };
    // A scenario for this command needn't say that a navigation is scored: nothing else can be.
    let navigation = "procedure.navigation";
    let mut set = match scenario {
        Some(file)
            if !Scenario::absent(file, settings, &[navigation])
                .map_err(Failure::input)?
                .is_empty() =>
        {
            vec![format!("{navigation}={{}}")]
        }
        _ => Vec::new(),
    };
    set.push(format!("source.uri={}", from_here(&format!("solution:{}", solution.display()))?));
    if let Some(reference) = reference {
        let path = std::path::absolute(reference).map_err(|error| {
            Failure::input(format!("failed to find {}: {error}", reference.display()))
        })?;
        set.push(format!("source.trajectory.file={}", path.display()));
    }
    let keys = [
        ("procedure.navigation.duration", duration),
        ("source.solution.skip", skip),
        ("source.trajectory.offset", offset),
        ("source.trajectory.offset_uncertainty", offset_uncertainty),
        ("source.solution.talker", talker),
        ("source.trajectory.true_heading", true_heading),
    ];
    set.extend(
        keys.into_iter().filter_map(|(key, value)| Some(format!("{key}={}", value.as_ref()?))),
    );
    set.extend(units);
    set.extend(settings.iter().cloned());
    let text = scenario.is_none().then(|| titled(solution));
    let path = scenario.as_ref().unwrap_or(solution).clone();
    // Keys of the caller come last and take precedence.
    let found = found(&path, text.as_deref(), &set)?;
    let set = [&found[..], &set].concat();
    evidenced::run(&RunRequest {
        scenario: path,
        places: FilePlaces::default(),
        text,
        set,
        out: out.clone(),
        force: *force,
        require: *require,
        json,
        call: Some(std::iter::once("octant".to_owned()).chain(std::env::args().skip(1)).collect()),
        ..RunRequest::default()
    })
}

/// The scenario of a solution, with its name as the title.
fn titled(solution: &Path) -> String {
    let name = solution.file_name().map_or_else(Default::default, |name| name.to_string_lossy());
    format!("title = {}\n{SCENARIO}", serde_json::Value::from(&*name))
}

/// Keys that follow from the solution itself: the rate of its points, and where it begins.
fn found(path: &Path, text: Option<&str>, set: &[String]) -> Result<Vec<String>, Failure> {
    let scenario = match text {
        None => Scenario::load(path, set),
        Some(text) => {
            let folder = path.parent().unwrap_or(Path::new(""));
            Scenario::parse(text, &path.display().to_string(), folder, set)
        }
    };
    let scenario = scenario.map_err(Failure::input)?;
    let SourceSpec::Solution(spec) = &scenario.source else {
        return Err(Failure::input("failed to score a solution: another source is set"));
    };
    if spec.line.is_some() {
        return Err(Failure::input(format!(
            "found {}, a port, expected a file: octant run takes a solution from a port",
            spec.solution.file.0
        )));
    }
    keys_of_solution(&scenario, spec)
}
