//! The attitude at the end of a least-squares calibration: σ in summary and terminal, and what is refused.

use crate::common::program::{ends, json};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use octant_calibration::Core;
use octant_earth::frames::phi_of;
use octant_earth::units::ARCSEC;
use octant_plant::Plant;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{GimbalCommand, Mode, Sample};
use octant_scenario::{Method, Scenario};
use octant_source::configure::configurations;
use std::path::Path;

/// Eight positions of 100 s and more, without G: least squares doesn't know it.
const CALIBRATION: &str = "
[imu]
rate = \"20 Hz\"
[imu.g_dependent]
constant = [\"0 deg/h/g\", \"0 deg/h/g\", \"0 deg/h/g\", \"0 deg/h/g\", \"0 deg/h/g\", \"0 deg/h/g\", \"0 deg/h/g\", \"0 deg/h/g\", \"0 deg/h/g\"]
[motion]
kind = \"static\"
heading = \"40 deg\"
[procedure.calibration]
duration = \"40 min\"
estimator = \"least-squares\"
[procedure.navigation]
duration = \"1 min\"
";

fn parsed() -> Scenario {
    let text = format!("schema = 1\n{CALIBRATION}");
    Scenario::parse(&text, "test.toml", Path::new(""), &[]).unwrap()
}

fn attitude([w, x, y, z]: [f64; 4]) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z))
}

/// Error φ and its covariance at the end of the calibration; `disturb` changes samples, with the attitude of the body.
fn at_the_end(
    scenario: &Scenario,
    seed: u64,
    mut disturb: impl FnMut(u64, &mut Sample, &UnitQuaternion<f64>),
) -> Result<(Vector3<f64>, Matrix3<f64>), String> {
    let (plant, config, _) = configurations(scenario, Method::Primary, seed).unwrap();
    let (mut plant, mut core) = (Plant::new(&plant).unwrap(), Core::new(&config).unwrap());
    let mut command = GimbalCommand::default();
    for number in 1.. {
        let mut sample = plant.step(&command).sample;
        let truth = attitude(plant.truth().q_nb);
        disturb(number, &mut sample, &truth);
        let output = core.step(&sample, None);
        command = output.gimbal_command;
        match output.mode {
            Mode::Navigating => {
                let p = core.concluded().unwrap().phi;
                let phi = phi_of(&attitude(output.navigation.q_nb), &truth);
                return Ok((phi, Matrix3::from_fn(|i, j| p[i][j])));
            }
            Mode::Refused => return Err(core.refusal().unwrap().to_string()),
            _ => assert!(number < 60_000),
        }
    }
    unreachable!()
}

#[test]
fn sixty_runs_tell_their_sigma() {
    let scenario = parsed();
    let (mut squares, mut axes) = (0.0, Vector3::<f64>::zeros());
    for seed in 1..=60 {
        let (phi, p) =
            at_the_end(&scenario, seed, |_, _, _| {}).unwrap_or_else(|e| panic!("{seed}: {e}"));
        squares += phi.dot(&(p.try_inverse().unwrap() * phi)) / 180.0;
        axes += Vector3::from_fn(|i, _| phi[i] * phi[i] / p[(i, i)] / 60.0);
    }
    println!("mean of the squared errors {squares:.3}, of each axis {axes:.3}");
    // 180 terms: 1 ± 0.105; 60 an axis: 1 ± 0.18.
    assert!((0.69..1.32).contains(&squares), "{squares}");
    assert!(axes.iter().all(|axis| (0.45..1.55).contains(axis)), "{axes}");
}

#[test]
fn a_base_that_turns_slowly_in_the_last_standstill_is_refused() {
    let scenario = parsed();
    let samples = scenario.calibration_samples();
    // The last dwell, but for its settling.
    let from = samples - 90 * 20;
    let turned = |axis: usize, rate_dph: f64| {
        // A degree an hour is an arcsecond a second.
        let rate = Vector3::from_fn(|i, _| if i == axis { rate_dph * ARCSEC } else { 0.0 });
        let mut carry = [0.0; 6];
        at_the_end(&scenario, 7, |number, sample, q_nb| {
            if number <= from {
                return;
            }
            let t_s = (number - from) as f64 * 0.05 - 0.025;
            // A base turned by θ in n: the force of gravity is turned the other way, as seen from it.
            let force = Vector3::new(0.0, 0.0, -9.79).cross(&(rate * t_s)) * 0.05;
            let (theta, velocity) = (q_nb.inverse() * (rate * 0.05), q_nb.inverse() * force);
            for i in 0..3 {
                let add = |to: &mut i32, counts: f64, carry: &mut f64| {
                    *carry += counts;
                    *to += carry.round() as i32;
                    *carry -= carry.round();
                };
                add(&mut sample.delta_theta[i], theta[i] / DELTA_THETA_LSB_RAD, &mut carry[i]);
                let counts = velocity[i] / DELTA_VELOCITY_LSB_MPS;
                add(&mut sample.delta_velocity[i], counts, &mut carry[3 + i]);
            }
        })
    };
    turned(0, 0.0).unwrap();
    for (axis, words) in [
        (0, "the specific force turned by"),
        (1, "the specific force turned by"),
        (2, "the rate about down of the last standstill"),
    ] {
        for rate in [0.4, -0.4] {
            let refused = turned(axis, rate).unwrap_err();
            println!("{axis}: {refused}");
            let either =
                axis == 0 && refused.contains("the horizontal rate of the last standstill");
            assert!(refused.contains(words) || either, "{axis}: {refused}");
        }
    }
}

#[test]
fn summary_and_terminal_have_the_sigma() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = folder.path().join("squares.toml");
    std::fs::write(&scenario, format!("schema = 1\nseed = 3\n{CALIBRATION}")).unwrap();
    let out = folder.path().join("squares");
    let (told, _) = ends(&["run", scenario.to_str().unwrap(), "--out", out.to_str().unwrap()], 0);
    let line = told.lines().find(|line| line.contains("attitude at its end")).unwrap();
    assert!(line.contains("error") && line.contains('σ'), "{line}");
    let solution = &json(&out.join("summary.json"))["calibration"]["solution"];
    let of = |angle: &str, what: &str| solution[angle][what].as_f64().unwrap();
    let (_, p) = at_the_end(&parsed(), 3, |_, _, _| {}).unwrap();
    let heading = p[(2, 2)].sqrt().to_degrees() * 60.0;
    assert!((of("heading_arcmin", "sigma") / heading - 1.0).abs() < 1e-3, "{solution} {heading}");
    // White noise over the last dwell: 0.0007 deg/√h in 110 s are 0.004 deg/h, a 3000th of Ω cos L: 1.1 arcmin.
    assert!((0.7..1.4).contains(&heading), "{heading}");
    assert!(of("heading_arcmin", "normalized").abs() < 4.0, "{solution}");
    // The velocity of a base at rest isn't estimated.
    assert!(solution["velocity_north_mps"]["sigma"].is_null(), "{solution}");
    let report = std::fs::read_to_string(out.join("report.html")).unwrap();
    let shown = octant_base::number::significant(of("heading_arcmin", "sigma"), 3);
    let heading = "<td>calibration, static, 2400 s</td><td>Heading</td>";
    let (_, row) = report.split_once(heading).unwrap();
    let row = row.split_once("</tr>").unwrap().0;
    assert!(row.contains(&format!(">{shown}<")), "{row}");
}
