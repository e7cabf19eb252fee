//! Comparison of two methods on the same instruments with the same noise: `octant compare`.

pub use super::claim::{CLAIM, Claim, interval, percent};
use super::floor::MaximumFloor;
pub use super::maxima::{Maxima, Measure};
use octant_statistics::convergence::pass;
use octant_statistics::paired::{Improvement, PassPairs, improvement};
use octant_statistics::power;
use octant_statistics::sample::{ConfidenceInterval, rms};
use serde::{Deserialize, Serialize};

/// Version of the schema of `compare.json`.
pub const SCHEMA: u32 = 1;

/// Confidence of the intervals of improvements, two-sided.
pub const CONFIDENCE: f64 = 0.9;
/// Confidence of the intervals of rates of refusals, two-sided.
pub const REFUSALS_CONFIDENCE: f64 = 0.95;

/// Both methods with one seed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PairedRun {
    /// The seed.
    pub seed: u64,
    /// Maxima of the first method, the one to be improved on.
    pub first: Maxima,
    /// Maxima of the second method.
    pub second: Maxima,
    /// Reason for which the first method refused its calibration; null: it didn't.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_refused: Option<String>,
    /// Reason for which the second method refused its calibration; null: it didn't.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub second_refused: Option<String>,
}

/// Numbers of refused calibrations of each method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Refusals {
    /// Number of seeds.
    pub seeds: u64,
    /// Number of seeds that the first method refused.
    pub first: u64,
    /// Number of seeds that the second method refused.
    pub second: u64,
    /// Number of seeds that both refused.
    pub both: u64,
    /// Rate of the first method, with its 95 % interval (Clopper and Pearson).
    pub first_rate: ConfidenceInterval,
    /// Rate of the second method, likewise.
    pub second_rate: ConfidenceInterval,
    /// Two-sided probability of a difference at least as large, if both refuse equally often (McNemar).
    pub p: f64,
    /// Smallest fraction of seeds refused by only one of the methods that this test detects at 5 % with
    /// a probability of 90 %; null: so few seeds detect none.
    pub detectable: Option<f64>,
}

impl Refusals {
    /// Counts the refusals of runs; `None` if no seed was refused.
    #[must_use]
    pub fn of(runs: &[PairedRun]) -> Option<Self> {
        let published = |of: fn(&PairedRun) -> bool| runs.iter().map(of).collect::<Vec<bool>>();
        let first = published(|run| run.first_refused.is_none());
        let second = published(|run| run.second_refused.is_none());
        let pairs = PassPairs::of(&first, &second)?;
        let refused = |published: &[bool]| published.iter().filter(|p| !**p).count() as u64;
        let rate = |published: &[bool]| {
            let refused: Vec<bool> = published.iter().map(|p| !p).collect();
            pass(&refused, REFUSALS_CONFIDENCE)
        };
        (pairs.both < runs.len() as u64).then_some(())?;
        Some(Self {
            seeds: runs.len() as u64,
            first: refused(&first),
            second: refused(&second),
            both: pairs.neither,
            first_rate: rate(&first)?,
            second_rate: rate(&second)?,
            p: pairs.mcnemar(),
            detectable: power::turning(runs.len() as u64, 0.05, power::POWER),
        })
    }

    fn words(&self, names: [&str; 2]) -> Vec<String> {
        let one = |name: &str, count: u64, rate: &ConfidenceInterval| {
            format!(
                "{name} refused {count} of {} seeds ({} %, 95 % interval [{} %, {} %])",
                self.seeds,
                percent(rate.value),
                percent(rate.low),
                percent(rate.high)
            )
        };
        let [first, second] = names;
        let either = self.first + self.second - self.both;
        let mut words = vec![format!(
            "{}, {}: McNemar's p = {}{}",
            one(first, self.first, &self.first_rate),
            one(second, self.second, &self.second_rate),
            octant_base::number::significant(self.p, 2),
            match self.detectable {
                Some(part) => format!(
                    "; so many seeds find with 90 % that one method refuses {} % more of them",
                    percent(part)
                ),
                None => "; so few seeds find no difference of the rates".to_owned(),
            }
        )];
        words.push(format!(
            "a refused seed is beyond every number, so that over all {} seeds the root mean square of a \
             method that refused one is not defined; errors are compared of the {} seeds that neither \
             refused: how the methods compare where both publish, which says nothing of the others",
            self.seeds,
            self.seeds - either
        ));
        words
    }
}

/// One measure over all seeds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeasureCell {
    /// Measure.
    pub measure: Measure,
    /// Number of pairs that have it.
    pub runs: u32,
    /// Root mean square over seeds of the first method, arcmin or m/s.
    pub first: f64,
    /// Root mean square over seeds of the second method, in the same unit.
    pub second: f64,
    /// Improvement 1 − second/first with its 90 % interval, and the smallest that so many pairs detect
    /// with a probability of 90 %.
    pub improvement: Improvement,
    /// Root mean square from the random walk alone, with exact parameters and attitude, in the same
    /// unit; null for attitude and velocity if the navigations of the methods differ in length.
    pub floor: Option<f64>,
    /// Verdict on the claim.
    pub claim: Claim,
}

