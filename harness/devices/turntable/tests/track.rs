//! Angles between looks at a table.

use octant_plant::config::TurntableConfig;
use octant_plant::table::{self, GimbalTable};
use octant_turntable::{AxisStatus, TableAxis, TableStatus, Track, TrackPoint};
use proptest::prelude::*;
use std::time::{Duration, Instant};

fn ms(ms: u64) -> Duration {
    Duration::from_millis(ms)
}

fn status(at: Instant, angles: [f64; 2], rates: [Option<f64>; 2]) -> TableStatus {
    let axis = |index: usize| AxisStatus {
        angle_rad: angles[index],
        rate_radps: rates[index],
        at: Some(at),
        at_within: ms(3),
        ..AxisStatus::default()
    };
    TableStatus { axes: [axis(0), axis(1)] }
}

proptest! {
    /// A steady turn is reproduced exactly, at any times of looks, also beyond the last look.
    #[test]
    fn a_steady_turn_is_found_again(
        looks in prop::collection::vec(1u64..50, 2..200),
        when in 0.0f64..1.2,
        rate in -0.5f64..0.5,
        says_rate: bool,
    ) {
        let start = Instant::now();
        let angle = |t: Duration| 1.0 + rate * t.as_secs_f64();
        let mut track = Track::new();
        let mut time = Duration::ZERO;
        let mut times = Vec::new();
        for look in looks {
            time += ms(look);
            times.push(time);
            let said = says_rate.then_some(rate);
            track.add(&status(start + time, [angle(time), -angle(time)], [said, said.map(|r| -r)]));
        }
        let kept = &times[times.len().saturating_sub(Track::POINTS)..];
        let when = time.mul_f64(when);
        match track.at(TableAxis::Roll, start + when) {
            None => prop_assert!(when < kept[0]),
            Some(place) => {
                prop_assert!(when >= kept[0]);
                prop_assert!((place.angle_rad + angle(when)).abs() < 1e-9);
                let nearest = kept.iter().map(|t| t.abs_diff(when)).min().unwrap();
                prop_assert_eq!(place.age, nearest);
            }
        }
    }
}

/// Between looks at an interval h a line deviates from a move with acceleration a by at most
/// a·h²/8; extrapolation to a time t after the last look deviates by a·t²/2.
#[test]
fn a_move_is_missed_by_what_its_acceleration_does_alone() {
    let degrees = f64::to_radians;
    let (rate, acceleration) = (degrees(10.0), degrees(10.0));
    let config = TurntableConfig {
        rate_radps: rate,
        acceleration_radps2: acceleration,
        encoder_sigma_rad: 0.0,
        non_orthogonality_rad: 0.0,
        backlash_rad: 0.0,
        errors: Default::default(),
    };
    let mut plant = GimbalTable::new(&config);
    plant.go_to(table::GimbalAxis::Azimuth, degrees(30.0), rate, 0);
    let true_at = |ms: u64| plant.motion(table::GimbalAxis::Azimuth, ms * 1_000_000);
    let (start, mut track) = (Instant::now(), Track::new());
    let (mut between, mut beyond) = (0.0f64, 0.0f64);
    for look in 0..250u64 {
        let now = look * 20;
        let motion = true_at(now);
        track.add(&status(start + ms(now), [motion.angle_rad, 0.0], [Some(motion.rate_radps); 2]));
        let missed = |when: u64| {
            let place = track.at(TableAxis::Azimuth, start + ms(when)).unwrap();
            (place.angle_rad - true_at(when).angle_rad).abs()
        };
        beyond = beyond.max(missed(now + 20));
        if look > 0 {
            between = between.max(missed(now - 10));
        }
    }
    let h = 0.02;
    assert!(between <= acceleration * h * h / 8.0 * 1.001 && between > 0.0, "{between}");
    assert!(beyond <= acceleration * h * h / 2.0 * 1.001 && beyond > 0.0, "{beyond}");
}

#[test]
fn nothing_is_known_before_the_table_said_something() {
    let (start, mut track) = (Instant::now() + ms(1000), Track::new());
    assert_eq!(track.at(TableAxis::Roll, start), None);
    track.add(&status(start, [0.5, 0.7], [None; 2]));
    assert_eq!(track.at(TableAxis::Roll, start - ms(1)), None);
    let place = track.at(TableAxis::Roll, start + ms(5)).unwrap();
    assert_eq!(place, TrackPoint { angle_rad: 0.7, age: ms(5), within: ms(3) });
    // A late look, or one without a time, changes nothing.
    track.add(&status(start - ms(10), [9.0, 9.0], [None; 2]));
    track.add(&TableStatus::default());
    assert_eq!(track.at(TableAxis::Roll, start + ms(5)), Some(place));
}
