//! Confirmations as text.

use super::outcome::{Attempt, ConfirmationReport};
use octant_base::number::significant;
use octant_design::confirm::{ConfirmedCell, NORMALIZED, NormalizedErrors};
use octant_design::measure::DesignMeasure;
use std::fmt::Write as _;

pub(super) fn of(report: &ConfirmationReport, measure: DesignMeasure) -> String {
    let mut out = format!(
        "  simulation: {} seeds from {} on at {}, against {} in the same time; at most {} designs\n",
        report.seeds, report.first_seed, report.rate, report.reference, report.attempts_max
    );
    for (index, attempt) in report.attempts.iter().enumerate() {
        let _ = writeln!(
            out,
            "    attempt {}: {}, rotation {:?}, predicted {} {}",
            index + 1,
            attempt.about,
            attempt.design.rotation,
            significant(attempt.design.score, 4),
            measure.unit()
        );
        out += &one(attempt);
    }
    let _ = writeln!(out, "  {}", report.words());
    out
}

fn one(attempt: &Attempt) -> String {
    let result = &attempt.result;
    let mut out = format!(
        "      {:20} {:>8} {:>8} {:>26} {:>11}\n",
        "largest error, arcmin", "eight", "designed", "improvement, 90 % interval", "predicted"
    );
    for cell in &result.cells {
        let ConfirmedCell { improvement, .. } = cell;
        let [value, low, high, predicted] =
            [improvement.value, improvement.low, improvement.high, cell.predicted_improvement]
                .map(|part| format!("{:.0}", 100.0 * part));
        let decides = if cell.decides { " *" } else { "" };
        let _ = writeln!(
            out,
            "      {:20} {:>9} {:>8} {:>26} {:>11}{decides}",
            cell.measure.name(),
            significant(cell.reference, 4),
            significant(cell.designed, 4),
            format!("{value} % [{low}, {high}]"),
            format!("{predicted} %"),
        );
    }
    if result.refused != [0, 0] {
        let [eight, designed] = result.refused;
        let _ = writeln!(
            out,
            "      refused calibrations: {eight} of eight positions, {designed} of the design"
        );
    }
    let (low, high) = NORMALIZED;
    let sides = [("eight", &result.normalized_reference), ("designed", &result.normalized)];
    for (name, errors) in sides {
        let Some(NormalizedErrors { all, diagonal }) = errors else { continue };
        let _ = writeln!(
            out,
            "      normalized squared errors of G, {name}: {:.2} [{:.2}, {:.2}], of the diagonal {:.2} [{:.2}, \
             {:.2}]; expected {low} to {high}",
            all.value, all.low, all.high, diagonal.value, diagonal.low, diagonal.high
        );
    }
    match result.confirmed {
        true => out += "      confirmed\n",
        false => {
            let _ = writeln!(out, "      not confirmed: {}", result.reasons.join("; "));
        }
    }
    out
}
