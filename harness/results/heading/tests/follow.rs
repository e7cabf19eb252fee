//! Follow-up error, transmission and resolution.

use crate::{assert_near, series};
use octant_heading::follow::{
    FAST, SLOW, follow_up_error_deg, resolution_deg, transmission_error_deg,
};

#[test]
fn a_delay_is_an_error_of_rate_times_delay_in_its_class() {
    let delay_s = 0.04;
    for sign in [1.0, -1.0] {
        // A turn at 8 °/s, then one at 16 °/s, across north.
        let turned = move |t_s: f64| {
            300.0 + sign * if t_s < 10.0 { 8.0 * t_s } else { 80.0 + 16.0 * (t_s - 10.0) }
        };
        let all = series(0.1, 20.0, |t_s| turned(t_s - delay_s), turned);
        let slow = follow_up_error_deg(&all.readings()[..90], SLOW, 0.0).unwrap();
        assert_near(slow, 8.0 * delay_s, 1e-9);
        let fast = follow_up_error_deg(&all.readings()[110..], FAST, 0.0).unwrap();
        assert_near(fast, 16.0 * delay_s, 1e-9);
        assert_eq!(follow_up_error_deg(&all.readings()[110..], SLOW, 0.0), None);
    }
    // At rest there is no turn.
    let still = series(0.1, 20.0, |_| 0.2, |_| 0.0);
    assert_eq!(follow_up_error_deg(still.readings(), SLOW, 0.0), None);
}

#[test]
fn an_error_at_rest_is_no_follow_up_error() {
    let all = series(0.1, 10.0, |t_s| 8.0 * t_s + 0.7, |t_s| 8.0 * t_s);
    assert_near(follow_up_error_deg(all.readings(), SLOW, 0.7).unwrap(), 0.0, 1e-9);
}

#[test]
fn steps_of_a_transmission_are_half_a_step_wrong_at_most() {
    let step = 1.0 / 6.0;
    let put_in: Vec<f64> = (0..3600).map(|i| 0.1 * f64::from(i)).collect();
    let sent: Vec<f64> =
        put_in.iter().map(|heading| octant_heading::angle::rounded(*heading, step)).collect();
    let pairs: Vec<[f64; 2]> = put_in.iter().zip(&sent).map(|(a, b)| [*a, *b]).collect();
    let error = transmission_error_deg(&pairs).unwrap();
    assert!(error <= 0.5 * step + 1e-9 && error > 0.4 * step, "{error}");
    assert_near(resolution_deg(&sent).unwrap(), step, 1e-9);
    assert_eq!(transmission_error_deg(&[]), None);
    assert_eq!(resolution_deg(&[1.0, 1.0]), None);
}
