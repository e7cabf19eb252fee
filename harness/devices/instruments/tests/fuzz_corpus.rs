//! Runs the fuzzer's seeds and findings through the same function, without the fuzzer. The seeds are
//! written by this test with `OCTANT_WRITE_FIXTURES=1`.
#![allow(clippy::print_stdout, reason = "the last name printed is the file that fails")]

#[path = "../../../../fuzz/instruments.rs"]
mod instruments;

use crate::common;
use octant_instruments::Protocol;
use std::path::PathBuf;

/// Streams of each protocol: whole, and with a piece missing.
fn seeds() -> Vec<(String, Vec<u8>)> {
    let mut seeds = Vec::new();
    for (number, (protocol, frames)) in common::streams(3).into_iter().enumerate() {
        let choice = Protocol::ALL.iter().position(|one| *one == protocol).unwrap() as u8;
        let lines = if number == Protocol::ALL.len() { "_lines" } else { "" };
        let name = format!("{}{lines}", protocol.name());
        let bytes = frames.concat();
        let seed = |piece: u8, bytes: &[u8]| [&[choice, piece], bytes].concat();
        seeds.push((name.clone(), seed(7, &bytes)));
        let at = frames[0].len() + 9;
        let damaged = [&bytes[..at], &bytes[at + 5..]].concat();
        seeds.push((format!("{name}_piece_missing"), seed(64, &damaged)));
    }
    seeds
}

#[test]
fn streams() {
    let folder =
        PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fuzz/corpus/instruments"));
    let write = std::env::var_os("OCTANT_WRITE_FIXTURES").is_some();
    let seeds = seeds();
    for (name, bytes) in &seeds {
        let file = folder.join(name);
        if write {
            std::fs::create_dir_all(&folder).unwrap();
            std::fs::write(&file, bytes).unwrap();
        }
        let shipped = std::fs::read(&file).unwrap_or_default();
        assert!(shipped == *bytes, "run this test with OCTANT_WRITE_FIXTURES=1 to write {name}");
    }
    let mut count = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        println!("{}", path.display());
        instruments::stream(&std::fs::read(&path).unwrap());
        count += 1;
    }
    assert!(count >= seeds.len());
}
