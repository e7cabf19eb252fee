//! Checks specific to Linux libraries: a search path, a stack that may be executable, versions of
//! symbols.

use super::binary::{LibraryProperties, is_beside};
use super::finding::{Findings, Place};
use super::rules::{BINARY_GLIBC, BINARY_RPATH, BINARY_STACK};
use object::read::elf::FileHeader;
use std::collections::BTreeSet;

/// Newest C library that a library may require without a warning: that of Ubuntu 22.04 and of
/// systems from 2022 on. A library that requires a newer one was built on a newer system than most
/// users have.
const GLIBC: [u32; 2] = [2, 35];

/// Checks search path, executable stack and versions of symbols of a Linux library.
pub(super) fn check<'data, Elf: FileHeader<Endian = object::Endianness>>(
    elf: &object::read::elf::ElfFile<'data, Elf>,
    place: Place<'_>,
    beside: &BTreeSet<String>,
    binary: &mut LibraryProperties,
    findings: &mut Findings,
) {
    use object::Object as _;
    use object::elf;
    use object::read::elf::ProgramHeader;
    let endian = elf.endian();
    let mut paths: Vec<String> = Vec::new();
    if let Ok(table) = elf.elf_dynamic_table() {
        for entry in &table {
            if matches!(entry.tag, elf::DT_RPATH | elf::DT_RUNPATH)
                && let Ok(text) = table.string(entry)
            {
                paths.push(String::from_utf8_lossy(text).into_owned());
            }
        }
    }
    let here = paths
        .iter()
        .flat_map(|path| path.split(':'))
        .any(|path| matches!(path.trim_end_matches('/'), "$ORIGIN" | "${ORIGIN}"));
    let bundled: Vec<&str> = binary
        .libraries
        .iter()
        .map(String::as_str)
        .filter(|name| is_beside(name, beside))
        .collect();
    if !bundled.is_empty() && !here {
        let found = match paths.join(":") {
            paths if paths.is_empty() => "no RPATH".to_owned(),
            paths => format!("RPATH {paths}"),
        };
        let expected = format!("$ORIGIN, to find {}", bundled.join(", "));
        findings.add(&BINARY_RPATH, place, found, expected);
    }
    for segment in elf.elf_program_headers() {
        if segment.p_type(endian) == elf::PT_GNU_STACK
            && segment.p_flags(endian).0 & elf::PF_X.0 != 0
        {
            let found = "PT_GNU_STACK is executable";
            findings.add(&BINARY_STACK, place, found, "a stack of data only");
        }
    }
    let mut newest: Option<[u32; 3]> = None;
    let table = elf.elf_section_table().versions(endian, elf.data());
    if let Ok(Some(versions)) = table {
        for symbol in elf.dynamic_symbols() {
            use object::ObjectSymbol;
            let index = versions.version_index(endian, symbol.index());
            let Ok(Some(version)) = versions.version(index.index()) else { continue };
            let name = String::from_utf8_lossy(version.name());
            if let Some(version) = name.strip_prefix("GLIBC_").and_then(glibc_version) {
                newest = newest.max(Some(version));
            }
        }
    }
    if let Some([major, minor, patch]) = newest {
        let text = match patch {
            0 => format!("{major}.{minor}"),
            _ => format!("{major}.{minor}.{patch}"),
        };
        if [major, minor] > GLIBC {
            let expected = format!("at most {}.{}, which most machines have", GLIBC[0], GLIBC[1]);
            findings.add(&BINARY_GLIBC, place, format!("it needs glibc {text}"), expected);
        }
        binary.glibc = Some(text);
    }
}

/// Reads a version: `2.17`, `2.2.5`.
fn glibc_version(text: &str) -> Option<[u32; 3]> {
    let mut version = [0; 3];
    for (number, part) in version.iter_mut().zip(text.split('.')) {
        *number = part.parse().ok()?;
    }
    Some(version)
}
