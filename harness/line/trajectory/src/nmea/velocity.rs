//! To which positions the velocities without a time belong.

use super::choice::chosen;
use super::date::LINES_TO_LOOK_AT;
use super::lines::NmeaLines;
use super::problem::NmeaProblem;
use super::sentence::Sentence;
use crate::point::SECOND_NS;
use octant_earth::ellipsoid::Ellipsoid;
use octant_scenario::trajectory::NmeaChoice;

/// Fewest velocities that tell to which positions they belong.
const VELOCITIES_LEAST: u32 = 5;

/// Learns whether the velocities without a time belong to the positions after them: those of the positions before and after
/// each tell.
pub(super) fn velocity_leads(
    lines: &mut NmeaLines,
    choice: &NmeaChoice,
) -> Result<bool, NmeaProblem> {
    let mut points: Vec<(i64, [f64; 2])> = Vec::new();
    // Velocities with the number of points before them.
    let mut velocities: Vec<(usize, [f64; 2])> = Vec::new();
    while lines.advance()? && lines.line <= LINES_TO_LOOK_AT {
        let Ok(sentence) = Sentence::of(&lines.text) else { continue };
        let sentence = chosen(sentence, choice);
        match (sentence.of_day_ns, sentence.position, sentence.velocity_mps) {
            (Some(at_ns), Some(position), _)
                if points.last().is_none_or(|(last_ns, _)| *last_ns != at_ns) =>
            {
                points.push((at_ns, position.value));
            }
            (None, _, Some(velocity)) => velocities.push((points.len(), velocity.value)),
            _ => {}
        }
    }
    let moved = |point: usize| {
        let ((from_ns, from), (to_ns, to)) =
            (points.get(point.checked_sub(1)?)?, points.get(point + 1)?);
        let elapsed_s = (to_ns - from_ns) as f64 / SECOND_NS as f64;
        let earth = Ellipsoid::at(from[0], 0.0);
        let across_m = earth.transverse_radius_m * earth.cos_latitude;
        let north_mps = (to[0] - from[0]) * earth.meridian_radius_m / elapsed_s;
        let east_mps = (to[1] - from[1]) * across_m / elapsed_s;
        (elapsed_s > 0.0).then_some([north_mps, east_mps])
    };
    let (mut before, mut after) = (Spread::default(), Spread::default());
    for (points_before, velocity) in &velocities {
        let Some(last) = points_before.checked_sub(1) else { continue };
        let (Some(of_last), Some(of_next)) = (moved(last), moved(last + 1)) else { continue };
        let off = |moved: [f64; 2]| [0, 1].map(|axis| velocity[axis] - moved[axis]);
        before.add(off(of_last));
        after.add(off(of_next));
    }
    // Without a change of velocity the two say the same.
    Ok(before.count >= VELOCITIES_LEAST && after.square() < 0.5 * before.square())
}

/// Squares of differences about their mean: a constant error of the velocities says nothing of their time.
#[derive(Clone, Copy, Debug, Default)]
struct Spread {
    count: u32,
    sum: [f64; 2],
    squares: f64,
}

impl Spread {
    fn add(&mut self, off: [f64; 2]) {
        self.count += 1;
        for (sum, off) in self.sum.iter_mut().zip(off) {
            *sum += off;
            self.squares += off * off;
        }
    }

    fn square(&self) -> f64 {
        let [north, east] = self.sum;
        self.squares - (north * north + east * east) / f64::from(self.count.max(1))
    }
}
