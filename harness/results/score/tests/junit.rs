//! JUnit XML within the schema of Jenkins' xUnit plugin.

use octant_score::junit::{
    JunitCase, JunitCases, JunitSuite, JunitTimes, document, write_document,
};
use octant_verdict::Verdict;
use std::io;
use std::time::{Duration, UNIX_EPOCH};

fn case(verdict: Verdict, message: &str) -> JunitCase {
    JunitCase {
        name: format!("{} <&>", verdict.name()),
        class: "c".to_owned(),
        properties: Vec::new(),
        times: None,
        verdict,
        message: message.to_owned(),
    }
}

/// The file is that of nextest but for properties of test cases, and the number of skipped ones of all suites, for which
/// the schema of Jenkins' xUnit plugin has no place.
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
            times: Some(JunitTimes {
                started: UNIX_EPOCH + Duration::from_secs(1_790_000_000),
                ended: UNIX_EPOCH + Duration::from_millis(1_790_001_234_567),
            }),
            cases: all.to_vec(),
        },
        JunitSuite {
            name: "empty".to_owned(),
            properties: Vec::new(),
            times: None,
            cases: Vec::new(),
        },
    ];
    let expected = r#"<?xml version="1.0" encoding="UTF-8"?>
<testsuites name="octant" tests="4" failures="1" errors="1">
    <testsuite name="s" tests="4" skipped="1" errors="1" failures="1" time="1234.567" timestamp="2026-09-21T14:13:20Z">
        <properties>
            <property name="seed" value="7"/>
        </properties>
        <testcase name="pass &lt;&amp;&gt;" classname="c"/>
        <testcase name="fail &lt;&amp;&gt;" classname="c">
            <failure message="found &quot;3&quot;" type="fail"/>
            <system-out>[[PROPERTY|verifies=NAV-1]]</system-out>
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

    /// Cases that are made when they are written.
    struct Made(usize);
    impl JunitCases for Made {
        fn each(&self, put: &mut dyn FnMut(&JunitCase) -> io::Result<()>) -> io::Result<()> {
            (0..self.0).try_for_each(|number| put(&case(Verdict::Fail, &number.to_string())))
        }
    }
    let made =
        JunitSuite { name: "m".to_owned(), properties: Vec::new(), times: None, cases: Made(3) };
    let listed = (0..3).map(|number| case(Verdict::Fail, &number.to_string()));
    let listed = JunitSuite {
        cases: listed.collect(),
        name: "m".to_owned(),
        properties: Vec::new(),
        times: None,
    };
    let mut written = Vec::new();
    write_document("octant", &[made], &mut written).unwrap();
    assert_eq!(String::from_utf8(written).unwrap(), document("octant", &[listed]).unwrap());
}

#[test]
fn control_characters_are_escaped() {
    let suite = JunitSuite {
        name: "a\u{1b}[31m\0\u{ffff}b\t".to_owned(),
        properties: Vec::new(),
        times: None,
        cases: Vec::new(),
    };
    let xml = document("octant", &[suite]).expect("can be written");
    assert!(xml.contains("name=\"a\\u001b[31m\\u0000\\uffffb"), "{xml}");
    assert!(!xml.contains(['\u{1b}', '\0', '\u{ffff}']), "{xml:?}");
}
