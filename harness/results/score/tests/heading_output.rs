//! Latency, follow-up and transmission of a heading: against numpy (`fixtures/golden/heading_output.json`, with the way it
//! was made beside it) and closed forms.

use octant_score::heading_output::{HeadingOutputScore, HeadingPair};
use serde_json::Value;

fn pairs(count: u32, rate_hz: f64, of: impl Fn(f64) -> [f64; 2]) -> Vec<HeadingPair> {
    let pair = |k: u32| {
        let t_s = f64::from(k) / rate_hz;
        let [output_deg, reference_deg] = of(t_s);
        HeadingPair {
            t_s,
            output_rad: output_deg.to_radians(),
            reference_rad: reference_deg.to_radians(),
        }
    };
    (0..count).map(pair).collect()
}

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "found {found}, expected {expected}");
}

#[test]
fn scores_are_those_of_another_computation() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/golden/heading_output.json");
    let golden: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let cases = golden["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 7);
    for case in cases {
        let number = |name: &str| case[name].as_f64().unwrap();
        let list = |name: &str| -> Vec<f64> {
            case[name].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
        };
        let (output, reference) = (list("output_deg"), list("reference_deg"));
        let rate_hz = number("rate_hz");
        let at = |t_s: f64| (t_s * rate_hz).round() as usize;
        let pairs =
            pairs(output.len() as u32, rate_hz, |t_s| [output[at(t_s)], reference[at(t_s)]]);
        let digit_rad = number("digit_deg").to_radians();
        let found = HeadingOutputScore::of(&pairs, digit_rad, 0.0).unwrap();
        let name = &case["name"];
        let latency_s = found.latency_s.unwrap();
        // The other one is in steps of 0.1 ms, and has no interpolation.
        assert!((latency_s - number("latency_s")).abs() < 1e-3, "{name}: {found:?}");
        let uncertainty_s = found.latency_uncertainty_s.unwrap();
        assert!((latency_s - number("true_latency_s")).abs() < uncertainty_s, "{name}: {found:?}");
        assert!(uncertainty_s < 0.02, "{name}: {found:?}");
        near(found.constant_error_deg, number("constant_error_deg"), 2e-3);
        near(found.transmission_error_deg, number("transmission_error_deg"), 4e-3);
        for (class, key) in
            [(found.follow_up_10, "follow_up_10"), (found.follow_up_20, "follow_up_20")]
        {
            let expected = &case[key];
            assert_eq!(class.is_some(), !expected.is_null(), "{name}: {key}");
            let Some(class) = class else { continue };
            near(class.max_deg, expected["max_deg"].as_f64().unwrap(), 5e-3);
            // Points at rest, whose rate is 0 but for rounding, are in none or in the first class.
            near(class.rms_deg, expected["rms_deg"].as_f64().unwrap(), 0.02 * class.rms_deg + 5e-3);
        }
    }
}

#[test]
fn a_turn_at_a_constant_rate_shows_its_follow_up_error_and_no_latency() {
    // At 12 deg/s 0.25 s are 3 deg; without a change of the rate that can't be told from a constant error.
    let turning = pairs(300, 10.0, |t| [12.0 * (t - 0.25), 12.0 * t]);
    let found = HeadingOutputScore::of(&turning, 0.0, 0.0).unwrap();
    assert_eq!(found.latency_s, None);
    near(found.constant_error_deg, -3.0, 1e-9);
    // With rests at both ends it can.
    let swept = |t: f64| 12.0 * t.clamp(10.0, 20.0);
    let resting = pairs(300, 10.0, |t| [swept(t - 0.2), swept(t)]);
    let found = HeadingOutputScore::of(&resting, 0.0, 0.0).unwrap();
    near(found.latency_s.unwrap(), 0.2, 5e-3);
    near(found.follow_up_20.unwrap().max_deg, 2.4, 0.02);
}

#[test]
fn a_heading_at_rest_has_its_constant_error_and_no_follow_up() {
    let rest = pairs(600, 1.0, |_| [359.9, 0.3]);
    let found = HeadingOutputScore::of(&rest, 0.1_f64.to_radians(), 0.0).unwrap();
    near(found.constant_error_deg, -0.4, 1e-9);
    near(found.transmission_error_deg, 0.0, 1e-9);
    assert_eq!((found.latency_s, found.follow_up_10, found.follow_up_20), (None, None, None));
    near(found.uncertainty("constant_error_deg"), 0.05, 1e-12);
}

