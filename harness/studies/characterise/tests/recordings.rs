//! Recordings of the plant: their terms are found again, the twin matches, Earth's rate is told; and recordings that aren't
//! of an instrument at rest are refused.

use octant_characterise::error::CharacteriseError;
use octant_characterise::kernel::RandomTerm;
use octant_characterise::recording::RestingRecording;
use octant_characterise::result::{Characterisation, characterise};
use octant_characterise::{page, text};
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{GimbalAngles, GimbalCommand};
use octant_scenario::Scenario;
use octant_scenario::resolve::{DrawnValues, Seeded};
use octant_source::{Epoch, PlantSource, Source};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

const HEADER: &str = "device_time_s,delta_theta_x_rad,delta_theta_y_rad,delta_theta_z_rad,delta_velocity_x_mps,\
    delta_velocity_y_mps,delta_velocity_z_mps\n";

/// Rows of the plant: time and increments.
fn plant(keys: &str, seed: u64, (azimuth, roll): (f64, f64), seconds: u64) -> Vec<[f64; 7]> {
    let text = format!("schema = 1\n{keys}\n[procedure.calibration]\n");
    let scenario = Scenario::parse(&text, "plant", Path::new(""), &[]).unwrap();
    let draws = DrawnValues::of(&scenario, &Seeded(seed));
    let samples = seconds * 1_000_000_000 / scenario.sample_period_ns;
    let settle = 30 * 1_000_000_000 / scenario.sample_period_ns;
    let mut source = PlantSource::new(&scenario.plant(seed, &draws), samples + settle).unwrap();
    let command = GimbalCommand { target: GimbalAngles::from_rad(azimuth, roll) };
    let mut epoch = Epoch::default();
    let mut rows = Vec::new();
    while source.next(&command, &mut epoch).unwrap() {
        let s = &epoch.sample;
        let theta = s.delta_theta.map(|count| f64::from(count) * DELTA_THETA_LSB_RAD);
        let velocity = s.delta_velocity.map(|count| f64::from(count) * DELTA_VELOCITY_LSB_MPS);
        let [a, b, c] = theta;
        let [d, e, f] = velocity;
        rows.push([s.device_time.ns as f64 * 1e-9, a, b, c, d, e, f]);
    }
    rows.split_off(settle as usize)
}

