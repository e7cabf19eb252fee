//! Each rule is broken by a change of a description, or of an FMU, that breaks no other rule.

use cases::cases;
use dll::dll;
use octant_fmu_check::binaries::LibraryProperties;
use octant_fmu_check::finding::Finding;
use octant_fmu_check::rules::{self, RULES, Severity};
use octant_fmu_check::{Report, check_archive, check_description, show};
use octant_fmu_host::archive::{Archive, ArchiveLimits};
use std::collections::BTreeSet;
use std::io::{Cursor, Write};
use zip::write::{SimpleFileOptions, ZipWriter};

mod bus;
mod cases;
mod dll;

const GOOD2: &str = include_str!("broken_rules/good_fmi2.xml");
const GOOD3: &str = include_str!("broken_rules/good_fmi3.xml");

/// Edit of a text: the original part, which occurs once, and its replacement.
type Edit<'a> = (&'a str, &'a str);

fn edited(text: &str, edits: &[Edit<'_>]) -> String {
    let mut text = text.to_owned();
    for (from, to) in edits {
        assert!(text.matches(from).count() == 1, "{from:?} isn't there once");
        text = text.replace(from, to);
    }
    text
}

fn ids(findings: &[Finding]) -> Vec<&'static str> {
    let ids: BTreeSet<&str> = findings.iter().map(|finding| finding.rule.id).collect();
    ids.into_iter().collect()
}

