//! Draws of a campaign's replicates.

use octant_scenario::campaign::{Campaign, Design, DistributionSpec, Levels};
use octant_statistics::draw::{
    Distribution as Drawn, DrawnFactor, Factor, FactorCorrelation, latin_hypercube, monte_carlo,
};

/// Value of a factor in a case: one of its levels, or a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum At {
    /// Index of a level.
    Level(usize),
    /// Number that was drawn.
    Number(f64),
}

/// Draws by factor and replicate. A draw depends only on the campaign's seed, the factor's name and
/// the replicate, and in a Latin hypercube also on the number of replicates. So another factor never
/// changes existing draws, and neither do more replicates, except in a Latin hypercube.
#[derive(Clone, Debug)]
pub(crate) struct Draws {
    by_factor: Vec<Vec<At>>,
}

impl Draws {
    pub(crate) fn at(&self, factor: usize, replicate: u32) -> At {
        let draws = self.by_factor.get(factor);
        draws.and_then(|all| all.get(replicate as usize)).copied().unwrap_or(At::Level(0))
    }
}

/// Computes the draws of a campaign with a seed.
///
/// # Errors
/// The reason, as text, if its design can't be made.
pub(crate) fn draws(campaign: &Campaign, seed: u64) -> Result<Draws, String> {
    let drawn: Vec<(usize, Factor)> = (campaign.factors.iter().enumerate())
        .filter_map(|(index, factor)| Some((index, drawn(&factor.name, &factor.levels)?)))
        .collect();
    let factors: Vec<Factor> = drawn.iter().map(|(_, factor)| factor.clone()).collect();
    let name = |index: usize| campaign.factors[index].name.clone();
    let correlations: Vec<FactorCorrelation> = (campaign.correlations.iter())
        .map(|c| FactorCorrelation { first: name(c.first), second: name(c.second), value: c.value })
        .collect();
    let mut by_factor = vec![Vec::new(); campaign.factors.len()];
    let mut add = |row: &[DrawnFactor]| {
        for ((index, _), value) in drawn.iter().zip(row) {
            by_factor[*index].push(match value {
                DrawnFactor::Number(number) => At::Number(*number),
                DrawnFactor::Choice(level) => At::Level(*level),
            });
        }
    };
    match campaign.design {
        // One after another: there can be millions.
        Design::MonteCarlo => {
            for replicate in 0..u64::from(campaign.replicates) {
                let row = monte_carlo(&factors, &correlations, seed, replicate);
                add(&row.map_err(|error| error.to_string())?);
            }
        }
        Design::LatinHypercube => {
            let runs = campaign.replicates as usize;
            let rows = latin_hypercube(&factors, &correlations, seed, runs);
            rows.map_err(|error| error.to_string())?.iter().for_each(|row| add(row));
        }
    }
    Ok(Draws { by_factor })
}

/// Returns a factor's distribution; `None` for a factor of the grid.
fn drawn(name: &str, levels: &Levels) -> Option<Factor> {
    let one_of = |count: usize| Drawn::Choice { weights: vec![1.0; count] };
    let distribution = match levels {
        Levels::Values { drawn: false, .. } | Levels::Faults { drawn: false, .. } => return None,
        Levels::Values { values, .. } => one_of(values.len()),
        Levels::Faults { lists, .. } => one_of(lists.len()),
        Levels::Distributed { distribution: DistributionSpec::Uniform { low, high }, .. } => {
            Drawn::Uniform { low: *low, high: *high }
        }
        Levels::Distributed {
            distribution: DistributionSpec::Normal { mean, sigma, low, high },
            ..
        } => {
            let factor = Factor::new(name, Drawn::Normal { mean: *mean, sigma: *sigma });
            let within = |limit: f64| limit.is_finite().then_some(limit);
            return Some(Factor { low: within(*low), high: within(*high), ..factor });
        }
    };
    Some(Factor::new(name, distribution))
}
