//! Builds the shared library for other platforms: cargo builds it in the source tree.

use super::error::BuildError;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::process::Stdio;

/// Builds the library for a target such as `aarch64-unknown-linux-gnu`; returns its path.
///
/// Uses cargo-zigbuild if it is installed: it brings the linker, and understands a glibc version at
/// the end of a target (`x86_64-unknown-linux-gnu.2.17`).
pub(super) fn library(target: &str) -> Result<PathBuf, BuildError> {
    let source = source_tree()?;
    let failed = |reason: String| BuildError::Target { target: target.to_owned(), reason };
    let zig = has_zigbuild(&source);
    // The part after the dot is for zig alone.
    let triple = match target.split_once('.') {
        None => target,
        Some((triple, version)) if zig && !version.is_empty() => triple,
        Some(_) => {
            return Err(failed(
                "a version of glibc can only be chosen with cargo-zigbuild, which isn't there \
                 (`pip install cargo-zigbuild ziglang`)"
                    .to_owned(),
            ));
        }
    };
    standard_library(triple, &source).map_err(failed)?;
    let output = octant_base::child::foreign("cargo")
        .arg(if zig { "zigbuild" } else { "build" })
        .args(["--release", "--package", "octant-fmu", "--lib", "--target", target])
        .arg("--message-format=json-render-diagnostics")
        .current_dir(&source)
        // Progress is for the user; the messages are for this program.
        .stderr(Stdio::piped())
        .output()
        .map_err(|error| failed(format!("cargo can't be started: {error}")))?;
    if !output.status.success() {
        return Err(failed(why(&String::from_utf8_lossy(&output.stderr), zig)));
    }
    artifact(&String::from_utf8_lossy(&output.stdout))
        .ok_or_else(|| failed("cargo made no shared library".to_owned()))
}

/// Finds the workspace: the current folder, or the one whose `target` the program is in. (The path at
/// the time of the build would make the program another one in each folder.)
fn source_tree() -> Result<PathBuf, BuildError> {
    let here = std::env::current_dir().ok();
    let program = std::env::current_exe().unwrap_or_default();
    let above = program.ancestors().map(Path::to_owned);
    let is_ours = |folder: &PathBuf| {
        folder.join("fmu/unit/Cargo.toml").is_file() && folder.join("models/calibration").is_dir()
    };
    here.into_iter().chain(above).find(is_ours).ok_or(BuildError::NoSource)
}

fn has_zigbuild(source: &Path) -> bool {
    let asked =
        octant_base::child::foreign("cargo-zigbuild").arg("--version").current_dir(source).output();
    asked.is_ok_and(|output| output.status.success())
}

/// Checks that the compiler has the standard library of a target.
fn standard_library(triple: &str, source: &Path) -> Result<(), String> {
    let output = octant_base::child::foreign("rustc")
        .args(["--print", "target-libdir", "--target", triple])
        .current_dir(source)
        .output()
        .map_err(|error| format!("rustc can't be started: {error}"))?;
    if !output.status.success() {
        return Err(format!("rustc knows no target {triple}: `rustc --print target-list`"));
    }
    let folder = PathBuf::from(String::from_utf8_lossy(&output.stdout).trim());
    if folder.is_dir() {
        return Ok(());
    }
    Err(format!(
        "the standard library for it isn't there: `rustup target add {triple}` ({} is missing)",
        folder.display()
    ))
}

/// Extracts the error from cargo's output, and adds a hint.
fn why(stderr: &str, zig: bool) -> String {
    let lines: Vec<&str> = stderr.lines().collect();
    let from = lines.iter().position(|line| line.starts_with("error")).unwrap_or(0);
    let said = lines[from..].iter().take(8).copied().collect::<Vec<_>>().join("\n");
    let help = if stderr.contains("linker") && !zig {
        "\na linker for it is missing: `pip install cargo-zigbuild ziglang` brings one, or name \
         yours in .cargo/config.toml"
    } else {
        ""
    };
    format!("cargo says\n{said}{help}")
}

/// Line of cargo's messages, with the fields that are used here.
#[derive(Deserialize)]
struct Message {
    reason: String,
    #[serde(default)]
    filenames: Vec<PathBuf>,
    target: Option<Named>,
}

#[derive(Deserialize)]
struct Named {
    name: String,
}

/// Finds the shared library among the files that cargo made.
fn artifact(messages: &str) -> Option<PathBuf> {
    let shared = |path: &PathBuf| {
        path.extension()
            .is_some_and(|extension| ["so", "dll", "dylib"].iter().any(|known| extension == *known))
    };
    messages
        .lines()
        .filter_map(|line| serde_json::from_str::<Message>(line).ok())
        .filter(|message| {
            message.reason == "compiler-artifact"
                && message.target.as_ref().is_some_and(|target| target.name == "octant_fmu")
        })
        .flat_map(|message| message.filenames)
        .find(shared)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::*;

    #[test]
    fn the_library_is_found_among_the_artifacts() {
        let messages = concat!(
            r#"{"reason":"compiler-artifact","target":{"name":"libm"},"filenames":["/t/libm.so"]}"#,
            "\nnot JSON\n",
            r#"{"reason":"compiler-artifact","target":{"name":"octant_fmu"},"#,
            r#""filenames":["/t/liboctant_fmu.rlib","/t/octant_fmu.dll","/t/octant_fmu.dll.a"]}"#,
            "\n",
            r#"{"reason":"build-finished","success":true}"#,
        );
        assert_eq!(artifact(messages), Some("/t/octant_fmu.dll".into()));
        assert_eq!(artifact(""), None);
    }

    #[test]
    fn what_is_missing_is_named() {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fmu");
        let unknown = standard_library("z80-unknown-cpm", &source).unwrap_err();
        assert!(unknown.contains("knows no target z80-unknown-cpm"), "{unknown}");
        // A target known to the compiler, for which no standard library is ever shipped.
        let bare = standard_library("avr-none", &source).unwrap_err();
        assert!(bare.contains("rustup target add avr-none"), "{bare}");
        let said = why("warning: x\nerror: linker `cc` not found\n  |\n", false);
        assert!(said.contains("linker `cc` not found") && said.contains("zigbuild"), "{said}");
    }
}
