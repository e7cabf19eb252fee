//! Damage costs only the messages that it hits, and is always noticed.

use crate::common::arbitrary::{message, one_of_each, output, sample};
use crate::common::{decode, encode, frames, messages, reassemble, received, same, sender};
use octant_wire::can::{self, BusFrame, CanVersion, Reassembler};
use octant_wire::serial::{DecodeEvent, FrameDefect, MAX_STUFFED_BYTES, SerialDecoder};
use octant_wire::{Message, MessageKind, Unreadable};
use proptest::prelude::*;

#[test]
fn every_flipped_bit_of_a_frame_is_noticed() {
    // The bit is in the second of three frames; the other two must arrive.
    for message in one_of_each() {
        let parts: Vec<Vec<u8>> = (0..3).map(|_| encode(&[message])).collect();
        let from = parts[0].len();
        let bytes = parts.concat();
        for bit in 8 * from..8 * (from + parts[1].len()) {
            let mut flipped = bytes.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            let mut decoder = SerialDecoder::new();
            let events = decode(&mut decoder, &[&flipped]);
            let found: Vec<Message> = received(&events).iter().map(|r| r.message).collect();
            assert!(!decoder.counters().is_clean(), "bit {bit} of {:?}", message.kind());
            assert!(decoder.counters().damaged() >= 1);
            assert!(same(&found, &[message, message]), "bit {bit} of {:?}", message.kind());
        }
    }
}

/// Flips one bit of identifier, data or length of a frame; `None`: no such frame exists.
fn flip(frame: &BusFrame, bit: usize) -> Option<BusFrame> {
    let bits = 8 * frame.data().len();
    let mut data = frame.data().to_vec();
    if bit < bits {
        data[bit / 8] ^= 1 << (bit % 8);
        return BusFrame::new(frame.id(), frame.format(), &data);
    }
    match bit - bits {
        id @ 0..11 => BusFrame::new(frame.id() ^ 1 << id, frame.format(), &data),
        11 => {
            data.pop();
            while BusFrame::new(0, frame.format(), &data).is_none() {
                data.pop();
            }
            BusFrame::new(frame.id(), frame.format(), &data)
        }
        _ => None,
    }
}

#[test]
fn every_flipped_bit_of_a_can_message_is_noticed() {
    for format in [CanVersion::Classic, CanVersion::Fd] {
        for message in one_of_each() {
            let good = frames(&message, format);
            for damaged in 0..good.len() {
                for bit in 0..8 * good[damaged].data().len() + 12 {
                    let mut bus = good.clone();
                    let Some(frame) = flip(&bus[damaged], bit) else { continue };
                    bus[damaged] = frame;
                    bus.extend(good.clone());
                    let mut reassembler = Reassembler::new(&[sender(&message)], format);
                    let events = reassemble(&mut reassembler, &bus);
                    let place =
                        format!("bit {bit} of frame {damaged}, {:?} {format:?}", message.kind());
                    assert!(same(&messages(&events), &[message]), "{place}: {events:?}");
                    let counters = reassembler.counters();
                    assert!(
                        !counters.is_clean()
                            || counters.foreign > 0
                            || reassembler.unfinished() > 0,
                        "{place}"
                    );
                }
            }
        }
    }
}

