//! Compares the outcome of a case with the expected one.
//!
//! A case that must not pass and passes is worse than any other deviation, because then the
//! verdicts of this program can't be trusted. It is an alarm.

use octant_base::number::significant;
use octant_verdict::Verdict;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Number that is known from another source.
#[derive(Clone, Debug, PartialEq)]
pub struct Known {
    /// Name in the outcome.
    pub name: String,
    /// The number.
    pub value: f64,
    /// Largest allowed deviation.
    pub tolerance: f64,
}

/// Expected outcome of a case.
#[derive(Clone, Debug, PartialEq)]
pub enum Expectation {
    /// Numbers from a source outside of this program's own arithmetic.
    Numbers {
        /// The numbers.
        known: Vec<Known>,
        /// Source of the numbers.
        source: &'static str,
    },
    /// A text, such as a hash.
    Text {
        /// The text.
        known: &'static str,
        /// Source of the text.
        source: &'static str,
    },
    /// A pass: exit status 0 and the verdict pass.
    Pass,
    /// Anything but a pass.
    NotPass {
        /// The exit status.
        status: i32,
        /// Words that the program's output must contain.
        because: &'static str,
    },
    /// The same bytes every time.
    Same,
}

/// Result of a case.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CaseOutcome {
    /// Exit status of the program; `None` if there is none, because it crashed or was ended.
    pub status: Option<i32>,
    /// Verdict that it wrote; `None` if it wrote none.
    pub verdict: Option<Verdict>,
    /// Output.
    pub said: String,
    /// Numbers by name.
    pub numbers: BTreeMap<String, f64>,
    /// Requested text.
    pub text: String,
    /// Bytes that must be the same, by the way in which they were made.
    pub made: Vec<(String, Vec<u8>)>,
}

/// Verdict on a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CaseVerdict {
    /// The outcome was as expected.
    Pass,
    /// The outcome was different.
    Fail,
    /// The case could not be run.
    Error,
    /// A case that must not pass has passed.
    Alarm,
}

impl CaseVerdict {
    /// Returns the name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Fail => "fail",
            Self::Error => "error",
            Self::Alarm => "alarm",
        }
    }
}

impl Expectation {
    /// Returns the kind of the case.
    #[must_use]
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Numbers { .. } | Self::Text { .. } => "golden",
            Self::Pass => "must pass",
            Self::NotPass { .. } => "must not pass",
            Self::Same => "same bytes",
        }
    }

    /// Describes the expectation as text.
    #[must_use]
    pub fn in_words(&self) -> String {
        match self {
            Self::Numbers { known, .. } => match known.as_slice() {
                all if all.len() > 6 => format!("{} numbers within their tolerances", all.len()),
                all => all.iter().map(Known::in_words).collect::<Vec<_>>().join(", "),
            },
            Self::Text { known, .. } => (*known).to_owned(),
            Self::Pass => "a pass, exit status 0".to_owned(),
            Self::NotPass { status, because } => {
                format!("exit status {status}, because of {because:?}")
            }
            Self::Same => "the same bytes every time".to_owned(),
        }
    }

    /// Returns the source of the expectation, for numbers or a text.
    #[must_use]
    pub const fn source(&self) -> Option<&'static str> {
        match self {
            Self::Numbers { source, .. } | Self::Text { source, .. } => Some(source),
            _ => None,
        }
    }
}

impl Known {
    fn in_words(&self) -> String {
        let Self { name, value, tolerance } = self;
        format!("{name} {} ± {}", significant(*value, 6), significant(*tolerance, 2))
    }
}

/// Judges an outcome, and describes the result.
#[must_use]
pub fn judge(expectation: &Expectation, outcome: &CaseOutcome) -> (CaseVerdict, String) {
    let ended = match outcome.status {
        Some(status) => format!("exit status {status}"),
        None => "no exit status: it crashed or took too long".to_owned(),
    };
    let first = outcome.said.lines().find(|line| !line.trim().is_empty()).unwrap_or("").trim();
    let said = if first.is_empty() { ended.clone() } else { format!("{ended}: {first}") };
    match expectation {
        Expectation::NotPass { status, because } => {
            // A user would take either of them for a pass.
            if outcome.status == Some(0) || outcome.verdict == Some(Verdict::Pass) {
                let words = format!("it PASSED and must not ({ended})");
                return (CaseVerdict::Alarm, words);
            }
            let right = outcome.status == Some(*status) && outcome.said.contains(because);
            let line = outcome.said.lines().find(|line| line.contains(because));
            match line {
                Some(line) if right => (CaseVerdict::Pass, format!("{ended}: {}", line.trim())),
                _ => (CaseVerdict::Fail, said),
            }
        }
        Expectation::Pass => {
            let kept = outcome.status == Some(0)
                && outcome.verdict.is_none_or(|verdict| verdict == Verdict::Pass);
            (if kept { CaseVerdict::Pass } else { CaseVerdict::Fail }, said)
        }
        Expectation::Numbers { known, .. } => numbers(known, outcome, &said),
        Expectation::Text { known, .. } => {
            if outcome.text.is_empty() {
                return (CaseVerdict::Fail, said);
            }
            let same = outcome.text == *known;
            (if same { CaseVerdict::Pass } else { CaseVerdict::Fail }, outcome.text.clone())
        }
        Expectation::Same => same(outcome, &said),
    }
}

fn numbers(known: &[Known], outcome: &CaseOutcome, said: &str) -> (CaseVerdict, String) {
    let mut worst: Option<(f64, String)> = None;
    let mut words = Vec::new();
    for number in known {
        let Some(found) = outcome.numbers.get(&number.name) else {
            return (CaseVerdict::Fail, format!("{} wasn't found; {said}", number.name));
        };
        let part = (found - number.value).abs() / number.tolerance;
        let told = format!("{} {}", number.name, significant(*found, 6));
        // NaN is beyond every tolerance.
        let part = if part.is_nan() { f64::INFINITY } else { part };
        if worst.as_ref().is_none_or(|(least, _)| part > *least) {
            let words = format!("{told} where {} is known", number.in_words());
            worst = Some((part, words));
        }
        words.push(told);
    }
    let Some((part, farthest)) = worst else {
        return (CaseVerdict::Fail, "no number is known, so that nothing is shown".to_owned());
    };
    let mut text = if words.len() > 6 { String::new() } else { words.join(", ") };
    if part > 1.0 {
        return (CaseVerdict::Fail, farthest);
    }
    if text.is_empty() {
        _ = write!(text, "at most {} % of a tolerance: {farthest}", significant(100.0 * part, 2));
    }
    (CaseVerdict::Pass, text)
}

fn same(outcome: &CaseOutcome, said: &str) -> (CaseVerdict, String) {
    let [first, others @ ..] = outcome.made.as_slice() else {
        return (CaseVerdict::Fail, format!("nothing was made; {said}"));
    };
    if others.is_empty() || first.1.is_empty() {
        return (CaseVerdict::Fail, format!("there is nothing to compare; {said}"));
    }
    let hash = |bytes: &[u8]| blake3::hash(bytes).to_hex()[..16].to_owned();
    match others.iter().find(|(_, bytes)| *bytes != first.1) {
        Some((how, bytes)) => {
            let words = format!("{}: BLAKE3 {}…, {how}: {}…", first.0, hash(&first.1), hash(bytes));
            (CaseVerdict::Fail, words)
        }
        None => {
            let ways: Vec<&str> = outcome.made.iter().map(|(how, _)| how.as_str()).collect();
            (CaseVerdict::Pass, format!("BLAKE3 {}… {}", hash(&first.1), ways.join(", ")))
        }
    }
}
