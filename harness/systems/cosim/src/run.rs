//! Runs a system from its file to its results: `octant run FILE.ssp`.

mod judge;

use super::error::MasterError;
use super::experiment::{GivenSettings, RunExperiment};
use super::faults::{Faulting, looked_at};
use super::flat::Flat;
use super::open::{OpenedSystem, is_exchange, open_all};
use super::order::SteppingOrder;
use super::parameters;
use super::record::{RowError, RowRecorder, signals};
use super::requirements::Requiring;
use super::simulation::{Abilities, Simulation, SteppingSettings};
use super::solve::IterationLimits;
use super::ssp::SspError;
use super::ssp::annotation::TomlText;
use super::ssp::package::Package;
use super::ssp::structure::SystemStructure;
use super::stream::SystemHash;
use super::summary::{FmuResult, LoopResult, SCHEMA, SystemEnded, SystemSummary};
use super::system::System;
use super::tuning::{TunedResult, Tuning, tunings};
use judge::judge;
use octant_base::control::Control;
use octant_base::failing::{Failing, FailureKind};
use octant_fmu_bind::settings::Starts;
use octant_fmu_host::instance::{Instance, OpenOptions, ProcessPlace};
use octant_fmu_host::{OpenedFmu, description::Description};
use octant_recorder::Event;
use octant_scenario::{FileProblems, connection_faults, system_requirements, text_of};
use octant_score::summary::results;
use octant_verdict::Verdict;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Maximum number of rows of a recording, where the interval isn't given.
pub const ROWS_MAX: u64 = 20_000;
/// Maximum number of times that a discarded step is halved.
const HALVINGS: u32 = 10;
/// Default seed.
const SEED: u64 = 1;

/// Settings of a run.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// The system: an `.ssp`, an `.ssd`, or a folder with one.
    pub path: PathBuf,
    /// Start, end and step, where the command line gives them.
    pub said: GivenSettings,
    /// Order, where the command line gives it.
    pub order: Option<SteppingOrder>,
    /// Seed, where the command line gives it.
    pub seed: Option<u64>,
    /// File of faults, instead of those of the structure.
    pub faults: Option<PathBuf>,
    /// File of requirements, instead of those of the structure.
    pub requirements: Option<PathBuf>,
    /// Arguments `ID=TIME` that trigger faults by hand.
    pub fires: Vec<String>,
    /// Arguments `FMU.VARIABLE=VALUE` that set parameters and start values.
    pub set: Vec<String>,
    /// Arguments `FMU.VARIABLE=VALUE@TIME` that change tunable parameters.
    pub tune: Vec<String>,
    /// Process in which the FMUs run.
    pub place: ProcessPlace,
    /// True to run FMUs that need the tools that made them.
    pub allow_tool: bool,
    /// Longest time of a call in a process of its own, and of loading; `None`: the defaults.
    pub time_limit: Option<Duration>,
    /// Number of steps between recorded rows.
    pub every: Option<u64>,
    /// True if the system must have requirements.
    pub require: bool,
    /// Maximum number of values that are no numbers from outputs into inputs; `None`: any.
    pub no_numbers_max: Option<u64>,
}

/// Reasons why a system can't be run at all.
#[derive(Debug, thiserror::Error)]
pub enum PrepareError {
    /// The files of the system aren't valid.
    #[error(transparent)]
    Ssp(#[from] SspError),
    /// The faults or requirements aren't valid.
    #[error(transparent)]
    List(#[from] FileProblems),
    /// The settings of the run aren't valid.
    #[error("{0}")]
    Usage(String),
    /// The initialization failed.
    #[error("{0}")]
    Master(#[from] MasterError),
}

impl Failing for PrepareError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Master(error) => error.kind(),
            Self::Ssp(_) | Self::List(_) | Self::Usage(_) => FailureKind::Input,
        }
    }
}

/// System that can be run.
pub struct PreparedSystem {
    request: Request,
    package: Package,
    structure: SystemStructure,
    flat: Flat,
    system: System,
    settings: SteppingSettings,
    order: SteppingOrder,
    seed: u64,
    instances: Vec<Box<dyn Instance>>,
    fmus: Vec<OpenedFmu>,
    abilities: Vec<Abilities>,
    starts: Vec<Starts>,
    tunings: Vec<Tuning>,
    faults: Option<TomlText>,
    faulting: Faulting,
    requirements: Option<TomlText>,
    requiring: Requiring,
    warnings: Vec<String>,
}

