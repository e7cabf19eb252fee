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
    let two = "[REQUIREMENT]\nUID: A\nSTATEMENT: x\n\n";
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
fn a_bad_node_of_an_sdoc_costs_one_node() {
    let head = "[DOCUMENT]\nTITLE: T\n\n";
    let good = "[REQUIREMENT]\nUID: LAST\nSTATEMENT: x\n";
    for (bad, expected) in [
        (
            "[REQUIREMENT]\nUID: A\nSTATEMENT: >>>\nx\n",
            "line 4: the object REQUIREMENT can't be read in line 6: STATEMENT begins with >>> and isn't closed by a \
             line <<<: it is left out",
        ),
        (
            "[REQUIREMENT]\nSTATEMENT: x\n",
            "line 4: the object REQUIREMENT has no UID and no MID, by which it could be named: it is left out",
        ),
        (
            "[REQUIREMENT]\nUID: LAST\nSTATEMENT: y\n",
            "line 9: the object LAST has the UID of another, that of line 5: it is left out",
        ),
        (
            "[REQUIREMENT]\nUID A\nSTATEMENT: x\n",
            "line 4: the object REQUIREMENT can't be read in line 5: found \"UID A\", expected a field NAME: value: it \
             is left out",
        ),
        (
            "[REQUIREMENT]\nUID: A\nCOMMENT: >>>\n<<<\n",
            "line 4: the object A has neither STATEMENT nor TITLE: it is left out",
        ),
        (
            "[DOCUMENT_FROM_FILE]\nFILE: b.sdoc\n",
            "line 4: the object b.sdoc is another document: read it by itself: it is left out",
        ),
        (
            "COMMENT: after an empty line\n",
            "line 4: the object between the nodes is no node: found \"COMMENT: after an empty line\", expected \
             [NAME]: it is left out",
        ),
    ] {
        let read = sdoc::read(&format!("{head}{bad}\n{good}"), "r.sdoc").unwrap();
        let notes: Vec<String> = read.notes.iter().map(ToString::to_string).collect();
        assert!(notes.contains(&expected.to_owned()), "{expected}\n{notes:?}");
        assert_eq!((read.account.read(), read.skipped()), (2, 1), "{bad}");
        assert_eq!(read.requirements.requirements[0].id, "LAST");
        assert_eq!(read.account.doubts().len(), 1);
    }
    // A MID names a node as well.
    let mid = "[REQUIREMENT]\nMID: 06a1\nSTATEMENT: x\nCOMMENT: >>>\n<<<\n\n[TEXT]\nSTATEMENT: y\n";
    let read = sdoc::read(&format!("{head}{mid}"), "r.sdoc").unwrap();
    assert_eq!(read.requirements.requirements[0].id, "06a1");
    let account = &read.account;
    let counts = (account.read(), account.repaired_count(), account.left_out_count());
    assert_eq!((counts, account.doubts()), ((2, 1, 1), vec![]));
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
    assert!(said("<RIF/>").contains("found RIF, the format before ReqIF"), "{}", said("<RIF/>"));
}

fn two_of_reqif() -> String {
    let of = |id: &str| Requirement::new(id, "x", Verification::Analysis);
    let all = Requirements { requirements: vec![of("N-1"), of("N-2")], ..Requirements::default() };
    reqif::write(&all, "2026-01-31T12:00:00Z").unwrap()
}

