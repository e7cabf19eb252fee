//! Collection of findings.

use super::rules::{Rule, Severity};
use octant_fmu_host::description::Standard;
use serde::Serialize;
use serde::ser::{SerializeStruct, Serializer};
use std::collections::BTreeMap;

/// Number of findings of a rule that are kept; the others are counted. A generator makes a mistake
/// for every variable.
const KEPT: usize = 25;

/// A violation of a rule.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Rule that is broken.
    pub rule: &'static Rule,
    /// File inside the FMU; empty: the FMU itself.
    pub entry: String,
    /// Line, if the finding is about one.
    pub line: Option<u32>,
    /// Variable, unit, element, … of the finding; empty if there is none.
    pub subject: String,
    /// Text or value found.
    pub found: String,
    /// Text or value expected.
    pub expected: String,
    /// Clause of the standard: `FMI 2.0, 2.2.7`.
    pub clause: String,
}

impl Serialize for Finding {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut state = serializer.serialize_struct("Finding", 8)?;
        state.serialize_field("severity", &self.rule.severity)?;
        state.serialize_field("rule", self.rule.id)?;
        state.serialize_field("entry", &self.entry)?;
        state.serialize_field("line", &self.line)?;
        state.serialize_field("subject", &self.subject)?;
        state.serialize_field("found", &self.found)?;
        state.serialize_field("expected", &self.expected)?;
        state.serialize_field("clause", &self.clause)?;
        state.end()
    }
}

/// Place of a finding.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place<'a> {
    pub(super) entry: &'a str,
    pub(super) line: Option<u32>,
    pub(super) subject: &'a str,
}

/// Findings so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Findings {
    kept: Vec<Finding>,
    counts: BTreeMap<&'static str, usize>,
    standard: Option<Standard>,
}

impl Findings {
    /// Sets the standard of the FMU, for all findings.
    pub(super) fn of(&mut self, standard: Standard) {
        self.standard = Some(standard);
    }

    /// Adds a violation of a rule.
    pub(super) fn add(
        &mut self,
        rule: &'static Rule,
        place: Place<'_>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) {
        let count = self.counts.entry(rule.id).or_default();
        *count += 1;
        if *count > KEPT {
            return;
        }
        self.kept.push(Finding {
            rule,
            entry: place.entry.to_owned(),
            line: place.line,
            subject: place.subject.to_owned(),
            found: found.into(),
            expected: expected.into(),
            // The standard may not be known yet.
            clause: String::new(),
        });
    }

    /// Returns all findings: worst first, each severity in the order of the file; and the number of
    /// findings of each rule that weren't kept.
    pub(super) fn finish(mut self) -> (Vec<Finding>, BTreeMap<&'static str, usize>) {
        for finding in &mut self.kept {
            finding.clause = clause(finding.rule, self.standard, &finding.subject);
        }
        self.kept.sort_by_key(|finding| std::cmp::Reverse(finding.rule.severity));
        let more = self
            .counts
            .into_iter()
            .filter(|&(_, count)| count > KEPT)
            .map(|(rule, count)| (rule, count - KEPT))
            .collect();
        (self.kept, more)
    }

    /// Returns whether there is an error among the findings.
    pub(super) fn has_errors(&self) -> bool {
        self.kept.iter().any(|finding| finding.rule.severity == Severity::Error)
    }
}

/// Clause of a rule in a standard, or in both while it isn't known which the FMU follows. `subject` is
/// that of the finding.
fn clause(rule: &Rule, standard: Option<Standard>, subject: &str) -> String {
    let of = |name: &str, section: &'static str| match section {
        "Octant" | "" => "Octant".into(),
        // A separate standard.
        _ if section.starts_with("FMI-LS-") => section.into(),
        _ => format!("{name}, {}", of_interface(section, subject)),
    };
    match standard {
        // Parts of FMI 3.0 that FMUs of FMI 2.0 have as well.
        Some(Standard::Fmi2) if !rule.fmi2.is_empty() => of("FMI 2.0", rule.fmi2),
        Some(_) => of("FMI 3.0", rule.fmi3),
        None if rule.fmi2 == "Octant" || rule.fmi2.is_empty() => of("FMI 3.0", rule.fmi3),
        None => format!("{}; {}", of("FMI 2.0", rule.fmi2), of("FMI 3.0", rule.fmi3)),
    }
}

/// Section about the interface that is the subject, where each interface has its own.
fn of_interface<'s>(section: &'s str, subject: &str) -> &'s str {
    const EACH: &str = "3.3.1, 4.3.1";
    match (section, subject) {
        (EACH, "ModelExchange") => "3.3.1",
        (EACH, "CoSimulation") => "4.3.1",
        _ => section,
    }
}
