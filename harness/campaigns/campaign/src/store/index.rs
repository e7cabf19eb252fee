//! Finds every result in the folder of a campaign, and reads it.

use super::error::{PartError, ResultPlace};
use super::facts::CaseFacts;
use super::frame::{Checksum, first};
use super::part::{Part, ScannedPart, place_in};
use super::scan::{hex, read_checksum, read_head, read_whole};
use super::stored::{NotCounted, Stored, StoredFile, StoredId, StoredRecord, read_file};
use super::writer::{EXTENSION, FOLDER};
use crate::execute::case::{CaseResult, ResultError};
use crate::journal::Journal;
use crate::plan::{Case, Plan};
use octant_base::not_finite;
use octant_base::pool::{each_in_order, processors};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::ErrorKind;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Largest number of parts that stay open.
const OPEN_MAX: usize = 64;

/// The results in the folder of a campaign, as they were when it was opened.
#[derive(Debug)]
pub struct CampaignResults {
    parts: Vec<Part>,
    /// Results by the ids of their cases, those of a case in the order in which they count: a list, as a
    /// campaign can have millions.
    pub(super) stored: Vec<(StoredId, Stored)>,
    /// Beginning of the BLAKE3 of each result that was found consistent, in the order of `stored`; 0 for one that was
    /// not checked yet. A command reads a result several times, and a check takes most of the time.
    consistent: Vec<AtomicU64>,
    /// Number of cases that have a result.
    cases: usize,
    /// Records that count no more, or never did.
    pub(super) not_counted: NotCounted,
    /// Makers of the records, as they are stored.
    pub(super) makers: Vec<Vec<u8>>,
    /// Journal of the campaign.
    pub journal: Journal,
}

/// Bytes of a result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StoredResult {
    /// Place where it is stored.
    pub place: ResultPlace,
    /// The JSON object, with a line end.
    pub bytes: Vec<u8>,
    /// BLAKE3 of the bytes, hexadecimal.
    pub blake3: String,
}

impl CampaignResults {
    /// Finds the results in the folder of a campaign.
    ///
    /// # Errors
    /// If a part can't be read or is damaged: file, byte, found and expected. The end of a part that was
    /// never completed counts as absent.
    pub fn open(folder: &Path) -> Result<Self, ResultError> {
        let file = |(case, is_second, place): (String, bool, ResultPlace)| {
            let path = place.path().to_owned();
            (case.as_str().into(), Stored::File(Box::new(StoredFile { path, is_second })))
        };
        let mut stored: Vec<(StoredId, Stored)> = all_files(folder).into_iter().map(file).collect();
        let has_files = !stored.is_empty();
        let journal = Journal::read(folder)?;
        let paths = parts(&folder.join(FOLDER))?;
        let mut parts = Vec::with_capacity(paths.len());
        let stays_open = paths.len() <= OPEN_MAX;
        let mut forgotten: BTreeMap<Box<str>, BTreeSet<Checksum>> = BTreeMap::new();
        let mut not_counted = NotCounted::default();
        let mut makers = Vec::new();
        let read = |(): &mut (), part: usize| {
            let number = u32::try_from(part).unwrap_or(u32::MAX);
            paths.get(part).map(|path| ScannedPart::of(path, number, stays_open)).transpose()
        };
        each_in_order(
            processors(),
            paths.len(),
            || (),
            read,
            |found| {
                let Some(mut found) = found else { return Ok(()) };
                let places: Vec<u16> =
                    found.makers.drain(..).map(|maker| place_in(&mut makers, maker)).collect();
                for (_, stored) in &mut found.stored {
                    if let Stored::Record(record) = stored {
                        record.maker = places.get(usize::from(record.maker)).copied().unwrap_or(0);
                    }
                }
                parts.push(found.part);
                not_counted.torn += u64::from(found.is_torn);
                if stored.is_empty() {
                    stored = found.stored;
                } else {
                    stored.extend(found.stored);
                }
                for (case, own) in found.forgotten {
                    forgotten.entry(case).or_default().insert(own);
                }
                Ok::<_, ResultError>(())
            },
        )?;
        let order = |(a_case, a): &(StoredId, Stored), (b_case, b): &(StoredId, Stored)| {
            a_case.cmp(b_case).then_with(|| a.order(b))
        };
        if has_files {
            // The files of a case are in their order already.
            stored.sort_by(order);
        } else {
            // In place: there can be millions.
            stored.sort_unstable_by(order);
        }
        let mut found =
            Self { parts, stored, consistent: Vec::new(), cases: 0, not_counted, makers, journal };
        found.forget(&forgotten)?;
        found.consistent.resize_with(found.stored.len(), AtomicU64::default);
        Ok(found)
    }

