//! True state: for scoring, never for the core.

/// Truth at one instant, at the centre of rotation of the gimbals. While a fault shakes the sensor
/// block against the gimballed body, position, velocity and attitude are those of the block: of the
/// motion that the sensors feel. A source that doesn't know velocity or attitude gives NaN.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Truth {
    /// Simulated time, ns since the start.
    pub time: crate::time::SimulatedTime,
    /// Geodetic latitude, rad.
    pub latitude_rad: f64,
    /// Longitude, rad.
    pub longitude_rad: f64,
    /// Height above the ellipsoid, m.
    pub height_m: f64,
    /// Velocity over ground in n, m/s.
    pub velocity_mps: [f64; 3],
    /// Attitude `q_nb` (w, x, y, z), of the gimballed body about which the sensor block vibrates.
    pub q_nb: [f64; 4],
    /// True gimbal angles (azimuth, roll), rad, without encoder error.
    pub gimbal_rad: [f64; 2],
}
