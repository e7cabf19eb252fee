//! `octant replay`: runs the core again on a recorded stream.

use crate::failure::Failure;
use crate::terminal::{print, print_json};
use clap::Args;
use octant_base::number::counted;
use octant_endpoint::{AnyEndpoint, InProcess};
use octant_run::replayed::replay;
use octant_scenario::Scenario;
use octant_source::Replay;
use octant_source::configure::configurations;
use octant_verdict::Verdict;
use serde::Serialize;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// A full-rate recording of a run; or, with --scenario, the file that the scenario's source
    /// section describes.
    #[arg(value_name = "RECORDING")]
    recording: PathBuf,
    /// Run this scenario on the recorded samples instead of the one inside the recording.
    #[arg(long, value_name = "SCENARIO")]
    scenario: Option<PathBuf>,
    /// Change one key of that scenario.
    #[arg(long, value_name = "KEY=VALUE", requires = "scenario")]
    set: Vec<String>,
    /// Folder of the run with --scenario.
    #[arg(long, value_name = "DIR", requires = "scenario")]
    out: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Comparison of a replay with the recording.
#[derive(Serialize)]
struct Comparison {
    samples: u64,
    stream_hash: String,
    outputs_equal: bool,
    /// True if the parameters with their σ are equal at every sample at which either side has new
    /// ones.
    parameters_equal: bool,
    first_difference_sample: Option<u64>,
    truncated: bool,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let Arguments { recording: path, scenario, set, out, json } = arguments;
    if let Some(scenario) = scenario {
        return crate::evidenced::on_recording(scenario, path, set, out.as_deref(), *json);
    }
    let (scenario, method, seed) = super::score::scenario_of(path)?;
    let scenario: Scenario = scenario;
    let bad = |error: &dyn std::fmt::Display| Failure::input(format!("failed to {error}"));
    let (_, core, _) = configurations(&scenario, method, seed).map_err(|e| bad(&e))?;
    // If the recording's core was an FMU, that FMU is used again; a device's answers are compared
    // with the core in this process.
    let device = scenario.endpoint.device().is_some();
    let elsewhere = (!device).then(|| octant_endpoint::open(&scenario, &core)).transpose();
    let endpoint: AnyEndpoint = match elsewhere.map_err(|e| bad(&e))?.flatten() {
        Some(endpoint) => endpoint,
        None => InProcess::new(&core).map_err(|e| bad(&format!("set up the core: {e}")))?.into(),
    };
    let source = Replay::open(path, None).map_err(|e| bad(&e))?;
    let mut replayed = replay(source, endpoint).map_err(|e| bad(&e))?;
    let samples = replayed.samples;
    let comparison = Comparison {
        samples,
        stream_hash: replayed.hash.hex(),
        outputs_equal: !replayed.outputs_differ,
        parameters_equal: !replayed.parameters_differ,
        first_difference_sample: replayed.first_difference_sample,
        truncated: replayed.truncated,
    };
    if *json {
        print_json(&comparison)?;
    } else {
        let equal = match comparison.first_difference_sample {
            None if samples == 0 => "nothing to compare".to_owned(),
            None => "every output and every parameter is equal to the recorded one, bit for bit"
                .to_owned(),
            Some(sample) => {
                let what = match (comparison.outputs_equal, comparison.parameters_equal) {
                    (false, false) => "outputs and parameters",
                    (true, false) => "parameters",
                    _ => "outputs",
                };
                format!("{what} differ from the recorded ones from sample {sample} on")
            }
        };
        let cut = if comparison.truncated { " (the recording is truncated)" } else { "" };
        let count = match samples {
            0 => "no samples".to_owned(),
            some => counted(some, "sample", "samples"),
        };
        print(&format!("{count}{cut}: {equal}\nstream hash {}\n", comparison.stream_hash))?;
    }
    let equal = comparison.outputs_equal && comparison.parameters_equal;
    Ok(match (equal, comparison.truncated || samples == 0) {
        (false, _) => Verdict::Fail,
        (true, true) => Verdict::Inconclusive,
        (true, false) => Verdict::Pass,
    })
}
