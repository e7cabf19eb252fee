//! Faults from the values of the parameters, and back.

use super::error::{FaultError, Misplaced, Unplaced};
use super::table::{FAULT_KIND, FAULT_NUMBERS, FAULT_SLOTS, MODEL, acts_in_plant, slot};
use crate::values::CellValues;
use octant_faults::catalogue::{
    Acts, Dimension, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use octant_faults::trigger::{Repeat, Schedule, Trigger};
use octant_faults::{Channels, FaultSpec, Setup, Station, Value, kinds};
use octant_plant::config::PlantConfig;

/// Id of a fault, by its index from 0.
fn id(fault: usize) -> String {
    format!("fault[{}]", fault + 1)
}

/// Makes the setup of the faults for a plant with this configuration.
#[must_use]
pub fn setup(config: &PlantConfig) -> Setup {
    Setup {
        seed: config.seed,
        sample_period_ns: config.sample_period_ns,
        calibration_samples: config.calibration_samples,
        angle_random_walk: config.imu.angle_random_walk,
        velocity_random_walk: config.imu.velocity_random_walk,
        turntable_rate_radps: config.turntable.rate_radps,
        id: String::new(),
    }
}

/// One of the numbers of a kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// Index in `fault[i].values`, from 1.
    pub place: usize,
    /// Parameter of the kind to which it belongs.
    pub parameter: &'static str,
    /// Meaning, with its unit or its choices.
    pub meaning: String,
}

/// Lists the numbers of a kind, in order, for the documentation.
#[must_use]
pub fn numbers(kind: &FaultKind) -> Vec<Number> {
    let mut all = Vec::new();
    for parameter in kind.parameters {
        let doc = parameter.doc.trim_end_matches('.');
        let mut push = |meaning: String| {
            all.push(Number { place: all.len() + 1, parameter: parameter.name, meaning });
        };
        let one_of = |dimensions: &[Dimension]| {
            let units: Vec<_> = dimensions.iter().map(|dimension| unit(*dimension)).collect();
            units.join(" or ")
        };
        let which = |dimensions: &[Dimension]| {
            let units = dimensions.iter().enumerate();
            let items: Vec<_> =
                units.map(|(place, dimension)| format!("{place}: {}", of(*dimension))).collect();
            format!("What {} is. {}.", parameter.name, items.join(", "))
        };
        match parameter.takes {
            Takes::Quantity(dimensions, _) => {
                push(format!("{doc}, {}.", one_of(dimensions)));
                if dimensions.len() > 1 {
                    push(which(dimensions));
                }
            }
            Takes::Vector(dimensions) => {
                for axis in ["first", "second", "third"] {
                    push(format!("{doc}, {}: the {axis}.", one_of(dimensions)));
                }
                if dimensions.len() > 1 {
                    push(which(dimensions));
                }
            }
            Takes::Integer(from, to) => push(format!("{doc}, a whole number, {from} to {to}.")),
            Takes::Flag => push(format!("{doc}: 1 for yes, 0 for no.")),
            Takes::Choice(names) => {
                let items: Vec<_> = names
                    .iter()
                    .enumerate()
                    .map(|(place, (name, _))| format!("{place}: {name}"))
                    .collect();
                push(format!("{doc}. {}.", items.join(", ")));
            }
            Takes::Channels => push(format!(
                "{doc}, added up: 1, 2, 4 for the gyros x, y, z, 8, 16, 32 for the accelerometers."
            )),
            // Only kinds on connections, which are not in the catalogue, have these.
            Takes::Number(_) | Takes::Value | Takes::Difference(_) => {}
        }
    }
    all
}

/// SI unit of a dimension.
fn unit(dimension: Dimension) -> &'static str {
    match dimension {
        Dimension::Time => "s",
        Dimension::Samples => "samples",
        Dimension::Frequency => "Hz",
        Dimension::Angle | Dimension::SmallAngle => "rad",
        Dimension::AngularRate | Dimension::GyroBias => "rad/s",
        Dimension::AngularAcceleration => "rad/s2",
        Dimension::AngleRandomWalk => "rad/s^(1/2)",
        Dimension::RateRandomWalk => "rad/s^(3/2)",
        Dimension::GDependent => "(rad/s)/(m/s2)",
        Dimension::Length => "m",
        Dimension::Velocity => "m/s",
        Dimension::Acceleration | Dimension::AccelBias => "m/s2",
        Dimension::VelocityRandomWalk => "m/s^(3/2)",
        Dimension::AccelRandomWalk => "m/s^(5/2)",
        Dimension::Ratio => "1",
        Dimension::Temperature => "K",
        Dimension::TemperatureRate => "K/s",
        Dimension::GyroBiasPerK => "rad/s/K",
        Dimension::AccelBiasPerK => "m/s2/K",
        Dimension::ScalePerK => "1/K",
        Dimension::AccelerationPsd => "(m/s2)^2/Hz",
        Dimension::Voltage => "V",
    }
}

