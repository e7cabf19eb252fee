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

#[cfg(test)]
mod tests {
    use super::*;

    fn case(verdict: Verdict, message: &str) -> JunitCase {
        JunitCase {
            name: format!("{} <&>", verdict.name()),
            class: "c".to_owned(),
            properties: Vec::new(),
            verdict,
            message: message.to_owned(),
        }
    }

    /// The file is that of the crate quick-junit, version 0.8, for the same cases.
    #[test]
    fn the_file_is_that_of_nextest() {
        let mut fails = case(Verdict::Fail, "found \"3\"");
        fails.properties.push(("verifies", "NAV-1".to_owned()));
        let all = [
            case(Verdict::Pass, ""),
            fails,
            case(Verdict::Inconclusive, "late"),
            case(Verdict::None, "not checked"),
        ];
        let suites = [
            JunitSuite {
                name: "s".to_owned(),
                properties: vec![("seed", "7".to_owned())],
                cases: all.to_vec(),
            },
            JunitSuite { name: "empty".to_owned(), properties: Vec::new(), cases: Vec::new() },
        ];
        let expected = r#"<?xml version="1.0" encoding="UTF-8"?>
<testsuites name="octant" tests="4" skipped="1" failures="1" errors="1">
    <testsuite name="s" tests="4" skipped="1" errors="1" failures="1">
        <properties>
            <property name="seed" value="7"/>
        </properties>
        <testcase name="pass &lt;&amp;&gt;" classname="c"/>
        <testcase name="fail &lt;&amp;&gt;" classname="c">
            <properties>
                <property name="verifies" value="NAV-1"/>
            </properties>
            <failure message="found &quot;3&quot;" type="fail"/>
        </testcase>
        <testcase name="inconclusive &lt;&amp;&gt;" classname="c">
            <error message="late" type="inconclusive"/>
        </testcase>
        <testcase name="none &lt;&amp;&gt;" classname="c">
            <skipped message="not checked"/>
        </testcase>
    </testsuite>
    <testsuite name="empty" tests="0" skipped="0" errors="0" failures="0"/>
</testsuites>
"#;
        assert_eq!(document("octant", &suites).expect("can be written"), expected);
    }

    #[test]
    fn control_characters_are_left_out() {
        let suite = JunitSuite {
            name: "a\u{1b}[31m\0\u{ffff}b\t".to_owned(),
            properties: Vec::new(),
            cases: Vec::new(),
        };
        let xml = document("octant", &[suite]).expect("can be written");
        assert!(xml.contains("name=\"a[31mb\""), "{xml}");
    }
}
