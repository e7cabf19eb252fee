//! Factors with which the drift correlates.

use super::elements::heading;
use maud::{Markup, html};
use octant_base::number;
use octant_campaign::report::CampaignReport;
use octant_campaign::report::figures::FactorFigures;

pub(super) fn section(report: &CampaignReport<'_>) -> Markup {
    let drawn = || {
        (report.combinations.iter().zip(&report.statistics.combinations))
            .filter(|(_, figures)| !figures.sensitivity.is_empty())
    };
    let grid = || report.statistics.scenarios.iter().filter(|scenario| !scenario.grid.is_empty());
    html! {
        (heading("sensitivity"))
        @if drawn().count() + grid().count() == 0 {
            p.empty { "No factor is a number." }
        } @else {
            p.hint { "Spearman's rank correlation of the radial error rate with each factor that is a number. A factor \
                of a fault counts where the fault is injected. The probability is that of a correlation as strong without \
                any relation; of many some are small by chance, and those in bold are more than that at 5 % all \
                together (Bonferroni)." }
            @if drawn().count() > 0 {
                div.wide tabindex="0" role="region" aria-label="Sensitivity by combination" {
                    table {
                        thead { tr {
                            th { "Combination" } th { "Factor" } th.n { "Cases" } th.n { "ρ" } th.n { "Probability" }
                        } }
                        tbody { @for (combination, figures) in drawn() {
                            @for (index, factor) in strongest_first(&figures.sensitivity).into_iter().enumerate() {
                                tr {
                                    td { @if index == 0 { (combination.name()) } }
                                    td { (factor.factor) }
                                    td.n { (factor.cases) }
                                    @match factor.correlation {
                                        Some(c) => {
                                            td.n { @if factor.stands_out { strong { (number::fixed(c.rho, 2)) } }
                                                @else { (number::fixed(c.rho, 2)) } }
                                            td.n { (number::significant(c.p, 2)) }
                                        }
                                        None => { td.n { "–" } td.n { "–" } }
                                    }
                                }
                            }
                        } }
                    }
                }
            }
            @if grid().count() > 0 {
                h3 { "Factors of the grid" }
                p.hint { "Over all cases of a scenario. There is no probability: the same instruments are in all values." }
                table {
                    thead { tr { th { "Scenario" } th { "Factor" } th.n { "Cases" } th.n { "ρ" } } }
                    tbody { @for scenario in grid() { @for factor in &scenario.grid { tr {
                        td { (scenario.scenario) } td { (factor.factor) }
                        td.n { (factor.cases) } td.n { (number::fixed(factor.rho, 2)) }
                    } } } }
                }
            }
        }
    }
}

fn strongest_first(factors: &[FactorFigures]) -> Vec<&FactorFigures> {
    let mut all: Vec<&FactorFigures> = factors.iter().collect();
    let size = |factor: &FactorFigures| factor.correlation.map_or(-1.0, |c| c.rho.abs());
    // A stable sort: equal ones stay in the order of the factors.
    all.sort_by(|a, b| size(b).total_cmp(&size(a)));
    all
}
