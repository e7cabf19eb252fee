//! Stores results: each once, and a different one beside it.

use super::error::{PartError, ResultPlace};
use super::frame::RecordKind;
use super::index::{CampaignResults, facts_of};
use super::scan::read_whole;
use super::writer::{NewResult, PartWriter};
use crate::execute::case::{CaseResult, ResultError};
use std::fs::File;
use std::path::Path;

/// Outcome of storing a result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StoreOutcome {
    /// The result was written.
    New(ResultPlace),
    /// The same bytes were there already.
    Same,
    /// A different result was there: the same case has two results. This one is stored beside it.
    Differs(ResultPlace),
}

/// Stores a result in a part: not if it is one of those `known` by their BLAKE3, and never over a
/// different one.
///
/// # Errors
/// If the operating system refuses; nothing of the result is stored then.
pub fn keep_in(
    writer: &mut PartWriter,
    case: &str,
    bytes: &[u8],
    known: &[String],
) -> Result<StoreOutcome, PartError> {
    let hash = blake3::hash(bytes).to_hex();
    if known.iter().any(|known| known == hash.as_str()) {
        return Ok(StoreOutcome::Same);
    }
    // Facts stand for a result that was checked. Any other one is always read in full.
    let place = ResultPlace::Record { part: "".into(), offset: 0, case: case.to_owned() };
    let facts = CaseResult::from_bytes(&place, bytes).map_or_else(|_| Vec::new(), |r| facts_of(&r));
    let place = writer.append(NewResult { case, bytes, facts: &facts })?;
    Ok(if known.is_empty() { StoreOutcome::New(place) } else { StoreOutcome::Differs(place) })
}

/// Stores one result in the folder of a campaign, as [`keep_in`] does.
///
/// # Errors
/// If the results there can't be read, or the operating system refuses.
pub fn keep(folder: &Path, case: &str, bytes: &[u8]) -> Result<StoreOutcome, ResultError> {
    let known = CampaignResults::open(folder)?.known(case)?;
    Ok(keep_in(&mut PartWriter::new(folder, "kept"), case, bytes, &known)?)
}

/// Notes that the results of the given cases don't count any more, of those that ended as errors.
/// The results stay where they are.
///
/// # Errors
/// If the operating system refuses.
pub fn forget_errors<'a>(
    results: &CampaignResults,
    writer: &mut PartWriter,
    cases: impl Iterator<Item = &'a str>,
) -> Result<(), ResultError> {
    for case in cases {
        for own in results.errors(case)? {
            writer.forget(case, own)?;
        }
    }
    Ok(())
}

/// Returns whether a part has a whole result of a case at a byte.
///
/// # Errors
/// If the operating system refuses.
pub fn has_at(part: &Path, offset: u64, case: &str) -> Result<bool, PartError> {
    let file = File::open(part).map_err(PartError::system("read", part))?;
    match read_whole(part, &file, offset) {
        Ok((head, _)) => Ok(head.kind == RecordKind::Result && head.case == case),
        Err(PartError::Damaged { .. }) => Ok(false),
        Err(error) => Err(error),
    }
}
