//! Who made a result: program, host and person.

use super::host::Machine;
use super::program::{operator, program_sha256};
use serde::{Deserialize, Serialize};
use std::sync::OnceLock;

/// Longest text of a name.
const NAME_MAX: usize = 200;

/// Maker of a result. It is no part of the result, which is the same on every host.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Maker {
    /// SHA-256 of the program; null if it can't be read.
    pub program_sha256: Option<String>,
    /// Version of the program.
    pub octant: String,
    /// Name of the host.
    pub host: String,
    /// Operator, as in the manifest of a run.
    pub operator: Option<String>,
}

impl Maker {
    /// Returns this program on this host.
    #[must_use]
    pub fn this() -> Self {
        let short = |name: String| name.chars().take(NAME_MAX).collect();
        Self {
            program_sha256: program_sha256(),
            octant: env!("CARGO_PKG_VERSION").to_owned(),
            host: short(Machine::this().name),
            operator: operator().map(short),
        }
    }

    /// Returns the bytes that each record of this process has.
    #[must_use]
    pub fn bytes_of_this() -> &'static [u8] {
        static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
        BYTES.get_or_init(|| serde_json::to_vec(&Self::this()).unwrap_or_default())
    }

    /// Reads the bytes of a record; `None` if they tell nobody.
    #[must_use]
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        serde_json::from_slice(bytes).ok()
    }
}

/// Results by one maker.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MadeBy {
    /// The maker; null for results from before makers were noted.
    pub maker: Option<Maker>,
    /// Number of results.
    pub results: u64,
}
