//! `octant run` of systems of foreign FMUs, as a user runs it: mixed kinds, crashes, refusals,
//! files that aren't systems.

use crate::common::foreign;
use crate::common::program::octant;
use serde_json::Value;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::Output;

const HEAD: &str = r#"<SystemStructureDescription version="1.0" name="foreign"
    xmlns="http://ssp-standard.org/SSP1/SystemStructureDescription"
    xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon"
    xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues">"#;

/// Makes a folder with a system of these elements and connections.
pub(crate) fn system(
    fmus: &[&str],
    elements: &str,
    connections: &str,
    more: &str,
) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("resources")).unwrap();
    for fmu in fmus {
        let to = folder.path().join("resources").join(format!("{fmu}.fmu"));
        std::fs::copy(foreign::fmu(fmu), to).unwrap();
    }
    let text = format!(
        "{HEAD}<System name=\"s\"><Elements>{elements}</Elements><Connections>{connections}\
         </Connections></System>{more}</SystemStructureDescription>"
    );
    std::fs::write(folder.path().join("SystemStructure.ssd"), text).unwrap();
    folder
}

pub(crate) fn component(
    name: &str,
    fmu: &str,
    connectors: &[(&str, &str)],
    set: &[(&str, &str)],
) -> String {
    let connectors: String = connectors
        .iter()
        .map(|(name, kind)| format!("<Connector name=\"{name}\" kind=\"{kind}\"/>"))
        .collect();
    let set: String = set
        .iter()
        .map(|(name, value)| format!("<ssv:Parameter name=\"{name}\">{value}</ssv:Parameter>"))
        .collect();
    format!(
        "<Component name=\"{name}\" source=\"resources/{fmu}.fmu\"><Connectors>{connectors}\
         </Connectors><ParameterBindings><ParameterBinding><ParameterValues>\
         <ssv:ParameterSet version=\"1.0\" name=\"p\"><ssv:Parameters>{set}</ssv:Parameters>\
         </ssv:ParameterSet></ParameterValues></ParameterBinding></ParameterBindings></Component>"
    )
}

pub(crate) fn connection(from: &str, to: &str) -> String {
    let ((a, y), (b, u)) = (from.split_once('.').unwrap(), to.split_once('.').unwrap());
    format!(
        "<Connection startElement=\"{a}\" startConnector=\"{y}\" endElement=\"{b}\" \
         endConnector=\"{u}\"/>"
    )
}

pub(crate) fn run(system: &Path, out: &Path, more: &[&str]) -> Output {
    let mut arguments = vec!["run", system.to_str().unwrap(), "--out", out.to_str().unwrap()];
    arguments.extend(more);
    octant(&arguments)
}

pub(crate) fn error(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

pub(crate) fn summary(folder: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join("summary.json")).unwrap()).unwrap()
}

/// Reads the rows of `values.csv`: names and numbers; a text is none.
fn rows(folder: &Path) -> (Vec<String>, Vec<Vec<f64>>) {
    let mut reader = csv::Reader::from_path(folder.join("values.csv")).unwrap();
    let names = reader.headers().unwrap().iter().map(str::to_owned).collect();
    let rows = reader
        .records()
        .map(|row| row.unwrap().iter().map(|field| field.parse().unwrap_or(f64::NAN)).collect())
        .collect();
    (names, rows)
}

/// Makes a ball in model exchange, whose velocity an integrator integrates again.
fn ball() -> tempfile::TempDir {
    let elements = component("ball", "ball_fmi3", &[("v", "output")], &[])
        + &component(
            "sum",
            "gain_fmi2",
            &[("u", "input"), ("y", "output")],
            &[("gain", "<ssv:Real value=\"1\"/>"), ("label", "<ssv:String value=\"ssp\"/>")],
        );
    system(&["ball_fmi3", "gain_fmi2"], &elements, &connection("ball.v", "sum.u"), "")
}

