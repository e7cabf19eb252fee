//! Runs one method of a scenario, from its configuration to its scores.

pub use super::error::{MethodError, SetupError, core_problem};
pub use super::planned::planned_of;
pub use super::recording::StreamKeeping;

use super::aligned::{self, uncertainty_of};
use super::at_rest::AtRest;
use super::attended::{Attended, before_start};
use super::done::PlannedWork;
use super::drive::{Ended, Line, RunError};
use super::faulted::Faulted;
use super::filtered::FilteredSeries;
use super::host::RunHost;
use super::in_time::drive_attended;
use super::planned::estimator_name;
use super::realtime::{self, TimeKeeping};
use super::recording::recorder_options;
use super::set_up::SetUp;
use super::watch::Watcher;
use crate::passes::{PassError, in_passes};
use octant_base::control::Control;
use octant_base::interrupt;
use octant_calibration::config as core;
use octant_calibration::table::CalibrationTable;
use octant_endpoint::{Conclusion, Endpoint, EndpointError, InProcess, Tells};
use octant_faults::Receipt;
use octant_fmu_bind::OpenedFmus;
use octant_recorder::event::{BenchRecord, LinkRecord, PowerRecord};
use octant_recorder::{
    Event, Recorder, RecorderError, RecorderOptions, RecorderSummary, RecorderTrouble, concluded,
};
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{Mode, Output, Parameters};
use octant_scenario::resolve::DrawnValues;
use octant_scenario::{Method, Realtime, Scenario};
use octant_score::parameters::{nees, score, score_further, worst_normalized_error};
use octant_score::summary::{
    AlignmentResult, CalibrationScore, HeightChannel, NavigationScore, SolutionScore,
};
use octant_score::trace::RunTrace;
use octant_source::configure::configurations;
use octant_source::{PlantSource, Source, SourceError};
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// Result of one method.
#[derive(Debug)]
pub struct MethodRun {
    /// Name of the method, as in "eight positions with G".
    pub label: String,
    /// End of the loop.
    pub ended: Ended,
    /// Result of the alignment; `None` if the unit never had an attitude.
    pub alignment: Option<AlignmentResult>,
    /// Result of the calibration.
    pub calibration: Option<CalibrationScore>,
    /// Result of the navigation.
    pub navigation: Option<NavigationScore>,
    /// Summary of the recorder.
    pub recorder: RecorderSummary,
    /// Observations of the run.
    pub watcher: Watcher,
    /// True parameters, where the source knows them.
    pub truth: Option<Parameters>,
    /// The calibration table, where the calibration was accepted.
    pub table: Option<CalibrationTable>,
    /// Receipts of the faults, in the order of the scenario.
    pub receipts: Vec<Receipt>,
    /// Twin run: the same run without its faults.
    pub twin: Option<Arc<MethodRun>>,
    /// Failure in the middle that ended the run.
    pub broken: Option<RunError>,
    /// Time keeping of a run by the clock.
    pub kept: Option<TimeKeeping>,
    /// Device and traffic of a run over a wire; as in the recording.
    pub link: Option<Box<LinkRecord>>,
    /// Clocks and counts of a real instrument and its table; as in the recording.
    pub bench: Option<Box<BenchRecord>>,
    /// Switchings of the device's power; as in the recording.
    pub power: Option<Box<PowerRecord>>,
    /// Description of the point where the source ended in the middle of something.
    pub cut_short: Option<String>,
}

