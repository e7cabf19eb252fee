//! The conformance vectors in `fixtures/wire`: written by this test with `OCTANT_WRITE_FIXTURES=1`,
//! checked otherwise. The results that a receiver must have for damaged input are stated here by hand.

use crate::common::vectors::{self, Vector};
use crate::common::{self, decode, reassemble, received, same};
use octant_wire::can::{self, BusFrame, CanVersion, Reassembler, Slot};
use octant_wire::layout::{FieldType, fields};
use octant_wire::message::{EndRole, Message, MessageKind};
use octant_wire::serial::{SerialDecoder, SerialEncoder};
use serde_json::{Value, json};

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Object as JSON text, with its keys in this order.
fn object(pairs: &[(&str, impl std::fmt::Display)]) -> String {
    let pairs: Vec<_> = pairs.iter().map(|(key, value)| format!("\"{key}\": {value}")).collect();
    format!("{{{}}}", pairs.join(", "))
}

/// Fields of a payload as JSON text, from the table alone and in its order.
fn fields_of(kind: MessageKind, payload: &[u8]) -> String {
    let mut all = Vec::new();
    for field in fields(kind) {
        let bytes = &payload[field.at..field.at + field.ty.bytes()];
        let number = bytes.iter().rev().take(8).fold(0u64, |n, byte| n << 8 | u64::from(*byte));
        let value = match field.ty {
            FieldType::U8 | FieldType::U16 | FieldType::U32 => json!(number),
            FieldType::U64 => json!(number.to_string()),
            FieldType::I32 => json!(number as u32 as i32),
            FieldType::F64 => json!(format!("{number:016x}")),
            FieldType::Step(flag) => {
                if let Some(flag) = flag {
                    all.push((flag, json!(number >> 15 == 1)));
                }
                json!(number & 0x7FFF)
            }
            FieldType::Bytes(_) => json!(hex(bytes)),
            FieldType::Text(_) => {
                let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
                json!(std::str::from_utf8(&bytes[..end]).unwrap())
            }
            FieldType::Zero(_) => continue,
        };
        all.push((field.name, value));
    }
    object(&all)
}

fn can_frames(vector: &Vector, format: CanVersion) -> Vec<BusFrame> {
    can::segments(&vector.message, vector.sender, format).unwrap().collect()
}

fn texts(frames: &[BusFrame]) -> Vec<String> {
    frames.iter().map(|frame| format!("{frame:?}")).collect()
}

fn serial_frame(vector: &Vector) -> Vec<u8> {
    SerialEncoder::starting_at(vector.sequence).encode(&vector.message, vector.clock).to_vec()
}

/// Writes or compares a file, with one entry on each line so that changes are readable.
fn check(name: &str, about: &str, entries: &[Vec<(&str, String)>]) {
    let line = |entry: &Vec<(&str, String)>| format!("    {}", object(entry));
    let lines: Vec<_> = entries.iter().map(line).collect();
    let made = format!(
        "{{\n  \"about\": {},\n  \"version\": {},\n  \"vectors\": [\n{}\n  ]\n}}\n",
        json!(about),
        octant_wire::VERSION,
        lines.join(",\n")
    );
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/wire");
    let file = format!("{folder}/{name}");
    if std::env::var_os("OCTANT_WRITE_FIXTURES").is_some() {
        std::fs::create_dir_all(folder).unwrap();
        std::fs::write(&file, &made).unwrap();
    }
    let shipped = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(shipped == made, "run this test with OCTANT_WRITE_FIXTURES=1 to write {name}");
    let _: Value = serde_json::from_str(&shipped).unwrap();
}

