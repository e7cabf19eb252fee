//! Renders a night: `nightly.json`, and `nightly.md` for readers and for the summary of a CI job.

use super::compare::{Change, NightComparison, Tested, TurnedCase};
use super::night::{CampaignNight, Night, Program};
use super::suite::SuiteResult;
use octant_base::number::{counted, plain, significant};
use octant_base::printable::printable;
use octant_verdict::Verdict;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Maximum number of rows of a table in `nightly.md`; the rest is in `nightly.json`.
const TOLD: usize = 20;

/// Content of `nightly.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NightReport {
    /// Version of this form: [`super::compare::SCHEMA`].
    pub schema: u32,
    /// The night.
    pub night: String,
    /// Time of its beginning.
    pub started: String,
    /// Time at which everything had run.
    pub ended: Option<String>,
    /// Overall verdict.
    pub verdict: Verdict,
    /// Reason, in plain words.
    pub reasons: Vec<String>,
    /// The program.
    pub program: Program,
    /// The program of the baseline; null without one.
    pub baseline_program: Option<Program>,
    /// Folder of the night, relative to the history.
    pub folder: String,
    /// Campaigns, each with its own verdict.
    pub campaigns: Vec<CampaignNight>,
    /// Cases of the suite with another end than expected.
    pub suite_broken: Vec<SuiteResult>,
    /// Number of cases of the suite.
    pub suite_cases: usize,
    /// Comparison with the baseline; null without one.
    pub comparison: Option<NightComparison>,
}

impl NightReport {
    /// Judges a night. `is_first` tells that it is known to have no baseline.
    #[must_use]
    pub fn new(
        night: &Night,
        baseline: Option<&Night>,
        comparison: Option<NightComparison>,
        is_first: bool,
    ) -> Self {
        let mut report = Self {
            schema: super::compare::SCHEMA,
            night: night.id.clone(),
            started: night.started.clone(),
            ended: night.ended.clone(),
            verdict: Verdict::Pass,
            reasons: Vec::new(),
            program: night.program.clone(),
            baseline_program: baseline.map(|night| night.program.clone()),
            folder: format!("nights/{}", night.id),
            campaigns: night.campaigns.clone(),
            suite_broken: (night.suite.iter().filter(|r| r.problem.is_some()).cloned()).collect(),
            suite_cases: night.suite.len(),
            comparison: None,
        };
        report.judge(comparison.as_ref(), is_first);
        report.comparison = comparison;
        report
    }

    fn because(&mut self, verdict: Verdict, reason: String) {
        self.verdict = self.verdict.worst(verdict);
        self.reasons.push(reason);
    }

