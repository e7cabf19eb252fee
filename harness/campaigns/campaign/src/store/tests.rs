//! The store: what is whole is read, an end that is torn counts as absent, and damage is told.

#![allow(clippy::unwrap_used, reason = "tests")]

use super::error::{PartError, ResultPlace};
use super::frame::{FILE_HEAD, SCHEMA, file_head};
use super::writer::PartWriter;
use super::{CampaignResults, StoreOutcome, file, forget_errors, has_at, keep, keep_in};
use crate::execute::case::{CaseResult, ResultError};
use proptest::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use tempfile::TempDir;

/// Errors are the smallest results that are consistent in themselves.
fn broken(case: &str, reason: &str) -> String {
    CaseResult::broken(case, reason.to_owned()).to_json().unwrap()
}

fn put(writer: &mut PartWriter, case: &str, text: &str) -> ResultPlace {
    match keep_in(writer, case, text.as_bytes(), &[]).unwrap() {
        StoreOutcome::New(place) => place,
        other => panic!("{other:?}"),
    }
}

/// A part of five results, with the bytes at which they begin and end.
struct Sample {
    folder: TempDir,
    part: PathBuf,
    bytes: Vec<u8>,
    ends: Vec<usize>,
}

const CASES: [&str; 5] = ["a1", "b2", "c3", "d4", "e5"];

static SAMPLE: LazyLock<Sample> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let mut writer = PartWriter::new(folder.path(), "1-of-1");
    let mut ends = vec![FILE_HEAD];
    let mut part = PathBuf::new();
    for (index, case) in CASES.iter().enumerate() {
        let reason: String = (0..40 * index).map(|k| format!("{}, ", k * k % 97)).collect();
        part = put(&mut writer, case, &broken(case, &reason)).path().to_owned();
        ends.push(usize::try_from(std::fs::metadata(&part).unwrap().len()).unwrap());
    }
    let bytes = std::fs::read(&part).unwrap();
    Sample { folder, part, bytes, ends }
});

/// A folder with one part of these bytes.
fn folder_of(bytes: &[u8]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let part = folder.path().join("results").join(SAMPLE.part.file_name().unwrap());
    std::fs::create_dir(folder.path().join("results")).unwrap();
    std::fs::write(part, bytes).unwrap();
    folder
}

/// Reads all results of a folder; each has to be that of the sample.
fn read(folder: &Path) -> Result<Vec<String>, ResultError> {
    let (results, whole) =
        (CampaignResults::open(folder)?, CampaignResults::open(SAMPLE.folder.path())?);
    let mut found = Vec::new();
    for case in results.ids() {
        assert_eq!(results.result(case)?, whole.result(case)?, "{case}");
        found.push(case.to_owned());
    }
    Ok(found)
}

/// Writes one more result, as the next run does.
fn go_on(folder: &Path) {
    put(&mut PartWriter::new(folder, "1-of-1"), "f6", &broken("f6", "more"));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    /// However much of a part is written when everything stops, its whole results are read, and the next
    /// writer goes on after them.
    #[test]
    fn a_part_that_ends_anywhere_has_its_whole_results(end in 0..=SAMPLE.bytes.len()) {
        let folder = folder_of(&SAMPLE.bytes[..end]);
        let whole = SAMPLE.ends[1..].iter().filter(|at| **at <= end).count();
        prop_assert_eq!(read(folder.path()).unwrap(), &CASES[..whole]);
        let part = folder.path().join("results").join(SAMPLE.part.file_name().unwrap());
        for (index, case) in CASES.iter().enumerate() {
            let is_there = has_at(&part, SAMPLE.ends[index] as u64, case).unwrap();
            prop_assert_eq!(is_there, index < whole, "{}", case);
        }
        go_on(folder.path());
        let results = CampaignResults::open(folder.path()).unwrap();
        prop_assert_eq!(results.len(), whole + 1);
        let place = results.place("f6").unwrap();
        let begin = SAMPLE.ends.iter().rfind(|at| **at <= end).copied().unwrap_or(FILE_HEAD) as u64;
        let name = SAMPLE.part.file_name().unwrap();
        let part = folder.path().join("results").join(name);
        prop_assert_eq!(place, ResultPlace::Record { part, offset: begin, case: "f6".to_owned() });
    }

    /// A flipped bit is an error that names file and byte, or, in the last result alone, makes it absent:
    /// no other result is ever read.
    #[test]
    fn a_flipped_bit_is_never_a_result(bit in 0..8 * SAMPLE.bytes.len()) {
        let mut bytes = SAMPLE.bytes.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        let folder = folder_of(&bytes);
        let record = SAMPLE.ends.iter().filter(|end| **end <= bit / 8).count();
        match (record, read(folder.path())) {
            (0, found) => prop_assert!(
                matches!(&found, Err(ResultError::Part(
                    PartError::Foreign { .. } | PartError::Version { .. }))),
                "{found:?}"
            ),
            (5, found) => prop_assert_eq!(found.unwrap(), &CASES[..4]),
            (_, found) => {
                let begin = SAMPLE.ends[record - 1] as u64;
                prop_assert!(
                    matches!(&found, Err(ResultError::Part(PartError::Damaged { path, offset, .. }))
                        if *offset == begin && path.starts_with(folder.path())),
                    "record {}: {:?}", record, found
                );
            }
        }
    }

    /// Bytes of anything are no results.
    #[test]
    fn any_bytes_are_no_results(bytes in prop::collection::vec(any::<u8>(), 0..300), has_head: bool) {
        let mut all = if has_head { file_head(SCHEMA).to_vec() } else { Vec::new() };
        all.extend(bytes);
        let found = CampaignResults::open(folder_of(&all).path());
        prop_assert!(found.is_err() || found.unwrap().is_empty());
    }
}

