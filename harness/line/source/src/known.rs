//! A reference that the scenario knows and the source doesn't: of a recording made at rest.

use octant_sample::{Aiding, DeviceTime, Reference};

/// The reference, at equal times of the samples' clock.
#[derive(Clone, Copy, Debug)]
pub(super) struct KnownReference {
    reference: Reference,
    period_ns: u64,
    /// Half of a sample period: stamps of real instruments jitter.
    slack_ns: u64,
    /// Start of the first sample's interval, and references so far.
    started_ns: Option<u64>,
    given: u64,
    sample_period_ns: u64,
}

impl KnownReference {
    /// Makes one that comes once a period.
    pub(super) fn new(reference: Reference, period_ns: u64, sample_period_ns: u64) -> Self {
        Self {
            reference,
            period_ns,
            slack_ns: sample_period_ns / 2,
            started_ns: None,
            given: 0,
            sample_period_ns,
        }
    }

    /// Returns the reference for a sample with this stamp, if one is due.
    pub(super) fn at(&mut self, stamp: DeviceTime) -> Option<Aiding> {
        let started_ns =
            *self.started_ns.get_or_insert(stamp.ns.saturating_sub(self.sample_period_ns));
        let elapsed_ns = stamp.ns.saturating_sub(started_ns).saturating_add(self.slack_ns);
        let due = elapsed_ns / self.period_ns;
        if due <= self.given {
            return None;
        }
        // After a gap there is one, and not all that were missed.
        self.given = due;
        Some(Aiding { device_time: stamp, reference: self.reference })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_comes_once_a_period_with_the_stamp_of_its_sample() {
        let reference = Reference::Velocity([0.0; 3]);
        let mut known = KnownReference::new(reference, 1_000_000_000, 100_000_000);
        let start_ns = 5_000_000_000;
        let mut came = Vec::new();
        // A tenth of a second each, two milliseconds of jitter, and a gap from 2.2 s to 4.5 s.
        for tenth in (1_u64..=60).filter(|tenth| !(23..45).contains(tenth)) {
            let jitter_ns = if tenth % 2 == 0 { 2_000_000 } else { 0 };
            let stamp = DeviceTime { ns: start_ns + tenth * 100_000_000 - jitter_ns };
            if let Some(aiding) = known.at(stamp) {
                assert_eq!(aiding.device_time, stamp);
                came.push(tenth);
            }
        }
        assert_eq!(came, [10, 20, 45, 50, 60]);
    }
}
