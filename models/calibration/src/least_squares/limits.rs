//! Capacities of the fixed stores, and the limit of acceptance.

/// Largest number of static intervals: six passes of nineteen stops fit.
pub const INTERVALS_MAX: usize = 128;

/// Longest window of the detection of standstill, samples.
pub const WINDOW_SAMPLES_MAX: usize = 512;

/// Residuals in units of their noise above which the adjustment against Earth rate, or an external
/// turntable, is refused. An unknown G of 5e-3 °/h/g reaches 2.7 in 4 h and 5.6 in 24 h.
pub const RESIDUAL_RMS_MAX: f64 = 10.0;
