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

/// Rest of a floor that doesn't move, with the encoders' 18″ unknown to the filter.
fn still() -> CaseRest {
    CaseRest { wander_rad_per_sqrt_s: 0.0, range_rad: 10.0 * ARCSEC, jitter_rad: 0.5 * ARCSEC }
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

#[test]
#[ignore = "minutes: run by tests/run"]
fn rest_gains_and_its_sigmas_are_right() {
    let seeds: Vec<u64> = (1..=draws(100, 16)).collect();
    for (name, positions, hours) in
        [("eight", EIGHT, 0.25), ("eight", EIGHT, 1.0), ("eight", EIGHT, 4.0), ("six", SIX, 1.0)]
    {
        let run = |rest| {
            on_two_threads(&seeds, |seed| {
                let case = InstrumentCase {
                    calibration_h: hours,
                    ..InstrumentCase::table_1(*seed, positions)
                };
                calibrate(&case, rest)
            })
        };
        let (without, with) = (run(None), run(Some(still())));
        println!("{name} positions in {hours} h");
        for group in ParameterGroup::ALL {
            let of = |runs: &[Calibrated]| {
                let rms = mean(runs.iter().flat_map(|run| {
                    group.range().map(|i| (run.errors[i] / group.si_per_unit()).powi(2))
                }))
                .sqrt();
                let sigma = mean(runs.iter().flat_map(|run| {
                    group.range().map(|i| (run.sigma[i] / group.si_per_unit()).powi(2))
                }))
                .sqrt();
                let square =
                    mean(runs.iter().flat_map(|run| {
                        group.range().map(|i| (run.errors[i] / run.sigma[i]).powi(2))
                    }));
                format!("{rms:.3e} σ {sigma:.3e} ({square:.2})")
            };
            println!("{:20} {}  {} {}", group.name(), of(&without), of(&with), group.unit());
        }
        let refused = with.iter().filter_map(|run| run.refusal.clone()).collect::<Vec<_>>();
        println!(
            "NIS {:.3} {:.3}, of rest {:.3}, refused {refused:?}",
            mean(without.iter().map(|run| run.nis)),
            mean(with.iter().map(|run| run.nis)),
            mean(with.iter().map(|run| run.rest_nis)),
        );
        assert_consistent(name, with.iter().map(|run| run.attitude));
    }
}
