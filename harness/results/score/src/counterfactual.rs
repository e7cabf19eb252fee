//! Effect of faults: comparison of the faulted run with its twin, which has the same instrument and the
//! same noise without the faults.
//!
//! Every difference between the two is caused by the faults, because nothing else differs. Reports of
//! the core in the faulted run that its twin doesn't have show that the core noticed the faults.

use super::calibration::{CalibrationScore, ParameterScore};
use super::health::{Episode, name};
use super::navigation::NavigationScore;
use super::sessions::Sessions;
use super::trace::RunTrace;
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::units::{ARCMIN, NAUTICAL_MILE_M};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Parameter shift, in posterior σ of the twin, from which a fault counts as harmful: an error that the
/// parameter's own σ makes unlikely.
pub const HARMFUL_SHIFT_SIGMA: f64 = 3.0;
/// Share of the twin's calibration below which one isn't whole.
const WHOLE: f64 = 0.99;
/// Time within which the same report in both runs is not attributed to the fault, ns.
const SAME_NS: u64 = 5_000_000_000;
/// Most rows of the difference in the summary.
const ROWS_MAX: usize = 1000;

/// Effect of the faults of a run, compared with its twin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Counterfactual {
    /// Time up to which the outputs of the two are the same, s; they differ within the next 200 outputs
    /// (1 s at 200 Hz). Null if no output differs.
    pub outputs_differ_after_s: Option<f64>,
    /// Shift of every estimated parameter, by name.
    pub parameters: BTreeMap<String, Shift>,
    /// Name of the parameter that shifted most; null without a calibration in both.
    pub worst_parameter: Option<String>,
    /// Magnitude of its shift, in σ of the twin.
    pub worst_shift_sigma: Option<f64>,
    /// Largest magnitude of a shift in the σ that the run with the faults published, of whichever parameter: what a user
    /// of the calibration is told. Null for a refused calibration, which published none, and in summaries of versions
    /// that didn't have it.
    #[serde(default)]
    pub worst_shift_published_sigma: Option<f64>,
    /// Difference of the navigation errors; null if one of the two didn't navigate.
    pub navigation: Option<DriftDifference>,
    /// Detection of each fault, in the order of the scenario.
    pub faults: Vec<Noticed>,
    /// Number of faults that fired and were not noticed.
    pub undetected: u64,
    /// Longest detection delay, s; null if no fault was noticed.
    pub detection_delay_max_s: Option<f64>,
    /// True if the calibration was refused, and that of the twin wasn't.
    pub refused: bool,
    /// True if the calibration is shorter than that of the twin: the unit began it anew, and the stream ended before it. It
    /// is no calibration of the procedure, whatever its σ.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub unended: bool,
    /// True for a significant effect: a parameter shifted by 3 σ or more, or the largest difference of
    /// position exceeds the twin's largest radial error.
    pub harmful: bool,
    /// True for a significant effect if the calibration was published and no fault was noticed.
    pub missed: bool,
    /// Number of reports of the core that no fault explains: those of the twin.
    pub false_alarms: u64,
    /// Hash of the twin's stream.
    pub twin_stream_hash: String,
    /// Reason why the twin is no measure of the effect: its calibration was refused, or it fell short of its plan. Left out
    /// for a whole one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub twin_lacks: Option<String>,
    /// Memory that the two sessions show of a unit in another process or device; left out where the core of this
    /// process is the unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sessions: Option<Box<Sessions>>,
}

/// Shift of one parameter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shift {
    /// Estimate of the faulted run minus that of the twin, in the unit of the parameter.
    pub shift: f64,
    /// Shift in posterior σ of the twin.
    pub sigma: f64,
}

/// Difference of the navigation errors, faulted minus twin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DriftDifference {
    /// Largest |difference| of latitude, arcmin.
    pub latitude_max_arcmin: f64,
    /// Largest |difference| of longitude, arcmin.
    pub longitude_max_arcmin: f64,
    /// Largest distance between the two solutions, nmi.
    pub radial_max_nmi: f64,
    /// Largest radial error of the twin, nmi, for comparison with the difference.
    pub twin_radial_max_nmi: f64,
    /// Rows of time (h), difference of latitude, difference of longitude (arcmin).
    pub series_hours: Vec<[f64; 3]>,
}

/// Detection of a fault by the core.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Noticed {
    /// Id of the fault.
    pub id: String,
    /// Onset: start of the first interval that it altered, s of the run; null if it never fired.
    pub onset_s: Option<f64>,
    /// First report of the core, from the onset on, that its twin doesn't have; null: none. With
    /// several faults at once it can be caused by another one.
    pub noticed_by: Option<String>,
    /// Time from the onset to that report, s.
    pub delay_s: Option<f64>,
    /// Time of the run at which the last such report ended, s.
    pub last_report_s: Option<f64>,
    /// True if the reports ended more than 2 s before the end of the run, the calibration stands, and
    /// no parameter shifted by 3 σ.
    pub recovered: bool,
}

