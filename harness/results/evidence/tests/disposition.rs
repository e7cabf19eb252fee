//! Files of dispositions.

use octant_evidence::discrepancy::Discrepancy;
use octant_evidence::disposition::{DispositionError, Dispositions, FILE_NAME};
use octant_verdict::Verdict;
use std::path::Path;

#[test]
fn every_text_is_quoted_so_that_toml_reads_it() {
    let with = |id: &str| {
        let found = Discrepancy {
            id: id.to_owned(),
            kind: "requirement",
            verdict: Verdict::Fail,
            requirement: None,
            what: String::new(),
            cases: Vec::new(),
        };
        Dispositions::default().with(&[found], Path::new("d.toml"), "a run", "octant").expect(id)
    };
    for (text, quoted) in [
        ("longitude: found 3", r#""longitude: found 3""#),
        (r#"found "3" in C:\x"#, r#"'found "3" in C:\x'"#),
        (r#"isn't "3""#, r#""isn't \"3\"""#),
    ] {
        let file = with(text).text;
        assert!(file.contains(&format!("\nid = {quoted}\n")), "{file}");
    }
    for text in ["", "a\"b", "a'b", "'\"\\", "\t\r\n\u{0}\u{8}\u{1b}\u{7f}\u{85}", "°\u{2028}😀"]
    {
        let file = with(text);
        let table: toml::Table = file.text.parse().expect(text);
        assert_eq!(table["discrepancies"][0]["id"].as_str(), Some(text));
        assert_eq!(file.entries[0].id, text);
    }
}

#[test]
fn an_error_names_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(FILE_NAME);
    std::fs::write(&path, "schema = 1\n\n[[discrepancies]]\nid = 3\n").unwrap();
    let Err(DispositionError::Form { reason, .. }) = Dispositions::read(&path) else {
        panic!("id is a text");
    };
    assert!(reason.starts_with("line 4: "), "{reason}");
}
