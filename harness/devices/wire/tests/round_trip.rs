//! Every message arrives bit for bit as it was sent, in both encodings, cut anywhere.

use crate::common::arbitrary::{message, one_of_each};
use crate::common::{decode, encode, frames, messages, reassemble, received, same, sender};
use octant_wire::can::{CanVersion, Reassembler};
use octant_wire::message::ClockTime;
use octant_wire::serial::{FrameOrder, MAX_FRAME_BYTES, SerialDecoder, SerialEncoder};
use octant_wire::{EndRole, Message, MessageKind};
use proptest::prelude::*;

proptest! {
    #[test]
    fn a_payload_is_its_message(message in message()) {
        let payload = message.payload();
        let again = Message::read(payload.kind(), payload.bytes()).unwrap();
        prop_assert!(again.same_bits(&message));
    }

    #[test]
    fn a_frame_is_its_message(message in message(), sequence: u16, ns: u64) {
        let mut encoder = SerialEncoder::starting_at(sequence);
        let bytes = encoder.encode(&message, ClockTime::from_ns(ns)).to_vec();
        prop_assert!(bytes.len() <= MAX_FRAME_BYTES);
        let (last, inner) = bytes[1..].split_last().unwrap();
        prop_assert!(bytes[0] == 0 && *last == 0 && !inner.contains(&0));
        let mut decoder = SerialDecoder::new();
        let all = received(&decode(&mut decoder, &[&bytes]));
        prop_assert_eq!(all.len(), 1);
        prop_assert_eq!((all[0].sequence, all[0].clock.ns), (sequence, ns));
        prop_assert_eq!(all[0].order, FrameOrder::First);
        prop_assert!(all[0].message.same_bits(&message));
        prop_assert!(decoder.counters().is_clean());
    }

    #[test]
    fn can_frames_are_their_message(message in message(), fd: bool) {
        let format = if fd { CanVersion::Fd } else { CanVersion::Classic };
        let sender = sender(&message);
        let mut reassembler = Reassembler::new(&[sender], format);
        let events = reassemble(&mut reassembler, &frames(&message, format));
        prop_assert!(same(&messages(&events), &[message]));
        prop_assert!(reassembler.counters().is_clean());
        prop_assert_eq!(reassembler.counters().foreign, 0);
    }

    #[test]
    fn where_the_bytes_are_cut_makes_no_difference(
        sent in proptest::collection::vec(message(), 1..8),
        garbage in proptest::collection::vec(any::<u8>(), 0..600),
        cuts in proptest::collection::vec(any::<prop::sample::Index>(), 0..12),
    ) {
        let mut bytes = encode(&sent);
        let at = bytes.len() / 2;
        bytes.splice(at..at, garbage);
        let mut at: Vec<usize> = cuts.iter().map(|cut| cut.index(bytes.len() + 1)).collect();
        at.sort_unstable();
        let mut pieces = Vec::new();
        let mut from = 0;
        for to in at.into_iter().chain([bytes.len()]) {
            pieces.push(&bytes[from..to]);
            from = to;
        }
        let (mut whole, mut cut) = (SerialDecoder::new(), SerialDecoder::new());
        let expected = decode(&mut whole, &[&bytes]);
        let found = decode(&mut cut, &pieces);
        prop_assert_eq!(format!("{expected:?}"), format!("{found:?}"));
        prop_assert_eq!(whole.counters(), cut.counters());
    }

    #[test]
    fn kinds_interleave_on_a_bus_as_priorities_have_it(
        sent in proptest::collection::vec(message(), 1..10),
        picks in proptest::collection::vec(any::<prop::sample::Index>(), 400),
        fd: bool,
    ) {
        // Messages of one slot stay in order; those of different slots may overtake each other.
        let format = if fd { CanVersion::Fd } else { CanVersion::Classic };
        let mut queues: Vec<(u16, Vec<_>)> = Vec::new();
        for message in &sent {
            let frames = frames(message, format);
            let slot = frames[0].id() >> 5;
            match queues.iter_mut().find(|(queue, _)| *queue == slot) {
                Some((_, queue)) => queue.extend(frames),
                None => queues.push((slot, frames)),
            }
        }
        let mut picks = picks.iter().cycle();
        let mut on_bus = Vec::new();
        while !queues.is_empty() {
            let queue = picks.next().unwrap().index(queues.len());
            on_bus.push(queues[queue].1.remove(0));
            queues.retain(|(_, queue)| !queue.is_empty());
        }
        let mut reassembler = Reassembler::new(&EndRole::ALL, format);
        let events = reassemble(&mut reassembler, &on_bus);
        prop_assert!(reassembler.counters().is_clean(), "{:?}", reassembler.counters());
        let mut found: Vec<_> = messages(&events).iter().map(|m| m.payload().bytes().to_vec()).collect();
        let mut expected: Vec<_> = sent.iter().map(|m| m.payload().bytes().to_vec()).collect();
        found.sort_unstable();
        expected.sort_unstable();
        prop_assert_eq!(found, expected);
    }

    #[test]
    fn any_payload_is_read_or_refused_and_what_is_read_is_written_back(
        code in 0..20u8,
        bytes in proptest::collection::vec(any::<u8>(), 0..260),
        fitting: bool,
    ) {
        let Some(kind) = MessageKind::of(code) else { return Ok(()) };
        let mut bytes = bytes;
        if fitting {
            bytes.resize(kind.payload_bytes(), 0);
        }
        if let Ok(message) = Message::read(kind, &bytes) {
            let payload = message.payload();
            let again = Message::read(kind, payload.bytes()).unwrap();
            prop_assert!(again.same_bits(&message));
        }
    }
}

