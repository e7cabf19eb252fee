//! The gimbals over the run, as the core commands them.

use super::solution::hours;
use octant_sample::{Mode, Output};
use octant_score::points::GimbalPoint;

/// Interval at which a gimbal at rest is drawn, ns.
const STANDING_PERIOD_NS: u64 = 60_000_000_000;
/// Maximum number of points: days of rotation in navigation are all alike.
const POINTS_MAX: usize = 40_000;

/// Ends of the moves, and the gimbals at rest once a minute.
#[derive(Clone, Debug, Default)]
pub struct GimbalSeries {
    next_ns: u64,
    was_moving: bool,
    /// The angles.
    pub points: Vec<GimbalPoint>,
}

impl GimbalSeries {
    /// Takes an answer; true if the unit's word whether they move has changed.
    #[inline(always)]
    pub(super) fn answer(&mut self, output: &Output) -> bool {
        let changes = output.moving != self.was_moving;
        if changes || output.device_time.ns >= self.next_ns {
            self.draw(output);
        }
        changes
    }

    #[inline(never)]
    fn draw(&mut self, output: &Output) {
        // A move is drawn as a line between its ends.
        self.next_ns = output.device_time.ns + STANDING_PERIOD_NS;
        self.was_moving = output.moving;
        if self.points.len() < POINTS_MAX {
            let target = output.gimbal_command.target;
            let (azimuth_deg, roll_deg) =
                (target.azimuth_rad().to_degrees(), target.roll_rad().to_degrees());
            // Until the gimbals arrive they are drawn at their last position.
            let (azimuth_deg, roll_deg) = match self.points.last() {
                Some(last) if output.moving => (last.azimuth_deg, last.roll_deg),
                _ => (azimuth_deg, roll_deg),
            };
            let stop = (output.mode == Mode::Calibrating).then_some(output.stop);
            let (hours, moving) = (hours(output), output.moving);
            self.points.push(GimbalPoint { hours, azimuth_deg, roll_deg, moving, stop });
        }
    }
}
