//! Bits of a signal.

use super::{Database, DbcProblem, SignalMapping};
use crate::units::{self, Quantity};
use can_dbc::{ByteOrder, Message, MultiplexIndicator, Signal, SignalExtendedValueType, ValueType};
use std::format;
use std::string::{String, ToString};
use std::vec::Vec;

/// Type of the bits.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Bits {
    Unsigned,
    Signed,
    Float,
    Double,
}

/// Position of a value in the data of a message, and its scale.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extract {
    /// First byte read.
    byte: usize,
    /// Number of bits to the right of the value in the 16 bytes from there, in their order.
    shift: u32,
    little_endian: bool,
    /// Length in bits, 1 to 64.
    pub(super) size: u32,
    bits: Bits,
    /// Value in SI units = number · `factor` + `offset`.
    pub(super) factor: f64,
    pub(super) offset: f64,
}

impl Extract {
    /// Raw number in the bits.
    #[inline]
    pub(super) fn raw(&self, data: &[u8]) -> u64 {
        let mut window = [0; 16];
        let from = data.get(self.byte..).unwrap_or_default();
        let length = from.len().min(16);
        window[..length].copy_from_slice(&from[..length]);
        let all = if self.little_endian {
            u128::from_le_bytes(window)
        } else {
            u128::from_be_bytes(window)
        };
        (all >> self.shift) as u64 & (u64::MAX >> (64 - self.size))
    }

    /// Value in SI units.
    #[inline]
    pub(super) fn value(&self, data: &[u8]) -> f64 {
        let raw = self.raw(data);
        let number = match self.bits {
            Bits::Unsigned => raw as f64,
            // Shifts the sign bit to the top and back.
            Bits::Signed => (((raw << (64 - self.size)) as i64) >> (64 - self.size)) as f64,
            Bits::Float => f64::from(f32::from_bits(raw as u32)),
            Bits::Double => f64::from_bits(raw),
        };
        number * self.factor + self.offset
    }

    /// Value of one count, for integers.
    pub(super) fn lsb(&self) -> Option<f64> {
        let counts = matches!(self.bits, Bits::Unsigned | Bits::Signed) && self.offset == 0.0;
        counts.then_some(self.factor.abs())
    }

    /// True if the bits are an unsigned integer without offset and with a positive factor.
    pub(super) fn is_counter(&self) -> bool {
        self.bits == Bits::Unsigned && self.offset == 0.0 && self.factor > 0.0
    }
}

/// A signal named by a mapping.
pub(super) struct Named<'a> {
    pub(super) message: &'a Message,
    signal: &'a Signal,
    pub(super) extract: Extract,
    /// File and line of the signal.
    pub(super) place: String,
    key: String,
    mapping: &'a str,
}

impl<'a> Named<'a> {
    /// Finds a signal by `Message.signal`, reversed by a minus before it.
    pub(super) fn find(
        database: &'a Database,
        mapping: &'a SignalMapping,
        key: &str,
        name: &str,
    ) -> Result<Self, DbcProblem> {
        let wrong = |what: String| DbcProblem { place: format!("{}: {key}", mapping.file), what };
        let (sign, bare) = match name.strip_prefix('-') {
            Some(bare) => (-1.0, bare),
            None => (1.0, name),
        };
        let (message_name, signal_name) = bare
            .split_once('.')
            .ok_or_else(|| wrong(format!("`{name}` is no signal, expected is `Message.signal`")))?;
        let messages = &database.dbc.messages;
        let message = messages
            .iter()
            .find(|one| one.name == message_name)
            .ok_or_else(|| wrong(format!("{} has no message `{message_name}`", database.file)))?;
        let signal =
            message.signals.iter().find(|one| one.name == signal_name).ok_or_else(|| {
                let names: Vec<&str> =
                    message.signals.iter().map(|signal| signal.name.as_str()).collect();
                let place = database.place(message, None);
                wrong(format!(
                    "message `{message_name}` ({place}) has no signal `{signal_name}`, it has {}",
                    names.join(", ")
                ))
            })?;
        let place = database.place(message, Some(signal_name));
        let extract = extract(database, message, signal, sign).map_err(|what| DbcProblem {
            place: place.clone(),
            what: format!("signal `{signal_name}` {what}"),
        })?;
        let key = key.to_string();
        Ok(Self { message, signal, extract, place, key, mapping: &mapping.file })
    }

