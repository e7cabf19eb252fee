//! Data from which a simulation continues.

use super::layout::Layout;
use super::mode::Mode;
use super::models::AnyComponent;
use super::ticks::Clocked;
use crate::table::Model;
use crate::values::CellValues;

/// Simulation as announced by the importer.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Experiment {
    /// True once FMI 2.0's own call has announced it.
    pub announced: bool,
    pub start_s: f64,
    pub stop_s: Option<f64>,
}

/// Data from which a simulation continues: the content of an FMU state.
#[derive(Debug)]
pub(super) struct Run {
    pub mode: Mode,
    pub experiment: Experiment,
    pub values: CellValues,
    /// Exists from the end of initialization on, and during it once outputs were requested.
    pub component: Option<Box<dyn AnyComponent>>,
    /// True if values have changed since the component was made.
    pub stale: bool,
    /// Sample periods since the start.
    pub tick: u64,
    /// Clocks, and the variables that have a value only at their ticks.
    pub clocked: Clocked,
}

impl Run {
    pub(super) fn new(model: &Model, layout: &Layout) -> Self {
        Self {
            clocked: Clocked::new(layout),
            mode: Mode::Instantiated,
            experiment: Experiment::default(),
            values: CellValues::new(model),
            component: None,
            stale: true,
            tick: 0,
        }
    }
}

impl Clone for Run {
    fn clone(&self) -> Self {
        Self {
            mode: self.mode,
            experiment: self.experiment,
            values: self.values.clone(),
            component: self.component.as_ref().map(|component| component.boxed_clone()),
            stale: self.stale,
            tick: self.tick,
            clocked: self.clocked.clone(),
        }
    }
}
