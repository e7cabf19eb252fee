//! Error texts of files of other tools, and of what a format has no place for.

use octant_requirements::exchange::Anything;
use octant_requirements::format::ExchangeFormat;
use octant_requirements::losses::losses;
use octant_requirements::{Imported, reqif, sdoc};
use octant_verdict::file;
use octant_verdict::requirement::{
    AttributeKind, Definition, Parent, Requirement, Requirements, Verification,
};

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
fn a_formatted_text_is_xhtml() {
    let said = |xhtml: &str| {
        let text = format!(
            "schema = 1\n[[requirements]]\nid = \"N-1\"\ntext = \"x\"\nverification = \"analysis\"\n\
             formatted = {{ T = \"{xhtml}\" }}\n"
        );
        file::read(&text, "r.toml", &Anything).map_err(|error| error.to_string())
    };
    assert!(said("<p>a <b>b</b></p>").is_ok());
    let error = said("<p>a").unwrap_err();
    let place = "r.toml:6:19: requirements.N-1.formatted.T: ";
    assert!(error.starts_with(&format!("{place}not XHTML: ")), "{error}");
    assert_eq!(
        said("<s xmlns='urn:x'>a</s>").unwrap_err(),
        format!("{place}found s, expected elements of XHTML")
    );
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
