//! The trace as StrictDoc shows it: results as a document beside that of the requirements.
//!
//! StrictDoc reads test reports in JUnit XML, but links a result to a requirement only through the
//! source file of the test, and refuses a report with an error in it. Results are therefore written as
//! a document of its own, a `TEST_RESULT` for each case with a relation to each requirement that it
//! verifies: whatever the verdict is.

use crate::error::ExportError;
use crate::requirement::Requirements;
use crate::sdoc::legal_uid;
use crate::trace::{Trace, Verdict};
use std::fmt::Write as _;

/// Role of the relation from a result to its requirement.
pub const VERIFIES: &str = "Verifies";

/// Writes the results of a campaign as an `.sdoc`, to be exported together with that of the
/// requirements.
///
/// # Errors
/// If a case has an id that StrictDoc doesn't take.
pub fn results(trace: &Trace, requirements: &Requirements, title: &str) -> Result<String, ExportError> {
    let mut out = format!("[DOCUMENT]\nTITLE: {title}\n\n[GRAMMAR]\nELEMENTS:\n");
    out.push_str("- TAG: TEXT\n  FIELDS:\n  - TITLE: UID\n    TYPE: String\n    REQUIRED: False\n");
    out.push_str("  - TITLE: STATEMENT\n    TYPE: String\n    REQUIRED: True\n- TAG: TEST_RESULT\n  FIELDS:\n");
    for (field, required) in
        [("UID", "True"), ("STATUS", "True"), ("RECORDING", "False"), ("FOLDER", "False"), ("STATEMENT", "True")]
    {
        _ = writeln!(out, "  - TITLE: {field}\n    TYPE: String\n    REQUIRED: {required}");
    }
    _ = writeln!(out, "  RELATIONS:\n  - TYPE: Parent\n  - TYPE: Parent\n    ROLE: {VERIFIES}");
    let mut cases: Vec<&str> = Vec::new();
    let mut seen = std::collections::HashSet::new();
    for link in trace.requirements.iter().flat_map(|row| &row.cases) {
        if seen.insert(link.case.as_str()) {
            cases.push(&link.case);
        }
    }
    for case in cases {
        if !legal_uid(case) || requirements.get(case).is_some() {
            let message = "its id is none that StrictDoc takes, or that of a requirement".to_owned();
            return Err(ExportError { format: "sdoc", id: case.to_owned(), message });
        }
        let links: Vec<_> = trace
            .requirements
            .iter()
            .filter_map(|row| Some((row, row.cases.iter().find(|link| link.case == case)?)))
            .collect();
        let word = |verdict: Option<Verdict>| verdict.map_or("not run", Verdict::name);
        let missing = links.iter().any(|(_, link)| link.verdict.is_none());
        let worst = links.iter().filter_map(|(_, link)| link.verdict).max();
        // A check that is missing leaves nothing shown.
        let worst = match worst {
            Some(verdict) if missing => Some(verdict.max(Verdict::Inconclusive)),
            other => other,
        };
        _ = write!(out, "\n[TEST_RESULT]\nUID: {case}\nSTATUS: {}\n", word(worst));
        let first = links.first().map(|(_, link)| *link);
        if let Some(recording) = first.and_then(|link| link.recording.as_deref()) {
            _ = writeln!(out, "RECORDING: {recording}");
        }
        if let Some(folder) = first.and_then(|link| link.folder.as_deref()) {
            _ = writeln!(out, "FOLDER: {folder}");
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
