//! Findings as text.

use super::Report;
use super::finding::Finding;
use super::rules::{RULES, Severity};
use std::fmt::Write;

/// Formats a report for users: the FMU, the findings, and their numbers.
#[must_use]
pub fn text(report: &Report) -> String {
    let mut text = String::new();
    head(report, &mut text);
    for finding in &report.findings {
        one(finding, &mut text);
    }
    for rule in RULES {
        if let Some(more) = report.more.get(rule.id) {
            let _ = writeln!(text, "  {:7} {}: {more} more", rule.severity.name(), rule.id);
        }
    }
    let count = |severity: Severity| {
        let count = report.count(severity);
        let plural = if count == 1 { "" } else { "s" };
        format!("{count} {}{plural}", severity.name())
    };
    let [errors, warnings, notes] = [Severity::Error, Severity::Warning, Severity::Note].map(count);
    let _ = writeln!(text, "  {errors}, {warnings}, {notes}");
    text
}

fn head(report: &Report, text: &mut String) {
    let _ = write!(text, "{}", report.file);
    if let Some(version) = &report.fmi_version {
        let name = report.model_name.as_deref().unwrap_or_default();
        let _ = write!(text, ": FMI {version}, {name:?}, {} variables", report.variables);
    }
    text.push('\n');
    for binary in &report.binaries {
        let _ = write!(text, "  {}", binary.entry);
        if !binary.format.is_empty() {
            let _ = write!(text, ": {} {}", binary.format, binary.architecture);
            let _ = write!(text, ", {} functions", binary.functions);
            if let Some(glibc) = &binary.glibc {
                let _ = write!(text, ", glibc {glibc}");
            }
            if !binary.libraries.is_empty() {
                let _ = write!(text, ", needs {}", binary.libraries.join(" "));
            }
        }
        text.push('\n');
    }
}

fn one(finding: &Finding, text: &mut String) {
    let mut place = finding.entry.clone();
    if let Some(line) = finding.line {
        let _ = write!(place, ":{line}");
    }
    if !finding.subject.is_empty() {
        let _ = write!(place, " {}", finding.subject);
    }
    if !place.is_empty() {
        place.push_str(": ");
    }
    let _ = writeln!(
        text,
        "  {:7} {}{}, expected {} [{}; {}]",
        finding.rule.severity.name(),
        place.trim_start(),
        finding.found,
        finding.expected,
        finding.rule.id,
        finding.clause
    );
}
