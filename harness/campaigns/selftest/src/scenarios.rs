//! Scenarios and campaigns from which several cases start.

use super::bench::{CaseBench, ProcessOutput};
use super::error::CaseSetupError;

pub(super) const SHORT: &str = include_str!("../../../../fixtures/selftest/short.toml");
pub(super) const SPIKE: &str = include_str!("../../../../fixtures/selftest/spike.toml");

/// Arguments with which a core accepts every sample.
pub(super) const BELIEVING: [&str; 8] = [
    "--set",
    "screening.gate=off",
    "--set",
    "screening.jumps=off",
    "--set",
    "screening.drift=off",
    "--set",
    "screening.stuck_samples=off",
];

/// Requirement on every case.
pub(super) const ALWAYS: &str = "schema = 1\ntitle = \"known\"\n[[requirements]]\nid = \"ALWAYS\"\n\
    text = \"It stays near.\"\nmeasure = \"navigation.radial_error_nmi.max\"\nlimit = \"10 nmi\"\n";

/// Requirement on 95 % of the cases.
pub(super) const MOSTLY: &str = "schema = 1\ntitle = \"known\"\n[[requirements]]\nid = \"MOSTLY\"\n\
    text = \"It mostly stays near.\"\nmeasure = \"navigation.radial_error_nmi.max\"\nlimit = \"10 nmi\"\n\
    pass = \"95 %\"\nconfidence = \"95 %\"\n";

/// Plans a campaign of a number of instruments.
pub(super) fn planned(
    bench: &CaseBench<'_>,
    cases: u32,
    requirements: &str,
    more: &str,
) -> Result<(), CaseSetupError> {
    let faults = "\n[[factors]]\nname = \"fault\"\nfaults = [[]]\n";
    let (of_scenario, of_campaign) = if more.starts_with('[') { ("", more) } else { (more, "") };
    bench.write("short.toml", SHORT)?;
    bench.write("requirements.toml", requirements)?;
    bench.write(
        "campaign.toml",
        format!(
            "schema = 1\ntitle = \"known\"\nseed = 1\nreplicates = {cases}\n\
             requirements = \"requirements.toml\"\n[[scenarios]]\nid = \"short\"\n\
             file = \"short.toml\"\n{of_scenario}{faults}{of_campaign}"
        ),
    )?;
    needs(&bench.octant(&["campaign", "plan", "campaign.toml", "--out", "campaign"])?, 0)
}

/// Runs a campaign.
pub(super) fn campaign(
    bench: &CaseBench<'_>,
    cases: u32,
    requirements: &str,
    more: &str,
) -> Result<(), CaseSetupError> {
    planned(bench, cases, requirements, more)?;
    let said = bench.octant(&["campaign", "run", "campaign", "--jobs", "1"])?;
    match said.status {
        Some(0 | 1 | 3 | 4) => Ok(()),
        status => Err(format!("run a campaign: status {status:?}: {}", said.err).into()),
    }
}

/// Checks the exit status of a preparing step.
pub(super) fn needs(said: &ProcessOutput, status: i32) -> Result<(), CaseSetupError> {
    if said.status == Some(status) {
        return Ok(());
    }
    Err(format!("prepare the case: status {:?}, expected {status}: {}", said.status, said.err)
        .into())
}
