//! Messages of every kind and value, and their way over a line or bus.

pub(crate) mod arbitrary;
pub(crate) mod peer;
pub(crate) mod vectors;

use octant_wire::can::{self, BusFrame, CanVersion, Reassembler};
use octant_wire::message::{ClockTime, EndRole, Message};
use octant_wire::serial::{DecodeEvent, Received, SerialDecoder, SerialEncoder};

/// Decodes bytes that arrive in pieces into events.
pub(crate) fn decode(decoder: &mut SerialDecoder, pieces: &[&[u8]]) -> Vec<DecodeEvent> {
    let mut events = Vec::new();
    for piece in pieces {
        let mut rest = *piece;
        while let Some(event) = decoder.next(&mut rest) {
            events.push(event);
        }
        assert!(rest.is_empty(), "bytes are left");
    }
    events
}

/// Extracts the messages from events.
pub(crate) fn received(events: &[DecodeEvent]) -> Vec<Received> {
    let received = |event: &DecodeEvent| match event {
        DecodeEvent::Received(received) => Some(*received),
        DecodeEvent::Lost(_) => None,
    };
    events.iter().filter_map(received).collect()
}

/// Encodes messages as one stretch of bytes.
pub(crate) fn encode(messages: &[Message]) -> Vec<u8> {
    let mut encoder = SerialEncoder::new();
    let frames =
        messages.iter().map(|message| encoder.encode(message, ClockTime::from_ns(5)).to_vec());
    frames.collect::<Vec<_>>().concat()
}

/// Role that sends a message.
pub(crate) fn sender(message: &Message) -> EndRole {
    match message {
        Message::Hello(hello) => hello.role,
        message => message.kind().senders()[0],
    }
}

/// Frames of a message from the first role that sends its kind.
pub(crate) fn frames(message: &Message, format: CanVersion) -> Vec<BusFrame> {
    can::segments(message, sender(message), format).expect("it has a slot").collect()
}

/// Reassembles frames into events.
pub(crate) fn reassemble(
    reassembler: &mut Reassembler,
    frames: &[BusFrame],
) -> Vec<can::ReassemblyEvent> {
    frames.iter().filter_map(|frame| reassembler.receive(frame)).collect()
}

/// Extracts the messages from events.
pub(crate) fn messages(events: &[can::ReassemblyEvent]) -> Vec<Message> {
    let message = |event: &can::ReassemblyEvent| match event {
        can::ReassemblyEvent::Received { message, .. } => Some(*message),
        can::ReassemblyEvent::Lost(_) => None,
    };
    events.iter().filter_map(message).collect()
}

/// True if the messages are equal bit for bit.
pub(crate) fn same(a: &[Message], b: &[Message]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.same_bits(b))
}
