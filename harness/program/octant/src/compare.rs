//! `octant compare`: two methods over many seeds, on the same instruments with the same noise.

use super::progress::with_progress;
use crate::arguments::{ScenarioArguments, load};
use crate::failure::Failure;
use crate::terminal::{print, print_json, write};
use clap::Args;
use octant_base::control::Control;
use octant_base::display::{DisplayUnits, UnitChoice};
use octant_evidence::manifest::shell_path;
use octant_run::paired::{MethodSide, paired};
use octant_scenario::{Method, Scenario};
use octant_score::compare::MethodComparison;
use octant_verdict::Verdict;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    scenario: ScenarioArguments,
    /// Reference scenario of the comparison. By default the scenario's own [baseline]; without a
    /// [baseline], the scenario without its --set.
    #[arg(long, value_name = "SCENARIO")]
    against: Option<PathBuf>,
    /// Number of seeds, counted up from the scenario's own.
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u64).range(2..=100_000))]
    seeds: u64,
    /// Folder for compare.json and compare.html; by default nothing is written.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Units of errors in report and terminal: of position (arcmin, nmi, m, km), attitude (arcmin, deg,
    /// arcsec, mrad) and velocity (m/s, kn, cm/s), such as nmi,deg.
    #[arg(long, value_name = "UNIT,UNIT")]
    units: Option<UnitChoice>,
    /// Print compare.json on stdout, and nothing else.
    #[arg(long)]
    json: bool,
}

/// Returns both sides: the reference method, and the method under comparison.
fn sides(
    arguments: &ScenarioArguments,
    against: Option<&Path>,
    units: Option<UnitChoice>,
) -> Result<(MethodSide, MethodSide), Failure> {
    let ScenarioArguments { scenario: file, set } = arguments;
    let side = |scenario, method| MethodSide { scenario, method };
    let chosen = units.map(|units| units.settings()).unwrap_or_default();
    let second = load(arguments, &chosen)?;
    if let Some(against) = against {
        let first = Scenario::load(against, &[]).map_err(Failure::input)?;
        return Ok((side(first, Method::Primary), side(second, Method::Primary)));
    }
    if second.baseline.is_some() {
        return Ok((side(second.clone(), Method::Baseline), side(second, Method::Primary)));
    }
    if set.is_empty() {
        return Err(Failure::input(format!(
            "failed to compare {}: found no [baseline], expected one, or --against SCENARIO, or --set \
             KEY=VALUE for the second method",
            file.display()
        )));
    }
    let first = Scenario::load(file, &[]).map_err(Failure::input)?;
    Ok((side(first, Method::Primary), side(second, Method::Primary)))
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let Arguments { scenario: of_scenario, against, seeds: count, out, units, json } = arguments;
    if let (Some(_), true, None) = (units, json, out) {
        return Err(Failure::input(
            "--units: found with --json, whose numbers have units of their own, expected --out DIR for a page in these \
             units, or no --json",
        ));
    }
    let (first, second) = sides(of_scenario, against.as_deref(), *units)?;
    let scenario = &second.scenario;
    let seeds: Vec<u64> = (0..*count).map(|n| scenario.seed.wrapping_add(n)).collect();
    let controls: Vec<Control> = (0..2 * seeds.len()).map(|_| Control::default()).collect();
    let samples = first.scenario.samples().zip(scenario.samples()).map(|(a, b)| a + b);
    let epochs = samples.map(|samples| samples * count);
    let sample_s = scenario.sample_period_ns as f64 * 1e-9;
    let comparison =
        with_progress(&controls, epochs, sample_s, || paired(&first, &second, &seeds, &controls))?;
    if let Some(folder) = out {
        let rerun = rerun(of_scenario, against.as_deref(), *count);
        write_results(folder, &comparison, &rerun, &scenario.display)?;
    }
    if *json {
        print_json(&comparison)?;
    } else {
        print(&octant_report::compare::table(&comparison, &scenario.display))?;
    }
    // With too few pairs nothing is shown.
    let compared = !comparison.cells.is_empty();
    Ok(if compared { Verdict::Pass } else { Verdict::Inconclusive })
}

/// Writes the comparison as JSON and as a page.
fn write_results(
    folder: &Path,
    comparison: &MethodComparison,
    rerun: &str,
    units: &DisplayUnits,
) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| {
        Failure::bench(format!("failed to create {}: {error}", folder.display()))
    })?;
    let json = serde_json::to_string_pretty(comparison)
        .map_err(|error| Failure::bench(format!("failed to write compare.json: {error}")))?;
    write(&folder.join("compare.json"), json + "\n")?;
    let provenance = [("rerun".to_owned(), rerun.to_owned())];
    let html = octant_report::compare::render(comparison, &provenance, units);
    write(&folder.join("compare.html"), html)
}

/// Returns the command line that makes the comparison again.
fn rerun(arguments: &ScenarioArguments, against: Option<&Path>, seeds: u64) -> String {
    let ScenarioArguments { scenario, set } = arguments;
    let mut line = format!("octant compare {}", shell_path(scenario));
    for set in set {
        line += &format!(" --set '{set}'");
    }
    if let Some(against) = against {
        line += &format!(" --against {}", shell_path(against));
    }
    line + &format!(" --seeds {seeds}")
}
