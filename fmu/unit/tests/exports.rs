//! The shared library has all functions of both standards, and nothing else.

use object::{Object, ObjectSymbol};
use std::collections::BTreeSet;

#[test]
fn the_library_exports_the_functions_of_both_standards_and_nothing_else() {
    let library = std::env::current_exe().unwrap().with_file_name("liboctant_fmu.so");
    let bytes = std::fs::read(&library).unwrap();
    let file = object::File::parse(&*bytes).unwrap();
    let exported: BTreeSet<&str> = file
        .dynamic_symbols()
        .filter(|symbol| symbol.is_definition() && !symbol.is_local())
        .map(|symbol| symbol.name().unwrap())
        .collect();
    let expected: BTreeSet<&str> =
        octant_fmi::fmi2::NAMES.iter().chain(octant_fmi::fmi3::NAMES).copied().collect();
    assert_eq!(exported, expected);
    let needed = BTreeSet::from(["libc.so.6", "libm.so.6", "libgcc_s.so.1"]);
    for library in file.import_libraries().unwrap() {
        let library = library.unwrap();
        let name = String::from_utf8_lossy(library.name()).into_owned();
        assert!(needed.contains(&*name) || name.starts_with("ld-linux"), "needs {name}");
    }
}
