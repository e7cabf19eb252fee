//! What is done with foreign CAN databases and mappings, for the fuzzer and for the test that runs the
//! corpus.
//!
//! A line of `=====` stands between the database, the mapping and the frames: identifier in four bytes,
//! length in one, data. Nothing may panic, and every frame is counted.

use octant_instruments::dbc::{CanFrame, Database, Gatherer, SignalMapping};

/// A database, a mapping, frames.
pub(crate) fn bus(bytes: &[u8]) {
    const MARK: &[u8] = b"=====\n";
    let cut = |bytes: &[u8]| bytes.windows(MARK.len()).position(|window| window == MARK);
    let Some(first) = cut(bytes) else { return };
    let (database, rest) = (&bytes[..first], &bytes[first + MARK.len()..]);
    let Some(second) = cut(rest) else { return };
    let (mapping, mut rest) = (&rest[..second], &rest[second + MARK.len()..]);
    let mapping = SignalMapping::parse("a.toml", &String::from_utf8_lossy(mapping));
    let database = Database::parse("a.dbc", &String::from_utf8_lossy(database));
    let (Ok(database), Ok(mapping)) = (database, mapping) else { return };
    let Ok(mut gatherer) = Gatherer::new(&database, &mapping) else { return };
    let mut frames = 0;
    while let Some(([a, b, c, d, length], tail)) = rest.split_first_chunk::<5>() {
        let (data, tail) = tail.split_at(usize::from(*length % 65).min(tail.len()));
        rest = tail;
        let id = u32::from_le_bytes([*a, *b, *c, *d]);
        gatherer.receive(&CanFrame { id: id & 0x1FFF_FFFF, extended: id >> 31 == 1, data });
        frames += 1;
    }
    assert_eq!(gatherer.counters().frames, frames);
}
