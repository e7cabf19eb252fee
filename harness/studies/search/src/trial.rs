//! What a candidate did.

use crate::candidate::Candidate;
use octant_faults::Receipt;
use octant_faults::catalogue::{Acts, Family};
use octant_faults::kinds;
use octant_run::MethodRun;
use octant_run::difference::between;
use octant_scenario::Scenario;
use octant_score::counterfactual::{Counterfactual, HARMFUL_SHIFT_SIGMA};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A candidate with its result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// The candidate.
    pub candidate: Candidate,
    /// Its result.
    pub result: TrialResult,
}

/// Result of a candidate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TrialResult {
    /// The scenario can't have these faults; the reason.
    Refused(String),
    /// The run with them ended without a comparison; the reason.
    Broken(String),
    /// It ran.
    Ran(TrialEffect),
}

/// Effect of the faults of a candidate, against the run without them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TrialEffect {
    /// True if every fault altered something.
    pub fired: bool,
    /// First report of the core that the run without the faults doesn't have, or its refusal.
    pub noticed_by: Option<String>,
    /// True if a change of the instrument lasted to the end of the calibration, whose parameters are then rightly
    /// those of the changed instrument.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub instrument_changed: bool,
    /// Largest shift of a parameter in posterior σ, with its name.
    pub worst: Option<(String, f64)>,
    /// Largest distance from the navigation without the faults, nmi, and the largest radial error of that one.
    pub radial_nmi: Option<[f64; 2]>,
    /// Shift of each parameter in posterior σ, where nothing was noticed.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub shifts_sigma: BTreeMap<String, f64>,
}

impl TrialEffect {
    /// Compares a run with its twin; `None` if one of them has no end.
    pub(crate) fn of(scenario: &Scenario, run: &MethodRun, twin: &MethodRun) -> Option<Self> {
        let found = between(scenario, run, twin)?;
        let refused = run.calibration.as_ref().and_then(|c| c.refused.clone());
        let report = found.faults.iter().find_map(|fault| fault.noticed_by.clone());
        let absent = || {
            let is_absent = run.calibration.is_none() || found.unended;
            is_absent.then(|| "no calibration was published".to_owned())
        };
        let noticed_by =
            report.or_else(|| refused.map(|why| format!("refused: {why}"))).or_else(absent);
        let shifts = |found: &Counterfactual| {
            found
                .parameters
                .iter()
                .map(|(name, shift)| (name.clone(), finite(shift.sigma)))
                .collect()
        };
        let instrument_changed = run.receipts.iter().any(|receipt| stays(receipt, scenario));
        Some(Self {
            instrument_changed,
            fired: run.receipts.iter().all(|receipt| receipt.fired()),
            worst: found.worst_parameter.clone().zip(found.worst_shift_sigma.map(finite)),
            radial_nmi: (found.navigation.as_ref())
                .map(|n| [n.radial_max_nmi, n.twin_radial_max_nmi].map(finite)),
            shifts_sigma: if noticed_by.is_none() && !instrument_changed {
                shifts(&found)
            } else {
                BTreeMap::new()
            },
            noticed_by,
        })
    }

    /// Harm as a multiple of that from which a fault counts as harmful: a shift of 3 σ, or a difference of
    /// position as large as the error of the run without the fault. The shifts don't count where the instrument
    /// changed for good.
    #[must_use]
    pub fn harm(&self) -> f64 {
        let worst = self.worst.as_ref().filter(|_| !self.instrument_changed);
        let shift = worst.map_or(0.0, |(_, sigma)| sigma / HARMFUL_SHIFT_SIGMA);
        let drift = self.radial_nmi.map_or(
            0.0,
            |[radial, of_twin]| {
                if of_twin > 0.0 { radial / of_twin } else { 0.0 }
            },
        );
        shift.max(drift)
    }

    /// True if every fault acted, and its harm can be told: a change of the instrument that stays shows in the
    /// position alone.
    #[must_use]
    pub fn is_judged(&self) -> bool {
        self.fired && !(self.instrument_changed && self.radial_nmi.is_none())
    }

    /// True if every fault acted and none was noticed.
    #[must_use]
    pub fn is_unnoticed(&self) -> bool {
        self.fired && self.noticed_by.is_none()
    }
}

/// True for a change of the instrument that lasted to the last second of the calibration.
fn stays(receipt: &Receipt, scenario: &Scenario) -> bool {
    let changes = kinds::named(receipt.kind).is_some_and(|kind| {
        matches!(kind.family, Family::Analogue | Family::RingLaser)
            || ["temperature-ramp", "lever-arm"].contains(&kind.name)
    });
    let end = scenario.calibration_samples();
    let last_second =
        (1_000_000_000 + scenario.sample_period_ns / 2) / scenario.sample_period_ns.max(1);
    let is_late = |last: u64| last.saturating_add(last_second) >= end;
    // A change that shows in motion alone, as that of a lever arm, alters no sample at rest: its duration tells how long
    // it lasts.
    let spec = scenario.faults.iter().map(|fault| &fault.spec).find(|spec| spec.id == receipt.id);
    let inside = spec.filter(|spec| spec.kind.acts == Acts::Plant).zip(receipt.first_sample);
    let lasts = inside.is_some_and(|(spec, first)| {
        spec.schedule.duration.is_none_or(|epochs| is_late(first.saturating_add(epochs)))
    });
    changes && (lasts || receipt.last_sample.is_some_and(is_late))
}

/// The number, or the largest one: an effect that isn't a number is more than any.
fn finite(number: f64) -> f64 {
    if number.is_finite() { number } else { f64::MAX }
}

impl Trial {
    /// Effect of a candidate that ran.
    #[must_use]
    pub fn effect(&self) -> Option<&TrialEffect> {
        match &self.result {
            TrialResult::Ran(effect) => Some(effect),
            TrialResult::Refused(_) | TrialResult::Broken(_) => None,
        }
    }

    /// True for a trial that took a run.
    #[must_use]
    pub fn is_run(&self) -> bool {
        !matches!(self.result, TrialResult::Refused(_))
    }

    /// Harm, where it went unnoticed.
    #[must_use]
    pub fn unnoticed_harm(&self) -> Option<f64> {
        self.effect().filter(|effect| effect.is_unnoticed()).map(TrialEffect::harm)
    }
}
