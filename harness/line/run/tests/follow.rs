//! Solutions and NIS that don't follow the samples are found.

use octant_endpoint::Tells;
use octant_run::observers::follow::RunFollower;
use octant_sample::Navigation;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{Mode, Output, Sample};

/// Watches 300 s of navigation at 10 Hz; `number` gives the solution of each sample.
fn watch(number: impl Fn(u64) -> [f64; 3]) -> Vec<String> {
    let mut follow = RunFollower::new(Some(Tells::ALL));
    for k in 1..=3000 {
        let [position, velocity, attitude] = number(k);
        let output = Output {
            mode: Mode::Navigating,
            navigation: Navigation {
                latitude_rad: position,
                velocity_mps: [velocity, 0.0, 0.0],
                q_nb: [attitude, 0.0, 0.0, 0.0],
                ..Navigation::default()
            },
            nis: f64::NAN,
            ..Output::default()
        };
        follow.epoch(k * 100_000_000, &output, None);
    }
    follow.reasons()
}

#[test]
fn a_solution_that_changes_follows_also_slowly() {
    assert!(watch(|k| [k as f64; 3]).is_empty());
    // Updated once a second, and parts of it once a second.
    assert!(watch(|k| [(k / 10) as f64; 3]).is_empty());
    assert!(watch(|k| [k as f64, (k / 10) as f64, (k / 10) as f64]).is_empty());
    // Back and forth, as on a ship, and never to the same bits.
    assert!(watch(|k| [(k as f64 * 0.37).sin(), (k as f64).cos(), k as f64]).is_empty());
}

#[test]
fn a_part_that_stands_still_is_found() {
    let all = watch(|_| [0.5; 3]);
    assert_eq!(all.len(), 3, "{all:?}");
    let position = watch(|k| [0.5, k as f64, k as f64]);
    assert_eq!(position.len(), 1);
    assert!(position[0].starts_with("the position of the navigation doesn't follow"));
    assert!(position[0].ends_with("for 299.900 s from 0.100 s on"), "{position:?}");
    // Constant from the middle on.
    let half = watch(|k| [k.min(1500) as f64, k as f64, k as f64]);
    assert!(half[0].contains("150.000 s from 150.000 s on"), "{half:?}");
}

#[test]
fn a_solution_that_goes_in_a_circle_is_found() {
    let circle = watch(|k| [((k / 10) % 5) as f64; 3]);
    assert_eq!(circle.len(), 1);
    assert!(circle[0].contains("are repetitions"), "{circle:?}");
    // The same second again and again is as it was a second ago, and isn't held.
    let second = watch(|k| [(k % 10) as f64; 3]);
    assert!(second[0].contains("are repetitions"), "{second:?}");
}

#[test]
fn nis_that_are_all_alike_are_found() {
    let with = |nis: &dyn Fn(u64) -> f64| {
        let mut follow = RunFollower::new(Some(Tells::ALL));
        for k in 0..20 {
            follow.epoch(k, &Output { nis: nis(k), ..Output::default() }, None);
        }
        follow.reasons()
    };
    assert!(with(&|_| f64::NAN).is_empty());
    assert!(with(&|k| k as f64).is_empty());
    assert_eq!(with(&|_| 0.0), ["the NIS doesn't follow the samples: all 20 are 0"]);
}

/// Watches a navigation of these seconds at 10 Hz, whose solution is new every `every` samples, and
/// which ends with an answer that says that it is done.
fn ends(seconds: u64, every: u64) -> Vec<String> {
    let mut follow = RunFollower::new(Some(Tells::ALL));
    for k in 1..=10 * seconds {
        let value = (k / every) as f64 * 1e-9;
        let navigation = Navigation {
            latitude_rad: value,
            velocity_mps: [value, 0.0, 0.0],
            q_nb: [1.0, value, 0.0, 0.0],
            ..Navigation::default()
        };
        let mode = if k < 10 * seconds { Mode::Navigating } else { Mode::Done };
        let output = Output { mode, navigation, nis: f64::NAN, ..Output::default() };
        follow.epoch(k * 100_000_000, &output, None);
    }
    follow.reasons()
}

#[test]
fn a_last_answer_that_is_done_leaves_the_limit_of_the_standstill() {
    for every in [10, 20, 100, 500] {
        assert!(ends(3600, every).is_empty(), "{:?}", ends(3600, every));
    }
    assert_eq!(ends(3600, 700).len(), 3, "more than a minute is too long");
    // Short navigations keep half of their length.
    assert!(ends(60, 200).is_empty(), "{:?}", ends(60, 200));
    assert_eq!(ends(60, 400).len(), 3);
}

/// 50 Hz.
const PERIOD_NS: u64 = 20_000_000;
const PERIOD_S: f64 = 0.02;
const RADIUS_M: f64 = 6_378_137.0;

