//! Numbers over the cases of a campaign: `statistics.json`.
//!
//! The statistics themselves are those of [`octant_statistics`]. An end of an interval for which
//! there are too few cases is null.
//!
//! A case that ran without a navigation, because its calibration was refused or it ended as an
//! error, is part of every figure, as a value beyond every number: percentiles are those of the
//! full sample, and null where they fall on such cases. Leaving them out would bias the drift to
//! that of the good cases. Cases with the same stream count once.

use super::combination::{self, Combination, number_of, takes_part};
use super::curves::StoredCurve;
use super::effects::{CaseEffect, EffectFigures};
use super::envelope::{EnvelopeFigures, ShownEnvelope};
use super::rows::{CaseDrift, ReportRows};
pub use super::spread::{CONFIDENCE, Position, Spread};
use crate::plan::{Case, Plan};
use octant_statistics::convergence::{ConvergenceStep, convergence};
use octant_statistics::outlier::{LIMIT, OutlierScale, outliers};
use octant_statistics::quantile::interval;
use octant_statistics::rank::{RankCorrelation, spearman};
use octant_statistics::rate::{RateBounds, rate_bounds};
use octant_statistics::sample::percentile;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Measure that is correlated with the factors.
pub const DRIFT: &str = "navigation.radial_error_nmi.rate_per_h";

/// Drift of the cases of one combination.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CombinationFigures {
    /// Scenario.
    pub scenario: String,
    /// Factors of the grid with their values.
    pub factors: BTreeMap<String, String>,
    /// Cases of the plan.
    pub cases: usize,
    /// Independent draws among those that ran, on which the figures are based.
    pub draws: usize,
    /// Draws with a navigation.
    pub navigated: usize,
    /// Draws without a navigation: refused or ended as errors, beyond every number.
    pub beyond: usize,
    /// Radial error at the end of the navigation; null, as everything below, if no case navigated.
    pub at_end: Option<Position>,
    /// Radial error at marks that all navigations reached.
    pub at_marks: BTreeMap<String, Position>,
    /// Largest radial error, nmi.
    pub largest_nmi: Option<Spread>,
    /// Largest errors of attitude and velocity, by name and unit, that all navigations have.
    pub solution: BTreeMap<String, Spread>,
    /// Radial error rate, nmi/h.
    pub rate_nmi_per_h: Option<RateBounds>,
    /// Time-RMS of the radial error, nmi.
    pub time_rms_nmi: Option<Spread>,
    /// Percentiles of the errors over time.
    pub envelope: Option<EnvelopeFigures>,
    /// Convergence of the median of the radial error at the end.
    pub convergence_cep50: Vec<ConvergenceStep>,
    /// Convergence of its 95th percentile.
    pub convergence_r95: Vec<ConvergenceStep>,
    /// Correlation of the drift with each drawn factor.
    pub sensitivity: Vec<FactorFigures>,
    /// Effects of the faults, against the twins without them; left out of a combination whose cases have no twins.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub effects: Option<EffectFigures>,
}

/// Correlation of the drift with a factor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FactorFigures {
    /// The factor.
    pub factor: String,
    /// Cases in which the factor has an effect.
    pub cases: usize,
    /// Spearman's rank correlation with the radial error rate; null with fewer than three cases, or
    /// if one of them is constant.
    pub correlation: Option<RankCorrelation>,
    /// True if significant at 5 %, with all correlations of the campaign considered.
    pub stands_out: bool,
}

/// All cases of a scenario over its combinations. They aren't independent of each other, so there
/// are no bounds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScenarioFigures {
    /// Name.
    pub scenario: String,
    /// Combinations.
    pub combinations: usize,
    /// Cases with a navigation.
    pub navigated: usize,
    /// Cases that ran without one: beyond every number.
    pub beyond: usize,
    /// Median of the radial error at the end, nmi.
    pub cep50_nmi: Option<f64>,
    /// 95th percentile.
    pub r95_nmi: Option<f64>,
    /// Median of the radial error rates, nmi/h.
    pub rate50_nmi_per_h: Option<f64>,
    /// 95th percentile.
    pub rate95_nmi_per_h: Option<f64>,
    /// Median of the time-RMS, nmi.
    pub time_rms_nmi: Option<f64>,
    /// Spearman's ρ of the drift with the numeric factors of the grid. Without a probability,
    /// because the same instruments occur at all values.
    pub grid: Vec<GridFigures>,
}

