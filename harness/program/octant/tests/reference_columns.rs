//! A reference that comes with a recording: columns of text, fields of an MCAP topic, at a rate and stamps of its own.

use crate::common::program::{ends, json};
use octant_recorder::reader::{Epochs, Recording};
use octant_sample::{Aiding, Reference};
use serde_json::Value;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::PathBuf;

/// A calibration with a move, aligned without the truth.
const PROCEDURE: &str = "
[imu]
rate = \"50 Hz\"
[procedure.alignment]
method = \"inertial\"
duration = \"5 min\"
[procedure.calibration]
duration = \"15 min\"
prior = { position = \"1 m\" }
stops = [{ azimuth = \"0 deg\", roll = \"0 deg\" }, { azimuth = \"0 deg\", roll = \"90 deg\" }]
[screening]
jumps = \"off\"
";
const SHIP: &str = "
[motion]
kind = \"dockside\"
heading = \"40 deg\"
[motion.ship]
roll = []
pitch = []
yaw = []
surge = [{ amplitude = \"0.2 m\", period = \"8 s\", phase = \"0.3 rad\" }]
sway = []
heave = [{ amplitude = \"0.1 m\", period = \"7 s\", phase = \"1.1 rad\" }]
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
const GIMBAL: &str = "
[source.text.gimbal]
azimuth = \"gimbal_azimuth_deg\"
roll = \"gimbal_roll_deg\"
";

/// A run of the plant in a folder, with its samples as text.
struct Recorded {
    folder: tempfile::TempDir,
    summary: Value,
}

impl Recorded {
    fn of(more: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name).display().to_string();
        let text = format!("schema = 1\nseed = 5\n{PROCEDURE}{more}[record]\nsamples = \"full\"\n");
        std::fs::write(at("plant.toml"), text).unwrap();
        ends(&["run", &at("plant.toml"), "--out", &at("plant")], 0);
        let csv = ["--to", "csv", "--tables", "samples,aiding", "--out", &at("samples")];
        ends(&[&["export", &at("plant")], &csv[..]].concat(), 0);
        let summary = json(&folder.path().join("plant/summary.json"));
        Self { folder, summary }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn aiding(&self) -> Vec<Aiding> {
        let mut epochs = Epochs::new(Recording::open(&self.path("plant/recording.mcap")).unwrap());
        std::iter::from_fn(|| epochs.next_epoch().unwrap())
            .filter_map(|epoch| epoch.aiding)
            .collect()
    }

    /// Runs the chain on the recording, and returns its summary.
    fn chain(&self, name: &str, more: &str, status: i32) -> Value {
        let scenario = self.path(&format!("{name}.toml"));
        std::fs::write(&scenario, format!("schema = 1\nseed = 5\n{PROCEDURE}{more}")).unwrap();
        let out = self.path(name);
        ends(&["run", scenario.to_str().unwrap(), "--out", out.to_str().unwrap()], status);
        json(&out.join("summary.json"))
    }
}

/// One line a reference, with all digits.
fn text_of(header: &str, aiding: &[Aiding]) -> String {
    let mut text = format!("{header}\n");
    for Aiding { device_time, reference } in aiding {
        let [a, b, c] = match *reference {
            Reference::Velocity([north, east, down]) => [north, east, -down],
            Reference::Position { latitude_rad, longitude_rad, height_m } => {
                [latitude_rad, longitude_rad, height_m]
            }
        };
        writeln!(text, "{} {a:?} {b:?} {c:?}", device_time.ns).unwrap();
    }
    text
}

#[test]
fn a_velocity_in_columns_gives_the_bits_of_the_run_that_it_was_recorded_in() {
    let aiding = "[procedure.calibration.aiding]\nreference = \"zero-velocity\"\n";
    let recorded = Recorded::of(aiding);
    let references = recorded.aiding();
    assert!((899..=900).contains(&references.len()), "{}", references.len());
    std::fs::write(recorded.path("gnss.txt"), text_of("ns vn ve vu", &references)).unwrap();
    let columns = "[source.reference]\nkind = \"velocity\"\nfile = \"gnss.txt\"\ndelimiter = \"whitespace\"\n\
                   time_column = \"ns\"\ntime_unit = \"ns\"\nnorth = \"vn\"\neast = \"ve\"\nup = 4\n";
    let summary = recorded.chain("own", &format!("{aiding}{COLUMNS}{GIMBAL}{columns}"), 0);
    assert_eq!(summary["stream_hash"], recorded.summary["stream_hash"]);
    let parameters = |summary: &Value| summary["calibration"]["parameters"].clone();
    for (name, value) in parameters(&summary).as_object().unwrap() {
        assert_eq!(value["estimate"], parameters(&recorded.summary)[name]["estimate"], "{name}");
    }
    // The file is an input of the run, as the samples are.
    let manifest = std::fs::read_to_string(recorded.path("own/manifest.json")).unwrap();
    assert!(manifest.contains("gnss.txt"), "{manifest}");

    // In the rows of the samples, empty between measurements, and with the stamps of the rows.
    let samples = std::fs::read_to_string(recorded.path("samples/samples.csv")).unwrap();
    let table = std::fs::read_to_string(recorded.path("samples/aiding.csv")).unwrap();
    let field = |line: &str, index: usize| line.split(',').nth(index).unwrap().to_owned();
    let index = |table: &str, name: &str| {
        let first = table.lines().next().unwrap();
        first.split(',').position(|found| found == name).unwrap_or_else(|| panic!("{first}"))
    };
    let stamp = index(&samples, "device_time_s");
    let of_aiding = ["velocity_north_mps", "velocity_east_mps", "velocity_down_mps"];
    let columns = of_aiding.map(|name| index(&table, name));
    let mut aided = table.lines().skip(1).peekable();
    let mut joined = format!("{},vn,ve,vd\n", samples.lines().next().unwrap());
    for line in samples.lines().skip(1) {
        let at = aided.next_if(|aided| field(aided, 0) == field(line, stamp));
        let values =
            columns.map(|column| at.map_or_else(String::new, |aided| field(aided, column)));
        writeln!(joined, "{line},{}", values.join(",")).unwrap();
    }
    assert_eq!(aided.next(), None, "every measurement has a sample");
    std::fs::write(recorded.path("joined.csv"), joined).unwrap();
    let uri = COLUMNS.replace("samples/samples.csv", "joined.csv");
    let columns =
        "[source.reference]\nkind = \"velocity\"\nnorth = \"vn\"\neast = \"ve\"\ndown = \"vd\"\n";
    let rows = recorded.chain("rows", &format!("{aiding}{uri}{GIMBAL}{columns}"), 0);
    assert_eq!(rows["stream_hash"], recorded.summary["stream_hash"]);
    // And without stamps at all: the row has the nominal one.
    let uri = uri.replace("\"device_time_s\"", "\"none\"\nrate = \"50 Hz\"");
    let rows = recorded.chain("none", &format!("{aiding}{uri}{GIMBAL}{columns}"), 0);
    assert_eq!(rows["stream_hash"], recorded.summary["stream_hash"]);
}

#[test]
fn a_position_is_the_same_from_text_and_from_a_topic() {
    let recorded = Recorded::of(SHIP);
    let references = recorded.aiding();
    std::fs::write(recorded.path("dock.txt"), text_of("# ns lat lon h", &references)).unwrap();
    let columns = "[source.reference]\nkind = \"position\"\nfile = \"dock.txt\"\nunit = \"rad\"\nheader = false\n\
                   delimiter = \"whitespace\"\ntime_column = 1\ntime_unit = \"ns\"\nlatitude = 2\n\
                   longitude = 3\nheight = 4\n";
    let own = recorded.chain("own", &format!("{SHIP}{COLUMNS}{GIMBAL}{columns}"), 0);
    assert_eq!(own["stream_hash"], recorded.summary["stream_hash"]);
    // An MCAP file has no gimbals here: the same as text without them.
    let text = recorded.chain("text", &format!("{SHIP}{COLUMNS}{columns}"), 0);
    let triad = |name: &str, field: &str, unit: &str, lsb: f64| {
        format!(
            "[source.mcap.{name}]\nx = \"{field}[0]\"\ny = \"{field}[1]\"\nz = \"{field}[2]\"\nunit = \"{unit}\"\n\
             quantity = \"increment\"\nscale = [{lsb:?}, {lsb:?}, {lsb:?}]\n"
        )
    };
    let mcap = format!(
        "[source]\nuri = \"replay:plant/recording.mcap\"\n[source.mcap]\ntopic = \"/imu\"\n\
         time_field = \"device_time_ns\"\n{}{}[source.reference]\nkind = \"position\"\ntopic = \"/aiding\"\n\
         time_field = \"device_time_ns\"\nunit = \"rad\"\nlatitude = \"value[0]\"\nlongitude = \"value[1]\"\n\
         height = \"value[2]\"\n",
        triad("gyro", "delta_theta", "rad", 2f64.powi(-36)),
        triad("accelerometer", "delta_velocity", "m/s", 2f64.powi(-30)),
    );
    let fields = recorded.chain("fields", &format!("{SHIP}{mcap}"), 0);
    assert_eq!(fields["stream_hash"], text["stream_hash"]);
    assert_ne!(fields["stream_hash"], own["stream_hash"], "gimbals");
}

/// Velocities from the closed form of the ship's motion, at a rate and phase of their own, rounded as receivers do.
#[test]
fn a_velocity_by_closed_form_is_right_where_a_standing_base_is_wrong() {
    let recorded = Recorded::of(SHIP);
    let (sine, cosine) = 40f64.to_radians().sin_cos();
    let mut text = String::from("t,vn,ve,vd\n");
    // Every 0.5 s, off the grid of 20 ms by 7 ms, with an outage of half a minute.
    for k in (0..2400).filter(|k| !(1000..1060).contains(k)) {
        let t_s = 0.5 * f64::from(k) + 0.307;
        let rate = |amplitude: f64, period: f64, phase: f64| {
            amplitude * TAU / period * (TAU * t_s / period + phase).cos()
        };
        let (surge, heave) = (rate(0.2, 8.0, 0.3), rate(0.1, 7.0, 1.1));
        let mms = [surge * cosine, surge * sine, heave].map(|v| (v * 1e3).round());
        writeln!(text, "{t_s:.3},{},{},{}", mms[0], mms[1], mms[2]).unwrap();
    }
    std::fs::write(recorded.path("gnss.csv"), text).unwrap();
    let aiding = "[procedure.calibration.aiding]\nperiod = \"0.5 s\"\nsigma = \"2 mm/s\"\n";
    let columns = "[source.reference]\nkind = \"velocity\"\nfile = \"gnss.csv\"\ntime_column = \"t\"\n\
                   unit = \"mm/s\"\nnorth = \"vn\"\neast = \"ve\"\ndown = \"vd\"\n";
    let moving = recorded.chain("moving", &format!("{SHIP}{aiding}{COLUMNS}{GIMBAL}{columns}"), 3);
    // Within 7 ms the ship's 0.12 m/s² are 0.9 mm/s: half of sigma at most, as is the rounding.
    let nis = moving["calibration"]["nis_mean"].as_f64().unwrap();
    assert!((0.1..3.0).contains(&nis), "{nis}");
    let solution = &moving["calibration"]["solution"];
    let truth = &recorded.summary["calibration"]["solution"];
    for angle in ["heading_deg", "pitch_deg", "roll_deg"] {
        let arcmin = angle.replace("_deg", "_arcmin");
        let true_deg =
            truth[angle].as_f64().unwrap() - truth[&arcmin]["error"].as_f64().unwrap() / 60.0;
        let error_arcmin = (solution[angle].as_f64().unwrap() - true_deg) * 60.0;
        let sigma = solution[&arcmin]["sigma"].as_f64().unwrap();
        assert!(error_arcmin.abs() < 4.0 * sigma, "{angle}: {error_arcmin} ± {sigma} arcmin");
    }
    // The outage is counted: no sample has a reference of another time.
    let lost = moving["calibration"]["health"]["aiding_lost"].as_u64().unwrap();
    assert!((55..=65).contains(&lost), "{lost}");
    // Declared as standing, the same samples contradict the filter.
    let scenario = recorded.path("standing.toml");
    let standing = aiding.replace("sigma", "reference = \"velocity\"\nsigma");
    let text =
        format!("schema = 1\n{PROCEDURE}{SHIP}{standing}{COLUMNS}{GIMBAL}[source.reference]\n");
    std::fs::write(&scenario, text).unwrap();
    let out = recorded.path("standing");
    let (told, _) = ends(&["run", scenario.to_str().unwrap(), "--out", out.to_str().unwrap()], 1);
    assert!(told.contains("refused"), "{told}");
}
