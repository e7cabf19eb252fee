//! A scenario: what is run, as a TOML file that an engineer can read.
//!
//! [`Scenario::load`] parses and checks it against one table of keys, fills in every
//! default and turns every quantity into SI. What is drawn from the seed is drawn once
//! ([`resolve`]) and put into the configurations of plant and core, so that two methods compared
//! on one seed meet the same instrument.

pub mod channel;
pub mod complete;
mod condition;
mod derive;
pub mod document;
pub mod error;
mod examples;
pub mod keys;
mod ports;
pub mod quantity;
pub mod read;
pub mod recorded;
pub mod resolve;
mod schema;
pub mod suite;
mod tour;
mod write;

pub use error::{Place, Problem, ScenarioError};
pub use keys::SCHEMA;
pub use ports::setting_argument;
pub use ports::{Code, Made, Port, Set, Setting, Written};
pub use quantity::parse as quantity_of;
pub use quantity::{Dimension, Quantity};
pub use read::drive::Drive;
pub use read::faults::Fault;
pub use read::faults::connection::{ConnectionFault, Given, connection_faults, text_of};
pub use read::fmu::{Endpoint, Fmu, InterfaceChoice, Mapped, Process};
pub use read::instrument_port::{Instrument, Messages, Speaks};
pub use read::live::Live;
pub use read::source::{FileName, Source};
pub use schema::schema;
pub use tour::{fault_example, fault_parameters, tour};

use octant_calibration::config as core;
use octant_plant::config as plant;
use octant_sample::parameters::Group;
use std::path::{Path, PathBuf};

/// A checked scenario, SI inside. Values that are drawn are still distributions: see [`resolve`].
#[derive(Clone, Debug)]
pub struct Scenario {
    /// What the run is about.
    pub title: String,
    /// Seed of every draw.
    pub seed: u64,
    /// Sample period, ns.
    pub sample_period_ns: u64,
    /// Where the instrument stands.
    pub site: plant::Site,
    /// How the case moves.
    pub motion: Motion,
    /// Noise densities and what the filter doesn't model; the parameters in it are zero until
    /// they are drawn.
    pub imu: plant::Imu,
    /// Where each group of true parameters comes from, in the order of [`Group::ALL`].
    pub parameters: [Distribution; 7],
    /// The two gimbals.
    pub turntable: plant::Turntable,
    /// The real table that has them, if there is one.
    pub drive: Option<Drive>,
    /// How the core finds its attitude.
    pub alignment: Alignment,
    /// Parameters that the core starts from.
    pub initial_parameters: octant_sample::Parameters,
    /// The calibration, if there is one.
    pub calibration: Option<Calibration>,
    /// The second method, if there is one.
    pub baseline: Option<Calibration>,
    /// The reference during calibration.
    pub aiding: plant::AidingSource,
    /// Navigation after it, if there is one.
    pub navigation: Option<core::NavigationPlan>,
    /// Screens and gates.
    pub screening: core::Screening,
    /// Faults, in the order in which they act.
    pub faults: Vec<Fault>,
    /// Limits that the results have to keep.
    pub requirements: Vec<Requirement>,
    /// What a value near a limit comes to.
    pub decision: octant_requirements::decision::Decision,
    /// What the bench measures with.
    pub equipment: Vec<octant_requirements::equipment::Equipment>,
    /// What is recorded.
    pub record: Record,
    /// Where samples come from.
    pub source: Source,
    /// Where the core runs.
    pub endpoint: Endpoint,
    /// Whether and how the run goes by the clock.
    pub realtime: Realtime,
    /// Name of the scenario's file, for messages.
    pub file: String,
    /// The scenario's own folder, from which relative file names start.
    pub folder: PathBuf,
    /// The document with every default written out.
    document: document::Table,
}

/// Which of the two methods of a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Method {
    /// The calibration of `[procedure.calibration]`.
    Primary,
    /// The calibration of `[baseline]`.
    Baseline,
}

/// Where the true values of a parameter group come from, SI.
#[derive(Clone, Debug, PartialEq)]
pub enum Distribution {
    /// Normal with this standard deviation, each entry alone.
    Normal(f64),
    /// Even within plus and minus this half width, each entry alone.
    Uniform(f64),
    /// Given.
    Constant(Vec<f64>),
}

/// How the case moves; phases that aren't given are drawn.
#[allow(clippy::large_enum_variant, reason = "one of it in a scenario")]
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// Fixed to the ground.
    Static(plant::CaseAttitude),
    /// On a moored ship.
    Dockside(Dockside),
}

