use super::*;
use std::io::Write;
use zip::write::{SimpleFileOptions, ZipWriter};

/// Makes a zip with these files.
fn zip(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut writer = ZipWriter::new(io::Cursor::new(Vec::new()));
    for (name, contents) in files {
        writer.start_file(*name, SimpleFileOptions::default()).expect("starts");
        writer.write_all(contents).expect("writes");
    }
    writer.finish().expect("finishes").into_inner()
}

/// Replaces all occurrences of `from` in a zip, in headers and directory alike.
fn patched(mut bytes: Vec<u8>, from: &[u8], to: &[u8]) -> Vec<u8> {
    assert_eq!(from.len(), to.len());
    let mut at = 0;
    while let Some(found) = bytes[at..].windows(from.len()).position(|window| window == from) {
        bytes[at + found..at + found + from.len()].copy_from_slice(to);
        at += found + from.len();
    }
    assert!(at > 0, "nothing is replaced");
    bytes
}

fn refused(bytes: Vec<u8>) -> String {
    Archive::from_bytes("h.fmu", bytes).expect_err("is refused").to_string()
}

#[test]
fn files_are_read_and_unpacked() {
    let files: [(&str, &[u8]); 3] =
        [("modelDescription.xml", b"<a/>"), ("binaries/x/y.so", b"\x7fELF"), ("resources/z", b"")];
    let mut archive = Archive::from_bytes("a.fmu", zip(&files)).expect("opens");
    assert!(archive.contains("resources/z") && !archive.contains("resources"));
    assert!(archive.contains_below("binaries/") && !archive.contains_below("sources/"));
    for (name, contents) in files {
        assert_eq!(archive.read(name).expect("reads"), contents);
    }
    let missing = archive.read("../etc/passwd").expect_err("isn't there").to_string();
    assert_eq!(missing, "a.fmu has no ../etc/passwd");
    let unpacked = archive.unpack().expect("unpacks");
    for (name, contents) in files {
        assert_eq!(fs::read(unpacked.path().join(name)).expect("is there"), contents);
    }
    // The folder is an archive as well, and stays when that is dropped.
    let mut folder = Archive::open(unpacked.path()).expect("opens");
    assert!(folder.is_folder());
    assert_eq!(folder.read("modelDescription.xml").expect("reads"), b"<a/>");
    drop(folder.unpack().expect("is a folder"));
    let path = unpacked.path().to_owned();
    assert!(path.join("modelDescription.xml").exists());
    drop(unpacked);
    assert!(!path.exists());
}

#[test]
fn what_is_no_zip_says_what_it_is() {
    assert_eq!(
        refused(Vec::new()),
        "h.fmu is no zip archive: it is empty, expected an FMU or SSP file, or an unpacked folder"
    );
    assert!(refused(b"<?xml version".to_vec()).contains("begins with \"<?xm\""));
    assert!(refused(b"PK".to_vec()).contains("begins with \"PK\""));
    let error = Archive::open(Path::new("/nowhere/x.fmu")).expect_err("isn't there").to_string();
    assert!(error.starts_with("failed to open /nowhere/x.fmu: "), "{error}");
}

#[test]
fn every_truncation_is_an_error() {
    let whole = zip(&[("modelDescription.xml", &[b'x'; 300]), ("b", b"c")]);
    for length in 0..whole.len() {
        let error = refused(whole[..length].to_vec());
        assert!(error.starts_with("h.fmu is "), "{length}: {error}");
    }
    // With bytes before the archive the file is two things at once.
    let mut polyglot = b"PK\x03\x04 not this".to_vec();
    polyglot.extend(&whole);
    assert!(refused(polyglot).starts_with("h.fmu is damaged: "));
}

