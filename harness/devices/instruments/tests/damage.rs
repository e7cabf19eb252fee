//! Damaged bytes never make a reading that wasn't sent, and cost only the frames that they touch.

use crate::common::{events, readings, streams};
use octant_instruments::{AnyDecoder, Protocol, Reading};
use proptest::prelude::*;

/// Decodes a whole stream to its end.
fn decode(protocol: Protocol, bytes: &[u8]) -> (Vec<Reading>, AnyDecoder) {
    let mut decoder = AnyDecoder::new(protocol);
    let mut all = events(&mut decoder, bytes);
    while let Some(event) = decoder.end() {
        all.push(event);
    }
    let counters = decoder.counters();
    assert_eq!(counters.bytes, bytes.len() as u64);
    assert_eq!(counters.bytes_framed + counters.bytes_lost, bytes.len() as u64);
    (readings(&all), decoder)
}

/// Replaces every byte of a frame by every other value: all readings found were sent, and the frames
/// before and after are found.
#[test]
fn no_byte_of_a_frame_can_be_another_one() {
    for (protocol, frames) in streams(3) {
        let sent = decode(protocol, &frames.concat()).0;
        assert_eq!(sent.len(), 3);
        let before = frames[0].len();
        for at in 0..frames[1].len() {
            for flip in 1..=255u8 {
                let mut bytes = frames.concat();
                bytes[before + at] ^= flip;
                let (found, decoder) = decode(protocol, &bytes);
                let context = format!("{protocol:?} byte {at} ^ {flip:#04x}");
                assert!(found.iter().all(|one| sent.contains(one)), "{context}: {found:?}");
                assert!(found.contains(&sent[0]), "{context}: the one before is lost");
                assert!(found.contains(&sent[2]), "{context}: the one after is lost");
                // A hexadecimal digit in the other case is the same number. And an Octant frame ends
                // with a zero before another zero, one of which is enough.
                if found.len() == 3 {
                    assert_eq!(found, sent, "{context}");
                } else {
                    assert!(!decoder.counters().is_clean(), "{context}");
                }
            }
        }
    }
}

#[test]
fn a_frame_that_is_cut_short_costs_itself() {
    for (protocol, frames) in streams(3) {
        let sent = decode(protocol, &frames.concat()).0;
        for cut in 1..frames[1].len() {
            let bytes = [&frames[0], &frames[1][..cut], &frames[2]].concat();
            let (found, _) = decode(protocol, &bytes);
            assert!(found.iter().all(|one| sent.contains(one)), "{protocol:?} {cut}");
            assert!(found.contains(&sent[0]), "{protocol:?} {cut}");
            // An Octant frame ends with a zero, and the next one begins with one.
            assert!(found.contains(&sent[2]), "{protocol:?} {cut}: {found:?}");
            let tail = [&frames[1][cut..], &frames[2][..]].concat();
            assert!(decode(protocol, &tail).0.contains(&sent[2]), "{protocol:?} {cut}");
        }
    }
}

/// Beginnings of long frames that are never completed, right before a frame.
#[test]
fn a_sync_by_chance_costs_no_frame() {
    for (protocol, frames) in streams(40) {
        let sent = decode(protocol, &frames.concat()).0;
        for chance in protocol.facts().false_starts {
            let bytes = [*chance, &frames.concat()].concat();
            let (found, decoder) = decode(protocol, &bytes);
            assert_eq!(found, sent, "{protocol:?} {chance:?}");
            assert_eq!(decoder.counters().bytes_lost, chance.len() as u64);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Frames that the damage doesn't touch are read, in order.
    #[test]
    fn what_is_not_touched_is_read(
        strikes in proptest::collection::vec((any::<prop::sample::Index>(), 0..4u8, any::<u8>()), 0..6),
    ) {
        for (protocol, frames) in streams(12) {
            let sent = decode(protocol, &frames.concat()).0;
            let mut damaged = frames.clone();
            let mut touched = vec![false; frames.len()];
            for (at, strike, byte) in &strikes {
                let which = at.index(frames.len());
                let frame = &mut damaged[which];
                touched[which] = true;
                let at = at.index(frame.len().max(1)).min(frame.len());
                match strike {
                    0 if at < frame.len() => frame[at] ^= byte | 1,
                    1 => frame.insert(at, *byte),
                    2 if at < frame.len() => drop(frame.remove(at)),
                    _ => frame.truncate(at),
                }
            }
            let (found, _) = decode(protocol, &damaged.concat());
            for (sent, touched) in sent.iter().zip(&touched) {
                prop_assert!(*touched || found.contains(sent), "{protocol:?}");
            }
            // The one-byte checksum passes two errors in one frame that cancel each other.
            if protocol != Protocol::Xsens || strikes.len() < 2 {
                prop_assert!(found.iter().all(|one| sent.contains(one)), "{protocol:?}");
            }
        }
    }

    /// Arbitrary bytes are counted and cause no panic.
    #[test]
    fn any_bytes_are_counted(bytes in proptest::collection::vec(any::<u8>(), 0..3000)) {
        for protocol in Protocol::ALL {
            decode(protocol, &bytes);
        }
    }
}
