//! Segments: records of part files, put together for a place where nothing can be appended.
//!
//! A segment is a part file that is complete when it is made, and is never changed. Its records are copied
//! bit by bit from the part files of a worker. A record is known by the checksum at its end.

use super::error::PartError;
use super::frame::{Checksum, FILE_HEAD, SCHEMA, file_head};
use super::scan::{scan, scan_from};
use super::writer::{EXTENSION, FOLDER};
use crate::plan::shard::Shard;
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::fs::File;
use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// Records that are stored nowhere else yet, as a part file of their own.
#[derive(Clone, Debug)]
pub struct Segment {
    /// Bytes of the part file.
    pub bytes: Vec<u8>,
    /// Number of records.
    pub records: usize,
    names: Vec<Checksum>,
    /// Parts that were read, and up to which byte.
    read: BTreeMap<PathBuf, u64>,
}

/// Records of a folder's part files, and which of them are stored elsewhere.
///
/// A worker takes over the results that it finds in its folder, whichever shard they were made for.
#[derive(Debug)]
pub struct SegmentSource {
    folder: PathBuf,
    stored: HashSet<Checksum>,
    /// Byte of each part up to which every record is stored.
    read: BTreeMap<PathBuf, u64>,
}

impl SegmentSource {
    /// Begins with the part files in the folder of a campaign, none of whose records is stored elsewhere.
    #[must_use]
    pub fn of(folder: &Path) -> Self {
        let (stored, read) = (HashSet::new(), BTreeMap::new());
        Self { folder: folder.join(FOLDER), stored, read }
    }

    /// Notes the records of a segment that is stored already, and returns how many there are.
    ///
    /// # Errors
    /// If it isn't a whole part file.
    pub fn take_over(&mut self, segment: &Path) -> Result<usize, PartError> {
        let file = File::open(segment).map_err(PartError::system("read", segment))?;
        let mut names = Vec::new();
        let scanned = scan(segment, &file, |found| names.push(found.own))?;
        if scanned.end != scanned.bytes || scanned.end < FILE_HEAD as u64 {
            return Err(PartError::Damaged {
                path: segment.to_owned(),
                offset: scanned.end,
                found: "an incomplete record".to_owned(),
                expected: "a whole segment, which is stored at once".to_owned(),
            });
        }
        let count = names.len();
        self.stored.extend(names);
        Ok(count)
    }

    /// Counts the bytes that were appended to the part files since the last segment.
    ///
    /// # Errors
    /// If the operating system refuses.
    pub fn waiting_bytes(&self) -> Result<u64, PartError> {
        let mut waiting = 0;
        for path in self.parts()? {
            let bytes = match std::fs::metadata(&path) {
                Ok(metadata) => metadata.len(),
                Err(error) => return Err(PartError::system("read", &path)(error)),
            };
            waiting += bytes.saturating_sub(self.begin(&path));
        }
        Ok(waiting)
    }

    /// Makes a segment of the records that are stored nowhere else, up to so many bytes or one record; `None` if
    /// there are none.
    ///
    /// # Errors
    /// If a part file can't be read, or is damaged.
    pub fn next(&self, bytes_max: u64) -> Result<Option<Segment>, PartError> {
        let mut segment = Segment {
            bytes: file_head(SCHEMA).to_vec(),
            records: 0,
            names: Vec::new(),
            read: BTreeMap::new(),
        };
        for path in self.parts()? {
            if self.add(&path, &mut segment, bytes_max)? {
                break;
            }
        }
        segment.records = segment.names.len();
        Ok((segment.records > 0).then_some(segment))
    }

    /// Adds the new records of a part to a segment; true if that is full.
    fn add(&self, path: &Path, segment: &mut Segment, bytes_max: u64) -> Result<bool, PartError> {
        let mut file = File::open(path).map_err(PartError::system("read", path))?;
        let begin = self.begin(path);
        let (mut chosen, mut end, mut is_full) = (Vec::new(), begin, false);
        let mut sum = segment.bytes.len() as u64;
        scan_from(path, &file, begin, |found| {
            let bytes = found.next - found.offset;
            let is_stored = self.stored.contains(&found.own);
            let fits = sum + bytes <= bytes_max || segment.names.is_empty() && chosen.is_empty();
            is_full |= !is_stored && !fits;
            if is_full {
                return;
            }
            if !is_stored {
                sum += bytes;
                chosen.push((found.offset, bytes, found.own));
            }
            end = found.next;
        })?;
        for (offset, bytes, own) in chosen {
            file.seek(SeekFrom::Start(offset)).map_err(PartError::system("read", path))?;
            let read = (&mut file).take(bytes).read_to_end(&mut segment.bytes);
            let read = read.map_err(PartError::system("read", path))?;
            if read as u64 != bytes {
                let source = ErrorKind::UnexpectedEof.into();
                return Err(PartError::System { action: "read", path: path.to_owned(), source });
            }
            segment.names.push(own);
        }
        segment.read.insert(path.to_owned(), end);
        Ok(is_full)
    }

    /// Notes that a segment is stored.
    pub fn stored(&mut self, segment: Segment) {
        self.stored.extend(segment.names);
        self.read.extend(segment.read);
    }

    /// Byte from which a part is read.
    fn begin(&self, path: &Path) -> u64 {
        self.read.get(path).copied().unwrap_or(FILE_HEAD as u64)
    }

    /// Lists the part files that workers write, in the order of their names.
    fn parts(&self) -> Result<Vec<PathBuf>, PartError> {
        let mut found: Vec<PathBuf> =
            parts(&self.folder)?.into_iter().map(|(path, _)| path).collect();
        found.sort();
        Ok(found)
    }
}

/// Lists the shards whose workers have written part files into the folder of a campaign.
///
/// # Errors
/// If the operating system refuses.
pub fn shards(folder: &Path) -> Result<BTreeSet<Shard>, PartError> {
    Ok(parts(&folder.join(FOLDER))?.into_iter().map(|(_, shard)| shard).collect())
}

/// Lists the part files of workers in the folder of the results, without segments.
fn parts(folder: &Path) -> Result<Vec<(PathBuf, Shard)>, PartError> {
    let entries = match std::fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(PartError::system("read", folder)(error)),
    };
    let mut found = Vec::new();
    for entry in entries {
        let entry = entry.map_err(PartError::system("read", folder))?;
        if let Some(shard) = shard_of_part(&entry.file_name().to_string_lossy()) {
            found.push((entry.path(), shard));
        }
    }
    Ok(found)
}

/// Returns the shard of a part file by its name, `K-of-N.NUMBER.octres`; `None` for any other file.
fn shard_of_part(name: &str) -> Option<Shard> {
    let (stem, number) = name.strip_suffix(EXTENSION)?.strip_suffix('.')?.rsplit_once('.')?;
    number.parse::<u64>().ok()?;
    let (number, of) = stem.split_once("-of-")?;
    Shard::parse(&format!("{number}/{of}")).ok()
}
