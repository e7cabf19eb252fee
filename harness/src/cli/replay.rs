//! `octant replay`: the core again, on a recorded stream.

use super::{Failure, print, print_json};
use crate::endpoint::{Endpoint, InProcess};
use crate::run::method::configurations;
use crate::run::unit;
use crate::source::{Epoch, Replay, Source};
use clap::Args;
use octant_recorder::StreamHash;
use octant_requirements::Verdict;
use octant_sample::parameters::PARAMETER_COUNT;
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{GimbalCommand, Output};
use octant_scenario::Scenario;
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
    /// Folder of the run that a scenario makes.
    #[arg(long, value_name = "DIR", requires = "scenario")]
    out: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// How a replay compares with what was recorded.
#[derive(Serialize)]
struct Comparison {
    samples: u64,
    stream_hash: String,
    outputs_equal: bool,
    /// Parameters with their σ, at every sample at which either side has new ones.
    parameters_equal: bool,
    first_difference_sample: Option<u64>,
    truncated: bool,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    if let Some(scenario) = &arguments.scenario {
        return super::run::on_recording(
            scenario,
            &arguments.recording,
            &arguments.set,
            arguments.out.as_deref(),
            arguments.json,
        );
    }
    let path = &arguments.recording;
    let (scenario, method, seed) = super::score::scenario_of(path)?;
    let scenario: Scenario = scenario;
    let bad = |error: &dyn std::fmt::Display| Failure::input(format!("failed to {error}"));
    let (_, core, _) = configurations(&scenario, method, seed).map_err(|e| bad(&e))?;
    // Where the recording's core was an FMU, that FMU again; what a device answered is compared with the
    // core in this process.
    let device = matches!(scenario.endpoint, octant_scenario::Endpoint::Live(_));
    let elsewhere = (!device).then(|| crate::endpoint::open(&scenario, &core)).transpose();
    let mut endpoint: Box<dyn Endpoint> = match elsewhere.map_err(|e| bad(&e))?.flatten() {
        Some(endpoint) => endpoint,
        None => Box::new(InProcess::new(&core).map_err(|e| bad(&format!("set up the core: {e}")))?),
    };
    let mut source = Replay::open(path, None).map_err(|e| bad(&e))?;
    let (mut hash, mut samples, mut revision) = (StreamHash::new(), 0u64, 0);
    let (mut first_difference_sample, mut parameters_equal) = (None, true);
    let mut outputs_equal = true;
    let (mut epoch, mut output) = (Epoch::default(), Output::default());
    while source.next(&GimbalCommand::default(), &mut epoch).map_err(|e| bad(&e))? {
        for event in &source.recorded().events {
            if let Some(event) = unit::of(event).map_err(|e| bad(&e))? {
                unit::happen(&event, &mut endpoint).map_err(|e| bad(&e))?;
            }
        }
        endpoint.step(&epoch, &mut output).map_err(|e| bad(&e))?;
        samples += 1;
        hash.epoch(&epoch.sample, epoch.aiding.as_ref(), &output);
        let announced = output.parameters_revision != revision;
        if announced {
            revision = output.parameters_revision;
            hash.parameters(&endpoint.parameters());
        }
        let recorded = source.recorded();
        let equal = match &recorded.parameters {
            Some(estimate) => announced && same_parameters(estimate, &endpoint.parameters()),
            // A file that ends in the middle may have lost those of its last sample.
            None => !announced || source.truncated(),
        };
        if !equal {
            parameters_equal = false;
            first_difference_sample.get_or_insert(output.sequence);
        }
        if let Some(recorded) = &recorded.output
            && !same(recorded, &output)
        {
            first_difference_sample.get_or_insert(output.sequence);
            outputs_equal = false;
        }
    }
    let comparison = Comparison {
        samples,
        stream_hash: hash.hex(),
        outputs_equal,
        parameters_equal,
        first_difference_sample,
        truncated: source.truncated(),
    };
    if arguments.json {
        print_json(&comparison)?;
    } else {
        let equal = match comparison.first_difference_sample {
            None if samples == 0 => "nothing to compare".to_owned(),
            None => "every output is equal to the recorded one, and every parameter, bit for bit"
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
        let cut = if comparison.truncated { " (the recording ends in the middle)" } else { "" };
        let count = if samples == 0 { "no".to_owned() } else { samples.to_string() };
        print(&format!("{count} samples{cut}: {equal}\nstream hash {}\n", comparison.stream_hash))?;
    }
    let equal = comparison.outputs_equal && comparison.parameters_equal;
    Ok(match (equal, comparison.truncated || samples == 0) {
        (false, _) => Verdict::Fail,
        (true, true) => Verdict::Inconclusive,
        (true, false) => Verdict::Pass,
    })
}

/// Equality of all bits, NaN included.
fn same_parameters(a: &ParameterEstimate, b: &ParameterEstimate) -> bool {
    let bits = |values: &[f64; PARAMETER_COUNT]| values.map(f64::to_bits);
    bits(&a.parameters.to_array()) == bits(&b.parameters.to_array())
        && bits(&a.sigma) == bits(&b.sigma)
}

/// Equality of all bits, NaN included.
fn same(a: &octant_sample::Output, b: &octant_sample::Output) -> bool {
    use octant_sample::canonical::{OUTPUT_BYTES, output};
    let (mut left, mut right) = ([0; OUTPUT_BYTES], [0; OUTPUT_BYTES]);
    output(a, &mut left);
    output(b, &mut right);
    left == right
}
