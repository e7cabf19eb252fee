//! One instance of a model: its life cycle.

use super::layout::{Layout, Slot};
use super::log::{Log, Outlet};
use super::mode::{self, Mode, Modes, Refusal, ServedStandard};
use super::models::Maker;
use super::run::{Experiment, Run};
use crate::table::Model;
use core::ffi::c_void;
use core::sync::atomic::{AtomicUsize, Ordering};
use octant_fmi::fmi3::IntermediateUpdate;

/// Slot of the time.
const TIME: usize = 0;

/// Options of FMI 3.0 at instantiation.
#[derive(Clone, Copy, Debug, Default)]
pub struct InstanceOptions {
    /// The importer handles events.
    pub event_mode_used: bool,
    /// A step may end before its time.
    pub early_return_allowed: bool,
    /// Callback between the periods of a step that has several.
    pub intermediate_update: Option<IntermediateUpdate>,
}

/// One instance.
#[derive(Debug)]
pub(super) struct Instance {
    standard: ServedStandard,
    maker: &'static Maker,
    layout: &'static Layout,
    pub(super) options: InstanceOptions,
    pub(super) outlet: Outlet,
    pub(super) log: Log,
    pub(super) run: Run,
    pub(super) snapshots: Snapshots,
    /// Outputs before a step, to find whether they change: reused memory.
    pub(super) before: Vec<u64>,
    /// Reason why the last step was discarded.
    pub(super) step_refused: String,
}

impl Instance {
    pub(super) fn new(
        standard: ServedStandard,
        maker: &'static Maker,
        options: InstanceOptions,
        outlet: Outlet,
        logging: bool,
    ) -> Self {
        let log = Log::new(standard, logging, outlet.callback.is_some());
        let layout = maker.layout();
        let run = Run::new(maker.model, layout);
        let (snapshots, before) = (Snapshots::default(), Vec::with_capacity(layout.outputs.len()));
        let step_refused = String::new();
        Self { standard, maker, layout, options, outlet, log, run, snapshots, before, step_refused }
    }

    #[inline]
    pub(super) fn standard(&self) -> ServedStandard {
        self.standard
    }

