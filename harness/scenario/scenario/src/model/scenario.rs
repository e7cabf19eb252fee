//! A checked scenario, in SI, with its faults.

use super::drive::Drive;
use super::endpoint::EndpointSpec;
use super::heading::{HeadingTestSpec, PowerCycle};
use super::motion::MotionSpec;
use super::procedure::{AlignmentSpec, CalibrationSpec, Method};
use super::source::SourceSpec;
use crate::error::Place;
use crate::reference::ReferenceSpec;
use crate::trajectory::SolutionLine;
use octant_base::display::DisplayUnits;
use octant_base::names::suggestion;
use octant_calibration::config as core;
use octant_earth::units::{DEG_PER_SQRT_HOUR, MICRO_G};
use octant_faults::station::FaultSpec;
use octant_faults::{FaultBuildError, Setup, Station};
use octant_plant::config as plant;
use octant_power::PowerPlan;
#[cfg(doc)]
use octant_sample::further::FurtherGroup;
use octant_sample::parameters::ParameterGroup;
use octant_toml_tree::{Node, Table, Value};
use std::path::PathBuf;

/// Noise of gyros, rad/√s, and of accelerometers, (m/s²)/√Hz, below which, both together, squares of normalized errors are
/// above 1.1 in the mean (`quiet_instruments` in `harness/support/test_loop`): the second where a sample is at most a sub-step of
/// the filter, and where it is longer.
const QUIET_GYRO: f64 = 1e-5 * DEG_PER_SQRT_HOUR;
const QUIET_ACCELEROMETER: [f64; 2] = [0.5 * MICRO_G, 1.5 * MICRO_G];
/// Longest sub-step of several samples, ns.
const SUB_STEP_NS: u64 = 50_000_000;

/// A fault of a scenario.
#[derive(Clone, Debug)]
pub struct Fault {
    /// Specification for the station.
    pub spec: FaultSpec,
    /// Epochs at which it is fired by hand, in order. Empty if its trigger isn't manual, or if nobody
    /// fires it.
    pub fires: Vec<u64>,
    /// Place in the scenario.
    pub place: Place,
}

/// A checked scenario, in SI. Random values are still distributions: see [`resolve`](crate::resolve).
#[derive(Clone, Debug)]
pub struct Scenario {
    /// Title of the run.
    pub title: String,
    /// Seed of every draw.
    pub seed: u64,
    /// Sample period, ns.
    pub sample_period_ns: u64,
    /// Rate of the samples as it is written, Hz: the period is this to a nanosecond.
    pub sample_rate_hz: f64,
    /// Place of the instrument.
    pub site: plant::PlantSite,
    /// Motion of the case.
    pub motion: MotionSpec,
    /// Noise densities and errors that the filter doesn't model; the parameters in it are zero until
    /// they are drawn.
    pub imu: plant::Imu,
    /// Distribution of each group of true parameters, in the order of [`ParameterGroup::ALL`].
    pub parameters: [ParameterDistribution; 7],
    /// Draws of the errors beside the parameters about those in `imu` and `site`, in the order of
    /// [`FurtherGroup::ALL`]; `None`: not drawn.
    pub further: [Option<ParameterDistribution>; 15],
    /// The two gimbals.
    pub turntable: plant::TurntableConfig,
    /// Real table with these gimbals, if there is one.
    pub drive: Option<Drive>,
    /// Alignment of the core.
    pub alignment: AlignmentSpec,
    /// Initial parameters of the core.
    pub initial_parameters: octant_sample::Parameters,
    /// Calibration, if there is one.
    pub calibration: Option<CalibrationSpec>,
    /// Second method, if there is one.
    pub baseline: Option<CalibrationSpec>,
    /// Reference during calibration.
    pub aiding: plant::AidingSource,
    /// Navigation after the calibration, if there is one.
    pub navigation: Option<core::NavigationPlan>,
    /// Heading test, if the run is one.
    pub heading_test: Option<HeadingTestSpec>,
    /// Screens and gates.
    pub screening: core::Screening,
    /// Faults, in the order in which they act.
    pub faults: Vec<Fault>,
    /// What a person does in the run, in the order of the scenario.
    pub operator: Vec<octant_operator::OperatorStep>,
    /// Limits that the results have to keep.
    pub requirements: Vec<RequirementSpec>,
    /// Decision rule for values near a limit.
    pub decision: octant_verdict::decision::Decision,
    /// Equipment of the bench.
    pub equipment: Vec<octant_verdict::equipment::Equipment>,
    /// Recording.
    pub record: RecordSpec,
    /// Source of the samples.
    pub source: SourceSpec,
    /// Noise that is added to the samples, in parts of the random walks.
    pub dither: Option<f64>,
    /// Reference of a source that brings none of its own.
    pub reference: Option<ReferenceSpec>,
    /// Place of the core.
    pub endpoint: EndpointSpec,
    /// What feeds the device of the endpoint, if it is switched.
    pub power: Option<PowerPlan>,
    /// Pacing by the clock.
    pub realtime: Realtime,
    /// Units of errors in report and terminal, at the scenario's site.
    pub display: DisplayUnits,
    /// Name of the scenario's file, for messages.
    pub file: String,
    /// Folder of the scenario, from which relative file names start.
    pub folder: PathBuf,
    /// Document with all defaults.
    pub(crate) document: Table,
}

