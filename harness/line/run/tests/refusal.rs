//! Texts of a refusal: each cause is told by its evidence.

use octant_calibration::state_machine::CalibrationRefusal as Refusal;
use octant_recorder::event::FaultResult;
use octant_run::refusal::{RefusedRun, Seen, explained};
use octant_scenario::Scenario;
use octant_score::summary::HealthCounts;
use std::path::Path;

fn lines(reason: &str, toml: &str, health: &HealthCounts, faults: &[FaultResult]) -> Vec<String> {
    let text = format!("schema = 1\n{toml}\n[procedure.calibration]\nduration = \"1 h\"\n");
    let scenario = Scenario::parse(&text, "r.toml", Path::new(""), &[]).unwrap();
    let plan = scenario.calibration.as_ref().unwrap();
    explained(&RefusedRun { reason, health, faults, twin: None, scenario: &scenario, plan })
}

fn held() -> String {
    Refusal::Held { held: 2018, expected: 3600 }.to_string()
}

#[test]
fn the_core_has_no_reason_of_which_the_text_is_unknown() {
    let refusals = [
        (Refusal::Inconsistent { mean: 12.0, limit: 9.0 }, Seen::Innovations),
        (Refusal::Rejected { rejected: 100, total: 3600 }, Seen::Innovations),
        (Refusal::Recoveries { recoveries: 11 }, Seen::Innovations),
        (Refusal::Held { held: 2018, expected: 3600 }, Seen::Innovations),
        (Refusal::AidingLost { used: 1, expected: 3600 }, Seen::Reference),
        (Refusal::Bridged { bridged: 1, total: 3 }, Seen::Samples),
        (Refusal::Disturbed { disturbances: 1 }, Seen::Disturbance),
        (Refusal::GimbalAngles { rejected: 5, used: 9 }, Seen::Disturbance),
        (Refusal::AnglesInconsistent { mean: 12.0, limit: 9.0 }, Seen::Disturbance),
        (Refusal::Drift { parameter: 5, sigmas: 5.6, between_s: (0.0, 1.0) }, Seen::Drift),
        (Refusal::Alignment, Seen::Other),
    ];
    for (refusal, seen) in refusals {
        assert_eq!(Seen::of(&refusal.to_string()), seen, "{refusal}");
    }
    let of = octant_calibration::config::UncertainQuantity::Heading;
    let uncertain = Refusal::Uncertain { of, sigma: 0.0518, limit: 0.0035 }.to_string();
    assert_eq!(Seen::of(&uncertain), Seen::Uncertain);
    // 0.0518 rad and 0.0035 rad, by hand: times 180 · 60 / π.
    assert_eq!(
        uncertain,
        "the heading is known to 178.075 arcmin (1 sigma) at the end, and at most 12.032 arcmin is published"
    );
}

#[test]
fn a_ship_that_is_said_to_stand_still() {
    let toml = "[motion]\nkind = \"dockside\"";
    let aiding = "[procedure.calibration.aiding]\nreference = \"zero-velocity\"";
    let text =
        format!("schema = 1\n{toml}\n[procedure.calibration]\nduration = \"1 h\"\n{aiding}\n");
    let scenario = Scenario::parse(&text, "r.toml", Path::new(""), &[]).unwrap();
    let plan = scenario.calibration.as_ref().unwrap();
    let (reason, health) = (held(), HealthCounts::default());
    let run = RefusedRun {
        reason: &reason,
        health: &health,
        faults: &[],
        twin: None,
        scenario: &scenario,
        plan,
    };
    // 0.2 m of amplitude is 0.14 m rms.
    assert_eq!(
        explained(&run),
        [
            "this means: navigation and reference differed by more than the filter can explain with the noise and the errors that it is told of",
            "likely cause 1: the ship moves, by 0.14 m rms on its largest axis, and aiding.reference = \"zero-velocity\" tells the filter that it stands still",
            "  try: procedure.calibration.aiding.reference = \"dock-position\"",
        ]
    );
}

#[test]
fn a_sea_that_is_larger_than_the_filter_is_told() {
    let toml = "[motion]\nkind = \"dockside\"\n[motion.ship]\nsway = [{ amplitude = \"1.25 m\", period = \"15 s\" }]";
    let said = lines(&held(), toml, &HealthCounts::default(), &[]);
    assert_eq!(
        said[1..],
        [
            "likely cause 1: the ship moves by 0.88 m rms on its largest axis, and aiding.sigma takes that for white noise of 0.15 m",
            "  try: procedure.calibration.aiding.sway = \"coloured\"",
        ]
    );
}