#[test]
fn model_exchange_and_co_simulation_run_together() {
    let folder = ball();
    let out = folder.path().join("run");
    let ran = run(folder.path(), &out, &["--stop", "0.4 s", "--csv"]);
    assert_eq!(ran.status.code(), Some(0), "{}", error(&ran));
    let (names, rows) = rows(&out);
    let at = |name: &str| names.iter().position(|known| known == name).unwrap();
    let (time, v, y) = (at("time"), at("ball.v"), at("sum.y"));
    assert_eq!(rows.len(), 41);
    let mut sum = 0.0;
    for (n, row) in rows.iter().enumerate() {
        // The ball falls freely until √(2/9.81) s.
        assert!((row[v] + 9.81 * row[time]).abs() < 1e-6, "row {n}: {row:?}");
        // The integrator has received the velocities of the earlier points.
        assert!((row[y] - sum).abs() < 1e-6, "row {n}: {} {sum}", row[y]);
        sum += 0.01 * row[v];
    }
    let summary = summary(&out);
    assert_eq!(summary["fmus"][0]["interface"], "model-exchange");
    assert_eq!(summary["steps"], 40);
    // The same bytes in this process and in others.
    let here = folder.path().join("here");
    let ran = run(folder.path(), &here, &["--stop", "0.4 s", "--csv", "--in-process"]);
    assert_eq!(ran.status.code(), Some(0), "{}", error(&ran));
    for file in ["summary.json", "values.csv", "recording.mcap"] {
        let (a, b) = (std::fs::read(out.join(file)), std::fs::read(here.join(file)));
        assert!(a.unwrap() == b.unwrap(), "{file} differs");
    }
}

/// An entry of a dictionary between two FMUs takes no time, and alters no value of its own type.
#[test]
fn a_signal_dictionary_carries_what_a_connection_carries() {
    let direct = ball();
    let file = direct.path().join("SystemStructure.ssd");
    let text = std::fs::read_to_string(&file).unwrap();
    let through = ball();
    let reference = "<SignalDictionaryReference name=\"bus\" dictionary=\"can\"><Connectors>\
                     <Connector name=\"speed\" kind=\"inout\"/></Connectors>\
                     </SignalDictionaryReference></Elements>";
    let dictionary = "</Connections><SignalDictionaries><SignalDictionary name=\"can\" \
                      source=\"resources/can.ssb\"/></SignalDictionaries>";
    let wires = connection("ball.v", "bus.speed") + &connection("bus.speed", "sum.u");
    let text = text
        .replace("</Elements>", reference)
        .replace(&connection("ball.v", "sum.u"), &wires)
        .replace("</Connections>", dictionary);
    std::fs::write(through.path().join("SystemStructure.ssd"), text).unwrap();
    let entries = |of_type: &str| {
        format!(
            "<SignalDictionary version=\"1.0\" \
             xmlns=\"http://ssp-standard.org/SSP1/SystemStructureSignalDictionary\" \
             xmlns:ssc=\"http://ssp-standard.org/SSP1/SystemStructureCommon\">\
             <DictionaryEntry name=\"speed\">{of_type}</DictionaryEntry></SignalDictionary>"
        )
    };
    let ssb = through.path().join("resources/can.ssb");
    let values = |folder: &Path, name: &str| {
        let out = folder.join(name);
        let ran = run(folder, &out, &["--stop", "0.4 s", "--csv"]);
        (ran.status.code(), error(&ran), std::fs::read(out.join("values.csv")).unwrap_or_default())
    };
    let (code, said, expected) = values(direct.path(), "run");
    assert_eq!(code, Some(0), "{said}");
    std::fs::write(&ssb, entries("<ssc:Real/>")).unwrap();
    let (code, said, found) = values(through.path(), "real");
    assert_eq!(code, Some(0), "{said}");
    assert!(found == expected, "the values differ");
    // A whole number has no value for the speed after the first step.
    std::fs::write(&ssb, entries("<ssc:Int16/>")).unwrap();
    let (code, said, _) = values(through.path(), "whole");
    assert_eq!(code, Some(4), "{said}");
    assert!(
        said.contains("the entry \"speed\" of the signal dictionary can (")
            && said.contains("is a Int16 and has no such value"),
        "{said}"
    );
    std::fs::write(&ssb, entries("<ssc:String/>")).unwrap();
    let (code, said, _) = values(through.path(), "text");
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("a Float64 can't become a String"), "{said}");
}

