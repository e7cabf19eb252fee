//! Builds a ZIP file whose bytes depend on its contents alone.

use std::io::{Cursor, Write};
use zip::result::ZipResult;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// One file of an archive.
#[derive(Clone, Debug)]
pub(super) struct File {
    /// Path in the archive, with forward slashes.
    pub(super) path: String,
    /// Contents.
    pub(super) contents: Vec<u8>,
}

impl File {
    /// Creates a file.
    pub(super) fn new(path: impl Into<String>, contents: impl Into<Vec<u8>>) -> Self {
        Self { path: path.into(), contents: contents.into() }
    }
}

/// Builds the archive of these files, in this order.
///
/// Time and permissions are the same for every file, and nothing depends on the machine. Deflate
/// without data descriptors, ZIP version 2.0, as the standard requires.
pub(super) fn archive(files: &[File]) -> ZipResult<Vec<u8>> {
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .compression_level(Some(9))
        .last_modified_time(DateTime::default())
        // Libraries don't need the executable bit to be loaded.
        .unix_permissions(0o644);
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for file in files {
        writer.start_file(file.path.as_str(), options)?;
        writer.write_all(&file.contents)?;
    }
    Ok(writer.finish()?.into_inner())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::*;
    use std::io::Read;

    #[test]
    fn files_come_back_in_order_and_the_header_is_what_the_standard_asks_for() {
        let files = [File::new("modelDescription.xml", "x".repeat(5000)), File::new("a/b.txt", "")];
        let bytes = archive(&files).unwrap();
        assert_eq!(bytes, archive(&files).unwrap());
        // Local file header: version needed at 4, flags at 6.
        assert_eq!(&bytes[..4], b"PK\x03\x04");
        assert!(u16::from_le_bytes([bytes[4], bytes[5]]) <= 20);
        assert_eq!(u16::from_le_bytes([bytes[6], bytes[7]]) & 0b1001, 0, "encrypted or streamed");
        let mut read = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
        for (index, file) in files.iter().enumerate() {
            let mut entry = read.by_index(index).unwrap();
            assert_eq!(entry.name().unwrap(), file.path);
            assert_eq!(entry.last_modified().unwrap().year(), 1980);
            let mut contents = Vec::new();
            entry.read_to_end(&mut contents).unwrap();
            assert_eq!(contents, file.contents);
        }
    }
}
