//! One method, a step at a time, with parts that others made.
//!
//! A host program holds a [`SteppedRun`] and decides when the next sample is due. Source, unit under
//! test and faults may be its own ([`Parts`]). Each step is the one of [`drive`](super::drive), so a run
//! of the harness's own parts has the same stream hash as any other.
//!
//! In a block, the unit gets many samples at once. That is possible where its commands are known
//! before: a command from sample k is felt in sample k + 2. [`SteppedRun::ahead`] makes the samples from
//! the announced commands on a copy of the source and of the faults; [`SteppedRun::play`] then takes the
//! steps with the unit's answers, and finds every sample that isn't the one that the unit got.

use super::done::PlannedWork;
use super::drive::{Books, Ended, RunError, Steps};
use super::error::{MethodError, SetupError};
use super::faulted::{Behind, Faulted};
use super::host::RunHost;
use super::in_time::InTime;
use super::interfere::{Functions, Interfered, Interferes};
use super::method::{self, MethodRun};
use super::recording::StreamKeeping;
use super::recording::recorder_options;
use super::set_up::SetUp;
use super::watch::Watcher;
use octant_base::control::Control;
use octant_endpoint::{Conclusion, Endpoint, EndpointError, InProcess, Tells};
use octant_faults::station::Delivered;
use octant_fmu_bind::OpenedFmus;
use octant_recorder::{Recorder, RecorderOptions, RecorderTrouble};
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{Epoch, GimbalCommand, Output, Parameters, Truth};
use octant_scenario::resolve::DrawnValues;
use octant_scenario::{Method, Scenario};
use octant_score::trace::RunTrace;
use octant_source::{PlantSource, Source};

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
    source: Box<dyn Source + Send>,
    faulted: Option<Faulted>,
    functions: Functions,
    endpoint: Box<dyn Endpoint + Send>,
    unit: Option<String>,
    recorder: Recorder,
    watcher: Watcher,
    truth: Option<DrawnValues>,
    control: Control,
    steps: Steps,
    names: Vec<(String, String)>,
    revision: u32,
    ended: Option<Result<Ended, RunError>>,
}