#[test]
fn messages_have_these_bytes() {
    let all = vectors::all();
    let mut entries = Vec::new();
    for vector in &all {
        let (kind, payload) = (vector.message.kind(), vector.message.payload());
        let frame = serial_frame(vector);
        let mut decoder = SerialDecoder::new();
        let found = received(&decode(&mut decoder, &[&frame]));
        assert!(same(&[found[0].message], &[vector.message]), "{}", vector.name);
        for format in [CanVersion::Classic, CanVersion::Fd] {
            let mut reassembler = Reassembler::new(&[vector.sender], format);
            let events = reassemble(&mut reassembler, &can_frames(vector, format));
            assert!(same(&common::messages(&events), &[vector.message]), "{}", vector.name);
        }
        entries.push(vec![
            ("name", json!(vector.name).to_string()),
            ("sender", json!(vector.sender.name()).to_string()),
            ("kind", json!(kind.name()).to_string()),
            ("fields", fields_of(kind, payload.bytes())),
            ("payload", json!(hex(payload.bytes())).to_string()),
            ("sequence", json!(vector.sequence).to_string()),
            ("clock_ns", json!(vector.clock.ns.to_string()).to_string()),
            ("frame", json!(hex(&frame)).to_string()),
            ("classic", json!(texts(&can_frames(vector, CanVersion::Classic))).to_string()),
            ("fd", json!(texts(&can_frames(vector, CanVersion::Fd))).to_string()),
        ]);
    }
    // Every identifier occurs.
    for slot in Slot::ALL {
        let id = slot.id(0, CanVersion::Classic);
        let sent = all.iter().any(|vector| can_frames(vector, CanVersion::Classic)[0].id() == id);
        assert!(sent, "{slot:?}");
    }
    check(
        "messages.json",
        "messages and their bytes; see harness/devices/wire/README.md",
        &entries,
    );
}

/// Fields in the table are where the code has them: checked bit by bit, in both directions.
#[test]
fn the_table_knows_every_bit_that_the_code_looks_at() {
    for vector in vectors::all() {
        let (kind, payload) = (vector.message.kind(), vector.message.payload());
        let payload = payload.bytes();
        for field in fields(kind) {
            for bit in 8 * field.at..8 * (field.at + field.ty.bytes()) {
                let mut flipped = payload.to_vec();
                flipped[bit / 8] ^= 1 << (bit % 8);
                let place = format!("{} bit {bit} ({})", vector.name, field.name);
                let unused = match field.ty {
                    FieldType::Zero(_) => true,
                    FieldType::Step(None) => bit % 16 == 15,
                    // The offset is absent.
                    FieldType::F64 => kind == MessageKind::Restart && payload[1] >> 7 == 0,
                    _ => false,
                };
                match Message::read(kind, &flipped) {
                    Ok(message) => {
                        let same = message.same_bits(&vector.message);
                        // Setting the flag adds an offset of zeros, which differs from no offset.
                        assert_eq!(same, unused, "{place}");
                    }
                    // The value is not among the choices, the version is wrong, or the text is invalid.
                    Err(_) => assert!(
                        !unused
                            && (!field.values.is_empty()
                                || field.name == "version"
                                || field.name == "segment"
                                || matches!(field.ty, FieldType::Text(_))),
                        "{place}"
                    ),
                }
            }
        }
    }
}

/// A case of damage on a line.
struct Case {
    name: &'static str,
    about: &'static str,
    /// Stretches of bytes; if there are several, each is a datagram.
    pieces: Vec<Vec<u8>>,
    /// Messages received.
    messages: Vec<&'static str>,
    /// Nonzero counts, except `bytes`.
    counts: Vec<(&'static str, u64)>,
}

fn stuffed(bare: &[u8]) -> Vec<u8> {
    let mut out = vec![0; cobs::max_encoding_length(bare.len()) + 2];
    let length = cobs::encode(bare, &mut out[1..]);
    out.truncate(length + 2);
    out
}

/// Frame of any kind and payload, with a valid CRC.
fn forged(kind: u8, sequence: u16, payload: &[u8]) -> Vec<u8> {
    let mut bare = vec![kind];
    bare.extend(sequence.to_le_bytes());
    bare.extend(1_000u64.to_le_bytes());
    bare.extend(payload);
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&bare);
    bare.extend(crc.to_le_bytes());
    stuffed(&bare)
}