proptest! {
    #[test]
    fn garbage_between_frames_loses_nothing(
        sent in proptest::collection::vec(message(), 1..5),
        garbage in proptest::collection::vec(proptest::collection::vec(any::<u8>(), 0..700), 6),
    ) {
        // Random garbage would need the right CRC to be a frame.
        let frames: Vec<Vec<u8>> = sent.iter().map(|m| encode(&[*m])).collect();
        let mut bytes = garbage[0].clone();
        for (frame, garbage) in frames.iter().zip(&garbage[1..]) {
            bytes.extend(frame);
            bytes.extend(garbage);
        }
        let mut decoder = SerialDecoder::new();
        let events = decode(&mut decoder, &[&bytes]);
        let found: Vec<Message> = received(&events).iter().map(|r| r.message).collect();
        prop_assert!(same(&found, &sent));
        // Every byte is part of a frame, lost, a zero, or still held.
        let counters = *decoder.counters();
        let whole: usize = frames.iter().map(|frame| frame.len() - 2).sum();
        let zeros = bytes.iter().filter(|byte| **byte == 0).count();
        let held = bytes.len() - bytes.iter().rposition(|byte| *byte == 0).unwrap() - 1;
        let held = if held > MAX_STUFFED_BYTES { 0 } else { held };
        prop_assert_eq!(counters.bytes as usize, bytes.len());
        prop_assert_eq!(counters.bytes_lost as usize, bytes.len() - whole - zeros - held);
    }

    #[test]
    fn a_hit_costs_the_frames_that_it_touches(
        sent in proptest::collection::vec(message(), 3..8),
        hit: prop::sample::Index,
        length in 1..300usize,
        with: u8,
    ) {
        let frames: Vec<Vec<u8>> = sent.iter().map(|m| encode(&[*m])).collect();
        let mut bytes = frames.concat();
        let from = hit.index(bytes.len());
        let to = (from + length).min(bytes.len());
        bytes[from..to].fill(with);
        let mut decoder = SerialDecoder::new();
        let found: Vec<Message> =
            received(&decode(&mut decoder, &[&bytes])).iter().map(|r| r.message).collect();
        let mut at = 0;
        let mut untouched = Vec::new();
        for (frame, message) in frames.iter().zip(&sent) {
            let end = at + frame.len();
            if end <= from || to <= at {
                untouched.push(*message);
            }
            at = end;
        }
        // Damage may leave a frame unchanged; it never loses an untouched frame, and never creates one.
        prop_assert!(untouched.iter().all(|m| found.iter().any(|f| f.same_bits(m))));
        prop_assert!(found.iter().all(|f| sent.iter().any(|m| f.same_bits(m))));
        prop_assert!(found.len() <= sent.len());
    }

    #[test]
    fn any_bytes_at_all_are_counted(
        pieces in proptest::collection::vec(proptest::collection::vec(any::<u8>(), 0..400), 0..8),
    ) {
        let mut decoder = SerialDecoder::new();
        for piece in &pieces {
            decode(&mut decoder, &[piece]);
            decoder.end();
        }
        let counters = *decoder.counters();
        let all: usize = pieces.iter().map(Vec::len).sum();
        let zeros = pieces.iter().flatten().filter(|byte| **byte == 0).count();
        prop_assert_eq!(counters.bytes as usize, all);
        prop_assert_eq!(counters.bytes_lost as usize, all - zeros);
        prop_assert_eq!(counters.frames, 0, "thirty-two bits by chance");
    }

    #[test]
    fn segments_lost_doubled_or_moved_never_make_a_message_that_was_not_sent(
        sent in proptest::collection::vec(prop_oneof![sample(), output()], 2..8),
        strikes in proptest::collection::vec((any::<prop::sample::Index>(), 0..4u8), 0..12),
        fd: bool,
    ) {
        let format = if fd { CanVersion::Fd } else { CanVersion::Classic };
        let mut bus: Vec<BusFrame> = sent.iter().flat_map(|m| frames(m, format)).collect();
        for (at, strike) in strikes {
            if bus.is_empty() {
                break;
            }
            let at = at.index(bus.len());
            match strike {
                0 => drop(bus.remove(at)),
                1 => {
                    let again = bus[at];
                    bus.insert(at, again);
                }
                2 => {
                    let with = (at + 1) % bus.len();
                    bus.swap(at, with);
                }
                _ => {
                    let frame = bus.remove(at);
                    bus.insert((at + 5).min(bus.len()), frame);
                }
            }
        }
        let mut reassembler = Reassembler::new(&octant_wire::EndRole::ALL, format);
        let found = messages(&reassemble(&mut reassembler, &bus));
        prop_assert!(found.iter().all(|f| sent.iter().any(|m| f.same_bits(m))));
        let counters = *reassembler.counters();
        prop_assert_eq!(counters.frames as usize, bus.len());
        if found.len() < sent.len() && format == CanVersion::Classic {
            // Each of these messages has many segments, so a loss shows.
            let all_of_one = counters.is_clean();
            let whole: usize = sent.iter().map(|m| frames(m, format).len()).sum();
            prop_assert!(!all_of_one || bus.len() < whole);
        }
    }

    #[test]
    fn any_can_frames_at_all_are_counted(
        bus in proptest::collection::vec((0..0x800u16, proptest::collection::vec(any::<u8>(), 0..65)), 0..60),
        fd: bool,
    ) {
        let format = if fd { CanVersion::Fd } else { CanVersion::Classic };
        let bus: Vec<BusFrame> = bus.iter().filter_map(|(id, data)| BusFrame::new(*id, format, data)).collect();
        let mut reassembler = Reassembler::new(&octant_wire::EndRole::ALL, format);
        let events = reassemble(&mut reassembler, &bus);
        prop_assert_eq!(messages(&events).len(), 0, "thirty-two bits by chance");
        prop_assert_eq!(reassembler.counters().frames as usize, bus.len());
    }
}

