//! `octant rejudge`: derives the verdicts of a stored folder by the present rules.

use crate::failure::Failure;
use crate::terminal::{print, print_json, write};
use clap::Args;
use octant_verdict::Verdict;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder of a run, a campaign or a night.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// File for the result; by default DIR.rejudged.json, beside the folder.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let Arguments { folder: given, out, json } = arguments;
    let failed = |path: &Path, error: std::io::Error| {
        Failure::input(format!("failed to find {}: {error}", path.display()))
    };
    // Canonical, because the default name of the output needs the real name of ".", and because a
    // link must not lead the output into the folder.
    let folder = std::fs::canonicalize(given).map_err(|error| failed(given, error))?;
    let out = match out {
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
            "--out: found {}, which is in the judged folder, expected a file outside it",
            out.display()
        )));
    }
    let found = octant_rejudge::folder(given).map_err(|error| Failure::of(&error).failed())?;
    let text = serde_json::to_string_pretty(&found)
        .map_err(|error| Failure::bench(format!("failed to write the result as JSON: {error}")))?;
    write(&out, text + "\n")?;
    if *json {
        print_json(&found)?;
    } else {
        print(&format!("{}{}\n", found.text(), out.display()))?;
    }
    Ok(found.verdict)
}