/// Data of one run for the comparison.
#[derive(Clone, Debug)]
pub struct CounterfactualSide<'a> {
    /// Calibration.
    pub calibration: Option<&'a CalibrationScore>,
    /// Navigation.
    pub navigation: Option<&'a NavigationScore>,
    /// Episodes of the core's reports.
    pub episodes: &'a [Episode],
    /// Trace.
    pub trace: &'a RunTrace,
    /// Hash of the stream.
    pub stream_hash: &'a str,
    /// Length of the run, s of device time.
    pub elapsed_s: f64,
    /// Reason why the run isn't whole; `None` for a whole one.
    pub lacks: Option<String>,
}

impl Counterfactual {
    /// Lists the contradictions between its figures, as texts.
    #[must_use]
    pub fn contradictions(&self) -> Vec<String> {
        let mut found = Vec::new();
        let shifts = || self.parameters.values().map(|shift| shift.sigma.abs());
        if shifts().all(f64::is_finite) && shifts().reduce(f64::max) != self.worst_shift_sigma {
            found
                .push("its worst_shift_sigma isn't the largest shift of its parameters".to_owned());
        }
        let fired = || self.faults.iter().filter(|fault| fault.onset_s.is_some());
        let unnoticed = fired().filter(|fault| fault.noticed_by.is_none()).count() as u64;
        if unnoticed != self.undetected {
            found.push(format!("its undetected is {}, of its faults {unnoticed}", self.undetected));
        }
        if self.faults.iter().filter_map(|f| f.delay_s).reduce(f64::max)
            != self.detection_delay_max_s
        {
            found
                .push("its detection_delay_max_s isn't the longest delay of its faults".to_owned());
        }
        let shifted = self.worst_shift_sigma.is_some_and(|sigma| sigma >= HARMFUL_SHIFT_SIGMA);
        let drifted = |n: &DriftDifference| n.radial_max_nmi > n.twin_radial_max_nmi;
        let harmful = shifted || self.navigation.as_ref().is_some_and(drifted);
        if harmful != self.harmful {
            found.push(format!("its harmful is {}, its figures give {harmful}", self.harmful));
        }
        found
    }
}

/// Compares a faulted run with its twin. `onsets` are the faults with the start of the first interval
/// that each altered, s; `latitude_rad` and `height_m` are those of the site.
#[must_use]
pub fn counterfactual(
    faulted: &CounterfactualSide<'_>,
    twin: &CounterfactualSide<'_>,
    onsets: &[(String, Option<f64>)],
    sample_s: f64,
    latitude_rad: f64,
    height_m: f64,
) -> Counterfactual {
    let parameters = shifts(faulted, twin);
    let worst = parameters
        .iter()
        .map(|(name, shift)| (name, shift.sigma.abs()))
        .max_by(|a, b| a.1.total_cmp(&b.1));
    let worst_shift_sigma = worst.map(|(_, sigma)| sigma);
    let refused_by =
        |side: &CounterfactualSide<'_>| side.calibration.is_some_and(|c| c.refused.is_some());
    let refused = refused_by(faulted) && !refused_by(twin);
    let navigation = difference(faulted, twin, latitude_rad, height_m);
    let shifted = worst_shift_sigma.is_some_and(|sigma| sigma >= HARMFUL_SHIFT_SIGMA);
    let drifted = navigation
        .as_ref()
        .is_some_and(|n: &DriftDifference| n.radial_max_nmi > n.twin_radial_max_nmi);
    let harmful = shifted || drifted;
    let new = new_episodes(faulted.episodes, twin.episodes);
    let unended = match (faulted.calibration, twin.calibration) {
        (Some(faulted), Some(twin)) => faulted.duration_h < WHOLE * twin.duration_h && !refused,
        _ => false,
    };
    let stands = !refused && !unended && !shifted;
    let faults: Vec<Noticed> = onsets
        .iter()
        .map(|(id, onset_s)| noticed(id, *onset_s, &new, faulted.elapsed_s, stands))
        .collect();
    let unnoticed = faults.iter().all(|fault| fault.noticed_by.is_none());
    Counterfactual {
        outputs_differ_after_s: faulted
            .trace
            .parts_from(twin.trace)
            .map(|outputs| outputs as f64 * sample_s),
        worst_parameter: worst.map(|(name, _)| name.clone()),
        worst_shift_sigma,
        worst_shift_published_sigma: published(faulted, twin),
        parameters,
        navigation,
        undetected: faults
            .iter()
            .filter(|fault| fault.onset_s.is_some() && fault.noticed_by.is_none())
            .count() as u64,
        detection_delay_max_s: faults.iter().filter_map(|f| f.delay_s).reduce(f64::max),
        faults,
        refused,
        unended,
        harmful,
        missed: harmful && !refused && !unended && unnoticed,
        false_alarms: twin.episodes.len() as u64,
        twin_stream_hash: twin.stream_hash.to_owned(),
        twin_lacks: twin.lacks.clone(),
        sessions: None,
    }
}

