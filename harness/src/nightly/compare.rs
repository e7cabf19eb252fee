//! Two nights, paired seed by seed.
//!
//! A case of both nights has the same instrument and the same noise: what differs between the two is the
//! doing of the program, or of a scenario that was changed. Whether that is worse is a matter of all
//! pairs, by Wilcoxon's signed-rank test for measures and McNemar's for passes; all of these tests
//! together have one in twenty (`Limits::alpha`) of finding what isn't there (Holm). What can't be paired
//! isn't compared: another seed is another instrument, and its noise is no news.
//!
//! A measure that a case had in one night and hasn't in the other, because its calibration was refused or it
//! ended as an error, is beyond every number there, and counts in the test with the highest rank.

use super::night::{CampaignNight, Night, Program};
use super::results::CaseRow;
use super::suite::SuiteResult;
use octant_requirements::Verdict;
use octant_score::numerics::in_words;
use octant_statistics::multiple::holm;
use octant_statistics::paired::{PassPairs, difference};
use octant_statistics::power;
use octant_statistics::sample::rms;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Version of the form of `nightly.json`.
pub const SCHEMA: u32 = 1;

/// What counts as a change.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Limits {
    /// Probability of any finding among all tests where there is nothing.
    pub alpha: f64,
    /// Part of the baseline's root mean square below which a change of the mean doesn't count.
    pub least: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { alpha: 0.05, least: 0.01 }
    }
}

/// What became of a measure or of passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Change {
    /// Worse, shown by the test.
    Worse,
    /// Better, shown by the test.
    Better,
    /// Not the same, and neither is shown, or too little to count.
    Changed,
    /// Every pair is the same, to the last bit.
    Same,
}

impl Change {
    /// As it is written.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Worse => "worse",
            Self::Better => "better",
            Self::Changed => "changed",
            Self::Same => "same",
        }
    }
}

/// A measure, or a requirement's passes, of a scenario of a campaign in both nights.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tested {
    /// The campaign.
    pub campaign: String,
    /// The scenario.
    pub scenario: String,
    /// Path of the measure, `margin of ID`, or `passes of ID`.
    pub measure: String,
    /// Pairs that are tested: those that have it in one of the nights, or in both.
    pub pairs: usize,
    /// Pairs that had it in the baseline alone: a calibration that is refused now is beyond every number.
    pub lost: usize,
    /// Pairs that have it in this night alone.
    pub gained: usize,
    /// Mean in the baseline; of passes, their part.
    pub baseline: f64,
    /// Mean in this night.
    pub tonight: f64,
    /// Mean difference of the pairs that have it in both, with its 95 % interval by Student's
    /// distribution; null with less than two such pairs.
    pub difference: Option<[f64; 3]>,
    /// Probability by the test alone.
    pub p: f64,
    /// The same, adjusted for all tests of the night.
    pub p_adjusted: f64,
    /// What it comes to.
    pub change: Change,
    /// Smallest change that so many pairs find with 90 % among all tests of the night: of the mean, in its
    /// unit; of passes, the part of the pairs that turn. Null: so few pairs find none.
    pub detectable: Option<f64>,
    /// The same of a mean, in standard deviations of the pairs' differences.
    pub detectable_sigma: Option<f64>,
    /// What a shift in standard deviations is multiplied by, and the least that counts.
    #[serde(skip)]
    scale: Option<[f64; 2]>,
}

/// A case that ends otherwise than in the baseline.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Turned {
    /// The campaign, or `suite`.
    pub campaign: String,
    /// The case.
    pub case: String,
    /// The scenario.
    pub scenario: String,
    /// Requirements that turned; empty: the case itself.
    pub requirements: Vec<String>,
    /// Verdict in the baseline.
    pub before: Option<Verdict>,
    /// Verdict in this night.
    pub now: Option<Verdict>,
    /// Why.
    pub reason: String,
    /// The line that runs it again.
    pub rerun: String,
}

