//! Time that an answer may take: without the time in which the FMU's process was ready to run and had
//! no processor, so that a busy host doesn't make an FMU hang.

use super::shared::{Shared, Word};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Limit on the time of one answer.
pub(super) struct Patience {
    limit: Duration,
    began: Instant,
    /// Time without a processor up to the first look.
    starved_before: Option<Duration>,
}

impl Patience {
    pub(super) fn new(limit: Duration) -> Self {
        Self { limit, began: Instant::now(), starved_before: None }
    }

    pub(super) const fn limit(&self) -> Duration {
        self.limit
    }

    /// Returns whether the process had its time.
    pub(super) fn is_over(&mut self, shared: &Shared) -> bool {
        let waited = self.began.elapsed();
        let before = *self.starved_before.get_or_insert_with(|| starved(shared));
        waited >= self.limit && had_time(waited, starved(shared).saturating_sub(before), self.limit)
    }
}

/// Returns whether a process that was waited for, and had no processor for a part of that time, had
/// as much time as the limit.
fn had_time(waited: Duration, starved: Duration, limit: Duration) -> bool {
    waited.saturating_sub(starved) >= limit
}

/// Time in which the first thread of the FMU's process, which calls the FMU, was ready to run and had no
/// processor; none where the kernel doesn't tell.
fn starved(shared: &Shared) -> Duration {
    let process = shared.word(Word::Process).load(Ordering::Relaxed);
    let text = std::fs::read_to_string(format!("/proc/{process}/schedstat")).unwrap_or_default();
    Duration::from_nanos(run_delay_ns(&text).unwrap_or(0))
}

/// Second number of a `schedstat`: time on the processor, time ready to run without one, ns.
fn run_delay_ns(text: &str) -> Option<u64> {
    text.split_ascii_whitespace().nth(1)?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::{had_time, run_delay_ns};
    use std::time::Duration;

    #[test]
    fn time_without_a_processor_is_not_counted() {
        let s = Duration::from_secs;
        assert!(had_time(s(10), s(0), s(10)));
        assert!(!had_time(s(10), s(1), s(10)));
        assert!(had_time(s(60), s(50), s(10)));
        assert!(!had_time(s(60), s(70), s(10)), "the kernel counts a moment more");
    }

    #[test]
    fn the_kernel_s_numbers_are_read() {
        assert_eq!(run_delay_ns("3213217 150000000 12\n"), Some(150_000_000));
        assert_eq!((run_delay_ns(""), run_delay_ns("1 x 2")), (None, None));
        let own = std::fs::read_to_string("/proc/self/schedstat").unwrap_or_default();
        assert!(own.is_empty() || run_delay_ns(&own).is_some(), "{own:?}");
    }
}
