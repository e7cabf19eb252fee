//! The smoother on the core's own filter: against a batch solution, and against the truth of an ensemble.

use nalgebra::{SMatrix, SVector, UnitQuaternion, Vector3};
use octant_calibration::config::{CoreConfig, Estimator, Further, Screening};
use octant_calibration::covariance::{Covariance, DR, DV, MOVING, PARAMETERS, PHI, STATE_COUNT};
use octant_calibration::filter::add_process_noise;
use octant_calibration::positions::EIGHT;
use octant_earth::frames::phi_of;
use octant_earth::units::*;
use octant_random::stream::Triad;
use octant_sample::Mode;
use octant_sample::counts::DELTA_THETA_LSB_RAD;
use octant_sample::parameters::PARAMETER_COUNT;
use octant_smoother::backward::SmoothedCalibration;
use octant_smoother::history::FilterHistory;
use octant_test_loop::draws;
use octant_test_loop::instrument::InstrumentCase;
use octant_test_loop::plant_and_core::{ClosedLoop, on_two_threads};

/// Samples a second.
const HZ: u64 = 20;
/// Random walk of the gyro biases, (rad/s)/√s.
const WALK: f64 = 0.02 * DEG_PER_HOUR / 60.0;

type Errors = [f64; STATE_COUNT];

/// A calibration with its smoother, and the true errors of the filter at each second.
struct Run {
    smoothed: SmoothedCalibration,
    errors: Vec<(f64, Errors)>,
}

fn configuration(
    seed: u64,
    hours: f64,
    walk: f64,
) -> (octant_plant::config::PlantConfig, CoreConfig) {
    let case = InstrumentCase { calibration_h: hours, ..InstrumentCase::table_1(seed, EIGHT) };
    let (mut plant, mut core) = (case.plant(), case.core());
    plant.sample_period_ns = 1_000_000_000 / HZ;
    plant.calibration_samples = (hours * 3600.0) as u64 * HZ;
    core.sample_period_ns = plant.sample_period_ns;
    core.screening = Screening::none();
    if let Some(calibration) = &mut core.calibration
        && let Estimator::Kalman(kalman) = &mut calibration.estimator
    {
        kalman.further = Further { gyro_rate_random_walk: walk, ..Further::default() };
    }
    (plant, core)
}

/// Runs a calibration with gyro biases that walk, for the instrument and for the filter.
fn run(seed: u64, hours: f64, walk: f64, nodes: usize) -> Run {
    let (plant, core) = configuration(seed, hours, walk);
    let parameters = plant.imu.parameters.to_array();
    let mut run = ClosedLoop::new(&plant, &core);
    let mut history = FilterHistory::new(&core, nodes).unwrap();
    let noise = Triad::new(seed, "smoothing.walk");
    let (mut bias, mut carried) = ([0.0; 3], [0.0; 3]);
    let interval_s = 1.0 / HZ as f64;
    let mut errors = Vec::new();
    let mut measured_s = None;
    let mut last = None;
    loop {
        run.step_altered(|mut sample, aiding| {
            let fresh = noise.at(sample.sequence);
            for axis in 0..3 {
                bias[axis] += walk * interval_s.sqrt() * fresh[axis];
                carried[axis] += bias[axis] * interval_s / DELTA_THETA_LSB_RAD;
                sample.delta_theta[axis] += carried[axis].round() as i32;
                carried[axis] -= carried[axis].round();
            }
            last = Some((sample, aiding));
            last
        });
        if !matches!(run.output.mode, Mode::Aligning | Mode::Calibrating) {
            let (sample, aiding) = last.unwrap();
            history.end(&sample, aiding.as_ref()).unwrap();
            break;
        }
        // The answer to the sample of a measurement doesn't have its correction yet; that to the next one has.
        if let Some(time_s) = measured_s.take() {
            errors.push((time_s, errors_of(&run, &parameters, &bias)));
        }
        let before = history.len();
        history.watch(&run.core).unwrap();
        if history.len() != before {
            measured_s = Some(run.core.filter().unwrap().time_s());
        }
    }
    Run { smoothed: history.smooth().unwrap(), errors }
}

#[test]
fn the_last_measurement_of_a_calibration_is_smoothed_too() {
    let (plant, core) = configuration(1, 0.5, 0.0);
    let mut run = ClosedLoop::new(&plant, &core);
    let mut history = FilterHistory::new(&core, 24).unwrap();
    let mut last = None;
    while matches!(run.output.mode, Mode::Aligning | Mode::Calibrating) {
        run.step_altered(|sample, aiding| {
            last = Some((sample, aiding));
            last
        });
        history.watch(&run.core).unwrap();
    }
    let (sample, aiding) = last.unwrap();
    history.end(&sample, aiding.as_ref()).unwrap();
    // All that the core used: one a second up to the end of the half hour.
    let table = run.core.table().unwrap();
    assert_eq!((history.len() as u64, table.quality.used), (1800, 1800));
    assert!((history.ends_s() - 1800.0).abs() < 1e-6, "{}", history.ends_s());
    // The filter knows of constants at its end what the smoother knows at every time.
    let mut largest: f64 = 0.0;
    for node in history.smooth().unwrap().nodes {
        let found = node.covariance();
        for i in 0..PARAMETER_COUNT {
            let smoothed = found[(PARAMETERS + i, PARAMETERS + i)];
            largest = largest.max((smoothed / table.covariance[i][i] - 1.0).abs());
        }
    }
    println!("variances of parameters: smoothed and published differ by {largest:e} at most");
    assert!(largest < 1e-6, "{largest}");
}

