//! Noise that a bench knows: for scoring, never for the core.

/// Running integrals of the noise that is known to be in the samples, in b, since an arbitrary moment. Only differences
/// mean something.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NoiseIntegral {
    /// Noise of the gyros, rad.
    pub delta_theta_rad: [f64; 3],
    /// Noise of the accelerometers, m/s.
    pub delta_velocity_mps: [f64; 3],
}

impl core::ops::Add for NoiseIntegral {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let sum = |a: [f64; 3], b: [f64; 3]| core::array::from_fn(|i| a[i] + b[i]);
        Self {
            delta_theta_rad: sum(self.delta_theta_rad, other.delta_theta_rad),
            delta_velocity_mps: sum(self.delta_velocity_mps, other.delta_velocity_mps),
        }
    }
}
