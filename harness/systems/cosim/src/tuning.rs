//! Parameters that change while a system runs: `--tune FMU.VARIABLE=VALUE@TIME`.

use super::error::{MasterError, is_refusal};
use super::experiment::RunExperiment;
use super::flat::Flat;
use super::parameters::from_argument;
use super::ssp::SspError;
use octant_base::names::suggestion;
use octant_fmu_bind::find::find;
use octant_fmu_bind::settings::{Starts, ValueSettings};
use octant_fmu_host::description::{Causality, Description, Variability, Variable};
use octant_fmu_host::instance::{Instance, said};
use octant_scenario::quantity::{UnitDimension, parse};
use serde::Serialize;

/// Part of a step by which a time may miss a communication point.
const CLOSE: f64 = 1e-6;

/// Parameters of one FMU that change at one communication point.
#[derive(Clone, Debug)]
pub struct Tuning {
    /// Communication point, from 0: they act from the step on that begins there.
    pub(super) point: u64,
    /// Index of the FMU.
    pub(super) node: usize,
    pub(super) values: Starts,
    /// The arguments as they were given.
    pub(super) told: TunedResult,
}

/// A change of parameters, as the summary has it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TunedResult {
    /// Time, s.
    pub at_s: f64,
    /// Name of the FMU in the system.
    pub fmu: String,
    /// Variables with their values, as they were given: `imu.angle_random_walk=1e-6`.
    pub values: Vec<String>,
    /// True once the FMU has taken them.
    pub done: bool,
}

impl Tuning {
    /// Sets the parameters.
    pub(super) fn apply(
        &mut self,
        instance: &mut dyn Instance,
        time_s: f64,
    ) -> Result<(), MasterError> {
        match self.values.apply(instance) {
            Ok(()) => {
                self.told.done = true;
                Ok(())
            }
            Err(error) if is_refusal(&error) => Err(MasterError::Tuned {
                node: self.told.fmu.clone(),
                values: self.told.values.join(", "),
                time_s,
                said: said(instance),
            }),
            Err(error) => Err(MasterError::Instance { node: self.told.fmu.clone(), time_s, error }),
        }
    }
}

/// Reads the arguments, in the order of their times. Those of one FMU and one time are set together.
///
/// # Errors
/// If a variable isn't a tunable parameter, a value doesn't fit it, or a time is no communication point before the end.
pub fn tunings(
    arguments: &[String],
    flat: &Flat,
    descriptions: &[&Description],
    experiment: &RunExperiment,
) -> Result<Vec<Tuning>, SspError> {
    type Collected<'a> = (u64, usize, ValueSettings<'a>, Vec<String>);
    let mut all: Vec<Collected<'_>> = Vec::new();
    let of = |argument: &str, message| SspError::of_file(&format!("--tune {argument}"), message);
    for argument in arguments {
        let wrong = |message: String| of(argument, message);
        let Some((set, time)) = argument.rsplit_once('@') else {
            let expected = "expected FMU.VARIABLE=VALUE@TIME, such as \
                            \"plant.imu.angle_random_walk=1e-6@30 s\"";
            return Err(wrong(expected.to_owned()));
        };
        let point = point(time, experiment).map_err(&wrong)?;
        let (node, name, values) = from_argument(set, &flat.components).map_err(&wrong)?;
        let description = descriptions[node];
        check(description, name, values.len()).map_err(&wrong)?;
        let place = all.iter().position(|(at, of, ..)| (*at, *of) == (point, node));
        let place = place.unwrap_or_else(|| {
            all.push((point, node, ValueSettings::new(description), Vec::new()));
            all.len() - 1
        });
        let (.., settings, told) = &mut all[place];
        settings.set(name, &values).map_err(|error| wrong(error.to_string()))?;
        let value = set.split_once('=').map_or("", |(_, value)| value.trim());
        told.push(format!("{name}={value}"));
    }
    // Stable: those of one time stay in the order in which they were given.
    all.sort_by_key(|(point, ..)| *point);
    let made = all.into_iter().map(|(point, node, settings, values)| {
        let name = &flat.components[node].name;
        let starts = settings.finish().map_err(|error| of(name, error.to_string()))?;
        let at_s = experiment.start_s + point as f64 * experiment.step_s;
        let told = TunedResult { at_s, fmu: name.clone(), values, done: false };
        Ok(Tuning { point, node, values: starts, told })
    });
    made.collect()
}

/// Communication point of a time.
fn point(time: &str, experiment: &RunExperiment) -> Result<u64, String> {
    let time = time.trim();
    let RunExperiment { start_s, step_s, steps } = *experiment;
    let at_s = match parse(time) {
        Ok(quantity) if quantity.is(UnitDimension::TIME) => quantity.si,
        _ => return Err(format!("found the time {time:?}, expected one such as \"30 s\"")),
    };
    let exact = (at_s - start_s) / step_s;
    let point = exact.round();
    if !(point >= 0.0 && point < steps as f64) {
        let stop_s = experiment.stop_s();
        return Err(format!(
            "found the time {at_s} s, expected one from the start at {start_s} s on, and before the end at {stop_s} s"
        ));
    }
    if (exact - point).abs() > CLOSE {
        let (before, after) = (exact.floor(), exact.floor() + 1.0);
        return Err(format!(
            "found the time {at_s} s, expected a communication point: the nearest are {} s and {} s",
            start_s + before * step_s,
            start_s + after * step_s
        ));
    }
    Ok(point as u64)
}

fn is_tunable(variable: &Variable) -> bool {
    variable.causality == Causality::Parameter && variable.variability == Variability::Tunable
}

/// Checks that a name is that of a tunable parameter, with the nearest such name else. A name that no variable has is
/// told of where its value is read.
fn check(description: &Description, name: &str, values: usize) -> Result<(), String> {
    let Some(found) = find(description, name, values) else { return Ok(()) };
    let Some((fixed, _)) = found.elements.iter().find(|(variable, _)| !is_tunable(variable)) else {
        return Ok(());
    };
    let what = match fixed.causality {
        Causality::Parameter => "a fixed parameter, which can't change in a running FMU",
        Causality::Input => "an input: a connection or a start value gives it its value",
        _ => "no parameter",
    };
    let known = description.variables.iter().filter(|v| is_tunable(v)).map(|v| v.name.as_str());
    if known.clone().next().is_none() {
        return Err(format!("{} is {what}, and the FMU has no tunable parameters", fixed.name));
    }
    Err(format!(
        "{} is {what}; {}",
        fixed.name,
        suggestion(&fixed.name, known, "tunable parameters")
    ))
}
