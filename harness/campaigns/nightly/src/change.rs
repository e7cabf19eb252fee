//! Changes of a measure between two nights, tested over their pairs of cases.

use octant_statistics::paired::difference;
use octant_statistics::sample::rms;
use serde::Serialize;

/// Thresholds of a change.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Thresholds {
    /// Probability of any false positive among all tests.
    pub alpha: f64,
    /// Smallest change of the mean that counts, as a fraction of the baseline's root mean square.
    pub least: f64,
}

impl Default for Thresholds {
    fn default() -> Self {
        Self { alpha: 0.05, least: 0.01 }
    }
}

/// Change of a measure or of passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Change {
    /// Worse, shown by the test.
    Worse,
    /// Better, shown by the test.
    Better,
    /// Different, but not significantly, or by too little to count.
    Changed,
    /// Every pair is the same, to the last bit.
    Same,
}

impl Change {
    /// Returns the name.
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

/// Measure, or passes of a requirement, for a scenario of a campaign in both nights.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tested {
    /// The campaign.
    pub campaign: String,
    /// The scenario.
    pub scenario: String,
    /// Path of the measure, `margin of ID`, or `passes of ID`.
    pub measure: String,
    /// Number of tested pairs: those that have the measure in at least one of the nights.
    pub pairs: usize,
    /// Number of pairs that have it in the baseline only: a calibration that is refused now is
    /// beyond every number.
    pub lost: usize,
    /// Number of pairs that have it in this night only.
    pub gained: usize,
    /// Mean in the baseline; for passes, their fraction.
    pub baseline: f64,
    /// Mean in this night.
    pub tonight: f64,
    /// Mean difference of the pairs that have it in both, with its 95 % interval by Student's
    /// distribution; null with less than two such pairs.
    pub difference: Option<[f64; 3]>,
    /// Probability by the test alone.
    pub p: f64,
    /// Probability, adjusted for all tests of the night.
    pub p_adjusted: f64,
    /// Change that the test shows.
    pub change: Change,
    /// Smallest change that this number of pairs detects with 90 % among all tests of the night: of
    /// the mean, in its unit; for passes, the fraction of pairs that turn. Null if there are too
    /// few pairs.
    pub detectable: Option<f64>,
    /// Smallest detectable change of a mean, in standard deviations of the pairs' differences.
    pub detectable_sigma: Option<f64>,
    /// Factor from a shift in standard deviations to the unit, and the smallest change that counts.
    #[serde(skip)]
    pub(super) scale: Option<[f64; 2]>,
}

/// Tests pairs of numbers. `sense` is 1 if less is better, −1 if more is. Holm's correction follows
/// when all tests are known.
pub fn tested(
    values: &[(Option<f64>, Option<f64>)],
    sense: f64,
    limits: Thresholds,
) -> Option<Tested> {
    // A measure that only one night has is as bad as possible in the other.
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
            // A mean with more values beyond every number is worse than any with fewer.
            let (more, counts) = match lost.cmp(&gained) {
                std::cmp::Ordering::Greater => (sense > 0.0, true),
                std::cmp::Ordering::Less => (sense < 0.0, true),
                std::cmp::Ordering::Equal => (moved > 0.0, moved.abs() >= least),
            };
            // A mean that a few pairs determine against all others shows no direction.
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