impl PreparedSystem {
    /// Reads a system, opens its FMUs, and resolves every name in them.
    ///
    /// # Errors
    /// If anything doesn't fit; no step was made then.
    pub fn new(request: Request) -> Result<Self, PrepareError> {
        let package = Package::open(&request.path)?;
        let structure = SystemStructure::read(&package)?;
        let flat = Flat::of(&structure)?;
        let OpenedSystem { instances, fmus } = open_all(&structure, &flat, &opening(&request))?;
        let described: Vec<&Description> = fmus.iter().map(|fmu| &**fmu.description()).collect();
        let experiment = RunExperiment::of(&request.said, &structure, &flat, &described)
            .map_err(|error| SspError::of_file(&structure.file, error.to_string()))?;
        let names: Vec<&str> = flat.components.iter().map(|c| c.name.as_str()).collect();
        let ours = &structure.co_simulation;
        let order = request.order.clone().or_else(|| ours.order.clone()).unwrap_or_default();
        let numbers = order.of(&names).map_err(|error| PrepareError::Usage(error.to_string()))?;
        let faults = given_or(request.faults.as_deref(), ours.faults.as_ref())?;
        let requirements = given_or(request.requirements.as_deref(), ours.requirements.as_ref())?;
        let (text, file) = match &faults {
            Some(faults) => (faults.text.as_str(), faults.file.as_str()),
            None => ("schema = 1", "--faults FILE"),
        };
        let (step_s, steps) = (experiment.step_s, experiment.steps);
        let list = connection_faults(text, file, step_s, steps, &request.fires)?;
        let looked = looked_at(&list, file, &names)?;
        let system = System::new(&structure, &flat, &described, &looked)?;
        let seed = request.seed.or(ours.seed).unwrap_or(SEED);
        let faulting = Faulting::new(&list, file, &system, &described, seed, step_s)?;
        let requiring = match &requirements {
            Some(TomlText { file, text }) => {
                let list = system_requirements(text, file)?;
                Requiring::new(&list, file, &signals(&system, &described))?
            }
            None => Requiring::default(),
        };
        let mut warnings = structure.warnings.clone();
        warnings.extend(flat.warnings.iter().cloned());
        for fault in list.iter().filter(|fault| fault.is_idle()) {
            let id = &fault.id;
            warnings.push(format!(
                "fault {id:?} is fired by hand, and no --fire {id}=TIME does: it won't fire"
            ));
        }
        let starts =
            parameters::starts(&structure, &flat, &described, &request.set, &mut warnings)?;
        let tunings = tunings(&request.tune, &flat, &described, &experiment)?;
        let abilities = (described.iter().zip(&flat.components))
            .map(|(description, component)| {
                let exchange = is_exchange(description, component.implementation);
                let interface =
                    if exchange { &description.model_exchange } else { &description.co_simulation };
                interface.as_ref().map_or_else(Abilities::default, |i| Abilities::of(i, exchange))
            })
            .collect();
        let settings = SteppingSettings {
            order: numbers,
            jacobi: order == SteppingOrder::Jacobi,
            start_s: experiment.start_s,
            step_s,
            steps,
            tolerance: None,
            loops: IterationLimits::default(),
            halvings: HALVINGS,
            no_numbers_max: request.no_numbers_max,
        };
        Ok(Self {
            request,
            package,
            structure,
            flat,
            system,
            settings,
            order,
            seed,
            instances,
            fmus,
            abilities,
            starts,
            tunings,
            faults,
            faulting,
            requirements,
            requiring,
            warnings,
        })
    }

    /// Name of the system.
    #[must_use]
    pub fn name(&self) -> &str {
        match self.structure.name.as_str() {
            "" => "system",
            name => name,
        }
    }

    /// Number of steps.
    #[must_use]
    pub const fn steps(&self) -> u64 {
        self.settings.steps
    }

    /// Communication step, s.
    #[must_use]
    pub const fn step_s(&self) -> f64 {
        self.settings.step_s
    }

    /// Seed of the faults' random streams.
    #[must_use]
    pub const fn seed(&self) -> u64 {
        self.seed
    }

    /// Returns the warnings.
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Returns structure, faults and requirements as texts, for the folder of the run: name and content.
    ///
    /// # Errors
    /// If the structure can't be read again.
    pub fn texts(&self) -> Result<Vec<(&'static str, String)>, SspError> {
        let structure = self.package.text_of(self.package.structure())?;
        let mut texts = vec![("SystemStructure.ssd", structure)];
        let lists = [("faults.toml", &self.faults), ("requirements.toml", &self.requirements)];
        for (name, list) in lists {
            texts.extend(list.iter().map(|list| (name, list.text.trim_start().to_owned())));
        }
        Ok(texts)
    }

