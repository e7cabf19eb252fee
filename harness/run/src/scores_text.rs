//! Scores of a navigation as text for the terminal.

use octant_score::summary::{ErrorScore, Navigation};

/// Renders the scores of a navigation, one line each for latitude, longitude, radial error, attitude and
/// velocity.
#[must_use]
pub fn navigation_lines(n: &Navigation) -> Vec<String> {
    let error = |e: &ErrorScore| {
        let slope = e.slope_per_day.map_or(String::new(), |s| format!(", {s:+.3} arcmin/day"));
        format!("max {:.3}, rms {:.3} arcmin{slope}", e.max, e.rms)
    };
    let mut lines = vec![
        format!("    latitude  {}", error(&n.latitude_error_arcmin)),
        format!("    longitude {}", error(&n.longitude_error_arcmin)),
        format!(
            "    radial    max {:.3}, rms {:.3} nmi, {:.4} nmi/h",
            n.radial_error_nmi.max, n.radial_error_nmi.rms, n.radial_error_nmi.rate_per_h
        ),
    ];
    let pair = |e: &ErrorScore| format!("max {:.3}, rms {:.3}", e.max, e.rms);
    if let (Some(heading), Some(pitch), Some(roll)) =
        (&n.heading_error_arcmin, &n.pitch_error_arcmin, &n.roll_error_arcmin)
    {
        let [heading, pitch, roll] = [heading, pitch, roll].map(pair);
        lines.push(format!("    attitude  heading {heading}; pitch {pitch}; roll {roll} arcmin"));
    }
    if let (Some(north), Some(east)) = (&n.velocity_north_error_mps, &n.velocity_east_error_mps) {
        let [north, east] = [north, east].map(pair);
        lines.push(format!("    velocity  north {north}; east {east} m/s"));
    }
    lines
}