#[test]
fn a_newer_version_is_refused_in_words() {
    let mut bytes = file_head(SCHEMA + 1).to_vec();
    bytes.extend(&SAMPLE.bytes[FILE_HEAD..]);
    let told = CampaignResults::open(folder_of(&bytes).path()).unwrap_err().to_string();
    assert!(told.contains("found version 3") && told.contains("a newer Octant wrote it"), "{told}");
}

#[test]
fn a_result_is_kept_once_and_a_different_one_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let first = broken("a1", "first");
    assert!(matches!(keep(folder.path(), "a1", first.as_bytes()), Ok(StoreOutcome::New(_))));
    assert_eq!(keep(folder.path(), "a1", first.as_bytes()).unwrap(), StoreOutcome::Same);
    // Two writers that don't know of each other.
    put(&mut PartWriter::new(folder.path(), "2-of-2"), "a1", &first);
    let results = CampaignResults::open(folder.path()).unwrap();
    assert_eq!((results.len(), results.differing("a1").unwrap()), (1, None));
    let second = broken("a1", "second");
    let kept = keep(folder.path(), "a1", second.as_bytes()).unwrap();
    assert!(matches!(kept, StoreOutcome::Differs(_)));
    let results = CampaignResults::open(folder.path()).unwrap();
    assert!(results.differing("a1").unwrap().is_some());
    assert_eq!(results.bytes("a1").unwrap().unwrap().bytes, first.as_bytes());
}

#[test]
fn an_error_that_is_forgotten_does_not_count_and_the_same_one_after_it_does() {
    let folder = tempfile::tempdir().unwrap();
    let (old, new) = (broken("a1", "in a file"), broken("b2", "in a part"));
    let path = file(folder.path(), "a1");
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(&path, &old).unwrap();
    keep(folder.path(), "b2", new.as_bytes()).unwrap();
    keep(folder.path(), "c3", b"{}\n").unwrap();
    let forget = || {
        let results = CampaignResults::open(folder.path()).unwrap();
        let mut writer = PartWriter::new(folder.path(), "1-of-1");
        forget_errors(&results, &mut writer, results.ids()).unwrap();
        CampaignResults::open(folder.path()).unwrap()
    };
    assert_eq!(forget().ids().collect::<Vec<_>>(), ["c3"], "it can't be read, and stays");
    for (case, text) in [("a1", &old), ("b2", &new)] {
        put(&mut PartWriter::new(folder.path(), "1-of-1"), case, text);
    }
    let again = CampaignResults::open(folder.path()).unwrap();
    assert_eq!(again.ids().collect::<Vec<_>>(), ["a1", "b2", "c3"]);
    assert_eq!(again.bytes("b2").unwrap().unwrap().bytes, new.as_bytes());
    assert_eq!(forget().len(), 1);
    assert_eq!(std::fs::read_to_string(path).unwrap(), old, "nothing is changed");
}

