//! Measures that the cases of a campaign can have: a requirement on another one would never get a value.

use octant_scenario::Scenario;
use octant_scenario::campaign::{FactorSpec, Levels};
use octant_verdict::measures::{MeasureNeed, needs};
use octant_verdict::verdict::LimitCheck;

/// Seconds of a navigation that reaches the marks.
const DAY_S: f64 = 86_400.0;

/// Returns why no case of a scenario can have the measure of a check; `None` if one can. What a factor sets may differ
/// from case to case.
pub(super) fn why_not(
    base: &Scenario,
    check: &LimitCheck,
    factors: &[FactorSpec],
) -> Option<String> {
    let path = check.measure.trim_matches('|');
    let set = |table: &str| {
        factors
            .iter()
            .any(|factor| key_of(&factor.levels).is_some_and(|key| key.starts_with(table)))
    };
    let navigation_s = base.navigation.as_ref().map(|plan| plan.duration_s);
    let shorter = |least_s: f64| match navigation_s {
        None => true,
        Some(duration_s) => duration_s.is_some_and(|duration_s| duration_s < least_s),
    };
    if needs(path).contains(&MeasureNeed::Twin)
        && let Some(factor) = factors.iter().find(|factor| leaves_out(&factor.levels))
    {
        return Some(format!(
            "requirement {:?} measures {:?}, which not every case can have: factor {:?} injects no fault in some of them, \
             and without faults a case has no twin to be compared with; expected a fault in each of its lists (false \
             alarms are counted in the twin), or a scenario of its own for the cases without",
            check.id, check.measure, factor.name
        ));
    }
    let lacking = needs(path).into_iter().find_map(|need| match need {
        MeasureNeed::Twin if base.faults.is_empty() => Some(
            "the scenario has no faults, and without them no case has a twin to be compared with",
        ),
        MeasureNeed::Clock | MeasureNeed::DeviceClock => {
            Some("cases of a campaign run in simulated time")
        }
        MeasureNeed::Calibration if base.calibration.is_none() && !set("procedure") => {
            Some("the scenario has no calibration")
        }
        MeasureNeed::Baseline if base.baseline.is_none() && !set("procedure") => {
            Some("the scenario has no second method")
        }
        MeasureNeed::Navigation if base.navigation.is_none() && !set("procedure") => {
            Some("the scenario has no navigation")
        }
        MeasureNeed::Day if shorter(DAY_S) && !set("procedure") => {
            Some("the scenario navigates for less than 24 h")
        }
        MeasureNeed::ThreeDays if shorter(3.0 * DAY_S) && !set("procedure") => {
            Some("the scenario navigates for less than 72 h")
        }
        _ => None,
    })?;
    Some(format!(
        "requirement {:?} measures {:?}, which no case can have: {lacking}; expected a measure that its cases have",
        check.id, check.measure
    ))
}

/// Returns whether a factor leaves all faults out in some cases.
fn leaves_out(levels: &Levels) -> bool {
    matches!(levels, Levels::Faults { lists, .. } if lists.iter().any(Vec::is_empty))
}

/// Key that a factor sets.
pub(super) fn key_of(levels: &Levels) -> Option<&str> {
    match levels {
        Levels::Values { key, .. } | Levels::Distributed { key, .. } => Some(key),
        _ => None,
    }
}