#[test]
fn every_changed_byte_is_an_error_or_harmless() {
    let files: [(&str, &[u8]); 2] =
        [("modelDescription.xml", b"<abc>abc abc abc</abc>"), ("b", b"c")];
    let whole = zip(&files);
    for at in 0..whole.len() {
        for change in [0x01, 0x80, 0xff] {
            let mut bytes = whole.clone();
            bytes[at] ^= change;
            let Ok(mut archive) = Archive::from_bytes("h.fmu", bytes) else { continue };
            // Names and dates may change; contents have a checksum, whose own bytes are
            // unprotected.
            for entry in archive.entries().to_vec() {
                if let Ok(contents) = archive.read(&entry.name) {
                    assert!(files.iter().any(|(_, known)| *known == contents), "byte {at}");
                }
            }
            let _ = archive.unpack();
        }
    }
}

#[test]
fn hostile_names_are_refused() {
    for (name, found) in [
        ("../../etc/x", "leaves the folder"),
        ("/etc/passwd", "is an absolute path"),
        ("a\\..\\b.txt", "has a backslash"),
        ("C:/windows", "has a drive letter"),
        ("a/../../b", "leaves the folder"),
    ] {
        let plain = "#".repeat(name.len());
        let bytes = patched(zip(&[(&plain, b"x")]), plain.as_bytes(), name.as_bytes());
        let error = refused(bytes.clone());
        assert!(
            error.starts_with(&format!("h.fmu: entry {:?} {found}, expected ", name)),
            "{error}"
        );
        // The survey lists the entry, but reads and unpacks nothing of it.
        let mut archive =
            Archive::survey_bytes("h.fmu", bytes, ArchiveLimits::DEFAULT).expect("is surveyed");
        assert_eq!(archive.problems().len(), 1);
        assert!(archive.entries().is_empty());
        assert!(archive.read(name).is_err() && archive.unpack().is_err());
    }
    let error = refused(patched(zip(&[("#latin", b"x")]), b"#latin", b"\xe4latin"));
    assert_eq!(error, "h.fmu: entry \"\\\\xe4latin\" isn't UTF-8, expected a name in UTF-8");
}

#[test]
fn names_that_collide_are_refused() {
    let twice = patched(zip(&[("aaa", b"1"), ("bbb", b"2")]), b"bbb", b"aaa");
    assert_eq!(
        refused(twice),
        "h.fmu: entry \"aaa\" is there twice, with different contents, expected one entry of a name"
    );
    let case = zip(&[("a/Model.so", b"1"), ("a/model.so", b"2")]);
    assert!(refused(case).contains("upper and lower case alone"));
    let both = zip(&[("a", b"1"), ("a/b", b"2")]);
    assert!(refused(both).contains("a file and a folder"));
}

#[test]
fn identical_entries_of_one_name_are_odd_and_read() {
    let text = b"<a/>".repeat(100);
    let mut writer = ZipWriter::new(io::Cursor::new(Vec::new()));
    // Packed in two ways: the contents count.
    for (name, method) in [
        ("aaa", zip::CompressionMethod::Stored),
        ("bbb", zip::CompressionMethod::Deflated),
        ("ccc", zip::CompressionMethod::Deflated),
    ] {
        let options = SimpleFileOptions::default().compression_method(method);
        writer.start_file(name, options).expect("starts");
        writer.write_all(&text).expect("writes");
    }
    let bytes = writer.finish().expect("finishes").into_inner();
    let bytes = patched(patched(bytes, b"bbb", b"aaa"), b"ccc", b"aaa");
    let mut archive = Archive::from_bytes("h.fmu", bytes.clone()).expect("opens");
    let odd = Odd { entry: "aaa".into(), what: Oddity::Duplicate };
    let twice = archive.oddities().iter().filter(|found| **found == odd).count();
    assert_eq!(twice, 2, "{:?}", archive.oddities());
    assert_eq!(archive.entries().len(), 1);
    assert_eq!(archive.read("aaa").expect("reads"), text);
    assert!(archive.unpack().is_ok());
    // Beyond the limit nothing is compared.
    let limits = ArchiveLimits { read_bytes: 500, ..ArchiveLimits::DEFAULT };
    let archive = Archive::survey_bytes("h.fmu", bytes, limits).expect("opens");
    assert!(archive.problems()[0].found.contains("can't be compared"), "{:?}", archive.problems());
    // A folder is there twice in the archives of some tools.
    let folder = patched(zip(&[("a/", b""), ("b/", b""), ("c", b"1")]), b"b/", b"a/");
    assert_eq!(Archive::from_bytes("h.fmu", folder).expect("opens").problems(), []);
}