/// Components of a moored ship's motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Dockside {
    /// Mean attitude.
    pub mean: plant::CaseAttitude,
    /// Roll, pitch, yaw (rad), surge, sway, heave (m).
    pub components: [Vec<Component>; 6],
    /// Sinusoids of a spectrum beside them, drawn.
    pub spectrum: Option<ShipSpectrum>,
    /// Offset from the dock's reference, north, east, down, m.
    pub mooring_offset_m: [f64; 3],
}

/// One sinusoid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Component {
    /// Amplitude, rad or m.
    pub amplitude: f64,
    /// Period, s.
    pub period_s: f64,
    /// Phase at time 0, rad; `None`: drawn.
    pub phase_rad: Option<f64>,
}

/// Motions with the shape of a wave spectrum, see [`octant_plant::sea`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShipSpectrum {
    /// Period of the peak, s.
    pub peak_period_s: f64,
    /// Standard deviation of roll, pitch, yaw (rad), surge, sway, heave (m); 0: not moved by it.
    pub sigma: [f64; 6],
    /// Sinusoids of each motion.
    pub components: usize,
}

/// How the core finds its attitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Alignment {
    /// Handed over with an error.
    Given {
        /// 1σ of the tilt about north and east, rad.
        tilt_rad: f64,
        /// 1σ of the azimuth, rad.
        azimuth_rad: f64,
        /// 1σ of each velocity, m/s.
        velocity_mps: f64,
        /// The attitude error itself, where it isn't drawn, rad.
        attitude_error_rad: Option<[f64; 3]>,
        /// The velocity error itself, where it isn't drawn, m/s.
        velocity_error_mps: Option<[f64; 3]>,
    },
    /// Found by the core.
    Coarse {
        /// How long to average, s.
        duration_s: f64,
    },
}

/// One method of calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// Name of the sequence, or `own stops`.
    pub name: String,
    /// The stops.
    pub sequence: octant_calibration::sequence::Sequence,
    /// Whole time, s.
    pub duration_s: f64,
    /// Dwell at a stop of weight 1 that fills the duration, s.
    pub dwell_s: f64,
    /// How the parameters are estimated. The external turntable's survey of the base is true.
    pub estimator: core::Estimator,
}

impl Calibration {
    /// Whether the filter estimates a group of parameters. Other estimators have no such choice.
    #[must_use]
    pub fn estimates(&self, group: Group) -> bool {
        match &self.estimator {
            core::Estimator::Kalman(kalman) => kalman.estimated[group as usize],
            core::Estimator::LeastSquares(_) | core::Estimator::ExternalTurntable(_) => true,
        }
    }
}

/// A limit that a result has to keep, with what the scenario says about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Requirement {
    /// What is checked.
    pub check: octant_requirements::verdict::LimitCheck,
    /// What is required, as a sentence.
    pub text: String,
    /// The limit as it was written.
    pub limit_text: String,
    /// Document and clause that it comes from.
    pub clause: Option<String>,
}

/// What is recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record {
    /// Samples between two records of truth, output and decimated samples.
    pub every_samples: u64,
    /// Every sample is kept.
    pub full_samples: bool,
    /// Shortest time between two records of the parameters, ns.
    pub parameters_period_ns: u64,
}

/// Whether and how a run goes by the clock, and what makes it too late.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Realtime {
    /// It does.
    pub by_clock: bool,
    /// Lateness from which on a sample is an overrun, ns.
    pub overrun_ns: u64,
    /// Overruns that are allowed.
    pub overruns: u64,
    /// Limit of the lateness of 99 % of the samples, ns.
    pub lateness_p99_ns: Option<u64>,
    /// Periods that may end without their answer.
    pub late_answers: u64,
    /// Time after which an endpoint that owes an answer is gone, ns.
    pub silence_ns: u64,
    /// Priority of SCHED_FIFO that is asked for.
    pub priority: Option<u8>,
    /// The only processor of the thread.
    pub cpu: Option<u16>,
    /// All memory stays in place.
    pub lock_memory: bool,
    /// Part of each wait that is spent looking at the clock, ns.
    pub spin_ns: u64,
}

impl Scenario {
    /// Reads and checks a scenario file, with `--set` arguments `KEY=VALUE` applied.
    ///
    /// # Errors
    /// If the file can't be read, isn't TOML, or is not a scenario: every problem with its place.
    pub fn load(path: &Path, overrides: &[String]) -> Result<Self, ScenarioError> {
        Self::load_fired(path, overrides, &[])
    }

