//! Scores of attitude and velocity compared with closed forms and golden numbers.

use crate::common::program::ends;
use octant_base::control::Control;
use octant_base::display::UnitChoice;
use octant_earth::ellipsoid::{EARTH_RATE_RADPS, Ellipsoid};
use octant_earth::units::{ARCMIN, ARCSEC, DEG, DEG_PER_HOUR, DEG_PER_SQRT_HOUR, MICRO_G};
use octant_observe::ensemble::ensemble;
use octant_run::assemble::{assemble, text as text_of};
use octant_run::{StreamKeeping, run_method};
use octant_scenario::{Method, Scenario};
use octant_score::attitude::CaseAngles;
use octant_score::drift::{DriftSample, DriftScorer};
use octant_score::floor::Floor;
use octant_score::summary::{
    AlignmentReference, ErrorScore, HeightChannel, NavigationScore, SolutionScore, Summary,
};
use std::f64::consts::PI;
use std::path::Path;

const LATITUDE: f64 = 30.5 * DEG;

fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "found {found}, expected {expected}");
}

/// Growth of φ (north, east, down) and velocity (north, east) from one error.
struct Growth {
    latitude_deg: f64,
    error: String,
    si: f64,
    /// Hours, φ in arcmin, velocity in m/s.
    rows: Vec<[f64; 6]>,
}

fn golden() -> Vec<Growth> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/golden/solution.json");
    let value: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let rows = value["rows"].as_array().unwrap().iter();
    rows.map(|row| {
        let unit = match row["unit"].as_str().unwrap() {
            "deg/h" => DEG_PER_HOUR,
            "ug" => MICRO_G,
            "arcsec" => ARCSEC,
            "m/s" => 1.0,
            other => panic!("unit {other}"),
        };
        Growth {
            latitude_deg: row["latitude_deg"].as_f64().unwrap(),
            error: row["error"].as_str().unwrap().to_owned(),
            si: row["value"].as_f64().unwrap() * unit,
            rows: serde_json::from_value(row["hours_phi_arcmin_velocity_mps"].clone()).unwrap(),
        }
    })
    .collect()
}

#[test]
fn the_error_model_of_the_floor_turns_and_moves_as_the_golden_one() {
    let mut compared = 0;
    for Growth { latitude_deg, error: name, si, rows } in golden() {
        let (mut initial, mut error) = ([0.0; 7], [0.0; 5]);
        match name.as_str() {
            "gyro_error_north" => error[0] = si,
            "gyro_error_east" => error[1] = si,
            "gyro_error_down" => error[2] = si,
            "accel_error_north" => error[3] = si,
            "accel_error_east" => error[4] = si,
            "initial_phi_north" => initial[0] = si,
            "initial_phi_down" => initial[2] = si,
            "initial_velocity_error_east" => initial[4] = si,
            other => panic!("error {other}"),
        }
        let model = Floor::new(latitude_deg * DEG, 0.0, 0.0, 0.0);
        for [hours, phi_n, phi_e, phi_d, north, east] in rows {
            let states = model.propagate_states(initial, &error, hours * 3600.0);
            for (found, expected) in states[..3].iter().zip([phi_n, phi_e, phi_d]) {
                assert_near(found / ARCMIN, expected, 1e-6);
            }
            assert_near(states[3], north, 1e-9);
            assert_near(states[4], east, 1e-9);
            compared += 1;
        }
    }
    assert_eq!(compared, 96);
}

/// Runs an instrument without noise and errors but for `errors`, at heading 0 with the gimbals at rest.
fn run(errors: &str, alignment: &str, hours: u32) -> Summary {
    let text = format!(
        "schema = 1\ntitle = \"one error\"\nseed = 1\n\
         [imu]\nangle_random_walk = \"0 deg/sqrt(h)\"\nvelocity_random_walk = \"0 ug/sqrt(Hz)\"\n\
         gyro_scale = {{ uniform = \"0 ppm\" }}\ngyro_misalignment = {{ uniform = \"0 arcsec\" }}\n\
         g_dependent = {{ normal = \"0 deg/h/g\" }}\naccel_scale = {{ uniform = \"0 ppm\" }}\n\
         accel_misalignment = {{ uniform = \"0 arcsec\" }}\n{errors}\n\
         [procedure.alignment]\n{alignment}\n\
         [procedure.navigation]\nduration = \"{hours} h\"\nrotation = \"none\"\n"
    );
    let scenario = Scenario::parse(&text, "text", Path::new(""), &[]).unwrap();
    let control = Control::default();
    let run = run_method(&scenario, Method::Primary, 1, StreamKeeping::None, &control).unwrap();
    assemble(&scenario, 1, run, None).unwrap().summary
}

