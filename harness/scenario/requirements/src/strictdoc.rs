//! The trace in StrictDoc: results as a document beside that of the requirements.
//!
//! StrictDoc reads test reports in JUnit XML, but links a result to a requirement only through the
//! source file of the test, and refuses a report with an error in it. So results are written as a
//! document of their own, with a `TEST_RESULT` for each case and a relation to each requirement that it
//! verifies, whatever the verdict is.

use crate::error::ExportError;
use crate::sdoc::legal_uid;
use octant_verdict::requirement::Requirements;
use octant_verdict::trace::{CampaignTrace, TraceLink, TraceRow};
use octant_verdict::verdict::Verdict;
use std::collections::HashMap;
use std::fmt::Write as _;

/// Role of the relation from a result to its requirement.
pub const VERIFIES: &str = "Verifies";

/// Cases of a trace with their requirements, in the order in which requirements name them.
fn cases(trace: &CampaignTrace) -> Vec<(&str, Vec<(&TraceRow, &TraceLink)>)> {
    let mut cases: Vec<(&str, Vec<(&TraceRow, &TraceLink)>)> = Vec::new();
    let mut index: HashMap<&str, usize> = HashMap::new();
    for row in &trace.requirements {
        for link in &row.cases {
            let at = *index.entry(&link.case).or_insert(cases.len());
            if at == cases.len() {
                cases.push((&link.case, Vec::new()));
            }
            cases[at].1.push((row, link));
        }
    }
    cases
}

fn word(verdict: Option<Verdict>) -> &'static str {
    verdict.map_or("not run", Verdict::name)
}

/// Verdict of a case; `None` if none of its checks ran. A missing check makes it at least inconclusive.
fn worst(links: &[(&TraceRow, &TraceLink)]) -> Option<Verdict> {
    let missing = links.iter().any(|(_, link)| link.verdict.is_none());
    let worst = links.iter().filter_map(|(_, link)| link.verdict).max()?;
    Some(if missing { worst.max(Verdict::Inconclusive) } else { worst })
}

/// Writes the results of a campaign as an `.sdoc`, to be exported together with that of the
/// requirements.
///
/// # Errors
/// If StrictDoc doesn't accept the id of a case.
pub fn results(
    trace: &CampaignTrace,
    requirements: &Requirements,
    title: &str,
) -> Result<String, ExportError> {
    // Ids of requirements can have characters that are markup elsewhere.
    let mut out =
        format!("[DOCUMENT]\nTITLE: {title}\nOPTIONS:\n  MARKUP: Text\n\n[GRAMMAR]\nELEMENTS:\n");
    out.push_str("- TAG: TEXT\n  FIELDS:\n  - TITLE: UID\n    TYPE: String\n    REQUIRED: False\n");
    out.push_str("  - TITLE: STATEMENT\n    TYPE: String\n    REQUIRED: True\n- TAG: TEST_RESULT\n  FIELDS:\n");
    for (field, required) in [
        ("UID", "True"),
        ("STATUS", "True"),
        ("RECORDING", "False"),
        ("FOLDER", "False"),
        ("STATEMENT", "True"),
    ] {
        _ = writeln!(out, "  - TITLE: {field}\n    TYPE: String\n    REQUIRED: {required}");
    }
    _ = writeln!(out, "  RELATIONS:\n  - TYPE: Parent\n  - TYPE: Parent\n    ROLE: {VERIFIES}");
    for (case, links) in cases(trace) {
        if !legal_uid(case) || requirements.get(case).is_some() {
            let message =
                "its id is none that StrictDoc takes, or that of a requirement".to_owned();
            return Err(ExportError { format: "sdoc", id: case.to_owned(), message });
        }
        let worst = worst(&links);
        _ = write!(out, "\n[TEST_RESULT]\nUID: {case}\nSTATUS: {}\n", word(worst));
        let first = links.first().map(|(_, link)| *link);
        if let Some(recording) = first.and_then(|link| link.recording.as_deref()) {
            _ = writeln!(out, "RECORDING: {}", recording.replace('\n', " "));
        }
        if let Some(folder) = first.and_then(|link| link.folder.as_deref()) {
            _ = writeln!(out, "FOLDER: {}", folder.replace('\n', " "));
        }
        out.push_str("STATEMENT: >>>\n");
        for (row, link) in &links {
            _ = writeln!(out, "- {}: {}", row.id, word(link.verdict));
        }
        out.push_str("<<<\nRELATIONS:\n");
        for (row, _) in &links {
            _ = writeln!(out, "- TYPE: Parent\n  VALUE: {}\n  ROLE: {VERIFIES}", row.id);
        }
    }
    Ok(out)
}

/// Name of the test report, by which StrictDoc recognizes its flavour.
const REPORT: &str = "campaign.lit.junit.xml";

