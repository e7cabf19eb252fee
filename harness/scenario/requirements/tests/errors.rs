//! Error texts of invalid files: place, path, found, expected.

use octant_requirements::file::{Anything, Checker};
use octant_requirements::format::ExchangeFormat;
use octant_requirements::losses::losses;
use octant_requirements::requirement::{
    AttributeKind, Definition, EnsembleRequirement, Limit, Parent, Requirement, Requirements,
    Verification, percent, probability,
};
use octant_requirements::{Imported, file, reqif, sdoc};

const HEAD: &str = "schema = 1\n[[requirements]]\nid = \"N-1\"\ntext = \"x\"\n";

/// Problems of a text, one line each.
fn problems(text: &str) -> Vec<String> {
    let error = file::read(text, "r.toml", &Anything).unwrap_err();
    error.to_string().lines().map(str::to_owned).collect()
}

#[test]
fn a_file_as_people_write_it_is_read() {
    let text = r#"
schema = 1
title = "Navigation"
[document]
VERSION = "3"
[[attributes]]
name = "Priority"
type = "choice"
options = ["high", "low"]
[[requirements]]
id = "NAV-1"
text = """
The longitude error stays below
20 arcmin over 24 hours.
"""
measure = "navigation.longitude_error_arcmin.max"
limit = "20 arcmin"
pass = "99.5 %"
confidence = "95 %"
clause = "SSS 3.2.1"
parents = ["SYS-1", { id = "SYS-2", role = "Refines" }]
attributes = { Priority = "high" }
[[requirements]]
id = "NAV-2"
text = "The filter is consistent."
measure = "calibration.nis_mean"
comparison = ">="
limit = 0.5
[[requirements]]
id = "DOC-1"
text = "A page says so."
verification = "inspection"
"#;
    let read = file::read(text, "r.toml", &Anything).unwrap();
    assert_eq!(read.title, "Navigation");
    let [first, second, third] = read.requirements.as_slice() else { panic!() };
    assert_eq!(first.text, "The longitude error stays below\n20 arcmin over 24 hours.");
    let check = first.check().unwrap();
    assert_eq!(check.limit, Limit::Quantity("20 arcmin".to_owned()));
    assert_eq!(check.ensemble, Some(EnsembleRequirement { pass: 0.995, confidence: 0.95 }));
    assert_eq!(first.parents[1].role.as_deref(), Some("Refines"));
    assert_eq!(second.check().unwrap().limit, Limit::Number(0.5));
    assert_eq!(third.verification, Verification::Inspection);
}

#[test]
fn every_problem_is_told_with_its_place() {
    let text = "schema = 1\n[[requirements]]\nid = \"N-1\"\ntext = \"x\"\nmesure = \"a\"\n\
                [[requirements]]\nid = \"N-1\"\ntext = \"\"\nmeasure = \"a\"\nlimit = \"fast\"\n";
    assert_eq!(
        problems(text),
        [
            "r.toml:2:1: requirements.N-1.measure: missing: a requirement has a measure, or says how \
             else it is verified (verification = \"analysis\", \"inspection\" or \"open\", or the names of tests in tests)",
            "r.toml:5:1: requirements.N-1.mesure: unknown key, did you mean \"measure\"? known: id, \
             title, text, measure, comparison, limit, pass, confidence, verification, tests, \
             clause, rationale, parents, section, under, kind, identifier, attributes, formatted",
            "r.toml:7:6: requirements.N-1.id: found \"N-1\" a second time, the first is in line 2; \
             expected unique ids",
            "r.toml:8:8: requirements.N-1.text: found an empty text",
            "r.toml:10:9: requirements.N-1.limit: found \"fast\", expected a quantity such as \
             \"3 arcmin\", or a number",
        ]
    );
}

