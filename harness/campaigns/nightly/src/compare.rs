//! Compares two nights, paired seed by seed.
//!
//! A case of both nights has the same instrument and the same noise: a difference comes from the
//! program, or from a changed scenario. Whether it is a regression is decided over all pairs, by
//! Wilcoxon's signed-rank test for measures and McNemar's for passes; all of these tests together
//! have a false-positive probability of one in twenty (`Thresholds::alpha`, Holm). Cases without a pair
//! aren't compared: another seed is another instrument, and its noise is no change.
//!
//! A measure that a case had in one night and lacks in the other, because its calibration was
//! refused or it ended as an error, is beyond every number there, and counts in the test with the
//! highest rank.

pub use super::change::{Change, Tested, Thresholds, tested};

use super::night::{CampaignNight, Night, Program};
use super::results::{CaseRow, SCORED_LATER};
use super::suite::SuiteResult;
use octant_evidence::manifest::shell_path;
use octant_score::numerics::in_words;
use octant_statistics::multiple::holm;
use octant_statistics::paired::PassPairs;
use octant_statistics::power;
use octant_verdict::Verdict;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Version of the form of `nightly.json`.
pub const SCHEMA: u32 = 1;

/// Case with another verdict than in the baseline.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct TurnedCase {
    /// The campaign, or `suite`.
    pub campaign: String,
    /// The case.
    pub case: String,
    /// The scenario.
    pub scenario: String,
    /// Requirements that turned; empty if the case itself did.
    pub requirements: Vec<String>,
    /// Verdict in the baseline.
    pub before: Option<Verdict>,
    /// Verdict in this night.
    pub now: Option<Verdict>,
    /// Reason.
    pub reason: String,
    /// Command line that runs it again.
    pub rerun: String,
}

/// Agreement of a campaign's cases with those of the baseline.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Pairing {
    /// The campaign.
    pub campaign: String,
    /// True if the plan is that of the baseline.
    pub same_plan: bool,
    /// Cases of this night.
    pub cases: usize,
    /// Cases of the baseline.
    pub baseline_cases: usize,
    /// Cases that both nights have.
    pub pairs: usize,
    /// Pairs whose scenario or settings were changed.
    pub changed_inputs: usize,
    /// Pairs with another result.
    pub changed_results: usize,
}

/// Comparison of a night with its baseline.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NightComparison {
    /// Night of the baseline.
    pub baseline: String,
    /// True if the same program ran both.
    pub same_program: bool,
    /// Statement that the programs have different numerics versions, so that differences aren't due
    /// to the unit; null if they are the same.
    pub numerics_changed: Option<String>,
    /// Thresholds of a change.
    pub limits: Thresholds,
    /// Campaigns of both nights.
    pub pairings: Vec<Pairing>,
    /// Campaigns and parts of the suite that only the baseline has.
    pub missing: Vec<String>,
    /// Campaigns that only this night has.
    pub new: Vec<String>,
    /// Every test.
    pub tests: Vec<Tested>,
    /// Requirements whose verdict is worse than in the baseline, as text.
    pub requirements_worse: Vec<String>,
    /// Requirements whose verdict is better.
    pub requirements_better: Vec<String>,
    /// Cases that are worse than in the baseline.
    pub newly_failing: Vec<TurnedCase>,
    /// Cases that are better than in the baseline.
    pub newly_passing: Vec<TurnedCase>,
    /// Cases with another result from the same program.
    pub flaky: Vec<String>,
}

/// A night with the rows of its campaigns, by name.
#[derive(Clone, Copy, Debug)]
pub struct Side<'a> {
    /// The night.
    pub night: &'a Night,
    /// Rows of its campaigns.
    pub rows: &'a BTreeMap<String, Vec<CaseRow>>,
}

/// Compares a night with its baseline. `rerun` returns the command line that runs a case of a
/// campaign again.
#[must_use]
pub fn compare(
    before: Side<'_>,
    now: Side<'_>,
    limits: Thresholds,
    rerun: &dyn Fn(&str, &str) -> String,
) -> NightComparison {
    let same_program = now.night.program.is_same(&before.night.program);
    let mut all = NightComparison {
        baseline: before.night.id.clone(),
        same_program,
        numerics_changed: numerics_changed(&before.night.program, &now.night.program),
        limits,
        pairings: Vec::new(),
        missing: Vec::new(),
        new: Vec::new(),
        tests: Vec::new(),
        requirements_worse: Vec::new(),
        requirements_better: Vec::new(),
        newly_failing: Vec::new(),
        newly_passing: Vec::new(),
        flaky: Vec::new(),
    };
    let of = |night: &Night| -> BTreeMap<String, CampaignNight> {
        night.campaigns.iter().map(|c| (c.name.clone(), c.clone())).collect()
    };
    let (old, new) = (of(before.night), of(now.night));
    for (name, campaign) in &new {
        let Some(baseline) = old.get(name) else {
            all.new.push(name.clone());
            continue;
        };
        let none = Vec::new();
        let rows = [before.rows, now.rows].map(|rows| rows.get(name).unwrap_or(&none));
        all.requirements(name, baseline, campaign);
        all.cases(name, campaign.plan == baseline.plan, rows, rerun);
    }
    all.missing.extend(old.keys().filter(|name| !new.contains_key(*name)).cloned());
    all.suite(&before.night.suite, &now.night.suite);
    let adjusted = holm(&all.tests.iter().map(|test| test.p).collect::<Vec<_>>());
    for (test, adjusted) in all.tests.iter_mut().zip(adjusted) {
        test.p_adjusted = adjusted;
        if adjusted > limits.alpha && matches!(test.change, Change::Worse | Change::Better) {
            test.change = Change::Changed;
        }
    }
    all.state_power();
    all
}