/// Files that StrictDoc needs to show a campaign, as paths and texts: its project, the requirements,
/// the results, one file for each case that names its requirements, and a test report.
///
/// The report is JUnit XML in the flavour of LLVM's lit, in which tests are files: so StrictDoc links
/// the requirement through the case's file to its result. StrictDoc refuses reports with errors in
/// them: inconclusive cases and errors are failures in it, with that type. `results.sdoc` has the
/// verdict by its name.
///
/// # Errors
/// If StrictDoc can't hold a part of a requirement or case.
pub fn folder(
    requirements: &Requirements,
    trace: &CampaignTrace,
    title: &str,
) -> Result<Vec<(String, String)>, ExportError> {
    let mut files = vec![
        ("strictdoc_config.py".to_owned(), config(title)),
        ("requirements.sdoc".to_owned(), crate::sdoc::write(requirements)?),
        ("results.sdoc".to_owned(), results(trace, requirements, &format!("{title}: results"))?),
    ];
    let cases = cases(trace);
    for (case, links) in &cases {
        // Each case has a path of its own, and none leads out of the folder.
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
        if case.starts_with('.') || !case.chars().all(plain) {
            let message = "its id is no name of a file: letters, digits, -, _ and .".to_owned();
            return Err(ExportError { format: "StrictDoc", id: (*case).to_owned(), message });
        }
        let ids: Vec<&str> = links.iter().map(|(row, _)| row.id.as_str()).collect();
        let text = format!("# @relation({}, scope=file)\ncase = \"{case}\"\n", ids.join(", "));
        files.push((format!("cases/{case}.toml"), text));
    }
    let report = report(title, &cases).map_err(|error| ExportError {
        format: "JUnit XML",
        id: title.to_owned(),
        message: error.to_string(),
    })?;
    files.push((REPORT.to_owned(), report));
    Ok(files)
}

/// Configuration of the project.
fn config(title: &str) -> String {
    let title = serde_json::Value::from(title).to_string();
    format!(
        "from strictdoc.core.project_config import ProjectConfig\n\n\n\
         def create_config() -> ProjectConfig:\n    return ProjectConfig(\n        \
         project_title={title},\n        project_features=[\n            \
         \"REQUIREMENT_TO_SOURCE_TRACEABILITY\",\n            \"TABLE_SCREEN\",\n            \
         \"TRACEABILITY_SCREEN\",\n            \"DEEP_TRACEABILITY_SCREEN\",\n        ],\n        \
         include_source_paths=[\"cases/**\"],\n        \
         test_report_root_dict={{\"{REPORT}\": \"\"}},\n    )\n"
    )
}

/// Test report. A case that hasn't run is skipped.
fn report(title: &str, cases: &[(&str, Vec<(&TraceRow, &TraceLink)>)]) -> std::io::Result<String> {
    use quick_xml::events::{BytesDecl, Event};
    let bad = |verdict: Option<Verdict>| verdict.is_some_and(|v| v != Verdict::Pass);
    let failures = cases.iter().filter(|(_, links)| bad(worst(links))).count().to_string();
    let skipped = cases.iter().filter(|(_, links)| worst(links).is_none()).count().to_string();
    let tests = cases.len().to_string();
    let mut out = quick_xml::Writer::new_with_indent(Vec::new(), b' ', 1);
    out.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let counts = [
        ("tests", tests.as_str()),
        ("failures", &failures),
        ("skipped", &skipped),
        ("errors", "0"),
    ];
    out.create_element("testsuites").with_attribute(("name", "octant")).write_inner_content(
        |out| {
            let suite = out.create_element("testsuite").with_attribute(("name", title));
            suite.with_attributes(counts).write_inner_content(|out| {
                for (case, links) in cases {
                    let name = format!("{case}.toml");
                    let element = out.create_element("testcase").with_attributes([
                        ("classname", "octant.cases"),
                        ("name", name.as_str()),
                        ("time", "0"),
                    ]);
                    element.write_inner_content(|out| {
                        let ids: Vec<&str> = links.iter().map(|(row, _)| row.id.as_str()).collect();
                        out.create_element("properties").write_inner_content(|out| {
                            let property = [("name", "verifies"), ("value", &ids.join(", "))];
                            out.create_element("property")
                                .with_attributes(property)
                                .write_empty()?;
                            Ok(())
                        })?;
                        let verdict = worst(links);
                        if let Some(verdict) = verdict.filter(|_| bad(verdict)) {
                            let of = |(row, link): &(&TraceRow, &TraceLink)| {
                                format!("{}: {}", row.id, word(link.verdict))
                            };
                            let message: Vec<String> = links.iter().map(of).collect();
                            let message = message.join("; ");
                            let attributes = [("type", verdict.name()), ("message", &message)];
                            out.create_element("failure")
                                .with_attributes(attributes)
                                .write_empty()?;
                        } else if verdict.is_none() {
                            out.create_element("skipped").write_empty()?;
                        }
                        Ok(())
                    })?;
                }
                Ok(())
            })?;
            Ok(())
        },
    )?;
    String::from_utf8(out.into_inner()).map_err(std::io::Error::other)
}
