//! Claims on a pass probability from data that is looked at while it grows.
//!
//! A bound for a fixed number of draws holds if the data is looked at once. Where a campaign may end, or be called shown,
//! at one of several looks, each look is another chance of a false claim. Two ways keep the confidence:
//!
//! - [`LookBoundary`]: K looks at numbers of draws that are fixed before. The error spent up to look k is at most
//!   α n_k / n_K (Lan and DeMets, Biometrika 70, 1983, with the linear function), and the numbers of failures that a
//!   look allows are the largest ones for which the exact probability of any false claim so far is within it. The
//!   recursion over the binomial increments is that of Armitage, McPherson and Rowe (J. R. Stat. Soc. A 132, 1969).
//! - [`open_lower_bound`]: any number of looks, at any time. The likelihood ratio against p, averaged over all greater
//!   probabilities (uniformly: the mixture of Robbins, Ann. Math. Stat. 41, 1970), is a supermartingale if the true
//!   probability is p or less, and by Ville's inequality it reaches 1/α at any time with a probability of at most α.
//!
//! Both errors, of a false "kept" and of a false "broken", are each at most α, as with a bound at a fixed number.

use super::proportion::{Demand, Needed, further};
use statrs::distribution::{Binomial, Discrete};
use statrs::function::beta::{beta_reg, ln_beta};

/// Probability below which the ends of a distribution of failures are left out of the recursion; it is added to the
/// error that is spent.
const TAIL: f64 = 1e-18;

/// Number of draws of a look, and what it allows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundaryLook {
    /// Draws up to this look.
    pub draws: u64,
    /// Largest number of draws that didn't pass with which the requirement is kept; `None`: it can't be shown here.
    pub kept_at_most: Option<u64>,
    /// Least number of draws that failed with which the requirement is broken; `None`: it can't be shown here.
    pub broken_from: Option<u64>,
    /// Probability of a false "kept" at this look or before, if draws pass exactly as often as required.
    pub kept_error: f64,
    /// Probability of a false "broken" at this look or before, likewise.
    pub broken_error: f64,
}

/// Numbers of failures that decide at each of several looks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LookBoundary {
    /// The looks, in their order.
    pub looks: Vec<BoundaryLook>,
}

impl LookBoundary {
    /// Computes the boundary of a demand for looks after these numbers of draws, in ascending order; a number that
    /// isn't above the one before adds nothing.
    #[must_use]
    pub fn of(demand: Demand, draws: &[u64]) -> Self {
        let allowed = 1.0 - demand.confidence;
        let all = draws.last().copied().unwrap_or(0).max(1) as f64;
        let (mut kept, mut broken) = (Undecided::new(), Undecided::new());
        let mut before = 0;
        let looks = draws.iter().map(|at| {
            let further = at.saturating_sub(before);
            before = before.max(*at);
            kept.grow(further, 1.0 - demand.pass);
            broken.grow(further, 1.0 - demand.pass);
            let spent = allowed * (*at as f64 / all).min(1.0);
            let (kept_at_most, broken_from) = (kept.take_few(spent), broken.take_many(spent));
            let (kept_error, broken_error) = (kept.spent, broken.spent);
            BoundaryLook { draws: *at, kept_at_most, broken_from, kept_error, broken_error }
        });
        Self { looks: looks.collect() }
    }

    /// Returns the numbers of draws of `looks` equal looks at `draws` draws.
    #[must_use]
    pub fn equal(draws: u64, looks: u32) -> Vec<u64> {
        let looks = u64::from(looks.max(1));
        (1..=looks).map(|look| (draws * look).div_ceil(looks)).collect()
    }
}

/// Distribution of the number of failures on the paths that no look has ended.
struct Undecided {
    /// Failures of the first probability.
    from: u64,
    probabilities: Vec<f64>,
    /// Probability of all paths that a look has ended, and of the ends that were left out.
    spent: f64,
}

impl Undecided {
    fn new() -> Self {
        Self { from: 0, probabilities: vec![1.0], spent: 0.0 }
    }

