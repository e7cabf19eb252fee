//! Physical dimensions of quantities.

/// Physical dimension of a quantity. A value in [`Values`](crate::Values) is in the SI unit named here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Dimension {
    /// s.
    Time,
    /// Whole samples; written `"20 samples"`.
    Samples,
    /// 1/s.
    Frequency,
    /// rad.
    Angle,
    /// rad, written in arcsec.
    SmallAngle,
    /// rad/s of a motion.
    AngularRate,
    /// rad/s of a gyro error.
    GyroBias,
    /// rad/s².
    AngularAcceleration,
    /// rad/√s.
    AngleRandomWalk,
    /// rad/s/√s.
    RateRandomWalk,
    /// (rad/s)/(m/s²).
    GDependent,
    /// m.
    Length,
    /// m/s.
    Velocity,
    /// m/s².
    Acceleration,
    /// m/s² of an accelerometer error.
    AccelBias,
    /// (m/s²)/√Hz.
    VelocityRandomWalk,
    /// (m/s²)/√s, a random walk of the accelerometer bias.
    AccelRandomWalk,
    /// 1.
    Ratio,
    /// K.
    Temperature,
    /// K/s.
    TemperatureRate,
    /// (rad/s)/K.
    GyroBiasPerK,
    /// (m/s²)/K.
    AccelBiasPerK,
    /// 1/K.
    ScalePerK,
    /// (m/s²)²/Hz, written in g²/Hz.
    AccelerationPsd,
    /// V.
    Voltage,
}
