//! Further states of the filter against instruments with the errors that they stand for.

use octant_calibration::config::*;
use octant_calibration::further::{DRIVING_COUNT, FURTHER_COUNT, FurtherGroup};
use octant_calibration::positions::EIGHT;
use octant_earth::units::*;
use octant_plant::config as plant;
use octant_plant::draw::{Draw, ParameterDraws, parameters};
use octant_sample::parameters::{PARAMETER_COUNT, ParameterGroup};
use octant_sample::{DeviceTime, Health, Mode};
use octant_test_loop::draws;
use octant_test_loop::instrument::InstrumentCase;
use octant_test_loop::plant_and_core::{ClosedLoop, on_two_threads};
use octant_test_loop::squares::{AttitudeSquares, assert_consistent};

/// 50 Hz: a move's second of acceleration is fifty samples.
const PERIOD_NS: u64 = 20_000_000;
const CALIBRATION_H: f64 = 1.0;
const CORRELATION_S: f64 = 300.0;

/// Standard deviation of a group, as drawn and as the filter's prior, SI.
fn sigma(group: FurtherGroup) -> f64 {
    match group {
        FurtherGroup::AccelLever => 0.03,
        FurtherGroup::GyroAsymmetry | FurtherGroup::AccelAsymmetry => 30.0 * PPM,
        // 20 µg/g².
        FurtherGroup::AccelQuadratic => 20.0 * MICRO_G / (9.8 * 9.8),
        FurtherGroup::GyroGaussMarkov => 0.005 * DEG_PER_HOUR,
        FurtherGroup::AccelGaussMarkov => 10.0 * MICRO_G,
        FurtherGroup::Deflection => 10.0 * ARCSEC,
        // 50 mGal.
        FurtherGroup::GravityAnomaly => 50e-5,
        // Times the change of [`warm_up`] they are those of the biases and scale factors themselves.
        FurtherGroup::GyroBiasTemperature => 0.001 * DEG_PER_HOUR,
        FurtherGroup::AccelBiasTemperature => 10.0 * MICRO_G,
        FurtherGroup::GyroScaleTemperature | FurtherGroup::AccelScaleTemperature => 5.0 * PPM,
        FurtherGroup::GimbalMounting
        | FurtherGroup::GimbalNonOrthogonality
        | FurtherGroup::EncoderEccentricity => unreachable!("see gimbal_angles"),
    }
}

/// Normal numbers of a seed: the parameters of two other instruments, of which each is drawn with σ 1.
fn normals(seed: u64) -> impl Iterator<Item = f64> {
    let of = |other: u64| parameters(seed ^ other, &normal([1.0; 7])).to_array();
    of(0xf117).into_iter().chain(of(0xf118))
}

/// An instrument that is switched on cold: 5 K in half of the calibration, and no more.
fn warm_up() -> plant::Temperature {
    plant::Temperature {
        ramp_kps: 10.0 / 3600.0,
        plateau_k: 5.0,
        gyro_bias_per_k: [0.0; 3],
        accel_bias_per_k: [0.0; 3],
        gyro_scale_per_k: [0.0; 3],
        accel_scale_per_k: [0.0; 3],
    }
}

fn normal(sigmas: [f64; 7]) -> ParameterDraws {
    let [gyro_bias, gyro_scale, gyro_misalignment, g_dependent, bias, scale, misalignment] = sigmas;
    ParameterDraws {
        gyro_bias: Draw::Normal { sigma: gyro_bias },
        gyro_scale: Draw::Normal { sigma: gyro_scale },
        gyro_misalignment: Draw::Normal { sigma: gyro_misalignment },
        g_dependent: Draw::Normal { sigma: g_dependent },
        accel_bias: Draw::Normal { sigma: bias },
        accel_scale: Draw::Normal { sigma: scale },
        accel_misalignment: Draw::Normal { sigma: misalignment },
    }
}