    /// Adds draws that fail with this probability.
    fn grow(&mut self, draws: u64, fails: f64) {
        let Ok(binomial) = Binomial::new(fails, draws) else { return };
        let sigma = (draws as f64 * fails * (1.0 - fails)).sqrt();
        let (mean, reach) = (draws as f64 * fails, 12.0 * sigma + 60.0);
        // Saturating conversions: the ends are within 0 and the number of draws.
        let low = (mean - reach).max(0.0) as u64;
        let high = ((mean + reach) as u64).min(draws);
        let steps: Vec<f64> = (low..=high).map(|failures| binomial.pmf(failures)).collect();
        let mut grown = vec![0.0; self.probabilities.len() + steps.len() - 1];
        for (place, before) in self.probabilities.iter().enumerate() {
            for (sum, step) in grown[place..].iter_mut().zip(&steps) {
                *sum += before * step;
            }
        }
        self.from += low;
        self.probabilities = grown;
        self.trim();
    }

    /// Leaves out ends that count for nothing, and counts them as spent.
    fn trim(&mut self) {
        let left = self.probabilities.iter().take_while(|p| **p < TAIL).count();
        let right = self.probabilities.iter().rev().take_while(|p| **p < TAIL).count();
        let end = self.probabilities.len() - right;
        if left >= end {
            return;
        }
        let kept = self.probabilities[left..end].to_vec();
        let all: f64 = self.probabilities.iter().sum();
        self.spent += (all - kept.iter().sum::<f64>()).max(0.0);
        self.from += left as u64;
        self.probabilities = kept;
    }

    /// Ends the paths with the fewest failures, as many as the error allows; returns their largest number of failures.
    fn take_few(&mut self, allowed: f64) -> Option<u64> {
        let (count, sum) = within(self.probabilities.iter(), allowed - self.spent);
        self.spent += sum;
        self.probabilities.drain(..count);
        let last = (self.from + count as u64).checked_sub(1);
        self.from += count as u64;
        last.filter(|_| count > 0)
    }

    /// Ends the paths with the most failures, as many as the error allows; returns their least number of failures.
    fn take_many(&mut self, allowed: f64) -> Option<u64> {
        let (count, sum) = within(self.probabilities.iter().rev(), allowed - self.spent);
        self.spent += sum;
        let left = self.probabilities.len() - count;
        self.probabilities.truncate(left);
        (count > 0).then_some(self.from + left as u64)
    }
}

/// Counts the first probabilities whose sum is within an error, but never all of them, and returns the sum.
fn within<'a>(probabilities: impl ExactSizeIterator<Item = &'a f64>, allowed: f64) -> (usize, f64) {
    let most = probabilities.len().saturating_sub(1);
    let (mut count, mut sum) = (0, 0.0);
    for probability in probabilities.take(most) {
        if sum + probability > allowed {
            break;
        }
        sum += probability;
        count += 1;
    }
    (count, sum)
}

/// Logarithm of the likelihood of all greater probabilities, averaged, over that of `p`.
fn ln_ratio_above(p: f64, failures: u64, runs: u64) -> f64 {
    let (s, f) = ((runs - failures) as f64, failures as f64);
    let above = beta_reg(f + 1.0, s + 1.0, 1.0 - p).max(f64::MIN_POSITIVE);
    ln_beta(s + 1.0, f + 1.0) + above.ln() - s * p.ln() - (f + 1.0) * (-p).ln_1p()
}

/// Lower bound of the probability of success that holds however often and whenever it is looked at: with probability
/// `confidence` it is never above the true one (a one-sided confidence sequence).
#[must_use]
pub fn open_lower_bound(failures: u64, runs: u64, confidence: f64) -> f64 {
    let successes = runs.saturating_sub(failures);
    if successes == 0 || !(0.5..1.0).contains(&confidence) {
        return 0.0;
    }
    let failures = runs - successes;
    // The ratio falls with p up to here, where it is below 2: a confidence of 50 % is reached before.
    let (mut low, mut high) = (0.0, successes as f64 / (runs as f64 + 1.0));
    let needed = -(1.0 - confidence).ln();
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if middle > 0.0 && ln_ratio_above(middle, failures, runs) >= needed {
            low = middle;
        } else {
            high = middle;
        }
        if high - low <= f64::EPSILON * high {
            break;
        }
    }
    low
}

/// Upper bound of the probability of success that holds at any time, as [`open_lower_bound`].
#[must_use]
pub fn open_upper_bound(failures: u64, runs: u64, confidence: f64) -> f64 {
    1.0 - open_lower_bound(runs.saturating_sub(failures), runs, confidence)
}

/// Number of further draws with which a demand is shown if all of them pass, looked at openly.
#[must_use]
pub fn open_further_if_all_pass(demand: Demand, failures: u64, runs: u64) -> Needed {
    if failures > runs {
        return Needed::CannotBeMet;
    }
    further(runs, |n| open_lower_bound(failures, n, demand.confidence) >= demand.pass)
}
