//! A block of epochs: what the run loop collects and the recorder's thread works off.

use super::{Event, Extra, Frame};
use octant_sample::Epoch;
use octant_sample::Truth;
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{Aiding, Output, Sample};

/// Epochs in columns, what is rare in lists of its own: a plain epoch costs two short copies.
///
/// A position is the number of frames of this block that came before: what belongs to frame `i`
/// stands at `i` ([`Block::aiding`], [`Block::altered`]) or, for what was said after it, at `i + 1`.
#[derive(Debug, Default)]
pub(super) struct Block {
    /// What reached the core; of a lost epoch what the source had delivered.
    pub(super) samples: Vec<Sample>,
    /// What it answered; of a lost epoch nothing of meaning.
    pub(super) outputs: Vec<Output>,
    /// Aiding that reached the core, by frame.
    pub(super) aiding: Vec<(u32, Aiding)>,
    /// What the source had delivered, for frames where it differs from what reached the core.
    pub(super) altered: Vec<(u32, Epoch)>,
    /// Frames of epochs that never reached the core in their step.
    pub(super) lost: Vec<u32>,
    /// Frames that reached the core beside another of the same step of the source, with the time
    /// of the step.
    pub(super) added: Vec<(u32, u64)>,
    /// Frames on the recording grid.
    pub(super) due: Vec<u32>,
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
            truth: Vec::with_capacity(64),
            parameters: Vec::with_capacity(64),
            events: Vec::new(),
        }
    }

    /// Frames in the block.
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

    #[inline]
    pub(super) fn push(&mut self, frame: &Frame<'_>, due: bool) {
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
        // Not `push`: that copies by way of the stack.
        self.samples.extend_from_slice(std::slice::from_ref(&frame.faulted.sample));
        self.outputs.extend_from_slice(std::slice::from_ref(frame.output));
    }

    /// Takes an epoch that didn't reach the core in its step.
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

    /// Takes an epoch that reached the core in a step in which another one had.
    pub(super) fn added(&mut self, step_ns: u64, faulted: &Epoch, output: &Output, due: bool) {
        let position = self.position();
        self.added.push((position, step_ns));
        self.push(&Frame { clean: faulted, faulted, output }, due);
    }

    pub(super) fn extra(&mut self, extra: &Extra) {
        let position = self.position();
        match extra {
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
        self.truth.clear();
        self.parameters.clear();
        self.events.clear();
    }
}

impl Frame<'_> {
    /// The core got something else than the source had delivered.
    #[inline]
    pub(super) fn is_altered(&self) -> bool {
        !same(self.clean, self.faulted)
    }
}

/// Bit for bit the same: NaN is equal to itself and zero differs from minus zero.
#[inline]
fn same(a: &Epoch, b: &Epoch) -> bool {
    std::ptr::eq(a, b)
        || (a.sample == b.sample
            && match (&a.aiding, &b.aiding) {
                (None, None) => true,
                (Some(a), Some(b)) => {
                    super::message::aiding_bits(a) == super::message::aiding_bits(b)
                }
                _ => false,
            })
}
