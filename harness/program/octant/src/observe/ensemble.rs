//! `octant observe --ensemble`: predicted result of a scenario's draws, and the comparison with its
//! cases.

use crate::arguments::{ScenarioArguments, load};
use crate::failure::Failure;
use crate::terminal::{print, print_json};
use octant_base::display::{DisplayUnits, UnitChoice};
use octant_base::number::{counted, significant};
use octant_campaign::against::{Against, EnsembleComparison, Selection, against};
use octant_campaign::plan::{FILE_NAME, Plan};
use octant_campaign::report::sites;
use octant_observe::ensemble::{DriftBand, Ensemble, ErrorBand, SolutionBands, ensemble};
use octant_scenario::Scenario;
use octant_verdict::Verdict;
use std::fmt::Write as _;
use std::path::Path;

/// Number of rows of a drift that are shown.
const DRIFT_ROWS: usize = 12;

pub(super) fn command(
    arguments: &ScenarioArguments,
    folder: Option<&Path>,
    units: UnitChoice,
    json: bool,
) -> Result<Verdict, Failure> {
    let scenario = load(arguments, &[])?;
    match folder {
        None => predict(&scenario, &scenario.display.with(units), json),
        Some(folder) => hold(arguments, folder, units, json),
    }
}

fn predict(scenario: &Scenario, units: &DisplayUnits, json: bool) -> Result<Verdict, Failure> {
    let ensembles = (scenario.methods())
        .map(|method| ensemble(scenario, method))
        .collect::<Result<Vec<_>, _>>()
        .map_err(|error| Failure::input(format!("failed to {error}")))?;
    if json {
        print_json(&ensembles)?;
    } else {
        for ensemble in &ensembles {
            print(&text(ensemble, units))?;
        }
    }
    Ok(Verdict::Pass)
}

fn hold(
    arguments: &ScenarioArguments,
    folder: &Path,
    units: UnitChoice,
    json: bool,
) -> Result<Verdict, Failure> {
    let ScenarioArguments { scenario, set } = arguments;
    let plan = Plan::read(&folder.join(FILE_NAME))?;
    let bytes = std::fs::read(scenario).map_err(|error| {
        Failure::input(format!("failed to read {}: {error}", scenario.display()))
    })?;
    let blake3 = blake3::hash(&bytes).to_hex().to_string();
    if !plan.scenarios.iter().any(|planned| planned.blake3 == blake3) {
        let names: Vec<String> =
            plan.scenarios.iter().map(|planned| planned.file.display().to_string()).collect();
        return Err(Failure::input(format!(
            "failed to compare with {}: found {}, expected one of its scenarios: {}",
            folder.display(),
            scenario.display(),
            names.join(", ")
        )));
    }
    let set = (!set.is_empty()).then_some(set.as_slice());
    let found = against(&plan, folder, &Selection { blake3: Some(&blake3), set })
        .map_err(|reason| Failure::input(format!("failed to {reason}")))?;
    if json {
        print_json(&found)?;
    } else {
        for comparison in &found.compared {
            // Several ensembles of a scenario can have several sites.
            let at_site = sites::of_ensemble(&plan, folder, comparison)?;
            print(&compared(&comparison.shown(&at_site.with(units))))?;
        }
        for left_out in &found.left_out {
            print(&format!("left out: {left_out}\n"))?;
        }
    }
    Ok(verdict(&found))
}

/// Returns the verdict of the comparison; inconclusive if nothing was compared.
fn verdict(found: &Against) -> Verdict {
    let of = |comparison: &EnsembleComparison| match comparison.stands {
        Some(true) => Verdict::Pass,
        Some(false) => Verdict::Fail,
        None => Verdict::Inconclusive,
    };
    let least = if found.compared.is_empty() { Verdict::Inconclusive } else { Verdict::Pass };
    found.compared.iter().map(of).fold(least, Verdict::worst)
}

fn text(ensemble: &Ensemble, units: &DisplayUnits) -> String {
    let figure = |value: f64| significant(value, 4);
    let mut out = format!("{}, as an ensemble\n", ensemble.method);
    let _ = writeln!(
        out,
        "  {:24} {:>12} {:>12} {:>12} {:>12}  unit",
        "1σ after the calibration", "before", "believed", "achieved", "mean"
    );
    for state in &ensemble.states {
        let _ = writeln!(
            out,
            "  {:24} {:>12} {:>12} {:>12} {:>12}  {}",
            state.name,
            figure(state.prior),
            state.believed.map_or("-".to_owned(), figure),
            figure(state.sigma),
            figure(state.mean),
            state.unit
        );
    }
    if !ensemble.drift.is_empty() {
        out += &drift(&ensemble.drift, units);
    }
    if let Some(last) = ensemble.drift.last()
        && let Some(bands) = &last.solution
    {
        out += &solution(last.hours, bands, units);
    }
    let _ = writeln!(out, "  not modelled:");
    for what in &ensemble.not_modelled {
        let _ = writeln!(out, "    {what}");
    }
    out
}

