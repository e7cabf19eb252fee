//! Lists the cases to inspect, each with its command line, and the discrepancies with their
//! dispositions.

use super::elements::{case_link, heading};
use maud::{Markup, html};
use octant_base::number;
use octant_campaign::report::CampaignReport;
use octant_campaign::report::rows::RowOutcome;
use octant_report::discrepancies::table;
use octant_report::units::shown;

/// Maximum number of cases shown of each kind.
const SHOWN: usize = 50;
/// Number of cases of a discrepancy that are shown at once; the others are folded.
const FIRST: usize = 5;

/// Cases of a kind, with what is said of them.
#[derive(Debug, Default)]
struct FoundCases {
    /// The first ones.
    first: Vec<(String, String)>,
    /// Number of all of them.
    all: usize,
}

pub(super) fn section(report: &CampaignReport<'_>, beside: Option<&str>) -> Markup {
    let outliers = &report.statistics.outliers;
    let of = |wanted: &dyn Fn(&RowOutcome) -> Option<String>| -> FoundCases {
        let mut found = FoundCases::default();
        for row in report.rows.iter() {
            if let Some(why) = row.outcome.as_ref().and_then(wanted) {
                found.all += 1;
                if found.first.len() < SHOWN {
                    found.first.push((row.case.id.to_string(), why));
                }
            }
        }
        found
    };
    let errors = of(&|outcome| outcome.error.clone());
    let refused = of(&|outcome| outcome.refused.clone());
    let unfired = of(&|outcome| {
        (!outcome.unfired.is_empty())
            .then(|| format!("never fired: {}", outcome.unfired.join(", ")))
    });
    let differing = of(&|outcome| {
        outcome.differs.then(|| "the same case came to two results, both are kept".to_owned())
    });
    html! {
        (heading("findings"))
        h3 { "Outliers" }
        @if outliers.is_empty() {
            p { "No case stands out from its combination." }
        } @else {
            p.hint { "Cases whose logarithm is further from the median of their combination than 3.5 modified z-scores \
                (median and median absolute deviation, Iglewicz and Hoaglin)." }
            div.wide tabindex="0" role="region" aria-label="Outliers" {
                table {
                    thead { tr {
                        th { "Case" } th { "Combination" } th { "Measure" } th.n { "Value" } th.n { "Median" } th.n { "Score" }
                    } }
                    tbody { @for outlier in outliers.iter().take(SHOWN) {
                        @let unit = shown(outlier.measure, report.units.shown());
                        tr {
                            td { (case_link(&outlier.case, beside)) }
                            td { (report.combinations.get(outlier.combination).map_or_else(String::new, |c| c.name())) }
                            td.mono { (outlier.measure) }
                            td.n { (number::significant(unit.of(outlier.value), 3)) " " (unit.name) }
                            td.n { (number::significant(unit.of(outlier.median), 3)) " " (unit.name) }
                            td.n { @if outlier.score.is_finite() { (number::fixed(outlier.score, 1)) } @else { "∞" } }
                        }
                        tr.again { td colspan="6" { code { (report.case_again(&outlier.case)) } } }
                    } }
                }
            }
            (more(outliers.len(), "statistics.json"))
        }
        (cases(report, "Cases that ended as errors", "No case ended as an error.", &errors, beside))
        @if refused.all > 0 { (cases(report, "Calibrations that were refused", "", &refused, beside)) }
        (cases(report, "Faults that never fired", "Every fault that was injected fired.", &unfired, beside))
        (cases(report, "Cases that came to two results", "No case came to two results.", &differing, beside))
    }
}

fn more(all: usize, place: &str) -> Markup {
    html! { @if all > SHOWN { p.hint { (all - SHOWN) " more are in " (place) "." } } }
}

fn cases(
    report: &CampaignReport<'_>,
    title: &str,
    none: &str,
    found: &FoundCases,
    beside: Option<&str>,
) -> Markup {
    html! {
        h3 { (title) }
        @if found.all == 0 {
            p { (none) }
        } @else {
            table {
                thead { tr { th { "Case" } th { "What" } } }
                tbody { @for (case, why) in &found.first {
                    tr {
                        td { (case_link(case, beside)) }
                        td { (why) div.reason { code { (report.case_again(case)) } } }
                    }
                } }
            }
            (more(found.all, "cases.parquet"))
        }
    }
}

/// Renders everything that isn't a pass, with the dispositions.
pub(super) fn discrepancies(report: &CampaignReport<'_>, beside: Option<&str>) -> Markup {
    let hint = "What is said of them stands in dispositions.toml, which people fill in. It changes no \
        verdict. One more case makes another discrepancy, of which nothing is said yet.";
    let list = |cases: &[String]| list(cases, beside);
    html! {
        (heading("discrepancies"))
        (table(&report.statistics.discrepancies, &report.dispositions, hint, &list))
    }
}

fn list(cases: &[String], beside: Option<&str>) -> Markup {
    let (first, rest) = cases.split_at(cases.len().min(FIRST));
    html! {
        div.reason {
            @for case in first { (case_link(case, beside)) " " }
            @if !rest.is_empty() {
                details {
                    summary { (rest.len()) " more" }
                    @for case in rest { (case_link(case, beside)) " " }
                }
            }
        }
    }
}
