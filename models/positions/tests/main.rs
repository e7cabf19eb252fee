//! Timing of the gimbals: dwells fill the time, and the cursor visits every stop.
#![allow(clippy::unwrap_used)]

use octant_positions::positions::{EIGHT, SIX, SIXTEEN, from_degrees};
use octant_positions::schedule::{Cursor, TurntableRates, dwell_s, move_s, moves_s};
use octant_sample::GimbalAngles;

const DT: f64 = 0.005;

fn rates() -> TurntableRates {
    let rate = 10f64.to_radians();
    TurntableRates { rate_radps: rate, acceleration_radps2: rate }
}

#[test]
fn a_trapezoid_takes_the_time_of_the_textbook() {
    // θ/ω + ω/α, and below ω²/α a triangle of 2 √(θ/α).
    assert!((move_s(90f64.to_radians(), &rates()) - 10.0).abs() < 1e-12);
    assert!((move_s(-180f64.to_radians(), &rates()) - 19.0).abs() < 1e-12);
    assert!((move_s(2.5f64.to_radians(), &rates()) - 1.0).abs() < 1e-12);
    assert_eq!(move_s(0.0, &rates()), 0.0);
}

#[test]
fn dwells_and_moves_fill_the_duration() {
    for (stops, weights) in [(SIX, 17.0), (EIGHT, 21.0)] {
        for passes in [1, 3] {
            let sequence = from_degrees(stops, passes).unwrap();
            let dwell = dwell_s(&sequence, 14_400.0, &rates()).unwrap();
            let whole = moves_s(&sequence, &rates()) + f64::from(passes) * weights * dwell;
            assert!((whole - 14_400.0).abs() < 1e-8);
        }
    }
}

#[test]
fn a_cursor_visits_every_stop_of_every_pass_and_leaves_the_last_at_the_end() {
    let sequence = from_degrees(EIGHT, 2).unwrap();
    let dwell = dwell_s(&sequence, 7200.0, &rates()).unwrap();
    let mut cursor = Cursor::new(sequence, GimbalAngles::default(), rates(), dwell, DT, false);
    let mut stops = vec![0];
    for tick in 1..=(7200.0 / DT) as u64 {
        cursor.advance(tick);
        if *stops.last().unwrap() != cursor.stop() {
            stops.push(cursor.stop());
        }
    }
    assert_eq!(stops, (0..38).collect::<Vec<_>>());
    assert!((cursor.departure_s() - 7200.0).abs() < 1e-6);
}

#[test]
fn navigation_walks_for_ever() {
    let sequence = from_degrees(SIXTEEN, 1).unwrap();
    let mut cursor = Cursor::new(sequence, GimbalAngles::default(), rates(), 300.0, DT, true);
    // 300 s of dwell and 19 s of move, forty times.
    let ticks = (40.0 * 319.0 / DT) as u64;
    for tick in 1..=ticks {
        cursor.advance(tick);
    }
    assert_eq!(cursor.stop(), 40);
}

#[test]
fn a_gap_over_several_stops_is_caught_up() {
    let sequence = from_degrees(SIXTEEN, 1).unwrap();
    let mut walked = Cursor::new(sequence, GimbalAngles::default(), rates(), 300.0, DT, true);
    let mut jumped = walked.clone();
    let ticks = (10.5 * 319.0 / DT) as u64;
    for tick in 1..=ticks {
        walked.advance(tick);
    }
    jumped.advance(ticks);
    assert_eq!((walked.stop(), walked.command()), (jumped.stop(), jumped.command()));
    assert_eq!(walked.departure_s(), jumped.departure_s());
}

#[test]
fn moves_that_leave_no_dwell_are_refused() {
    let sequence = from_degrees(SIX, 1).unwrap();
    let refused = dwell_s(&sequence, 160.0, &rates()).unwrap_err();
    assert!((refused.moves_s - 160.0).abs() < 1e-9);
    assert!(refused.to_string().contains("the moves alone take"), "{refused}");
}
