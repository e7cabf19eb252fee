//! One method, a step at a time, with parts that others made.
//!
//! A host program holds a [`SteppedRun`] and decides when the next sample is due. Source, unit under
//! test and faults may be its own ([`Parts`]). Each step is that of every [`Bench`], so a run
//! of the harness's own parts has the same stream hash as any other.
//!
//! In a block, the unit gets many samples at once. That is possible where its commands are known
//! before: a command from sample k is felt in sample k + 2. [`SteppedRun::ahead`] makes the samples from
//! the announced commands on a copy of the source and of the faults; [`SteppedRun::play`] then takes the
//! steps with the unit's answers, and finds every sample that isn't the one that the unit got.

use super::once::settled;
use crate::bench::ended::RunError;
use crate::bench::error::{MethodError, SetupError};
use crate::bench::faulted::Behind;
use crate::bench::host::RunHost;
use crate::bench::interfere::{Functions, Interfered, Interferes};
use crate::bench::plan::{Looks, Plan};
use crate::bench::recording::StreamKeeping;
use crate::bench::set_up::{Line, SetUp};
use crate::bench::{Bench, noted};
use crate::results::method::MethodRun;
use octant_endpoint::{AnyEndpoint, Conclusion, Endpoint, EndpointError};
use octant_faults::station::Delivered;
use octant_fmu_bind::OpenedFmus;
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{Epoch, GimbalCommand, Output, Parameters, Truth};
use octant_scenario::{Method, Scenario};
use octant_source::{AnySource, Source};

/// Parts of a run that the host program made, in place of the scenario's.
#[derive(Default)]
pub struct Parts {
    /// Source of the samples.
    pub source: Option<Box<dyn Source + Send>>,
    /// Unit under test, with its name.
    pub unit: Option<(String, Box<dyn Endpoint + Send>)>,
    /// Faults after those of the scenario, in order.
    pub faults: Vec<Box<dyn Interferes + Send>>,
}

impl std::fmt::Debug for Parts {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Parts")
            .field("source", &self.source.is_some())
            .field("unit", &self.unit.as_ref().map(|(name, _)| name))
            .field("faults", &self.faults.len())
            .finish()
    }
}

/// A run of one method between two steps.
pub struct SteppedRun {
    scenario: Scenario,
    method: Method,
    bench: Bench<AnySource, AnyEndpoint>,
    functions: Functions,
    unit: Option<String>,
}

impl std::fmt::Debug for SteppedRun {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SteppedRun").field("steps", &self.bench.steps).finish_non_exhaustive()
    }
}

/// Reasons why a block can't be made.
#[derive(Debug, thiserror::Error)]
pub enum AheadError {
    /// The source has no copy that goes ahead.
    #[error(
        "make a block of samples: only the simulated plant can go ahead; step by step it works"
    )]
    Source,
    /// The faults can't be copied.
    #[error("make a block of samples: {0} acts step by step alone")]
    Fault(String),
    /// The copy failed.
    #[error(transparent)]
    Run(#[from] RunError),
}

