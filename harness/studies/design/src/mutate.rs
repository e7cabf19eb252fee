//! Local moves of the search: small changes of a candidate.

use crate::candidate::{Gimbals, GridStop, Limits, SHARE_MAX};
use octant_random::draws::Draws;

fn of_all<T: Copy>(draws: &mut Draws, all: &[T]) -> T {
    all[draws.below(all.len())]
}

/// Makes a random candidate.
pub(crate) fn random(limits: &Limits, draws: &mut Draws) -> Vec<GridStop> {
    let most = limits.stops_max.min(30);
    let count = 2 + draws.below(most - 1);
    let mut stops = vec![GridStop { azimuth_deg: 0, roll_deg: 0, share: 4 }];
    while stops.len() < count {
        let near = stops[stops.len() - 1];
        stops.push(neighbour(limits, near, draws));
    }
    stops
}

/// Makes a stop that one move reaches from another.
fn neighbour(limits: &Limits, from: GridStop, draws: &mut Draws) -> GridStop {
    let free = limits.free();
    let [azimuths, rolls] = free.map(|range| limits.values(range));
    let (can_azimuth, can_roll) = (azimuths.len() > 1, rolls.len() > 1);
    loop {
        let mut to = GridStop { share: 1 + draws.below(8) as u32, ..from };
        let which = match (can_azimuth, can_roll, limits.gimbals) {
            (true, false, _) => 0,
            (false, true, _) => 1,
            (_, _, Gimbals::Both) => draws.below(3),
            _ => draws.below(2),
        };
        if which != 1 {
            to.azimuth_deg = of_all(draws, &azimuths);
        }
        if which != 0 {
            to.roll_deg = of_all(draws, &rolls);
        }
        if (to.azimuth_deg, to.roll_deg) != (from.azimuth_deg, from.roll_deg) {
            return to;
        }
    }
}

/// Makes a changed candidate; `None` if the change broke a limit.
pub(crate) fn changed(
    limits: &Limits,
    stops: &[GridStop],
    draws: &mut Draws,
) -> Option<Vec<GridStop>> {
    let mut next = stops.to_vec();
    let changes = if draws.below(4) == 0 { 2 } else { 1 };
    for _ in 0..changes {
        change(limits, &mut next, draws);
    }
    tidy(limits, &mut next);
    (next != stops && limits.keep(&next)).then_some(next)
}

fn change(limits: &Limits, stops: &mut Vec<GridStop>, draws: &mut Draws) {
    let count = stops.len();
    // The first stop is the lead-in: only its share changes.
    let at = if count > 1 { 1 + draws.below(count - 1) } else { 0 };
    let [azimuths, rolls] = limits.free().map(|range| limits.values(range));
    let full = 360 / limits.grid_deg.max(1) * limits.grid_deg;
    match draws.below(12) {
        0 if at > 0 => stops[at].azimuth_deg = of_all(draws, &azimuths),
        1 if at > 0 => stops[at].roll_deg = of_all(draws, &rolls),
        2 if at > 0 => {
            let step = limits.grid_deg * [-1, 1][draws.below(2)];
            if draws.below(2) == 0 {
                stops[at].azimuth_deg += step
            } else {
                stops[at].roll_deg += step
            }
        }
        3 | 4 => {
            let stop = &mut stops[draws.below(count)];
            stop.share = match draws.below(5) {
                0 => stop.share + 1,
                1 => stop.share.saturating_sub(1),
                2 => stop.share * 2,
                3 => stop.share / 2,
                _ => 1 + draws.below(SHARE_MAX as usize / 4) as u32,
            }
            .clamp(1, SHARE_MAX);
        }
        5 if count > 2 => {
            let other = 1 + draws.below(count - 1);
            stops.swap(at, other);
        }
        6 | 7 if count < limits.stops_max => {
            let before = stops[at.min(count - 1)];
            stops.insert(at + 1, neighbour(limits, before, draws));
        }
        8 if count > 2 => {
            stops.remove(at);
        }
        9 if count > 3 => {
            let other = 1 + draws.below(count - 1);
            stops[at.min(other)..=at.max(other)].reverse();
        }
        // A turn of all that follows: the same attitudes seen from another side.
        10 => {
            let turn = [-180, -90, 90, 180, full, -full][draws.below(6)];
            let azimuth = draws.below(2) == 0;
            for stop in &mut stops[at.max(1).min(count)..] {
                if azimuth { stop.azimuth_deg += turn } else { stop.roll_deg += turn }
            }
        }
        // A share moves from one stop to another.
        _ => {
            let other = draws.below(count);
            if stops[at].share > 1 && other != at {
                stops[at].share -= 1;
                stops[other].share = (stops[other].share + 1).min(SHARE_MAX);
            }
        }
    }
}

/// Joins stops at the same angles, and makes moves of one gimbal where both may not turn.
fn tidy(limits: &Limits, stops: &mut Vec<GridStop>) {
    if limits.gimbals == Gimbals::One {
        for index in 1..stops.len() {
            let (before, stop) = (stops[index - 1], &mut stops[index]);
            let by = [stop.azimuth_deg - before.azimuth_deg, stop.roll_deg - before.roll_deg];
            if by[0] != 0 && by[1] != 0 {
                if by[0].abs() < by[1].abs() {
                    stop.azimuth_deg = before.azimuth_deg;
                } else {
                    stop.roll_deg = before.roll_deg;
                }
            }
        }
    }
    stops.dedup_by(|stop, before| {
        let same = (stop.azimuth_deg, stop.roll_deg) == (before.azimuth_deg, before.roll_deg);
        if same {
            before.share = (before.share + stop.share).min(SHARE_MAX);
        }
        same
    });
}
