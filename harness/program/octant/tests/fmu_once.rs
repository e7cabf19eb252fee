//! A run opens an FMU once: the opening that is checked, described and hashed is the one that runs, and each method has
//! one instance of it.

use crate::common::foreign;
use crate::common::program::{ended, json, program};
use crate::fmu_source::{core, imu};
use octant_base::hash::sha256;
use octant_fmu_bind::OpenedFmus;
use octant_run::Prepared;
use octant_scenario::Scenario;
use std::path::{Path, PathBuf};

/// Copies a foreign FMU, so that no other test opens it.
fn copy(name: &str, folder: &Path) -> PathBuf {
    let path = folder.join(format!("{name}.fmu"));
    std::fs::copy(foreign::fmu(name), &path).unwrap();
    path
}

/// Writes a scenario of less than a minute, with its FMU in a folder.
fn scenario(name: &str, folder: &Path) -> PathBuf {
    let fmu = copy(name, folder);
    let text = match name {
        "imu_fmi2" => imu("").replace("4 min", "20 s"),
        "core_fmi2" => core("").replace("60 s", "20 s").replace("12 s", "2 s"),
        _ => "schema = 1\n[motion]\nkind = \"dockside\"\nheading = \"30 deg\"\n\
              [procedure.calibration]\nduration = \"10 s\"\nstops = [{}]\n[source]\nuri = \"fmu:FMU\"\n\
              [source.fmu]\nstep = \"10 ms\"\n[source.fmu.map]\n\
              case.roll = { variable = \"x0\", unit = \"deg\" }\n"
            .to_owned(),
    };
    let shared = foreign::fmu(name);
    let text = text.replace(shared.to_str().unwrap(), fmu.to_str().unwrap());
    let path = folder.join("s.toml");
    std::fs::write(&path, text.replace("FMU", fmu.to_str().unwrap())).unwrap();
    path
}

/// A fault that alters one sample, for a run with a twin.
const SPIKE: &str = "[[faults]]\nid = \"s\"\nkind = \"spike\"\nchannels = \"gyro x\"\n\
    amplitude = \"1000 deg/h\"\ntrigger = { at = \"5 s\" }\nduration = \"1 s\"\n";

/// The kernel's counts of what happens to files.
#[cfg(target_os = "linux")]
mod counting {
    use rustix::fs::inotify::{self, CreateFlags, ReadFlags, WatchFlags};
    use std::mem::MaybeUninit;
    use std::os::fd::OwnedFd;
    use std::path::Path;

    pub(super) struct Counter(OwnedFd);

    impl Counter {
        /// Counts the openings of a file.
        pub(super) fn openings(path: &Path) -> Self {
            // Equal events in succession are merged: reads and closings part the openings.
            Self::of(path, WatchFlags::OPEN | WatchFlags::ACCESS | WatchFlags::CLOSE)
        }

        /// Counts the folders and files that are made in a folder.
        pub(super) fn creations(path: &Path) -> Self {
            Self::of(path, WatchFlags::CREATE)
        }

        fn of(path: &Path, flags: WatchFlags) -> Self {
            let inotify = inotify::init(CreateFlags::NONBLOCK | CreateFlags::CLOEXEC).unwrap();
            inotify::add_watch(&inotify, path, flags).unwrap();
            Self(inotify)
        }

        /// Number of openings.
        pub(super) fn opened(&self) -> usize {
            self.count(ReadFlags::OPEN, "")
        }

        /// Number of creations of files whose name begins like this.
        pub(super) fn created(&self, name: &str) -> usize {
            self.count(ReadFlags::CREATE, name)
        }

        fn count(&self, kind: ReadFlags, name: &str) -> usize {
            let mut buffer = [MaybeUninit::uninit(); 1 << 14];
            let mut events = inotify::Reader::new(&self.0, &mut buffer);
            let mut count = 0;
            while let Ok(event) = events.next() {
                assert!(!event.events().contains(ReadFlags::QUEUE_OVERFLOW), "events were lost");
                let named = event.file_name().map_or("", |name| name.to_str().unwrap());
                count += usize::from(event.events().contains(kind) && named.starts_with(name));
            }
            count
        }
    }
}

/// Runs the program; returns how often it opened the file, and how many instances it made.
#[cfg(target_os = "linux")]
fn counts(arguments: &[&str], file: &Path, status: &[i32]) -> (usize, usize) {
    use counting::Counter;
    let temporary = tempfile::tempdir().unwrap();
    let (openings, instances) = (Counter::openings(file), Counter::creations(temporary.path()));
    let output = program(arguments).env("TMPDIR", temporary.path()).output().unwrap();
    let found = output.status.code().unwrap();
    assert!(status.contains(&found), "{found}: {}", String::from_utf8_lossy(&output.stderr));
    // Each instance has an unpacked folder of its own.
    (openings.opened(), instances.created("octant-fmu-"))
}

/// A source, a source that moves the plant, and a core.
#[cfg(target_os = "linux")]
#[test]
fn a_run_opens_an_fmu_once_and_starts_it_once() {
    for name in ["imu_fmi2", "vanderpol_fmi2", "core_fmi2"] {
        let folder = tempfile::tempdir().unwrap();
        let file = scenario(name, folder.path());
        let (file, out) = (file.to_str().unwrap(), folder.path().join("run"));
        let run = ["run", file, "--out", out.to_str().unwrap()];
        let fmu = folder.path().join(format!("{name}.fmu"));
        assert_eq!(counts(&run, &fmu, &[0, 1, 3]), (1, 1), "{name}");
        assert_eq!(json(&out.join("manifest.json"))["fmus"][0]["sha256"], sha256(&fmu).unwrap());
    }
}

