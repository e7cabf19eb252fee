//! FMUs of `fixtures/fmu/foreign`, compiled and packed.
//!
//! For a test of its own: `#[path = "common/foreign.rs"] mod foreign;`.

use octant_fmu_host::description::Standard;
use octant_fmu_host::library::platforms;
use octant_test_processes::command;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Names of these FMUs, without `scheduled_fmi3`: it has only the functions that its own tests call.
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

/// Returns the folder with their sources.
pub fn sources() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures/fmu/foreign")
}

/// Returns an unpacked FMU: a folder with the description and the library for this platform. It is
/// shared between tests, and no test writes there.
pub fn unpacked(name: &str) -> PathBuf {
    let place = place(name);
    let folder = place.join(name);
    if !folder.is_dir() {
        let work = tempfile::tempdir_in(place).unwrap();
        let built = work.path().join(name);
        build(name, &built);
        // If another test was quicker, its folder stays.
        if std::fs::rename(&built, &folder).is_err() {
            assert!(folder.is_dir(), "{} can't be made", folder.display());
        }
    }
    folder
}

/// Returns a packed FMU, `NAME.fmu`. It is shared between tests, and no test writes there.
pub fn fmu(name: &str) -> PathBuf {
    let path = place(name).join(format!("{name}.fmu"));
    if !path.is_file() {
        let folder = unpacked(name);
        let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
        pack(&mut archive, &folder, "");
        let bytes = archive.finish().unwrap().into_inner();
        let mut file = tempfile::NamedTempFile::new_in(path.parent().unwrap()).unwrap();
        file.write_all(&bytes).unwrap();
        file.persist(&path).unwrap();
    }
    path
}

/// Returns a folder that belongs to these sources: other sources get another one.
fn place(name: &str) -> PathBuf {
    let mut hash = blake3::Hasher::new();
    let mut files: Vec<PathBuf> = Vec::new();
    for folder in [sources(), sources().join("models")] {
        files.extend(std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()));
    }
    files.sort();
    for file in files.iter().filter(|file| file.is_file()) {
        hash.update(file.as_os_str().as_encoded_bytes());
        hash.update(&std::fs::read(file).unwrap());
    }
    let place = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("foreign")
        .join(format!("{}-{name}", &hash.finalize().to_hex()[..16]));
    std::fs::create_dir_all(&place).unwrap();
    place
}

/// Compiles the source with the name of the FMU, or the interface around its model.
fn build(name: &str, folder: &Path) {
    let (model, standard) = name.rsplit_once('_').unwrap();
    let platform = platforms(match standard {
        "fmi2" => Standard::Fmi2,
        _ => Standard::Fmi3,
    })[0];
    let binaries = folder.join("binaries").join(platform);
    std::fs::create_dir_all(&binaries).unwrap();
    std::fs::create_dir_all(folder.join("resources")).unwrap();
    std::fs::copy(sources().join(format!("{name}.xml")), folder.join("modelDescription.xml"))
        .unwrap();
    let own = sources().join(format!("{name}.c"));
    let library = binaries.join(format!("{name}{}", std::env::consts::DLL_SUFFIX));
    let mut gcc = command("gcc");
    gcc.args(["-std=gnu11", "-O1", "-g", "-fPIC", "-shared", "-Wall", "-Wextra", "-Werror"]);
    gcc.args(["-fvisibility=default", "-Wno-infinite-recursion"]);
    if own.is_file() {
        gcc.arg(own);
    } else {
        gcc.arg(format!("-DMODEL=\"models/{model}.h\""));
        gcc.arg(sources().join(format!("continuous_{standard}.c")));
    }
    let status = gcc.arg("-o").arg(&library).arg("-lm").status();
    assert!(status.is_ok_and(|status| status.success()), "gcc has to compile {name}");
}

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
    pack(&mut archive, folder, "");
    std::fs::write(file, archive.finish().unwrap().into_inner()).unwrap();
}

fn pack(archive: &mut zip::ZipWriter<std::io::Cursor<Vec<u8>>>, folder: &Path, prefix: &str) {
    let mut entries: Vec<_> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap()).collect();
    entries.sort_by_key(std::fs::DirEntry::file_name);
    for entry in entries {
        let name = format!("{prefix}{}", entry.file_name().to_str().unwrap());
        let options = zip::write::SimpleFileOptions::default();
        if entry.path().is_dir() {
            archive.add_directory(format!("{name}/"), options).unwrap();
            pack(archive, &entry.path(), &format!("{name}/"));
        } else {
            archive.start_file(name, options).unwrap();
            archive.write_all(&std::fs::read(entry.path()).unwrap()).unwrap();
        }
    }
}