    /// Removes what doesn't count any more, and cases of which only second results are left.
    fn forget(
        &mut self,
        forgotten: &BTreeMap<Box<str>, BTreeSet<Checksum>>,
    ) -> Result<(), ResultError> {
        let mut gone = BTreeSet::new();
        for (case, forgotten) in forgotten {
            let case = StoredId::from(&**case);
            let from = self.stored.partition_point(|(other, _)| *other < case);
            for (index, (_, stored)) in self.of(&case).iter().enumerate() {
                if forgotten.contains(&self.own(stored)?) {
                    gone.insert(from + index);
                }
            }
        }
        let mut from = 0;
        for of_case in self.stored.chunk_by(|(a, _), (b, _)| a == b) {
            let left = |index: &usize| !gone.contains(&(from + index));
            let counts = |index: usize| !of_case[index].1.is_beside();
            if (0..of_case.len()).filter(left).any(counts) {
                self.cases += 1;
            } else {
                gone.extend(from..from + of_case.len());
            }
            from += of_case.len();
        }
        self.not_counted.taken_back = gone.len() as u64;
        let mut index = 0;
        if !gone.is_empty() {
            self.stored.retain(|_| {
                index += 1;
                !gone.contains(&(index - 1))
            });
        }
        self.stored.shrink_to_fit();
        Ok(())
    }

    /// Returns the places of the results of a case.
    pub(super) fn range(&self, case: &str) -> Range<usize> {
        let case = StoredId::from(case);
        let from = self.stored.partition_point(|(other, _)| *other < case);
        let rest = self.stored.get(from..).unwrap_or_default();
        from..from + rest.iter().take_while(|(other, _)| *other == case).count()
    }

    /// Returns the results of a case.
    pub(super) fn of(&self, case: &str) -> &[(StoredId, Stored)] {
        self.stored.get(self.range(case)).unwrap_or_default()
    }

    /// Returns the cases that have a result, in the order of their ids: those that a plan can have come first.
    pub fn ids(&self) -> impl Iterator<Item = &str> {
        let cases = self.stored.chunk_by(|(a, _), (b, _)| a == b);
        cases.filter_map(|of_case| Some(&*of_case.first()?.0))
    }

    /// Number of cases that have a result.
    #[must_use]
    pub fn len(&self) -> usize {
        self.cases
    }

