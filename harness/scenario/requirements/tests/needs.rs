//! `needs.json` of sphinx-needs.

use octant_requirements::Imported;
use octant_requirements::mapping::{self, Mapping};
use octant_requirements::needs;
use octant_verdict::requirement::{AttributeKind, Parent, Requirement, Requirements, Verification};

/// As the builder `needs` writes it, with fewer fields.
const FILE: &str = r#"{"current_version": "1.0", "project": "INS", "versions": {"0.9": {"needs": {}},
 "1.0": {"creator": {"program": "sphinx_needs", "version": "9.1.0"}, "needs_amount": 4, "needs": {
  "NAV_1": {"id": "NAV_1", "type": "req", "title": "Drift", "content": "It *stays* below.", "status": "open",
   "tags": ["sea"], "links": [], "links_back": ["NAV_2"], "sections": ["Sub", "Top"], "docname": "index",
   "owner": null, "effort": 3, "ready": true, "arch": {}},
  "NAV_2": {"id": "NAV_2", "type": "spec", "title": "Part", "content": "Of it.", "links": ["NAV_1"],
   "refines": ["NAV_1"], "parent_needs": ["NAV_1"], "parent_need": "NAV_1", "arch": {"a": "uml"}},
  "T_1": {"id": "T_1", "type": "test", "title": "Test", "content": "", "links": ["NAV_1"]},
  "NAV_3": {"id": "NAV_3", "type": "req", "title": "Empty", "content": ""}},
  "needs_schema": {"properties": {"refines": {"field_type": "links"}, "links": {"field_type": "links"},
   "parent_needs": {"field_type": "links"}, "links_back": {"field_type": "backlinks"}}}}}}
"#;

fn read(text: &str) -> Imported {
    needs::read(text, "needs.json", &Mapping::default()).unwrap()
}

fn notes(imported: &Imported) -> String {
    imported.notes.iter().map(|note| format!("{note}\n")).collect()
}

#[test]
fn the_file_of_the_builder_is_read() {
    let found = read(FILE);
    assert_eq!(found.requirements.title, "INS");
    let first = found.requirements.get("NAV_1").unwrap();
    assert_eq!((first.title.as_deref(), first.text.as_str()), (Some("Drift"), "It *stays* below."));
    assert_eq!(first.section, ["Top", "Sub"]);
    assert_eq!(first.kind, None);
    assert_eq!(first.verification, Verification::Open);
    assert_eq!(found.requirements.kind("effort"), AttributeKind::Integer);
    assert_eq!(found.requirements.kind("ready"), AttributeKind::Boolean);
    let second = found.requirements.get("NAV_2").unwrap();
    assert_eq!(second.kind.as_deref(), Some("spec"));
    assert_eq!(second.under.as_deref(), Some("NAV_1"));
    let roles: Vec<Option<&str>> = second.parents.iter().map(|p| p.role.as_deref()).collect();
    assert_eq!(roles, [None, Some("refines")]);
    let notes = notes(&found);
    for expected in [
        "the versions 0.9 are left out: \"1.0\" is current",
        "line 6: NAV_2 is an object with fields that are left out: arch, which is no text",
        "no requirements but information: T_1",
        "computed by sphinx-needs, and left out: docname, links_back, parent_need",
    ] {
        assert!(notes.contains(expected), "{expected}\n{notes}");
    }
    // A need with a title and without a body is a requirement.
    assert_eq!(found.requirements.get("NAV_3").unwrap().text, "Empty");
    let account = &found.account;
    let counts = (account.read(), account.repaired_count(), account.left_out_count());
    assert_eq!((counts, account.doubts()), ((4, 1, 1), vec![]));
    let written = needs::write(&found.requirements, "2026-01-31T12:00:00Z").unwrap();
    assert_eq!(read(&written).requirements, found.requirements, "{written}");
}

