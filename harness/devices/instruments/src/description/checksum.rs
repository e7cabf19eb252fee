//! Checksum of a frame or a record.

use super::fields::{ORDERS, place};
use super::table::{DescriptionProblem, Table};
use crate::described::{
    ByteOrder, ChecksumKind, CrcParameters, DescribedCrc, FrameChecksum, FrameNumber, NumberType,
};
use std::format;

/// Kinds of checksums by their names; of a CRC its width.
#[derive(Clone, Copy)]
enum Named {
    None,
    Plain(ChecksumKind),
    Crc(u32),
}

const KINDS: [(&str, Named); 8] = [
    ("none", Named::None),
    ("sum8", Named::Plain(ChecksumKind::Sum8)),
    ("sum16", Named::Plain(ChecksumKind::Sum16)),
    ("words16", Named::Plain(ChecksumKind::Words16)),
    ("xor8", Named::Plain(ChecksumKind::Xor8)),
    ("crc8", Named::Crc(8)),
    ("crc16", Named::Crc(16)),
    ("crc32", Named::Crc(32)),
];

/// Reads the checksum of so many bytes.
pub(super) fn checksum(
    table: &Table<'_>,
    frame_bytes: usize,
    order: ByteOrder,
) -> Result<Option<FrameChecksum>, DescriptionProblem> {
    const PLACES: [&str; 6] = ["kind", "from", "to", "at", "byte_order", "pad_to"];
    let kind = match table.needed_choice("kind", &KINDS)? {
        Named::None => {
            table.only(&["kind"])?;
            return Ok(None);
        }
        Named::Plain(kind) => {
            table.only(&PLACES)?;
            kind
        }
        Named::Crc(width) => {
            table.only(
                &[&PLACES[..], &["poly", "init", "refin", "refout", "xorout", "check"]].concat(),
            )?;
            ChecksumKind::Crc(crc(table, width)?)
        }
    };
    let order = table.choice("byte_order", &ORDERS)?.unwrap_or(order);
    let size = kind.bytes();
    let missing =
        || table.problem("at", "missing, expected the offset of the checksum's first byte");
    let at = place(table, "at", size, frame_bytes)?.ok_or_else(missing)?;
    let from = place(table, "from", 0, frame_bytes)?.unwrap_or(0);
    let to = place(table, "to", 0, frame_bytes)?.unwrap_or(at);
    if from >= to {
        let what =
            format!("it covers the bytes from {from} to before {to}, expected one byte at least");
        return Err(table.problem_of_all(what));
    }
    if at < to && at + size > from {
        let what = format!(
            "it covers the bytes from {from} to before {to}, expected bytes without the checksum itself, at {at}"
        );
        return Err(table.problem_of_all(what));
    }
    let pad_to = table.integer("pad_to", 1..=64)?.unwrap_or(1);
    let number = FrameNumber::whole(at, NumberType::Unsigned(size as u8), order);
    Ok(Some(FrameChecksum { kind, from, to, pad_to: usize::try_from(pad_to).unwrap_or(1), number }))
}

fn crc(table: &Table<'_>, width: u32) -> Result<DescribedCrc, DescriptionProblem> {
    let most = (1i64 << width) - 1;
    let word = |key: &str| -> Result<Option<u32>, DescriptionProblem> {
        Ok(table.integer(key, 0..=most)?.and_then(|word| u32::try_from(word).ok()))
    };
    let needed = |key: &str, value: Option<u32>| {
        value.ok_or_else(|| table.problem(key, "missing, expected a parameter of the CRC"))
    };
    let flag = |key: &str| -> Result<bool, DescriptionProblem> {
        let what = "missing, expected true or false: whether bits are reflected";
        table.boolean(key)?.ok_or_else(|| table.problem(key, what))
    };
    let crc = DescribedCrc::new(CrcParameters {
        width,
        poly: needed("poly", word("poly")?)?,
        init: needed("init", word("init")?)?,
        refin: flag("refin")?,
        refout: flag("refout")?,
        xorout: needed("xorout", word("xorout")?)?,
    });
    if let Some(check) = word("check")? {
        let computed = crc.of(b"123456789".iter().copied());
        if computed != check {
            let what = format!(
                "found {check:#x}, but these parameters give {computed:#x} of the characters 123456789"
            );
            return Err(table.problem("check", what));
        }
    }
    Ok(crc)
}
