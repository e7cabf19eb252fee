//! How quickly the truth changes, from one comparison with the solution to the next.

use octant_earth::ellipsoid::Ellipsoid;
use octant_sample::Truth;

/// Largest changes of the truth so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct TrueMotion {
    last: Option<(u64, Truth)>,
    rates: [f64; 3],
}

impl TrueMotion {
    /// Takes the truth at a time, ns.
    pub(super) fn push(&mut self, now_ns: u64, truth: &Truth) {
        let last = self.last.replace((now_ns, *truth));
        let Some((before_ns, before)) = last.filter(|(before_ns, _)| *before_ns < now_ns) else {
            return;
        };
        let elapsed_s = (now_ns - before_ns) as f64 * 1e-9;
        let earth = Ellipsoid::at(before.latitude_rad, before.height_m);
        let across_m = earth.transverse_radius_m * earth.cos_latitude;
        let north_m = (truth.latitude_rad - before.latitude_rad) * earth.meridian_radius_m;
        let east_m = (truth.longitude_rad - before.longitude_rad) * across_m;
        let change = |axis: usize| truth.velocity_mps[axis] - before.velocity_mps[axis];
        // Of unit quaternions the chord: 2 sin(angle / 4), the shorter way round.
        let chord = |sign: f64| -> f64 {
            let parts = before.q_nb.iter().zip(&truth.q_nb);
            libm::sqrt(parts.map(|(a, b)| (a - sign * b) * (a - sign * b)).sum::<f64>())
        };
        let turned_rad = 4.0 * libm::asin((0.5 * chord(1.0).min(chord(-1.0))).min(1.0));
        let changes = [libm::hypot(north_m, east_m), libm::hypot(change(0), change(1)), turned_rad];
        for (most, change) in self.rates.iter_mut().zip(changes) {
            // NaN: the source doesn't tell it.
            *most = most.max(change / elapsed_s);
        }
    }

    /// Largest speed, acceleration and turning rate of the body so far: m/s, m/s², rad/s. Between two
    /// comparisons, normally a second, they are means.
    #[must_use]
    pub fn rates(&self) -> [f64; 3] {
        self.rates
    }
}
