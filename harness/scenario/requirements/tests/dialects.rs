//! Files as other tools write them.

use octant_requirements::exchange;
use octant_requirements::exchange::Anything;
use octant_requirements::format::ExchangeFormat;
use octant_requirements::losses::losses;
use octant_requirements::mapping::{self, Mapping};
use octant_requirements::{Imported, reqif};
use octant_verdict::requirement::{Limit, Requirement, Verification};
use octant_verdict::trace::{CampaignTrace, TracedCase, TracedResult};
use octant_verdict::{Comparison, Verdict};
use std::path::{Path, PathBuf};

fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures/requirements/dialects").join(name)
}

fn text(name: &str) -> String {
    std::fs::read_to_string(sample(name)).unwrap()
}

fn read(name: &str) -> Imported {
    exchange::read(&sample(name), None, &Anything).unwrap()
}

fn notes(imported: &Imported) -> String {
    imported.notes.iter().map(|note| format!("{note}\n")).collect()
}

fn ids(imported: &Imported) -> Vec<&str> {
    imported.requirements.requirements.iter().map(|r| r.id.as_str()).collect()
}

fn of<'a>(imported: &'a Imported, id: &str) -> &'a Requirement {
    imported.requirements.get(id).unwrap()
}

/// Written and read again, nothing has changed: with the archive, whose attachments are kept.
fn survives(imported: &Imported) {
    let time = "2026-01-31T12:00:00Z";
    let bytes = reqif::write_archive(&imported.requirements, &imported.attachments, time).unwrap();
    let back = reqif::read_archive(&bytes, "back.reqifz", &Mapping::default()).unwrap();
    assert_eq!(back.requirements, imported.requirements);
    assert_eq!(back.attachments, imported.attachments);
    let toml = octant_verdict::file::write(&imported.requirements);
    let back = octant_verdict::file::read(&toml, "back.toml", &Anything).unwrap();
    assert_eq!(back, imported.requirements, "{toml}");
}

#[test]
fn doors_says_by_an_enumeration_what_is_a_requirement() {
    let found = read("doors.reqif");
    assert_eq!(ids(&found), ["3", "7", "4"]);
    let third = of(&found, "3");
    assert_eq!(third.section, ["Navigation"]);
    assert_eq!(third.text, "The longitude error stays below\n20 arcmin.\n\n- at sea\n- alongside");
    assert!(third.formatted[0].xhtml.contains("<b>longitude</b>"), "{third:?}");
    // Nobody mapped the measure: it is an attribute, and no pass can come of it.
    assert_eq!(third.verification, Verification::Open);
    let below = of(&found, "7");
    assert_eq!(below.under.as_deref(), Some("3"));
    assert_eq!(below.parents[0].id, "3");
    assert_eq!(below.parents[0].role.as_deref(), Some("satisfies"));
    let notes = notes(&found);
    let line = |id: &str| {
        let object = format!("<SPEC-OBJECT IDENTIFIER=\"{id}\"");
        text("doors.reqif").lines().position(|line| line.contains(&object)).unwrap() + 1
    };
    for expected in [
        format!("line {}: the object _d5 has no text: it is left out", line("_d5")),
        format!("line {}: the object _d6 has no id: it is left out", line("_d6")),
        "no requirements but information: 2".to_owned(),
        "the relation from \"_d7\" to \"_d2\" is left out".to_owned(),
        "open until somebody says how they are verified: 3, 7, 4".to_owned(),
    ] {
        assert!(notes.contains(&expected), "{expected}\n{notes}");
    }
    assert_eq!(found.skipped(), 2);
    survives(&found);
}

const DOORS: &str = "schema = 1\n\n[attributes]\nverification = \"Verification Method\"\n\
                     measure = \"Octant Measure\"\nlimit = \"Octant Limit\"\n\n[values.verification]\n\
                     Test = \"test\"\nAnalysis = \"analysis\"\nReview = \"inspection\"\n";

#[test]
fn a_mapping_finds_measures_limits_and_methods() {
    let mapping = mapping::read(DOORS, "doors.toml").unwrap();
    let found = exchange::read(&sample("doors.reqif"), Some(&mapping), &Anything).unwrap();
    let Verification::Test(check) = &of(&found, "3").verification else { panic!("{found:?}") };
    assert_eq!(check.measure, "navigation.marks.24h.longitude_max_arcmin");
    assert_eq!(check.comparison, Comparison::AtMost);
    assert_eq!(check.limit, Limit::Quantity("20 arcmin".to_owned()));
    // The first of several methods counts where none is a test.
    assert_eq!(of(&found, "4").verification, Verification::Inspection);
    let methods = of(&found, "4").attributes.iter().find(|a| a.name == "Verification Method");
    assert_eq!(methods.unwrap().values, ["Review", "Analysis"]);
    assert_eq!(of(&found, "7").verification, Verification::Open);
    survives(&found);
}

