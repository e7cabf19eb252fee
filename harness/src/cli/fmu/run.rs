//! `octant fmu run`.

use super::super::progress::with_progress;
use super::super::{Failure, print, print_json, seconds};
use crate::fmu::mapping::settings::{Settings, Starts};
use crate::fmu::run::input::{InputError, Inputs};
use crate::fmu::run::output::{Outputs, Sink};
use crate::fmu::run::{Finished, SimulateError, Span, simulate};
use crate::run::Control;
use clap::{Args, ValueEnum};
use octant_fmu_host::OpenError;
use octant_fmu_host::instance::{Instance, InstanceError, InterfaceKind, Options, Place};
use octant_requirements::Verdict;
use octant_scenario::{ScenarioError, setting_argument};
use serde::Serialize;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Step any FMU, with inputs from a file; or a core, with the samples of a scenario's source.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The FMU, or the folder of an unpacked one.
    #[arg(value_name = "FILE")]
    pub(super) fmu: PathBuf,
    /// Inputs: a CSV file with a column of time and one for each variable, with its unit in brackets
    /// where it is another: "imu.w [deg/s]".
    #[arg(long, value_name = "FILE.csv")]
    input: Option<PathBuf>,
    /// Samples of this scenario's source for a core: the FMU takes the place of the scenario's
    /// endpoint.
    #[arg(long, value_name = "SCENARIO", conflicts_with_all = ["input", "start", "stop", "step", "output", "tolerance"])]
    pub(super) source: Option<PathBuf>,
    /// Set a parameter, or an input that is held, before the start.
    #[arg(long, value_name = "NAME=VALUE")]
    pub(super) set: Vec<String>,
    /// Start, s or with a unit; by default that of the FMU's default experiment, else 0.
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    start: Option<String>,
    /// End; by default that of the default experiment, else the last row of the inputs.
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    stop: Option<String>,
    /// Communication step; by default that of the default experiment, else a 500th of the whole.
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    step: Option<String>,
    /// Relative tolerance of the solver; by default that of the default experiment.
    #[arg(long, value_name = "NUMBER")]
    tolerance: Option<f64>,
    /// Interface type; by default co-simulation where the FMU has it.
    #[arg(long, value_enum)]
    pub(super) interface: Option<Interface>,
    /// Where the FMU runs.
    #[arg(long, value_enum, default_value_t = Process::Own)]
    pub(super) process: Process,
    /// Wall time that a call may take in a process of its own; longer, and it hangs.
    #[arg(long, value_name = "TIME", default_value = "10 s")]
    pub(super) time_limit: String,
    /// Where the outputs go: rows of CSV, or an MCAP file; with --source a recording, in MCAP.
    #[arg(long, value_name = "FILE")]
    pub(super) out: Option<PathBuf>,
    /// Replace the file if it is there already.
    #[arg(long, requires = "out")]
    pub(super) force: bool,
    /// A variable that is recorded, as often as needed; by default all outputs that are numbers.
    #[arg(long, value_name = "NAME")]
    output: Vec<String>,
    /// Print one JSON object.
    #[arg(long)]
    pub(super) json: bool,
}

/// Interface types.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Interface {
    /// Co-simulation: the FMU steps itself.
    #[value(name = "cs", alias = "co-simulation")]
    CoSimulation,
    /// Model exchange: its equations are integrated here.
    #[value(name = "me", alias = "model-exchange")]
    ModelExchange,
}

/// Where an FMU runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Process {
    /// In a process of its own: a crash or a hang is told.
    Own,
    /// In this process: faster.
    Shared,
}

/// What is told of a run.
#[derive(Serialize)]
struct Told {
    fmu: String,
    model: String,
    fmi: String,
    generation_tool: String,
    interface: &'static str,
    process: &'static str,
    start_s: f64,
    stop_s: f64,
    step_s: f64,
    steps: u64,
    reached_s: f64,
    terminated: bool,
    interrupted: bool,
    wall_s: f64,
    outputs: Vec<String>,
    left_out: Vec<String>,
    out: Option<PathBuf>,
}

