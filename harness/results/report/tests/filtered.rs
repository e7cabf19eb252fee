//! Scale of the errors while a filter calibrates.

use octant_report::chart::{Band, Chart, Line, Role};
use octant_report::filtered::scale;

#[test]
fn the_beginning_does_not_set_the_scale() {
    let mut chart = Chart::new("Heading error", "h", "y");
    let sigma = |hours: f64, sigma: f64| [hours, -sigma, sigma];
    chart.bands = vec![Band {
        label: String::new(),
        role: Role::Primary,
        points: vec![sigma(0.0, 6.0), sigma(0.3, 2.0), sigma(0.5, 1.0), sigma(4.0, 0.2)],
    }];
    assert_eq!(scale(&chart), Some([-1.25, 1.25]));
    // An error outside of the band is in sight.
    let points = vec![[1.0, 0.1], [2.0, -1.6]];
    chart.lines = vec![Line { label: String::new(), role: Role::Primary, points }];
    assert_eq!(scale(&chart), Some([-2.0, 2.0]));
    chart.bands[0].points[0] = sigma(0.0, 2.0);
    assert_eq!(scale(&chart), None, "the chart's own choice");
}
