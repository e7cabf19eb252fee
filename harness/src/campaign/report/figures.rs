//! `statistics.json`: what the cases of a campaign show together, as numbers.
//!
//! The statistics themselves are those of [`octant_statistics`]. An end of an interval for which there are
//! too few cases is null.
//!
//! A case that ran and has no navigation, because its calibration was refused or it ended as an error, is in
//! every figure, beyond every number: percentiles are those of the full sample, and null where they fall on
//! such cases. What is left after leaving them out would be the drift of those that drift little. Cases of
//! the same stream count once.

use super::combination::{self, Combination, number_of, takes_part};
use super::rows::{Curve, Drift, Row};
use crate::campaign::plan::{Case, Plan};
use octant_statistics::convergence::{Step, convergence};
use octant_statistics::envelope::envelope;
use octant_statistics::outlier::{LIMIT, Scale, outliers};
use octant_statistics::quantile::interval;
use octant_statistics::rank::{Correlation, spearman};
use octant_statistics::rate::{RateBounds, rate_bounds};
use octant_statistics::sample::{Interval, percentile, rms};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Confidence of all intervals that nobody asked for with another one, two-sided.
pub const CONFIDENCE: f64 = 0.95;
/// Percentiles of the envelopes.
pub const PERCENTILES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];
/// What is correlated with the factors.
pub const DRIFT: &str = "navigation.radial_error_nmi.rate_per_h";

/// Radial position errors of many cases, nmi.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Position {
    /// Cases that have it.
    pub cases: usize,
    /// Median.
    pub cep50: Interval,
    /// 95th percentile.
    pub r95: Interval,
    /// √ of the mean of squares.
    pub drms: f64,
}

impl Position {
    fn of(radial_nmi: &[f64]) -> Option<Self> {
        Some(Self {
            cases: radial_nmi.len(),
            cep50: interval(radial_nmi, 0.5, CONFIDENCE)?,
            r95: interval(radial_nmi, 0.95, CONFIDENCE)?,
            drms: rms(radial_nmi)?,
        })
    }
}

/// Median and 95th percentile of a measure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Median.
    pub p50: Interval,
    /// 95th percentile.
    pub p95: Interval,
}

impl Spread {
    fn of(values: &[f64]) -> Option<Self> {
        Some(Self {
            p50: interval(values, 0.5, CONFIDENCE)?,
            p95: interval(values, 0.95, CONFIDENCE)?,
        })
    }
}

/// How the cases of one combination drift.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CombinationFigures {
    /// Scenario.
    pub scenario: String,
    /// Factors of the grid with their values.
    pub factors: BTreeMap<String, String>,
    /// Cases of the plan.
    pub cases: usize,
    /// Independent draws among those that ran: the figures are of them.
    pub draws: usize,
    /// Draws with a navigation.
    pub navigated: usize,
    /// Draws without one: refused or ended as errors, beyond every number.
    pub beyond: usize,
    /// Radial error at the end of the navigation; null where no case navigated, as everything below.
    pub at_end: Option<Position>,
    /// Radial error at marks that all of them reached.
    pub at_marks: BTreeMap<String, Position>,
    /// Largest radial error, nmi.
    pub largest_nmi: Option<Spread>,
    /// Radial error rate, nmi/h.
    pub rate_nmi_per_h: Option<RateBounds>,
    /// Time-RMS of the radial error, nmi.
    pub time_rms_nmi: Option<Spread>,
    /// Percentiles of the errors over time.
    pub envelope: Option<EnvelopeFigures>,
    /// How the median of the radial error at the end settles.
    pub convergence_cep50: Vec<Step>,
    /// How its 95th percentile settles.
    pub convergence_r95: Vec<Step>,
    /// How the drift goes with each factor that is drawn.
    pub sensitivity: Vec<FactorFigures>,
}

/// Percentiles of latitude and longitude error over time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EnvelopeFigures {
    /// Times, h.
    pub hours: Vec<f64>,
    /// Percentiles, 0 to 1.
    pub percentiles: Vec<f64>,
    /// Of latitude error, arcmin: a curve for each percentile.
    pub latitude_arcmin: Vec<Vec<f64>>,
    /// Of longitude error.
    pub longitude_arcmin: Vec<Vec<f64>>,
}

/// How the drift goes with a factor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FactorFigures {
    /// The factor.
    pub factor: String,
    /// Cases in which it has a part.
    pub cases: usize,
    /// Spearman's rank correlation with the radial error rate; null of fewer than three cases, or where
    /// one of them is constant.
    pub correlation: Option<Correlation>,
    /// Whether it is more than chance at 5 %, if all correlations of the campaign are looked at.
    pub stands_out: bool,
}

