//! Accounts of documents: each object is counted once, whatever becomes of it.

use crate::texts::reqif_of;
use octant_requirements::exchange::{self, Anything};
use octant_requirements::mapping::Mapping;
use octant_requirements::{Imported, needs, reqif, sdoc};
use octant_verdict::file;
use octant_verdict::requirement::{Requirement, Requirements, Verification};
use proptest::collection::vec;
use proptest::prelude::*;
use std::fmt::Write as _;

/// Content of an object, from which its fate follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Content {
    Good,
    NoText,
    /// The id of the first object.
    Again,
    /// A part that can't be read, or isn't defined.
    Bad,
    /// No requirement, by what it says of itself.
    Information,
    Repaired,
}

use Content::{Again, Bad, Good, Information, NoText, Repaired};

/// Objects in any order behind a good one.
fn contents() -> impl Strategy<Value = Vec<Content>> {
    let any = prop_oneof![
        Just(Good),
        Just(NoText),
        Just(Again),
        Just(Bad),
        Just(Information),
        Just(Repaired)
    ];
    vec(any, 0..30).prop_map(|all| [vec![Good], all].concat())
}

fn check(found: &Imported, all: &[Content]) -> Result<(), TestCaseError> {
    let count = |of: &[Content]| all.iter().filter(|one| of.contains(one)).count() as u64;
    let account = &found.account;
    prop_assert_eq!(account.read(), all.len() as u64, "{:?}", account);
    prop_assert_eq!(account.used_count(), count(&[Good, Repaired]), "{:?}", account);
    prop_assert_eq!(account.repaired_count(), count(&[Repaired]), "{:?}", account);
    prop_assert_eq!(account.left_out_count(), count(&[NoText, Again, Bad, Information]));
    prop_assert_eq!(found.requirements.requirements.len() as u64, account.used_count());
    prop_assert_eq!(found.skipped(), count(&[NoText, Again, Bad]), "{:?}", account);
    prop_assert_eq!(account.doubts().is_empty(), found.skipped() == 0);
    // It is stored with the requirements.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.toml");
    exchange::write(&path, found, "", false).unwrap();
    let back = exchange::read(&path, None, &Anything).unwrap();
    prop_assert_eq!(&back.requirements.accounts, &vec![account.clone()]);
    prop_assert_eq!(back.requirements.doubts(), account.doubts());
    Ok(())
}

fn as_reqif(all: &[Content]) -> String {
    let texts: Vec<&str> = (all.iter())
        .map(|content| match content {
            NoText => "",
            Repaired => "kept<h:del>deleted</h:del>",
            _ => "It holds.",
        })
        .collect();
    let mut text = reqif_of(&texts).replace(
        "</SPEC-OBJECT-TYPE></SPEC-TYPES>",
        "</SPEC-OBJECT-TYPE><SPEC-OBJECT-TYPE IDENTIFIER=\"info\" LONG-NAME=\"Information\"/></SPEC-TYPES>",
    );
    for (at, content) in all.iter().enumerate() {
        let of = |name: &str| format!("\"o{at}\"><TYPE><SPEC-OBJECT-TYPE-REF>{name}<");
        match content {
            Bad => text = text.replace(&of("t"), &of("gone")),
            Information => text = text.replace(&of("t"), &of("info")),
            Again if at % 2 == 0 => {
                text = text.replace(&of("t"), &of("t").replace(&format!("o{at}"), "o0"))
            }
            Again => text = text.replace(&format!("\"N-{at}\""), "\"N-0\""),
            _ => {}
        }
    }
    text
}

fn as_sdoc(all: &[Content]) -> String {
    let mut text = "[DOCUMENT]\nTITLE: T\n".to_owned();
    for (at, content) in all.iter().enumerate() {
        let node = match content {
            Good => format!("[REQUIREMENT]\nUID: N-{at}\nSTATEMENT: >>>\nIt\n\n[holds].\n<<<\n"),
            NoText => format!("[REQUIREMENT]\nUID: N-{at}\nCOMMENT: x\n"),
            Again => "[REQUIREMENT]\nUID: N-0\nSTATEMENT: x\n".to_owned(),
            Bad => format!("[REQUIREMENT]\nUID: N-{at}\nSTATEMENT\n"),
            Information => "[TEXT]\nSTATEMENT: x\n".to_owned(),
            Repaired => format!("[REQUIREMENT]\nMID: {at}\nSTATEMENT: x\n"),
        };
        _ = write!(text, "\n{node}");
    }
    text
}