#[test]
fn frames_are_numbered_and_gaps_counted() {
    let sent = one_of_each();
    // A hello restarts the numbering and is left out here.
    let sent: Vec<_> = sent.into_iter().filter(|m| m.kind() != MessageKind::Hello).collect();
    let mut encoder = SerialEncoder::starting_at(0xFFFD);
    let all: Vec<Vec<u8>> =
        sent.iter().map(|m| encoder.encode(m, ClockTime::default()).to_vec()).collect();
    let order = |picked: &[usize]| {
        let mut decoder = SerialDecoder::new();
        let bytes: Vec<u8> = picked.iter().flat_map(|i| all[*i].clone()).collect();
        let events = decode(&mut decoder, &[&bytes]);
        (received(&events).iter().map(|r| r.order).collect::<Vec<_>>(), *decoder.counters())
    };
    use FrameOrder::{Behind, First, Missing, Next};
    let (orders, counters) = order(&[0, 1, 2, 3, 4]);
    assert_eq!(orders, [First, Next, Next, Next, Next]);
    assert!(counters.is_clean());
    let (orders, counters) = order(&[0, 1, 5, 6]);
    assert_eq!(orders, [First, Next, Missing(3), Next]);
    assert_eq!((counters.missing, counters.behind), (3, 0));
    let (orders, counters) = order(&[0, 1, 1, 2, 0, 3]);
    assert_eq!(orders, [First, Next, Behind(1), Next, Behind(3), Next]);
    assert_eq!((counters.missing, counters.behind), (0, 2));
}

#[test]
fn half_of_the_numbers_are_ahead_and_half_behind() {
    let end = *one_of_each().iter().find(|message| message.kind() == MessageKind::End).unwrap();
    for (second, expected) in [
        (1, FrameOrder::Next),
        (2, FrameOrder::Missing(1)),
        (0x8000, FrameOrder::Missing(0x7FFF)),
        (0x8001, FrameOrder::Behind(0x8000)),
        (0xFFFF, FrameOrder::Behind(2)),
        (0, FrameOrder::Behind(1)),
    ] {
        let mut decoder = SerialDecoder::new();
        let first = SerialEncoder::starting_at(0).encode(&end, ClockTime::default()).to_vec();
        let second = SerialEncoder::starting_at(second).encode(&end, ClockTime::default()).to_vec();
        let events = decode(&mut decoder, &[&first, &second]);
        assert_eq!(received(&events)[1].order, expected);
    }
}

#[test]
fn the_longest_frame_fits() {
    // Without zeros, stuffing is at its longest.
    let mut longest = 0;
    for message in one_of_each() {
        let bytes = encode(&[message]);
        longest = longest.max(bytes.len());
    }
    let full = octant_sample::Parameters::from_array(&[f64::from_bits(0x0101_0101_0101_0101); 30]);
    let step = octant_wire::StepNumber::new(0x0101);
    let restart = octant_wire::message::Restart { step, offset: Some(full) };
    let mut encoder = SerialEncoder::starting_at(0x0101);
    let clock = ClockTime::from_ns(0x0101_0101_0101_0101);
    longest = longest.max(encoder.encode(&Message::Restart(restart), clock).len());
    assert!(longest >= MAX_FRAME_BYTES - 1, "{longest} of {MAX_FRAME_BYTES}");
}