impl SteppedRun {
    /// Sets up a method of a scenario with a seed and with parts that others made. `fmus` are FMUs that are opened or
    /// get opened.
    ///
    /// # Errors
    /// If it can't be set up, as [`crate::run_method`].
    pub fn new(
        scenario: &Scenario,
        method: Method,
        seed: u64,
        recording: StreamKeeping<'_>,
        parts: Parts,
        fmus: &OpenedFmus,
    ) -> Result<Self, MethodError> {
        if let Some(step) = scenario.operator.first() {
            return Err(SetupError::Unattended { id: step.id.clone() }.into());
        }
        let mut set_up = SetUp::of(scenario, method, seed, fmus)?;
        let Parts { source: foreign, unit, faults } = parts;
        if scenario.source.is_recorded() && foreign.is_none() {
            set_up.settle(settled(scenario, &set_up.plant, &set_up.core)?);
        }
        let control = crate::bench::records::nobody();
        let plan = Plan {
            trace: !scenario.faults.is_empty(),
            looks: Looks::Always,
            ..Plan::of(scenario, method, seed, recording, control)
        };
        let (name, unit) = unit.unzip();
        let line = |set_up: &mut SetUp, scenario: &Scenario| {
            let (recorded, source) = match foreign {
                Some(source) => (source.samples_planned(), source.into()),
                None => {
                    let source = set_up.source(scenario)?;
                    let recorded = source.as_ref().and_then(|source| source.samples_planned());
                    let plant = || Ok::<_, SetupError>(set_up.plant_source(scenario)?.into());
                    (recorded, source.map_or_else(plant, Ok)?)
                }
            };
            let endpoint = match unit {
                Some(unit) => unit.into(),
                None => match set_up.endpoint(scenario)? {
                    Some(endpoint) => endpoint,
                    None => set_up.in_process()?.into(),
                },
            };
            Ok(Line { source, endpoint, recorded })
        };
        let mut bench = Bench::open(&plan, plan.ready()?, set_up, line)?.under_nobody();
        let functions = Functions::new(faults);
        if !functions.is_empty() {
            bench.end_with_source();
        }
        Ok(Self { scenario: scenario.clone(), method, bench, functions, unit: name })
    }

    /// Takes one step; `false` if the run is over, after a failure too. [`Self::finish`] tells how it
    /// ended.
    pub fn step(&mut self) -> bool {
        let Bench { source, endpoint, faulted, steps, keeper, ended, .. } = &mut self.bench;
        let mut faults = Interfered { faulted: faulted.as_mut(), functions: &mut self.functions };
        ended.is_none() && noted(steps.step(source, &mut faults, endpoint, keeper), ended)
    }

    /// Makes the next samples as the unit gets them if its answers have these commands, one for each
    /// sample; fewer where the source ends. The run itself doesn't move.
    ///
    /// # Errors
    /// If source or faults can't go ahead.
    pub fn ahead(&mut self, commands: &[GimbalCommand]) -> Result<Vec<Epoch>, AheadError> {
        if !self.functions.is_empty() {
            return Err(AheadError::Fault("a fault that is a function".to_owned()));
        }
        let bench = &self.bench;
        let mut source = bench.source.ahead().ok_or(AheadError::Source)?;
        let mut station = bench.faulted.as_ref().map(|faulted| faulted.station.clone());
        let mut output = *bench.output();
        let mut epochs = Vec::with_capacity(commands.len());
        let mut epoch = Epoch::default();
        let (mut host, mut nobody) = (RunHost::default(), Nobody);
        for next in commands {
            let mut command = output.gimbal_command;
            if let Some(station) = &mut station {
                let mut world = Behind(&mut *source, &mut nobody, &mut host);
                station.before(&mut command, &output, &mut world);
            }
            if !source.next(&command, &mut epoch).map_err(RunError::from)? {
                break;
            }
            let delivered = station.as_mut().map(|station| {
                let mut world = Behind(&mut *source, &mut nobody, &mut host);
                station.after(&epoch, &output, &mut world).delivered
            });
            match delivered {
                None | Some(Delivered::Untouched) => epochs.push(epoch),
                // The place of a lost or repeated sample shifts all later ones.
                Some(Delivered::These([one])) => epochs.push(*one),
                Some(Delivered::These(_)) => break,
            }
            output.gimbal_command = *next;
        }
        Ok(epochs)
    }

    /// Takes the steps of a block with the answers to its epochs; estimates of parameters come with
    /// the place of their output. Returns the number of steps taken: all of them, or up to the end.
    pub fn play(
        &mut self,
        epochs: &[Epoch],
        outputs: &[Output],
        estimates: Vec<(usize, ParameterEstimate)>,
    ) -> usize {
        let Bench { source, endpoint, faulted, steps, keeper, ended, .. } = &mut self.bench;
        let last = endpoint.parameters();
        let mut answers = Answers { epochs, outputs, estimates: estimates.into(), next: 0, last };
        while answers.next < epochs.len().min(outputs.len()) && ended.is_none() {
            let mut faults =
                Interfered { faulted: faulted.as_mut(), functions: &mut self.functions };
            noted(steps.step(source, &mut faults, &mut answers, keeper), ended);
        }
        answers.next
    }

