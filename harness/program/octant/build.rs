//! Bakes in what a manifest says about the build: the state of the repository and the compiler.
//! Both may be missing (a source archive, no git): then the manifest says so.

use sha2::{Digest, Sha256};
use std::process::Command;

fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}

fn main() {
    // The folders whose state `--dirty` speaks of, and what moves when a commit is made.
    for path in ["build.rs", "../..", "../../../models", "../../../fmu", "../../../Cargo.lock"] {
        println!("cargo:rerun-if-changed={path}");
    }
    for name in ["HEAD", "index"] {
        if let Some(path) = output("git", &["rev-parse", "--git-path", name])
            && std::path::Path::new(&path).exists()
        {
            println!("cargo:rerun-if-changed={path}");
        }
    }
    let commit = output("git", &["rev-parse", "HEAD"]).unwrap_or_default();
    let changed = output(
        "git",
        // Without writing to the index, which would be a reason to build again.
        &["--no-optional-locks", "status", "--porcelain", "--untracked-files=no"],
    );
    let dirty = !commit.is_empty() && changed.is_none_or(|changed| !changed.is_empty());
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let rustc = output(&rustc, &["--version"]).unwrap_or_default();
    println!("cargo:rustc-env=OCTANT_GIT_COMMIT={commit}");
    println!("cargo:rustc-env=OCTANT_GIT_DIRTY={dirty}");
    println!("cargo:rustc-env=OCTANT_RUSTC={rustc}");
    let lock = std::fs::read("../../../Cargo.lock").map(Sha256::digest);
    let lock = lock.map(|hash| hash.iter().map(|byte| format!("{byte:02x}")).collect::<String>());
    println!("cargo:rustc-env=OCTANT_LOCK_FILE={}", lock.unwrap_or_default());
}
