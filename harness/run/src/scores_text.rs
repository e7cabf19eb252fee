//! Scores of a navigation as text for the terminal.

use octant_base::number;
use octant_score::summary::{AlignmentResult, ErrorScore, Navigation, PointScore, SolutionScore};

/// Renders an alignment on one line: reference, duration, attitude, and the scores of the attitude.
#[must_use]
pub fn alignment_line(alignment: &AlignmentResult) -> String {
    let AlignmentResult { reference, duration_s, solution } = alignment;
    let degrees = |value: Option<f64>| value.map_or("-".to_owned(), |v| number::fixed(v, 3));
    let scores = attitude_scores(solution).map_or(String::new(), |scores| format!("; {scores}"));
    format!(
        "  alignment {}, {} s: heading {}, pitch {}, roll {} deg{scores}",
        reference.name(),
        number::plain(*duration_s, 4),
        degrees(solution.heading_deg),
        degrees(solution.pitch_deg),
        degrees(solution.roll_deg),
    )
}

/// Renders the solution at the end of a calibration; `None` if neither errors nor σ are known.
#[must_use]
pub fn solution_line(solution: &SolutionScore) -> Option<String> {
    Some(format!("    attitude at its end: {}", attitude_scores(solution)?))
}

/// Errors and σ of heading, pitch and roll; `None` if neither is known.
fn attitude_scores(solution: &SolutionScore) -> Option<String> {
    let points = [solution.heading_arcmin, solution.pitch_arcmin, solution.roll_arcmin];
    let all = |of: fn(&PointScore) -> Option<f64>, sign: bool| -> Option<String> {
        let one = |point: &PointScore| {
            of(point).map(|v| if sign { format!("{v:+.3}") } else { format!("{v:.3}") })
        };
        Some(points.iter().map(one).collect::<Option<Vec<String>>>()?.join(", "))
    };
    match (all(|point| point.error, true), all(|point| point.sigma, false)) {
        (Some(error), Some(sigma)) => Some(format!("error {error}, σ {sigma} arcmin")),
        (Some(error), None) => Some(format!("error {error} arcmin")),
        (None, Some(sigma)) => Some(format!("σ {sigma} arcmin")),
        (None, None) => None,
    }
}

/// Renders the scores of a navigation, one line each for latitude, longitude, radial error, attitude and
/// velocity.
#[must_use]
pub fn navigation_lines(n: &Navigation) -> Vec<String> {
    let error = |e: &ErrorScore| {
        let slope = e.slope_per_day.map_or(String::new(), |s| format!(", {s:+.3} arcmin/day"));
        format!("max {:.3}, rms {:.3} arcmin{slope}", e.max, e.rms)
    };
    let mut lines = vec![
        format!("    latitude  {}", error(&n.latitude_error_arcmin)),
        format!("    longitude {}", error(&n.longitude_error_arcmin)),
        format!(
            "    radial    max {:.3}, rms {:.3} nmi, {:.4} nmi/h",
            n.radial_error_nmi.max, n.radial_error_nmi.rms, n.radial_error_nmi.rate_per_h
        ),
    ];
    let pair = |e: &ErrorScore| format!("max {:.3}, rms {:.3}", e.max, e.rms);
    if let (Some(heading), Some(pitch), Some(roll)) =
        (&n.heading_error_arcmin, &n.pitch_error_arcmin, &n.roll_error_arcmin)
    {
        let [heading, pitch, roll] = [heading, pitch, roll].map(pair);
        lines.push(format!("    attitude  heading {heading}; pitch {pitch}; roll {roll} arcmin"));
    }
    if let (Some(north), Some(east)) = (&n.velocity_north_error_mps, &n.velocity_east_error_mps) {
        let [north, east] = [north, east].map(pair);
        lines.push(format!("    velocity  north {north}; east {east} m/s"));
    }
    lines
}