#[test]
fn each_key_says_what_it_expects() {
    for (rest, expected) in [
        ("measure = \"a\"\n", "r.toml:2:1: requirements.N-1.limit: missing, expected a quantity"),
        (
            "measure = \"a\"\nlimit = \"3\"\n",
            "6:9: requirements.N-1.limit: found \"3\", expected a unit, or a bare number",
        ),
        (
            "measure = \"a\"\nlimit = inf\n",
            "6:9: requirements.N-1.limit: found a number that isn't finite",
        ),
        (
            "measure = \"a\"\nlimit = 1\ncomparison = \"=\"\n",
            "7:14: requirements.N-1.comparison: found \"=\", expected <=, <, >= or >",
        ),
        (
            "measure = \"a\"\nlimit = 1\npass = \"95 %\"\n",
            "requirements.N-1.confidence: missing: pass says something only together with confidence",
        ),
        (
            "measure = \"a\"\nlimit = 1\npass = \"0.95\"\nconfidence = \"95 %\"\n",
            "7:8: requirements.N-1.pass: found \"0.95\", expected a percentage such as \"95 %\"",
        ),
        (
            "measure = \"a\"\nlimit = 1\npass = \"100 %\"\nconfidence = \"95 %\"\n",
            "expected more than 0 % and less than 100 %",
        ),
        (
            "measure = \"a\"\nlimit = 1\npass = 95\nconfidence = \"95 %\"\n",
            "7:8: requirements.N-1.pass: found the bare number 95, expected a text",
        ),
        (
            "verification = \"review\"\n",
            "5:16: requirements.N-1.verification: found \"review\", known: test, analysis, inspection",
        ),
        ("verification = \"anlysis\"\n", "did you mean \"analysis\"?"),
        (
            "verification = \"analysis\"\nlimit = 1\n",
            "6:9: requirements.N-1.limit: a requirement that is verified by analysis has none",
        ),
        ("verification = \"test\"\n", "requirements.N-1.measure: missing"),
        (
            "verification = \"test\"\ntests = []\n",
            "requirements.N-1.tests: found no test, expected at least one",
        ),
        (
            "tests = [\"a.rs::b\", \"a; b\"]\n",
            "requirements.N-1.tests: found \"a; b\", expected the name of a test",
        ),
        (
            "tests = [\"a.rs::b\"]\nmeasure = \"a\"\n",
            "requirements.N-1.measure: a requirement that other tests verify has none",
        ),
        (
            "verification = \"analysis\"\ntests = [\"a.rs::b\"]\n",
            "requirements.N-1.tests: a requirement that is verified by analysis has none",
        ),
        (
            "verification = \"analysis\"\nattributes = { UID = \"x\" }\n",
            "requirements.N-1.attributes.UID: stands for a key",
        ),
        (
            "verification = \"analysis\"\nattributes = { VERIFICATION = \"x\" }\n",
            "stands for a key",
        ),
        (
            "verification = \"analysis\"\nparents = \"x\"\n",
            "6:11: requirements.N-1.parents: found \"x\", expected an array of ids",
        ),
        (
            "verification = \"analysis\"\ntitle = \"a\\nb\"\n",
            "6:9: requirements.N-1.title: found several lines, expected one",
        ),
        (
            "verification = \"analysis\"\nclause = \"a\\u0007\"\n",
            "found the control character '\\u{7}'",
        ),
    ] {
        let found = problems(&format!("{HEAD}{rest}")).join("\n");
        assert!(found.contains(expected), "{rest}: {found}");
    }
}

#[test]
fn attributes_have_to_be_of_their_kind() {
    let define =
        "schema = 1\n[[attributes]]\nname = \"P\"\ntype = \"choice\"\noptions = [\"a\", \"b\"]\n";
    let one = "[[requirements]]\nid = \"N\"\ntext = \"x\"\nverification = \"analysis\"\n";
    let text = format!("{define}{one}attributes = {{ P = \"c\" }}\n");
    assert_eq!(
        problems(&text),
        ["r.toml:10:20: requirements.N.attributes.P: found c, expected one of a, b"]
    );
    let text = "schema = 1\n[[attributes]]\nname = \"P\"\ntype = \"chice\"\n";
    assert!(problems(text)[0].contains("did you mean \"choice\"?"));
    let text = "schema = 1\n[[attributes]]\nname = \"P\"\ntype = \"choice\"\n";
    assert!(problems(text)[0].contains("missing, a choice has options"));
}

#[test]
fn a_newer_missing_or_older_schema_is_refused_in_plain_words() {
    let newer = problems("schema = 2\nwhatever = 3\n");
    assert_eq!(
        newer,
        [
            "r.toml:1:10: schema: the file is of version 2, and this Octant reads version 1: it takes a newer Octant"
        ]
    );
    assert_eq!(problems(""), ["r.toml:1:1: schema: missing, expected 1"]);
    assert_eq!(problems("schema = 0"), ["r.toml:1:10: schema: found version 0, expected 1"]);
    assert_eq!(problems("schema = \"1\""), ["r.toml:1:10: schema: found \"1\", expected 1"]);
    assert!(problems("schema = 1\n[x\n")[0].starts_with("r.toml:2:3: not TOML: "));
}

struct OnlyDrift;

impl Checker for OnlyDrift {
    fn measure(&self, measure: &str) -> Result<(), String> {
        if measure == "drift" { Ok(()) } else { Err(format!("found {measure:?}, expected drift")) }
    }

    fn limit(&self, _: &str, limit: &Limit) -> Result<(), String> {
        match limit {
            Limit::Quantity(text) if !text.ends_with("nmi") => {
                Err(format!("found {text:?}, expected nmi"))
            }
            _ => Ok(()),
        }
    }
}

