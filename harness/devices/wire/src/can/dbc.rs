//! The CAN database (DBC): every frame and signal, for any tool that reads such files.

use super::{CanVersion, Slot};
use crate::layout::{self, Field, FieldType, image_at};
use crate::message::{EndRole, MessageKind, SEGMENT_VALUES};
use core::fmt::{Result, Write};
use octant_sample::parameters::NAMES;

/// Name of a sender as a node.
const fn node(role: EndRole) -> &'static str {
    match role {
        EndRole::Harness => "Harness",
        EndRole::Device => "Device",
        EndRole::Instrument => "Instrument",
    }
}

/// Name of a message's frame: `HarnessSample_0`, in FD `HarnessSampleFd_0`.
fn message_name(w: &mut impl Write, slot: Slot, segment: usize, format: CanVersion) -> Result {
    w.write_str(node(slot.sender))?;
    for word in slot.kind.name().split('_') {
        let mut letters = word.chars();
        if let Some(first) = letters.next() {
            w.write_char(first.to_ascii_uppercase())?;
            w.write_str(letters.as_str())?;
        }
    }
    if slot.kind == MessageKind::Parameters {
        write!(w, "{}", slot.parameters)?;
    }
    let fd = if format == CanVersion::Fd { "Fd" } else { "" };
    write!(w, "{fd}_{segment}")
}

/// A signal: a number at one place of one frame.
struct Signal {
    name: &'static str,
    /// Suffix of the name, if one field is several signals.
    part: Option<usize>,
    prefix: &'static str,
    /// First bit in the image.
    bit: usize,
    bits: usize,
    signed: bool,
    float: bool,
    factor: f64,
    unit: &'static str,
    values: &'static [&'static str],
    about: &'static str,
}

impl Signal {
    fn name(&self, w: &mut impl Write) -> Result {
        write!(w, "{}{}", self.prefix, self.name)?;
        self.part.map_or(Ok(()), |part| write!(w, "_{part}"))
    }
}

const CRC: Signal = Signal {
    name: "crc32",
    part: None,
    prefix: "",
    bit: 32,
    bits: 32,
    signed: false,
    float: false,
    factor: 1.0,
    unit: "",
    values: &[],
    about: "CRC-32 over the number of the slot and the payload",
};

/// Calls `each` with the signals of a field.
fn signals(slot: Slot, field: &Field, each: &mut dyn FnMut(&Signal) -> Result) -> Result {
    let signal = Signal {
        name: field.name,
        bit: 8 * image_at(field.at),
        bits: 8 * field.ty.bytes(),
        signed: field.ty == FieldType::I32,
        float: field.ty == FieldType::F64,
        factor: field.lsb,
        unit: field.unit,
        values: field.values,
        about: field.about,
        ..CRC
    };
    match field.ty {
        FieldType::Zero(_) => Ok(()),
        FieldType::Step(flag) => {
            each(&Signal { bits: 15, ..signal })?;
            let Some(name) = flag else { return Ok(()) };
            each(&Signal { name, bit: signal.bit + 15, bits: 1, about: "", ..signal })
        }
        // Eight bytes at a time: the most that one frame holds.
        FieldType::Bytes(bytes) | FieldType::Text(bytes) => (0..bytes / 8).try_for_each(|part| {
            each(&Signal { part: Some(part), bit: signal.bit + 64 * part, bits: 64, ..signal })
        }),
        FieldType::F64 if slot.kind == MessageKind::Parameters => {
            // Each parameter has its own name: the estimates come first, then their σ.
            let number = (field.at - 12) / 8;
            let index = SEGMENT_VALUES * usize::from(slot.parameters) + number % SEGMENT_VALUES;
            let prefix = if number < SEGMENT_VALUES { "" } else { "sigma_" };
            let (name, unit) = (NAMES[index], layout::parameter_unit(index));
            each(&Signal { name, prefix, unit, about: "", ..signal })
        }
        _ => each(&signal),
    }
}

/// Calls `each` with the signals of a frame, and with their first bit in it.
fn frame_signals(
    slot: Slot,
    segment: usize,
    format: CanVersion,
    each: &mut dyn FnMut(&Signal, usize) -> Result,
) -> Result {
    let room = 8 * format.room();
    let mut here = |signal: &Signal| {
        if signal.bit / room == segment { each(signal, signal.bit % room) } else { Ok(()) }
    };
    for field in layout::fields(slot.kind) {
        signals(slot, field, &mut here)?;
    }
    here(&CRC)
}

/// Calls `each` with every frame of both formats.
fn frames(each: &mut dyn FnMut(Slot, usize, CanVersion) -> Result) -> Result {
    for format in [CanVersion::Classic, CanVersion::Fd] {
        for slot in Slot::ALL {
            for segment in 0..slot.segments(format) {
                each(slot, segment, format)?;
            }
        }
    }
    Ok(())
}

