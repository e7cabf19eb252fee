//! Answers of a unit, checked number by number.

use octant_endpoint::answer::{AnswerCheck, Misbehaviour};
use octant_sample::parameters::{NAMES, PARAMETER_COUNT, ParameterEstimate};
use octant_sample::{DeviceTime, Navigation, Parameters};
use octant_sample::{Mode, Output, Sample};
use std::f64::consts::FRAC_PI_2;

fn sample(number: u64) -> Sample {
    let device_time = DeviceTime::from_ns(number * 5_000_000);
    Sample { sequence: number, device_time, ..Sample::default() }
}

fn good(number: u64) -> Output {
    let sent = sample(number);
    Output {
        sequence: sent.sequence,
        device_time: sent.device_time,
        navigation: Navigation { q_nb: [1.0, 0.0, 0.0, 0.0], ..Navigation::default() },
        nis: f64::NAN,
        ..Output::default()
    }
}

fn second(change: impl FnOnce(&mut Output)) -> Result<(), Misbehaviour> {
    let mut check = AnswerCheck::new();
    let before = Output { parameters_revision: 7, mode: Mode::Calibrating, ..good(1) };
    check.answer(&sample(1), &before).unwrap();
    let mut output = Output { parameters_revision: 7, mode: Mode::Calibrating, ..good(2) };
    change(&mut output);
    check.answer(&sample(2), &output)
}

#[test]
fn an_answer_that_is_right_passes_with_all_that_the_wire_allows() {
    second(|_| {}).unwrap();
    second(|o| o.nis = 0.0).unwrap();
    second(|o| o.nis = 1e300).unwrap();
    second(|o| o.parameters_revision = u32::MAX).unwrap();
    second(|o| o.navigation.latitude_rad = -FRAC_PI_2).unwrap();
    // Unwrapped, and in single precision.
    second(|o| o.navigation.longitude_rad = 6.9).unwrap();
    second(|o| o.navigation.q_nb = [-0.6, 0.0, f64::from(0.8_f32), -0.0]).unwrap();
    for mode in [Mode::Navigating, Mode::Done, Mode::Refused] {
        second(|o| o.mode = mode).unwrap();
    }
}

#[test]
fn every_number_that_is_wrong_is_found_with_field_and_value() {
    type Change = fn(&mut Output);
    let table: [(&str, &str, Change); 19] = [
        ("sequence", "3", |o| o.sequence = 3),
        ("sequence", "0", |o| o.sequence = 0),
        ("device_time", "1 ns", |o| o.device_time = DeviceTime::from_ns(1)),
        ("navigation.latitude_rad", "NaN", |o| o.navigation.latitude_rad = f64::NAN),
        ("navigation.latitude_rad", "1.6", |o| o.navigation.latitude_rad = 1.6),
        ("navigation.longitude_rad", "inf", |o| o.navigation.longitude_rad = f64::INFINITY),
        ("navigation.longitude_rad", "-inf", |o| {
            o.navigation.longitude_rad = f64::NEG_INFINITY;
        }),
        ("navigation.height_m", "NaN", |o| o.navigation.height_m = f64::NAN),
        ("navigation.velocity_mps, north", "NaN", |o| o.navigation.velocity_mps[0] = f64::NAN),
        ("navigation.velocity_mps, east", "30000", |o| o.navigation.velocity_mps[1] = 3e4),
        ("navigation.velocity_mps, down", "inf", |o| {
            o.navigation.velocity_mps[2] = f64::INFINITY;
        }),
        ("navigation.q_nb", "[0.0, 0.0, 0.0, 0.0]", |o| o.navigation.q_nb = [0.0; 4]),
        ("navigation.q_nb", "[inf, 0.0, 0.0, 0.0]", |o| o.navigation.q_nb[0] = f64::INFINITY),
        ("navigation.q_nb", "[1.0, 0.0, NaN, 0.0]", |o| o.navigation.q_nb[2] = f64::NAN),
        ("nis", "inf", |o| o.nis = f64::INFINITY),
        ("nis", "-1", |o| o.nis = -1.0),
        ("parameters_revision", "6", |o| o.parameters_revision = 6),
        ("mode", "aligning", |o| o.mode = Mode::Aligning),
        ("navigation.height_m", "-100000000", |o| o.navigation.height_m = -1e8),
    ];
    for (field, found, change) in table {
        let wrong = second(change).unwrap_err();
        assert_eq!((wrong.field.as_str(), wrong.found.as_str(), wrong.sample), (field, found, 2));
        assert!(wrong.to_string().starts_with("the answer to sample 2: "), "{wrong}");
    }
}

#[test]
fn modes_go_back_after_a_restart_alone() {
    let mut check = AnswerCheck::new();
    let in_mode = |number, mode| Output { mode, ..good(number) };
    check.answer(&sample(1), &in_mode(1, Mode::Navigating)).unwrap();
    let wrong = check.answer(&sample(2), &in_mode(2, Mode::Calibrating)).unwrap_err();
    assert_eq!(wrong.expected, "navigating, or a later one");
    check.restarted();
    check.answer(&sample(2), &in_mode(2, Mode::Aligning)).unwrap();
}

#[test]
fn parameters_are_finite_and_sigmas_not_negative() {
    let estimate = |value: f64, sigma: f64| {
        let mut values = [1e-9; PARAMETER_COUNT];
        let mut sigmas = [1e-10; PARAMETER_COUNT];
        (values[14], sigmas[14]) = (value, sigma);
        let parameters = Parameters::from_array(&values);
        ParameterEstimate { revision: 1, parameters, sigma: sigmas }
    };
    let found = |value, sigma| {
        AnswerCheck::new().parameters(9, &estimate(value, sigma)).map_err(|wrong| wrong.field)
    };
    for sigma in [1e-9, 0.0, f64::NAN] {
        found(1e-8, sigma).unwrap();
    }
    let name = NAMES[14];
    for value in [f64::NAN, f64::INFINITY, 1e9] {
        assert_eq!(found(value, 1.0), Err(format!("parameters.{name}")));
    }
    for sigma in [f64::INFINITY, -1e-9] {
        assert_eq!(found(0.0, sigma), Err(format!("sigma.{name}")));
    }
}