/// Distribution of the true values of a parameter group, SI.
#[derive(Clone, Debug, PartialEq)]
pub enum ParameterDistribution {
    /// Normal with this standard deviation, independent for each entry.
    Normal(f64),
    /// Uniform between plus and minus this half width, independent for each entry.
    Uniform(f64),
    /// Given values.
    Constant(Vec<f64>),
}

/// A limit on a result, with its description in the scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct RequirementSpec {
    /// Check of the limit.
    pub check: octant_verdict::verdict::LimitCheck,
    /// Statement of the requirement, a sentence.
    pub text: String,
    /// Limit as written.
    pub limit_text: String,
    /// Document and clause of its origin.
    pub clause: Option<String>,
}

/// Recording of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordSpec {
    /// Number of samples between two records of truth, output and decimated samples.
    pub every_samples: u64,
    /// True if every sample is kept.
    pub full_samples: bool,
    /// Shortest time between two records of the parameters, ns.
    pub parameters_period_ns: u64,
    /// Shortest time between two messages on a topic for other tools, ns; `None` without these.
    pub topics_period_ns: Option<u64>,
}

/// Pacing of a run by the clock, and its limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Realtime {
    /// True if the run is paced by the clock.
    pub by_clock: bool,
    /// Lateness above which a sample is an overrun, ns.
    pub overrun_ns: u64,
    /// Number of permitted overruns.
    pub overruns: u64,
    /// Limit of the lateness of 99 % of the samples, ns.
    pub lateness_p99_ns: Option<u64>,
    /// Number of periods that may end without their answer.
    pub late_answers: u64,
    /// Silence after which an endpoint that owes an answer counts as gone, ns.
    pub silence_ns: u64,
    /// Requested priority of SCHED_FIFO.
    pub priority: Option<u8>,
    /// Processor to which the thread is pinned.
    pub cpu: Option<u16>,
    /// True to lock all memory of the process.
    pub lock_memory: bool,
    /// Part of each wait that is spent reading the clock, ns.
    pub spin_ns: u64,
}

/// Error of an id that no fault of a scenario has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no fault has the id {id:?}{}", known_faults(.id, .known))]
pub struct UnknownFault {
    /// The id.
    pub id: String,
    /// Ids of the scenario's faults.
    pub known: Vec<String>,
}

/// Ids to write instead of an unknown one, as the end of a message.
fn known_faults(id: &str, known: &[String]) -> String {
    if known.is_empty() {
        return ": the scenario has no [[faults]]".to_owned();
    }
    format!(", {}", suggestion(id, known.iter().map(String::as_str), "its faults"))
}

impl Scenario {
    /// Returns whether the filter of a method considers or estimates errors beside the parameters.
    #[must_use]
    pub fn has_further_states(&self, method: Method) -> bool {
        let calibration = match method {
            Method::Primary => &self.calibration,
            Method::Baseline => &self.baseline,
        };
        let estimator = calibration.as_ref().map(|calibration| &calibration.estimator);
        matches!(estimator, Some(core::Estimator::Kalman(of)) if of.further != core::Further::default())
    }

    /// Lists the methods that a run of the scenario has.
    pub fn methods(&self) -> impl Iterator<Item = Method> + use<> {
        let baseline = self.baseline.as_ref().map(|_| Method::Baseline);
        std::iter::once(Method::Primary).chain(baseline)
    }

    /// Makes the same scenario without its faults.
    #[must_use]
    pub fn without_faults(&self) -> Self {
        self.with_faults(|_| false)
    }