/// How far the cases of a campaign are those of the baseline.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Pairing {
    /// The campaign.
    pub campaign: String,
    /// It has the plan of the baseline.
    pub same_plan: bool,
    /// Cases of this night.
    pub cases: usize,
    /// Cases of the baseline.
    pub baseline_cases: usize,
    /// Cases that both have.
    pub pairs: usize,
    /// Of these, those whose scenario or settings were changed.
    pub changed_inputs: usize,
    /// Of these, those that came to another result.
    pub changed_results: usize,
}

/// What a night is against its baseline.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Night of the baseline.
    pub baseline: String,
    /// The same program ran both.
    pub same_program: bool,
    /// The programs have other numerics versions, in words: what differs isn't the unit's doing; null: they have the same.
    pub numerics_changed: Option<String>,
    /// What counts as a change.
    pub limits: Limits,
    /// Campaigns of both nights.
    pub pairings: Vec<Pairing>,
    /// Campaigns and parts of the suite that the baseline has and this night hasn't.
    pub missing: Vec<String>,
    /// Campaigns that the baseline hasn't.
    pub new: Vec<String>,
    /// Every test.
    pub tests: Vec<Tested>,
    /// Requirements whose verdict is worse than in the baseline, in words.
    pub requirements_worse: Vec<String>,
    /// And those whose verdict is better.
    pub requirements_better: Vec<String>,
    /// Cases that are worse than in the baseline.
    pub newly_failing: Vec<Turned>,
    /// Cases that are better.
    pub newly_passing: Vec<Turned>,
    /// The same case and the same program, and another result.
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

