//! Attacks on content, order, mode and parameters of the answers, over every port.

use super::unit::{ALL, CALIBRATION, HONEST, Over, SECOND, Turn, Twist, check, run};
use super::{Ends, Row, fails, open};
use octant_sample::parameters::PARAMETER_COUNT;
use octant_sample::{DeviceTime, Health, Mode};

/// Attack on the answers.
struct Attack {
    group: &'static str,
    about: &'static str,
    ends: Ends,
    twist: Twist,
}

type Values = [f64; PARAMETER_COUNT];

const fn answer(answer: fn(&mut Turn<'_>)) -> Twist {
    Twist { answer, ..HONEST }
}

const fn parameters(parameters: fn(u64, &mut Values, &mut Values)) -> Twist {
    Twist { parameters, ..HONEST }
}

/// Sample in the middle of the navigation.
const MIDDLE: u64 = CALIBRATION + 200;

macro_rules! attacks {
    ($($name:ident: $group:literal, $about:literal, $ends:expr, $twist:expr;)*) => {
        /// Returns the rows of the table.
        pub fn rows() -> Vec<Row> {
            vec![$({
                let attack = $name::ATTACK;
                let over = "serial, UDP, CAN";
                Row { group: attack.group, about: attack.about, over, ends: attack.ends }
            }),*]
        }
        $(mod $name {
            use super::*;

            pub(super) const ATTACK: Attack =
                Attack { group: $group, about: $about, ends: $ends, twist: $twist };

            #[test]
            fn over_serial() {
                check(ATTACK.about, &ATTACK.ends, run(Over::Serial, ATTACK.twist));
            }

            #[test]
            fn over_udp() {
                check(ATTACK.about, &ATTACK.ends, run(Over::Udp, ATTACK.twist));
            }

            #[test]
            fn over_can() {
                check(ATTACK.about, &ATTACK.ends, run(Over::Can, ATTACK.twist));
            }
        })*
    };
}

attacks! {
    sequence_off_by_one: "order", "numbers its answers one too high", fails("sequence is 2, expected 1"),
        answer(|t| t.output.sequence += 1);
    sequence_zero: "order", "numbers every answer 0", fails("sequence is 0, expected 1"),
        answer(|t| t.output.sequence = 0);
    sequence_late: "order", "loses count in the middle of the navigation",
        fails("the answer to sample 1200: sequence is 1199, expected 1200"),
        answer(|t| t.output.sequence -= u64::from(t.k >= MIDDLE));
    sequence_largest: "order", "answers once with the largest number there is",
        fails("sequence is 18446744073709551615"),
        answer(|t| if t.k == MIDDLE { t.output.sequence = u64::MAX });
    time_by_a_nanosecond: "time", "stamps its answers a nanosecond late", fails("device_time is 20000001 ns"),
        answer(|t| t.output.device_time.ns += 1);
    time_zero: "time", "stamps no answer", fails("device_time is 0 ns"),
        answer(|t| t.output.device_time = DeviceTime::default());
    time_of_before: "time", "stamps with the sample before", fails("device_time is 0 ns, expected 20000000 ns"),
        answer(|t| t.output.device_time.ns -= 20_000_000);
    time_once: "time", "stamps one answer of all with another time",
        fails("the answer to sample 1200: device_time is 1 ns"),
        answer(|t| if t.k == MIDDLE { t.output.device_time.ns = 1 });
    answers_late_by_one: "order", "answers each sample with what it should have answered to the one before",
        fails("the answer to sample 2: sequence is 1, expected 2"),
        answer(|t| if let Some(before) = t.before.last() { *t.output = *before });
    nine_of_ten_elsewhere: "content", "nine of ten answers 60 nmi away, at 1000 m/s; the one of each second is right",
        fails("NEAR"),
        answer(|t| if t.k > CALIBRATION && !t.k.is_multiple_of(10) {
            t.output.navigation.latitude_rad += 1.0_f64.to_radians();
            t.output.navigation.velocity_mps[0] += 1000.0;
        });
    once_elsewhere: "content", "one answer of all 2 nmi away, between two seconds", fails("NEAR"),
        answer(|t| if t.k == MIDDLE + 13 { t.output.navigation.latitude_rad += (2.0_f64 / 60.0).to_radians() });
    jumps_within_its_limits: "content", "a position that jumps by 500 m and stays there",
        open("the position of the navigation doesn't fit its velocity: 1 answer, the first one at 24.260 s off by 5"),
        answer(|t| if t.k >= MIDDLE + 13 { t.output.navigation.latitude_rad += 500.0 / 6.37e6 });
    velocity_of_another: "content", "a velocity of 30 m/s that its position doesn't have",
        open("the position of the navigation doesn't fit its velocity"),
        answer(|t| if t.k >= CALIBRATION { t.output.navigation.velocity_mps[1] += 30.0 });
    turns_at_once: "content", "an attitude that turns by a degree from one answer to the next",
        open("the attitude of the navigation doesn't fit the gyros: 1 answer, the first one at 24.260 s"),
        answer(|t| if t.k >= MIDDLE + 13 {
            let [w, x, y, z] = t.output.navigation.q_nb;
            let (s, c) = 0.5_f64.to_radians().sin_cos();
            t.output.navigation.q_nb = [c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w];
        });
    height_of_another: "content", "a height that rises by 100 m at once",
        open("the height of the navigation doesn't fit its velocity: 1 answer, the first one at 24.260 s off by 100"),
        answer(|t| if t.k >= MIDDLE + 13 { t.output.navigation.height_m += 100.0 });
    latitude_nan: "content", "a latitude that is NaN", fails("navigation.latitude_rad is NaN"),
        answer(|t| if t.k == MIDDLE { t.output.navigation.latitude_rad = f64::NAN });
    latitude_nan_at_first: "content", "NaN in its first answer alone",
        fails("the answer to sample 1: navigation.latitude_rad is NaN"),
        answer(|t| if t.k == 1 { t.output.navigation.latitude_rad = f64::NAN });
    latitude_nan_at_last: "content", "NaN in its last answer alone",
        fails("the answer to sample 1500: navigation.latitude_rad is NaN"),
        answer(|t| if t.k == ALL { t.output.navigation.latitude_rad = f64::NAN });
    latitude_nan_always: "content", "a navigation that is NaN from its beginning",
        fails("the answer to sample 1000: navigation.latitude_rad is NaN"),
        answer(|t| if t.k >= CALIBRATION {
            t.output.navigation.latitude_rad = f64::NAN;
            t.output.navigation.longitude_rad = f64::NAN;
        });
    latitude_infinite: "content", "an infinite latitude", fails("navigation.latitude_rad is -inf"),
        answer(|t| if t.k == MIDDLE { t.output.navigation.latitude_rad = f64::NEG_INFINITY });
    latitude_in_degrees: "content", "a latitude in degrees", fails("navigation.latitude_rad is 30.5"),
        answer(|t| t.output.navigation.latitude_rad = 30.5);
    longitude_nan: "content", "a longitude that is NaN", fails("navigation.longitude_rad is NaN"),
        answer(|t| if t.k == MIDDLE { t.output.navigation.longitude_rad = f64::NAN });
    longitude_huge: "content", "a longitude of a thousand million radians", fails("navigation.longitude_rad is"),
        answer(|t| if t.k == MIDDLE { t.output.navigation.longitude_rad = 1e9 });
    longitude_infinite: "content", "an infinite longitude", fails("navigation.longitude_rad is inf"),
        answer(|t| if t.k == MIDDLE { t.output.navigation.longitude_rad = f64::INFINITY });
    height_nan: "content", "a height that is NaN", fails("navigation.height_m is NaN"),
        answer(|t| if t.k == MIDDLE { t.output.navigation.height_m = f64::NAN });
    height_huge: "content", "a height beyond the Moon", fails("navigation.height_m is 1000000000"),
        answer(|t| if t.k == MIDDLE { t.output.navigation.height_m = 1e9 });
    velocity_nan: "content", "a velocity north that is NaN", fails("navigation.velocity_mps, north is NaN"),
        answer(|t| if t.k == MIDDLE { t.output.navigation.velocity_mps[0] = f64::NAN });
    velocity_infinite: "content", "an infinite velocity east", fails("navigation.velocity_mps, east is inf"),
        answer(|t| if t.k == MIDDLE { t.output.navigation.velocity_mps[1] = f64::INFINITY });
    velocity_huge: "content", "a velocity down beyond any orbit", fails("navigation.velocity_mps, down is 1000000"),
        answer(|t| if t.k == MIDDLE { t.output.navigation.velocity_mps[2] = 1e6 });
    attitude_infinite: "content", "attitudes that are infinite", fails("navigation.q_nb is [inf"),
        answer(|t| if t.k >= CALIBRATION { t.output.navigation.q_nb = [f64::INFINITY; 4] });
    attitude_nan: "content", "a component of the attitude that is NaN", fails("NaN], expected a quaternion of norm 1"),
        answer(|t| if t.k == MIDDLE { t.output.navigation.q_nb[3] = f64::NAN });
    attitude_zero: "content", "an attitude of zeros", fails("navigation.q_nb is [0.0, 0.0, 0.0, 0.0]"),
        answer(|t| t.output.navigation.q_nb = [0.0; 4]);
    attitude_not_normal: "content", "an attitude twice as long as it is", fails("expected a quaternion of norm 1"),
        answer(|t| t.output.navigation.q_nb = t.output.navigation.q_nb.map(|q| 2.0 * q));
    nis_infinite: "content", "an infinite NIS", fails("nis is inf"),
        answer(|t| if t.output.nis.is_finite() { t.output.nis = f64::INFINITY });
    nis_negative: "content", "negative NIS", fails("nis is -"),
        answer(|t| t.output.nis = -t.output.nis);
    nis_zero: "follows", "NIS that are all zero", open("the NIS doesn't follow the samples: all"),
        answer(|t| if t.output.nis.is_finite() { t.output.nis = 0.0 });
    nis_three: "follows", "NIS that are all 3, as they should be in the mean",
        open("the NIS doesn't follow the samples: all"),
        answer(|t| if t.output.nis.is_finite() { t.output.nis = 3.0 });
    frozen: "follows", "a navigation that stands still from its beginning",
        open("the position of the navigation doesn't follow the samples"),
        answer(|t| if t.k > CALIBRATION {
            t.output.navigation = t.before[CALIBRATION as usize - 1].navigation;
        });
    frozen_half_way: "follows", "a navigation that stands still from its half on",
        open("the attitude of the navigation doesn't follow the samples"),
        answer(|t| if t.k > CALIBRATION + 240 {
            t.output.navigation = t.before[CALIBRATION as usize + 239].navigation;
        });
    frozen_position: "follows", "the position of the site, which is where it stands",
        open("the position of the navigation doesn't follow the samples"),
        answer(|t| {
            t.output.navigation.latitude_rad = 30.5_f64.to_radians();
            t.output.navigation.longitude_rad = 114.4_f64.to_radians();
        });
    frozen_velocity: "follows", "a velocity of exactly zero, which is what it has",
        open("the velocity of the navigation doesn't follow the samples"),
        answer(|t| t.output.navigation.velocity_mps = [0.0; 3]);
    frozen_attitude: "follows", "an attitude that stands still",
        open("the attitude of the navigation doesn't follow the samples"),
        answer(|t| t.output.navigation.q_nb = [1.0, 0.0, 0.0, 0.0]);
    circle: "follows", "the solutions of one second of its navigation, again and again",
        open("are repetitions of those before"),
        answer(|t| if t.k >= CALIBRATION + 2 * SECOND {
            let from = CALIBRATION + SECOND;
            t.output.navigation = t.before[(from + t.k % SECOND) as usize - 1].navigation;
        });
    done_after_a_second: "plan", "says that it is done after one second of its navigation",
        open("navigation: planned 10 s, done 1 s"),
        answer(|t| if t.k == CALIBRATION + SECOND { t.output.mode = Mode::Done });
    done_in_the_calibration: "plan", "says that it is done after half of its calibration",
        open("calibration: planned 20 s, done 10 s"),
        answer(|t| if t.k == CALIBRATION / 2 { t.output.mode = Mode::Done });
    done_at_once: "plan", "says that it is done in its first answer", open("navigation: planned 10 s, done 0 s"),
        answer(|t| t.output.mode = Mode::Done);
    done_just_before_the_end: "plan", "says that it is done two seconds too early",
        open("navigation: planned 10 s, done 8 s"),
        answer(|t| if t.k == ALL - 2 * SECOND { t.output.mode = Mode::Done });
    never_calibrates: "plan", "navigates from its first answer, without a calibration",
        open("calibration: planned 20 s, done 0 s"),
        answer(|t| if t.k < CALIBRATION { t.output.mode = Mode::Navigating });
    never_calibrates_after_aligning: "plan", "aligns as long as it should calibrate, and navigates then",
        open("calibration: planned 20 s, done 0 s"),
        answer(|t| if t.k < CALIBRATION { t.output.mode = Mode::Aligning });
    aligns_for_ever: "plan", "stays in its alignment", open("navigation: planned 10 s, done 0 s"),
        answer(|t| t.output.mode = Mode::Aligning);
    calibrates_for_ever: "plan", "stays in its calibration", open("navigation: planned 10 s, done 0 s"),
        answer(|t| t.output.mode = Mode::Calibrating);
    navigates_at_half: "plan", "navigates after half of its calibration", open("calibration: planned 20 s, done 10 s"),
        answer(|t| if (CALIBRATION / 2..CALIBRATION).contains(&t.k) { t.output.mode = Mode::Navigating });
    commands_nothing: "plan", "never turns its gimbals, and counts its stops", open("stops of the calibration: planned 2, done 1"),
        answer(|t| t.output.gimbal_command = octant_sample::GimbalCommand::default());
    commands_another_place: "plan", "turns its gimbals to other places", open("stops of the calibration: planned 2, done 0"),
        answer(|t| t.output.gimbal_command.target.azimuth += 1_000_000_000);
    commands_too_late: "plan", "turns to its second stop a second before the end",
        open("stops of the calibration: planned 2, done 1"),
        answer(|t| if t.k < CALIBRATION - SECOND { t.output.gimbal_command = octant_sample::GimbalCommand::default() });
    back_to_calibration: "mode", "calibrates again in the middle of its navigation",
        fails("the answer to sample 1200: mode is calibrating, expected navigating"),
        answer(|t| if t.k >= MIDDLE { t.output.mode = Mode::Calibrating });
    back_to_alignment: "mode", "starts anew by itself", fails("mode is aligning, expected navigating"),
        answer(|t| if t.k == MIDDLE { t.output.mode = Mode::Aligning });
    to_and_fro: "mode", "calibrates and navigates in turn", fails("mode is calibrating, expected navigating"),
        answer(|t| if t.k.is_multiple_of(2) { t.output.mode = Mode::Navigating });
    refuses_at_once: "mode", "refuses its calibration in its first answer", fails("refused"),
        answer(|t| t.output.mode = Mode::Refused);
    refuses_at_the_end: "mode", "refuses its calibration at its end", fails("refused"),
        answer(|t| if t.k >= CALIBRATION { t.output.mode = Mode::Refused });
    parameter_nan: "parameters", "a parameter that is NaN", fails("parameters.gyro_bias_y is NaN"),
        parameters(|_, values, _| values[1] = f64::NAN);
    six_parameters_nan: "parameters", "six of its parameters are NaN, which a worst of the others passes over",
        fails("parameters.gyro_scale_x is NaN"),
        parameters(|_, values, _| values[3..9].fill(f64::NAN));
    parameter_infinite: "parameters", "a parameter that is infinite", fails("is inf"),
        parameters(|_, values, _| values[20] = f64::INFINITY);
    parameter_huge: "parameters", "a parameter beyond any sensor", fails("expected a finite number"),
        parameters(|_, values, _| values[0] = 1e9);
    parameter_nan_at_the_end: "parameters", "a parameter that becomes NaN with the last revision",
        fails("parameters.gyro_bias_x is NaN"),
        parameters(|k, values, _| if k + 1 >= CALIBRATION { values[0] = f64::NAN });
    sigma_infinite: "parameters", "an infinite uncertainty", fails("sigma.gyro_bias_x is inf"),
        parameters(|_, _, sigma| sigma[0] = f64::INFINITY);
    sigma_negative: "parameters", "a negative uncertainty", fails("sigma.gyro_bias_x is -"),
        parameters(|_, _, sigma| sigma[0] = -sigma[0]);
    sigma_zero: "parameters", "uncertainties of zero", open("have no uncertainty above zero"),
        parameters(|_, _, sigma| sigma.fill(0.0));
    six_sigmas_nan: "parameters", "six parameters without an uncertainty, which a worst of the others passes over",
        open("6 of the 30 parameters that were to be estimated have no uncertainty above zero"),
        parameters(|_, _, sigma| sigma[3..9].fill(f64::NAN));
    no_sigma: "parameters", "no uncertainty at all", open("30 of the 30 parameters"),
        parameters(|_, _, sigma| sigma.fill(f64::NAN));
    sigma_tiny: "parameters", "uncertainties a million times too small", fails("SIGMA: calibration.worst_normalized_error is"),
        parameters(|_, _, sigma| for s in sigma.iter_mut() { *s *= 1e-6 });
    parameters_constant: "parameters", "the parameters that it began with, with an uncertainty",
        open("not one parameter moved from where it began"),
        parameters(|_, values, sigma| {
            values.fill(0.0);
            sigma.fill(1e-3);
        });
    revision_back: "parameters", "counts its revisions backwards", fails("parameters_revision is"),
        answer(|t| t.output.parameters_revision = 1_000_000 - t.output.parameters_revision);
    revision_zero_at_last: "parameters", "forgets its revision in the navigation", fails("parameters_revision is 0"),
        answer(|t| if t.k == MIDDLE { t.output.parameters_revision = 0 });
    health_hidden_wrong: "content", "jumps of a mile in its position, without a word",
        fails("NEAR: navigation.radial_error_nmi.max is"),
        answer(|t| {
            t.output.health = Health::empty();
            if t.k > MIDDLE { t.output.navigation.latitude_rad += 1e-3; }
        });
}
