//! The predicted ensemble compared with runs: the part that is the same in every run, with one run
//! without noise; the random part, with two hundred.

use nalgebra::{Quaternion, UnitQuaternion};
use octant_calibration::Core;
use octant_calibration::covariance::{DR, DV, PARAMETERS, PHI, STATE_COUNT};
use octant_calibration::further::{FURTHER_COUNT, FurtherGroup};
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::frames::phi_of;
use octant_earth::units::{ARCMIN, NAUTICAL_MILE_M};
use octant_observe::ensemble::{Ensemble, ensemble, state_unit};
use octant_plant::Plant;
use octant_plant::config::{AidingKind, PlantConfig};
use octant_sample::{GimbalCommand, Mode};
use octant_scenario::{Method, Scenario};
use octant_score::attitude::CaseAngles;
use octant_source::configure::configurations;
use octant_statistics::sample::{mean, percentile, rms};
use octant_test_loop::draws;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

mod further;
mod sequences;

/// At this rate a move at 10 °/s is still divided into steps of 0.5°; a filter's cost is per
/// second.
const RATE: &str = "20 Hz";
/// Half a second after a measurement: at the last sample before it the calibration still has
/// position and vertical velocity, which navigation resets.
const CALIBRATION: &str = "duration = \"14400.55 s\"\n";
/// Rate of the ensemble of Table 1, whose three days are most of the work: what slow samples change
/// grows with their interval, and at 10 Hz would be more than a tenth of σ.
const TABLE_1_RATE: &str = "16 Hz";
/// The same time after a measurement at this rate.
const TABLE_1_CALIBRATION: &str = "duration = \"14400.5625 s\"\n";

fn scenario(text: &str) -> Scenario {
    scenario_at(RATE, text)
}

fn scenario_at(rate: &str, text: &str) -> Scenario {
    let text = format!("schema = 1\n{text}");
    let rate = format!("imu.rate={rate}");
    Scenario::parse(&text, "test.toml", Path::new(""), &[rate]).unwrap()
}

/// Results of one run.
struct Run {
    /// Errors of all 39 states at the end of the calibration, and of the constant further ones that
    /// the filter has, in the units and signs of a prediction.
    errors: Vec<f64>,
    /// Latitude and longitude error, arcmin, and radial error, nmi, at equal times.
    drift: Vec<[f64; 3]>,
    /// Heading, pitch and roll error, arcmin, and velocity error north and east, m/s, at these times.
    motion: Vec<[f64; 5]>,
}

fn attitude(q: [f64; 4]) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::new(q[0], q[1], q[2], q[3]))
}

/// Makes a run with its drift by the hour.
fn run(scenario: &Scenario, seed: u64, change: impl Fn(&mut PlantConfig)) -> Run {
    run_every(scenario, seed, 3600, change)
}

