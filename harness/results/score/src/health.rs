//! Reports of the core over a run: counts, episodes, mean NIS.

use super::calibration::HealthCounts;
use octant_sample::time::DeviceTime;
use octant_sample::{Health, Output};

/// Most episodes kept; further ones are only counted.
pub const EPISODES_MAX: usize = 1000;

/// Longest time between flags of one cause in the same episode, ns: measurements come once a second.
const JOIN_NS: u64 = 2_500_000_000;

/// A period in which the core reported one cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Episode {
    /// Cause: one flag.
    pub cause: Health,
    /// First epoch that reported it.
    pub start: DeviceTime,
    /// Last epoch that reported it.
    pub end: DeviceTime,
    /// Number of epochs that reported it.
    pub epochs: u64,
}

impl Episode {
    /// Name of the cause.
    #[must_use]
    pub fn name(&self) -> &'static str {
        name(self.cause)
    }
}

/// Name of a flag.
#[must_use]
pub fn name(cause: Health) -> &'static str {
    match cause {
        Health::INNOVATION_REJECTED => "measurement rejected",
        Health::RECOVERING => "filter recovering",
        Health::GYRO_STUCK => "gyro stuck",
        Health::ACCELEROMETER_STUCK => "accelerometer stuck",
        Health::GAP => "samples missing",
        Health::OUT_OF_ORDER => "sample out of order",
        Health::INERTIAL_INVALID => "inertial counts invalid",
        Health::GIMBAL_DISAGREES => "gimbal not at its position",
        Health::AIDING_LOST => "aiding lost",
        Health::INCONSISTENT => "innovations contradict the tuning",
        Health::NUMERIC => "number kept out of the state",
        Health::JUMP => "increments jumped",
        Health::GIMBAL_SLIPPED => "gyros and encoders disagree on a turn",
        Health::DRIFTING => "a parameter drifts",
        Health::AIDING_STALE => "aiding of another time",
        _ => "several causes",
    }
}

/// Monitors the outputs of one run, without allocating.
#[derive(Clone, Debug)]
pub struct HealthMonitor {
    counts: HealthCounts,
    /// Last epoch that reported each flag, and the index of its episode if it is listed.
    last: [Option<(DeviceTime, Option<usize>)>; 32],
    episodes: Vec<Episode>,
    unlisted: u64,
    nis_sum: f64,
    nis_count: u64,
}

impl Default for HealthMonitor {
    fn default() -> Self {
        Self::new()
    }
}

impl HealthMonitor {
    /// Makes a monitor without outputs.
    #[must_use]
    pub fn new() -> Self {
        Self {
            counts: HealthCounts::default(),
            last: [None; 32],
            episodes: Vec::with_capacity(EPISODES_MAX),
            unlisted: 0,
            nis_sum: 0.0,
            nis_count: 0,
        }
    }

    /// Takes the output of one epoch.
    pub fn push(&mut self, output: &Output) {
        self.push_at(output, output.device_time);
    }

    /// Takes the output of one epoch at a given time: a fault may have altered the output's own stamp.
    pub fn push_at(&mut self, output: &Output, now: DeviceTime) {
        let rejected = output.health.contains(Health::INNOVATION_REJECTED);
        if output.nis.is_finite() || rejected {
            self.counts.measurements += 1;
        }
        if output.nis.is_finite() && !rejected {
            self.nis_sum += output.nis;
            self.nis_count += 1;
        }
        if output.health.is_empty() {
            return;
        }
        for cause in output.health.iter() {
            self.count(cause, now);
        }
    }

    fn count(&mut self, cause: Health, now: DeviceTime) {
        let bit = cause.bits().trailing_zeros() as usize;
        let joins = self.last[bit].filter(|(last, _)| now.ns.saturating_sub(last.ns) <= JOIN_NS);
        let listed = match joins {
            Some((_, listed)) => {
                if let Some(episode) = listed.and_then(|i| self.episodes.get_mut(i)) {
                    episode.end = now;
                    episode.epochs += 1;
                }
                listed
            }
            None if self.episodes.len() < EPISODES_MAX => {
                self.episodes.push(Episode { cause, start: now, end: now, epochs: 1 });
                Some(self.episodes.len() - 1)
            }
            None => {
                self.unlisted += 1;
                None
            }
        };
        self.last[bit] = Some((now, listed));
        let counts = &mut self.counts;
        let count = match cause {
            Health::INNOVATION_REJECTED => &mut counts.rejected,
            Health::RECOVERING => {
                // A recovery is one event, whatever its length.
                counts.recoveries += u64::from(joins.is_none());
                return;
            }
            Health::GYRO_STUCK => &mut counts.gyro_stuck,
            Health::ACCELEROMETER_STUCK => &mut counts.accelerometer_stuck,
            Health::GAP => &mut counts.gaps,
            Health::OUT_OF_ORDER => &mut counts.out_of_order,
            Health::INERTIAL_INVALID => &mut counts.inertial_invalid,
            Health::GIMBAL_DISAGREES => &mut counts.gimbal_disagrees,
            Health::AIDING_LOST => &mut counts.aiding_lost,
            Health::INCONSISTENT => &mut counts.inconsistent,
            Health::NUMERIC => &mut counts.numeric,
            Health::JUMP => &mut counts.jumps,
            Health::GIMBAL_SLIPPED => &mut counts.gimbal_slips,
            Health::DRIFTING => &mut counts.drifting,
            Health::AIDING_STALE => &mut counts.aiding_stale,
            _ => return,
        };
        *count += 1;
    }

    /// Counts so far.
    #[must_use]
    pub fn counts(&self) -> &HealthCounts {
        &self.counts
    }

    /// Mean NIS of the measurements used in the calibration; `None` if there was none.
    #[must_use]
    pub fn nis_mean(&self) -> Option<f64> {
        (self.nis_count > 0).then(|| self.nis_sum / self.nis_count as f64)
    }

    /// Episodes in the order of their beginnings, at most [`EPISODES_MAX`].
    #[must_use]
    pub fn episodes(&self) -> &[Episode] {
        &self.episodes
    }

    /// Number of episodes beyond the list.
    #[must_use]
    pub fn unlisted(&self) -> u64 {
        self.unlisted
    }
}
