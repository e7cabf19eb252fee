//! `octant fmu check` on real libraries: foreign FMUs as they are, and with a library that was built
//! wrongly.
#![cfg(all(target_os = "linux", target_arch = "x86_64"))]
#![allow(clippy::unwrap_used)]

#[path = "common/foreign.rs"]
mod foreign;

use octant::fmu::check::{Report, check};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A folder with the FMU `gain_fmi2`, without its library, that one may change.
fn gain() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::Builder::new().suffix(".fmu").tempdir().unwrap();
    let description = foreign::sources().join("gain_fmi2.xml");
    std::fs::copy(description, folder.path().join("modelDescription.xml")).unwrap();
    let binaries = folder.path().join("binaries/linux64");
    std::fs::create_dir_all(&binaries).unwrap();
    (folder, binaries)
}

/// Compiles the FMU's source with more options.
fn compile(library: &Path, options: &[&str]) {
    let status = Command::new("gcc")
        .args(["-std=gnu11", "-O1", "-fPIC", "-shared", "-fvisibility=default"])
        .arg(foreign::sources().join("gain_fmi2.c"))
        .arg("-o")
        .arg(library)
        .args(options)
        .arg("-lm")
        .current_dir(library.parent().unwrap())
        .status()
        .unwrap();
    assert!(status.success());
}

/// Findings that are worse than notes: rule and what was found.
fn found(report: &Report) -> Vec<String> {
    report
        .findings
        .iter()
        .filter(|finding| finding.rule.severity > octant::fmu::check::rules::Severity::Note)
        .map(|finding| format!("{}: {}", finding.rule.id, finding.found))
        .collect()
}

/// What is found when the library is compiled with these options.
fn built(options: &[&str]) -> Vec<String> {
    let (folder, binaries) = gain();
    compile(&binaries.join("gain_fmi2.so"), options);
    found(&check(folder.path()).unwrap().report())
}

#[test]
fn foreign_fmus_have_no_finding_but_what_they_lack() {
    for name in foreign::NAMES {
        let report = check(&foreign::fmu(name)).unwrap().report();
        assert_eq!(found(&report), [] as [&str; 0], "{name}");
        let [binary] = &report.binaries[..] else { panic!("{:?}", report.binaries) };
        assert_eq!((&binary.format[..], &binary.architecture[..]), ("Elf", "X86_64"));
        assert!(binary.functions > 30, "{binary:?}");
        let notes = ["files.documentation", "files.licence", "variable.description"];
        for finding in &report.findings {
            assert!(notes.contains(&finding.rule.id), "{name}: {finding:?}");
        }
    }
}

#[test]
fn functions_that_are_missing_are_named() {
    let (folder, binaries) = gain();
    let script = folder.path().join("exports");
    std::fs::write(&script, "{ global: fmi2*; local: fmi2DoStep; fmi2Reset; };").unwrap();
    let option = format!("-Wl,--version-script={}", script.display());
    compile(&binaries.join("gain_fmi2.so"), &[&option]);
    std::fs::remove_file(script).unwrap();
    let report = check(folder.path()).unwrap().report();
    assert_eq!(found(&report), ["binary.symbols: no fmi2Reset, fmi2DoStep"]);
}

#[test]
fn an_executable_stack_is_found() {
    let found = built(&["-Wl,-z,execstack"]);
    assert_eq!(found, ["binary.executable-stack: PT_GNU_STACK is executable"]);
}

#[test]
fn libraries_that_it_needs_are_found() {
    let (folder, binaries) = gain();
    let extra = binaries.join("libextra.so");
    let source = folder.path().join("extra.c");
    std::fs::write(&source, "int extra(void) { return 1; }").unwrap();
    let made = Command::new("gcc").args(["-shared", "-fPIC", "-o"]).arg(&extra).arg(&source);
    assert!({ made }.status().unwrap().success());
    std::fs::remove_file(source).unwrap();
    let with = ["-Wl,--no-as-needed", "-L.", "-lextra"];
    let library = binaries.join("gain_fmi2.so");
    compile(&library, &with);
    let now = || found(&check(folder.path()).unwrap().report());
    assert_eq!(now(), ["binary.rpath: no RPATH"]);
    compile(&library, &[&with[..], &["-Wl,-rpath,/opt/lib"]].concat());
    assert_eq!(now(), ["binary.rpath: RPATH /opt/lib"]);
    compile(&library, &[&with[..], &["-Wl,-rpath,$ORIGIN"]].concat());
    assert_eq!(now(), [] as [&str; 0]);
    std::fs::remove_file(extra).unwrap();
    assert_eq!(now(), ["binary.libraries: it needs libextra.so"]);
}

