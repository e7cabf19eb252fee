//! `.reqifz`: whole ones, and those that somebody damaged or made to do harm.

use octant_requirements::mapping::Mapping;
use octant_requirements::reqif::{self, ReqIfArchiveError};
use octant_requirements::{Attachment, Imported};
use octant_verdict::requirement::{Requirement, Requirements, Verification};
use std::io::{Cursor, Write as _};
use zip::write::{SimpleFileOptions, ZipWriter};

const TIME: &str = "2026-01-31T12:00:00Z";

fn requirements(title: &str, ids: &[&str]) -> Requirements {
    let all = ids.iter().map(|id| Requirement::new(id, "It holds.", Verification::Analysis));
    Requirements { title: title.to_owned(), requirements: all.collect(), ..Requirements::default() }
}

fn archive(entries: &[(&str, &[u8])]) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in entries {
        zip.start_file(*name, SimpleFileOptions::default()).unwrap();
        zip.write_all(bytes).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

fn read(bytes: &[u8]) -> Result<Imported, ReqIfArchiveError> {
    reqif::read_archive(bytes, "a.reqifz", &Mapping::default())
}

fn said(bytes: &[u8]) -> String {
    read(bytes).unwrap_err().to_string()
}

#[test]
fn files_of_an_archive_are_read_together() {
    let first = reqif::write(&requirements("First", &["A"]), TIME).unwrap();
    let second = reqif::write(&requirements("Second", &["B"]), TIME).unwrap();
    // A relation from the second file to the first.
    let relation = format!(
        "<SPEC-RELATIONS><SPEC-RELATION IDENTIFIER=\"r\" LAST-CHANGE=\"{TIME}\"><TYPE><SPEC-RELATION-TYPE-REF>\
         octant-t-relation-0</SPEC-RELATION-TYPE-REF></TYPE><SOURCE><SPEC-OBJECT-REF>octant-B\
         </SPEC-OBJECT-REF></SOURCE><TARGET><SPEC-OBJECT-REF>octant-A</SPEC-OBJECT-REF></TARGET>\
         </SPEC-RELATION></SPEC-RELATIONS>"
    );
    let start = second.find("<SPEC-RELATIONS>").unwrap();
    let end = second.find("</SPEC-RELATIONS>").unwrap() + "</SPEC-RELATIONS>".len();
    let second = format!("{}{relation}{}", &second[..start], &second[end..]);
    let bytes = archive(&[
        ("b/second.reqif", second.as_bytes()),
        ("first.reqif", first.as_bytes()),
        ("files/p.png", b"png"),
    ]);
    let found = read(&bytes).unwrap();
    let b = found.requirements.get("B").unwrap();
    assert_eq!(b.parents[0].id, "A");
    assert_eq!(b.section, ["Second"]);
    assert_eq!(found.requirements.get("A").unwrap().section, ["First"]);
    let picture = Attachment { name: "files/p.png".to_owned(), bytes: b"png".to_vec() };
    assert_eq!(found.attachments, [picture]);
}

#[test]
fn an_id_of_two_files_costs_one_object_and_names_both() {
    let first = reqif::write(&requirements("First", &["A"]), TIME).unwrap();
    let second = first.replace("octant-A", "other-A");
    let bytes = archive(&[("1.reqif", first.as_bytes()), ("2.reqif", second.as_bytes())]);
    let found = read(&bytes).unwrap();
    let told = |found: &Imported, words: &str| {
        found.notes.iter().any(|note| note.to_string().contains(words))
    };
    assert!(told(&found, "2.reqif, line ") && told(&found, "of another, that of 1.reqif, line "));
    assert_eq!((found.account.read(), found.skipped()), (2, 1));
    // An object with another content is no copy.
    let second = first.replace("It holds.", "It doesn't hold.");
    let bytes = archive(&[("1.reqif", first.as_bytes()), ("2.reqif", second.as_bytes())]);
    let found = read(&bytes).unwrap();
    assert!(told(&found, "is in 1.reqif with another content, which is kept"));
    assert_eq!((found.account.read(), found.skipped()), (2, 1));
    // The same object in two files is one requirement.
    let bytes = archive(&[("1.reqif", first.as_bytes()), ("2.reqif", first.as_bytes())]);
    let found = read(&bytes).unwrap();
    assert_eq!(found.requirements.requirements.len(), 1);
    assert!(told(&found, "is in 1.reqif too"));
    assert_eq!((found.account.read(), found.account.left_out_count(), found.skipped()), (2, 1, 0));
}

#[test]
fn a_damaged_archive_is_refused_in_plain_words() {
    let good = reqif::write_archive(&requirements("T", &["A"]), &[], TIME).unwrap();
    assert_eq!(good, reqif::write_archive(&requirements("T", &["A"]), &[], TIME).unwrap());
    assert!(read(&good).is_ok());
    for cut in [0, 1, 10, good.len() / 2, good.len() - 1] {
        let error = said(&good[..cut]);
        assert!(error.starts_with("a.reqifz: not a readable ZIP archive: "), "{error}");
    }
    // Every byte of the content is covered by its checksum.
    let mut flipped = good.clone();
    flipped[60] ^= 0x20;
    assert!(read(&flipped).is_err());
    let nothing = archive(&[("readme.txt", b"x")]);
    assert!(
        said(&nothing).contains("no file that ends in .reqif in the archive, found readme.txt")
    );
    let broken = archive(&[("x.reqif", b"<REQ-IF>")]);
    assert!(said(&broken).starts_with("a.reqifz/x.reqif:1:"), "{}", said(&broken));
}

#[test]
fn names_that_lead_out_of_the_archive_are_refused() {
    for name in ["../x.reqif", "a/../../x.reqif", "/etc/x.reqif", "..\\x.reqif", "C:\\x.reqif"] {
        let error = said(&archive(&[(name, b"x")]));
        assert!(error.contains("leads out of the archive"), "{name}: {error}");
    }
}

#[test]
fn a_bomb_is_refused_while_it_is_unpacked() {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let zeros = vec![0; 1 << 20];
    zip.start_file("x.reqif", SimpleFileOptions::default()).unwrap();
    for _ in 0..513 {
        zip.write_all(&zeros).unwrap();
    }
    let bytes = zip.finish().unwrap().into_inner();
    assert!(bytes.len() < 4 << 20);
    let error = said(&bytes);
    assert!(
        error.contains("too large from the entry \"x.reqif\" on, and the limit is 512 MiB"),
        "{error}"
    );
}

#[test]
fn a_picture_that_is_missing_is_named() {
    let mut all = requirements("T", &["A"]);
    all.requirements[0].text = "See".to_owned();
    all.requirements[0].formatted = vec![octant_verdict::requirement::FormattedText {
        name: "ReqIF.Text".to_owned(),
        xhtml: "<p>See<object data=\"p.png\" type=\"image/png\"/></p>".to_owned(),
    }];
    let alone = reqif::write_archive(&all, &[], TIME).unwrap();
    let notes = read(&alone).unwrap().notes;
    assert!(notes[0].to_string().contains("A: the text shows \"p.png\""), "{notes:?}");
    let picture = Attachment { name: "p.png".to_owned(), bytes: vec![1, 2] };
    let whole = reqif::write_archive(&all, std::slice::from_ref(&picture), TIME).unwrap();
    let found = read(&whole).unwrap();
    assert_eq!((found.notes.len(), found.attachments), (0, vec![picture]));
    assert_eq!(found.requirements, all);
}
