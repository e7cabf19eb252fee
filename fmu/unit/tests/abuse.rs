//! The C interface as a hostile or careless importer calls it: a C program that loads the library
//! and checks every answer. It is in `tests/abuse`.

use octant_fmu::c::{ServedStandard, token};
use octant_fmu::calibrator::table::MODEL;
use octant_fmu::{calibrator_can, plant};
use octant_test_processes::command;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

const SOURCES: [&str; 10] =
    ["main", "handles", "order", "values", "time", "states", "random", "threads", "bus", "stack"];

/// Value references that the program uses.
const NAMES: [(&str, &str); 25] = [
    ("GYRO", "gyro.delta_theta"),
    ("ACCELEROMETER", "accelerometer.delta_velocity"),
    ("GIMBAL_AZIMUTH", "gimbal.azimuth"),
    ("GIMBAL_ROLL", "gimbal.roll"),
    ("IMU_VALID", "imu.valid"),
    ("IMU_STATUS", "imu.status"),
    ("IMU_SEQUENCE", "imu.sequence"),
    ("IMU_PERIOD", "imu.period_ns"),
    ("REFERENCE_KIND", "reference.kind"),
    ("REFERENCE_VELOCITY", "reference.velocity"),
    ("MODE", "mode"),
    ("LATITUDE", "navigation.latitude"),
    ("LONGITUDE", "navigation.longitude"),
    ("HEIGHT", "navigation.height"),
    ("VELOCITY", "navigation.velocity"),
    ("ATTITUDE", "navigation.attitude"),
    ("NIS", "filter.nis"),
    ("HEALTH", "health"),
    ("ANSWER_SEQUENCE", "answer.sequence"),
    ("PARAMETERS", "parameters.gyro_bias"),
    ("SIGMA", "sigma.gyro_bias"),
    ("SITE_LATITUDE", "site.latitude"),
    ("ALIGNMENT_METHOD", "procedure.alignment.method"),
    ("ALIGNMENT_DURATION", "procedure.alignment.duration"),
    ("GATE_NIS", "screening.gate.nis"),
];

/// Those of the Calibrator on a bus.
const BUS_NAMES: [(&str, &str); 6] = [
    ("BUS_RX_CLOCK", "can.Rx_Clock"),
    ("BUS_RX_DATA", "can.Rx_Data"),
    ("BUS_TX_CLOCK", "can.Tx_Clock"),
    ("BUS_TX_DATA", "can.Tx_Data"),
    ("BUS_NOTIFICATIONS", "can.bus_notifications"),
    ("BUS_MODE", "mode"),
];

/// Facts of the Calibrator, from the program's table.
fn header() -> String {
    let mut text = "/* Made by the test. */\n".to_owned();
    for (constant, name) in NAMES {
        let _ = writeln!(text, "#define {constant} {}u", MODEL.slot(name));
    }
    let groups: Vec<String> = MODEL
        .with_slots()
        .filter(|(_, variable)| {
            let name = variable.name;
            name.starts_with("sigma.")
                || name.starts_with("parameters.") && name != "parameters.revision"
        })
        .map(|(slot, _)| slot.to_string())
        .collect();
    let _ = writeln!(text, "#define OUTPUT_GROUPS {}", groups.join(", "));
    for (constant, name) in BUS_NAMES {
        let _ = writeln!(text, "#define {constant} {}u", calibrator_can::table::MODEL.slot(name));
    }
    let bias = plant::table::MODEL.slot("imu.parameters.gyro_bias");
    let _ = writeln!(text, "#define PLANT_GYRO_BIAS {bias}u");
    let bus = token(&calibrator_can::table::MODEL, ServedStandard::Fmi3);
    let _ = writeln!(text, "#define TOKEN_BUS \"{bus}\"");
    let of_fmi2 = token(&calibrator_can::table::MODEL, ServedStandard::Fmi2);
    let _ = writeln!(text, "#define TOKEN_BUS2 \"{of_fmi2}\"");
    for (constant, standard) in [("2", ServedStandard::Fmi2), ("3", ServedStandard::Fmi3)] {
        let plant = token(&plant::table::MODEL, standard);
        let _ = writeln!(text, "#define TOKEN_PLANT{constant} \"{plant}\"");
    }
    let _ = writeln!(text, "#define SLOTS {}u", MODEL.slots());
    let _ = writeln!(text, "#define TOKEN2 \"{}\"", token(&MODEL, ServedStandard::Fmi2));
    let _ = writeln!(text, "#define TOKEN3 \"{}\"", token(&MODEL, ServedStandard::Fmi3));
    text
}

/// The library that was built with this test.
fn library() -> PathBuf {
    let name =
        format!("{}octant_fmu{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let found = std::env::current_exe().unwrap().with_file_name(name);
    assert!(found.is_file(), "there is no {}", found.display());
    found
}

/// Compiles the program; `None`: there is no C compiler here.
fn compile(folder: &Path) -> Option<PathBuf> {
    std::fs::write(folder.join("calibrator.h"), header()).unwrap();
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/abuse");
    let program = folder.join("abuse");
    let mut gcc = command("gcc");
    gcc.args(["-std=gnu11", "-g", "-O1", "-Wall", "-Wextra", "-Werror", "-pthread", "-I"]);
    gcc.arg(folder).arg("-o").arg(&program);
    gcc.args(SOURCES.map(|source| sources.join(source).with_extension("c")));
    gcc.arg("-ldl");
    match gcc.output() {
        Ok(output) => {
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            Some(program)
        }
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            eprintln!("skipped: there is no gcc here");
            None
        }
        Err(error) => panic!("run gcc: {error}"),
    }
}

fn run(mut command: Command) {
    let output = command.output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    let complained = String::from_utf8_lossy(&output.stderr);
    print!("{said}");
    assert!(output.status.success(), "{}\n{said}{complained}", output.status);
}

#[test]
fn every_answer_is_the_one_that_the_standard_asks_for() {
    let folder = tempfile::tempdir().unwrap();
    let Some(program) = compile(folder.path()) else { return };
    let mut command = command(program);
    command.arg(library()).arg("10000");
    run(command);
}

/// Memory is used as it should be, and all of it is given back.
#[test]
#[ignore = "takes minutes; tests/rigs/fmu-abuse runs it"]
fn valgrind_finds_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let program = compile(folder.path()).expect("gcc");
    let mut command = command("valgrind");
    command.args(["--quiet", "--error-exitcode=99", "--leak-check=full"]);
    command.args(["--show-leak-kinds=definite,indirect,possible"]);
    command.args(["--errors-for-leak-kinds=definite,indirect,possible", "--track-origins=yes"]);
    command.arg(program).arg(library()).arg("4000");
    run(command);
}
