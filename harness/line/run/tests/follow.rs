//! Solutions and NIS that don't follow the samples are found.

use octant_endpoint::Tells;
use octant_run::observers::follow::RunFollower;
use octant_sample::Navigation;
use octant_sample::{Mode, Output};

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
        follow.epoch(k * 100_000_000, &output);
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
}

#[test]
fn nis_that_are_all_alike_are_found() {
    let with = |nis: &dyn Fn(u64) -> f64| {
        let mut follow = RunFollower::new(Some(Tells::ALL));
        for k in 0..20 {
            follow.epoch(k, &Output { nis: nis(k), ..Output::default() });
        }
        follow.reasons()
    };
    assert!(with(&|_| f64::NAN).is_empty());
    assert!(with(&|k| k as f64).is_empty());
    assert_eq!(with(&|_| 0.0), ["the NIS doesn't follow the samples: all 20 are 0"]);
}