    /// Runs the system and records into files of these paths.
    ///
    /// # Errors
    /// If the system can't be initialized, or a file can't be made. Later failures are in the
    /// summary.
    pub fn run(self, paths: &[&Path], control: &Control) -> Result<Results, PrepareError> {
        self.run_watched(paths, control, |_, _| Ok(()))
    }

    /// Runs as [`Self::run`], and calls `watch` at every communication point.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn run_watched(
        self,
        paths: &[&Path],
        control: &Control,
        mut watch: impl FnMut(&mut Simulation<'_>, &System) -> Result<(), MasterError>,
    ) -> Result<Results, PrepareError> {
        let Self { system, settings, instances, starts, abilities, faulting, requiring, .. } = self;
        let described: Vec<&Description> =
            self.fmus.iter().map(|fmu| &**fmu.description()).collect();
        let every = self.request.every.unwrap_or(settings.steps.div_ceil(ROWS_MAX)).max(1);
        let mut simulation =
            Simulation::new(&system, &settings, instances, abilities, Some(faulting));
        simulation.tune_at(self.tunings);
        for (node, starts) in starts.iter().enumerate() {
            starts.apply(simulation.instances()[node].as_mut()).map_err(|error| {
                let node = system.nodes[node].name.clone();
                MasterError::Instance { node, time_s: settings.start_s, error }
            })?;
        }
        let ended_by = simulation.initialize()?;
        let name = if self.structure.name.is_empty() { "system" } else { &self.structure.name };
        let mut recorder = RowRecorder::new(&system, &described, name, paths, every, requiring)
            .map_err(|error| PrepareError::Usage(error.to_string()))?;
        let times = (settings.start_s, settings.step_s);
        let mut hash = SystemHash::new(&system, &described, &starts, times);
        let described = &described[..];
        let kept = Kept { recorder: &mut recorder, hash: &mut hash, watch: &mut watch, described };
        let ended = drive(&mut simulation, &system, &settings, kept, ended_by, control);
        let mut warnings = self.warnings;
        warnings.extend(simulation.no_numbers().map(|(wire, since_s)| {
            format!(
                "{} isn't a number, first at {since_s} s, and went into {}",
                wire.source, wire.target
            )
        }));
        let mut messages: Vec<(String, String)> = Vec::new();
        let mut fmus = Vec::with_capacity(system.nodes.len());
        let ended = match (ended, simulation.terminate()) {
            (Ok(_), Err(error)) => SystemEnded::Failed {
                at_s: simulation.time_s(simulation.steps()),
                reason: format!("failed to end the FMUs: {error}"),
            },
            (Ok(ended), Ok(())) => ended,
            (Err(error), _) => SystemEnded::Failed {
                at_s: simulation.time_s(simulation.steps().saturating_sub(1)),
                reason: error.to_string(),
            },
        };
        for (number, component) in self.flat.components.iter().enumerate() {
            let said = simulation.instances()[number].messages();
            let counts = simulation.counts()[number];
            let description = described[number];
            let exchange = is_exchange(description, component.implementation);
            fmus.push(FmuResult {
                name: component.name.clone(),
                source: component.source.clone(),
                sha256: self.fmus[number].sha256().map(str::to_owned),
                model: description.model_name.clone(),
                token: description.token.clone(),
                fmi: description.fmi_version.clone(),
                interface: if exchange { "model-exchange" } else { "co-simulation" },
                generation_tool: description.generation_tool.clone(),
                tolerated: description.tolerated.clone(),
                discarded: counts.discarded,
                refused: counts.refused,
                messages: said.len(),
            });
            let own = said.iter().filter(|message| message.is_of_host());
            warnings.extend(own.map(|message| format!("{}: {}", component.name, message.text)));
            messages.extend(said.iter().map(|m| (component.name.clone(), m.to_string())));
        }
        let ended = match (ended, simulation.finish()) {
            (SystemEnded::Failed { at_s, reason }, _) => SystemEnded::Failed { at_s, reason },
            (_, Err(error)) => SystemEnded::Failed {
                at_s: simulation.time_s(simulation.steps()),
                reason: format!("failed to free the FMUs: {error}"),
            },
            (ended, Ok(())) => ended,
        };
        let receipts = simulation.station().map(|station| station.receipts()).unwrap_or_default();
        let faults = results(&receipts);
        let is_whole = matches!(ended, SystemEnded::AtStop | SystemEnded::AskedByFmu { .. });
        let requirements = recorder.requiring().results(is_whole);
        let tuned: Vec<TunedResult> = simulation.tunings().cloned().collect();
        let required = (&requirements[..], self.request.require);
        let (verdict, reasons) = judge(&ended, &faults, &tuned, required);
        let written = recorder
            .event(simulation.time_s(simulation.steps()), &Event::Receipts(faults.clone()))
            .and_then(|()| recorder.finish());
        let (verdict, reasons) = match written {
            Ok(()) => (verdict, reasons),
            Err(error) => (Verdict::Error, vec![format!("failed to write the recording: {error}")]),
        };
        Ok(Results {
            summary: SystemSummary {
                schema: SCHEMA,
                octant: env!("CARGO_PKG_VERSION").to_owned(),
                system: name.to_owned(),
                seed: self.seed,
                verdict,
                reasons,
                order: self.order.to_string(),
                start_s: settings.start_s,
                stop_s: settings.start_s + settings.steps as f64 * settings.step_s,
                step_s: settings.step_s,
                steps: simulation.steps(),
                rejected: simulation.rejected(),
                ended,
                loops: simulation.loops().iter().map(LoopResult::from).collect(),
                requirements,
                faults,
                fmus,
                tuned,
                connections: system.wires.len(),
                recorded_every: every,
                warnings,
                stream_hash: hash.hex(),
            },
            messages,
        })
    }
}