/// Correlation of the drift with a factor of the grid.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GridFigures {
    /// The factor.
    pub factor: String,
    /// Cases.
    pub cases: usize,
    /// Spearman's ρ with the radial error rate.
    pub rho: f64,
}

/// Outlying case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OutlierFigures {
    /// The case.
    pub case: String,
    /// Combination, as a place in the list of them.
    pub combination: usize,
    /// The measure.
    pub measure: &'static str,
    /// Value.
    pub value: f64,
    /// Median of the combination.
    pub median: f64,
    /// Modified z-score of the logarithm; null if it isn't finite.
    pub score: f64,
}

/// Cases of a sample that ran; a case without a drift is beyond every number.
struct Sample<'a> {
    rows: &'a ReportRows<'a>,
    /// Places of the cases in the plan.
    places: Vec<usize>,
}

impl<'a> Sample<'a> {
    /// Selects the cases at these places, the first of each draw.
    fn of_draws(rows: &'a ReportRows<'_>, places: &[usize], draws: &[u32]) -> Self {
        let mut seen = vec![false; draws.iter().max().map_or(0, |last| *last as usize + 1)];
        let mut is_new = |place: usize| {
            let seen = draws.get(place).and_then(|draw| seen.get_mut(*draw as usize));
            seen.is_none_or(|seen| !std::mem::replace(seen, true))
        };
        Self::of(rows, places.iter().copied().filter(|p| rows.has_run(*p) && is_new(*p)))
    }

    fn of(rows: &'a ReportRows<'_>, places: impl Iterator<Item = usize>) -> Self {
        Self { rows, places: places.filter(|place| rows.has_run(*place)).collect() }
    }

    /// Reads the cases, each with its drift.
    fn cases(&self) -> impl Iterator<Item = (&'a Case, Option<CaseDrift>)> {
        self.rows.drifts_at(self.places.iter().copied())
    }

    /// Reads the drifts of the cases that navigated.
    fn drifts(&self) -> impl Iterator<Item = CaseDrift> {
        let there = self.places.iter().copied().filter(|place| self.rows.has_drift(*place));
        self.rows.drifts_at(there).filter_map(|(_, drift)| drift)
    }

    /// Reads the errors over time, each with the place of its case.
    fn curves(&self) -> impl Iterator<Item = (usize, StoredCurve)> {
        let cases = self.places.iter().zip(self.cases());
        cases.filter_map(|(place, (_, drift))| Some((*place, drift?.curve?)))
    }

    /// Reads the effects of the faults of the cases; empty if no case has any.
    fn effects(&self) -> Vec<Option<CaseEffect>> {
        if !self.places.iter().any(|place| self.rows.has_effect(*place)) {
            return Vec::new();
        }
        let rows = self.rows.at(self.places.iter().copied());
        rows.map(|row| row.outcome.and_then(|outcome| outcome.effect)).collect()
    }

    fn navigated(&self) -> usize {
        self.places.iter().filter(|place| self.rows.has_drift(**place)).count()
    }

    fn beyond(&self) -> usize {
        self.places.len() - self.navigated()
    }

    /// Returns a measure of all cases; empty if no case navigates.
    fn column(&self, of: impl Fn(&CaseDrift) -> f64) -> Vec<f64> {
        if self.navigated() == 0 {
            return Vec::new();
        }
        self.cases().map(|(_, drift)| drift.as_ref().map_or(f64::INFINITY, &of)).collect()
    }
}

/// A measure of a drift.
type Measure = fn(&CaseDrift) -> f64;

/// Measures that are searched for outliers.
const OUTLYING: [(&str, Measure); 2] = [
    ("navigation.radial_error_nmi.max", |drift| drift.max_nmi),
    (DRIFT, |drift| drift.rate_nmi_per_h),
];

