//! `octant diff`: two runs or two campaigns side by side.

use crate::failure::Failure;
use crate::terminal::{note, print, print_json, write};
use clap::Args;
use octant_diff::side::Side;
use octant_diff::{CampaignDiff, is_campaign, page, runs, text};
use octant_verdict::Verdict;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder of a run or a campaign, or a recording.
    #[arg(value_name = "A")]
    first: PathBuf,
    /// The same, to compare it with.
    #[arg(value_name = "B")]
    second: PathBuf,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
    /// File for a page with plots over each other.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let Arguments { first, second, json, out } = arguments;
    let (is_equal, html) = match (is_campaign(first), is_campaign(second)) {
        (true, true) => {
            let diff = CampaignDiff::of(first, second).map_err(failed)?;
            if *json {
                print_json(&diff)?
            } else {
                print(&text::of_campaigns(&diff))?
            }
            (diff.equal, out.as_ref().map(|_| page::of_campaigns(&diff)))
        }
        (false, false) => {
            let first = Side::read(first).map_err(failed)?;
            let second = Side::read(second).map_err(failed)?;
            let diff = runs(&first, &second).map_err(failed)?;
            if *json {
                print_json(&diff)?
            } else {
                print(&text::of_runs(&diff))?
            }
            (diff.equal, out.as_ref().map(|_| page::of_runs(&diff, [&first, &second])))
        }
        (is_first, _) => {
            let [campaign, run] = if is_first { [first, second] } else { [second, first] };
            return Err(Failure::input(format!(
                "{} is a campaign and {} isn't, expected two runs or two campaigns",
                campaign.display(),
                run.display()
            )));
        }
    };
    if let (Some(path), Some(html)) = (out, html) {
        write(path, html)?;
        note!("octant: wrote {}", path.display());
    }
    Ok(if is_equal { Verdict::Pass } else { Verdict::Fail })
}

fn failed(error: octant_diff::DiffError) -> Failure {
    Failure::input(error).failed()
}