#[test]
fn links_devices_and_ciphers_are_refused() {
    let mut writer = ZipWriter::new(io::Cursor::new(Vec::new()));
    writer.add_symlink("link", "/etc/passwd", SimpleFileOptions::default()).expect("adds");
    let link = writer.finish().expect("finishes").into_inner();
    assert_eq!(
        refused(link),
        "h.fmu: entry \"link\" is a symbolic link, expected a file or a folder"
    );
    // Bit 0 of the flags in the directory, eight bytes after the signature.
    let mut bytes = zip(&[("a", b"1")]);
    let at = bytes.windows(4).position(|window| window == b"PK\x01\x02").expect("a directory");
    bytes[at + 8] |= 1;
    let error = refused(bytes);
    assert!(error.contains("encrypted"), "{error}");
    // The compression, ten bytes after it: 12 is bzip2.
    let mut bytes = zip(&[("a", b"1")]);
    bytes[at + 10] = 12;
    let error = refused(bytes);
    assert!(error.contains("packed with"), "{error}");
    // The type in the mode, 38 + 2 bytes after it: a character device.
    let mut bytes = zip(&[("a", b"1")]);
    bytes[at + 41] = 0o020;
    let error = refused(bytes);
    assert!(error.contains("is a device"), "{error}");
}

#[test]
fn bombs_are_stopped_while_unpacking() {
    let zeros = vec![0u8; 1 << 20];
    let bytes = zip(&[("a", &zeros), ("b", &zeros)]);
    let limits = |limits: ArchiveLimits| Archive::survey_bytes("h.fmu", bytes.clone(), limits);
    let small = ArchiveLimits { ratio_free_bytes: 1 << 16, ..ArchiveLimits::DEFAULT };
    let error = limits(small).expect("opens").unpack().expect_err("a bomb").to_string();
    assert_eq!(
        error,
        "h.fmu: entry \"a\" unpacks to more than 100 times its size, \
         expected at most 65536 bytes for such an entry"
    );
    let small = ArchiveLimits { unpacked_bytes: 3 << 19, ..ArchiveLimits::DEFAULT };
    let error = limits(small).expect("opens").unpack().expect_err("a bomb").to_string();
    assert_eq!(
        error,
        "h.fmu: with entry \"b\" more is unpacked than from any FMU, expected at most 1572864 bytes"
    );
    let small = ArchiveLimits { read_bytes: 1000, ..ArchiveLimits::DEFAULT };
    let error = limits(small).expect("opens").read("a").expect_err("too large").to_string();
    assert_eq!(
        error,
        "h.fmu: with entry \"a\" more is unpacked than from any FMU, expected at most 1000 bytes"
    );
    // The size in the headers is no protection: here it says one byte.
    let mut lying = bytes.clone();
    let size = (1u32 << 20).to_le_bytes();
    lying = patched(lying, &size, &1u32.to_le_bytes());
    let small = ArchiveLimits { unpacked_bytes: 1 << 19, ..ArchiveLimits::DEFAULT };
    let mut archive = Archive::survey_bytes("h.fmu", lying, small).expect("opens");
    archive.unpack().expect_err("a bomb or damaged");
}

