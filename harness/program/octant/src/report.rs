//! `octant report`: renders the report of a finished run again.

use crate::failure::Failure;
use crate::terminal::note;
use crate::terminal::{print, write};
use clap::Args;
use octant_base::display::UnitChoice;
use octant_base::whole_file::keep;
use octant_calibration::table::CalibrationTable;
use octant_evidence::discrepancy::counted;
use octant_evidence::disposition::Dispositions;
use octant_evidence::manifest::{FILE_NAME as MANIFEST, shell_line};
use octant_evidence::planned::unplanned;
use octant_evidence::statements::SUMMARY;
use octant_evidence::{Manifest, ManifestError, discrepancy};
use octant_faults::rule::UnitEvent;
use octant_recorder::Event;
use octant_recorder::reader::{Epochs, Recording};
use octant_report::{ReportData, ReportProvenance, SolutionSeries};
use octant_run::observers::done::PlannedWork;
use octant_run::observers::filtered::FilteredSeries;
use octant_run::{Observers, unit};
use octant_sample::Parameters;
use octant_sample::parameters::{NAMES, PARAMETER_COUNT, ParameterGroup};
use octant_scenario::file_names::FileNames;
use octant_scenario::{HeadingCondition, Method, Scenario};
use octant_score::numerics::differs;
use octant_score::rederive;
use octant_score::summary::Summary;
use octant_source::Epoch;
use octant_verdict::Verdict;
use std::path::{Path, PathBuf};

/// Recording of the baseline, in the folder of a run.
const BASELINE: &str = "baseline.mcap";
/// Calibration table, in the folder of a run.
const TABLE: &str = "calibration.octcal";

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder of a run, or its recording.
    #[arg(value_name = "RUN")]
    run: PathBuf,
    /// File for the report; by default report.html in the current folder, because the manifest of
    /// the run covers the files in its folder.
    #[arg(long, value_name = "FILE", default_value = "report.html")]
    out: PathBuf,
    /// File with the dispositions of the run's discrepancies. New discrepancies are added at its end;
    /// existing entries and the run's own files don't change.
    #[arg(long, value_name = "FILE")]
    dispositions: Option<PathBuf>,
    /// Units of errors in the report, instead of the scenario's: of position (arcmin, nmi, m, km), attitude (arcmin, deg,
    /// arcsec, mrad) and velocity (m/s, kn, cm/s), such as nmi,deg.
    #[arg(long, value_name = "UNIT,UNIT")]
    units: Option<UnitChoice>,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let Arguments { run, out, dispositions: said_in, units } = arguments;
    let folder = crate::run_folder::folder_of(run);
    if !folder.join(MANIFEST).exists() {
        let run = folder.display();
        return Err(Failure::input(format!(
            "found no {MANIFEST} in {run}, expected the folder of a run"
        )));
    }
    // Only files that the manifest confirms are shown: the summary, the scenario and the recording
    // must be those of the run.
    let manifest =
        Manifest::read(folder).map_err(|error| Failure::input(format!("failed to {error}")))?;
    let failed = |error: ManifestError| Failure::input(error).failed();
    let path = folder.join(SUMMARY);
    let bytes = manifest.read_file(folder, SUMMARY).map_err(failed)?;
    let wrong =
        |reason: String| Failure::input(format!("failed to read {}: {reason}", path.display()));
    let text = String::from_utf8(bytes).map_err(|_| wrong("it isn't UTF-8 text".to_owned()))?;
    let summary =
        Summary::from_json(&text).map_err(|error| Failure::input(format!("failed to {error}")))?;
    let found = rederive::contradictions(&summary);
    if !found.is_empty() {
        return Err(wrong(format!("it contradicts itself: {}", found.join("; "))));
    }
    if let Some(told) = differs(summary.numerics) {
        note!("octant: {}: {told}; octant rejudge derives the verdict again", path.display());
    }
    for name in ["scenario.toml", "recording.mcap"] {
        manifest.check_file(folder, name).map_err(failed)?;
    }
    let scenario_path = folder.join("scenario.toml");
    let scenario = Scenario::load(&scenario_path, &[]).map_err(Failure::input)?;
    let found = unplanned(&scenario, &summary);
    if !found.is_empty() {
        return Err(wrong(format!("it isn't what was planned: {}", found.join("; "))));
    }
    let dispositions = match said_in {
        None => Dispositions::default(),
        Some(path) => disposed(&summary, path, folder)?,
    };
    let (observed, _) = watch(&folder.join("recording.mcap"), &scenario, Method::Primary)?;
    let baseline = folder.join(BASELINE);
    let (baseline_solution, baseline_calibration_errors) = if baseline.exists() {
        manifest.check_file(folder, BASELINE).map_err(failed)?;
        let (observed, _) = watch(&baseline, &scenario, Method::Baseline)?;
        (observed.drift.solution, calibration_errors(observed.charts.filtered))
    } else {
        Default::default()
    };
    let data = ReportData {
        truth: truth(&summary),
        facts: octant_run::assemble::facts(&scenario),
        axes_of_source: FileNames::of(&scenario.source).line(),
        events: observed.measurements.events(),
        navigation_start_h: observed.drift.start_h(),
        solution: observed.drift.solution,
        baseline_solution,
        calibration_errors: calibration_errors(observed.charts.filtered),
        baseline_calibration_errors,
        latitude_rad: Some(scenario.site.latitude_rad),
        sample_period_s: Some(scenario.sample_period_ns as f64 * 1e-9),
        covariance: covariance(&manifest, folder)?,
        requirement_texts: octant_run::assemble::requirement_texts(&scenario),
        requirement_clauses: scenario.requirement_clauses(),
        heading_condition: HeadingCondition::of(&scenario).words(),
        convergence: observed.convergence.points,
        nis: observed.measurements.nis,
        gimbals: observed.gimbals.points,
        stops: octant_run::assemble::stop_labels(&scenario),
        provenance: provenance(&manifest),
        dispositions,
        units: scenario.display.with(units.unwrap_or_default()),
        summary,
    };
    let html = octant_report::run::render(&data);
    if let Some(path) = said_in {
        // Without any discrepancy there is nothing to write.
        if !data.dispositions.text.is_empty() {
            keep(path, data.dispositions.text.as_bytes()).map_err(|error| {
                Failure::bench(format!("failed to write {}: {error}", path.display()))
            })?;
        }
        let found = discrepancy::of_run(&data.summary);
        let open = data.dispositions.open(&found).count();
        print(&format!("{}, {open} without a disposition\n", counted(found.len())))?;
    }
    write(out, html)?;
    print(&format!("{}\n", out.display()))?;
    Ok(Verdict::Pass)
}

