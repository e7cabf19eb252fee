//! One method of a scenario, from its configuration to its scores.

use super::concluded;
use super::done::Plan;
use super::drive::{Control, Ended, RunError, drive};
use super::faulted::{Faulted, drive_faulted};
use super::host::Host;
use super::realtime::{Kept, Line, drive_by_clock};
use super::watch::Watcher;
use crate::calibrate::{PassError, in_passes};
use crate::endpoint::{Conclusion, Endpoint, EndpointError, InProcess, Tells};
use crate::source::{PlantSource, Source, SourceError};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use octant_calibration::config as core;
use octant_calibration::state_machine::ConfigError;
use octant_calibration::table::CalibrationTable;
use octant_faults::Receipt;
use octant_plant::Plant;
use octant_recorder::{
    Event, Policy, Recorder, RecorderError, RecorderOptions, RecorderSummary, Samples, Trouble,
};
use octant_sample::parameters::ParameterEstimate;
use octant_sample::parameters::{Group, NAMES};
use octant_sample::{Mode, Output, Parameters};
use octant_scenario::resolve::{Draws, Seeded};
use octant_scenario::{self as scenario, Method, Realtime, Scenario, Source as SourceKind};
use octant_score::parameters::{nees, score, worst_normalized_error};
use octant_score::summary::{Calibration, HeightChannel, Navigation};
use octant_score::trace::Trace;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// What is kept of a method's stream.
#[derive(Clone, Copy, Debug)]
pub enum Recording<'a> {
    /// A file, by the scenario's policy.
    File(&'a Path),
    /// The hash of the stream and those of altered streams, and the trace by which a twin is compared.
    Hash,
    /// The hash of the stream alone, of a run that is compared with no other.
    HashAlone,
    /// Nothing: for ensembles.
    None,
}

