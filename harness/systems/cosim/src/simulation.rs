//! Steps FMUs together: transfers, steps, and the treatment of a refused step.
//!
//! Step n goes from communication point n − 1 to point n, which is at start + n · step. In Jacobi
//! order all transfers of a step come first, and every FMU steps from the values at point n − 1. In
//! Gauss-Seidel order an FMU's transfers come just before its step: from the FMUs before it in the
//! order it gets values of point n.
//!
//! If an FMU discards a step, all FMUs return to their states at its beginning, and the step is
//! made in parts: up to the time that the FMU reached and on from there, or in halves, and these
//! again in halves. Values are transferred between the parts; faults don't advance until the step
//! is complete.

mod ends;
mod refused;
mod saved;
mod settings;

pub use settings::{Abilities, EventCounts, SteppingSettings};

use super::error::{MasterError, is_refusal};
use super::faults::Faulting;
use super::initialize::{Initializer, Loop};
use super::system::{ExchangeSide, NumberPath, System};
use super::tuning::{TunedResult, Tuning};
use super::values::{carried, number_of};
use octant_faults::connection::ConnectionStation;
use octant_fmu_host::instance::{Instance, InstanceError, StepOutcome, Stepped};

/// FMUs that run together.
pub struct Simulation<'a> {
    system: &'a System,
    settings: &'a SteppingSettings,
    instances: Vec<Box<dyn Instance>>,
    abilities: Vec<Abilities>,
    /// Faults on wires; elements are the numbers of the wires.
    faulting: Option<Faulting>,
    inputs: Vec<Vec<f64>>,
    outputs: Vec<Vec<f64>>,
    /// Outputs at the beginning of a part.
    before: Vec<Vec<f64>>,
    /// Wires into each FMU.
    into: Vec<Vec<usize>>,
    /// Wires that have faults.
    faulted: Vec<bool>,
    /// The step in which each wire was transferred last.
    transferred: Vec<u64>,
    /// Value that each input got at the beginning of the step.
    delivered: Vec<f64>,
    /// Ends of the remaining parts of a step.
    ends: Vec<f64>,
    /// Saved states, one for each FMU, while a part is made.
    states: Vec<u64>,
    rolls_back: bool,
    /// Steps done.
    step: u64,
    /// Number of faults that were triggered by hand so far.
    fired: usize,
    /// Changes of parameters in the order of their times, and the number of those that were made.
    tunings: Vec<Tuning>,
    tuned: usize,
    counts: Vec<EventCounts>,
    /// Number of parts of steps that were repeated.
    rejected: u64,
    loops: Vec<Loop>,
    /// First time at which each wire's output was no number.
    no_number_since_s: Vec<Option<f64>>,
    /// Values that were no numbers on all wires so far.
    no_numbers: u64,
    /// Outputs that are texts, and bytes as hexadecimal digits, in the order of the FMUs.
    written: Vec<String>,
}

/// Result of an attempt at a step, or at a part of one.
enum Attempt {
    Done { ended_by: Option<usize> },
    Discarded { node: usize, reached_s: f64 },
}

impl<'a> Simulation<'a> {
    /// Creates a simulation of FMUs that are instantiated and have their parameters, in the order
    /// of the system's nodes.
    #[must_use]
    pub fn new(
        system: &'a System,
        settings: &'a SteppingSettings,
        instances: Vec<Box<dyn Instance>>,
        abilities: Vec<Abilities>,
        faulting: Option<Faulting>,
    ) -> Self {
        let nodes = &system.nodes;
        let numbers = |side: fn(&super::system::SystemNode) -> &ExchangeSide| -> Vec<Vec<f64>> {
            nodes.iter().map(|node| vec![0.0; side(node).plan.elements]).collect()
        };
        let read = |node: &super::system::SystemNode| {
            vec![0.0; node.outputs.plan.elements + node.watched.plan.elements]
        };
        let outputs: Vec<Vec<f64>> = nodes.iter().map(read).collect();
        let mut into = vec![Vec::new(); nodes.len()];
        for (number, wire) in system.wires.iter().enumerate() {
            into[wire.to.node].push(number);
        }
        let wires = system.wires.len();
        let has_fault =
            |wire: usize| faulting.as_ref().is_some_and(|faulting| faulting.station.is_on(wire));
        let able = |of: fn(&Abilities) -> bool| abilities.iter().all(of);
        Self {
            inputs: numbers(|node| &node.inputs),
            before: outputs.clone(),
            outputs,
            into,
            faulted: (0..wires).map(has_fault).collect(),
            transferred: vec![0; wires],
            delivered: vec![0.0; wires],
            ends: Vec::new(),
            states: Vec::with_capacity(nodes.len()),
            rolls_back: able(|one| one.state) && able(|one| one.variable_step),
            step: 0,
            fired: 0,
            tunings: Vec::new(),
            tuned: 0,
            counts: vec![EventCounts::default(); nodes.len()],
            rejected: 0,
            loops: Vec::new(),
            no_number_since_s: vec![None; wires],
            no_numbers: 0,
            written: Vec::new(),
            system,
            settings,
            instances,
            abilities,
            faulting,
        }
    }