    pub(super) fn maker(&self) -> &'static Maker {
        self.maker
    }

    pub(super) fn model(&self) -> &'static Model {
        self.maker.model
    }

    pub(super) fn layout(&self) -> &'static Layout {
        self.layout
    }

    #[inline]
    pub(super) fn slots(&self) -> &'static [Slot] {
        &self.layout.slots
    }

    #[inline]
    pub(super) fn cells(&self) -> &[u64] {
        self.run.values.cells()
    }

    #[inline]
    pub(super) fn slots_and_cells(&mut self) -> (&'static [Slot], &mut [u64]) {
        (&self.layout.slots, self.run.values.cells_mut())
    }

    #[inline]
    pub(super) fn mode(&self) -> Mode {
        self.run.mode
    }

    /// Refuses a call that isn't allowed in the present mode.
    #[inline]
    pub(super) fn require(&self, modes: Modes) -> Result<(), Refusal> {
        if modes.has(self.run.mode) { Ok(()) } else { Err(self.not_now()) }
    }

    #[cold]
    fn not_now(&self) -> Refusal {
        let mode = self.run.mode;
        // Hosts show the last error, and rarely the discarded step before it.
        let why = match mode == Mode::StepFailed && !self.step_refused.is_empty() {
            true => format!(": {}", self.step_refused),
            false => String::new(),
        };
        Refusal::error(format!("not allowed now: {}{why}", mode.name()))
    }

    #[inline]
    pub(super) fn values_changed(&mut self) {
        self.run.stale = true;
    }

    /// Returns whether the outputs don't correspond to the values that were set.
    #[inline]
    pub(super) fn outputs_are_stale(&self) -> bool {
        self.run.mode == Mode::Initialization && self.run.stale
    }

    /// Value references of the inputs on which the variable with this one depends.
    pub(super) fn dependencies(&self, reference: u32) -> Result<Vec<u32>, Refusal> {
        let model = self.maker.model;
        if reference as usize == TIME {
            return Ok(Vec::new());
        }
        let found = model.with_slots().find(|(slot, _)| *slot == reference as usize);
        let (_, variable) = found.ok_or_else(|| {
            Refusal::error(format!(
                "{} has no variable with value reference {reference}",
                model.name
            ))
        })?;
        let first = |name: &&str| model.find(name).map(|(slot, _)| slot as u32);
        Ok(variable.depends_on.iter().filter_map(first).collect())
    }

    pub(super) fn setup_experiment(
        &mut self,
        start_s: f64,
        stop_s: Option<f64>,
    ) -> Result<(), Refusal> {
        self.require(mode::INSTANTIATED)?;
        if !start_s.is_finite() {
            return Err(Refusal::error(format!(
                "the start time is {start_s}, a finite number is expected"
            )));
        }
        if let Some(stop_s) = stop_s
            && !(stop_s >= start_s)
        {
            return Err(Refusal::error(format!(
                "the stop time is {stop_s} s, not before the start at {start_s} s is expected"
            )));
        }
        self.run.experiment = Experiment { announced: true, start_s, stop_s };
        Ok(())
    }

    pub(super) fn enter_initialization(&mut self) -> Result<(), Refusal> {
        self.require(mode::INSTANTIATED)?;
        if !self.run.experiment.announced {
            return Err(Refusal::error("fmi2SetupExperiment has to be called before"));
        }
        self.run.values.set_real(TIME, self.run.experiment.start_s);
        self.run.mode = Mode::Initialization;
        self.run.stale = true;
        Ok(())
    }

    pub(super) fn exit_initialization(&mut self) -> Result<(), Refusal> {
        self.require(mode::INITIALIZATION)?;
        if self.run.stale || self.run.component.is_none() {
            self.initialize()?;
        }
        self.run.tick = 0;
        self.run.mode = if self.options.event_mode_used { Mode::Event } else { Mode::Step };
        Ok(())
    }

    /// Makes the component, and its outputs, from the values.
    #[cold]
    pub(super) fn initialize(&mut self) -> Result<(), Refusal> {
        let made = (self.maker.initialize)(&mut self.run.values);
        self.run.component = Some(made.map_err(Refusal::error)?);
        self.run.stale = false;
        Ok(())
    }

    pub(super) fn terminate(&mut self) -> Result<(), Refusal> {
        self.require(mode::TERMINATE)?;
        if let Some(component) = &mut self.run.component {
            component.terminate(&mut self.run.values);
        }
        self.remark();
        self.run.mode = Mode::Terminated;
        Ok(())
    }

    pub(super) fn reset(&mut self) -> Result<(), Refusal> {
        self.require(mode::ALIVE)?;
        self.run = Run::new(self.maker.model, self.layout);
        Ok(())
    }

    /// Logs the component's remark, if there is one.
    #[inline]
    pub(super) fn remark(&mut self) {
        let remark = self.run.component.as_mut().and_then(|component| component.remark());
        if let Some(remark) = remark {
            self.log.say(octant_fmi::fmi2::OK, remark);
        }
    }

    /// Time reached, s.
    #[inline]
    pub(super) fn time_s(&self) -> f64 {
        self.run.values.real(TIME)
    }

    #[inline]
    pub(super) fn set_time(&mut self, time_s: f64) {
        self.run.values.set_real(TIME, time_s);
    }
}

/// Next name of a stored state. No name is given twice, so that the name of another instance's or
/// of a freed state is never valid.
static NEXT_NAME: AtomicUsize = AtomicUsize::new(1);

/// Stored states of an instance.
#[derive(Debug, Default)]
pub(super) struct Snapshots {
    pub(super) kept: Vec<(usize, Box<Run>)>,
}

impl Snapshots {
    pub(super) fn place(&self, name: *mut c_void) -> Result<usize, Refusal> {
        self.kept.iter().position(|(kept, _)| *kept == name.addr()).ok_or_else(|| {
            Refusal::error(if name.is_null() {
                "the FMU state is a null pointer"
            } else {
                "the FMU state isn't one of this instance, or has been freed"
            })
        })
    }

    pub(super) fn keep(&mut self, run: Run) -> *mut c_void {
        let name = NEXT_NAME.fetch_add(1, Ordering::Relaxed);
        self.kept.push((name, Box::new(run)));
        core::ptr::without_provenance_mut(name)
    }
}
