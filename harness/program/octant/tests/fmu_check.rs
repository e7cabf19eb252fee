//! `octant fmu check` on real libraries: foreign FMUs as they are, and with a wrongly built
//! library.

use crate::common::foreign;
use crate::common::program::{OCTANT, program};
use octant_fmu_build as build;
use octant_fmu_check::load::load;
use octant_fmu_check::rules::Severity;
use octant_fmu_check::{Report, check, show};
use octant_fmu_host::instance::OpenOptions;
use octant_test_processes::command;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::time::Duration;

/// Makes a folder with an FMU of FMI 2.0, without its library, for changes.
fn empty(name: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::Builder::new().suffix(".fmu").tempdir().unwrap();
    let description = foreign::sources().join(format!("{name}.xml"));
    std::fs::copy(description, folder.path().join("modelDescription.xml")).unwrap();
    let binaries = folder.path().join("binaries/linux64");
    std::fs::create_dir_all(&binaries).unwrap();
    (folder, binaries)
}

/// Makes the FMU `gain_fmi2`, without its library.
fn gain() -> (tempfile::TempDir, PathBuf) {
    empty("gain_fmi2")
}

/// Compiles the FMU's source, which has the library's name, with more options.
fn compile(library: &Path, options: &[&str]) {
    let name = library.file_stem().unwrap().to_str().unwrap();
    let status = command("gcc")
        .args(["-std=gnu11", "-O1", "-fPIC", "-shared", "-fvisibility=default"])
        .arg(foreign::sources().join(format!("{name}.c")))
        .arg("-o")
        .arg(library)
        .args(options)
        .arg("-lm")
        .current_dir(library.parent().unwrap())
        .status()
        .unwrap();
    assert!(status.success());
}

/// Changes the description.
fn edit(folder: &Path, from: &str, to: &str) {
    let path = folder.join("modelDescription.xml");
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains(from), "{from:?} isn't in the description");
    std::fs::write(path, text.replacen(from, to, 1)).unwrap();
}

/// Lists the findings of loading and stepping: rule and found content.
fn stepped(fmu: &Path) -> Vec<String> {
    let mut checked = check(fmu).unwrap();
    assert!(checked.can_be_loaded());
    // A busy host takes seconds to start a process; the FMUs that hang do so for ever.
    let limit = Duration::from_secs(8);
    let options = OpenOptions {
        program: Some(OCTANT.into()),
        start_limit: limit,
        time_limit: limit,
        ..OpenOptions::default()
    };
    load(&mut checked, &options, true);
    let report = checked.report();
    let found = report.findings.iter().filter(|finding| finding.rule.id.starts_with("load."));
    found.map(|finding| format!("{}: {}", finding.rule.id, finding.found)).collect()
}

/// Lists findings worse than notes, except for functions that these FMUs don't need: rule and found
/// content.
fn found(report: &Report) -> Vec<String> {
    report
        .findings
        .iter()
        .filter(|finding| finding.rule.severity > Severity::Note)
        .filter(|finding| finding.rule.id != "binary.optional-symbols")
        .map(|finding| format!("{}: {}", finding.rule.id, finding.found))
        .collect()
}

/// Lists the findings of a library compiled with these options.
fn built(options: &[&str]) -> Vec<String> {
    let (folder, binaries) = gain();
    compile(&binaries.join("gain_fmi2.so"), options);
    found(&check(folder.path()).unwrap().report())
}