/// Files of older versions and parts are one set of results.
#[test]
fn files_of_older_versions_are_read_beside_parts() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [("a1.json", broken("a1", "x")), ("a1.differs-1.json", broken("a1", "y"))] {
        let path = file(folder.path(), "a1").with_file_name(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    keep(folder.path(), "b2", broken("b2", "z").as_bytes()).unwrap();
    let results = CampaignResults::open(folder.path()).unwrap();
    assert_eq!(results.ids().collect::<Vec<_>>(), ["a1", "b2"]);
    assert!(results.differing("a1").unwrap().is_some());
    assert_eq!(results.differing("b2").unwrap(), None);
    let reason = |case: &str| results.result(case).unwrap().unwrap().0.error.unwrap();
    assert_eq!([reason("a1"), reason("b2")], ["x", "z"]);
}

/// Two writers at once have two files; one after another have one.
#[cfg(unix)]
#[test]
fn a_part_has_one_writer() {
    let folder = tempfile::tempdir().unwrap();
    let [mut first, mut second] = [(); 2].map(|()| PartWriter::new(folder.path(), "1-of-1"));
    let paths =
        [first.next_record().unwrap().0.to_owned(), second.next_record().unwrap().0.to_owned()];
    assert_ne!(paths[0], paths[1]);
    drop(first);
    assert_eq!(PartWriter::new(folder.path(), "1-of-1").next_record().unwrap().0, paths[0]);
    assert!(CampaignResults::open(folder.path()).unwrap().is_empty());
}

/// The last record is cut at each of its bytes, and each of its bytes is changed: it is absent, the others
/// are whole, and the next writer stores it again.
#[test]
fn a_last_result_that_is_torn_or_damaged_anywhere_is_absent() {
    let (begin, end) = (SAMPLE.ends[4], SAMPLE.ends[5]);
    let changed = (begin..end).map(|at| {
        let mut bytes = SAMPLE.bytes.clone();
        bytes[at] = !bytes[at];
        bytes
    });
    for bytes in (begin..end).map(|at| SAMPLE.bytes[..at].to_vec()).chain(changed) {
        let folder = folder_of(&bytes);
        assert_eq!(read(folder.path()).unwrap(), &CASES[..4]);
        let result = CampaignResults::open(SAMPLE.folder.path()).unwrap().bytes("e5").unwrap();
        let text = String::from_utf8(result.unwrap().bytes).unwrap();
        put(&mut PartWriter::new(folder.path(), "1-of-1"), "e5", &text);
        assert_eq!(read(folder.path()).unwrap(), CASES);
    }
}

/// A copy of a part, as a person makes it, adds nothing; what is forgotten in one is forgotten in both.
#[test]
fn a_copied_part_counts_once() {
    let folder = folder_of(&SAMPLE.bytes);
    let results = folder.path().join("results");
    let copy = || std::fs::copy(results.join("1-of-1.1.octres"), results.join("copy.octres"));
    copy().unwrap();
    assert_eq!(read(folder.path()).unwrap(), CASES);
    let there = CampaignResults::open(folder.path()).unwrap();
    for case in CASES {
        assert_eq!(there.differing(case).unwrap(), None);
    }
    let mut writer = PartWriter::new(folder.path(), "1-of-1");
    forget_errors(&there, &mut writer, ["c3"].into_iter()).unwrap();
    let left = CampaignResults::open(folder.path()).unwrap();
    assert_eq!((left.len(), left.has("c3")), (4, false));
    put(&mut writer, "c3", &broken("c3", "now"));
    copy().unwrap();
    let again = CampaignResults::open(folder.path()).unwrap();
    assert_eq!((again.len(), again.differing("c3").unwrap()), (5, None));
    let (result, _) = again.result("c3").unwrap().unwrap();
    assert_eq!(result.error.as_deref(), Some("now"));
}

/// A record that one of two workers stores, in any order.
#[derive(Clone, Copy, Debug)]
enum Stored {
    Result { case: usize, which: usize },
    TakeBack { case: usize },
}

fn stored() -> impl Strategy<Value = Vec<Stored>> {
    let result = (0..6_usize, 0..2_usize).prop_map(|(case, which)| Stored::Result { case, which });
    let take_back = (0..6_usize).prop_map(|case| Stored::TakeBack { case });
    proptest::collection::vec(prop_oneof![4 => result, 1 => take_back], 0..24)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Cases 0 to 3 count, 4 is after the end, and 5 isn't planned.
    #[test]
    fn each_stored_result_is_in_one_place_of_the_account(all in stored(), is_torn: bool) {
        let folder = tempfile::tempdir().unwrap();
        let mut writers = ["1-of-2", "2-of-2"].map(|name| PartWriter::new(folder.path(), name));
        // Results that count, by case, in their order; and how many were taken back.
        let (mut kept, mut taken_back) = (vec![Vec::new(); 6], 0);
        for (number, stored) in all.iter().enumerate() {
            match *stored {
                Stored::Result { case, which } => {
                    let id = format!("c{case}");
                    // An error that was taken back would take its equals with it: each time has its own text.
                    let text = broken(&id, &format!("{which} after {taken_back}"));
                    put(&mut writers[number % 2], &id, &text);
                    kept[case].push(text);
                }
                Stored::TakeBack { case } => {
                    let results = CampaignResults::open(folder.path()).unwrap();
                    let id = format!("c{case}");
                    forget_errors(&results, &mut writers[number % 2], [&*id].into_iter()).unwrap();
                    taken_back += kept[case].len() as u64;
                    kept[case].clear();
                }
            }
        }
        if is_torn {
            let path = put(&mut writers[0], "c0", &broken("c0", "torn")).path().to_owned();
            let length = std::fs::metadata(&path).unwrap().len();
            std::fs::File::options().write(true).open(&path).unwrap().set_len(length - 3).unwrap();
        }
        let results = CampaignResults::open(folder.path()).unwrap();
        let place = |id: &str| id.strip_prefix('c')?.parse::<usize>().ok().filter(|case| *case < 5);
        let cases = ["c0", "c1", "c2", "c3"];
        let account = results.account_of(place, cases.into_iter(), 4).unwrap();
        let count = |kind: &str| {
            account.entries().find(|(_, entry)| entry.kind.starts_with(kind)).map_or(0, |(_, e)| e.count)
        };
        let planned = &kept[..5];
        let again = |equal: bool| -> u64 {
            planned.iter().map(|of| of.iter().skip(1).filter(|text| (**text == of[0]) == equal).count() as u64).sum()
        };
        let records = kept.iter().map(|of| of.len() as u64).sum::<u64>();
        prop_assert_eq!(account.read(), records + taken_back + u64::from(is_torn));
        let used = kept[..4].iter().filter(|of| !of.is_empty()).count() as u64;
        prop_assert_eq!(account.used_count(), used);
        prop_assert_eq!(account.missing_count(), 4 - used);
        prop_assert_eq!(count("results that came again"), again(true));
        prop_assert_eq!(count("other results"), again(false));
        prop_assert_eq!(count("results after"), u64::from(!kept[4].is_empty()));
        prop_assert_eq!(count("results of cases that"), kept[5].len() as u64);
        prop_assert_eq!(count("results that a later"), taken_back);
        prop_assert_eq!(count("results of which"), u64::from(is_torn));
    }
}

/// Results of a program whose numbers aren't finite are no results: no facts stand for them.
#[test]
fn a_result_with_no_number_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (case, text) in [("a1", "NaN"), ("b2", "1e999"), ("c3", "null")] {
        let json = format!(
            "{{\"schema\":2,\"case\":\"{case}\",\"verdict\":\"pass\",\
            \"error\":null,\"summary\":{{\"verdict\":\"pass\",\"seed\":{text}}}}}\n"
        );
        keep(folder.path(), case, json.as_bytes()).unwrap();
        let results = CampaignResults::open(folder.path()).unwrap();
        assert!(results.has(case));
        let told = results.result(case).unwrap_err().to_string();
        assert!(told.contains(&format!("case {case} at byte")), "{told}");
    }
}

/// A result that was found consistent is not checked again, unless it is another one by then.
#[test]
fn a_result_that_was_consistent_is_read_again_and_another_one_in_its_place_is_checked() {
    let [one, other] = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    let text = broken("a1", "gone");
    let part = put(&mut PartWriter::new(one.path(), "1-of-1"), "a1", &text);
    let changed = text.replace(r#""verdict":"error""#, r#""verdict":"pass""#);
    assert_ne!(text, changed);
    let contradicts = put(&mut PartWriter::new(other.path(), "1-of-1"), "a1", &changed);
    let results = CampaignResults::open(one.path()).unwrap();
    let first = results.result("a1").unwrap().unwrap();
    assert_eq!(results.result("a1").unwrap().unwrap(), first);
    std::fs::write(part.path(), std::fs::read(contradicts.path()).unwrap()).unwrap();
    let found = results.result("a1");
    assert!(matches!(&found, Err(ResultError::Contradiction { .. })), "{found:?}");
}
