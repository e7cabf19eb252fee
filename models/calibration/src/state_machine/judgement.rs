//! Judgement of a calibration: accepted, or refused with a reason.

use crate::config::{Kalman, SigmaLimits, UncertainQuantity};
use crate::covariance::PHI;
use crate::drift::Largest;
use crate::filter::{AngleTally, CalibrationFilter, CaseTurn};
use crate::table::Quality;
use octant_sample::parameters::{NAMES, PARAMETER_COUNT};

/// Largest share of measurements that the gate may reject in an accepted calibration.
const REJECTED_SHARE_MAX: f64 = 0.02;
/// Largest number of recoveries in an accepted calibration.
const RECOVERIES_MAX: u32 = 10;
/// Smallest share of the expected measurements in an accepted calibration.
const MEASURED_SHARE_MIN: f64 = 0.5;

/// Smallest share of the expected measurements that must have updated the parameters: recoveries
/// hold these, and an endless recovery would hold them for ever.
const ESTIMATING_SHARE_MIN: f64 = 0.5;

/// Largest share of the samples that may be bridged by known motion: bridged samples calibrate
/// nothing, and the motion is known only as far as the base is at rest.
const BRIDGED_SHARE_MAX: f64 = 0.02;

/// Reason why a calibration was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub enum CalibrationRefusal {
    /// The innovations contradict the tuning.
    #[error("the mean NIS of {mean:.1} is above {limit}: the innovations contradict the tuning")]
    Inconsistent {
        /// Mean NIS.
        mean: f64,
        /// Limit.
        limit: f64,
    },
    /// The gate rejected too many measurements.
    #[error(
        "{rejected} of {total} measurements were rejected: the innovations contradict the tuning"
    )]
    Rejected {
        /// Measurements rejected.
        rejected: u64,
        /// All measurements.
        total: u64,
    },
    /// The filter had to recover too often.
    #[error("the filter had to recover {recoveries} times, at most {RECOVERIES_MAX} are accepted")]
    Recoveries {
        /// Recoveries.
        recoveries: u32,
    },
    /// The parameters were held for too long.
    #[error("recoveries held the parameters during {held} of {expected} measurements")]
    Held {
        /// Measurements used while the parameters were held.
        held: u64,
        /// Measurements expected.
        expected: u64,
    },
    /// The reference was missing.
    #[error("only {used} of {expected} measurements of the reference came")]
    AidingLost {
        /// Measurements used.
        used: u64,
        /// Measurements expected.
        expected: u64,
    },
    /// Too many samples were missing or not used.
    #[error("{bridged} of {total} samples were missing, stuck or not to be believed")]
    Bridged {
        /// Samples bridged.
        bridged: u64,
        /// Samples of the calibration.
        total: u64,
    },
    /// A disturbance could not be undone.
    #[error(
        "{disturbances} {} noticed and could not be undone: what was learned from {} can't be told",
        if *disturbances == 1 { "disturbance was" } else { "disturbances were" },
        if *disturbances == 1 { "it" } else { "them" }
    )]
    Disturbed {
        /// Disturbances.
        disturbances: u64,
    },
    /// Gimbal angles that were measurements contradicted the gyros for good.
    #[error(
        "gimbal angles are measurements and contradict the gyros, as after a slip of a gimbal or an encoder: {rejected} \
         were rejected, {used} used"
    )]
    GimbalAngles {
        /// Measurements rejected.
        rejected: u64,
        /// Measurements used.
        used: u64,
    },
    /// The angles contradict the errors that the gimbals are said to have.
    #[error(
        "the mean NIS of the gimbal angles of {mean:.1} is above {limit}: they contradict the errors that the filter is \
         told of"
    )]
    AnglesInconsistent {
        /// Mean NIS.
        mean: f64,
        /// Limit.
        limit: f64,
    },
    /// A parameter drifted while it was estimated.
    #[error(
        "{} drifted: between {:.0} s and {:.0} s it was corrected by {sigmas:.1} times what its \
         uncertainty allows",
        NAMES[*parameter % PARAMETER_COUNT], between_s.0, between_s.1
    )]
    Drift {
        /// Index of the parameter, in the order of [`NAMES`].
        parameter: usize,
        /// Correction in the standard deviations that it should have.
        sigmas: f64,
        /// Start and end, s since the calibration began to measure.
        between_s: (f64, f64),
    },
    /// A standard deviation is larger than what may be published.
    #[error(
        "{} is known to {:.3} {} (1 sigma) at the end, and at most {:.3} {} is published",
        of.name(), sigma / of.si_per_unit(), of.unit(), limit / of.si_per_unit(), of.unit()
    )]
    Uncertain {
        /// Its quantity.
        of: UncertainQuantity,
        /// Standard deviation, SI.
        sigma: f64,
        /// Limit, SI.
        limit: f64,
    },
    /// The least-squares adjustment gave no result.
    #[error("{0}")]
    Adjustment(#[from] crate::least_squares::AdjustmentRefusal),
    /// The attitude could not be found from gravity and Earth rate.
    #[error("no attitude could be found from gravity and Earth rate: did the instrument stand?")]
    Alignment,
    /// A number of the filter is not finite.
    #[error("the covariance is not finite")]
    Numeric,
    /// The alignment in the inertial frame found no attitude that can be trusted.
    #[error("{0}")]
    Inertial(#[from] crate::inertial_alignment::AlignmentRefusal),
    /// The average of the last standstill doesn't fit a base at rest at the site.
    #[error("{0}")]
    Standstill(#[from] crate::standstill::StandstillRefusal),
    /// The case is said to rest, and turned: what was learned from its rest can't be told apart.
    #[error("the case is said to rest and turned: {0}")]
    CaseTurned(CaseTurn),
}

/// Quality of a filter's calibration so far.
pub(super) fn quality_of(filter: &CalibrationFilter) -> Quality {
    let tally = filter.tally();
    Quality {
        nis_mean: tally.nis_sum / (tally.used - tally.held) as f64,
        used: tally.used,
        rejected: tally.rejected,
        recoveries: u64::from(tally.recoveries),
        drift_sigmas: filter.drift().map_or(0.0, |drift| drift.largest().sigmas),
        ..Quality::default()
    }
}

/// Largest mean NIS of an accepted calibration. What the configuration gives is for a mean of 3; where considered states let
/// it be more, it is the same multiple of that.
pub(super) fn nis_limit(filter: &CalibrationFilter, kalman: &Kalman) -> f64 {
    let high = filter.expected_nis().map_or(3.0, |expected| expected.high.max(3.0));
    kalman.refuse_above_mean_nis * (high / 3.0)
}

/// Judges a filter at the end of its calibration, in which `expected` measurements were due, and
/// `bridged` of `samples` were bridged, with the number of slips of gimbals that the screens noticed.
pub(super) fn judge(
    filter: &CalibrationFilter,
    kalman: &Kalman,
    expected: u64,
    (bridged, samples): (u64, u64),
    gimbal_slips: u64,
) -> Result<Quality, CalibrationRefusal> {
    let (tally, quality) = (filter.tally(), quality_of(filter));
    let total = tally.used + tally.rejected;
    if !filter.is_finite() {
        return Err(CalibrationRefusal::Numeric);
    }
    if total == 0 {
        // Where the stream ends before the first is due too: a calibration rests on one at least.
        return Err(CalibrationRefusal::AidingLost { used: 0, expected: expected.max(1) });
    }
    let estimating = tally.used - tally.held;
    if (total as f64) >= MEASURED_SHARE_MIN * expected as f64
        && (estimating as f64) < ESTIMATING_SHARE_MIN * expected as f64
    {
        return Err(CalibrationRefusal::Held { held: tally.held, expected });
    }
    if (total as f64) < MEASURED_SHARE_MIN * expected as f64 {
        return Err(CalibrationRefusal::AidingLost { used: total, expected });
    }
    if tally.rejected as f64 > REJECTED_SHARE_MAX * total as f64 {
        return Err(CalibrationRefusal::Rejected { rejected: tally.rejected, total });
    }
    if tally.recoveries > RECOVERIES_MAX {
        return Err(CalibrationRefusal::Recoveries { recoveries: tally.recoveries });
    }
    let limit = nis_limit(filter, kalman);
    if !(quality.nis_mean <= limit) {
        return Err(CalibrationRefusal::Inconsistent { mean: quality.nis_mean, limit });
    }
    if bridged as f64 > BRIDGED_SHARE_MAX * samples as f64 {
        return Err(CalibrationRefusal::Bridged { bridged, total: samples });
    }
    if let Some(drift) = filter.drift()
        && drift.is_found()
    {
        let &Largest { sigmas, parameter, between_s } = drift.largest();
        return Err(CalibrationRefusal::Drift { parameter, sigmas, between_s });
    }
    if let Some(turn) = filter.case_turn(gimbal_slips) {
        return Err(CalibrationRefusal::CaseTurned(turn));
    }
    if let Some(tally) = filter.angle_tally()
        && kalman.further.angles.is_some()
    {
        judge_angles(tally, gimbal_slips, kalman.refuse_above_mean_nis)?;
    }
    Ok(quality)
}

/// Judges the standard deviations that would be published; heading and tilt have the limits of the instrument's grade, rad,
/// where the scenario gives none.
pub(super) fn judge_sigmas(
    filter: &CalibrationFilter,
    limits: &SigmaLimits,
    of_grade: (f64, f64),
) -> Result<(), CalibrationRefusal> {
    let [north, east, down] = [0, 1, 2].map(|axis| filter.covariance().sigma(PHI + axis));
    let parameters = filter.parameter_sigmas();
    match limits.exceeded(of_grade, (down, north.max(east)), &parameters) {
        Some((of, sigma, limit)) => Err(CalibrationRefusal::Uncertain { of, sigma, limit }),
        None => Ok(()),
    }
}

/// Judges gimbal angles that were measurements: one slip, of which it can't be told what was learned from it, is too
/// much.
fn judge_angles(tally: &AngleTally, slips: u64, limit: f64) -> Result<(), CalibrationRefusal> {
    let &AngleTally { used, rejected, in_a_row: _, nis_sum, slipped } = tally;
    if slipped || slips != 0 || rejected as f64 > REJECTED_SHARE_MAX * (used + rejected) as f64 {
        return Err(CalibrationRefusal::GimbalAngles { rejected, used });
    }
    let mean = nis_sum / used.max(1) as f64;
    if mean <= limit { Ok(()) } else { Err(CalibrationRefusal::AnglesInconsistent { mean, limit }) }
}