fn errors_of(run: &ClosedLoop, parameters: &[f64; PARAMETER_COUNT], bias: &[f64; 3]) -> Errors {
    let quaternion = |[w, x, y, z]: [f64; 4]| {
        UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z))
    };
    let (output, truth) = (&run.output.navigation, run.plant.truth());
    let phi = phi_of(&quaternion(output.q_nb), &quaternion(truth.q_nb));
    let dv = Vector3::from(output.velocity_mps) - Vector3::from(truth.velocity_mps);
    let mut all = [0.0; STATE_COUNT];
    all[PHI..DV].copy_from_slice(phi.as_slice());
    all[DV..DR].copy_from_slice(dv.as_slice());
    for (i, (truth, estimate)) in
        parameters.iter().zip(run.core.parameters().to_array()).enumerate()
    {
        let walked = if i < 3 { bias[i] } else { 0.0 };
        all[PARAMETERS + i] = truth + walked - estimate;
    }
    all
}

/// Normalized squares and squares over an ensemble: filter and smoother, states by states, over the nodes after the first
/// quarter.
fn ensemble(
    seeds: u64,
    hours: f64,
    walk: f64,
) -> ([[f64; STATE_COUNT]; 2], [[f64; STATE_COUNT]; 2]) {
    let seeds: Vec<u64> = (1..=seeds).collect();
    let runs = on_two_threads(&seeds, |seed| run(*seed, hours, walk, 24));
    let mut normalized = [[0.0; STATE_COUNT]; 2];
    let mut squares = [[0.0; STATE_COUNT]; 2];
    let mut n = 0.0;
    for run in &runs {
        for node in &run.smoothed.nodes {
            if node.time_s < 0.25 * hours * 3600.0 {
                continue;
            }
            n += 1.0;
            let (_, truth) = run.errors.iter().find(|(time_s, _)| *time_s == node.time_s).unwrap();
            let (found, p) = (node.errors(), node.filtered_covariance());
            let smoothed = node.covariance();
            for i in 0..STATE_COUNT {
                for (k, (error, variance)) in
                    [(truth[i], p[(i, i)]), (truth[i] - found[i], smoothed[(i, i)])]
                        .into_iter()
                        .enumerate()
                {
                    normalized[k][i] += error * error / variance;
                    squares[k][i] += error * error;
                }
            }
        }
    }
    (normalized.map(|all| all.map(|sum| sum / n)), squares.map(|all| all.map(|sum| sum / n)))
}

fn check(seeds: u64) {
    for walk in [0.0, WALK] {
        let (normalized, squares) = ensemble(seeds, 1.0, walk);
        let states = |from: usize, to: usize, of: &[f64; STATE_COUNT]| {
            of[from..to].iter().sum::<f64>() / (to - from) as f64
        };
        for (name, from, to) in [
            ("tilt", PHI, PHI + 2),
            ("azimuth", PHI + 2, PHI + 3),
            ("velocity", DV, DV + 3),
            ("gyro bias", PARAMETERS, PARAMETERS + 3),
            ("other parameters", PARAMETERS + 3, STATE_COUNT),
        ] {
            let [filter, smoother] = normalized.map(|all| states(from, to, &all));
            let gain = (states(from, to, &squares[1]) / states(from, to, &squares[0])).sqrt();
            println!(
                "walk {walk:e}, {name}: normalized squares {filter:.2}, {smoother:.2}; rms by {gain:.3}"
            );
            // The errors of a calibration at different times depend on each other: a run counts as one.
            let chance = (2.0 / ((to - from) as f64 * seeds as f64)).sqrt();
            assert!((smoother - 1.0).abs() < (3.5 * chance).max(0.1), "{name}: {smoother}");
        }
    }
}

#[test]
fn errors_that_are_left_are_as_large_as_the_smoother_says() {
    check(draws(60, 30));
}

/// Prints the table of docs/smoothing.md.
#[test]
#[ignore = "minutes: a study"]
fn study_of_errors_that_are_left() {
    check(draws(400, 4));
}

/// Conditional covariance of the states at some times, given all measurements at once: with the covariances Σ of states and
/// measurements under the prior, process noise included, it is Σxx − Σxy (Σyy + R)⁻¹ Σyx. Neither filter nor smoother has
/// a part in it.
struct Batch {
    transitions: Vec<Full>,
    states: Vec<Full>,
    /// Lower triangle of the Cholesky factor of Σyy + R.
    root: Vec<Vec<f64>>,
}