#[test]
fn foreign_fmus_have_no_finding_but_what_they_lack() {
    for name in foreign::NAMES {
        let report = check(&foreign::fmu(name)).unwrap().report();
        // Some name log categories, but have no function to select them.
        let mut found = found(&report);
        found.retain(|found| !found.ends_with("SetDebugLogging"));
        let expected: &[&str] = match name {
            // The FMU lacks the functions for Booleans and clocks, which its tests don't call.
            "clocks_fmi3" => &["binary.symbols: no fmi3GetBoolean, fmi3GetClock"],
            _ => &[],
        };
        assert_eq!(found, expected, "{name}");
        let [binary] = &report.binaries[..] else { panic!("{:?}", report.binaries) };
        assert_eq!((&binary.format[..], &binary.architecture[..]), ("Elf", "X86_64"));
        assert!(binary.functions > 10, "{binary:?}");
        let known = [
            "files.documentation",
            "files.licence",
            "variable.description",
            "binary.symbols",
            "binary.optional-symbols",
        ];
        for finding in &report.findings {
            assert!(known.contains(&finding.rule.id), "{name}: {finding:?}");
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
    let mut gcc = command("gcc");
    let status = gcc.args(["-shared", "-fPIC", "-o"]).arg(&extra).arg(&source).status();
    assert!(status.unwrap().success());
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

/// A function that was added in glibc 2.36, wherever it is compiled.
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
    let gcc = command("gcc")
        .args(["-std=gnu11", "-fPIC", "-shared", "-fvisibility=default", "-o"])
        .arg(&library)
        .arg(foreign::sources().join("gain_fmi2.c"))
        .args([&path, "-lm"])
        .output()
        .unwrap();
    assert!(gcc.status.success());
    std::fs::remove_file(source).unwrap();
    let report = check(folder.path()).unwrap().report();
    // A machine with an older glibc leaves the symbol without a version.
    if report.binaries[0].glibc.as_deref() == Some("2.36") {
        assert_eq!(found(&report), ["binary.glibc: it needs glibc 2.36"]);
    }
}

#[test]
fn foreign_fmus_are_loaded_and_stepped() {
    for name in foreign::NAMES {
        assert_eq!(stepped(&foreign::fmu(name)), [] as [&str; 0], "{name}");
    }
}

#[test]
fn our_own_fmus_have_no_finding() {
    let folder = tempfile::tempdir().unwrap();
    let options = build::Options { out: folder.path().to_owned(), ..build::Options::default() };
    let files = build::build(&options).unwrap();
    let fmus: Vec<PathBuf> =
        files.into_iter().filter(|file| file.extension().is_some_and(|end| end == "fmu")).collect();
    assert_eq!(fmus.len(), 5);
    for fmu in fmus {
        let report = check(&fmu).unwrap().report();
        assert!(report.findings.is_empty(), "{}", show::text(&report));
        assert_eq!(stepped(&fmu), [] as [&str; 0], "{}", fmu.display());
    }
}

#[test]
fn trouble_at_instantiation_is_a_finding() {
    let (folder, binaries) = empty("trouble_fmi2");
    compile(&binaries.join("trouble_fmi2.so"), &[]);
    assert_eq!(stepped(folder.path()), [] as [&str; 0]);
    // The name selects the behaviour.
    edit(folder.path(), "modelName=\"Trouble\"", "modelName=\"instantiate 1\"");
    let crash = stepped(folder.path());
    assert!(crash[0].starts_with("load.survives: "), "{crash:?}");
    assert!(crash[0].ends_with("was ended by SIGSEGV in fmi2Instantiate"), "{crash:?}");
    edit(folder.path(), "instantiate 1", "instantiate 8");
    let refusal = stepped(folder.path());
    assert!(refusal[0].starts_with("load.instantiates: "), "{refusal:?}");
    edit(folder.path(), "instantiate 8", "instantiate 4");
    // The FMU hangs for ever: a finding shows that the time limit was kept.
    let hang = stepped(folder.path());
    assert!(hang[0].starts_with("load.survives: ") && hang[0].contains("8 s"), "{hang:?}");
}

#[test]
fn a_library_that_does_not_load_is_a_finding() {
    let (folder, binaries) = gain();
    let library = binaries.join("gain_fmi2.so");
    let source = folder.path().join("more.c");
    let with = |text: &str, more: &[&str]| {
        std::fs::write(&source, text).unwrap();
        compile(&library, &[&[source.to_str().unwrap()], more].concat());
        stepped(folder.path())
    };
    let found = with("void nobody(void); void octant(void) { nobody(); }", &[]);
    assert!(found[0].starts_with("load.opens: ") && found[0].contains("nobody"), "{found:?}");
    let crash = "__attribute__((constructor)) static void f(void) { *(volatile int *)8 = 1; }";
    let found = with(crash, &[]);
    assert!(found[0].starts_with("load.survives: ") && found[0].contains("SIGSEGV"), "{found:?}");
    // The macro renames the FMU's own function; the other file undoes it for itself.
    let version = "#undef fmi2GetVersion\nconst char *fmi2GetVersion(void) { return \"1.0\"; }";
    let found = with(version, &["-Dfmi2GetVersion=other_version"]);
    assert!(found[0].starts_with("load.opens: ") && found[0].contains("1.0"), "{found:?}");
    let step = "#undef fmi2DoStep\nint fmi2DoStep(void) { return 3; }";
    let found = with(step, &["-Dfmi2DoStep=other_step"]);
    assert!(found[0].starts_with("load.steps: ") && found[0].contains("error"), "{found:?}");
    let step = "#undef fmi2DoStep\nint fmi2DoStep(void) { __builtin_trap(); }";
    let found = with(step, &["-Dfmi2DoStep=other_step"]);
    assert!(found[0].ends_with("was ended by SIGILL in fmi2DoStep"), "{found:?}");
}

#[test]
fn an_interface_that_is_not_tried_is_no_error_of_the_fmu() {
    let found = stepped(&foreign::unpacked("scheduled_fmi3"));
    let expected =
        "load.not-tried: not tried: octant fmu run --interface scheduled-execution runs it";
    assert!(found.iter().any(|one| one == expected), "{found:?}");
    assert!(found.iter().all(|one| !one.starts_with("load.opens")), "{found:?}");
    // An FMU with both kinds is tried with both, and neither is an error.
    assert_eq!(stepped(&foreign::unpacked("vanderpol_fmi3")), [] as [&str; 0]);
}

#[test]
fn what_needs_its_tool_is_loaded_on_request_alone() {
    let (folder, binaries) = gain();
    compile(&binaries.join("gain_fmi2.so"), &[]);
    edit(folder.path(), "<CoSimulation ", "<CoSimulation needsExecutionTool=\"true\" ");
    assert_eq!(stepped(folder.path()), ["load.tool: it needs the tool that made it"]);
    // A wrong start value is found by running alone.
    edit(folder.path(), "start=\"2\"", "start=\"2.5\"");
    let (output, out, err) = octant(&["--step"], &[folder.path()]);
    assert_eq!(output.status.code(), Some(0), "{out}{err}");
    assert!(out.contains("or --allow-tool") && !out.contains("load.starts"), "{out}");
    let (output, out, err) = octant(&["--step", "--allow-tool"], &[folder.path()]);
    assert_eq!(output.status.code(), Some(0), "{out}{err}");
    assert!(out.contains("load.starts"), "{out}");
    let run = |more: &[&str]| {
        let fmu = folder.path().to_str().unwrap();
        let output = program(&["fmu", "run", fmu, "--stop", "1"]).args(more).output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let (status, error) = run(&[]);
    assert_eq!(status, Some(2), "{error}");
    assert!(error.contains("it needs the tool that made it; where that is"), "{error}");
    assert!(error.contains("--allow-tool runs it"), "{error}");
    assert_eq!(run(&["--allow-tool"]).0, Some(0));
}

#[test]
fn a_failure_at_the_end_is_a_finding() {
    for (replaced, code, expected) in foreign::BAD_ENDS {
        let folder = foreign::altered("gain_fmi2", code, replaced);
        for more in [&[][..], &["--step"]] {
            let more = [more, &["--time-limit", "5"]].concat();
            let (output, out, err) = octant(&more, &[folder.path()]);
            assert_eq!(output.status.code(), Some(1), "{out}{err}");
            assert!(out.contains(expected) && out.contains("[load.survives;"), "{out}");
        }
    }
}

/// Code that starts a process, which leaves the FMU's group and session, and writes its number.
const DAEMON: &str = r#"
#include <signal.h>
#include <stdio.h>
#include <unistd.h>
__attribute__((constructor)) static void f(void) {
    if (fork() == 0) {
        setsid();
        if (fork() == 0) {
            FILE *file = fopen("PLACE.part", "w");
            fprintf(file, "%d", getpid());
            fclose(file);
            rename("PLACE.part", "PLACE");
            for (;;)
                pause();
        }
        _exit(0);
    }
    while (access("PLACE", F_OK) != 0)
        usleep(1000);
    END
}
"#;

#[test]
fn nothing_that_an_fmu_starts_outlives_it() {
    for (end, found) in [
        ("", "[]"),
        ("*(volatile int *)8 = 1;", "SIGSEGV in the loading of its library"),
        ("for (;;) pause();", "gave no answer to the loading of its library for 8 s"),
    ] {
        let place = tempfile::tempdir().unwrap();
        let place = place.path().join("pid");
        let code = DAEMON.replace("PLACE", place.to_str().unwrap()).replace("END", end);
        let folder = foreign::altered("gain_fmi2", &code, &[]);
        let all = format!("{:?}", stepped(folder.path()));
        assert!(all.contains(found), "{all}");
        let pid = std::fs::read_to_string(&place).unwrap();
        assert!(!Path::new("/proc").join(&pid).join("exe").exists(), "{pid} lives on: {end:?}");
    }
}

#[test]
fn the_output_of_an_fmu_is_limited() {
    let code = r#"
#include <stdio.h>
__attribute__((constructor)) static void f(void) {
    for (int i = 0; i < 100000; i++) {
        printf("noise on standard output %d, thirty-two\n", i);
        fprintf(stderr, "noise on standard error %d\n", i);
    }
}
"#;
    let folder = foreign::altered("gain_fmi2", code, &[]);
    let (output, out, err) = octant(&[], &[folder.path()]);
    assert_eq!(output.status.code(), Some(0), "{out}{err}");
    assert!(out.contains("0 errors") && !out.contains("noise"), "{out}");
    let told = err.trim_end().lines().last().unwrap();
    let dropped = told.split(": ").nth(2).unwrap().split(' ').next().unwrap();
    let dropped: usize = dropped.parse().unwrap();
    assert!(told.ends_with("more bytes of its output were dropped, expected at most 1048576"));
    // A line of each number on each stream.
    let digits: usize = (0..100_000).map(|i: usize| i.to_string().len()).sum();
    let all = digits
        + 100_000 * "noise on standard output , thirty-two\n".len()
        + digits
        + 100_000 * "noise on standard error \n".len();
    assert_eq!(dropped + (1 << 20), all, "{told}");
    // Each line names the FMU; the last one is cut.
    let lines: Vec<&str> = err.trim_end().lines().filter(|line| *line != told).collect();
    let name = told.split(": ").nth(1).unwrap();
    let passed = |line: &&str| line.strip_prefix(name).unwrap().len() - ": ".len() + 1;
    let passed: usize = lines.iter().map(passed).sum();
    assert!([1 << 20, (1 << 20) + 1].contains(&passed), "{passed}");
}

#[test]
fn identical_entries_are_a_warning_and_run() {
    let (folder, binaries) = gain();
    let library = binaries.join("gain_fmi2.so");
    compile(&library, &[]);
    let description = std::fs::read(folder.path().join("modelDescription.xml")).unwrap();
    let packed = |second: &[u8]| {
        let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
        for (name, contents) in [
            ("modelDescription.xml", &description[..]),
            ("modelDescriptions.ml", second),
            ("binaries/linux64/gain_fmi2.so", &std::fs::read(&library).unwrap()),
        ] {
            archive.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
            archive.write_all(contents).unwrap();
        }
        let mut bytes = archive.finish().unwrap().into_inner();
        let (from, to) = (b"modelDescriptions.ml", b"modelDescription.xml");
        for at in 0..bytes.len() - from.len() {
            if &bytes[at..at + from.len()] == from {
                bytes[at..at + from.len()].copy_from_slice(to);
            }
        }
        let path = folder.path().join("twice.fmu");
        std::fs::write(&path, bytes).unwrap();
        path
    };
    let fmu = packed(&description);
    let (output, out, err) = octant(&["--step"], &[&fmu]);
    assert_eq!(output.status.code(), Some(0), "{out}{err}");
    assert!(out.contains("the same entry is there twice"), "{out}");
    assert!(out.contains("[archive.duplicate; FMI 2.0, 2.3]"), "{out}");
    let run = || program(&["fmu", "run", fmu.to_str().unwrap(), "--stop", "1"]).output().unwrap();
    assert_eq!(run().status.code(), Some(0));
    packed(b"<another/>");
    let output = run();
    assert_eq!(output.status.code(), Some(2));
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(error.contains("is there twice, with different contents"), "{error}");
}

/// A library that leaves a mark when it is loaded.
#[test]
fn nothing_of_a_hostile_fmu_is_run() {
    let (folder, binaries) = gain();
    let mark = folder.path().join("mark");
    let source = folder.path().join("more.c");
    let text = format!(
        "#include <stdio.h>\n__attribute__((constructor)) static void f(void) \
         {{ FILE *f = fopen({:?}, \"w\"); if (f) fclose(f); }}",
        mark.display().to_string()
    );
    std::fs::write(&source, text).unwrap();
    let library = binaries.join("gain_fmi2.so");
    compile(&library, &[source.to_str().unwrap()]);
    let packed = |name: &str, more: &[&str]| {
        let path = folder.path().join(name);
        let mut archive = zip::ZipWriter::new(std::fs::File::create(&path).unwrap());
        let options = zip::write::SimpleFileOptions::default();
        let description = folder.path().join("modelDescription.xml");
        let files =
            [("modelDescription.xml", &description), ("binaries/linux64/gain_fmi2.so", &library)];
        for (name, file) in files {
            archive.start_file(name, options).unwrap();
            archive.write_all(&std::fs::read(file).unwrap()).unwrap();
        }
        for name in more {
            archive.start_file(*name, options).unwrap();
        }
        archive.finish().unwrap();
        path
    };
    let (output, out, err) = octant(&[], &[&packed("hostile.fmu", &["../evil"])]);
    assert_eq!(output.status.code(), Some(1), "{out}{err}");
    assert!(out.contains("../evil: leaves the folder") && out.contains("[archive.name;"), "{out}");
    assert!(!mark.exists());
    let plain = packed("plain.fmu", &[]);
    // The last of the two counts.
    for no_load in [&["--no-load"][..], &["--load", "--no-load"]] {
        let (output, out, err) = octant(no_load, &[&plain]);
        assert_eq!(output.status.code(), Some(0), "{out}{err}");
        assert!(!mark.exists());
    }
    let (output, out, err) = octant(&["--no-load", "--load"], &[&plain]);
    assert_eq!(output.status.code(), Some(0), "{out}{err}");
    assert!(mark.exists());
}

#[test]
fn other_start_values_than_the_descriptions_are_found() {
    let (folder, binaries) = gain();
    compile(&binaries.join("gain_fmi2.so"), &[]);
    edit(folder.path(), "start=\"2\"", "start=\"2.5\"");
    assert_eq!(stepped(folder.path()), ["load.starts: \"gain\" is 2, its start value is 2.5"]);
}

fn octant(arguments: &[&str], files: &[&Path]) -> (Output, String, String) {
    let output = program(&[]).args(["fmu", "check"]).args(arguments).args(files).output().unwrap();
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

    let (output, out, _) = octant(&["--step"], &[&good]);
    assert_eq!(output.status.code(), Some(0), "{out}");

    let (output, _, err) = octant(&["--time-limit", "0"], &[&good]);
    assert_eq!(output.status.code(), Some(2));
    assert!(err.contains("expected a positive number of seconds"), "{err}");
}

#[test]
fn the_page_lists_every_rule() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../docs/fmu-check.md");
    let page = std::fs::read_to_string(page).unwrap();
    let listed: Vec<&str> = page.lines().filter(|line| line.starts_with("| `")).collect();
    let rules: Vec<String> = octant_fmu_check::rules::RULES
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
