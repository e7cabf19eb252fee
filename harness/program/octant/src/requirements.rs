//! `octant requirements`: checks files of requirements, and converts them into those of other
//! tools.

mod measures;

use crate::failure::Failure;
use crate::terminal::{note, print, print_json, tell_account};
use clap::{Args, Subcommand};
use octant_base::number::counted;
use octant_campaign::plan::requirements::Measures;
use octant_requirements::Imported;
use octant_requirements::exchange::{self, ExchangeError};
use octant_verdict::Verdict;
use octant_verdict::file::Checker as _;
use octant_verdict::measures::unasked;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Check a file, .toml, .sdoc, .reqif, .reqifz or needs.json, or a folder of Doorstop: print its number of requirements, or
    /// its errors.
    Check {
        /// The file.
        #[arg(value_name = "FILE")]
        file: PathBuf,
        /// Names that the file has for the parts of a requirement: a mapping file.
        #[arg(long, value_name = "FILE")]
        mapping: Option<PathBuf>,
    },
    /// Convert a file to another format; the extensions tell the formats: .toml, .sdoc, .reqif, .reqifz, .json, none for a folder
    /// of Doorstop.
    ///
    /// Parts that the other format can't keep are named. The exit status is 3 if requirements could not be read. A .toml keeps the
    /// account of what was read, and a campaign on it is inconclusive then.
    Convert {
        /// Existing file.
        #[arg(value_name = "FROM")]
        from: PathBuf,
        /// New file.
        #[arg(value_name = "TO")]
        to: PathBuf,
        /// Names that FROM has for the parts of a requirement: a mapping file.
        #[arg(long, value_name = "FILE")]
        mapping: Option<PathBuf>,
        /// Overwrite TO.
        #[arg(long)]
        force: bool,
    },
    /// List all measures that a requirement can have: unit, meaning, sign, and what a run needs to have them.
    Measures {
        /// Print one JSON object.
        #[arg(long)]
        json: bool,
    },
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let Arguments { command } = arguments;
    match command {
        Command::Check { file, mapping } => check(file, mapping.as_deref()),
        Command::Convert { from, to, mapping, force } => {
            convert(from, to, mapping.as_deref(), *force)
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

fn check(path: &Path, mapping: Option<&Path>) -> Result<Verdict, Failure> {
    let imported = read(path, mapping)?;
    let all = &imported.requirements.requirements;
    let count = |name: &str| {
        all.iter().filter(|requirement| requirement.verification.name() == name).count()
    };
    print(&format!(
        "{}: {}, {} by test, {} by analysis, {} by inspection, {} open\n",
        path.display(),
        counted(all.len(), "requirement", "requirements"),
        count("test"),
        count("analysis"),
        count("inspection"),
        count("open")
    ))?;
    let checks: Vec<_> = all.iter().filter_map(|requirement| requirement.check()).collect();
    for kind in unasked(checks.iter().map(|check| check.measure.as_str())) {
        note!("octant: {}: {}", path.display(), kind.sentence());
    }
    // A requirement without a stated verification can't be shown, and one that is missing neither.
    let is_whole = count("open") == 0 && doubts(&imported) == 0;
    Ok(if is_whole { Verdict::Pass } else { Verdict::Inconclusive })
}

fn convert(
    from: &Path,
    to: &Path,
    mapping: Option<&Path>,
    force: bool,
) -> Result<Verdict, Failure> {
    // Before the work, and without a warning that nobody needs then.
    exchange::format_of(to).map_err(Failure::input)?;
    if to.is_file() && !force {
        return Err(Failure::input(ExchangeError::Exists { path: to.to_owned() }));
    }
    let imported = read(from, mapping)?;
    let now = octant_base::utc::seconds(SystemTime::now());
    let lost = exchange::write(to, &imported, &now, force).map_err(Failure::input)?;
    for loss in lost {
        note!("octant: {}: {loss}", to.display());
    }
    print(&format!("{}\n", to.display()))?;
    if imported.skipped() > 0 {
        let number = imported.skipped();
        let number =
            format!("{number} {}", if number == 1 { "requirement" } else { "requirements" });
        note!("octant: {}: {number} could not be read: the file is not complete", to.display());
    }
    Ok(if doubts(&imported) == 0 { Verdict::Pass } else { Verdict::Inconclusive })
}

/// Number of entries of the accounts, of this document and of those before it, that could have changed a verdict.
fn doubts(imported: &Imported) -> usize {
    imported.accounts().iter().map(|account| account.doubts().len()).sum()
}

/// Reads the requirements of a file; parts that an import leaves out are listed on stderr.
fn read(path: &Path, mapping: Option<&Path>) -> Result<Imported, Failure> {
    let mapping = mapping.map(exchange::read_mapping).transpose().map_err(Failure::input)?;
    let imported = exchange::read(path, mapping.as_ref(), &Measures).map_err(Failure::input)?;
    imported.accounts().iter().for_each(tell_account);
    for note in &imported.notes {
        note!("octant: {}: {note}", path.display());
    }
    for requirement in &imported.requirements.requirements {
        let Some(check) = requirement.check() else { continue };
        let measure = Measures.measure(&check.measure);
        if let Err(error) = measure.and_then(|()| Measures.limit(&check.measure, &check.limit)) {
            note!("octant: {}: {}: {error}", path.display(), requirement.id);
        }
    }
    Ok(imported)
}