fn as_needs(all: &[Content]) -> String {
    let needs: Vec<String> = (all.iter().enumerate())
        .map(|(at, content)| match content {
            Good => format!("\"N_{at}\": {{\"title\": \"t\", \"content\": \"\\\"N_0\\\": {{\"}}"),
            NoText => format!("\"N_{at}\": {{\"content\": \" \"}}"),
            Again => "\"N_0\": {\"title\": \"t\"}".to_owned(),
            Bad => format!("\"N_{at}\": [1]"),
            Information => format!("\"N_{at}\": {{\"type\": \"test\", \"title\": \"t\"}}"),
            Repaired => format!("\"N_{at}\": {{\"title\": \"t\", \"arch\": {{\"a\": 1}}}}"),
        })
        .collect();
    let needs = needs.join(",\n");
    format!("{{\"current_version\": \"1\", \"versions\": {{\"1\": {{\"needs\": {{\n{needs}}}}}}}}}")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn each_object_of_a_reqif_is_counted_once(all in contents()) {
        check(&reqif::read(&as_reqif(&all), "d.reqif").unwrap(), &all)?;
    }

    #[test]
    fn each_node_of_an_sdoc_is_counted_once(all in contents()) {
        check(&sdoc::read(&as_sdoc(&all), "d.sdoc").unwrap(), &all)?;
    }

    #[test]
    fn each_need_is_counted_once(all in contents()) {
        check(&needs::read(&as_needs(&all), "needs.json", &Mapping::default()).unwrap(), &all)?;
    }

    #[cfg(feature = "doorstop")]
    #[test]
    fn each_item_of_a_folder_is_counted_once(all in contents()) {
        // A folder has no id twice.
        let all: Vec<Content> = all.into_iter().map(|one| if one == Again { Bad } else { one }).collect();
        let mut files = vec![(".doorstop.yml".to_owned(), "settings:\n  prefix: N\n".to_owned())];
        for (at, content) in all.iter().enumerate() {
            let text = match content {
                Good => "text: x\n",
                NoText => "level: 1.1\n",
                Bad | Again => "text: [\n",
                Information => "text: x\nnormative: false\n",
                Repaired => "text: x\nmore:\n  a: 1\n",
            };
            files.push((format!("N{at:03}.yml"), text.to_owned()));
        }
        let found = octant_requirements::doorstop::read(&files, "d", &Mapping::default()).unwrap();
        check(&found, &all)?;
    }

    #[test]
    fn an_archive_counts_the_objects_of_all_files(all in contents(), more in contents()) {
        let second = as_reqif(&more).replace("\"o", "\"p").replace("\"N-", "\"M-");
        let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
        for (name, text) in [("1.reqif", as_reqif(&all)), ("2.reqif", second)] {
            zip.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
            std::io::Write::write_all(&mut zip, text.as_bytes()).unwrap();
        }
        let bytes = zip.finish().unwrap().into_inner();
        let found = reqif::read_archive(&bytes, "d.reqifz", &Mapping::default()).unwrap();
        check(&found, &[all, more].concat())?;
    }

    #[test]
    fn every_requirement_of_a_toml_is_used(count in 0_usize..30) {
        let one = |at: usize| Requirement::new(&format!("N-{at}"), "x", Verification::Analysis);
        let requirements = (0..count).map(one).collect();
        let all = Requirements { title: "T".to_owned(), requirements, ..Requirements::default() };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("r.toml");
        std::fs::write(&path, file::write(&all)).unwrap();
        let found = exchange::read(&path, None, &Anything).unwrap();
        prop_assert_eq!((found.account.read(), found.account.used_count()), (count as u64, count as u64));
        // A copy of it is no import.
        let copy = folder.path().join("copy.toml");
        exchange::write(&copy, &found, "", false).unwrap();
        prop_assert_eq!(std::fs::read(copy).unwrap(), std::fs::read(path).unwrap());
    }

    /// A damage at one place costs what it hits: the sums hold, and every requirement is one that was used.
    #[test]
    fn the_account_of_a_damaged_document_holds(
        all in contents(),
        at in any::<prop::sample::Index>(),
        by in prop_oneof![Just('['), Just('"'), Just('<'), Just('\n'), Just('\u{1}'), any::<char>()],
    ) {
        let damaged = |text: String| {
            let mut chars: Vec<char> = text.chars().collect();
            let at = at.index(chars.len());
            chars[at] = by;
            chars.into_iter().collect::<String>()
        };
        for found in [
            reqif::read(&damaged(as_reqif(&all)), "d.reqif").ok(),
            sdoc::read(&damaged(as_sdoc(&all)), "d.sdoc").ok(),
            needs::read(&damaged(as_needs(&all)), "needs.json", &Mapping::default()).ok(),
        ].into_iter().flatten() {
            let account = &found.account;
            prop_assert!(account.used_count() >= found.requirements.requirements.len() as u64);
            prop_assert!(account.read() + 2 >= all.len() as u64, "{:?} of {:?}", account, all);
            let counted = account.used_count() + account.left_out_count();
            prop_assert_eq!(account.read(), counted);
        }
    }
}

#[test]
fn an_account_in_a_toml_whose_sum_is_wrong_is_refused() {
    let found = reqif::read(&as_reqif(&[Good, NoText, Repaired]), "d.reqif").unwrap();
    let mut all = found.requirements;
    all.title = "T".to_owned();
    all.accounts.push(found.account);
    let text = file::write(&all);
    assert!(file::read(&text, "r.toml", &Anything).is_ok_and(|back| back == all), "{text}");
    for (from, to, expected) in [
        (
            "read = 3",
            "read = 2",
            "read: found 2, expected 3, the sum of used, repaired and left_out",
        ),
        ("used = 1", "used = -1", "used: expected a number of units, 0 or more"),
        ("doubt = true", "doubt = 1", "doubt: expected true or false"),
        (
            "unit = [\"object\", \"objects\"]",
            "unit = \"object\"",
            "expected the name of a unit and its plural",
        ),
        ("left_out = [", "left = [", "unknown key, did you mean \"left_out\"?"),
    ] {
        assert!(text.contains(from), "{from}\n{text}");
        let error = file::read(&text.replacen(from, to, 1), "r.toml", &Anything).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
}