    /// Returns whether no case has a result.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.cases == 0
    }

    /// Returns whether a case has a result.
    #[must_use]
    pub fn has(&self, case: &str) -> bool {
        !self.of(case).is_empty()
    }

    /// Returns the place of the result of a case.
    #[must_use]
    pub fn place(&self, case: &str) -> Option<ResultPlace> {
        self.main(case).map(|stored| self.place_of(stored, case))
    }

    /// Returns the place of a second result of a case, which differs from the first.
    ///
    /// # Errors
    /// If a result has to be read to tell, and can't.
    pub fn differing(&self, case: &str) -> Result<Option<ResultPlace>, ResultError> {
        let all = self.of(case);
        if all.len() < 2 {
            return Ok(None);
        }
        let Some(main) = self.main(case) else { return Ok(None) };
        let mut blake3 = None;
        for (_, stored) in all {
            // A name is enough, whatever is in the file.
            if stored.is_beside() {
                return Ok(Some(self.place_of(stored, case)));
            }
            let found = self.blake3(stored)?;
            if found != *blake3.get_or_insert(self.blake3(main)?) {
                return Ok(Some(self.place_of(stored, case)));
            }
        }
        Ok(None)
    }

    /// Returns the BLAKE3 of every result of a case, hexadecimal.
    ///
    /// # Errors
    /// If a result has to be read for it, and can't.
    pub fn known(&self, case: &str) -> Result<Vec<String>, ResultError> {
        self.of(case).iter().map(|(_, stored)| Ok(hex(&self.blake3(stored)?))).collect()
    }

    /// Returns the time at which the result of a case was stored.
    #[must_use]
    pub fn time(&self, case: &str) -> Option<SystemTime> {
        match self.main(case)? {
            Stored::File(file) => std::fs::metadata(&file.path).ok()?.modified().ok(),
            Stored::Record(record) => UNIX_EPOCH.checked_add(Duration::from_nanos(record.time_ns)),
        }
    }

    /// Reads the bytes of the result of a case; `None` if it has none.
    ///
    /// # Errors
    /// If it can't be read, or is damaged.
    pub fn bytes(&self, case: &str) -> Result<Option<StoredResult>, ResultError> {
        let read = |stored| Ok(self.read(stored, case)?.0);
        self.main(case).map(read).transpose()
    }

    /// Reads the result of a case, with the BLAKE3 of its bytes; `None` if it has none. It is checked
    /// for consistency: its hashes, and its verdict with its values and limits.
    ///
    /// # Errors
    /// If it can't be read, or isn't the result of its case: found and expected.
    pub fn result(&self, case: &str) -> Result<Option<(CaseResult, String)>, ResultError> {
        let Some((at, stored)) = self.main_at(case) else { return Ok(None) };
        let (StoredResult { place, bytes, blake3 }, facts) = self.read(stored, case)?;
        let mark = blake3.get(..16).and_then(|digits| u64::from_str_radix(digits, 16).ok());
        let consistent = self.consistent.get(at).zip(mark.filter(|mark| *mark != 0));
        if consistent.is_some_and(|(known, mark)| known.load(Ordering::Relaxed) == mark) {
            return Ok(Some((CaseResult::unjudged(&place, &bytes)?, blake3)));
        }
        let result = CaseResult::from_bytes(&place, &bytes)?;
        if let Some(facts) = facts {
            let of_result = facts_of(&result);
            if facts != of_result {
                let text = |facts: &[u8]| String::from_utf8_lossy(facts).into_owned();
                let told = [text(&facts), text(&of_result)];
                let [facts, of_result] = told;
                let contradictions =
                    vec![format!("its facts are {facts}, its result gives {of_result}")];
                return Err(ResultError::Contradiction { place, contradictions });
            }
        }
        if let Some((known, mark)) = consistent {
            known.store(mark, Ordering::Relaxed);
        }
        Ok(Some((result, blake3)))
    }

    /// Reads the result of a planned case as [`CampaignResults::result`] does, and checks that it is that of
    /// the plan.
    ///
    /// # Errors
    /// If it can't be read, or isn't the result of its case: found and expected.
    pub fn of_plan(
        &self,
        plan: &Plan,
        case: &Case,
    ) -> Result<Option<(CaseResult, String)>, ResultError> {
        let found = self.result(&case.id)?;
        if let (Some((result, _)), Some(place), Ok(planned)) =
            (&found, self.place(&case.id), plan.planned(case))
        {
            result.belongs(&place, planned, case)?;
        }
        Ok(found)
    }

    /// Reads the facts of the result of a planned case; `None` if it has none. They are checked
    /// against the plan and for consistency; only where they aren't stored, the result is read.
    ///
    /// # Errors
    /// If they can't be read, or aren't those of the case: found and expected.
    pub fn facts(&self, plan: &Plan, case: &Case) -> Result<Option<CaseFacts>, ResultError> {
        let Some(stored) = self.main(&case.id) else { return Ok(None) };
        let Stored::Record(record @ StoredRecord { has_facts: true, .. }) = stored else {
            return Ok(self.of_plan(plan, case)?.map(|(result, _)| CaseFacts::of(&result)));
        };
        let place = self.place_of(stored, &case.id);
        let head = self.at(record, read_head)?;
        let form = |source| ResultError::Form { place: place.clone(), source };
        let facts: CaseFacts = not_finite::from_slice(&head.facts).map_err(form)?;
        facts.belongs(&place, plan.planned(case).ok(), case)?;
        Ok(Some(facts))
    }

    /// Returns the checksums of all results of a case that ended as errors, by which they can be
    /// forgotten. A result that can't be read is none of them.
    pub(crate) fn errors(&self, case: &str) -> Result<Vec<Checksum>, ResultError> {
        let all = self.of(case).iter().map(|(_, stored)| stored);
        all.filter(|stored| self.is_error(stored, case)).map(|stored| self.own(stored)).collect()
    }

    fn is_error(&self, stored: &Stored, case: &str) -> bool {
        let read = || -> Result<bool, ResultError> {
            let (StoredResult { place, bytes, .. }, _) = self.read(stored, case)?;
            Ok(CaseResult::from_bytes(&place, &bytes)?.error.is_some())
        };
        if let Stored::Record(record) = stored
            && record.has_facts
            && let Ok(head) = self.at(record, read_head)
            && let Ok(facts) = not_finite::from_slice::<CaseFacts>(&head.facts)
        {
            return facts.error.is_some();
        }
        read().unwrap_or(false)
    }

    /// BLAKE3 of a result. It isn't kept: few cases have more than one.
    pub(super) fn blake3(&self, stored: &Stored) -> Result<[u8; 32], ResultError> {
        match stored {
            Stored::File(file) => Ok(*blake3::hash(&read_file(&file.path)?).as_bytes()),
            Stored::Record(record) => Ok(self.at(record, read_head)?.blake3),
        }
    }

    /// Number of results that were taken back.
    #[must_use]
    pub fn taken_back(&self) -> u64 {
        self.not_counted.taken_back
    }

    /// Returns the checksum by which a result can be forgotten.
    fn own(&self, stored: &Stored) -> Result<Checksum, ResultError> {
        match stored {
            Stored::File(_) => Ok(first(&self.blake3(stored)?)),
            Stored::Record(record) => Ok(self.at(record, read_checksum)?),
        }
    }

    /// The result that counts: the first one.
    fn main(&self, case: &str) -> Option<&Stored> {
        self.main_at(case).map(|(_, stored)| stored)
    }

    /// The result that counts, with its place among all.
    pub(super) fn main_at(&self, case: &str) -> Option<(usize, &Stored)> {
        let mut all = self.range(case).filter_map(|at| Some((at, &self.stored.get(at)?.1)));
        all.find(|(_, stored)| !stored.is_beside())
    }

    fn path(&self, record: &StoredRecord) -> &Path {
        self.parts.get(record.part as usize).map_or(Path::new(""), |part| part.path.as_path())
    }

    /// Reads something of a record.
    fn at<T>(
        &self,
        record: &StoredRecord,
        read: impl Fn(&Path, &File, u64) -> Result<T, PartError>,
    ) -> Result<T, PartError> {
        let path = self.path(record);
        match self.parts.get(record.part as usize).and_then(|part| part.file.as_ref()) {
            Some(file) => read(path, file, record.offset),
            None => {
                let file = File::open(path).map_err(PartError::system("read", path))?;
                read(path, &file, record.offset)
            }
        }
    }

    fn place_of(&self, stored: &Stored, case: &str) -> ResultPlace {
        match stored {
            Stored::File(file) => ResultPlace::File(file.path.clone()),
            Stored::Record(record) => ResultPlace::Record {
                part: self.path(record).to_owned(),
                offset: record.offset,
                case: case.to_owned(),
            },
        }
    }

    /// Reads a result with the facts that are stored beside it.
    fn read(
        &self,
        stored: &Stored,
        case: &str,
    ) -> Result<(StoredResult, Option<Vec<u8>>), ResultError> {
        let place = self.place_of(stored, case);
        let (bytes, blake3, facts) = match stored {
            Stored::File(file) => {
                let bytes = read_file(&file.path)?;
                let blake3 = blake3::hash(&bytes);
                (bytes, blake3, None)
            }
            Stored::Record(record) => {
                let (head, bytes) = self.at(record, read_whole)?;
                // The bytes were held against it.
                let blake3 = blake3::Hash::from_bytes(head.blake3);
                (bytes, blake3, Some(head.facts).filter(|facts| !facts.is_empty()))
            }
        };
        let blake3 = blake3.to_hex().to_string();
        Ok((StoredResult { place, bytes, blake3 }, facts))
    }
}

