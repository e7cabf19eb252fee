//! Confirmations from given runs.

use octant_design::confirm::{Confirmation, PredictedPair, runs_hash};
use octant_design::largest::{LargestErrors, Sampled};
use octant_design::measure::DesignMeasure;
use octant_run::paired::SideResult;
use octant_score::compare::{Maxima, Measure};

fn predicted(longitude_arcmin: f64) -> Vec<LargestErrors> {
    let at = |hours: f64, factor: f64| LargestErrors {
        hours,
        latitude_arcmin: Sampled { value: 1.0, error: 0.01 },
        longitude_arcmin: Sampled { value: factor * longitude_arcmin, error: 0.01 },
        radial_nmi: Sampled { value: 1.0, error: 0.01 },
    };
    vec![at(24.0, 0.4), at(72.0, 1.0)]
}

/// Runs with longitude errors about `first` and `second`, and these normalized errors.
fn runs(first: f64, second: f64, normalized: f64) -> Vec<[SideResult; 2]> {
    let side = |seed: u64, longitude: f64, normalized: f64| {
        let scatter = 1.0 + 0.1 * ((seed % 5) as f64 - 2.0);
        SideResult {
            maxima: Maxima {
                latitude_24h: Some(0.5 * scatter),
                longitude_24h: Some(0.4 * longitude * scatter),
                latitude_72h: Some(scatter),
                longitude_72h: Some(longitude * scatter),
                ..Maxima::default()
            },
            refused: None,
            g_normalized: vec![normalized; 9],
        }
    };
    (0..40).map(|seed| [side(seed, first, 1.0), side(seed + 1, second, normalized)]).collect()
}

fn judged(runs: &[[SideResult; 2]]) -> Confirmation {
    let pair = PredictedPair { reference: predicted(3.7), designed: predicted(2.6) };
    Confirmation::of(runs, &pair, DesignMeasure::named("longitude").unwrap())
}

#[test]
fn a_design_that_does_as_predicted_is_confirmed() {
    let found = judged(&runs(3.7, 2.6, 1.0));
    assert!(found.confirmed, "{:?}", found.reasons);
    assert_eq!((found.seeds, found.refused), (40, [0, 0]));
    let decides: Vec<Measure> =
        found.cells.iter().filter(|cell| cell.decides).map(|cell| cell.measure).collect();
    assert_eq!(decides, [Measure::Longitude72h]);
    let cell = found.cells.iter().find(|cell| cell.decides).unwrap();
    assert!((cell.predicted_improvement - (1.0 - 2.6 / 3.7)).abs() < 1e-12);
    assert!((cell.improvement.value - (1.0 - 2.6 / 3.7)).abs() < 1e-3);
    assert_eq!(found.normalized.unwrap().all.value, 1.0);
    // Better than promised is as promised.
    assert!(judged(&runs(3.7, 1.0, 1.0)).confirmed);
}

#[test]
fn a_broken_promise_is_told() {
    let reasons = |runs: &[[SideResult; 2]]| {
        let found = judged(runs);
        assert_eq!(found.confirmed, found.reasons.is_empty());
        found.reasons.join("; ")
    };
    let optimistic = reasons(&runs(3.7, 2.6, 1.8_f64.sqrt()));
    assert!(optimistic.contains("are 1.80, expected 0.8 to 1.3"), "{optimistic}");
    let pessimistic = reasons(&runs(3.7, 2.6, 0.5));
    assert!(pessimistic.contains("are 0.25"), "{pessimistic}");
    let none = reasons(&runs(3.7, 3.7, 1.0));
    assert!(none.contains("longitude to 72 h is 0 % smaller"), "{none}");
    assert!(none.contains("predicted 30 %"), "{none}");
    let mut refused = runs(3.7, 2.6, 1.0);
    refused[3][1] = SideResult {
        maxima: Maxima::default(),
        refused: Some("NIS".to_owned()),
        ..refused[3][1].clone()
    };
    assert!(reasons(&refused).contains("1 of 40 calibrations were refused"));
    let mut unknown = runs(3.7, 2.6, 1.0);
    unknown[3][1].g_normalized.clear();
    assert!(reasons(&unknown).contains("unknown"));
    // The diagonal alone is beyond the range, the mean of all nine is not.
    let mut diagonal = runs(3.7, 2.6, 1.0);
    for [_, designed] in &mut diagonal {
        for term in [0, 4, 8] {
            designed.g_normalized[term] = 1.5_f64.sqrt();
        }
    }
    let told = reasons(&diagonal);
    assert!(told.contains("their diagonal are 1.50") && !told.contains("nine"), "{told}");
}

#[test]
fn latitude_decides_where_it_is_minimised() {
    let pair = PredictedPair { reference: predicted(3.7), designed: predicted(2.6) };
    let measure = DesignMeasure::named("latitude.largest").unwrap();
    let found = Confirmation::of(&runs(3.7, 3.7, 1.0), &pair, measure);
    assert!(found.confirmed, "{:?}", found.reasons);
    assert!(found.cells.iter().any(|cell| cell.decides && cell.measure == Measure::Latitude72h));
}

#[test]
fn runs_of_other_scenarios_are_others() {
    assert_ne!(runs_hash("ab", "c"), runs_hash("a", "bc"));
    assert_eq!(runs_hash("ab", "c"), runs_hash("ab", "c"));
}