    /// Makes the same scenario with some of its faults, selected by their numbers from 0.
    #[must_use]
    pub fn with_faults(&self, keep: impl Fn(usize) -> bool) -> Self {
        let mut some = self.clone();
        let mut numbers = 0..;
        some.faults.retain(|_| numbers.next().is_some_and(&keep));
        if some.faults.is_empty() {
            some.document.remove("faults");
        } else if let Some(Node { value: Value::Array(entries), .. }) =
            some.document.get_mut("faults")
        {
            let mut numbers = 0..;
            entries.retain(|_| numbers.next().is_some_and(&keep));
        }
        some
    }

    /// Makes the same scenario with only the faults of these ids.
    ///
    /// # Errors
    /// If an id has no fault.
    pub fn with_only(&self, faults: &[String]) -> Result<Self, UnknownFault> {
        let ids: Vec<&str> = self.faults.iter().map(|fault| fault.spec.id.as_str()).collect();
        if let Some(unknown) = faults.iter().find(|id| !ids.contains(&id.as_str())) {
            let known = ids.iter().map(|id| (*id).to_owned()).collect();
            return Err(UnknownFault { id: unknown.clone(), known });
        }
        let keep: Vec<bool> = ids.iter().map(|id| faults.iter().any(|kept| kept == id)).collect();
        Ok(self.with_faults(|index| keep.get(index).copied().unwrap_or(false)))
    }

    /// The calibration of a method.
    #[must_use]
    pub fn calibration_of(&self, method: Method) -> Option<&CalibrationSpec> {
        match method {
            Method::Primary => self.calibration.as_ref(),
            Method::Baseline => self.baseline.as_ref(),
        }
    }

    /// Name of a method, as terminal, tables and reports show it.
    #[must_use]
    pub fn method_label(&self, method: Method) -> String {
        let Some(calibration) = self.calibration_of(method) else {
            return match &self.source {
                SourceSpec::Solution(spec) => format!("solution {}", spec.solution.file.short()),
                _ => "navigation alone".to_owned(),
            };
        };
        let estimator = match &calibration.estimator {
            core::Estimator::Kalman(_) => {
                let g = ParameterGroup::GDependent;
                if calibration.estimates(g) { "with G states" } else { "without G states" }
            }
            core::Estimator::LeastSquares(_) => "by least squares",
            core::Estimator::ExternalTurntable(_) => "on an external turntable",
        };
        let name = &calibration.name;
        // A name of the scenario is never that of a published sequence.
        match octant_calibration::positions::named(name) {
            Some(_) => format!("{name} positions {estimator}"),
            None => format!("{name} {estimator}"),
        }
    }

    /// Number of samples of the calibration phase.
    #[must_use]
    pub fn calibration_samples(&self) -> u64 {
        let duration_s = self.calibration.as_ref().map_or(0.0, |c| c.duration_s);
        self.samples_in(duration_s)
    }

    /// Number of samples in a time, as the core counts them.
    fn samples_in(&self, time_s: f64) -> u64 {
        ((time_s * 1e9).round() as u64).saturating_add(self.sample_period_ns / 2)
            / self.sample_period_ns
    }

    /// Number of samples of the whole procedure, with all run-ups of a heading test; `None` if navigation lasts until
    /// the source ends.
    #[must_use]
    pub fn samples(&self) -> Option<u64> {
        if let (SourceSpec::Solution(_), Some(test)) = (&self.source, &self.heading_test) {
            // The time of a solution's run is that with power.
            return Some(self.run_up_samples()? * u64::from(test.run_ups));
        }
        let last = self.power_cycles().last().map_or(0, |cycle| cycle.on_before - 1);
        Some(last + self.run_up_samples()?)
    }

    /// The port of a solution that comes while the run goes.
    #[must_use]
    pub fn solution_line(&self) -> Option<&SolutionLine> {
        match &self.source {
            SourceSpec::Solution(spec) => spec.line.as_ref(),
            _ => None,
        }
    }

    /// Time for which a solution is taken from its port, s, with the pauses of a heading test; `None` without an end.
    #[must_use]
    pub fn line_s(&self) -> Option<f64> {
        let duration_s = self.navigation.as_ref()?.duration_s?;
        Some(self.heading_test.as_ref().map_or(duration_s, |test| test.lasts_s(duration_s)))
    }

    /// Number of samples from switching on to the end of the navigation; `None` if it lasts until the source ends.
    #[must_use]
    pub fn run_up_samples(&self) -> Option<u64> {
        let navigation_s = match &self.navigation {
            None => 0.0,
            Some(plan) => plan.duration_s?,
        };
        Some(self.calibration_samples() + self.samples_in(navigation_s))
    }