/// Runs the command.
pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    if let Some(scenario) = &arguments.source {
        return super::run_source::command(arguments, scenario);
    }
    let bad = |error: &dyn std::fmt::Display| Failure::input(format!("failed to {error}"));
    in_the_way(arguments)?;
    let mut instance = open(arguments)?;
    let instance = instance.as_mut();
    let description = instance.description().clone();
    let starts = starts(arguments, instance)?;
    let mut inputs = match &arguments.input {
        Some(path) => Some(Inputs::read(path, &description).map_err(|error| match error {
            // The place stands first, as in messages about scenarios.
            InputError::Content { .. } => Failure::input(error),
            _ => bad(&error),
        })?),
        None => None,
    };
    let outputs = Outputs::choose(&description, &arguments.output)
        .map_err(|error| bad(&format!("record the outputs: {error}")))?;
    let span = span(arguments, instance, inputs.as_ref())?;
    let steps = span.steps().map_err(|error| bad(&format!("plan the steps: {error}")))?;
    let mut sink = match &arguments.out {
        Some(path) => Sink::file(path, &outputs, &description.model_name).map_err(|e| bad(&e))?,
        None => Sink::None,
    };
    let control = Control::default();
    let one = std::slice::from_ref(&control);
    let (finished, wall_s) = with_progress(one, Some(steps), span.step_s, || {
        let began = Instant::now();
        let inputs = inputs.as_mut();
        let finished = simulate(instance, &starts, inputs, &outputs, &span, &mut sink, &control);
        (finished, began.elapsed().as_secs_f64())
    });
    // What was written before a failure is kept.
    let written = sink.finish();
    log(instance);
    let finished = finished.map_err(|error| {
        let kept = match &arguments.out {
            Some(path) => format!("; what came before is in {}", path.display()),
            None => String::new(),
        };
        match error {
            SimulateError::Instance(InstanceError::Value { .. }) => bad(&error),
            error => {
                Failure::bench(format!("failed to run {}: {error}{kept}", arguments.fmu.display()))
            }
        }
    })?;
    written.map_err(|error| Failure::bench(format!("failed to write the outputs: {error}")))?;
    tell(arguments, &description, &span, &finished, wall_s, outputs)?;
    Ok(if finished.cancelled { Verdict::Inconclusive } else { Verdict::Pass })
}

/// A file that is there already is not overwritten unless it is told.
pub(super) fn in_the_way(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.out {
        Some(path) if path.exists() && !arguments.force => Err(Failure::input(format!(
            "failed to create {}: it is there already; --force replaces it",
            path.display()
        ))),
        _ => Ok(()),
    }
}

fn open(arguments: &Arguments) -> Result<Box<dyn Instance>, Failure> {
    let options = Options {
        interface: match arguments.interface {
            None => InterfaceKind::Any,
            Some(Interface::CoSimulation) => InterfaceKind::CoSimulation,
            Some(Interface::ModelExchange) => InterfaceKind::ModelExchange,
        },
        place: match arguments.process {
            Process::Own => Place::OwnProcess,
            Process::Shared => Place::ThisProcess,
        },
        time_limit: Duration::from_secs_f64(
            seconds("--time-limit", &arguments.time_limit)?.max(0.0),
        ),
        ..Options::default()
    };
    octant_fmu_host::open(&arguments.fmu, &options).map_err(|error| {
        let message = format!("failed to open {}: {error}", arguments.fmu.display());
        match error {
            OpenError::Instance(InstanceError::Process { .. }) => Failure::bench(message),
            _ => Failure::input(message),
        }
    })
}

/// What `--set` sets.
fn starts(arguments: &Arguments, instance: &dyn Instance) -> Result<Starts, Failure> {
    let mut settings = Settings::new(instance.description());
    let mut problems = Vec::new();
    for argument in &arguments.set {
        let set = setting_argument(argument).and_then(|setting| {
            let set = settings.set(&setting.name, &setting.values);
            set.map_err(|message| setting.at.problem(message))
        });
        problems.extend(set.err());
    }
    if !problems.is_empty() {
        let file = arguments.fmu.display().to_string();
        return Err(Failure::input(ScenarioError { file, problems }));
    }
    settings.finish().map_err(|error| Failure::input(format!("failed to set parameters: {error}")))
}

