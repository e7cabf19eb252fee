//! What decides how a run begins, and what a calibration leaves open.
//!
//! Equal beginnings give equal runs until a fault sets in. Runs that differ by their navigation alone have the
//! calibration in common.

use crate::bench::plan::Plan;
use crate::bench::set_up::SetUp;
use crate::bench::{Bench, Records};
use crate::observers::done::PlannedWork;
use octant_calibration::config::{CoreConfig, NavigationPlan};
use octant_calibration::state_machine::CoreConfigError;
use octant_endpoint::{InProcess, Tells};
use octant_faults::catalogue::Acts;
use octant_plant::config::PlantConfig;
use octant_scenario::EndpointSpec;
use octant_scenario::resolve::DrawnValues;
use octant_source::PlantSource;
use octant_source::configure::configurations;

/// A run of plant and core in this process, which can be divided.
pub(super) type Simulated<'a> = Bench<PlantSource, InProcess, Records<'a>>;

/// Everything that decides a run but its faults: equal beginnings give equal runs.
#[derive(Debug, PartialEq)]
pub(super) struct Beginning {
    plant: PlantConfig,
    core: CoreConfig,
    samples: u64,
    work: PlannedWork,
}

/// Returns what decides a run but its faults, and its drawn values; `None` if it can't be divided.
pub(super) fn beginning(plan: &Plan<'_>) -> Option<(Beginning, DrawnValues)> {
    let Plan { scenario, method, seed, .. } = *plan;
    let elsewhere = |acts| matches!(acts, Acts::Host | Acts::Wire | Acts::Power);
    let divisible = scenario.source.is_plant_alone()
        && matches!(scenario.endpoint, EndpointSpec::InProcess)
        && !scenario.realtime.by_clock
        && scenario.operator.is_empty()
        // Readings and power cycles of a heading test belong to one run.
        && scenario.heading_test.is_none()
        && !scenario.faults.iter().any(|fault| elsewhere(fault.spec.kind.acts));
    if !divisible {
        return None;
    }
    // What can't be set up says so when it runs alone.
    let (plant, core, draws) = configurations(scenario, method, seed).ok()?;
    let samples = scenario.samples()?;
    let work = PlannedWork::of(scenario, method, &core, Tells::ALL, None);
    Some((Beginning { plant, core, samples, work }, draws))
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

    /// Sets what comes after the calibration of a run, which hasn't ended yet.
    pub(super) fn turn<'a>(
        &self,
        mut bench: Simulated<'a>,
    ) -> Result<Simulated<'a>, CoreConfigError> {
        bench.endpoint.plan_navigation(self.navigation.clone())?;
        bench.steps.last(self.samples);
        bench.keeper.observers.done.plan(self.work.clone());
        Ok(Bench { source: bench.source.lasting(self.samples), ..bench })
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

    /// Its configurations, as a method that is set up.
    pub(super) fn set_up(&self, draws: &DrawnValues) -> SetUp {
        SetUp::configured(self.plant.clone(), self.core.clone(), draws.clone())
    }
}