/// Rules of the description that an edit breaks.
fn broken(good: &str, edits: &[Edit<'_>]) -> (Vec<&'static str>, Vec<Finding>) {
    let (_, findings) = check_description(&edited(good, edits));
    (ids(&findings), findings)
}

#[test]
fn good_descriptions_have_no_finding() {
    for good in [GOOD2, GOOD3] {
        let (description, findings) = check_description(good);
        assert!(findings.is_empty(), "{findings:#?}");
        assert_eq!(description.expect("is read").tolerated, [] as [&str; 0]);
    }
}

#[test]
fn an_fmu_of_fmi_1_has_one_finding() {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    zip.start_file("modelDescription.xml", SimpleFileOptions::default()).expect("starts");
    // The encoding would be another finding.
    zip.write_all(b"<fmiModelDescription fmiVersion=\"1.0\" modelName=\"\xb0\"/>").expect("writes");
    let bytes = zip.finish().expect("finishes").into_inner();
    let archive = Archive::survey_bytes("old.fmu", bytes, ArchiveLimits::DEFAULT).expect("opens");
    let report = check_archive(archive).expect("has a description").report();
    let found: Vec<String> =
        report.findings.iter().map(|one| format!("{}: {}", one.rule.id, one.found)).collect();
    let expected = "description.readable: an FMU of FMI 1.0, which this program doesn't run";
    assert_eq!(found, [expected]);
}

#[test]
fn a_change_that_breaks_one_rule_is_found_by_this_rule_alone() {
    let mut wrong = Vec::new();
    for (rule, good, edits, says) in cases() {
        let (ids, findings) = broken(good, &edits);
        let said = findings
            .iter()
            .any(|f| format!("{}: {}, expected {}", f.subject, f.found, f.expected).contains(says));
        if ids != [rule.id] || !said {
            let found: Vec<String> = findings
                .iter()
                .map(|f| {
                    format!("{} {}: {}, expected {}", f.rule.id, f.subject, f.found, f.expected)
                })
                .collect();
            wrong.push(format!("{} by {edits:?}, {says:?}: {found:#?}", rule.id));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The standard has co-simulation pass over the number of event indicators.
#[test]
fn event_indicators_are_ignored_in_co_simulation() {
    let edits = [(r#"<ModelExchange modelIdentifier="good"/>"#, ""), (r#" reinit="true""#, "")];
    let (ids, findings) = broken(GOOD2, &edits);
    assert_eq!(ids, [] as [&str; 0], "{findings:?}");
}

/// Files of an FMU without any finding.
fn files(description: &str) -> Vec<(&'static str, Vec<u8>)> {
    let mut files = vec![
        ("modelDescription.xml", description.as_bytes().to_vec()),
        ("documentation/index.html", b"<html/>".to_vec()),
        ("documentation/licenses/license.txt", b"MIT".to_vec()),
        ("sources/good.c", b"int x;".to_vec()),
        ("terminalsAndIcons/terminalsAndIcons.xml", TERMINALS.as_bytes().to_vec()),
        ("terminalsAndIcons/icon.png", b"png".to_vec()),
        ("terminalsAndIcons/plug.png", b"png".to_vec()),
        ("resources/data.txt", b"1".to_vec()),
    ];
    if description.contains("instantiationToken") {
        files.push(("sources/buildDescription.xml", BUILD.as_bytes().to_vec()));
    }
    files
}

const TERMINALS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiTerminalsAndIcons fmiVersion="3.0">
  <GraphicalRepresentation>
    <CoordinateSystem x1="-100" y1="-100" x2="100" y2="100" suggestedScalingFactorTo_mm="0.1"/>
    <Icon x1="-100" y1="-100" x2="100" y2="100"/>
  </GraphicalRepresentation>
  <Terminals>
    <Terminal name="plug" matchingRule="plug">
      <TerminalMemberVariable variableName="u" memberName="u" variableKind="signal"/>
      <TerminalMemberVariable variableName="x" memberName="x" variableKind="signal"/>
      <Terminal name="inner" matchingRule="sequence">
        <TerminalMemberVariable variableName="mode" variableKind="signal"/>
      </Terminal>
      <TerminalGraphicalRepresentation x1="0" y1="0" x2="1" y2="1" iconBaseName="plug"/>
    </Terminal>
  </Terminals>
</fmiTerminalsAndIcons>"#;

const BUILD: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiBuildDescription fmiVersion="3.0">
  <BuildConfiguration modelIdentifier="good">
    <SourceFileSet language="C99"><SourceFile name="good.c"/></SourceFileSet>
  </BuildConfiguration>
</fmiBuildDescription>"#;

fn packed(files: &[(&str, Vec<u8>)]) -> Vec<u8> {
    packed_by(SimpleFileOptions::default(), files)
}

/// Packs without compression, so that contents can be found in the archive.
fn stored(files: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let options = SimpleFileOptions::default();
    packed_by(options.compression_method(zip::CompressionMethod::Stored), files)
}

fn packed_by(options: SimpleFileOptions, files: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, contents) in files {
        writer.start_file(*name, options).expect("starts");
        writer.write_all(contents).expect("writes");
    }
    writer.finish().expect("finishes").into_inner()
}

fn survey(bytes: Vec<u8>) -> Report {
    let archive = Archive::survey_bytes("good.fmu", bytes, ArchiveLimits::DEFAULT).expect("opens");
    check_archive(archive).expect("is checked").report()
}

#[test]
fn good_fmus_have_no_finding() {
    for good in [GOOD2, GOOD3] {
        let report = survey(packed(&files(good)));
        assert!(report.findings.is_empty(), "{:#?}", report.findings);
    }
}

/// A change of the files of an FMU.
enum Change {
    /// Adds a file.
    Add(&'static str, &'static [u8]),
    /// Removes a file.
    Remove(&'static str),
    /// Edits a file.
    Edit(&'static str, &'static str, &'static str),
}

#[test]
fn a_change_of_a_file_is_found_by_one_rule() {
    use Change::{Add, Edit, Remove};
    use rules::*;
    const ICONS: &str = "terminalsAndIcons/terminalsAndIcons.xml";
    const BUILDS: &str = "sources/buildDescription.xml";
    let cases: Vec<(&Rule, &str, Vec<Change>)> = vec![
        (&FILES_DOCUMENTATION, GOOD2, vec![Remove("documentation/index.html")]),
        (&FILES_LICENCE, GOOD2, vec![Remove("documentation/licenses/license.txt")]),
        (
            &FILES_LICENCE_ENTRY,
            GOOD3,
            vec![
                Remove("documentation/licenses/license.txt"),
                Add("documentation/licenses/MIT", b"MIT"),
            ],
        ),
        (&FILES_UNKNOWN, GOOD3, vec![Add("stuff/x", b"")]),
        (&SOURCES_FILES, GOOD2, vec![Remove("sources/good.c"), Add("sources/other.c", b"")]),
        (&SOURCES_FILES, GOOD3, vec![Remove("sources/good.c")]),
        (&SOURCES_BUILD, GOOD3, vec![Remove(BUILDS)]),
        (&SOURCES_BUILD, GOOD3, vec![Edit(BUILDS, "<SourceFile name=\"good.c\"/>", "")]),
        (&SOURCES_IDENTIFIER, GOOD3, vec![Edit(BUILDS, "\"good\"", "\"bad\"")]),
        (&TERMINALS_READABLE, GOOD3, vec![Edit(ICONS, "matchingRule=\"plug\"", "")]),
        (&TERMINALS_READABLE, GOOD2, vec![Edit(ICONS, "</Terminals>", "")]),
        (&TERMINALS_READABLE, GOOD2, vec![Remove(ICONS)]),
        (&TERMINALS_VERSION, GOOD3, vec![Edit(ICONS, "\"3.0\"", "\"3.1\"")]),
        (&TERMINALS_NAME, GOOD3, vec![Edit(ICONS, "memberName=\"x\"", "memberName=\"u\"")]),
        (&TERMINALS_MEMBER, GOOD3, vec![Edit(ICONS, "memberName=\"x\" ", "")]),
        (
            &TERMINALS_VARIABLE,
            GOOD2,
            vec![Edit(ICONS, "variableName=\"x\"", "variableName=\"xx\"")],
        ),
        (
            &TERMINALS_CAUSALITY,
            GOOD2,
            vec![Edit(ICONS, "variableName=\"x\"", "variableName=\"s\"")],
        ),
        (&TERMINALS_RULE, GOOD2, vec![Edit(ICONS, "\"sequence\"", "\"any\"")]),
        (&TERMINALS_ICON, GOOD2, vec![Remove("terminalsAndIcons/icon.png")]),
        (
            &TERMINALS_ICON,
            GOOD2,
            vec![Edit(ICONS, "iconBaseName=\"plug\"", "iconBaseName=\"../plug\"")],
        ),
        (&TERMINALS_ICON, GOOD2, vec![Remove("terminalsAndIcons/plug.png")]),
        (
            &DESCRIPTION_ENCODING,
            GOOD2,
            vec![Edit("modelDescription.xml", "encoding=\"UTF-8\"", "encoding=\"ISO-8859-1\"")],
        ),
        (&BINARY_NAME, GOOD2, vec![Add("binaries/linux64/bad.so", b"")]),
        (&BINARY_FORMAT, GOOD2, vec![Add("binaries/linux64/good.so", b"no library")]),
        (&BINARY_FOLDER, GOOD3, vec![Add("binaries/sparc-solaris/good.so", b"")]),
    ];
    for (rule, good, changes) in cases {
        let mut files = files(good);
        for change in &changes {
            match change {
                Add(name, contents) => files.push((name, contents.to_vec())),
                Remove(name) => {
                    assert!(files.iter().any(|(other, _)| other == name), "{name}");
                    files.retain(|(other, _)| other != name);
                }
                Edit(name, from, to) => {
                    let file = files.iter_mut().find(|(other, _)| other == name).expect("a file");
                    let text = String::from_utf8(file.1.clone()).expect("text");
                    file.1 = edited(&text, &[(from, to)]).into_bytes();
                }
            }
        }
        let report = survey(packed(&files));
        let found: Vec<&str> = ids(&report.findings)
            .into_iter()
            // The platform of the test machine decides about this rule.
            .filter(|id| *id != "binary.platform" || rule.id == *id)
            .collect();
        assert_eq!(found, [rule.id], "{:#?}", report.findings);
    }
    let mut files = files(GOOD2);
    files.retain(|(name, _)| !name.starts_with("sources/"));
    let found = ids(&survey(packed(&files)).findings);
    assert_eq!(found, ["files.implementation", "sources.files"]);
}

/// OpenModelica writes names of sources with `./` before them.
#[test]
fn names_of_sources_have_steps_between_folders() {
    for (name, expected) in [
        ("./good.c", &[][..]),
        ("../sources/./good.c", &[]),
        ("sub/good.c", &["sources.files"]),
        ("../../good.c", &["sources.files"]),
    ] {
        let mut files = files(GOOD2);
        let file = files.iter_mut().find(|(name, _)| *name == "modelDescription.xml").expect("it");
        let text = String::from_utf8(file.1.clone()).expect("text");
        let to = format!("<File name=\"{name}\"/>");
        file.1 = edited(&text, &[("<File name=\"good.c\"/>", &to)]).into_bytes();
        let found = ids(&survey(packed(&files)).findings);
        let found: Vec<&str> = found.into_iter().filter(|id| *id != "binary.platform").collect();
        assert_eq!(found, expected, "{name}");
    }
}

/// Replaces all occurrences of `from` in a zip.
fn patched(mut bytes: Vec<u8>, from: &[u8], to: &[u8]) -> Vec<u8> {
    let mut at = 0;
    while let Some(found) = bytes[at..].windows(from.len()).position(|window| window == from) {
        bytes[at + found..at + found + from.len()].copy_from_slice(to);
        at += found + from.len();
    }
    assert!(at > 0);
    bytes
}

#[test]
fn what_is_wrong_with_an_archive_is_found_and_the_rest_is_checked() {
    let good = packed(&files(GOOD2));
    let finding = |bytes: Vec<u8>| {
        let report = survey(bytes);
        assert_eq!(report.model_name.as_deref(), Some("Good"));
        ids(&report.findings)
    };
    let hostile = patched(good.clone(), b"resources/data.txt", b"../../../data1.txt");
    assert_eq!(finding(hostile), ["archive.name"]);
    let twice = patched(good.clone(), b"terminalsAndIcons/icon.png", b"terminalsAndIcons/plug.png");
    assert_eq!(finding(twice), ["archive.duplicate", "terminals.icon"]);
    let mut other = files(GOOD2);
    other.push(("sources/goods.c000", b"2".to_vec()));
    let differ = patched(packed(&other), b"resources/data.txt", b"sources/goods.c000");
    assert_eq!(finding(differ), ["archive.name"]);
    // Fields of the directory's last header: version needed, flags.
    let at = (0..good.len() - 4).rev().find(|&at| &good[at..at + 4] == b"PK\x01\x02").expect("one");
    let mut version = good.clone();
    version[at + 6] = 45;
    assert_eq!(finding(version), ["archive.version-needed"]);
    let device = patched(good.clone(), b"resources/data.txt", b"resources/nul::txt");
    assert_eq!(finding(device), ["archive.name-windows"]);
    let unmarked = patched(good.clone(), b"resources/data.txt", "resources/dät.txt".as_bytes());
    assert_eq!(finding(unmarked), ["archive.name-encoding"]);
    // A reader that uses the headers before the entries sees another file.
    let place = good.windows(18).position(|w| w == b"resources/data.txt").expect("the first");
    let mut two_faced = good.clone();
    two_faced[place..place + 18].copy_from_slice(b"resources/evil.txt");
    assert_eq!(finding(two_faced), ["archive.headers"]);
    let mut descriptor = stored(&files(GOOD2));
    let at = (0..descriptor.len() - 4)
        .rev()
        .find(|&at| &descriptor[at..at + 4] == b"PK\x01\x02")
        .expect("one");
    descriptor[at + 8] |= 1 << 3;
    let found = finding(descriptor);
    assert!(found.contains(&"archive.data-descriptor"), "{found:?}");
    // A damaged entry is detected when it is read.
    let damaged = patched(stored(&files(GOOD2)), b"iconBaseName", b"iconBaseNine");
    assert_eq!(finding(damaged), ["archive.readable"]);
}

#[test]
fn every_rule_that_a_description_can_break_has_a_case() {
    let tested: BTreeSet<&str> = cases().iter().map(|(rule, ..)| rule.id).collect();
    let elsewhere =
        ["archive.", "files.", "sources.", "terminals.", "layered.", "bus.", "binary.", "load."];
    for rule in RULES {
        let is_here = !elsewhere.iter().any(|start| rule.id.starts_with(start))
            && rule.id != "description.encoding";
        assert!(!is_here || tested.contains(rule.id), "no case breaks {}", rule.id);
    }
}

#[test]
fn units_that_fmi_has_no_exponents_for_are_no_finding() {
    for name in ["rad/s^(3/2)", "deg/sqrt(h)", "kg/kg"] {
        let unit = format!("<Unit name=\"{name}\"/><Unit name=\"m/s\">");
        let (ids, findings) = broken(GOOD2, &[("<Unit name=\"m/s\">", &unit)]);
        assert_eq!(ids, [] as [&str; 0], "{findings:?}");
    }
}

#[test]
fn many_findings_of_a_rule_are_counted() {
    let variables: String = (100..200)
        .map(|i| format!("<ScalarVariable name=\"v{i}\" valueReference=\"{i}\"><Real unit=\"x\"/></ScalarVariable>"))
        .collect();
    let text = edited(GOOD2, &[("</ModelVariables>", &format!("{variables}</ModelVariables>"))]);
    let mut all = files(GOOD2);
    all[0].1 = text.into_bytes();
    let report = survey(packed(&all));
    assert_eq!(report.findings.len(), 25);
    assert_eq!(report.count(Severity::Error), 100);
    assert_eq!(report.more.get("unit.defined"), Some(&75));
    let shown = show::text(&report);
    assert!(shown.contains("unit.defined: 75 more"), "{shown}");
    assert!(shown.ends_with("  100 errors, 0 warnings, 0 notes\n"), "{shown}");
}

#[test]
fn a_finding_says_where_and_why() {
    let mut all = files(GOOD2);
    all[0].1 = edited(GOOD2, &[("max=\"10\" start=\"0\"", "max=\"10\" start=\"11\"")]).into_bytes();
    let report = survey(packed(&all));
    assert_eq!(
        show::text(&report),
        "good.fmu: FMI 2.0, \"Good\", 14 variables\n  \
         error   modelDescription.xml:18 u: start 11, expected -10 to 10 \
         [variable.start-range; FMI 2.0, 2.2.7]\n  \
         1 error, 0 warnings, 0 notes\n"
    );
    let json = serde_json::to_value(&report).expect("is JSON");
    assert_eq!(
        json["findings"][0],
        serde_json::json!({
            "severity": "error",
            "rule": "variable.start-range",
            "entry": "modelDescription.xml",
            "line": 18,
            "subject": "u",
            "found": "start 11",
            "expected": "-10 to 10",
            "clause": "FMI 2.0, 2.2.7",
        })
    );
}

#[test]
fn a_finding_cites_the_clause_of_its_standard_and_interface() {
    let clauses = |good: &str, edits: &[Edit<'_>]| -> Vec<String> {
        let (_, findings) = broken(good, edits);
        findings.into_iter().map(|finding| finding.clause).collect()
    };
    // Before the version is known, both count.
    assert_eq!(clauses("", &[]), ["FMI 2.0, 2.2; FMI 3.0, 2.4"]);
    assert_eq!(clauses(GOOD3, &[("</ModelVariables>", "")]), ["FMI 2.0, 2.2; FMI 3.0, 2.4"]);
    let state = [(r#"canGetAndSetFMUstate="true""#, "")];
    assert_eq!(clauses(GOOD2, &state), ["FMI 2.0, 4.3.1"]);
    let identifiers = [
        (r#"<ModelExchange modelIdentifier="good""#, r#"<ModelExchange modelIdentifier="good-1""#),
        (r#"<CoSimulation modelIdentifier="good""#, r#"<CoSimulation modelIdentifier="good-1""#),
    ];
    assert_eq!(clauses(GOOD2, &identifiers), ["FMI 2.0, 3.3.1", "FMI 2.0, 4.3.1"]);
    assert_eq!(clauses(GOOD3, &[(r#"hasEventMode="true""#, "")]), ["FMI 3.0, 4.4"]);
    // The encoding is found wrong before the version is read.
    let mut all = files(GOOD3);
    all[0].1 = edited(GOOD3, &[("UTF-8", "ISO-8859-1")]).into_bytes();
    let report = survey(packed(&all));
    assert_eq!(ids(&report.findings), ["description.encoding"]);
    assert_eq!(report.findings[0].clause, "FMI 3.0, 2.4");
    // Terminals are of FMI 3.0 in an FMU of FMI 2.0 too.
    let mut all = files(GOOD2);
    let (_, terminals) = all.iter_mut().find(|(name, _)| name.ends_with("Icons.xml")).expect("one");
    *terminals = edited(TERMINALS, &[(r#""sequence""#, r#""any""#)]).into_bytes();
    assert_eq!(survey(packed(&all)).findings[0].clause, "FMI 3.0, 2.4.9.2");
}

/// Every rule has a section in each standard in which it can be broken, in the form of the standard.
#[test]
fn sections_have_the_form_of_their_standard() {
    let is_section = |text: &str| {
        text.split(", ").all(|part| {
            part.split('.').count() > 1 && part.split('.').all(|n| n.parse::<u8>().is_ok())
        })
    };
    for rule in RULES {
        for section in [rule.fmi2, rule.fmi3] {
            let of_bus = section.strip_prefix("FMI-LS-BUS 1.0.0, ");
            let known = section.is_empty()
                || section == "Octant"
                || is_section(section)
                || of_bus.is_some_and(|of| of.split('.').all(|n| n.parse::<u8>().is_ok()));
            assert!(known, "{}: {section:?}", rule.id);
        }
        assert!(!rule.fmi2.is_empty() || !rule.fmi3.is_empty(), "{}", rule.id);
        assert_eq!(rule.fmi2 == "Octant", rule.fmi3 == "Octant", "{}", rule.id);
    }
}

/// Functions of both interfaces of the description of FMI 2.0.
fn all_functions() -> Vec<&'static str> {
    octant_fmi::fmi2::NAMES.to_vec()
}

#[test]
fn a_library_for_windows_is_read() {
    let check = |folder: &str, bytes: Vec<u8>, more: &[(&'static str, Vec<u8>)]| {
        let name = format!("binaries/{folder}/good.dll");
        let mut files: Vec<(&str, Vec<u8>)> = files(GOOD2);
        files.push((&name, bytes));
        files.extend_from_slice(more);
        let report = survey(packed(&files));
        let text: Vec<String> = report
            .findings
            .iter()
            .filter(|finding| finding.rule.id != "binary.platform")
            .map(|finding| format!("{}: {}", finding.rule.id, finding.found))
            .collect();
        (report.binaries, text)
    };
    let all = all_functions();
    let (binaries, found) = check("win64", dll(&all, &["KERNEL32.dll"]), &[]);
    assert_eq!(found, [] as [&str; 0]);
    assert_eq!(
        binaries,
        [LibraryProperties {
            entry: "binaries/win64/good.dll".into(),
            format: "Pe".into(),
            architecture: "X86_64".into(),
            functions: all.len(),
            libraries: vec!["KERNEL32.dll".into()],
            glibc: None,
        }]
    );
    let fewer: Vec<&str> =
        all.iter().copied().filter(|name| !matches!(*name, "fmi2DoStep" | "fmi2SetTime")).collect();
    let (_, found) = check("win64", dll(&fewer, &[]), &[]);
    assert_eq!(found, ["binary.symbols: no fmi2SetTime, fmi2DoStep"]);
    let prefixed: Vec<String> = all.iter().map(|name| format!("good_{name}")).collect();
    let prefixed: Vec<&str> = prefixed.iter().map(String::as_str).collect();
    let (_, found) = check("win64", dll(&prefixed, &[]), &[]);
    let expected = "binary.symbols: good_fmi2GetTypesPlatform and others with a prefix, as in a static library";
    assert_eq!(found, [expected]);
    let fewer: Vec<&str> = all.iter().copied().filter(|name| *name != "fmi2CancelStep").collect();
    let (_, found) = check("win64", dll(&fewer, &[]), &[]);
    assert_eq!(found, ["binary.optional-symbols: no fmi2CancelStep"]);
    let (_, found) = check("win32", dll(&all, &[]), &[]);
    assert_eq!(found, ["binary.architecture: Pe for X86_64"]);
    let (_, found) = check("win64", dll(&all, &["VCRUNTIME140.dll", "extra.dll"]), &[]);
    assert_eq!(found, ["binary.libraries: it needs VCRUNTIME140.dll, extra.dll"]);
    let beside = [("binaries/win64/Extra.dll", Vec::new())];
    let (_, found) = check("win64", dll(&all, &["extra.dll"]), &beside);
    assert_eq!(found, [] as [&str; 0]);
}