/// From when to when, in what steps.
fn span(
    arguments: &Arguments,
    instance: &dyn Instance,
    inputs: Option<&Inputs>,
) -> Result<Span, Failure> {
    let description = instance.description();
    let default = &description.default_experiment;
    let given = |name: &str, text: &Option<String>| {
        text.as_ref().map(|text| seconds(name, text)).transpose()
    };
    let start_s = given("--start", &arguments.start)?.or(default.start_s).unwrap_or(0.0);
    let stop_s = given("--stop", &arguments.stop)?
        .or(default.stop_s)
        .or(inputs.map(|inputs| inputs.span_s().1))
        .ok_or_else(|| {
            Failure::input(
                "failed to plan the steps: the FMU says no stop time, expected --stop TIME",
            )
        })?;
    let internal = || {
        let interface = description.co_simulation.as_ref()?;
        interface
            .fixed_internal_step_s
            .filter(|_| arguments.interface != Some(Interface::ModelExchange))
    };
    let step_s = given("--step", &arguments.step)?
        .or(default.step_s)
        .or_else(internal)
        .unwrap_or((stop_s - start_s) / 500.0);
    Ok(Span { start_s, stop_s, step_s, tolerance: arguments.tolerance.or(default.tolerance) })
}

/// What the FMU said beside results.
fn log(instance: &mut dyn Instance) {
    for message in instance.messages() {
        note!("octant: {}: {message}", instance.name());
    }
}

fn tell(
    arguments: &Arguments,
    description: &octant_fmu_host::description::Description,
    span: &Span,
    finished: &Finished,
    wall_s: f64,
    outputs: Outputs,
) -> Result<(), Failure> {
    let exchange = arguments.interface == Some(Interface::ModelExchange)
        || description.co_simulation.is_none();
    let told = Told {
        fmu: arguments.fmu.display().to_string(),
        model: description.model_name.clone(),
        fmi: description.fmi_version.clone(),
        generation_tool: description.generation_tool.clone(),
        interface: if exchange { "model exchange" } else { "co-simulation" },
        process: match arguments.process {
            Process::Own => "own",
            Process::Shared => "shared",
        },
        start_s: span.start_s,
        stop_s: span.stop_s,
        step_s: span.step_s,
        steps: finished.steps,
        reached_s: finished.time_s,
        terminated: finished.terminated,
        interrupted: finished.cancelled,
        wall_s,
        outputs: outputs.columns.into_iter().map(|column| column.name).collect(),
        left_out: outputs.left_out,
        out: arguments.out.clone(),
    };
    if arguments.json {
        return print_json(&told);
    }
    let tool = match told.generation_tool.as_str() {
        "" => String::new(),
        tool => format!(", made by {tool}"),
    };
    let mut text = format!(
        "{}: {}, FMI {}, {}{tool}\n{} steps of {} s from {} s to {} s",
        told.fmu,
        told.model,
        told.fmi,
        told.interface,
        told.steps,
        told.step_s,
        told.start_s,
        told.reached_s
    );
    if told.steps > 0 {
        text += &format!(
            ", {:.3} µs a step in {} process",
            1e6 * told.wall_s / told.steps as f64,
            if told.process == "own" { "its own" } else { "this" }
        );
    }
    text += match (told.terminated, told.interrupted) {
        (true, _) => "; then the FMU wanted the simulation to end\n",
        (_, true) => "; then it was interrupted\n",
        _ => "\n",
    };
    if !told.left_out.is_empty() {
        text += &format!("not recorded, being no numbers: {}\n", told.left_out.join(", "));
    }
    if let Some(out) = &told.out {
        let (rows, columns) = (told.steps + 1, told.outputs.len());
        text += &format!("{rows} rows of time and {columns} outputs in {}\n", out.display());
    }
    print(&text)
}