#[test]
fn what_is_built_for_another_machine_is_found() {
    let (folder, binaries) = gain();
    let library = binaries.join("gain_fmi2.so");
    compile(&library, &[]);
    let good = std::fs::read(&library).unwrap();
    let now = |bytes: &[u8]| {
        std::fs::write(&library, bytes).unwrap();
        found(&check(folder.path()).unwrap().report())
    };
    // e_machine, at 18: AArch64; e_type, at 16: an object file.
    let mut other = good.clone();
    other[18] = 183;
    assert_eq!(now(&other), ["binary.architecture: Elf for Aarch64"]);
    let mut object = good.clone();
    object[16] = 1;
    assert_eq!(now(&object), ["binary.format: Relocatable"]);
    let cut = now(&good[..good.len() / 2]);
    assert!(cut[0].starts_with("binary.format: no library: "), "{cut:?}");
    std::fs::write(&library, &good).unwrap();
    std::fs::rename(&binaries, folder.path().join("binaries/darwin64")).unwrap();
    let found = found(&check(folder.path()).unwrap().report());
    assert_eq!(found, ["binary.name: gain_fmi2.so", "binary.platform: binaries for darwin64"]);
    std::fs::rename(
        folder.path().join("binaries/darwin64"),
        folder.path().join("binaries/x86_64-linux"),
    )
    .unwrap();
    let report = check(folder.path()).unwrap().report();
    let rules: Vec<&str> = report.findings.iter().map(|finding| finding.rule.id).collect();
    assert!(rules.contains(&"binary.folder") && !rules.contains(&"binary.platform"), "{rules:?}");
}

/// A function that came with glibc 2.36, wherever it is compiled.
#[test]
fn a_new_c_library_is_found() {
    let (folder, binaries) = gain();
    let source = folder.path().join("new.c");
    std::fs::write(
        &source,
        "unsigned arc4random(void); unsigned octant(void) { return arc4random(); }",
    )
    .unwrap();
    let library = binaries.join("gain_fmi2.so");
    let path = source.to_str().unwrap().to_owned();
    let gcc = Command::new("gcc")
        .args(["-std=gnu11", "-fPIC", "-shared", "-fvisibility=default", "-o"])
        .arg(&library)
        .arg(foreign::sources().join("gain_fmi2.c"))
        .args([&path, "-lm"])
        .output()
        .unwrap();
    assert!(gcc.status.success());
    std::fs::remove_file(source).unwrap();
    let report = check(folder.path()).unwrap().report();
    // A machine with an older one leaves the symbol without a version.
    if report.binaries[0].glibc.as_deref() == Some("2.36") {
        assert_eq!(found(&report), ["binary.glibc: it needs glibc 2.36"]);
    }
}

fn octant(arguments: &[&str], files: &[&Path]) -> (Output, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_octant"))
        .args(["fmu", "check"])
        .args(arguments)
        .args(files)
        .output()
        .unwrap();
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    let (out, err) = (text(&output.stdout), text(&output.stderr));
    (output, out, err)
}

#[test]
fn the_program_says_what_it_found_and_with_which_status() {
    let good = foreign::fmu("gain_fmi2");
    let (output, out, _) = octant(&["--no-load"], &[&good]);
    assert_eq!(output.status.code(), Some(0), "{out}");
    assert!(out.contains("FMI 2.0, \"Gain\"") && out.contains("0 errors"), "{out}");

    let (folder, _binaries) = gain();
    let description = folder.path().join("modelDescription.xml");
    let text = std::fs::read_to_string(&description).unwrap();
    std::fs::write(&description, text.replace("causality=\"input\"", "causality=\"imput\""))
        .unwrap();
    let (output, out, err) = octant(&["--no-load"], &[&good, folder.path()]);
    assert_eq!(output.status.code(), Some(1), "{out}{err}");
    assert!(out.contains("schema.value; FMI 2.0, 2.2]"), "{out}");

    let nothing = folder.path().join("nothing.fmu");
    std::fs::write(&nothing, "not a zip").unwrap();
    let (output, out, err) = octant(&["--no-load", "--json"], &[&good, &nothing]);
    assert_eq!(output.status.code(), Some(2), "{out}{err}");
    assert!(err.contains("nothing.fmu is no zip archive: it begins with \"not \""), "{err}");
    let json: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(json["files"].as_array().unwrap().len(), 2);
    assert_eq!(json["errors"], 0);
    assert_eq!(json["files"][0]["model_name"], "Gain");
    assert!(json["files"][1]["unreadable"].as_str().unwrap().contains("no zip archive"));

    let (output, _, err) = octant(&["--time-limit", "0"], &[&good]);
    assert_eq!(output.status.code(), Some(2));
    assert!(err.contains("expected a positive number of seconds"), "{err}");
}

#[test]
fn the_page_lists_every_rule() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/fmu-check.md");
    let page = std::fs::read_to_string(page).unwrap();
    let listed: Vec<&str> = page.lines().filter(|line| line.starts_with("| `")).collect();
    let rules: Vec<String> = octant::fmu::check::rules::RULES
        .iter()
        .map(|rule| {
            let severity = rule.severity.name();
            format!(
                "| `{}` | {severity} | {} | {} | {} |",
                rule.id, rule.says, rule.fmi2, rule.fmi3
            )
        })
        .collect();
    assert_eq!(listed, rules);
}
