//! Positions of a sequence: the distinct directions of gravity in the body, in the order of their
//! first visits.
//!
//! A sequence comes back to a position on its way, also from another azimuth: the nineteen stops of
//! the eight positions have eight directions. Down in body at gimbal angles a and r is
//! `(sin r sin a, sin r cos a, cos r)` on a level base, see [`octant_earth::frames::c_cb`].

use crate::sequence::{STOPS_MAX, Stop};
use nalgebra::Vector3;
use octant_earth::frames;

/// Directions closer than this are one position, rad: 1 arcmin.
const SAME_RAD: f64 = 1.0 / 60.0 * core::f64::consts::PI / 180.0;

/// Positions that the stops of a sequence visit, numbered from 1 by their first visits.
///
/// ```
/// use octant_positions::positions::{EIGHT, from_degrees};
/// use octant_positions::visits::VisitedPositions;
///
/// let eight = from_degrees(EIGHT, 1).unwrap();
/// let visited = VisitedPositions::of(eight.stops());
/// assert_eq!(visited.count(), 8);
/// // The seventh stop comes back to roll 90°, where the third was the first.
/// assert_eq!(visited.at(6), 3);
/// assert_eq!(visited.first_visit(3), Some(2));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VisitedPositions {
    numbers: [u8; STOPS_MAX],
    stops: usize,
    count: u8,
}

impl VisitedPositions {
    /// Numbers the positions of the stops of one pass; stops beyond [`STOPS_MAX`] are left out.
    #[must_use]
    pub fn of(stops: &[Stop]) -> Self {
        let mut visited =
            Self { numbers: [0; STOPS_MAX], stops: stops.len().min(STOPS_MAX), count: 0 };
        let mut directions = [Vector3::zeros(); STOPS_MAX];
        for (number, stop) in visited.numbers.iter_mut().zip(stops) {
            let c_cb = frames::c_cb(stop.azimuth_rad, stop.roll_rad);
            let down = Vector3::new(c_cb[(2, 0)], c_cb[(2, 1)], c_cb[(2, 2)]);
            let known = &directions[..usize::from(visited.count)];
            *number =
                match known.iter().zip(1..).find(|(other, _)| (down - **other).norm() < SAME_RAD) {
                    Some((_, number)) => number,
                    None => {
                        directions[usize::from(visited.count)] = down;
                        visited.count += 1;
                        visited.count
                    }
                };
        }
        visited
    }

    /// Number of positions.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count.into()
    }

    /// Position of a stop, from 1. The stop counts from 0, over all passes.
    #[must_use]
    pub fn at(&self, stop: usize) -> usize {
        self.numbers[stop % self.stops.max(1)].into()
    }

    /// Stop, from 0, that visits a position first; `None` if there is no such position. The position
    /// counts from 1.
    #[must_use]
    pub fn first_visit(&self, position: usize) -> Option<usize> {
        self.numbers[..self.stops].iter().position(|number| usize::from(*number) == position)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::positions::{SEQUENCES, SIXTEEN, from_degrees};

    fn visited(name: &str) -> VisitedPositions {
        let stops = crate::positions::named(name).unwrap();
        VisitedPositions::of(from_degrees(stops, 1).unwrap().stops())
    }

    #[test]
    fn stops_of_eight_have_the_positions_of_their_angles() {
        // By hand from (sin r sin a, sin r cos a, cos r): 1 z, 2 yz, 3 y, 4 −z, 5 −y, 6 x, 7 −x, 8 xz.
        let by_hand = [1, 2, 3, 4, 5, 4, 3, 6, 5, 7, 5, 6, 4, 7, 4, 6, 8, 1, 1];
        let eight = visited("eight");
        assert_eq!(core::array::from_fn(|stop| eight.at(stop)), by_hand);
        for (position, first) in (1..).zip([0, 1, 2, 3, 4, 7, 9, 16]) {
            assert_eq!(eight.first_visit(position), Some(first), "{position}");
        }
        assert_eq!((eight.first_visit(0), eight.first_visit(9)), (None, None));
        // The second pass begins with the first position again.
        assert_eq!((eight.at(19), eight.at(19 + 16)), (1, 8));
    }

    #[test]
    fn sequences_have_the_positions_of_their_names() {
        let counts = [
            // Their tilts lie in one plane of the body or in two, but both differ from the six.
            ("six", 6),
            ("eight", 8),
            ("eight-level", 8),
            ("eight-same-plane", 8),
            // Each axis up and down, with two headings.
            ("twelve", 6),
            ("nineteen", 6),
            // At roll 0° and 180° the azimuth doesn't move gravity: 2 directions; those of the four
            // other rolls are 2 · 4, because (a, r) and (a + 180°, −r) are one.
            ("twenty-four", 10),
        ];
        assert_eq!(counts.len(), SEQUENCES.len());
        for (name, count) in counts {
            assert_eq!(visited(name).count(), count, "{name}");
        }
        let moves = from_degrees(SIXTEEN, 1).unwrap();
        assert_eq!(VisitedPositions::of(moves.stops()).count(), 2, "z up and z down");
    }

    #[test]
    fn directions_within_an_arcminute_are_one_position() {
        let stop = |roll_arcmin: f64| Stop {
            azimuth_rad: 0.3,
            roll_rad: (roll_arcmin / 60.0).to_radians(),
            weight: 1.0,
        };
        assert_eq!(VisitedPositions::of(&[stop(10.0), stop(10.9)]).count(), 1);
        assert_eq!(VisitedPositions::of(&[stop(10.0), stop(11.1)]).count(), 2);
        assert_eq!(VisitedPositions::of(&[stop(0.0); STOPS_MAX]).count(), 1);
        let all: [Stop; STOPS_MAX] = core::array::from_fn(|k| stop(60.0 * k as f64));
        let visited = VisitedPositions::of(&all);
        assert_eq!((visited.count(), visited.at(63)), (STOPS_MAX, STOPS_MAX));
        assert_eq!(VisitedPositions::of(&[]).count(), 0);
        assert_eq!(VisitedPositions::of(&[]).at(3), 0);
    }
}
