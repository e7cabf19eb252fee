//! Fields of a frame.

use super::table::{DescriptionProblem, Table};
use crate::ReadingKind;
use crate::described::{
    ByteOrder, FieldMeaning, FrameField, FrameNumber, LINE_BYTES_MAX, LineField, NumberType,
};
use crate::units::{Quantity, Unit, names, unit};
use std::format;
use std::vec::Vec;

/// Byte orders by their names.
pub(super) const ORDERS: [(&str, ByteOrder); 2] =
    [("little", ByteOrder::Little), ("big", ByteOrder::Big)];

const TYPES: [(&str, NumberType); 12] = [
    ("i8", NumberType::Signed(1)),
    ("u8", NumberType::Unsigned(1)),
    ("i16", NumberType::Signed(2)),
    ("u16", NumberType::Unsigned(2)),
    ("i24", NumberType::Signed(3)),
    ("u24", NumberType::Unsigned(3)),
    ("i32", NumberType::Signed(4)),
    ("u32", NumberType::Unsigned(4)),
    ("i64", NumberType::Signed(8)),
    ("u64", NumberType::Unsigned(8)),
    ("f32", NumberType::Float32),
    ("f64", NumberType::Float64),
];

/// Subject of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Is {
    Gyro(usize),
    Accel(usize),
    Counter,
    Stamp,
    Temperature,
    Status,
}

const SUBJECTS: [(&str, Is); 10] = [
    ("gyro x", Is::Gyro(0)),
    ("gyro y", Is::Gyro(1)),
    ("gyro z", Is::Gyro(2)),
    ("accel x", Is::Accel(0)),
    ("accel y", Is::Accel(1)),
    ("accel z", Is::Accel(2)),
    ("counter", Is::Counter),
    ("stamp", Is::Stamp),
    ("temperature", Is::Temperature),
    ("status", Is::Status),
];

/// Where the fields of a frame or a line are.
#[derive(Clone, Copy, Debug)]
pub(super) enum Places {
    /// Among so many bytes.
    Bytes {
        /// Number of bytes of the frame or record.
        bytes: usize,
        /// Order of the bytes of numbers.
        order: ByteOrder,
        /// Whether a stamp may be a floating-point number, as from version 2 on.
        float_stamps: bool,
    },
    /// In columns of a line.
    Columns,
}

/// Place of a field.
#[derive(Clone, Copy, Debug)]
pub(super) enum FieldPlace {
    /// A number among bytes.
    Number(FrameNumber),
    /// A column, from 1.
    Column(usize),
}

impl FieldPlace {
    fn is_integer(&self) -> bool {
        matches!(self, Self::Number(number) if number.number.is_integer())
    }
}

/// A field with the range of its counter or clock.
pub(super) struct ReadField {
    pub(super) place: FieldPlace,
    pub(super) meaning: FieldMeaning,
    /// Number of values of a counter or a stamp, of a stamp that is no integer in ns; `None`: 2⁶⁴.
    pub(super) modulo: Option<u64>,
    subject: Is,
}

impl ReadField {
    /// The field of a line.
    pub(super) fn of_line(&self) -> Option<LineField> {
        match self.place {
            FieldPlace::Column(column) => Some(LineField { column, meaning: self.meaning }),
            FieldPlace::Number(_) => None,
        }
    }

    /// The field of a frame or record.
    pub(super) fn of_frame(&self) -> Option<FrameField> {
        match self.place {
            FieldPlace::Number(number) => Some(FrameField { number, meaning: self.meaning }),
            FieldPlace::Column(_) => None,
        }
    }

    /// True for the time of an integer field.
    pub(super) fn is_integer(&self) -> bool {
        self.place.is_integer()
    }
}

/// Offset of a key's value from the frame's start, for something of so many bytes.
pub(super) fn place(
    table: &Table<'_>,
    key: &str,
    size: usize,
    frame_bytes: usize,
) -> Result<Option<usize>, DescriptionProblem> {
    let frame = frame_bytes as i64;
    let Some(at) = table.integer(key, -frame..=frame)? else { return Ok(None) };
    let from_start = if at < 0 { frame + at } else { at };
    if from_start + size as i64 > frame {
        let bytes = octant_base::number::counted(size as u64, "byte", "bytes");
        return Err(table.problem(
            key,
            format!("found {at}, from which {bytes} don't end within the frame's {frame}"),
        ));
    }
    Ok(usize::try_from(from_start).ok())
}

