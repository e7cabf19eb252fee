//! Checksums of the two streams of a run with faults: of the source, and as received by the core.
//!
//! Both begin with the first epoch in which they differ and continue to the end of the run: BLAKE3 over
//! the canonical bytes of sample and aiding, epoch by epoch. Before that the streams are equal, and
//! nothing is computed.

use super::StreamHash;
use super::block::Block;
use octant_sample::{Aiding, Sample};

/// Checksums of the clean and of the faulted stream.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlteredStreams {
    /// Sequence number of the first sample that was altered, lost or added.
    pub first_sample: u64,
    /// BLAKE3 of the source's stream from then on, 64 hexadecimal digits.
    pub clean_blake3: String,
    /// BLAKE3 of the core's stream from then on, 64 hexadecimal digits.
    pub faulted_blake3: String,
}

/// Both hashes so far.
#[derive(Clone, Debug)]
pub(super) struct Streams {
    first_sample: u64,
    clean: StreamHash,
    faulted: StreamHash,
}

impl Streams {
    /// Adds an epoch that is the same in both streams.
    #[inline]
    pub(super) fn unaltered(&mut self, sample: &Sample, aiding: Option<&Aiding>) {
        self.clean.input(sample, aiding);
        self.faulted.input(sample, aiding);
    }

    pub(super) fn finish(mut self) -> AlteredStreams {
        AlteredStreams {
            first_sample: self.first_sample,
            clean_blake3: self.clean.hex(),
            faulted_blake3: self.faulted.hex(),
        }
    }
}

/// Adds a block; starts the hashes at the first difference.
pub(super) fn take(streams: &mut Option<Streams>, block: &Block) {
    if streams.is_none() && block.altered.is_empty() && block.added.is_empty() {
        return;
    }
    let mut aiding = block.aiding.iter().peekable();
    let mut altered = block.altered.iter().peekable();
    let mut lost = block.lost.iter().peekable();
    let mut added = block.added.iter().peekable();
    for (position, sample) in block.samples.iter().enumerate() {
        let at = position as u32;
        let aiding = aiding.next_if(|(of, _)| *of == at).map(|(_, aiding)| aiding);
        let clean = altered.next_if(|(of, _)| *of == at).map(|(_, epoch)| epoch);
        let lost = lost.next_if(|of| **of == at).is_some();
        let added = added.next_if(|(of, _)| *of == at).is_some();
        if streams.is_none() && (clean.is_some() || added) {
            let first_sample = clean.map_or(sample.sequence, |epoch| epoch.sample.sequence);
            let (clean, faulted) = (StreamHash::new(), StreamHash::new());
            *streams = Some(Streams { first_sample, clean, faulted });
        }
        let Some(streams) = streams else { continue };
        match clean {
            Some(epoch) => streams.clean.input(&epoch.sample, epoch.aiding.as_ref()),
            None if added => {}
            None => streams.clean.input(sample, aiding),
        }
        if !lost {
            streams.faulted.input(sample, aiding);
        }
    }
}
