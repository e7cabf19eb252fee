//! The core's reports as events of a report.

use super::watch::Watcher;
use octant_report::HealthEvent;

impl Watcher {
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
