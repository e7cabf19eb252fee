//! Renders the page of a kind of fault in Markdown, and its picture; words for the properties of a kind.

use crate::failure::Failure;
use octant_faults::catalogue::{Acts, FaultKind, Lasts};
use octant_faults::station::World;
use octant_report::fault_picture::{PictureRuns, PictureStep, PictureWindow, picture as draw};
use octant_run::side_by_side::{SideBySide, Step, side_by_side};
use octant_sample::disturbance::Disturbed;
use octant_sample::{Output, Truth};
use octant_scenario::{Scenario, fault_example, fault_parameters};
use std::path::Path;

/// Scenario of the examples: at 100 s the instrument dwells; from 115 s to 125 s it turns by 90° of
/// azimuth to the third position.
const STAGE: &str = r#"schema = 1
[procedure.calibration]
duration = "4 min"
stops = [
    { azimuth = "0 deg", roll = "0 deg" },
    { azimuth = "0 deg", roll = "45 deg" },
    { azimuth = "90 deg", roll = "45 deg" },
    { azimuth = "90 deg", roll = "0 deg" },
]
"#;
/// References; a fault may need another than the first.
const REFERENCES: [&str; 2] = ["zero-velocity", "dock-position"];
const SEED: u64 = 1;
/// Length of the scenario, s; `SHOWN_MAX_S` is the longest part that is shown.
const STAGE_S: f64 = 240.0;
const SHOWN_MAX_S: f64 = 45.0;

/// Renders the page of a kind as Markdown; its picture is the file of the same name beside it.
pub(super) fn markdown(kind: &'static FaultKind) -> String {
    let name = kind.name;
    let mut out = format!("# {name}\n\n{}\n\n", kind.summary);
    if has_picture(kind) {
        out += &format!("![{name}: the example, with the fault and without it]({name}.svg)\n\n");
    }
    out += &format!("{}\n\n", kind.model);
    out += &format!("Acts {}. Lasts {}.\n\n## Parameters\n\n", acts(kind.acts), lasts(kind.lasts));
    let takes = fault_parameters(name);
    let cell = |text: &str| text.replace('|', "\\|");
    if kind.parameters.is_empty() {
        out += "None.\n";
    } else {
        out += "| key | meaning | takes | default |\n|---|---|---|---|\n";
    }
    for parameter in kind.parameters {
        let takes = takes.iter().find(|(key, _)| *key == parameter.name);
        let takes = takes.map_or("", |(_, takes)| takes.as_str());
        let default =
            parameter.default.map_or_else(|| "always given".to_owned(), |d| format!("`{d}`"));
        out += &format!(
            "| `{}` | {} | {} | {} |\n",
            parameter.name,
            cell(parameter.doc),
            cell(takes),
            cell(&default)
        );
    }
    let example = fault_example(name).unwrap_or_default();
    out += &format!("\n## In a scenario\n\n```toml\n{example}```\n\n");
    out += &format!(
        "Family: {}. [How faults are written, and all kinds](../faults.md)\n",
        kind.family.name()
    );
    out
}

/// Returns whether a kind has a picture: a fault of the wire alters frames, and one of the host
/// only their timing, so there is no sample to draw.
pub(super) fn has_picture(kind: &FaultKind) -> bool {
    !matches!(kind.acts, Acts::Wire | Acts::Host | Acts::Power)
}

/// Returns the step in which the first fault of a scenario sets in.
fn onset(scenario: &Scenario, runs: &SideBySide) -> Option<u64> {
    let mut station = scenario.station(SEED).ok()??;
    let mut output = Output::default();
    for step in &runs.faulted {
        station.before(&mut step.command.clone(), &output, &mut Nothing);
        let first = station.occurrences().iter().find(|it| it.begins && it.fault == 0);
        if let Some(first) = first {
            return Some(first.epoch);
        }
        station.told();
        output = step.output.unwrap_or(output);
    }
    None
}

/// A world in which nothing can be done.
struct Nothing;

impl World for Nothing {
    fn disturbed(&mut self) -> Option<&mut dyn Disturbed> {
        None
    }

    fn truth(&self) -> Option<Truth> {
        None
    }
}

/// Returns what a picture shows of two runs.
fn shown(runs: &SideBySide) -> PictureRuns<'_> {
    PictureRuns {
        clean: runs.clean.iter().map(shown_step).collect(),
        faulted: runs.faulted.iter().map(shown_step).collect(),
    }
}

fn shown_step(step: &Step) -> PictureStep<'_> {
    PictureStep { command: step.command, delivered: &step.delivered, output: step.output.as_ref() }
}

/// Draws the picture of a kind: its example, simulated.
pub(super) fn picture(kind: &'static FaultKind) -> Result<String, Failure> {
    if !has_picture(kind) {
        return Err(Failure::input(format!(
            "found kind {}, which acts {}: expected a kind that acts on samples, to draw a picture",
            kind.name,
            acts(kind.acts)
        )));
    }
    let example = fault_example(kind.name).unwrap_or_default();
    for reference in REFERENCES {
        let text = format!(
            "{STAGE}[procedure.calibration.aiding]\nreference = \"{reference}\"\n{example}"
        );
        let file = format!("example of {}", kind.name);
        let scenario = Scenario::parse(&text, &file, Path::new(""), &[]).map_err(Failure::input)?;
        let period_s = scenario.sample_period_ns as f64 * 1e-9;
        let steps = (STAGE_S / period_s).round() as u64;
        let runs = side_by_side(&scenario, SEED, steps)?;
        let first_sample = runs.receipts.first().and_then(|receipt| receipt.first_sample);
        let Some(first_sample) = first_sample else { continue };
        // Inside the plant the effect may show later, in the next move.
        let inside = kind.acts == Acts::Plant;
        let onset = if inside { onset(&scenario, &runs) } else { None }.unwrap_or(first_sample);
        let duration = scenario.faults.first().and_then(|fault| fault.spec.schedule.duration);
        let lasts_s = duration.map_or_else(|| kind.example.shown_s, |n| n as f64 * period_s);
        let shown_s = (1.4 * lasts_s).clamp(10.0 * period_s, SHOWN_MAX_S);
        let after = (shown_s / period_s).round() as u64;
        let before = after * 3 / 10;
        let window = PictureWindow {
            from: onset.saturating_sub(before).max(1),
            onset,
            to: (onset + after).min(steps),
        };
        if let Some(svg) = draw(kind, &shown(&runs), window, period_s) {
            return Ok(svg);
        }
    }
    Err(Failure::bench(format!(
        "failed to draw {}: its example changes none of the drawn quantities",
        kind.name
    )))
}

/// Describes where a kind acts.
pub(crate) fn acts(acts: Acts) -> &'static str {
    match acts {
        Acts::Plant => "inside the simulated instrument, before its sensors measure",
        Acts::Command => "on set points on their way from the core to the turntable",
        Acts::Samples => "on samples and aiding on their way to the core",
        Acts::Delivery => "on the delivery of samples: lost, late, in another order",
        Acts::Unit => "on the unit under test itself",
        Acts::Wire => "on the wire between the harness and a device",
        Acts::Host => "on the host that the harness runs on",
        Acts::Power => "on the supply of a device",
        _ => "elsewhere",
    }
}

/// Describes how long a kind lasts.
pub(crate) fn lasts(lasts: Lasts) -> &'static str {
    match lasts {
        Lasts::Span => "for its duration (by default to the end of the run), then ends",
        Lasts::Fading => {
            "for its duration (by default to the end of the run), then fades linearly over its recovery"
        }
        Lasts::Instant => "an instant: it takes no duration",
    }
}
