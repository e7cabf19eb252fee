//! Bytes of a part file: its head, and records one after another.
//!
//! | bytes of the file's head | content |
//! |---|---|
//! | 8 | `OCTRES\r\n` |
//! | 4 | version, little endian as all numbers here |
//! | 4 | first bytes of the BLAKE3 of the above |
//!
//! | bytes of a record | content |
//! |---|---|
//! | 4 | marker |
//! | 1, 1, 2 | kind; length of the case's id; length of who made it |
//! | 4, 4, 4 | length of the facts, of the compressed result, of the result |
//! | 8 | time at which it was stored, ns since 1970 (UTC): the order of two records |
//! | 32 | BLAKE3 of the result; of a forgotten one the 16 bytes at the end of its record, and 16 zeros |
//! | … | id of the case, then facts, then who made it (JSON; from version 2 on) |
//! | 16 | first bytes of the BLAKE3 of the record so far |
//! | … | result, compressed by Zstandard |
//! | 16 | first bytes of the BLAKE3 of the 16 bytes above and the compressed result: names the record |
//!
//! The lengths have a checksum of their own, so that damage to a length is told from a file that ends
//! early: what can be found by its marker after damage proves that the damage is no end.

/// Newest version of the part files, which this program writes.
pub(super) const SCHEMA: u32 = 2;
/// First version whose records tell who made them.
pub(super) const MADE_BY: u32 = 2;
/// Length of a file's head.
pub(super) const FILE_HEAD: usize = 16;
/// Marker of a record.
pub(super) const MARKER: [u8; 4] = [0xc5, b'R', b'E', b'C'];
/// Length of the part of a record's head whose length is always the same.
pub(super) const FIXED: usize = 60;
/// Length of a checksum.
pub(super) const CHECK: usize = 16;
/// Largest facts; larger ones are left out.
pub(super) const FACTS_MAX: usize = 1 << 20;
/// Largest result.
pub(super) const RESULT_MAX: usize = 1 << 28;
const MAGIC: [u8; 8] = *b"OCTRES\r\n";

/// First bytes of a BLAKE3.
pub(super) type Checksum = [u8; CHECK];

/// Kind of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RecordKind {
    /// The result of a case.
    Result,
    /// A record of the case, named by its checksum, doesn't count any more.
    Forgotten,
}

/// Head of a record.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct RecordHead {
    pub(super) kind: RecordKind,
    pub(super) case: String,
    pub(super) facts: Vec<u8>,
    /// Maker of the record, JSON; empty in files of version 1.
    pub(super) maker: Vec<u8>,
    pub(super) body_bytes: u32,
    pub(super) raw_bytes: u32,
    pub(super) time_ns: u64,
    pub(super) blake3: [u8; 32],
    /// Checksum of the head.
    pub(super) check: Checksum,
}

impl RecordHead {
    /// Length of the head.
    pub(super) fn bytes(&self) -> u64 {
        (FIXED + self.case.len() + self.facts.len() + self.maker.len() + CHECK) as u64
    }
}

/// Lengths that the fixed part of a head names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Lengths {
    pub(super) case: usize,
    pub(super) facts: usize,
    pub(super) maker: usize,
}

impl Lengths {
    /// Length of what follows the fixed part, without the checksum.
    pub(super) fn named(self) -> usize {
        self.case + self.facts + self.maker
    }
}

/// Computes the checksum of some parts.
pub(super) fn checksum(parts: &[&[u8]]) -> Checksum {
    let mut hasher = blake3::Hasher::new();
    parts.iter().for_each(|part| _ = hasher.update(part));
    first(hasher.finalize().as_bytes())
}

/// Returns the first bytes of a hash.
pub(super) fn first(hash: &[u8; 32]) -> Checksum {
    let mut check = [0; CHECK];
    check.copy_from_slice(&hash[..CHECK]);
    check
}

/// Makes the head of a file.
pub(super) fn file_head(version: u32) -> [u8; FILE_HEAD] {
    let mut head = [0; FILE_HEAD];
    head[..8].copy_from_slice(&MAGIC);
    head[8..12].copy_from_slice(&version.to_le_bytes());
    let check = checksum(&[&head[..12]]);
    head[12..].copy_from_slice(&check[..4]);
    head
}

/// Outcome of reading the head of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FileHead {
    /// A part of a version that this program reads.
    Whole(u32),
    /// The head was never completed.
    Torn,
    /// Version that this program doesn't read.
    Version(u32),
    /// Something else.
    Foreign,
}

