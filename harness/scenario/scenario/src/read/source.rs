//! Reads the source of the samples from `[source]`.

use super::instrument_port::{instrument, log};
use crate::error::Problem;
use crate::keys::{At, McapKeys, SignalKeys, SourceKeys, TextKeys};
use crate::model::{FileName, SourceSpec};
use crate::recorded::{
    AxisColumn, GimbalColumns, MappedField, MappedStamp, McapMapping, NO_TIME, RecordedColumn,
    RecordedQuantity, TemperatureColumn, TemperatureField, TextFiles, TextMapping, TimeColumn,
};
use std::path::PathBuf;

pub(super) fn read(keys: &SourceKeys, sample_period_ns: u64) -> Result<SourceSpec, Problem> {
    let uri = keys.uri.as_str();
    match uri.split_once(':') {
        None if uri == "plant" => Ok(SourceSpec::Plant),
        Some(("replay", file)) if !file.is_empty() => {
            let mapping = keys.mcap.as_ref().map(|mcap| read_mcap(mcap, sample_period_ns));
            Ok(SourceSpec::Replay {
                file: FileName(file.to_owned()),
                mapping: mapping.transpose()?,
            })
        }
        Some(("text", file)) if !file.is_empty() => {
            let Some(text) = &*keys.text else {
                let message = "missing, expected the columns of the text files of source.uri";
                return Err(keys.text.problem(message));
            };
            Ok(SourceSpec::Text(read_text(text, file, sample_period_ns)?))
        }
        Some(("log", file)) if !file.is_empty() => Ok(SourceSpec::Log(log(keys, file)?)),
        Some(("fmu", file)) if !file.is_empty() => {
            Ok(SourceSpec::Fmu(Box::new(super::fmu::source(keys, file, sample_period_ns)?)))
        }
        Some(("solution", file)) if !file.is_empty() => {
            Ok(SourceSpec::Solution(Box::new(super::trajectory::solution(keys, file)?)))
        }
        _ if octant_link::Uri::is_one(uri) => Ok(SourceSpec::Live(instrument(keys)?)),
        _ => Err(keys.uri.problem(format!(
            "found {uri:?}, expected plant, replay:FILE, text:FILE, log:FILE, solution:FILE, \
             fmu:FILE, serial:PORT, udp:HOST:PORT, can:INTERFACE or slcan:PORT"
        ))),
    }
}

/// Reads the noise that is added to the samples, which are those of an instrument whose noise isn't known.
pub(super) fn dither(keys: &SourceKeys, source: &SourceSpec) -> Result<Option<f64>, Problem> {
    match source {
        _ if keys.dither.is_none() => {}
        SourceSpec::Solution(_) => {
            return Err(keys.dither.problem("a solution has no samples: expected no dither"));
        }
        source if source.has_plant() => {
            return Err(keys.dither.problem(
                "the noise of a simulated instrument is known without it: expected no dither",
            ));
        }
        _ => {}
    }
    Ok(*keys.dither)
}

