//! Honest units in other implementations: none of them causes a finding.

use super::unit::{CALIBRATION, HONEST, Over, SECOND, Turn, Twist, run, run_of, scenario};
use octant_sample::{Health, Mode};
use octant_verdict::Verdict;
use std::f64::consts::TAU;

fn passes(about: &str, over: Over, twist: Twist) {
    let summary = run(over, twist).unwrap();
    assert_eq!(summary.verdict, Verdict::Pass, "{about}: {:?}", summary.reasons);
    assert!(summary.findings.is_empty() && summary.reasons.is_empty(), "{about}");
}

fn answers(about: &str, answer: fn(&mut Turn<'_>)) {
    passes(about, Over::Udp, Twist { answer, ..HONEST });
}

#[test]
fn the_core_itself_passes_over_every_port() {
    for over in [Over::Serial, Over::Udp, Over::Can] {
        passes("the core", over, HONEST);
    }
}

#[test]
fn the_core_in_process_passes() {
    let summary = super::unit::summary_of(&scenario("")).unwrap();
    assert_eq!(summary.verdict, Verdict::Pass, "{:?}", summary.reasons);
}

macro_rules! honest {
    ($($name:ident: $about:literal, $twist:expr;)*) => {
        /// Lists their behaviours.
        pub fn list() -> Vec<&'static str> {
            vec![$($about),*]
        }
        $(#[test]
        fn $name() {
            let twist: Twist = $twist;
            passes($about, Over::Udp, twist);
        })*
    };
}