/// True further states of an instrument with errors of these groups.
fn truth(seed: u64, groups: &[FurtherGroup]) -> [f64; FURTHER_COUNT] {
    let numbers: Vec<f64> = normals(seed).take(FURTHER_COUNT).collect();
    let mut all = [0.0; FURTHER_COUNT];
    for group in groups {
        for k in group.range() {
            all[k] = sigma(*group) * numbers[k];
        }
    }
    all
}

/// Instrument whose parameters are drawn from the filter's prior, with errors of these groups.
fn configured(
    seed: u64,
    groups: &[FurtherGroup],
    further: Further,
) -> (plant::PlantConfig, CoreConfig) {
    let case =
        InstrumentCase { calibration_h: CALIBRATION_H, ..InstrumentCase::table_1(seed, EIGHT) };
    let (mut plant, mut core) = (case.plant(), case.core());
    (plant.sample_period_ns, core.sample_period_ns) = (PERIOD_NS, PERIOD_NS);
    plant.calibration_samples = (CALIBRATION_H * 3600e9) as u64 / PERIOD_NS;
    core.screening = Screening::none();
    let kalman = kalman(&mut core);
    plant.imu.parameters = parameters(seed, &normal(kalman.prior.parameters));
    kalman.refuse_above_mean_nis = 1e9;
    kalman.further = further;
    let all = truth(seed, groups);
    let three = |group: FurtherGroup| -> [f64; 3] {
        let at = group.range().start;
        [all[at], all[at + 1], all[at + 2]]
    };
    let extensions = &mut plant.imu.extensions;
    extensions.lever_arm_m = [0, 3, 6].map(|k| [all[k], all[k + 1], all[k + 2]]);
    extensions.gyro_asymmetry = three(FurtherGroup::GyroAsymmetry);
    extensions.accel_asymmetry = three(FurtherGroup::AccelAsymmetry);
    extensions.accel_quadratic = three(FurtherGroup::AccelQuadratic);
    if FurtherGroup::OF_TEMPERATURE.iter().any(|group| groups.contains(group)) {
        extensions.temperature = Some(plant::Temperature {
            gyro_bias_per_k: three(FurtherGroup::GyroBiasTemperature),
            accel_bias_per_k: three(FurtherGroup::AccelBiasTemperature),
            gyro_scale_per_k: three(FurtherGroup::GyroScaleTemperature),
            accel_scale_per_k: three(FurtherGroup::AccelScaleTemperature),
            ..warm_up()
        });
    }
    let process = |group| {
        let sigma = sigma(group);
        groups
            .contains(&group)
            .then_some(plant::GaussMarkov { sigma, correlation_time_s: CORRELATION_S })
    };
    extensions.gyro_gauss_markov = process(FurtherGroup::GyroGaussMarkov);
    extensions.accel_gauss_markov = process(FurtherGroup::AccelGaussMarkov);
    let deflection = FurtherGroup::Deflection.range().start;
    plant.site.gravity = plant::GravityDisturbance {
        deflection_north_rad: all[deflection],
        deflection_east_rad: all[deflection + 1],
        anomaly_mps2: all[FurtherGroup::GravityAnomaly.range().start],
    };
    (plant, core)
}

fn kalman(core: &mut CoreConfig) -> &mut Kalman {
    match &mut core.calibration.as_mut().unwrap().estimator {
        Estimator::Kalman(kalman) => kalman,
        _ => unreachable!(),
    }
}

/// Groups that drive attitude and velocity; those of the gimbals are in `gimbal_angles`.
fn driving() -> [FurtherGroup; 12] {
    std::array::from_fn(|index| FurtherGroup::ALL[index])
}

fn off() -> Further {
    Further {
        gyro_correlation_time_s: CORRELATION_S,
        accel_correlation_time_s: CORRELATION_S,
        temperature: Some(TemperatureErrors { groups: [FurtherUse::Off; 4], reference_c: None }),
        ..Further::default()
    }
}

fn considered(group: FurtherGroup) -> Further {
    off().with(group, FurtherUse::Considered { sigma: sigma(group) })
}

fn estimated(groups: &[FurtherGroup]) -> Further {
    groups.iter().fold(off(), |further, group| {
        further.with(*group, FurtherUse::Estimated { sigma: sigma(*group) })
    })
}