/// Final errors of heading, pitch, roll (arcmin), north, east (m/s).
fn finals(summary: &Summary) -> [f64; 5] {
    let scores = summary.navigation.as_ref().unwrap().errors();
    [2, 3, 4, 5, 6].map(|i| scores[i].2.unwrap().r#final)
}

#[test]
fn a_run_with_one_sensor_error_turns_and_moves_as_the_golden_one() {
    const EXACT: &str = "attitude_error = [\"0 arcsec\", \"0 arcsec\", \"0 arcsec\"]\n\
                         velocity_error = [\"0 m/s\", \"0 m/s\", \"0 m/s\"]";
    let gyro = |axes: [&str; 3]| {
        format!(
            "gyro_bias = {{ constant = [\"{} deg/h\", \"{} deg/h\", \"{} deg/h\"] }}\naccel_bias = {{ normal = \"0 ug\" }}",
            axes[0], axes[1], axes[2]
        )
    };
    let none = gyro(["0", "0", "0"]);
    let accel = "gyro_bias = { normal = \"0 deg/h\" }\naccel_bias = { constant = [\"10 ug\", \"0 ug\", \"0 ug\"] }";
    let turned = EXACT.replacen("\"0 arcsec\"]", "\"360 arcsec\"]", 1);
    for (name, errors, alignment) in [
        ("gyro_error_north", gyro(["0.01", "0", "0"]), EXACT),
        ("gyro_error_east", gyro(["0", "0.01", "0"]), EXACT),
        ("gyro_error_down", gyro(["0", "0", "0.01"]), EXACT),
        ("accel_error_north", accel.to_owned(), EXACT),
        ("initial_phi_down", none, &turned),
    ] {
        let all = golden();
        let growth = all.iter().find(|g| g.latitude_deg == 30.5 && g.error == name).unwrap();
        for hours in [1, 3] {
            let row = growth.rows.iter().find(|row| row[0] == f64::from(hours)).unwrap();
            let [_, phi_n, phi_e, phi_d, north, east] = *row;
            let expected = [-phi_d, -phi_e, -phi_n, north, east];
            let found = finals(&run(&errors, alignment, hours));
            // Terms of second order, and the counts, are below a thousandth of the largest error so far.
            let largest = |columns: std::ops::Range<usize>| {
                let so_far = growth.rows.iter().filter(|row| row[0] <= f64::from(hours));
                so_far.flat_map(|row| &row[columns.clone()]).fold(0.0f64, |m, x| m.max(x.abs()))
            };
            let (angles, speeds) = (largest(1..4), largest(4..6));
            for (i, scale) in [angles, angles, angles, speeds, speeds].into_iter().enumerate() {
                let (found, expected) = (found[i], expected[i]);
                assert!(
                    (found - expected).abs() <= 1e-3 * scale,
                    "{name}, {hours} h, {i}: found {found}, expected {expected}"
                );
            }
        }
    }
}

#[test]
fn an_alignment_has_its_attitude_errors_and_sigma() {
    let none = "gyro_bias = { normal = \"0 deg/h\" }\naccel_bias = { normal = \"0 ug\" }";
    let given = "attitude_error = [\"60 arcsec\", \"-120 arcsec\", \"360 arcsec\"]\n\
                 velocity_error = [\"0.02 m/s\", \"-0.01 m/s\", \"0 m/s\"]";
    let alignment = run(none, given, 1).alignment.unwrap();
    assert_eq!((alignment.reference, alignment.duration_s), (AlignmentReference::External, 0.0));
    let SolutionScore { heading_arcmin, pitch_arcmin, roll_arcmin, .. } = alignment.solution;
    // One sample later: the attitude has turned by a few milliseconds of arc.
    assert_near(heading_arcmin.error.unwrap(), -6.0, 1e-3);
    assert_near(pitch_arcmin.error.unwrap(), 2.0, 1e-2);
    assert_near(roll_arcmin.error.unwrap(), -1.0, 1e-2);
    // The encoders add their error, of 18″.
    assert_near(alignment.solution.heading_deg.unwrap(), -0.1, 0.01);
    assert_near(alignment.solution.velocity_north_mps.error.unwrap(), 0.02, 1e-4);
    // Without a filter there is no covariance.
    assert_eq!(heading_arcmin.sigma, None);
    // By gravity and Earth rate, the error of an east gyro of 0.01 °/h is ε/(Ω cos L) of φ down.
    let east = "gyro_bias = { constant = [\"0 deg/h\", \"0.01 deg/h\", \"0 deg/h\"] }\naccel_bias = { normal = \"0 ug\" }";
    let coarse = run(east, "method = \"coarse\"\nduration = \"300 s\"", 1).alignment.unwrap();
    assert_eq!(coarse.reference, AlignmentReference::Static);
    assert_near(coarse.duration_s, 300.0, 0.011);
    let expected = 0.01 * DEG_PER_HOUR / (EARTH_RATE_RADPS * LATITUDE.cos()) / ARCMIN;
    assert_near(coarse.solution.heading_arcmin.error.unwrap(), -expected, 5e-3 * expected);
    assert_near(coarse.solution.pitch_arcmin.error.unwrap(), 0.0, 1e-2);
}

/// Scores errors (arcmin, m/s) that are the same for heading and north, with opposite signs for roll
/// and east.
fn scored(hours: f64, f: impl Fn(f64) -> f64) -> NavigationScore {
    let mut scorer = DriftScorer::new();
    for k in 0..=(hours * 120.0) as u32 {
        let t_s = 30.0 * f64::from(k);
        let x = f(t_s);
        scorer.push(&DriftSample {
            t_s,
            position_error_rad: Some([0.0, 0.0]),
            attitude_error: Some(CaseAngles {
                heading_rad: x * ARCMIN,
                pitch_rad: 0.0,
                roll_rad: -x * ARCMIN,
            }),
            velocity_error_mps: Some([x, -x]),
            latitude_rad: LATITUDE,
            height_m: 0.0,
        });
    }
    scorer.finish(HeightChannel::Held).unwrap()
}

#[test]
fn secular_and_schuler_parts_are_told_apart() {
    let schuler = 2.0 * PI / Ellipsoid::at(LATITUDE, 0.0).schuler_period_s();
    for hours in [1.5, 3.1, 7.0, 23.0, 72.0] {
        let n = scored(hours, |t| 0.3 + 0.2 * t / 86_400.0 + 0.5 * (schuler * t + 0.7).sin());
        let heading: ErrorScore = n.heading_error_arcmin.unwrap();
        for (score, sign) in [
            (heading, 1.0),
            (n.velocity_north_error_mps.unwrap(), 1.0),
            (n.roll_error_arcmin.unwrap(), -1.0),
            (n.velocity_east_error_mps.unwrap(), -1.0),
        ] {
            assert_near(score.slope_per_day.unwrap(), sign * 0.2, 1e-6);
            assert_near(score.schuler_amplitude.unwrap(), 0.5, 1e-6);
        }
        assert_eq!(
            n.pitch_error_arcmin.unwrap().schuler_amplitude.map(|a| a.abs() < 1e-9),
            Some(true)
        );
    }
    assert_eq!(scored(1.0, |t| t).heading_error_arcmin.unwrap().schuler_amplitude, None);
}

#[test]
fn the_schuler_part_is_that_of_each_period() {
    let schuler = 2.0 * PI / Ellipsoid::at(LATITUDE, 0.0).schuler_period_s();
    // Foucault turns the plane of the oscillation once in 47 h: over 72 h one phase for all of it would
    // nearly cancel. Its slow change bends the fits of the periods by less than 1 %.
    let foucault = EARTH_RATE_RADPS * LATITUDE.sin();
    let n = scored(72.0, |t| (foucault * t).cos() * (schuler * t).sin());
    let expected = 0.5f64.sqrt();
    let found = n.heading_error_arcmin.unwrap().schuler_amplitude.unwrap();
    assert_near(found, expected, 0.03 * expected);
    // An oscillation at the Earth rate leaks by 2(Ω/ω)² of it at most.
    let n = scored(72.0, |t| (EARTH_RATE_RADPS * t).cos());
    let found = n.heading_error_arcmin.unwrap().schuler_amplitude.unwrap();
    assert!(found <= 2.0 * (EARTH_RATE_RADPS / schuler).powi(2), "{found}");
}

#[test]
fn errors_that_are_not_known_have_no_score() {
    let mut scorer = DriftScorer::new();
    for k in 0..100u32 {
        scorer.push(&DriftSample {
            t_s: f64::from(k),
            position_error_rad: Some([0.0, 0.0]),
            attitude_error: None,
            velocity_error_mps: (k != 50).then_some([0.0; 2]),
            latitude_rad: LATITUDE,
            height_m: 0.0,
        });
    }
    let n = scorer.finish(HeightChannel::Held).unwrap();
    assert_eq!(n.heading_error_arcmin, None);
    assert_eq!(n.velocity_east_error_mps, None);
}

#[test]
fn the_floor_of_attitude_and_velocity_is_that_of_noise_alone() {
    // Without Earth rate the white noise N of a gyro moves the tilt as a random walk that Schuler bounds:
    // σ² = N²(t/2 + sin 2ωt/4ω) (Britting, ch. 7). At 10 minutes the Earth's turn is below 5 %.
    let noise = 7e-4 * DEG_PER_SQRT_HOUR;
    let floor = Floor::new(LATITUDE, 0.0, noise, 0.0).at_heading(90.0 * DEG);
    let solution = floor.summary(600.0).solution.unwrap();
    let omega = 2.0 * PI / Ellipsoid::at(LATITUDE, 0.0).schuler_period_s();
    let tilt = noise * (300.0 + (2.0 * omega * 600.0f64).sin() / (4.0 * omega)).sqrt() / ARCMIN;
    for value in [solution.pitch_arcmin, solution.roll_arcmin] {
        assert_near(value.r#final, tilt, 0.05 * tilt);
        assert!(value.rms < value.r#final);
    }
    assert_near(solution.heading_arcmin.r#final, noise * 600f64.sqrt() / ARCMIN, 0.05 * tilt);
}

#[test]
fn the_largest_heading_error_of_noise_alone_is_that_of_a_brownian_motion() {
    // For a Wiener process W of one second, M = max |W| has E M² = E 1/τ, with τ the time of leaving
    // ±1, whose Laplace transform is 1/cosh √2s: E M² = ∫ u/cosh u du = 2G, Catalan's constant
    // G = 0.9159655941772190, and E M = √(π/2). Looked at n times, M is less by 0.5826/√n in the mean
    // (Siegmund, Advances in Applied Probability 11, 1979). At the equator the heading of the floor is
    // such a process but for the Earth's turn in the hour, (Ωt)²/3 of its variance at the end.
    let (noise, hours, steps) = (7e-4 * DEG_PER_SQRT_HOUR, 1.0f64, 60.0f64);
    let floor = Floor::new(0.0, 0.0, noise, 0.0);
    let missed = 0.5826 / steps.sqrt();
    let square = 2.0 * 0.915_965_594_177_219 - 2.0 * missed * (0.5 * PI).sqrt() + missed * missed;
    let expected = noise * (3600.0 * hours * square).sqrt() / ARCMIN;
    let found = floor.maxima(&[hours], 4000, 3)[0].solution.heading_arcmin;
    // 4000 members have a standard error of 0.6 %; without the steps it would be 5.4 % more.
    assert_near(found / expected, 1.0, 0.025);
}

#[test]
fn the_largest_errors_of_noise_alone_turn_with_the_case_and_exceed_their_last() {
    let (arw, vrw) = (7e-4 * DEG_PER_SQRT_HOUR, 50.0 * MICRO_G);
    let north = Floor::new(LATITUDE, 0.0, arw, vrw);
    let east = north.clone().at_heading(90.0 * DEG);
    let hours = 24.0;
    let [a, b] = [&north, &east].map(|floor| floor.maxima(&[hours], 400, 1)[0].solution);
    // With the bow to the east, pitch is what roll was to the north, with the other sign.
    assert_near(b.roll_arcmin / a.pitch_arcmin, 1.0, 1e-12);
    assert_near(b.pitch_arcmin / a.roll_arcmin, 1.0, 1e-12);
    assert_eq!(a.heading_arcmin, b.heading_arcmin);
    let summary = north.summary(hours * 3600.0);
    let last = summary.sigma.last().and_then(|point| point.solution).unwrap();
    let of = summary.solution.unwrap();
    for name in ["heading", "pitch", "roll", "north", "east"] {
        let (max, sigma) = (a.of(name).unwrap(), last.of(name).unwrap());
        assert_eq!(sigma, of.of(name).unwrap().r#final, "{name}");
        // The rms of the maximum is above that of the last value; a walk has √2G, an oscillation
        // whose amplitude grows has less than the √2 of its amplitude times that.
        assert!(max > 1.1 * sigma && max < 2.0 * sigma, "{name}: {max} of {sigma}");
    }
    assert_eq!(last.of("longitude"), None);
}

#[test]
fn a_predicted_ensemble_obeys_the_units_and_its_json_keeps_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("s.toml");
    let text = "schema = 1\n[procedure.calibration]\npositions = \"six\"\nduration = \"1 h\"\n\
                [procedure.navigation]\nduration = \"2 h\"\n[display]\nvelocity = \"kn\"\n";
    std::fs::write(&file, text).unwrap();
    let file = file.to_str().unwrap();
    let shown = |more: &[&str]| ends(&[&["observe", file], more].concat(), 0).0;
    let row = |text: &str, name: &str| -> Vec<f64> {
        let line = text.lines().rfind(|line| line.trim_start().starts_with(name));
        let words = line.unwrap_or_else(|| panic!("no {name} in {text}")).split_whitespace();
        words.filter_map(|word| word.replace('−', "-").parse().ok()).collect()
    };
    let near = |found: f64, expected: f64| {
        assert!((found / expected - 1.0).abs() < 2e-2, "found {found}, expected {expected}");
    };
    let (plain, other) =
        (shown(&["--ensemble"]), shown(&["--ensemble", "--units", "m,arcsec,m/s"]));
    assert!(plain.contains("latitude, arcmin") && plain.contains("50, 95 %, nmi"), "{plain}");
    assert!(other.contains("latitude, m") && other.contains("50, 95 %, m"), "{other}");
    let line = |text: &str, name: &str| {
        text.lines().rfind(|line| line.trim_start().starts_with(name)).unwrap().to_owned()
    };
    assert!(
        line(&plain, "heading").ends_with(" arcmin") && line(&other, "roll").ends_with(" arcsec")
    );
    assert!(line(&plain, "velocity north").ends_with(" kn"));
    assert!(line(&other, "velocity east").ends_with(" m/s"));
    near(row(&other, "heading")[0], 60.0 * row(&plain, "heading")[0]);
    // A knot is 1852 m in an hour.
    near(row(&plain, "velocity north")[0], row(&other, "velocity north")[0] * 3600.0 / 1852.0);
    // The last row of the drift: hours, three percentiles each of latitude and longitude, two radial.
    let (last, metres) = (row(&plain, "2.0"), row(&other, "2.0"));
    let earth = Ellipsoid::at(LATITUDE, 0.0);
    near(metres[3], last[3] * earth.meridian_radius_m * ARCMIN);
    near(metres[6], last[6] * earth.transverse_radius_m * earth.cos_latitude * ARCMIN);
    near(metres[8], last[8] * 1852.0);
    assert!(shown(&["--units", "km"]).contains("predicted drift in navigation, 1σ, km"));
}

#[test]
fn a_calibration_ends_with_an_attitude_and_its_sigma() {
    let text = "schema = 1\n[imu]\nrate = \"20 Hz\"\n[motion]\nkind = \"static\"\nheading = \"40 deg\"\n\
                [procedure.calibration]\npositions = \"six\"\nduration = \"1 h\"\n";
    let scenario = Scenario::parse(text, "text", Path::new(""), &[]).unwrap();
    let control = Control::default();
    let run = run_method(&scenario, Method::Primary, 1, StreamKeeping::None, &control).unwrap();
    let calibration = run.calibration.unwrap();
    assert_eq!(calibration.refused, None);
    assert_eq!(calibration.reference, Some(AlignmentReference::Static));
    let solution = calibration.solution.unwrap();
    // The σ that is predicted without a run; about the heading it is φ down.
    let predicted = ensemble(&scenario, Method::Primary).unwrap();
    let believed = |name: &str| {
        let state = predicted.states.iter().find(|state| state.name == name).unwrap();
        state.believed.unwrap()
    };
    let heading = solution.heading_arcmin.sigma.unwrap();
    assert_near(heading, believed("phi_down") / 60.0, 0.02 * heading);
    let tilts = [believed("phi_north"), believed("phi_east")].map(|sigma| sigma / 60.0);
    let (s, c) = (40.0 * DEG).sin_cos();
    let roll = (c * tilts[0]).hypot(s * tilts[1]);
    // Without the correlation of the tilts, which is small.
    assert_near(solution.roll_arcmin.sigma.unwrap(), roll, 0.1 * roll);
    let north = solution.velocity_north_mps.sigma.unwrap();
    assert_near(north, believed("velocity_north"), 0.02 * north);
    for (name, _, point) in solution.points() {
        let normalized = point.normalized.unwrap();
        assert!(normalized.abs() < 5.0, "{name}: {normalized} σ");
        assert_near(point.error.unwrap() / point.sigma.unwrap(), normalized, 1e-12);
    }
    assert_near(solution.heading_deg.unwrap(), 40.0, 0.1);
    // The filter took over from the alignment with its prior: 360″ about down.
    let alignment = run.alignment.unwrap();
    assert_near(alignment.solution.heading_arcmin.sigma.unwrap(), 6.0, 1e-6);
}

#[test]
fn report_and_terminal_obey_the_units_and_the_summary_keeps_its_own() {
    let text = |display: &str| {
        format!(
            "schema = 1\n[imu]\nrate = \"20 Hz\"\n{display}\
             [procedure.navigation]\nduration = \"2 h\"\nrotation = \"none\"\n"
        )
    };
    let run = |display: &str, settings: &[String]| {
        let scenario = Scenario::parse(&text(display), "text", Path::new(""), settings).unwrap();
        let control = Control::default();
        let run = run_method(&scenario, Method::Primary, 1, StreamKeeping::None, &control).unwrap();
        assemble(&scenario, 1, run, None).unwrap()
    };
    let plain = run("", &[]);
    let other = run("[display]\nposition = \"m\"\nattitude = \"deg\"\nvelocity = \"kn\"\n", &[]);
    let chosen: UnitChoice = "m,deg,kn".parse().unwrap();
    let set = run("", &chosen.settings());
    assert_eq!(plain.summary.to_json().unwrap(), other.summary.to_json().unwrap());
    assert_eq!(other.report.units, set.report.units);
    let terminal = [&plain, &other].map(|run| text_of(&run.summary, &run.report.units));
    assert!(
        terminal[0].contains(" arcmin/day") && terminal[0].contains(" m/s\n"),
        "{}",
        terminal[0]
    );
    for unit in [" m, ", " m/day", " m/h", " deg\n", " kn\n"] {
        assert!(terminal[1].contains(unit), "{unit}: {}", terminal[1]);
    }
    // 0.05 arcmin a metre and more: the number is the score's in the other unit.
    let n = plain.summary.navigation.as_ref().unwrap();
    let arcmin_m = Ellipsoid::at(LATITUDE, 0.0).meridian_radius_m * ARCMIN;
    let metres =
        format!("latitude  max {:.1}, rms", n.latitude_error_arcmin.unwrap().max * arcmin_m);
    assert!(terminal[1].contains(&metres), "{metres}: {}", terminal[1]);
    let knots = n.velocity_north_error_mps.unwrap().max * 3600.0 / 1852.0;
    assert!(terminal[1].contains(&format!("north max {knots:.3}")), "{}", terminal[1]);
    let page = octant_report::run::render(&other.report);
    assert!(page.contains("Latitude error, largest, m<") && page.contains(">kn<"));
    assert!(!page.contains("arcmin"), "a score in arcmin is left");
}