    fn judge(&mut self, comparison: Option<&NightComparison>, is_first: bool) {
        let differing: Vec<String> = (self.campaigns.iter())
            .flat_map(|c| c.differing.iter().map(move |case| format!("{}: case {case}", c.name)))
            .collect();
        for case in differing {
            self.because(Verdict::Error, format!("{case} came to two results in one night"));
        }
        let Some(comparison) = comparison else {
            return self.judge_alone(is_first);
        };
        if !comparison.flaky.is_empty() {
            let reason = format!(
                "{} of the same cases came to another result with the same program: it isn't \
                 deterministic",
                comparison.flaky.len()
            );
            self.because(Verdict::Error, reason);
        }
        if !comparison.missing.is_empty() {
            let reason = format!("not in this night: {}", comparison.missing.join(", "));
            self.because(Verdict::Inconclusive, reason);
        }
        for pairing in &comparison.pairings {
            if pairing.pairs == 0 && pairing.baseline_cases > 0 {
                let reason = format!(
                    "{}: no case is in both nights, so that nothing can be told",
                    pairing.campaign
                );
                self.because(Verdict::Inconclusive, reason);
            }
        }
        if let Some(words) = &comparison.numerics_changed {
            // The verdict of this night alone stands. Differences from the baseline come from the
            // program, or can't be separated from its effect.
            self.judge_itself();
            let reason = format!(
                "{words}; what differs from the baseline is no regression of the unit and no \
                 non-determinism. Look at this night by itself, and accept it as the baseline: octant \
                 nightly accept {} --history DIR",
                self.night
            );
            return self.because(Verdict::Inconclusive, reason);
        }
        for words in &comparison.requirements_worse {
            self.because(Verdict::Fail, words.clone());
        }
        let failing = &comparison.newly_failing;
        if !failing.is_empty() {
            // A case that newly ends as an error points to the bench or the program, which is worse
            // than a fail.
            let errors = |t: &&TurnedCase| t.now.is_none() || t.now == Some(Verdict::Error);
            let count = failing.iter().filter(errors).count();
            let verdict = if count > 0 { Verdict::Error } else { Verdict::Fail };
            let errors = match count {
                0 => String::new(),
                count => {
                    format!(", {} as {}", count, if count == 1 { "an error" } else { "errors" })
                }
            };
            self.because(
                verdict,
                format!("{} newly worse{errors}", counted(failing.len(), "case", "cases")),
            );
        }
        let mut worse: BTreeMap<(&str, &str), Vec<&Tested>> = BTreeMap::new();
        for test in comparison.found(Change::Worse) {
            worse.entry((&test.campaign, &test.scenario)).or_default().push(test);
        }
        for ((campaign, scenario), tests) in worse {
            self.because(Verdict::Fail, in_words(campaign, scenario, &tests));
        }
        for (place, pairs) in blind(comparison) {
            let reason = format!(
                "{place}: something changed, and {pairs} pairs are too few for any of {} tests to find it",
                comparison.tests.len()
            );
            self.because(Verdict::Inconclusive, reason);
        }
        if self.verdict == Verdict::Pass {
            self.reasons.push("no regression found".to_owned());
        }
        self.reasons.extend(power_in_words(comparison));
    }

    /// Judges a night without a baseline, by its own results.
    fn judge_alone(&mut self, is_first: bool) {
        self.judge_itself();
        if is_first {
            self.reasons.push("the first night: nothing to compare with".to_owned());
        } else {
            let reason = "there is no baseline to compare with: it was lost, or none was accepted yet \
                          (--first starts one)";
            self.because(Verdict::Inconclusive, reason.to_owned());
        }
    }

    /// Judges the results of a night by themselves.
    fn judge_itself(&mut self) {
        let broken = self.suite_broken.len();
        if broken > 0 {
            let reason = format!("{broken} cases of the suite don't end as they have to");
            self.because(Verdict::Fail, reason);
        }
        for campaign in self.campaigns.clone() {
            if campaign.verdict == Some(Verdict::Error) {
                let reason = format!("campaign {}: error", campaign.name);
                self.because(Verdict::Error, reason);
            }
        }
    }

    /// Returns the bytes of `nightly.json`.
    ///
    /// # Errors
    /// If it can't be written as JSON.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }

