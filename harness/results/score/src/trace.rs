//! Data of a run for the comparison with its twin: digests of the core's outputs, and navigation errors
//! on a common grid.

use octant_sample::Output;

/// Number of outputs for one digest.
pub const DIGEST_OUTPUTS: u64 = 200;
/// Most points of drift kept; beyond, every second one is dropped and the grid spacing is doubled.
pub const POINTS_MAX: usize = 4096;

/// Trace of one run.
#[derive(Clone, Debug)]
pub struct RunTrace {
    running: u64,
    outputs: u64,
    /// One digest for every [`DIGEST_OUTPUTS`] outputs, each over all outputs so far.
    digests: Vec<u64>,
    stride_s: u64,
    /// Second of the navigation, latitude and longitude error, rad.
    points: Vec<(u64, f64, f64)>,
}

impl Default for RunTrace {
    fn default() -> Self {
        Self::new()
    }
}

impl RunTrace {
    /// Makes an empty trace.
    #[must_use]
    pub fn new() -> Self {
        Self { running: 0, outputs: 0, digests: Vec::new(), stride_s: 1, points: Vec::new() }
    }

    /// Adds the output of an epoch.
    #[inline]
    pub fn output(&mut self, output: &Output) {
        let navigation = &output.navigation;
        let mut take = |bits: u64| {
            self.running =
                (self.running ^ bits).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(31);
        };
        take(navigation.latitude_rad.to_bits());
        take(navigation.longitude_rad.to_bits());
        for value in navigation.velocity_mps.iter().chain(&navigation.q_nb) {
            take(value.to_bits());
        }
        take(u64::from(output.health.bits()) << 32 | u64::from(output.parameters_revision));
        take(output.mode as u64);
        self.outputs += 1;
        if self.outputs.is_multiple_of(DIGEST_OUTPUTS) {
            self.digests.push(self.running);
        }
    }

    /// Begins a navigation; points of an earlier one, before a restart of the core, are dropped.
    pub fn navigation_begins(&mut self) {
        self.points.clear();
        self.stride_s = 1;
    }

    /// Adds a navigation error, `t_s` after the start of the navigation. Only errors at whole seconds
    /// are kept.
    pub fn drift(&mut self, t_s: f64, latitude_error_rad: f64, longitude_error_rad: f64) {
        let second = t_s.round();
        if (t_s - second).abs() > 1e-6 || !(0.0..1e12).contains(&second) {
            return;
        }
        let second = second as u64;
        if !second.is_multiple_of(self.stride_s) {
            return;
        }
        self.points.push((second, latitude_error_rad, longitude_error_rad));
        if self.points.len() > POINTS_MAX {
            self.stride_s *= 2;
            let stride_s = self.stride_s;
            self.points.retain(|(second, ..)| second.is_multiple_of(stride_s));
        }
    }

    /// Number of outputs up to which this run and another are the same: they differ within the next
    /// [`DIGEST_OUTPUTS`]. `None` if there is no difference.
    #[must_use]
    pub fn parts_from(&self, other: &Self) -> Option<u64> {
        let common = self.digests.iter().zip(&other.digests).take_while(|(a, b)| a == b).count();
        let same = self.outputs == other.outputs && self.running == other.running;
        (!same).then_some(common as u64 * DIGEST_OUTPUTS)
    }

    /// Rows of navigation time (h), and difference of latitude and longitude error, this run minus the
    /// other, rad, at the points that both have.
    #[must_use]
    pub fn minus(&self, other: &Self) -> Vec<(f64, f64, f64)> {
        let mut theirs = other.points.iter().peekable();
        let mut difference = Vec::new();
        for (second, latitude, longitude) in &self.points {
            while theirs.next_if(|point| point.0 < *second).is_some() {}
            if let Some(point) = theirs.next_if(|point| point.0 == *second) {
                let hours = *second as f64 / 3600.0;
                difference.push((hours, latitude - point.1, longitude - point.2));
            }
        }
        difference
    }
}