#[test]
fn a_bad_object_of_a_reqif_costs_one_object() {
    let good = two_of_reqif();
    let line = |of: &str| good.lines().position(|line| line.contains(of)).unwrap() + 1;
    let at = line("<SPEC-OBJECT IDENTIFIER=\"octant-N-1\"");
    for (from, to, expected, counts) in [
        (
            "<SPEC-OBJECT-REF>octant-N-1<",
            "<SPEC-OBJECT-REF>gone<",
            format!(
                "line {}: the hierarchy has an object \"gone\" that isn't in the file",
                line("<SPEC-OBJECT-REF>octant-N-1<") - 2
            ),
            (2, 0, 1),
        ),
        (
            "<SPEC-OBJECT-TYPE-REF>octant-t-octant-REQUIREMENT<",
            "<SPEC-OBJECT-TYPE-REF>gone<",
            format!(
                "line {at}: the object octant-N-1 is of a type \"gone\" that isn't in the file: it is left out"
            ),
            (2, 1, 0),
        ),
        (
            "<ATTRIBUTE-DEFINITION-XHTML-REF>",
            "<ATTRIBUTE-DEFINITION-XHTML-REF>gone",
            format!(
                "line {at}: the object octant-N-1 has an attribute \"goneoctant-t-octant-REQUIREMENT-a-2\" that no \
                 type in the file has: it is left out"
            ),
            (2, 1, 0),
        ),
        (
            "<SPEC-OBJECT IDENTIFIER=\"octant-N-1\"",
            "<SPEC-OBJECT",
            format!(
                "line {at}: the object without an IDENTIFIER has no IDENTIFIER: it is left out"
            ),
            (2, 1, 1),
        ),
        (
            "<SPEC-OBJECT IDENTIFIER=\"octant-N-2\"",
            "<SPEC-OBJECT IDENTIFIER=\"octant-N-1\"",
            format!(
                "line {}: the object octant-N-1 is there a second time, the first is in line {at}: it is left out",
                line("<SPEC-OBJECT IDENTIFIER=\"octant-N-2\"")
            ),
            (2, 1, 1),
        ),
        (
            "THE-VALUE=\"N-2\"",
            "THE-VALUE=\"N-1\"",
            format!(
                "line {}: the object octant-N-2 has the id \"N-1\" of another, that of line {at}: it is left out",
                line("<SPEC-OBJECT IDENTIFIER=\"octant-N-2\"")
            ),
            (2, 1, 0),
        ),
    ] {
        assert!(good.contains(from), "{from}\n{good}");
        let read = reqif::read(&good.replacen(from, to, 1), "r.reqif").unwrap();
        let notes: Vec<String> = read.notes.iter().map(ToString::to_string).collect();
        assert!(notes.contains(&expected), "{expected}\n{notes:?}");
        let account = &read.account;
        let found = (account.read(), account.left_out_count(), account.missing_count());
        assert_eq!(found, counts, "{to}");
        assert_eq!(account.doubts().len() as u64, counts.1 + counts.2);
        assert_eq!(read.requirements.requirements.len() as u64, 2 - counts.1);
    }
}

#[test]
fn other_forms_of_reqif_are_read() {
    let good = two_of_reqif();
    let is_read = |text: &str| {
        let read = reqif::read(text, "r.reqif").unwrap();
        assert_eq!(read.requirements.requirements.len(), 2);
        read
    };
    is_read(&format!("\n \r\n{good}"));
    let later = good.replace("<CORE-CONTENT>", "<CORE-CONTENT></x>");
    let at = good.lines().position(|line| line.contains("<CORE-CONTENT>")).unwrap() + 1;
    let error = reqif::read(&format!("\n\n{later}"), "r.reqif").unwrap_err().to_string();
    assert!(error.starts_with(&format!("r.reqif:{}:", at + 2)), "{error}");
    let read = is_read(&good.replace("ReqIF/20110401/reqif.xsd", "ReqIF/20101201"));
    assert!(
        read.account.lines()[1].contains("the namespace of 2010"),
        "{:?}",
        read.account.lines()
    );
    // A head whose names StrictDoc doesn't take becomes one that it does.
    let mut all = read.requirements;
    all.document.push(("ReqIF.Prefix".to_owned(), "NAV".to_owned()));
    let text = sdoc::write(&all).unwrap();
    assert!(text.contains("  ReqIF_Prefix: NAV\n"), "{text}");
    let lost = losses(&Imported::own(all, "r.toml"), ExchangeFormat::StrictDoc);
    assert_eq!(
        lost,
        ["these names in the head of the document get _ for other characters: ReqIF.Prefix"]
    );
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
    let imported = Imported::own(alone, "r.toml");
    let lost = losses(&imported, ExchangeFormat::ReqIf);
    assert_eq!(lost.len(), 1);
    assert!(
        lost[0].contains("parents in other documents are left out")
            && lost[0].ends_with(": Z of A")
    );
    // An identifier that XML doesn't take, as a MID that begins with a digit, is written in another form.
    let mut all = of("A", "x");
    for id in ["1 2", "06a1f3", "a_b", "octant_id-x", "é+"] {
        all.requirements[0].identifier = Some(id.to_owned());
        let text = reqif::write(&all, "").unwrap();
        let back = reqif::read(&text, "r.reqif").unwrap();
        assert_eq!(back.requirements.requirements[0].identifier.as_deref(), Some(id), "{text}");
    }
}

#[test]
fn the_time_of_reading_grows_with_the_size() {
    let of = |count: usize| {
        let one = |at: usize| Requirement::new(&format!("N-{at}"), "x\ny", Verification::Analysis);
        let requirements = (0..count).map(one).collect();
        reqif::write(&Requirements { requirements, ..Requirements::default() }, "").unwrap()
    };
    let (few, many) = (of(500), of(8000));
    let time = |text: &str| {
        let all = (0..3).map(|_| {
            let begin = std::time::Instant::now();
            assert!(reqif::read(text, "r.reqif").is_ok());
            begin.elapsed()
        });
        all.min().unwrap()
    };
    // 16 times as many objects took 256 times as long.
    let ratio = time(&many).as_secs_f64() / time(&few).as_secs_f64();
    assert!(ratio < 100.0, "{ratio}");
}