/// Returns the bytes of the facts of a result.
pub(super) fn facts_of(result: &CaseResult) -> Vec<u8> {
    // Values of these types can always be serialised.
    serde_json::to_vec(&CaseFacts::of(result)).unwrap_or_default()
}

/// Lists the part files in a folder, in the order of their names.
fn parts(folder: &Path) -> Result<Vec<PathBuf>, ResultError> {
    let system = |source| ResultError::System { path: folder.to_owned(), source };
    let entries = match std::fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(system(error)),
    };
    let mut found = Vec::new();
    for entry in entries {
        let path = entry.map_err(system)?.path();
        if path.extension().is_some_and(|of| of == EXTENSION) {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

/// Folder of the files, in the folder of a campaign.
const CASES: &str = "cases";

/// Returns the result file of a case in the folder of its campaign, as versions before part files wrote it.
#[must_use]
pub fn file(folder: &Path, id: &str) -> PathBuf {
    folder.join(CASES).join(id.get(..2).unwrap_or("")).join(format!("{id}.json"))
}

/// Lists the results: each with its case, and whether it is a second one, stored beside another.
fn all_files(folder: &Path) -> Vec<(String, bool, ResultPlace)> {
    let read = |folder: PathBuf| std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut found: Vec<_> = read(folder.join(CASES))
        .flat_map(|part| read(part.path()))
        .filter_map(|entry| {
            let name = entry.file_name().to_string_lossy().into_owned();
            let name = name.strip_suffix(".json")?;
            let (id, rest) = name.split_once('.').unwrap_or((name, ""));
            let is_second = rest.starts_with("differs-");
            (is_second || rest.is_empty() && !id.is_empty())
                .then(|| (id.to_owned(), is_second, ResultPlace::File(entry.path())))
        })
        .collect();
    found.sort();
    found
}
