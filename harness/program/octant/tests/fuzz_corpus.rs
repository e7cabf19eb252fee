//! The fuzzer's seed and found inputs, passed through the same functions without it.

#[path = "../../../../fuzz/inputs.rs"]
mod inputs;

/// Runs every file of a corpus, which must have three or more.
fn corpus(name: &str, input: fn(&[u8])) {
    let folder = format!("{}/../../../fuzz/corpus/{name}", env!("CARGO_MANIFEST_DIR"));
    let mut count = 0;
    for entry in std::fs::read_dir(&folder).expect("the corpus is there") {
        let path = entry.expect("the corpus can be listed").path();
        let bytes = std::fs::read(&path).expect("the corpus can be read");
        println!("{}", path.display());
        input(&bytes);
        count += 1;
    }
    assert!(count >= 3, "{folder} has {count} inputs");
}

#[test]
fn scenarios() {
    corpus("scenario", inputs::scenario);
}

#[test]
fn recordings() {
    corpus("recording", inputs::recording);
}

#[test]
fn texts() {
    corpus("text", inputs::text);
}

#[test]
fn tables() {
    corpus("table", inputs::table);
}

#[test]
fn fmus() {
    corpus("fmu", inputs::fmu);
}

#[test]
fn descriptions() {
    corpus("description", inputs::description);
}