/// Makes an integrator beside an FMU that causes trouble in its step from 0.5 s on.
fn trouble(what: &str) -> tempfile::TempDir {
    let number = |number: &str| format!("<ssv:Integer value=\"{number}\"/>");
    let elements = component("sum", "gain_fmi2", &[("u", "input"), ("y", "output")], &[])
        + &component(
            "trouble",
            "trouble_fmi2",
            &[("u", "input"), ("y", "output")],
            &[
                ("from", "<ssv:Real value=\"0.5\"/>"),
                ("place", &number("4")),
                ("trouble", &number(what)),
            ],
        );
    let connections = connection("sum.y", "trouble.u");
    system(&["gain_fmi2", "trouble_fmi2"], &elements, &connections, "")
}

#[test]
fn a_crash_ends_the_run_with_an_error_and_a_complete_recording() {
    let folder = trouble("1");
    let out = folder.path().join("run");
    let ran = run(folder.path(), &out, &["--csv"]);
    assert_eq!(ran.status.code(), Some(4), "{}", error(&ran));
    let summary = summary(&out);
    assert_eq!(
        (&summary["verdict"], &summary["ended"]["how"]),
        (&"error".into(), &"failed".into())
    );
    let reason = summary["reasons"][0].as_str().unwrap();
    assert!(reason.starts_with("trouble failed at 0.5 s: "), "{reason}");
    assert!(reason.contains("SIGSEGV") && reason.contains("fmi2DoStep"), "{reason}");
    // The earlier rows are there, and readable.
    let (_, rows) = rows(&out);
    assert_eq!(rows.len(), 51);
    assert!((rows[50][0] - 0.5).abs() < 1e-12);
    let bytes = std::fs::read(out.join("recording.mcap")).unwrap();
    let messages = mcap::MessageStream::new(&bytes).unwrap();
    let rows = messages.filter(|m| m.as_ref().unwrap().channel.topic == "/fmu/outputs");
    assert_eq!(rows.count(), 51);
    assert!(out.join("manifest.json").is_file());
}

#[test]
fn who_discards_for_good_is_told_with_its_words() {
    let folder = trouble("7");
    let out = folder.path().join("run");
    let ran = run(folder.path(), &out, &["--json"]);
    assert_eq!(ran.status.code(), Some(4), "{}", error(&ran));
    let summary: Value = serde_json::from_slice(&ran.stdout).unwrap();
    let reason = summary["reasons"][0].as_str().unwrap();
    assert!(reason.starts_with("trouble discarded the step from 0.5 s to 0.5"), "{reason}");
    assert!(reason.contains("half of it at most"), "{reason}");
    assert!(error(&ran).contains(&format!("octant: {reason}\n")), "{}", error(&ran));
    assert!(summary["rejected"].as_u64().unwrap() >= 1, "{summary}");
}

fn packed(entries: &[(&str, &[u8])]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("system.ssp");
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, bytes) in entries {
        archive.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
        archive.write_all(bytes).unwrap();
    }
    std::fs::write(&path, archive.finish().unwrap().into_inner()).unwrap();
    (folder, path)
}