#[test]
fn garbage_without_a_zero_is_counted_as_it_comes() {
    let mut decoder = SerialDecoder::new();
    for round in 1..=1000u64 {
        assert!(decode(&mut decoder, &[&[0xA5; 1000]]).is_empty());
        assert_eq!(decoder.counters().bytes_lost, 1000 * round);
    }
    let message = one_of_each()[0];
    let bytes = encode(&[message]);
    let events = decode(&mut decoder, &[&bytes]);
    let DecodeEvent::Lost(lost) = events[0] else { panic!("{events:?}") };
    assert_eq!((lost.cause, lost.bytes), (FrameDefect::Long, 1_000_000));
    assert!(same(&[received(&events)[0].message], &[message]));
    assert_eq!(decoder.counters().bytes_lost, 1_000_000);
}

#[test]
fn a_cut_line_or_datagram_ends_with_what_there_is() {
    let message = one_of_each()[3];
    let bytes = encode(&[message]);
    // A frame without its last zero is still complete.
    let mut decoder = SerialDecoder::new();
    assert!(decode(&mut decoder, &[&bytes[..bytes.len() - 1]]).is_empty());
    let Some(DecodeEvent::Received(received)) = decoder.end() else { panic!("it is whole") };
    assert!(received.message.same_bits(&message));
    assert_eq!(decoder.end(), None);
    // A frame cut anywhere else is none.
    for cut in 2..bytes.len() - 1 {
        let mut decoder = SerialDecoder::new();
        decode(&mut decoder, &[&bytes[..cut]]);
        let Some(DecodeEvent::Lost(lost)) = decoder.end() else { panic!("cut at {cut}") };
        assert_eq!(lost.bytes, cut as u64 - 1);
    }
}