impl std::fmt::Debug for SteppedRun {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SteppedRun").field("steps", &self.steps).finish_non_exhaustive()
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
    /// If it can't be set up, as [`super::run_method`].
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
        if scenario.source.is_recorded() && parts.source.is_none() {
            set_up.settle(method::settled(scenario, &set_up.plant, &set_up.core)?);
        }
        let trouble = RecorderTrouble::default();
        let mut faulted = method::faulted(scenario, seed)?;
        if let Some(faulted) = &mut faulted {
            faulted.host = RunHost::new(scenario, &recording, &trouble)?;
        }
        let foreign_source = parts.source.is_some();
        let source: Box<dyn Source + Send> = match parts.source {
            Some(source) => source,
            None => match set_up.source(scenario)? {
                Some(source) => Box::new(source),
                None => {
                    let samples = scenario.samples().unwrap_or(u64::MAX);
                    Box::new(PlantSource::new(&set_up.plant, samples).map_err(SetupError::Plant)?)
                }
            },
        };
        let (unit, endpoint): (Option<String>, Box<dyn Endpoint + Send>) = match parts.unit {
            Some((name, unit)) => (Some(name), unit),
            None => match set_up.endpoint(scenario)? {
                Some(endpoint) => (None, Box::new(endpoint)),
                None => (None, Box::new(InProcess::new(&set_up.core).map_err(SetupError::Core)?)),
            },
        };
        let SetUp { core, draws, .. } = set_up;
        let tells = if unit.is_some() { Tells::ALL } else { endpoint.tells() };
        let told = (source.has_true_parameters(), tells);
        let options =
            RecorderOptions { trouble, ..recorder_options(scenario, seed, &draws, method, told) };
        let recorder = recording.start(&options).map_err(SetupError::Recorder)?;
        let recorded = source
            .samples_planned()
            .filter(|_| foreign_source || !scenario.source.is_plant_alone());
        let mut watcher = Watcher::new(PlannedWork::of(scenario, method, &core, tells, recorded));
        watcher.trace = (!scenario.faults.is_empty()).then(RunTrace::new);
        method::charts(&mut watcher, scenario, method, recording);
        let functions = Functions::new(parts.faults);
        let injects = faulted.is_some() || !functions.is_empty();
        let total = source.samples_total().filter(|_| injects);
        let names = faulted.iter().flat_map(|faulted| faulted.station.names());
        let names = names.map(|(id, kind)| (id.to_owned(), kind.to_owned())).collect();
        Ok(Self {
            scenario: scenario.clone(),
            method,
            source,
            faulted,
            functions,
            endpoint,
            unit,
            recorder,
            watcher,
            truth: told.0.then(|| draws.clone()),
            control: Control::default(),
            steps: Steps::new(total),
            names,
            revision: 0,
            ended: None,
        })
    }

    /// Takes one step; `false` if the run is over, after a failure too. [`Self::finish`] tells how it
    /// ended.
    pub fn step(&mut self) -> bool {
        let mut endpoint = std::mem::replace(&mut self.endpoint, Box::new(Nobody));
        let goes_on = self.step_with(&mut *endpoint);
        self.endpoint = endpoint;
        goes_on
    }

    fn step_with(&mut self, endpoint: &mut (dyn Endpoint + Send)) -> bool {
        if self.ended.is_some() {
            return false;
        }
        let names = std::mem::take(&mut self.names);
        let books = Books { recorder: &mut self.recorder, watcher: &mut self.watcher, names };
        let control = &self.control;
        let mut keeper =
            InTime { books, control, look_every: 1, revision: self.revision, attended: None };
        let faulted = self.faulted.as_mut();
        let mut faults = Interfered { faulted, functions: &mut self.functions };
        let stepped = self.steps.step(&mut *self.source, &mut faults, endpoint, &mut keeper);
        self.revision = keeper.revision;
        self.names = keeper.books.names;
        match stepped {
            Ok(None) => true,
            Ok(Some(ended)) => {
                self.ended = Some(Ok(ended));
                false
            }
            Err(error) => {
                self.ended = Some(Err(error));
                false
            }
        }
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
        let mut source = self.source.ahead().ok_or(AheadError::Source)?;
        let mut station = self.faulted.as_ref().map(|faulted| faulted.station.clone());
        let mut output = *self.steps.output();
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
        let last = self.endpoint.parameters();
        let mut answers = Answers { epochs, outputs, estimates: estimates.into(), next: 0, last };
        while answers.next < epochs.len().min(outputs.len()) && self.step_with(&mut answers) {}
        answers.next
    }

    /// Epoch that the source delivered in the last step.
    #[must_use]
    pub fn epoch(&self) -> &Epoch {
        self.steps.epoch()
    }

    /// Last answer of the unit.
    #[must_use]
    pub fn output(&self) -> &Output {
        self.steps.output()
    }

    /// Parameters as of the last answer.
    #[must_use]
    pub fn parameters(&self) -> ParameterEstimate {
        self.endpoint.parameters()
    }

    /// Truth at the last epoch, where the source knows it.
    #[must_use]
    pub fn truth(&self) -> Option<Truth> {
        self.source.truth()
    }

    /// Number of steps so far.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.steps.number()
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
    pub fn finish(mut self) -> Result<MethodRun, MethodError> {
        let driven = self.ended.take().unwrap_or(Ok(Ended::Cancelled));
        if let Some(faulted) = &self.faulted {
            faulted.last_words().into_iter().for_each(|event| self.recorder.event(event));
        }
        let books = (&mut self.recorder, &mut self.watcher);
        let (source, endpoint) = (&mut *self.source, &mut *self.endpoint);
        let closed = method::close((driven, None), source, endpoint, books, &self.control)?;
        let faulted = self.faulted.map_or_else(Vec::new, |faulted| faulted.station.receipts());
        let receipts = faulted.into_iter().chain(self.functions.receipts()).collect();
        let (scenario, method) = (&self.scenario, self.method);
        let (recorder, watcher) = (self.recorder, self.watcher);
        let run = method::finish(scenario, method, closed, recorder, watcher, self.truth.as_ref())?;
        let label = match self.unit {
            Some(name) => format!("{name}, a unit of the host program"),
            None => run.label.clone(),
        };
        Ok(MethodRun { receipts, label, ..run })
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

/// Endpoint in the place of one that is in use.
struct Nobody;

impl Endpoint for Nobody {
    fn step(&mut self, _: &Epoch, _: &mut Output) -> Result<(), EndpointError> {
        Err(EndpointError::Gone { uri: BLOCK.to_owned(), reason: "it is in use".to_owned() })
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
