//! Plain texts of formatted ones, and methods of verification.

use octant_requirements::exchange::Anything;
use octant_requirements::mapping::{self, Mapping};
use octant_requirements::{Imported, needs, reqif, sdoc};
use octant_verdict::file;
use octant_verdict::requirement::Verification;

/// A ReqIF with an object for each value of ReqIF.Text.
pub(crate) fn reqif_of(texts: &[&str]) -> String {
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

fn read(text: &str) -> Imported {
    reqif::read(&reqif_of(&[text]), "r.reqif").unwrap()
}

#[test]
fn texts_keep_their_meaning() {
    for (xhtml, plain) in [
        ("below 10<h:sup>-5</h:sup> rad/s", "below 10^-5 rad/s"),
        ("x<h:sub>i</h:sub> and y<h:sub>i, j</h:sub>", "x_i and y_(i, j)"),
        ("m<h:sup>2</h:sup>s, 10<h:sup>n<h:sup>2</h:sup></h:sup>", "m^(2)s, 10^(n^2)"),
        ("10<h:span style=\"vertical-align: super\">-5</h:span>", "10^-5"),
        ("within <h:del>1 nmi</h:del> <h:ins>2 nmi</h:ins>", "within 2 nmi"),
        ("within 1 nmi<h:del>2 nmi</h:del><h:s> 3 nmi</h:s>.", "within 1 nmi."),
        ("1<h:span style=\"text-decoration: line-through;\">0</h:span> nmi", "1 nmi"),
        (
            "<h:table>\n <h:tr>\n <h:th>Axis</h:th>\n <h:th>Limit</h:th></h:tr>\n<h:tr><h:td>x</h:td>\
             <h:td><h:p>1 deg/h</h:p><h:p>at rest</h:p></h:td></h:tr><h:tr><h:td/><h:td>2<h:br/>3</h:td></h:tr>\
             </h:table>after",
            "Axis | Limit\nx | 1 deg/h at rest\n | 2 3\n\nafter",
        ),
        (
            "All of:<h:ul><h:li>one</h:li>\n<h:li><h:p>two</h:p><h:ol><h:li>a</h:li><h:li>b</h:li></h:ol></h:li>\
             <h:li/></h:ul>and",
            "All of:\n\n- one\n- two\n  1. a\n  2. b\n\nand",
        ),
        ("<h:h1>Head</h:h1>text", "Head\n\ntext"),
        ("<h:pre>a\n  b</h:pre>c", "a\n  b\n\nc"),
        ("<h:p>a</h:p><h:p>b<h:br/>c</h:p>", "a\n\nb\nc"),
        ("a <h:b>bold</h:b> <h:i>word</h:i>", "a bold word"),
    ] {
        let found = read(xhtml);
        let only = &found.requirements.requirements[0];
        assert_eq!(only.text, plain, "{xhtml}");
        // The original is kept, and goes back.
        let original = &only.formatted[0].xhtml;
        assert_eq!(*original, format!("<div>{}</div>", xhtml.replace("h:", "")), "{xhtml}");
        let written = reqif::write(&found.requirements, "").unwrap();
        let back = reqif::read(&written, "r.reqif").unwrap();
        assert_eq!(back.requirements.requirements[0].formatted, only.formatted);
        assert_eq!(back.requirements.requirements[0].text, plain);
    }
}

#[test]
fn a_repaired_text_is_in_the_account_with_before_and_after() {
    let found = read("within 1 nmi<h:del>2 nmi</h:del> at sea");
    assert_eq!(
        found.account.lines(),
        [
            "r.reqif: 1 object read, all used, 1 repaired",
            "repaired: 1 with text that is marked as deleted, which is left out, the first o0 in line 2: \"within 1 \
             nmi2 nmi at sea\" became \"within 1 nmi at sea\""
        ]
    );
    assert_eq!(found.account.doubts(), Vec::<String>::new());
    // Deleted altogether it is no requirement that somebody could overlook.
    let gone = read("<h:del>within 1 nmi</h:del>");
    assert_eq!((gone.requirements.requirements.len(), gone.skipped()), (0, 1));
}

#[test]
fn a_requirement_with_test_among_its_methods_is_tested() {
    let all = ["Analysis, Test", "Test; Analysis", "test", "TEST,Inspection"];
    for how in all {
        let text = format!(
            "[DOCUMENT]\nTITLE: T\n\n[REQUIREMENT]\nUID: A\nVERIFICATION: {how}\nTESTS: tests::a\nSTATEMENT: x\n\n\
             [REQUIREMENT]\nUID: B\nVERIFICATION: {how}\nSTATEMENT: x\n"
        );
        let found = sdoc::read(&text, "r.sdoc").unwrap().requirements;
        let tests = Verification::Tests(vec!["tests::a".to_owned()]);
        assert_eq!(found.requirements[0].verification, tests, "{how}");
        // A test that nobody named can't pass in silence.
        assert_eq!(found.requirements[1].verification, Verification::Open, "{how}");
        let toml = file::write(&found);
        assert_eq!(file::read(&toml, "r.toml", &Anything).unwrap(), found, "{toml}");
        let back = sdoc::read(&sdoc::write(&found).unwrap(), "r.sdoc").unwrap().requirements;
        assert_eq!(back.requirements[0].verification, tests, "{how}");
        assert_eq!(back.requirements[0].attributes, found.requirements[0].attributes);
    }
    let needs = "{\"current_version\": \"1\", \"versions\": {\"1\": {\"needs\": {\"A\": {\"id\": \"A\", \"title\": \"a\", \
                 \"method\": [\"Analysis\", \"Test\"], \"limit_\": \"1 nmi\", \"m\": \"navigation.radial_error_nmi.max\"}, \
                 \"B\": {\"id\": \"B\", \"title\": \"b\", \"method\": [\"Analysis\", \"Test\"]}, \
                 \"C\": {\"id\": \"C\", \"title\": \"c\", \"method\": [\"Analysis\"]}}}}}";
    let mapping = mapping::read(
        "schema = 1\n[attributes]\nverification = \"method\"\nlimit = \"limit_\"\nmeasure = \"m\"\n\
         [values.verification]\nAnalysis = \"analysis\"\nTest = \"test\"\n",
        "m.toml",
    )
    .unwrap();
    let found = needs::read(needs, "needs.json", &mapping).unwrap().requirements;
    assert!(matches!(found.requirements[0].verification, Verification::Test(_)), "{found:?}");
    assert_eq!(found.requirements[1].verification, Verification::Open);
    assert_eq!(found.requirements[2].verification, Verification::Analysis);
    assert!(needs::read(needs, "needs.json", &Mapping::default()).is_ok());
}
