//! Checks an FMU by the rules of FMI 2.0 and FMI 3.0.
//!
//! [`check`] reads its archive, its descriptions and its libraries, and runs no code of it.
//! [`load::load`] runs its code, in a process of its own.
//!
//! | module | idea |
//! |---|---|
//! | [`rules`] | the rules, each with its severity and its clause |
//! | [`finding`] | findings and their places |
//! | `model` | a description together with the text of its file |
//! | `head` | interfaces, log categories, default experiment |
//! | `units` | units, types, enumerations |
//! | [`names`] | names and their grammar |
//! | `variables` | causality, variability, initial, start, limits |
//! | `references` | aliases, arrays, clocked variables |
//! | `clocks` | clocks |
//! | `structure` | outputs, derivatives, initial unknowns, dependencies |
//! | `terminals` | terminals and icons |
//! | `bus` | layered standards, and FMUs on a bus |
//! | `files` | documentation, licence, sources |
//! | [`binaries`] | shared libraries, read without running them |
//! | `elf` | checks specific to Linux libraries |
//! | [`functions`] | functions that the libraries have to export |
//! | [`load`] | the library loaded, an instance made and stepped |
//! | [`show`] | findings as text |

pub mod binaries;
mod binary;
mod bus;
mod clocks;
mod elf;
mod files;
pub mod finding;
pub mod functions;
mod head;
pub mod load;
mod model;
pub mod names;
mod references;
pub mod rules;
pub mod show;
mod structure;
mod terminals;
mod text;
mod units;
mod variables;

pub use head::is_c_identifier;

use binaries::LibraryProperties;
use finding::{Finding, Findings, Place};
use model::Model;
use octant_fmu_host::archive::{Archive, ArchiveError, ArchiveLimits};
use octant_fmu_host::description::schema::{self, Breaks, ElementRule, Violation};
use octant_fmu_host::description::xml::{Element, File};
use octant_fmu_host::description::{Description, Standard, is_of_fmi_1, of_fmi_1, read};
use octant_fmu_host::library::platforms;
use rules::Severity;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;
use text::text;

/// Description inside an FMU.
const DESCRIPTION: &str = "modelDescription.xml";

/// Result of a check.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// File name of the FMU.
    pub file: String,
    /// `fmiVersion`, if it can be read.
    pub fmi_version: Option<String>,
    /// `modelName`, if it can be read.
    pub model_name: Option<String>,
    /// Number of variables.
    pub variables: usize,
    /// Properties of the libraries.
    pub binaries: Vec<LibraryProperties>,
    /// Findings, worst first.
    pub findings: Vec<Finding>,
    /// Number of further findings of each rule that has too many.
    pub more: BTreeMap<&'static str, usize>,
}

impl Report {
    /// Number of findings of a severity.
    #[must_use]
    pub fn count(&self, severity: Severity) -> usize {
        let more: usize = rules::RULES
            .iter()
            .filter(|rule| rule.severity == severity)
            .filter_map(|rule| self.more.get(rule.id))
            .sum();
        more + self.findings.iter().filter(|finding| finding.rule.severity == severity).count()
    }
}

/// An FMU that was checked, ready for further checks.
pub struct Checked {
    /// Archive.
    pub archive: Archive,
    /// Description, if it can be read.
    pub description: Option<Description>,
    file: String,
    binaries: Vec<LibraryProperties>,
    findings: Findings,
}

impl Checked {
    /// Returns whether the FMU has a library for this machine, and its archive can be unpacked.
    #[must_use]
    pub fn can_be_loaded(&self) -> bool {
        let Some(description) = &self.description else { return false };
        let here = platforms(description.standard);
        let is_here = |binary: &LibraryProperties| {
            here.iter().any(|platform| binary.entry.starts_with(&format!("binaries/{platform}/")))
        };
        self.archive.problems().is_empty() && self.binaries.iter().any(is_here)
    }

    /// Makes the report of all findings.
    #[must_use]
    pub fn report(self) -> Report {
        let (findings, more) = self.findings.finish();
        let description = self.description.as_ref();
        Report {
            file: self.file,
            fmi_version: description.map(|description| description.fmi_version.clone()),
            model_name: description.map(|description| description.model_name.clone()),
            variables: description.map_or(0, |description| description.variables.len()),
            binaries: self.binaries,
            findings,
            more,
        }
    }
}