#[test]
fn measures_and_units_are_asked_of_who_knows_them() {
    let read = |measure: &str, limit: &str| {
        let text = format!("{HEAD}measure = \"{measure}\"\nlimit = \"{limit}\"\n");
        file::read(&text, "r.toml", &OnlyDrift).map_err(|error| error.to_string())
    };
    assert!(read("drift", "3 nmi").is_ok());
    let wrong = "r.toml:5:11: requirements.N-1.measure: found \"drft\", expected drift";
    assert_eq!(read("drft", "3 nmi").unwrap_err(), wrong);
    let wrong = "r.toml:6:9: requirements.N-1.limit: found \"3 m\", expected nmi";
    assert_eq!(read("drift", "3 m").unwrap_err(), wrong);
}

#[test]
fn a_percentage_is_the_decimal_that_is_written() {
    for (text, value) in
        [("95 %", 0.95), ("86.4%", 0.864), ("99.999 %", 0.99999), ("0.1 %", 0.001), ("5 %", 0.05)]
    {
        assert_eq!(probability(text), Ok(value));
        assert_eq!(probability(&percent(value)), Ok(value));
    }
    assert_eq!(percent(0.5), "50 %");
    assert_eq!(percent(0.9995), "99.95 %");
    for text in ["95", "% 95", "0 %", "-1 %", "NaN %", ""] {
        assert!(probability(text).is_err(), "{text}");
    }
}

#[test]
fn a_broken_sdoc_is_told_with_its_line() {
    let said = |text: &str| sdoc::read(text, "r.sdoc").unwrap_err().to_string();
    let head = "[DOCUMENT]\nTITLE: T\n\n";
    assert_eq!(said(""), "r.sdoc:1:1: the file ends here, expected [DOCUMENT]");
    assert_eq!(said("[DOCUMENT]\nVERSION: 1\n"), "r.sdoc:3:1: the document has no TITLE");
    assert_eq!(
        said(&format!("{head}[REQUIREMENT]\nUID: A\nSTATEMENT: >>>\nx\n")),
        "r.sdoc:6:1: STATEMENT begins with >>> and isn't closed by a line <<<"
    );
    assert_eq!(
        said(&format!("{head}[REQUIREMENT]\nSTATEMENT: x\n")),
        "r.sdoc:4:1: this REQUIREMENT has no UID, by which it could be named"
    );
    let two = "[REQUIREMENT]\nUID: A\nSTATEMENT: x\n\n";
    assert_eq!(
        said(&format!("{head}{two}{two}")),
        "r.sdoc:9:1: the UID \"A\" is there a second time, the first is in line 5"
    );
    assert_eq!(
        said(&format!("{head}[REQUIREMENT]\nUID A\n")),
        "r.sdoc:5:1: found \"UID A\", expected a field NAME: value"
    );
    assert_eq!(
        said(&format!("{head}[[SECTION]]\nTITLE: S\n\n{two}")),
        "r.sdoc:11:1: the file ends, and [[SECTION]] of line 4 isn't closed"
    );
    assert_eq!(
        said("[DOCUMENT]\nTITLE: T\nVERSON: 1\n"),
        "r.sdoc:3:1: unknown field \"VERSON\" of the document, did you mean \"VERSION\"? known: MID, UID, \
         VERSION, DATE, CLASSIFICATION, REQ_PREFIX, PREFIX, ROOT, ENABLE_MID, RELATION_FIELD, MARKUP, \
         AUTO_LEVELS, LAYOUT, VIEW_STYLE, REQUIREMENT_STYLE, NODE_IN_TOC, REQUIREMENT_IN_TOC, DEFAULT_VIEW"
    );
    assert!(
        said(&format!("{head}[[/SECTION]]\n"))
            .contains("found the end of SECTION, and none is open")
    );
}

#[test]
fn what_an_import_leaves_out_is_told() {
    let text = "[DOCUMENT]\nTITLE: T\n\n[TEXT]\nSTATEMENT: prose\n\n[REQUIREMENT]\nUID: A\nMEASURE: a\n\
                STATEMENT: x\nRELATIONS:\n- TYPE: File\n  PATH: a.c\n\n[REQUIREMENT]\nUID: B\nTITLE: b\n\
                VERIFICATION: Review\n";
    let read = sdoc::read(text, "r.sdoc").unwrap();
    let notes: Vec<String> = read.notes.iter().map(ToString::to_string).collect();
    assert_eq!(
        notes,
        [
            "line 4: free text is left out",
            "line 12: a relation of type File is left out",
            "line 9: A: MEASURE without LIMIT: how it is verified has to be added",
            "line 18: B: VERIFICATION is \"Review\": how it is verified has to be added",
        ]
    );
    // Nothing is lost, and requirements.toml says that it is open.
    let back = sdoc::read(&sdoc::write(&read.requirements).unwrap(), "r.sdoc").unwrap();
    assert_eq!(back.requirements, read.requirements);
    let toml = file::write(&read.requirements);
    assert_eq!(toml.matches("verification = \"open\"").count(), 2, "{toml}");
    assert_eq!(file::read(&toml, "r.toml", &Anything).unwrap(), read.requirements);
    let unsaid = toml.replace("verification = \"open\"\n", "");
    let error = file::read(&unsaid, "r.toml", &Anything).unwrap_err();
    assert_eq!(error.problems.len(), 2);
    assert!(error.to_string().contains("requirements.B.measure: missing"), "{error}");
}

