//! JUnit XML, in the flavour of nextest that CI systems read.

use octant_requirements::Verdict;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, Event};
use std::io;

/// Suite of test cases.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JunitSuite {
    /// Name.
    pub name: String,
    /// Names and values of its properties.
    pub properties: Vec<(&'static str, String)>,
    /// Test cases.
    pub cases: Vec<JunitCase>,
}

/// Test case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JunitCase {
    /// Name.
    pub name: String,
    /// Name of the class, which CI systems group by.
    pub class: String,
    /// Names and values of its properties.
    pub properties: Vec<(&'static str, String)>,
    /// Verdict. JUnit has no "inconclusive": it becomes an error of that type, because it must never
    /// count as passed.
    pub verdict: Verdict,
    /// Reason of a verdict that isn't a pass.
    pub message: String,
}

impl JunitCase {
    /// Element that says why the case isn't a success; `None` for a pass.
    fn element(&self) -> Option<&'static str> {
        match self.verdict {
            Verdict::None => Some("skipped"),
            Verdict::Pass => None,
            Verdict::Fail => Some("failure"),
            Verdict::Inconclusive | Verdict::Error => Some("error"),
        }
    }

    fn write(&self, writer: &mut Writer<Vec<u8>>) -> io::Result<()> {
        let tag = tag("testcase", &[("name", &self.name), ("classname", &self.class)]);
        let element = self.element();
        if self.properties.is_empty() && element.is_none() {
            return writer.write_event(Event::Empty(tag));
        }
        writer.write_event(Event::Start(tag))?;
        properties(&self.properties, writer)?;
        if let Some(element) = element {
            let kind = self.verdict.name();
            let attributes = [("message", self.message.as_str()), ("type", kind)];
            let shown = if element == "skipped" { &attributes[..1] } else { &attributes };
            writer.write_event(Event::Empty(self::tag(element, shown)))?;
        }
        writer.write_event(Event::End(BytesEnd::new("testcase")))
    }
}

/// Writes suites as one file of this name.
///
/// # Errors
/// If the XML can't be written.
pub fn document(name: &str, suites: &[JunitSuite]) -> io::Result<String> {
    let mut writer = Writer::new_with_indent(Vec::new(), b' ', 4);
    writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let count = |element| count(suites.iter().flat_map(|suite| &suite.cases), element);
    let attributes = [
        ("name", name),
        ("tests", &suites.iter().map(|suite| suite.cases.len()).sum::<usize>().to_string()),
        ("skipped", &count("skipped")),
        ("failures", &count("failure")),
        ("errors", &count("error")),
    ];
    writer.write_event(Event::Start(tag("testsuites", &attributes)))?;
    for suite in suites {
        write_suite(suite, &mut writer)?;
    }
    writer.write_event(Event::End(BytesEnd::new("testsuites")))?;
    writer.write_indent()?;
    String::from_utf8(writer.into_inner()).map_err(io::Error::other)
}

fn write_suite(suite: &JunitSuite, writer: &mut Writer<Vec<u8>>) -> io::Result<()> {
    let count = |element| count(suite.cases.iter(), element);
    let tag = tag(
        "testsuite",
        &[
            ("name", &suite.name),
            ("tests", &suite.cases.len().to_string()),
            ("skipped", &count("skipped")),
            ("errors", &count("error")),
            ("failures", &count("failure")),
        ],
    );
    if suite.properties.is_empty() && suite.cases.is_empty() {
        return writer.write_event(Event::Empty(tag));
    }
    writer.write_event(Event::Start(tag))?;
    properties(&suite.properties, writer)?;
    for case in &suite.cases {
        case.write(writer)?;
    }
    writer.write_event(Event::End(BytesEnd::new("testsuite")))
}

fn properties(all: &[(&'static str, String)], writer: &mut Writer<Vec<u8>>) -> io::Result<()> {
    if all.is_empty() {
        return Ok(());
    }
    writer.write_event(Event::Start(BytesStart::new("properties")))?;
    for (name, value) in all {
        let property = tag("property", &[("name", name), ("value", value)]);
        writer.write_event(Event::Empty(property))?;
    }
    writer.write_event(Event::End(BytesEnd::new("properties")))
}

fn count<'a>(cases: impl Iterator<Item = &'a JunitCase>, element: &str) -> String {
    cases.filter(|case| case.element() == Some(element)).count().to_string()
}

/// Makes a tag with attributes. Control characters are left out: XML has no form for most of them, and
/// a terminal would obey others.
fn tag<'a>(name: &'a str, attributes: &[(&str, &str)]) -> BytesStart<'a> {
    let fits = |c: &char| *c == '\n' || !(c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}'));
    let mut tag = BytesStart::new(name);
    for (key, value) in attributes {
        tag.push_attribute((*key, value.chars().filter(fits).collect::<String>().as_str()));
    }
    tag
}