/// Makes a run with its drift at intervals of `every_s` seconds.
fn run_every(
    scenario: &Scenario,
    seed: u64,
    every_s: u64,
    change: impl Fn(&mut PlantConfig),
) -> Run {
    let (mut plant, config, draws) = configurations(scenario, Method::Primary, seed).unwrap();
    change(&mut plant);
    let mut plant = Plant::new(&plant).unwrap();
    let mut core = Core::new(&config).unwrap();
    let every = every_s * 1_000_000_000 / scenario.sample_period_ns;
    let calibration = scenario.calibration_samples();
    let earth = Ellipsoid::at(config.site.latitude_rad, config.site.height_m);
    let metres = [earth.meridian_radius_m, earth.transverse_radius_m * earth.cos_latitude];
    let mut command = GimbalCommand::default();
    let mut run =
        Run { errors: vec![f64::NAN; STATE_COUNT], drift: Vec::new(), motion: Vec::new() };
    for sample in 1..=scenario.samples().unwrap() {
        let step = plant.step(&command);
        let output = core.step(&step.sample, step.aiding.as_ref());
        command = output.gimbal_command;
        if sample == calibration - 1 {
            assert_eq!(output.mode, Mode::Calibrating, "seed {seed}");
            let truth = plant.truth();
            let phi = phi_of(&attitude(output.navigation.q_nb), &attitude(truth.q_nb));
            let at = &output.navigation;
            let position = [
                (at.latitude_rad - truth.latitude_rad) * metres[0],
                (at.longitude_rad - truth.longitude_rad) * metres[1],
                truth.height_m - at.height_m,
            ];
            for axis in 0..3 {
                run.errors[PHI + axis] = phi[axis];
                run.errors[DV + axis] = at.velocity_mps[axis] - truth.velocity_mps[axis];
                run.errors[DR + axis] = position[axis];
            }
            let (estimate, truth) = (core.parameters().to_array(), draws.parameters.to_array());
            for (i, (estimate, truth)) in estimate.iter().zip(truth).enumerate() {
                run.errors[PARAMETERS + i] = estimate - truth;
            }
            for (state, error) in run.errors.iter_mut().enumerate() {
                *error /= state_unit(state).1;
            }
            run.errors.extend(further_errors(&core, &scenario.true_further(&draws)));
        } else if sample > calibration && (sample - calibration).is_multiple_of(every) {
            let truth = plant.truth();
            let north = output.navigation.latitude_rad - truth.latitude_rad;
            let east = output.navigation.longitude_rad - truth.longitude_rad;
            let radial = libm::hypot(north * metres[0], east * metres[1]) / NAUTICAL_MILE_M;
            run.drift.push([north / ARCMIN, east / ARCMIN, radial]);
            let at = &output.navigation;
            let case = CaseAngles::error(at.q_nb, truth.q_nb, truth.gimbal_rad);
            let [heading, pitch, roll] =
                [case.heading_rad, case.pitch_rad, case.roll_rad].map(|angle| angle / ARCMIN);
            let [vn, ve] = [0, 1].map(|axis| at.velocity_mps[axis] - truth.velocity_mps[axis]);
            run.motion.push([heading, pitch, roll, vn, ve]);
        }
    }
    run
}

/// Errors of the further states that a core has and that have a truth, in their units.
fn further_errors(core: &Core, truth: &[Option<f64>; FURTHER_COUNT]) -> Vec<f64> {
    let Some(found) = core.further() else { return Vec::new() };
    let is_process =
        |group| matches!(group, FurtherGroup::GyroGaussMarkov | FurtherGroup::AccelGaussMarkov);
    let groups = FurtherGroup::ALL.into_iter().filter(|group| !is_process(*group));
    let known = |k: &usize| found.sigma[*k] > 0.0;
    let errors = groups.flat_map(|group| {
        let error = move |k: usize| (found.value[k] - truth[k].unwrap()) / group.si_per_unit();
        group.range().filter(known).map(error)
    });
    errors.collect()
}

/// Removes the plant's noise, and keeps its draws.
fn silent(plant: &mut PlantConfig) {
    plant.imu.angle_random_walk = 0.0;
    plant.imu.velocity_random_walk = 0.0;
    match &mut plant.aiding.kind {
        AidingKind::ZeroVelocity { sigma_mps } | AidingKind::Velocity { sigma_mps } => {
            *sigma_mps = 0.0;
        }
        AidingKind::DockPosition { sigma_m } => *sigma_m = 0.0,
    }
}

/// Disables the screens of noise and parameter changes.
const UNSCREENED: &str = "[screening]\nstuck_samples = \"off\"\nbridging = \"off\"\ndrift = \"off\"\n\
                          gate = \"off\"\n";