fn write(name: &str, rows: &[[f64; 7]]) -> PathBuf {
    let mut text = HEADER.to_owned();
    for row in rows {
        let cells: Vec<String> = row
            .iter()
            .enumerate()
            .map(|(i, x)| if i == 0 { format!("{x:.9}") } else { format!("{x:e}") })
            .collect();
        let _ = writeln!(text, "{}", cells.join(","));
    }
    let folder = std::env::temp_dir().join(format!("octant-characterise-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(format!("{name}.csv"));
    std::fs::write(&path, text).unwrap();
    path
}

fn characterised(name: &str, rows: &[[f64; 7]]) -> Result<Characterisation, CharacteriseError> {
    let path = write(name, rows);
    let result = RestingRecording::of(&path, None, &[])
        .and_then(|recording| characterise(&recording, Some(7)));
    std::fs::remove_file(path).unwrap();
    result
}

fn refusal(name: &str, rows: &[[f64; 7]]) -> String {
    characterised(name, rows).map(|_| ()).unwrap_err().to_string()
}

const INSTRUMENT: &str = "[imu]\nrate = \"50 Hz\"\nangle_random_walk = \"0.01 deg/sqrt(h)\"\n\
    velocity_random_walk = \"80 ug/sqrt(Hz)\"\n[imu.extensions]\ngyro_rate_random_walk = \"2 deg/h/sqrt(h)\"\n\
    gyro_quantization = \"0.05 arcsec\"\n";

#[test]
fn terms_of_the_plant_are_found_again_and_the_twin_matches() {
    let rows = plant(INSTRUMENT, 11, (0.0, 0.0), 2400);
    let result = characterised("terms", &rows).unwrap();
    assert_eq!(result.analysis.stretches.len(), 1);
    let truth = |text: &str| octant_scenario::quantity_of(text).unwrap().si;
    let walk = truth("0.01 deg/sqrt(h)");
    let wander = truth("2 deg/h/sqrt(h)");
    let quantization = truth("0.05 arcsec") / 12f64.sqrt();
    let noise = truth("80 ug/sqrt(Hz)");
    let covered = |term, range: std::ops::Range<usize>, value: f64| {
        result.analysis.channels[range]
            .iter()
            .filter(|channel| {
                let fit = *channel.noise.as_ref().unwrap().term(term).unwrap();
                fit.value.is_some()
                    && fit.interval[0] * 0.99 <= value
                    && value <= fit.interval[1] * 1.01
            })
            .count()
    };
    // Of three axes at 95 % each.
    assert!(covered(RandomTerm::RandomWalk, 0..3, walk) >= 2);
    assert!(covered(RandomTerm::RateRandomWalk, 0..3, wander) >= 2);
    assert!(covered(RandomTerm::Quantization, 0..3, quantization) >= 2);
    assert!(covered(RandomTerm::RandomWalk, 3..6, noise) >= 2);
    for channel in &result.analysis.channels {
        assert!(channel.noise.as_ref().unwrap().probability > 1e-3, "{}", channel.name);
        assert!(channel.lines.is_empty(), "{:?}", channel.lines);
        assert_eq!(channel.ramp.unwrap().value, None, "{}", channel.name);
    }
    let twin = result.twin.as_ref().unwrap();
    assert_eq!(
        twin.channels.iter().filter(|channel| channel.matches()).count(),
        6,
        "{:?}",
        twin.channels
    );
    Scenario::parse(&result.imu, "imu", Path::new(""), &[]).unwrap();
    let said = text::of(&result);
    assert!(said.contains("gyro random walk N, deg/sqrt(h)"), "{said}");
    assert!(page::render(&result, "octant characterise").contains("Simulated twin"));
    let json = serde_json::to_value(&result).unwrap();
    assert_eq!(json["schema"], 1);
}

#[test]
fn a_twin_of_another_instrument_differs() {
    let rows = plant(INSTRUMENT, 12, (0.0, 0.0), 600);
    let path = write("another", &rows);
    let recording = RestingRecording::of(&path, None, &[]).unwrap();
    let result = characterise(&recording, None).unwrap();
    std::fs::remove_file(path).unwrap();
    let other = result.imu.replace("angle_random_walk = \"", "angle_random_walk = \"1");
    let twin = octant_characterise::twin::simulate(&other, 3, &result.analysis.stretches).unwrap();
    let twin = octant_characterise::twin::compare(&result.analysis, twin, 3);
    assert!(twin.channels[..3].iter().all(|channel| !channel.matches()), "{:?}", twin.channels);
    assert!(twin.channels[3..].iter().all(octant_characterise::twin::ChannelMatch::matches));
}

#[test]
fn latitude_follows_from_attitudes() {
    let keys = "[site]\nlatitude = \"53 deg\"\n[imu]\nrate = \"50 Hz\"\ngyro_bias = { constant = [\"3 deg/h\", \"-2 deg/h\", \"1 deg/h\"] }\n";
    let quarter = std::f64::consts::FRAC_PI_2;
    let mut rows: Vec<[f64; 7]> = Vec::new();
    for (azimuth, roll) in [(0.0, 0.0), (0.0, quarter), (0.0, 2.0 * quarter), (quarter, quarter)] {
        let from = rows.last().map_or(0.0, |last| last[0] + 60.0);
        let part = plant(keys, 5, (azimuth, roll), 300);
        let first = part[0][0];
        rows.extend(part.into_iter().map(|mut row| {
            row[0] += from - first + 0.02;
            row
        }));
    }
    let result = characterised("attitudes", &rows).unwrap();
    let check = &result.earth_rate;
    assert_eq!((check.stretches, check.attitudes), (4, 4), "{check:?}");
    assert_eq!(result.gaps, 3);
    let [low, high] = check.latitude_interval_rad.unwrap().map(f64::to_degrees);
    assert!(low < 53.0 && 53.0 < high && high - low < 3.0, "{check:?}");
    let [cosine, sigma] = check.cosine.unwrap();
    assert!((cosine - 53f64.to_radians().cos()).abs() < 4.0 * sigma, "{check:?}");
    // Where gimbals and case are at zero body x points to the heading of the case, north.
    let [heading, sigma] = check.headings_rad[0].unwrap();
    let off =
        (heading + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
    assert!(off.abs() < 4.0 * sigma && sigma < 0.02, "{check:?}");
}

#[test]
fn one_attitude_tells_no_latitude() {
    let rows = plant(INSTRUMENT, 2, (0.0, 0.0), 120);
    let result = characterised("single", &rows).unwrap();
    assert_eq!(result.earth_rate.latitude_rad, None);
    assert!(text::of(&result).contains("latitude: not told, one attitude"));
}

#[test]
fn other_recordings_are_refused_with_a_reason() {
    let rows = plant(INSTRUMENT, 3, (0.0, 0.0), 90);
    let said = refusal("short", &rows[..1500]);
    assert!(said.contains("it lasts 30 s, expected 60 s at least"), "{said}");
    let mut stuck = rows.clone();
    stuck.iter_mut().for_each(|row| row[2] = 0.0);
    let said = refusal("stuck", &stuck);
    assert!(said.contains("gyro y is 0 in every sample") && said.contains("stuck"), "{said}");
    let mut nan = rows.clone();
    nan[700][4] = f64::NAN;
    let said = refusal("nan", &nan);
    assert!(said.contains("line 702") && said.contains("expected a finite number"), "{said}");
    let mut back = rows.clone();
    back[700..].iter_mut().for_each(|row| row[0] -= 5.0);
    let said = refusal("back", &back);
    assert!(said.contains("line 702: the clock goes back from"), "{said}");
    let path = write("columns", &rows);
    std::fs::write(&path, "a,b\n1,2\n3,4\n").unwrap();
    let said = RestingRecording::of(&path, None, &[]).unwrap_err().to_string();
    assert!(said.contains("--scenario"), "{said}");
    std::fs::remove_file(path).unwrap();
}

#[test]
fn motion_is_refused_and_gaps_end_stretches() {
    let ship = "[imu]\nrate = \"50 Hz\"\n[motion]\nkind = \"dockside\"\n[motion.ship]\npreset = \"harbour\"\n";
    let ship = ship
        .replace("preset = \"harbour\"", "roll = [{ amplitude = \"0.5 deg\", period = \"8 s\" }]");
    let said = refusal("sway", &plant(&ship, 4, (0.0, 0.0), 300));
    assert!(said.contains("it moves"), "{said}");
    let mut rows = plant(INSTRUMENT, 3, (0.0, 0.0), 200);
    rows.drain(5000..5100);
    let result = characterised("gap", &rows).unwrap();
    assert_eq!((result.gaps, result.analysis.stretches.len()), (1, 2));
}

/// Rows of the plant with a temperature in a column of their own; the rates of gyro x and accelerometer z follow it.
fn warm(name: &str, per_k: [f64; 2], change: &dyn Fn(usize, f64) -> String) -> PathBuf {
    let mut text = HEADER.replace('\n', ",temperature\n");
    for (k, mut row) in plant(INSTRUMENT, 21, (0.0, 0.0), 1200).into_iter().enumerate() {
        let t = 20.0 + 4.0 * (row[0] / 60.0).sin() + row[0] / 300.0;
        row[1] += per_k[0] * (t - 20.0) * 0.02;
        row[6] += per_k[1] * (t - 20.0) * 0.02;
        let cells: Vec<String> = row
            .iter()
            .enumerate()
            .map(|(i, x)| if i == 0 { format!("{x:.9}") } else { format!("{x:e}") })
            .collect();
        let _ = writeln!(text, "{},{}", cells.join(","), change(k, t));
    }
    let path = write(name, &[]);
    std::fs::write(&path, text).unwrap();
    path
}

fn characterised_warm(
    path: &Path,
    more: &[&str],
    seed: Option<u64>,
) -> Result<Characterisation, CharacteriseError> {
    let set: Vec<String> = more.iter().map(|set| (*set).to_owned()).collect();
    RestingRecording::of(path, None, &set).and_then(|recording| characterise(&recording, seed))
}

const COLUMN: &str = "source.text.temperature_column=temperature";

#[test]
fn a_temperature_is_told_and_its_part_leaves_the_noise_alone() {
    let written = |_: usize, t: f64| format!("{:.3}", t + 273.15);
    // 10 deg/h/K and 300 ug/K.
    let truth = [4.85e-5, 2.94e-3];
    let path = warm("warm", truth, &written);
    let cold = characterised_warm(&path, &[], None).unwrap();
    let kelvin = "source.text.temperature_unit=K";
    let result = characterised_warm(&path, &[COLUMN, kelvin], Some(7)).unwrap();
    let still = warm("still", [0.0; 2], &written);
    let without = characterised_warm(&still, &[], None).unwrap();
    std::fs::remove_file(still).unwrap();
    std::fs::remove_file(path).unwrap();
    assert!(cold.temperature.reason.as_ref().unwrap().contains("source.text.temperature_column"));
    let found = &result.temperature;
    assert_eq!(found.reason, None);
    let [low, high] = found.range_c.unwrap();
    assert!((15.0..18.0).contains(&low) && (25.0..29.0).contains(&high), "{found:?}");
    for (channel, truth) in [(0, truth[0]), (5, truth[1])] {
        let fit = &found.channels[channel];
        let [low, high] = fit.interval.unwrap();
        assert!(fit.per_k.is_some() && low <= truth && truth <= high, "{fit:?}");
    }
    // The same noise as that of the instrument that doesn't feel the temperature, but for what the fit took with it.
    for channel in [0, 5] {
        let rows = |result: &Characterisation| {
            let rows = &result.analysis.channels[channel].deviations;
            rows.iter().map(|row| (row.allan.deviation, row.allan.freedom)).collect::<Vec<_>>()
        };
        let (corrected, expected) = (rows(&result), rows(&without));
        for ((found, _), (expected, freedom)) in corrected.iter().zip(&expected) {
            assert!(
                *freedom < 3.0 || (found / expected - 1.0).abs() < 0.2,
                "{corrected:?}, {expected:?}"
            );
        }
        let last = expected.iter().rposition(|(_, freedom)| *freedom > 3.0).unwrap();
        assert!(
            rows(&cold)[last].0 > 2.0 * expected[last].0,
            "the temperature is in the deviations"
        );
        let walk = |result: &Characterisation| {
            *result.analysis.channels[channel]
                .noise
                .as_ref()
                .unwrap()
                .term(RandomTerm::RandomWalk)
                .unwrap()
        };
        let (found, expected) = (walk(&result), walk(&without));
        assert!((found.value.unwrap() / expected.value.unwrap() - 1.0).abs() < 0.01, "{found:?}");
    }
    // The file runs, with the coefficients that are shown.
    let scenario = Scenario::parse(&result.imu, "imu", Path::new(""), &[]).unwrap();
    let draws = DrawnValues::of(&scenario, &Seeded(1));
    let warmth = scenario.plant(1, &draws).imu.extensions.temperature.unwrap();
    let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-3;
    assert!(near(warmth.gyro_bias_per_k[0], found.channels[0].per_k.unwrap()), "{warmth:?}");
    assert!(near(warmth.accel_bias_per_k[2], found.channels[5].per_k.unwrap()), "{warmth:?}");
    let [change_k, time_s] = found.change.unwrap();
    assert!(near(warmth.plateau_k, change_k) && near(warmth.ramp_kps, change_k / time_s));
    let said = text::of(&result);
    assert!(said.contains("gyro bias, deg/h/K"), "{said}");
    assert!(page::render(&result, "octant characterise").contains("temperature, °C"));
    let json = serde_json::to_value(&result).unwrap();
    assert_eq!(json["temperature"]["channels"].as_array().unwrap().len(), 6);
    assert!(result.twin.unwrap().channels.iter().all(|channel| channel.matches()));
}

#[test]
fn a_temperature_that_is_none_is_refused_with_its_place() {
    let said = |change: &dyn Fn(usize, f64) -> String, more: &[&str]| {
        let path = warm("wrong", [0.0; 2], change);
        let said = characterised_warm(&path, more, None).unwrap_err().to_string();
        std::fs::remove_file(path).unwrap();
        assert!(said.contains("wrong.csv") || said.contains("temperature_unit"), "{said}");
        said
    };
    let plain = |_: usize, t: f64| format!("{t:.3}");
    let missing = said(&plain, &["source.text.temperature_column=warmth"]);
    assert!(missing.contains("no column \"warmth\", found device_time_s"), "{missing}");
    let nan = said(&|k, t| if k == 700 { "nan".into() } else { plain(k, t) }, &[COLUMN]);
    assert!(
        nan.contains("line 702: column 8: temperature NaN degC, expected a finite number"),
        "{nan}"
    );
    let jump = said(&|k, t| plain(k, if k == 700 { t + 50.0 } else { t }), &[COLUMN]);
    assert!(
        jump.contains("line 702: column 8: temperature")
            && jump.contains("50 K from the one 0.02 s before"),
        "{jump}"
    );
    let kelvin = said(&plain, &[COLUMN, "source.text.temperature_unit=K"]);
    assert!(
        kelvin.contains("line 2: column 8: temperature")
            && kelvin.contains("expected 173.15 to 473.15 K"),
        "{kelvin}"
    );
    let unit = said(&plain, &[COLUMN, "source.text.temperature_unit=degF"]);
    assert!(
        unit.contains("source.text.temperature_unit: found \"degF\"") && unit.contains("degC, K"),
        "{unit}"
    );
}
