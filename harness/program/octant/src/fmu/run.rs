//! `octant fmu run`.

use super::super::progress::with_progress;
use super::arguments::{
    Arguments, Interface, OpeningArguments, Process, SharedRunOptions, SteppingArguments,
    in_the_way,
};
use crate::arguments::seconds;
use crate::failure::Failure;
use crate::given::GivenOptions;
use crate::terminal::note;
use crate::terminal::{print, print_json};
use octant_base::control::Control;
use octant_base::failing::{Failing, FailureKind};
use octant_base::number::counted;
use octant_cosim::single::input::{InputFileError, Inputs};
use octant_cosim::single::output::{Outputs, Sink};
use octant_cosim::single::scheduled::simulate_scheduled;
use octant_cosim::single::{Finished, SimulateError, Span, simulate};
use octant_fmu_bind::settings::{Starts, ValueSettings};
use octant_fmu_host::description::Description;
use octant_fmu_host::instance::{Instance, InterfaceKind, OpenOptions, ProcessPlace};
use octant_scenario::{FileProblems, setting_argument};
use octant_verdict::Verdict;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Summary of a run.
#[derive(Serialize)]
struct RunSummary {
    fmu: String,
    model: String,
    fmi: String,
    generation_tool: String,
    interface: &'static str,
    process: &'static str,
    start_s: f64,
    stop_s: f64,
    /// `None` in scheduled execution.
    step_s: Option<f64>,
    steps: u64,
    reached_s: f64,
    terminated: bool,
    interrupted: bool,
    wall_s: f64,
    notes: Vec<String>,
    outputs: Vec<String>,
    left_out: Vec<String>,
    out: Option<PathBuf>,
}

/// A way to run an FMU.
type Simulation = fn(
    &mut dyn Instance,
    &Starts,
    Option<&mut Inputs>,
    &Outputs,
    &Span,
    &mut Sink,
    &Control,
) -> Result<Finished, SimulateError>;

/// Runs the command.
pub(super) fn command(arguments: &Arguments, given: &GivenOptions) -> Result<Verdict, Failure> {
    let Arguments { fmu, source, stepping, set, opening, out, force, json } = arguments;
    if opening.process == Process::Shared {
        given.refuse_ids(
            &["time_limit"],
            "found with --process shared, expected --process own: in the shared process a call can't be interrupted",
        )?;
    }
    let scheduled = opening.interface == Some(Interface::ScheduledExecution);
    if scheduled {
        given.refuse_ids(
            &["source"],
            "found with --interface scheduled-execution, expected co-simulation or model exchange: a core makes a \
             step for each sample",
        )?;
        given.refuse_ids(
            &["step"],
            "found with --interface scheduled-execution, expected none: the clocks of the FMU set the times",
        )?;
    }
    if source.is_some() {
        given.refuse::<SteppingArguments>(
            "found with --source, expected one without the other: the scenario has inputs, times and outputs",
        )?;
    }
    let bad = |error: &dyn std::fmt::Display| Failure::input(format!("failed to {error}"));
    let kept =
        SharedRunOptions { fmu, set, opening, out: out.as_deref(), force: *force, json: *json };
    if let Some(scenario) = source {
        return super::run_source::command(&kept, scenario);
    }
    let SteppingArguments { input, start, stop, step, tolerance, output } = stepping;
    in_the_way(kept.out, kept.force)?;
    let mut instance = open(fmu, opening)?;
    let instance = instance.as_mut();
    let description = instance.description().clone();
    let starts = starts(fmu, set, instance)?;
    let mut inputs = match input {
        Some(path) => Some(Inputs::read(path, &description).map_err(|error| match error {
            // The place comes first, as in messages about scenarios.
            InputFileError::Content { .. } => Failure::input(error),
            _ => bad(&error),
        })?),
        None => None,
    };
    let outputs = Outputs::choose(&description, output)
        .map_err(|error| bad(&format!("record the outputs: {error}")))?;
    let times = [("--start", start), ("--stop", stop), ("--step", step)];
    let span = span(times, *tolerance, opening.interface, &description, inputs.as_ref())?;
    let steps = span.steps().map_err(|error| bad(&format!("plan the steps: {error}")))?;
    let mut sink = match kept.out {
        Some(path) => Sink::file(path, &outputs, &description.model_name).map_err(|e| bad(&e))?,
        None => Sink::None,
    };
    let control = Control::default();
    let one = std::slice::from_ref(&control);
    // How often the clocks tick isn't known before.
    let (planned, run): (_, Simulation) =
        if scheduled { (None, simulate_scheduled) } else { (Some(steps), simulate) };
    let (finished, wall_s) = with_progress(one, planned, span.step_s, || {
        let began = Instant::now();
        let inputs = inputs.as_mut();
        let finished = run(instance, &starts, inputs, &outputs, &span, &mut sink, &control);
        (finished, began.elapsed().as_secs_f64())
    });
    // Data written before a failure is kept.
    let written = sink.finish();
    log(instance);
    let finished = finished.and_then(|finished| {
        instance.finish()?;
        Ok(finished)
    });
    let finished = finished.map_err(|error| {
        let before = match kept.out {
            Some(path) => format!("; the outputs before that are in {}", path.display()),
            None => String::new(),
        };
        match error.kind() {
            // Before the first step, so that there are no outputs, and the FMU is named.
            FailureKind::Input => bad(&error),
            kind => {
                Failure::of_kind(kind, format!("failed to run {}: {error}{before}", fmu.display()))
            }
        }
    })?;
    written.map_err(|error| Failure::bench(format!("failed to write the outputs: {error}")))?;
    tell(&kept, &description, &span, &finished, wall_s, outputs)?;
    Ok(if finished.cancelled { Verdict::Inconclusive } else { Verdict::Pass })
}

