//! Folders of Doorstop.

use octant_requirements::exchange::Anything;
use octant_requirements::format::ExchangeFormat;
use octant_requirements::losses::losses;
use octant_requirements::mapping::{self, Mapping};
use octant_requirements::{Imported, doorstop, exchange};
use octant_verdict::requirement::{
    AttributeKind, ForeignAttribute, Parent, Requirement, Requirements, Verification,
};

/// Settings and items as Doorstop 3.2 writes them.
const SETTINGS: &str =
    "settings:\n  digits: 3\n  itemformat: yaml\n  parent: SYS\n  prefix: REQ\n  sep: ''\n";
const HEADING: &str = "active: true\nderived: false\nheader: |\n  Navigation\nlevel: 1.0\nlinks: []\nnormative: \
                       false\nref: ''\nreviewed: null\ntext: ''\n";
const ITEM: &str = "active: true\nderived: true\neffort: 3\nheader: |\n  Drift\nlevel: 1.1\nlinks:\n- SYS001: \
                    avwblqPimDJ2OgTrRCXxRPN8FQhUBWqPIXm7kSR95C4=\nnormative: true\nowner: me\nref: 'a.c'\n\
                    reviewed: Zp7kuFJBYPm8d5lxMSlYFvwpoZb11VuF_bj_2s4_Nhg=\ntags:\n- a\n- b\ntext: |\n  The \
                    *drift* stays below:\n\n  20 arcmin\n";

fn item(level: &str, text: &str, more: &str) -> String {
    format!("active: true\nlevel: {level}\nnormative: true\ntext: {text}\n{more}")
}

fn files(all: &[(&str, &str)]) -> Vec<(String, String)> {
    all.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect()
}

fn read(all: &[(&str, &str)]) -> Imported {
    doorstop::read(&files(all), "reqs", &Mapping::default()).unwrap()
}

fn said(all: &[(&str, &str)]) -> String {
    doorstop::read(&files(all), "reqs", &Mapping::default()).unwrap_err().to_string()
}

#[test]
fn a_folder_of_doorstop_is_read() {
    let under = item("'1.1.10'", "Below.", "");
    let before = item("1.1.2", "Before it.", "");
    let off = item("1.2", "Off.", "").replace("active: true", "active: false");
    let prose = item("1.3", "Prose.", "").replace("normative: true", "normative: false");
    let empty = item("1.4", "''", "");
    let titled = item("1.5", "''", "header: Only a header\n");
    let found = read(&[
        (".doorstop.yml", SETTINGS),
        ("REQ001.yml", HEADING),
        ("REQ002.yml", ITEM),
        ("REQ003.yml", &under),
        ("REQ004.yml", &before),
        ("REQ005.yml", &off),
        ("REQ006.yml", &prose),
        ("REQ007.yml", &empty),
        ("REQ008.yml", &titled),
    ]);
    let ids: Vec<&str> = found.requirements.requirements.iter().map(|r| r.id.as_str()).collect();
    assert_eq!(ids, ["REQ002", "REQ004", "REQ003", "REQ008"]);
    assert_eq!(found.requirements.get("REQ008").unwrap().text, "Only a header");
    let account = &found.account;
    let counts = (account.read(), account.used_count(), account.left_out_count());
    assert_eq!(counts, (8, 5, 3));
    assert_eq!(
        account.doubts(),
        ["reqs: left out: 1 without a text, the first REQ007 in REQ007.yml, line 1"]
    );
    let first = &found.requirements.requirements[0];
    assert_eq!(first.title.as_deref(), Some("Drift"));
    assert_eq!(first.text, "The *drift* stays below:\n\n20 arcmin");
    assert_eq!(first.section, ["Navigation"]);
    assert_eq!(first.parents, [Parent { id: "SYS001".to_owned(), role: None }]);
    assert_eq!(first.verification, Verification::Open);
    let attribute = |name: &str| first.attributes.iter().find(|a| a.name == name).unwrap();
    assert_eq!(attribute("derived").values, ["true"]);
    assert_eq!(attribute("ref").values, ["a.c"]);
    assert_eq!(attribute("tags").values, ["a", "b"]);
    assert_eq!(found.requirements.kind("effort"), AttributeKind::Integer);
    assert_eq!(found.requirements.requirements[2].under.as_deref(), Some("REQ002"));
    let notes: String = found.notes.iter().map(|note| format!("{note}\n")).collect();
    for expected in [
        "REQ007.yml, line 1: the object REQ007 has no text: it is left out",
        "not active or not normative: REQ005, REQ006",
        "reviews and the stamps of links are left out",
    ] {
        assert!(notes.contains(expected), "{expected}\n{notes}");
    }
    let written = doorstop::write(&found.requirements).unwrap();
    let back = doorstop::read(&written, "reqs", &Mapping::default()).unwrap();
    assert_eq!(back.requirements, found.requirements, "{written:?}");
    assert_eq!(back.skipped(), 0);
}

