//! Case that is known to rest: what that gains, that its σ are right, and a case that turns.

use octant_calibration::config::*;
use octant_calibration::positions::{EIGHT, SIX};
use octant_earth::units::*;
use octant_plant::config as plant;
use octant_plant::draw::{Draw, ParameterDraws, parameters};
use octant_sample::parameters::{PARAMETER_COUNT, ParameterGroup};
use octant_test_loop::draws;
use octant_test_loop::instrument::InstrumentCase;
use octant_test_loop::plant_and_core::{ClosedLoop, on_two_threads};
use octant_test_loop::squares::{AttitudeSquares, assert_consistent};

/// 50 Hz: a move's second of acceleration is fifty samples.
const PERIOD_NS: u64 = 20_000_000;

/// Rest as the scenario's defaults have it: more jitter and wander than the simulated floor has.
fn by_default() -> CaseRest {
    CaseRest {
        wander_rad_per_sqrt_s: 0.2 * ARCSEC / 60.0,
        range_rad: 10.0 * ARCSEC,
        jitter_rad: 0.5 * ARCSEC,
    }
}

/// Floor that doesn't move, known as such: its noise is below that of the gyros in a second.
fn still() -> CaseRest {
    CaseRest { wander_rad_per_sqrt_s: 0.0, jitter_rad: 0.02 * ARCSEC, ..by_default() }
}

fn kalman(core: &mut CoreConfig) -> &mut Kalman {
    match &mut core.calibration.as_mut().unwrap().estimator {
        Estimator::Kalman(kalman) => kalman,
        _ => unreachable!(),
    }
}

/// Instrument of Table 1 whose parameters are drawn from the filter's prior.
fn configured(case: &InstrumentCase, rest: Option<CaseRest>) -> (plant::PlantConfig, CoreConfig) {
    let (mut plant, mut core) = (case.plant(), case.core());
    (plant.sample_period_ns, core.sample_period_ns) = (PERIOD_NS, PERIOD_NS);
    plant.calibration_samples = (case.calibration_h * 3600e9) as u64 / PERIOD_NS;
    core.screening = Screening::none();
    let kalman = kalman(&mut core);
    let [a, b, c, d, e, f, g] = kalman.prior.parameters;
    plant.imu.parameters = parameters(
        case.seed,
        &ParameterDraws {
            gyro_bias: Draw::Normal { sigma: a },
            gyro_scale: Draw::Normal { sigma: b },
            gyro_misalignment: Draw::Normal { sigma: c },
            g_dependent: Draw::Normal { sigma: d },
            accel_bias: Draw::Normal { sigma: e },
            accel_scale: Draw::Normal { sigma: f },
            accel_misalignment: Draw::Normal { sigma: g },
        },
    );
    kalman.further.rest = rest;
    (plant, core)
}

struct Calibrated {
    errors: [f64; PARAMETER_COUNT],
    sigma: [f64; PARAMETER_COUNT],
    nis: f64,
    rest_nis: f64,
    attitude: AttitudeSquares,
    refusal: Option<String>,
}

fn calibrate(case: &InstrumentCase, rest: Option<CaseRest>) -> Calibrated {
    let (plant, core) = configured(case, rest);
    let mut run = ClosedLoop::new(&plant, &core);
    run.run_to(plant.calibration_samples - 1);
    let filter = run.core.filter().unwrap();
    let rest_nis = filter.angle_tally().map_or(f64::NAN, |tally| tally.nis_sum / tally.used as f64);
    let nis = run.core.diagnostics().quality.nis_mean;
    let (truth, found) = (plant.imu.parameters.to_array(), run.core.parameters().to_array());
    let attitude = AttitudeSquares::of(&run);
    let sigma = *run.core.sigma();
    run.run_to(plant.calibration_samples + 1);
    Calibrated {
        errors: std::array::from_fn(|i| found[i] - truth[i]),
        sigma,
        nis,
        rest_nis,
        attitude,
        refusal: run.core.refusal().map(ToString::to_string),
    }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0.0), |(sum, n), value| (sum + value, n + 1.0));
    sum / n
}