    /// Lists document and clause of the requirements by their ids, where they have one.
    #[must_use]
    pub fn requirement_clauses(&self) -> std::collections::BTreeMap<String, String> {
        let clause = |r: &RequirementSpec| Some((r.check.id.clone(), r.clause.clone()?));
        self.requirements.iter().filter_map(clause).collect()
    }

    /// Lists the times without power between the run-ups of a heading test.
    #[must_use]
    pub fn power_cycles(&self) -> Vec<PowerCycle> {
        let (Some(test), Some(on)) = (&self.heading_test, self.run_up_samples()) else {
            return Vec::new();
        };
        if matches!(self.source, SourceSpec::Solution(_)) {
            return Vec::new();
        }
        let off = self.samples_in(test.off_s);
        let cycle = |number: u64| PowerCycle {
            off_before: number * on + (number - 1) * off + 1,
            on_before: number * (on + off) + 1,
        };
        (1..u64::from(test.run_ups)).map(cycle).collect()
    }

    /// Number of samples for which the source delivers references: those of the calibration, and through all of a test with
    /// several run-ups, each of which calibrates.
    pub(crate) fn reference_samples(&self) -> u64 {
        let several = self.heading_test.is_some_and(|test| test.run_ups > 1);
        let all = self.samples().filter(|_| several);
        all.unwrap_or_else(|| self.calibration_samples())
    }

    /// Time from switching on to the next switching on, s, of a test with several run-ups; `None` for another run.
    pub(crate) fn run_up_every_s(&self) -> Option<f64> {
        let second = self.power_cycles().first()?.on_before - 1;
        Some((second * self.sample_period_ns) as f64 * 1e-9)
    }

    /// Properties of a run that faults need.
    #[must_use]
    pub fn fault_setup(&self, seed: u64) -> Setup {
        Setup {
            seed,
            sample_period_ns: self.sample_period_ns,
            calibration_samples: self.calibration_samples(),
            angle_random_walk: self.imu.angle_random_walk,
            velocity_random_walk: self.imu.velocity_random_walk,
            turntable_rate_radps: self.turntable.rate_radps,
            id: String::new(),
        }
    }

    /// Station of a run with a seed; `None` without faults.
    ///
    /// # Errors
    /// If a fault can't be built, which doesn't happen for a scenario that was read.
    pub fn station(&self, seed: u64) -> Result<Option<Station>, (String, FaultBuildError)> {
        if self.faults.is_empty() {
            return Ok(None);
        }
        let specs: Vec<FaultSpec> = self.faults.iter().map(|fault| fault.spec.clone()).collect();
        Station::new(&specs, &self.fault_setup(seed)).map(Some)
    }

    /// Warnings before a run, which are no errors.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        use octant_faults::trigger::Trigger;
        let idle = |fault: &&Fault| {
            fault.spec.schedule.trigger == Trigger::Manual && fault.fires.is_empty()
        };
        let text = |fault: &Fault| {
            let id = &fault.spec.id;
            format!("fault {id:?} is fired by hand, and no --fire {id}=TIME does: it won't fire")
        };
        let faults = self.faults.iter().filter(idle).map(text);
        faults.chain(self.quiet()).collect()
    }

    /// Warning about sensors so quiet that the filter's σ are too small: its error model is linear, and what is of second
    /// order in errors of the size of Table 1 is more than such noise.
    fn quiet(&self) -> Option<String> {
        let calibrates = self
            .calibration
            .iter()
            .chain(&self.baseline)
            .any(|calibration| matches!(calibration.estimator, core::Estimator::Kalman(_)));
        let (gyro, accel) = (self.imu.angle_random_walk, self.imu.velocity_random_walk);
        let limit = QUIET_ACCELEROMETER[usize::from(self.sample_period_ns > SUB_STEP_NS)];
        let quiet = gyro < QUIET_GYRO && accel < limit;
        (calibrates && quiet && matches!(self.source, SourceSpec::Plant)).then(|| {
            format!(
                "imu.angle_random_walk and imu.velocity_random_walk: found {:.1e} deg/√h and {:.1e} ug/√Hz, both below \
                 {:.0e} deg/√h and {:.1} ug/√Hz: the filter is linear, and its σ are too small for what is of second order \
                 in errors of the size of Table 1",
                gyro / DEG_PER_SQRT_HOUR,
                accel / MICRO_G,
                QUIET_GYRO / DEG_PER_SQRT_HOUR,
                limit / MICRO_G
            )
        })
    }
}
