//! Rows of a campaign's certificate: each requirement in each scenario, with the case that came nearest to its limit.

use maud::{Markup, html};
use octant_campaign::plan::Case;
use octant_campaign::report::requirement::{RequirementFigures, checks};
use octant_campaign::report::{CampaignReport, combination};
use octant_report::certificate::{Certificate, ROWS_MAX, Row, is_of_heading, is_of_test, page};
use octant_scenario::HeadingCondition;
use octant_score::verdict::RequirementResult;
use octant_verdict::Verdict;

/// Renders the certificate; empty without a requirement on a heading test.
pub(super) fn first_page(report: &CampaignReport<'_>) -> Markup {
    of(report).map_or_else(|| html! {}, |certificate| page(&certificate))
}

/// Certificate of a campaign; `None` without a requirement on a heading test.
fn of(report: &CampaignReport<'_>) -> Option<Certificate> {
    let shown = |is: fn(&str) -> bool| {
        let all = report.statistics.requirements.iter();
        all.filter(move |r| r.measure.as_deref().is_some_and(is))
    };
    shown(is_of_test).next()?;
    let of_scenarios: Vec<Row> =
        shown(is_of_heading).flat_map(|r| by_scenario(report, r)).collect();
    let open: Vec<Row> =
        report.status.not_by_test.iter().map(|id| not_tested(report, id)).collect();
    // Many scenarios have no room on a page: then a requirement has one row for all of them.
    let mut rows = if of_scenarios.len() + open.len() > ROWS_MAX {
        shown(is_of_heading).map(|r| row(report, r, None)).collect()
    } else {
        of_scenarios
    };
    rows.extend(open);
    Some(Certificate {
        title: report.plan.title.clone(),
        lines: lines(report).into_iter().chain([super::origin::line(report)]).collect(),
        verdict: report.statistics.verdict,
        rows,
    })
}

/// Rows of a requirement: one for each scenario, or one if all cases are judged together.
fn by_scenario(report: &CampaignReport<'_>, r: &RequirementFigures) -> Vec<Row> {
    if r.asked.is_some() {
        return vec![row(report, r, None)];
    }
    let scenarios = report.plan.scenarios.iter().map(|scenario| scenario.id.as_str());
    let own = scenarios.filter(|scenario| checks(report.plan, scenario, &r.id));
    own.map(|scenario| row(report, r, Some(scenario))).collect()
}

/// Row of a requirement in a scenario, or in all of them.
fn row(report: &CampaignReport<'_>, r: &RequirementFigures, scenario: Option<&str>) -> Row {
    let (mut cases, mut run) = (0usize, 0usize);
    let mut worst = Verdict::Pass;
    let mut nearest: Option<(&Case, RequirementResult)> = None;
    for row in report.rows.iter() {
        let is = scenario.map_or_else(
            || checks(report.plan, &row.case.scenario, &r.id),
            |scenario| &*row.case.scenario == scenario,
        );
        if !is {
            continue;
        }
        cases += 1;
        let Some(outcome) = row.outcome else { continue };
        run += 1;
        worst = worst.max(outcome.check(&r.id));
        let Some(result) = outcome.checks.into_iter().find(|check| check.id == r.id) else {
            continue;
        };
        // A result without a margin has no value: it is shown where no other is.
        let margin = |result: &RequirementResult| result.margin.unwrap_or(f64::INFINITY);
        if nearest.as_ref().is_none_or(|(_, least)| margin(&result) < margin(least)) {
            nearest = Some((row.case, result));
        }
    }
    let verdict = match scenario {
        Some(_) if run < cases => worst.max(Verdict::Inconclusive),
        Some(_) => worst,
        None => r.verdict,
    };
    let mut condition = scenario.map_or_else(String::new, |scenario| format!("{scenario}: "));
    condition += &match &nearest {
        Some((case, _)) => condition_of(report, case),
        None => "no case has run".to_owned(),
    };
    if cases > 1 {
        condition += &format!("; least margin of {run} of {cases} cases");
    }
    let (test, clause) = named(report, &r.id);
    Row {
        test,
        clause,
        condition,
        result: nearest.map(|(_, result)| result),
        verdict: Some(verdict),
    }
}

/// Condition of a case; without the file of its scenario its factors alone.
fn condition_of(report: &CampaignReport<'_>, case: &Case) -> String {
    let scenario = report.plan.planned(case).and_then(|planned| planned.scenario(case));
    scenario.map_or_else(
        |_| {
            let factors = case.factors.iter();
            let words: Vec<String> = factors
                .map(|(name, value)| format!("{name} {}", combination::shown(value)))
                .collect();
            words.join(", ")
        },
        |scenario| HeadingCondition::of(&scenario).words(),
    )
}

/// Row of a requirement that no run verifies.
fn not_tested(report: &CampaignReport<'_>, id: &str) -> Row {
    let (test, clause) = named(report, id);
    Row { test, clause, condition: String::new(), result: None, verdict: None }
}

/// Name and clause of a requirement; its id where its file isn't there.
fn named(report: &CampaignReport<'_>, id: &str) -> (String, String) {
    let own = report.about.get(id);
    let test = own.map(|own| own.title.clone().unwrap_or_else(|| own.text.clone()));
    let clause = own.and_then(|own| own.clause.clone());
    let id = || id.to_owned();
    (test.filter(|text| !text.is_empty()).unwrap_or_else(id), clause.unwrap_or_else(id))
}

/// Lines of the grid: each factor with its values.
fn lines(report: &CampaignReport<'_>) -> Vec<String> {
    let mut grid: Vec<(&str, Vec<&str>)> = Vec::new();
    for (name, value) in report.combinations.iter().flat_map(|combination| &combination.factors) {
        let at = grid.iter().position(|(known, _)| known == name).unwrap_or_else(|| {
            grid.push((name, Vec::new()));
            grid.len() - 1
        });
        if let Some((_, values)) = grid.get_mut(at)
            && !values.contains(&value.as_str())
        {
            values.push(value);
        }
    }
    grid.iter().map(|(name, values)| format!("{name}: {}", values.join(", "))).collect()
}
