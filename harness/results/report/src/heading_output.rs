//! Output chain of a heading: latency, follow-up error by class of rate of turn, transmission and resolution.

use maud::{Markup, html};
use octant_base::number;
use octant_score::heading_output::{FollowUpScore, HeadingOutputScore};

/// One row: name, value, expanded uncertainty and unit; without a value the reason.
struct Row {
    name: &'static str,
    found: Result<(f64, Option<f64>, &'static str), &'static str>,
    about: String,
}

/// Renders the section.
pub(super) fn section(output: &HeadingOutputScore) -> Markup {
    html! {
        h3 id="heading-output" { "Output of the heading" }
        p.hint {
            "The output against a reference that turns. Uncertainties are expanded (95 %), without that of the reference: by \
            what is left of the errors, by half of the last digit, and by the times of headings that have none."
        }
        table {
            thead { tr {
                th { "Measure" } th.n { "Value" } th.n { "Uncertainty" } th style="padding-left:14px" { "Unit" } th { "Of" }
            } }
            tbody { @for row in rows(output) { (rendered(&row)) } }
        }
    }
}

fn rendered(row: &Row) -> Markup {
    let shown = |value: f64| number::significant(value, 3);
    html! {
        tr {
            td { (row.name) }
            @match row.found {
                Ok((value, uncertainty, unit)) => {
                    td.n { (shown(value)) }
                    td.n { @match uncertainty { Some(uncertainty) => { "± " (shown(uncertainty)) } None => "–" } }
                    td style="padding-left:14px" { (unit) }
                }
                Err(reason) => { td colspan="3" { "not tested: " (reason) } }
            }
            td { (row.about) }
        }
    }
}

fn rows(output: &HeadingOutputScore) -> Vec<Row> {
    let of = |path: &str| Some(output.uncertainty(path));
    let mut rows = vec![Row {
        name: "Latency",
        found: match output.latency_s {
            Some(latency_s) => Ok((latency_s, output.latency_uncertainty_s, "s")),
            None => Err("the reference turns too little, or at one rate alone"),
        },
        about: "least squares of what is left".to_owned(),
    }];
    let classes = [
        ("Follow-up error up to 10 deg/s", output.follow_up_10),
        ("Follow-up error from 10 to 20 deg/s", output.follow_up_20),
    ];
    for (name, class) in classes {
        let about = class.map_or_else(String::new, |class: FollowUpScore| {
            format!(
                "rms {} deg, {} points, up to {} deg/s",
                number::significant(class.rms_deg, 3),
                class.points,
                number::significant(class.rate_max_degps, 3)
            )
        });
        let found = class.ok_or("no turn of this class in the reference");
        let found = found.map(|class| (class.max_deg, Some(class.uncertainty_deg), "deg"));
        rows.push(Row { name, found, about });
    }
    let rms = number::significant(output.transmission_rms_deg, 3);
    rows.extend([
        Row {
            name: "Error of transmission and resolution",
            found: Ok((output.transmission_error_deg, of("transmission_error_deg"), "deg")),
            about: format!("without constant error and latency, largest; rms {rms} deg"),
        },
        Row {
            name: "Constant error",
            found: Ok((output.constant_error_deg, of("constant_error_deg"), "deg")),
            about: String::new(),
        },
        Row {
            name: "Resolution",
            found: Ok((output.resolution_deg, None, "deg")),
            about: "last digit of the output".to_owned(),
        },
    ]);
    rows
}
