//! Error texts of invalid files: place, path, found, expected.

use octant_verdict::file::{self, Checker};
use octant_verdict::requirement::{EnsembleRequirement, Limit, Verification, percent, probability};

const HEAD: &str = "schema = 1\n[[requirements]]\nid = \"N-1\"\ntext = \"x\"\n";

/// Accepts whatever a run might have.
struct Anything;

impl Checker for Anything {
    fn measure(&self, _: &str) -> Result<(), String> {
        Ok(())
    }

    fn limit(&self, _: &str, _: &Limit) -> Result<(), String> {
        Ok(())
    }

    fn formatted(&self, _: &str) -> Result<(), String> {
        Ok(())
    }
}

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
             title, text, measure, comparison, limit, secant_latitude, pass, confidence, verification, tests, \
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
            "measure = \"a\"\nlimit = 1\npass = \"95 %\"\nconfidence = \"1 %\"\n",
            "found \"1 %\", expected a confidence of at least 50 %",
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

    fn formatted(&self, xhtml: &str) -> Result<(), String> {
        if xhtml == "drift" { Ok(()) } else { Err(format!("found {xhtml:?}, expected drift")) }
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
    let formatted = |xhtml: &str| {
        let text =
            format!("{HEAD}verification = \"analysis\"\nformatted = {{ T = \"{xhtml}\" }}\n");
        file::read(&text, "r.toml", &OnlyDrift).map_err(|error| error.to_string())
    };
    assert!(formatted("drift").is_ok());
    let wrong = "r.toml:6:19: requirements.N-1.formatted.T: found \"drft\", expected drift";
    assert_eq!(formatted("drft").unwrap_err(), wrong);
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
fn the_factor_sec_phi_belongs_to_errors_of_a_heading() {
    let with = |measure: &str, flag: &str| {
        format!("{HEAD}measure = \"{measure}\"\nlimit = \"1 deg\"\nsecant_latitude = {flag}\n")
    };
    let read = |text: &str| file::read(text, "r.toml", &Anything).unwrap();
    for (flag, expected) in [("true", true), ("false", false)] {
        let found = read(&with("|heading.settle_point_error_deg|", flag));
        let check = found.requirements[0].check().unwrap();
        assert_eq!(check.secant_latitude, expected);
        // It comes back from the file that is written.
        assert_eq!(read(&file::write(&found)), found);
    }
    let refused = problems(&with("navigation.heading_error_arcmin.max", "true"));
    assert_eq!(refused.len(), 1, "{refused:?}");
    for part in ["7:", "secant_latitude", "no factor sec φ", "heading.repeatability_deg"] {
        assert!(refused[0].contains(part), "{part:?} is not in {refused:?}");
    }
    let no_flag = problems(&with("heading.repeatability_deg", "\"yes\""));
    assert!(no_flag[0].contains("expected true or false"), "{no_flag:?}");
}
