//! A Latin hypercube: as many candidates as runs, each value of each key spread evenly over its range.

use crate::candidate::{Candidate, PlacedFault};
use crate::space::Space;
use octant_random::draws::Draws;

/// Draws all candidates (McKay, Beckman and Conover, 1979): forms, and the places of each key, are permutations
/// of equal strata. `pairs` is the share of candidates with two faults.
#[must_use]
pub fn latin(space: &Space, seed: u64, pairs: f64, count: usize) -> Vec<Candidate> {
    let keys = space.forms.iter().map(|form| form.keys.len()).max().unwrap_or(0);
    let column = |name: String| strata(seed, &name, count);
    let columns = |fault: usize| -> Vec<Vec<f64>> {
        (0..=keys).map(|key| column(format!("faults search latin {fault} {key}"))).collect()
    };
    let of_faults = [columns(0), columns(1)];
    let doubled = column("faults search latin pairs".to_owned());
    let placed = |columns: &[Vec<f64>], index: usize| {
        let forms = space.forms.len();
        let form = ((columns[0][index] * forms as f64) as usize).min(forms - 1);
        let places = (0..space.forms[form].keys.len()).map(|key| columns[key + 1][index]);
        PlacedFault { form, places: places.collect() }
    };
    (0..count)
        .map(|index| {
            let faults = if doubled[index] < pairs { 2 } else { 1 };
            let of = of_faults.iter().take(faults);
            Candidate { faults: of.map(|columns| placed(columns, index)).collect() }
        })
        .collect()
}

/// A random place in each of `count` equal strata, in random order.
fn strata(seed: u64, name: &str, count: usize) -> Vec<f64> {
    let mut draw = {
        let mut step = 0;
        move || {
            step += 1;
            Draws::of(seed, name, step)
        }
    };
    let mut places: Vec<f64> =
        (0..count).map(|stratum| (stratum as f64 + draw().unit()) / count as f64).collect();
    for last in (1..count).rev() {
        places.swap(last, draw().below(last + 1));
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stratum_has_one_place() {
        let mut places = strata(1, "test", 100);
        assert!(places.windows(2).any(|pair| pair[0] > pair[1]));
        places.sort_by(f64::total_cmp);
        for (stratum, place) in places.iter().enumerate() {
            assert_eq!((place * 100.0) as usize, stratum);
        }
    }
}
