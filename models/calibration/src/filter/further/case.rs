//! Case that is said to rest: how far it turned, and whether that contradicts what is said of it.
//!
//! The attitude of the case is estimated, so that a case that turns faster than its wander allows shows in the
//! innovations, and one that turns slowly in how far it has come.

use super::FurtherStates;
use super::border::CASE;
use octant_earth::rotation::log;
use octant_earth::units::ARCSEC;

/// Standard deviations beyond the range that contradict it.
const RANGE_SIGMAS: f64 = 6.0;
/// Standard deviations of the mean NIS beyond 3 that contradict jitter and wander: 3e-7 of one calibration, where
/// innovations are independent.
const NIS_SIGMAS: f64 = 5.0;
/// Variance of the NIS of three axes.
const NIS_VARIANCE: f64 = 6.0;
/// Largest share of comparisons that the gate may reject.
const REJECTED_SHARE_MAX: f64 = 0.02;

/// Contradiction between a case that is said to rest and its measurements.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub enum CaseTurn {
    /// Sudden turns.
    #[error("{rejected} of {total} comparisons of its attitude were rejected")]
    Sudden {
        /// Comparisons rejected by the gate.
        rejected: u64,
        /// All comparisons.
        total: u64,
    },
    /// Gyros and encoders show a slip at rest.
    #[error("gyros and encoders differ by {slips} slips")]
    Slips {
        /// Slips.
        slips: u64,
    },
    /// More noise than jitter and wander have.
    #[error(
        "the mean NIS of its attitude is {mean:.2}, {limit:.2} at most by its jitter and wander"
    )]
    Noise {
        /// Mean NIS.
        mean: f64,
        /// Limit.
        limit: f64,
    },
    /// A turn beyond the range.
    #[error(
        "it turned by {:.1}\" about an axis of n, {:.1}\" at most by its range and the uncertainty of attitude",
        turned_rad / ARCSEC, limit_rad / ARCSEC
    )]
    Range {
        /// Turn since the first measurement, rad.
        turned_rad: f64,
        /// Range, and what uncertainty explains, rad.
        limit_rad: f64,
    },
}

impl FurtherStates {
    /// Takes note of how far the case has turned, after a measurement.
    pub(super) fn follow_case(&mut self) {
        let Some(angles) = &mut self.angles else { return };
        let (Some(travel), Some(q_nc)) = (&mut angles.travel, self.border.reference.q_nc) else {
            return;
        };
        let own = &self.border.own;
        let variances = [0, 1, 2].map(|axis| own[CASE + axis][CASE + axis].max(0.0));
        let (first, before) = *travel.first.get_or_insert((q_nc, variances));
        let turned = log(&(q_nc * first.inverse()));
        for axis in 0..3 {
            let sigma = libm::sqrt(before[axis] + variances[axis]);
            let (turned_rad, limit_rad) =
                (turned[axis].abs(), angles.range_rad + RANGE_SIGMAS * sigma);
            let more =
                travel.beyond.is_none_or(|(turned, limit)| turned_rad - limit_rad > turned - limit);
            if turned_rad > limit_rad && more {
                travel.beyond = Some((turned_rad, limit_rad));
            }
        }
    }

    /// Returns the contradiction to a case at rest, with the number of slips that the screens noticed.
    pub(in crate::filter) fn case_turn(&self, slips: u64) -> Option<CaseTurn> {
        let angles = self.angles.as_ref()?;
        let (tally, travel) = (&angles.tally, angles.travel.as_ref()?);
        let (rejected, total) = (tally.rejected, tally.used + tally.rejected);
        let limit = 3.0 + NIS_SIGMAS * libm::sqrt(NIS_VARIANCE / tally.used.max(1) as f64);
        let mean = tally.nis_sum / tally.used.max(1) as f64;
        if tally.slipped || rejected as f64 > REJECTED_SHARE_MAX * total as f64 {
            Some(CaseTurn::Sudden { rejected, total })
        } else if slips != 0 {
            Some(CaseTurn::Slips { slips })
        } else if let Some((turned_rad, limit_rad)) = travel.beyond {
            Some(CaseTurn::Range { turned_rad, limit_rad })
        } else if mean > limit {
            Some(CaseTurn::Noise { mean, limit })
        } else {
            None
        }
    }
}