fn serial_cases() -> Vec<Case> {
    // A stream of five frames in order.
    let names = ["sample with aiding", "output", "end", "time request", "bye of a device"];
    let mut encoder = SerialEncoder::new();
    let frames: Vec<Vec<u8>> = names
        .iter()
        .map(|name| {
            let vector = vectors::named(name);
            encoder.encode(&vector.message, vector.clock).to_vec()
        })
        .collect();
    let [a, b, c, d, e] = <[Vec<u8>; 5]>::try_from(frames).unwrap();
    let [an, bn, cn, dn, en] = names;
    let all = [&a[..], &b, &c, &d, &e].concat();
    let garbage: Vec<u8> = (1..=250).map(|i: u8| i.wrapping_mul(73) | 1).collect();
    let lost = |frame: &[u8]| frame.len() as u64 - 2;
    let flipped = |frame: &[u8], at: usize, bit: u8| {
        let mut frame = frame.to_vec();
        frame[at] ^= 1 << bit;
        frame
    };
    let hello = vectors::named("hello of a device");
    let hello_payload = hello.message.payload().bytes().to_vec();
    let mut newer = hello_payload.clone();
    newer[0] = 2;
    newer.extend([1, 2, 3, 4]);
    let mut wrong_mode = vectors::named("output").message.payload().bytes().to_vec();
    wrong_mode[20] = 5;
    let mut no_text = hello_payload;
    no_text[60] = 0xFF;
    let hello_anew = SerialEncoder::new().encode(&hello.message, hello.clock).to_vec();
    let case = |name,
                about,
                bytes: &[&[u8]],
                messages: &[&'static str],
                counts: &[(&'static str, u64)]| Case {
        name,
        about,
        pieces: vec![bytes.concat()],
        messages: messages.to_vec(),
        counts: counts.to_vec(),
    };
    let n = names;
    let mut cases = vec![
        case("undamaged", "five frames in a row", &[&all], &n, &[("frames", 5)]),
        case("nothing", "a line that sends zeros", &[&[0; 100]], &[], &[]),
        case(
            "one zero between frames",
            "the zero after a frame is the one before the next",
            &[&a, &b[1..], &c[1..]],
            &[an, bn, cn],
            &[("frames", 3)],
        ),
        case(
            "garbage between frames",
            "bytes that are no frame, without a zero, before and between frames",
            &[&garbage, &a, &garbage, &garbage[..3], &b],
            &[an, bn],
            &[("frames", 2), ("bytes_lost", 503), ("malformed", 2)],
        ),
        case(
            "garbage with zeros",
            "each stretch between zeros counts",
            &[&[1, 0, 2, 2, 0, 0, 9, 9, 9], &a],
            &[an],
            &[("frames", 1), ("bytes_lost", 6), ("malformed", 3)],
        ),
        case(
            "babble",
            "more bytes without a zero than any frame has",
            &[&[0xA5; 1000], &a],
            &[an],
            &[("frames", 1), ("bytes_lost", 1000), ("long", 1)],
        ),
        case(
            "babble of just the longest",
            "261 bytes may be a frame, and one more may not",
            &[&[1; 261], &[0], &[1; 262], &a],
            &[an],
            &[("frames", 1), ("bytes_lost", 523), ("long", 1), ("checksum", 1)],
        ),
        case(
            "a bit flipped",
            "in the payload of the second frame",
            &[&a, &flipped(&b, 60, 3), &c],
            &[an, cn],
            &[("frames", 2), ("bytes_lost", lost(&b)), ("checksum", 1), ("missing", 1)],
        ),
        case(
            "a bit flipped in the stuffing",
            "a block then reaches beyond the end",
            &[&a, &flipped(&b, b.len() - 8, 7), &c],
            &[an, cn],
            &[("frames", 2), ("bytes_lost", lost(&b)), ("malformed", 1), ("missing", 1)],
        ),
        case(
            "a byte turned zero",
            "the second frame falls into two pieces",
            &[
                &a,
                &{
                    let mut b = b.clone();
                    b[60] = 0;
                    b
                },
                &c,
            ],
            &[an, cn],
            &[("frames", 2), ("bytes_lost", lost(&b) - 1), ("malformed", 2), ("missing", 1)],
        ),
        case(
            "the zero before a frame damaged",
            "one byte of garbage sticks to it",
            &[&a, &flipped(&b, 0, 5), &c],
            &[an, cn],
            &[("frames", 2), ("bytes_lost", lost(&b) + 1), ("checksum", 1), ("missing", 1)],
        ),
        case(
            "the zero after a frame damaged",
            "the next frame has its own zero before it",
            &[&a, &flipped(&b, b.len() - 1, 0), &c],
            &[an, cn],
            &[("frames", 2), ("bytes_lost", lost(&b) + 1), ("checksum", 1), ("missing", 1)],
        ),
        case(
            "cut off",
            "the end of a frame is missing, and the next one follows",
            &[&a, &b[..48], &c],
            &[an, cn],
            &[("frames", 2), ("bytes_lost", 47), ("malformed", 1), ("missing", 1)],
        ),
        case(
            "the beginning missing",
            "a receiver that is switched on in the middle of a frame",
            &[&a[30..], &b],
            &[bn],
            &[("frames", 1), ("bytes_lost", a.len() as u64 - 31), ("checksum", 1)],
        ),
        case(
            "frames missing",
            "two of five",
            &[&a, &d, &e],
            &[an, dn, en],
            &[("frames", 3), ("missing", 2)],
        ),
        case(
            "a frame twice",
            "it is handed on",
            &[&a, &b, &b, &c],
            &[an, bn, bn, cn],
            &[("frames", 4), ("behind", 1)],
        ),
        case(
            "frames in another order",
            "the one that comes late was counted as missing before",
            &[&a, &c, &b, &d],
            &[an, cn, bn, dn],
            &[("frames", 4), ("missing", 1), ("behind", 1)],
        ),
        case(
            "a hello counts anew",
            "its sequence is the first one of a sender that has started again",
            &[&a, &b, &c, &hello_anew, &b],
            &[an, bn, cn, "hello of a device", bn],
            &[("frames", 5)],
        ),
        case(
            "a newer hello",
            "of version 2, and longer",
            &[&forged(1, 0, &newer), &b],
            &[bn],
            &[("frames", 2), ("unreadable", 1)],
        ),
        case(
            "an unknown kind",
            "the frame is intact and counts in the sequence",
            &[&a, &forged(77, 1, &[1, 2, 3]), &c],
            &[an, cn],
            &[("frames", 3), ("unreadable", 1)],
        ),
        case(
            "a wrong length",
            "an end with a byte too many, and one without payload",
            &[&forged(7, 0, &[1, 0, 0, 0, 0]), &forged(7, 1, &[])],
            &[],
            &[("frames", 2), ("unreadable", 2)],
        ),
        case(
            "values without meaning",
            "mode 5, and a name that is no UTF-8",
            &[&forged(4, 0, &wrong_mode), &forged(1, 1, &no_text)],
            &[],
            &[("frames", 2), ("unreadable", 2)],
        ),
        case(
            "the shortest frame",
            "fourteen bytes with a CRC are none",
            &[&stuffed(&[3; 14])],
            &[],
            &[("bytes_lost", 15), ("malformed", 1)],
        ),
    ];
    cases.push(Case {
        name: "datagrams",
        about: "two frames in one; one cut off; one without its last zero; an empty one; one in order",
        pieces: vec![
            [&a[..], &b].concat(),
            c[..10].to_vec(),
            d[..d.len() - 1].to_vec(),
            Vec::new(),
            e.clone(),
        ],
        messages: vec![an, bn, dn, en],
        counts: vec![("frames", 4), ("bytes_lost", 9), ("malformed", 1), ("missing", 1)],
    });
    cases
}

#[test]
fn damage_on_a_line_leaves_this() {
    let mut entries = Vec::new();
    for case in serial_cases() {
        let mut decoder = SerialDecoder::new();
        let mut events = Vec::new();
        for piece in &case.pieces {
            events.extend(decode(&mut decoder, &[piece]));
            if case.pieces.len() > 1 {
                events.extend(decoder.end());
            }
        }
        let found: Vec<Message> = received(&events).iter().map(|r| r.message).collect();
        let expected: Vec<Message> =
            case.messages.iter().map(|name| vectors::named(name).message).collect();
        assert!(same(&found, &expected), "{}: {events:?}", case.name);
        let c = decoder.counters();
        let counts: Vec<(&str, u64)> = [
            ("frames", c.frames),
            ("bytes_lost", c.bytes_lost),
            ("long", c.long),
            ("malformed", c.malformed),
            ("checksum", c.checksum),
            ("unreadable", c.unreadable),
            ("missing", c.missing),
            ("behind", c.behind),
        ]
        .into_iter()
        .filter(|(_, count)| *count > 0)
        .collect();
        assert_eq!(counts, case.counts, "{}: {events:?}", case.name);
        let bytes: usize = case.pieces.iter().map(Vec::len).sum();
        assert_eq!(c.bytes, bytes as u64);
        let counts: Vec<_> = counts.iter().map(|(name, count)| (*name, json!(count))).collect();
        entries.push(vec![
            ("name", json!(case.name).to_string()),
            ("about", json!(case.about).to_string()),
            (
                "bytes",
                json!(case.pieces.iter().map(|piece| hex(piece)).collect::<Vec<_>>()).to_string(),
            ),
            ("messages", json!(case.messages).to_string()),
            ("counts", object(&counts)),
        ]);
    }
    check(
        "serial.json",
        "what comes out of a damaged line; see harness/devices/wire/README.md",
        &entries,
    );
}

/// A case of damage on a bus.
struct BusCase {
    name: &'static str,
    about: &'static str,
    format: CanVersion,
    frames: Vec<BusFrame>,
    messages: Vec<&'static str>,
    counts: Vec<(&'static str, u64)>,
    unfinished: usize,
}

fn bus_cases() -> Vec<BusCase> {
    let of = |name, format| can_frames(&vectors::named(name), format);
    let classic = |name| of(name, CanVersion::Classic);
    let (s, z) = (classic("sample with aiding"), classic("sample of zeros"));
    let output = of("output", CanVersion::Fd);
    let heartbeat = of("heartbeat of a device", CanVersion::Fd);
    let pick =
        |frames: &[BusFrame], order: &[usize]| order.iter().map(|i| frames[*i]).collect::<Vec<_>>();
    let (sn, zn, on) = ("sample with aiding", "sample of zeros", "output");
    let case = |name,
                about,
                frames,
                messages: &[&'static str],
                counts: &[(&'static str, u64)],
                unfinished| BusCase {
        name,
        about,
        format: CanVersion::Classic,
        frames,
        messages: messages.to_vec(),
        counts: counts.to_vec(),
        unfinished,
    };
    let fd = |case: BusCase| BusCase { format: CanVersion::Fd, ..case };
    let altered = |frame: &BusFrame, at: usize| {
        let mut data = frame.data().to_vec();
        data[at] ^= 0x10;
        BusFrame::new(frame.id(), frame.format(), &data).unwrap()
    };
    let cut = |frame: &BusFrame, to: usize| {
        BusFrame::new(frame.id(), frame.format(), &frame.data()[..to]).unwrap()
    };
    let mut newer = classic("hello of a device");
    newer[0] = {
        let mut data = newer[0].data().to_vec();
        data[0] = 2;
        BusFrame::new(newer[0].id(), CanVersion::Classic, &data).unwrap()
    };
    let whole = &[0, 1, 2, 3, 4, 5, 6];
    vec![
        case(
            "undamaged",
            "two samples",
            [s.clone(), z.clone()].concat(),
            &[sn, zn],
            &[("frames", 14), ("messages", 2)],
            0,
        ),
        case(
            "kinds between each other",
            "aiding with its higher priority comes between the segments of a sample",
            {
                let aiding = classic("aiding, velocity");
                [&s[..3], &aiding[..2], &s[3..5], &aiding[2..], &s[5..]].concat()
            },
            &["aiding, velocity", sn],
            &[("frames", 12), ("messages", 2)],
            0,
        ),
        case(
            "a segment lost",
            "the message is dropped, the next one comes",
            [pick(&s, &[0, 1, 2, 4, 5, 6]), z.clone()].concat(),
            &[zn],
            &[("frames", 13), ("messages", 1), ("missing", 1), ("orphaned", 2)],
            0,
        ),
        case(
            "the first segments lost",
            "a receiver that is switched on in the middle of a message",
            [pick(&s, &[5, 6]), z.clone()].concat(),
            &[zn],
            &[("frames", 9), ("messages", 1), ("missing", 5), ("orphaned", 1)],
            0,
        ),
        case(
            "the last segments lost",
            "the next message begins",
            [pick(&s, &[0, 1, 2]), z.clone()].concat(),
            &[zn],
            &[("frames", 10), ("messages", 1), ("incomplete", 1)],
            0,
        ),
        case(
            "the end never comes",
            "the message is begun and not whole",
            pick(&s, &[0, 1, 2]),
            &[],
            &[("frames", 3)],
            1,
        ),
        case(
            "segments twice",
            "the bus delivered them twice: no harm",
            pick(&s, &[0, 0, 1, 2, 3, 3, 4, 5, 6, 6]),
            &[sn],
            &[("frames", 10), ("messages", 1), ("duplicated", 3)],
            0,
        ),
        case(
            "a message twice",
            "it is a message again",
            [s.clone(), s.clone()].concat(),
            &[sn, sn],
            &[("frames", 14), ("messages", 2)],
            0,
        ),
        case(
            "segments in another order",
            "the earlier one ends the message",
            [pick(&s, &[0, 1, 2, 3, 1, 4, 5, 6]), z.clone()].concat(),
            &[zn],
            &[("frames", 15), ("messages", 1), ("disordered", 1), ("orphaned", 3)],
            0,
        ),
        case(
            "two segments exchanged",
            "the later one is too early",
            [pick(&s, &[0, 1, 3, 2, 4, 5, 6]), z.clone()].concat(),
            &[zn],
            &[("frames", 14), ("messages", 1), ("missing", 1), ("orphaned", 4)],
            0,
        ),
        case(
            "segments of two messages",
            "the beginning of one and the end of the next: the CRC tells",
            [&s[..5], &z[5..], &s[..]].concat(),
            &[sn],
            &[("frames", 14), ("messages", 1), ("mixed", 1)],
            0,
        ),
        case(
            "a bit flipped",
            "which the CRC of the bus did not see",
            [
                pick(&s, whole)
                    .iter()
                    .enumerate()
                    .map(|(i, frame)| if i == 3 { altered(frame, 2) } else { *frame })
                    .collect(),
                z.clone(),
            ]
            .concat(),
            &[zn],
            &[("frames", 14), ("messages", 1), ("mixed", 1)],
            0,
        ),
        case(
            "a frame too short",
            "the message is dropped",
            [vec![s[0], cut(&s[1], 7)], s[2..].to_vec(), z.clone()].concat(),
            &[zn],
            &[("frames", 14), ("messages", 1), ("orphaned", 5), ("malformed", 1)],
            0,
        ),
        case(
            "others on the bus",
            "identifiers of others, a slot that is free, a segment beyond the message, the other format, a sender that isn't listened to",
            {
                let other = |id, data: &[u8]| BusFrame::new(id, CanVersion::Classic, data).unwrap();
                [
                    vec![
                        other(0x7DF, &[2, 1, 12]),
                        other(0x000, &[]),
                        s[0],
                        other(10 << 5 | 7, &[0; 8]),
                    ],
                    vec![output[0], classic("sample of an instrument")[0]],
                    s[1..].to_vec(),
                ]
                .concat()
            },
            &[sn],
            &[("frames", 12), ("foreign", 5), ("messages", 1)],
            0,
        ),
        case(
            "a newer hello",
            "of version 2: the first frame is enough",
            newer,
            &[],
            &[("frames", 14), ("orphaned", 13), ("unreadable", 1)],
            0,
        ),
        fd(case(
            "CAN FD",
            "three frames of an output",
            output.clone(),
            &[on],
            &[("frames", 3), ("messages", 1)],
            0,
        )),
        fd(case(
            "CAN FD, a segment lost",
            "the last of three is not enough",
            [&output[..1], &output[2..], &output[..]].concat(),
            &[on],
            &[("frames", 5), ("messages", 1), ("missing", 1)],
            0,
        )),
        fd(case(
            "CAN FD, one frame again",
            "a message of one segment is a message each time",
            [heartbeat.clone(), heartbeat].concat(),
            &["heartbeat of a device"; 2],
            &[("frames", 2), ("messages", 2)],
            0,
        )),
        fd(case(
            "CAN FD, not zero behind the end",
            "a sample has 56 bytes in a frame of 64",
            vec![altered(&of(sn, CanVersion::Fd)[0], 60)],
            &[],
            &[("frames", 1), ("malformed", 1)],
            0,
        )),
    ]
}

#[test]
fn damage_on_a_bus_leaves_this() {
    let listened = [EndRole::Harness, EndRole::Device];
    let mut entries = Vec::new();
    for case in bus_cases() {
        let mut reassembler = Reassembler::new(&listened, case.format);
        let events = reassemble(&mut reassembler, &case.frames);
        let expected: Vec<Message> =
            case.messages.iter().map(|name| vectors::named(name).message).collect();
        assert!(same(&common::messages(&events), &expected), "{}: {events:?}", case.name);
        let c = reassembler.counters();
        let counts: Vec<(&str, u64)> = [
            ("frames", c.frames),
            ("foreign", c.foreign),
            ("messages", c.messages),
            ("duplicated", c.duplicated),
            ("missing", c.missing),
            ("disordered", c.disordered),
            ("orphaned", c.orphaned),
            ("incomplete", c.incomplete),
            ("mixed", c.mixed),
            ("malformed", c.malformed),
            ("unreadable", c.unreadable),
        ]
        .into_iter()
        .filter(|(_, count)| *count > 0)
        .collect();
        assert_eq!(counts, case.counts, "{}: {events:?}", case.name);
        assert_eq!(reassembler.unfinished(), case.unfinished, "{}", case.name);
        let counts: Vec<_> = counts.iter().map(|(name, count)| (*name, json!(count))).collect();
        entries.push(vec![
            ("name", json!(case.name).to_string()),
            ("about", json!(case.about).to_string()),
            (
                "format",
                json!(if case.format == CanVersion::Fd { "fd" } else { "classic" }).to_string(),
            ),
            ("senders", json!(listened.map(EndRole::name)).to_string()),
            ("frames", json!(texts(&case.frames)).to_string()),
            ("messages", json!(case.messages).to_string()),
            ("counts", object(&counts)),
            ("unfinished", json!(case.unfinished).to_string()),
        ]);
    }
    check(
        "can.json",
        "what comes out of a disturbed bus; see harness/devices/wire/README.md",
        &entries,
    );
}
