//! The filter's measurements: health, NIS over the run, and whether innovations are white.

use super::solution::hours;
use super::whiteness::Whiteness;
use octant_sample::{DeviceTime, Health, Innovation, Output};
use octant_score::health::HealthMonitor;
use octant_score::points::{HealthEvent, NisPoint};

/// Maximum number of NIS points; beyond, every second one is dropped.
const NIS_POINTS_MAX: usize = 50_000;

/// Measurements as the core reported them.
#[derive(Clone, Debug)]
pub struct Measurements {
    stride: u64,
    count: u64,
    troubled: bool,
    /// Health and NIS over the run.
    pub health: HealthMonitor,
    /// NIS of the measurements.
    pub nis: Vec<NisPoint>,
    /// Whether the innovations are white.
    pub whiteness: Whiteness,
}

impl Measurements {
    pub(super) fn new() -> Self {
        Self {
            stride: 1,
            count: 0,
            troubled: false,
            health: HealthMonitor::new(),
            nis: Vec::new(),
            whiteness: Whiteness::default(),
        }
    }

    /// Takes an answer, with the time of the source where faults may have altered its stamp.
    #[inline(always)]
    pub(super) fn answer(&mut self, output: &Output, source_time: Option<DeviceTime>) {
        if !output.health.is_empty() || self.troubled || output.nis.is_finite() {
            self.troubled = !output.health.is_empty();
            self.measurement(output, source_time.unwrap_or(output.device_time));
        }
    }

    #[inline(never)]
    fn measurement(&mut self, output: &Output, at: DeviceTime) {
        self.health.push_at(output, at);
        if output.nis.is_finite() {
            self.count += 1;
            if self.nis.len() >= NIS_POINTS_MAX {
                let mut odd = false;
                self.nis.retain(|_| {
                    odd = !odd;
                    odd
                });
                self.stride *= 2;
            }
            // Rejected measurements are always drawn.
            let rejected = output.health.contains(Health::INNOVATION_REJECTED);
            if rejected || self.count.is_multiple_of(self.stride) {
                self.nis.push(NisPoint { hours: hours(output), nis: output.nis, innovation: None });
            }
        }
    }

    /// Takes the innovation of the measurement in the last output.
    #[inline(never)]
    pub(super) fn innovation(&mut self, output: &Output, innovation: &Innovation) {
        self.whiteness.push(innovation);
        let at = hours(output);
        if let Some(point) = self.nis.last_mut().filter(|point| point.hours == at) {
            point.innovation = Some(*innovation);
        }
    }

    /// Lists the core's reports, in order of time.
    #[must_use]
    pub fn events(&self) -> Vec<HealthEvent> {
        let mut events: Vec<HealthEvent> = self
            .health
            .episodes()
            .iter()
            .map(|episode| HealthEvent {
                hours: episode.start.seconds() / 3600.0,
                duration_s: episode.end.ns.saturating_sub(episode.start.ns) as f64 * 1e-9,
                name: episode.name().to_owned(),
                detail: format!("{} epochs", episode.epochs),
            })
            .collect();
        events.sort_by(|a, b| a.hours.total_cmp(&b.hours));
        events
    }
}
