//! Renders the state of a run as text: one line, or a page.

use super::follow::{Follow, Stage};
use super::state::{FaultState, RunState};
use octant_base::number::{counted, fixed, significant};
use octant_sample::parameters::{NAMES, ParameterGroup};
use octant_sample::{Mode, Output};
use octant_scenario::NumberedStops;
use octant_verdict::Verdict;
use std::fmt::Write as _;

/// Renders a time of a run: `9 h 34 min`, `12.5 s`.
#[must_use]
pub fn time(ns: u64) -> String {
    let seconds = ns / 1_000_000_000;
    match seconds {
        0..60 => format!("{:.1} s", ns as f64 * 1e-9),
        60..3600 => format!("{} min {:02} s", seconds / 60, seconds % 60),
        _ => format!("{} h {:02} min", seconds / 3600, seconds / 60 % 60),
    }
}

/// Renders a lateness in microseconds: `54.2 µs`, `21.0 ms`.
#[must_use]
pub fn lateness(us: f64) -> String {
    if us < 1e3 {
        format!("{} µs", significant(us, 3))
    } else {
        format!("{} ms", significant(us / 1e3, 3))
    }
}

/// Describes the progress in a few words.
#[must_use]
pub fn stage(follow: &Follow) -> String {
    match &follow.stage {
        Stage::Starting => asks(follow).unwrap_or_else(|| "starting".to_owned()),
        Stage::Running => asks(follow).unwrap_or_else(|| "running".to_owned()),
        Stage::Recorded => "recorded, and not judged yet".to_owned(),
        Stage::Ended(summary) => format!("ended: {}", summary.verdict.name()),
        Stage::BrokenOff => "broke off: nobody writes it any more".to_owned(),
        Stage::Unjudged => {
            "recorded to its end, without a verdict: its folder isn't whole".to_owned()
        }
    }
}

/// Describes the question to the operator that is open, if one is.
fn asks(follow: &Follow) -> Option<String> {
    let records = octant_operator::journal::read(follow.place.folder()).ok()?;
    let asked = *octant_operator::journal::open(&records).first()?;
    let (step, ask) = (asked.step.as_deref()?, asked.ask.as_deref()?);
    Some(format!("asks its operator, step {step}: {ask}"))
}

/// Describes the core's place in its procedure.
#[must_use]
pub fn mode(state: &RunState) -> String {
    let Some(output) = &state.output else { return "no output yet".to_owned() };
    let mut text = output.mode.name().to_owned();
    if matches!(output.mode, Mode::Calibrating | Mode::Navigating) {
        let _ = write!(text, ", stop {}", stop(output, state.about.stops.as_ref()));
        if output.moving {
            text += ", moving";
        }
    }
    text
}

/// Describes the stop of an output: `7 of 19, position 3 of 8`; in navigation its number alone.
pub(crate) fn stop(output: &Output, stops: Option<&NumberedStops>) -> String {
    let stop = usize::from(output.stop);
    match stops.filter(|_| output.mode == Mode::Calibrating) {
        Some(stops) => stops.describe(stop),
        None => (stop + 1).to_string(),
    }
}

/// Names the core's present health reports.
#[must_use]
pub fn health(state: &RunState) -> String {
    let Some(output) = &state.output else { return "–".to_owned() };
    let names: Vec<&str> = output.health.iter().map(octant_score::health::name).collect();
    if names.is_empty() { "good".to_owned() } else { names.join(", ") }
}

/// Describes the state of a fault.
#[must_use]
pub fn fault(fault: &FaultState) -> String {
    let times = match fault.firings {
        1 => "once".to_owned(),
        n => format!("{n} times"),
    };
    if let Some(receipt) = &fault.receipt {
        return match (receipt.first_sample, receipt.last_sample) {
            (Some(first), Some(last)) => {
                let n = receipt.samples_altered;
                format!("fired {times}: {n} samples from {first} to {last}")
            }
            _ if fault.firings > 0 => format!("set in {times}"),
            _ => "never fired".to_owned(),
        };
    }
    match fault.last_ns {
        Some(ns) if fault.acts => format!("acts since {}", time(ns)),
        Some(ns) => format!("fired {times}, until {}", time(ns)),
        None => format!("armed, {}", fault.when).trim_end_matches([',', ' ']).to_owned(),
    }
}

/// Renders one line.
#[must_use]
pub fn line(follow: &Follow) -> String {
    let state = &follow.state;
    if matches!(follow.stage, Stage::Starting) {
        return stage(follow);
    }
    let mut text = format!("{:>11}", time(state.time_ns));
    if let Some(done) = state.done() {
        let _ = write!(text, " {:>5} %", fixed(done * 100.0, 1));
    }
    let _ = write!(text, "  {}", mode(state));
    if let (Stage::Running, Some(asks)) = (&follow.stage, asks(follow)) {
        let _ = write!(text, "  {asks}");
    }
    if let Some(drift) = state.drift {
        let _ = write!(
            text,
            "  lat {} lon {} arcmin, {} nmi",
            fixed(drift.latitude_arcmin, 3),
            fixed(drift.longitude_arcmin, 3),
            fixed(drift.radial_nmi, 3)
        );
    }
    if let Some(nis) = state.nis.filter(|_| state.mode() != Some(Mode::Navigating)) {
        let _ = write!(text, "  NIS {}, mean {}", fixed(nis.last, 2), fixed(nis.mean(), 2));
    }
    if state.output.is_some_and(|output| !output.health.is_empty()) {
        let _ = write!(text, "  {}", health(state));
    }
    if !state.faults.is_empty() {
        let fired = state.faults.iter().filter(|fault| fault.firings > 0).count();
        let _ = write!(text, "  {fired} of {} faults fired", state.faults.len());
        let acting = state.faults.iter().filter(|fault| fault.acts);
        let acting: Vec<&str> = acting.map(|fault| fault.id.as_str()).collect();
        if !acting.is_empty() {
            let _ = write!(text, ", {} acts", acting.join(", "));
        }
    }
    if let Some(pace) = state.pace {
        let _ = write!(
            text,
            "  late {}, {}",
            lateness(pace.latest_us),
            counted(pace.overruns, "overrun", "overruns")
        );
    }
    text
}

