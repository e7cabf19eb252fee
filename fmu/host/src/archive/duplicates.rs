//! Entries of one name: identical ones do no harm, whichever of them a reader takes.

use std::io::{self, Cursor, Read, Seek, SeekFrom};
use zip::read::ZipArchive;

/// Length of a header in the directory, without name and extra fields.
pub(super) const HEADER: usize = 46;
/// Length of a header before an entry, without name and extra fields.
const LOCAL: usize = 30;

/// Header of an entry in the directory.
pub(super) type Header = [u8; HEADER];

/// Result of the comparison of two entries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ContentComparison {
    Identical,
    Different,
    /// The entries can't be compared: they are damaged, encrypted or larger than the limit.
    Unknown,
}

/// Compares the contents of two entries by their headers in the directory. `left`: bytes that may
/// still be read and unpacked for comparisons of this archive.
pub(super) fn compare(
    source: &mut (impl Read + Seek),
    one: &Header,
    other: &Header,
    left: &mut u64,
) -> ContentComparison {
    // Offset, sizes, checksum and method: the same bytes of the file.
    if one[42..46] == other[42..46] && one[10..28] == other[10..28] {
        return ContentComparison::Identical;
    }
    if size_of(one) != size_of(other) {
        return ContentComparison::Different;
    }
    match (contents(source, one, left), contents(source, other, left)) {
        (Ok(one), Ok(other)) if one == other => ContentComparison::Identical,
        (Ok(_), Ok(_)) => ContentComparison::Different,
        _ => ContentComparison::Unknown,
    }
}

fn field(header: &[u8], at: usize) -> u32 {
    u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]])
}

fn size_of(header: &Header) -> u32 {
    field(header, 24)
}

/// Unpacks an entry and returns its hash. The entry is read as the only one of an archive in
/// memory, since the zip library keeps one entry for a name.
fn contents(
    source: &mut (impl Read + Seek),
    header: &Header,
    left: &mut u64,
) -> io::Result<blake3::Hash> {
    let (packed, offset) = (field(header, 20), field(header, 42));
    // The largest numbers refer to fields for larger archives.
    if packed == u32::MAX || offset == u32::MAX || size_of(header) == u32::MAX {
        return Err(io::ErrorKind::Unsupported.into());
    }
    let mut spend = |bytes: u64| -> io::Result<()> {
        *left = left.checked_sub(bytes).ok_or(io::ErrorKind::FileTooLarge)?;
        Ok(())
    };
    spend(packed.into())?;
    source.seek(SeekFrom::Start(offset.into()))?;
    let mut local = [0; LOCAL];
    source.read_exact(&mut local)?;
    let name = u16::from_le_bytes([local[26], local[27]]);
    let extra = u16::from_le_bytes([local[28], local[29]]);
    source.seek(SeekFrom::Current(i64::from(name) + i64::from(extra)))?;
    // The header before the entry is made from that in the directory, without bit 3 of the flags:
    // sizes that come after the data.
    let mut archive = b"PK\x03\x04".to_vec();
    archive.extend(&header[6..28]);
    archive[6] &= !(1 << 3);
    archive.extend([1, 0, 0, 0, b'a']);
    let start = archive.len();
    let read = source.take(packed.into()).read_to_end(&mut archive)?;
    if read as u64 != u64::from(packed) {
        return Err(io::ErrorKind::UnexpectedEof.into());
    }
    let directory = start + read;
    let mut only = *header;
    only[8] &= !(1 << 3);
    only[28..34].copy_from_slice(&[1, 0, 0, 0, 0, 0]);
    only[42..46].fill(0);
    archive.extend(only);
    archive.push(b'a');
    archive.extend(b"PK\x05\x06\0\0\0\0\x01\0\x01\0");
    archive.extend((HEADER as u32 + 1).to_le_bytes());
    archive.extend(u32::try_from(directory).map_err(io::Error::other)?.to_le_bytes());
    archive.extend([0, 0]);
    let mut archive = ZipArchive::new(Cursor::new(archive)).map_err(io::Error::other)?;
    let mut entry = archive.by_index(0).map_err(io::Error::other)?;
    let mut hasher = blake3::Hasher::new();
    let mut buffer = vec![0; 64 << 10];
    loop {
        let read = entry.read(&mut buffer)?;
        if read == 0 {
            return Ok(hasher.finalize());
        }
        spend(read as u64)?;
        hasher.update(&buffer[..read]);
    }
}
