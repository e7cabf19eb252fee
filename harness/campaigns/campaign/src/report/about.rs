//! Texts of a campaign's requirements, from its file and from its scenarios.

use crate::judge::trace::{has_file, requirements_of};
use crate::plan::Plan;
use octant_verdict::Comparison;
use octant_verdict::requirement::{Check, Limit, Requirement, Requirements, Verification};

/// Collects the requirements that the cases of a plan check, with notes about missing texts.
pub(super) fn requirements(plan: &Plan) -> (Requirements, Vec<String>) {
    let mut notes = Vec::new();
    let mut all = Requirements {
        title: plan.title.clone(),
        accounts: plan.accounts.clone(),
        ..Requirements::default()
    };
    if has_file(plan) {
        match requirements_of(plan) {
            Ok(found) => all = found,
            Err(error) => {
                notes.push(format!("the texts of the requirements are missing: {error}"));
                all.requirements = plan.requirements.iter().map(planned).collect();
            }
        }
    }
    for scenario in &plan.scenarios {
        let unknown: Vec<&String> =
            scenario.requirements.iter().filter(|id| all.get(id).is_none()).collect();
        if unknown.is_empty() {
            continue;
        }
        let case = plan.cases.iter().find(|case| case.scenario == scenario.id);
        let loaded = case.map(|case| scenario.scenario(case));
        if let Some(Err(error)) = &loaded {
            let id = &scenario.id;
            notes.push(format!("the texts of the requirements of {id:?} are missing: {error}"));
        }
        let loaded = loaded.and_then(Result::ok);
        for id in unknown {
            let own = loaded.iter().flat_map(|s| &s.requirements).find(|own| own.check.id == *id);
            let verification = Verification::Test(Check {
                measure: own.map_or_else(String::new, |own| own.check.measure.clone()),
                comparison: own.map_or(Comparison::AtMost, |own| sign(own.check.comparison.sign())),
                limit: Limit::Number(own.map_or(f64::NAN, |own| own.check.limit)),
                secant_latitude: own.is_some_and(|own| own.check.secant_latitude),
                ensemble: None,
            });
            let text = own.map_or("", |own| own.text.as_str());
            let mut requirement = Requirement::new(id, text, verification);
            requirement.clause = own.and_then(|own| own.clause.clone());
            all.requirements.push(requirement);
        }
    }
    (all, notes)
}

fn sign(sign: &str) -> Comparison {
    Comparison::of_sign(sign).unwrap_or(Comparison::AtMost)
}

/// Builds a requirement of the campaign's file from the plan's data.
fn planned(planned: &crate::plan::requirements::Planned) -> Requirement {
    let check = &planned.check;
    let verification = Verification::Test(Check {
        measure: check.measure.clone(),
        comparison: sign(check.comparison.sign()),
        limit: Limit::Number(check.limit),
        secant_latitude: check.secant_latitude,
        ensemble: planned.ensemble,
    });
    Requirement::new(&check.id, "", verification)
}