#[test]
fn a_mapping_for_one_type_holds_for_that_type() {
    let text = "schema = 1\n[types.Functional.attributes]\nid = \"IDENTIFIER\"\nrationale = \"Difficulty\"\n";
    let mapping = mapping::read(text, "m.toml").unwrap();
    let name = "enterprise_architect.reqif";
    let found = exchange::read(&sample(name), Some(&mapping), &Anything).unwrap();
    assert_eq!(of(&found, "EAID_1").rationale.as_deref(), Some("Low"));
    assert_eq!(of(&found, "EAID_1").attributes.len(), 0);
}

#[test]
fn polarion_has_the_title_of_every_item_where_others_have_that_of_chapters() {
    let found = read("polarion.reqif");
    assert_eq!(ids(&found), ["INS-2"]);
    let only = of(&found, "INS-2");
    assert_eq!(only.title.as_deref(), Some("Time to align"));
    assert_eq!(only.section, ["Alignment"]);
    assert_eq!(only.kind.as_deref(), Some("System Requirement"));
    assert!(notes(&found).contains("no requirements but information: INS-3"));
    survives(&found);
    // Of a heading its title is kept, and the rest is named.
    let more = text("polarion.reqif").replacen(
        "<ATTRIBUTE-VALUE-STRING THE-VALUE=\"Alignment\">",
        "<ATTRIBUTE-VALUE-DATE THE-VALUE=\"2025-03-15T10:46:58Z\"><DEFINITION>\
         <ATTRIBUTE-DEFINITION-DATE-REF>ad-0-4</ATTRIBUTE-DEFINITION-DATE-REF></DEFINITION>\
         </ATTRIBUTE-VALUE-DATE><ATTRIBUTE-VALUE-STRING THE-VALUE=\"Alignment\">",
        1,
    );
    let found = reqif::read(&more, "more.reqif").unwrap();
    assert!(notes(&found).contains("other attributes are left out: INS-1"), "{}", notes(&found));
}

#[test]
fn jama_has_folders_and_pictures() {
    let found = read("jama.reqif");
    let only = of(&found, "INS-SYSRQ-7");
    assert_eq!(only.section, ["Calibration"]);
    assert_eq!(only.title.as_deref(), Some("Scale factor"));
    assert_eq!(only.text, "The scale factor is known to 10 ppm.\n\na chart");
    assert!(only.formatted[0].xhtml.contains("<object data=\"files/scale.png\""));
    survives(&found);
    let lost = losses(&found, ExchangeFormat::StrictDoc).join("\n");
    assert!(lost.contains("the formatting of texts is left out: INS-SYSRQ-7"), "{lost}");
    // A text that somebody changed has lost its formatting, and that is said.
    let mut changed = found;
    changed.requirements.requirements[0].text = "It is known to 20 ppm.".to_owned();
    let lost = losses(&changed, ExchangeFormat::ReqIf).join("\n");
    assert!(lost.contains("because the text was changed"), "{lost}");
    let written = reqif::write(&changed.requirements, "2026-01-31T12:00:00Z").unwrap();
    let back = reqif::read(&written, "back.reqif").unwrap();
    assert_eq!(of(&back, "INS-SYSRQ-7").text, "It is known to 20 ppm.");
}

#[test]
fn codebeamer_has_categories_and_descriptions() {
    let found = read("codebeamer.reqif");
    assert_eq!(ids(&found), ["1002"]);
    assert_eq!(of(&found, "1002").section, ["Interfaces"]);
    assert_eq!(of(&found, "1002").text, "Outputs come at 200 Hz.");
    assert!(notes(&found).contains("no requirements but information: 1003"));
    survives(&found);
}

#[test]
fn enterprise_architect_names_objects_by_their_identifier() {
    let found = read("enterprise_architect.reqif");
    assert_eq!(ids(&found), ["EAID_1", "EAID_2"]);
    assert_eq!(of(&found, "EAID_2").title.as_deref(), Some("Cables"));
    assert_eq!(of(&found, "EAID_2").parents[0].role.as_deref(), Some("Refine"));
    assert!(notes(&found).contains("called by their IDENTIFIER"), "{}", notes(&found));
    survives(&found);
}

#[test]
fn a_mapping_that_names_what_is_not_there_tells_the_nearest() {
    let said = |text: &str| {
        let mapping = mapping::read(text, "m.toml").unwrap();
        exchange::read(&sample("doors.reqif"), Some(&mapping), &Anything).unwrap_err().to_string()
    };
    let error = said("schema = 1\n[attributes]\nverification = \"Verification Methods\"\n");
    assert!(
        error.starts_with(
            "m.toml:3:16: attributes.verification: the file has no attribute \"Verification Methods\", did \
             you mean \"Verification Method\"?"
        ),
        "{error}"
    );
    let error = said("schema = 1\n[types.Requirements.attributes]\nid = \"ReqIF.ForeignID\"\n");
    assert!(
        error.contains("has no type \"Requirements\", did you mean \"Requirement Type\"?"),
        "{error}"
    );
    let error = said(&DOORS.replace("Analysis =", "Analysys ="));
    assert!(error.contains("has no value \"Analysys\", did you mean \"Analysis\"?"), "{error}");
    let error = said("schema = 1\n[informative.values]\n\"Object Type\" = [\"Infos\"]\n");
    assert!(error.contains("has no value \"Infos\""), "{error}");
}