/// Renders the end of a run: verdict and reasons. Empty while it is in progress.
#[must_use]
pub fn end(follow: &Follow) -> String {
    match &follow.stage {
        Stage::Ended(summary) => {
            let mut text = format!("{}: {}\n", summary.scenario, summary.verdict.name());
            for reason in &summary.reasons {
                let _ = writeln!(text, "  {reason}");
            }
            for met in summary.requirements.iter().filter(|r| r.verdict == Verdict::Pass) {
                let _ = writeln!(text, "  {}", met.sentence());
            }
            text
        }
        _ => String::new(),
    }
}

/// Renders the whole state as a page.
#[must_use]
pub fn page(follow: &Follow) -> String {
    let state = &follow.state;
    let about = &state.about;
    let mut out = String::new();
    let mut row = |name: &str, text: &str| {
        let _ = writeln!(out, "{name:11} {text}");
    };
    row("run", &follow.place.folder().display().to_string());
    match &about.unread {
        None => {
            row("scenario", &about.title);
            row("method", &format!("{}, seed {}", about.method, about.seed));
        }
        Some(reason) => row("scenario", &format!("can't be read: {reason}")),
    }
    row("state", &stage(follow));
    let done = state.done().map_or_else(String::new, |done| {
        let of = time(about.length_ns.unwrap_or_default());
        format!(" of {of}, {} %", fixed(done * 100.0, 1))
    });
    row("time", &(time(state.time_ns) + &done));
    row("mode", &mode(state));
    if let Some(gimbals) = state.gimbals {
        row("gimbals", &angles(gimbals));
    }
    if let Some(output) = &state.output {
        let navigation = &output.navigation;
        row(
            "position",
            &format!(
                "{}° {}° {} m",
                fixed(navigation.latitude_rad.to_degrees(), 6),
                fixed(navigation.longitude_rad.to_degrees(), 6),
                fixed(navigation.height_m, 1)
            ),
        );
        row("health", &health(state));
    }
    for (name, drift) in [("drift", state.drift), ("largest", Some(state.largest))] {
        if let Some(drift) = drift.filter(|_| state.drift.is_some()) {
            row(
                name,
                &format!(
                    "latitude {} longitude {} arcmin, radial {} nmi",
                    fixed(drift.latitude_arcmin, 4),
                    fixed(drift.longitude_arcmin, 4),
                    fixed(drift.radial_nmi, 4)
                ),
            );
        }
    }
    if let Some(nis) = state.nis {
        row("NIS", &format!("{}, mean {}", fixed(nis.last, 3), fixed(nis.mean(), 3)));
    }
    for cause in &state.causes {
        let last = time(cause.last_ns);
        row("reported", &format!("{}, {} outputs, last {last}", cause.name(), cause.outputs));
    }
    for one in &state.faults {
        row("fault", &format!("{} ({}): {}", one.id, one.kind, fault(one)));
    }
    if let Some(pace) = state.pace {
        row(
            "pace",
            &format!(
                "{} samples, {} late at most in the last second, {} at most, overruns {}, late \
                 answers {}",
                pace.frames,
                lateness(pace.latest_us),
                lateness(state.latest_us),
                pace.overruns,
                pace.late_answers
            ),
        );
    }
    for (name, reason) in [("refused", &state.refused), ("broke off", &state.error)] {
        if let Some(reason) = reason {
            row(name, reason);
        }
    }
    out += &parameters(state);
    out + &end(follow)
}

fn parameters(state: &RunState) -> String {
    let mut out = String::new();
    let Some((_, estimate)) = &state.parameters else { return out };
    let values = estimate.parameters.to_array();
    for group in ParameterGroup::ALL {
        let unit = group.si_per_unit();
        for i in group.range().filter(|i| estimate.sigma[*i] > 0.0) {
            let (value, sigma) = (values[i] / unit, estimate.sigma[i] / unit);
            let decimals = octant_base::number::decimals_for(sigma, 2);
            let _ = writeln!(
                out,
                "  {:24} {:>10} ± {} {}",
                NAMES[i],
                fixed(value, decimals),
                fixed(sigma, decimals),
                group.unit()
            );
        }
    }
    out
}

/// Renders azimuth and roll.
#[must_use]
pub fn angles(gimbals: octant_sample::GimbalAngles) -> String {
    format!(
        "azimuth {}°, roll {}°",
        fixed(gimbals.azimuth_rad().to_degrees(), 2),
        fixed(gimbals.roll_rad().to_degrees(), 2)
    )
}
