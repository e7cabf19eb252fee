//! What a summary has to hold by the scenario beside it: requirements, limits and the rule of decision are planned,
//! and a summary only repeats them.

use octant_base::number::counted;
use octant_scenario::Scenario;
use octant_score::summary::Summary;
use octant_score::verdict::RequirementResult;
use octant_verdict::decision::{DecisionRule, NavigationContext};
use octant_verdict::verdict::LimitCheck;

/// Share by which an uncertainty may be below that of the plan: it went through text.
const ROUNDING: f64 = 1e-9;

/// Difference of two latitudes that are the same, deg: one went through text.
const LATITUDE_DEG: f64 = 1e-9;

/// Lists what a summary has otherwise than its scenario: requirements that were left out, added or changed, another rule of
/// decision, an uncertainty below that of the plan.
#[must_use]
pub fn unplanned(scenario: &Scenario, summary: &Summary) -> Vec<String> {
    let mut found = Vec::new();
    let planned = || scenario.requirements.iter().map(|requirement| &requirement.check);
    let missing = planned().filter(|check| !summary.requirements.iter().any(|r| r.id == check.id));
    found.extend(missing.map(|check| {
        format!("{} is missing: scenario.toml requires {}", check.id, in_words(check))
    }));
    for result in &summary.requirements {
        // Ids are unique in a scenario.
        match planned().find(|check| check.id == result.id) {
            None => found.push(format!("{} isn't a requirement of scenario.toml", result.id)),
            Some(check) if !is_of(result, check) => found.push(format!(
                "{} is {}, scenario.toml requires {}",
                result.id,
                in_words(&LimitCheck {
                    id: result.id.clone(),
                    measure: result.measure.clone(),
                    comparison: result.comparison,
                    limit: result.written_limit(),
                    secant_latitude: result.at_equator.is_some(),
                }),
                in_words(check)
            )),
            Some(check) => found.extend(too_certain(scenario, summary, result, check)),
        }
    }
    let (count, unique) = (summary.requirements.len(), planned().count());
    if found.is_empty() && count != unique {
        found.push(format!(
            "it has {}, scenario.toml has {unique}",
            counted(count as u64, "requirement", "requirements")
        ));
    }
    if let Some(heading) = &summary.heading {
        let planned_deg = scenario.site.latitude_rad.to_degrees();
        if !((heading.latitude_deg - planned_deg).abs() < LATITUDE_DEG) {
            found.push(format!(
                "its heading test is at a latitude of {} deg, the site of scenario.toml at {planned_deg} deg",
                heading.latitude_deg
            ));
        }
    }
    let rule = scenario.decision.rule();
    if let Some(decision) = summary.decision.as_ref().filter(|decision| decision.rule != rule) {
        found.push(format!(
            "it was decided by {}, scenario.toml asks for {}",
            rule_name(decision.rule),
            rule_name(rule)
        ));
    }
    found
}

const fn rule_name(rule: DecisionRule) -> &'static str {
    match rule {
        DecisionRule::GuardBand => "guard band",
        DecisionRule::SimpleAcceptance => "simple acceptance",
    }
}

fn is_of(result: &RequirementResult, check: &LimitCheck) -> bool {
    let has_secant = result.at_equator.is_some();
    (&result.measure, result.comparison, result.written_limit().to_bits(), has_secant)
        == (&check.measure, check.comparison, check.limit.to_bits(), check.secant_latitude)
}

fn in_words(check: &LimitCheck) -> String {
    let secant = if check.secant_latitude { " × sec φ" } else { "" };
    format!("{} {} {}{secant}", check.measure, check.comparison.sign(), check.limit)
}

/// Describes a result whose uncertainty is below that which the scenario alone gives. What the run itself adds (the
/// times of a solution, the σ in its file) can only make it larger.
fn too_certain(
    scenario: &Scenario,
    summary: &Summary,
    result: &RequirementResult,
    check: &LimitCheck,
) -> Option<String> {
    if scenario.decision.rule() == DecisionRule::SimpleAcceptance {
        return None;
    }
    let against = NavigationContext {
        simulated: scenario.source.is_simulated(summary.navigation.is_some()),
        latitude_rad: scenario.site.latitude_rad,
        height_m: scenario.site.height_m,
        navigation_s: summary.done.as_ref().and_then(|done| done.navigation_s).unwrap_or_default(),
        timing: None,
    };
    let least = scenario.decision.uncertainty(&check.measure, &against).ok()?;
    let stated = result.uncertainty.unwrap_or(0.0);
    (result.value.is_some() && !(stated >= least * (1.0 - ROUNDING))).then(|| {
        format!(
            "{} has an uncertainty of {stated}, scenario.toml gives at least {least}",
            result.id
        )
    })
}
