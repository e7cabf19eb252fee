//! Scenarios that ship with Octant: each is read, resolved and read again.

use octant_earth::Vector3;
use octant_sample::parameters::ParameterGroup;
use octant_scenario::resolve::{DrawnValues, Seeded};
use octant_scenario::{GRADES, Method, Scenario};
use std::path::{Path, PathBuf};

fn files() -> Vec<PathBuf> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/scenarios");
    let of_heading = format!("{folder}/heading");
    let mut files: Vec<PathBuf> = [folder, &of_heading]
        .into_iter()
        .flat_map(|folder| std::fs::read_dir(folder).unwrap())
        .map(|entry| entry.unwrap().path())
        .collect();
    files.retain(|path| path.is_file());
    files.sort();
    assert!(files.len() >= 11);
    files
}

fn both_configurations(scenario: &Scenario) -> String {
    let draws = DrawnValues::of(scenario, &Seeded(1));
    let plant = scenario.plant(scenario.seed, &draws);
    let core = |method| scenario.core(method, &draws, &scenario.mean_attitude(), &Vector3::zeros());
    // Debug prints every field, and floats so that they read back to the same bits.
    format!(
        "{plant:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?}",
        core(Method::Primary),
        core(Method::Baseline),
        scenario.requirements,
        scenario.record,
        scenario.source,
        scenario.reference,
        scenario.endpoint
    )
}

