//! The latency of the host, measured.

use octant_realtime::latency::{LatencyResult, Trial, measure};
use octant_realtime::schedule::Wish;
use std::time::Duration;

#[test]
fn as_many_wakings_as_periods_are_measured() {
    let found = measure(Trial {
        period_ns: 1_000_000,
        duration: Duration::from_millis(50),
        spin_ns: 0,
        wish: Wish { priority: None, lock_memory: false, cpu: None },
    })
    .unwrap_or_else(|error| panic!("{error}"));
    assert!((49..=50).contains(&found.report.frames), "{found:?}");
    assert_eq!(found.report.lateness.count, found.report.frames);
    assert!(found.report.lateness.p50_us <= found.report.lateness.p99_us);
    let text = serde_json::to_string(&found).unwrap_or_default();
    let back: LatencyResult = serde_json::from_str(&text).unwrap_or_else(|e| panic!("{e}: {text}"));
    assert_eq!(back, found);
}
