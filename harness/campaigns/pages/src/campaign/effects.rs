//! Effects of the faults, each case against its twin without them.

use super::elements::{heading, with_bounds, with_bounds_in};
use maud::{Markup, html};
use octant_base::display::ShownUnit;
use octant_base::number;
use octant_campaign::report::CampaignReport;
use octant_campaign::report::effects::EffectFigures;

pub(super) fn section(report: &CampaignReport<'_>) -> Markup {
    let all = || {
        let figures = report.statistics.combinations.iter().map(|figures| figures.effects.as_ref());
        (report.combinations.iter().zip(figures)).filter_map(|(c, figures)| Some((c, figures?)))
    };
    html! {
        (heading("effects"))
        @if all().count() == 0 {
            p.empty { "No case was compared with a twin without faults: no requirement asks for one." }
        } @else {
            p.hint { "Each case against the same run without its faults. A draw is detected if every fault that fired was \
                noticed; a draw of which one wasn't is beyond every delay. Missed: a significant effect, unnoticed, on a \
                published calibration. False alarms are reports of the twins, which no fault explains. Below each figure \
                its interval at " (number::plain(100.0 * report.statistics.confidence, 3)) " %." }
            div.wide tabindex="0" role="region" aria-label="Effects of the faults by combination" {
                table {
                    thead { tr {
                        th { "Combination" } th.n { "Draws compared" } th.n { "Largest shift 50 %, σ" } th.n { "95 %, σ" }
                        th.n { "Detected, %" } th.n { "Delay 50 %, s" } th.n { "95 %, s" } th.n { "Missed" }
                        th.n { "Refused" } th.n { "Draws with false alarms" }
                    } }
                    tbody { @for (combination, figures) in all() { (row(&combination.name(), figures)) } }
                }
            }
        }
    }
}

fn row(name: &str, figures: &EffectFigures) -> Markup {
    let percent = ShownUnit { factor: 100.0, name: "%", decimals: 1 };
    html! {
        tr {
            td { (name) }
            td.n { (figures.compared) @if figures.beyond > 0 { div.reason { (figures.beyond) " beyond" } } }
            @match figures.worst_shift_sigma {
                Some(shift) => { td.n { (with_bounds(&shift.p50)) } td.n { (with_bounds(&shift.p95)) } }
                None => { td.n { "–" } td.n { "–" } }
            }
            td.n { (with_bounds_in(&figures.detected, percent)) }
            @match figures.detection_delay_s {
                Some(delay) => { td.n { (with_bounds(&delay.p50)) } td.n { (with_bounds(&delay.p95)) } }
                None => { td.n { "–" } td.n { "–" } }
            }
            td.n { (figures.missed) }
            td.n { (figures.refused) }
            td.n { (figures.with_false_alarms)
                @if figures.false_alarms > 0 { div.reason { (figures.false_alarms) " reports" } } }
        }
    }
}
