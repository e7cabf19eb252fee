//! Writes a bundle.

use super::collect::Collected;
use super::contents::{BundleContents, BundledFile};
use super::entry_name::LIST;
use super::error::BundleError;
use octant_campaign::plan::planned::hash_of_file;
use octant_campaign::plan::{FILE_NAME as PLAN, Plan};
use std::fs::File;
use std::io::{self, BufWriter, Read, Write};
use std::path::Path;
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// Level of Deflate.
const LEVEL: i64 = 6;
/// Length from which an entry has 64-bit lengths. Compressed data can be a little longer.
const LARGE_BYTES: u64 = 4_000_000_000;

/// Writes the plan of a campaign, with every file that its cases need, as one file. The same plan and the same
/// files give the same bytes. A file with these bytes is left as it is.
///
/// # Errors
/// If a file can't be read or is no longer the planned one, if another file is there, or if it can't be
/// written: then nothing is left under its name.
pub fn write(plan: Plan, out: &Path) -> Result<BundleContents, BundleError> {
    let Collected { plan, files, outside } = Collected::of(plan)?;
    let text = plan.to_json();
    let mut listed: Vec<BundledFile> = files
        .iter()
        .map(|(path, file)| BundledFile {
            path: path.clone(),
            bytes: file.bytes,
            blake3: file.blake3.clone(),
        })
        .collect();
    listed.push(BundledFile {
        path: PLAN.to_owned(),
        bytes: text.len() as u64,
        blake3: blake3::hash(text.as_bytes()).to_hex().to_string(),
    });
    let contents = BundleContents::new(&plan.id, outside.into_iter().collect(), listed);
    let folder = out.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(BundleError::system("create", folder))?;
    octant_base::whole_file::clean(folder);
    let new = octant_base::whole_file::new_file(folder)
        .map_err(BundleError::system("create a file in", folder))?;
    let wrong = |error: ZipError| BundleError::system("write", out)(error.into());
    let mut archive = ZipWriter::new(BufWriter::new(new.as_file()));
    // The list comes first, so that it is found without reading the rest.
    put(&mut archive, LIST, contents.to_json().as_bytes()).map_err(wrong)?;
    put(&mut archive, PLAN, text.as_bytes()).map_err(wrong)?;
    for (path, collected) in &files {
        let mut source =
            File::open(&collected.file).map_err(BundleError::system("read", &collected.file))?;
        archive.start_file(path.as_str(), options(path, collected.bytes)).map_err(wrong)?;
        let copied = copy(&mut source, &mut archive).map_err(BundleError::system("write", out))?;
        if copied != collected.blake3 {
            return Err(BundleError::Unfit {
                path: collected.file.clone(),
                reason: "it was changed while the bundle was made".to_owned(),
            });
        }
    }
    let mut writer = archive.finish().map_err(wrong)?;
    writer.flush().map_err(BundleError::system("write", out))?;
    drop(writer);
    new.as_file().sync_all().map_err(BundleError::system("write", out))?;
    if out.exists() {
        let hash = |path: &Path| hash_of_file(path).map_err(BundleError::system("read", path));
        if out.is_file() && hash(out)? == hash(new.path())? {
            return Ok(contents);
        }
        return Err(exists(out));
    }
    new.persist_noclobber(out).map_err(|failed| match failed.error {
        error if error.kind() == io::ErrorKind::AlreadyExists => exists(out),
        error => BundleError::system("write", out)(error),
    })?;
    Ok(contents)
}

fn exists(out: &Path) -> BundleError {
    let reason = "something else is there, expected a new name or the same bundle".to_owned();
    BundleError::Exists { path: out.to_owned(), reason }
}

/// Nothing of host or clock.
fn options(path: &str, bytes: u64) -> SimpleFileOptions {
    // These are compressed already.
    let is_packed = [".fmu", ".mcap", ".zip"].iter().any(|end| path.ends_with(end));
    let options = SimpleFileOptions::default()
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644)
        .large_file(bytes >= LARGE_BYTES);
    if is_packed {
        options.compression_method(CompressionMethod::Stored)
    } else {
        options.compression_method(CompressionMethod::Deflated).compression_level(Some(LEVEL))
    }
}

fn put<W: Write + io::Seek>(
    archive: &mut ZipWriter<W>,
    path: &str,
    bytes: &[u8],
) -> Result<(), ZipError> {
    archive.start_file(path, options(path, bytes.len() as u64))?;
    Ok(archive.write_all(bytes)?)
}

/// Copies a file, and returns its BLAKE3.
fn copy(source: &mut impl Read, target: &mut impl Write) -> io::Result<String> {
    let mut hasher = blake3::Hasher::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        let count = match source.read(&mut buffer) {
            Ok(0) => return Ok(hasher.finalize().to_hex().to_string()),
            Ok(count) => count,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(error),
        };
        let read = buffer.get(..count).unwrap_or_default();
        hasher.update(read);
        target.write_all(read)?;
    }
}
