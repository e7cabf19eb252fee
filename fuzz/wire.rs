//! What is done with foreign bytes of a wire, for the fuzzer and for the test that runs the corpus.
//!
//! Nothing may panic, every byte and frame has to be accounted for, and a message that was accepted
//! has to be one that can be sent.

use octant_wire::can::{self, BusFrame, CanVersion, Reassembler};
use octant_wire::message::{ClockTime, EndRole, Message, MessageKind};
use octant_wire::serial::{DecodeEvent, SerialDecoder, SerialEncoder};

/// A message that was received goes out and comes back as it was, on both encodings.
fn holds(message: &Message) {
    let payload = message.payload();
    let again =
        Message::read(payload.kind(), payload.bytes()).expect("what was read is read again");
    assert!(again.same_bits(message), "{message:?}");
    let mut encoder = SerialEncoder::new();
    let mut frame = encoder.encode(message, ClockTime::default());
    let Some(DecodeEvent::Received(received)) = SerialDecoder::new().next(&mut frame) else {
        panic!("its frame is no frame: {message:?}")
    };
    assert!(received.message.same_bits(message), "{message:?}");
    for sender in EndRole::ALL {
        for format in [CanVersion::Classic, CanVersion::Fd] {
            let Ok(frames) = can::segments(message, sender, format) else { continue };
            let mut reassembler = Reassembler::new(&[sender], format);
            let last = frames.filter_map(|frame| reassembler.receive(&frame)).last();
            match last {
                Some(can::ReassemblyEvent::Received { message: found, .. }) => {
                    assert!(found.same_bits(message), "{message:?}");
                }
                // A hello says itself who sends it.
                other => assert!(matches!(message, Message::Hello(_)), "{other:?}: {message:?}"),
            }
        }
    }
}

/// A line: the same in one piece as in pieces of the length that the first byte says, and every byte
/// in a frame, lost, a zero or not yet decided. And a payload: kind, then bytes.
pub(crate) fn serial(bytes: &[u8]) {
    let Some((first, bytes)) = bytes.split_first() else { return };
    let (mut whole, mut cut) = (SerialDecoder::new(), SerialDecoder::new());
    let mut events = Vec::new();
    let mut rest = bytes;
    while let Some(event) = whole.next(&mut rest) {
        if let DecodeEvent::Received(received) = &event {
            holds(&received.message);
        }
        events.push(event);
    }
    let mut in_pieces = Vec::new();
    for mut piece in bytes.chunks(usize::from(*first).max(1)) {
        while let Some(event) = cut.next(&mut piece) {
            in_pieces.push(event);
        }
    }
    // As text: a NaN is equal to itself there.
    assert_eq!(format!("{events:?}"), format!("{in_pieces:?}"));
    events.extend(whole.end());
    cut.end();
    assert_eq!(whole.counters(), cut.counters());
    let counters = whole.counters();
    assert_eq!(counters.bytes, bytes.len() as u64);
    assert_eq!(events.len() as u64, counters.frames + counters.damaged());
    if counters.frames == 0 {
        let zeros = bytes.iter().filter(|byte| **byte == 0).count();
        assert_eq!(counters.bytes_lost, (bytes.len() - zeros) as u64);
    }
    if let Some(kind) = MessageKind::of(*first)
        && let Ok(message) = Message::read(kind, bytes)
    {
        holds(&message);
    }
}

/// A bus: identifier in two bytes, length in one, data; and so on.
pub(crate) fn can(bytes: &[u8]) {
    for format in [CanVersion::Classic, CanVersion::Fd] {
        let mut reassembler = Reassembler::new(&EndRole::ALL, format);
        let (mut rest, mut frames, mut messages) = (bytes, 0, 0);
        while let Some(([low, high, length], tail)) = rest.split_first_chunk::<3>() {
            let (data, tail) = tail.split_at(usize::from(*length).min(tail.len()));
            rest = tail;
            let Some(frame) = BusFrame::new(u16::from_le_bytes([*low, *high]), format, data) else {
                continue;
            };
            frames += 1;
            if let Some(can::ReassemblyEvent::Received { message, .. }) =
                reassembler.receive(&frame)
            {
                holds(&message);
                messages += 1;
            }
        }
        let counters = reassembler.counters();
        assert_eq!((counters.frames, counters.messages), (frames, messages));
        assert!(reassembler.unfinished() <= can::Slot::ALL.len());
    }
}
