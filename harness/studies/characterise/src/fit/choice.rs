//! Choice of the terms that a record shows.

use super::scoring::{Model, Rows};
use super::uncertainty::Uncertainty;
use crate::freedom::Covariances;
use crate::kernel::TERMS;
use std::rc::Rc;

/// Index of the Gauss-Markov term.
pub(super) const GAUSS_MARKOV: usize = TERMS - 1;
/// Rise of the deviance, as χ², below which a term leaves the model.
pub(super) const LEAVES: f64 = 6.634_896_601_021_214;

/// Terms that are taken for those of the record, and others that it doesn't exclude.
pub(super) struct Choice {
    pub(super) chosen: Chosen,
    /// Terms with the Gauss-Markov one, where it isn't shown but nearly.
    pub(super) rival: Option<Rival>,
}

/// Terms that describe the record too.
pub(super) struct Rival {
    pub(super) chosen: Chosen,
    pub(super) covariances: Rc<Covariances>,
}

/// Terms that a record shows.
pub(super) struct Chosen {
    pub(super) free: Vec<usize>,
    pub(super) model: Model,
}

impl Chosen {
    /// True for a term that is in the model with a value.
    pub(super) fn shows(&self, index: usize) -> bool {
        self.free.contains(&index) && self.model.squares[index] > 0.0
    }
}

/// Fits some terms, then leaves out those that the deviance doesn't need, but one.
pub(super) fn reduce(
    rows: &Rows,
    covariances: &Covariances,
    terms: &[usize],
    time_s: f64,
    kept: Option<usize>,
) -> Option<Chosen> {
    let mut free = terms.to_vec();
    let mut model = rows.fit_time(&free, None, time_s)?;
    while free.len() > 1 {
        let without = |index: usize| -> Option<(f64, Chosen)> {
            let rest: Vec<usize> = free.iter().copied().filter(|i| *i != index).collect();
            let found = rows.fit_time(&rest, None, model.time_s)?;
            let at = Model { time_s: model.time_s, ..found };
            let a = Uncertainty::of(rows, covariances, &at, &free).factor(index);
            Some(((found.deviance - model.deviance) / a, Chosen { free: rest, model: found }))
        };
        let may_leave = free.iter().filter(|index| Some(**index) != kept);
        let least =
            may_leave.filter_map(|index| without(*index)).min_by(|a, b| a.0.total_cmp(&b.0));
        match least {
            Some((rise, chosen)) if !(rise > LEAVES) => (free, model) = (chosen.free, chosen.model),
            _ => break,
        }
    }
    Some(Chosen { free, model })
}