#[test]
fn a_packed_system_is_run_and_what_is_none_is_refused() {
    let unpacked = ball();
    let read = |name: &str| std::fs::read(unpacked.path().join(name)).unwrap();
    let structure = read("SystemStructure.ssd");
    let (a, b) = (read("resources/ball_fmi3.fmu"), read("resources/gain_fmi2.fmu"));
    let fmus: [(&str, &[u8]); 2] =
        [("resources/ball_fmi3.fmu", &a), ("resources/gain_fmi2.fmu", &b)];
    let whole = [("SystemStructure.ssd", &structure[..]), fmus[0], fmus[1]];
    let (folder, path) = packed(&whole);
    let ran = run(&path, &folder.path().join("run"), &["--stop", "0.1 s"]);
    assert_eq!(ran.status.code(), Some(0), "{}", error(&ran));
    let text = String::from_utf8(ran.stdout).unwrap();
    assert!(text.starts_with("foreign: none\n"), "{text}");
    assert!(text.contains("ball and sum, jacobi, 10 steps of 0.01 s to 0.1 s"), "{text}");

    let refused = |entries: &[(&str, &[u8])], expected: &str| {
        let (folder, path) = packed(entries);
        let ran = run(&path, &folder.path().join("run"), &[]);
        assert_eq!(ran.status.code(), Some(2), "{}", error(&ran));
        assert!(error(&ran).contains(expected), "{}", error(&ran));
        let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().collect();
        assert_eq!(left.len(), 1, "no folder of a run is left");
    };
    refused(&fmus, "failed to find SystemStructure.ssd in it");
    refused(&[whole[0], fmus[0]], "there is none of this name");
    refused(&[("../evil", b"x"), whole[0]], "system.ssp: entry \"../evil\"");
    refused(&[("SystemStructure.ssd", b"<x/>")], "SystemStructure.ssd:1: x: found <x>");
    refused(
        &[whole[0], (fmus[0].0, b"no archive"), fmus[1]],
        "SystemStructure.ssd:4: Component \"ball\": failed to",
    );
    let unpacked = unpacked.path();
    for (more, expected) in [
        (&["--source", "plant"][..], "--source: found the system of FMUs"),
        (&["--order", "gauss-seidel=ball"], "the order leaves out sum"),
        (&["--step", "7 ms", "--stop", "1 s"], "expected a whole number"),
        (&["--step", "fast"], "--step: found \"fast\", expected a time"),
        (&["--set", "ball.h=3 kg"], "--set ball.h=3 kg"),
        (&["--faults", "/nowhere.toml"], "failed to read /nowhere.toml"),
        (&["--fire", "x=1 s"], "--fire x=1 s: the scenario has no faults"),
    ] {
        // Without a stop, the missing stop would be refused instead.
        let stop: &[&str] = if more.contains(&"--stop") { &[] } else { &["--stop", "1 s"] };
        let ran = run(unpacked, &unpacked.join("run"), &[more, stop].concat());
        assert_eq!(ran.status.code(), Some(2), "{more:?}: {}", error(&ran));
        assert!(error(&ran).contains(expected), "{more:?}: {}", error(&ran));
    }
    let scenario =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures/scenarios/quick.toml");
    let ran = run(&scenario, &unpacked.join("run"), &["--order", "jacobi"]);
    assert_eq!(ran.status.code(), Some(2));
    assert!(error(&ran).contains("--order: found the scenario"), "{}", error(&ran));
}

/// Rewrites the description of an FMU so that it needs the tool that made it.
fn needs_its_tool(fmu: &Path) {
    let mut archive = zip::ZipArchive::new(std::fs::File::open(fmu).unwrap()).unwrap();
    let mut written = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for index in 0..archive.len() {
        let mut entry = archive.by_index(index).unwrap();
        let (name, mut bytes) = (entry.name().unwrap().into_owned(), Vec::new());
        entry.read_to_end(&mut bytes).unwrap();
        if name == "modelDescription.xml" {
            let text = String::from_utf8(bytes).unwrap();
            let needing = "<CoSimulation needsExecutionTool=\"true\" ";
            bytes = text.replace("<CoSimulation ", needing).into_bytes();
        }
        written.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        written.write_all(&bytes).unwrap();
    }
    std::fs::write(fmu, written.finish().unwrap().into_inner()).unwrap();
}

#[test]
fn an_fmu_that_needs_its_tool_is_run_on_request_alone() {
    let folder = ball();
    needs_its_tool(&folder.path().join("resources/gain_fmi2.fmu"));
    let run = |more: &[&str]| {
        let ran =
            run(folder.path(), &folder.path().join("run"), &[&["--stop", "0.1 s"], more].concat());
        (ran.status.code(), error(&ran))
    };
    let (status, said) = run(&[]);
    assert!(status == Some(2) && said.contains("it needs the tool that made it"), "{said}");
    let (status, said) = run(&["--allow-tool"]);
    assert_eq!(status, Some(0), "{said}");
}