fn read_text(keys: &TextKeys, file: &str, sample_period_ns: u64) -> Result<TextMapping, Problem> {
    let column = |key: &At<RecordedColumn>| match &**key {
        RecordedColumn::Name(name) if !keys.header => Err(key.problem(format!(
            "found the name {name:?} with header = false, expected a column number"
        ))),
        column => Ok(column.clone()),
    };
    let sensor = |columns: [&At<RecordedColumn>; 3], keys: SignalKeys<'_>| {
        let [x, y, z] = columns.map(column);
        let columns = [x?, y?, z?];
        let axis = |axis: Mapped| {
            let column = columns[axis.index].clone();
            AxisColumn { column, offset: axis.offset, scale: axis.scale }
        };
        Ok(signal(keys)?.map(axis))
    };
    let file_of = |own: &Option<String>| PathBuf::from(own.as_deref().unwrap_or(file));
    let (gyro, accelerometer) = (&keys.gyro, &keys.accelerometer);
    let files = match (file_of(&gyro.file), file_of(&accelerometer.file)) {
        (gyro, accelerometer) if gyro == accelerometer => TextFiles::One(gyro),
        (gyro, accelerometer) => TextFiles::Split { gyro, accelerometer },
    };
    let quantity = *gyro.quantity;
    let gyro = sensor([&gyro.x, &gyro.y, &gyro.z], gyro.signal())?;
    let other = &accelerometer.quantity;
    let columns = [&accelerometer.x, &accelerometer.y, &accelerometer.z];
    let accelerometer = sensor(columns, accelerometer.signal())?;
    same_quantity(quantity, other)?;
    check_rate(&keys.rate, keys.split, sample_period_ns)?;
    let time = match &*keys.time_column {
        RecordedColumn::Name(name) if name == NO_TIME && !keys.rate.given => {
            return Err(keys.rate.problem(
                "missing, expected the rate of the rows: time_column is \"none\", and the time of a row is its \
                 number over the rate",
            ));
        }
        RecordedColumn::Name(name) if name == NO_TIME => None,
        time if is_measured(keys, time) => {
            return Err(keys.time_column.problem(
                "found a column of a gyro or accelerometer, expected one of times, or \"none\" with source.text.rate",
            ));
        }
        _ => Some(TimeColumn { column: column(&keys.time_column)?, unit: keys.time_unit }),
    };
    let gimbal = keys.gimbal.as_ref().map(|gimbal| {
        let scale = gimbal.unit.unit_si()?;
        let axis = |key| Ok(AxisColumn { column: column(key)?, offset: 0.0, scale });
        Ok(GimbalColumns { azimuth: axis(&gimbal.azimuth)?, roll: axis(&gimbal.roll)? })
    });
    let temperature = match &*keys.temperature_column {
        None => None,
        Some(RecordedColumn::Name(name)) if !keys.header => {
            return Err(keys.temperature_column.problem(format!(
                "found the name {name:?} with header = false, expected a column number"
            )));
        }
        Some(column) => {
            Some(TemperatureColumn { column: column.clone(), unit: keys.temperature_unit })
        }
    };
    Ok(TextMapping {
        files,
        time,
        gyro,
        accelerometer,
        quantity,
        nominal_rate_hz: *keys.rate,
        split: keys.split,
        delimiter: keys.delimiter,
        comment: keys.comment.clone(),
        skip_lines: keys.skip_lines,
        header: keys.header,
        gimbal: gimbal.transpose()?,
        temperature,
    })
}

/// True if a column is one of a gyro, or of an accelerometer in the same file.
fn is_measured(keys: &TextKeys, column: &RecordedColumn) -> bool {
    let (gyro, accel) = (&keys.gyro, &keys.accelerometer);
    let of_gyro = [&gyro.x, &gyro.y, &gyro.z].iter().any(|x| ***x == *column);
    let of_accel = [&accel.x, &accel.y, &accel.z].iter().any(|x| ***x == *column);
    of_gyro || (of_accel && accel.file == gyro.file)
}

fn read_mcap(keys: &McapKeys, sample_period_ns: u64) -> Result<McapMapping, Problem> {
    let sensor = |paths: [&String; 3], keys: SignalKeys<'_>| {
        let field = |axis: Mapped| MappedField {
            path: paths[axis.index].clone(),
            offset: axis.offset,
            scale: axis.scale,
        };
        Ok(signal(keys)?.map(field))
    };
    let (gyro, accelerometer) = (&keys.gyro, &keys.accelerometer);
    let quantity = *gyro.quantity;
    let gyro = sensor([&gyro.x, &gyro.y, &gyro.z], gyro.signal())?;
    let other = &accelerometer.quantity;
    let paths = [&accelerometer.x, &accelerometer.y, &accelerometer.z];
    let accelerometer = sensor(paths, accelerometer.signal())?;
    same_quantity(quantity, other)?;
    let nanoseconds = &keys.nanoseconds_field;
    let stamp = match keys.time_field.clone() {
        None if nanoseconds.is_some() => {
            return Err(nanoseconds.problem("found without time_field, to which it is added"));
        }
        None => MappedStamp::LogTime,
        Some(path) => MappedStamp::Field {
            path,
            unit: keys.time_unit,
            nanoseconds: nanoseconds.value.clone(),
        },
    };
    check_rate(&keys.rate, keys.split, sample_period_ns)?;
    Ok(McapMapping {
        topic: keys.topic.clone(),
        accelerometer_topic: keys.accelerometer.topic.clone().filter(|topic| *topic != keys.topic),
        gyro,
        accelerometer,
        quantity,
        stamp,
        nominal_rate_hz: *keys.rate,
        split: keys.split,
        gimbal: None,
        temperature: keys
            .temperature_field
            .clone()
            .map(|path| TemperatureField { path, unit: keys.temperature_unit }),
    })
}

