//! Seed of a campaign that comes from what its plan says.

use super::looks::Looks;
use super::requirements::Planned;
use super::{PlannedScenario, StopRule};
use octant_verdict::verdict::LimitCheck;
use serde::Serialize;

/// Bits of a seed that comes from a plan: JSON and TOML hold such a number exactly.
const SEED_BITS: u32 = 48;

/// Content of a plan from which its seed comes: neither the number of replicates nor the values of a grid, so that a
/// campaign can grow, and no free text.
#[derive(Serialize)]
struct SeedContent<'a> {
    what: &'static str,
    scenarios: Vec<(&'a str, &'a str, &'a [String], &'a [LimitCheck])>,
    requirements: &'a [Planned],
    not_by_test: &'a [String],
    factors: &'a [String],
    stop: &'a Option<StopRule>,
    looks: Looks,
}

/// Computes the seed that comes from what a plan says.
pub(super) fn seed_of(
    scenarios: &[PlannedScenario],
    (requirements, not_by_test): (&[Planned], &[String]),
    factors: &[String],
    stop: &Option<StopRule>,
    looks: Looks,
) -> u64 {
    let scenarios = (scenarios.iter())
        .map(|PlannedScenario { id, blake3, requirements, checks, .. }| {
            (id.as_str(), blake3.as_str(), requirements.as_slice(), checks.as_slice())
        })
        .collect();
    let what = "seed of an octant campaign";
    let content = SeedContent { what, scenarios, requirements, not_by_test, factors, stop, looks };
    // Values of these types can always be serialised.
    let text = serde_json::to_vec(&content).unwrap_or_default();
    let mut first = [0; 8];
    first.copy_from_slice(&blake3::hash(&text).as_bytes()[..8]);
    u64::from_le_bytes(first) >> (64 - SEED_BITS)
}