/// Name of the quantity of a dimension, for numbers with several possible dimensions.
fn of(dimension: Dimension) -> String {
    let what = match dimension {
        Dimension::Time => "a time",
        Dimension::Samples => "a number of samples",
        Dimension::GyroBias | Dimension::AngularRate => "an angular rate",
        Dimension::AccelBias | Dimension::Acceleration => "an acceleration",
        Dimension::Velocity => "a velocity",
        Dimension::Length => "a length",
        Dimension::RateRandomWalk | Dimension::AngleRandomWalk => "a random walk of the gyros",
        Dimension::AccelRandomWalk | Dimension::VelocityRandomWalk => {
            "a random walk of the accelerometers"
        }
        other => return format!("in {}", unit(other)),
    };
    format!("{what} in {}", unit(dimension))
}

/// Sets the parameters to faults, in order; the remaining ones become none. The ids are not kept: a
/// plant calls its faults `fault[1]`, `fault[2]`, …, and random numbers depend on that.
///
/// # Errors
/// If there are too many faults, or one can't act inside a plant, or has a trigger or a repetition
/// for which there is no parameter.
pub(super) fn put(
    faults: &[FaultSpec],
    sample_period_ns: u64,
    values: &mut CellValues,
) -> Result<(), FaultError> {
    if faults.len() > FAULT_SLOTS {
        return Err(FaultError::TooMany { found: faults.len() });
    }
    let period_s = sample_period_ns as f64 * 1e-9;
    for place in 0..FAULT_SLOTS {
        let base = place * slot::FAULT_STRIDE;
        let Some(fault) = faults.get(place) else {
            values.set_integer(slot::FAULT_KIND + base, 0);
            continue;
        };
        let wrong = |why: Unplaced| FaultError::Unplaced {
            id: fault.id.clone(),
            kind: fault.kind.name,
            why,
        };
        refuse(fault.kind).map_err(|why| wrong(why.into()))?;
        let Schedule { trigger, duration, recovery, repeat } = &fault.schedule;
        let by_hand = match (trigger, repeat) {
            (Trigger::Epoch(first), Repeat::Once) => {
                let start_s = first.saturating_sub(1) as f64 * period_s;
                values.set_real(slot::FAULT_START + base, start_s);
                false
            }
            (Trigger::Manual, Repeat::Once | Repeat::EveryTime) => true,
            (Trigger::Epoch(_), _) => return Err(wrong(Unplaced::Repeats)),
            _ => return Err(wrong(Unplaced::Trigger)),
        };
        values.set_boolean(slot::FAULT_BY_HAND + base, by_hand);
        let place_in_catalogue = kinds::all().position(|kind| kind.name == fault.kind.name);
        let item = place_in_catalogue.map_or(0, |place| place as i32 + 1);
        values.set_integer(slot::FAULT_KIND + base, item);
        let duration_s = duration.map_or(0.0, |epochs| epochs as f64 * period_s);
        values.set_real(slot::FAULT_DURATION + base, duration_s);
        values.set_real(slot::FAULT_RECOVERY + base, *recovery as f64 * period_s);
        let mut numbers = Vec::new();
        for parameter in fault.kind.parameters {
            let value = fault.values.get(parameter.name);
            if !value.is_some_and(|value| spread(parameter, value, &mut numbers)) {
                return Err(wrong(Unplaced::NoValue(parameter.name)));
            }
        }
        numbers.resize(FAULT_NUMBERS, 0.0);
        for (i, number) in numbers.iter().enumerate() {
            values.set_real(slot::FAULT_VALUES + base + i, *number);
        }
    }
    Ok(())
}

/// Converts a value to numbers; returns false if the value doesn't fit the parameter.
fn spread(parameter: &FaultParameter, value: Value, numbers: &mut Vec<f64>) -> bool {
    let which = |dimensions: &[Dimension], dimension: Dimension, numbers: &mut Vec<f64>| {
        let place = dimensions.iter().position(|known| *known == dimension);
        if dimensions.len() > 1 {
            numbers.extend(place.map(|place| place as f64));
        }
        place.is_some()
    };
    match (parameter.takes, value) {
        (Takes::Quantity(dimensions, _), Value::Quantity(value, dimension)) => {
            numbers.push(value);
            which(dimensions, dimension, numbers)
        }
        (Takes::Vector(dimensions), Value::Vector(vector, dimension)) => {
            numbers.extend(vector);
            which(dimensions, dimension, numbers)
        }
        (Takes::Integer(..), Value::Integer(value)) => {
            numbers.push(value as f64);
            true
        }
        (Takes::Flag, Value::Flag(value)) => {
            numbers.push(f64::from(u8::from(value)));
            true
        }
        (Takes::Choice(names), Value::Choice(name)) => {
            let place = names.iter().position(|(known, _)| *known == name);
            numbers.extend(place.map(|place| place as f64));
            place.is_some()
        }
        (Takes::Channels, Value::Channels(channels)) => {
            numbers.push(channels.iter().map(|channel| f64::from(1u8 << channel)).sum());
            true
        }
        _ => false,
    }
}