/// The configuration of the core of a method, as a run has it.
///
/// # Errors
/// If it can't be made.
pub fn core_of(
    scenario: &Scenario,
    method: Method,
    seed: u64,
) -> Result<core::CoreConfig, MethodError> {
    let (plant, mut core, _) = configurations(scenario, method, seed).map_err(SetupError::from)?;
    if scenario.source.is_recorded()
        && let Some(parameters) = settled(scenario, &plant, &core)?
    {
        core.initial_parameters = parameters;
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
    recording: StreamKeeping<'_>,
    control: &Control,
) -> Result<MethodRun, MethodError> {
    whole(run_as_far_as_it_goes(scenario, method, seed, recording, control)?)
}

/// Takes a run that broke in the middle for an error.
pub(super) fn whole(mut run: MethodRun) -> Result<MethodRun, MethodError> {
    match run.broken.take() {
        None => Ok(run),
        Some(error) => Err(error.into()),
    }
}

/// Runs as [`run_method`]. If source, endpoint or the disk of the recording go away in the middle,
/// the run ends there, states the failure, and its recording is complete up to that point.
///
/// # Errors
/// If it can't be set up, a file can't be read to its end, or the recorder fails otherwise.
pub fn run_as_far_as_it_goes(
    scenario: &Scenario,
    method: Method,
    seed: u64,
    recording: StreamKeeping<'_>,
    control: &Control,
) -> Result<MethodRun, MethodError> {
    let set_up = SetUp::of(scenario, method, seed, &OpenedFmus::default())?;
    run_set_up(scenario, (method, seed), set_up, recording, control)
}

/// Runs as [`run_as_far_as_it_goes`] a method that was set up.
pub(super) fn run_set_up(
    scenario: &Scenario,
    (method, seed): (Method, u64),
    mut set_up: SetUp,
    recording: StreamKeeping<'_>,
    control: &Control,
) -> Result<MethodRun, MethodError> {
    if scenario.source.is_recorded() {
        set_up.settle(settled(scenario, &set_up.plant, &set_up.core)?);
    }
    let trouble = RecorderTrouble::default();
    let mut faulted = faulted(scenario, seed)?;
    if let Some(faulted) = &mut faulted {
        // Set up before the session with a device begins: from then on the device waits for its
        // first sample.
        faulted.host = RunHost::new(scenario, &recording, &trouble)?;
    }
    // Before a port is opened and a table turns.
    let begins = !control.lost.load(Ordering::Relaxed) && before_start(scenario, control)?;
    let opened = if begins { set_up.source(scenario)? } else { None };
    let elsewhere = if begins { set_up.endpoint(scenario)? } else { None };
    let SetUp { plant, core, draws, .. } = set_up;
    let true_parameters = opened.as_ref().map_or(begins, |source| source.has_true_parameters());
    let tells = elsewhere.as_ref().map_or(Tells::ALL, |endpoint| endpoint.tells());
    let told = (true_parameters, tells);
    let options =
        RecorderOptions { trouble, ..recorder_options(scenario, seed, &draws, method, told) };
    let mut recorder = recording.start(&options).map_err(SetupError::Recorder)?;
    let recorded = opened.as_ref().and_then(|source| source.samples_planned());
    let plan = PlannedWork::of(scenario, method, &core, tells, recorded);
    let mut watcher = Watcher::new(plan);
    let compared = match recording {
        StreamKeeping::HashAlone => false,
        StreamKeeping::Hash => true,
        StreamKeeping::File(_) | StreamKeeping::None => !scenario.faults.is_empty(),
    };
    watcher.trace = compared.then(RunTrace::new);
    charts(&mut watcher, scenario, method, recording);
    let samples = scenario.samples().unwrap_or(u64::MAX);
    let realtime =
        scenario.realtime.by_clock.then_some((&scenario.realtime, scenario.sample_period_ns));
    let attended = Attended::of(scenario, method, control);
    let closed = match (opened, elsewhere) {
        _ if !begins => {
            let mut source = PlantSource::new(&plant, samples).map_err(SetupError::Plant)?;
            let mut endpoint = InProcess::new(&core).map_err(SetupError::Core)?;
            let books = (&mut recorder, &mut watcher);
            close((Ok(Ended::Cancelled), None), &mut source, &mut endpoint, books, control)?
        }
        // Statically dispatched: this loop processes ten million samples a second.
        (None, None) => {
            let mut source = PlantSource::new(&plant, samples).map_err(SetupError::Plant)?;
            let mut endpoint = InProcess::new(&core).map_err(SetupError::Core)?;
            let faulted = faulted.as_mut();
            let line = Line { source: &mut source, faulted, endpoint: &mut endpoint };
            to_the_end(realtime, line, (&mut recorder, &mut watcher), control, attended)?
        }
        (opened, elsewhere) => {
            let mut source = match opened {
                Some(source) => source,
                None => PlantSource::new(&plant, samples).map_err(SetupError::Plant)?.into(),
            };
            let mut endpoint = match elsewhere {
                Some(endpoint) => endpoint,
                None => InProcess::new(&core).map_err(SetupError::Core)?.into(),
            };
            let faulted = faulted.as_mut();
            let line = Line { source: &mut source, faulted, endpoint: &mut endpoint };
            to_the_end(realtime, line, (&mut recorder, &mut watcher), control, attended)?
        }
    };
    let receipts = faulted.map_or_else(Vec::new, |faulted| faulted.station.receipts());
    let truth = true_parameters.then_some(&draws);
    let run = finish(scenario, method, closed, recorder, watcher, truth)?;
    Ok(MethodRun { receipts, ..run })
}

/// Switches on what only the report shows, for a run that has one: a run with a recording.
pub(super) fn charts(
    watcher: &mut Watcher,
    scenario: &Scenario,
    method: Method,
    recording: StreamKeeping<'_>,
) {
    if matches!(recording, StreamKeeping::File(_)) {
        watcher.filtered = FilteredSeries::of(scenario, method);
        // Both methods have the same instrument.
        watcher.at_rest = (method == Method::Primary).then(|| Box::new(AtRest::of(scenario)));
    }
}

/// State at the end of a loop.
pub(super) struct Closed {
    ended: Ended,
    broken: Option<RunError>,
    /// Answer to the end of the source.
    last: Option<Output>,
    conclusion: Conclusion,
    estimate: ParameterEstimate,
    kept: Option<TimeKeeping>,
    link: Option<Box<LinkRecord>>,
    bench: Option<Box<BenchRecord>>,
    power: Option<Box<PowerRecord>>,
    cut_short: Option<String>,
}

/// Drives to the end or a failure, and asks the core for its conclusion.
fn to_the_end<S: Source, E: Endpoint>(
    realtime: Option<(&Realtime, u64)>,
    line: Line<'_, S, E>,
    (recorder, watcher): (&mut Recorder, &mut Watcher),
    control: &Control,
    attended: Option<Attended<'_>>,
) -> Result<Closed, RunError> {
    let Line { source, faulted, endpoint } = line;
    let line = Line { source: &mut *source, faulted, endpoint: &mut *endpoint };
    let (driven, kept) = match realtime {
        None => (drive_attended(line, recorder, watcher, control, attended), None),
        Some(settings) => {
            let books = (&mut *recorder, &mut *watcher);
            let (driven, kept) = realtime::drive_attended(settings, line, books, control, attended);
            (driven, Some(kept))
        }
    };
    close((driven, kept), source, endpoint, (recorder, watcher), control)
}

/// Ends source and endpoint after the loop, and asks the core for its conclusion.
pub(super) fn close<S: Source + ?Sized, E: Endpoint + ?Sized>(
    (driven, kept): (Result<Ended, RunError>, Option<TimeKeeping>),
    source: &mut S,
    endpoint: &mut E,
    (recorder, watcher): (&mut Recorder, &mut Watcher),
    control: &Control,
) -> Result<Closed, RunError> {
    // Moving equipment is stopped first.
    let broken = driven.as_ref().err().map(ToString::to_string);
    let (bench, stopped) = source.conclude(broken.as_deref());
    let driven = match stopped {
        None => driven,
        Some(error) => driven.and(Err(error.into())),
    };
    let cut_short = source.cut_short();
    if let Some(detail) = &bench {
        recorder.event(Event::Bench(detail.clone()));
    }
    let told = control.attendance.get().map_or_else(Vec::new, |attendance| attendance.told());
    for record in
        told.iter().filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok())
    {
        recorder.event(Event::Operator(record));
    }
    let driven = driven.and_then(|ended| match ended {
        Ended::SourceEnded => Ok((ended, endpoint.end_of_stream()?)),
        _ => Ok((ended, None)),
    });
    if let Err(RunError::Endpoint(EndpointError::Misbehaved(misbehaviour))) = &driven {
        watcher.misbehaved.get_or_insert_with(|| misbehaviour.clone());
    }
    let (ended, last, broken) = match driven {
        // Errors that came while the run was being stopped after a misbehaviour aren't its cause.
        _ if watcher.misbehaved.is_some() => (Ended::Misbehaved, None, None),
        Ok((Ended::Cancelled, _)) if is_lost(control, watcher) => (Ended::Lost, None, None),
        Ok((ended, last)) => (ended, last, None),
        // An interrupt stopped the moving equipment without waiting for the run.
        Err(error)
            if error.is_gone() && (control.cancel.load(Ordering::Relaxed) || interrupt::seen()) =>
        {
            (Ended::Cancelled, None, None)
        }
        Err(error) if error.is_gone() => {
            recorder.event(Event::Error { reason: error.to_string() });
            (Ended::Broken, None, Some(error))
        }
        Err(error) => return Err(error),
    };
    let mut conclusion = endpoint.conclusion();
    let link = conclusion.events.iter().find_map(|event| match event {
        Event::Link(link) => Some(link.clone()),
        _ => None,
    });
    let power = conclusion.events.iter().find_map(|event| match event {
        Event::Power(power) => Some(power.clone()),
        _ => None,
    });
    conclusion.events.drain(..).for_each(|event| recorder.event(event));
    let estimate = endpoint.parameters();
    // The core is ended last, so that a failure there loses nothing that it has told.
    let (ended, broken) = match endpoint.close() {
        Err(error)
            if broken.is_none() && !matches!(ended, Ended::Misbehaved | Ended::Cancelled) =>
        {
            recorder.event(Event::Error { reason: error.to_string() });
            (Ended::Broken, Some(error.into()))
        }
        _ => (ended, broken),
    };
    Ok(Closed { ended, broken, last, conclusion, estimate, kept, link, bench, power, cut_short })
}

