//! Candidates: stops on a grid of gimbal angles, with whole numbers as shares of the time.
//!
//! A candidate is exactly the sequence that is written into a scenario: what is judged is what will run.

use crate::setup::DesignError;
use octant_calibration::positions::Degrees;
use octant_calibration::sequence::{STOPS_MAX, Sequence, Stop};
use octant_earth::units::DEG;
use serde::{Deserialize, Serialize};

/// Largest share of a stop.
pub const SHARE_MAX: u32 = 64;
/// Share of a stop of the published sequences, so that finer shares are possible.
const SHARE_OF_ONE: f64 = 4.0;

/// A stop on the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct GridStop {
    /// Inner gimbal, deg, cumulative.
    pub azimuth_deg: i32,
    /// Outer gimbal, deg, cumulative.
    pub roll_deg: i32,
    /// Dwell relative to the others.
    pub share: u32,
}

impl GridStop {
    /// Makes a stop of a published sequence, whose angles are whole degrees.
    #[must_use]
    pub fn of_published((azimuth, roll, weight): &Degrees) -> Self {
        Self {
            azimuth_deg: *azimuth as i32,
            roll_deg: *roll as i32,
            share: (*weight * SHARE_OF_ONE) as u32,
        }
    }
}

/// Gimbals that may turn in one move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Gimbals {
    /// Both at once.
    Both,
    /// One a move.
    One,
    /// The azimuth gimbal alone; roll stands at zero.
    Azimuth,
    /// The roll gimbal alone; azimuth stands at zero.
    Roll,
}

/// Limits of the gimbals and of a sequence.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Limits {
    /// Gimbals that may turn.
    pub gimbals: Gimbals,
    /// Smallest and largest azimuth, deg, cumulative.
    pub azimuth_deg: (i32, i32),
    /// Smallest and largest roll, deg, cumulative.
    pub roll_deg: (i32, i32),
    /// Grid of the angles, deg.
    pub grid_deg: i32,
    /// Largest number of stops.
    pub stops_max: usize,
    /// Shortest dwell, s.
    pub dwell_min_s: f64,
    /// Time at rest at zero with which every sequence starts, s: the level alignment.
    pub lead_in_s: f64,
    /// Duration of a quick round of the eight positions after it, with its moves, s; 0: no round.
    pub round_s: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            gimbals: Gimbals::Both,
            azimuth_deg: (-360, 360),
            roll_deg: (-360, 360),
            grid_deg: 45,
            stops_max: 40,
            dwell_min_s: 30.0,
            lead_in_s: 300.0,
            round_s: 0.0,
        }
    }
}

impl Limits {
    /// Checks that the limits leave something to choose from.
    ///
    /// # Errors
    /// If they don't.
    pub fn check(&self) -> Result<(), DesignError> {
        let refuse = |words: String| Err(DesignError::Limits(words));
        if !(1..=180).contains(&self.grid_deg) {
            return refuse(format!("grid: found {} deg, expected 1 to 180 deg", self.grid_deg));
        }
        if !(2..=STOPS_MAX).contains(&self.stops_max) {
            return refuse(format!("stops: found {}, expected 2 to {STOPS_MAX}", self.stops_max));
        }
        for (name, (low, high)) in [("azimuth", self.azimuth_deg), ("roll", self.roll_deg)] {
            if !((-900..=0).contains(&low) && (0..=900).contains(&high)) {
                return refuse(format!(
                    "{name} range: found {low} to {high} deg, expected a range within ±900 deg that \
                     contains 0, where every sequence starts"
                ));
            }
        }
        if self.free().iter().all(|range| self.values(*range).len() < 2) {
            return refuse(format!(
                "the ranges of the gimbals hold no other angle of the grid of {} deg than 0, expected one",
                self.grid_deg
            ));
        }
        Ok(())
    }

    /// Ranges of azimuth and roll as far as the gimbals may turn, deg.
    pub(crate) fn free(&self) -> [(i32, i32); 2] {
        match self.gimbals {
            Gimbals::Both | Gimbals::One => [self.azimuth_deg, self.roll_deg],
            Gimbals::Azimuth => [self.azimuth_deg, (0, 0)],
            Gimbals::Roll => [(0, 0), self.roll_deg],
        }
    }

    /// Angles of the grid in a range, deg.
    pub(crate) fn values(&self, (low, high): (i32, i32)) -> Vec<i32> {
        let grid = self.grid_deg;
        (low / grid..=high / grid).map(|step| step * grid).collect()
    }

    /// Makes a candidate of a published sequence, with the lead-in before it; `None` if it doesn't keep the
    /// limits.
    #[must_use]
    pub fn of_published(&self, stops: &[Degrees]) -> Option<Vec<GridStop>> {
        let mut all = vec![GridStop { azimuth_deg: 0, roll_deg: 0, share: 1 }];
        let mut stops: Vec<GridStop> = stops.iter().map(GridStop::of_published).collect();
        if let [GridStop { azimuth_deg: 0, roll_deg: 0, .. }, ..] = stops[..] {
            all.clear();
        }
        all.append(&mut stops);
        self.keep(&all).then_some(all)
    }

    /// Returns whether stops are on the grid and within the ranges, and moves use the gimbals that they may.
    #[must_use]
    pub fn keep(&self, stops: &[GridStop]) -> bool {
        let [azimuth, roll] = self.free();
        let within = |angle: i32, (low, high): (i32, i32)| {
            (low..=high).contains(&angle) && angle % self.grid_deg == 0
        };
        let starts = matches!(stops, [GridStop { azimuth_deg: 0, roll_deg: 0, .. }, ..]);
        let moves = |pair: &[GridStop]| {
            let azimuth = pair[0].azimuth_deg != pair[1].azimuth_deg;
            let roll = pair[0].roll_deg != pair[1].roll_deg;
            (azimuth || roll) && !(azimuth && roll && self.gimbals == Gimbals::One)
        };
        starts
            && stops.len() <= self.stops_max
            && stops.iter().all(|stop| {
                within(stop.azimuth_deg, azimuth)
                    && within(stop.roll_deg, roll)
                    && (1..=SHARE_MAX * 4).contains(&stop.share)
            })
            && stops.windows(2).all(moves)
    }
}

/// Makes a sequence of stops on the grid.
#[must_use]
pub fn sequence_of(stops: &[GridStop]) -> Option<Sequence> {
    let stop = |stop: &GridStop| Stop {
        azimuth_rad: f64::from(stop.azimuth_deg) * DEG,
        roll_rad: f64::from(stop.roll_deg) * DEG,
        weight: f64::from(stop.share),
    };
    let stops: Vec<Stop> = stops.iter().map(stop).collect();
    Sequence::new(&stops, 1).ok()
}
