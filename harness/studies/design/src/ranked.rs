//! Candidates of a search, ranked by the measure itself.

use crate::candidate::{GridStop, Limits, sequence_of};
use crate::judge::Judge;
use octant_calibration::config::TurntableRates;
use octant_calibration::schedule::DoesNotFit;
use octant_calibration::sequence::Sequence;

/// Result of a search.
#[derive(Clone, Debug)]
pub struct Found {
    /// The best candidate, with its lead-in.
    pub stops: Vec<GridStop>,
    /// The same as a sequence.
    pub sequence: Sequence,
    /// Its measure.
    pub score: f64,
    /// The next best candidates that visit other angles or the same in another order, the best first.
    pub others: Vec<Found>,
}

/// Ranks candidates, each with what the search minimised; `None` if none of them fits.
///
/// Of candidates that visit the same angles in the same order the best alone counts. A largest error is
/// predicted of each: in the search a form stood for it.
pub(crate) fn rank(
    mut all: Vec<(Vec<GridStop>, f64)>,
    judge: &mut Judge,
    limits: &Limits,
    (duration_s, rates): (f64, &TurntableRates),
) -> Result<Option<Found>, DoesNotFit> {
    all.retain(|(_, score)| score.is_finite());
    all.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut known: Vec<Vec<(i32, i32)>> = Vec::new();
    let mut ranked = Vec::new();
    for (mut candidate, mut score) in all {
        let angles = candidate.iter().map(|stop| (stop.azimuth_deg, stop.roll_deg)).collect();
        if known.contains(&angles) {
            continue;
        }
        known.push(angles);
        let stops = limits.led_in(&mut candidate, duration_s, rates);
        let Some((stops, sequence)) = stops.and_then(|s| sequence_of(&s).map(|made| (s, made)))
        else {
            continue;
        };
        if judge.has_draws() {
            score = judge.score(&sequence, duration_s)?;
        }
        ranked.push(Found { stops, sequence, score, others: Vec::new() });
    }
    ranked.sort_by(|a, b| a.score.total_cmp(&b.score));
    let mut ranked = ranked.into_iter();
    Ok(ranked.next().map(|best| Found { others: ranked.collect(), ..best }))
}