/// Checks an FMU: a file, or a folder with its unpacked content. No code of it is run.
///
/// # Errors
/// If it is no archive, or has no description.
pub fn check(path: &Path) -> Result<Checked, ArchiveError> {
    let mut checked = check_archive(Archive::survey(path, ArchiveLimits::DEFAULT)?)?;
    let is_fmu = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("fmu"));
    if !is_fmu && !checked.archive.is_folder() {
        let found = format!("{:?}", path.file_name().unwrap_or_default());
        checked.findings.add(&rules::ARCHIVE_EXTENSION, Place::default(), found, "a name in .fmu");
    }
    Ok(checked)
}

/// Checks an open FMU.
///
/// # Errors
/// If it has no description.
pub fn check_archive(mut archive: Archive) -> Result<Checked, ArchiveError> {
    let mut findings = Findings::default();
    let bytes = archive.read(DESCRIPTION)?;
    let file = archive.file().to_owned();
    let mut binaries = Vec::new();
    if is_of_fmi_1(&bytes) {
        let error = of_fmi_1(DESCRIPTION);
        let place = Place { entry: DESCRIPTION, subject: &error.place, ..Place::default() };
        findings.add(&rules::DESCRIPTION_READABLE, place, error.found, error.expected);
        return Ok(Checked { archive, description: None, file, binaries, findings });
    }
    let description = text(DESCRIPTION, &bytes, &mut findings).and_then(|text| {
        with_description(&text, &mut findings, |model, findings| {
            others(model, &mut archive, findings);
            binaries = binaries::check(model, &mut archive, findings);
        })
    });
    archive_findings(&archive, &mut findings);
    Ok(Checked { archive, description, file, binaries, findings })
}

/// Checks a description alone.
#[must_use]
pub fn check_description(text: &str) -> (Option<Description>, Vec<Finding>) {
    let mut findings = Findings::default();
    let description = with_description(text, &mut findings, |_, _| {});
    (description, findings.finish().0)
}

/// Checks a description; `then` continues with the parts that depend on it.
fn with_description(
    text: &str,
    findings: &mut Findings,
    then: impl FnOnce(&Model<'_, '_>, &mut Findings),
) -> Option<Description> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let file = File::new(DESCRIPTION, text);
    let place = Place { entry: DESCRIPTION, ..Place::default() };
    let unreadable = |findings: &mut Findings,
                      error: octant_fmu_host::description::DescriptionError| {
        let place = Place { line: error.line, subject: &error.place, ..place };
        findings.add(&rules::DESCRIPTION_READABLE, place, error.found, error.expected);
    };
    let document = match file.parse(text) {
        Ok(document) => document,
        Err(error) => {
            unreadable(findings, error);
            return None;
        }
    };
    let root = Element::root(&file, &document);
    // The rest depends on the version.
    let standard = match root.text("fmiVersion").map(str::trim) {
        Some(version) if version.starts_with("2.") => Some(Standard::Fmi2),
        Some(version) if version.starts_with("3.") => Some(Standard::Fmi3),
        _ => None,
    };
    if let Some(standard) = standard {
        findings.of(standard);
        let node = match standard {
            Standard::Fmi2 => &schema::FMI2,
            Standard::Fmi3 => &schema::FMI3,
        };
        follow_schema(DESCRIPTION, root, node, findings);
    }
    let description = match read(text, DESCRIPTION) {
        Ok(description) => description,
        Err(error) => {
            // A value that breaks the schema is reported only once.
            if !findings.has_errors() {
                unreadable(findings, error);
            }
            return None;
        }
    };
    let model = Model::new(DESCRIPTION, &description, root);
    head::check(&model, findings);
    units::check(&model, findings);
    names::check(&model, findings);
    variables::check(&model, findings);
    references::check(&model, findings);
    clocks::check(&model, findings);
    structure::check(&model, findings);
    then(&model, findings);
    Some(description)
}

/// Turns violations of a schema into findings.
fn follow_schema(entry: &str, root: Element<'_, '_>, node: &ElementRule, findings: &mut Findings) {
    schema::walk(root, node, &mut |Violation { breaks, line, place, found, expected }| {
        let rule = match breaks {
            Breaks::UnknownElement => &rules::SCHEMA_ELEMENT,
            Breaks::UnknownAttribute => &rules::SCHEMA_ATTRIBUTE,
            Breaks::MissingElement => &rules::SCHEMA_MISSING_ELEMENT,
            Breaks::MissingAttribute => &rules::SCHEMA_MISSING_ATTRIBUTE,
            Breaks::Order => &rules::SCHEMA_ORDER,
            Breaks::Repeated => &rules::SCHEMA_REPEATED,
            Breaks::Value => &rules::SCHEMA_VALUE,
        };
        let place = Place { entry, line: Some(line), subject: &place };
        findings.add(rule, place, found, expected);
    });
}

