//! The bytes of an instrument in words: how many came, and what they were.

use octant_base::number::counted;
use octant_instruments::framing::ReadingCounters;
use octant_instruments::{ReadingDefect, novatel};
use std::fmt::Write as _;

/// Describes the bytes of a protocol, with the cause why the first intact frame that can't be read can't.
/// `table` is the table of the source that has the keys of the protocol.
pub(super) fn traffic(
    counters: &ReadingCounters,
    unread: Option<ReadingDefect>,
    protocol: &str,
    table: &str,
) -> String {
    let mut said = format!(
        "{}, {}, {} of protocol {protocol}, {} with a wrong checksum",
        counted(counters.bytes, "byte", "bytes"),
        counted(counters.readings, "reading", "readings"),
        counted(counters.other, "other frame", "other frames"),
        counted(counters.checksum, "frame", "frames"),
    );
    if let Some(cause) = unread {
        let frames = counted(counters.unknown, "frame", "frames");
        _ = write!(said, ", {frames} that can't be read, the first: {cause}");
        if matches!(cause, ReadingDefect::Unknown { field: novatel::IMU_TYPE, .. }) {
            _ = write!(said, " (with source.{table}.gyro_count and accel_count it is read)");
        }
    }
    if counters.bytes_lost > 0 {
        let bytes = counted(counters.bytes_lost, "byte belongs", "bytes belong");
        _ = write!(said, "; {bytes} to no frame of this protocol");
    }
    said
}