/// Instrument without draws.
const GIVEN: &str = "
[imu.gyro_bias]
constant = [\"0.004 deg/h\", \"-0.007 deg/h\", \"0.005 deg/h\"]
[imu.gyro_scale]
constant = [\"20 ppm\", \"-15 ppm\", \"8 ppm\"]
[imu.gyro_misalignment]
constant = [\"20 arcsec\", \"-10 arcsec\", \"15 arcsec\", \"5 arcsec\", \"-25 arcsec\", \"12 arcsec\"]
[imu.g_dependent]
constant = [\"1e-3 deg/h/g\", \"4e-4 deg/h/g\", \"-3e-4 deg/h/g\", \"2e-4 deg/h/g\", \"-8e-4 deg/h/g\", \
\"5e-4 deg/h/g\", \"-4e-4 deg/h/g\", \"3e-4 deg/h/g\", \"9e-4 deg/h/g\"]
[imu.accel_bias]
constant = [\"50 ug\", \"-80 ug\", \"60 ug\"]
[imu.accel_scale]
constant = [\"12 ppm\", \"-18 ppm\", \"10 ppm\"]
[imu.accel_misalignment]
constant = [\"15 arcsec\", \"-20 arcsec\", \"10 arcsec\"]
[procedure.alignment]
attitude_error = [\"30 arcsec\", \"-40 arcsec\", \"200 arcsec\"]
velocity_error = [\"0.01 m/s\", \"-0.02 m/s\", \"0.01 m/s\"]
";

/// Compares the mean of a prediction with one run without noise: the allowed difference is `part`
/// of the largest of σ, mean and the run's error.
fn assert_same(predicted: &Ensemble, run: &Run, part: f64) {
    for (state, error) in predicted.states.iter().zip(&run.errors) {
        let size = state.believed.unwrap_or(0.0).max(error.abs());
        println!(
            "{:24} {:12.5e} {error:12.5e} of {size:.3e} {}",
            state.name, state.mean, state.unit
        );
        assert!(
            (state.mean - error).abs() < part * size,
            "{}: {} predicted, {error} run",
            state.name,
            state.mean
        );
    }
    let largest = |axis: usize| run.drift.iter().map(|d| d[axis].abs()).fold(0.0, f64::max);
    let largest = [largest(0), largest(1)];
    // A start within `part` of its σ adds to the error of the growth, and so do samples at 20 Hz, which
    // stand for those at 200 Hz as well as that; a tilt φ swings the velocity by g φ/ω.
    let believed = |name: &str| {
        let state = predicted.states.iter().find(|state| state.name == name).unwrap();
        state.believed.unwrap() / 60.0
    };
    let earth = Ellipsoid::at(30.5f64.to_radians(), 0.0);
    let schuler = 2.0 * std::f64::consts::PI / earth.schuler_period_s();
    let tilt = believed("phi_north").max(believed("phi_east"));
    let swing = earth.gravity_mps2 * tilt * ARCMIN / schuler;
    let at_start = [believed("phi_down"), tilt, tilt, swing, swing];
    let fastest: [f64; 5] = std::array::from_fn(|axis| {
        run.motion.iter().map(|motion| motion[axis].abs()).fold(0.0, f64::max)
    });
    for (hour, drift) in run.drift.iter().enumerate() {
        let band =
            predicted.drift.iter().find(|b| (b.hours - hour as f64 - 1.0).abs() < 1e-6).unwrap();
        let bands = band.solution.unwrap().all();
        for (axis, (band, found)) in bands.iter().zip(run.motion[hour]).enumerate() {
            assert!(
                (band.mean - found).abs() < part * (fastest[axis] + 2.0 * at_start[axis]),
                "attitude or velocity {axis} at {} h: {} predicted, {found} run",
                hour + 1,
                band.mean
            );
        }
        let means = [band.latitude_arcmin.mean, band.longitude_arcmin.mean];
        println!("{:3} h {means:9.5?} {drift:9.5?}", hour + 1);
        for axis in 0..2 {
            assert!(
                (means[axis] - drift[axis]).abs() < part * largest[axis],
                "axis {axis} at {} h: {} predicted, {} run",
                hour + 1,
                means[axis],
                drift[axis]
            );
        }
    }
}

#[test]
fn given_errors_come_out_as_the_mean() {
    // Six positions, with G in truth alone: the filter lacks existing states.
    let text = format!(
        "{UNSCREENED}{GIVEN}[procedure.calibration]\n{CALIBRATION}positions = \"six\"\ng_states = false\n\
         [procedure.navigation]\nduration = \"24 h\"\n"
    );
    let scenario = scenario(&text);
    let predicted = ensemble(&scenario, Method::Primary).unwrap();
    assert!(predicted.states.iter().all(|state| state.prior == 0.0));
    assert_same(&predicted, &run(&scenario, 1, silent), 0.05);
}

#[test]
fn a_temperature_ramp_comes_out_as_the_mean() {
    let text = format!(
        "{UNSCREENED}[imu.extensions.temperature]\nramp = \"5 K/h\"\nplateau = \"15 K\"\n\
         gyro_bias = [\"0.0002 deg/h/K\", \"-0.0001 deg/h/K\", \"0.0003 deg/h/K\"]\n\
         accel_bias = [\"2 ug/K\", \"1 ug/K\", \"-2 ug/K\"]\n\
         gyro_scale = [\"0.5 ppm/K\", \"0 ppm/K\", \"0 ppm/K\"]\n\
         accel_scale = [\"0 ppm/K\", \"0.5 ppm/K\", \"0 ppm/K\"]\n\
         {GIVEN}[procedure.calibration]\n{CALIBRATION}[procedure.navigation]\nduration = \"12 h\"\n"
    );
    let scenario = scenario(&text);
    assert_same(&ensemble(&scenario, Method::Primary).unwrap(), &run(&scenario, 1, silent), 0.05);
}

#[test]
fn a_sway_with_given_phases_comes_out_as_the_mean() {
    // The displacement alone: the prediction doesn't include roll, pitch and yaw.
    let text = format!(
        "{UNSCREENED}[motion]\nkind = \"dockside\"\nheading = \"40 deg\"\n[motion.ship]\n\
         surge = [{{ amplitude = \"0.2 m\", period = \"6 s\", phase = \"20 deg\" }}]\n\
         sway = [{{ amplitude = \"0.2 m\", period = \"7.3 s\", phase = \"150 deg\" }}]\n\
         heave = [{{ amplitude = \"0.2 m\", period = \"8.1 s\", phase = \"250 deg\" }}]\n\
         mooring_offset = [\"1 m\", \"-2 m\", \"0.5 m\"]\n\
         {GIVEN}[procedure.calibration]\n{CALIBRATION}[procedure.navigation]\nduration = \"12 h\"\n"
    );
    let scenario = scenario(&text);
    assert_same(&ensemble(&scenario, Method::Primary).unwrap(), &run(&scenario, 1, silent), 0.05);
}

#[test]
fn slow_samples_make_the_same_run() {
    // The ensembles below are run at these rates, which is valid as long as 200 Hz gives the same errors.
    let at = |rate: &str, calibration: &str| {
        let text = format!(
            "{UNSCREENED}{GIVEN}[procedure.calibration]\n{calibration}[procedure.navigation]\nduration = \"12 h\"\n"
        );
        scenario_at(rate, &text)
    };
    let predicted = ensemble(&at(RATE, CALIBRATION), Method::Primary).unwrap();
    let fast = run(&at("200 Hz", CALIBRATION), 1, silent);
    for (rate, calibration) in [(RATE, CALIBRATION), (TABLE_1_RATE, TABLE_1_CALIBRATION)] {
        assert_slow(rate, &predicted, &run(&at(rate, calibration), 1, silent), &fast);
    }
}

/// Compares a run at a low rate with one at 200 Hz.
fn assert_slow(rate: &str, predicted: &Ensemble, slow: &Run, fast: &Run) {
    for (state, (slow, fast)) in predicted.states.iter().zip(slow.errors.iter().zip(&fast.errors)) {
        let difference = (slow - fast).abs();
        assert!(
            difference < 0.05 * state.believed.unwrap(),
            "{rate}, {}: {difference}",
            state.name
        );
    }
    let motion = slow.motion.iter().zip(&fast.motion);
    let apart: [f64; 5] = std::array::from_fn(|axis| {
        motion.clone().map(|(slow, fast)| (slow[axis] - fast[axis]).abs()).fold(0.0, f64::max)
    });
    println!("{rate}: heading, pitch, roll (arcmin), velocity (m/s) differ by {apart:.6?}");
    // A tenth of the σ of the attitude after this calibration, 0.15 and 0.012 arcmin, and what that tilt
    // swings the velocity by, 0.027 m/s.
    let limits = [0.015, 0.0012, 0.0012, 0.0027, 0.0027];
    assert!(apart.iter().zip(limits).all(|(apart, limit)| *apart < limit), "{rate}: {apart:?}");
    for (slow, fast) in slow.drift.iter().zip(&fast.drift) {
        // The drift over the following day is some tenths of an arc minute.
        let is_same = (0..2).all(|axis| (slow[axis] - fast[axis]).abs() < 2e-3);
        assert!(is_same, "{rate}: {slow:?} {fast:?}");
    }
}

#[test]
fn a_prediction_says_what_it_is_not_for() {
    let refused = |text: &str| {
        let error = ensemble(&scenario(text), Method::Primary).unwrap_err();
        error.to_string()
    };
    assert!(refused("[procedure.navigation]\nduration = \"1 h\"\n").contains("kalman"));
    let least = "[procedure.calibration]\nestimator = \"least-squares\"\n";
    assert!(refused(least).contains("kalman"));
    let coarse = "[motion]\nkind = \"dockside\"\n[procedure.alignment]\nmethod = \"coarse\"\n\
                  [procedure.calibration]\n";
    assert!(refused(coarse).contains("coarse"));
    let faulted = "[procedure.calibration]\n[[faults]]\nid = \"a\"\nkind = \"spike\"\n\
                   trigger = { at = \"10 s\" }\nchannels = \"gyro x\"\namplitude = \"1 deg/h\"\n";
    let predicted = ensemble(&scenario(faulted), Method::Primary).unwrap();
    assert!(predicted.not_modelled.iter().any(|what| what.contains("faults")));
}

/// Makes runs of seeds from 1 on, on all processors.
fn runs(scenario: &Scenario, count: u64, every_s: u64) -> Vec<Run> {
    let next = AtomicU64::new(1);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut all: Vec<(u64, Run)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads)
            .map(|_| {
                scope.spawn(|| {
                    let mut mine = Vec::new();
                    loop {
                        let seed = next.fetch_add(1, Ordering::Relaxed);
                        if seed > count {
                            return mine;
                        }
                        mine.push((seed, run_every(scenario, seed, every_s, |_| ())));
                    }
                })
            })
            .collect();
        workers.into_iter().flat_map(|worker| worker.join().unwrap()).collect()
    });
    all.sort_by_key(|(seed, _)| *seed);
    all.into_iter().map(|(_, run)| run).collect()
}

/// Compares predicted with simulated: σ of every state about the predicted mean, and of the drift
/// by the hour.
fn assert_ensemble(scenario: &Scenario, count: u64, drift_hours: std::ops::RangeInclusive<usize>) {
    let began = std::time::Instant::now();
    let predicted = ensemble(scenario, Method::Primary).unwrap();
    let predicted_in = began.elapsed();
    let began = std::time::Instant::now();
    let runs = runs(scenario, count, 3600);
    println!(
        "predicted in {:.2} s, {count} runs in {:.1} s",
        predicted_in.as_secs_f64(),
        began.elapsed().as_secs_f64()
    );
    // The limits are those of 200 runs; what a figure of fewer runs scatters by grows with the root.
    let wider = (200.0 / count as f64).sqrt();
    let mut ratios = Vec::new();
    let mut wrong = Vec::new();
    for (i, state) in predicted.states.iter().enumerate() {
        let errors: Vec<f64> = runs.iter().map(|run| run.errors[i] - state.mean).collect();
        let simulated = rms(&errors).unwrap();
        let ratio = state.sigma / simulated;
        println!(
            "{:24} {:11.4e} {simulated:11.4e} {ratio:.3} {}",
            state.name, state.sigma, state.unit
        );
        if !((ratio - 1.0).abs() <= 0.2 * wider) {
            wrong.push(format!("{}: {ratio:.3}", state.name));
        }
        ratios.push(ratio);
    }
    let whole = mean(&ratios).unwrap();
    println!("mean ratio of {} states: {whole:.4}", ratios.len());
    if !((whole - 1.0).abs() <= 0.03 * wider) {
        wrong.push(format!("mean ratio {whole:.4}"));
    }
    let mut worst = [0.0f64; 6];
    let mut sums = [0.0f64; 6];
    let mut motion_worst = [0.0f64; 5];
    let hours = drift_hours.clone().count() as f64;
    for hour in drift_hours {
        let band = predicted.drift.iter().find(|b| (b.hours - hour as f64).abs() < 1e-6).unwrap();
        let column =
            |axis: usize| runs.iter().map(|run| run.drift[hour - 1][axis]).collect::<Vec<_>>();
        let of = |values: &[f64], p: f64| percentile(values, p).unwrap();
        let mut found = Vec::new();
        for (axis, band) in [band.latitude_arcmin, band.longitude_arcmin].into_iter().enumerate() {
            let values = column(axis);
            let about: Vec<f64> = values.iter().map(|v| v - band.mean).collect();
            found.push(band.sigma / rms(&about).unwrap());
            found.push((band.p95 - band.p5) / (of(&values, 0.95) - of(&values, 0.05)));
        }
        for (axis, band) in band.solution.unwrap().all().into_iter().enumerate() {
            let about: Vec<f64> =
                runs.iter().map(|run| run.motion[hour - 1][axis] - band.mean).collect();
            let ratio = band.sigma / rms(&about).unwrap();
            motion_worst[axis] = motion_worst[axis].max((ratio - 1.0).abs());
            if !((ratio - 1.0).abs() <= 0.25 * wider) {
                wrong.push(format!("attitude or velocity {axis} at {hour} h: {ratio:.3}"));
            }
        }
        let radial = column(2);
        found.push(band.radial_nmi.p50 / of(&radial, 0.5));
        found.push(band.radial_nmi.p95 / of(&radial, 0.95));
        if hour % 6 == 0 || hour < 6 {
            println!("{hour:3} h {found:.3?}");
        }
        for (i, ratio) in found.iter().enumerate() {
            worst[i] = worst[i].max((ratio - 1.0).abs());
            sums[i] += ratio / hours;
            if !((ratio - 1.0).abs() <= 0.25 * wider) {
                wrong.push(format!("figure {i} at {hour} h: {ratio:.3}"));
            }
        }
    }
    println!("drift (latitude σ, 5-95 %; longitude σ, 5-95 %; radial 50 %, 95 %):");
    println!("  mean {sums:.3?}, largest deviation {worst:.3?}");
    println!("σ of heading, pitch, roll, velocity: largest deviation {motion_worst:.3?}");
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
#[ignore = "minutes: run by tests/run"]
fn many_runs_of_table_1() {
    let text = format!(
        "[procedure.calibration]\npositions = \"eight\"\n{TABLE_1_CALIBRATION}\
         [procedure.navigation]\nduration = \"72 h\"\n"
    );
    assert_ensemble(&scenario_at(TABLE_1_RATE, &text), draws(200, 60), 1..=72);
}

#[test]
#[ignore = "minutes: tests/run has the one of Table 1"]
fn two_hundred_runs_of_a_filter_that_knows_too_little() {
    // Six positions without G, wandering biases, and an attitude that the core aligns itself.
    // Unmodelled effects move the filter's parameters, so the screen for that is off.
    let text = format!(
        "[imu]\ng_dependent = {{ normal = \"0.002 deg/h/g\" }}\n\
         [imu.extensions]\ngyro_rate_random_walk = \"0.0005 deg/h/sqrt(h)\"\n\
         [imu.extensions.gyro_gauss_markov]\nsigma = \"0.002 deg/h\"\n\
         correlation_time = \"30 min\"\n\
         [imu.extensions.accel_gauss_markov]\nsigma = \"3 ug\"\ncorrelation_time = \"10 min\"\n\
         [screening]\ndrift = \"off\"\n\
         [procedure.alignment]\nmethod = \"coarse\"\nduration = \"60 s\"\n\
         [procedure.calibration]\n{CALIBRATION}positions = \"six\"\ng_states = false\n\
         [procedure.navigation]\nduration = \"6 h\"\n"
    );
    assert_ensemble(&scenario(&text), 200, 1..=6);
}

#[test]
#[ignore = "minutes: tests/run has the one of Table 1"]
fn two_hundred_runs_at_the_dockside() {
    let text = format!(
        "[motion]\nkind = \"dockside\"\n[procedure.calibration]\n{CALIBRATION}\
         [procedure.navigation]\nduration = \"6 h\"\n"
    );
    assert_ensemble(&scenario(&text), 200, 1..=6);
}