#[test]
fn mapping_files_are_checked_when_they_are_read() {
    let said = |text: &str| mapping::read(text, "m.toml").unwrap_err().to_string();
    assert!(said("schema = 2\nnew = 1\n").contains("it takes a newer Octant"));
    assert!(said("[attributes]\n").contains("schema: missing, expected 1"));
    assert!(said("schema = 1\n[attributes]\nids = \"x\"\n").contains("did you mean \"id\"?"));
    let error = said("schema = 1\n[values.verification]\nReview = \"inspect\"\n");
    assert!(
        error.contains("values.verification.Review: found \"inspect\", expected \"test\""),
        "{error}"
    );
    assert!(said("schema = 1\n[informative]\nvalues = 3\n").contains("expected a table"));
    let refused = exchange::read(
        Path::new("requirements.toml"),
        Some(&mapping::read(DOORS, "m.toml").unwrap()),
        &Anything,
    );
    assert!(refused.unwrap_err().to_string().contains("a mapping is for .reqif"));
}

#[test]
fn a_duplicate_id_costs_one_object_and_is_told_with_both_lines() {
    let twice = text("doors.reqif").replace("THE-VALUE=\"4\"", "THE-VALUE=\"3\"");
    let found = reqif::read(&twice, "twice.reqif").unwrap();
    let notes = notes(&found);
    assert!(notes.contains("has the id \"3\" of another, that of line "), "{notes}");
    assert_eq!((ids(&found), found.skipped()), (vec!["3", "7"], 3));
}

#[test]
fn the_encoding_of_a_file_is_known_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wide.reqif");
    let text = text("doors.reqif");
    let wide: Vec<u8> =
        "\u{feff}".encode_utf16().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    std::fs::write(&path, &wide).unwrap();
    let found = exchange::read(&path, None, &Anything).unwrap();
    assert_eq!(found.requirements, read("doors.reqif").requirements);
    std::fs::write(&path, &wide[..wide.len() - 1]).unwrap();
    assert!(
        exchange::read(&path, None, &Anything).unwrap_err().to_string().contains("no valid UTF-16")
    );
    let latin = text.replace("grey", "gr\u{e4}u").replace("UTF-8", "ISO-8859-1");
    let latin: Vec<u8> = latin.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
    std::fs::write(&path, &latin).unwrap();
    assert_eq!(
        of(&exchange::read(&path, None, &Anything).unwrap(), "4").text,
        "The housing is gr\u{e4}u."
    );
    let undeclared = String::from_utf8_lossy(&latin).replace("ISO-8859-1", "KOI8-R");
    let undeclared: Vec<u8> =
        undeclared.chars().map(|c| if c == '\u{fffd}' { 0xe4 } else { c as u8 }).collect();
    std::fs::write(&path, undeclared).unwrap();
    let error = exchange::read(&path, None, &Anything).unwrap_err().to_string();
    assert!(error.contains("found the byte 0xe4, and declares \"koi8-r\""), "{error}");
}

#[test]
fn a_requirement_of_another_tool_is_inconclusive_until_somebody_says_how_it_is_verified() {
    let found = read("doors.reqif");
    // The account of the document is another reason, which isn't written here.
    let toml = octant_verdict::file::write(&found.requirements);
    let read = octant_verdict::file::read(&toml, "r.toml", &Anything).unwrap();
    assert_eq!(toml.matches("verification = \"open\"").count(), 3, "{toml}");
    let trace = CampaignTrace::new(&read, &[]);
    assert_eq!(trace.verdict(), Verdict::Inconclusive);
    assert!(trace.requirements.iter().all(|row| row.verdict == Some(Verdict::Inconclusive)));
    // A requirement that passes beside it changes nothing.
    let passed = toml.replacen(
        "verification = \"open\"",
        "measure = \"done\"\ncomparison = \">=\"\nlimit = 1",
        1,
    );
    let read = octant_verdict::file::read(&passed, "r.toml", &Anything).unwrap();
    let result = TracedResult {
        verdict: Verdict::Pass,
        checks: vec![("3".to_owned(), Verdict::Pass)],
        recording: None,
        folder: None,
    };
    let verifies = vec!["3".to_owned()];
    let case = TracedCase { id: "c".to_owned(), verifies, draw: 0, result: Some(result) };
    let trace = CampaignTrace::new(&read, &[case]);
    assert_eq!(trace.requirements[0].verdict, Some(Verdict::Pass));
    assert_eq!(trace.verdict(), Verdict::Inconclusive);
}
