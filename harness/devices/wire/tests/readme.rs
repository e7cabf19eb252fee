//! The tables and the example in the description equal those of the code.

use octant_sample::parameters::NAMES;
use octant_sample::{DeviceTime, GimbalAngles, Health, Sample};
use octant_wire::can::{Bus, CanVersion, Slot};
use octant_wire::layout::{FieldType, fields, parameter_unit};
use octant_wire::message::{Capabilities, ClockTime, SampleMessage, StepNumber};
use octant_wire::serial::{HEADER_BYTES, SerialEncoder};
use octant_wire::traffic::Traffic;
use octant_wire::{Message, MessageKind};
use std::fmt::Write;

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/README.md");

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>().join(" ")
}

fn kinds() -> String {
    let mut table = "| code | kind | from | payload, bytes | serial frame, bytes at most | classic frames | FD frames | \
                     what |\n|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    for kind in MessageKind::ALL {
        let from: Vec<_> = kind.senders().iter().map(|role| role.name()).collect();
        let slot = Slot::of(kind.senders()[0], kind, 0).unwrap();
        let bytes = kind.payload_bytes();
        let frame = 2 + cobs::max_encoding_length(HEADER_BYTES + bytes + 4);
        let what = match kind {
            MessageKind::Hello => "who the sender is, and what it can do",
            MessageKind::Sample => "a sample, on which the device steps",
            MessageKind::Aiding => "the reference that goes with the sample after it",
            MessageKind::Output => "what the core answers",
            MessageKind::Parameters => "a sixth of the parameters with their σ",
            MessageKind::Restart => "the core is to start anew",
            MessageKind::End => "no sample comes any more",
            MessageKind::Ready => "the core has started anew",
            MessageKind::Heartbeat => "the sender is there",
            MessageKind::Status => "what it has done, received and lost",
            MessageKind::TimeRequest => "what time is it there?",
            MessageKind::TimeReply => "so late",
            MessageKind::Bye => "the sender goes, and why",
        };
        writeln!(
            table,
            "| {} | {} | {} | {bytes} | {frame} | {} | {} | {what} |",
            kind.code(),
            kind.name(),
            from.join(", "),
            slot.segments(CanVersion::Classic),
            slot.segments(CanVersion::Fd),
        )
        .unwrap();
    }
    table
}

fn field_table(kind: MessageKind) -> String {
    let mut table = "| at | type | name | unit | what |\n|---|---|---|---|---|\n".to_owned();
    for field in fields(kind) {
        let mut row = |at: usize, ty: &str, name: &str, unit: &str, what: &str| {
            let name = if name.is_empty() { String::new() } else { format!("`{name}`") };
            writeln!(table, "| {at} | {ty} | {name} | {unit} | {what} |").unwrap();
        };
        let unit = match field.lsb {
            1.0 => field.unit.to_owned(),
            lsb => format!("2^{} {}", lsb.log2(), field.unit),
        };
        let values: Vec<_> =
            field.values.iter().enumerate().map(|(code, name)| format!("{code} {name}")).collect();
        let mut what = field.about.to_owned();
        if !values.is_empty() {
            what = format!("{what}: {}", values.join(", "));
        }
        match field.ty {
            FieldType::Step(Some(flag)) => {
                row(field.at, "step", field.name, "", "bits 0 to 14");
                row(field.at, "flag", flag, "", &format!("bit 15; {what}"));
            }
            FieldType::Bytes(n) => row(field.at, &format!("{n} bytes"), field.name, &unit, &what),
            FieldType::Text(n) => {
                row(field.at, &format!("text, {n} bytes"), field.name, &unit, &what)
            }
            FieldType::Zero(n) => row(field.at, &format!("zero, {n} bytes"), "", "", ""),
            ty => row(field.at, ty.name(), field.name, &unit, &what),
        }
    }
    table
}

fn parameters() -> String {
    let mut table = "| index | name | unit |\n|---|---|---|\n".to_owned();
    for (index, name) in NAMES.iter().enumerate() {
        writeln!(table, "| {index} | `{name}` | {} |", parameter_unit(index)).unwrap();
    }
    table
}

fn slots() -> String {
    let mut table = "| slot | message | from | image, bytes | classic identifiers | FD identifiers, and bytes of \
                     each frame |\n|---|---|---|---|---|---|\n"
        .to_owned();
    for slot in Slot::ALL {
        let ids = |format| {
            let last = slot.segments(format) - 1;
            let first = format!("{:03X}", slot.id(0, format));
            if last == 0 { first } else { format!("{first}–{:03X}", slot.id(last, format)) }
        };
        let lengths: Vec<_> = (0..slot.segments(CanVersion::Fd))
            .map(|segment| slot.frame_bytes(segment, CanVersion::Fd).to_string())
            .collect();
        let sixth = match slot.kind {
            MessageKind::Parameters => format!(", segment {}", slot.parameters),
            _ => String::new(),
        };
        writeln!(
            table,
            "| {} | {}{sixth} | {} | {} | {} | {}: {} |",
            slot.number,
            slot.kind.name(),
            slot.sender.name(),
            slot.image_bytes(),
            ids(CanVersion::Classic),
            ids(CanVersion::Fd),
            lengths.join(", "),
        )
        .unwrap();
    }
    table
}

