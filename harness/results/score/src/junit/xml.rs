//! JUnit XML as CI systems read it: within the schema of Jenkins' xUnit plugin (`junit-10.xsd`), which is the strictest. It
//! knows no properties of a test case: they are lines `[[PROPERTY|NAME=VALUE]]` of its `system-out`, which test
//! management systems read.

use octant_base::printable::printable;
use octant_verdict::Verdict;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, BytesText, Event};
use std::io;
use std::time::SystemTime;

/// Suite of test cases.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JunitSuite<C = Vec<JunitCase>> {
    /// Name.
    pub name: String,
    /// Names and values of its properties.
    pub properties: Vec<(&'static str, String)>,
    /// Time of its tests.
    pub times: Option<JunitTimes>,
    /// Test cases.
    pub cases: C,
}

/// Time in which tests ran.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JunitTimes {
    /// Beginning.
    pub started: SystemTime,
    /// End.
    pub ended: SystemTime,
}

impl JunitTimes {
    /// Duration as the schema has it, s.
    fn seconds(self) -> String {
        let duration = self.ended.duration_since(self.started).unwrap_or_default();
        format!("{}.{:03}", duration.as_secs(), duration.subsec_millis())
    }
}

/// Test cases of a suite, which need not be in memory together.
pub trait JunitCases {
    /// Passes on one case after another: every time the same ones.
    ///
    /// # Errors
    /// The first error of `put`.
    fn each(&self, put: &mut dyn FnMut(&JunitCase) -> io::Result<()>) -> io::Result<()>;
}

impl JunitCases for Vec<JunitCase> {
    fn each(&self, put: &mut dyn FnMut(&JunitCase) -> io::Result<()>) -> io::Result<()> {
        self.iter().try_for_each(put)
    }
}

/// Numbers of test cases.
#[derive(Clone, Copy, Debug, Default)]
struct CaseNumbers {
    tests: usize,
    skipped: usize,
    failures: usize,
    errors: usize,
}

impl CaseNumbers {
    fn of(cases: &impl JunitCases) -> io::Result<Self> {
        let mut all = Self::default();
        cases.each(&mut |case| {
            all.tests += 1;
            match case.element() {
                Some("skipped") => all.skipped += 1,
                Some("failure") => all.failures += 1,
                Some(_) => all.errors += 1,
                None => {}
            }
            Ok(())
        })?;
        Ok(all)
    }
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
    /// Time in which it ran, where that is known.
    pub times: Option<JunitTimes>,
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

    fn write(&self, writer: &mut Writer<impl io::Write>) -> io::Result<()> {
        let mut tag = tag("testcase", &[("name", &self.name), ("classname", &self.class)]);
        if let Some(times) = self.times {
            tag.push_attribute(("time", &*times.seconds()));
        }
        let element = self.element();
        if self.properties.is_empty() && element.is_none() {
            return writer.write_event(Event::Empty(tag));
        }
        writer.write_event(Event::Start(tag))?;
        if let Some(element) = element {
            let kind = self.verdict.name();
            let attributes = [("message", self.message.as_str()), ("type", kind)];
            let shown = if element == "skipped" { &attributes[..1] } else { &attributes };
            writer.write_event(Event::Empty(self::tag(element, shown)))?;
        }
        if !self.properties.is_empty() {
            let line = |(name, value): &(&str, String)| format!("[[PROPERTY|{name}={value}]]");
            let lines = self.properties.iter().map(line).collect::<Vec<_>>().join("\n");
            writer.write_event(Event::Start(BytesStart::new("system-out")))?;
            writer.write_event(Event::Text(BytesText::new(&in_lines(&lines))))?;
            writer.write_event(Event::End(BytesEnd::new("system-out")))?;
        }
        writer.write_event(Event::End(BytesEnd::new("testcase")))
    }
}

/// Writes suites as one file of this name.
///
/// # Errors
/// If the XML can't be written.
pub fn document(name: &str, suites: &[JunitSuite]) -> io::Result<String> {
    let mut text = Vec::new();
    write_document(name, suites, &mut text)?;
    String::from_utf8(text).map_err(io::Error::other)
}

/// Writes suites as [`document`] does, into a file. The cases of each are asked for twice: their numbers come
/// first.
///
/// # Errors
/// If the XML can't be written.
pub fn write_document<C: JunitCases>(
    name: &str,
    suites: &[JunitSuite<C>],
    to: impl io::Write,
) -> io::Result<()> {
    let mut writer = Writer::new_with_indent(to, b' ', 4);
    writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let numbers = suites.iter().map(|suite| CaseNumbers::of(&suite.cases));
    let numbers = numbers.collect::<io::Result<Vec<CaseNumbers>>>()?;
    let sum = |of: fn(&CaseNumbers) -> usize| numbers.iter().map(of).sum::<usize>().to_string();
    let attributes = [
        ("name", name),
        ("tests", &sum(|all| all.tests)),
        ("failures", &sum(|all| all.failures)),
        ("errors", &sum(|all| all.errors)),
    ];
    writer.write_event(Event::Start(tag("testsuites", &attributes)))?;
    for (suite, numbers) in suites.iter().zip(&numbers) {
        write_suite(suite, *numbers, &mut writer)?;
    }
    writer.write_event(Event::End(BytesEnd::new("testsuites")))?;
    writer.write_indent()
}

fn write_suite<C: JunitCases>(
    suite: &JunitSuite<C>,
    numbers: CaseNumbers,
    writer: &mut Writer<impl io::Write>,
) -> io::Result<()> {
    let mut tag = tag(
        "testsuite",
        &[
            ("name", &suite.name),
            ("tests", &numbers.tests.to_string()),
            ("skipped", &numbers.skipped.to_string()),
            ("errors", &numbers.errors.to_string()),
            ("failures", &numbers.failures.to_string()),
        ],
    );
    if let Some(times) = suite.times {
        tag.push_attribute(("time", &*times.seconds()));
        tag.push_attribute(("timestamp", &*octant_base::utc::seconds(times.started)));
    }
    if suite.properties.is_empty() && numbers.tests == 0 {
        return writer.write_event(Event::Empty(tag));
    }
    writer.write_event(Event::Start(tag))?;
    properties(&suite.properties, writer)?;
    suite.cases.each(&mut |case| case.write(writer))?;
    writer.write_event(Event::End(BytesEnd::new("testsuite")))
}

fn properties(
    all: &[(&'static str, String)],
    writer: &mut Writer<impl io::Write>,
) -> io::Result<()> {
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

/// Escapes control characters but line ends.
fn in_lines(text: &str) -> String {
    text.split('\n').map(printable).collect::<Vec<_>>().join("\n")
}

/// Makes a tag with attributes. Control characters are escaped: XML has no form for most of them, and
/// a terminal would obey others.
fn tag<'a>(name: &'a str, attributes: &[(&str, &str)]) -> BytesStart<'a> {
    let mut tag = BytesStart::new(name);
    for (key, value) in attributes {
        tag.push_attribute((*key, &*printable(value)));
    }
    tag
}