#[test]
fn a_broken_reqif_is_told_with_its_line() {
    let said = |text: &str| reqif::read(text, "r.reqif").unwrap_err().to_string();
    assert!(
        said("<REQ-IF>\n<a></b>").starts_with("r.reqif:2:4: not XML: "),
        "{}",
        said("<REQ-IF>\n<a></b>")
    );
    assert!(
        said("<html/>")
            .starts_with("r.reqif:1:1: found html of the namespace \"\", expected REQ-IF of ")
    );
    let one = Requirement::new("N-1", "x", Verification::Analysis);
    let all = Requirements { requirements: vec![one], ..Requirements::default() };
    let good = reqif::write(&all, "2026-01-31T12:00:00Z").unwrap();
    let line = |of: &str| good.lines().position(|line| line.contains(of)).unwrap() + 1;
    for (from, to, expected) in [
        (
            "<SPEC-OBJECT-REF>octant-N-1<",
            "<SPEC-OBJECT-REF>gone<",
            "the hierarchy has an object \"gone\" that isn't in the file",
        ),
        (
            "<SPEC-OBJECT-TYPE-REF>octant-t-octant-REQUIREMENT<",
            "<SPEC-OBJECT-TYPE-REF>gone<",
            "the object \"octant-N-1\" is of a type \"gone\" that isn't in the file",
        ),
        (
            "<ATTRIBUTE-DEFINITION-XHTML-REF>",
            "<ATTRIBUTE-DEFINITION-XHTML-REF>gone",
            "that no type in the file has",
        ),
        ("<SPEC-OBJECT IDENTIFIER=\"octant-N-1\"", "<SPEC-OBJECT", "SPEC-OBJECT has no IDENTIFIER"),
    ] {
        assert!(good.contains(from), "{from}\n{good}");
        let error = said(&good.replacen(from, to, 1));
        assert!(error.contains(expected), "{error}");
        let at: usize = error.split(':').nth(1).unwrap().parse().unwrap();
        assert!(at > line("<CORE-CONTENT>"), "{error}");
    }
}

#[test]
fn what_a_format_has_no_place_for_is_refused() {
    let of = |id: &str, text: &str| Requirements {
        title: "T".to_owned(),
        requirements: vec![Requirement::new(id, text, Verification::Analysis)],
        ..Requirements::default()
    };
    let error = sdoc::write(&of("§1", "x")).unwrap_err().to_string();
    assert!(
        error.starts_with(
            "failed to write sdoc: requirement §1: its id \"§1\" is none of StrictDoc's"
        )
    );
    let error = sdoc::write(&of("A", "a\n<<<\nb")).unwrap_err().to_string();
    assert!(error.contains("STATEMENT has a line that begins with <<<"), "{error}");
    let mut choice = of("A", "x");
    choice.definitions.push(Definition {
        name: "P".to_owned(),
        kind: AttributeKind::Choice(vec!["a, b".to_owned()]),
        field: None,
    });
    let error = sdoc::write(&choice).unwrap_err().to_string();
    assert!(error.contains("the option \"a, b\" of P has a comma"), "{error}");
    // Parts unknown to StrictDoc are written where it has a place for them.
    let mut foreign = of("A", "x");
    foreign.document.push(("Author".to_owned(), "B".to_owned()));
    foreign.requirements[0].kind = Some("Requirement type 2".to_owned());
    let text = sdoc::write(&foreign).unwrap();
    assert!(
        text.contains("METADATA:\n  Author: B\n") && text.contains("\n[REQUIREMENT_TYPE]\n"),
        "{text}"
    );
    // A relation has both ends in one file: the other is named.
    let mut alone = of("A", "x");
    alone.requirements[0].parents.push(Parent { id: "Z".to_owned(), role: None });
    let imported = Imported { requirements: alone, notes: Vec::new(), attachments: Vec::new() };
    let lost = losses(&imported, ExchangeFormat::ReqIf);
    assert_eq!(lost.len(), 1);
    assert!(
        lost[0].contains("parents in other documents are left out")
            && lost[0].ends_with(": Z of A")
    );
    let mut all = of("A", "x");
    all.requirements[0].identifier = Some("1 2".to_owned());
    let error = reqif::write(&all, "").unwrap_err().to_string();
    assert!(error.contains("its identifier \"1 2\" is none that XML takes"), "{error}");
}