    /// Returns the time of a communication point, s, as a product: a sum would accumulate rounding
    /// errors.
    #[must_use]
    pub fn time_s(&self, point: u64) -> f64 {
        self.settings.start_s + point as f64 * self.settings.step_s
    }

    /// Steps done.
    #[must_use]
    pub const fn steps(&self) -> u64 {
        self.step
    }

    /// Returns the values that connected inputs got at the beginning of the last step, in the order
    /// of the wires.
    #[must_use]
    pub fn delivered(&self) -> &[f64] {
        &self.delivered
    }

    /// Returns the numbers of the connected inputs of an FMU.
    #[must_use]
    pub fn inputs(&self, node: usize) -> &[f64] {
        &self.inputs[node]
    }

    /// Returns the numbers of the connected outputs of an FMU.
    #[must_use]
    pub fn outputs(&self, node: usize) -> &[f64] {
        &self.outputs[node][..self.system.nodes[node].outputs.plan.elements]
    }

    /// Returns the numbers of the unconnected outputs of an FMU.
    #[must_use]
    pub fn watched(&self, node: usize) -> &[f64] {
        &self.outputs[node][self.system.nodes[node].outputs.plan.elements..]
    }

    /// Returns the outputs that are texts, and bytes as hexadecimal digits, as they were read last, in
    /// the order of the FMUs.
    #[must_use]
    pub fn written(&self) -> &[String] {
        &self.written
    }

    /// Returns the outputs that were no numbers and went into inputs: the wire, and the first time, s.
    pub fn no_numbers(&self) -> impl Iterator<Item = (&NumberPath, f64)> {
        let since = self.system.wires.iter().zip(&self.no_number_since_s);
        since.filter_map(|(wire, since_s)| Some((wire, (*since_s)?)))
    }

    /// Returns the loops that were found in the initialization.
    #[must_use]
    pub fn loops(&self) -> &[Loop] {
        &self.loops
    }

    /// Returns the counts of each FMU.
    #[must_use]
    pub fn counts(&self) -> &[EventCounts] {
        &self.counts
    }

    /// Number of parts of steps that were repeated because an FMU discarded them.
    #[must_use]
    pub const fn rejected(&self) -> u64 {
        self.rejected
    }

    /// Gives the simulation its changes of parameters, in the order of their times.
    pub fn tune_at(&mut self, tunings: Vec<Tuning>) {
        self.tunings = tunings;
    }

    /// Returns the changes of parameters.
    pub fn tunings(&self) -> impl Iterator<Item = &TunedResult> {
        self.tunings.iter().map(|tuning| &tuning.told)
    }

    /// Returns the changes of parameters with their values.
    pub(super) fn changes(&self) -> &[Tuning] {
        &self.tunings
    }

    /// Returns the faults.
    pub fn station(&mut self) -> Option<&mut ConnectionStation> {
        self.faulting.as_mut().map(|faulting| &mut faulting.station)
    }

    /// Returns the instances.
    pub fn instances(&mut self) -> &mut [Box<dyn Instance>] {
        &mut self.instances
    }

    fn failed(&self, node: usize, time_s: f64) -> impl Fn(InstanceError) -> MasterError + use<> {
        let node = self.system.nodes[node].name.clone();
        move |error| MasterError::Instance { node: node.clone(), time_s, error }
    }

