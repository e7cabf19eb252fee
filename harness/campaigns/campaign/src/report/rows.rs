//! Reads each case's result once, and keeps the parts that a report needs: in a temporary file, as a
//! campaign can have millions of cases.

pub use super::curves::Curve;
pub use super::outcome::{CaseDrift, RowOutcome};

use super::curves::{CurveFile, CurveWriter};
use super::error::ReportError;
use super::outcome::ReadOutcome;
use super::row_bytes::{ErrorNames, decode, decode_drift, encode};
use crate::judge::independence;
use crate::judge::twins::{SharedTwins, TwinsSaid};
use crate::plan::{Case, Plan};
use crate::store::CampaignResults;
use crate::store::in_plan_order::{RESULTS_AT_ONCE, read_in_order};
use crate::store::result_error::ResultError;
use crate::store::stream_key::StreamKey;
use octant_verdict::Verdict;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::sync::{Arc, Mutex, PoisonError};

/// Bytes that are written at a time.
const WRITTEN: usize = 1 << 20;
/// Bytes that are read at a time.
const WINDOW: u64 = 1 << 18;

/// Case with its result.
#[derive(Clone, Debug)]
pub struct ReportRow<'a> {
    /// The case.
    pub case: &'a Case,
    /// Result; `None` if the case hasn't run.
    pub outcome: Option<RowOutcome>,
}

/// Rows of a plan, in a temporary file. A row that can't be read is like one of a case that hasn't run, and
/// [`ReportRows::error`] tells of it.
#[derive(Debug)]
pub struct ReportRows<'a> {
    cases: &'a [Case],
    /// End of each row in the file.
    ends: Vec<u64>,
    /// Facts of each row that are kept in memory.
    known: Vec<KnownRow>,
    names: ErrorNames,
    /// The file without a name, and the first error of reading it.
    file: Mutex<(Option<File>, Option<io::Error>)>,
    curves: Arc<CurveFile>,
}

/// Verdict of a case that has run, and whether it navigated.
#[derive(Clone, Copy, Debug)]
struct KnownRow {
    verdict: Option<Verdict>,
    navigated: bool,
    has_effect: bool,
}

/// Statement of a result on its twins, if it has any.
type Twins = Option<TwinsSaid>;

/// Reads the rows of a plan up to `end`, and one hash of all results.
///
/// # Errors
/// If an existing result can't be read.
pub fn read<'a>(
    plan: &'a Plan,
    results: &CampaignResults,
    end: usize,
) -> Result<(ReportRows<'a>, String), ReportError> {
    let cases = plan.cases.get(..end).unwrap_or(&plan.cases);
    let mut hasher = blake3::Hasher::new();
    let mut curves = CurveWriter::new();
    let mut rows = ReportRows::new(cases, curves.file());
    let mut bytes = Vec::new();
    let wrong = |source| ReportError::System {
        action: "keep the results of cases in",
        path: std::env::temp_dir(),
        source,
    };
    let mut shared = SharedTwins::default();
    // No case, a case without a result, or one with it.
    type Read = Option<Option<(ReadOutcome, String, Twins)>>;
    let read = |place: usize| -> Result<Read, ReportError> {
        let Some(case) = cases.get(place) else { return Ok(None) };
        let Some((result, hash)) = results.of_plan(plan, case)? else { return Ok(Some(None)) };
        let differs = results.differing(&case.id)?.is_some();
        let twins = TwinsSaid::of(case, result.summary.as_ref());
        Ok(Some(Some((ReadOutcome::of(result, differs), hash, twins))))
    };
    read_in_order(cases.len(), RESULTS_AT_ONCE, read, |place, read| {
        let Some(case) = cases.get(place) else { return Ok(()) };
        let Some((outcome, hash, twins)) = read else {
            hasher.update(format!("{} -\n", case.id).as_bytes());
            return rows.push(None, &mut bytes).map_err(wrong);
        };
        hasher.update(format!("{} {hash}\n", case.id).as_bytes());
        if let Some(reason) = shared.contradiction(twins)
            && let Some(place) = results.place(&case.id)
        {
            return Err(ResultError::Twins { place, reason }.into());
        }
        let outcome = outcome.keep(&mut curves).map_err(wrong)?;
        rows.push(Some(&outcome), &mut bytes).map_err(wrong)
    })?;
    curves.flush().map_err(wrong)?;
    rows.flush(&mut bytes).map_err(wrong)?;
    Ok((rows, hasher.finalize().to_hex().to_string()))
}

/// Returns the independent draw of each row.
pub(super) fn draws(rows: &ReportRows<'_>) -> Vec<u32> {
    let stream = |row: ReportRow<'_>| -> Option<StreamKey> {
        Some(row.outcome?.stream_hash?.as_str().into())
    };
    let streams: Vec<Option<StreamKey>> = rows.iter().map(stream).collect();
    independence::draws(rows.cases.iter().zip(streams.iter().map(Option::as_ref)))
}

impl<'a> ReportRows<'a> {
    fn new(cases: &'a [Case], curves: Arc<CurveFile>) -> Self {
        Self {
            cases,
            ends: Vec::with_capacity(cases.len()),
            known: Vec::with_capacity(cases.len()),
            names: ErrorNames::new(),
            file: Mutex::default(),
            curves,
        }
    }

    fn push(&mut self, outcome: Option<&RowOutcome>, bytes: &mut Vec<u8>) -> io::Result<()> {
        let (before, last) = (bytes.len(), self.ends.last().copied().unwrap_or(0));
        outcome.inspect(|outcome| encode(outcome, &mut self.names, bytes));
        self.ends.push(last + (bytes.len() - before) as u64);
        self.known.push(KnownRow {
            verdict: outcome.map(|outcome| outcome.verdict),
            navigated: outcome.is_some_and(|outcome| outcome.drift.is_some()),
            has_effect: outcome.is_some_and(|outcome| outcome.effect.is_some()),
        });
        if bytes.len() >= WRITTEN { self.flush(bytes) } else { Ok(()) }
    }