/// All cases of a scenario, whatever their combination. They aren't independent of each other, so there
/// are no bounds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScenarioFigures {
    /// Its name.
    pub scenario: String,
    /// Its combinations.
    pub combinations: usize,
    /// Cases with a navigation.
    pub navigated: usize,
    /// Cases that ran and have none: beyond every number.
    pub beyond: usize,
    /// Median of the radial error at the end, nmi.
    pub cep50_nmi: Option<f64>,
    /// Its 95th percentile.
    pub r95_nmi: Option<f64>,
    /// Median of the radial error rates, nmi/h.
    pub rate50_nmi_per_h: Option<f64>,
    /// Their 95th percentile.
    pub rate95_nmi_per_h: Option<f64>,
    /// Median of the time-RMS, nmi.
    pub time_rms_nmi: Option<f64>,
    /// Spearman's ρ of the drift with the factors of the grid that are numbers. No probability: the same
    /// instruments are in all values.
    pub grid: Vec<GridFigures>,
}

/// How the drift goes with a factor of the grid.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GridFigures {
    /// The factor.
    pub factor: String,
    /// Cases.
    pub cases: usize,
    /// Spearman's ρ with the radial error rate.
    pub rho: f64,
}

/// A case that stands out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OutlierFigures {
    /// The case.
    pub case: String,
    /// Its combination, as a place in the list of them.
    pub combination: usize,
    /// The measure.
    pub measure: &'static str,
    /// Its value.
    pub value: f64,
    /// Median of the combination.
    pub median: f64,
    /// Modified z-score of the logarithm; null: it isn't finite.
    pub score: f64,
}

/// The cases of a sample that ran, each with its drift; without one it is beyond every number.
struct Sample<'a> {
    cases: Vec<(&'a Case, Option<&'a Drift>)>,
}

impl<'a> Sample<'a> {
    /// Cases at these places, the first of each draw.
    fn of_draws(rows: &'a [Row<'_>], places: &[usize], draws: &[usize]) -> Self {
        let mut seen = BTreeSet::new();
        let is_new = |place: &&usize| draws.get(**place).is_none_or(|draw| seen.insert(*draw));
        let run = |place: &&usize| rows.get(**place).is_some_and(|row| row.outcome.is_some());
        Self::of(rows, places.iter().filter(run).filter(is_new).copied())
    }

    fn of(rows: &'a [Row<'_>], places: impl Iterator<Item = usize>) -> Self {
        let one = |place: usize| {
            let row = rows.get(place)?;
            Some((row.case, row.outcome.as_ref()?.drift.as_ref()))
        };
        Self { cases: places.filter_map(one).collect() }
    }

    fn navigated(&self) -> usize {
        self.cases.iter().filter(|(_, drift)| drift.is_some()).count()
    }

    fn beyond(&self) -> usize {
        self.cases.len() - self.navigated()
    }

    /// A measure of all cases; nothing where no case navigates.
    fn column(&self, of: impl Fn(&Drift) -> f64) -> Vec<f64> {
        if self.navigated() == 0 {
            return Vec::new();
        }
        self.cases.iter().map(|(_, drift)| drift.map_or(f64::INFINITY, &of)).collect()
    }
}

/// A measure of a drift.
type Measure = fn(&Drift) -> f64;

/// Measures of which outliers are looked for.
const OUTLYING: [(&str, Measure); 2] = [
    ("navigation.radial_error_nmi.max", |drift| drift.max_nmi),
    (DRIFT, |drift| drift.rate_nmi_per_h),
];

