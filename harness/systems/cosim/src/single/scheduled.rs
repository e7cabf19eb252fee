//! Scheduled execution (FMI 3.0, 5): the model partitions of an FMU are activated at the ticks of their
//! input clocks, in the order of time, and at one time in the order of priority, of which the smallest
//! number comes first.
//!
//! Before an activation the inputs of the partition are set, and those of none; after it, its outputs
//! are read, and those of none: a variable has its value at the ticks of its own clocks. Row 0 is the
//! state of the initialization. A row follows each time at which clocks tick.

use super::input::Inputs;
use super::output::{Outputs, Sink};
use super::{Finished, STEPS_MAX, SimulateError, Span};
use octant_base::control::Control;
use octant_fmu_bind::settings::Starts;
use octant_fmu_host::description::{
    Causality, Description, IntervalVariability, Variable, VariableType,
};
use octant_fmu_host::instance::{AccessPlan, Instance, InstanceError, VariableGroup};
use std::ops::Range;

/// Input clock, with the times at which its partition is activated.
#[derive(Clone, Debug)]
struct Partition {
    name: String,
    reference: u32,
    kind: IntervalVariability,
    priority: u32,
    shift_s: f64,
    /// Interval of the description, s.
    described_s: Option<f64>,
    interval_s: Option<f64>,
    /// Start from which ticks at multiples of the interval are counted, so that rounding doesn't
    /// accumulate.
    base_s: f64,
    ticks: u64,
    next_s: Option<f64>,
    last_s: Option<f64>,
    /// Shortest interval: with a shorter one the run has more ticks than any run needs.
    least_s: f64,
}

/// A variable, its place among the numbers of all, and its clocks.
struct ClockedVariable {
    group: VariableGroup,
    place: Range<usize>,
    clocks: Vec<u32>,
}

impl ClockedVariable {
    /// Returns whether it belongs to one of these clocks, or to none at all.
    fn is_of(&self, clocks: &[u32]) -> bool {
        self.clocks.is_empty() || self.clocks.iter().any(|clock| clocks.contains(clock))
    }
}