const fn answer(answer: fn(&mut Turn<'_>)) -> Twist {
    Twist { answer, ..HONEST }
}

/// Rounds to single precision, which many units use.
fn single(value: &mut f64) {
    *value = f64::from(*value as f32);
}

honest! {
    in_single_precision: "velocity and attitude in single precision", answer(|t| {
        t.output.navigation.velocity_mps.iter_mut().for_each(single);
        t.output.navigation.q_nb.iter_mut().for_each(single);
    });
    the_other_quaternion: "the attitude with the other sign", answer(|t| {
        t.output.navigation.q_nb = t.output.navigation.q_nb.map(|q| -q);
    });
    attitude_changes_sign: "attitudes whose sign changes from one to the next", answer(|t| {
        if t.k.is_multiple_of(2) {
            t.output.navigation.q_nb = t.output.navigation.q_nb.map(|q| -q);
        }
    });
    updates_once_a_second: "a navigation that is new once a second", answer(|t| {
        let last = t.k - t.k % SECOND;
        if t.k > CALIBRATION && t.k > last && last >= CALIBRATION {
            t.output.navigation = t.before[last as usize - 1].navigation;
        }
    });
    updates_position_slowly: "a position that is new twice a second", answer(|t| {
        let last = t.k - t.k % (SECOND / 2);
        if t.k > CALIBRATION && t.k > last && last >= CALIBRATION {
            let before = t.before[last as usize - 1].navigation;
            t.output.navigation.latitude_rad = before.latitude_rad;
            t.output.navigation.longitude_rad = before.longitude_rad;
        }
    });
    aligns_first: "an alignment of its own before it calibrates", answer(|t| {
        if t.k < SECOND {
            t.output.mode = Mode::Aligning;
        }
    });
    numbers_its_stops_otherwise: "stops that it numbers from 100", answer(|t| t.output.stop += 100);
    never_says_moving: "gimbals that it never says to be moving", answer(|t| t.output.moving = false);
    always_says_moving: "gimbals that it always says to be moving", answer(|t| t.output.moving = true);
    commands_with_a_rounded_angle: "set points that are rounded to a thousandth of a degree", answer(|t| {
        let target = &mut t.output.gimbal_command.target;
        target.roll -= target.roll % 2000;
    });
    revisions_in_steps_of_ten: "revisions that it counts in tens", answer(|t| t.output.parameters_revision *= 10);
    revisions_of_a_later_life: "revisions that don't begin at zero", answer(|t| t.output.parameters_revision += 1 << 20);
    reports_all_kinds: "reports of its health that nobody else knows", answer(|t| {
        t.output.health |= Health::from_bits_retain(1 << 27);
    });
    tells_no_nis: "no NIS where it measured nothing for a while", answer(|t| {
        if t.k < 3 * SECOND {
            t.output.nis = f64::NAN;
        }
    });
    nis_of_zero_once: "a NIS of exactly zero, once", answer(|t| {
        if t.k == 5 * SECOND {
            t.output.nis = 0.0;
        }
    });
    navigates_to_the_end: "never says that it is done", answer(|t| {
        if t.output.mode == Mode::Done {
            t.output.mode = Mode::Navigating;
        }
    });
    changes_modes_a_sample_late: "modes that come a sample late", answer(|t| {
        if let Some(before) = t.before.last() {
            t.output.mode = before.mode;
        }
    });
    heights_of_its_own: "a height that drifts by metres", answer(|t| t.output.navigation.height_m += 5.0);
    minus_zeros: "zeros with a sign", answer(|t| {
        for v in &mut t.output.navigation.velocity_mps {
            if *v == 0.0 {
                *v = -0.0;
            }
        }
    });
    slow: "answers after three milliseconds", answer(|t| {
        if t.k.is_multiple_of(10) {
            std::thread::sleep(std::time::Duration::from_millis(3));
        }
    });
    wider_uncertainties: "uncertainties that are five times as careful", Twist {
        parameters: |_, _, sigma| for s in sigma.iter_mut() { *s *= 5.0 },
        ..HONEST
    };
    no_silence_of_its_own: "no time after which it gives the harness up", Twist { silence_ms: 0, ..HONEST };
}

/// Navigations that are long enough for a unit that answers anew every so many seconds.
#[test]
fn units_that_answer_anew_every_2_10_and_50_seconds() {
    fn every<const SECONDS: u64>(t: &mut Turn<'_>) {
        let last = t.k - t.k % (SECONDS * SECOND);
        if t.k > CALIBRATION && t.k > last && last >= CALIBRATION {
            t.output.navigation = t.before[last as usize - 1].navigation;
        }
    }
    let long = |seconds: u64| {
        let more = super::unit::SCENARIO
            .replace("duration = \"10 s\"", &format!("duration = \"{seconds} s\""));
        octant_scenario::Scenario::parse(&more, "hostile.toml", std::path::Path::new(""), &[])
            .unwrap()
    };
    for (seconds, answer) in
        [(20, every::<2> as fn(&mut Turn<'_>)), (60, every::<10>), (300, every::<50>)]
    {
        let summary = run_of(&long(seconds), Over::Udp, Twist { answer, ..HONEST }).unwrap();
        assert_eq!(summary.verdict, Verdict::Pass, "{seconds} s: {:?}", summary.reasons);
        assert!(summary.findings.is_empty(), "{:?}", summary.findings);
    }
}

#[test]
fn a_turn_more_of_longitude_is_not_wrapped() {
    // The error is a whole turn, which the unit may report that way: it is no violation in an
    // answer, and fails by its requirement.
    let twist = Twist { answer: |t| t.output.navigation.longitude_rad += TAU, ..HONEST };
    let summary = run(Over::Udp, twist).unwrap();
    assert!(summary.findings.is_empty(), "{:?}", summary.findings);
    answers("nothing", |_| {});
}

#[test]
fn faults_of_the_samples_are_not_the_units() {
    // The answer to an epoch that the harness itself altered refers to the altered epoch.
    let fault = |kind: &str, more: &str| {
        format!(
            "[[faults]]\nid = \"a\"\nkind = \"{kind}\"\ntrigger = {{ at = \"22 s\" }}\n\
             duration = \"200 ms\"\n{more}"
        )
    };
    for (kind, more) in [
        ("duplicate", ""),
        ("reorder", ""),
        ("dropout", ""),
        ("dropout-held", ""),
        ("frozen-clock", ""),
        ("time-offset", "offset = \"1 ms\"\n"),
    ] {
        let summary = run_of(&scenario(&fault(kind, more)), Over::Udp, HONEST);
        let summary = summary.unwrap_or_else(|error| panic!("{kind}: {error}"));
        assert!(summary.findings.is_empty(), "{kind}: {:?}", summary.findings);
    }
}
