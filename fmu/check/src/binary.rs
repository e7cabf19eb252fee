//! Properties of one shared library.

use serde::Serialize;
use std::collections::BTreeSet;

/// Properties of a library.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct LibraryProperties {
    /// The file inside the FMU.
    pub entry: String,
    /// `Elf`, `Pe`, `MachO`.
    pub format: String,
    /// `X86_64`, `Aarch64`, …
    pub architecture: String,
    /// Number of functions of the FMU's standard that it exports.
    pub functions: usize,
    /// Libraries that it needs.
    pub libraries: Vec<String>,
    /// Newest version of the C library that it requires: `2.17`.
    pub glibc: Option<String>,
}

/// Returns whether a library with this name is in the same folder.
pub(super) fn is_beside(name: &str, beside: &BTreeSet<String>) -> bool {
    let file = name.rsplit('/').next().unwrap_or(name);
    beside.iter().any(|other| other.eq_ignore_ascii_case(file))
}