/// Activates the model partitions of an FMU from its start values to the end.
///
/// # Errors
/// If the FMU fails, a clock has no time to tick at, or the outputs can't be written; earlier rows
/// are kept.
pub fn simulate_scheduled(
    instance: &mut dyn Instance,
    starts: &Starts,
    mut inputs: Option<&mut Inputs>,
    outputs: &Outputs,
    span: &Span,
    sink: &mut Sink,
    control: &Control,
) -> Result<Finished, SimulateError> {
    let description = instance.description().clone();
    let set = match &inputs {
        Some(inputs) => variables(&description, &inputs.plan)?,
        None => Vec::new(),
    };
    let got = variables(&description, &outputs.plan)?;
    let mut partitions = partitions(&description, (span.stop_s - span.start_s) / STEPS_MAX);
    if partitions.is_empty() {
        return Err(SimulateError::NoPartition { fmu: instance.name().to_owned() });
    }
    starts.apply(instance)?;
    instance.enter_initialization(span.start_s, Some(span.stop_s), span.tolerance)?;
    if let Some(inputs) = &mut inputs {
        inputs.at(span.start_s);
        for one in &set {
            instance.set(&one.group, &inputs.numbers[one.place.clone()])?;
        }
    }
    let (mut numbers, mut texts) = (vec![0.0; outputs.plan.elements], Vec::new());
    for one in &got {
        instance.get(&one.group, &mut numbers[one.place.clone()])?;
    }
    outputs.read_texts(instance, &mut texts)?;
    instance.exit_initialization()?;
    sink.row(span.start_s, outputs, &numbers, &texts)?;
    for partition in &mut partitions {
        partition.start(instance, span.start_s)?;
    }
    let mut finished = Finished::at(span.start_s);
    let mut now_s = span.start_s;
    loop {
        if control.look(finished.steps) {
            finished.cancelled = true;
            break;
        }
        let of_clocks = partitions.iter().filter_map(|partition| partition.next_s);
        // A row before the start ticks at the start.
        let of_rows = inputs.as_ref().and_then(|inputs| inputs.next_tick_s());
        let next_s = of_clocks.chain(of_rows.map(|row| row.max(now_s))).min_by(f64::total_cmp);
        let Some(next_s) = next_s.filter(|next_s| *next_s <= span.stop_s + close_s(span.stop_s))
        else {
            finished.time_s = span.stop_s;
            break;
        };
        now_s = next_s;
        let triggered = match &mut inputs {
            Some(inputs) => {
                inputs.at(now_s);
                inputs.ticks().map_or_else(Vec::new, |group| group.references)
            }
            None => Vec::new(),
        };
        let due: Vec<usize> = (0..partitions.len())
            .filter(|number| {
                let partition = &partitions[*number];
                triggered.contains(&partition.reference)
                    || partition.next_s.is_some_and(|next_s| next_s <= now_s + close_s(now_s))
            })
            .collect();
        for number in due {
            let reference = partitions[number].begin(instance, now_s)?;
            if let Some(inputs) = &inputs {
                for one in set.iter().filter(|one| one.is_of(&[reference])) {
                    instance.set(&one.group, &inputs.numbers[one.place.clone()])?;
                }
            }
            let mut news = instance.activate_partition(reference, now_s)?;
            news.ticked.push(reference);
            for one in got.iter().filter(|one| one.is_of(&news.ticked)) {
                instance.get(&one.group, &mut numbers[one.place.clone()])?;
            }
            outputs.read_texts(instance, &mut texts)?;
            for (clock, interval_s) in news.countdowns {
                for partition in partitions.iter_mut().filter(|one| one.reference == clock) {
                    partition.count_down(instance, now_s, interval_s)?;
                }
            }
        }
        for partition in &mut partitions {
            partition.ask(instance, now_s)?;
        }
        finished.steps += 1;
        finished.time_s = now_s;
        sink.row(now_s, outputs, &numbers, &texts)?;
    }
    instance.terminate()?;
    Ok(finished)
}

/// Difference within which two times are one, s: decimal times and multiples of intervals differ in
/// their last digits.
fn close_s(time_s: f64) -> f64 {
    1e-12 * time_s.abs()
}

/// Lists the variables of a plan one by one.
fn variables(
    description: &Description,
    plan: &AccessPlan,
) -> Result<Vec<ClockedVariable>, InstanceError> {
    let mut all = Vec::new();
    let mut first = 0;
    for group in &plan.groups {
        for reference in &group.references {
            let of = |variable: &&Variable| variable.reference == *reference;
            let Some(variable) = description.variables.iter().find(of) else { continue };
            let one = VariableGroup::of(description, variable)?.exactly();
            let place = first..first + one.elements;
            first = place.end;
            all.push(ClockedVariable { group: one, place, clocks: variable.clocks.clone() });
        }
    }
    Ok(all)
}

/// Lists the input clocks of an FMU by priority; one without comes last.
fn partitions(description: &Description, least_s: f64) -> Vec<Partition> {
    let clocks = description.variables.iter().filter(|variable| {
        variable.kind == VariableType::Clock && variable.causality == Causality::Input
    });
    let mut partitions: Vec<Partition> = clocks
        .filter_map(|variable| {
            let clock = variable.clock?;
            let counted = |count: u64| Some(count as f64 / clock.resolution? as f64);
            Some(Partition {
                name: variable.name.clone(),
                reference: variable.reference,
                kind: clock.interval_variability,
                priority: clock.priority.unwrap_or(u32::MAX),
                shift_s: match counted(clock.shift_counter) {
                    Some(shift_s) if clock.shift_counter > 0 => shift_s,
                    _ => clock.shift_s,
                },
                described_s: clock.interval_s.or_else(|| counted(clock.interval_counter?)),
                interval_s: None,
                base_s: 0.0,
                ticks: 0,
                next_s: None,
                last_s: None,
                least_s,
            })
        })
        .collect();
    partitions.sort_by_key(|partition| partition.priority);
    partitions
}

