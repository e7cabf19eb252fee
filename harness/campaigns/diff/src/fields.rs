//! Fields of a recorded message by name, from its bytes and the schema of its topic.

use octant_recorder::message::{
    Topic, encode_aiding, encode_covariance, encode_innovation, encode_output, encode_parameters,
    encode_sample, encode_truth,
};
use octant_recorder::reader::Item;

/// Bytes before the fields.
const ENCAPSULATION_BYTES: usize = 4;

/// Writes a message as it is recorded; false for an event, which is compared elsewhere.
pub fn encode(item: &Item, bytes: &mut Vec<u8>) -> bool {
    match item {
        Item::CleanSample(sample) | Item::Sample(sample) => encode_sample(sample, bytes),
        Item::CleanAiding(aiding) => encode_aiding(aiding.as_ref(), bytes),
        Item::Aiding(aiding) => encode_aiding(Some(aiding), bytes),
        Item::Output(output) => encode_output(output, bytes),
        Item::Innovation(sequence, innovation) => encode_innovation(*sequence, innovation, bytes),
        Item::Covariance(sequence, covariance) => encode_covariance(*sequence, covariance, bytes),
        Item::Parameters(sequence, estimate) => encode_parameters(*sequence, estimate, bytes),
        Item::Truth(truth) => encode_truth(truth, bytes),
        Item::Event(_) => return false,
    }
    true
}

/// First field of two messages on a topic that differs in a bit: its name and both values.
#[must_use]
pub fn first_difference(
    topic: Topic,
    first: &[u8],
    second: &[u8],
) -> Option<(String, String, String)> {
    let mut at = ENCAPSULATION_BYTES;
    for line in topic.schema().lines() {
        let Some((kind, name)) = line.split('#').next().unwrap_or("").trim().split_once(' ') else {
            continue;
        };
        // A constant takes no room.
        if name.contains('=') {
            continue;
        }
        let (kind, count) = match kind.split_once('[') {
            Some((kind, count)) => (kind, count.trim_end_matches(']').parse().ok()?),
            None => (kind, 1usize),
        };
        let size = size(kind)?;
        for i in 0..count {
            let (a, b) = (first.get(at..at + size)?, second.get(at..at + size)?);
            if a != b {
                let name = name.trim();
                let name = if count > 1 { format!("{name}[{i}]") } else { name.to_owned() };
                return Some((name, value(kind, a)?, value(kind, b)?));
            }
            at += size;
        }
    }
    None
}

fn size(kind: &str) -> Option<usize> {
    Some(match kind {
        "bool" | "uint8" | "int8" => 1,
        "uint16" | "int16" => 2,
        "uint32" | "int32" | "float32" => 4,
        "uint64" | "int64" | "float64" => 8,
        _ => return None,
    })
}

fn value(kind: &str, bytes: &[u8]) -> Option<String> {
    Some(match kind {
        "bool" => (bytes[0] != 0).to_string(),
        "uint8" => bytes[0].to_string(),
        "int8" => i8::from_le_bytes(bytes.try_into().ok()?).to_string(),
        "uint16" => u16::from_le_bytes(bytes.try_into().ok()?).to_string(),
        "int16" => i16::from_le_bytes(bytes.try_into().ok()?).to_string(),
        "uint32" => u32::from_le_bytes(bytes.try_into().ok()?).to_string(),
        "int32" => i32::from_le_bytes(bytes.try_into().ok()?).to_string(),
        "float32" => f32::from_le_bytes(bytes.try_into().ok()?).to_string(),
        "uint64" => u64::from_le_bytes(bytes.try_into().ok()?).to_string(),
        "int64" => i64::from_le_bytes(bytes.try_into().ok()?).to_string(),
        "float64" => {
            let number = f64::from_le_bytes(bytes.try_into().ok()?);
            let size = number.abs();
            if size == 0.0 || (1e-4..1e15).contains(&size) {
                number.to_string()
            } else {
                format!("{number:e}")
            }
        }
        _ => return None,
    })
}