#[test]
fn a_mapping_finds_attributes_of_a_project() {
    let item = item("1", "It holds.", "method: Review\n");
    let all = files(&[(".doorstop.yml", SETTINGS), ("REQ001.yml", &item)]);
    let text = "schema = 1\n[attributes]\nverification = \"method\"\n[values.verification]\nReview = \"inspection\"\n";
    let found = doorstop::read(&all, "reqs", &mapping::read(text, "m.toml").unwrap()).unwrap();
    assert_eq!(found.requirements.requirements[0].verification, Verification::Inspection);
    let wrong = mapping::read(&text.replace("\"method\"", "\"methods\""), "m.toml").unwrap();
    let error = doorstop::read(&all, "reqs", &wrong).unwrap_err().to_string();
    assert!(error.contains("no attribute \"methods\", did you mean \"method\"?"), "{error}");
}

#[test]
fn what_is_no_item_is_refused_with_its_file_and_line() {
    let with = |text: &str| {
        let found =
            read(&[(".doorstop.yml", SETTINGS), ("REQ001.yml", text), ("REQ002.yml", ITEM)]);
        // The others are read.
        assert_eq!(found.requirements.requirements.len(), 1);
        assert_eq!((found.skipped(), found.account.read()), (1, 2));
        found.notes[0].to_string()
    };
    assert_eq!(said(&[("REQ001.yml", ITEM)]), "reqs:1:1: there is no .doorstop.yml in the folder");
    assert_eq!(
        with("- a\n- b\n"),
        "REQ001.yml, line 1: the object REQ001 can't be read: found a list, expected a mapping of \
         attributes: it is left out"
    );
    assert!(with("").contains("found an empty file"));
    assert!(with("text: 'x\n").starts_with("REQ001.yml, line "), "{}", with("text: 'x\n"));
    assert!(with("text: a\ntext: b\n").starts_with(
        "REQ001.yml, line 2: the object REQ001 can't be read: the key \"text\" is there a"
    ));
    assert!(with("level: one\n").contains("level is no outline number"));
    assert!(with("active: maybe\n").contains("active is no truth value"));
    assert!(
        with("a: &x [1]\nb: *x\n")
            .contains("line 2: the object REQ001 can't be read: found an alias")
    );
    let deep = format!("a: {}", "[".repeat(60));
    assert!(with(&deep).contains("more than 50 levels"), "{}", with(&deep));
    let other = SETTINGS.replace("itemformat: yaml", "itemformat: asciidoc");
    assert_eq!(
        said(&[(".doorstop.yml", &other)]),
        "reqs/.doorstop.yml:1:1: itemformat is \"asciidoc\", expected \"yaml\" or \"markdown\""
    );
}

