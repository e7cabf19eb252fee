//! Request for a run of a scenario, and the command line that asks for it again.

use crate::attendant::OperatorWays;
use octant_scenario::{FilePlaces, RequirementSpec};
use std::path::PathBuf;

/// Request for a run of a scenario.
#[derive(Clone, Debug, Default)]
pub struct RunRequest {
    /// File of the scenario.
    pub scenario: PathBuf,
    /// Files that the scenario names and that are somewhere else. A text has none.
    pub places: FilePlaces,
    /// Text of the scenario, in place of the file's content.
    pub text: Option<String>,
    /// Changes of its keys, `KEY=VALUE`.
    pub set: Vec<String>,
    /// Folder of the run; by default a new one in ./runs.
    pub out: Option<PathBuf>,
    /// Replaces a run in the folder.
    pub force: bool,
    /// Seed, instead of the scenario's.
    pub seed: Option<u64>,
    /// URI of the source, instead of the scenario's.
    pub source: Option<String>,
    /// URI of the endpoint, instead of the scenario's.
    pub endpoint: Option<String>,
    /// Faults that are triggered by hand, `ID=TIME`.
    pub fire: Vec<String>,
    /// Requirements that a campaign adds to those of the scenario. No line of `octant run` has them: they need a call.
    pub requirements: Vec<RequirementSpec>,
    /// Ids of the faults that are injected; `None` for all.
    pub only_faults: Option<Vec<String>>,
    /// The faults are the ones that a campaign plans for its case: none is left out.
    pub planned_faults: bool,
    /// Counts a run of which nothing is required as inconclusive.
    pub require: bool,
    /// Runs by the clock.
    pub realtime: bool,
    /// Ends a run by the clock when its bench is lost.
    pub stop_when_lost: bool,
    /// Leaves out the twins.
    pub no_twin: bool,
    /// Address at which the run is served to Foxglove.
    pub live: Option<String>,
    /// Prints the summary as JSON.
    pub json: bool,
    /// Call that made the run, in place of a command line that makes it again.
    pub call: Option<Vec<String>>,
    /// Ways to the operator of the run.
    pub operator: OperatorWays,
}

/// Returns the command line that makes the run again, with the seed that was used.
pub(crate) fn rerun(request: &RunRequest, used_seed: u64) -> Vec<String> {
    let RunRequest {
        scenario,
        places: _,
        text: _,
        set,
        // Where the evidence and the summary go makes no other run; nor does a seed that wasn't given.
        out: _,
        force: _,
        seed: _,
        source,
        endpoint,
        fire,
        requirements: _,
        only_faults,
        planned_faults: _,
        require,
        realtime,
        stop_when_lost,
        no_twin,
        live: _,
        json: _,
        call,
        operator: OperatorWays { attended: _, elsewhere: _, answers, page: _ },
    } = request;
    if let Some(call) = call {
        return call.clone();
    }
    let mut line = vec!["octant".to_owned(), "run".to_owned(), scenario.display().to_string()];
    for set in set {
        line.extend(["--set".to_owned(), set.clone()]);
    }
    for (name, uri) in [("--source", source), ("--endpoint", endpoint)] {
        if let Some(uri) = uri {
            line.extend([name.to_owned(), uri.clone()]);
        }
    }
    for fire in fire {
        line.extend(["--fire".to_owned(), fire.clone()]);
    }
    if let Some(faults) = only_faults {
        line.push(format!("--only-faults={}", faults.join(",")));
    }
    for (name, is_given) in [
        ("--require", *require),
        ("--realtime", *realtime),
        ("--stop-when-lost", *stop_when_lost),
        ("--no-twin", *no_twin),
    ] {
        if is_given {
            line.push(name.to_owned());
        }
    }
    if let Some(answers) = answers {
        line.extend(["--answers".to_owned(), answers.display().to_string()]);
    }
    line.extend(["--seed".to_owned(), used_seed.to_string()]);
    line
}
