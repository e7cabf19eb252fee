//! `octant rejudge`: verdicts of a stored folder, by the rules of today.

use super::{Failure, print, print_json, write};
use crate::evidence::rejudge::{self, RejudgeError};
use clap::Args;
use octant_requirements::Verdict;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder of a run, a campaign or a night.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Where it is written what came of it; by default beside the folder, as DIR.rejudged.json.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let failed = |path: &Path, error: std::io::Error| {
        Failure::input(format!("failed to find {}: {error}", path.display()))
    };
    // By its real name: that of "." is needed for the file, and a link is no way into the folder.
    let folder = std::fs::canonicalize(&arguments.folder)
        .map_err(|error| failed(&arguments.folder, error))?;
    let out = match &arguments.out {
        Some(out) => out.clone(),
        None => {
            let mut name = folder.clone().into_os_string();
            name.push(".rejudged.json");
            name.into()
        }
    };
    let parent = out.parent().filter(|parent| !parent.as_os_str().is_empty());
    let parent = parent.unwrap_or(Path::new("."));
    let place = std::fs::canonicalize(parent).map_err(|error| failed(parent, error))?;
    if place.starts_with(&folder) {
        return Err(Failure::input(format!(
            "--out: found {}, which is in the folder that is judged: expected a file beside it",
            out.display()
        )));
    }
    let found = rejudge::folder(&arguments.folder).map_err(|error| {
        match error {
            RejudgeError::System { .. } => Failure::bench(error),
            _ => Failure::input(error),
        }
        .failed()
    })?;
    let text = serde_json::to_string_pretty(&found)
        .map_err(|error| Failure::bench(format!("failed to write the result as JSON: {error}")))?;
    write(&out, text + "\n")?;
    if arguments.json {
        print_json(&found)?;
    } else {
        print(&format!("{}{}\n", found.text(), out.display()))?;
    }
    Ok(found.verdict)
}