/// Reads the fields of a frame, a record or a line.
pub(super) fn fields(
    frame: &Table<'_>,
    places: Places,
) -> Result<Vec<ReadField>, DescriptionProblem> {
    let tables = frame.tables("field")?;
    let mut all: Vec<ReadField> = Vec::new();
    for table in &tables {
        let read = field(table, places)?;
        let is_same = |other: &ReadField| other.subject == read.subject;
        // Several status words are taken together.
        if read.subject != Is::Status && all.iter().any(is_same) {
            return Err(table.problem("is", "found a second time in the frame, expected once"));
        }
        all.push(read);
    }
    triad(frame, &tables, &all, "gyro")?;
    triad(frame, &tables, &all, "accel")?;
    Ok(all)
}

/// Checks that a frame has three axes of a sensor or none, all of them increments or all of them means.
fn triad(
    frame: &Table<'_>,
    tables: &[Table<'_>],
    all: &[ReadField],
    sensor: &str,
) -> Result<(), DescriptionProblem> {
    let kind = |read: &ReadField| match (sensor, read.meaning) {
        ("gyro", FieldMeaning::Rotation { kind, .. })
        | ("accel", FieldMeaning::Velocity { kind, .. }) => Some(kind),
        _ => None,
    };
    let axes: Vec<(&Table<'_>, ReadingKind)> =
        tables.iter().zip(all).filter_map(|(table, read)| Some((table, kind(read)?))).collect();
    if axes.is_empty() {
        return Ok(());
    }
    if axes.len() != 3 {
        let found = axes.len();
        return Err(frame.problem(
            "field",
            format!(
                "found {found} of {sensor} x, {sensor} y and {sensor} z, expected all three or none"
            ),
        ));
    }
    match axes.iter().find(|axis| axis.1 != axes[0].1) {
        None => Ok(()),
        Some((table, _)) => Err(table.problem(
            "unit",
            format!("found another quantity than that of the other axes of the {sensor}s, expected increments of all or rates of all"),
        )),
    }
}

fn field(table: &Table<'_>, places: Places) -> Result<ReadField, DescriptionProblem> {
    let subject = table.needed_choice("is", &SUBJECTS)?;
    let special: &[&str] = match subject {
        Is::Gyro(_) | Is::Accel(_) | Is::Temperature => &["unit", "scale", "zero"],
        Is::Counter => &["modulo"],
        Is::Stamp => &["unit", "scale", "modulo"],
        Is::Status => &["good", "faulty", "gyro_saturated", "accel_saturated"],
    };
    let place = match places {
        Places::Bytes { bytes, order, float_stamps } => {
            table.only(&[&["is", "at", "type", "byte_order", "mask"], special].concat())?;
            let number = number(table, bytes, order)?;
            let needs_integer = match subject {
                Is::Counter | Is::Status => true,
                Is::Stamp => !float_stamps,
                _ => false,
            };
            if needs_integer && !number.number.is_integer() {
                let what = "found a floating-point type, expected an integer";
                let version = if subject == Is::Stamp { ", or version = 2" } else { "" };
                return Err(table.problem("type", format!("{what}{version}")));
            }
            FieldPlace::Number(number)
        }
        Places::Columns => {
            table.only(&[&["is", "column"], special].concat())?;
            let column = table.integer("column", 1..=LINE_BYTES_MAX as i64)?.ok_or_else(|| {
                table.problem("column", "missing, expected the number of the column, from 1")
            })?;
            FieldPlace::Column(usize::try_from(column).unwrap_or(1))
        }
    };
    // A number of a column is one of 64 bits.
    let bits = if let FieldPlace::Number(number) = place { number.bits } else { 64 };
    let mut range = None;
    let meaning = match subject {
        Is::Gyro(axis) => {
            let quantities = [Quantity::AngularRate, Quantity::Angle];
            let (kind, zero, scale) = inertial(table, &quantities)?;
            FieldMeaning::Rotation { axis, kind, zero, scale }
        }
        Is::Accel(axis) => {
            let quantities = [Quantity::Acceleration, Quantity::Velocity];
            let (kind, zero, scale) = inertial(table, &quantities)?;
            FieldMeaning::Velocity { axis, kind, zero, scale }
        }
        Is::Counter => {
            range = modulo(table, bits)?;
            FieldMeaning::Counter
        }
        Is::Stamp => {
            let size = scale(table)? * unit_of(table, &[Quantity::Time])?.1;
            if size <= 0.0 {
                return Err(
                    table.problem("scale", "found a negative number, expected a positive one")
                );
            }
            let size_ns = size * 1e9;
            range = if place.is_integer() {
                modulo(table, bits)?
            } else {
                // The clock of a decimal number is continued in ns.
                modulo(table, 64)?.map(|units| libm::round(units as f64 * size_ns) as u64)
            };
            FieldMeaning::Stamp(size_ns)
        }
        Is::Temperature => {
            let (scale, zero) = (scale(table)?, table.number("zero")?.unwrap_or(0.0));
            let units = [("degC", 0.0), ("K", -273.15)];
            let offset_c = table.choice("unit", &units)?.unwrap_or(0.0);
            FieldMeaning::Temperature { zero, scale, offset_c }
        }
        Is::Status => {
            let most = if bits >= 63 { i64::MAX } else { (1 << bits) - 1 };
            let bits = |key: &str| -> Result<u64, DescriptionProblem> {
                Ok(table.integer(key, 0..=most)?.unwrap_or(0).unsigned_abs())
            };
            let [good, faulty] = [bits("good")?, bits("faulty")?];
            let [gyro_saturated, accel_saturated] =
                [bits("gyro_saturated")?, bits("accel_saturated")?];
            if good | faulty | gyro_saturated | accel_saturated == 0 {
                let what = "no bit has a meaning, expected good, faulty, gyro_saturated or accel_saturated";
                return Err(table.problem_of_all(what));
            }
            FieldMeaning::Flags { good, faulty, gyro_saturated, accel_saturated }
        }
    };
    Ok(ReadField { place, meaning, modulo: range, subject })
}

/// Reads the number of a field among so many bytes.
fn number(
    table: &Table<'_>,
    frame_bytes: usize,
    order: ByteOrder,
) -> Result<FrameNumber, DescriptionProblem> {
    let number = table.needed_choice("type", &TYPES)?;
    let order = table.choice("byte_order", &ORDERS)?.unwrap_or(order);
    let at = place(table, "at", number.bytes(), frame_bytes)?.ok_or_else(|| {
        table.problem("at", "missing, expected the offset of the field's first byte")
    })?;
    let mut number = FrameNumber::whole(at, number, order);
    mask(table, &mut number)?;
    Ok(number)
}

/// Takes the bits of a mask, which is one run of ones.
fn mask(table: &Table<'_>, number: &mut FrameNumber) -> Result<(), DescriptionProblem> {
    if !table.has("mask") {
        return Ok(());
    }
    if !number.number.is_integer() {
        return Err(
            table.problem("mask", "found with a floating-point type, expected an integer's")
        );
    }
    let bits = number.number.bits();
    let most = if bits >= 63 { i64::MAX } else { (1 << bits) - 1 };
    let mask = table.integer("mask", 1..=most)?.unwrap_or(1).unsigned_abs();
    (number.shift, number.bits) = (mask.trailing_zeros(), mask.count_ones());
    if mask >> number.shift != u64::MAX >> (64 - number.bits) {
        let what =
            format!("found {mask:#x}, expected bits beside each other, such as 0x7F or 0x0FF0");
        return Err(table.problem("mask", what));
    }
    Ok(())
}

fn scale(table: &Table<'_>) -> Result<f64, DescriptionProblem> {
    match table.number("scale")? {
        None => Ok(1.0),
        Some(0.0) => Err(table.problem("scale", "found 0, expected another number")),
        Some(scale) => Ok(scale),
    }
}

fn unit_of(table: &Table<'_>, quantities: &[Quantity]) -> Result<Unit, DescriptionProblem> {
    let expected = || format!("expected one of {}", names(quantities));
    let Some(found) = table.text("unit")? else {
        return Err(table.problem("unit", format!("missing, {}", expected())));
    };
    let known = unit(found).filter(|unit| quantities.contains(&unit.0));
    known.ok_or_else(|| table.problem("unit", format!("found {found:?}, {}", expected())))
}

/// Kind, raw number of zero, and SI units of a raw unit.
fn inertial(
    table: &Table<'_>,
    quantities: &[Quantity],
) -> Result<(ReadingKind, f64, f64), DescriptionProblem> {
    let (quantity, size) = unit_of(table, quantities)?;
    let kind = match quantity {
        Quantity::Angle | Quantity::Velocity => ReadingKind::Increment,
        _ => ReadingKind::Mean,
    };
    Ok((kind, table.number("zero")?.unwrap_or(0.0), size * scale(table)?))
}

/// Number of values before a counter begins again; `None`: 2⁶⁴.
fn modulo(table: &Table<'_>, bits: u32) -> Result<Option<u64>, DescriptionProblem> {
    let all = 1u64.checked_shl(bits);
    let most = all.and_then(|all| i64::try_from(all).ok()).unwrap_or(i64::MAX);
    match table.integer("modulo", 2..=most)? {
        None => Ok(all),
        Some(modulo) => Ok(Some(modulo.unsigned_abs())),
    }
}
