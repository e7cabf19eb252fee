//! Parameters and their σ, in six segments, so that they never delay an output for long.

use super::kind::MessageKind;
use super::step::StepNumber;
use crate::Unreadable;
use crate::bytes::{Reader, Writer};
use octant_sample::Parameters;
use octant_sample::parameters::PARAMETER_COUNT;

/// Number of parameters in a segment.
pub const SEGMENT_VALUES: usize = 5;
/// Number of segments of all parameters.
pub const PARAMETERS_SEGMENTS: usize = PARAMETER_COUNT / SEGMENT_VALUES;

/// Five parameters with their σ, in the order of [`octant_sample::parameters::NAMES`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ParametersSegment {
    /// Number of the step whose output announced them.
    pub step: StepNumber,
    /// Index of the segment, from 0.
    pub segment: u8,
    /// Revision of the parameters.
    pub revision: u32,
    /// Estimates, SI.
    pub values: [f64; SEGMENT_VALUES],
    /// 1σ, SI.
    pub sigma: [f64; SEGMENT_VALUES],
}

impl ParametersSegment {
    /// Divides all parameters into segments.
    #[must_use]
    pub fn all(
        step: StepNumber,
        revision: u32,
        parameters: &Parameters,
        sigma: &[f64; PARAMETER_COUNT],
    ) -> [Self; PARAMETERS_SEGMENTS] {
        let values = parameters.to_array();
        core::array::from_fn(|segment| {
            let at = segment * SEGMENT_VALUES;
            Self {
                step,
                segment: segment as u8,
                revision,
                values: core::array::from_fn(|i| values[at + i]),
                sigma: core::array::from_fn(|i| sigma[at + i]),
            }
        })
    }

    pub(super) fn write(&self, w: &mut Writer<'_>) {
        w.u16(self.step.number());
        w.u8(self.segment);
        w.u8(0);
        w.u32(self.revision);
        w.u32(0);
        for value in self.values.iter().chain(&self.sigma) {
            w.f64(*value);
        }
    }

    pub(super) fn read(r: &mut Reader<'_>) -> Result<Self, Unreadable> {
        let step = StepNumber::new(r.u16());
        let [segment, _] = r.take();
        if usize::from(segment) >= PARAMETERS_SEGMENTS {
            return Err(Unreadable::Value {
                kind: MessageKind::Parameters,
                field: "segment",
                found: segment.into(),
                expected: "0 to 5",
            });
        }
        let revision = r.u32();
        r.u32();
        let (values, sigma) = (r.array(Reader::f64), r.array(Reader::f64));
        Ok(Self { step, segment, revision, values, sigma })
    }
}

/// All parameters with their σ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gathered {
    /// Number of the step whose output announced them.
    pub step: StepNumber,
    /// Revision of the parameters.
    pub revision: u32,
    /// Estimates, SI.
    pub parameters: Parameters,
    /// 1σ, SI.
    pub sigma: [f64; PARAMETER_COUNT],
}

/// Collects segments, in any order, until all of one step and revision are there.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gathering {
    step: StepNumber,
    revision: u32,
    values: [f64; PARAMETER_COUNT],
    sigma: [f64; PARAMETER_COUNT],
    /// Received segments, a bit for each.
    there: u8,
    abandoned: u64,
}

impl Gathering {
    /// Makes an empty collection.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a segment; returns all parameters if it was the last one missing. A segment of another step
    /// or revision begins a new set and abandons the segments of the former.
    pub fn add(&mut self, segment: &ParametersSegment) -> Option<Gathered> {
        let index = usize::from(segment.segment);
        if index >= PARAMETERS_SEGMENTS {
            return None;
        }
        if (segment.step, segment.revision) != (self.step, self.revision) {
            self.abandoned += u64::from(self.there != 0);
            self.there = 0;
            self.step = segment.step;
            self.revision = segment.revision;
        }
        let range = index * SEGMENT_VALUES..(index + 1) * SEGMENT_VALUES;
        self.values[range.clone()].copy_from_slice(&segment.values);
        self.sigma[range].copy_from_slice(&segment.sigma);
        self.there |= 1 << index;
        if self.there != (1 << PARAMETERS_SEGMENTS) - 1 {
            return None;
        }
        self.there = 0;
        Some(Gathered {
            step: self.step,
            revision: self.revision,
            parameters: Parameters::from_array(&self.values),
            sigma: self.sigma,
        })
    }

    /// Number of incomplete sets that were abandoned for another step or revision.
    #[must_use]
    pub fn abandoned(&self) -> u64 {
        self.abandoned
    }
}
