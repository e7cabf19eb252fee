//! FMUs of `fixtures/fmu/foreign`, and variants that fail.

#[path = "../../../../../fmu/host/tests/common/foreign.rs"]
mod sound;

use octant_fmu_host::description::Standard;
use octant_fmu_host::library::platforms;
use octant_test_processes::command;
pub(crate) use sound::{copy, fmu, pack, sources, unpacked, without_clocks};
use std::path::Path;

/// Names of these FMUs, without `scheduled_fmi3` and `timed_fmi3`: they have only the functions that their own tests call.
pub const NAMES: [&str; 13] = [
    "gain_fmi2",
    "trouble_fmi2",
    "imu_fmi2",
    "core_fmi2",
    "signals_fmi3",
    "clocks_fmi3",
    "ball_fmi2",
    "ball_fmi3",
    "vanderpol_fmi2",
    "vanderpol_fmi3",
    "dahlquist_fmi3",
    "stair_fmi3",
    "feedthrough_fmi3",
];

/// Makes an unpacked FMU of FMI 2.0 whose library has more code. The functions in `replaced` are those
/// of `code`; the FMU's own have another name. The folder is the test's own.
pub fn altered(name: &str, code: &str, replaced: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::Builder::new().suffix(".fmu").tempdir().unwrap();
    std::fs::copy(
        sources().join(format!("{name}.xml")),
        folder.path().join("modelDescription.xml"),
    )
    .unwrap();
    let binaries = folder.path().join("binaries").join(platforms(Standard::Fmi2)[0]);
    std::fs::create_dir_all(&binaries).unwrap();
    let more = tempfile::Builder::new().suffix(".c").tempfile().unwrap();
    // The option below renames the functions here too.
    let undone: String = replaced.iter().map(|name| format!("#undef {name}\n")).collect();
    std::fs::write(&more, undone + code).unwrap();
    let status = command("gcc")
        .args(["-std=gnu11", "-O1", "-fPIC", "-shared", "-fvisibility=default"])
        .args(replaced.iter().map(|name| format!("-D{name}=own_{name}")))
        .arg(sources().join(format!("{name}.c")))
        .arg(more.path())
        .arg("-o")
        .arg(binaries.join(format!("{name}{}", std::env::consts::DLL_SUFFIX)))
        .arg("-lm")
        .status();
    assert!(status.is_ok_and(|status| status.success()), "gcc has to compile {name}");
    folder
}

/// Code of FMUs that fail at their end: the function that is replaced, the code, and how the failure is
/// named.
pub const BAD_ENDS: [(&[&str], &str, &str); 4] = [
    (
        &["fmi2FreeInstance"],
        "void fmi2FreeInstance(void *p) { *(volatile int *)8 = 1; }",
        "was ended by SIGSEGV in fmi2FreeInstance",
    ),
    (
        &["fmi2FreeInstance"],
        "#include <stdlib.h>\nvoid fmi2FreeInstance(void *p) { exit(0); }",
        "ended by itself with exit status 0 in fmi2FreeInstance",
    ),
    (
        &[],
        "#include <stdlib.h>\n__attribute__((destructor)) static void f(void) { abort(); }",
        "was ended by SIGABRT in the unloading of its library",
    ),
    (
        &[],
        "#include <unistd.h>\n__attribute__((destructor)) static void f(void) { for (;;) pause(); }",
        "gave no answer to the unloading of its library for 5 s, and was ended",
    ),
];

/// Packs an unpacked FMU into a file.
pub fn pack_into(folder: &Path, file: &Path) {
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    sound::pack(&mut archive, folder, "");
    std::fs::write(file, archive.finish().unwrap().into_inner()).unwrap();
}
