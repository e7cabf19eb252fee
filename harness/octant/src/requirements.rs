//! `octant requirements`: checks files of requirements, and converts them into those of other
//! tools.

mod measures;

use crate::failure::Failure;
use crate::terminal::note;
use crate::terminal::{print, print_json, write};
use clap::{Args, Subcommand};
use octant_base::number::counted;
use octant_campaign::requirements::Measures;
use octant_requirements::Verdict;
use octant_requirements::{Requirements, file, reqif, sdoc};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Check a file, .toml, .sdoc or .reqif: print its number of requirements, or its errors.
    Check {
        /// The file.
        #[arg(value_name = "FILE")]
        file: PathBuf,
    },
    /// Convert a file to another format; the extensions tell the formats: .toml, .sdoc, .reqif.
    Convert {
        /// Existing file.
        #[arg(value_name = "FROM")]
        from: PathBuf,
        /// New file; an existing one is never overwritten.
        #[arg(value_name = "TO")]
        to: PathBuf,
    },
    /// List all measures that a requirement can have: unit, meaning, sign, and what a run needs to have them.
    Measures {
        /// Print one JSON object.
        #[arg(long)]
        json: bool,
    },
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    match &arguments.command {
        Command::Check { file } => {
            let requirements = read(file)?;
            let count = |name: &str| {
                let of = |r: &&octant_requirements::Requirement| r.verification.name() == name;
                requirements.requirements.iter().filter(of).count()
            };
            print(&format!(
                "{}: {}, {} by test, {} by analysis, {} by inspection, {} open\n",
                file.display(),
                counted(requirements.requirements.len(), "requirement", "requirements"),
                count("test"),
                count("analysis"),
                count("inspection"),
                count("open")
            ))?;
            // A requirement without a stated verification can't be shown.
            Ok(if count("open") == 0 { Verdict::Pass } else { Verdict::Inconclusive })
        }
        Command::Convert { from, to } => {
            let requirements = read(from)?;
            let text = match ending(to)? {
                Format::Toml => file::write(&requirements),
                Format::StrictDoc => sdoc::write(&requirements).map_err(Failure::input)?,
                Format::ReqIf => {
                    let now = octant_base::utc::seconds(SystemTime::now());
                    reqif::write(&requirements, &now).map_err(Failure::input)?
                }
            };
            if to.exists() {
                return Err(Failure::input(format!(
                    "failed to write {}: the file exists already",
                    to.display()
                )));
            }
            write(to, text)?;
            print(&format!("{}\n", to.display()))?;
            Ok(Verdict::Pass)
        }
        Command::Measures { json } => {
            if *json {
                print_json(&measures::listed())?
            } else {
                print(&measures::text())?
            }
            Ok(Verdict::Pass)
        }
    }
}

enum Format {
    Toml,
    StrictDoc,
    ReqIf,
}

fn ending(path: &Path) -> Result<Format, Failure> {
    match path.extension().and_then(|ending| ending.to_str()) {
        Some("toml") => Ok(Format::Toml),
        Some("sdoc") => Ok(Format::StrictDoc),
        Some("reqif") => Ok(Format::ReqIf),
        _ => Err(Failure::input(format!(
            "{}: expected a file that ends in .toml, .sdoc or .reqif",
            path.display()
        ))),
    }
}

/// Reads the requirements of a file; parts that an import leaves out are listed on stderr.
fn read(path: &Path) -> Result<Requirements, Failure> {
    let format = ending(path)?;
    let name = path.display().to_string();
    let text = std::fs::read_to_string(path)
        .map_err(|error| Failure::input(format!("failed to read {name}: {error}")))?;
    let imported = match format {
        Format::Toml => return file::read(&text, &name, &Measures).map_err(Failure::input),
        Format::StrictDoc => sdoc::read(&text, &name),
        Format::ReqIf => reqif::read(&text, &name),
    }
    .map_err(Failure::input)?;
    for note in &imported.notes {
        note!("octant: {name}: {note}");
    }
    Ok(imported.requirements)
}