fn same_quantity(
    gyro: RecordedQuantity,
    accelerometer: &At<RecordedQuantity>,
) -> Result<(), Problem> {
    if gyro == **accelerometer {
        return Ok(());
    }
    let message = "found another one than that of the gyros, expected rates or increments of both";
    Err(accelerometer.problem(message))
}

/// Checks that the nominal rate of rows, times the number of samples of each, is the rate of the scenario,
/// because the core has one sample period.
fn check_rate(rate: &At<f64>, split: u32, sample_period_ns: u64) -> Result<(), Problem> {
    let found_ns = 1e9 / **rate;
    // Periods of samples are whole nanoseconds, those of rows are not.
    if (found_ns / f64::from(split) - sample_period_ns as f64).abs() <= 0.5 {
        return Ok(());
    }
    Err(rate.problem(format!(
        "found {:?}, a period of {found_ns} ns, split by {split}, but imu.rate gives \
         {sample_period_ns} ns: expected the same",
        rate.text
    )))
}

/// Column along a body axis: `si = (raw − offset) · scale`.
#[derive(Clone, Copy)]
struct Mapped {
    /// Instrument axis: 0, 1, 2 for x, y, z.
    index: usize,
    offset: f64,
    scale: f64,
}

fn signal(keys: SignalKeys<'_>) -> Result<[Mapped; 3], Problem> {
    let unit = keys.unit.as_str();
    let integral = matches!(unit, "rad" | "deg" | "arcsec" | "m/s" | "mm/s");
    if integral != (**keys.quantity == RecordedQuantity::Increments) {
        return Err(keys.unit.problem(format!(
            "found {unit:?}, which is not the unit of quantity = {:?}",
            keys.quantity.text
        )));
    }
    if keys.scale.contains(&0.0) {
        return Err(keys.scale.problem("found 0, expected other numbers than zero"));
    }
    let unit = keys.unit.unit_si()?;
    Ok(axes(keys.axes)?.map(|(index, sign)| Mapped {
        index,
        offset: keys.offset[index],
        scale: sign * keys.scale[index] * unit,
    }))
}

/// Instrument axis (0, 1, 2) and sign of body x, y, z.
fn axes(texts: &At<Vec<String>>) -> Result<[(usize, f64); 3], Problem> {
    let axis = |text: &String| {
        let sign = if text.starts_with('-') { -1.0 } else { 1.0 };
        let index = ["x", "y", "z"].iter().position(|name| *name == text.trim_start_matches('-'));
        index.map(|index| (index, sign))
    };
    let axes: Vec<(usize, f64)> = texts.iter().filter_map(axis).collect();
    let mut indices: Vec<usize> = axes.iter().map(|axis| axis.0).collect();
    indices.sort_unstable();
    match <[(usize, f64); 3]>::try_from(axes) {
        Ok(axes) if indices == [0, 1, 2] => Ok(axes),
        _ => Err(texts.problem(format!(
            "found {:?}, expected x, y and z once each, such as [\"y\", \"x\", \"-z\"]",
            **texts
        ))),
    }
}