/// Compares a night with its baseline. `rerun` makes the line that runs a case of a campaign again.
#[must_use]
pub fn compare(
    before: Side<'_>,
    now: Side<'_>,
    limits: Limits,
    rerun: &dyn Fn(&str, &str) -> String,
) -> Comparison {
    let same_program = now.night.program.is_same(&before.night.program);
    let mut all = Comparison {
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

/// That two programs give other bits from the same inputs.
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

impl Comparison {
    /// What the tests could have found. The first step of Holm's procedure divides the level by the number
    /// of tests: what it finds is found however the others come out.
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
                list.push(Turned {
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
            let turned = || Turned {
                campaign: "suite".to_owned(),
                case: result.name.clone(),
                scenario: result.scenario.display().to_string(),
                requirements: Vec::new(),
                before: old.and_then(|old| old.verdict),
                now: result.verdict,
                reason: result.problem.clone().unwrap_or_default(),
                rerun: format!("octant run {}", result.scenario.display()),
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

    /// Tests that came to this.
    pub fn found(&self, change: Change) -> impl Iterator<Item = &Tested> {
        self.tests.iter().filter(move |test| test.change == change)
    }
}

impl CaseRow {
    /// Whether two rows hold the same result, to the last bit. The case may have another id.
    fn has_result_of(&self, other: &Self) -> bool {
        let result = |row: &Self| {
            let mut row = row.row.clone();
            row.retain(|(name, _)| name != "case" && name != "set");
            row
        };
        result(self) == result(other)
    }
}

/// Tests pairs of numbers. The sense is 1 where less is better, −1 where more is. What Holm's correction
/// leaves of it is known when all tests are.
fn tested(values: &[(Option<f64>, Option<f64>)], sense: f64, limits: Limits) -> Option<Tested> {
    // What one night has and the other hasn't is as bad there as can be.
    let far = sense * f64::INFINITY;
    let there = values.iter().filter(|(a, b)| a.is_some() || b.is_some());
    let carried: Vec<(f64, f64)> =
        there.map(|(a, b)| (a.unwrap_or(far), b.unwrap_or(far))).collect();
    if carried.is_empty() {
        return None;
    }
    let lost = values.iter().filter(|(a, b)| a.is_some() && b.is_none()).count();
    let gained = values.iter().filter(|(a, b)| a.is_none() && b.is_some()).count();
    let both: Vec<(f64, f64)> = values.iter().filter_map(|(a, b)| Some(((*a)?, (*b)?))).collect();
    let (before, now): (Vec<f64>, Vec<f64>) = both.iter().copied().unzip();
    let mean = |values: &[f64]| octant_statistics::sample::mean(values).unwrap_or(f64::NAN);
    let same = lost + gained == 0 && both.iter().all(|(a, b)| a.to_bits() == b.to_bits());
    let (first, second): (Vec<f64>, Vec<f64>) = carried.iter().copied().unzip();
    let found = difference(&first, &second, 0.95);
    let least = limits.least * rms(&before).unwrap_or(0.0);
    let (p, change) = match &found {
        _ if same => (1.0, Change::Same),
        None => (1.0, Change::Changed),
        Some(found) => {
            let moved = found.mean.map_or(0.0, |mean| mean.value);
            // A mean with one more that is beyond every number is worse than any without.
            let (more, counts) = match lost.cmp(&gained) {
                std::cmp::Ordering::Greater => (sense > 0.0, true),
                std::cmp::Ordering::Less => (sense < 0.0, true),
                std::cmp::Ordering::Equal => (moved > 0.0, moved.abs() >= least),
            };
            // A mean that a few pairs make against all others is no direction.
            let agrees = (found.more > found.less) == more && found.more != found.less;
            let change = match (agrees && counts, more == (sense > 0.0)) {
                (false, _) => Change::Changed,
                (true, true) => Change::Worse,
                (true, false) => Change::Better,
            };
            (found.wilcoxon_p, change)
        }
    };
    Some(Tested {
        campaign: String::new(),
        scenario: String::new(),
        measure: String::new(),
        pairs: carried.len(),
        lost,
        gained,
        baseline: mean(&before),
        tonight: mean(&now),
        difference: found
            .and_then(|found| found.mean)
            .map(|mean| [mean.value, mean.low, mean.high]),
        p,
        p_adjusted: 1.0,
        change,
        detectable: None,
        detectable_sigma: None,
        scale: Some([found.and_then(|found| found.deviation).unwrap_or(0.0), least]),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pairs(
        count: u32,
        one: impl Fn(u32) -> (Option<f64>, Option<f64>),
    ) -> Vec<(Option<f64>, Option<f64>)> {
        (0..count).map(one).collect()
    }

    /// A number that looks drawn.
    fn drawn(k: u32) -> f64 {
        1.0 + 0.1 * f64::from((k * 37 + 11) % 101) / 101.0
    }

    #[test]
    fn a_calibration_that_is_refused_now_is_worse_than_any_error() {
        // Six of sixteen are refused, and the others got better by a little.
        let values =
            pairs(16, |k| (Some(drawn(k)), (k >= 6).then(|| drawn(k) - 1e-6 * drawn(k + 3))));
        let found = tested(&values, 1.0, Limits::default()).unwrap();
        assert_eq!((found.pairs, found.lost, found.gained), (16, 6, 0));
        // The direction is that of the refused ones; the majority says otherwise: it isn't shown.
        assert_eq!(found.change, Change::Changed);
        let values = pairs(16, |k| (Some(drawn(k)), (k >= 12).then(|| drawn(k))));
        let found = tested(&values, 1.0, Limits::default()).unwrap();
        assert_eq!((found.change, found.lost), (Change::Worse, 12));
        // Twelve signs alike: 2 · 2^-12.
        assert!((found.p - 2.0 * 0.5f64.powi(12)).abs() < 1e-12, "{}", found.p);
        // A margin is lost downwards.
        let margin = tested(&values, -1.0, Limits::default()).unwrap();
        assert_eq!(margin.change, Change::Worse);
        // And what is published again is better.
        let back: Vec<_> = values.iter().map(|(a, b)| (*b, *a)).collect();
        assert_eq!(tested(&back, 1.0, Limits::default()).unwrap().change, Change::Better);
        // Refused in both nights: no difference, and the pair has nothing to test.
        let none = pairs(16, |k| if k < 8 { (None, None) } else { (Some(1.0), Some(1.0)) });
        let found = tested(&none, 1.0, Limits::default()).unwrap();
        assert_eq!((found.change, found.pairs, found.lost), (Change::Same, 8, 0));
        assert!(tested(&none[..8], 1.0, Limits::default()).is_none());
    }
}