    /// Renders `nightly.md`.
    #[must_use]
    pub fn markdown(&self) -> String {
        let mut text = format!("# Night {}: {}\n\n", self.night, self.verdict.name());
        for reason in &self.reasons {
            _ = writeln!(text, "- {}", escaped(reason));
        }
        _ = writeln!(text, "\nThis night: {}.  ", self.program.in_words());
        if let (Some(program), Some(comparison)) = (&self.baseline_program, &self.comparison) {
            let same = if comparison.same_program { "the same program" } else { "another program" };
            let words = program.in_words();
            _ = writeln!(text, "Baseline: night {}, {words}: {same}.", comparison.baseline);
        }
        text += "\n| campaign | verdict | cases | in both | other settings | other results |\n";
        text += "|---|---|---|---|---|---|\n";
        for campaign in &self.campaigns {
            let verdict = campaign.verdict.map_or("broken off", Verdict::name);
            let of = |c: &NightComparison| {
                c.pairings.iter().find(|p| p.campaign == campaign.name).cloned()
            };
            let pairing = self.comparison.as_ref().and_then(of);
            let row = pairing.map_or("– | – | – | –".to_owned(), |p| {
                format!("{} | {} | {} | {}", p.cases, p.pairs, p.changed_inputs, p.changed_results)
            });
            _ = writeln!(
                text,
                "| [{0}]({1}/{0}) | {verdict} | {row} |",
                campaign.name, self.folder
            );
        }
        let held = self.suite_cases - self.suite_broken.len();
        if self.suite_cases > 0 {
            _ = writeln!(
                text,
                "\n{held} of {} cases of the suite end as they have to.",
                self.suite_cases
            );
        }
        if let Some(comparison) = &self.comparison {
            against(&mut text, comparison);
        }
        if !self.suite_broken.is_empty() {
            text += "\n## Not as the suite says\n\n| case | what is wrong | evidence |\n|---|---|---|\n";
            for result in self.suite_broken.iter().take(TOLD) {
                let problem = escaped(result.problem.as_deref().unwrap_or(""));
                let evidence = result
                    .evidence
                    .as_deref()
                    .map_or("–".to_owned(), |path| format!("[{path}]({path})"));
                _ = writeln!(text, "| {} | {problem} | {evidence} |", result.name);
            }
            more(&mut text, self.suite_broken.len());
        }
        text
    }
}

/// Lists scenarios in which something changed and no test could have found it, with their pairs.
fn blind(comparison: &NightComparison) -> BTreeMap<String, usize> {
    let is_blind = |test: &&Tested| test.change == Change::Changed && test.detectable.is_none();
    let blind = comparison.tests.iter().filter(is_blind);
    blind.map(|test| (format!("{}: {}", test.campaign, test.scenario), test.pairs)).collect()
}

/// Describes the detectable changes, by number of pairs.
fn power_in_words(comparison: &NightComparison) -> Vec<String> {
    let mut by_pairs: BTreeMap<usize, Option<f64>> = BTreeMap::new();
    for test in comparison.tests.iter().filter(|test| test.detectable_sigma.is_some()) {
        by_pairs.insert(test.pairs, test.detectable_sigma);
    }
    let one = |(pairs, shift): (usize, Option<f64>)| {
        let shift = significant(shift?, 2);
        Some(format!(
            "{pairs} pairs find with 90 % a mean that moved by {shift} standard deviations of the pairs' \
             differences, in {} tests",
            comparison.tests.len()
        ))
    };
    by_pairs.into_iter().filter_map(one).collect()
}

fn against(text: &mut String, comparison: &NightComparison) {
    tests(text, "Worse", comparison, Change::Worse);
    turned(text, "Newly worse cases", &comparison.newly_failing);
    tests(text, "Better", comparison, Change::Better);
    turned(text, "Newly better cases", &comparison.newly_passing);
    for (title, list) in [
        ("Requirements that are worse", &comparison.requirements_worse),
        ("Requirements that are better", &comparison.requirements_better),
        ("Not the same with the same program: an error", &comparison.flaky),
        ("In the baseline and not in this night", &comparison.missing),
        ("Not in the baseline", &comparison.new),
    ] {
        if !list.is_empty() {
            _ = writeln!(text, "\n## {title}\n");
            for line in list.iter().take(TOLD) {
                _ = writeln!(text, "- {}", escaped(line));
            }
            more(text, list.len());
        }
    }
    powers(text, comparison);
    let changed = comparison.found(Change::Changed).count();
    let same = comparison.found(Change::Same).count();
    let percent = plain(100.0 * comparison.limits.least, 3);
    _ = writeln!(
        text,
        "\n{} measures were compared: {same} are the same to the last bit, {changed} changed and are \
         shown to be neither worse nor better. What counts: p ≤ {} over all of them together (Holm), \
         and a mean that moved by {percent} % of the baseline's root mean square.",
        comparison.tests.len(),
        plain(comparison.limits.alpha, 3)
    );
}

