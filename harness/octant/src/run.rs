//! `octant run`.

use super::evidenced::{self, RunRequest};
use super::run_folder::{free_name, in_the_way};
use crate::arguments::ScenarioArguments;
use crate::attendant::OperatorWays;
use crate::failure::Failure;
use clap::Args;
use octant_base::display::UnitChoice;
use octant_evidence::{Existing, RunFolder};
use octant_requirements::Verdict;
use octant_scenario::FilePlaces;
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
    /// Source of the samples, instead of the scenario's source.uri.
    #[arg(long, value_name = "URI")]
    source: Option<String>,
    /// Endpoint of the core, instead of the scenario's endpoint.uri.
    #[arg(long, value_name = "URI")]
    endpoint: Option<String>,
    /// Fire a fault whose trigger is manual, such as spike-1="5050 s".
    #[arg(long, value_name = "ID=TIME")]
    fire: Vec<String>,
    /// Inject only these of the scenario's faults; --only-faults= injects none.
    #[arg(long, value_name = "ID,ID", value_delimiter = ',', require_equals = true, num_args = 0..)]
    only_faults: Option<Vec<String>>,
    /// Make a run without requirements inconclusive: for pipelines, which must not pass after the list
    /// of requirements was emptied.
    #[arg(long)]
    require: bool,
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
    /// Print summary.json on stdout, and nothing else.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    system: super::run_system::SystemArguments,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    if octant_cosim::ssp::package::is_system(&arguments.scenario.scenario) {
        return system(arguments);
    }
    if let Some(option) = arguments.system.first_given() {
        return Err(Failure::input(format!(
            "{option} is for systems of FMUs, and {} is a scenario",
            arguments.scenario.scenario.display()
        )));
    }
    evidenced::run(&arguments.request())
}

impl Arguments {
    fn request(&self) -> RunRequest {
        let chosen = self.units.map(|units| units.settings()).unwrap_or_default();
        RunRequest {
            scenario: self.scenario.scenario.clone(),
            places: FilePlaces::default(),
            text: None,
            set: [self.scenario.set.clone(), chosen].concat(),
            out: self.out.clone(),
            force: self.force,
            seed: self.seed,
            source: self.source.clone(),
            endpoint: self.endpoint.clone(),
            fire: self.fire.clone(),
            only_faults: self.only_faults.clone(),
            planned_faults: false,
            require: self.require,
            realtime: self.realtime,
            stop_when_lost: self.stop_when_lost,
            no_twin: self.no_twin,
            live: self.live.clone(),
            json: self.json,
            call: None,
            operator: OperatorWays {
                attended: true,
                elsewhere: self.no_terminal,
                answers: self.answers.clone(),
                page: self.page.clone(),
            },
        }
    }
}

/// Runs a system of FMUs.
fn system(arguments: &Arguments) -> Result<Verdict, Failure> {
    let path = &arguments.scenario.scenario;
    let given = [
        ("--source", arguments.source.is_some()),
        ("--units", arguments.units.is_some()),
        ("--endpoint", arguments.endpoint.is_some()),
        ("--realtime", arguments.realtime),
        ("--stop-when-lost", arguments.stop_when_lost),
        ("--no-twin", arguments.no_twin),
        ("--only-faults", arguments.only_faults.is_some()),
        ("--live", arguments.live.is_some()),
        ("--answers", arguments.answers.is_some()),
        ("--page", arguments.page.is_some()),
        ("--no-terminal", arguments.no_terminal),
    ];
    if let Some((option, _)) = given.into_iter().find(|(_, given)| *given) {
        return Err(Failure::input(format!(
            "{option} is for scenarios, and {} is a system of FMUs",
            path.display()
        )));
    }
    let out = arguments.out.clone().unwrap_or_else(|| free_name(path));
    let existing = if arguments.force { Existing::Replace } else { Existing::Refuse };
    super::run_system::command(
        &super::run_system::Shared {
            path,
            set: &arguments.scenario.set,
            fire: &arguments.fire,
            seed: arguments.seed,
            json: arguments.json,
        },
        &arguments.system,
        || {
            RunFolder::create(&out, existing)
                .map_err(|error| Failure::input(format!("failed to {}", in_the_way(&error))))
        },
    )
}
