//! Parts of a run's stream that are kept.

use crate::observers::{TELLS_ATTITUDE, TELLS_POSITION, TELLS_TILT, TELLS_VELOCITY};
use octant_endpoint::Tells;
use octant_recorder::{Policy, Recorder, RecorderError, RecorderOptions, Samples};
use octant_scenario::resolve::DrawnValues;
use octant_scenario::{Method, Scenario};
use octant_views::about::About;
use octant_views::publishing;
use std::path::Path;

/// Parts of a method's stream that are kept.
#[derive(Clone, Copy, Debug)]
pub enum StreamKeeping<'a> {
    /// A file, by the scenario's policy.
    File(&'a Path),
    /// Hash of the stream and those of altered streams, and the trace for the comparison with a
    /// twin.
    Hash,
    /// Hash of the stream alone, for a run that isn't compared with another.
    HashAlone,
    /// Nothing, for ensembles.
    None,
}

impl StreamKeeping<'_> {
    /// Starts the recorder.
    pub(crate) fn start(self, options: &RecorderOptions) -> Result<Recorder, RecorderError> {
        Ok(match self {
            Self::File(path) => Recorder::to_file(path, options)?,
            Self::Hash => Recorder::hash_only(options),
            Self::HashAlone => Recorder::stream_hash_only(options),
            Self::None => Recorder::none(),
        })
    }
}

/// Returns the recorder's options of a method, from the scenario, and from what source and endpoint tell:
/// whether the true parameters are known, and the parts of an output.
pub(crate) fn recorder_options(
    scenario: &Scenario,
    method: Method,
    seed: u64,
    draws: &DrawnValues,
    true_parameters: bool,
    tells: Tells,
) -> RecorderOptions {
    let record = &scenario.record;
    let method_name = match method {
        Method::Primary => "primary",
        Method::Baseline => "baseline",
    };
    RecorderOptions {
        policy: Policy {
            samples: if record.full_samples { Samples::Full } else { Samples::Decimated },
            period_ns: record.every_samples * scenario.sample_period_ns,
            parameters_period_ns: record.parameters_period_ns,
        },
        scenario: scenario.to_resolved_toml(seed, draws),
        metadata: [
            ("method", method_name.to_owned()),
            ("seed", seed.to_string()),
            ("true_parameters", true_parameters.to_string()),
            (TELLS_VELOCITY, tells.velocity.to_string()),
            (TELLS_ATTITUDE, tells.attitude.to_string()),
        ]
        .into_iter()
        // Headings alone have no position.
        .chain((!tells.position).then(|| (TELLS_POSITION, false.to_string())))
        .chain((!tells.tilt).then(|| (TELLS_TILT, false.to_string())))
        .map(|(key, value)| (key.to_owned(), value))
        .collect(),
        publishing: record.topics_period_ns.map(|period_ns| {
            let truth = true_parameters.then_some(draws.parameters);
            publishing(About::of_run(scenario, method, seed, truth), period_ns)
        }),
        ..RecorderOptions::default()
    }
}