fn load() -> String {
    let mut table =
        "| bus | 200 Hz: there | back | both | 1000 Hz: both |\n|---|---|---|---|---|\n".to_owned();
    for bus in [
        Bus::classic(250_000),
        Bus::classic(500_000),
        Bus::classic(1_000_000),
        Bus::fd(500_000, 2_000_000),
        Bus::fd(1_000_000, 5_000_000),
        Bus::fd(1_000_000, 8_000_000),
    ] {
        let load = bus.load(&Traffic::session(200.0));
        let percent = |share: f64| format!("{:.0} %", 100.0 * share);
        writeln!(
            table,
            "| {bus} | {} | {} | {} | {} |",
            percent(load.from_harness),
            percent(load.to_harness),
            percent(load.share()),
            percent(bus.load(&Traffic::session(1000.0)).share()),
        )
        .unwrap();
    }
    table
}

/// Text of a sample, field by field, unstuffed and stuffed.
fn example() -> String {
    let sample = Sample {
        sequence: 1,
        device_time: DeviceTime { ns: 5_000_000 },
        delta_theta: [17_000, -5, 0],
        delta_velocity: [0, 40, -52_600_000],
        gimbal: GimbalAngles { azimuth: 0, roll: 105_414_357 },
        ..Sample::default()
    };
    let message = Message::Sample(SampleMessage { step: StepNumber::new(1), aided: true, sample });
    let payload = message.payload();
    let payload = payload.bytes();
    let mut encoder = SerialEncoder::starting_at(7);
    let clock = ClockTime::from_ns(1_000_000_000);
    let frame = encoder.encode(&message, clock).to_vec();
    let mut bare = frame[1..frame.len() - 1].to_vec();
    let length = cobs::decode_in_place(&mut bare).unwrap();
    let crc = &bare[length - 4..length];
    let mut text = "The first sample of a session, with aiding, as frame 7:\n\n```\n".to_owned();
    let mut line = |bytes: &[u8], what: &str| writeln!(text, "{:<24} {what}", hex(bytes)).unwrap();
    line(&[2], "kind 2, sample");
    line(&7u16.to_le_bytes(), "sequence 7");
    line(&1_000_000_000u64.to_le_bytes(), "clock 1000000000 ns");
    line(&payload[0..2], "step 1, aided");
    line(&payload[2..4], "status 0");
    line(&payload[4..12], "sequence of the sample 1");
    line(&payload[12..20], "device time 5000000 ns");
    line(&payload[20..24], "delta_theta x 17000");
    line(&payload[24..28], "delta_theta y -5");
    line(&payload[28..32], "delta_theta z 0");
    line(&payload[32..36], "delta_velocity x 0");
    line(&payload[36..40], "delta_velocity y 40");
    line(&payload[40..44], "delta_velocity z -52600000");
    line(&payload[44..48], "azimuth 0");
    line(&payload[48..52], "roll 105414357 (45 deg)");
    line(crc, "CRC-32 of all of it");
    text.push_str("```\n\nand on the line:\n\n```\n");
    for bytes in frame.chunks(24) {
        writeln!(text, "{}", hex(bytes)).unwrap();
    }
    text.push_str("```\n");
    text
}

/// Replaces the part of the page between two marks.
fn filled(page: &str, mark: &str, content: &str) -> String {
    let (begin, end) = (format!("<!-- begin {mark} -->\n"), format!("<!-- end {mark} -->"));
    let (before, rest) = page.split_once(&begin).unwrap_or_else(|| panic!("no {begin}"));
    let (_, after) = rest.split_once(&end).unwrap_or_else(|| panic!("no {end}"));
    format!("{before}{begin}{content}{end}{after}")
}

#[test]
fn the_tables_of_the_page_are_those_of_the_code() {
    let page = std::fs::read_to_string(FILE).unwrap();
    let mut made = filled(&page, "kinds", &kinds());
    for kind in MessageKind::ALL {
        // Ready shares the table of another kind.
        if kind != MessageKind::Ready {
            made = filled(&made, &format!("fields {}", kind.name()), &field_table(kind));
        }
    }
    made = filled(&made, "parameters", &parameters());
    made = filled(&made, "slots", &slots());
    made = filled(&made, "load", &load());
    made = filled(&made, "example", &example());
    if std::env::var_os("OCTANT_WRITE_FIXTURES").is_some() {
        std::fs::write(FILE, &made).unwrap();
        return;
    }
    assert!(made == page, "run this test with OCTANT_WRITE_FIXTURES=1 to write the tables");
}

#[test]
fn every_bit_that_has_a_name_is_on_the_page() {
    let page = std::fs::read_to_string(FILE).unwrap();
    let mut rows = 0;
    let mut row = |section: &str, name: &str, bits: u32| {
        let (_, rest) = page.split_once(section).unwrap();
        let table = rest.split_once("\n\n").unwrap().1.split("\n\n").next().unwrap();
        let row = format!("| {} | `{}` |", bits.trailing_zeros(), name.to_lowercase());
        assert!(table.contains(&row), "{row} in {section:?}: {table}");
        rows += 1;
    };
    for (name, bits) in Capabilities::all().iter_names() {
        row("Capabilities, what", name, bits.bits());
    }
    for (name, bits) in octant_sample::Status::all().iter_names() {
        row("Status, what", name, bits.bits().into());
    }
    for (name, bits) in Health::all().iter_names() {
        row("Health:", name, bits.bits());
    }
    // The page has no other rows: each table has one for each name.
    let on_page = page.lines().filter(|line| line.starts_with("| ") && line.contains(" | `"));
    let numbered = on_page.filter(|line| {
        let cells: Vec<_> = line.split(" | ").collect();
        cells.len() == 3 && cells[0].trim_start_matches("| ").parse::<u32>().is_ok()
    });
    assert_eq!(numbered.count(), rows + NAMES.len());
}