    /// As [`Scenario::load`], with `--fire` arguments `ID=TIME` applied: times at which faults
    /// with a manual trigger set in.
    ///
    /// # Errors
    /// As [`Scenario::load`], and if an argument names no fault with a manual trigger.
    pub fn load_fired(
        path: &Path,
        overrides: &[String],
        fires: &[String],
    ) -> Result<Self, ScenarioError> {
        let file = path.display().to_string();
        let text = std::fs::read_to_string(path).map_err(|error| ScenarioError {
            file: file.clone(),
            problems: vec![Problem {
                place: Place::Unread,
                path: String::new(),
                message: error.to_string(),
            }],
        })?;
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::parse_fired(&text, &file, folder, overrides, fires)
    }

    /// Checks a scenario's text. `file` names it in errors, `folder` is where relative file names
    /// start.
    ///
    /// # Errors
    /// If it isn't TOML or not a scenario: every problem with its place.
    pub fn parse(
        text: &str,
        file: &str,
        folder: &Path,
        overrides: &[String],
    ) -> Result<Self, ScenarioError> {
        Self::parse_fired(text, file, folder, overrides, &[])
    }

    fn parse_fired(
        text: &str,
        file: &str,
        folder: &Path,
        overrides: &[String],
        fires: &[String],
    ) -> Result<Self, ScenarioError> {
        let with_file = |problems| ScenarioError { file: file.to_owned(), problems };
        let mut document = document::parse(text).map_err(with_file)?;
        let mut problems = Vec::new();
        for argument in overrides {
            if let Err(problem) = override_set(&mut document, argument) {
                problems.push(problem);
            }
        }
        for argument in fires {
            if let Err(problem) = fire(&mut document, argument) {
                problems.push(problem);
            }
        }
        derive::derive(&mut document);
        let start = Place::File { line: 1, column: 1 };
        complete::complete(&mut document, &keys::SCENARIO, "", &start, &mut problems);
        if problems.is_empty() {
            problems = derive::refuse_without_effect(&document);
        }
        if !problems.is_empty() {
            return Err(with_file(problems));
        }
        let scenario =
            read::scenario(document, folder).map_err(|problem| with_file(vec![problem]))?;
        Ok(Self { file: file.to_owned(), ..scenario })
    }

    /// The same scenario without its faults.
    #[must_use]
    pub fn without_faults(&self) -> Self {
        self.with_faults(|_| false)
    }

    /// The same scenario with some of its faults, by their numbers from 0.
    #[must_use]
    pub fn with_faults(&self, keep: impl Fn(usize) -> bool) -> Self {
        let mut some = self.clone();
        let mut numbers = 0..;
        some.faults.retain(|_| numbers.next().is_some_and(&keep));
        if some.faults.is_empty() {
            some.document.remove("faults");
        } else if let Some(document::Node { value: document::Value::Array(entries), .. }) =
            some.document.get_mut("faults")
        {
            let mut numbers = 0..;
            entries.retain(|_| numbers.next().is_some_and(&keep));
        }
        some
    }

    /// The same scenario with the faults of these ids alone.
    ///
    /// # Errors
    /// In words, if it has no fault of an id.
    pub fn with_only(&self, faults: &[String]) -> Result<Self, String> {
        let ids: Vec<&str> = self.faults.iter().map(|fault| fault.spec.id.as_str()).collect();
        if let Some(unknown) = faults.iter().find(|id| !ids.contains(&id.as_str())) {
            let known = octant_base::names::suggestion(unknown, ids.iter().copied(), "its faults");
            return Err(format!("no fault has the id {unknown:?}, {known}"));
        }
        let keep: Vec<bool> = ids.iter().map(|id| faults.iter().any(|kept| kept == id)).collect();
        Ok(self.with_faults(|index| keep.get(index).copied().unwrap_or(false)))
    }

    /// Samples of the calibration phase.
    #[must_use]
    pub fn calibration_samples(&self) -> u64 {
        let duration_s = self.calibration.as_ref().map_or(0.0, |c| c.duration_s);
        (duration_s * 1e9).round() as u64 / self.sample_period_ns
    }

    /// Samples of the whole procedure; `None` where navigation lasts until the source ends.
    #[must_use]
    pub fn samples(&self) -> Option<u64> {
        let navigation_s = match &self.navigation {
            None => 0.0,
            Some(plan) => plan.duration_s?,
        };
        Some(
            self.calibration_samples()
                + (navigation_s * 1e9).round() as u64 / self.sample_period_ns,
        )
    }
}