impl CombinationFigures {
    pub(super) fn of(
        plan: &Plan,
        grid: &[String],
        combination: &Combination,
        rows: &ReportRows<'_>,
        draws: &[u32],
    ) -> Self {
        let sample = Sample::of_draws(rows, &combination.cases, draws);
        let column = |f: fn(&CaseDrift) -> f64| sample.column(f);
        let last = column(|drift| drift.final_nmi);
        let of_last = |p: f64| convergence(&last, |values| interval(values, p, CONFIDENCE));
        let envelope =
            || EnvelopeFigures::of(sample.curves().map(|(_, curve)| curve), sample.beyond());
        let is_number = |name: &String| {
            let cases = combination.cases.iter().filter_map(|case| plan.cases.get(*case));
            cases.filter_map(|case| case.factors.get(name)).all(|v| number_of(v).is_some())
        };
        let drawn = |name: &&String| !grid.contains(*name) && is_number(name);
        Self {
            scenario: combination.scenario.clone(),
            factors: combination.factors.iter().cloned().collect(),
            cases: combination.cases.len(),
            draws: sample.places.len(),
            navigated: sample.navigated(),
            beyond: sample.beyond(),
            at_end: Position::of(&last),
            at_marks: marks(&sample),
            largest_nmi: Spread::of(&column(|drift| drift.max_nmi)),
            solution: solution(&sample),
            rate_nmi_per_h: rate_bounds(&column(|drift| drift.rate_nmi_per_h), CONFIDENCE),
            time_rms_nmi: Spread::of(&column(|drift| drift.rms_nmi)),
            envelope: envelope(),
            convergence_cep50: of_last(0.5),
            convergence_r95: of_last(0.95),
            sensitivity: (plan.factors.iter().filter(drawn))
                .filter_map(|name| FactorFigures::of(name, &sample))
                .collect(),
            effects: EffectFigures::of(&sample.effects()),
        }
    }
}

/// Builds the envelope of a combination, in units of which each case, by its place, has so many in a minute of arc of
/// latitude and of longitude.
pub(super) fn envelope_in(
    combination: &Combination,
    rows: &ReportRows<'_>,
    draws: &[u32],
    factors: impl Fn(usize) -> [f64; 2],
) -> Option<ShownEnvelope> {
    let sample = Sample::of_draws(rows, &combination.cases, draws);
    let curves = sample.curves().map(|(place, curve)| (curve, factors(place)));
    ShownEnvelope::of(curves, sample.beyond())
}

/// Collects the largest errors of attitude and velocity that every navigating case has.
fn solution(sample: &Sample<'_>) -> BTreeMap<String, Spread> {
    // One by one: a set that is collected sorts a list of all first, with every case's names.
    let mut names: BTreeSet<(&str, &str)> = BTreeSet::new();
    sample.drifts().flat_map(|drift| drift.solution).for_each(|(name, unit, _)| {
        names.insert((name, unit));
    });
    let of = |(name, unit): (&str, &str)| {
        let get = |drift: &CaseDrift| {
            let mut all = drift.solution.iter();
            all.find(|other| (other.0, other.1) == (name, unit)).map(|(.., max)| *max)
        };
        let known = sample.drifts().all(|drift| get(&drift).is_some());
        let value = |drift: &CaseDrift| get(drift).unwrap_or(f64::INFINITY);
        Some((format!("{name}, {unit}"), Spread::of(&known.then(|| sample.column(value))?)?))
    };
    names.into_iter().filter_map(of).collect()
}

/// Collects radial errors at the marks that every navigating case reached.
fn marks(sample: &Sample<'_>) -> BTreeMap<String, Position> {
    let mut names: BTreeSet<String> = BTreeSet::new();
    sample.drifts().for_each(|drift| names.extend(drift.marks_nmi.into_keys()));
    let of = |name: &String| {
        let reached = sample.drifts().all(|drift| drift.marks_nmi.contains_key(name));
        let value = |drift: &CaseDrift| drift.marks_nmi.get(name).copied().unwrap_or(f64::INFINITY);
        Some((name.clone(), Position::of(&reached.then(|| sample.column(value))?)?))
    };
    names.iter().filter_map(of).collect()
}

