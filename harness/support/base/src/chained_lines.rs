//! Files of lines that grow while a program works, so that it goes on after an interruption.
//!
//! Each line is a checksum, a blank and a text. The checksum is the beginning of the BLAKE3 of the one before and of the
//! text: a line that is edited or left out is found. It has no key, and so it doesn't keep anybody from writing a whole
//! file anew. A line without an end was interrupted, and is cut off.

use std::fs::{File, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Number of characters of a checksum.
const CHECKSUM: usize = 32;

/// A file whose lock ends with it. The lock belongs to the open file, which a process that is being started shares until
/// it executes its program: without these words the lock would outlast the file here.
#[derive(Debug)]
struct LockedFile(File);

impl Drop for LockedFile {
    fn drop(&mut self) {
        // Where this fails, closing the file ends the lock.
        let _ = self.0.unlock();
    }
}

/// A locked file of chained lines.
#[derive(Debug)]
pub struct ChainedLines {
    path: PathBuf,
    file: LockedFile,
    /// Checksum of the last line.
    chained: String,
}

/// Reasons why a file of chained lines can't be used.
#[derive(Debug, thiserror::Error)]
pub enum ChainedLinesError {
    /// The operating system refuses.
    #[error("{action} {path}: {source}")]
    System {
        /// Action that failed.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A line isn't the expected one.
    #[error("{path}: line {line}: {problem}")]
    Line {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Found and expected content.
        problem: String,
    },
}

/// Checksum of a line after another one.
fn chain(before: &str, text: &str) -> String {
    let mut hasher = blake3::Hasher::new();
    hasher.update(before.as_bytes());
    hasher.update(text.as_bytes());
    hasher.finalize().to_hex().chars().take(CHECKSUM).collect()
}

/// Reads the whole lines of a file; returns where they end, and the last checksum.
fn whole_lines(
    path: &Path,
    is_mine: impl FnOnce(&str) -> Result<(), String>,
    each: &mut dyn FnMut(&str) -> Result<(), String>,
) -> Result<(usize, String), ChainedLinesError> {
    let refused = |line, problem| ChainedLinesError::Line { path: path.to_owned(), line, problem };
    let bytes = std::fs::read(path).map_err(|source| ChainedLinesError::System {
        action: "read",
        path: path.to_owned(),
        source,
    })?;
    let end = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
    let whole = std::str::from_utf8(&bytes[..end])
        .map_err(|_| refused(1, "found bytes that are not UTF-8".to_owned()))?;
    let (mut chained, mut is_mine) = (String::new(), Some(is_mine));
    for (index, line) in whole.lines().enumerate() {
        let (checksum, text) = line.split_once(' ').unwrap_or(("", line));
        let is_first = is_mine.take();
        let found = is_first.is_none();
        if let Some(is_mine) = is_first {
            is_mine(text).map_err(|problem| refused(1, problem))?;
        }
        chained = chain(&chained, text);
        if checksum != chained {
            let problem = "the checksum doesn't fit: a line was changed or left out".to_owned();
            return Err(refused(index + 1, problem));
        }
        if found {
            each(text).map_err(|problem| refused(index + 1, problem))?;
        }
    }
    Ok((end, chained))
}

impl ChainedLines {
    /// Opens a file, or begins it with a first line, and locks it. `is_mine` takes the first line of a file that is
    /// there, before its checksum is looked at: a newer version may have another one. `each` takes the further lines.
    /// Both return what they found and what they expected of a line that they refuse.
    ///
    /// # Errors
    /// If a line is refused or doesn't follow the one before, another process has the file, or the operating system
    /// refuses.
    pub fn open(
        path: &Path,
        first: &str,
        is_mine: impl FnOnce(&str) -> Result<(), String>,
        mut each: impl FnMut(&str) -> Result<(), String>,
    ) -> Result<Self, ChainedLinesError> {
        let failed = |action| {
            move |source| ChainedLinesError::System { action, path: path.to_owned(), source }
        };
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(false);
        let file = options.open(path).map_err(failed("open"))?;
        file.try_lock().map_err(|error| failed("lock")(error.into()))?;
        let mut file = LockedFile(file);
        let (end, chained) = whole_lines(path, is_mine, &mut each)?;
        file.0.set_len(end as u64).map_err(failed("cut"))?;
        file.0.seek(SeekFrom::Start(end as u64)).map_err(failed("read"))?;
        let mut lines = Self { path: path.to_owned(), file, chained };
        if end == 0 {
            lines.append([first.to_owned()])?;
        }
        Ok(lines)
    }

    /// Reads a file that is there, and leaves it as it is; a line without an end isn't taken. The functions are those of
    /// [`Self::open`].
    ///
    /// # Errors
    /// If a line is refused or doesn't follow the one before, there is none, or the operating system refuses.
    pub fn read(
        path: &Path,
        is_mine: impl FnOnce(&str) -> Result<(), String>,
        mut each: impl FnMut(&str) -> Result<(), String>,
    ) -> Result<(), ChainedLinesError> {
        let (end, _) = whole_lines(path, is_mine, &mut each)?;
        if end == 0 {
            let problem = "found no line".to_owned();
            return Err(ChainedLinesError::Line { path: path.to_owned(), line: 1, problem });
        }
        Ok(())
    }

    /// Name of the file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Appends texts without line ends; they are on the disk when this returns.
    ///
    /// # Errors
    /// If the operating system refuses.
    pub fn append(
        &mut self,
        texts: impl IntoIterator<Item = String>,
    ) -> Result<(), ChainedLinesError> {
        let mut all = String::new();
        for text in texts {
            self.chained = chain(&self.chained, &text);
            all += &format!("{} {text}\n", self.chained);
        }
        let written = self.file.0.write_all(all.as_bytes()).and_then(|()| self.file.0.sync_data());
        written.map_err(|source| self.failed("write", source))
    }

    /// Cuts off all lines but the first ones.
    ///
    /// # Errors
    /// If the operating system refuses.
    pub fn forget_from(&mut self, lines: usize) -> Result<(), ChainedLinesError> {
        let bytes = std::fs::read(&self.path).map_err(|source| self.failed("read", source))?;
        let kept: Vec<&[u8]> = bytes.split_inclusive(|byte| *byte == b'\n').take(lines).collect();
        let length = kept.iter().map(|line| line.len()).sum::<usize>() as u64;
        let checksum = kept.last().and_then(|line| line.get(..CHECKSUM)).unwrap_or_default();
        self.chained = String::from_utf8_lossy(checksum).into_owned();
        let cut = self.file.0.set_len(length);
        let cut = cut.and_then(|()| self.file.0.seek(SeekFrom::Start(length)).map(drop));
        cut.map_err(|source| self.failed("cut", source))
    }

    fn failed(&self, action: &'static str, source: io::Error) -> ChainedLinesError {
        ChainedLinesError::System { action, path: self.path.clone(), source }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn open(path: &Path) -> Result<(ChainedLines, Vec<String>), ChainedLinesError> {
        let mut found = Vec::new();
        let is_mine = |text: &str| match text {
            "mine" => Ok(()),
            other => Err(format!("found {other}, expected mine")),
        };
        let lines = ChainedLines::open(path, "mine", is_mine, |text| {
            found.push(text.to_owned());
            Ok(())
        })?;
        Ok((lines, found))
    }

    #[test]
    fn lines_come_back_and_a_torn_one_is_cut_off() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lines");
        let (mut lines, found) = open(&path).unwrap();
        assert!(found.is_empty());
        lines.append(["a b".to_owned(), String::new(), "c".to_owned()]).unwrap();
        // Another process has it.
        assert!(open(&path).unwrap_err().to_string().starts_with("lock "));
        drop(lines);
        let whole = std::fs::read(&path).unwrap();
        std::fs::write(&path, &whole[..whole.len() - 1]).unwrap();
        let (mut lines, found) = open(&path).unwrap();
        assert_eq!(found, ["a b", ""]);
        // Reading alone gives the same lines, and doesn't cut off a torn one.
        let torn = [&std::fs::read(&path).unwrap()[..], b"torn"].concat();
        std::fs::write(&path, &torn).unwrap();
        let mut found = Vec::new();
        let take = |text: &str| {
            found.push(text.to_owned());
            Ok(())
        };
        ChainedLines::read(&path, |_| Ok(()), take).unwrap();
        assert_eq!(
            (found, std::fs::read(&path).unwrap()),
            (vec!["a b".to_owned(), String::new()], torn)
        );
        let empty = folder.path().join("empty");
        std::fs::write(&empty, "torn").unwrap();
        let told =
            |path: &Path| ChainedLines::read(path, |_| Ok(()), |_| Ok(())).unwrap_err().to_string();
        assert!(told(&empty).ends_with("line 1: found no line"));
        assert!(told(&folder.path().join("none")).starts_with("read "));
        // The chain goes on from there, and from what is cut off on purpose.
        lines.append(["d".to_owned()]).unwrap();
        lines.forget_from(2).unwrap();
        lines.append(["e".to_owned()]).unwrap();
        drop(lines);
        assert_eq!(open(&path).unwrap().1, ["a b", "e"]);
    }

    /// A copy of the open file, as a process has it that is being started, doesn't keep the lock.
    #[test]
    fn lock_ends_with_the_lines() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lines");
        let (lines, _) = open(&path).unwrap();
        let _copy = lines.file.0.try_clone().unwrap();
        drop(lines);
        open(&path).unwrap();
    }

    #[test]
    fn edited_missing_and_foreign_lines_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lines");
        let (mut lines, _) = open(&path).unwrap();
        lines.append(["a".to_owned(), "b".to_owned(), "c".to_owned()]).unwrap();
        drop(lines);
        let whole = std::fs::read_to_string(&path).unwrap();
        let without_b: String =
            whole.split_inclusive('\n').filter(|l| !l.ends_with(" b\n")).collect();
        for (text, expected) in [
            (whole.replace(" b\n", " x\n"), "line 3: the checksum doesn't fit"),
            (without_b, "line 3: the checksum doesn't fit"),
            (whole.replace(" mine\n", " other\n"), "line 1: found other, expected mine"),
            ("no chain\n".to_owned(), "line 1: found chain, expected mine"),
        ] {
            std::fs::write(&path, text).unwrap();
            let error = open(&path).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }
}