/// A run of which nothing is required passes in no pipeline that asks for requirements.
#[test]
fn a_system_without_requirements_is_inconclusive_where_some_are_asked_for() {
    let folder = ball();
    let requirements = folder.path().join("requirements.toml");
    let text = "schema = 1\n[[requirements]]\nid = \"V\"\ntext = \"It falls.\"\n\
                measure = \"signal.ball.v.max\"\nlimit = 1.0\n";
    std::fs::write(&requirements, text).unwrap();
    let given = ["--requirements", requirements.to_str().unwrap()];
    for (more, status, verdict) in [
        (&[][..], 0, "none"),
        (&["--require"], 3, "inconclusive"),
        (&[&["--require"], &given[..]].concat(), 0, "pass"),
    ] {
        let out = folder.path().join(verdict);
        let ran = run(folder.path(), &out, &[&["--stop", "0.1 s"], more].concat());
        assert_eq!(ran.status.code(), Some(status), "{}", error(&ran));
        let found = summary(&out);
        assert_eq!(found["verdict"], verdict, "{found}");
        let manifest = std::fs::read_to_string(out.join("manifest.json")).unwrap();
        assert_eq!(manifest.contains("--require"), !more.is_empty(), "{manifest}");
        if status == 3 {
            let reasons = ["the system requires nothing, and --require wants it to"];
            assert_eq!(found["reasons"], serde_json::json!(reasons));
        }
    }
}

#[test]
fn the_annotation_says_step_order_and_faults() {
    let unpacked = ball();
    let file = unpacked.path().join("SystemStructure.ssd");
    let text = std::fs::read_to_string(&file).unwrap();
    let with = |faults: &str| {
        let annotation = format!(
            "<Annotations><ssc:Annotation type=\"octant.co-simulation\">\
             <CoSimulation xmlns=\"urn:octant:co-simulation:1\" step=\"20 ms\" \
             order=\"gauss-seidel=ball,sum\"><Faults><![CDATA[\n{faults}]]></Faults>\
             </CoSimulation></ssc:Annotation></Annotations></SystemStructureDescription>"
        );
        std::fs::write(&file, text.replace("</SystemStructureDescription>", &annotation)).unwrap();
    };
    with(
        "schema = 1\n[[faults]]\nid = \"x\"\nkind = \"stuck\"\nconnection = \"sum.u\"\nvalue = \"2 cm/s\"\ntrigger = { at = \"0.1 s\" }\n",
    );
    let out = unpacked.path().join("run");
    let ran = run(unpacked.path(), &out, &["--stop", "0.2 s"]);
    assert_eq!(ran.status.code(), Some(0), "{}", error(&ran));
    let summary = summary(&out);
    assert_eq!(summary["order"], "gauss-seidel=ball,sum");
    assert_eq!((&summary["step_s"], &summary["steps"]), (&0.02.into(), &10.into()));
    assert_eq!(
        (&summary["faults"][0]["first_sample"], &summary["faults"][0]["samples_altered"]),
        (&6.into(), &5.into())
    );
    assert!(std::fs::read_to_string(out.join("faults.toml")).unwrap().starts_with("schema = 1"));
    // A problem has the line of the structure.
    with("schema = 1\n[[faults]]\nid = \"x\"\nkind = \"stuk\"\n");
    let ran = run(unpacked.path(), &out, &["--stop", "0.2 s"]);
    assert_eq!(ran.status.code(), Some(2));
    let line = std::fs::read_to_string(&file).unwrap();
    let line = line.lines().position(|line| line.contains("stuk")).unwrap() + 1;
    assert!(
        error(&ran).contains(&format!("SystemStructure.ssd:{line}:8: faults[0].kind")),
        "{}",
        error(&ran)
    );
}

#[test]
fn an_fmu_that_fails_at_its_end_ends_the_run_with_what_was_recorded() {
    let folder = ball();
    let (replaced, code, expected) = foreign::BAD_ENDS[0];
    let bad = foreign::altered("gain_fmi2", code, replaced);
    let resource = folder.path().join("resources/gain_fmi2.fmu");
    foreign::pack_into(bad.path(), &resource);
    let out = folder.path().join("run");
    let ran = run(folder.path(), &out, &["--stop", "0.4 s", "--csv"]);
    let error = error(&ran);
    assert_eq!(ran.status.code(), Some(4), "{error}");
    assert!(error.contains("failed to free the FMUs: sum failed at 0.4 s"), "{error}");
    assert!(error.contains(expected), "{error}");
    assert_eq!(summary(&out)["ended"]["how"], "failed");
    assert_eq!(rows(&out).1.len(), 41);
}

