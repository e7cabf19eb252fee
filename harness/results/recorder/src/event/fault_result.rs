//! Result of a fault, as recordings and summaries have it.

use octant_sample::LargestChange;
use serde::{Deserialize, Serialize};

/// Result of one fault.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FaultResult {
    /// Id in the scenario.
    pub id: String,
    /// Kind.
    pub kind: String,
    /// True if the fault was armed.
    pub armed: bool,
    /// True if it altered at least one sample.
    pub fired: bool,
    /// First sample altered.
    pub first_sample: Option<u64>,
    /// Last sample altered.
    pub last_sample: Option<u64>,
    /// Number of samples altered.
    pub samples_altered: u64,
    /// Number of firings.
    #[serde(default)]
    pub firings: u32,
    /// CRC-32 of the samples before the alteration, hexadecimal; null if there are none.
    #[serde(default)]
    pub clean_crc32: Option<String>,
    /// CRC-32 of the samples after the alteration.
    #[serde(default)]
    pub faulted_crc32: Option<String>,
    /// Largest change of each channel, where the fault altered samples or set points in place.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub largest_change: Option<LargestChange>,
}

impl FaultResult {
    /// Text `fault spike-1 (spike): fired once, 100 samples from 36001 to 36100`.
    #[must_use]
    pub fn sentence(&self) -> String {
        let times = match self.firings {
            1 => "once".to_owned(),
            n => format!("{n} times"),
        };
        let what = match (self.first_sample, self.last_sample) {
            (Some(first), Some(last)) if first == last => format!("fired {times}, sample {first}"),
            (Some(first), Some(last)) => {
                format!("fired {times}, {} samples from {first} to {last}", self.samples_altered)
            }
            _ if self.firings > 0 => format!("set in {times} and altered nothing"),
            _ => "never fired".to_owned(),
        };
        format!("fault {} ({}): {what}", self.id, self.kind)
    }
}
