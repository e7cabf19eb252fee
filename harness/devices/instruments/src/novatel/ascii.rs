//! ASCII form of the log, a line of text.

use crate::checksum;
use crate::framing::{Extent, ReadingDefect};
use core::fmt::{self, Write};

/// First byte of a line with the short header, and the name of the log.
const SHORT: (u8, &str) = (b'%', "RAWIMUSXA");
/// First byte of a line with the long header, and the name of the log.
const LONG: (u8, &str) = (b'#', "RAWIMUXA");
/// Separator before the CRC.
const MARK: u8 = b'*';
const CRC_DIGITS: usize = 8;
/// CRC digits and end of the line, bytes.
const TAIL_BYTES: usize = CRC_DIGITS + END.len();
const END: &str = "\r\n";

/// Returns whether a line can begin with a byte.
pub(crate) fn begins(byte: u8) -> bool {
    byte == SHORT.0 || byte == LONG.0
}

/// Length from the first byte to the end of the line: printable characters, the separator, eight digits, CR and
/// LF.
pub(super) fn extent(bytes: &[u8], most: usize) -> Extent {
    let printable = |byte: &u8| (0x20..0x7F).contains(byte);
    let text = bytes.iter().position(|byte| *byte == MARK || !printable(byte));
    match text {
        Some(at) if bytes[at] == MARK && at + 1 + TAIL_BYTES <= most => {
            Extent::Bytes(at + 1 + TAIL_BYTES)
        }
        Some(_) => Extent::None,
        None if bytes.len() + TAIL_BYTES >= most => Extent::None,
        // At least the separator and the bytes after it are missing.
        None => Extent::Open(1 + TAIL_BYTES),
    }
}

/// First byte of a line with the right checksum, and the line between it and the checksum.
pub(crate) fn checked(frame: &[u8]) -> Result<(u8, &str), ReadingDefect> {
    let text = core::str::from_utf8(frame).map_err(|_| ReadingDefect::Malformed)?;
    let headed = [SHORT.0, LONG.0]
        .into_iter()
        .find_map(|begin| Some((begin, text.strip_prefix(char::from(begin))?)));
    let (begin, text) = headed.ok_or(ReadingDefect::Malformed)?;
    let text = text.strip_suffix(END).ok_or(ReadingDefect::Malformed)?;
    let (text, digits) = text.split_once('*').ok_or(ReadingDefect::Malformed)?;
    // A sign must be refused here, because the number parser accepts it.
    if !digits.bytes().all(|digit| digit.is_ascii_hexdigit()) {
        return Err(ReadingDefect::Malformed);
    }
    let found = u32::from_str_radix(digits, 16).map_err(|_| ReadingDefect::Malformed)?;
    let computed = checksum::novatel(text.as_bytes());
    if found != computed {
        return Err(ReadingDefect::Checksum { found, computed });
    }
    Ok((begin, text))
}

/// Reads the log from a line.
pub(super) fn read(frame: &[u8]) -> Result<Option<RawImu>, ReadingDefect> {
    let (begin, text) = checked(frame)?;
    let name = if begin == LONG.0 { LONG.1 } else { SHORT.1 };
    let Some((head, data)) = text.split_once(';') else { return Ok(None) };
    match head.split(',').next() {
        Some(found) if found == name => {}
        // The checksum doesn't cover the first byte: a damaged one makes the other form's begin of it.
        Some(found) if found == SHORT.1 || found == LONG.1 => return Err(ReadingDefect::Malformed),
        _ => return Ok(None),
    }
    let fields = &mut data.split(',');
    macro_rules! next {
        ($field:literal, $parse:expr) => {
            fields.next().and_then($parse).ok_or(ReadingDefect::NoNumber { field: $field })?
        };
    }
    let raw = RawImu {
        info: next!("IMU info", |t| u8::from_str_radix(t, 16).ok()),
        kind: next!("IMU type", |t| t.parse().ok()),
        week: next!("week", |t| t.parse().ok()),
        seconds: next!("seconds", |t| t.parse().ok()),
        status: next!("IMU status", |t| u32::from_str_radix(t, 16).ok()),
        velocity: [
            next!("z velocity", |t| t.parse().ok()),
            next!("-y velocity", |t| t.parse().ok()),
            next!("x velocity", |t| t.parse().ok()),
        ],
        rotation: [
            next!("z rotation", |t| t.parse().ok()),
            next!("-y rotation", |t| t.parse().ok()),
            next!("x rotation", |t| t.parse().ok()),
        ],
    };
    if fields.next().is_some() {
        return Err(ReadingDefect::NoNumber { field: "number of fields" });
    }
    Ok(Some(raw))
}

/// Writes a line up to its CRC, without the separator.
///
/// # Errors
/// If `to` has no room.
pub fn write_line(raw: &RawImu, to: &mut impl Write) -> fmt::Result {
    let RawImu { info, kind, week, seconds, status, velocity, rotation } = raw;
    let (begin, name) = (char::from(SHORT.0), SHORT.1);
    write!(
        to,
        "{begin}{name},{week},{seconds:.3};{info:02x},{kind},{week},{seconds:.9},{status:08x}"
    )?;
    for count in velocity.iter().chain(rotation) {
        write!(to, ",{count}")?;
    }
    Ok(())
}

/// Fields of `RAWIMUSX`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawImu {
    /// IMU info: bit 0 error, bit 1 encrypted.
    pub info: u8,
    /// Kind of unit.
    pub kind: u8,
    /// GPS week.
    pub week: u16,
    /// Seconds into the week.
    pub seconds: f64,
    /// Status of the unit; its bits depend on the kind.
    pub status: u32,
    /// Velocity increments: z, −y, x, counts.
    pub velocity: [i32; 3],
    /// Rotation increments: z, −y, x, counts.
    pub rotation: [i32; 3],
}