/// Renders the detectable changes of each scenario: the measures of a navigation, and passes.
fn powers(text: &mut String, comparison: &NightComparison) {
    if comparison.tests.is_empty() {
        return;
    }
    *text += "\n## Smallest change that is found with 90 %\n\n";
    *text += "| campaign | scenario | measure | pairs | before | smallest change |\n|---|---|---|---|---|---|\n";
    let is_told = |test: &&Tested| {
        ["navigation.radial_error_nmi.max", "calibration.worst_normalized_error"]
            .contains(&test.measure.as_str())
            || test.measure.starts_with("passes of ")
    };
    let told: Vec<&Tested> = comparison.tests.iter().filter(is_told).collect();
    for test in told.iter().take(TOLD) {
        let smallest = match test.detectable {
            None => "none: too few pairs".to_owned(),
            Some(part) if test.detectable_sigma.is_none() => {
                format!("{} % of the pairs turn", significant(100.0 * part, 2))
            }
            Some(change) => significant(change, 2),
        };
        _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {smallest} |",
            test.campaign,
            escaped(&test.scenario),
            escaped(&test.measure),
            test.pairs,
            significant(test.baseline, 4)
        );
    }
    more(text, told.len());
}

fn tests(text: &mut String, title: &str, comparison: &NightComparison, change: Change) {
    let found: Vec<&Tested> = comparison.found(change).collect();
    if found.is_empty() {
        return;
    }
    _ = writeln!(text, "\n## {title}\n");
    *text += "| campaign | scenario | measure | pairs | before | now | difference, 95 % | p | found with 90 % |\n";
    *text += "|---|---|---|---|---|---|---|---|---|\n";
    for test in found.iter().take(TOLD) {
        let difference = test.difference.map_or("–".to_owned(), |[value, low, high]| {
            let [value, low, high] = [value, low, high].map(|v| significant(v, 3));
            format!("{value} [{low}, {high}]")
        });
        _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {difference} | {} | {} |",
            test.campaign,
            escaped(&test.scenario),
            escaped(&test.measure),
            test.pairs,
            significant(test.baseline, 4),
            significant(test.tonight, 4),
            significant(test.p_adjusted, 2),
            test.detectable.map_or("–".to_owned(), |change| significant(change, 2))
        );
    }
    more(text, found.len());
}

fn turned(text: &mut String, title: &str, list: &[TurnedCase]) {
    if list.is_empty() {
        return;
    }
    _ = writeln!(text, "\n## {title}\n");
    *text += "| campaign | case | scenario | before | now | why | again |\n|---|---|---|---|---|---|---|\n";
    for turned in list.iter().take(TOLD) {
        let name = |verdict: Option<Verdict>| verdict.map_or("none", Verdict::name);
        _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | `{}` |",
            turned.campaign,
            turned.case,
            escaped(&turned.scenario),
            name(turned.before),
            name(turned.now),
            escaped(&turned.reason),
            turned.rerun
        );
    }
    more(text, list.len());
}

fn more(text: &mut String, count: usize) {
    if count > TOLD {
        _ = writeln!(text, "\nAnd {} more, in nightly.json.", count - TOLD);
    }
}

/// Describes the regression of a scenario: the number of measures, and the clearest one.
fn in_words(campaign: &str, scenario: &str, tests: &[&Tested]) -> String {
    let what = match tests.len() {
        1 => "a measure".to_owned(),
        count => format!("{count} measures"),
    };
    let clearest = tests.iter().min_by(|a, b| a.p.total_cmp(&b.p));
    let clearest = clearest.map_or(String::new(), |test| {
        format!(
            ", first {}: {} before, {} now ({} pairs, p = {})",
            test.measure,
            significant(test.baseline, 4),
            significant(test.tonight, 4),
            test.pairs,
            significant(test.p_adjusted, 2)
        )
    });
    format!("{campaign}: {what} of {scenario} worse{clearest}")
}

/// Escapes a text for a cell of a table, on one line.
fn escaped(text: &str) -> String {
    printable(&text.replace('|', "\\|").replace(['\n', '\r'], " ")).into_owned()
}