#[test]
fn every_shipped_scenario_is_one() {
    for file in files() {
        let scenario = Scenario::load(&file, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert_ne!(scenario.title, "untitled", "{}", file.display());
        assert!(std::fs::read_to_string(&file).unwrap().starts_with("# "), "{}", file.display());
    }
}

#[test]
fn a_resolved_scenario_makes_the_same_run_and_resolves_to_itself() {
    for file in files() {
        let scenario = Scenario::load(&file, &[]).unwrap();
        let draws = DrawnValues::of(&scenario, &Seeded(1));
        let resolved = scenario.to_resolved_toml(scenario.seed, &draws);
        let again = Scenario::parse(&resolved, "resolved", Path::new("/elsewhere"), &[])
            .unwrap_or_else(|error| panic!("{error}\n{resolved}"));
        assert_eq!(both_configurations(&again), both_configurations(&scenario), "{resolved}");
        let draws = DrawnValues::of(&again, &Seeded(1));
        assert_eq!(again.to_resolved_toml(again.seed, &draws), resolved);
    }
}

/// `imu.model` gives the values that `octant new` writes out, keys beside it replace them, and the
/// resolved scenario has them all: it doesn't need the model any more.
#[test]
fn an_instrument_by_its_name_is_that_of_its_sheet() {
    let parsed = |text: &str| {
        Scenario::parse(text, "model.toml", Path::new(""), &[])
            .unwrap_or_else(|error| panic!("{error}\n{text}"))
    };
    let tail = "[procedure.navigation]\nduration = \"1 h\"\n";
    for sheet in GRADES {
        let line = |key: &str, value: &str| format!("{key} = {value}\n");
        let imu: String = sheet.imu.iter().map(|(key, value, _)| line(key, value)).collect();
        let prior: String = sheet.prior.iter().map(|(key, value)| line(key, value)).collect();
        let written = parsed(&format!(
            "schema = 1\n[imu]\n{imu}[procedure.calibration]\n\
             [procedure.calibration.prior]\n{prior}{tail}"
        ));
        let named = parsed(&format!(
            "schema = 1\n[imu]\nmodel = \"{}\"\n[procedure.calibration]\n{tail}",
            sheet.name
        ));
        assert_eq!(both_configurations(&named), both_configurations(&written), "{}", sheet.name);
        let resolved = named.to_resolved_toml(1, &DrawnValues::of(&named, &Seeded(1)));
        let other = resolved
            .replace(sheet.name, if sheet.name == "table-1" { "tactical-mems" } else { "table-1" });
        assert_ne!(other, resolved);
        assert_eq!(both_configurations(&parsed(&other)), both_configurations(&named), "{resolved}");
    }
    // 0.753 deg/h in rad/s; the accelerometers' value is the one beside the model.
    let mems = parsed(
        "schema = 1\n[imu]\nmodel = \"tactical-mems\"\n[imu.extensions]\n\
         accel_bias_instability = \"10 ug\"\n[procedure.navigation]\nduration = \"1 h\"\n",
    );
    let extensions = &mems.imu.extensions;
    let expected = 0.753 * std::f64::consts::PI / 180.0 / 3600.0;
    assert!((extensions.gyro_bias_instability / expected - 1.0).abs() < 1e-12);
    assert!((extensions.accel_bias_instability / (10.0 * 9.80665e-6) - 1.0).abs() < 1e-12);
    let unknown = Scenario::parse(
        "schema = 1\n[imu]\nmodel = \"fog-tactical\"\n[procedure.navigation]\nduration = \"1 h\"\n",
        "model.toml",
        Path::new(""),
        &[],
    );
    let said = unknown.unwrap_err().to_string();
    assert!(GRADES.iter().all(|sheet| said.contains(sheet.name)), "{said}");
}

#[test]
fn what_no_shipped_scenario_has_resolves_to_the_same_run_too() {
    let head = "schema = 1\n[procedure.calibration]\n";
    let texts = [
        "[motion]\nkind = \"dockside\"\nheading = \"30 deg\"\n\
         [motion.ship]\nheave = [{ amplitude = \"0.1 m\", period = \"7 s\", phase = \"1 rad\" }]\n\
         spectrum = { peak_period = \"9 s\", roll = \"2 deg\", components = 5 }\n".to_owned(),
        "[procedure.alignment]\nmethod = \"coarse\"\n".to_owned(),
        "error_model = \"psi\"\nnot_estimated = [\"accel_scale\"]\n[screening.gate]\n\
         recovery = { attitude = \"3600 arcsec\" }\n[imu.extensions.vibration]\nfrequency = \"35 Hz\"\n\
         [imu.extensions.temperature]\nramp = \"5 K/h\"\nplateau = \"20 K\"\n"
            .to_owned(),
        "estimator = \"external-turntable\"\n[screening]\ngate = \"off\"\n".to_owned(),
        "[procedure.calibration.least_squares]\ngravity = \"9.79 m/s^2\"\n\
         [baseline]\nestimator = \"least-squares\"\nstops = [{ roll = \"90 deg\" }, {}]\n"
            .to_owned(),
        "[source]\nuri = \"text:data/gyro.csv\"\n[source.text]\ndelimiter = \"comma\"\nheader = true\n\
         [source.text.gyro]\nx = \"gx\"\ny = 3\nz = 4\nunit = \"deg/s\"\naxes = [\"y\", \"x\", \"-z\"]\n\
         [source.text.accelerometer]\nfile = \"/data/a.csv\"\nx = 2\ny = 3\nz = 4\nunit = \"g\"\n\
         [source.reference]\n"
            .to_owned(),
        "[source]\nuri = \"fmu:/data/imu.fmu\"\n[source.fmu]\ninterface = \"model-exchange\"\n\
         time_limit = \"3 s\"\nstep = \"1 ms\"\ntolerance = 1e-7\n\
         parameters = { \"ship.mass\" = 3.2e6, \"x[1]\" = true, on = \"a \\\"b\\\"\", v = [1, 2] }\n\
         [source.fmu.map]\ngyro.rate = [\"-wy\", { variable = \"wx\", unit = \"deg/s\", scale = -2.0 }, \
         { constant = \"1 deg/h\" }]\naccelerometer.specific_force = \"f\"\n\
         [endpoint]\nuri = \"fmu:/data/core.fmu\"\n[endpoint.fmu]\nprocess = \"shared\"\n\
         modes = { calibrating = [1, \"turning\"], done = 4 }\n\
         [endpoint.fmu.map]\nmode = \"phase\"\n"
            .to_owned(),
    ];
    for text in texts {
        let text = format!("{head}{text}");
        let parse = |text: &str, folder: &str| {
            Scenario::parse(text, "f", Path::new(folder), &[])
                .unwrap_or_else(|error| panic!("{error}\n{text}"))
        };
        let scenario = parse(&text, "/runs");
        let resolved = scenario.to_resolved_toml(1, &DrawnValues::of(&scenario, &Seeded(1)));
        let again = parse(&resolved, "/elsewhere");
        let place = |text: String| text.replace("\"data/gyro.csv\"", "\"/runs/data/gyro.csv\"");
        assert_eq!(
            both_configurations(&again),
            place(both_configurations(&scenario)),
            "{resolved}"
        );
    }
}

#[test]
fn the_quick_scenario_is_what_its_header_says() {
    let file = files().into_iter().find(|file| file.ends_with("quick.toml")).unwrap();
    let scenario = Scenario::load(&file, &[]).unwrap();
    assert_eq!(scenario.calibration_samples(), 4 * 3600 * 200);
    assert_eq!(scenario.samples(), Some(28 * 3600 * 200));
    let (eight, six) = (scenario.calibration.unwrap(), scenario.baseline.unwrap());
    assert!(
        eight.estimates(ParameterGroup::GDependent) && !six.estimates(ParameterGroup::GDependent)
    );
    assert_eq!((eight.sequence.stops().len(), six.sequence.stops().len()), (19, 17));
    // 16 moves of 90°: 10 s each; 17 equal dwells fill the rest.
    assert!((six.dwell_s - (14400.0 - 160.0) / 17.0).abs() < 1e-9, "{}", six.dwell_s);
    // 14 moves of 90° and four of 45°, 5.5 s each; two of the dwells are double.
    assert!((eight.dwell_s - (14400.0 - 162.0) / 21.0).abs() < 1e-9, "{}", eight.dwell_s);
}