    fn wrong(&self, what: String) -> DbcProblem {
        DbcProblem { place: format!("{}: {}", self.mapping, self.key), what }
    }

    /// Sets the unit of the value: that of the database, or the given one, which must not contradict
    /// it.
    pub(super) fn in_unit(
        &mut self,
        given: Option<&str>,
        suitable: &[Quantity],
    ) -> Result<Quantity, DbcProblem> {
        let name = &self.signal.name;
        let own = self.signal.unit.trim();
        let place = &self.place;
        let expected = || units::names(suitable);
        let known = |text: &str| units::unit(text).filter(|(kind, _)| suitable.contains(kind));
        let unit = match given {
            Some(given) => {
                let unit = known(given).ok_or_else(|| {
                    self.wrong(format!(
                        "unit `{given}` doesn't fit, expected is one of {}",
                        expected()
                    ))
                })?;
                if units::unit(own).is_some_and(|own| own != unit) {
                    return Err(self.wrong(format!(
                        "signal `{name}` has unit `{own}` in the database ({place}), not `{given}`"
                    )));
                }
                unit
            }
            None if own.is_empty() => {
                return Err(self.wrong(format!(
                    "signal `{name}` ({place}) has no unit: say it, one of {}",
                    expected()
                )));
            }
            None => known(own).ok_or_else(|| {
                self.wrong(format!(
                    "signal `{name}` ({place}) has unit `{own}`, expected is one of {}",
                    expected()
                ))
            })?,
        };
        self.extract.factor *= unit.1;
        self.extract.offset *= unit.1;
        Ok(unit.0)
    }

    /// Checks that the value is a counter: an unsigned integer.
    pub(super) fn counter(&self) -> Result<(), DbcProblem> {
        if self.extract.is_counter() {
            return Ok(());
        }
        Err(self.wrong(format!(
            "signal `{}` ({}) is no counter: expected is an unsigned integer without an offset",
            self.signal.name, self.place
        )))
    }
}

/// Position and scale of a signal in the data, or the error in it.
fn extract(
    database: &Database,
    message: &Message,
    signal: &Signal,
    sign: f64,
) -> Result<Extract, String> {
    if signal.multiplexer_indicator != MultiplexIndicator::Plain
        && signal.multiplexer_indicator != MultiplexIndicator::Multiplexor
    {
        return Err("is multiplexed, which isn't supported".into());
    }
    let bits = match database.value_type(message.id, signal) {
        SignalExtendedValueType::IEEEfloat32Bit => Bits::Float,
        SignalExtendedValueType::IEEEdouble64bit => Bits::Double,
        SignalExtendedValueType::SignedOrUnsignedInteger => match signal.value_type {
            ValueType::Signed => Bits::Signed,
            ValueType::Unsigned => Bits::Unsigned,
        },
    };
    let (start, size) = (signal.start_bit, signal.size);
    let expected = match bits {
        Bits::Float => 32..=32,
        Bits::Double => 64..=64,
        Bits::Signed | Bits::Unsigned => 1..=64,
    };
    if !expected.contains(&size) {
        return Err(format!(
            "has {size} bits, expected are {} to {}",
            expected.start(),
            expected.end()
        ));
    }
    if message.size > 64 {
        return Err(format!("is in a message of {} bytes, a frame has at most 64", message.size));
    }
    let little_endian = signal.byte_order == ByteOrder::LittleEndian;
    // The start of a big-endian signal is its highest bit, counted from the low end of its byte.
    let first = if little_endian {
        Some(start)
    } else {
        start.checked_add(7).map(|beyond| beyond - 2 * (start % 8))
    };
    let fits =
        first.and_then(|first| first.checked_add(size)).is_some_and(|end| end <= 8 * message.size);
    let (Some(first), true) = (first, fits) else {
        return Err(format!(
            "of {size} bits from bit {start} doesn't fit in the {} bytes of its message",
            message.size
        ));
    };
    let within = (first % 8) as u32;
    let size = size as u32;
    Ok(Extract {
        byte: (first / 8) as usize,
        shift: if little_endian { within } else { 128 - within - size },
        little_endian,
        size,
        bits,
        factor: sign * signal.factor,
        offset: sign * signal.offset,
    })
}