/// Reads the head of a file from its first bytes, at most [`FILE_HEAD`].
pub(super) fn read_file_head(bytes: &[u8]) -> FileHead {
    if bytes.len() < FILE_HEAD {
        let is_torn = (1..=SCHEMA).any(|version| file_head(version).starts_with(bytes));
        return if is_torn { FileHead::Torn } else { FileHead::Foreign };
    }
    let version = number(bytes, 8);
    if bytes[..FILE_HEAD] != file_head(version) {
        return FileHead::Foreign;
    }
    match version {
        1..=SCHEMA => FileHead::Whole(version),
        _ => FileHead::Version(version),
    }
}

/// Content of a new record.
#[derive(Clone, Copy, Debug)]
pub(super) struct NewRecord<'a> {
    pub(super) kind: RecordKind,
    pub(super) case: &'a str,
    pub(super) facts: &'a [u8],
    pub(super) maker: &'a [u8],
    pub(super) body: &'a [u8],
    pub(super) raw_bytes: usize,
    pub(super) time_ns: u64,
    pub(super) blake3: [u8; 32],
}

/// Makes the bytes of a record; `None` if a length is too large for it.
pub(super) fn record(new: &NewRecord<'_>) -> Option<(Vec<u8>, Checksum)> {
    let NewRecord { kind, case, facts, maker, body, raw_bytes, time_ns, blake3 } = *new;
    if facts.len() > FACTS_MAX || raw_bytes > RESULT_MAX {
        return None;
    }
    let named = case.len() + facts.len() + maker.len();
    let mut bytes = Vec::with_capacity(FIXED + named + body.len() + 2 * CHECK);
    bytes.extend(MARKER);
    bytes.push(match kind {
        RecordKind::Result => 1,
        RecordKind::Forgotten => 2,
    });
    bytes.push(u8::try_from(case.len()).ok()?);
    bytes.extend(u16::try_from(maker.len()).ok()?.to_le_bytes());
    for length in [facts.len(), body.len(), raw_bytes] {
        bytes.extend(u32::try_from(length).ok()?.to_le_bytes());
    }
    bytes.extend(time_ns.to_le_bytes());
    bytes.extend(blake3);
    bytes.extend(case.as_bytes());
    bytes.extend(facts);
    bytes.extend(maker);
    let head = checksum(&[&bytes]);
    bytes.extend(head);
    bytes.extend(body);
    let own = checksum(&[&head, body]);
    bytes.extend(own);
    Some((bytes, own))
}

/// Reads the lengths from the fixed part of a head; `None` if it is none.
pub(super) fn lengths(fixed: &[u8; FIXED]) -> Option<Lengths> {
    let lengths = Lengths {
        case: usize::from(fixed[5]),
        facts: number(fixed, 8) as usize,
        maker: usize::from(u16::from_le_bytes([fixed[6], fixed[7]])),
    };
    let is_head = fixed.starts_with(&MARKER)
        && (1..=2).contains(&fixed[4])
        && lengths.facts <= FACTS_MAX
        && number(fixed, 16) as usize <= RESULT_MAX;
    is_head.then_some(lengths)
}

/// Reads a head from its fixed part and the rest; `None` if its checksum is wrong.
pub(super) fn head(fixed: &[u8; FIXED], lengths: Lengths, rest: &[u8]) -> Option<RecordHead> {
    let (named, check) = rest.split_at_checked(lengths.named())?;
    let found = checksum(&[fixed, named]);
    if found != check {
        return None;
    }
    let (case, facts) = named.split_at(lengths.case);
    let (facts, maker) = facts.split_at(lengths.facts);
    let mut time_ns = [0; 8];
    time_ns.copy_from_slice(&fixed[20..28]);
    let mut blake3 = [0; 32];
    blake3.copy_from_slice(&fixed[28..]);
    Some(RecordHead {
        kind: if fixed[4] == 1 { RecordKind::Result } else { RecordKind::Forgotten },
        case: std::str::from_utf8(case).ok()?.to_owned(),
        facts: facts.to_vec(),
        maker: maker.to_vec(),
        body_bytes: number(fixed, 12),
        raw_bytes: number(fixed, 16),
        time_ns: u64::from_le_bytes(time_ns),
        blake3,
        check: found,
    })
}

fn number(bytes: &[u8], at: usize) -> u32 {
    let mut four = [0; 4];
    four.copy_from_slice(&bytes[at..at + 4]);
    u32::from_le_bytes(four)
}
