//! A block of epochs: filled by the run loop, processed by the recorder's thread.

use super::{EpochFrame, Event, Extra};
use octant_sample::Epoch;
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{Aiding, Output, Sample};
use octant_sample::{Innovation, NavigationCovariance, Truth};

/// Epochs in columns, with rare parts in lists of their own: a plain epoch costs two short copies.
///
/// A position is the number of earlier frames in this block: parts of frame `i` have position `i`
/// ([`Block::aiding`], [`Block::altered`]), and parts added after it have `i + 1`.
#[derive(Clone, Debug, Default)]
pub(super) struct Block {
    /// Samples that reached the core; for a lost epoch, the one that the source delivered.
    pub(super) samples: Vec<Sample>,
    /// Outputs of the core; for a lost epoch, without meaning.
    pub(super) outputs: Vec<Output>,
    /// Aiding that reached the core, by frame.
    pub(super) aiding: Vec<(u32, Aiding)>,
    /// Epochs of the source, for frames where they differ from those that reached the core.
    pub(super) altered: Vec<(u32, Epoch)>,
    /// Frames whose epochs didn't reach the core in their step.
    pub(super) lost: Vec<u32>,
    /// Frames that reached the core in a step of the source in which another one had, with the time of
    /// the step.
    pub(super) added: Vec<(u32, u64)>,
    /// Frames on the recording grid.
    pub(super) due: Vec<u32>,
    /// Innovations, by position.
    pub(super) innovations: Vec<(u32, Innovation)>,
    /// Covariances of the solution, by position.
    pub(super) covariances: Vec<(u32, NavigationCovariance)>,
    /// Truth, by position.
    pub(super) truth: Vec<(u32, Truth)>,
    /// Changed parameters, by position.
    pub(super) parameters: Vec<(u32, ParameterEstimate)>,
    /// Events, by position.
    pub(super) events: Vec<(u32, Event)>,
}

impl Block {
    pub(super) fn new(epochs: usize) -> Self {
        Self {
            samples: Vec::with_capacity(epochs),
            outputs: Vec::with_capacity(epochs),
            aiding: Vec::with_capacity(64),
            altered: Vec::with_capacity(64),
            lost: Vec::with_capacity(64),
            added: Vec::with_capacity(64),
            due: Vec::with_capacity(64),
            innovations: Vec::with_capacity(64),
            covariances: Vec::with_capacity(64),
            truth: Vec::with_capacity(64),
            parameters: Vec::with_capacity(64),
            events: Vec::new(),
        }
    }

    /// Number of frames in the block.
    #[inline]
    pub(super) fn len(&self) -> usize {
        self.samples.len()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.samples.is_empty()
            && self.truth.is_empty()
            && self.parameters.is_empty()
            && self.events.is_empty()
    }

    #[inline]
    fn position(&self) -> u32 {
        self.samples.len() as u32
    }

    #[inline(always)]
    pub(super) fn push(&mut self, frame: &EpochFrame<'_>, due: bool) {
        let position = self.position();
        if let Some(aiding) = frame.faulted.aiding {
            self.aiding.push((position, aiding));
        }
        if frame.is_altered() {
            self.altered.push((position, *frame.clean));
        }
        if due {
            self.due.push(position);
        }
        // Unlike `push`, this doesn't copy by way of the stack.
        self.samples.extend_from_slice(std::slice::from_ref(&frame.faulted.sample));
        self.outputs.extend_from_slice(std::slice::from_ref(frame.output));
    }

    /// Adds an epoch that didn't reach the core in its step.
    pub(super) fn lost(&mut self, clean: &Epoch, due: bool) {
        let position = self.position();
        self.altered.push((position, *clean));
        self.lost.push(position);
        if due {
            self.due.push(position);
        }
        self.samples.push(clean.sample);
        self.outputs.push(Output::default());
    }

    /// Adds an epoch that reached the core in a step in which another one had.
    pub(super) fn added(&mut self, step_ns: u64, faulted: &Epoch, output: &Output, due: bool) {
        let position = self.position();
        self.added.push((position, step_ns));
        self.push(&EpochFrame { clean: faulted, faulted, output }, due);
    }

    pub(super) fn extra(&mut self, extra: &Extra) {
        let position = self.position();
        match extra {
            Extra::Innovation(innovation) => self.innovations.push((position, *innovation)),
            Extra::Covariance(covariance) => self.covariances.push((position, *covariance)),
            Extra::Truth(truth) => self.truth.push((position, *truth)),
            Extra::Parameters(estimate) => self.parameters.push((position, *estimate)),
        }
    }

    pub(super) fn event(&mut self, event: Event) {
        self.events.push((self.position(), event));
    }

    pub(super) fn clear(&mut self) {
        self.samples.clear();
        self.outputs.clear();
        self.aiding.clear();
        self.altered.clear();
        self.lost.clear();
        self.added.clear();
        self.due.clear();
        self.innovations.clear();
        self.covariances.clear();
        self.truth.clear();
        self.parameters.clear();
        self.events.clear();
    }
}

impl EpochFrame<'_> {
    /// True if the core received another epoch than the source delivered.
    #[inline]
    pub(super) fn is_altered(&self) -> bool {
        !std::ptr::eq(self.clean, self.faulted) && !same(self.clean, self.faulted)
    }
}

/// True if both have the same bits: NaN equals itself, and zero differs from minus zero.
fn same(a: &Epoch, b: &Epoch) -> bool {
    a.sample == b.sample
        && match (&a.aiding, &b.aiding) {
            (None, None) => true,
            (Some(a), Some(b)) => super::message::aiding_bits(a) == super::message::aiding_bits(b),
            _ => false,
        }
}