/// Results of a run.
#[derive(Clone, Debug)]
pub struct Results {
    /// The summary.
    pub summary: SystemSummary,
    /// Messages that FMUs logged: the name of the FMU, and its text.
    pub messages: Vec<(String, String)>,
}

/// Receivers of every communication point.
struct Kept<'a, W> {
    recorder: &'a mut RowRecorder,
    hash: &'a mut SystemHash,
    watch: &'a mut W,
    described: &'a [&'a Description],
}

/// Steps to the end.
fn drive<W>(
    simulation: &mut Simulation<'_>,
    system: &System,
    settings: &SteppingSettings,
    kept: Kept<'_, W>,
    mut ended_by: Option<usize>,
    control: &Control,
) -> Result<SystemEnded, RowError>
where
    W: FnMut(&mut Simulation<'_>, &System) -> Result<(), MasterError>,
{
    let Kept { recorder, hash, watch, described } = kept;
    loop {
        let at_s = simulation.time_s(simulation.steps());
        let last = ended_by.is_some() || simulation.steps() == settings.steps;
        simulation.read_written()?;
        hash.add(simulation, described);
        watch(simulation, system)?;
        recorder.row(simulation, system, last)?;
        if let Some(node) = ended_by {
            return Ok(SystemEnded::AskedByFmu { fmu: system.nodes[node].name.clone(), at_s });
        }
        if last {
            return Ok(SystemEnded::AtStop);
        }
        if control.look(simulation.steps()) {
            return Ok(SystemEnded::Interrupted { at_s });
        }
        ended_by = simulation.advance()?;
        tell_faults(simulation, recorder, at_s)?;
    }
}

/// Writes onsets and ends of faults into the recording.
fn tell_faults(
    simulation: &mut Simulation<'_>,
    recorder: &mut RowRecorder,
    at_s: f64,
) -> std::io::Result<()> {
    let Some(station) = simulation.station() else { return Ok(()) };
    for occurrence in station.occurrences() {
        let (id, kind) = station.name(occurrence.fault).unwrap_or_default();
        let event = Event::Fault {
            begins: occurrence.begins,
            id: id.to_owned(),
            kind: kind.to_owned(),
            sample: occurrence.epoch,
        };
        recorder.event(at_s, &event)?;
    }
    station.told();
    Ok(())
}

/// Options with which all FMUs are opened.
fn opening(request: &Request) -> OpenOptions {
    let default = OpenOptions::default();
    OpenOptions {
        place: request.place,
        allow_tool: request.allow_tool,
        start_limit: request.time_limit.unwrap_or(default.start_limit),
        time_limit: request.time_limit.unwrap_or(default.time_limit),
        ..default
    }
}

/// Text of the file that the command line gives, else that of the structure.
fn given_or(
    path: Option<&Path>,
    ours: Option<&TomlText>,
) -> Result<Option<TomlText>, FileProblems> {
    match path {
        Some(path) => Ok(Some(TomlText { file: path.display().to_string(), text: text_of(path)? })),
        None => Ok(ours.cloned()),
    }
}
