//! What decides how a run begins, its state between two steps, and what a calibration leaves open.
//!
//! Equal beginnings give equal runs until a fault sets in. Runs that differ by their navigation alone have the
//! calibration in common.

use super::done::PlannedWork;
use super::drive::{Ended, RunError, Steps};
use super::faulted::Faulted;
use super::in_time::{CONTROL_EPOCHS, InTime};
use super::watch::Watcher;
use octant_base::control::Control;
use octant_calibration::config::{CoreConfig, NavigationPlan};
use octant_calibration::state_machine::CoreConfigError;
use octant_endpoint::{InProcess, Tells};
use octant_faults::catalogue::Acts;
use octant_plant::config::PlantConfig;
use octant_scenario::resolve::DrawnValues;
use octant_scenario::{EndpointSpec, Method, Scenario};
use octant_source::configure::configurations;
use octant_source::{PlantSource, Source};

/// One of the runs.
#[derive(Clone, Copy, Debug)]
pub struct BranchPlan<'a> {
    /// Its scenario.
    pub scenario: &'a Scenario,
    /// Method.
    pub method: Method,
    /// Seed.
    pub seed: u64,
    /// Progress, and the request to end it.
    pub control: &'a Control,
}

/// Everything that decides a run but its faults: equal beginnings give equal runs.
#[derive(Debug, PartialEq)]
pub(super) struct Beginning {
    pub(super) plant: PlantConfig,
    pub(super) core: CoreConfig,
    pub(super) samples: u64,
    pub(super) work: PlannedWork,
}

/// Returns what decides a run but its faults; `None` if it can't be divided.
pub(super) fn beginning(plan: &BranchPlan<'_>) -> Option<(Beginning, DrawnValues)> {
    let BranchPlan { scenario, method, seed, .. } = plan;
    let elsewhere = |acts| matches!(acts, Acts::Host | Acts::Wire | Acts::Power);
    let divisible = scenario.source.is_plant_alone()
        && matches!(scenario.endpoint, EndpointSpec::InProcess)
        && !scenario.realtime.by_clock
        && scenario.operator.is_empty()
        && !scenario.faults.iter().any(|fault| elsewhere(fault.spec.kind.acts));
    if !divisible {
        return None;
    }
    // What can't be set up says so when it runs alone.
    let (plant, core, draws) = configurations(scenario, *method, *seed).ok()?;
    let samples = scenario.samples()?;
    let work = PlannedWork::of(scenario, *method, &core, Tells::ALL, None);
    Some((Beginning { plant, core, samples, work }, draws))
}

/// State of a run after a step.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    pub(super) source: PlantSource,
    pub(super) endpoint: InProcess,
    pub(super) steps: Steps,
    pub(super) watcher: Watcher,
    pub(super) revision: u32,
    /// How the trunk ended; `None`: it goes on.
    pub(super) ended: Option<Ended>,
}

/// The part of a run after its calibration.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ahead {
    navigation: Option<NavigationPlan>,
    samples: u64,
    work: PlannedWork,
}

impl Ahead {
    pub(super) fn of(beginning: &Beginning) -> Self {
        let Beginning { core, samples, work, .. } = beginning;
        Self { navigation: core.navigation.clone(), samples: *samples, work: work.clone() }
    }
}

impl Beginning {
    /// Returns whether the runs are the same up to the end of a calibration.
    pub(super) fn calibrates_as(&self, other: &Self) -> bool {
        let calibration = |core: &CoreConfig| CoreConfig { navigation: None, ..core.clone() };
        self == other
            || self.core.calibration.is_some()
                && self.plant == other.plant
                && calibration(&self.core) == calibration(&other.core)
    }
}

/// Returns whether the next step of a run without faults ends the calibration.
pub(super) fn ends_calibration_next(endpoint: &InProcess, steps: &Steps) -> bool {
    steps.number() + 1 == endpoint.core().calibration_samples()
}

impl Parts {
    /// Sets what comes after the calibration, which hasn't ended yet.
    pub(super) fn turn_to(self, ahead: &Ahead) -> Result<Self, CoreConfigError> {
        let Self { source, mut endpoint, mut steps, mut watcher, revision, ended } = self;
        endpoint.plan_navigation(ahead.navigation.clone())?;
        steps.last(ahead.samples);
        watcher.done.plan(ahead.work.clone());
        Ok(Self {
            source: source.lasting(ahead.samples),
            endpoint,
            steps,
            watcher,
            revision,
            ended,
        })
    }
}

/// Returns whether a fault sets in at the next step; by hand too.
pub(super) fn is_due(faulted: &Faulted, steps: &Steps, source: &PlantSource) -> bool {
    let next = steps.number() + 1;
    faulted.fires.iter().any(|(at, _)| *at == next)
        || faulted.station.sets_in_next(steps.output(), || source.truth())
}

/// A run on its way.
pub(super) type Going<'a, 'b> =
    (&'a mut PlantSource, &'a mut InProcess, &'a mut InTime<'b>, &'a mut Steps);

/// Takes steps until a fault sets in at the next one; returns the end, where the run ends before.
pub(super) fn until_due(
    (source, endpoint, keeper, steps): Going<'_, '_>,
    faulted: &mut Faulted,
    other: &Control,
) -> Result<Option<Ended>, RunError> {
    loop {
        if is_due(faulted, steps, source) {
            return Ok(None);
        }
        if steps.number().is_multiple_of(CONTROL_EPOCHS) {
            // The end of the other one is asked for together with that of this one.
            _ = other.look(steps.number());
        }
        if let Some(ended) = steps.step(source, faulted, endpoint, keeper)? {
            return Ok(Some(ended));
        }
    }
}