/// States that two programs give different bits from the same inputs, if their numerics versions
/// differ.
fn numerics_changed(before: &Program, now: &Program) -> Option<String> {
    (before.numerics != now.numerics).then(|| {
        format!(
            "the numerics changed: the baseline is of octant {} with {}, this night of octant {} with {}",
            before.octant,
            in_words(before.numerics),
            now.octant,
            in_words(now.numerics)
        )
    })
}

impl NightComparison {
    /// Computes the detectable changes of the tests. The first step of Holm's procedure divides the
    /// level by the number of tests: a change found at that level is found whatever the other tests
    /// give.
    fn state_power(&mut self) {
        let level = self.limits.alpha / self.tests.len().max(1) as f64;
        let mut shifts: BTreeMap<usize, Option<f64>> = BTreeMap::new();
        for test in &mut self.tests {
            let pairs = test.pairs;
            match test.scale {
                Some([sigma, least]) => {
                    let shift = shifts.entry(pairs).or_insert_with(|| {
                        power::signed_rank_shift(pairs as u64, level, power::POWER)
                    });
                    test.detectable_sigma = *shift;
                    test.detectable = shift.map(|shift| (shift * sigma).max(least));
                }
                None => test.detectable = power::turning(pairs as u64, level, power::POWER),
            }
        }
    }

    fn requirements(&mut self, name: &str, before: &CampaignNight, now: &CampaignNight) {
        for (id, verdict) in &now.requirements {
            let Some(old) = before.requirements.get(id) else { continue };
            let words = format!("{name}: {id}: {} before, {} now", old.name(), verdict.name());
            match verdict.cmp(old) {
                std::cmp::Ordering::Greater => self.requirements_worse.push(words),
                std::cmp::Ordering::Less => self.requirements_better.push(words),
                std::cmp::Ordering::Equal => {}
            }
        }
        for id in before.requirements.keys().filter(|id| !now.requirements.contains_key(*id)) {
            self.missing.push(format!("{name}: requirement {id}"));
        }
    }

    fn cases(
        &mut self,
        campaign: &str,
        same_plan: bool,
        [before, now]: [&Vec<CaseRow>; 2],
        rerun: &dyn Fn(&str, &str) -> String,
    ) {
        let by_pair: HashMap<&str, &CaseRow> =
            before.iter().map(|row| (row.pair.as_str(), row)).collect();
        let pairs: Vec<(&CaseRow, &CaseRow)> =
            now.iter().filter_map(|row| Some((*by_pair.get(row.pair.as_str())?, row))).collect();
        let differs = |(a, b): &&(&CaseRow, &CaseRow)| !a.has_result_of(b);
        self.pairings.push(Pairing {
            campaign: campaign.to_owned(),
            same_plan,
            cases: now.len(),
            baseline_cases: before.len(),
            pairs: pairs.len(),
            changed_inputs: pairs.iter().filter(|(a, b)| a.case != b.case).count(),
            changed_results: pairs.iter().filter(differs).count(),
        });
        for (old, new) in &pairs {
            if self.same_program && old.case == new.case && !old.has_result_of(new) {
                self.flaky.push(format!("{campaign}: case {}", new.case));
            }
            let line = rerun(campaign, &new.case);
            self.turn(campaign, old, new, line);
        }
        let scenarios: BTreeSet<&str> = pairs.iter().map(|(_, b)| b.scenario.as_str()).collect();
        for scenario in scenarios {
            let mine: Vec<_> =
                pairs.iter().copied().filter(|(_, b)| b.scenario == scenario).collect();
            self.measures(campaign, scenario, &mine);
        }
    }

    fn turn(&mut self, campaign: &str, old: &CaseRow, new: &CaseRow, rerun: String) {
        let turned = |worse: bool| {
            let ids = new.checks.iter().filter(|(id, (verdict, _))| {
                old.checks.get(*id).is_some_and(|(before, _)| {
                    if worse { verdict > before } else { verdict < before }
                })
            });
            ids.map(|(id, _)| id.clone()).collect::<Vec<String>>()
        };
        for (worse, list) in [(true, &mut self.newly_failing), (false, &mut self.newly_passing)] {
            let requirements = turned(worse);
            let itself = if worse { new.verdict > old.verdict } else { new.verdict < old.verdict };
            if itself || !requirements.is_empty() {
                list.push(TurnedCase {
                    campaign: campaign.to_owned(),
                    case: new.case.clone(),
                    scenario: new.scenario.clone(),
                    requirements,
                    before: Some(old.verdict),
                    now: Some(new.verdict),
                    reason: new.reasons.clone(),
                    rerun: rerun.clone(),
                });
            }
        }
    }