/// Why a method could not be set up.
#[derive(Debug, thiserror::Error)]
pub enum SetupError {
    /// The plant's configuration contradicts itself.
    #[error("set up the plant: {0}")]
    Plant(#[from] octant_plant::ConfigError),
    /// The core's configuration contradicts itself.
    #[error("set up the core: {}", core_problem(.0))]
    Core(#[from] ConfigError),
    /// A source could not be opened.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// An endpoint could not be opened.
    #[error(transparent)]
    Endpoint(crate::endpoint::OpenError),
    /// A fault can't be injected.
    #[error("inject fault {id:?}: {reason}")]
    Fault {
        /// Its id.
        id: String,
        /// Why.
        reason: String,
    },
    /// The scenario has no second method.
    #[error("run the baseline: the scenario has no [baseline]")]
    NoBaseline,
    /// The recorder could not be set up.
    #[error(transparent)]
    Recorder(#[from] RecorderError),
}

impl From<crate::endpoint::OpenError> for SetupError {
    fn from(error: crate::endpoint::OpenError) -> Self {
        match error {
            crate::endpoint::OpenError::Core(error) => Self::Core(error),
            other => Self::Endpoint(other),
        }
    }
}

/// Why a core can't be set up, in the figures of the scenario.
#[must_use]
pub fn core_problem(error: &ConfigError) -> String {
    use octant_base::number::plain;
    match error {
        ConfigError::Alignment { alignment_s, dwell_s } if alignment_s <= dwell_s => {
            "coarse alignment needs the first stop at azimuth 0 and roll 0, where the gimbals start"
                .to_owned()
        }
        ConfigError::Alignment { alignment_s, dwell_s } => format!(
            "procedure.alignment.duration is {} s, and the first stop is held for {} s only",
            plain(*alignment_s, 5),
            plain(*dwell_s, 5)
        ),
        _ => error.to_string(),
    }
}

/// Why a method gave no result.
#[derive(Debug, thiserror::Error)]
pub enum MethodError {
    /// It could not be set up: the input is bad.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// It broke off: the bench failed.
    #[error(transparent)]
    Run(#[from] RunError),
}

/// One method, run.
#[derive(Debug)]
pub struct MethodRun {
    /// Name of the method, as in "eight positions with G".
    pub label: String,
    /// How the loop ended.
    pub ended: Ended,
    /// Its calibration.
    pub calibration: Option<Calibration>,
    /// Its navigation.
    pub navigation: Option<Navigation>,
    /// What the recorder left.
    pub recorder: RecorderSummary,
    /// What was noticed.
    pub watcher: Watcher,
    /// True parameters, where the source knows them.
    pub truth: Option<Parameters>,
    /// The calibration table, where the calibration was accepted.
    pub table: Option<CalibrationTable>,
    /// What became of the faults, in the order of the scenario.
    pub receipts: Vec<Receipt>,
    /// The same run without its faults.
    pub twin: Option<Arc<MethodRun>>,
    /// What went away in the middle, and ended it.
    pub broken: Option<RunError>,
    /// How it kept time, where it went by the clock.
    pub kept: Option<Kept>,
    /// What went over the wire to a device, and who it is; as in the recording.
    pub link: Option<serde_json::Value>,
    /// Clocks and counts of a real instrument and its table; as in the recording.
    pub bench: Option<serde_json::Value>,
    /// Where the source ended in the middle of something.
    pub cut_short: Option<String>,
}

/// Name of a method, for people.
#[must_use]
pub fn label(scenario: &Scenario, method: Method) -> String {
    let calibration = match method {
        Method::Primary => scenario.calibration.as_ref(),
        Method::Baseline => scenario.baseline.as_ref(),
    };
    let Some(calibration) = calibration else { return "navigation alone".to_owned() };
    let estimator = match &calibration.estimator {
        core::Estimator::Kalman(_) => {
            let g = octant_sample::parameters::Group::GDependent;
            if calibration.estimates(g) { "with G states" } else { "without G states" }
        }
        core::Estimator::LeastSquares(_) => "by least squares",
        core::Estimator::ExternalTurntable(_) => "on an external turntable",
    };
    if calibration.name == "own stops" {
        format!("own stops {estimator}")
    } else {
        format!("{} positions {estimator}", calibration.name)
    }
}

/// Configurations of plant and core of one method of a scenario.
///
/// # Errors
/// If they contradict themselves.
pub fn configurations(
    scenario: &Scenario,
    method: Method,
    seed: u64,
) -> Result<(octant_plant::config::Config, core::Config, Draws), SetupError> {
    let draws = Draws::of(scenario, &Seeded(seed));
    let plant = scenario.plant(seed, &draws);
    // On a ship the attitude at the start depends on the phases that were drawn, or on the ship.
    let truth = match &scenario.source {
        SourceKind::Plant => Some(Plant::new(&plant)?.truth()),
        SourceKind::Fmu(fmu) => crate::source::fmu::truth_at_start(scenario, fmu, &plant)?,
        SourceKind::Replay { .. } | SourceKind::Text(_) | SourceKind::Live(_) => None,
    };
    let (q_nb, velocity) = match truth {
        Some(truth) => {
            let [w, x, y, z] = truth.q_nb;
            let q_nb = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
            (q_nb, Vector3::from(truth.velocity_mps))
        }
        None => (scenario.mean_attitude(), Vector3::zeros()),
    };
    let core = scenario.core(method, &draws, &q_nb, &velocity).ok_or(SetupError::NoBaseline)?;
    Ok((plant, core, draws))
}

/// The configuration of the core of a method, as a run has it.
///
/// # Errors
/// If it can't be made.
pub fn core_of(
    scenario: &Scenario,
    method: Method,
    seed: u64,
) -> Result<core::Config, MethodError> {
    let (plant, mut core, _) = configurations(scenario, method, seed)?;
    if scenario.source.is_recorded() {
        settle(scenario, &plant, &mut core)?;
    }
    Ok(core)
}

/// Runs one method of a scenario with a seed.
///
/// # Errors
/// If it can't be set up, or source, endpoint or recorder fail.
pub fn run_method(
    scenario: &Scenario,
    method: Method,
    seed: u64,
    recording: Recording<'_>,
    control: &Control,
) -> Result<MethodRun, MethodError> {
    let mut run = run_as_far_as_it_goes(scenario, method, seed, recording, control)?;
    match run.broken.take() {
        None => Ok(run),
        Some(error) => Err(error.into()),
    }
}

/// As [`run_method`]; where source, endpoint or the disk of the recording go away in the middle, the
/// run ends there, with a recording that is complete up to there, and says so.
///
/// # Errors
/// If it can't be set up, a file can't be read to its end, or the recorder fails otherwise.
pub fn run_as_far_as_it_goes(
    scenario: &Scenario,
    method: Method,
    seed: u64,
    recording: Recording<'_>,
    control: &Control,
) -> Result<MethodRun, MethodError> {
    let (plant, mut core, draws) = configurations(scenario, method, seed)?;
    if scenario.source.is_recorded() {
        settle(scenario, &plant, &mut core)?;
    }
    let trouble = Trouble::default();
    let mut faulted = faulted(scenario, seed)?;
    if let Some(faulted) = &mut faulted {
        // Before a device is greeted: it waits for its first sample from then on.
        faulted.host = Host::new(scenario, &recording, &trouble)?;
    }
    let opened = crate::source::open(scenario, &plant).map_err(SetupError::Source)?;
    let elsewhere = crate::endpoint::open(scenario, &core).map_err(SetupError::from)?;
    let true_parameters = opened.as_ref().is_none_or(|source| source.has_true_parameters());
    let options = RecorderOptions {
        trouble,
        ..recorder_options(scenario, seed, &draws, method, true_parameters)
    };
    let mut recorder = match recording {
        Recording::File(path) => Recorder::to_file(path, &options).map_err(SetupError::Recorder)?,
        Recording::Hash => Recorder::hash_only(&options),
        Recording::HashAlone => Recorder::stream_hash_only(&options),
        Recording::None => Recorder::none(),
    };
    let tells = elsewhere.as_ref().map_or(Tells::ALL, |endpoint| endpoint.tells());
    let recorded = opened.as_ref().and_then(|source| source.samples_planned());
    let plan = Plan::of(scenario, method, &core, tells, recorded);
    let mut watcher = Watcher::new(plan);
    let compared = match recording {
        Recording::HashAlone => false,
        Recording::Hash => true,
        Recording::File(_) | Recording::None => !scenario.faults.is_empty(),
    };
    watcher.trace = compared.then(Trace::new);
    let samples = scenario.samples().unwrap_or(u64::MAX);
    let realtime =
        scenario.realtime.by_clock.then_some((&scenario.realtime, scenario.sample_period_ns));
    let closed = match (opened, elsewhere) {
        // Statically dispatched: this loop passes ten million samples a second.
        (None, None) => {
            let mut source = PlantSource::new(&plant, samples).map_err(SetupError::Plant)?;
            let mut endpoint = InProcess::new(&core).map_err(SetupError::Core)?;
            let faulted = faulted.as_mut();
            let line = Line { source: &mut source, faulted, endpoint: &mut endpoint };
            to_the_end(realtime, line, &mut recorder, &mut watcher, control)?
        }
        (opened, elsewhere) => {
            let mut source: Box<dyn Source> = match opened {
                Some(source) => source,
                None => Box::new(PlantSource::new(&plant, samples).map_err(SetupError::Plant)?),
            };
            let mut endpoint: Box<dyn Endpoint> = match elsewhere {
                Some(endpoint) => endpoint,
                None => Box::new(InProcess::new(&core).map_err(SetupError::Core)?),
            };
            let faulted = faulted.as_mut();
            let line = Line { source: &mut source, faulted, endpoint: &mut endpoint };
            to_the_end(realtime, line, &mut recorder, &mut watcher, control)?
        }
    };
    let receipts = faulted.map_or_else(Vec::new, |faulted| faulted.station.receipts());
    let truth = true_parameters.then_some(draws.parameters);
    let run = finish(scenario, method, closed, recorder, watcher, truth)?;
    Ok(MethodRun { receipts, ..run })
}

/// What is left when a loop has ended.
struct Closed {
    ended: Ended,
    broken: Option<RunError>,
    /// The answer to the end of the source.
    last: Option<Output>,
    conclusion: Conclusion,
    estimate: ParameterEstimate,
    kept: Option<Kept>,
    link: Option<serde_json::Value>,
    bench: Option<serde_json::Value>,
    cut_short: Option<String>,
}

/// Drives until the end, whatever it is, and asks the core for its last words.
fn to_the_end<S: Source, E: Endpoint>(
    realtime: Option<(&Realtime, u64)>,
    line: Line<'_, S, E>,
    recorder: &mut Recorder,
    watcher: &mut Watcher,
    control: &Control,
) -> Result<Closed, RunError> {
    let Line { source, faulted, endpoint } = line;
    let mut kept = None;
    let driven = match (realtime, faulted) {
        (None, None) => drive(source, endpoint, recorder, watcher, control),
        (None, Some(faulted)) => {
            drive_faulted(source, faulted, endpoint, recorder, watcher, control)
        }
        (Some((settings, period_ns)), faulted) => {
            let line = Line { source, faulted, endpoint: &mut *endpoint };
            let (driven, time) =
                drive_by_clock(settings, period_ns, line, recorder, watcher, control);
            kept = Some(time);
            driven
        }
    };
    // First of all what moves is stopped.
    let broken = driven.as_ref().err().map(ToString::to_string);
    let (bench, stopped) = source.conclude(broken.as_deref());
    let driven = match stopped {
        None => driven,
        Some(error) => driven.and(Err(error.into())),
    };
    let cut_short = source.cut_short();
    if let Some(detail) = &bench {
        recorder.event(Event { kind: "bench".to_owned(), detail: detail.clone() });
    }
    let driven = driven.and_then(|ended| match ended {
        Ended::SourceEnded => Ok((ended, endpoint.end_of_stream()?)),
        _ => Ok((ended, None)),
    });
    if let Err(RunError::Endpoint(EndpointError::Misbehaved(misbehaviour))) = &driven {
        watcher.misbehaved.get_or_insert_with(|| misbehaviour.clone());
    }
    let (ended, last, broken) = match driven {
        // What came after the misbehaviour, while the run was being stopped, is no reason of its end.
        _ if watcher.misbehaved.is_some() => (Ended::Misbehaved, None, None),
        Ok((ended, last)) => (ended, last, None),
        // Somebody wanted its end, and stopped what moves without waiting for the run.
        Err(error) if error.is_gone() && control.cancel.load(Ordering::Relaxed) => {
            (Ended::Cancelled, None, None)
        }
        Err(error) if error.is_gone() => {
            recorder.event(Event {
                kind: "error".to_owned(),
                detail: serde_json::json!({ "reason": error.to_string() }),
            });
            (Ended::Broken, None, Some(error))
        }
        Err(error) => return Err(error),
    };
    let mut conclusion = endpoint.conclusion();
    let link = conclusion.events.iter().find(|event| event.kind == "link");
    let link = link.map(|event| event.detail.clone());
    conclusion.events.drain(..).for_each(|event| recorder.event(event));
    let estimate = endpoint.parameters();
    Ok(Closed { ended, broken, last, conclusion, estimate, kept, link, bench, cut_short })
}

/// The station of a scenario, with a host to which nothing can happen; `None` without faults.
pub(super) fn faulted(scenario: &Scenario, seed: u64) -> Result<Option<Faulted>, SetupError> {
    let station = scenario
        .station(seed)
        .map_err(|(id, error)| SetupError::Fault { id, reason: error.to_string() })?;
    let mut fires: Vec<(u64, String)> = (scenario.faults.iter())
        .flat_map(|fault| fault.fires.iter().map(|at| (*at, fault.spec.id.clone())))
        .collect();
    fires.sort_unstable();
    Ok(station.map(|station| Faulted { station, fires, host: Host::default() }))
}

/// Least squares linearises about its initial parameters, and a real instrument's errors can be
/// large: it passes over the recorded samples until nothing moves, and the run that is recorded is
/// one more pass.
fn settle(
    scenario: &Scenario,
    plant: &octant_plant::config::Config,
    core: &mut core::Config,
) -> Result<(), MethodError> {
    let least_squares = core
        .calibration
        .as_ref()
        .is_some_and(|c| matches!(c.estimator, core::Estimator::LeastSquares(_)));
    if !least_squares {
        return Ok(());
    }
    let open = || match crate::source::open(scenario, plant)? {
        Some(source) => Ok(source),
        None => Err(SourceError::Read {
            path: "source.uri".to_owned(),
            reason: "a file is expected here".to_owned(),
        }),
    };
    let passes = in_passes(core, open).map_err(|error| match error {
        PassError::Config(error) => MethodError::Setup(SetupError::Core(error)),
        PassError::Source(error) => MethodError::Run(RunError::Source(error)),
    })?;
    if passes.core.table().is_some() {
        core.initial_parameters = *passes.core.parameters();
    }
    Ok(())
}

/// What is recorded of a method, by the scenario.
fn recorder_options(
    scenario: &Scenario,
    seed: u64,
    draws: &Draws,
    method: Method,
    true_parameters: bool,
) -> RecorderOptions {
    let record = &scenario.record;
    let method = match method {
        Method::Primary => "primary",
        Method::Baseline => "baseline",
    };
    RecorderOptions {
        policy: Policy {
            samples: if record.full_samples { Samples::Full } else { Samples::Decimated },
            period_ns: record.every_samples * scenario.sample_period_ns,
            parameters_period_ns: record.parameters_period_ns,
        },
        scenario: scenario.to_resolved_toml(seed, draws),
        metadata: [
            ("method", method.to_owned()),
            ("seed", seed.to_string()),
            ("true_parameters", true_parameters.to_string()),
        ]
        .map(|(key, value)| (key.to_owned(), value))
        .into(),
        ..RecorderOptions::default()
    }
}

/// Scores what was watched and closes the recording.
fn finish(
    scenario: &Scenario,
    method: Method,
    closed: Closed,
    mut recorder: Recorder,
    mut watcher: Watcher,
    truth: Option<Parameters>,
) -> Result<MethodRun, MethodError> {
    let Closed { ended, broken, last, conclusion, estimate, kept, link, bench, cut_short } = closed;
    if let Some(output) = last {
        watcher.last_parameters = Some(estimate);
        // No sample goes with this output: the recording keeps the parameters as an event.
        if output.mode != watcher.last_mode && output.mode != Mode::Refused {
            recorder.event(concluded::event(&estimate));
            watcher.parameters(&output, &estimate);
        }
        watcher.epoch(&output);
    }
    let refused = match conclusion.refused {
        None if watcher.last_mode == Mode::Refused => Some("the core doesn't say why".to_owned()),
        refused => refused,
    };
    if let Some(reason) = &refused {
        recorder.event(Event {
            kind: "refused".to_owned(),
            detail: serde_json::json!({ "reason": reason }),
        });
    }
    let (_, done) = watcher.work();
    let calibration = match method {
        Method::Primary => scenario.calibration.as_ref(),
        Method::Baseline => scenario.baseline.as_ref(),
    }
    .map(|plan| {
        let parameters = score(truth.as_ref(), &estimate.parameters, &estimate.sigma);
        let mut health = watcher.health.counts().clone();
        health.measurements = conclusion.measurements.unwrap_or(health.measurements);
        let nis_mean = conclusion.nis_mean.or(watcher.health.nis_mean());
        Calibration {
            positions: plan.name.clone(),
            estimator: estimator_name(&plan.estimator).to_owned(),
            duration_h: done.calibration_s.unwrap_or(plan.duration_s) / 3600.0,
            nis_mean: nis_mean.filter(|nis| nis.is_finite()),
            nees: nees(&parameters),
            worst_normalized_error: worst_normalized_error(&parameters, &planned_of(plan)),
            parameters,
            refused: refused.clone(),
            health,
        }
    });
    let navigation = match watcher.drift() {
        Some(drift) => Some(drift.finish(HeightChannel::Held).map_err(RunError::from)?),
        None => None,
    };
    let table = conclusion.table;
    let (recorder, broken) = match recorder.finish() {
        Ok(summary) => (summary, broken),
        // The last of it found no room: the file is readable up to there, as after any other end.
        Err(error @ RecorderError::Write { .. }) => {
            (RecorderSummary::default(), broken.or(Some(error.into())))
        }
        Err(error) => return Err(RunError::from(error).into()),
    };
    let ended = if broken.is_some() { Ended::Broken } else { ended };
    Ok(MethodRun {
        label: label(scenario, method),
        ended,
        calibration,
        navigation,
        recorder,
        watcher,
        truth,
        table,
        receipts: Vec::new(),
        twin: None,
        broken,
        kept,
        link,
        bench,
        cut_short,
    })
}

/// Parameters that a calibration is to estimate, where the plan says which.
#[must_use]
pub fn planned_of(plan: &scenario::Calibration) -> Vec<&'static str> {
    match &plan.estimator {
        core::Estimator::Kalman(_) => {
            (0..NAMES.len()).filter(|i| plan.estimates(Group::of(*i))).map(|i| NAMES[i]).collect()
        }
        core::Estimator::LeastSquares(_) | core::Estimator::ExternalTurntable(_) => Vec::new(),
    }
}

fn estimator_name(estimator: &core::Estimator) -> &'static str {
    match estimator {
        core::Estimator::Kalman(_) => "kalman",
        core::Estimator::LeastSquares(_) => "least-squares",
        core::Estimator::ExternalTurntable(_) => "external-turntable",
    }
}
