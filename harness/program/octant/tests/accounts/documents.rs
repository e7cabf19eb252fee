//! Documents of requirements, whole and damaged, converted by the program; the new file keeps the account.

use super::table::{Case, Counts, Ends, Part};

const HEAD: &str = "[DOCUMENT]\nTITLE: Navigation\n";

/// StrictDoc's document of these nodes, and of one after them.
fn sdoc(nodes: &[&str]) -> String {
    let last = "[REQUIREMENT]\nUID: LAST\nSTATEMENT: It holds.\nVERIFICATION: Analysis\n";
    format!("{HEAD}\n{}", [nodes, &[last]].concat().join("\n"))
}

/// ReqIF of these texts of XHTML: `N-0` is the id of the first.
fn reqif(texts: &[&str]) -> String {
    let objects: String = (texts.iter().enumerate())
        .map(|(at, text)| {
            format!(
                "<SPEC-OBJECT IDENTIFIER=\"o{at}\"><TYPE><SPEC-OBJECT-TYPE-REF>t</SPEC-OBJECT-TYPE-REF></TYPE><VALUES>\
                 <ATTRIBUTE-VALUE-STRING THE-VALUE=\"N-{at}\"><DEFINITION><ATTRIBUTE-DEFINITION-STRING-REF>i\
                 </ATTRIBUTE-DEFINITION-STRING-REF></DEFINITION></ATTRIBUTE-VALUE-STRING><ATTRIBUTE-VALUE-XHTML>\
                 <DEFINITION><ATTRIBUTE-DEFINITION-XHTML-REF>x</ATTRIBUTE-DEFINITION-XHTML-REF></DEFINITION>\
                 <THE-VALUE><h:div>{text}</h:div></THE-VALUE></ATTRIBUTE-VALUE-XHTML></VALUES></SPEC-OBJECT>\n"
            )
        })
        .collect();
    format!(
        "<REQ-IF xmlns=\"http://www.omg.org/spec/ReqIF/20110401/reqif.xsd\" xmlns:h=\"http://www.w3.org/1999/xhtml\">\
         <CORE-CONTENT><REQ-IF-CONTENT><SPEC-TYPES><SPEC-OBJECT-TYPE IDENTIFIER=\"t\" LONG-NAME=\"R\">\
         <SPEC-ATTRIBUTES><ATTRIBUTE-DEFINITION-STRING IDENTIFIER=\"i\" LONG-NAME=\"ReqIF.ForeignID\"/>\
         <ATTRIBUTE-DEFINITION-XHTML IDENTIFIER=\"x\" LONG-NAME=\"ReqIF.Text\"/></SPEC-ATTRIBUTES>\
         </SPEC-OBJECT-TYPE></SPEC-TYPES><SPEC-OBJECTS>\n{objects}</SPEC-OBJECTS></REQ-IF-CONTENT></CORE-CONTENT>\
         </REQ-IF>"
    )
}

fn needs(needs: &str) -> String {
    format!("{{\"current_version\": \"1\", \"versions\": {{\"1\": {{\"needs\": {{{needs}}}}}}}}}")
}

struct Documents(Part);

impl Documents {
    fn row(&mut self, file: &str, holds: &str, content: &str, counts: Counts, ends: Ends) {
        let input = file.rsplit_once('.').map_or(file, |(_, ending)| ending);
        let counts: &[_] = if matches!(ends, Ends::Refused(_)) { &[] } else { &[(file, counts)] };
        let files: [(&str, &[u8]); 1] = [(file, content.as_bytes())];
        self.0.converts(&Case { input, holds, files: &files, set: &[], counts, ends });
    }
}

