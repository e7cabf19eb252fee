//! Effects of faults over the cases of a combination, each against its twin without faults.
//!
//! A case without a comparison (it ended as an error, or its twin wasn't asked for) is beyond every number, and so is
//! the delay of a case of which a fault went unnoticed.

use super::spread::{CONFIDENCE, Spread};
use octant_score::counterfactual::Counterfactual;
use octant_statistics::proportion::{success_lower_bound, success_upper_bound};
use octant_statistics::sample::ConfidenceInterval;
use serde::Serialize;

/// Effect of the faults of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseEffect {
    /// Largest shift of a parameter, in σ of the twin; `None` without a calibration in both.
    pub shift_sigma: Option<f64>,
    /// Longest delay of a detection, s; `None` if nothing was noticed.
    pub delay_s: Option<f64>,
    /// Number of faults that fired and were not noticed.
    pub undetected: u64,
    /// True if the calibration was refused, and that of the twin wasn't.
    pub refused: bool,
    /// True for a significant effect of faults that were not noticed, on a published calibration.
    pub missed: bool,
    /// Number of reports of the twin.
    pub false_alarms: u64,
}

impl CaseEffect {
    pub(super) fn of(difference: &Counterfactual) -> Self {
        Self {
            shift_sigma: difference.worst_shift_sigma,
            delay_s: difference.detection_delay_max_s,
            undetected: difference.undetected,
            refused: difference.refused,
            missed: difference.missed,
            false_alarms: difference.false_alarms,
        }
    }
}

/// Effects of faults over independent draws.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EffectFigures {
    /// Draws with a comparison.
    pub compared: usize,
    /// Draws without one.
    pub beyond: usize,
    /// Largest shift of a parameter, in σ of the twin; null without a calibration.
    pub worst_shift_sigma: Option<Spread>,
    /// Share of the draws in which every fault that fired was noticed.
    pub detected: ConfidenceInterval,
    /// Longest delay of a detection, s.
    pub detection_delay_s: Option<Spread>,
    /// Draws with a significant effect that was not noticed, on a published calibration.
    pub missed: usize,
    /// Draws whose calibration was refused, and that of the twin wasn't.
    pub refused: usize,
    /// Draws whose twin has a report.
    pub with_false_alarms: usize,
    /// Reports of all twins.
    pub false_alarms: u64,
}

impl EffectFigures {
    /// Summarises the effects of draws; `None` if no draw has one.
    pub(super) fn of(effects: &[Option<CaseEffect>]) -> Option<Self> {
        let there: Vec<&CaseEffect> = effects.iter().flatten().collect();
        if there.is_empty() {
            return None;
        }
        let count = |is: fn(&CaseEffect) -> bool| there.iter().filter(|e| is(e)).count();
        let column = |value: fn(&CaseEffect) -> Option<f64>| -> Vec<f64> {
            let of = |effect: &Option<CaseEffect>| effect.as_ref().and_then(value);
            effects.iter().map(|effect| of(effect).unwrap_or(f64::INFINITY)).collect()
        };
        let delay = |e: &CaseEffect| e.delay_s.filter(|_| e.undetected == 0);
        let noticed = count(|e| e.undetected == 0);
        let (runs, others) = (effects.len() as u64, (effects.len() - noticed) as u64);
        // Each end has half of the error.
        let one_sided = 0.5 + 0.5 * CONFIDENCE;
        let has_shift = there.iter().any(|e| e.shift_sigma.is_some());
        Some(Self {
            compared: there.len(),
            beyond: effects.len() - there.len(),
            worst_shift_sigma: if has_shift {
                Spread::of(&column(|e| e.shift_sigma))
            } else {
                None
            },
            detected: ConfidenceInterval {
                value: noticed as f64 / runs as f64,
                low: success_lower_bound(others, runs, one_sided),
                high: success_upper_bound(others, runs, one_sided),
            },
            detection_delay_s: Spread::of(&column(delay)),
            missed: count(|e| e.missed),
            refused: count(|e| e.refused),
            with_false_alarms: count(|e| e.false_alarms > 0),
            false_alarms: there.iter().map(|e| e.false_alarms).sum(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn effect(shift_sigma: f64, delay_s: Option<f64>, false_alarms: u64) -> CaseEffect {
        let undetected = u64::from(delay_s.is_none());
        let shift_sigma = Some(shift_sigma);
        let missed = undetected > 0 && shift_sigma >= Some(3.0);
        CaseEffect { shift_sigma, delay_s, undetected, refused: false, missed, false_alarms }
    }

    #[test]
    fn what_was_not_noticed_or_compared_is_beyond_every_delay() {
        let effects = [
            Some(effect(0.5, Some(1.0), 0)),
            Some(effect(4.0, None, 2)),
            Some(effect(1.0, Some(3.0), 1)),
            None,
        ];
        let found = EffectFigures::of(&effects).unwrap();
        assert_eq!((found.compared, found.beyond, found.missed), (3, 1, 1));
        assert_eq!((found.with_false_alarms, found.false_alarms), (2, 3));
        assert_eq!(found.detected.value, 0.5, "the case without a comparison noticed nothing");
        // Two of four, Clopper and Pearson, 95 %: tabled.
        assert!((found.detected.low - 0.0676).abs() < 1e-4, "{:?}", found.detected);
        assert!((found.detected.high - 0.9324).abs() < 1e-4, "{:?}", found.detected);
        let delay = found.detection_delay_s.unwrap();
        assert!(delay.p95.value.is_infinite() && delay.p50.low <= 3.0, "{delay:?}");
        assert!(found.worst_shift_sigma.unwrap().p95.value.is_infinite());
        assert_eq!(EffectFigures::of(&[None]), None);
    }
}