/// Returns whether a run that was stopped was stopped because its bench is lost, or was in an earlier run.
fn is_lost(control: &Control, watcher: &Watcher) -> bool {
    let here = control.stop_when_lost.load(Ordering::Relaxed) && watcher.bench_broke.is_some();
    (here || control.lost.load(Ordering::Relaxed)) && !control.cancel.load(Ordering::Relaxed)
}

/// Builds the station of a scenario, with a host without targets; `None` without faults.
pub fn faulted(scenario: &Scenario, seed: u64) -> Result<Option<Faulted>, SetupError> {
    let station = scenario
        .station(seed)
        .map_err(|(id, error)| SetupError::Fault { id, reason: error.to_string() })?;
    let mut fires: Vec<(u64, String)> = (scenario.faults.iter())
        .flat_map(|fault| fault.fires.iter().map(|at| (*at, fault.spec.id.clone())))
        .collect();
    fires.sort_unstable();
    Ok(station.map(|station| Faulted { station, fires, host: RunHost::default() }))
}

/// Iterates a least-squares calibration on recorded samples. Least squares linearises about its
/// initial parameters, and a real instrument's errors can be large: the samples are passed
/// repeatedly until the parameters settle, and the recorded run is one more pass. Returns the initial parameters of
/// that pass, where they are others than those of `core`.
pub(super) fn settled(
    scenario: &Scenario,
    plant: &octant_plant::config::PlantConfig,
    core: &core::CoreConfig,
) -> Result<Option<Parameters>, MethodError> {
    let least_squares = core
        .calibration
        .as_ref()
        .is_some_and(|c| matches!(c.estimator, core::Estimator::LeastSquares(_)));
    if !least_squares {
        return Ok(None);
    }
    let open = || match octant_source::open(scenario, plant)? {
        Some(source) => Ok(source),
        None => Err(SourceError::Read {
            path: "source.uri".to_owned(),
            reason: "a file is expected here".to_owned(),
        }),
    };
    let passes = in_passes(core, open).map_err(|error| match error {
        PassError::Config(error) => MethodError::Setup(SetupError::Core(error)),
        PassError::Run(error) => MethodError::Run(error),
    })?;
    Ok(passes.core.table().map(|_| *passes.core.parameters()))
}

