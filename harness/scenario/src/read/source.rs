//! Reads the source of the samples from `[source]`.

use super::instrument_port::instrument;
use super::reader::Reader;
use crate::error::Problem;
use crate::model::{FileName, Source};
use crate::recorded::{
    Axis, Column, Delimiter, GimbalColumns, MappedField, MappedStamp, McapMapping, Quantity,
    TextFiles, TextMapping, TimeColumn, TimeUnit,
};
use std::path::PathBuf;

pub(super) fn read(table: &Reader<'_>, sample_period_ns: u64) -> Result<Source, Problem> {
    let uri = table.text("uri")?;
    match uri.split_once(':') {
        None if uri == "plant" => Ok(Source::Plant),
        Some(("replay", file)) if !file.is_empty() => Ok(Source::Replay {
            file: FileName(file.to_owned()),
            mapping: match table.optional_table("mcap") {
                Some(mcap) => Some(read_mcap(&mcap, sample_period_ns)?),
                None => None,
            },
        }),
        Some(("text", file)) if !file.is_empty() => {
            let Some(text) = table.optional_table("text") else {
                let message = "missing, expected the columns of the text files of source.uri";
                return Err(table.problem("text", message));
            };
            Ok(Source::Text(read_text(&text, file, sample_period_ns)?))
        }
        Some(("fmu", file)) if !file.is_empty() => {
            Ok(Source::Fmu(Box::new(super::fmu::source(table, file, sample_period_ns)?)))
        }
        _ if octant_link::Uri::is_one(uri) => Ok(Source::Live(instrument(table, uri)?)),
        _ => Err(table.problem(
            "uri",
            format!(
                "found {uri:?}, expected plant, replay:FILE, text:FILE, fmu:FILE, serial:PORT, \
                 udp:HOST:PORT, can:INTERFACE or slcan:PORT"
            ),
        )),
    }
}

fn read_text(
    table: &Reader<'_>,
    file: &str,
    sample_period_ns: u64,
) -> Result<TextMapping, Problem> {
    let header = table.boolean("header")?;
    let column = |table: &Reader<'_>, key: &str| -> Result<Column, Problem> {
        match table.optional_text(key) {
            None => Ok(Column::Number(table.integer(key)?)),
            Some(name) if header => Ok(Column::Name(name.to_owned())),
            Some(name) => Err(table.problem(
                key,
                format!("found the name {name:?} with header = false, expected a column number"),
            )),
        }
    };
    let sensor = |key: &str| -> Result<([Axis; 3], Quantity), Problem> {
        let sensor = table.table(key)?;
        let columns = [column(&sensor, "x")?, column(&sensor, "y")?, column(&sensor, "z")?];
        let signal = signal(&sensor)?;
        let axis = |axis: Mapped| {
            let column = columns[axis.index].clone();
            Axis { column, offset: axis.offset, scale: axis.scale }
        };
        Ok((signal.axes.map(axis), signal.quantity))
    };
    let file_of = |key: &str| -> Result<PathBuf, Problem> {
        Ok(PathBuf::from(table.table(key)?.optional_text("file").unwrap_or(file)))
    };
    let files = match (file_of("gyro")?, file_of("accelerometer")?) {
        (gyro, accelerometer) if gyro == accelerometer => TextFiles::One(gyro),
        (gyro, accelerometer) => TextFiles::Split { gyro, accelerometer },
    };
    let (gyro, quantity) = sensor("gyro")?;
    let (accelerometer, other) = sensor("accelerometer")?;
    same_quantity(table, quantity, other)?;
    let (nominal_rate_hz, split) = rate(table, sample_period_ns)?;
    let unit = time_unit(table)?;
    Ok(TextMapping {
        files,
        time: Some(TimeColumn { column: column(table, "time_column")?, unit }),
        gyro,
        accelerometer,
        quantity,
        nominal_rate_hz,
        split,
        delimiter: match table.text("delimiter")? {
            "comma" => Delimiter::Character(b','),
            "semicolon" => Delimiter::Character(b';'),
            "tab" => Delimiter::Character(b'\t'),
            _ => Delimiter::Blanks,
        },
        comment: table.text("comment")?.to_owned(),
        skip_lines: table.integer("skip_lines")?,
        gimbal: match table.optional_table("gimbal") {
            None => None,
            Some(gimbal) => {
                let scale = unit_si(&gimbal, "unit")?;
                let axis = |key| Ok(Axis { column: column(&gimbal, key)?, offset: 0.0, scale });
                Some(GimbalColumns { azimuth: axis("azimuth")?, roll: axis("roll")? })
            }
        },
    })
}