/// Applies a `--set KEY=VALUE` to a document: KEY is a dotted path, VALUE is TOML or a text
/// without its quotes.
pub fn override_set(document: &mut document::Table, argument: &str) -> Result<(), Problem> {
    let problem = |path: &str, message: String| Problem {
        place: Place::Argument(argument.to_owned()),
        path: path.to_owned(),
        message,
    };
    let Some((path, value)) = argument.split_once('=') else {
        let message = "expected KEY=VALUE, such as procedure.calibration.duration=12 h".to_owned();
        return Err(problem("", message));
    };
    let path = path.trim();
    let node = document::parse_argument(value, argument);
    if let Some(problem) = document::controls_of_argument(path, &node) {
        return Err(problem);
    }
    if let Some((id, key)) = path.strip_prefix("faults.").and_then(|rest| rest.split_once('.')) {
        // What keys a fault has depends on its kind: they are checked with those of the file.
        let fault = fault_of(document, id).map_err(|message| problem(path, message))?;
        fault.set_at(key, document::parse_argument(value, argument));
        return Ok(());
    }
    let mut section = &keys::SCENARIO;
    let mut names = path.split('.').peekable();
    while let Some(name) = names.next() {
        let Some(key) = section.key(name) else {
            let known = octant_base::names::suggestion(name, section.names(), "known here");
            return Err(problem(path, format!("unknown key {name:?}, {known}")));
        };
        if names.peek().is_some() {
            if matches!(key.kind, keys::Kind::Settings) {
                // What follows is the name of a variable.
                document.set_at(path, document::parse_argument(value, argument));
                return Ok(());
            }
            section = key.kind.section().ok_or_else(|| {
                problem(path, format!("{name} has no keys of its own; set it as a whole"))
            })?;
        }
    }
    // Giving a sequence in one way takes back the other, and a group's values take back its draw.
    let exclusive: &[&str] = match path.rsplit_once('.').map_or(path, |(_, name)| name) {
        "stops" => &["positions"],
        "positions" => &["stops"],
        _ if section.one_of => &["normal", "uniform", "constant"],
        _ => &[],
    };
    if let Some((parent, _)) = path.rsplit_once('.') {
        for name in exclusive {
            document.remove_at(&format!("{parent}.{name}"));
        }
    }
    document.set_at(path, document::parse_argument(value, argument));
    Ok(())
}

/// The table of the fault with an id.
fn fault_of<'a>(
    document: &'a mut document::Table,
    id: &str,
) -> Result<&'a mut document::Table, String> {
    use document::{Node, Value};
    let id_of = |node: &Node| match &node.value {
        Value::Table(table) => match &table.get("id")?.value {
            Value::Text(id) => Some(id.clone()),
            _ => None,
        },
        _ => None,
    };
    let Some(Node { value: Value::Array(faults), .. }) = document.get_mut("faults") else {
        return Err("the scenario has no faults".to_owned());
    };
    let ids: Vec<String> = faults.iter().filter_map(id_of).collect();
    match faults.iter_mut().find(|node| id_of(node).is_some_and(|found| found == id)) {
        Some(Node { value: Value::Table(fault), .. }) => Ok(fault),
        _ => {
            let known =
                octant_base::names::suggestion(id, ids.iter().map(String::as_str), "faults");
            Err(format!("no fault has the id {id:?}, {known}"))
        }
    }
}

/// Applies a `--fire ID=TIME`: adds the time to those of a manual trigger.
fn fire(document: &mut document::Table, argument: &str) -> Result<(), Problem> {
    use document::{Node, Value};
    let place = Place::Fire(argument.to_owned());
    let problem = |message: String| Problem { place: place.clone(), path: String::new(), message };
    let Some((id, time)) = argument.rsplit_once('=') else {
        return Err(problem("expected ID=TIME, such as spike-1=\"5050 s\"".to_owned()));
    };
    let fault = fault_of(document, id).map_err(problem)?;
    let Some(Node { value: Value::Table(trigger), .. }) = fault.get_mut("trigger") else {
        return Err(problem(format!("fault {id:?} has no trigger that can be fired by hand")));
    };
    if trigger.get("manual").is_none() {
        return Err(problem(format!("the trigger of fault {id:?} is not manual")));
    }
    let node = document::parse_argument(time, argument);
    let node = Node { place: place.clone(), ..node };
    match trigger.get_mut("fire") {
        Some(Node { value: Value::Array(times), .. }) => times.push(node),
        _ => trigger.set("fire", Node { value: Value::Array(vec![node]), place }),
    }
    Ok(())
}
