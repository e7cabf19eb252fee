//! Selection of cases of a plan: by pattern, and by their results.

use super::case;
use crate::journal::JournalEvent;
use crate::plan::factor_values::FactorValue;
use crate::plan::{Case, Plan};
use crate::store::CampaignResults;
use octant_verdict::Verdict;
use std::collections::BTreeSet;
use std::path::Path;

/// Cases that an execution may run, and those that it runs although they have a result.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CaseSelection {
    /// Places in the plan; `None`: all.
    picked: Option<BTreeSet<usize>>,
    /// Places of cases that are run a second time. The stored result stays, and the new one has to
    /// be the same.
    repeated: BTreeSet<usize>,
    /// Patterns of the cases that are picked.
    patterns: Vec<String>,
}

/// Error of a pattern that no case matches.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "found no case that matches {}, expected patterns of its id, its scenario or FACTOR=VALUE, such \
     as {}",
    .patterns.iter().map(|pattern| format!("{pattern:?}")).collect::<Vec<_>>().join(" and "),
    .examples.join(", ")
)]
pub struct NoSuchCase {
    /// The patterns.
    pub patterns: Vec<String>,
    /// Names that the first case of the plan has.
    pub examples: Vec<String>,
}

impl CaseSelection {
    /// Selects the cases that match every one of some patterns; all cases without a pattern.
    ///
    /// A pattern matches a case if it matches its id, the name of its scenario, or `FACTOR=VALUE` of
    /// one of its factors, from the first to the last character. `*` stands for any characters, `?`
    /// for one.
    ///
    /// # Errors
    /// If no case matches.
    pub fn of(plan: &Plan, patterns: &[String]) -> Result<Self, NoSuchCase> {
        if patterns.is_empty() {
            return Ok(Self::default());
        }
        let matching = |case: &Case| {
            let names = names(case);
            patterns.iter().all(|pattern| names.iter().any(|name| matches(pattern, name)))
        };
        let cases = plan.cases.iter().enumerate();
        let picked: BTreeSet<usize> =
            cases.filter(|(_, case)| matching(case)).map(|(index, _)| index).collect();
        if picked.is_empty() {
            return Err(NoSuchCase {
                patterns: patterns.to_vec(),
                examples: plan.cases.first().map(names).unwrap_or_default(),
            });
        }
        Ok(Self { picked: Some(picked), repeated: BTreeSet::new(), patterns: patterns.to_vec() })
    }

    /// Adds a repetition of the selected cases whose stored result has failed. Cases that ended as
    /// errors without a summary aren't among them: their results are forgotten and made again.
    ///
    /// # Errors
    /// If an existing result can't be read.
    pub fn repeating_failed(self, plan: &Plan, folder: &Path) -> Result<Self, case::ResultError> {
        let mut repeated = BTreeSet::new();
        let results = CampaignResults::open(folder)?;
        for (index, case) in plan.cases.iter().enumerate() {
            if self.picks(index)
                && let Some(facts) = results.facts(plan, case)?
                && facts.verdict > Verdict::Inconclusive
                && facts.error.is_none()
            {
                repeated.insert(index);
            }
        }
        Ok(Self { repeated, ..self })
    }

    /// Returns whether a case, given by its place in the plan, may be run.
    #[must_use]
    pub fn picks(&self, index: usize) -> bool {
        self.picked.as_ref().is_none_or(|picked| picked.contains(&index))
    }

    /// Returns whether a case is run although it has a result.
    #[must_use]
    pub fn repeats(&self, index: usize) -> bool {
        self.repeated.contains(&index)
    }

    /// Returns whether any case is left out.
    #[must_use]
    pub fn is_restricted(&self) -> bool {
        self.picked.is_some()
    }

    /// Returns whether any case is run a second time.
    #[must_use]
    pub fn has_repeated(&self) -> bool {
        !self.repeated.is_empty()
    }

    /// Returns what a journal says of it, if it leaves cases out of a plan of `of` cases.
    #[must_use]
    pub fn in_journal(&self, of: usize) -> Option<JournalEvent> {
        let cases = self.picked.as_ref()?.len();
        Some(JournalEvent::Restricted { only: self.patterns.clone(), cases, of })
    }

    /// Returns the places of the cases that are run although they have a result.
    pub(super) fn repeated(&self) -> impl Iterator<Item = usize> {
        self.repeated.iter().copied()
    }

    /// Ends the repetitions: they were run.
    pub fn repetitions_done(&mut self) {
        self.repeated.clear();
    }
}

/// Names by which a case can be selected.
fn names(case: &Case) -> Vec<String> {
    let factor = |(name, value): (&str, &FactorValue)| match value {
        FactorValue::Number(number) => format!("{name}={number}"),
        FactorValue::Text(text) => format!("{name}={text}"),
    };
    let own = [case.id.to_string(), case.scenario.to_string()];
    own.into_iter().chain(case.factors.iter().map(factor)).collect()
}

/// Matches a whole text with a pattern of `*`, `?` and other characters, which stand for themselves.
fn matches(pattern: &str, text: &str) -> bool {
    let (pattern, text): (Vec<char>, Vec<char>) =
        (pattern.chars().collect(), text.chars().collect());
    let (mut at, mut in_text) = (0, 0);
    // Last `*`, and the character of the text up to which it reaches.
    let mut star: Option<(usize, usize)> = None;
    while in_text < text.len() {
        match pattern.get(at) {
            Some('*') => {
                star = Some((at, in_text));
                at += 1;
            }
            Some(c) if *c == '?' || *c == text[in_text] => {
                at += 1;
                in_text += 1;
            }
            _ => {
                // The last `*` takes one character more.
                let Some((star_at, reached)) = star else { return false };
                star = Some((star_at, reached + 1));
                at = star_at + 1;
                in_text = reached + 1;
            }
        }
    }
    pattern[at..].iter().all(|c| *c == '*')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pattern_matches_whole_names() {
        for (pattern, text, expected) in [
            ("static", "static", true),
            ("static", "static-2", false),
            ("static*", "static-2", true),
            ("*2", "static-2", true),
            ("*a*i*", "static", true),
            ("*a*x*", "static", false),
            ("s?atic", "static", true),
            ("s?tatic", "static", false),
            ("*", "", true),
            ("", "", true),
            ("", "a", false),
            ("latitude=?0 deg", "latitude=60 deg", true),
            ("a*b*c", "aXbXbXc", true),
            ("é?", "éü", true),
        ] {
            assert_eq!(matches(pattern, text), expected, "{pattern} {text}");
        }
    }
}
