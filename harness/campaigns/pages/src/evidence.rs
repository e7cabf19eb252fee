//! Folder of a campaign as evidence: inputs, results, and a manifest with the hash of every file,
//! signed as that of a run.

use octant_campaign::plan::{INPUTS, Plan};
use octant_campaign::report::file_names::{JUNIT, PAGE, PREDICTION, STATISTICS};
use octant_campaign::report::junit::junit;
use octant_campaign::report::{CampaignReport, ReportError, again};
use octant_evidence::manifest::{CampaignFacts, JournalCounts, program_sha256};
use octant_evidence::signature::{self, SigningKey};
use octant_evidence::{Manifest, RunFacts, disposition};
use std::io::{BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;
use tempfile::NamedTempFile;

/// Writes everything into the folder of a campaign: dispositions, statistics, JUnit, page, copies
/// of the inputs, and the manifest last. Existing files with the same content aren't touched.
///
/// # Errors
/// If a file can't be written, or nothing can be appended to the dispositions: then nothing is
/// written.
pub fn write(
    report: &mut CampaignReport<'_>,
    folder: &Path,
    key: Option<Arc<SigningKey>>,
    started: SystemTime,
) -> Result<Manifest, ReportError> {
    let path = folder.join(disposition::FILE_NAME);
    let discrepancies = &report.statistics.discrepancies;
    // Without discrepancies and without an existing file there is nothing to write.
    if !(discrepancies.is_empty() && report.dispositions.text.is_empty()) {
        let dispositions = &report.dispositions;
        report.dispositions = dispositions.with(
            discrepancies,
            &path,
            "this campaign",
            "octant campaign report DIR",
        )?;
    }
    report.signature = key.as_ref().map(|key| format!("minisign key {}", key.id()));
    octant_campaign::execute::remove_locks(folder);
    let path_of = |name: &str| folder.join(name);
    let xml = new_junit(report, &path_of(JUNIT))?;
    let (statistics, prediction) = (report.statistics_json()?, report.prediction_json()?);
    let html = crate::campaign::render(report, true);
    report.check()?;
    if !report.dispositions.text.is_empty() {
        keep(&path, report.dispositions.text.as_bytes())?;
    }
    keep(&folder.join(STATISTICS), statistics.as_bytes())?;
    keep(&folder.join(PREDICTION), prediction.as_bytes())?;
    let wrong = |source| ReportError::System { action: "write", path: path_of(JUNIT), source };
    octant_base::whole_file::keep_new(&path_of(JUNIT), xml).map_err(wrong)?;
    keep(&folder.join(PAGE), html.as_bytes())?;
    inputs(report, folder)?;
    // An old signature doesn't apply to the new manifest.
    let old = folder.join(signature::FILE_NAME);
    match std::fs::remove_file(&old) {
        Err(source) if source.kind() != ErrorKind::NotFound => {
            return Err(ReportError::System { action: "remove", path: old, source });
        }
        _ => {}
    }
    let program = program_sha256();
    let [first, last] = report.run_between.map(|time| time.map(octant_base::utc::seconds));
    let facts = RunFacts {
        command_line: report.again().pop().unwrap_or_default(),
        campaign: Some(CampaignFacts {
            title: report.plan.title.clone(),
            plan: report.plan.id.clone(),
            verdict: report.statistics.verdict,
            cases: report.statistics.cases,
            open_cases: report.statistics.open,
            discrepancies: report.statistics.discrepancies.len(),
            open_discrepancies: report.open(),
            results_blake3: report.statistics.results_blake3.clone(),
            seed: report.statistics.seed.clone(),
            looks: report.statistics.looks.way.clone(),
            journal: Some(JournalCounts {
                entries: report.journal.len(),
                looks: report.journal.iter().filter(|entry| entry.is_look()).count(),
            }),
            program_sha256: program,
            made_by: report.made_by.clone(),
            selftest: report.selftest.as_ref().map(|test| test.verdict),
            first_result: first,
            last_result: last,
            rerun: again(report),
        }),
        key,
        accounts: report.statistics.inputs.clone(),
        ..RunFacts::between(started, SystemTime::now())
    };
    Ok(Manifest::write(folder, &facts)?)
}

/// Returns the names of the files of a folder that its plan, results and journal give otherwise. The folder was verified,
/// and its report was made by this program.
///
/// # Errors
/// If a report can't be made of the folder, or a file can't be read.
pub fn differing(
    plan: &Plan,
    folder: &Path,
    manifest: &Manifest,
) -> Result<Vec<&'static str>, ReportError> {
    let mut plan = plan.clone();
    plan.use_copies(folder);
    let mut report = CampaignReport::of(&plan, folder)?;
    // The folder may have another name now.
    let words = &manifest.command_line;
    if let Some(name) = words.get(3) {
        report.name.clone_from(name);
    }
    let units = words.iter().position(|word| word == "--units");
    if let Some(units) = units.and_then(|at| words.get(at + 1)?.parse().ok()) {
        report.show_in(units)?;
    }
    report.signature.clone_from(&manifest.signature);
    let mut xml = Vec::new();
    let wrong = |path: PathBuf| move |source| ReportError::System { action: "read", path, source };
    junit(&report, &mut xml).map_err(wrong(folder.join(JUNIT)))?;
    let (statistics, prediction) = (report.statistics_json()?, report.prediction_json()?);
    let page = crate::campaign::render(&report, true);
    report.check()?;
    let made: [(&'static str, &[u8]); 4] = [
        (STATISTICS, statistics.as_bytes()),
        (PREDICTION, prediction.as_bytes()),
        (JUNIT, &xml),
        (PAGE, page.as_bytes()),
    ];
    let mut differing = Vec::new();
    for (name, bytes) in made {
        let path = folder.join(name);
        if std::fs::read(&path).map_err(wrong(path))? != bytes {
            differing.push(name);
        }
    }
    Ok(differing)
}

/// Writes the JUnit file under another name: it is as long as the campaign, and gets its own name with the
/// others.
fn new_junit(report: &CampaignReport<'_>, path: &Path) -> Result<NamedTempFile, ReportError> {
    let folder = path.parent().unwrap_or(path);
    let wrong = |source| ReportError::System { action: "write", path: path.to_owned(), source };
    octant_base::whole_file::clean(folder);
    let new = octant_base::whole_file::new_file(folder).map_err(wrong)?;
    let mut writer = BufWriter::new(new.as_file());
    junit(report, &mut writer).and_then(|()| writer.flush()).map_err(wrong)?;
    drop(writer);
    Ok(new)
}

/// Copies the campaign's file, its requirements and its scenarios, if they are still the planned
/// ones. An existing copy stays.
fn inputs(report: &mut CampaignReport<'_>, folder: &Path) -> Result<(), ReportError> {
    let plan = report.plan;
    let mut files: Vec<(PathBuf, PathBuf)> = Vec::new();
    for scenario in &plan.scenarios {
        let copy = scenario.copied(folder).file;
        let bytes = std::fs::read(&scenario.file).ok();
        let planned = bytes.is_some_and(|b| blake3::hash(&b).to_hex().as_str() == scenario.blake3);
        if planned && !files.iter().any(|(_, other)| *other == copy) {
            files.push((scenario.file.clone(), copy));
        }
    }
    let folder = folder.join(INPUTS);
    if let Some(bundled) = &plan.bundled {
        let own = [
            (Some(&bundled.campaign), "campaign.toml"),
            (bundled.requirements.as_ref(), "requirements.toml"),
        ];
        for (planned, name) in own {
            files.extend(
                planned.filter(|p| p.check().is_ok()).map(|p| (p.file.clone(), folder.join(name))),
            );
        }
    // Only if the campaign's plan is still the same.
    } else if plan.is_of(&plan.campaign) {
        files.push((plan.campaign.clone(), folder.join("campaign.toml")));
        let campaign = octant_scenario::campaign::Campaign::load(&plan.campaign).ok();
        if let Some(path) = campaign.and_then(|campaign| campaign.requirements) {
            files.push((path, folder.join("requirements.toml")));
        }
    }
    if files.is_empty() {
        return Ok(());
    }
    std::fs::create_dir_all(&folder).map_err(|source| ReportError::System {
        action: "create",
        path: folder.clone(),
        source,
    })?;
    for (from, to) in files {
        let bytes = std::fs::read(&from).map_err(|source| ReportError::System {
            action: "read",
            path: from,
            source,
        })?;
        keep(&to, &bytes)?;
    }
    Ok(())
}

/// Writes a file whole or not at all, and only if it changes.
fn keep(path: &Path, bytes: &[u8]) -> Result<(), ReportError> {
    let wrong = |source| ReportError::System { action: "write", path: path.to_owned(), source };
    octant_base::whole_file::keep(path, bytes).map_err(wrong)
}