impl Partition {
    fn error(&self, instance: &dyn Instance, time_s: f64, reason: String) -> SimulateError {
        SimulateError::Clock {
            clock: self.name.clone(),
            fmu: instance.name().to_owned(),
            time_s,
            reason,
        }
    }

    /// Determines the first tick.
    fn start(&mut self, instance: &mut dyn Instance, start_s: f64) -> Result<(), SimulateError> {
        use IntervalVariability::{Changing, Countdown, Triggered};
        if matches!(self.kind, Countdown | Triggered) {
            return Ok(());
        }
        let asked = match self.described_s {
            None => instance.partition_interval_s(self.reference)?,
            described => described,
        };
        self.base_s = start_s + self.shift_s;
        match asked {
            Some(interval_s) => {
                self.interval_s = Some(self.checked(instance, start_s, interval_s)?);
                self.next_s = Some(self.base_s);
            }
            // The FMU tells it after one of its partitions was active.
            None if self.kind == Changing => {}
            None => {
                let reason = "found no interval, neither in the description nor from the FMU, \
                              expected one"
                    .to_owned();
                return Err(self.error(instance, start_s, reason));
            }
        }
        Ok(())
    }

    /// Returns an interval if time moves on by it.
    fn checked(
        &self,
        instance: &dyn Instance,
        now_s: f64,
        interval_s: f64,
    ) -> Result<f64, SimulateError> {
        let moves = interval_s.is_finite() && now_s + interval_s > now_s + close_s(now_s);
        if moves && interval_s >= self.least_s {
            return Ok(interval_s);
        }
        let reason = format!(
            "found the interval {interval_s:?} s, expected a time above 0, and {STEPS_MAX:e} ticks at most"
        );
        Err(self.error(instance, now_s, reason))
    }

    /// Counts a tick, and determines the next one as far as it is known; returns the reference.
    fn begin(&mut self, instance: &dyn Instance, now_s: f64) -> Result<u32, SimulateError> {
        use IntervalVariability::{Constant, Fixed, Tunable};
        if self.last_s.is_some_and(|last_s| now_s <= last_s + close_s(last_s)) {
            let reason =
                "it would tick a second time at this time, expected a later one".to_owned();
            return Err(self.error(instance, now_s, reason));
        }
        self.last_s = Some(now_s);
        self.ticks += 1;
        self.next_s = match (self.kind, self.interval_s) {
            (Constant | Fixed | Tunable, Some(interval_s)) => {
                Some(self.base_s + self.ticks as f64 * interval_s)
            }
            _ => None,
        };
        Ok(self.reference)
    }

    /// Takes a countdown that the FMU has begun.
    fn count_down(
        &mut self,
        instance: &dyn Instance,
        now_s: f64,
        interval_s: f64,
    ) -> Result<(), SimulateError> {
        // A countdown of zero makes the partition active at this time too, unless it was already.
        if !(interval_s >= 0.0 && interval_s.is_finite()) {
            let reason =
                format!("found the interval {interval_s:?} s, expected 0 or a time above it");
            return Err(self.error(instance, now_s, reason));
        }
        self.next_s = Some(now_s + interval_s);
        Ok(())
    }

    /// Asks for an interval that an activation may have changed.
    fn ask(&mut self, instance: &mut dyn Instance, now_s: f64) -> Result<(), SimulateError> {
        use IntervalVariability::{Changing, Tunable};
        let waits = self.kind == Changing && self.next_s.is_none();
        if self.kind != Tunable && !waits {
            return Ok(());
        }
        let Some(interval_s) = instance.partition_interval_s(self.reference)? else {
            return Ok(());
        };
        if self.kind == Tunable && self.interval_s == Some(interval_s) {
            return Ok(());
        }
        // A new interval counts from here.
        self.interval_s = Some(self.checked(instance, now_s, interval_s)?);
        self.base_s = now_s;
        self.ticks = 1;
        self.next_s = Some(now_s + interval_s);
        Ok(())
    }
}