#[test]
fn documents_of_requirements() {
    let mut part = Documents(Part::new("documents"));
    let used = Counts::used;
    let node = |uid: &str| format!("[REQUIREMENT]\nUID: {uid}\nSTATEMENT: It holds.\n");
    let (one, two) = (node("N-1"), node("N-2"));
    let mut sdoc_row = |holds: &str, nodes: &[&str], counts: Counts, ends: Ends| {
        part.row("d.sdoc", holds, &sdoc(nodes), counts, ends);
    };
    sdoc_row("three nodes", &[&one, &two], used(3), Ends::Pass);
    sdoc_row("free text", &["[TEXT]\nSTATEMENT: x\n"], used(1).left_out(1), Ends::Pass);
    sdoc_row(
        "a MID in place of a UID",
        &["[REQUIREMENT]\nMID: 06a1\nSTATEMENT: x\n"],
        used(1).repaired(1),
        Ends::Pass,
    );
    let lost = |words| Ends::Inconclusive(words);
    sdoc_row(
        "neither MID nor UID",
        &["[REQUIREMENT]\nSTATEMENT: x\n"],
        used(1).left_out(1),
        lost("without an id"),
    );
    sdoc_row("a UID twice", &[&one, &one], used(2).left_out(1), lost("with the id of another"));
    sdoc_row("a title alone", &["[REQUIREMENT]\nUID: A\nTITLE: x\n"], used(2), Ends::Pass);
    sdoc_row(
        "neither statement nor title",
        &["[REQUIREMENT]\nUID: A\n"],
        used(1).left_out(1),
        lost("without a text"),
    );
    sdoc_row(
        "a field without a colon",
        &["[REQUIREMENT]\nUID A\n"],
        used(1).left_out(1),
        lost("that can't be read"),
    );
    sdoc_row(
        "a statement whose end is missing",
        &["[REQUIREMENT]\nUID: A\nSTATEMENT: >>>\nx\n", &two],
        used(2).left_out(1),
        lost("that can't be read"),
    );
    sdoc_row(
        "another document within it",
        &["[DOCUMENT_FROM_FILE]\nFILE: b.sdoc\n"],
        used(1).left_out(1),
        lost("that are documents of their own"),
    );
    part.row(
        "d.sdoc",
        "no title of the document",
        "[DOCUMENT]\nVERSION: 1\n",
        used(0),
        Ends::Refused("has no TITLE"),
    );
    let mut reqif_row = |holds: &str, text: &str, counts: Counts, ends: Ends| {
        part.row("d.reqif", holds, text, counts, ends);
    };
    let good = reqif(&["It holds.", "It stays."]);
    reqif_row("two objects", &good, used(2), Ends::Pass);
    reqif_row(
        "an empty line before it",
        &format!("\n<?xml version=\"1.0\"?>{good}"),
        used(2),
        Ends::Pass,
    );
    reqif_row(
        "the namespace of 2010",
        &good.replace("20110401/reqif.xsd", "20101201"),
        used(2),
        Ends::Pass,
    );
    reqif_row(
        "superscripts and a list",
        &reqif(&["10<h:sup>-5</h:sup>", "<h:ul><h:li>x</h:li></h:ul>"]),
        used(2),
        Ends::Pass,
    );
    reqif_row(
        "deleted text",
        &reqif(&["within 1 nmi<h:del>2 nmi</h:del>"]),
        used(0).repaired(1),
        Ends::Pass,
    );
    reqif_row(
        "all of a text deleted",
        &reqif(&["x", "<h:del>y</h:del>"]),
        used(1).left_out(1),
        lost("without a text"),
    );
    reqif_row(
        "an identifier twice",
        &good.replace("\"o1\"", "\"o0\""),
        used(1).left_out(1),
        lost("with the id of another"),
    );
    reqif_row(
        "a type that isn't there",
        &good.replacen("REF>t<", "REF>u<", 1),
        used(1).left_out(1),
        lost("that the document doesn't define"),
    );
    reqif_row(
        "an object without an id",
        &good.replace("\"N-1\"", "\"\""),
        used(1).left_out(1),
        lost("without an id"),
    );
    reqif_row(
        "a hierarchy with an object that isn't there",
        &good.replace(
            "</SPEC-OBJECTS>",
            "</SPEC-OBJECTS><SPECIFICATIONS><SPECIFICATION IDENTIFIER=\"s\"><CHILDREN><SPEC-HIERARCHY IDENTIFIER=\"h\">\
             <OBJECT><SPEC-OBJECT-REF>gone</SPEC-OBJECT-REF></OBJECT></SPEC-HIERARCHY></CHILDREN></SPECIFICATION>\
             </SPECIFICATIONS>",
        ),
        used(2).missing(1),
        lost("that the hierarchy names"),
    );
    reqif_row("the format before ReqIF", "<RIF/>", used(0), Ends::Refused("found RIF"));
    reqif_row("cut off", &good[..good.len() - 9], used(0), Ends::Refused("not XML"));
    let mut needs_row = |holds: &str, text: &str, counts: Counts, ends: Ends| {
        part.row("needs.json", holds, &needs(text), counts, ends);
    };
    let one = "\"N_1\": {\"title\": \"a\", \"content\": \"It holds.\"}";
    needs_row(
        "a need, and a test",
        &format!("{one}, \"T_1\": {{\"type\": \"test\", \"title\": \"b\"}}"),
        used(1).left_out(1),
        Ends::Pass,
    );
    needs_row(
        "a title without a body",
        "\"N_1\": {\"title\": \"a\", \"content\": \"\"}",
        used(1),
        Ends::Pass,
    );
    needs_row(
        "an id twice",
        &format!("{one}, {one}"),
        used(1).left_out(1),
        lost("with the id of another"),
    );
    needs_row(
        "a body that is no text",
        &format!("{one}, \"N_2\": {{\"title\": \"b\", \"content\": [[1]]}}"),
        used(1).left_out(1),
        lost("that can't be read"),
    );
    part.row("needs.json", "cut off", &needs(one)[..40], used(0), Ends::Refused("not JSON"));
    part.0.finish(24);
}
