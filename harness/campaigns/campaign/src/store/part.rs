//! One part file of a folder, and what its records are.

use super::error::PartError;
use super::frame::{Checksum, RecordKind, first};
use super::scan::{Found, scan};
use super::stored::{Stored, StoredId, StoredRecord};
use crate::execute::case::ResultError;
use std::fs::File;
use std::path::{Path, PathBuf};

/// A part file, open if there are few of them.
#[derive(Debug)]
pub(super) struct Part {
    pub(super) path: PathBuf,
    pub(super) file: Option<File>,
}

/// A part file with its results, and those of its records that don't count any more.
pub(super) struct ScannedPart {
    pub(super) part: Part,
    pub(super) stored: Vec<(StoredId, Stored)>,
    pub(super) forgotten: Vec<(Box<str>, Checksum)>,
    /// True if the last record was never completed.
    pub(super) is_torn: bool,
    /// Makers of its records, as they are stored.
    pub(super) makers: Vec<Vec<u8>>,
}

impl ScannedPart {
    /// Reads the heads of all records of a part, the part by its number.
    pub(super) fn of(path: &Path, part: u32, stays_open: bool) -> Result<Self, ResultError> {
        let (mut stored, mut forgotten, mut makers) = (Vec::new(), Vec::new(), Vec::new());
        let file = File::open(path).map_err(PartError::system("read", path))?;
        let scanned = scan(path, &file, |Found { mut head, offset, .. }| {
            if head.kind == RecordKind::Forgotten {
                forgotten.push((head.case.into_boxed_str(), first(&head.blake3)));
                return;
            }
            let has_facts = !head.facts.is_empty();
            let maker = place_in(&mut makers, std::mem::take(&mut head.maker));
            let time_ns = head.time_ns;
            let record = StoredRecord { time_ns, part, offset, has_facts, maker };
            stored.push((head.case.as_str().into(), Stored::Record(record)));
        })?;
        let part = Part { path: path.to_owned(), file: stays_open.then_some(file) };
        Ok(Self { part, stored, forgotten, is_torn: scanned.end < scanned.bytes, makers })
    }
}

/// Returns the place of a maker in a list, to which it is added. A list has few of them: after 65535 the last one stands for
/// all others, which are told as unknown.
pub(super) fn place_in(makers: &mut Vec<Vec<u8>>, maker: Vec<u8>) -> u16 {
    let place = makers.iter().rposition(|known| *known == maker).unwrap_or_else(|| {
        if makers.len() < usize::from(u16::MAX) {
            makers.push(maker);
        } else if makers.len() == usize::from(u16::MAX) {
            makers.push(Vec::new());
        }
        makers.len() - 1
    });
    u16::try_from(place).unwrap_or(u16::MAX)
}
