//! FMUs of `fixtures/fmu/foreign`, compiled and packed.

use octant_fmu_host::description::Standard;
use octant_fmu_host::library::platforms;
use octant_test_processes::command;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Returns the folder with their sources.
pub(crate) fn sources() -> PathBuf {
    // Crates at several depths share this file.
    let mut above = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    let found = above.find_map(|folder| {
        let sources = folder.join("fixtures/fmu/foreign");
        sources.is_dir().then_some(sources)
    });
    found.expect("the repository has them")
}

/// Returns an unpacked FMU: a folder with the description and the library for this platform. It is
/// shared between tests, and no test writes there.
pub(crate) fn unpacked(name: &str) -> PathBuf {
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
pub(crate) fn fmu(name: &str) -> PathBuf {
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
    // Cargo's folder for files of tests; unit tests of a library aren't told it.
    let program = std::env::current_exe().unwrap();
    let target = program.ancestors().nth(3).expect("TARGET/PROFILE/deps/PROGRAM");
    let place =
        target.join("tmp/foreign").join(format!("{}-{name}", &hash.finalize().to_hex()[..16]));
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

pub(crate) fn pack(
    archive: &mut zip::ZipWriter<std::io::Cursor<Vec<u8>>>,
    folder: &Path,
    prefix: &str,
) {
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

/// Makes a copy of a foreign FMU's folder, with another description.
pub(crate) fn copy(name: &str, change: impl Fn(&str) -> String) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let from = unpacked(name);
    let text = std::fs::read_to_string(from.join("modelDescription.xml")).unwrap();
    std::fs::write(folder.path().join("modelDescription.xml"), change(&text)).unwrap();
    let platform = std::fs::read_dir(from.join("binaries")).unwrap().next().unwrap().unwrap();
    let binaries = folder.path().join("binaries").join(platform.file_name());
    std::fs::create_dir_all(&binaries).unwrap();
    for file in std::fs::read_dir(platform.path()).unwrap() {
        let file = file.unwrap();
        std::fs::copy(file.path(), binaries.join(file.file_name())).unwrap();
    }
    folder
}

/// Copies `signals_fmi3` without its clocks: then it may be run without event mode.
pub(crate) fn without_clocks() -> tempfile::TempDir {
    copy("signals_fmi3", |text| {
        let lines = text.lines().filter(|line| !line.contains("<Clock "));
        let text = lines.collect::<Vec<_>>().join("\n");
        let text = text.replace(" clocks=\"41\"", "").replace(" clocks=\"43\"", "");
        text.replace("<Output valueReference=\"41\"/>", "")
    })
}