#[test]
fn times_in_doubt_and_last_digits_are_in_the_uncertainty() {
    let heading = |t: f64| 30.0 * (t * 0.2).sin();
    let late = pairs(2000, 10.0, |t| [(heading(t - 0.1) * 10.0).round() / 10.0, heading(t)]);
    let digit_rad = 0.1_f64.to_radians();
    let sure = HeadingOutputScore::of(&late, digit_rad, 0.0).unwrap();
    let doubted = HeadingOutputScore::of(&late, digit_rad, 0.1).unwrap();
    assert_eq!(sure.latency_s, doubted.latency_s);
    let [least, most] = [sure, doubted].map(|score| score.latency_uncertainty_s.unwrap());
    near(most, least.hypot(0.1), 1e-12);
    let [least, most] = [sure, doubted].map(|score| score.uncertainty("follow_up_10.max_deg"));
    near(least, 0.05, 2e-3);
    // At up to 6 deg/s.
    near(most, 0.05_f64.hypot(0.6), 5e-3);
    let [least, most] = [sure, doubted].map(|score| score.uncertainty("transmission_error_deg"));
    assert!(least < 2e-3, "{least}");
    near(most, 0.6, 5e-3);
}

#[test]
fn gaps_are_left_out_and_few_points_give_no_score() {
    let heading = |t: f64| 350.0 + 20.0 * (t * 0.3).sin();
    let all = pairs(1200, 10.0, |t| [heading(t - 0.15), heading(t)]);
    let with_gap: Vec<_> =
        all.iter().filter(|pair| !(40.0..60.0).contains(&pair.t_s)).copied().collect();
    let found = HeadingOutputScore::of(&with_gap, 0.0, 0.0).unwrap();
    near(found.latency_s.unwrap(), 0.15, 1e-4);
    assert_eq!(found.follow_up_10.unwrap().points, with_gap.len() as u64 - 4);
    assert_eq!(HeadingOutputScore::of(&all[..20], 0.0, 0.0), None);
}

#[test]
fn a_delay_is_an_error_of_rate_times_delay_in_its_class() {
    let delay_s = 0.04;
    for sign in [1.0, -1.0] {
        // A turn at 8 deg/s, then one at 16 deg/s, across north.
        let turned = move |t_s: f64| {
            300.0 + sign * if t_s < 10.0 { 8.0 * t_s } else { 80.0 + 16.0 * (t_s - 10.0) }
        };
        let all = pairs(201, 10.0, |t_s| [turned(t_s - delay_s), turned(t_s)]);
        let found = HeadingOutputScore::of(&all, 0.0, 0.0).unwrap();
        near(found.latency_s.unwrap(), delay_s, 2e-3);
        // Where one rate becomes the other, rates are means of both.
        near(found.follow_up_10.unwrap().max_deg, 8.0 * delay_s, 0.02);
        near(found.follow_up_20.unwrap().max_deg, 16.0 * delay_s, 0.02);
        assert!(found.follow_up_10.unwrap().rate_max_degps < 8.0 + 1e-9);
        // Alone, neither is in the other's class.
        let fast = HeadingOutputScore::of(&all[110..], 0.0, 0.0).unwrap();
        assert_eq!(fast.follow_up_10, None);
    }
}

#[test]
fn an_error_at_rest_is_no_follow_up_error() {
    let all = pairs(100, 10.0, |t_s| [8.0 * t_s + 0.7, 8.0 * t_s]);
    let found = HeadingOutputScore::of(&all, 0.0, 0.0).unwrap();
    near(found.constant_error_deg, 0.7, 1e-9);
    near(found.follow_up_10.unwrap().max_deg, 0.0, 1e-9);
}

#[test]
fn steps_of_a_transmission_are_half_a_step_wrong_at_most() {
    let step = 1.0 / 6.0;
    let stepped = |heading: f64| (heading / step).round() * step;
    let all = pairs(3600, 10.0, |t_s| [stepped(t_s), t_s]);
    let found = HeadingOutputScore::of(&all, f64::to_radians(step), 0.0).unwrap();
    let error = found.transmission_error_deg;
    assert!(error <= 0.5 * step + 1e-3 && error > 0.4 * step, "{error}");
    near(found.resolution_deg, step, 1e-12);
    assert_eq!(HeadingOutputScore::of(&[], 0.0, 0.0), None);
}
