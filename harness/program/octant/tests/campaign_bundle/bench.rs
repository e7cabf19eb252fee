//! A campaign with files of its own, and its bundle.

use crate::common::program::{ended, octant_in};
use octant_dispatch::bundle::unpack::unpack;
use octant_fmu_build::{Options, build};
use std::io::{Cursor, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use tempfile::TempDir;
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

const TABLES: [&str; 3] = ["cases.parquet", "checks.parquet", "drift.parquet"];

pub(crate) const SCENARIO: &str = "schema = 1
title = \"short\"
[imu]
rate = \"20 Hz\"
[endpoint]
uri = \"fmu:../the models/core.fmu\"
[procedure.initial_parameters]
table = \"../earlier.octcal\"
[procedure.calibration]
positions = \"eight\"
duration = \"24 min\"
[procedure.navigation]
duration = \"10 min\"
[[requirements]]
id = \"NAV-1\"
text = \"It stays near.\"
measure = \"navigation.radial_error_nmi.max\"
limit = \"10 nmi\"
";

/// The second scenario has its FMU by an absolute name, set by the campaign.
fn campaign(core: &Path) -> String {
    format!(
        "schema = 1
title = \"bundled\"
replicates = 2
requirements = \"requirements.toml\"
[[scenarios]]
id = \"relative\"
file = \"scenarios/short.toml\"
[[scenarios]]
id = \"absolute\"
file = \"scenarios/short.toml\"
set = {{ \"endpoint.uri\" = \"fmu:{}\" }}
",
        core.display()
    )
}

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures/formats").join(name)
}

/// Our own FMU of the core, built once.
pub(crate) fn core() -> &'static [u8] {
    static CORE: OnceLock<Vec<u8>> = OnceLock::new();
    CORE.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        build(&Options { out: folder.path().to_owned(), ..Options::default() }).unwrap();
        std::fs::read(folder.path().join("calibrator_fmi3.fmu")).unwrap()
    })
}

/// The computer on which a campaign is planned, and any others.
pub(crate) struct Bench {
    pub(crate) folder: TempDir,
}

impl Bench {
    /// Writes the files of a campaign. Without `core` the FMU is a text, which can be planned and not run.
    pub(crate) fn new(core: &[u8], is_absolute: bool) -> Self {
        let bench = Self { folder: tempfile::tempdir().unwrap() };
        for folder in ["plan/scenarios", "plan/the models"] {
            std::fs::create_dir_all(bench.at(folder)).unwrap();
        }
        let fmu = bench.at("plan/the models/core.fmu");
        std::fs::write(&fmu, core).unwrap();
        std::fs::write(bench.at("plan/scenarios/short.toml"), SCENARIO).unwrap();
        let text = campaign(&fmu);
        let relative = text.split("[[scenarios]]\nid = \"absolute\"").next().unwrap().to_owned();
        let text = if is_absolute { text } else { relative };
        std::fs::write(bench.at("plan/campaign.toml"), text).unwrap();
        for (from, to) in [
            ("requirements.toml", "requirements.toml"),
            ("run/calibration.octcal", "earlier.octcal"),
        ] {
            std::fs::copy(fixture(from), bench.at("plan").join(to)).unwrap();
        }
        bench.octant(&["campaign", "plan", "plan/campaign.toml", "--out", "cert"], 0);
        bench
    }

    pub(crate) fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    #[track_caller]
    pub(crate) fn octant(&self, arguments: &[&str], status: i32) -> (String, String) {
        ended(octant_in(self.folder.path(), arguments), status)
    }

    pub(crate) fn bundled(&self) -> PathBuf {
        self.octant(&["campaign", "bundle", "cert", "--out", "cert.zip"], 0);
        self.at("cert.zip")
    }

    pub(crate) fn tables(&self, folder: &str) -> Vec<Vec<u8>> {
        TABLES.map(|table| std::fs::read(self.at(folder).join(table)).unwrap()).to_vec()
    }

    /// Unpacks, and checks that nothing is left where it is refused.
    #[track_caller]
    pub(crate) fn refusal(&self, bundle: &Path) -> String {
        let before = names(self.folder.path());
        let error = unpack(bundle, &self.at("refused")).unwrap_err().to_string();
        assert_eq!(names(self.folder.path()), before, "{error}");
        assert!(error.contains(&bundle.display().to_string()), "{error}");
        error
    }
}

pub(crate) fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Names and contents of the entries of a bundle.
pub(crate) type Entries = Vec<(String, Vec<u8>)>;

/// Entries of an archive in their order.
pub(crate) fn entries(bytes: &[u8]) -> Entries {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).unwrap();
    let count = archive.len();
    let one = |index| {
        let mut entry = archive.by_index(index).unwrap();
        let mut content = Vec::new();
        entry.read_to_end(&mut content).unwrap();
        (entry.name().unwrap().into_owned(), content)
    };
    (0..count).map(one).collect()
}

/// Writes a whole archive, as an editor of archives does: its checksums are right.
pub(crate) fn pack(path: &Path, entries: &[(String, Vec<u8>)]) {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in entries {
        archive.start_file(name.as_str(), SimpleFileOptions::default()).unwrap();
        archive.write_all(content).unwrap();
    }
    std::fs::write(path, archive.finish().unwrap().into_inner()).unwrap();
}
