//! Scores of a navigation as text for the terminal.

use octant_base::display::{DisplayUnits, ShownUnit};
use octant_base::number;
use octant_score::heading_output::HeadingOutputScore;
use octant_score::summary::{
    AlignmentResult, ErrorScore, HeadingScore, NavigationScore, PointScore, RunUpScore,
    SolutionScore,
};

/// Renders an alignment on one line: reference, duration, attitude, and the scores of the attitude.
#[must_use]
pub(super) fn alignment_line(alignment: &AlignmentResult, units: &DisplayUnits) -> String {
    let AlignmentResult { reference, duration_s, solution } = alignment;
    let degrees = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{v:.3}"));
    let scores =
        attitude_scores(solution, units).map_or(String::new(), |scores| format!("; {scores}"));
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
pub(super) fn solution_line(solution: &SolutionScore, units: &DisplayUnits) -> Option<String> {
    Some(format!("    attitude at its end: {}", attitude_scores(solution, units)?))
}

/// Errors and σ of heading, pitch and roll; `None` if neither is known.
fn attitude_scores(solution: &SolutionScore, units: &DisplayUnits) -> Option<String> {
    let points = [solution.heading_arcmin, solution.pitch_arcmin, solution.roll_arcmin];
    let unit = units.attitude();
    let digits = unit.decimals;
    let all = |of: fn(&PointScore) -> Option<f64>, sign: bool| -> Option<String> {
        let one = |point: &PointScore| {
            let value = unit.of(of(point)?);
            Some(if sign { format!("{value:+.digits$}") } else { format!("{value:.digits$}") })
        };
        Some(points.iter().map(one).collect::<Option<Vec<String>>>()?.join(", "))
    };
    let name = unit.name;
    match (all(|point| point.error, true), all(|point| point.sigma, false)) {
        (Some(error), Some(sigma)) => Some(format!("error {error}, σ {sigma} {name}")),
        (Some(error), None) => Some(format!("error {error} {name}")),
        (None, Some(sigma)) => Some(format!("σ {sigma} {name}")),
        (None, None) => None,
    }
}

/// Renders a heading test, one line for each run-up.
#[must_use]
pub(super) fn heading_lines(heading: &HeadingScore) -> Vec<String> {
    let latitude = number::plain(heading.latitude_deg, 4);
    let mut lines =
        vec![format!("  heading test {}, latitude {latitude} deg", heading.test.name())];
    for (number, run_up) in heading.run_ups.iter().enumerate() {
        lines.push(format!("    run-up {}: {}", number + 1, run_up_text(run_up)));
    }
    if let Some(repeated) =
        heading.in_motion.map_or(heading.repeatability_deg, |of| of.repeatability_deg)
    {
        lines.push(format!("    repeatability {repeated:.4} deg"));
    }
    if !heading.knows_truth() {
        lines.push(
            "    not tested: errors, for no true heading is known; settling, scatter and repeatability are of the headings alone"
                .to_owned(),
        );
    }
    lines
}

/// Text of one run-up of a heading test.
fn run_up_text(run_up: &RunUpScore) -> String {
    let mut parts = vec![match run_up.settling_time_min {
        Some(time_min) if run_up.settled => {
            format!("settled after {} min", number::plain(time_min, 4))
        }
        Some(time_min) => format!("not settled before {} min", number::plain(time_min, 4)),
        None => "settling time unknown".to_owned(),
    }];
    for (name, point) in
        [("settle point", run_up.settle_point), ("after the motion", run_up.after_motion)]
    {
        let Some(point) = point else { continue };
        let error = point.error_deg.map_or(String::new(), |error| format!(", error {error:+.4}"));
        let (heading, rms) = (point.heading_deg, point.readings_rms_deg);
        parts.push(format!("{name} {heading:.4}{error}, rms {rms:.4} deg"));
    }
    parts.extend(run_up.scorsby_error_deg.map(|error| format!("after the motion {error:+.4} deg")));
    if let Some(amplitude) = run_up.dynamic_amplitude_deg {
        let at = run_up.dynamic_frequency_hz.filter(|hz| *hz > 0.0);
        let at = at.map_or(String::new(), |hz| format!(" at {hz:.4} Hz"));
        parts.push(format!("up to {amplitude:.4} deg in the motion{at}"));
    }
    parts.join("; ")
}

/// Latency, follow-up error and error of transmission of a heading on one line.
fn output_words(output: &HeadingOutputScore) -> String {
    let deg = |value: f64| number::plain(value, 3);
    let mut words = Vec::new();
    if let (Some(latency_s), Some(uncertainty_s)) = (output.latency_s, output.latency_uncertainty_s)
    {
        words.push(format!("latency {latency_s:.3} ± {uncertainty_s:.3} s"));
    }
    let classes = [("to 10", output.follow_up_10), ("10 to 20", output.follow_up_20)];
    for (name, class) in classes.into_iter().filter_map(|(name, class)| Some((name, class?))) {
        let (max, uncertainty) = (deg(class.max_deg), deg(class.uncertainty_deg));
        words.push(format!("follow-up {name} deg/s max {max} ± {uncertainty} deg"));
    }
    words.push(format!(
        "transmission max {} deg, last digit {} deg",
        deg(output.transmission_error_deg),
        deg(output.resolution_deg)
    ));
    words.join("; ")
}

/// Renders the scores of a navigation, one line each for latitude, longitude, radial error, attitude and
/// velocity.
#[must_use]
pub(super) fn navigation_lines(n: &NavigationScore, units: &DisplayUnits) -> Vec<String> {
    let pair = |e: &ErrorScore, unit: ShownUnit| {
        let (max, rms, digits) = (unit.of(e.max), unit.of(e.rms), unit.decimals);
        format!("max {max:.digits$}, rms {rms:.digits$}")
    };
    let position = |e: &ErrorScore, unit: ShownUnit| {
        let (name, digits) = (unit.name, unit.decimals);
        let slope = e
            .slope_per_day
            .map_or(String::new(), |s| format!(", {:+.digits$} {name}/day", unit.of(s)));
        format!("{} {name}{slope}", pair(e, unit))
    };
    let radial = units.radial();
    let (digits, finer) = (radial.decimals, radial.decimals + 1);
    let mut lines = Vec::new();
    if let (Some(latitude), Some(longitude)) = (&n.latitude_error_arcmin, &n.longitude_error_arcmin)
    {
        lines.push(format!("    latitude  {}", position(latitude, units.latitude())));
        lines.push(format!("    longitude {}", position(longitude, units.longitude())));
    }
    if let Some(score) = &n.radial_error_nmi {
        lines.push(format!(
            "    radial    max {:.digits$}, rms {:.digits$} {name}, {:.finer$} {name}/h",
            radial.of(score.max),
            radial.of(score.rms),
            radial.of(score.rate_per_h),
            name = radial.name
        ));
    }
    let unit = units.attitude();
    if let (Some(heading), None) = (&n.heading_error_arcmin, &n.pitch_error_arcmin) {
        lines.push(format!("    heading   {} {}", pair(heading, unit), unit.name));
    }
    if let (Some(heading), Some(pitch), Some(roll)) =
        (&n.heading_error_arcmin, &n.pitch_error_arcmin, &n.roll_error_arcmin)
    {
        let [heading, pitch, roll] = [heading, pitch, roll].map(|e| pair(e, unit));
        lines.push(format!(
            "    attitude  heading {heading}; pitch {pitch}; roll {roll} {}",
            unit.name
        ));
    }
    if let Some(output) = &n.heading_output {
        lines.push(format!("    output    {}", output_words(output)));
    }
    if let (Some(north), Some(east)) = (&n.velocity_north_error_mps, &n.velocity_east_error_mps) {
        let unit = units.velocity();
        let [north, east] = [north, east].map(|e| pair(e, unit));
        lines.push(format!("    velocity  north {north}; east {east} {}", unit.name));
    }
    lines
}
