//! `octant campaign report`: the page, the numbers and the evidence of a campaign.

use super::planned::read;
use crate::failure::Failure;
use crate::place::{CampaignPlace, Needs};
use crate::signing::signing_key;
use crate::terminal::{print, tell_account, write};
use clap::Args;
use octant_base::display::UnitChoice;
use octant_campaign::judge::shown::note_look;
use octant_campaign::report::file_names::PAGE;
use octant_campaign::report::{CampaignReport, ReportError};
use octant_campaign_pages::{campaign, evidence};
use octant_evidence::discrepancy::counted;
use octant_verdict::Verdict;
use std::path::PathBuf;
use std::time::SystemTime;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder of the campaign, or its address on object storage.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Write only the page, to this file, and leave the folder unchanged.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Units of errors on the page, instead of the scenarios': of position (arcmin, nmi, m, km), attitude (arcmin, deg,
    /// arcsec, mrad) and velocity (m/s, kn, cm/s), such as nmi,deg. Files for programs keep theirs.
    #[arg(long, value_name = "UNIT,UNIT")]
    units: Option<UnitChoice>,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let started = SystemTime::now();
    let Arguments { folder, out, units } = arguments;
    let mut place = CampaignPlace::of(folder, Needs::All)?;
    let folder = &place.folder().to_owned();
    let plan = read(folder)?;
    // An invalid key is reported before anything is written.
    let key = if out.is_none() { signing_key()? } else { None };
    let mut report = CampaignReport::of(&plan, folder)?;
    if plan.has_claims() || out.is_none() {
        note_look(&plan, folder, &report.status, "octant campaign report")?;
        report.reread_journal(folder)?;
    }
    if let Some(units) = *units {
        report.show_in(units)?;
    }
    let path = match out {
        Some(path) => {
            let page = campaign::render(&report, false);
            report.check()?;
            write(path, page)?;
            path.clone()
        }
        None => {
            evidence::write(&mut report, folder, key, started)?;
            place.put_back()?;
            folder.join(PAGE)
        }
    };
    report.statistics.inputs.iter().for_each(tell_account);
    let found = report.statistics.discrepancies.len();
    let verdict = report.statistics.verdict;
    print(&format!(
        "{}: {}\n  {}, {} without a disposition\n{}\n",
        plan.title,
        verdict.name(),
        counted(found),
        report.open(),
        place.shown(&path)
    ))?;
    Ok(verdict)
}

impl From<ReportError> for Failure {
    fn from(error: ReportError) -> Self {
        let failure = Self::of(&error);
        match error {
            ReportError::Plan(error) => error.into(),
            ReportError::Foreign(error) => error.into(),
            ReportError::Form { .. }
            | ReportError::Units { .. }
            | ReportError::Dispositions(_)
            | ReportError::Result(_)
            | ReportError::System { .. }
            | ReportError::Format { .. }
            | ReportError::Manifest(_) => failure.failed(),
        }
    }
}