/// Writes the database.
///
/// # Errors
/// If the writer fails.
pub fn write(w: &mut impl Write) -> Result {
    writeln!(w, "VERSION \"octant wire {}\"\n\n\nNS_ :\n\nBS_:\n", crate::VERSION)?;
    writeln!(
        w,
        "BU_: {} {} {}\n",
        node(EndRole::Harness),
        node(EndRole::Device),
        node(EndRole::Instrument)
    )?;
    frames(&mut |slot, segment, format| {
        write!(w, "BO_ {} ", slot.id(segment, format))?;
        message_name(w, slot, segment, format)?;
        writeln!(w, ": {} {}", slot.frame_bytes(segment, format), node(slot.sender))?;
        let receiver = match slot.sender {
            EndRole::Harness => "Device,Instrument",
            EndRole::Device | EndRole::Instrument => "Harness",
        };
        frame_signals(slot, segment, format, &mut |signal, bit| {
            write!(w, " SG_ ")?;
            signal.name(w)?;
            let sign = if signal.signed || signal.float { '-' } else { '+' };
            write!(w, " : {bit}|{}@1{sign} ({:?},0) [0|0]", signal.bits, Number(signal.factor))?;
            writeln!(w, " \"{}\" {receiver}", signal.unit)
        })?;
        writeln!(w)
    })?;
    comments(w)?;
    attributes(w)?;
    value_tables(w)
}

/// A factor, written without a decimal point if it is an integer.
struct Number(f64);

impl core::fmt::Debug for Number {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> Result {
        if self.0 == 1.0 { f.write_str("1") } else { write!(f, "{:e}", self.0) }
    }
}

fn comments(w: &mut impl Write) -> Result {
    writeln!(
        w,
        "CM_ \"Messages of octant on classic CAN and CAN FD. Identifier: bit 10 CAN FD, bits 9 to 5 slot, \
         bits 4 to 0 segment. A bus has one of the two formats. Made by octant-wire.\";"
    )?;
    for (role, about) in [
        (EndRole::Harness, "tests: sends samples, gets outputs"),
        (EndRole::Device, "is tested: gets samples, answers with outputs"),
        (EndRole::Instrument, "an inertial unit: sends samples on its own"),
    ] {
        writeln!(w, "CM_ BU_ {} \"{about}\";", node(role))?;
    }
    frames(&mut |slot, segment, format| {
        frame_signals(slot, segment, format, &mut |signal, _| {
            if signal.about.is_empty() {
                return Ok(());
            }
            write!(w, "CM_ SG_ {} ", slot.id(segment, format))?;
            signal.name(w)?;
            writeln!(w, " \"{}\";", signal.about)
        })
    })
}

fn attributes(w: &mut impl Write) -> Result {
    writeln!(w, "BA_DEF_ \"BusType\" STRING ;")?;
    // The list is fixed by the tools; this database uses 0 and 14.
    write!(w, "BA_DEF_ BO_ \"VFrameFormat\" ENUM \"StandardCAN\",\"ExtendedCAN\"")?;
    for _ in 2..14 {
        write!(w, ",\"reserved\"")?;
    }
    writeln!(w, ",\"StandardCAN_FD\",\"ExtendedCAN_FD\";")?;
    writeln!(w, "BA_DEF_DEF_ \"BusType\" \"CAN\";")?;
    writeln!(w, "BA_DEF_DEF_ \"VFrameFormat\" \"StandardCAN\";")?;
    writeln!(w, "BA_ \"BusType\" \"CAN FD\";")?;
    frames(&mut |slot, segment, format| match format {
        CanVersion::Classic => Ok(()),
        CanVersion::Fd => {
            writeln!(w, "BA_ \"VFrameFormat\" BO_ {} 14;", slot.id(segment, format))
        }
    })
}

fn value_tables(w: &mut impl Write) -> Result {
    frames(&mut |slot, segment, format| {
        frame_signals(slot, segment, format, &mut |signal, _| {
            if signal.values.is_empty() {
                return Ok(());
            }
            write!(w, "VAL_ {} ", slot.id(segment, format))?;
            signal.name(w)?;
            for (value, name) in signal.values.iter().enumerate().rev() {
                write!(w, " {value} \"{name}\"")?;
            }
            writeln!(w, " ;")
        })
    })?;
    frames(&mut |slot, segment, format| {
        frame_signals(slot, segment, format, &mut |signal, _| {
            if !signal.float {
                return Ok(());
            }
            write!(w, "SIG_VALTYPE_ {} ", slot.id(segment, format))?;
            signal.name(w)?;
            writeln!(w, " : 2;")
        })
    })
}