#[test]
fn entries_that_share_bytes_are_refused() {
    // Both entries of the directory point to the first: the principle of flat bombs.
    let mut bytes = zip(&[("aaa", b"111"), ("aab", b"111")]);
    let directory: Vec<usize> =
        (0..bytes.len() - 4).filter(|&at| &bytes[at..at + 4] == b"PK\x01\x02").collect();
    bytes[directory[1] + 42..directory[1] + 46].copy_from_slice(&0u32.to_le_bytes());
    assert_eq!(refused(bytes), "h.fmu is damaged: entries overlap");
}

#[test]
fn too_many_entries_are_refused() {
    let names: Vec<String> = (0..20).map(|i| format!("file{i}")).collect();
    let files: Vec<(&str, &[u8])> = names.iter().map(|name| (&name[..], &b""[..])).collect();
    let bytes = zip(&files);
    let few = ArchiveLimits { entries: 19, ..ArchiveLimits::DEFAULT };
    let error = Archive::survey_bytes("h.fmu", bytes.clone(), few).expect_err("too many");
    assert_eq!(error.to_string(), "h.fmu: it has 20 entries, expected at most 19");
    let few = ArchiveLimits { directory_bytes: 500, ..ArchiveLimits::DEFAULT };
    let error = Archive::survey_bytes("h.fmu", bytes, few).expect_err("too many");
    assert_eq!(error.to_string(), "h.fmu: its directory is too large, expected at most 500 bytes");
}

#[cfg(unix)]
#[test]
fn programs_stay_programs_and_links_in_folders_are_not_followed() {
    use std::os::unix::fs::PermissionsExt;
    let mut writer = ZipWriter::new(io::Cursor::new(Vec::new()));
    let program = SimpleFileOptions::default().unix_permissions(0o755);
    writer.start_file("resources/tool", program).expect("starts");
    writer.start_file("resources/data", SimpleFileOptions::default()).expect("starts");
    let bytes = writer.finish().expect("finishes").into_inner();
    let unpacked = Archive::from_bytes("a.fmu", bytes).expect("opens").unpack().expect("unpacks");
    let mode = |name| {
        fs::metadata(unpacked.path().join(name)).expect("is there").permissions().mode() & 0o111
    };
    assert_eq!((mode("resources/tool"), mode("resources/data")), (0o111, 0));
    // A link within the folder, as unpacked libraries have them.
    std::os::unix::fs::symlink("data", unpacked.path().join("resources/inside")).expect("links");
    let mut archive = Archive::open(unpacked.path()).expect("has a link to a file of its own");
    assert_eq!(archive.read("resources/inside").expect("is read"), b"");
    std::os::unix::fs::symlink("/etc/passwd", unpacked.path().join("resources/link"))
        .expect("links");
    let error = Archive::open(unpacked.path()).expect_err("has a link").to_string();
    assert!(error.contains("\"resources/link\" is a link or a device"), "{error}");
}

#[test]
fn a_copy_has_the_hash_of_what_is_read_whatever_becomes_of_the_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.fmu");
    let bytes = zip(&[("a.txt", b"content")]);
    std::fs::write(&path, &bytes).expect("is written");
    let (mut archive, hash) = Archive::open_copy(&path).expect("opens");
    assert_eq!(hash, octant_base::hash::sha256(&path).ok());
    std::fs::write(&path, b"another").expect("is written");
    assert_eq!(archive.read("a.txt").expect("is read"), b"content");
    for _ in 0..2 {
        let unpacked = archive.unpack().expect("unpacks");
        assert_eq!(std::fs::read(unpacked.path().join("a.txt")).expect("is there"), b"content");
    }
    let error = Archive::open_copy(&path).expect_err("is no archive").to_string();
    assert!(error.contains("a.fmu is no zip archive: it begins with \"anot\""), "{error}");
    let (_, hash) = Archive::open_copy(folder.path()).expect("a folder opens");
    assert_eq!(hash, None);
    #[cfg(unix)]
    Archive::open_copy(Path::new("/dev/zero")).expect_err("has no end");
}
