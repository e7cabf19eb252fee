//! Hashes and counts of the epochs so far, and the summary that they end in.

use super::altered;
use super::altered::AlteredStreams;
use super::block::Block;
use super::stream_hash::StreamHash;
use super::{EpochFrame, MessageCounts};

/// Hashes and counts of the epochs so far.
#[derive(Clone, Debug)]
pub(super) struct Digest {
    pub(super) hash: StreamHash,
    /// True if the source's stream is compared with the core's.
    pub(super) compares: bool,
    pub(super) streams: Option<altered::Streams>,
    pub(super) summary: RecorderSummary,
}

impl Digest {
    pub(super) fn new() -> Self {
        Self {
            hash: StreamHash::new(),
            compares: true,
            streams: None,
            summary: RecorderSummary::default(),
        }
    }

    /// Takes a frame in which the core received the source's epoch.
    #[inline]
    pub(super) fn epoch(&mut self, frame: &EpochFrame<'_>) {
        let (sample, aiding) = (&frame.faulted.sample, frame.faulted.aiding.as_ref());
        self.hash.epoch(sample, aiding, frame.output);
        if let Some(streams) = &mut self.streams {
            streams.unaltered(sample, aiding);
        }
        self.summary.epochs += 1;
        self.summary.aiding += u64::from(aiding.is_some());
    }

    /// Takes the contents of a block, and empties it.
    #[inline]
    pub(super) fn take_up(&mut self, block: &mut Block) {
        if !block.is_empty() {
            self.take(block);
            block.clear();
        }
    }

    #[inline(never)]
    pub(super) fn take(&mut self, block: &Block) {
        hash_block(&mut self.hash, block);
        if self.compares {
            altered::take(&mut self.streams, block);
        }
        let summary = &mut self.summary;
        summary.epochs += (block.len() - block.lost.len()) as u64;
        summary.aiding += block.aiding.len() as u64;
        summary.altered += (block.altered.len() + block.added.len()) as u64;
    }

    pub(super) fn finish(mut self) -> RecorderSummary {
        RecorderSummary {
            stream_hash: self.hash.hex(),
            altered_streams: self.streams.map(altered::Streams::finish),
            ..self.summary
        }
    }
}

fn hash_block(hash: &mut StreamHash, block: &Block) {
    let mut aiding = block.aiding.iter().peekable();
    let mut parameters = block.parameters.iter().peekable();
    let mut lost = block.lost.iter().peekable();
    let end = block.len();
    let mut index = 0;
    while index <= end {
        let position = index as u32;
        while let Some((_, estimate)) = parameters.next_if(|(at, _)| *at == position) {
            hash.parameters(estimate);
        }
        if lost.next_if(|at| **at == position).is_none()
            && let (Some(sample), Some(output)) =
                (block.samples.get(index), block.outputs.get(index))
        {
            let aiding = aiding.next_if(|(at, _)| *at == position).map(|(_, aiding)| aiding);
            hash.epoch(sample, aiding, output);
        }
        index += 1;
        // Up to the next frame with a part of its own, samples and outputs follow one another.
        let next = [
            aiding.peek().map(|(at, _)| *at),
            parameters.peek().map(|(at, _)| *at),
            lost.peek().map(|at| **at),
        ];
        let next = next.into_iter().flatten().min().map_or(end, |at| end.min(at as usize));
        if index < next {
            for (sample, output) in
                block.samples[index..next].iter().zip(&block.outputs[index..next])
            {
                hash.plain(sample, output);
            }
            index = next;
        }
    }
}

/// Summary of a recording.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecorderSummary {
    /// Hash of the whole stream ([`StreamHash`](super::StreamHash)); empty for a recorder without any function.
    pub stream_hash: String,
    /// Number of epochs.
    pub epochs: u64,
    /// Number of aiding messages that reached the core.
    pub aiding: u64,
    /// Number of epochs in which the core received something else than the source delivered.
    pub altered: u64,
    /// Checksums of the streams of the source and the core, if they differ.
    pub altered_streams: Option<AlteredStreams>,
    /// Number of messages in the file, by topic.
    pub messages: MessageCounts,
    /// Size of the file, bytes.
    pub bytes: u64,
}
