//! The files of an FMU: documentation, licence, sources, and files that don't belong there.

use super::finding::{Findings, Place};
use super::head::of_file;
use super::model::Model;
use super::rules::{
    FILES_DOCUMENTATION, FILES_IMPLEMENTATION, FILES_LICENCE, FILES_LICENCE_ENTRY, FILES_UNKNOWN,
    SOURCES_BUILD, SOURCES_FILES, SOURCES_IDENTIFIER,
};
use octant_fmu_host::archive::Archive;
use octant_fmu_host::description::xml::Element;
use std::collections::BTreeSet;

/// Description of the sources in FMI 3.0.
pub(super) const BUILD_DESCRIPTION: &str = "sources/buildDescription.xml";

/// Checks the list of files.
pub(super) fn check(model: &Model<'_, '_>, archive: &Archive, findings: &mut Findings) {
    let binaries = archive.contains_below("binaries/");
    let sources = archive.contains_below("sources/");
    if !binaries && !sources {
        let found = "neither binaries/ nor sources/";
        findings.add(&FILES_IMPLEMENTATION, Place::default(), found, "one of both");
    }
    if !archive.contains("documentation/index.html") {
        let found = "no documentation/index.html";
        findings.add(&FILES_DOCUMENTATION, Place::default(), found, "documentation for users");
    }
    if !archive.contains_below("documentation/licenses/") {
        let found = "nothing in documentation/licenses/";
        findings.add(&FILES_LICENCE, Place::default(), found, "the licences of what is inside");
    } else if !model.is_fmi2()
        && !["txt", "html", "spdx"]
            .iter()
            .any(|end| archive.contains(&format!("documentation/licenses/license.{end}")))
    {
        let found = "no entry point in documentation/licenses/";
        findings.add(&FILES_LICENCE_ENTRY, Place::default(), found, "license.txt, .html or .spdx");
    }
    let mut seen = BTreeSet::new();
    for entry in archive.entries() {
        let top = entry.name.split('/').next().unwrap_or_default();
        let known = match top {
            "modelDescription.xml"
            | "documentation"
            | "sources"
            | "binaries"
            | "resources"
            | "extra"
            | "terminalsAndIcons" => true,
            "model.png" | "licenses" => model.is_fmi2(),
            _ => false,
        };
        if !known && seen.insert(top) {
            let place = of_file(top, "");
            findings.add(
                &FILES_UNKNOWN,
                place,
                "a file or folder of no meaning",
                "extra/ for others",
            );
        }
    }
    if model.is_fmi2() {
        listed_sources(model, archive, findings);
    } else if sources && !archive.contains(BUILD_DESCRIPTION) {
        let place = of_file("sources/", "");
        findings.add(&SOURCES_BUILD, place, "no buildDescription.xml", "what is built of them");
    }
}

/// Returns whether a file is there that is named from `sources/`, with `.` and `..` among the parts of its name.
fn has_source(archive: &Archive, name: &str) -> bool {
    let mut parts = vec!["sources"];
    for part in name.split('/') {
        match part {
            "" | "." => {}
            ".." if parts.pop().is_none() => return false,
            ".." => {}
            part => parts.push(part),
        }
    }
    archive.contains(&parts.join("/"))
}

/// Checks the source files that the description of FMI 2.0 lists.
fn listed_sources(model: &Model<'_, '_>, archive: &Archive, findings: &mut Findings) {
    for interface in model.root.children() {
        for file in interface.child("SourceFiles").into_iter().flat_map(Element::children) {
            let Some(name) = file.text("name") else { continue };
            if !has_source(archive, name) {
                let place = model.at(file, name);
                findings.add(&SOURCES_FILES, place, format!("no sources/{name}"), "the file");
            }
        }
    }
}

/// Checks `buildDescription.xml` against the files and the description.
pub(super) fn build_description(
    model: &Model<'_, '_>,
    root: Element<'_, '_>,
    archive: &Archive,
    findings: &mut Findings,
) {
    let identifiers: BTreeSet<&str> =
        model.root.children().filter_map(|element| element.text("modelIdentifier")).collect();
    let mut platforms = BTreeSet::new();
    for configuration in root.children().filter(|child| child.name() == "BuildConfiguration") {
        let identifier = configuration.text("modelIdentifier").unwrap_or_default();
        let at = |element: Element<'_, '_>| Some(element.line());
        let place =
            |element, subject| Place { entry: BUILD_DESCRIPTION, line: at(element), subject };
        if !identifiers.contains(identifier) {
            let found = format!("model identifier {identifier:?}");
            let expected = identifiers.iter().copied().collect::<Vec<_>>().join(" or ");
            findings.add(&SOURCES_IDENTIFIER, place(configuration, identifier), found, expected);
        }
        let platform = configuration.text("platform");
        if !platforms.insert((identifier, platform)) {
            let found =
                format!("a second configuration for {}", platform.unwrap_or("any platform"));
            findings.add(&SOURCES_IDENTIFIER, place(configuration, identifier), found, "one");
        }
        for set in configuration.children().filter(|child| child.name() == "SourceFileSet") {
            for file in set.children().filter(|child| child.name() == "SourceFile") {
                let Some(name) = file.text("name") else { continue };
                if !has_source(archive, name) {
                    let found = format!("no sources/{name}");
                    findings.add(&SOURCES_FILES, place(file, name), found, "the file");
                }
            }
        }
    }
}
