//! Runs a short scenario with a fault and without it, epoch by epoch, as data for a picture of the
//! fault.

use crate::bench::Bench;
use crate::bench::error::MethodError;
use crate::bench::plan::Plan;
use crate::bench::recording::StreamKeeping;
use crate::bench::records::nobody;
use crate::bench::set_up::{Line, SetUp};
use octant_endpoint::{Endpoint, EndpointError, InProcess};
use octant_faults::Receipt;
use octant_fmu_bind::OpenedFmus;
use octant_sample::disturbance::Disturbed;
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{GimbalCommand, NoiseIntegral, Output, Parameters, Truth};
use octant_scenario::{Method, Scenario};
use octant_source::{Epoch, PlantSource, Source, SourceError};
use std::cell::RefCell;
use std::rc::Rc;

/// Events in one step of the source.
#[derive(Clone, Debug, Default)]
pub struct Step {
    /// Set point of the turntable.
    pub command: GimbalCommand,
    /// Epochs that reached the core.
    pub delivered: Vec<Epoch>,
    /// Last answer of the core; `None` where no epoch reached it.
    pub output: Option<Output>,
}

/// Both runs, step by step from the start.
#[derive(Clone, Debug)]
pub struct SideBySide {
    /// Steps without the faults.
    pub clean: Vec<Step>,
    /// Steps with the faults.
    pub faulted: Vec<Step>,
    /// Receipts of the faults.
    pub receipts: Vec<Receipt>,
}

/// Runs the first steps of a scenario with its faults and without.
///
/// # Errors
/// If a run can't be set up, or breaks off.
pub fn side_by_side(scenario: &Scenario, seed: u64, steps: u64) -> Result<SideBySide, MethodError> {
    let (clean, _) = watched(&scenario.without_faults(), seed, steps)?;
    let (faulted, receipts) = watched(scenario, seed, steps)?;
    Ok(SideBySide { clean, faulted, receipts })
}

type Steps = Rc<RefCell<Vec<Step>>>;

fn watched(
    scenario: &Scenario,
    seed: u64,
    steps: u64,
) -> Result<(Vec<Step>, Vec<Receipt>), MethodError> {
    let method = Method::Primary;
    let set_up = SetUp::of(scenario, method, seed, &OpenedFmus::default())?;
    let plan =
        Plan { trace: false, ..Plan::of(scenario, method, seed, StreamKeeping::None, nobody()) };
    let seen = Steps::default();
    let line = |set_up: &mut SetUp, _: &Scenario| {
        let source = PlantSource::new(&set_up.plant, steps)?;
        let source = WatchedSource { source, seen: Rc::clone(&seen) };
        let endpoint = WatchedEndpoint { endpoint: set_up.in_process()?, seen: Rc::clone(&seen) };
        Ok(Line { source, endpoint, recorded: None })
    };
    let mut bench = Bench::open(&plan, plan.ready()?, set_up, line)?;
    bench.run();
    let receipts = bench.faulted.as_ref().map_or_else(Vec::new, |all| all.station.receipts());
    bench.end()?;
    Ok((seen.take(), receipts))
}

/// Notes every step of the source.
struct WatchedSource {
    source: PlantSource,
    seen: Steps,
}

impl Source for WatchedSource {
    fn next(&mut self, command: &GimbalCommand, epoch: &mut Epoch) -> Result<bool, SourceError> {
        let more = self.source.next(command, epoch)?;
        if more {
            self.seen.borrow_mut().push(Step { command: *command, ..Step::default() });
        }
        Ok(more)
    }

    fn truth(&self) -> Option<Truth> {
        self.source.truth()
    }

    #[inline]
    fn truth_stands(&self) -> Option<bool> {
        self.source.truth_stands()
    }

    fn known_noise(&self) -> Option<NoiseIntegral> {
        self.source.known_noise()
    }

    fn temperature_c(&mut self) -> Result<Option<f64>, SourceError> {
        self.source.temperature_c()
    }

    fn samples_total(&self) -> Option<u64> {
        self.source.samples_total()
    }

    fn disturbed(&mut self) -> Option<&mut dyn Disturbed> {
        self.source.disturbed()
    }
}

/// Notes every epoch that reaches the core.
struct WatchedEndpoint {
    endpoint: InProcess,
    seen: Steps,
}

impl Endpoint for WatchedEndpoint {
    fn step(&mut self, epoch: &Epoch, output: &mut Output) -> Result<(), EndpointError> {
        self.endpoint.step(epoch, output)?;
        if let Some(step) = self.seen.borrow_mut().last_mut() {
            step.delivered.push(*epoch);
            step.output = Some(*output);
        }
        Ok(())
    }

    fn feels(&self) -> bool {
        self.endpoint.feels()
    }

    fn feel(&mut self, temperature_c: f64) {
        self.endpoint.feel(temperature_c);
    }

    fn uri(&self) -> String {
        self.endpoint.uri()
    }

    fn restart(&mut self, offset: Option<&Parameters>) -> Result<(), EndpointError> {
        self.endpoint.restart(offset)
    }

    fn parameters(&self) -> ParameterEstimate {
        self.endpoint.parameters()
    }
}