fn read_mcap(table: &Reader<'_>, sample_period_ns: u64) -> Result<McapMapping, Problem> {
    let sensor = |key: &str| -> Result<([MappedField; 3], Quantity), Problem> {
        let sensor = table.table(key)?;
        let paths = [sensor.text("x")?, sensor.text("y")?, sensor.text("z")?];
        let signal = signal(&sensor)?;
        let field = |axis: Mapped| MappedField {
            path: paths[axis.index].to_owned(),
            offset: axis.offset,
            scale: axis.scale,
        };
        Ok((signal.axes.map(field), signal.quantity))
    };
    let (gyro, quantity) = sensor("gyro")?;
    let (accelerometer, other) = sensor("accelerometer")?;
    same_quantity(table, quantity, other)?;
    let nanoseconds = table.optional_text("nanoseconds_field").map(str::to_owned);
    let stamp = match table.optional_text("time_field") {
        None if nanoseconds.is_some() => {
            let message = "found without time_field, to which it is added";
            return Err(table.problem("nanoseconds_field", message));
        }
        None => MappedStamp::LogTime,
        Some(path) => {
            MappedStamp::Field { path: path.to_owned(), unit: time_unit(table)?, nanoseconds }
        }
    };
    let (nominal_rate_hz, split) = rate(table, sample_period_ns)?;
    Ok(McapMapping {
        topic: table.text("topic")?.to_owned(),
        gyro,
        accelerometer,
        quantity,
        stamp,
        nominal_rate_hz,
        split,
        gimbal: None,
    })
}

fn same_quantity(table: &Reader<'_>, gyro: Quantity, other: Quantity) -> Result<(), Problem> {
    if gyro == other {
        return Ok(());
    }
    Err(table.table("accelerometer")?.problem(
        "quantity",
        "found another one than that of the gyros, expected rates or increments of both",
    ))
}

/// Nominal rate of rows, Hz, and the number of samples of each. Their product must be the rate of the
/// scenario, because the core has one sample period.
fn rate(table: &Reader<'_>, sample_period_ns: u64) -> Result<(f64, u32), Problem> {
    let found_ns = super::instrument::sample_period_ns(table)?;
    let split: u32 = table.integer("split")?;
    if found_ns == sample_period_ns * u64::from(split) {
        return Ok((table.si("rate")?, split));
    }
    Err(table.problem(
        "rate",
        format!(
            "found {:?}, a period of {found_ns} ns, split by {split}, but imu.rate gives \
             {sample_period_ns} ns: expected the same",
            table.text("rate")?
        ),
    ))
}

fn time_unit(table: &Reader<'_>) -> Result<TimeUnit, Problem> {
    Ok(match table.text("time_unit")? {
        "ms" => TimeUnit::Millisecond,
        "us" => TimeUnit::Microsecond,
        "ns" => TimeUnit::Nanosecond,
        _ => TimeUnit::Second,
    })
}

/// SI value of a unit.
fn unit_si(table: &Reader<'_>, key: &str) -> Result<f64, Problem> {
    let unit = table.text(key)?;
    crate::quantity::parse(&format!("1 {unit}"))
        .map(|quantity| quantity.si)
        .map_err(|_| table.problem(key, format!("found the unknown unit {unit:?}")))
}

/// Column along a body axis: `si = (raw − offset) · scale`.
#[derive(Clone, Copy)]
struct Mapped {
    /// Instrument axis: 0, 1, 2 for x, y, z.
    index: usize,
    offset: f64,
    scale: f64,
}

struct Signal {
    axes: [Mapped; 3],
    quantity: Quantity,
}

fn signal(table: &Reader<'_>) -> Result<Signal, Problem> {
    let quantity = match table.text("quantity")? {
        "increment" => Quantity::Increments,
        _ => Quantity::Rates,
    };
    let unit = table.text("unit")?;
    let integral = matches!(unit, "rad" | "deg" | "arcsec" | "m/s" | "mm/s");
    if integral != (quantity == Quantity::Increments) {
        let quantity = table.text("quantity")?;
        return Err(table.problem(
            "unit",
            format!("found {unit:?}, which is not the unit of quantity = {quantity:?}"),
        ));
    }
    let scale: [f64; 3] = table.numbers("scale")?;
    if scale.contains(&0.0) {
        return Err(table.problem("scale", "found 0, expected other numbers than zero"));
    }
    let offset: [f64; 3] = table.numbers("offset")?;
    let unit = unit_si(table, "unit")?;
    let axes = axes(table)?.map(|(index, sign)| Mapped {
        index,
        offset: offset[index],
        scale: sign * scale[index] * unit,
    });
    Ok(Signal { axes, quantity })
}

/// Instrument axis (0, 1, 2) and sign of body x, y, z.
fn axes(table: &Reader<'_>) -> Result<[(usize, f64); 3], Problem> {
    let texts = table.texts("axes");
    let axis = |text: &&str| {
        let sign = if text.starts_with('-') { -1.0 } else { 1.0 };
        let index = ["x", "y", "z"].iter().position(|name| *name == text.trim_start_matches('-'));
        index.map(|index| (index, sign))
    };
    let axes: Vec<(usize, f64)> = texts.iter().filter_map(axis).collect();
    let mut indices: Vec<usize> = axes.iter().map(|axis| axis.0).collect();
    indices.sort_unstable();
    match <[(usize, f64); 3]>::try_from(axes) {
        Ok(axes) if indices == [0, 1, 2] => Ok(axes),
        _ => Err(table.problem(
            "axes",
            format!(
                "found {texts:?}, expected x, y and z once each, such as [\"y\", \"x\", \"-z\"]"
            ),
        )),
    }
}