/// Scores the observations and closes the recording.
pub(super) fn finish(
    scenario: &Scenario,
    method: Method,
    closed: Closed,
    mut recorder: Recorder,
    mut watcher: Watcher,
    truth: Option<&DrawnValues>,
) -> Result<MethodRun, MethodError> {
    let Closed { ended, broken, last, conclusion, estimate, kept, link, bench, power, cut_short } =
        closed;
    if let Some(output) = last {
        watcher.last_parameters = Some(estimate);
        // No sample belongs to this output: the recording stores the parameters as an event.
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
        recorder.event(Event::Refused { reason: reason.clone() });
    }
    let (_, done) = watcher.work();
    let calibration = match method {
        Method::Primary => scenario.calibration.as_ref(),
        Method::Baseline => scenario.baseline.as_ref(),
    }
    .map(|plan| {
        let known = truth.map(|draws| &draws.parameters);
        let parameters = score(known, &estimate.parameters, &estimate.sigma);
        let all = truth.map(|draws| scenario.true_further(draws));
        let further = score_further(all.as_ref(), conclusion.further.as_ref());
        let mut health = watcher.health.counts().clone();
        health.measurements = conclusion.measurements.unwrap_or(health.measurements);
        let nis_mean = conclusion.nis_mean.or(watcher.health.nis_mean());
        let uncertainty = conclusion.solution.as_ref().map(uncertainty_of);
        CalibrationScore {
            reference: Some(aligned::calibration_reference(scenario, &plan.estimator)),
            solution: watcher
                .calibrated
                .as_ref()
                .map(|point| SolutionScore::of(point, uncertainty.as_ref())),
            positions: plan.name.clone(),
            estimator: estimator_name(&plan.estimator).to_owned(),
            duration_h: done.calibration_s.unwrap_or(plan.duration_s) / 3600.0,
            nis_mean: nis_mean.filter(|nis| nis.is_finite()),
            nis_expected: conclusion.nis_expected,
            nees: nees(&parameters, &further),
            worst_normalized_error: worst_normalized_error(&parameters, &planned_of(plan)),
            parameters,
            further,
            refused: refused.clone(),
            refusal_explained: Vec::new(),
            health,
            sigma_hours: watcher
                .filtered
                .as_mut()
                .map_or_else(Vec::new, FilteredSeries::take_sigma),
        }
    });
    let navigation = match watcher.drift() {
        Some(drift) => Some(drift.finish(HeightChannel::Held).map_err(RunError::from)?),
        None => None,
    };
    let table = conclusion.table;
    let (recorder, broken) = match recorder.finish() {
        Ok(summary) => (summary, broken),
        // The end of the recording found no space: the file is readable up to there, as after any
        // other end.
        Err(error @ RecorderError::Write { .. }) => {
            (RecorderSummary::default(), broken.or(Some(error.into())))
        }
        Err(error) => return Err(RunError::from(error).into()),
    };
    let ended = if broken.is_some() { Ended::Broken } else { ended };
    Ok(MethodRun {
        label: scenario.method_label(method),
        ended,
        alignment: aligned::alignment(scenario, &watcher),
        calibration,
        navigation,
        recorder,
        watcher,
        truth: truth.map(|draws| draws.parameters),
        table,
        receipts: Vec::new(),
        twin: None,
        broken,
        kept,
        link,
        bench,
        power,
        cut_short,
    })
}