#[test]
fn items_in_markdown_are_read() {
    let settings = SETTINGS.replace("itemformat: yaml", "itemformat: markdown");
    let item = "---\nactive: true\nlevel: 1.1\nlinks: []\nnormative: true\n---\n\n# Drift\n\nIt stays *below*:\n\n\
                20 arcmin\n";
    let found = read(&[
        (".doorstop.yml", &settings),
        ("REQ001.md", item),
        ("REQ002.md", "---\nlevel: 1.2\n---\nNo header.\n"),
        ("REQ003.md", "# No attributes\n"),
        ("REQ004.yml", ITEM),
    ]);
    let texts: Vec<(Option<&str>, &str)> = (found.requirements.requirements.iter())
        .map(|r| (r.title.as_deref(), r.text.as_str()))
        .collect();
    assert_eq!(texts, [(Some("Drift"), "It stays *below*:\n\n20 arcmin"), (None, "No header.")]);
    assert_eq!((found.account.read(), found.skipped()), (3, 1));
    let notes: String = found.notes.iter().map(|note| format!("{note}\n")).collect();
    assert!(
        notes.contains("REQ003.md, line 1: the object REQ003 can't be read: found no attributes")
    );
    assert!(notes.contains("REQ004.yml is not read: the items are in itemformat markdown"));
}

#[test]
fn texts_that_look_like_yaml_come_back() {
    let texts = [
        "yes",
        "- a: b\n# no comment\n\n  indented",
        "\"quoted\" and 'quoted': |",
        "µ ≤ 3 \u{2028} x",
        "a line with space \nand another",
        "null",
        "%TAG",
    ];
    let all: Vec<Requirement> = texts
        .iter()
        .enumerate()
        .map(|(at, text)| Requirement {
            title: Some("yes: no".to_owned()),
            attributes: vec![ForeignAttribute {
                name: "a: b".to_owned(),
                values: vec!["1.50".to_owned()],
            }],
            ..Requirement::new(&format!("NAV-{at}"), text, Verification::Analysis)
        })
        .collect();
    let requirements =
        Requirements { title: "T: x".to_owned(), requirements: all, ..Requirements::default() };
    let written = doorstop::write(&requirements).unwrap();
    let mut back = doorstop::read(&written, "reqs", &Mapping::default()).unwrap().requirements;
    // These are what the folder says of itself.
    back.document.clear();
    assert_eq!(back, requirements);
}

#[test]
fn what_doorstop_has_no_place_for_is_named_or_refused() {
    let mut all = Requirements {
        title: "T".to_owned(),
        requirements: vec![Requirement::new("NAV", "x", Verification::Analysis)],
        ..Requirements::default()
    };
    let error = doorstop::write(&all).unwrap_err().to_string();
    assert!(error.contains("its id \"NAV\" is none of Doorstop's"), "{error}");
    all.requirements[0].id = "../NAV-1".to_owned();
    assert!(doorstop::write(&all).is_err());
    all.requirements[0].id = "NAV-1".to_owned();
    all.requirements[0].parents =
        vec![Parent { id: "SYS-1".to_owned(), role: Some("Refines".to_owned()) }];
    all.document = vec![("VERSION".to_owned(), "2".to_owned())];
    assert!(doorstop::write(&all).is_ok());
    let imported = Imported::own(all, "r.toml");
    let lost = losses(&imported, ExchangeFormat::Doorstop);
    assert_eq!(
        lost,
        [
            "of the head of the document is left out: VERSION",
            "the roles of the parents are left out: NAV-1"
        ]
    );
}

#[test]
fn a_folder_is_written_only_where_nothing_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("reqs");
    let mut all = Requirements {
        title: "T".to_owned(),
        requirements: vec![
            Requirement::new("NAV-1", "x", Verification::Analysis),
            Requirement::new("NAV-2", "y", Verification::Analysis),
        ],
        ..Requirements::default()
    };
    let imported = |all: &Requirements| Imported::own(all.clone(), "r.toml");
    assert_eq!(exchange::write(&path, &imported(&all), "", false).unwrap(), Vec::<String>::new());
    let back = exchange::read(&path, None, &Anything).unwrap();
    assert_eq!(back.requirements.requirements, all.requirements);
    let error = exchange::write(&path, &imported(&all), "", false).unwrap_err().to_string();
    assert!(error.contains("--force overwrites it"), "{error}");
    exchange::write(&path, &imported(&all), "", true).unwrap();
    all.requirements.pop();
    let error = exchange::write(&path, &imported(&all), "", true).unwrap_err().to_string();
    assert!(error.contains("has items that the new document doesn't have: NAV-2.yml"), "{error}");
}