/// Reads the limit of `--time-limit`.
pub(crate) fn time_limit_of(text: &str) -> Result<Duration, Failure> {
    let limit = Duration::try_from_secs_f64(seconds("--time-limit", text)?);
    limit.ok().filter(|limit| !limit.is_zero()).ok_or_else(|| {
        Failure::input(format!("--time-limit: found {text:?}, expected a time above 0"))
    })
}

fn open(fmu: &Path, opening: &OpeningArguments) -> Result<Box<dyn Instance>, Failure> {
    let OpeningArguments { interface, process, allow_tool, time_limit: limit } = opening;
    let default = OpenOptions::default();
    let (start_limit, time_limit) = match limit {
        Some(text) => {
            let limit = time_limit_of(text)?;
            (limit, limit)
        }
        None => (default.start_limit, default.time_limit),
    };
    let options = OpenOptions {
        interface: match interface {
            None => InterfaceKind::Any,
            Some(Interface::CoSimulation) => InterfaceKind::CoSimulation,
            Some(Interface::ModelExchange) => InterfaceKind::ModelExchange,
            Some(Interface::ScheduledExecution) => InterfaceKind::ScheduledExecution,
        },
        place: match process {
            Process::Own => ProcessPlace::OwnProcess,
            Process::Shared => ProcessPlace::ThisProcess,
        },
        allow_tool: *allow_tool,
        start_limit,
        time_limit,
        ..default
    };
    octant_fmu_host::open(fmu, &options).map_err(|error| {
        let (kind, error) = (error.kind(), error.to_string());
        // Most errors name the file, and some its path.
        let name = fmu.file_name().map_or_else(String::new, |name| name.to_string_lossy().into());
        let file = match error.contains(&name) && !name.is_empty() {
            true => "the FMU".to_owned(),
            false => fmu.display().to_string(),
        };
        Failure::of_kind(kind, format!("failed to open {file}: {error}"))
    })
}

/// Collects the start values of `--set`.
fn starts(fmu: &Path, set: &[String], instance: &dyn Instance) -> Result<Starts, Failure> {
    let mut settings = ValueSettings::new(instance.description());
    let mut problems = Vec::new();
    for argument in set {
        let set = setting_argument(argument).and_then(|setting| {
            let set = settings.set(&setting.name, &setting.values);
            set.map_err(|error| setting.at.problem(error.to_string()))
        });
        problems.extend(set.err());
    }
    if !problems.is_empty() {
        let file = fmu.display().to_string();
        return Err(Failure::input(FileProblems { file, problems }));
    }
    settings.finish().map_err(|error| Failure::input(format!("failed to set parameters: {error}")))
}

