//! Information that the samples of the calibration have of the parameters, from the true motion.

use octant_followed::interval::Interval;
use octant_sample::{NoiseIntegral, Truth};
use octant_score::information::SampleInformation;

/// Longest interval between two truths that are taken together, ns.
const BREAK_NS: u64 = 2_500_000_000;

/// Information so far.
#[derive(Clone, Debug, Default)]
pub struct CalibrationInformation {
    before: Option<(u64, Truth)>,
    /// The sums.
    pub sum: SampleInformation,
}

impl CalibrationInformation {
    /// Takes the truth at an answer of the calibration.
    pub(super) fn truth(&mut self, now_ns: u64, truth: &Truth) {
        let before = self.before.replace((now_ns, *truth));
        let Some((before_ns, before)) = before.filter(|(before_ns, _)| *before_ns < now_ns) else {
            return;
        };
        let dt_s = (now_ns - before_ns) as f64 * 1e-9;
        let none = NoiseIntegral::default();
        match Interval::between(&before, truth, [&none, &none], dt_s) {
            Some(interval) if now_ns - before_ns <= BREAK_NS => {
                self.sum.take(dt_s, interval.turn_rad(), interval.force_mps());
            }
            // More information than any motion that isn't seen has: no bound that is too high.
            _ => (0..3).for_each(|axis| {
                let at = |size: f64| std::array::from_fn(|i| if i == axis { size } else { 0.0 });
                self.sum.take(dt_s, at(10.0 * dt_s), at(100.0 * dt_s));
            }),
        }
    }
}
