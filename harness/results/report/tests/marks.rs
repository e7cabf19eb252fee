//! Markers of moves and stops.

use octant_report::marks::phases;
use octant_report::{GimbalPoint, StopLabel};

#[test]
fn moves_lie_between_stops() {
    let point = |hours: f64, moving: bool| GimbalPoint {
        hours,
        azimuth_deg: 0.0,
        roll_deg: 0.0,
        moving,
        stop: None,
    };
    let gimbals = [
        point(0.0, false),
        point(1.0, false),
        point(1.5, true),
        point(1.75, false),
        point(3.0, false),
    ];
    let (moves, stops) = phases(&gimbals, &[]);
    assert_eq!(moves, [(1.5, 1.75, String::new())]);
    assert_eq!(stops, [(0.0, 1.5, "1".to_owned()), (1.75, 3.0, "2".to_owned())]);
}

#[test]
fn stops_of_the_calibration_have_their_positions_where_the_angles_are_the_planned_ones() {
    let point = |hours: f64, roll_deg: f64, moving: bool, stop: Option<u16>| GimbalPoint {
        hours,
        azimuth_deg: 0.0,
        roll_deg,
        moving,
        stop,
    };
    let labels = [(0.0, "1 of 3, position 1 of 2"), (90.0, "2 of 3, position 2 of 2")]
        .map(|(roll_deg, text)| StopLabel { azimuth_deg: 0.0, roll_deg, text: text.to_owned() });
    let gimbals = [
        // The alignment at the first stop belongs to no stop of the calibration.
        point(0.0, 0.0, false, None),
        point(0.5, 0.0, false, Some(0)),
        point(1.0, 0.0, true, Some(1)),
        point(1.1, 90.05, false, Some(1)),
        point(2.0, 90.05, true, Some(0)),
        // A unit that tells another stop than the one that it commands, and one beyond the plan.
        point(2.1, 45.0, false, Some(0)),
        point(3.0, 45.0, true, Some(9)),
        point(3.1, 0.0, false, Some(9)),
        point(4.0, 0.0, false, Some(9)),
    ];
    let (_, stops) = phases(&gimbals, &labels);
    let texts: Vec<&str> = stops.iter().map(|(.., text)| text.as_str()).collect();
    assert_eq!(texts, ["1 of 3, position 1 of 2", "2 of 3, position 2 of 2", "3", "4"]);
}