/// Determines start, end and step, in this order in `times`.
fn span(
    times: [(&str, &Option<String>); 3],
    tolerance: Option<f64>,
    chosen: Option<Interface>,
    description: &Description,
    inputs: Option<&Inputs>,
) -> Result<Span, Failure> {
    let default = &description.default_experiment;
    let mut given = [None; 3];
    for (given, (name, text)) in given.iter_mut().zip(times) {
        *given = text.as_ref().map(|text| seconds(name, text)).transpose()?;
    }
    let [start_s, stop_s, step_s] = given;
    let start_s = start_s.or(default.start_s).unwrap_or(0.0);
    let stop_s =
        stop_s.or(default.stop_s).or(inputs.map(|inputs| inputs.span_s().1)).ok_or_else(|| {
            Failure::input(
                "failed to plan the steps: found no stop time in the FMU, expected --stop TIME",
            )
        })?;
    let internal = || {
        let interface = description.co_simulation.as_ref()?;
        interface.fixed_internal_step_s.filter(|_| chosen != Some(Interface::ModelExchange))
    };
    let step_s = step_s.or(default.step_s).or_else(internal).unwrap_or((stop_s - start_s) / 500.0);
    let splits = match (&description.co_simulation, chosen) {
        (Some(interface), None | Some(Interface::CoSimulation)) => interface.variable_step,
        // Model exchange is integrated over steps of any length.
        _ => true,
    };
    Ok(Span { start_s, stop_s, step_s, tolerance: tolerance.or(default.tolerance), splits })
}

/// Prints the messages of the FMU.
fn log(instance: &mut dyn Instance) {
    for message in instance.messages() {
        note!("octant: {}: {message}", instance.name());
    }
}

fn tell(
    kept: &SharedRunOptions<'_>,
    description: &Description,
    span: &Span,
    finished: &Finished,
    wall_s: f64,
    outputs: Outputs,
) -> Result<(), Failure> {
    let chosen = kept.opening.interface;
    let scheduled = chosen == Some(Interface::ScheduledExecution);
    let exchange = chosen == Some(Interface::ModelExchange) || description.co_simulation.is_none();
    let summary = RunSummary {
        fmu: kept.fmu.display().to_string(),
        model: description.model_name.clone(),
        fmi: description.fmi_version.clone(),
        generation_tool: description.generation_tool.clone(),
        interface: match exchange {
            _ if scheduled => "scheduled execution",
            true => "model exchange",
            false => "co-simulation",
        },
        process: match kept.opening.process {
            Process::Own => "own",
            Process::Shared => "shared",
        },
        start_s: span.start_s,
        stop_s: span.stop_s,
        step_s: (!scheduled).then_some(span.step_s),
        steps: finished.steps,
        reached_s: finished.time_s,
        terminated: finished.terminated,
        interrupted: finished.cancelled,
        wall_s,
        notes: finished.notes.clone(),
        outputs: outputs.columns.into_iter().map(|column| column.name).collect(),
        left_out: outputs.left_out,
        out: kept.out.map(Path::to_owned),
    };
    for text in &summary.notes {
        note!("octant: {}: warning: {text}", kept.fmu.display());
    }
    if kept.json {
        return print_json(&summary);
    }
    let tool = match summary.generation_tool.as_str() {
        "" => String::new(),
        tool => format!(", made by {tool}"),
    };
    let steps = match summary.step_s {
        Some(step_s) => format!("{} of {step_s} s", counted(summary.steps, "step", "steps")),
        None => counted(summary.steps, "time of ticks", "times of ticks"),
    };
    let mut text = format!(
        "{}: {}, FMI {}, {}{tool}\n{steps} from {} s to {} s",
        summary.fmu,
        summary.model,
        summary.fmi,
        summary.interface,
        summary.start_s,
        summary.reached_s
    );
    if summary.steps > 0 {
        text += &format!(
            ", {:.3} µs per {} in {} process",
            1e6 * summary.wall_s / summary.steps as f64,
            if scheduled { "time" } else { "step" },
            if summary.process == "own" { "its own" } else { "this" }
        );
    }
    text += match (summary.terminated, summary.interrupted) {
        (true, _) => "; then the FMU ended the simulation\n",
        (_, true) => "; then the run was interrupted\n",
        _ => "\n",
    };
    if !summary.left_out.is_empty() {
        text += &format!(
            "not recorded, because they have no value between ticks: {}\n",
            summary.left_out.join(", ")
        );
    }
    if let Some(out) = &summary.out {
        let rows = counted(summary.steps + 1, "row", "rows");
        let columns = counted(summary.outputs.len(), "output", "outputs");
        text += &format!("{rows} of time and {columns} in {}\n", out.display());
    }
    print(&text)
}