/// A twin has an instance of its own, of the same opening.
#[cfg(target_os = "linux")]
#[test]
fn a_run_and_its_twin_share_the_opening() {
    let folder = tempfile::tempdir().unwrap();
    let file = scenario("core_fmi2", folder.path());
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, text + SPIKE).unwrap();
    let (file, out) = (file.to_str().unwrap(), folder.path().join("run"));
    let run = ["run", file, "--out", out.to_str().unwrap()];
    let fmu = folder.path().join("core_fmi2.fmu");
    assert_eq!(counts(&run, &fmu, &[0, 1, 3]), (1, 2));
}

/// Two components of a system with the same file.
#[cfg(target_os = "linux")]
#[test]
fn a_system_opens_each_file_once() {
    let folder = tempfile::tempdir().unwrap();
    let resources = folder.path().join("resources");
    std::fs::create_dir(&resources).unwrap();
    let fmu = copy("gain_fmi2", &resources);
    let component =
        |name: &str| format!("<Component name=\"{name}\" source=\"resources/gain_fmi2.fmu\"/>");
    let text = format!(
        "<SystemStructureDescription version=\"1.0\" name=\"twice\" \
         xmlns=\"http://ssp-standard.org/SSP1/SystemStructureDescription\"><System name=\"s\"><Elements>\
         {}{}</Elements></System></SystemStructureDescription>",
        component("a"),
        component("b")
    );
    std::fs::write(folder.path().join("SystemStructure.ssd"), text).unwrap();
    let (path, out) = (folder.path().to_str().unwrap(), folder.path().join("run"));
    let run = ["run", path, "--step", "10 ms", "--stop", "1 s", "--out", out.to_str().unwrap()];
    assert_eq!(counts(&run, &fmu, &[0]), (1, 2));
    let manifest = json(&out.join("manifest.json"));
    for number in 0..2 {
        assert_eq!(manifest["fmus"][number]["sha256"], sha256(&fmu).unwrap(), "{manifest}");
    }
}

/// Whatever becomes of the file after the opening: the manifest has the hash of the FMU that runs.
#[test]
fn a_file_that_is_overwritten_after_its_opening_changes_nothing() {
    for (name, faults) in [("imu_fmi2", ""), ("vanderpol_fmi2", ""), ("core_fmi2", SPIKE)] {
        let folder = tempfile::tempdir().unwrap();
        let file = scenario(name, folder.path());
        let text = std::fs::read_to_string(&file).unwrap();
        let role = if text.contains("[source.fmu") { "source" } else { "endpoint" };
        std::fs::write(&file, text + faults).unwrap();
        let shared = format!("{role}.fmu.process=shared");
        let scenario = Scenario::load(&file, &[shared]).unwrap_or_else(|e| panic!("{e}"));
        let fmu = folder.path().join(format!("{name}.fmu"));
        let (hash, fmus) = (sha256(&fmu).unwrap(), OpenedFmus::default());
        let facts = octant_evidence::fmus(&scenario, 1, &fmus).unwrap();
        assert_eq!(facts[0].sha256.as_ref(), Some(&hash));
        // In place, as a build does that writes its FMU anew.
        std::fs::write(&fmu, "another").unwrap();
        let prepared = Prepared::of(&scenario, 1, true, &fmus).unwrap_or_else(|e| panic!("{e}"));
        let runs = prepared.run(folder.path()).unwrap_or_else(|e| panic!("{e}"));
        assert!(runs[0].bench.broken.is_none() && runs[0].recorder.epochs > 0);
        assert_eq!(runs[0].twin.is_some(), !faults.is_empty());
        assert_eq!(octant_evidence::fmus(&scenario, 1, &fmus).unwrap()[0].sha256, Some(hash));
        // Another run opens the file again.
        let error = Prepared::of(&scenario, 1, false, &OpenedFmus::default()).unwrap_err();
        assert!(error.to_string().contains("is no zip archive"), "{error}");
    }
}

/// A second method and a twin need instances of their own, of which a process can hold one.
#[test]
fn a_process_that_can_hold_one_instance_is_not_asked_for_two() {
    let folder = tempfile::tempdir().unwrap();
    let once = foreign::altered("core_fmi2", "int nothing;", &[]);
    let xml = once.path().join("modelDescription.xml");
    let text = std::fs::read_to_string(&xml).unwrap();
    let once_per_process = "<CoSimulation canBeInstantiatedOnlyOncePerProcess=\"true\" ";
    let changed = text.replace("<CoSimulation ", once_per_process);
    assert_ne!(changed, text);
    std::fs::write(xml, changed).unwrap();
    let shared = "[endpoint.fmu]\nprocess = \"shared\"\n";
    let file = scenario("core_fmi2", folder.path());
    let text = std::fs::read_to_string(&file).unwrap().replace("[endpoint.fmu]\n", shared);
    let fmu = folder.path().join("core_fmi2.fmu");
    let text = text.replace(fmu.to_str().unwrap(), once.path().to_str().unwrap());
    std::fs::write(&file, text + SPIKE).unwrap();
    let run = |more: &[&str], status: i32| {
        let arguments = [&["run", file.to_str().unwrap(), "--out", "run"], more].concat();
        ended(program(&arguments).current_dir(&folder).output().unwrap(), status).1
    };
    let error = run(&[], 2);
    let expected = "failed to run 2 instances of ";
    assert!(error.contains(expected) && error.contains("expected process = \"own\""), "{error}");
    assert!(!folder.path().join("run").exists());
    run(&["--no-twin"], 3);
}