impl FactorFigures {
    /// Correlates a factor; `None` if it isn't numeric.
    fn of(name: &str, sample: &Sample<'_>) -> Option<Self> {
        let (mut values, mut rates) = (Vec::new(), Vec::new());
        for (case, drift) in sample.cases() {
            let Some(value) = case.factors.get(name) else { continue };
            let number = number_of(value)?;
            if takes_part(case, name) {
                values.push(number);
                rates.push(drift.map_or(f64::INFINITY, |drift| drift.rate_nmi_per_h));
            }
        }
        Some(Self {
            factor: name.to_owned(),
            cases: values.len(),
            correlation: spearman(&values, &rates),
            stands_out: false,
        })
    }
}

/// Marks significant correlations, with all correlations considered.
pub(super) fn mark(all: &mut [CombinationFigures]) {
    let looked_at: usize = (all.iter().flat_map(|figures| &figures.sensitivity))
        .filter(|factor| factor.correlation.is_some())
        .count();
    for factor in all.iter_mut().flat_map(|figures| &mut figures.sensitivity) {
        factor.stands_out = factor.correlation.is_some_and(|c| c.stands_out(0.05, looked_at));
    }
}

impl ScenarioFigures {
    pub(super) fn of(
        scenario: &str,
        grid: &[String],
        combinations: &[Combination],
        rows: &ReportRows<'_>,
    ) -> Self {
        let mine: Vec<&Combination> =
            combinations.iter().filter(|combination| combination.scenario == scenario).collect();
        let sample = Sample::of(rows, mine.iter().flat_map(|c| &c.cases).copied());
        let at = |p: f64, f: fn(&CaseDrift) -> f64| percentile(&sample.column(f), p);
        let of_grid = |factor: &String| {
            let found = FactorFigures::of(factor, &sample)?;
            let rho = found.correlation?.rho;
            Some(GridFigures { factor: factor.clone(), cases: found.cases, rho })
        };
        Self {
            scenario: scenario.to_owned(),
            combinations: mine.len(),
            navigated: sample.navigated(),
            beyond: sample.beyond(),
            cep50_nmi: at(0.5, |drift| drift.final_nmi),
            r95_nmi: at(0.95, |drift| drift.final_nmi),
            rate50_nmi_per_h: at(0.5, |drift| drift.rate_nmi_per_h),
            rate95_nmi_per_h: at(0.95, |drift| drift.rate_nmi_per_h),
            time_rms_nmi: at(0.5, |drift| drift.rms_nmi),
            grid: grid.iter().filter_map(of_grid).collect(),
        }
    }
}

/// Lists cases that stand out from their combination, the farthest first.
pub(super) fn standing_out(
    combinations: &[Combination],
    rows: &ReportRows<'_>,
) -> Vec<OutlierFigures> {
    let mut found = Vec::new();
    for (place, combination) in combinations.iter().enumerate() {
        let navigated = combination.cases.iter().copied().filter(|case| rows.has_drift(*case));
        let there = Sample::of(rows, navigated);
        for (measure, of) in OUTLYING {
            let values: Vec<f64> = there.drifts().map(|drift| of(&drift)).collect();
            let median = percentile(&values, 0.5).unwrap_or(f64::NAN);
            found.extend(outliers(&values, OutlierScale::Logarithm, LIMIT).into_iter().filter_map(
                |o| {
                    Some(OutlierFigures {
                        case: rows.case(*there.places.get(o.index)?)?.id.to_string(),
                        combination: place,
                        measure,
                        value: *values.get(o.index)?,
                        median,
                        score: o.score,
                    })
                },
            ));
        }
    }
    found.sort_by(|a, b| b.score.abs().total_cmp(&a.score.abs()).then(a.case.cmp(&b.case)));
    found
}

/// Returns the combinations of a plan with the names of the factors that span them.
pub(super) fn combinations(plan: &Plan, end: usize) -> (Vec<Combination>, Vec<String>) {
    (combination::of(plan, end), combination::of_grid(plan))
}
