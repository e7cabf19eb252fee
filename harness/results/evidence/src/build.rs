//! How the program was built, for its manifests.
//!
//! The program says it once, at its start: its build script alone is run again at every commit, and the
//! crates under it are not compiled again for a new commit.

use std::sync::OnceLock;

/// How a program was built. Empty texts are not known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Build {
    /// Commit of the repository.
    pub git_commit: &'static str,
    /// Files under version control had changed.
    pub is_git_dirty: bool,
    /// Version line of the compiler.
    pub rustc: &'static str,
    /// SHA-256 of `Cargo.lock`, hexadecimal.
    pub lock_file_sha256: &'static str,
}

static BUILD: OnceLock<Build> = OnceLock::new();

/// Stores how this program was built. The first call counts.
pub fn say(build: Build) {
    let _ = BUILD.set(build);
}

/// The build of this program; nothing is known where nobody said it.
#[must_use]
pub fn this() -> Build {
    BUILD.get().copied().unwrap_or_default()
}