const REQUIRED: &str = r#"
schema = 1
[[requirements]]
id = "SYS-1"
text = "The ball doesn't fall faster than 10 m/s."
measure = "signal.ball.v.min"
comparison = ">="
limit = -10
[[requirements]]
id = "SYS-2"
text = "It ends slow."
measure = "|signal.ball.v.final|"
limit = 3.8
"#;

#[test]
fn a_system_has_requirements_on_its_signals() {
    let folder = ball();
    let out = folder.path().join("run");
    let file = folder.path().join("requirements.toml");
    let required = |text: &str, stop: &str| {
        std::fs::write(&file, text).unwrap();
        let _ = std::fs::remove_dir_all(&out);
        run(folder.path(), &out, &["--stop", stop, "--requirements", file.to_str().unwrap()])
    };
    // It falls at 9.81 m/s² for 0.2 s, then for 0.4 s.
    let ran = required(REQUIRED, "0.2 s");
    assert_eq!(ran.status.code(), Some(0), "{}", error(&ran));
    let told = String::from_utf8(ran.stdout).unwrap();
    assert!(told.contains("SYS-2: |signal.ball.v.final| is 1.962, required <= 3.8"), "{told}");
    let found = summary(&out);
    assert_eq!(found["verdict"], "pass");
    assert_eq!(found["requirements"][0]["id"], "SYS-1");
    assert!((found["requirements"][0]["value"].as_f64().unwrap() + 1.962).abs() < 1e-6);
    assert!(out.join("requirements.toml").exists());
    assert!(std::fs::read_to_string(out.join("junit.xml")).unwrap().contains("SYS-2"));

    // The smallest value between the recorded rows counts too.
    let ran = required(REQUIRED, "0.4 s");
    assert_eq!(ran.status.code(), Some(1), "{}", error(&ran));
    let found = summary(&out);
    assert_eq!(
        (&found["verdict"], &found["requirements"][0]["verdict"]),
        (&"fail".into(), &"pass".into())
    );
    assert!(
        found["reasons"][0].as_str().unwrap().starts_with("SYS-2: |signal.ball.v.final| is 3.92")
    );

    for (text, expected) in [
        (
            REQUIRED.replace("ball.v.min", "ball.vv.min"),
            "requirements.toml:6:11: requirements[0].measure: found \"signal.ball.vv.min\", and the system has no signal \"ball.vv\", did you mean \"ball.v\"?",
        ),
        (
            REQUIRED.replace("v.min", "v.mean"),
            "expected signal.NAME.max, signal.NAME.min or signal.NAME.final",
        ),
        (REQUIRED.replace("3.8", "\"3 kg\""), "requirements[1].limit: found \"3 kg\""),
        (REQUIRED.replace("SYS-2", "SYS-1"), "a second time"),
        (REQUIRED.replace("limit = 3.8", ""), "limit"),
    ] {
        let ran = required(&text, "0.2 s");
        let error = error(&ran);
        assert_eq!(ran.status.code(), Some(2), "{error}");
        assert!(error.contains(expected), "{error}: {expected}");
        assert!(!out.exists());
    }
    // In the system's own annotation.
    std::fs::write(folder.path().join("resources/required.toml"), REQUIRED).unwrap();
    let path = folder.path().join("SystemStructure.ssd");
    let text = std::fs::read_to_string(&path).unwrap();
    let annotation = r#"<Annotations><ssc:Annotation type="octant.co-simulation">
        <CoSimulation xmlns="urn:octant:co-simulation:1">
        <Requirements source="resources/required.toml"/></CoSimulation>
        </ssc:Annotation></Annotations></SystemStructureDescription>"#;
    std::fs::write(&path, text.replace("</SystemStructureDescription>", annotation)).unwrap();
    let ran = run(folder.path(), &out, &["--stop", "0.4 s"]);
    assert_eq!(ran.status.code(), Some(1), "{}", error(&ran));
}