/// Solution of a ship that swings to the north and rolls, `t` s after its start, and the sample before.
fn swinging(t: f64) -> (Navigation, Sample) {
    let at = |t: f64| {
        let (sin, cos) = (0.8 * t).sin_cos();
        // 1 m of amplitude, and a roll of 5 degrees.
        let roll = 0.087 * (0.7 * t).sin();
        let q_nb = [(0.5 * roll).cos(), (0.5 * roll).sin(), 0.0, 0.0];
        let navigation = Navigation {
            latitude_rad: 0.5 + (sin + 1e-3 * t) / RADIUS_M,
            longitude_rad: 1.0 + 1e-9 * t,
            velocity_mps: [0.8 * cos + 1e-3, 1e-4 * t, 1e-5 * t],
            q_nb,
            ..Navigation::default()
        };
        (navigation, roll)
    };
    let ((before, from), (now, to)) = (at(t - PERIOD_S), at(t));
    let north_mps = now.velocity_mps[0] - before.velocity_mps[0];
    let up_mps = -9.8 * PERIOD_S;
    let (sin, cos) = (0.5 * (from + to)).sin_cos();
    let felt = [north_mps, sin * up_mps, cos * up_mps];
    let sample = Sample {
        delta_theta: [((to - from) / DELTA_THETA_LSB_RAD) as i32, 0, 0],
        delta_velocity: felt.map(|mps| (mps / DELTA_VELOCITY_LSB_MPS) as i32),
        ..Sample::default()
    };
    (now, sample)
}

/// Follows 400 s of a swinging ship with answers that are altered; `before` are the honest ones.
fn fits(mut altered: impl FnMut(u64, &mut Output, &[Navigation])) -> (Vec<String>, u64) {
    let mut follow = RunFollower::new(Some(Tells::ALL));
    let mut before = Vec::new();
    for k in 1..=20_000u64 {
        let (navigation, sample) = swinging(k as f64 * PERIOD_S);
        before.push(navigation);
        let mut output =
            Output { mode: Mode::Navigating, navigation, nis: f64::NAN, ..Output::default() };
        altered(k, &mut output, &before);
        follow.epoch(k * PERIOD_NS, &output, Some(&sample));
    }
    (follow.reasons(), follow.steps())
}

#[test]
fn answers_of_one_navigation_fit_each_other() {
    assert_eq!(fits(|_, _, _| {}).0, [""; 0]);
    // New every 1, 2, 10 and 50 s, as a whole or the position alone.
    for every in [50, 100, 500, 2500] {
        let whole = fits(|k, output, before| {
            output.navigation = before[(k - k % every).max(1) as usize - 1];
        });
        assert_eq!(whole.0, [""; 0], "whole, every {every} samples");
        let part = fits(|k, output, before| {
            let last = before[(k - k % every).max(1) as usize - 1];
            output.navigation.latitude_rad = last.latitude_rad;
            output.navigation.longitude_rad = last.longitude_rad;
        });
        assert_eq!(part.0, [""; 0], "position, every {every} samples");
    }
    // Rounded to 0.01 arcmin, 0.1 m/s and 0.1 degrees; single precision.
    let coarse = fits(|_, output, _| {
        let round = |value: &mut f64, step: f64| *value = (*value / step).round() * step;
        round(&mut output.navigation.latitude_rad, 0.01 / 60.0 * 0.017_453);
        round(&mut output.navigation.longitude_rad, 0.01 / 60.0 * 0.017_453);
        output.navigation.velocity_mps.iter_mut().for_each(|v| round(v, 0.1));
        output.navigation.q_nb.iter_mut().for_each(|q| round(q, 0.0017));
    });
    // A position that is the same for a minute is another finding.
    let unfit: Vec<&String> = coarse.0.iter().filter(|reason| reason.contains("fit")).collect();
    assert!(unfit.is_empty(), "{unfit:?}");
    let single = fits(|_, output, _| {
        output.navigation.latitude_rad = f64::from(output.navigation.latitude_rad as f32);
        output.navigation.longitude_rad = f64::from(output.navigation.longitude_rad as f32);
    });
    assert_eq!(single.0, [""; 0]);
}

#[test]
fn answers_that_do_not_fit_are_named_with_the_first_one() {
    let found = |altered: fn(u64, &mut Output)| fits(|k, output, _| altered(k, output)).0;
    let jump =
        found(|k, output| output.navigation.latitude_rad += if k >= 9000 { 1e-5 } else { 0.0 });
    assert_eq!(jump.len(), 1, "{jump:?}");
    assert!(
        jump[0].starts_with(
            "the position of the navigation doesn't fit its velocity: 1 answer, the first one at \
             180.000 s off by 63."
        ),
        "{jump:?}"
    );
    let kept = found(|_, output| output.navigation.velocity_mps[1] = 30.0);
    assert!(kept[0].contains("position of the navigation doesn't fit its velocity"), "{kept:?}");
    let surge =
        found(|k, output| output.navigation.velocity_mps[0] += if k % 10 == 0 { 0.0 } else { 1e3 });
    assert!(
        surge.iter().any(|reason| reason.contains("doesn't fit the accelerometers")),
        "{surge:?}"
    );
    let turn = found(|k, output| {
        if k >= 9000 {
            output.navigation.q_nb = [0.995f64.sqrt(), 0.0, 0.0, 0.005f64.sqrt()];
        }
    });
    assert!(
        turn.iter()
            .any(|reason| reason.contains("attitude of the navigation doesn't fit the gyros")
                && reason.contains("at 180.000 s")),
        "{turn:?}"
    );
    let climb =
        found(|k, output| output.navigation.height_m = if k >= 9000 { 500.0 } else { 1e-3 });
    assert!(
        climb[0].contains("the height of the navigation doesn't fit its velocity"),
        "{climb:?}"
    );
}

#[test]
fn steps_of_corrections_are_counted_and_are_no_misfit() {
    let (reasons, steps) = fits(|k, output, _| {
        output.navigation.latitude_rad += 1e-5 * (k / 5000) as f64;
        if k.is_multiple_of(5000) {
            output.nis = k as f64;
        }
    });
    assert_eq!((reasons, steps), (Vec::new(), 4));
}