/// Makes the faults from the parameters, with their indices.
///
/// # Errors
/// If a fault can't act inside a plant, or its kind doesn't accept a number: the variable, the
/// value found and the values expected. The station reports other contradictions.
pub fn faults(values: &CellValues) -> Result<Vec<(usize, FaultSpec)>, FaultError> {
    let mut all = Vec::new();
    for place in 0..FAULT_SLOTS {
        if let Some(spec) = fault(place, values)? {
            all.push((place, spec));
        }
    }
    Ok(all)
}

fn fault(place: usize, values: &CellValues) -> Result<Option<FaultSpec>, FaultError> {
    let base = place * slot::FAULT_STRIDE;
    let item = values.integer(slot::FAULT_KIND + base);
    if item == 0 {
        return Ok(None);
    }
    let id = id(place);
    let known = usize::try_from(item - 1).ok().and_then(|at| kinds::all().nth(at));
    let Some(kind) = known else {
        return Err(FaultError::NoItem { id, found: item });
    };
    if let Err(why) = refuse(kind) {
        return Err(FaultError::Misplaced { id, found: item, kind: kind.name, why });
    }
    let period_ns = values.count(slot::PERIOD) as f64;
    // The cast saturates, beyond any run.
    let of_time = |time_s: f64| (time_s * 1e9 / period_ns).round() as u64;
    let samples = |slot: usize| {
        let found = values.real(slot + base);
        let whole = of_time(found);
        if found > 0.0 && whole == 0 {
            let label = MODEL.label(slot + base);
            return Err(FaultError::TooShort { label, found_s: found });
        }
        Ok(whole)
    };
    let by_hand = values.boolean(slot::FAULT_BY_HAND + base);
    let duration = samples(slot::FAULT_DURATION)?;
    let recovery = samples(slot::FAULT_RECOVERY)?;
    if recovery > 0 && kind.lasts != Lasts::Fading {
        let found_s = values.real(slot::FAULT_RECOVERY + base);
        return Err(FaultError::Recovery { id, found_s, kind: kind.name });
    }
    let schedule = Schedule {
        trigger: if by_hand {
            Trigger::Manual
        } else {
            let start_s = values.real(slot::FAULT_START + base);
            Trigger::Epoch(of_time(start_s).saturating_add(1))
        },
        duration: (duration > 0).then_some(duration),
        recovery,
        repeat: if by_hand { Repeat::EveryTime } else { Repeat::Once },
    };
    let mut numbers = Numbers { id: &id, kind, next: 0, values, slot: slot::FAULT_VALUES + base };
    let mut found = octant_faults::Values::default();
    for parameter in kind.parameters {
        found.set(parameter.name, numbers.value(parameter)?);
    }
    numbers.end()?;
    Ok(Some(FaultSpec { id, kind, values: found, schedule }))
}

/// Refuses a kind that can't act inside a plant, with the reason.
fn refuse(kind: &FaultKind) -> Result<(), Misplaced> {
    match kind.acts {
        _ if acts_in_plant(kind) => Ok(()),
        Acts::Unit | Acts::Power => Err(Misplaced::Unit),
        Acts::Delivery => Err(Misplaced::Delivery),
        _ => Err(Misplaced::Elsewhere),
    }
}

/// Reader of the numbers of a fault.
struct Numbers<'a> {
    id: &'a str,
    kind: &'static FaultKind,
    next: usize,
    values: &'a CellValues,
    slot: usize,
}

