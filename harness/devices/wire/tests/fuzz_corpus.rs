//! Runs the fuzzer's seeds and findings through the same functions, without the fuzzer. The seeds are
//! the conformance vectors, written by this test with `OCTANT_WRITE_FIXTURES=1`.
#![allow(clippy::print_stdout, reason = "the last name printed is the file that fails")]

#[path = "../../../../fuzz/wire.rs"]
mod wire;

use serde_json::Value;
use std::path::PathBuf;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../..");

fn vectors(name: &str) -> Vec<Value> {
    let text = std::fs::read_to_string(format!("{ROOT}/fixtures/wire/{name}")).unwrap();
    let all: Value = serde_json::from_str(&text).unwrap();
    all["vectors"].as_array().unwrap().clone()
}

fn unhex(text: &str) -> Vec<u8> {
    let byte = |i| u8::from_str_radix(&text[i..i + 2], 16).unwrap();
    (0..text.len()).step_by(2).map(byte).collect()
}

fn texts(list: &Value) -> Vec<&str> {
    list.as_array().unwrap().iter().map(|text| text.as_str().unwrap()).collect()
}

/// Converts frames in the notation of `cansend` to the fuzzer's input.
fn frames(list: &Value) -> Vec<u8> {
    let mut bytes = Vec::new();
    for text in texts(list) {
        let (id, data) = text.split_once('#').unwrap();
        let data = unhex(data.strip_prefix("#1").unwrap_or(data));
        bytes.extend(u16::from_str_radix(id, 16).unwrap().to_le_bytes());
        bytes.push(data.len() as u8);
        bytes.extend(data);
    }
    bytes
}

/// Runs every file of a corpus, which contains the seeds.
fn corpus(name: &str, input: fn(&[u8]), seeds: Vec<(String, Vec<u8>)>) {
    let folder = PathBuf::from(format!("{ROOT}/fuzz/corpus/{name}"));
    let write = std::env::var_os("OCTANT_WRITE_FIXTURES").is_some();
    std::fs::create_dir_all(&folder).unwrap();
    for (name, bytes) in &seeds {
        let letters = name.replace(|c: char| !c.is_ascii_alphanumeric(), "_");
        let file = folder.join(letters);
        if write {
            std::fs::write(&file, bytes).unwrap();
        }
        let shipped = std::fs::read(&file).unwrap_or_default();
        assert!(shipped == *bytes, "run this test with OCTANT_WRITE_FIXTURES=1 to write {name}");
    }
    let mut count = 0;
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        println!("{}", path.display());
        input(&std::fs::read(&path).unwrap());
        count += 1;
    }
    assert!(count >= seeds.len());
}

#[test]
fn lines() {
    let mut seeds = Vec::new();
    for vector in vectors("serial.json") {
        let name = vector["name"].as_str().unwrap().to_owned();
        // Seeds are cut into pieces of seven bytes.
        let bytes = texts(&vector["bytes"]).into_iter().flat_map(unhex);
        seeds.push((name, [7].into_iter().chain(bytes).collect()));
    }
    for vector in vectors("messages.json") {
        let kind = vector["kind"].as_str().unwrap();
        let code =
            octant_wire::MessageKind::ALL.iter().find(|one| one.name() == kind).unwrap().code();
        let payload = unhex(vector["payload"].as_str().unwrap());
        let name = format!("payload {}", vector["name"].as_str().unwrap());
        seeds.push((name, [code].into_iter().chain(payload).collect()));
    }
    corpus("wire_serial", wire::serial, seeds);
}

#[test]
fn buses() {
    let mut seeds = Vec::new();
    for vector in vectors("can.json") {
        seeds.push((vector["name"].as_str().unwrap().to_owned(), frames(&vector["frames"])));
    }
    for vector in vectors("messages.json") {
        let name = vector["name"].as_str().unwrap();
        seeds.push((format!("fd {name}"), frames(&vector["fd"])));
    }
    corpus("wire_can", wire::can, seeds);
}
