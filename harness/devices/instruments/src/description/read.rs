//! A description from its text.

use super::fields::{ORDERS, ReadField, fields, place};
use super::table::{DescriptionProblem, Table, Text, VERSION};
use crate::described::{
    ByteOrder, ChecksumKind, CrcParameters, DescribedCrc, FRAME_BYTES_MAX, FieldMeaning,
    FrameChecksum, FrameDescription, FrameField, FrameNumber, NumberType, RecordDescription,
    SYNC_BYTES_MAX,
};
use crate::rollover::Rollover;
use std::borrow::ToOwned;
use std::format;
use std::string::{String, ToString as _};
use std::vec::Vec;

/// A frame in one of its forms.
struct ReadFrame {
    sync: Vec<u8>,
    bytes: usize,
    checksum: Option<FrameChecksum>,
    fields: Vec<FrameField>,
}

/// Reads the name and the frames of a unit.
pub(super) fn read(
    file: &str,
    text: &str,
) -> Result<(String, RecordDescription), DescriptionProblem> {
    let text = Text { file, text };
    let table = octant_toml_tree::read(text.text)
        .map_err(|problem| text.problem(&problem.place, problem.message))?;
    let root = Table::root(text, &table);
    // First, so that a newer file is refused for that and not for its new keys.
    let version = root
        .integer("version", 1..=i64::MAX)?
        .ok_or_else(|| root.problem("version", format!("missing, expected version = {VERSION}")))?;
    if version > VERSION {
        let what = format!(
            "found {version}, but this program reads descriptions up to version {VERSION}: use a newer Octant"
        );
        return Err(root.problem("version", what));
    }
    root.only(&["version", "name", "byte_order", "checksum", "frame"])?;
    let name = root.text("name")?.filter(|name| !name.is_empty()).map(ToOwned::to_owned);
    let name =
        name.ok_or_else(|| root.problem("name", "missing, expected the unit and its format"))?;
    let order = root.choice("byte_order", &ORDERS)?.unwrap_or_default();
    let checksum = root.table("checksum")?;
    let tables = root.tables("frame")?;
    if tables.is_empty() {
        return Err(root.problem("frame", "missing, expected one [[frame]] at least"));
    }
    let mut frames = Vec::new();
    let mut ranges = Ranges::default();
    for table in &tables {
        frame(table, checksum.as_ref(), order, &mut ranges, &mut frames)?;
    }
    let is_whole = |frame: &&ReadFrame| {
        let has = |wanted: fn(&FieldMeaning) -> bool| {
            frame.fields.iter().any(|field| wanted(&field.meaning))
        };
        has(|meaning| matches!(meaning, FieldMeaning::Rotation { .. }))
            && has(|meaning| matches!(meaning, FieldMeaning::Velocity { .. }))
    };
    if !frames.iter().any(|frame| is_whole(&frame)) {
        let what = "found no frame with gyros and accelerometers, expected one at least: a reading has both";
        return Err(root.problem("frame", what));
    }
    let views: Vec<FrameDescription<'_>> = frames
        .iter()
        .map(|ReadFrame { sync, bytes, checksum, fields }| FrameDescription {
            sync,
            bytes: *bytes,
            checksum: *checksum,
            fields,
        })
        .collect();
    let rollover = |range: Option<Option<u64>>| match range {
        Some(Some(modulo)) => Rollover::modulo(modulo),
        Some(None) | None => Rollover::new(64),
    };
    let record = RecordDescription::new(&views, rollover(ranges.counter), rollover(ranges.stamp))
        .map_err(|error| root.problem("frame", error.to_string()))?;
    Ok((name, record))
}

/// Ranges of counter and clock, which are the same in all frames.
#[derive(Default)]
struct Ranges {
    counter: Option<Option<u64>>,
    stamp: Option<Option<u64>>,
}

impl Ranges {
    fn take(&mut self, table: &Table<'_>, read: &ReadField) -> Result<(), DescriptionProblem> {
        let (known, what) = match read.field.meaning {
            FieldMeaning::Counter => (&mut self.counter, "counter"),
            FieldMeaning::Stamp(_) => (&mut self.stamp, "stamp"),
            _ => return Ok(()),
        };
        if known.is_some_and(|known| known != read.modulo) {
            let range = |modulo: Option<u64>| modulo.map_or("2^64".to_owned(), |m| m.to_string());
            let message = format!(
                "the {what} has {} values, expected {} as in the frames before it",
                range(read.modulo),
                range(known.flatten())
            );
            return Err(table.problem("field", message));
        }
        *known = Some(read.modulo);
        Ok(())
    }
}

/// Reads the forms of a frame.
fn frame(
    table: &Table<'_>,
    checksum_of_all: Option<&Table<'_>>,
    order: ByteOrder,
    ranges: &mut Ranges,
    frames: &mut Vec<ReadFrame>,
) -> Result<(), DescriptionProblem> {
    table.only(&["name", "sync", "length", "forms", "checksum", "field"])?;
    // For people alone, but a text all the same.
    table.text("name")?;
    let mut forms = table.tables("forms")?;
    for form in &forms {
        form.only(&["sync", "length"])?;
    }
    if forms.is_empty() {
        forms.push(table.clone());
    } else if let Some(key) = ["sync", "length"].into_iter().find(|key| table.has(key)) {
        return Err(table.problem(key, "found beside forms, expected it in each of the forms"));
    }
    let own = table.table("checksum")?;
    let checksum_table = own.as_ref().or(checksum_of_all).ok_or_else(|| {
        table.problem(
            "checksum",
            "missing, expected a table with kind; kind = \"none\" if the frame has none",
        )
    })?;
    for form in &forms {
        let sync = form.bytes("sync", SYNC_BYTES_MAX)?;
        let alike =
            |other: &&ReadFrame| other.sync.starts_with(&sync) || sync.starts_with(&other.sync);
        if let Some(other) = frames.iter().find(alike) {
            let what = format!(
                "found {sync:02x?}, which can't be told from {:02x?} of a frame before it",
                other.sync
            );
            return Err(form.problem("sync", what));
        }
        let bytes = form.integer("length", sync.len() as i64..=FRAME_BYTES_MAX as i64)?;
        let bytes = bytes.ok_or_else(|| {
            form.problem("length", "missing, expected the number of the frame's bytes, its sync and checksum with them")
        })?;
        let bytes = usize::try_from(bytes).unwrap_or(FRAME_BYTES_MAX);
        let checksum = checksum(checksum_table, bytes, order)?;
        let read = fields(table, bytes, order)?;
        for field in &read {
            ranges.take(table, field)?;
        }
        let fields = read.into_iter().map(|read| read.field).collect();
        frames.push(ReadFrame { sync, bytes, checksum, fields });
    }
    Ok(())
}

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

fn checksum(
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