type Full = SMatrix<f64, STATE_COUNT, STATE_COUNT>;

impl Batch {
    /// Measurements of the velocity, with variance `r`; `noise` is the process noise of one transition.
    fn new(transitions: Vec<Full>, prior: &Full, noise: &Full, r: f64) -> Self {
        let mut states = Vec::new();
        let mut p = *prior;
        for transition in &transitions {
            p = transition * p * transition.transpose() + noise;
            states.push(p);
        }
        let mut batch = Self { transitions, states, root: Vec::new() };
        let n = batch.states.len();
        let mut all = vec![vec![0.0; 3 * n]; 3 * n];
        for j in 0..n {
            for (k, covariance) in batch.with_later(j).into_iter().enumerate() {
                for a in 0..3 {
                    for b in 0..3 {
                        all[3 * (j + k) + b][3 * j + a] = covariance[(DV + a, DV + b)];
                    }
                }
            }
        }
        for i in 0..3 * n {
            all[i][i] += r;
            for j in 0..=i {
                let sum: f64 = (0..j).map(|k| all[i][k] * all[j][k]).sum();
                all[i][j] =
                    if i == j { (all[i][i] - sum).sqrt() } else { (all[i][j] - sum) / all[j][j] };
            }
        }
        batch.root = all;
        batch
    }

    /// Covariances of the state at `j` with those at `j`, `j` + 1 and so on.
    fn with_later(&self, j: usize) -> Vec<Full> {
        let mut all = vec![self.states[j]];
        for transition in &self.transitions[j + 1..] {
            let last = all[all.len() - 1];
            all.push(last * transition.transpose());
        }
        all
    }

    /// Variances of the states at `t`.
    fn variances(&self, t: usize) -> [f64; STATE_COUNT] {
        let n = self.states.len();
        let mut with_all: Vec<Full> = (0..t)
            .map(|j| {
                let between = self.transitions[j + 1..=t]
                    .iter()
                    .fold(Full::identity(), |product, next| next * product);
                between * self.states[j]
            })
            .collect();
        with_all.extend(self.with_later(t));
        core::array::from_fn(|i| {
            let mut x = vec![0.0; 3 * n];
            for row in 0..3 * n {
                let sum: f64 = (0..row).map(|k| self.root[row][k] * x[k]).sum();
                x[row] = (with_all[row / 3][(i, DV + row % 3)] - sum) / self.root[row][row];
            }
            self.states[t][(i, i)] - x.iter().map(|x| x * x).sum::<f64>()
        })
    }
}

#[test]
fn standard_deviations_are_those_of_a_batch_solution() {
    const SECONDS: usize = 150;
    let (plant, core) = configuration(1, 0.5, 0.0);
    let mut run = ClosedLoop::new(&plant, &core);
    // A node at each measurement of the first 150 s.
    let mut history = FilterHistory::new(&core, 1800).unwrap();
    let mut transitions = Vec::new();
    while history.len() < SECONDS {
        run.step();
        let before = history.len();
        history.watch(&run.core).unwrap();
        if history.len() > before {
            let rows = &run.core.filter().unwrap().passage().transition().rows;
            let mut full = Full::identity();
            for i in 0..MOVING {
                for j in 0..STATE_COUNT {
                    full[(i, j)] = rows[i][j];
                }
            }
            transitions.push(full);
        }
    }
    // At rest the specific force of a second is that against gravity.
    let mut noise = Covariance::from_sigmas(&[0.0; STATE_COUNT]);
    let force = Vector3::new(0.0, 0.0, -9.793_6);
    let variances = [core.noise.angle_random_walk, core.noise.velocity_random_walk].map(|n| n * n);
    add_process_noise(&mut noise, (variances[0], variances[1]), 1.0, &force);
    let noise = Full::from_fn(|i, j| noise.at(i, j));
    let prior = Full::from_diagonal(&SVector::from(*history.prior()).map(|sigma| sigma * sigma));
    let batch = Batch::new(transitions, &prior, &noise, 1e-6);
    let smoothed = history.smooth().unwrap();
    assert_eq!(smoothed.nodes.len(), SECONDS);
    let mut gained: f64 = 1.0;
    for t in [0, 30, 75, 120, SECONDS - 1] {
        let (expected, node) = (batch.variances(t), &smoothed.nodes[t]);
        let found = node.covariance();
        for i in 0..STATE_COUNT {
            let ratio = (found[(i, i)] / expected[i]).sqrt();
            assert!((ratio - 1.0).abs() < 1e-3, "state {i} at {t} s: {ratio}");
            gained = gained.min((found[(i, i)] / node.node.covariance[i][i]).sqrt());
        }
    }
    assert!(gained < 0.5, "{gained}");
}
