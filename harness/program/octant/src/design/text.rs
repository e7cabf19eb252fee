//! A design as text: scores, the bound, and a table of the stops.

use super::confirm_text;
use super::outcome::Report;
use octant_base::number::significant;
use octant_design::measure::DesignMeasure;
use octant_design::report::SequenceDesign;
use std::fmt::Write as _;

pub(super) fn of(report: &Report, measure: DesignMeasure) -> String {
    let mut out = format!("{}\n", report.scenario);
    let _ = writeln!(out, "  minimised: {}, {}", measure.words(), measure.unit());
    if let Some(shortest) = &report.shortest {
        let _ = writeln!(
            out,
            "  shortest calibration found: {:.2} h, where eight positions of 4 h have {}; the bound forbids less \
             than {:.2} h",
            shortest.duration_h,
            significant(shortest.target, 4),
            shortest.bound_h
        );
    }
    for design in &report.designs {
        out += &one(design, measure);
    }
    if let Some(confirmation) = &report.confirmation {
        out += &confirm_text::of(confirmation, measure);
    }
    out
}

fn one(design: &SequenceDesign, measure: DesignMeasure) -> String {
    let figure = |value: f64| significant(value, 4);
    let mut out = match design.rotation {
        "scenario" => format!("  {:.2} h, rotation of the scenario\n", design.duration_h),
        name => format!("  {:.2} h, rotation \"{name}\"\n", design.duration_h),
    };
    let bound = design.bound.value;
    let ratio = |score: f64| match bound > 0.0 {
        true => format!("{:+.1} %", 100.0 * (score / bound - 1.0)),
        false => "-".to_owned(),
    };
    let _ = writeln!(out, "    {:24} {:>12} {:>14}", "sequence", measure.unit(), "above bound");
    for published in &design.published {
        let (score, above) = match published.score {
            Some(score) => (figure(score), ratio(score)),
            None => ("too long".to_owned(), String::new()),
        };
        let _ = writeln!(out, "    {:24} {score:>12} {above:>14}", published.name);
    }
    let _ = writeln!(
        out,
        "    {:24} {:>12} {:>14}",
        "designed",
        figure(design.score),
        ratio(design.score)
    );
    let _ = writeln!(
        out,
        "    {:24} {:>12} {:>14}",
        "  by octant observe",
        figure(design.observed),
        ratio(design.observed)
    );
    if let Some(continuous) = &design.continuous {
        for (what, all) in
            [("calibration", &continuous.calibration), ("navigation", &continuous.navigation)]
        {
            let Some(best) = all.first() else { continue };
            let _ = writeln!(
                out,
                "    {:24} {:>12} {:>14}   {}, {} deg/s",
                format!("  continuous {what}"),
                figure(best.score),
                ratio(best.score),
                best.scheme,
                significant(best.rate_deg_per_s, 2)
            );
        }
    }
    let sampling = match design.bound.sampling > 0.0 {
        true => format!("   ± {} by the number of draws", significant(design.bound.sampling, 2)),
        false => String::new(),
    };
    let _ = writeln!(out, "    {:24} {:>12}{sampling}", "bound of all sequences", figure(bound));
    let _ = writeln!(
        out,
        "    {:>4} {:>12} {:>10} {:>10} {:>10} {:>14} {:>14}",
        "stop", "azimuth, deg", "roll, deg", "dwell, s", "until, h", "if ended here", "without it"
    );
    for (index, stop) in design.stops.iter().enumerate() {
        let _ = writeln!(
            out,
            "    {:>4} {:>12} {:>10} {:>10.0} {:>10.3} {:>14} {:>14}",
            index + 1,
            stop.azimuth_deg.round(),
            stop.roll_deg.round(),
            stop.dwell_s,
            stop.until_s / 3600.0,
            figure(stop.measure_so_far),
            stop.measure_without.map_or_else(|| "-".to_owned(), figure)
        );
    }
    out
}
