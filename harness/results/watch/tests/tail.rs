//! A file that is read while it is written: every message once, whatever is there of it.

use crate::common::epochs::record;
use crate::common::stream::stream;
use octant_evidence::{Existing, RunFolder};
use octant_recorder::reader::{Item, Recording};
use octant_recorder::{Policy, RecorderOptions, Samples};
use octant_watch::place::RunPlace;
use octant_watch::tail::{PollEnd, Tail, TailError};
use std::io::{self, Read, Write};

fn full() -> RecorderOptions {
    RecorderOptions {
        policy: Policy { samples: Samples::Full, ..Policy::default() },
        scenario: "schema = 1\ntitle = \"a stream\"\n".into(),
        ..RecorderOptions::default()
    }
}

/// Returns all messages of a complete file.
fn items(bytes: &[u8]) -> Vec<(u64, Item)> {
    let mut recording = Recording::new(bytes).unwrap();
    std::iter::from_fn(|| recording.next_item().unwrap()).collect()
}

/// Compares to the last bit: NaN equals NaN.
#[track_caller]
fn same(found: &[(u64, Item)], expected: &[(u64, Item)]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert_eq!(format!("{found:?}"), format!("{expected:?}"));
    }
}

/// File of which a part is written.
struct Prefix<'a> {
    bytes: &'a [u8],
    written: usize,
    read: usize,
}

impl Read for Prefix<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n = buffer.len().min(self.written - self.read);
        buffer[..n].copy_from_slice(&self.bytes[self.read..self.read + n]);
        self.read += n;
        Ok(n)
    }
}

#[test]
fn a_file_that_grows_by_single_bytes_gives_every_message_once() {
    // Noise doesn't compress: several chunks.
    let (bytes, _) = record(&stream(6000), &full());
    let expected = items(&bytes);
    let mut recording = Recording::growing(Prefix { bytes: &bytes, written: 0, read: 0 });
    let mut found = Vec::new();
    let mut grew = 0;
    for written in 0..=bytes.len() {
        recording.source().written = written;
        let before = found.len();
        while let Some(item) = recording.next_item().unwrap() {
            found.push(item);
        }
        grew += usize::from(found.len() > before);
        assert!(!recording.truncated());
        assert_eq!(recording.ended(), written == bytes.len(), "after {written} bytes");
    }
    assert!(grew >= 2, "the messages came {grew} times");
    same(&found, &expected);
}

#[test]
fn every_prefix_of_a_file_gives_a_prefix_of_its_messages() {
    let (bytes, _) = record(&stream(6000), &full());
    let expected = items(&bytes);
    let mut lengths = Vec::new();
    for written in (0..bytes.len()).step_by(4999).chain([8, 9, bytes.len() - 1, bytes.len()]) {
        let mut recording = Recording::growing(Prefix { bytes: &bytes, written, read: 0 });
        let found: Vec<_> = std::iter::from_fn(|| recording.next_item().unwrap()).collect();
        same(&found, &expected[..found.len()]);
        lengths.push(found.len());
        // The rest comes when it is there.
        recording.source().written = bytes.len();
        let rest: Vec<_> = std::iter::from_fn(|| recording.next_item().unwrap()).collect();
        same(&rest, &expected[found.len()..]);
        assert!(recording.ended());
    }
    lengths.dedup();
    assert!(lengths.len() > 2, "{lengths:?}");
}

#[test]
fn a_file_is_followed_through_its_writing_and_its_new_name() {
    let (bytes, _) = record(&stream(6000), &full());
    let expected = items(&bytes);
    let here = tempfile::tempdir().unwrap();
    let path = here.path().join("run");
    let folder = RunFolder::create(&path, Existing::Refuse).unwrap();
    let mut tail = Tail::new(RunPlace::of(&path).unwrap());
    let mut found = Vec::new();
    let mut look = |tail: &mut Tail, most| {
        tail.look(most, |info, time_ns, item| {
            assert_eq!(info.version, 1);
            found.push((time_ns, item));
        })
        .unwrap()
    };
    assert_eq!(look(&mut tail, 10), PollEnd::Present, "there is no file yet");
    let writer = std::thread::spawn(move || {
        let mut file = std::fs::File::create(folder.path().join("recording.mcap")).unwrap();
        let mut left = &bytes[..];
        // Pieces that end within magic, heads, chunks and the summary.
        for size in [1, 6, 2, 100, 7, 1021, 3].into_iter().cycle() {
            let (piece, rest) = left.split_at(left.len().min(size));
            file.write_all(piece).unwrap();
            left = rest;
            if left.is_empty() {
                break;
            }
        }
        drop(file);
        std::fs::write(folder.path().join("manifest.json"), "{}").unwrap();
        folder.finish().unwrap();
    });
    // A limit that can end a poll in the middle of a chunk.
    while look(&mut tail, 777) != PollEnd::End {}
    writer.join().unwrap();
    same(&found, &expected);
    // The end stays the end.
    assert_eq!(tail.look(10, |_, _, _| panic!("a message after the end")).unwrap(), PollEnd::End);
}

#[test]
fn another_file_in_its_place_is_told_and_so_is_damage() {
    let (bytes, _) = record(&stream(6000), &full());
    let here = tempfile::tempdir().unwrap();
    let path = here.path().join("recording.mcap");
    std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    let mut tail = Tail::new(RunPlace::of(&path).unwrap());
    assert_eq!(tail.look(usize::MAX, |_, _, _| {}).unwrap(), PollEnd::Present);
    std::fs::write(&path, &bytes[..100]).unwrap();
    let error = tail.look(10, |_, _, _| {}).unwrap_err();
    assert!(matches!(error, TailError::Replaced { found: 100, .. }), "{error}");

    let mut damaged = bytes.clone();
    let at = bytes.len() / 3;
    damaged[at..at + 100].fill(0);
    std::fs::write(&path, &damaged).unwrap();
    let mut tail = Tail::new(RunPlace::of(&path).unwrap());
    let error = tail.look(usize::MAX, |_, _, _| {}).unwrap_err().to_string();
    assert!(error.contains("damaged after byte"), "{error}");

    std::fs::write(&path, "no recording at all").unwrap();
    let mut tail = Tail::new(RunPlace::of(&path).unwrap());
    let error = tail.look(10, |_, _, _| {}).unwrap_err().to_string();
    assert!(error.contains("not an MCAP file"), "{error}");
}
