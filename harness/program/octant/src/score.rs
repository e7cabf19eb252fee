//! `octant score`: scoring alone, from a recording that has truth and outputs, or of a solution that is made already.

use crate::failure::Failure;
use crate::given::GivenOptions;
use crate::score_solution::SolutionArguments;
use crate::terminal::{print, print_json};
use clap::Args;
use octant_base::display::{DisplayUnits, UnitChoice};
use octant_recorder::Event;
use octant_recorder::reader::Recording;
use octant_run::planned_of;
use octant_scenario::resolve::{DrawnValues, Seeded};
use octant_scenario::{Method, Scenario};
use octant_score::parameters::{nees, score, worst_normalized_error};
use octant_score::summary::{HeightChannel, NavigationScore, ParameterScore};
use octant_verdict::Verdict;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder of a run, or a recording, an MCAP file.
    #[arg(value_name = "RUN", required_unless_present = "solution")]
    run: Option<PathBuf>,
    #[command(flatten)]
    solution: SolutionArguments,
    /// Units of errors on the terminal, instead of the scenario's: of position (arcmin, nmi, m, km), attitude (arcmin, deg,
    /// arcsec, mrad) and velocity (m/s, kn, cm/s), such as nmi,deg.
    #[arg(long, value_name = "UNIT,UNIT")]
    units: Option<UnitChoice>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Scores of a recording.
#[derive(Serialize)]
struct Scores {
    scenario: String,
    method: String,
    nis_mean: Option<f64>,
    nees: BTreeMap<String, f64>,
    worst_normalized_error: Option<f64>,
    parameters: BTreeMap<String, ParameterScore>,
    navigation: Option<NavigationScore>,
    /// First rule that the unit's answers broke; the scores cover the time before it.
    misbehaved: Option<String>,
}

/// Returns whether the instrument of a recording had the errors that its scenario draws.
pub(super) fn true_parameters(path: &Path, scenario: &Scenario) -> Result<bool, Failure> {
    let recording = Recording::open(path)
        .map_err(|error| Failure::input(format!("failed to read {}: {error}", path.display())))?;
    // Recordings from before FMUs don't state it.
    let said = recording.info().run.get("true_parameters").map(|text| text == "true");
    Ok(said.unwrap_or(scenario.source.is_plant_alone()))
}

/// Returns the scenario inside a recording.
pub(super) fn scenario_of(path: &Path) -> Result<(Scenario, Method, u64), Failure> {
    let recording = Recording::open(path)
        .map_err(|error| Failure::input(format!("failed to read {}: {error}", path.display())))?;
    let info = recording.info();
    let name = format!("scenario.toml in {}", path.display());
    let folder = path.parent().unwrap_or(Path::new(""));
    let scenario = Scenario::parse(&info.scenario, &name, folder, &[]).map_err(Failure::input)?;
    let method = match info.run.get("method").map(String::as_str) {
        Some("baseline") => Method::Baseline,
        _ => Method::Primary,
    };
    let seed = info.run.get("seed").and_then(|seed| seed.parse().ok()).unwrap_or(scenario.seed);
    Ok((scenario, method, seed))
}

pub(super) fn command(arguments: &Arguments, given: &GivenOptions) -> Result<Verdict, Failure> {
    let Arguments { run, solution, units, json } = arguments;
    let Some(run) = run else {
        let units = units.map(|units| units.settings()).unwrap_or_default();
        return super::score_solution::command(solution, units, *json);
    };
    // clap lets a requirement go that conflicts with what is there.
    given.refuse::<SolutionArguments>(format!(
        "found the run {}, expected --solution FILE in its place: the option is for solutions alone",
        run.display()
    ))?;
    if units.is_some() && *json {
        return Err(Failure::input(
            "--units: found with --json, whose numbers have units of their own, expected no --json",
        ));
    }
    let path = &crate::run_folder::recording_of(run)?;
    let (scenario, method, seed) = scenario_of(path)?;
    let (observed, last_event) = super::report::watch(path, &scenario, method)?;
    let navigation = match observed.drift.scored() {
        Some(drift) => Some(
            drift
                .finish(HeightChannel::Held)
                .map_err(|error| Failure::input(format!("failed to {error}")))?,
        ),
        None => None,
    };
    let draws = DrawnValues::of(&scenario, &Seeded(seed));
    let truth = true_parameters(path, &scenario)?.then_some(draws.parameters);
    let parameters = observed
        .convergence
        .last
        .map(|estimate| score(truth.as_ref(), &estimate.parameters, &estimate.sigma))
        .unwrap_or_default();
    let plan = scenario.calibration_of(method);
    let planned = plan.map(planned_of).unwrap_or_default();
    let scores = Scores {
        scenario: scenario.title.clone(),
        method: scenario.method_label(method),
        nis_mean: observed.measurements.health.nis_mean(),
        nees: nees(&parameters, &BTreeMap::new()),
        worst_normalized_error: worst_normalized_error(&parameters, &planned),
        parameters,
        navigation,
        misbehaved: observed.answers.misbehaved.as_ref().map(ToString::to_string),
    };
    if scores.navigation.is_none() && scores.parameters.is_empty() && scores.misbehaved.is_none() {
        if let Some(Event::Refused { reason }) = last_event {
            return Err(Failure::input(format!(
                "failed to score {}: its calibration was refused: {reason}",
                path.display()
            )));
        }
        return Err(Failure::input(format!(
            "failed to score {}: it has neither parameters nor a navigation with truth",
            path.display()
        )));
    }
    if *json {
        print_json(&scores)?;
    } else {
        print(&text(&scores, &scenario.display.with(units.unwrap_or_default())))?;
    }
    Ok(if scores.misbehaved.is_some() { Verdict::Fail } else { Verdict::Pass })
}

fn text(scores: &Scores, units: &DisplayUnits) -> String {
    use std::fmt::Write as _;
    let mut out = format!("{}: {}\n", scores.scenario, scores.method);
    if let Some(misbehaved) = &scores.misbehaved {
        let _ = writeln!(out, "  {misbehaved}; the scores below cover the time before that");
    }
    if let Some(nis) = scores.nis_mean {
        let _ = writeln!(out, "  NIS {nis:.3} (expected 3)");
    }
    for (group, nees) in &scores.nees {
        let _ = writeln!(out, "  {group:20} squared error / variance {nees:.2} (expected 1)");
    }
    if scores.parameters.values().all(|p| p.r#true.is_none()) {
        out += &octant_run::assemble::parameter_lines(&scores.parameters);
    }
    if let Some(navigation) = &scores.navigation {
        let radial = units.radial();
        let _ = writeln!(
            out,
            "  navigation {} h, height held",
            octant_base::number::plain(navigation.duration_h, 4)
        );
        for (name, _, error) in navigation.errors() {
            let Some(error) = error else { continue };
            let unit = units.of(name);
            let digits = unit.decimals;
            let _ = writeln!(
                out,
                "    {name:10} max {:.digits$}, rms {:.digits$}, final {:+.digits$} {}",
                unit.of(error.max),
                unit.of(error.rms),
                unit.of(error.r#final),
                unit.name
            );
        }
        if let Some(score) = navigation.radial_error_nmi {
            let (digits, finer) = (radial.decimals, radial.decimals + 1);
            let _ = writeln!(
                out,
                "    radial     max {:.digits$}, rms {:.digits$} {name}, {:.finer$} {name}/h",
                radial.of(score.max),
                radial.of(score.rms),
                radial.of(score.rate_per_h),
                name = radial.name
            );
        }
    }
    out
}