/// Result of one calibration.
struct Calibrated {
    nis: f64,
    attitude: AttitudeSquares,
    /// Errors of the parameters, and their standard deviations.
    errors: [f64; PARAMETER_COUNT],
    sigma: [f64; PARAMETER_COUNT],
    /// Squared normalized errors of the further states; NaN where they are off.
    further: [f64; FURTHER_COUNT],
    further_sigma: [f64; FURTHER_COUNT],
}

fn calibrate(seed: u64, groups: &[FurtherGroup], further: Further, screened: bool) -> Calibrated {
    let (plant, mut core) = configured(seed, groups, further);
    if screened {
        core.screening = Screening::hardened(Base::Still);
    }
    let mut run = ClosedLoop::new(&plant, &core);
    assert_eq!(run.calibrate(), Mode::Done, "seed {seed}: {:?}", run.core.refusal());
    let (true_ones, estimate) = (plant.imu.parameters.to_array(), run.core.parameters().to_array());
    let all = truth(seed, groups);
    let found = run.core.further().copied();
    let sigmas = found.map_or([0.0; FURTHER_COUNT], |found| found.sigma);
    Calibrated {
        nis: run.core.table().unwrap().quality.nis_mean,
        attitude: AttitudeSquares::of(&run),
        errors: std::array::from_fn(|i| estimate[i] - true_ones[i]),
        sigma: *run.core.sigma(),
        further: std::array::from_fn(|k| {
            found.map_or(f64::NAN, |found| ((found.value[k] - all[k]) / found.sigma[k]).powi(2))
        }),
        further_sigma: sigmas,
    }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0.0), |(sum, n), value| (sum + value, n + 1.0));
    sum / n
}

/// Mean squared normalized error of a group of parameters.
fn nees(runs: &[Calibrated], group: ParameterGroup) -> f64 {
    mean(runs.iter().flat_map(|run| group.range().map(|i| (run.errors[i] / run.sigma[i]).powi(2))))
}

/// The same of all parameters.
fn nees_of_all(runs: &[Calibrated]) -> f64 {
    mean(runs.iter().flat_map(|run| (0..30).map(|i| (run.errors[i] / run.sigma[i]).powi(2))))
}

/// The same of a group of further states.
fn further_nees(runs: &[Calibrated], group: FurtherGroup) -> f64 {
    mean(runs.iter().flat_map(|run| run.further[group.range()].iter().copied()))
}

/// Gauss-Markov biases are what they are at the end of the run, which the plant doesn't tell.
fn is_constant(group: FurtherGroup) -> bool {
    !matches!(group, FurtherGroup::GyroGaussMarkov | FurtherGroup::AccelGaussMarkov)
}

/// Size of errors in standard deviations of others: root of the mean square over all parameters.
fn size(errors: &[f64; PARAMETER_COUNT], sigma: &[f64; PARAMETER_COUNT]) -> f64 {
    mean((0..PARAMETER_COUNT).map(|i| (errors[i] / sigma[i]).powi(2))).sqrt()
}

/// A group of three states has 600 degrees of freedom over 200 seeds, and a mean within 0.8 and 1.2 by
/// 3.5 σ; the two of the deflection and the one anomaly keep their prior, 1 ± 0.07 and ± 0.1.
#[test]
#[ignore = "minutes: run by tests/run"]
fn all_groups_at_once_are_consistent() {
    let seeds: Vec<u64> = (1..=draws(200, 60)).collect();
    let all = driving();
    let runs = on_two_threads(&seeds, |seed| calibrate(*seed, &all, estimated(&all), true));
    let nis = mean(runs.iter().map(|run| run.nis));
    println!("all groups estimated, {} seeds: NIS {nis:.3}", seeds.len());
    let mut found = Vec::new();
    for group in ParameterGroup::ALL {
        found.push((group.name(), nees(&runs, group), group.range().len()));
    }
    for group in all.into_iter().filter(|group| is_constant(*group)) {
        found.push((group.name(), further_nees(&runs, group), group.range().len()));
    }
    for k in 0..DRIVING_COUNT {
        let name = octant_calibration::further::FURTHER_NAMES[k];
        println!("  {name:22} σ {:.3e}", runs[0].further_sigma[k]);
    }
    for (name, nees, _) in &found {
        println!("  {name:20} normalized error {nees:.2}");
    }
    for (name, nees, states) in found {
        let spread = (2.0 / (states * seeds.len()) as f64).sqrt();
        let bound = 0.2f64.max(3.5 * spread);
        assert!((nees - 1.0).abs() < bound, "{name}: {nees}");
    }
    assert!((nis - 3.0).abs() < 0.05, "{nis}");
    assert_consistent("all groups estimated", runs.iter().map(|run| run.attitude));
}