/// Table of the drift over the ensemble.
fn drift(rows: &[DriftBand], units: &DisplayUnits) -> String {
    let (in_latitude, in_longitude, in_radial) =
        (units.latitude(), units.longitude(), units.radial());
    let mut out = format!(
        "  drift of the ensemble: percentiles 5 %, 50 % and 95 % of the runs\n  {:>6} {:>29} {:>29} {:>19}\n",
        "hours",
        format!("latitude, {}", in_latitude.name),
        format!("longitude, {}", in_longitude.name),
        format!("50, 95 %, {}", in_radial.name)
    );
    let every = (rows.len() / DRIFT_ROWS).max(1);
    for row in rows.iter().skip(every - 1).step_by(every) {
        let _ = write!(out, "  {:>6.1}", row.hours);
        let ErrorBand { p5, p50, p95, .. } = row.latitude_arcmin;
        let latitude = [p5, p50, p95].map(|value| in_latitude.of(value));
        let ErrorBand { p5, p50, p95, .. } = row.longitude_arcmin;
        let longitude = [p5, p50, p95].map(|value| in_longitude.of(value));
        let radial = [row.radial_nmi.p50, row.radial_nmi.p95].map(|value| in_radial.of(value));
        let columns =
            [(&latitude[..], in_latitude), (&longitude, in_longitude), (&radial, in_radial)];
        for (values, unit) in columns {
            // A digit more than the scores have.
            let decimals = unit.decimals + 1;
            for value in values {
                let _ = write!(out, " {value:>9.decimals$}");
            }
        }
        out.push('\n');
    }
    out
}

/// Table of attitude and velocity over the ensemble at the end.
fn solution(hours: f64, bands: &SolutionBands, units: &DisplayUnits) -> String {
    let mut out = format!(
        "  {:24} {:>12} {:>12} {:>12} {:>12}  unit\n",
        format!("attitude, velocity, {hours:.1} h"),
        "σ",
        "5 %",
        "50 %",
        "95 %"
    );
    let (attitude, velocity) = (units.attitude(), units.velocity());
    let names = [
        ("heading", attitude),
        ("pitch", attitude),
        ("roll", attitude),
        ("velocity north", velocity),
        ("velocity east", velocity),
    ];
    for ((name, unit), band) in names.into_iter().zip(bands.all()) {
        let [sigma, p5, p50, p95] =
            [band.sigma, band.p5, band.p50, band.p95].map(|value| significant(unit.of(value), 4));
        let _ =
            writeln!(out, "  {name:24} {sigma:>12} {p5:>12} {p50:>12} {p95:>12}  {}", unit.name);
    }
    out
}

fn compared(comparison: &EnsembleComparison) -> String {
    let figure = |value: f64| significant(value, 4);
    let mut out = format!("{}, {}", comparison.scenario, comparison.method);
    if !comparison.set.is_empty() {
        let _ = write!(out, ", {}", comparison.set.join(", "));
    }
    let _ = writeln!(out, ": {}", counted(comparison.runs, "run", "runs"));
    for words in &comparison.words {
        let _ = writeln!(out, "  {words}");
    }
    let _ = writeln!(
        out,
        "  {:24} {:>12} {:>12} {:>25} {:>7}  unit",
        "σ", "predicted", "simulated", "within", "ratio"
    );
    let rows = comparison.states.iter().chain(&comparison.drift);
    for row in rows {
        let mark = if row.agrees { "" } else { "  differs" };
        let _ = writeln!(
            out,
            "  {:24} {:>12} {:>12} {:>12} {:>12} {:>7}  {}{mark}",
            row.name,
            figure(row.predicted_sigma),
            figure(row.simulated_sigma.value),
            figure(row.simulated_sigma.low),
            figure(row.simulated_sigma.high),
            row.ratio.map_or("-".to_owned(), |ratio| format!("{ratio:.3}")),
            row.unit
        );
    }
    out
}