#[test]
fn an_instrument_with_a_noise_for_which_there_is_no_state() {
    let drift =
        Refusal::Drift { parameter: 5, sigmas: 9.0, between_s: (150.0, 1200.0) }.to_string();
    let said = lines(&drift, "[imu]\nmodel = \"tactical-mems\"", &HealthCounts::default(), &[]);
    assert_eq!(
        said[1],
        "likely cause 1: the instrument has gyro bias instability 0.753 deg/h, accelerometer bias instability 75.3 ug, and the filter has no state for it"
    );
}

#[test]
fn an_instrument_that_is_worse_than_the_prior_and_a_fault_that_comes_first() {
    let toml = "[imu]\nrate = \"10 Hz\"\ngyro_bias = { normal = \"5 deg/h\" }";
    let fired = |fired: bool| -> FaultResult {
        serde_json::from_value(serde_json::json!({
            "id": "spike-1", "kind": "spike", "armed": true, "fired": fired, "first_sample": null,
            "last_sample": null, "samples_altered": 1, "faulted_crc32": null,
        }))
        .unwrap()
    };
    let said = lines(&held(), toml, &HealthCounts::default(), &[fired(true)]);
    assert_eq!(
        [&said[1], &said[3], &said[5]],
        [
            "likely cause 1: a fault of the scenario fired, spike-1 (spike), and no twin tells what happens without it",
            "likely cause 2: the instrument's errors are larger than the filter's prior says, 1 sigma: gyro_bias of 5.00 deg/h against 0.00500",
            "likely cause 3: imu.rate is 10 Hz: a move turns the body by up to 1.00 deg in one sample",
        ]
    );
    let said = lines(&held(), toml, &HealthCounts::default(), &[fired(false)]);
    assert!(said[1].contains("prior"), "{said:?}");
}

#[test]
fn samples_reference_and_gimbals_by_the_reports_of_the_core() {
    let health = HealthCounts {
        gaps: 3,
        gyro_stuck: 800,
        aiding_lost: 40,
        gimbal_slips: 7,
        ..HealthCounts::default()
    };
    let said = |refusal: Refusal| lines(&refusal.to_string(), "", &health, &[])[1].clone();
    assert_eq!(
        said(Refusal::Bridged { bridged: 20_000, total: 720_000 }),
        "likely cause 1: the core reported 3 gaps, 800 epochs with a stuck gyro"
    );
    assert_eq!(
        said(Refusal::AidingLost { used: 100, expected: 3600 }),
        "likely cause 1: the reference was missing in 40 epochs, and had the stamp of another sample in 0"
    );
    let disturbed = lines(&Refusal::Disturbed { disturbances: 1 }.to_string(), "", &health, &[]);
    assert!(
        disturbed.iter().any(|line| line.contains("different turns in 7 epochs")),
        "{disturbed:?}"
    );
}

#[test]
fn a_disturbance_that_leaves_too_little_time() {
    let of = octant_calibration::config::UncertainQuantity::Heading;
    let uncertain = Refusal::Uncertain { of, sigma: 0.0518, limit: 0.0035 }.to_string();
    let health = HealthCounts { jumps: 410, recoveries: 1, ..HealthCounts::default() };
    let said = lines(&uncertain, "", &health, &[]);
    assert_eq!(
        said[..3],
        [
            "this means: too little was learned, or it was forgotten again after a disturbance",
            "likely cause 1: the filter recovered 1 times and met 410 epochs with jumps: each opens the attitude, which takes time to be learned again",
            "  try: a calibration without the disturbance, or a longer one that rests after it",
        ]
    );
}

#[test]
fn nothing_is_invented() {
    let said = lines(&held(), "", &HealthCounts::default(), &[]);
    assert_eq!(said.len(), 2);
    assert!(said[1].starts_with("likely cause: none shows"), "{said:?}");
    assert!(lines("the unit says no", "", &HealthCounts::default(), &[]).is_empty());
}

#[test]
fn a_limit_that_the_time_does_not_reach() {
    let of = octant_calibration::config::UncertainQuantity::Heading;
    let reason = Refusal::Uncertain { of, sigma: 4.5e-5, limit: 3e-6 }.to_string();
    let said = lines(&reason, "", &HealthCounts::default(), &[]);
    assert!(said[1].contains("too short for this instrument"), "{said:?}");
    assert!(said[2].contains("refuse_above_sigma"), "{said:?}");
}