    /// Epoch that the source delivered in the last step.
    #[must_use]
    pub fn epoch(&self) -> &Epoch {
        self.bench.epoch()
    }

    /// Last answer of the unit.
    #[must_use]
    pub fn output(&self) -> &Output {
        self.bench.output()
    }

    /// Parameters as of the last answer.
    #[must_use]
    pub fn parameters(&self) -> ParameterEstimate {
        self.bench.endpoint.parameters()
    }

    /// Truth at the last epoch, where the source knows it.
    #[must_use]
    pub fn truth(&self) -> Option<Truth> {
        self.bench.source.truth()
    }

    /// Number of steps so far.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.bench.steps.number()
    }

    /// Scenario of the run.
    #[must_use]
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// Ends the run, and scores it. A run that isn't over counts as interrupted.
    ///
    /// # Errors
    /// If source, unit or recorder failed in a way that leaves no result.
    pub fn finish(self) -> Result<MethodRun, MethodError> {
        let Self { scenario, method, bench, functions, unit } = self;
        let mut run = MethodRun::scored(&scenario, method, bench.close()?)?;
        run.receipts.extend(functions.receipts());
        if let Some(name) = unit {
            run.label = format!("{name}, a unit of the host program");
        }
        Ok(run)
    }
}

/// Answers of a block.
struct Answers<'a> {
    epochs: &'a [Epoch],
    outputs: &'a [Output],
    estimates: std::collections::VecDeque<(usize, ParameterEstimate)>,
    next: usize,
    last: ParameterEstimate,
}

/// Name of a block in messages.
const BLOCK: &str = "block";

impl Endpoint for Answers<'_> {
    fn step(&mut self, epoch: &Epoch, output: &mut Output) -> Result<(), EndpointError> {
        let gone = |reason: String| EndpointError::Gone { uri: BLOCK.to_owned(), reason };
        let (Some(sent), Some(answer)) = (self.epochs.get(self.next), self.outputs.get(self.next))
        else {
            return Err(gone(format!("a fault delivered more than {} samples", self.epochs.len())));
        };
        if !sent.same_bits(epoch) {
            return Err(gone(format!(
                "sample {} isn't the one that the unit got in its block: its commands weren't those \
                 announced, or a fault looks at answers; step by step both work",
                epoch.sample.sequence
            )));
        }
        *output = *answer;
        if let Some((_, estimate)) = self.estimates.pop_front_if(|(place, _)| *place == self.next) {
            self.last = estimate;
        }
        self.next += 1;
        Ok(())
    }

    fn uri(&self) -> String {
        BLOCK.to_owned()
    }

    fn restart(&mut self, _: Option<&Parameters>) -> Result<(), EndpointError> {
        let reason = "a unit restarts step by step, not in a block".to_owned();
        Err(EndpointError::Restart { uri: BLOCK.to_owned(), reason })
    }

    fn parameters(&self) -> ParameterEstimate {
        self.last
    }
}

/// Endpoint of samples that are made ahead: no unit has them yet.
struct Nobody;

impl Endpoint for Nobody {
    fn step(&mut self, _: &Epoch, _: &mut Output) -> Result<(), EndpointError> {
        Err(EndpointError::Gone { uri: BLOCK.to_owned(), reason: "it has no unit".to_owned() })
    }

    fn uri(&self) -> String {
        BLOCK.to_owned()
    }

    fn restart(&mut self, _: Option<&Parameters>) -> Result<(), EndpointError> {
        Ok(())
    }

    fn parameters(&self) -> ParameterEstimate {
        let sigma = [f64::NAN; octant_sample::parameters::PARAMETER_COUNT];
        ParameterEstimate { revision: 0, parameters: Parameters::default(), sigma }
    }

    fn conclusion(&mut self) -> Conclusion {
        Conclusion::default()
    }
}
