//! The lead-in of a sequence: a level alignment and, where it is asked for, a quick round of the eight
//! positions.
//!
//! A candidate of a search is what follows. Linear prediction takes the products of errors for zero; the
//! round makes the errors small before the long dwells, where a sequence without it would rest with errors
//! of the size of their draws.

use crate::candidate::{GridStop, Limits, SHARE_MAX, sequence_of};
use crate::setup::DesignError;
use octant_calibration::config::TurntableRates;
use octant_calibration::positions::{EIGHT, from_degrees};
use octant_calibration::schedule::{dwell_s, moves_s};
use octant_calibration::sequence::STOPS_MAX;

/// Parts of a share of a candidate, for the dwells of the round, which are shorter.
const FINE: u32 = 16;
/// Stops of the round before the candidate's own first stop, at zero, which ends it.
pub const ROUND_STOPS: usize = EIGHT.len() - 1;
/// Steps in which shares are rounded until every dwell is as long as it has to be.
const ROUNDING_MAX: usize = 64;

/// Longest quick round that is made unasked, s.
const ROUND_MAX_S: f64 = 1200.0;
/// Part of the calibration that it takes at most, unless its dwells would be too short.
const ROUND_PART: f64 = 1.0 / 12.0;

/// Returns the duration of a quick round that suits a calibration, s; `None` where the sequence has one
/// already, or the gimbals can't do it.
#[must_use]
pub fn quick_round_s(limits: &Limits, duration_s: f64, rates: &TurntableRates) -> Option<f64> {
    let least_s = libm::ceil(moves_of_round_s(rates) + limits.dwell_min_s * weights());
    let round_s = libm::round(ROUND_PART * duration_s).min(ROUND_MAX_S).max(least_s);
    let stops_max = limits.stops_max.min(Limits::STOPS_AFTER_ROUND_MAX);
    let with = Limits { round_s, stops_max, ..*limits };
    (limits.round_s == 0.0 && with.check_lead_in(rates).is_ok()).then_some(round_s)
}

impl Limits {
    /// Largest number of stops beside those of a quick round.
    pub const STOPS_AFTER_ROUND_MAX: usize = STOPS_MAX - ROUND_STOPS;

    /// Checks that the lead-in keeps the limits.
    ///
    /// # Errors
    /// If it doesn't.
    pub fn check_lead_in(&self, rates: &TurntableRates) -> Result<(), DesignError> {
        let refuse = |words: String| Err(DesignError::Limits(words));
        if self.round_s == 0.0 {
            return Ok(());
        }
        let reached = Self { grid_deg: 1, stops_max: EIGHT.len(), ..*self };
        if !reached.keep(&round_stops()) {
            return refuse(format!(
                "lead-in round: found gimbals {:?} within {:?} deg azimuth and {:?} deg roll, expected both \
                 gimbals within 0 to 270 deg, where the eight positions are",
                self.gimbals, self.azimuth_deg, self.roll_deg
            ));
        }
        if self.stops_max > Self::STOPS_AFTER_ROUND_MAX {
            return refuse(format!(
                "stops: found {} beside the {ROUND_STOPS} of the lead-in round, expected at most {}",
                self.stops_max,
                Self::STOPS_AFTER_ROUND_MAX
            ));
        }
        let least_s = moves_of_round_s(rates) + self.dwell_min_s * weights();
        if self.round_s < least_s {
            return refuse(format!(
                "lead-in round: found {} s, expected at least {least_s:.0} s for its moves and for dwells of \
                 {} s",
                self.round_s, self.dwell_min_s
            ));
        }
        Ok(())
    }

    /// Makes the stops of a sequence of a candidate, with its lead-in as long as it has to be; `None` if its
    /// dwells would be too short.
    #[must_use]
    pub fn led_in(
        &self,
        stops: &mut [GridStop],
        duration_s: f64,
        rates: &TurntableRates,
    ) -> Option<Vec<GridStop>> {
        let all = match self.round_s > 0.0 {
            true => self.after_round(stops, duration_s, rates)?,
            false => self.after_alignment(stops, duration_s, rates)?,
        };
        let unit_s = dwell_s(&sequence_of(&all)?, duration_s, rates).ok()?;
        let shortest = all.iter().map(|stop| stop.share).min()?;
        (unit_s * f64::from(shortest) >= self.dwell_min_s - 1e-6).then_some(all)
    }

    fn after_alignment(
        &self,
        stops: &mut [GridStop],
        duration_s: f64,
        rates: &TurntableRates,
    ) -> Option<Vec<GridStop>> {
        let free_s = duration_s - moves_s(&sequence_of(stops)?, rates);
        let others: u32 = stops[1..].iter().map(|stop| stop.share).sum();
        let least = self.lead_in_s * f64::from(others) / (free_s - self.lead_in_s);
        if !(free_s > self.lead_in_s) || least > f64::from(SHARE_MAX * 4) {
            return None;
        }
        stops[0].share = stops[0].share.max(libm::ceil(least - 1e-9) as u32);
        Some(stops.to_vec())
    }

    fn after_round(
        &self,
        stops: &[GridStop],
        duration_s: f64,
        rates: &TurntableRates,
    ) -> Option<Vec<GridStop>> {
        let round = round_stops();
        if stops.len() + ROUND_STOPS > STOPS_MAX {
            return None;
        }
        let unit_s = (self.round_s - moves_of_round_s(rates)) / weights();
        // Dwells that the lead-in has to have, s: its last stop is the candidate's first.
        let mut least_s: Vec<f64> = EIGHT.iter().map(|(.., weight)| unit_s * weight).collect();
        least_s[0] = self.lead_in_s;
        let mut all: Vec<GridStop> = round[..ROUND_STOPS].to_vec();
        all.extend(stops.iter().map(|stop| GridStop { share: stop.share * FINE, ..*stop }));
        let own = all[ROUND_STOPS].share;
        let free_s = duration_s - moves_s(&sequence_of(&all)?, rates);
        let others: u32 = stops.iter().map(|stop| stop.share * FINE).sum();
        let fine_s = (free_s - least_s.iter().sum::<f64>()) / f64::from(others);
        if !(fine_s > 0.0) {
            return None;
        }
        let mut shares: Vec<u32> =
            least_s.iter().map(|least| libm::ceil(least / fine_s - 1e-9).max(1.0) as u32).collect();
        for _ in 0..ROUNDING_MAX {
            let unit_s = free_s / f64::from(others + shares.iter().sum::<u32>());
            let mut enough = true;
            for (share, least) in shares.iter_mut().zip(&least_s) {
                if f64::from(*share) * unit_s < least - 1e-6 {
                    (*share, enough) = (*share + 1, false);
                }
            }
            if enough {
                all.iter_mut().zip(&shares).for_each(|(stop, share)| stop.share = *share);
                all[ROUND_STOPS].share = own + shares[ROUND_STOPS];
                return Some(all);
            }
        }
        None
    }
}

fn round_stops() -> Vec<GridStop> {
    EIGHT.iter().map(GridStop::of_published).collect()
}

fn moves_of_round_s(rates: &TurntableRates) -> f64 {
    from_degrees(EIGHT, 1).map_or(f64::INFINITY, |sequence| moves_s(&sequence, rates))
}

/// Sum of the weights of the round's dwells, without the level alignment, its first.
fn weights() -> f64 {
    EIGHT[1..].iter().map(|(.., weight)| weight).sum()
}