/// Reads the covariance of the run's calibration table; `None` for a run without one.
fn covariance(
    manifest: &Manifest,
    run: &Path,
) -> Result<Option<Box<[[f64; PARAMETER_COUNT]; PARAMETER_COUNT]>>, Failure> {
    if !run.join(TABLE).exists() {
        return Ok(None);
    }
    let bytes = manifest.read_file(run, TABLE).map_err(|error| Failure::input(error).failed())?;
    let table = CalibrationTable::from_bytes(&bytes).map_err(|error| {
        Failure::input(format!("failed to read {}: {error}", run.join(TABLE).display()))
    })?;
    Ok(Some(Box::new(table.covariance)))
}

/// Reads the dispositions of a run's discrepancies, and adds an entry for each that had none.
fn disposed(summary: &Summary, path: &Path, run: &Path) -> Result<Dispositions, Failure> {
    let found = discrepancy::of_run(summary);
    let said =
        Dispositions::read(path).map_err(|error| Failure::input(format!("failed to {error}")))?;
    if found.is_empty() && said.text.is_empty() {
        return Ok(said);
    }
    let [run, file] = [run, path].map(|path| path.display().to_string());
    let again = shell_line(&["octant".into(), "report".into(), run, "--dispositions".into(), file]);
    said.with(&found, path, "this run", &again)
        .map_err(|error| Failure::input(format!("failed to {error}")))
}

/// Errors of attitude and velocity of a calibration by a filter.
fn calibration_errors(filtered: Option<FilteredSeries>) -> SolutionSeries {
    filtered.map(|filtered| filtered.errors).unwrap_or_default()
}

/// Feeds the recording of a method to observers; returns them with the recording's last event.
pub(super) fn watch(
    path: &Path,
    scenario: &Scenario,
    method: Method,
) -> Result<(Observers, Option<Event>), Failure> {
    let bad = |error: &dyn std::fmt::Display| {
        Failure::input(format!("failed to read {}: {error}", path.display()))
    };
    let recording = Recording::open(path).map_err(|error| bad(&error))?;
    // No comparison with a plan: a decimated recording doesn't contain all of the work.
    let mut observed = Observers::new(PlannedWork::lasting(scenario));
    observed.recorded(&recording.info().run);
    observed.charts.filtered = FilteredSeries::of(scenario, method);
    let mut epochs = Epochs::new(recording);
    let mut last = None;
    while let Some(epoch) = epochs.next_epoch().map_err(|error| bad(&error))? {
        let Some(output) = &epoch.output else { continue };
        last = Some(*output);
        for event in &epoch.events {
            if unit::of(event).ok().flatten().is_some_and(|event| event != UnitEvent::PowerOff) {
                observed.restarted();
            }
        }
        let wanted = match epoch.sample {
            Some(sample) => {
                let sent = Epoch { sample, aiding: epoch.aiding };
                observed.answer(&sent, true, output)
            }
            None => observed.epoch(output),
        };
        if let Some(innovation) = &epoch.innovation {
            observed.innovation(output, innovation);
        }
        if let Some(estimate) = &epoch.parameters {
            observed.parameters(output, estimate);
        }
        if let (true, Some(truth)) = (wanted, &epoch.truth) {
            observed.truth(output, truth);
        }
    }
    let concluded = epochs.last_event().and_then(octant_recorder::concluded::estimate);
    if let (Some(output), Some(estimate)) = (last, concluded) {
        observed.parameters(&output, &estimate);
    }
    if epochs.recording().truncated() {
        note!("octant: {} is truncated; the part before that is used", path.display());
    }
    Ok((observed, epochs.last_event().cloned()))
}

/// Reads the true parameters from a summary.
fn truth(summary: &Summary) -> Option<Parameters> {
    let calibration = summary.calibration.as_ref()?;
    let mut all = [0.0; NAMES.len()];
    for (i, name) in NAMES.iter().enumerate() {
        all[i] = calibration.parameters.get(*name)?.r#true? * ParameterGroup::of(i).si_per_unit();
    }
    Some(Parameters::from_array(&all))
}

/// Reads the provenance of a run from its manifest.
pub(super) fn provenance(manifest: &Manifest) -> ReportProvenance {
    ReportProvenance { entries: manifest.entries(), rerun: manifest.rerun.clone() }
}