/// Each group alone: what its error costs if it is ignored, considered or estimated, in standard
/// deviations of an instrument without it.
#[test]
#[ignore = "minutes: run by tests/run"]
fn estimated_errors_cost_least_and_considered_ones_are_told() {
    let seeds: Vec<u64> = (1..=draws(50, 16)).collect();
    let reference = on_two_threads(&seeds, |seed| calibrate(*seed, &[], off(), false));
    println!("error in σ of an instrument without it; in brackets the normalized square");
    println!(
        "{:20} {:>16} {:>16} {:>16} {:>8}",
        "group", "ignored", "considered", "estimated", "states"
    );
    for group in driving() {
        let on = [group];
        let ways = [off(), considered(group), estimated(&on)].map(|further| {
            let runs = on_two_threads(&seeds, |seed| calibrate(*seed, &on, further, false));
            let sizes = runs
                .iter()
                .zip(&reference)
                .map(|(run, reference)| size(&run.errors, &reference.sigma).powi(2));
            (mean(sizes).sqrt(), nees_of_all(&runs), runs)
        });
        let of = |way: usize| format!("{:.2} ({:.2})", ways[way].0, ways[way].1);
        // NaN where the plant doesn't tell the truth.
        let own = if is_constant(group) { further_nees(&ways[2].2, group) } else { f64::NAN };
        println!("{:20} {:>16} {:>16} {:>16} {own:>8.2}", group.name(), of(0), of(1), of(2));
        // Pooled over thirty parameters that correlate: 10 % over 50 seeds.
        for way in [1, 2] {
            assert!((0.8..1.2).contains(&ways[way].1), "{}: {}", group.name(), ways[way].1);
        }
        if is_constant(group) {
            let spread = (2.0 / (group.range().len() * seeds.len()) as f64).sqrt();
            assert!((own - 1.0).abs() < 0.2f64.max(3.5 * spread), "{}: {own}", group.name());
        }
        assert!(ways[2].0 < 1.05 * ways[0].0, "{}", group.name());
    }
}

/// Size effect of arms of 5 cm: the shift of the parameters against the same instrument without arms.
#[test]
fn estimated_lever_arms_leave_less_than_a_tenth_of_the_size_effect() {
    let run = |arms: bool, further: Further| {
        let (mut plant, core) = configured(3, &[], further);
        if arms {
            plant.imu.extensions.lever_arm_m =
                [[0.05, -0.05, 0.05], [-0.05, 0.05, 0.05], [0.05, 0.05, -0.05]];
        }
        let mut run = ClosedLoop::new(&plant, &core);
        assert_eq!(run.calibrate(), Mode::Done);
        (run.core.parameters().to_array(), *run.core.sigma(), run.core.further().copied())
    };
    let lever = FurtherGroup::AccelLever;
    let (without, sigma, _) = run(false, off());
    let shift = |found: &[f64; PARAMETER_COUNT]| {
        size(&std::array::from_fn(|i| found[i] - without[i]), &sigma)
    };
    let ignored = shift(&run(true, off()).0);
    let on = off().with(lever, FurtherUse::Estimated { sigma: 0.05 });
    let (found, _, arms) = run(true, on);
    let left = shift(&found);
    let arms = arms.unwrap();
    println!("size effect of 5 cm: {ignored:.2} σ ignored, {left:.3} σ estimated");
    println!("arms {:.4?} ± {:.4?} m", arms.value_of(lever), arms.sigma_of(lever));
    assert!(left < 0.1 * ignored, "{left} {ignored}");
    for (k, value) in arms.value_of(lever).iter().enumerate() {
        assert!((value.abs() - 0.05).abs() < 5.0 * arms.sigma_of(lever)[k] + 1e-4, "{k}");
    }
}

