//! Child processes that don't inherit the signing key, and time limits for them.

mod asked;
mod limited;

pub use asked::{AskedChild, AskedReply, SEPARATOR};
pub use limited::{ChildEnded, ChildOutcome, finish};

use std::ffi::OsStr;
use std::process::Command;

/// Environment variable with the path of the secret key's file.
pub const KEY: &str = "OCTANT_SIGNING_KEY";
/// Environment variable with the key's password, if it has one.
pub const PASSWORD: &str = "OCTANT_SIGNING_PASSWORD";

/// Makes a command without the path and password of the signing key in its environment. Every process
/// that the program starts is made here, above all those that run foreign code.
pub fn command(program: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(program);
    command.env_remove(KEY).env_remove(PASSWORD);
    command
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::{Path, PathBuf};

    #[test]
    fn a_process_hears_nothing_of_the_key() {
        let command = command("program");
        let removed: Vec<_> =
            command.get_envs().filter(|(_, value)| value.is_none()).map(|(name, _)| name).collect();
        assert_eq!(removed, [KEY, PASSWORD].map(std::ffi::OsStr::new));
    }

    /// No other file of the program starts a process.
    #[test]
    fn every_process_is_started_without_the_key() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let mut open: Vec<PathBuf> =
            ["models", "fmu", "harness"].map(|name| root.join(name)).into();
        let mut seen = 0;
        while let Some(folder) = open.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    // Tests and benches have a starter of their own.
                    if !["tests", "benches", "target", "testing"]
                        .iter()
                        .any(|name| path.ends_with(name))
                    {
                        open.push(path);
                    }
                    continue;
                }
                if path.extension().is_none_or(|of| of != "rs") || path.ends_with("build.rs") {
                    continue;
                }
                let text = std::fs::read_to_string(&path).unwrap_or_default();
                // Only the program counts, not its unit tests.
                let program = text.split("#[cfg(test)]").next().unwrap();
                let own = path.ends_with("base/src/child.rs");
                let found = program.matches(concat!("Command::", "new(")).count();
                assert_eq!(found, usize::from(own), "{}", path.display());
                seen += program.matches("child::command(").count();
            }
        }
        assert!(seen >= 5, "{seen} processes are started");
    }
}
