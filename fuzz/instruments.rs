//! What is done with foreign bytes of instruments, for the fuzzer and for the test that runs the corpus.
//!
//! Nothing may panic, every byte has to be accounted for, and how the bytes are cut may make no
//! difference.

use octant_instruments::{
    AnyDecoder, Axes, FramingEvent, Protocol, ReadingCounters, Sampler, SamplerSettings,
};

/// The protocol that the first byte chooses, in pieces of the length that the second one says.
pub(crate) fn stream(bytes: &[u8]) {
    let [choice, piece, bytes @ ..] = bytes else { return };
    let protocol = Protocol::ALL[usize::from(*choice) % Protocol::ALL.len()];
    let (mut whole, mut cut) = (AnyDecoder::new(protocol), AnyDecoder::new(protocol));
    let mut rest = bytes;
    let mut events: Vec<FramingEvent> = std::iter::from_fn(|| whole.next(&mut rest)).collect();
    assert!(rest.is_empty());
    events.extend(std::iter::from_fn(|| whole.end()));
    let mut in_pieces = Vec::new();
    for mut piece in bytes.chunks(usize::from(*piece).max(1)) {
        in_pieces.extend(std::iter::from_fn(|| cut.next(&mut piece)));
    }
    in_pieces.extend(std::iter::from_fn(|| cut.end()));
    // As text: a NaN is equal to itself there.
    assert_eq!(format!("{events:?}"), format!("{in_pieces:?}"));
    assert_eq!(whole.counters(), cut.counters());
    accounted(whole.counters(), bytes.len(), events.len());
    let mut sampler = Sampler::new(SamplerSettings { axes: Axes::SAME, rate_hz: 200.0 });
    let mut last = None;
    for event in events {
        let FramingEvent::Reading(reading) = event else { continue };
        if let Ok(sample) = sampler.sample(&reading, None) {
            assert!(last.is_none_or(|last| sample.sequence > last));
            last = Some(sample.sequence);
        }
    }
}

fn accounted(counters: &ReadingCounters, bytes: usize, events: usize) {
    assert_eq!(counters.bytes, bytes as u64);
    assert_eq!(counters.bytes_framed + counters.bytes_lost, counters.bytes);
    let lost = counters.checksum + counters.malformed + counters.unknown;
    assert_eq!(counters.readings + lost, events as u64);
}
