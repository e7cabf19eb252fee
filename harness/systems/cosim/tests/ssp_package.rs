//! Sources of components stay within their package.

use octant_cosim::ssp::package::{Package, STRUCTURE};

#[test]
fn a_loose_structure_has_the_files_around_it() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["system", "models"] {
        std::fs::create_dir(folder.path().join(name)).unwrap();
    }
    std::fs::write(folder.path().join("models/plant.fmu"), "x").unwrap();
    let structure = folder.path().join("system/loop.ssd");
    std::fs::write(&structure, "<x/>").unwrap();
    let package = Package::open(&structure).unwrap();
    let found = package.resolve("../models/plant.fmu").unwrap();
    assert!(found.is_file(), "{}", found.display());
    // A name in a message is that of a file.
    assert!(std::path::Path::new(&package.name_of(&found)).is_file());
    let beside = folder.path().join("system/values.ssv");
    std::fs::write(&beside, "<x/>").unwrap();
    assert_eq!(
        package.name_of(&package.resolve("values.ssv").unwrap()),
        beside.display().to_string()
    );
    let error = package.resolve("../models/absent.fmu").unwrap_err().to_string();
    assert!(error.contains("there is none of this name"), "{error}");
}

#[test]
fn sources_stay_within_the_package() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("resources")).unwrap();
    std::fs::write(folder.path().join("resources/my plant.fmu"), "x").unwrap();
    std::fs::write(folder.path().join(STRUCTURE), "<x/>").unwrap();
    let package = Package::open(folder.path()).unwrap();
    let inside = folder.path().join("resources/my plant.fmu");
    for source in ["resources/my%20plant.fmu", "./resources//my plant.fmu"] {
        assert_eq!(package.resolve(source).unwrap(), inside, "{source}");
    }
    for (source, reason) in [
        ("../secret.fmu", "leads out"),
        ("resources/%2e%2e/%2e%2e/secret.fmu", "leads out"),
        ("/etc/passwd", "expected a file of the package"),
        ("file:///etc/passwd", "expected a file of the package"),
        ("https://example.com/x.fmu", "expected a file of the package"),
        ("resources\\x.fmu", "expected a file of the package"),
        ("resources/x%2.fmu", "% signs"),
        ("resources/absent.fmu", "there is none of this name"),
        ("#other", "parts of other files"),
    ] {
        let error = package.resolve(source).unwrap_err().to_string();
        assert!(error.contains(reason), "{source}: {error}");
    }
}
