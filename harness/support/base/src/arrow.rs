//! Schema of a table in the form of Arrow, as the metadata `ARROW:schema` of a Parquet file.
//!
//! Parquet has no metadata of columns that readers show. Arrow has: its libraries write the whole schema into this
//! key, and read units and descriptions of fields from it. The value is base64 of an encapsulated IPC message
//! ("Arrow Columnar Format", section "Encapsulated message format"; Schema.fbs), a FlatBuffer ("FlatBuffer
//! internals"). The crates of Arrow would bring a tree of packages for these two hundred bytes.

/// Key of the schema in the metadata of a Parquet file.
pub const ARROW_SCHEMA_KEY: &str = "ARROW:schema";

/// Type of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArrowKind {
    /// 64-bit float.
    Double,
    /// Signed 64-bit integer.
    Int64,
    /// Boolean.
    Boolean,
    /// UTF-8 text.
    Utf8,
}

/// Field that may be null.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ArrowField {
    /// Name.
    pub name: String,
    /// Type.
    pub kind: ArrowKind,
    /// Metadata: keys with values, such as `unit` with `deg`.
    pub metadata: Vec<(String, String)>,
}

/// Value of [`ARROW_SCHEMA_KEY`] for the fields of a table.
#[must_use]
pub fn arrow_schema(fields: &[ArrowField]) -> String {
    let mut flat = message(fields);
    while !flat.len().is_multiple_of(8) {
        flat.push(0);
    }
    // Marker of a message in the present format, then the length of the FlatBuffer.
    let mut bytes = vec![0xff; 4];
    bytes.extend_from_slice(&(flat.len() as u32).to_le_bytes());
    bytes.extend_from_slice(&flat);
    base64(&bytes)
}

/// Field of a FlatBuffers table.
enum Slot {
    /// Absent: its default holds.
    Default,
    /// Scalar by its little-endian bytes.
    Scalar(Vec<u8>),
    /// Offset to something that is written later.
    Offset,
}

/// Version 5 of the metadata.
const METADATA_V5: i16 = 4;
/// Schema among the kinds of messages.
const HEADER_SCHEMA: u8 = 1;

/// Writes the message front to back: a table first, then what its offsets point to.
fn message(fields: &[ArrowField]) -> Vec<u8> {
    let mut out = vec![0; 8];
    let slots = [
        Slot::Scalar(METADATA_V5.to_le_bytes().to_vec()),
        Slot::Scalar(vec![HEADER_SCHEMA]),
        Slot::Offset,
        Slot::Default,
    ];
    let (root, offsets) = table(&mut out, &slots);
    patch(&mut out, 0, root);
    let (schema, of_schema) = table(&mut out, &[Slot::Default, Slot::Offset]);
    patch(&mut out, offsets[0], schema);
    let (list, places) = vector(&mut out, fields.len());
    patch(&mut out, of_schema[0], list);
    for (place, one) in places.into_iter().zip(fields) {
        let at = field(&mut out, one);
        patch(&mut out, place, at);
    }
    out
}

fn field(out: &mut Vec<u8>, field: &ArrowField) -> usize {
    let (kind, parts): (u8, Vec<Slot>) = match field.kind {
        // 64 bits, signed.
        ArrowKind::Int64 => {
            (2, vec![Slot::Scalar(64i32.to_le_bytes().to_vec()), Slot::Scalar(vec![1])])
        }
        // Precision: double.
        ArrowKind::Double => (3, vec![Slot::Scalar(2i16.to_le_bytes().to_vec())]),
        ArrowKind::Utf8 => (5, Vec::new()),
        ArrowKind::Boolean => (6, Vec::new()),
    };
    let slots = [
        Slot::Offset,
        Slot::Scalar(vec![1]),
        Slot::Scalar(vec![kind]),
        Slot::Offset,
        Slot::Default,
        Slot::Offset,
        Slot::Offset,
    ];
    let (at, offsets) = table(out, &slots);
    let name = text(out, &field.name);
    patch(out, offsets[0], name);
    let (parts, _) = table(out, &parts);
    patch(out, offsets[1], parts);
    let (children, _) = vector(out, 0);
    patch(out, offsets[2], children);
    let (metadata, places) = vector(out, field.metadata.len());
    patch(out, offsets[3], metadata);
    for (place, (key, value)) in places.into_iter().zip(&field.metadata) {
        let (pair, of_pair) = table(out, &[Slot::Offset, Slot::Offset]);
        patch(out, place, pair);
        for (offset, words) in of_pair.into_iter().zip([key, value]) {
            let words = text(out, words);
            patch(out, offset, words);
        }
    }
    at
}