    fn flush(&mut self, bytes: &mut Vec<u8>) -> io::Result<()> {
        let (file, _) = self.file.get_mut().unwrap_or_else(PoisonError::into_inner);
        let file = match file {
            Some(file) => file,
            none => none.insert(tempfile::tempfile()?),
        };
        file.write_all(bytes)?;
        bytes.clear();
        Ok(())
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.cases.len()
    }

    /// Returns whether there is no row.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.cases.is_empty()
    }

    /// Returns the case of a row.
    #[must_use]
    pub fn case(&self, place: usize) -> Option<&'a Case> {
        self.cases.get(place)
    }

    /// Returns the verdict of a case; `None` if it hasn't run.
    #[must_use]
    pub fn verdict(&self, place: usize) -> Option<Verdict> {
        self.known.get(place)?.verdict
    }

    /// Returns whether a case has run.
    #[must_use]
    pub fn has_run(&self, place: usize) -> bool {
        self.verdict(place).is_some()
    }

    /// Returns whether a case has a drift.
    #[must_use]
    pub fn has_drift(&self, place: usize) -> bool {
        self.known.get(place).is_some_and(|known| known.navigated)
    }

    /// Returns whether a case has an effect of its faults, against its twin.
    #[must_use]
    pub fn has_effect(&self, place: usize) -> bool {
        self.known.get(place).is_some_and(|known| known.has_effect)
    }

    /// Takes the first error of reading a row, or the drift of one.
    #[must_use]
    pub fn error(&self) -> Option<io::Error> {
        let of_rows = self.file.lock().unwrap_or_else(PoisonError::into_inner).1.take();
        of_rows.or_else(|| self.curves.error())
    }

    /// Reads all rows.
    pub fn iter(&self) -> impl Iterator<Item = ReportRow<'a>> {
        self.at(0..self.len())
    }

    /// Reads the rows of these cases, given by their places; those that lie near each other are best read
    /// one after another.
    pub fn at<P: IntoIterator<Item = usize>>(
        &self,
        places: P,
    ) -> impl Iterator<Item = ReportRow<'a>> + use<'_, 'a, P> {
        let mut window = RowWindow { start: 0, bytes: Vec::new() };
        places.into_iter().filter_map(move |place| self.row(place, &mut window))
    }

    /// Reads the cases at these places, each with its drift, as [`ReportRows::at`] does.
    pub(super) fn drifts_at<P: IntoIterator<Item = usize>>(
        &self,
        places: P,
    ) -> impl Iterator<Item = (&'a Case, Option<CaseDrift>)> + use<'_, 'a, P> {
        let mut window = RowWindow { start: 0, bytes: Vec::new() };
        places.into_iter().filter_map(move |place| {
            let case = self.cases.get(place)?;
            let drift = self.known.get(place)?.navigated.then(|| {
                self.read(place, &mut window, |bytes| {
                    decode_drift(bytes, &self.names, &self.curves)
                })
            });
            Some((case, drift.flatten().flatten()))
        })
    }

    fn row(&self, place: usize, window: &mut RowWindow) -> Option<ReportRow<'a>> {
        let case = self.cases.get(place)?;
        let outcome = self
            .has_run(place)
            .then(|| self.read(place, window, |bytes| decode(bytes, &self.names, &self.curves)));
        Some(ReportRow { case, outcome: outcome.flatten() })
    }

    /// Reads the bytes of a row; `None` where that fails, which [`ReportRows::error`] tells.
    fn read<T>(
        &self,
        place: usize,
        window: &mut RowWindow,
        decode: impl FnOnce(&[u8]) -> Option<T>,
    ) -> Option<T> {
        let end = *self.ends.get(place)?;
        let start = place.checked_sub(1).map_or(Some(0), |last| self.ends.get(last).copied())?;
        let decoded = self.bytes(start, end, window).and_then(|bytes| {
            decode(bytes).ok_or_else(|| io::Error::other("what was written is not what is read"))
        });
        let keep = |error| {
            let mut inner = self.file.lock().unwrap_or_else(PoisonError::into_inner);
            inner.1.get_or_insert(error);
        };
        decoded.map_err(keep).ok()
    }

    /// Returns the bytes of a row.
    fn bytes<'w>(&self, start: u64, end: u64, window: &'w mut RowWindow) -> io::Result<&'w [u8]> {
        if start < window.start || end > window.start + window.bytes.len() as u64 {
            let last = self.ends.last().copied().unwrap_or(0);
            let length = (end - start).max(WINDOW).min(last - start);
            let length = usize::try_from(length).map_err(io::Error::other)?;
            window.bytes.resize(length, 0);
            window.start = start;
            let mut inner = self.file.lock().unwrap_or_else(PoisonError::into_inner);
            let file = inner.0.as_mut().ok_or(io::ErrorKind::UnexpectedEof)?;
            file.seek(SeekFrom::Start(start))?;
            file.read_exact(&mut window.bytes)?;
        }
        let range = |at: u64| usize::try_from(at - window.start).map_err(io::Error::other);
        let (from, to) = (range(start)?, range(end)?);
        window.bytes.get(from..to).ok_or_else(|| io::ErrorKind::UnexpectedEof.into())
    }
}

/// Bytes of the file that were read last.
struct RowWindow {
    start: u64,
    bytes: Vec<u8>,
}