/// A clock that is fast by κ: each period is too short by κ, and stamps say it isn't. Turns are measured whole, over more
/// periods; gravity and Earth's rate are smaller by κ per second of the clock. So it shifts the parameters as a gravity
/// anomaly of −κ g does, and no group of its own could be told from that: but for Earth's rate, 0.0015 deg/h of 1e-4.
#[test]
fn the_rate_of_the_clock_is_a_gravity_anomaly() {
    const KAPPA: f64 = 1e-4;
    let run = |kappa: f64, anomaly_mps2: f64| {
        let (mut plant, core) = configured(4, &[], off());
        (plant.imu.angle_random_walk, plant.imu.velocity_random_walk) = (0.0, 0.0);
        plant.sample_period_ns = (PERIOD_NS as f64 * (1.0 - kappa)) as u64;
        plant.aiding.period_ns = plant.sample_period_ns * (plant.aiding.period_ns / PERIOD_NS);
        plant.site.gravity.anomaly_mps2 = anomaly_mps2;
        let mut run = ClosedLoop::new(&plant, &core);
        while matches!(run.output.mode, Mode::Aligning | Mode::Calibrating) {
            run.step_altered(|mut sample, mut aiding| {
                sample.device_time = DeviceTime::from_ns(sample.sequence * PERIOD_NS);
                if let Some(aiding) = &mut aiding {
                    aiding.device_time = sample.device_time;
                }
                Some((sample, aiding))
            });
        }
        assert_eq!(run.output.mode, Mode::Done, "{:?}", run.core.refusal());
        (run.core.parameters().to_array(), *run.core.sigma())
    };
    let (without, sigma) = run(0.0, 0.0);
    let shift = |found: [f64; PARAMETER_COUNT]| -> [f64; PARAMETER_COUNT] {
        std::array::from_fn(|i| (found[i] - without[i]) / sigma[i])
    };
    let gravity = octant_earth::ellipsoid::Ellipsoid::at(30.5 * DEG, 0.0).gravity_mps2;
    let fast = shift(run(KAPPA, 0.0).0);
    let heavy = shift(run(0.0, -KAPPA * gravity).0);
    for i in 0..PARAMETER_COUNT {
        println!("{:24} {:9.3} {:9.3} σ", octant_sample::parameters::NAMES[i], fast[i], heavy[i]);
    }
    // Common to the three accelerometers, −κ.
    for i in ParameterGroup::AccelScale.range() {
        assert!((fast[i] * sigma[i] + KAPPA).abs() < 0.02 * KAPPA, "{}", fast[i] * sigma[i]);
    }
    for i in 0..PARAMETER_COUNT {
        assert!((fast[i] - heavy[i]).abs() < 1.5, "{i}: {} {}", fast[i], heavy[i]);
    }
}

/// A gyro that walks: with the process noise the other groups are consistent and the walk isn't taken
/// for a drift.
#[test]
#[ignore = "minutes: run by tests/run"]
fn a_rate_random_walk_is_modelled() {
    let seeds: Vec<u64> = (1..=draws(40, 16)).collect();
    let walk = 0.02 * DEG_PER_HOUR / 60.0;
    let [ignored, modelled] = [0.0, walk].map(|modelled| {
        on_two_threads(&seeds, |seed| {
            let further = Further { gyro_rate_random_walk: modelled, ..off() };
            let (mut plant, core) = configured(*seed, &[], further);
            plant.imu.extensions.gyro_rate_random_walk = walk;
            let mut run = ClosedLoop::new(&plant, &core);
            assert_eq!(run.calibrate(), Mode::Done);
            let (truth, found) =
                (plant.imu.parameters.to_array(), run.core.parameters().to_array());
            let sigma = run.core.sigma();
            // All but the biases, whose truth at the end the plant doesn't tell.
            mean((3..PARAMETER_COUNT).map(|i| ((found[i] - truth[i]) / sigma[i]).powi(2)))
        })
    });
    let (ignored, modelled) = (mean(ignored.into_iter()), mean(modelled.into_iter()));
    println!("rate random walk: normalized square {ignored:.2} ignored, {modelled:.2} modelled");
    assert!((0.8..1.2).contains(&modelled), "{modelled}");
    assert!(ignored > 1.3, "{ignored}");
}