fn drift<'a>(rows: &'a [Row<'_>], case: usize) -> Option<&'a Drift> {
    rows.get(case)?.outcome.as_ref()?.drift.as_ref()
}

impl CombinationFigures {
    pub(super) fn of(
        plan: &Plan,
        grid: &[String],
        combination: &Combination,
        rows: &[Row<'_>],
        draws: &[usize],
    ) -> Self {
        let sample = Sample::of_draws(rows, &combination.cases, draws);
        let column = |f: fn(&Drift) -> f64| sample.column(f);
        let last = column(|drift| drift.final_nmi);
        let of_last = |p: f64| convergence(&last, |values| interval(values, p, CONFIDENCE));
        let curves: Vec<&Curve> =
            sample.cases.iter().filter_map(|(_, drift)| drift.as_ref()?.curve.as_ref()).collect();
        let values = |name: &String| {
            let cases = combination.cases.iter().filter_map(|case| plan.cases.get(*case));
            cases.filter_map(|case| case.factors.get(name)).collect::<Vec<_>>()
        };
        let is_number = |name: &String| values(name).into_iter().all(|v| number_of(v).is_some());
        let drawn = |name: &&String| !grid.contains(*name) && is_number(name);
        Self {
            scenario: combination.scenario.clone(),
            factors: combination.factors.iter().cloned().collect(),
            cases: combination.cases.len(),
            draws: sample.cases.len(),
            navigated: sample.navigated(),
            beyond: sample.beyond(),
            at_end: Position::of(&last),
            at_marks: marks(&sample),
            largest_nmi: Spread::of(&column(|drift| drift.max_nmi)),
            rate_nmi_per_h: rate_bounds(&column(|drift| drift.rate_nmi_per_h), CONFIDENCE),
            time_rms_nmi: Spread::of(&column(|drift| drift.rms_nmi)),
            envelope: EnvelopeFigures::of(&curves, sample.beyond()),
            convergence_cep50: of_last(0.5),
            convergence_r95: of_last(0.95),
            sensitivity: (plan.factors.iter().filter(drawn))
                .filter_map(|name| FactorFigures::of(name, &sample))
                .collect(),
        }
    }
}

/// Radial errors at the marks that every case reached which navigated.
fn marks(sample: &Sample<'_>) -> BTreeMap<String, Position> {
    let drifts = || sample.cases.iter().filter_map(|(_, drift)| *drift);
    let names: BTreeSet<&String> = drifts().flat_map(|drift| drift.marks_nmi.keys()).collect();
    let of = |name: &String| {
        let reached = drifts().all(|drift| drift.marks_nmi.contains_key(name));
        let value = |drift: &Drift| drift.marks_nmi.get(name).copied().unwrap_or(f64::INFINITY);
        Some((name.clone(), Position::of(&reached.then(|| sample.column(value))?)?))
    };
    names.into_iter().filter_map(of).collect()
}

impl EnvelopeFigures {
    /// Up to where the shortest navigation ends; none of navigations whose lengths are so different that
    /// their grids are.
    ///
    /// An error has a sign, and one beyond every number may have either: it counts as far below for the
    /// percentiles under the median and as far above for those over it. The median of such a sample isn't
    /// defined.
    fn of(curves: &[&Curve], beyond: usize) -> Option<Self> {
        let step_s = curves.first()?.step_s;
        if curves.iter().any(|curve| curve.step_s != step_s) {
            return None;
        }
        let points = curves.iter().map(|curve| curve.latitude_arcmin.len()).min()?;
        let of = |column: fn(&Curve) -> &[f64]| {
            let all: Vec<&[f64]> = curves.iter().filter_map(|c| column(c).get(..points)).collect();
            let with = |far: f64, percentiles: &[f64]| {
                let far = vec![far; points];
                let rest = std::iter::repeat_n(far.as_slice(), beyond);
                let all: Vec<&[f64]> = all.iter().copied().chain(rest).collect();
                envelope(&all, points, percentiles).ok()
            };
            let curve = |p: f64| match p.total_cmp(&0.5) {
                std::cmp::Ordering::Less => with(f64::NEG_INFINITY, &[p])?.curves.pop(),
                std::cmp::Ordering::Equal if beyond > 0 => Some(vec![f64::NAN; points]),
                _ => with(f64::INFINITY, &[p])?.curves.pop(),
            };
            PERCENTILES.into_iter().map(curve).collect::<Option<Vec<_>>>()
        };
        Some(Self {
            hours: (0..points).map(|k| k as f64 * step_s / 3600.0).collect(),
            percentiles: PERCENTILES.to_vec(),
            latitude_arcmin: of(|curve| &curve.latitude_arcmin)?,
            longitude_arcmin: of(|curve| &curve.longitude_arcmin)?,
        })
    }
}

impl FactorFigures {
    /// `None` of one that isn't a number.
    fn of(name: &str, sample: &Sample<'_>) -> Option<Self> {
        let (mut values, mut rates) = (Vec::new(), Vec::new());
        for (case, drift) in &sample.cases {
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

/// Marks what is more than chance, if all correlations are looked at.
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
        rows: &[Row<'_>],
    ) -> Self {
        let mine: Vec<&Combination> =
            combinations.iter().filter(|combination| combination.scenario == scenario).collect();
        let sample = Sample::of(rows, mine.iter().flat_map(|c| &c.cases).copied());
        let at = |p: f64, f: fn(&Drift) -> f64| percentile(&sample.column(f), p);
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

/// Cases that stand out from their combination, the farthest first.
pub(super) fn standing_out(combinations: &[Combination], rows: &[Row<'_>]) -> Vec<OutlierFigures> {
    let mut found = Vec::new();
    for (place, combination) in combinations.iter().enumerate() {
        let there: Vec<(&Case, &Drift)> = (combination.cases.iter())
            .filter_map(|case| Some((rows.get(*case)?.case, drift(rows, *case)?)))
            .collect();
        for (measure, of) in OUTLYING {
            let values: Vec<f64> = there.iter().map(|(_, drift)| of(drift)).collect();
            let median = percentile(&values, 0.5).unwrap_or(f64::NAN);
            found.extend(outliers(&values, Scale::Logarithm, LIMIT).into_iter().filter_map(|o| {
                Some(OutlierFigures {
                    case: there.get(o.index)?.0.id.clone(),
                    combination: place,
                    measure,
                    value: *values.get(o.index)?,
                    median,
                    score: o.score,
                })
            }));
        }
    }
    found.sort_by(|a, b| b.score.abs().total_cmp(&a.score.abs()).then(a.case.cmp(&b.case)));
    found
}

/// The combinations of a plan with the names of the factors that span them.
pub(super) fn combinations(plan: &Plan, end: usize) -> (Vec<Combination>, Vec<String>) {
    (combination::of(plan, end), combination::of_grid(plan))
}