/// Turns problems of the archive itself into findings.
fn archive_findings(archive: &Archive, findings: &mut Findings) {
    for problem in archive.problems() {
        let place = Place { entry: &problem.name, ..Place::default() };
        findings.add(&rules::ARCHIVE_NAME, place, &problem.found, problem.expected);
    }
    for oddity in archive.oddities() {
        use octant_fmu_host::archive::Oddity;
        let place = Place { entry: &oddity.entry, ..Place::default() };
        let (rule, found, expected) = match oddity.what {
            Oddity::Version(version) => (
                &rules::ARCHIVE_VERSION,
                format!("it needs version {}.{}", version / 10, version % 10),
                "at most 2.0",
            ),
            Oddity::Descriptor => (
                &rules::ARCHIVE_DESCRIPTOR,
                "the size of a stored entry comes after it".to_owned(),
                "the size in the header",
            ),
            Oddity::Unmarked => (
                &rules::ARCHIVE_ENCODING,
                "a name beyond ASCII without the mark of UTF-8".to_owned(),
                "bit 11 of the flags",
            ),
            Oddity::Windows(ref found) => {
                (&rules::ARCHIVE_WINDOWS, found.clone(), "a name that every system can hold")
            }
            Oddity::Duplicate => (
                &rules::ARCHIVE_DUPLICATE,
                "the same entry is there twice".to_owned(),
                "one entry of a name",
            ),
            Oddity::Headers(ref reason) => {
                (&rules::ARCHIVE_HEADERS, reason.clone(), "the same as in the directory")
            }
        };
        findings.add(rule, place, found, expected);
    }
}

/// Checks the other XML files, and the list of files.
fn others(model: &Model<'_, '_>, archive: &mut Archive, findings: &mut Findings) {
    files::check(model, archive, findings);
    let has = |archive: &Archive| archive.entries().iter().map(|e| e.name.clone()).collect();
    let names: std::collections::BTreeSet<String> = has(archive);
    let manifest = match model.is_fmi2() {
        true => None,
        false => bus::manifests(archive, findings),
    };
    let terminals = xml(
        (terminals::FILE, &schema::TERMINALS_AND_ICONS, &rules::TERMINALS_READABLE),
        archive,
        findings,
        |root, _, findings| {
            terminals::check(model, root, &|name| names.contains(name), findings);
            bus::check(model, Some(root), manifest, findings);
        },
    );
    if terminals.is_none() {
        bus::check(model, None, manifest, findings);
    }
    if terminals.is_none() && names.iter().any(|name| name.starts_with("terminalsAndIcons/")) {
        let place = Place { entry: "terminalsAndIcons/", ..Place::default() };
        let found = "a folder without terminalsAndIcons.xml";
        findings.add(&rules::TERMINALS_READABLE, place, found, "the file");
    }
    if !model.is_fmi2() {
        xml(
            (files::BUILD_DESCRIPTION, &schema::BUILD_DESCRIPTION, &rules::SOURCES_BUILD),
            archive,
            findings,
            |root, archive, findings| files::build_description(model, root, archive, findings),
        );
    }
}

/// Reads another XML file, checks it by its schema, and continues with its root; `None`: the file
/// is missing.
fn xml(
    (entry, node, rule): (&str, &'static ElementRule, &'static rules::Rule),
    archive: &mut Archive,
    findings: &mut Findings,
    then: impl FnOnce(Element<'_, '_>, &Archive, &mut Findings),
) -> Option<()> {
    if !archive.contains(entry) {
        return None;
    }
    let place = Place { entry, ..Place::default() };
    let bytes = match archive.read(entry) {
        Ok(bytes) => bytes,
        Err(error) => {
            findings.add(&rules::ARCHIVE_READABLE, place, error.to_string(), "the file");
            return Some(());
        }
    };
    let Some(text) = text(entry, &bytes, findings) else { return Some(()) };
    let file = File::new(entry, &text);
    match file.parse(&text) {
        Ok(document) => {
            let root = Element::root(&file, &document);
            let mut broken = false;
            schema::walk(root, node, &mut |violation| {
                broken = true;
                let place =
                    Place { line: Some(violation.line), subject: &violation.place, ..place };
                findings.add(rule, place, violation.found, violation.expected);
            });
            if !broken {
                then(root, archive, findings);
            }
        }
        Err(error) => {
            let place = Place { line: error.line, subject: &error.place, ..place };
            findings.add(rule, place, error.found, error.expected);
        }
    }
    Some(())
}