/// Comparison of two methods.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MethodComparison {
    /// Version of the schema: [`SCHEMA`].
    pub schema: u32,
    /// Version of the program.
    pub octant: String,
    /// Name of the scenario.
    pub scenario: String,
    /// Name of the first method.
    pub first: String,
    /// Name of the second method.
    pub second: String,
    /// Refusals of the methods; null if there were none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refusals: Option<Refusals>,
    /// Every measure that at least two pairs have.
    pub cells: Vec<MeasureCell>,
    /// Verdict on the claim in plain words, then the reasons.
    pub words: Vec<String>,
    /// Every pair of runs.
    pub runs: Vec<PairedRun>,
}

/// Compares paired runs.
///
/// `floor` has the maxima of the random walk alone for 24 h, 72 h and the length of the navigation, from
/// [`super::floor::Floor::maxima`]. `navigation_h` is the length of the navigation, h, if it is the same
/// for both methods.
#[must_use]
pub fn compare(
    scenario: &str,
    first: &str,
    second: &str,
    runs: &[PairedRun],
    floor: &[MaximumFloor],
    navigation_h: Option<f64>,
) -> MethodComparison {
    let floor_of = |measure: Measure| {
        let hours = measure.hours().or(navigation_h)?;
        measure.floor(floor.iter().find(|floor| floor.hours == hours)?)
    };
    let cells: Vec<MeasureCell> = Measure::ALL
        .into_iter()
        .filter_map(|measure| cell(measure, runs, floor_of(measure)))
        .collect();
    let refusals = Refusals::of(runs);
    MethodComparison {
        schema: SCHEMA,
        octant: env!("CARGO_PKG_VERSION").to_owned(),
        scenario: scenario.to_owned(),
        first: first.to_owned(),
        second: second.to_owned(),
        words: words(first, second, runs.len(), &cells, refusals.as_ref()),
        refusals,
        cells,
        runs: runs.to_vec(),
    }
}

fn cell(measure: Measure, runs: &[PairedRun], floor: Option<f64>) -> Option<MeasureCell> {
    let pairs: Vec<(f64, f64)> =
        runs.iter().filter_map(|r| r.first.get(measure).zip(r.second.get(measure))).collect();
    let (first, second): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
    let improvement = improvement(&first, &second, CONFIDENCE)?;
    Some(MeasureCell {
        measure,
        runs: first.len() as u32,
        first: rms(&first)?,
        second: rms(&second)?,
        improvement,
        floor,
        claim: Claim::of(&improvement),
    })
}

/// Text of the verdict and its reasons.
fn words(
    first: &str,
    second: &str,
    seeds: usize,
    cells: &[MeasureCell],
    refusals: Option<&Refusals>,
) -> Vec<String> {
    let told = refusals.map(|refusals| refusals.words([first, second])).unwrap_or_default();
    // A g-dependent bias changes the longitude at the latest mark most.
    let of_position = |cell: &&MeasureCell| cell.measure.hours().is_some();
    let main = cells.iter().rfind(|c| c.measure.is_longitude());
    let main = main.or_else(|| cells.iter().rfind(of_position)).or_else(|| cells.last());
    let Some(main) = main else {
        let nothing = format!(
            "nothing to compare: {seeds} pairs of runs, and at least 2 with 24 h of navigation are needed"
        );
        return std::iter::once(nothing).chain(told).collect();
    };
    let (measure, range) = (main.measure.name(), interval(&main.improvement));
    let value = main.improvement.value;
    let found = format!(
        "the largest error in {measure} is {} % {} with {second} than with {first}, 90 % interval \
         of the improvement {range}, {} pairs",
        percent(value.abs()),
        if value < 0.0 { "larger" } else { "smaller" },
        main.runs
    );
    let mut words = vec![match main.claim {
        Claim::Holds => format!("the claim (more than 50 % better) holds: {found}"),
        Claim::Likely => format!(
            "the claim (more than 50 % better) is likely and not shown: {found}; the interval \
             reaches below 50 %, and more seeds would tell"
        ),
        Claim::Better => format!(
            "better, and whether by more than 50 % is open: {found}; the interval reaches above \
             50 %, and more seeds would tell"
        ),
        Claim::BetterByLess => format!("better, and by less than 50 %: {found}"),
        Claim::NotShown => format!(
            "no claim{}: the interval of improvement of {measure}, {range}, includes 0",
            if near_floor(main) { ": the random walk hides it" } else { "" }
        ),
        Claim::Worse => format!("{second} is worse than {first}: {found}"),
    }];
    if let Some(floor) = main.floor {
        words.push(format!(
            "the noise of the sensors alone, with every parameter and the attitude exact, gives \
             {floor:.3} {}; {second} has {:.3} and {first} {:.3}",
            main.measure.unit(),
            main.second,
            main.first
        ));
        // Even a method without any error of its own would have the floor.
        let best = 1.0 - floor / main.first;
        if best < CLAIM {
            words.push(format!(
                "no method could improve on {first} by more than about {} % here: g-dependent bias times \
                 calibration time is too small against the random walk",
                percent(best.max(0.0))
            ));
        }
    }
    words.extend(told);
    if let Some(detectable) = main.improvement.detectable.filter(|part| part.is_finite()) {
        words.push(format!(
            "{} pairs that scatter like these show an improvement of {measure} of {} % or more with a \
             probability of 90 %",
            main.runs,
            percent(detectable)
        ));
    }
    if main.runs < 20 {
        words.push(format!(
            "{} seeds leave a sampling error of 20 to 25 % and more in each number",
            main.runs
        ));
    }
    words
}

/// True if the second method is within a factor of 2 of the random walk.
fn near_floor(cell: &MeasureCell) -> bool {
    cell.floor.is_some_and(|floor| cell.second < 2.0 * floor)
}
