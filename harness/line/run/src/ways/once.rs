//! Runs one method of a scenario once, from its configuration to its scores.

use super::passes::{PassError, in_passes};
use super::realtime;
use crate::bench::attended::before_start;
use crate::bench::ended::Ended;
use crate::bench::error::{MethodError, SetupError};
use crate::bench::plan::Plan;
use crate::bench::recording::StreamKeeping;
use crate::bench::set_up::{Line, SetUp};
use crate::bench::{Bench, Records};
use crate::results::method::MethodRun;
use octant_base::control::Control;
use octant_calibration::config::{CoreConfig, Estimator};
use octant_endpoint::Endpoint;
use octant_fmu_bind::OpenedFmus;
use octant_plant::config::PlantConfig;
use octant_sample::{Epoch, GimbalCommand, Parameters, Truth};
use octant_scenario::{EndpointSpec, Method, Scenario};
use octant_source::configure::configurations;
use octant_source::{Source, SourceError};
use std::sync::atomic::Ordering;

/// The configuration of the core of a method, as a run has it.
///
/// # Errors
/// If it can't be made.
pub fn core_of(scenario: &Scenario, method: Method, seed: u64) -> Result<CoreConfig, MethodError> {
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
    as_far_as_it_goes(&Plan::of(scenario, method, seed, recording, control))?.whole()
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
    as_far_as_it_goes(&Plan::of(scenario, method, seed, recording, control))
}

/// Runs a plan as [`run_as_far_as_it_goes`].
pub(super) fn as_far_as_it_goes(plan: &Plan<'_>) -> Result<MethodRun, MethodError> {
    let Plan { scenario, method, seed, .. } = *plan;
    set_up(plan, SetUp::of(scenario, method, seed, &OpenedFmus::default())?)
}

/// Runs a plan whose method was set up.
pub(super) fn set_up(plan: &Plan<'_>, mut set_up: SetUp) -> Result<MethodRun, MethodError> {
    let Plan { scenario, control, .. } = *plan;
    if scenario.source.is_recorded() {
        set_up.settle(settled(scenario, &set_up.plant, &set_up.core)?);
    }
    // Set up before the session with a device begins: from then on the device waits for its first sample.
    let ready = plan.ready()?;
    // Before a port is opened and a table turns.
    if control.lost.load(Ordering::Relaxed) || !before_start(scenario, control)? {
        let never = |set_up: &mut SetUp, _: &Scenario| {
            Ok(Line { source: NeverBegun, endpoint: set_up.in_process()?, recorded: None })
        };
        let mut bench = Bench::open(plan, ready, set_up, never)?;
        bench.ended = Some(Ok(Ended::Cancelled));
        return MethodRun::scored(scenario, plan.method, bench.close()?);
    }
    let simulated =
        scenario.source.is_plant_alone() && matches!(scenario.endpoint, EndpointSpec::InProcess);
    if simulated {
        once(plan, Bench::open(plan, ready, set_up, SetUp::simulated)?)
    } else {
        let dither = plan.session.and_then(|session| session.dither);
        let opened = |set_up: &mut SetUp, scenario: &Scenario| {
            let Line { source, endpoint, recorded } = set_up.opened(scenario)?;
            Ok(Line { source: source.of_session(dither), endpoint, recorded })
        };
        once(plan, Bench::open(plan, ready, set_up, opened)?)
    }
}

/// Runs an open bench to its end, and scores it.
fn once<S: Source, E: Endpoint>(
    plan: &Plan<'_>,
    mut bench: Bench<S, E, Records<'_>>,
) -> Result<MethodRun, MethodError> {
    let Plan { scenario, method, .. } = *plan;
    if scenario.realtime.by_clock {
        realtime::run(&mut bench, &scenario.realtime, scenario.sample_period_ns);
    } else {
        bench.run();
    }
    MethodRun::scored(scenario, method, bench.close()?)
}

/// Source of a run that was ended before it began.
struct NeverBegun;

impl Source for NeverBegun {
    fn next(&mut self, _: &GimbalCommand, _: &mut Epoch) -> Result<bool, SourceError> {
        Ok(false)
    }

    fn truth(&self) -> Option<Truth> {
        None
    }

    fn samples_total(&self) -> Option<u64> {
        None
    }
}

/// Iterates a least-squares calibration on recorded samples. Least squares linearises about its
/// initial parameters, and a real instrument's errors can be large: the samples are passed
/// repeatedly until the parameters settle, and the recorded run is one more pass. Returns the initial parameters of
/// that pass, where they are others than those of `core`.
pub(super) fn settled(
    scenario: &Scenario,
    plant: &PlantConfig,
    core: &CoreConfig,
) -> Result<Option<Parameters>, MethodError> {
    let least_squares = core
        .calibration
        .as_ref()
        .is_some_and(|c| matches!(c.estimator, Estimator::LeastSquares(_)));
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