/// Shifts of the parameters that both runs estimated.
fn shifts(
    faulted: &CounterfactualSide<'_>,
    twin: &CounterfactualSide<'_>,
) -> BTreeMap<String, Shift> {
    let (Some(faulted), Some(twin)) = (faulted.calibration, twin.calibration) else {
        return BTreeMap::new();
    };
    twin.parameters
        .iter()
        .filter_map(|(name, clean)| {
            let estimate = faulted.parameters.get(name)?.estimate;
            let sigma = clean.sigma?;
            let shift = estimate - clean.estimate;
            Some((name.clone(), Shift { shift, sigma: shift / sigma }))
        })
        .collect()
}

/// Largest shift in the σ that the faulted run published.
fn published(faulted: &CounterfactualSide<'_>, twin: &CounterfactualSide<'_>) -> Option<f64> {
    let (published, clean) = (faulted.calibration?, twin.calibration?);
    if published.refused.is_some() {
        return None;
    }
    let shift = |(name, score): (&String, &ParameterScore)| {
        Some((score.estimate - clean.parameters.get(name)?.estimate).abs() / score.sigma?)
    };
    published.parameters.iter().filter_map(shift).max_by(f64::total_cmp)
}

fn difference(
    faulted: &CounterfactualSide<'_>,
    twin: &CounterfactualSide<'_>,
    latitude_rad: f64,
    height_m: f64,
) -> Option<DriftDifference> {
    faulted.navigation?;
    let twin_radial_max_nmi = twin.navigation?.radial_error_nmi?.max;
    let earth = Ellipsoid::at(latitude_rad, height_m);
    let rows = faulted.trace.minus(twin.trace);
    let (mut latitude_max, mut longitude_max, mut radial_max_m) = (0.0f64, 0.0f64, 0.0f64);
    for (_, latitude, longitude) in &rows {
        let north_m = latitude * earth.meridian_radius_m;
        let east_m = longitude * earth.transverse_radius_m * earth.cos_latitude;
        latitude_max = latitude_max.max(latitude.abs());
        longitude_max = longitude_max.max(longitude.abs());
        radial_max_m = radial_max_m.max(libm::hypot(north_m, east_m));
    }
    let every = rows.len().div_ceil(ROWS_MAX).max(1);
    Some(DriftDifference {
        latitude_max_arcmin: latitude_max / ARCMIN,
        longitude_max_arcmin: longitude_max / ARCMIN,
        radial_max_nmi: radial_max_m / NAUTICAL_MILE_M,
        twin_radial_max_nmi,
        series_hours: rows
            .iter()
            .step_by(every)
            .map(|(hours, latitude, longitude)| [*hours, latitude / ARCMIN, longitude / ARCMIN])
            .collect(),
    })
}

/// Episodes of the faulted run that the twin doesn't have at that time.
fn new_episodes<'a>(faulted: &'a [Episode], twin: &[Episode]) -> Vec<&'a Episode> {
    faulted
        .iter()
        .filter(|episode| {
            !twin.iter().any(|other| {
                other.cause == episode.cause && episode.start.ns.abs_diff(other.start.ns) <= SAME_NS
            })
        })
        .collect()
}

fn noticed(
    id: &str,
    onset_s: Option<f64>,
    new: &[&Episode],
    elapsed_s: f64,
    stands: bool,
) -> Noticed {
    let mut found = Noticed {
        id: id.to_owned(),
        onset_s,
        noticed_by: None,
        delay_s: None,
        last_report_s: None,
        recovered: false,
    };
    let Some(onset_s) = onset_s else { return found };
    let after: Vec<&&Episode> = new.iter().filter(|e| e.start.seconds() >= onset_s).collect();
    if let Some(first) = after.iter().min_by_key(|episode| episode.start.ns) {
        found.noticed_by = Some(name(first.cause).to_owned());
        // Rounded to the nanosecond of the stamps, so that a delay of 5 ms keeps a limit of 5 ms.
        found.delay_s = Some(((first.start.seconds() - onset_s) * 1e9).round() / 1e9);
        let last_s = after.iter().map(|e| e.end.seconds()).fold(0.0, f64::max);
        found.last_report_s = Some(last_s);
        // Measurements come once a second: reports at the very end haven't ended.
        found.recovered = stands && last_s < elapsed_s - 2.0;
    }
    found
}
