//! The chain of real data: a recording whose base settles, aligned in the inertial frame, then filtered with what is
//! known of its motion.

use crate::common::program::{ends, json};
use nalgebra::{Quaternion, UnitQuaternion};
use octant_calibration::Core;
use octant_calibration::covariance::PHI;
use octant_calibration::inertial_alignment::AlignmentSigma;
use octant_earth::frames::phi_of;

use octant_plant::Plant;
use octant_sample::{GimbalCommand, Mode};
use octant_scenario::{Method, Scenario};
use octant_source::configure::configurations;
use std::path::Path;

/// A ring-laser unit with pulses of 0.1″ and 125 µg·s on a base that tilts by 0.2° in half an hour.
const SETTLING: &str = "
[imu]
rate = \"50 Hz\"
angle_random_walk = \"0.0007 deg/sqrt(h)\"
velocity_random_walk = \"10 ug/sqrt(Hz)\"
[imu.extensions]
gyro_quantization = \"0.1 arcsec\"
accel_quantization = \"0.0012258 m/s\"
[procedure.calibration]
duration = \"1 h\"
stops = [{ azimuth = \"0 deg\", roll = \"0 deg\" }]
aiding = { reference = \"velocity\" }
";
const BASE: &str = "
[motion]
kind = \"dockside\"
heading = \"40 deg\"
[motion.ship]
roll = [{ amplitude = \"0.2 deg\", period = \"2 h\" }]
pitch = []
yaw = []
surge = []
sway = []
heave = []
";
const INERTIAL: &str = "
[procedure.alignment]
method = \"inertial\"
duration = \"10 min\"
";
const COLUMNS: &str = "
[source]
uri = \"text:samples/samples.csv\"
[source.text]
delimiter = \"comma\"
header = true
time_column = \"device_time_s\"
[source.text.gyro]
x = \"delta_theta_x_rad\"
y = \"delta_theta_y_rad\"
z = \"delta_theta_z_rad\"
unit = \"rad\"
quantity = \"increment\"
[source.text.accelerometer]
x = \"delta_velocity_x_mps\"
y = \"delta_velocity_y_mps\"
z = \"delta_velocity_z_mps\"
unit = \"m/s\"
quantity = \"increment\"
";
const STATIC: &str = "
[source.reference]
kind = \"static\"
";

/// Runs the simulation and leaves its samples as text; returns the true heading at the end, deg.
fn recorded(folder: &Path, more: &str) -> f64 {
    let scenario = folder.join("settling.toml");
    let text =
        format!("schema = 1\nseed = 5\n{SETTLING}{BASE}{more}[record]\nsamples = \"full\"\n");
    std::fs::write(&scenario, text).unwrap();
    let run = folder.join("settling");
    ends(&["run", scenario.to_str().unwrap(), "--out", run.to_str().unwrap()], 0);
    let samples = folder.join("samples");
    ends(
        &[
            "export",
            run.to_str().unwrap(),
            "--to",
            "csv",
            "--tables",
            "samples",
            "--out",
            samples.to_str().unwrap(),
        ],
        0,
    );
    let solution = &json(&run.join("summary.json"))["calibration"]["solution"];
    let error = solution["heading_arcmin"]["error"].as_f64().unwrap();
    solution["heading_deg"].as_f64().unwrap() - error / 60.0
}

fn chain(folder: &Path, name: &str, text: &str) -> String {
    let scenario = folder.join(name);
    std::fs::write(&scenario, format!("schema = 1\n{SETTLING}{text}")).unwrap();
    scenario.display().to_string()
}

#[test]
fn a_recording_of_a_base_that_settles_is_aligned_and_filtered() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let heading_deg = recorded(folder, "");
    let out = folder.join("chain");
    let scenario = chain(folder, "chain.toml", &format!("{INERTIAL}{COLUMNS}{STATIC}"));
    let (told, _) = ends(&["run", &scenario, "--out", out.to_str().unwrap()], 0);
    let axes = "gyro x, y, z: delta_theta_x_rad, delta_theta_y_rad, delta_theta_z_rad; accelerometer x, y, z: ";
    for line in ["  axes of the source: ", "  columns        "] {
        assert!(told.contains(&format!("{line}{axes}")), "{told}");
    }
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains(&format!("Axes of the source: {axes}")));
    let summary = json(&out.join("summary.json"));
    let aligned = &summary["alignment"]["solution"];
    assert_eq!(
        (&summary["alignment"]["reference"], &summary["alignment"]["duration_s"]),
        (&"static".into(), &600.0.into())
    );
    let sigma = aligned["heading_arcmin"]["sigma"].as_f64().unwrap();
    assert!((5.9..6.5).contains(&sigma), "{aligned}");
    let solution = &summary["calibration"]["solution"];
    let sigma = solution["heading_arcmin"]["sigma"].as_f64().unwrap();
    let error = (solution["heading_deg"].as_f64().unwrap() - heading_deg) * 60.0;
    assert!(error.abs() < 3.0 * sigma && sigma < 2.0, "{error} arcmin, sigma {sigma}");
    // Pulses repeat, and no channel is stuck.
    let health = &summary["calibration"]["health"];
    assert_eq!(
        (&health["accelerometer_stuck"], &health["gyro_stuck"]),
        (&0.into(), &0.into()),
        "{health}"
    );
    // Rows without stamps follow each other at the nominal rate: the same samples.
    let rows = COLUMNS
        .replace("time_column = \"device_time_s\"", "time_column = \"none\"\nrate = \"50 Hz\"");
    let scenario = chain(folder, "rows.toml", &format!("{INERTIAL}{rows}{STATIC}"));
    let again = folder.join("rows");
    ends(&["run", &scenario, "--out", again.to_str().unwrap()], 0);
    assert_eq!(json(&again.join("summary.json"))["stream_hash"], summary["stream_hash"]);
}

#[test]
fn what_fits_no_latitude_is_refused_and_no_pass() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // Far beyond the prior of 0.005 deg/h that the chain believes.
    recorded(folder, "[imu.gyro_bias]\nconstant = [\"0.4 deg/h\", \"0 deg/h\", \"0 deg/h\"]\n");
    let scenario = chain(
        folder,
        "chain.toml",
        &format!(
            "{INERTIAL}{COLUMNS}{STATIC}[[requirements]]\nid = \"H\"\ntext = \"h\"\nmeasure = \"calibration.solution.heading_arcmin.sigma\"\nlimit = 60.0\n"
        ),
    );
    let out = folder.join("chain");
    let (told, _) = ends(&["run", &scenario, "--out", out.to_str().unwrap()], 1);
    assert!(told.contains("gravity turned by"), "{told}");
    assert_eq!(json(&out.join("summary.json"))["verdict"], "fail");
}

#[test]
fn a_filter_gets_one_reference_and_no_average_of_a_base_that_may_turn() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let refused = |text: &str| {
        let (_, said) = ends(&["run", &chain(folder, "wrong.toml", text)], 2);
        said
    };
    let said = refused(&format!("{INERTIAL}{COLUMNS}"));
    assert!(said.contains("source.uri") && said.contains("[source.reference]"), "{said}");
    let said = refused(&format!("{INERTIAL}{STATIC}"));
    assert!(said.contains("source.reference") && said.contains("reference of its own"), "{said}");
    let coarse = INERTIAL.replace("inertial", "coarse");
    let said = refused(&format!("{coarse}{COLUMNS}{STATIC}"));
    assert!(said.contains("procedure.alignment.method") && said.contains("\"inertial\""), "{said}");
    let noise = "[procedure.calibration.aiding]\nnoise = \"1 mm/s\"\n";
    let noisy = SETTLING.replace("aiding = { reference = \"velocity\" }\n", noise);
    let wrong = folder.join("noisy.toml");
    std::fs::write(&wrong, format!("schema = 1\n{noisy}{INERTIAL}{COLUMNS}{STATIC}")).unwrap();
    let (_, said) = ends(&["run", wrong.to_str().unwrap()], 2);
    assert!(said.contains("aiding.noise") && said.contains("without effect"), "{said}");
    let short = INERTIAL.replace("10 min", "5 s");
    let said = refused(&format!("{short}{COLUMNS}{STATIC}"));
    assert!(said.contains("procedure.alignment.duration") && said.contains("10 s"), "{said}");
}

/// Normalized attitude errors north, east, down of one run at the end of the alignment and of the calibration.
fn normalized(scenario: &Scenario, seed: u64) -> [[f64; 3]; 2] {
    let (plant, config, _) = configurations(scenario, Method::Primary, seed).unwrap();
    let octant_scenario::AlignmentSpec::Inertial { duration_s } = scenario.alignment else {
        panic!()
    };
    let sigma = AlignmentSigma::of(&config, duration_s).attitude_rad;
    let mut plant = Plant::new(&plant).unwrap();
    let mut core = Core::new(&config).unwrap();
    let mut command = GimbalCommand::default();
    let mut found = [[f64::NAN; 3]; 2];
    let samples = scenario.calibration_samples();
    let mut before = Mode::Aligning;
    for sample in 1..samples {
        let step = plant.step(&command);
        let output = core.step(&step.sample, step.aiding.as_ref());
        command = output.gimbal_command;
        assert_ne!(output.mode, Mode::Refused, "seed {seed}: {:?}", core.refusal());
        let attitude =
            |q: [f64; 4]| UnitQuaternion::new_unchecked(Quaternion::new(q[0], q[1], q[2], q[3]));
        let phi = || phi_of(&attitude(output.navigation.q_nb), &attitude(plant.truth().q_nb));
        if output.mode != before {
            before = output.mode;
            let phi = phi();
            found[0] = [0, 1, 2].map(|axis| phi[axis] / sigma[axis]);
        }
        if sample == samples - 1 {
            let (phi, filter) = (phi(), core.filter().unwrap());
            found[1] = [0, 1, 2].map(|axis| phi[axis] / filter.covariance().sigma(PHI + axis));
        }
    }
    found
}

/// Of 100 runs: errors within 3σ, and their normalized root mean square, at the end of alignment and calibration.
fn hundred(text: &str) -> [([usize; 3], [f64; 3]); 2] {
    let scenario =
        Scenario::parse(&format!("schema = 1\n{text}"), "test.toml", Path::new(""), &[]).unwrap();
    let mut within = [[0; 3]; 2];
    let mut squares = [[0.0; 3]; 2];
    for seed in 1..=100 {
        for (moment, errors) in normalized(&scenario, seed).iter().enumerate() {
            for axis in 0..3 {
                within[moment][axis] += usize::from(errors[axis].abs() <= 3.0);
                squares[moment][axis] += errors[axis] * errors[axis] / 100.0;
            }
        }
    }
    [0, 1].map(|moment| (within[moment], squares[moment].map(f64::sqrt)))
}

#[test]
fn hundred_alignments_on_a_base_that_tilts_tell_their_sigma() {
    let found = hundred(&format!(
        "{}{INERTIAL}{BASE}",
        SETTLING.replace("50 Hz", "20 Hz").replace("1 h", "30 min")
    ));
    println!("{found:?}");
    for (within, rms) in found {
        assert!(within.into_iter().all(|count| count >= 99), "{found:?}");
        // The tilt of an alignment is that of the accelerometers' errors, uniform and not normal.
        assert!(rms.into_iter().all(|rms| (0.4..1.2).contains(&rms)), "{found:?}");
    }
}

#[test]
fn hundred_alignments_on_a_ship_tell_their_sigma() {
    let ship = "[motion]\nkind = \"dockside\"\nheading = \"40 deg\"\n[motion.ship]\npreset = \"default\"\n";
    let settling =
        SETTLING.replace("1 h", "30 min").replace("aiding = { reference = \"velocity\" }\n", "");
    let found = hundred(&format!("{settling}{INERTIAL}{ship}"));
    println!("{found:?}");
    for (within, rms) in found {
        assert!(within.into_iter().all(|count| count >= 99), "{found:?}");
        assert!(rms.into_iter().all(|rms| rms < 1.2), "{found:?}");
    }
}