    /// Initializes all FMUs; returns the index of one that requests the end of the simulation.
    ///
    /// # Errors
    /// If one fails, or a loop can't be solved.
    pub fn initialize(&mut self) -> Result<Option<usize>, MasterError> {
        let settings = self.settings;
        let start_s = settings.start_s;
        let stop_s = Some(self.time_s(settings.steps));
        for node in 0..self.instances.len() {
            let entered =
                self.instances[node].enter_initialization(start_s, stop_s, settings.tolerance);
            entered.map_err(self.failed(node, start_s))?;
        }
        let initializer = Initializer {
            system: self.system,
            instances: &mut self.instances,
            inputs: &mut self.inputs,
            outputs: &mut self.outputs,
            start_s,
        };
        self.loops = initializer.run(&settings.loops)?;
        self.carry_texts(None, start_s)?;
        let mut ended_by = None;
        for node in 0..self.instances.len() {
            let ended = self.instances[node].exit_initialization();
            if ended.map_err(self.failed(node, start_s))? {
                ended_by.get_or_insert(node);
            }
        }
        for node in 0..self.instances.len() {
            let groups = &self.system.nodes[node].read;
            let mut rest = self.outputs[node].as_mut_slice();
            for group in groups {
                let (these, others) = rest.split_at_mut(group.elements);
                let got = self.instances[node].get(group, these);
                rest = others;
                got.map_err(|error| MasterError::Instance {
                    node: self.system.nodes[node].name.clone(),
                    time_s: start_s,
                    error,
                })?;
            }
        }
        Ok(ended_by)
    }

    /// Makes one step; returns the index of an FMU that requests the end of the simulation after
    /// it.
    ///
    /// # Errors
    /// If an FMU fails, or refuses the step in whole and in parts.
    pub fn advance(&mut self) -> Result<Option<usize>, MasterError> {
        let (start_s, end_s) = (self.time_s(self.step), self.time_s(self.step + 1));
        self.tune(start_s)?;
        self.step += 1;
        self.begin_faults();
        let mut ended_by = None;
        let mut time_s = start_s;
        // Ends of the remaining parts, the next one last.
        self.ends.clear();
        self.ends.push(end_s);
        while let Some(until_s) = self.ends.last().copied() {
            let whole = time_s == start_s && self.ends.len() == 1;
            // The nominal length of the whole step: a difference of times would be rounded.
            let length_s = if whole { self.settings.step_s } else { until_s - time_s };
            if self.rolls_back {
                self.keep(time_s)?;
            }
            match self.attempt(time_s, length_s)? {
                Attempt::Done { ended_by: node } => {
                    ended_by = ended_by.or(node);
                    if self.rolls_back {
                        self.forget(time_s)?;
                    }
                    time_s = until_s;
                    self.ends.pop();
                }
                Attempt::Discarded { node, reached_s } => {
                    self.counts[node].discarded += 1;
                    self.rejected += 1;
                    let shorter_s = self.shorter(node, time_s, length_s, reached_s)?;
                    self.ends.push(time_s + shorter_s);
                    self.go_back(time_s)?;
                }
            }
        }
        Ok(ended_by)
    }

    /// Changes the parameters that change at the beginning of the step.
    fn tune(&mut self, time_s: f64) -> Result<(), MasterError> {
        while let Some(tuning) =
            self.tunings.get_mut(self.tuned).filter(|tuning| tuning.point == self.step)
        {
            tuning.apply(self.instances[tuning.node].as_mut(), time_s)?;
            self.tuned += 1;
        }
        Ok(())
    }

    /// Evaluates triggers with the outputs at the beginning of the step.
    fn begin_faults(&mut self) {
        let Some(faulting) = &mut self.faulting else { return };
        while let Some((_, id)) = faulting.fires.get(self.fired).filter(|(at, _)| *at == self.step)
        {
            faulting.station.fire(id);
            self.fired += 1;
        }
        let (conditions, outputs) = (&faulting.conditions, &self.outputs);
        faulting.station.begin(|fault| {
            let condition = conditions.get(fault).copied().flatten()?;
            condition.holds(outputs[condition.spot.node][condition.spot.place])
        });
    }

