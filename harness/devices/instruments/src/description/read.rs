//! A description from its text.

use super::checksum::checksum;
use super::fields::{ORDERS, Places, ReadField, fields};
use super::form::UnitForm;
use super::lines::lines;
use super::ranges::{Ranges, is_whole};
use super::record::record;
use super::table::{DescriptionProblem, Table, Text, VERSION};
use crate::described::{
    ByteOrder, FRAME_BYTES_MAX, FrameChecksum, FrameDescription, FrameField, RecordDescription,
    SYNC_BYTES_MAX,
};
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

/// Reads the name and the form of a unit.
pub(super) fn read(file: &str, text: &str) -> Result<(String, UnitForm), DescriptionProblem> {
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
    if let Some(key) = ["record", "line"].into_iter().find(|key| version < 2 && root.has(key)) {
        let what = format!("found in a description of version {version}, expected version = 2");
        return Err(root.problem(key, what));
    }
    root.only(match (root.has("record"), root.has("line")) {
        (true, false) => &["version", "name", "byte_order", "checksum", "record"],
        (false, true) => &["version", "name", "skip_lines", "line"],
        (false, false) if version < 2 => &["version", "name", "byte_order", "checksum", "frame"],
        _ => {
            &["version", "name", "byte_order", "checksum", "frame", "record", "line", "skip_lines"]
        }
    })?;
    let name = root.text("name")?.filter(|name| !name.is_empty()).map(ToOwned::to_owned);
    let name =
        name.ok_or_else(|| root.problem("name", "missing, expected the unit and its format"))?;
    if root.has("record") && root.has("line") {
        let what = "found beside record, expected one of [[frame]], [record] and [[line]]";
        return Err(root.problem("line", what));
    }
    let form = if root.has("record") {
        UnitForm::Records(record(&root)?)
    } else if root.has("line") {
        UnitForm::Lines(lines(&root)?)
    } else {
        UnitForm::Frames(frames(&root, version)?)
    };
    Ok((name, form))
}

/// Reads the frames of a unit.
fn frames(root: &Table<'_>, version: i64) -> Result<RecordDescription, DescriptionProblem> {
    let order = root.choice("byte_order", &ORDERS)?.unwrap_or_default();
    let checksum = root.table("checksum")?;
    let tables = root.tables("frame")?;
    if tables.is_empty() {
        let what = if version < 2 {
            "missing, expected one [[frame]] at least"
        } else {
            "missing, expected one [[frame]] at least, a [record] or a [[line]]"
        };
        return Err(root.problem("frame", what));
    }
    if let Some(key) = ["skip_lines"].into_iter().find(|key| root.has(key)) {
        return Err(root.problem(key, "found without a [[line]], expected it with lines alone"));
    }
    let mut frames = Vec::new();
    let mut ranges = Ranges::default();
    let given = Given { checksum: checksum.as_ref(), order, float_stamps: version >= 2 };
    for table in &tables {
        frame(table, &given, &mut ranges, &mut frames)?;
    }
    if !frames.iter().any(|frame| is_whole(frame.fields.iter().map(|field| &field.meaning))) {
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
    RecordDescription::new(&views, ranges.counter(), ranges.stamp())
        .map_err(|error| root.problem("frame", error.to_string()))
}

/// Settings that hold for all frames.
struct Given<'a> {
    checksum: Option<&'a Table<'a>>,
    order: ByteOrder,
    float_stamps: bool,
}

/// Reads the forms of a frame.
fn frame(
    table: &Table<'_>,
    given: &Given<'_>,
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
    let Given { order, float_stamps, .. } = *given;
    let own = table.table("checksum")?;
    let checksum_table = own.as_ref().or(given.checksum).ok_or_else(|| {
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
        let read = fields(table, Places::Bytes { bytes, order, float_stamps })?;
        for field in &read {
            ranges.take(table, field)?;
        }
        let fields = read.iter().filter_map(ReadField::of_frame).collect();
        frames.push(ReadFrame { sync, bytes, checksum, fields });
    }
    Ok(())
}