/// Seeds, positions and hours, each without rest, with that of the defaults, and with that of a still floor: the sizes
/// of errors and their σ, paired. Where the floor is what the filter is told, squares are one; where it is better, they
/// are less.
#[test]
#[ignore = "minutes: run by tests/run"]
fn rest_gains_and_its_sigmas_are_right() {
    let seeds: Vec<u64> = (1..=draws(100, 16)).collect();
    let cases =
        [("eight", EIGHT, 1.0), ("eight", EIGHT, 0.25), ("eight", EIGHT, 4.0), ("six", SIX, 1.0)];
    for &(name, positions, hours) in draws(&cases[..], &cases[..1]) {
        let run = |rest| {
            on_two_threads(&seeds, |seed| {
                let case = InstrumentCase {
                    calibration_h: hours,
                    ..InstrumentCase::table_1(*seed, positions)
                };
                calibrate(&case, rest)
            })
        };
        let all = [None, Some(by_default()), Some(still())].map(run);
        println!(
            "{name} positions in {hours} h: size, σ and normalized square without, by default, still"
        );
        for group in ParameterGroup::ALL {
            let told = all.each_ref().map(|runs| {
                let of = |value: fn(&Calibrated, usize) -> f64| {
                    mean(
                        runs.iter()
                            .flat_map(|run| group.range().map(move |i| value(run, i).powi(2))),
                    )
                };
                let (size, sigma) =
                    (of(|run, i| run.errors[i]).sqrt(), of(|run, i| run.sigma[i]).sqrt());
                let unit = group.si_per_unit();
                let square = of(|run, i| run.errors[i] / run.sigma[i]);
                format!("{:.3e} σ {:.3e} ({square:.2})", size / unit, sigma / unit)
            });
            println!("{:20} {}  {}", group.name(), told.join("  "), group.unit());
        }
        let pooled = all.each_ref().map(|runs| {
            mean(
                runs.iter().flat_map(|run| (0..30).map(|i| (run.errors[i] / run.sigma[i]).powi(2))),
            )
        });
        let bias = all.each_ref().map(|runs| {
            let gyros = ParameterGroup::GyroBias.range();
            mean(runs.iter().flat_map(|run| gyros.clone().map(|i| run.errors[i].powi(2)))).sqrt()
        });
        println!(
            "squares of all {pooled:.2?}, gain of gyro biases {:.2} {:.2}",
            bias[0] / bias[1],
            bias[0] / bias[2]
        );
        for (k, runs) in all.iter().enumerate() {
            let nis = mean(runs.iter().map(|run| run.nis));
            let of_rest = mean(runs.iter().map(|run| run.rest_nis));
            let refused: Vec<_> =
                runs.iter().zip(&seeds).filter(|(run, _)| run.refusal.is_some()).collect();
            println!("NIS {nis:.3}, of rest {of_rest:.3}, refused {}", refused.len());
            refused.iter().for_each(|(run, seed)| println!("  seed {seed}: {:?}", run.refusal));
            assert!(refused.is_empty());
            assert!((nis - 3.0).abs() < 0.1, "{nis}");
            // The first comparison of a stop has a smaller NIS than three: ψ, and what a move leaves open, take a part.
            assert!(k == 0 || of_rest < 3.05, "{of_rest}");
            assert_consistent(name, runs.iter().map(|run| run.attitude));
        }
        assert!((0.8..1.2).contains(&pooled[0]) && (0.8..1.2).contains(&pooled[2]), "{pooled:?}");
        assert!((0.6..1.1).contains(&pooled[1]), "{pooled:?}");
        assert!(bias[0] / bias[1] > 1.3 && bias[0] / bias[2] > 1.3, "{bias:?}");
    }
}

/// A core that is stored and loaded amid the calibration goes on bit for bit.
#[test]
fn a_stored_core_with_rest_goes_on_as_it_was() {
    let case = InstrumentCase { calibration_h: 0.5, ..InstrumentCase::table_1(2, EIGHT) };
    let (plant, core) = configured(&case, Some(by_default()));
    let mut run = ClosedLoop::new(&plant, &core);
    run.run_to(23_273);
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
    assert!(run.core.filter().unwrap().angle_tally().unwrap().used > 500);
}

#[test]
fn a_rest_and_a_moving_base_exclude_each_other() {
    let case = InstrumentCase::table_1(1, EIGHT);
    let (_, mut core) = configured(&case, Some(by_default()));
    core.screening.base = Base::Moving(BaseMotion {
        angle_rad: 0.1,
        rate_radps: 0.1,
        acceleration_radps2: 0.1,
        force_mps2: 1.0,
        jerk_mps3: 1.0,
    });
    assert_eq!(
        octant_calibration::Core::new(&core).unwrap_err().to_string(),
        "gimbal angles or the rest of the case are measurements and the base moves, a base at rest is expected"
    );
}