    fn measures(&mut self, campaign: &str, scenario: &str, pairs: &[(&CaseRow, &CaseRow)]) {
        let mut names: BTreeSet<String> = BTreeSet::new();
        let mut requirements: BTreeSet<&str> = BTreeSet::new();
        for row in pairs.iter().flat_map(|(a, b)| [a, b]) {
            names.extend(row.measures.keys().cloned());
            requirements.extend(row.checks.keys().map(String::as_str));
        }
        let mut put = |measure: String, value: &dyn Fn(&CaseRow) -> Option<f64>, sense: f64| {
            let values: Vec<_> = pairs.iter().map(|(a, b)| (value(a), value(b))).collect();
            let test = tested(&values, sense, self.limits);
            self.tests.extend(test.map(|test| Tested {
                campaign: campaign.to_owned(),
                scenario: scenario.to_owned(),
                measure,
                ..test
            }));
        };
        for name in names {
            // A baseline from before attitude and velocity were scored has nothing to compare with.
            let later = SCORED_LATER.contains(&name.as_str());
            if later && !pairs.iter().any(|(a, _)| a.measures.contains_key(&name)) {
                continue;
            }
            put(name.clone(), &|row| row.measures.get(&name).copied(), 1.0);
        }
        for id in &requirements {
            let margin = |row: &CaseRow| row.checks.get(*id).and_then(|(_, margin)| *margin);
            put(format!("margin of {id}"), &margin, -1.0);
        }
        for id in requirements {
            let passed = |row: &CaseRow| {
                row.checks.get(id).is_some_and(|(verdict, _)| *verdict == Verdict::Pass)
            };
            let before: Vec<bool> = pairs.iter().map(|(a, _)| passed(a)).collect();
            let now: Vec<bool> = pairs.iter().map(|(_, b)| passed(b)).collect();
            let Some(counts) = PassPairs::of(&before, &now) else { continue };
            let part = |passes: u64| passes as f64 / pairs.len().max(1) as f64;
            let change = match counts.only_first.cmp(&counts.only_second) {
                _ if counts.only_first + counts.only_second == 0 => Change::Same,
                std::cmp::Ordering::Greater => Change::Worse,
                std::cmp::Ordering::Less => Change::Better,
                std::cmp::Ordering::Equal => Change::Changed,
            };
            self.tests.push(Tested {
                campaign: campaign.to_owned(),
                scenario: scenario.to_owned(),
                measure: format!("passes of {id}"),
                pairs: pairs.len(),
                lost: 0,
                gained: 0,
                baseline: part(counts.both + counts.only_first),
                tonight: part(counts.both + counts.only_second),
                difference: None,
                p: counts.mcnemar(),
                p_adjusted: 1.0,
                change,
                detectable: None,
                detectable_sigma: None,
                scale: None,
            });
        }
    }

    fn suite(&mut self, before: &[SuiteResult], now: &[SuiteResult]) {
        for result in now {
            let old = before.iter().find(|old| old.name == result.name);
            let turned = || TurnedCase {
                campaign: "suite".to_owned(),
                case: result.name.clone(),
                scenario: result.scenario.display().to_string(),
                requirements: Vec::new(),
                before: old.and_then(|old| old.verdict),
                now: result.verdict,
                reason: result.problem.clone().unwrap_or_default(),
                rerun: format!("octant run {}", shell_path(&result.scenario)),
            };
            match (old.map(|old| old.problem.is_some()), result.problem.is_some()) {
                (None | Some(false), true) => self.newly_failing.push(turned()),
                (Some(true), false) => self.newly_passing.push(turned()),
                _ => {}
            }
            if let Some(old) = old
                && self.same_program
                && old.scenario_blake3 == result.scenario_blake3
                && !old.is_same(result)
            {
                self.flaky.push(format!("suite: {}", result.name));
            }
        }
        let gone = before.iter().filter(|old| !now.iter().any(|new| new.name == old.name));
        self.missing.extend(gone.map(|old| format!("suite: {}", old.name)));
    }

    /// Lists the tests with this change.
    pub fn found(&self, change: Change) -> impl Iterator<Item = &Tested> {
        self.tests.iter().filter(move |test| test.change == change)
    }
}

impl CaseRow {
    /// Returns whether two rows have the same result, to the last bit. The case may have another
    /// id.
    fn has_result_of(&self, other: &Self) -> bool {
        let result = |row: &Self| {
            let mut row = row.row.clone();
            // Factors are those of the pair, whatever their form.
            row.retain(|(name, _)| name != "case" && name != "set" && !name.starts_with("factor."));
            row
        };
        result(self) == result(other)
    }
}