/// Writes a table behind its vtable; returns its position, and those of its offsets.
fn table(out: &mut Vec<u8>, slots: &[Slot]) -> (usize, Vec<usize>) {
    let size = |slot: &Slot| match slot {
        Slot::Default => 0,
        Slot::Scalar(bytes) => bytes.len(),
        Slot::Offset => 4,
    };
    // Positions of the fields from the start of the table, which begins with the offset to its vtable.
    let mut end = 4usize;
    let mut places = Vec::with_capacity(slots.len());
    for slot in slots {
        let size = size(slot);
        end = end.next_multiple_of(size.max(1));
        places.push(if size == 0 { 0 } else { end });
        end += size;
    }
    let vtable_bytes = 4 + 2 * slots.len();
    let start = (out.len() + vtable_bytes).next_multiple_of(8);
    out.resize(start - vtable_bytes, 0);
    let short = |value: usize| (value as u16).to_le_bytes();
    out.extend_from_slice(&short(vtable_bytes));
    out.extend_from_slice(&short(end));
    places.iter().for_each(|place| out.extend_from_slice(&short(*place)));
    out.extend_from_slice(&(vtable_bytes as i32).to_le_bytes());
    out.resize(start + end, 0);
    let mut offsets = Vec::new();
    for (slot, place) in slots.iter().zip(places) {
        match slot {
            Slot::Default => {}
            Slot::Scalar(bytes) => {
                out[start + place..start + place + bytes.len()].copy_from_slice(bytes);
            }
            Slot::Offset => offsets.push(start + place),
        }
    }
    (start, offsets)
}

/// Writes a vector of offsets; returns its position, and those of the offsets.
fn vector(out: &mut Vec<u8>, count: usize) -> (usize, Vec<usize>) {
    let start = out.len().next_multiple_of(4);
    out.resize(start, 0);
    out.extend_from_slice(&(count as u32).to_le_bytes());
    out.resize(start + 4 + 4 * count, 0);
    (start, (0..count).map(|i| start + 4 + 4 * i).collect())
}

/// Writes a string with its length before it and a zero behind it.
fn text(out: &mut Vec<u8>, words: &str) -> usize {
    let start = out.len().next_multiple_of(4);
    out.resize(start, 0);
    out.extend_from_slice(&(words.len() as u32).to_le_bytes());
    out.extend_from_slice(words.as_bytes());
    out.push(0);
    start
}

/// Points an offset to a later position.
fn patch(out: &mut [u8], place: usize, target: usize) {
    let distance = (target - place) as u32;
    out[place..place + 4].copy_from_slice(&distance.to_le_bytes());
}

/// Base64 of RFC 4648, section 4.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |i: usize| u32::from(group.get(i).copied().unwrap_or(0));
        let bits = (byte(0) << 16) | (byte(1) << 8) | byte(2);
        for i in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * i)) as usize & 63];
            text.push(if i <= group.len() { char::from(letter) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_the_standard() {
        // RFC 4648, section 10.
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }

    fn u32_at(bytes: &[u8], at: usize) -> usize {
        u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize
    }

    /// Position of a field of a table; `None` where its default holds.
    fn at(bytes: &[u8], table: usize, slot: usize) -> Option<usize> {
        let vtable = table - u32_at(bytes, table);
        let short = |at: usize| usize::from(u16::from_le_bytes([bytes[at], bytes[at + 1]]));
        assert!(4 + 2 * slot < short(vtable), "slot {slot} isn't in the vtable");
        Some(short(vtable + 4 + 2 * slot)).filter(|place| *place > 0).map(|place| table + place)
    }

    fn follow(bytes: &[u8], place: usize) -> usize {
        place + u32_at(bytes, place)
    }

    fn words(bytes: &[u8], place: usize) -> &str {
        let at = follow(bytes, place);
        std::str::from_utf8(&bytes[at + 4..at + 4 + u32_at(bytes, at)]).unwrap()
    }

    #[test]
    fn offsets_lead_to_names_types_and_units() {
        let field = |name: &str, kind, unit: &str| ArrowField {
            name: name.to_owned(),
            kind,
            metadata: vec![("unit".to_owned(), unit.to_owned())],
        };
        let fields = [
            field("latitude_deg", ArrowKind::Double, "deg"),
            field("n", ArrowKind::Int64, ""),
            field("moving", ArrowKind::Boolean, "µ"),
            field("id", ArrowKind::Utf8, "x"),
        ];
        let bytes = message(&fields);
        let root = u32_at(&bytes, 0);
        assert_eq!(bytes[at(&bytes, root, 1).unwrap()], HEADER_SCHEMA);
        let schema = follow(&bytes, at(&bytes, root, 2).unwrap());
        let list = follow(&bytes, at(&bytes, schema, 1).unwrap());
        assert_eq!(u32_at(&bytes, list), fields.len());
        for (i, field) in fields.iter().enumerate() {
            let table = follow(&bytes, list + 4 + 4 * i);
            assert_eq!(words(&bytes, at(&bytes, table, 0).unwrap()), field.name);
            assert_eq!(bytes[at(&bytes, table, 1).unwrap()], 1, "nullable");
            let kind = bytes[at(&bytes, table, 2).unwrap()];
            assert_eq!(kind, [3, 2, 6, 5][i]);
            let metadata = follow(&bytes, at(&bytes, table, 6).unwrap());
            let pair = follow(&bytes, metadata + 4);
            assert_eq!(words(&bytes, at(&bytes, pair, 0).unwrap()), "unit");
            assert_eq!(words(&bytes, at(&bytes, pair, 1).unwrap()), field.metadata[0].1);
        }
    }
}
