//! Records a run: rows of all connected inputs and all outputs.
//!
//! Row 0 is the state after initialization. Each later row holds the outputs at its time, and the
//! inputs with which the step to that time was made.

use super::convert::WireUnit;
use super::error::MasterError;
use super::requirements::{NamedSignal, Requiring};
use super::simulation::Simulation;
use super::system::{ExchangeSide, System, element_names};
use super::values::is_numeric;
use crate::single::output::{OutputColumn, Outputs, Sink, SinkError};
use octant_fmu_host::description::{Description, VariableType};
use std::io;
use std::path::Path;

/// Reasons why a row can't be recorded.
#[derive(Debug, thiserror::Error)]
pub enum RowError {
    /// An FMU failed when its outputs were read.
    #[error(transparent)]
    Master(#[from] MasterError),
    /// The file can't be written.
    #[error("write the recording: {0}")]
    Write(#[from] io::Error),
}

/// Writes rows into files.
pub struct RowRecorder {
    outputs: Outputs,
    numbers: Vec<f64>,
    sinks: Vec<Sink>,
    /// Number of steps between rows.
    every: u64,
    rows: u64,
    /// Requirements, which see every communication point.
    requiring: Requiring,
}

/// Columns of all nodes, each with its place among the numbers or the texts, and the number of all
/// numbers.
fn columns(system: &System, descriptions: &[&Description]) -> (Vec<OutputColumn>, usize) {
    let mut columns = Vec::new();
    let (mut place, mut texts) = (0, 0);
    for (node, description) in system.nodes.iter().zip(descriptions) {
        for side in [&node.inputs, &node.outputs, &node.watched] {
            columns.extend(of_side(&node.name, side, description, place));
            place += side.plan.elements;
        }
        for (number, group) in &node.written {
            let variable = &description.variables[*number];
            for (at, name) in element_names(description, variable).into_iter().enumerate() {
                columns.push(OutputColumn {
                    name: format!("{}.{name}", node.name),
                    kind: variable.kind,
                    place: texts + at,
                    unit: None,
                });
            }
            texts += group.elements;
        }
    }
    (columns, place)
}

/// Lists the recorded numbers of a system by their places, for requirements.
#[must_use]
pub fn signals(system: &System, descriptions: &[&Description]) -> Vec<NamedSignal> {
    let (columns, places) = columns(system, descriptions);
    let mut signals =
        vec![NamedSignal { name: String::new(), unit: None, kind: VariableType::Float64 }; places];
    for column in columns.into_iter().filter(|column| is_numeric(column.kind)) {
        let node = system.nodes.iter().zip(descriptions).find_map(|(node, description)| {
            let name = column.name.strip_prefix(&node.name)?.strip_prefix('.')?;
            let base = name.split('[').next().unwrap_or(name);
            let of = |name: &str| description.variable(name);
            Some((description, of(name).or_else(|| of(base))?))
        });
        let unit =
            node.and_then(|(description, variable)| WireUnit::of_variable(description, variable));
        if let Some(signal) = signals.get_mut(column.place) {
            *signal = NamedSignal { name: column.name, unit, kind: column.kind };
        }
    }
    signals
}

impl RowRecorder {
    /// Creates the files of these paths, `.mcap` or `.csv`.
    ///
    /// # Errors
    /// If a file can't be made.
    pub fn new(
        system: &System,
        descriptions: &[&Description],
        name: &str,
        paths: &[&Path],
        every: u64,
        requiring: Requiring,
    ) -> Result<Self, SinkError> {
        let (columns, place) = columns(system, descriptions);
        let numbers = vec![0.0; place];
        let outputs = Outputs {
            plan: octant_fmu_host::instance::AccessPlan::default(),
            texts: Vec::new(),
            columns,
            left_out: Vec::new(),
        };
        let sinks = paths.iter().map(|path| Sink::file(path, &outputs, name));
        let sinks = sinks.collect::<Result<_, _>>()?;
        Ok(Self { numbers, sinks, outputs, every, rows: 0, requiring })
    }

    /// Number of rows that were written.
    #[must_use]
    pub const fn rows(&self) -> u64 {
        self.rows
    }

    /// Lists the names of the columns except time.
    pub fn columns(&self) -> impl Iterator<Item = &str> {
        self.outputs.columns.iter().map(|column| column.name.as_str())
    }

    /// Returns the requirements, with the values at all points so far.
    #[must_use]
    pub const fn requiring(&self) -> &Requiring {
        &self.requiring
    }

    /// Writes a row if one is due at this step, or if it is the `last`.
    ///
    /// # Errors
    /// If an FMU fails, or a file can't be written.
    pub fn row(
        &mut self,
        simulation: &Simulation<'_>,
        system: &System,
        last: bool,
    ) -> Result<(), RowError> {
        let is_due = simulation.steps().is_multiple_of(self.every) || last;
        if !is_due && self.requiring.is_empty() {
            return Ok(());
        }
        let mut place = 0;
        let mut room = |elements: usize| {
            place += elements;
            place - elements..place
        };
        for (number, node) in system.nodes.iter().enumerate() {
            let inputs = room(node.inputs.plan.elements);
            self.numbers[inputs].copy_from_slice(simulation.inputs(number));
            let outputs = room(node.outputs.plan.elements);
            self.numbers[outputs].copy_from_slice(simulation.outputs(number));
            let watched = room(node.watched.plan.elements);
            self.numbers[watched].copy_from_slice(simulation.watched(number));
        }
        let time_s = simulation.time_s(simulation.steps());
        self.requiring.look(time_s, &self.numbers);
        if !is_due {
            return Ok(());
        }
        for sink in &mut self.sinks {
            sink.row(time_s, &self.outputs, &self.numbers, simulation.written())?;
        }
        self.rows += 1;
        Ok(())
    }

    /// Notes an event in the files that have a place for it.
    ///
    /// # Errors
    /// If a file can't be written.
    pub fn event(&mut self, time_s: f64, event: &octant_recorder::Event) -> io::Result<()> {
        self.sinks.iter_mut().try_for_each(|sink| sink.event(time_s, event))
    }

    /// Finishes the files.
    ///
    /// # Errors
    /// If one can't be written.
    pub fn finish(self) -> io::Result<()> {
        self.sinks.into_iter().try_for_each(Sink::finish)
    }
}

fn of_side(
    node: &str,
    side: &ExchangeSide,
    description: &Description,
    first: usize,
) -> Vec<OutputColumn> {
    let mut columns = Vec::new();
    for (number, range) in side.variables.iter().zip(&side.plan.places) {
        let variable = &description.variables[*number];
        for (name, place) in element_names(description, variable).into_iter().zip(range.clone()) {
            columns.push(OutputColumn {
                name: format!("{node}.{name}"),
                kind: variable.kind,
                place: first + place,
                unit: variable.unit.clone(),
            });
        }
    }
    columns
}
