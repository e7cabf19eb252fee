//! `octant compare`: two methods over many seeds, on the same instruments with the same noise.

use super::progress::with_progress;
use crate::arguments::{ScenarioArguments, load};
use crate::failure::Failure;
use crate::terminal::{print, print_json, write};
use clap::Args;
use octant_base::control::Control;
use octant_base::display::{DisplayUnits, UnitChoice};
use octant_requirements::Verdict;
use octant_run::paired::{MethodSide, paired};
use octant_scenario::{Method, Scenario};
use octant_score::compare::MethodComparison;
use std::path::PathBuf;

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
fn sides(arguments: &Arguments) -> Result<(MethodSide, MethodSide), Failure> {
    let side = |scenario, method| MethodSide { scenario, method };
    let chosen = arguments.units.map(|units| units.settings()).unwrap_or_default();
    let second = load(&arguments.scenario, &chosen)?;
    if let Some(against) = &arguments.against {
        let first = Scenario::load(against, &[]).map_err(Failure::input)?;
        return Ok((side(first, Method::Primary), side(second, Method::Primary)));
    }
    if second.baseline.is_some() {
        return Ok((side(second.clone(), Method::Baseline), side(second, Method::Primary)));
    }
    if arguments.scenario.set.is_empty() {
        return Err(Failure::input(format!(
            "failed to compare {}: found no [baseline], expected one, or --against SCENARIO, or --set \
             KEY=VALUE for the second method",
            arguments.scenario.scenario.display()
        )));
    }
    let first = Scenario::load(&arguments.scenario.scenario, &[]).map_err(Failure::input)?;
    Ok((side(first, Method::Primary), side(second, Method::Primary)))
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let (first, second) = sides(arguments)?;
    let scenario = &second.scenario;
    let seeds: Vec<u64> = (0..arguments.seeds).map(|n| scenario.seed.wrapping_add(n)).collect();
    let controls: Vec<Control> = (0..2 * seeds.len()).map(|_| Control::default()).collect();
    let samples = first.scenario.samples().zip(scenario.samples()).map(|(a, b)| a + b);
    let epochs = samples.map(|samples| samples * arguments.seeds);
    let sample_s = scenario.sample_period_ns as f64 * 1e-9;
    let comparison =
        with_progress(&controls, epochs, sample_s, || paired(&first, &second, &seeds, &controls))?;
    write_results(arguments, &comparison, &scenario.display)?;
    // With too few pairs nothing is shown.
    let compared = !comparison.cells.is_empty();
    Ok(if compared { Verdict::Pass } else { Verdict::Inconclusive })
}

fn write_results(
    arguments: &Arguments,
    comparison: &MethodComparison,
    units: &DisplayUnits,
) -> Result<(), Failure> {
    if let Some(folder) = &arguments.out {
        std::fs::create_dir_all(folder).map_err(|error| {
            Failure::bench(format!("failed to create {}: {error}", folder.display()))
        })?;
        let json = serde_json::to_string_pretty(comparison)
            .map_err(|error| Failure::bench(format!("failed to write compare.json: {error}")))?;
        write(&folder.join("compare.json"), json + "\n")?;
        let mut line = vec![
            "octant".to_owned(),
            "compare".to_owned(),
            arguments.scenario.scenario.display().to_string(),
        ];
        for set in &arguments.scenario.set {
            line.extend(["--set".to_owned(), format!("'{set}'")]);
        }
        if let Some(against) = &arguments.against {
            line.extend(["--against".to_owned(), against.display().to_string()]);
        }
        line.extend(["--seeds".to_owned(), arguments.seeds.to_string()]);
        let provenance = [("rerun".to_owned(), line.join(" "))];
        let html = octant_report::compare::render(comparison, &provenance, units);
        write(&folder.join("compare.html"), html)?;
    }
    if arguments.json {
        print_json(comparison)
    } else {
        print(&octant_report::compare::table(comparison, units))
    }
}
