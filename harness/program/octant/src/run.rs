//! `octant run`.

use super::evidenced;
use super::run_folder::{free_name, in_the_way};
use super::run_request::RunRequest;
use super::run_system::{SharedOptions, SystemArguments};
use crate::arguments::ScenarioArguments;
use crate::attendant::OperatorWays;
use crate::failure::Failure;
use crate::given::GivenOptions;
use clap::Args;
use octant_base::display::UnitChoice;
use octant_evidence::{Existing, RunFolder};
use octant_scenario::FilePlaces;
use octant_verdict::Verdict;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    scenario: ScenarioArguments,
    /// Folder of the run; by default a new one in ./runs.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace the folder if it holds a run already.
    #[arg(long, requires = "out")]
    force: bool,
    /// Seed of all random draws, instead of the scenario's.
    #[arg(long, value_name = "N", value_parser = crate::arguments::seed, allow_negative_numbers = true)]
    seed: Option<u64>,
    /// Fire a fault whose trigger is manual, such as spike-1="5050 s".
    #[arg(long, value_name = "ID=TIME")]
    fire: Vec<String>,
    /// Make a run without requirements inconclusive: for pipelines, which must not pass after the list
    /// of requirements was emptied.
    #[arg(long)]
    require: bool,
    /// Print summary.json on stdout, and nothing else.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    of_scenario: ScenarioRunArguments,
    #[command(flatten)]
    of_system: SystemArguments,
}

/// Options for scenarios alone.
#[derive(Debug, Args)]
#[command(next_help_heading = "Options for a scenario (FILE.toml)")]
pub(super) struct ScenarioRunArguments {
    /// Source of the samples, instead of the scenario's source.uri.
    #[arg(long, value_name = "URI")]
    source: Option<String>,
    /// Endpoint of the core, instead of the scenario's endpoint.uri.
    #[arg(long, value_name = "URI")]
    endpoint: Option<String>,
    /// Inject only these of the scenario's faults; --only-faults= injects none.
    #[arg(long, value_name = "ID,ID", value_delimiter = ',', require_equals = true, num_args = 0..)]
    only_faults: Option<Vec<String>>,
    /// Run in real time: every sample is sent at its own time, as with realtime.pace = "clock".
    #[arg(long)]
    realtime: bool,
    /// End a run by the clock at the moment at which its bench breaks a limit of [realtime], and don't begin what would
    /// follow: the baseline, the twin.
    #[arg(long)]
    stop_when_lost: bool,
    /// Skip the twin run without faults, with which a run with faults is compared.
    #[arg(long)]
    no_twin: bool,
    /// Serve the run to Foxglove while it runs; by default to this host only.
    #[arg(
        long,
        value_name = "ADDRESS",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = super::live::DEFAULT_ADDRESS
    )]
    live: Option<String>,
    /// Take the answers to the operator's steps from a file, in place of a person: TOML, or the operator.jsonl of
    /// another run.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["page", "no_terminal"])]
    answers: Option<PathBuf>,
    /// Serve a page with the operator's questions; by default to this host only, at any free port.
    #[arg(
        long,
        value_name = "ADDRESS",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = crate::operator_page::DEFAULT_ADDRESS
    )]
    page: Option<String>,
    /// Read no answers from the terminal: they come from octant answer in another process, or from the page.
    #[arg(long)]
    no_terminal: bool,
    /// Units of errors in report and terminal: of position (arcmin, nmi, m, km), attitude (arcmin, deg,
    /// arcsec, mrad) and velocity (m/s, kn, cm/s), such as nmi,deg.
    #[arg(long, value_name = "UNIT,UNIT")]
    units: Option<UnitChoice>,
}

pub(super) fn command(arguments: &Arguments, given: &GivenOptions) -> Result<Verdict, Failure> {
    let file = arguments.scenario.scenario.display();
    if octant_cosim::ssp::package::is_system(&arguments.scenario.scenario) {
        given.refuse::<ScenarioRunArguments>(format!(
            "found the system of FMUs {file}, expected a scenario: the option is for scenarios alone"
        ))?;
        return system(arguments);
    }
    given.refuse::<SystemArguments>(format!(
        "found the scenario {file}, expected a system of FMUs: the option is for systems alone"
    ))?;
    evidenced::run(&request(arguments))
}

fn request(arguments: &Arguments) -> RunRequest {
    let Arguments {
        scenario: ScenarioArguments { scenario, set },
        out,
        force,
        seed,
        fire,
        require,
        json,
        of_scenario,
        // Refused before.
        of_system: _,
    } = arguments;
    let ScenarioRunArguments {
        source,
        endpoint,
        only_faults,
        realtime,
        stop_when_lost,
        no_twin,
        live,
        answers,
        page,
        no_terminal,
        units,
    } = of_scenario;
    let chosen = units.map(|units| units.settings()).unwrap_or_default();
    RunRequest {
        scenario: scenario.clone(),
        places: FilePlaces::default(),
        text: None,
        set: [set.clone(), chosen].concat(),
        out: out.clone(),
        force: *force,
        seed: *seed,
        source: source.clone(),
        endpoint: endpoint.clone(),
        fire: fire.clone(),
        requirements: Vec::new(),
        only_faults: only_faults.clone(),
        planned_faults: false,
        require: *require,
        realtime: *realtime,
        stop_when_lost: *stop_when_lost,
        no_twin: *no_twin,
        live: live.clone(),
        json: *json,
        call: None,
        operator: OperatorWays {
            attended: true,
            elsewhere: *no_terminal,
            answers: answers.clone(),
            page: page.clone(),
        },
    }
}

/// Runs a system of FMUs.
fn system(arguments: &Arguments) -> Result<Verdict, Failure> {
    let Arguments {
        scenario: ScenarioArguments { scenario: path, set },
        out,
        force,
        seed,
        fire,
        require,
        json,
        // Refused before.
        of_scenario: _,
        of_system,
    } = arguments;
    let out = out.clone().unwrap_or_else(|| free_name(path));
    let existing = if *force { Existing::Replace } else { Existing::Refuse };
    let shared = SharedOptions { path, set, fire, seed: *seed, require: *require, json: *json };
    super::run_system::command(&shared, of_system, || {
        RunFolder::create(&out, existing)
            .map_err(|error| Failure::input(format!("failed to {}", in_the_way(&error))))
    })
}
