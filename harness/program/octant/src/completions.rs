//! `octant completions` and `octant man`: scripts of shells and manual pages, made from the command line
//! itself.

use crate::failure::Failure;
use clap::{Args, ValueEnum};
use octant_verdict::Verdict;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct CompletionArguments {
    /// Shell that reads the script.
    #[arg(value_enum, value_name = "SHELL")]
    shell: CompletionShell,
}

#[derive(Debug, Args)]
pub(super) struct ManArguments {
    /// Folder for the pages, one for each command; it is made if it isn't there.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Shells with completions.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum CompletionShell {
    /// Bash.
    Bash,
    /// Zsh.
    Zsh,
    /// Fish.
    Fish,
    /// PowerShell.
    #[value(name = "powershell")]
    PowerShell,
}

/// Prints the completion script of a shell.
#[cfg(feature = "completions")]
pub(super) fn completions(
    arguments: &CompletionArguments,
    mut command: clap::Command,
) -> Result<Verdict, Failure> {
    use clap_complete::Shell;
    let CompletionArguments { shell } = arguments;
    let shell = match shell {
        CompletionShell::Bash => Shell::Bash,
        CompletionShell::Zsh => Shell::Zsh,
        CompletionShell::Fish => Shell::Fish,
        CompletionShell::PowerShell => Shell::PowerShell,
    };
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut command, "octant", &mut script);
    crate::terminal::print(&String::from_utf8_lossy(&script))?;
    Ok(Verdict::Pass)
}

/// Writes the manual pages.
#[cfg(feature = "completions")]
pub(super) fn man(arguments: &ManArguments, command: clap::Command) -> Result<Verdict, Failure> {
    let ManArguments { folder } = arguments;
    let failed = |error: std::io::Error| {
        Failure::bench(format!("failed to write manual pages into {}: {error}", folder.display()))
    };
    std::fs::create_dir_all(folder).map_err(failed)?;
    clap_mangen::generate_to(command, folder).map_err(failed)?;
    crate::terminal::print(&format!("{}\n", folder.join("octant.1").display()))?;
    Ok(Verdict::Pass)
}

#[cfg(not(feature = "completions"))]
fn missing(what: &str) -> Failure {
    Failure::input(format!(
        "this program was built without {what}: build it with cargo build --release --features \
         octant/completions"
    ))
}

/// Refuses: the program was built without completions.
#[cfg(not(feature = "completions"))]
pub(super) fn completions(
    arguments: &CompletionArguments,
    _: clap::Command,
) -> Result<Verdict, Failure> {
    let CompletionArguments { shell } = arguments;
    let shell = shell.to_possible_value();
    let shell = shell.as_ref().map_or("this shell", |shell| shell.get_name());
    Err(missing(&format!("completions for {shell}")))
}

/// Refuses: the program was built without manual pages.
#[cfg(not(feature = "completions"))]
pub(super) fn man(arguments: &ManArguments, _: clap::Command) -> Result<Verdict, Failure> {
    let ManArguments { folder } = arguments;
    Err(missing(&format!("the manual pages for {}", folder.display())))
}