/// A gap, a stuck channel and a jump that opens the gate: the filter with all further states comes
/// through, and its errors are as large as it says.
#[test]
fn faults_leave_further_states_consistent() {
    let all = driving();
    let (plant, mut core) = configured(5, &all, estimated(&all));
    core.screening = Screening::hardened(Base::Still);
    let mut run = ClosedLoop::new(&plant, &core);
    let mut last = 0;
    while matches!(run.output.mode, Mode::Aligning | Mode::Calibrating) {
        run.step_altered(|mut sample, aiding| {
            let seconds = sample.sequence as f64 * PERIOD_NS as f64 * 1e-9;
            last = sample.sequence;
            if (900.0..903.0).contains(&seconds) {
                return None;
            }
            if (1500.0..1502.0).contains(&seconds) {
                sample.delta_velocity = [7_000; 3];
            }
            if (2000.0..2001.0).contains(&seconds) {
                sample.delta_theta[0] += 40_000;
            }
            Some((sample, aiding))
        });
    }
    assert_eq!(run.output.mode, Mode::Done, "{:?}", run.core.refusal());
    assert!(run.core.diagnostics().quality.bridged > 0);
    assert!(run.epochs(Health::RECOVERING) > 0 || run.epochs(Health::JUMP) > 0);
    let (truth_39, found) = (plant.imu.parameters.to_array(), run.core.parameters().to_array());
    let sigma = run.core.sigma();
    let squares = mean((0..30).map(|i| ((found[i] - truth_39[i]) / sigma[i]).powi(2)));
    let (further, values) = (run.core.further().unwrap(), truth(5, &all));
    let constant = (0..DRIVING_COUNT).filter(|k| !(18..24).contains(k));
    let of_further =
        mean(constant.map(|k| ((further.value[k] - values[k]) / further.sigma[k]).powi(2)));
    println!("after faults: normalized squares {squares:.2}, further {of_further:.2}");
    assert!(squares < 2.5 && of_further < 2.5, "{squares} {of_further}");
}

#[test]
fn a_coloured_sway_and_further_states_exclude_each_other() {
    let (_, mut core) = configured(1, &[], estimated(&[FurtherGroup::AccelLever]));
    let kalman = kalman(&mut core);
    kalman.sway = SwayNoise::Coloured;
    kalman.aiding = AidingMode::Position { sigma_m: 0.01 };
    assert_eq!(
        octant_calibration::Core::new(&core).unwrap_err().to_string(),
        "the sway is coloured and further states are on, one of the two is expected"
    );
}

/// A core that is stored and loaded amid the calibration goes on bit for bit.
#[test]
fn a_stored_core_with_further_states_goes_on_as_it_was() {
    let all = driving();
    let (plant, mut core) = configured(2, &all, estimated(&all));
    core.screening = Screening::hardened(Base::Still);
    let mut run = ClosedLoop::new(&plant, &core);
    // Amid a sub-step, and in a move.
    run.run_to(45_273);
    let mut bytes = Vec::new();
    run.core.save(&mut bytes);
    let mut other = run.clone();
    other.core = octant_calibration::Core::load(&bytes).unwrap();
    for run in [&mut run, &mut other] {
        run.run_to(60_000);
    }
    let states = [&run, &other].map(|run| {
        let mut bytes = Vec::new();
        run.core.save(&mut bytes);
        bytes
    });
    assert!(states[0] == states[1]);
    assert!(run.core.further().unwrap().value[..DRIVING_COUNT].iter().all(|value| *value != 0.0));
}
