//! Conversion factors between SI and the units of the field. Multiply to get SI.

/// Standard gravity, m/s²: the g of "µg" and "per g".
pub const STANDARD_GRAVITY_MPS2: f64 = 9.806_65;
/// rad in a degree.
pub const DEG: f64 = core::f64::consts::PI / 180.0;
/// rad in a minute of arc.
pub const ARCMIN: f64 = DEG / 60.0;
/// rad in a second of arc.
pub const ARCSEC: f64 = DEG / 3600.0;
/// rad/s in a degree per hour.
pub const DEG_PER_HOUR: f64 = DEG / 3600.0;
/// rad/√s in a degree per root hour (angle random walk).
pub const DEG_PER_SQRT_HOUR: f64 = DEG / 60.0;
/// (rad/s)/(m/s²) in a degree per hour per g.
pub const DEG_PER_HOUR_PER_G: f64 = DEG_PER_HOUR / STANDARD_GRAVITY_MPS2;
/// m/s² in a micro-g; also (m/s²)/√Hz in a µg/√Hz.
pub const MICRO_G: f64 = 1e-6 * STANDARD_GRAVITY_MPS2;
/// One part per million.
pub const PPM: f64 = 1e-6;
/// m in a nautical mile.
pub const NAUTICAL_MILE_M: f64 = 1852.0;