impl Numbers<'_> {
    fn number(&mut self) -> f64 {
        self.next += 1;
        // No kind takes more numbers than there are.
        if self.next > FAULT_NUMBERS { 0.0 } else { self.values.real(self.slot + self.next - 1) }
    }

    fn wrong(&self, parameter: &FaultParameter, found: f64, expected: &str) -> FaultError {
        FaultError::Number {
            id: self.id.to_owned(),
            place: self.next,
            name: parameter.name,
            kind: self.kind.name,
            found,
            expected: expected.to_owned(),
        }
    }

    /// Reads a whole number from 0 to below `count`.
    fn place(&mut self, parameter: &FaultParameter, count: usize) -> Result<usize, FaultError> {
        let found = self.number();
        let place = found as usize;
        if place as f64 == found && place < count {
            return Ok(place);
        }
        Err(self.wrong(parameter, found, &format!("a whole number from 0 to {}", count - 1)))
    }

    fn dimension(
        &mut self,
        parameter: &FaultParameter,
        dimensions: &[Dimension],
    ) -> Result<Dimension, FaultError> {
        match dimensions {
            [one] => Ok(*one),
            several => Ok(several[self.place(parameter, several.len())?]),
        }
    }

    fn value(&mut self, parameter: &'static FaultParameter) -> Result<Value, FaultError> {
        Ok(match parameter.takes {
            Takes::Quantity(dimensions, bounds) => {
                let found = self.number();
                if let Some(expected) = outside(found, bounds) {
                    return Err(self.wrong(parameter, found, &expected));
                }
                Value::Quantity(found, self.dimension(parameter, dimensions)?)
            }
            Takes::Vector(dimensions) => {
                let vector = [self.number(), self.number(), self.number()];
                if let Some(found) = vector.into_iter().find(|found| !found.is_finite()) {
                    return Err(self.wrong(parameter, found, "a finite number"));
                }
                Value::Vector(vector, self.dimension(parameter, dimensions)?)
            }
            Takes::Integer(from, to) => {
                let found = self.number();
                let whole = found as i64;
                if whole as f64 != found || !(from..=to).contains(&whole) {
                    let expected = format!("a whole number from {from} to {to}");
                    return Err(self.wrong(parameter, found, &expected));
                }
                Value::Integer(whole)
            }
            Takes::Flag => Value::Flag(self.place(parameter, 2)? == 1),
            Takes::Choice(names) => Value::Choice(names[self.place(parameter, names.len())?].0),
            Takes::Channels => {
                let mask = self.place(parameter, 64)?;
                let mut all: Option<Channels> = None;
                for channel in (0..6).filter(|channel| mask & (1 << channel) != 0) {
                    let one = if channel < 3 {
                        Channels::gyro(channel)
                    } else {
                        Channels::accelerometer(channel - 3)
                    };
                    all = Some(all.map_or(one, |all| all.union(one)));
                }
                match all {
                    Some(channels) => Value::Channels(channels),
                    None => return Err(self.wrong(parameter, 0.0, "a sum of channels, 1 to 63,")),
                }
            }
            Takes::Number(_) | Takes::Value | Takes::Difference(_) => {
                return Err(FaultError::OfConnections { id: self.id.to_owned() });
            }
        })
    }

    /// Checks that the remaining numbers are zero: another value was meant for another kind.
    fn end(&mut self) -> Result<(), FaultError> {
        while self.next < FAULT_NUMBERS {
            let found = self.number();
            if found != 0.0 {
                let (id, place, kind) = (self.id.to_owned(), self.next, self.kind.name);
                return Err(FaultError::Surplus { id, place, found, kind });
            }
        }
        Ok(())
    }
}

/// Returns the expected range of a quantity, if the value is outside of it.
fn outside(found: f64, bounds: ParameterBounds) -> Option<String> {
    let (fits, expected) = match bounds {
        ParameterBounds::NotZero => (found != 0.0, "a number other than 0".to_owned()),
        ParameterBounds::Any => (true, "a finite number".to_owned()),
        ParameterBounds::Positive => (found > 0.0, "a number above 0".to_owned()),
        ParameterBounds::NotNegative => (found >= 0.0, "0 or more".to_owned()),
        ParameterBounds::Within(from, to, _) => {
            ((from..=to).contains(&found), format!("a number from {from} to {to}"))
        }
    };
    (!(fits && found.is_finite())).then_some(expected)
}

/// Makes the station of the faults, if there are any, with their indices.
pub(super) fn station(
    values: &CellValues,
    config: &PlantConfig,
) -> Result<Option<(Station, Vec<usize>)>, FaultError> {
    let faults = faults(values)?;
    if faults.is_empty() {
        return Ok(None);
    }
    let (places, specs): (Vec<_>, Vec<_>) = faults.into_iter().unzip();
    let station = Station::new(&specs, &setup(config))
        .map_err(|(id, error)| FaultError::Build { id, error })?;
    if station.most_delivered() > 1 {
        return Err(FaultError::Burst { samples: station.most_delivered() });
    }
    Ok(Some((station, places)))
}

const _: () = assert!(FAULT_KIND.items.len() > 1, "there are kinds that can act");
