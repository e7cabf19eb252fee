//! The grid on which decimated data is kept.

/// First multiple of the period after a time.
pub(super) fn next_on_grid(time_ns: u64, period_ns: u64) -> u64 {
    let period_ns = period_ns.max(1);
    (time_ns / period_ns).saturating_add(1).saturating_mul(period_ns)
}
