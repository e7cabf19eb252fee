//! Draws of the factors of many runs: Monte Carlo and Latin hypercubes, with correlations.
//!
//! Draws come from the named, counter-based streams of `octant-random`. Draw i of a factor depends on
//! the seed, the factor's name and i, in a Latin hypercube also on the number of runs, and on nothing
//! else: adding a factor, or runs to a Monte Carlo, changes no other draw. Correlated factors also
//! depend on each other.

mod correlation;
mod distribution;
mod error;

pub use correlation::{Correlations, FactorCorrelation};
pub use distribution::{Distribution, DrawnFactor, Factor};
pub use error::DrawError;

use crate::sample::ranks;
use octant_random::normal::{uniform, words};
use octant_random::stream::{Phase, key};

/// Name of a factor's stream, which no model uses.
fn stream(name: &str) -> String {
    format!("factor {name}")
}

/// Word `word` of draw `i` of a factor, as a number in (0, 1).
pub(crate) fn unit(seed: u64, name: &str, i: u64, word: usize) -> f64 {
    uniform(words(key(seed, &stream(name), Phase::Draw), i)[word])
}

/// Draw `i` of every factor, in the order of the factors.
///
/// # Errors
/// If a factor or a correlation is invalid.
pub fn monte_carlo(
    factors: &[Factor],
    correlations: &[FactorCorrelation],
    seed: u64,
    i: u64,
) -> Result<Vec<DrawnFactor>, DrawError> {
    check(factors)?;
    let correlations = Correlations::new(factors, correlations)?;
    let mut units: Vec<f64> = factors.iter().map(|f| unit(seed, &f.name, i, 0)).collect();
    correlations.apply(&mut units);
    factors.iter().zip(&units).map(|(factor, u)| factor.at(*u)).collect()
}

/// Latin hypercube of `runs` runs (McKay, Beckman and Conover, Technometrics 21, 1979): every factor
/// has one draw in each of `runs` parts of equal probability, at a random place in its part.
/// Correlations are made by rearranging the draws (Iman and Conover, Communications in Statistics B 11,
/// 1982), which keeps the parts of every factor.
///
/// # Errors
/// If a factor or a correlation is invalid, or there are too few runs to correlate them.
pub fn latin_hypercube(
    factors: &[Factor],
    correlations: &[FactorCorrelation],
    seed: u64,
    runs: usize,
) -> Result<Vec<Vec<DrawnFactor>>, DrawError> {
    check(factors)?;
    let correlations = Correlations::new(factors, correlations)?;
    if runs == 0 {
        return Err(DrawError::Runs { found: 0, expected: 1 });
    }
    let mut columns: Vec<Vec<f64>> = factors.iter().map(|f| column(seed, &f.name, runs)).collect();
    correlations.rearrange(&mut columns)?;
    (0..runs)
        .map(|i| factors.iter().zip(&columns).map(|(f, column)| f.at(column[i])).collect())
        .collect()
}

/// Probabilities of one factor in a Latin hypercube: the part of a run is the rank of its first random
/// number among all, and its place in the part is a second random number.
fn column(seed: u64, name: &str, runs: usize) -> Vec<f64> {
    let key = key(seed, &format!("hypercube of {runs}: {name}"), Phase::Draw);
    let words: Vec<[u64; 4]> = (0..runs as u64).map(|i| words(key, i)).collect();
    let order: Vec<f64> = words.iter().map(|w| uniform(w[0])).collect();
    let ranks = ranks(&order);
    let place =
        |(rank, w): (&f64, &[u64; 4])| (libm::floor(rank - 1.0) + uniform(w[1])) / runs as f64;
    ranks.iter().zip(&words).map(place).collect()
}

fn check(factors: &[Factor]) -> Result<(), DrawError> {
    for (index, factor) in factors.iter().enumerate() {
        factor.check()?;
        if factors[..index].iter().any(|other| other.name == factor.name) {
            return Err(DrawError::Duplicate(factor.name.clone()));
        }
    }
    Ok(())
}
