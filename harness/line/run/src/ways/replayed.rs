//! Runs a core again on a recording, and compares it with the recorded one.

use crate::bench::ended::{Ended, RunError};
use crate::bench::steps::{InStep, Injects, Keeps};
use crate::bench::{Bench, unit};
use octant_endpoint::Endpoint;
use octant_faults::rule::UnitEvent;
use octant_recorder::StreamHash;
use octant_sample::Output;
use octant_sample::canonical::{OUTPUT_BYTES, output as canonical};
use octant_sample::parameters::{PARAMETER_COUNT, ParameterEstimate};
use octant_source::{Epoch, Replay};

/// Comparison of a core's answers with the recorded ones.
#[derive(Debug, Default)]
pub struct Replayed {
    /// Number of samples.
    pub samples: u64,
    /// Stream hash so far.
    pub hash: StreamHash,
    /// True if an output differs.
    pub outputs_differ: bool,
    /// True if the parameters with their σ differ at a sample at which either side has new ones.
    pub parameters_differ: bool,
    /// Sequence number of the first answer that differs.
    pub first_difference_sample: Option<u64>,
    /// True if the recording ends in the middle.
    pub truncated: bool,
    revision: u32,
}

/// Repeats a recording with the core at an endpoint, events of the unit included.
///
/// # Errors
/// If the recording can't be read to its end, or the endpoint fails.
pub fn replay<E: Endpoint>(source: Replay, endpoint: E) -> Result<Replayed, RunError> {
    let mut bench = Bench::with(source, endpoint, None, Replayed::default());
    bench.run_through(&mut Recorded::default());
    let (_, source, _, replayed) = bench.end()?;
    Ok(Replayed { truncated: source.truncated(), ..replayed })
}

/// Events of the unit in a recording, before the sample that the loop has.
#[derive(Debug, Default)]
pub(super) struct Recorded(Vec<UnitEvent>);

impl<E: ?Sized> Injects<Replay, E> for Recorded {
    fn unit_events(&mut self, source: &Replay) -> Result<&[UnitEvent], RunError> {
        self.0.clear();
        for event in &source.recorded().events {
            self.0.extend(unit::of(event)?);
        }
        Ok(&self.0)
    }
}

impl<E: Endpoint + ?Sized> Keeps<Replay, E> for Replayed {
    /// Never ends the run: all of a recording is compared.
    fn answered(
        &mut self,
        source: &Replay,
        endpoint: &E,
        _step: InStep<'_>,
        sent: &Epoch,
        output: &Output,
    ) -> Result<Option<Ended>, RunError> {
        self.samples += 1;
        self.hash.epoch(&sent.sample, sent.aiding.as_ref(), output);
        let announced = output.parameters_revision != self.revision;
        let estimate = announced.then(|| endpoint.parameters());
        if let Some(estimate) = &estimate {
            self.revision = output.parameters_revision;
            self.hash.parameters(estimate);
        }
        let recorded = source.recorded();
        let parameters_equal = match (&recorded.parameters, &estimate) {
            (Some(recorded), Some(estimate)) => same_parameters(recorded, estimate),
            (Some(_), None) => false,
            // A file that ends in the middle may have lost the parameters of its last sample.
            (None, announced) => announced.is_none() || source.truncated(),
        };
        let outputs_equal = recorded.output.as_ref().is_none_or(|recorded| same(recorded, output));
        self.parameters_differ |= !parameters_equal;
        self.outputs_differ |= !outputs_equal;
        if !(parameters_equal && outputs_equal) {
            self.first_difference_sample.get_or_insert(output.sequence);
        }
        Ok(None)
    }
}

/// Compares all bits, NaN included.
fn same_parameters(a: &ParameterEstimate, b: &ParameterEstimate) -> bool {
    let bits = |values: &[f64; PARAMETER_COUNT]| values.map(f64::to_bits);
    bits(&a.parameters.to_array()) == bits(&b.parameters.to_array())
        && bits(&a.sigma) == bits(&b.sigma)
}

/// Compares all bits, NaN included.
fn same(a: &Output, b: &Output) -> bool {
    let (mut left, mut right) = ([0; OUTPUT_BYTES], [0; OUTPUT_BYTES]);
    canonical(a, &mut left);
    canonical(b, &mut right);
    left == right
}