    /// Makes all transfers, and steps all FMUs over an interval.
    fn attempt(&mut self, time_s: f64, length_s: f64) -> Result<Attempt, MasterError> {
        let settings = self.settings;
        let mut ended_by = None;
        if settings.jacobi {
            for node in 0..self.instances.len() {
                self.transfer(node, time_s)?;
            }
            self.carry_texts(None, time_s)?;
        }
        for node in &settings.order {
            if !settings.jacobi {
                self.transfer(*node, time_s)?;
                self.carry_texts(Some(*node), time_s)?;
            }
            let stepped = self.exchange(*node, time_s, length_s)?;
            match stepped.outcome {
                StepOutcome::Discarded if !stepped.terminate => {
                    return Ok(Attempt::Discarded { node: *node, reached_s: stepped.time_s });
                }
                _ if stepped.terminate => ended_by = ended_by.or(Some(*node)),
                _ => {}
            }
        }
        Ok(Attempt::Done { ended_by })
    }

    /// Transfers the values of the wires into an FMU.
    fn transfer(&mut self, node: usize, time_s: f64) -> Result<(), MasterError> {
        for number in &self.into[node] {
            let wire = &self.system.wires[*number];
            let value = self.outputs[wire.from.node][wire.from.place];
            if wire.is_real && value.is_nan() {
                let since_s = self.no_number_since_s[*number].get_or_insert(time_s);
                self.no_numbers += 1;
                if self.settings.no_numbers_max.is_some_and(|max| self.no_numbers > max) {
                    return Err(MasterError::NoNumber {
                        source_name: wire.source.clone(),
                        target: wire.target.clone(),
                        since_s: *since_s,
                        found: self.no_numbers,
                        max: self.settings.no_numbers_max.unwrap_or(0),
                    });
                }
            }
            let mut value = wire.convert(value, time_s)?;
            let again = std::mem::replace(&mut self.transferred[*number], self.step) == self.step;
            if self.faulted[*number]
                && let Some(faulting) = &mut self.faulting
            {
                // Faults act on numbers. A value that none alters keeps its bits.
                let kind = wire.conversion.kind();
                let Some(before) = number_of(kind, value) else {
                    return Err(wire.beyond_faults(value, time_s));
                };
                let after = faulting.station.transfer(*number, before, again);
                if after.to_bits() != before.to_bits() {
                    let altered = carried(kind, after);
                    value = altered.ok_or_else(|| wire.beyond_faults(value, time_s))?;
                }
            }
            if !again {
                self.delivered[*number] = value;
            }
            self.inputs[node][wire.to.place] = value;
        }
        Ok(())
    }

    /// Transfers texts and bytes, into one FMU or all.
    fn carry_texts(&mut self, only: Option<usize>, time_s: f64) -> Result<(), MasterError> {
        for wire in &self.system.texts {
            let (from, to) = (wire.from.0, wire.to.0);
            if only.is_some_and(|only| only != to) {
                continue;
            }
            if wire.binary {
                let value = self.instances[from].get_binaries(&wire.from.1);
                let value = value.map_err(self.failed(from, time_s))?;
                let set = self.instances[to].set_binaries(&wire.to.1, &value);
                set.map_err(self.failed(to, time_s))?;
            } else {
                let value = self.instances[from].get_strings(&wire.from.1);
                let value = value.map_err(self.failed(from, time_s))?;
                let set = self.instances[to].set_strings(&wire.to.1, &value);
                set.map_err(self.failed(to, time_s))?;
            }
        }
        Ok(())
    }

    /// Sets the inputs of an FMU, steps it, and reads its outputs.
    fn exchange(
        &mut self,
        node: usize,
        time_s: f64,
        length_s: f64,
    ) -> Result<Stepped, MasterError> {
        let sides = &self.system.nodes[node];
        let (set, get) = (&sides.inputs.plan.groups, &sides.read);
        let (inputs, outputs) = (&self.inputs[node], &mut self.outputs[node]);
        let instance = &mut self.instances[node];
        match instance.exchange(set, inputs, time_s, length_s, get, outputs) {
            Ok(stepped) => Ok(stepped),
            Err(error) if is_refusal(&error) => {
                self.set_one_by_one(node, time_s)?;
                let outputs = &mut self.outputs[node];
                let stepped =
                    self.instances[node].exchange(&[], &[], time_s, length_s, get, outputs);
                stepped.map_err(self.failed(node, time_s))
            }
            Err(error) => Err(self.failed(node, time_s)(error)),
        }
    }
}
