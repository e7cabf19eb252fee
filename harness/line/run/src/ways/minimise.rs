//! The smallest set of faults that still breaks a run: delta debugging (Zeller and Hildebrandt,
//! "Simplifying and isolating failure-inducing input", IEEE TSE 28, 2002), on faults.
//!
//! The result is 1-minimal: without any one of its faults the run no longer fails in that way.
//! Everything is deterministic, and no set is run twice.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Result of a set of faults.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SetOutcome {
    /// The run still fails.
    Breaks,
    /// The run doesn't fail.
    Holds,
    /// The set can't be run: a fault waits for one that is not in the set.
    Impossible,
}

/// One step of the search.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SearchStep {
    /// Numbers of the faults in the set, from 0, in the order of the scenario.
    pub faults: Vec<usize>,
    /// Result of the run with this set.
    pub outcome: SetOutcome,
}

/// Shrinks the set of faults 0 to `count`. `test` runs a set. `None` if the whole set doesn't fail,
/// or the empty one does: then no fault is responsible.
///
/// # Errors
/// Errors of `test`.
pub fn minimise<E>(
    count: usize,
    mut test: impl FnMut(&[usize]) -> Result<SetOutcome, E>,
) -> Result<(Option<Vec<usize>>, Vec<SearchStep>), E> {
    let mut known: BTreeMap<Vec<usize>, SetOutcome> = BTreeMap::new();
    let mut trail = Vec::new();
    let mut breaks = |set: &[usize]| -> Result<bool, E> {
        if let Some(outcome) = known.get(set) {
            return Ok(*outcome == SetOutcome::Breaks);
        }
        let outcome = test(set)?;
        known.insert(set.to_vec(), outcome);
        trail.push(SearchStep { faults: set.to_vec(), outcome });
        Ok(outcome == SetOutcome::Breaks)
    };
    let mut set: Vec<usize> = (0..count).collect();
    if !breaks(&set)? || breaks(&[])? {
        return Ok((None, trail));
    }
    let mut parts = 2;
    while set.len() >= 2 {
        let size = set.len().div_ceil(parts);
        let chunks: Vec<Vec<usize>> = set.chunks(size).map(<[usize]>::to_vec).collect();
        let rest_of = |chunk: &Vec<usize>| -> Vec<usize> {
            set.iter().copied().filter(|fault| !chunk.contains(fault)).collect()
        };
        let mut smaller = None;
        for chunk in &chunks {
            if breaks(chunk)? {
                smaller = Some((chunk.clone(), 2));
                break;
            }
        }
        if smaller.is_none() && chunks.len() > 2 {
            for chunk in &chunks {
                let rest = rest_of(chunk);
                if breaks(&rest)? {
                    smaller = Some((rest, (chunks.len() - 1).max(2)));
                    break;
                }
            }
        }
        match smaller {
            Some((found, finer)) => (set, parts) = (found, finer),
            None if parts >= set.len() => break,
            None => parts = (2 * parts).min(set.len()),
        }
    }
    Ok((Some(set), trail))
}