#[test]
fn what_is_intact_but_not_understood_is_said_in_plain_words() {
    let words =
        |kind: MessageKind, payload: &[u8]| Message::read(kind, payload).unwrap_err().to_string();
    let mut hello = one_of_each()
        .into_iter()
        .find(|m| m.kind() == MessageKind::Hello)
        .unwrap()
        .payload()
        .bytes()
        .to_vec();
    hello[0] = 2;
    assert_eq!(
        words(MessageKind::Hello, &hello),
        "the peer speaks version 2 of the wire protocol, this program version 1: update this program, \
         or give the peer a firmware of version 1"
    );
    // Applies to a newer hello of any length.
    assert_eq!(
        Message::read(MessageKind::Hello, &[3, 0]),
        Err(Unreadable::NewerVersion { found: 3 })
    );
    assert_eq!(
        words(MessageKind::Sample, &[0; 3]),
        "a message sample has 3 bytes, expected are 52"
    );
    let mut output = [0; 132];
    output[20] = 5;
    assert_eq!(
        words(MessageKind::Output, &output),
        "a message output has mode 5, expected is 0 to 4"
    );
    output[20..22].copy_from_slice(&[0, 2]);
    assert_eq!(
        words(MessageKind::Output, &output),
        "a message output has moving 2, expected is 0 or 1"
    );
    let mut bye = [b'x'; 44];
    bye[10] = 0xFF;
    assert_eq!(
        words(MessageKind::Bye, &bye),
        "a message bye has a text that is no text: the text isn't UTF-8 from byte 6 on"
    );
    assert_eq!(
        Unreadable::Code { code: 99 }.to_string(),
        "a message has code 99, known are 1 to 13"
    );
}

#[test]
fn can_faults_are_told_apart() {
    let sent = one_of_each();
    let message = *sent.iter().find(|m| m.kind() == MessageKind::Sample).unwrap();
    let good = frames(&message, CanVersion::Classic);
    let run = |bus: &[BusFrame]| {
        let mut reassembler = Reassembler::new(&[sender(&message)], CanVersion::Classic);
        let events = reassemble(&mut reassembler, bus);
        (events, *reassembler.counters())
    };
    let pick = |order: &[usize]| order.iter().map(|i| good[*i]).collect::<Vec<_>>();
    let causes = |events: &[can::ReassemblyEvent]| {
        let cause = |event: &can::ReassemblyEvent| match event {
            can::ReassemblyEvent::Lost(lost) => Some(lost.cause),
            can::ReassemblyEvent::Received { .. } => None,
        };
        events.iter().filter_map(cause).collect::<Vec<_>>()
    };

    let (events, counters) = run(&pick(&[0, 1, 2, 5, 6, 0, 1, 2, 3, 4, 5, 6]));
    assert_eq!(causes(&events), [can::DropCause::Missing(2)]);
    assert_eq!((counters.messages, counters.missing, counters.orphaned), (1, 2, 1));

    let (events, counters) = run(&pick(&[0, 1, 2, 2, 3, 4, 5, 5, 6, 6]));
    assert!(causes(&events).is_empty());
    assert_eq!((counters.messages, counters.duplicated), (1, 3));

    let (events, counters) = run(&pick(&[0, 1, 2, 3, 1, 4, 5, 6]));
    assert_eq!(causes(&events), [can::DropCause::Disordered]);
    assert_eq!((counters.messages, counters.disordered, counters.orphaned), (0, 1, 3));

    let (events, counters) = run(&pick(&[0, 1, 2, 0, 1, 2, 3, 4, 5, 6]));
    assert_eq!(causes(&events), [can::DropCause::Incomplete]);
    assert_eq!((counters.messages, counters.incomplete), (1, 1));

    let (events, counters) = run(&pick(&[4, 5, 6, 0, 1, 2, 3, 4, 5, 6]));
    assert_eq!(causes(&events), [can::DropCause::Missing(4)]);
    assert_eq!((counters.messages, counters.missing, counters.orphaned), (1, 4, 2));

    // First half of one message and second half of another: only the CRC can tell.
    let Message::Sample(mut other) = message else { unreachable!() };
    other.sample.delta_velocity[1] ^= 1;
    let other = frames(&Message::Sample(other), CanVersion::Classic);
    let mixed: Vec<BusFrame> = good[..5].iter().chain(&other[5..]).copied().collect();
    let (events, counters) = run(&mixed);
    assert!(matches!(causes(&events)[..], [can::DropCause::Mixed { .. }]), "{events:?}");
    assert_eq!((counters.messages, counters.mixed), (0, 1));
}
