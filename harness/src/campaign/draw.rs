//! What is drawn for the replicates of a campaign.

use super::file::{Campaign, Design, Distribution, Levels};
use super::plan::At;
use octant_random::normal::{uniform, words};
use octant_random::stream::{Phase, key};
use statrs::distribution::{ContinuousCDF, Normal};

/// What is drawn, by factor and replicate. A draw depends on the campaign's seed, the factor's name and
/// the replicate alone: more of any leaves those that there are.
#[derive(Clone, Debug)]
pub(super) struct Draws {
    by_factor: Vec<Vec<At>>,
}

impl Draws {
    pub(super) fn at(&self, factor: usize, replicate: u32) -> At {
        let draws = self.by_factor.get(factor);
        draws.and_then(|all| all.get(replicate as usize)).copied().unwrap_or(At::Level(0))
    }
}

/// What a campaign draws.
///
/// # Errors
/// In words, if its design can't be made.
pub(super) fn draws(campaign: &Campaign) -> Result<Draws, String> {
    if campaign.design == Design::LatinHypercube {
        return Err("design \"latin-hypercube\" is not part of this version".to_owned());
    }
    if !campaign.correlations.is_empty() {
        return Err("correlations are not part of this version".to_owned());
    }
    let of = |name: &str, levels: &Levels| {
        let key = key(campaign.seed, &format!("campaign {name}"), Phase::Draw);
        (0..campaign.replicates)
            .map(|replicate| at(levels, uniform(words(key, u64::from(replicate))[0])))
            .collect()
    };
    let by_factor =
        campaign.factors.iter().map(|factor| of(&factor.name, &factor.levels)).collect();
    Ok(Draws { by_factor })
}

/// The level, or the number, at a probability.
fn at(levels: &Levels, probability: f64) -> At {
    let one_of = |count: usize| At::Level(((probability * count as f64) as usize).min(count - 1));
    match levels {
        Levels::Values { values, .. } => one_of(values.len()),
        Levels::Faults { lists, .. } => one_of(lists.len()),
        Levels::Distributed { distribution, .. } => At::Number(quantile(distribution, probability)),
    }
}

fn quantile(distribution: &Distribution, probability: f64) -> f64 {
    match *distribution {
        Distribution::Uniform { low, high } => low + probability * (high - low),
        Distribution::Normal { mean, sigma, low, high } => {
            let Ok(normal) = Normal::new(mean, sigma) else { return mean };
            let (from, to) = (normal.cdf(low), normal.cdf(high));
            normal.inverse_cdf(from + probability * (to - from)).clamp(low, high)
        }
    }
}