#[test]
fn a_mapping_finds_fields_of_a_project() {
    let mapping = mapping::read(
        "schema = 1\n[attributes]\nclause = \"status\"\n[informative]\ntypes = [\"spec\", \"test\"]\n",
        "m.toml",
    )
    .unwrap();
    let found = needs::read(FILE, "needs.json", &mapping).unwrap();
    assert_eq!(found.requirements.requirements.len(), 2);
    assert_eq!(found.requirements.requirements[0].clause.as_deref(), Some("open"));
    let wrong = mapping::read("schema = 1\n[attributes]\nclause = \"statuz\"\n", "m.toml").unwrap();
    let error = needs::read(FILE, "needs.json", &wrong).unwrap_err().to_string();
    assert!(error.contains("no attribute \"statuz\", did you mean \"status\"?"), "{error}");
}

#[test]
fn json_of_another_form_is_refused_in_plain_words() {
    let said =
        |text: &str| needs::read(text, "needs.json", &Mapping::default()).unwrap_err().to_string();
    assert!(said("{").starts_with("needs.json:1:1: not JSON: "), "{}", said("{"));
    assert!(
        said("[]").contains("not a needs.json of sphinx-needs: found \"[\", expected an object"),
        "{}",
        said("[]")
    );
    assert!(said("{}").contains("there is no \"versions\""));
    assert!(said("{\"versions\": {}}").contains("there is no \"current_version\""));
    let other = FILE.replace("\"current_version\": \"1.0\"", "\"current_version\": \"1.1\"");
    assert!(
        said(&other).contains("current_version is \"1.1\", which isn't among"),
        "{}",
        said(&other)
    );
    let newer = FILE.replacen('{', "{\"format_version\": 2, ", 1);
    assert!(said(&newer).contains("format_version is 2, and this Octant reads version 1"));
    let twice = FILE.replace("\"0.9\": {", "\"1.0\": {");
    assert!(
        said(&twice).contains("the version \"1.0\" is there a second time"),
        "{}",
        said(&twice)
    );
    let missing = FILE.replace("\"needs\": {\n", "\"need\": {\n");
    assert!(said(&missing).contains("the version \"1.0\" has no \"needs\""), "{}", said(&missing));
}

#[test]
fn a_bad_need_costs_one_need() {
    for (from, to, expected) in [
        (
            "\"NAV_2\": {",
            "\"NAV_1\": {",
            "line 6: the object NAV_1 is there a second time, the first is in line 3: it is left out",
        ),
        (
            "\"Of it.\"",
            "{\"a\": 1}",
            "line 6: the object NAV_2 has content, which is no text: it is left out",
        ),
        (
            "\"title\": \"Empty\"",
            "\"title\": \"\"",
            "line 9: the object NAV_3 has no text: it is left out",
        ),
        (
            "\"NAV_3\": {\"id\"",
            "\"NAV_3\": 3, \"T_2\": {\"type\": \"test\", \"id\"",
            "the object NAV_3 is no object",
        ),
    ] {
        assert!(FILE.contains(from), "{from}");
        let found = read(&FILE.replacen(from, to, 1));
        assert!(notes(&found).contains(expected), "{expected}\n{}", notes(&found));
        assert_eq!(found.skipped(), 1, "{expected}");
        let all = if to.contains("T_2") { 5 } else { 4 };
        assert_eq!(found.account.read(), all, "{expected}");
        assert_eq!(found.account.doubts().len(), 1);
    }
}

#[test]
fn fields_that_every_need_has_are_no_attributes() {
    let mut all = Requirements {
        title: "T".to_owned(),
        requirements: vec![Requirement::new("A_1", "x", Verification::Analysis)],
        ..Requirements::default()
    };
    all.requirements[0].parents =
        vec![Parent { id: "B".to_owned(), role: Some("title".to_owned()) }];
    let error = needs::write(&all, "").unwrap_err().to_string();
    assert!(
        error.contains("the role \"title\" of a parent is the name of another field"),
        "{error}"
    );
}
