//! Motion of the case at one time, and of a ship in six degrees of freedom.

use nalgebra::Vector3;

/// Motion that the case feels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CaseMotion {
    /// ω_ic in c, rad/s.
    pub(crate) rate: Vector3<f64>,
    /// Derivative of the rate in c, rad/s² (transport rate taken at constant latitude).
    pub(crate) acceleration: Vector3<f64>,
    /// Specific force in c, m/s².
    pub(crate) force: Vector3<f64>,
}

/// Position, velocity and attitude of the case.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Whereabouts {
    pub(crate) latitude_rad: f64,
    pub(crate) longitude_rad: f64,
    pub(crate) height_m: f64,
    pub(crate) velocity_mps: Vector3<f64>,
    pub(crate) heading_rad: f64,
    pub(crate) pitch_rad: f64,
    pub(crate) roll_rad: f64,
}

/// The node of an interval at which motion is wanted.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Node {
    /// One of the regular nodes.
    Regular(usize),
    /// Seconds since the start of the interval.
    Offset(f64),
}

/// Value, rate and acceleration of one degree of freedom.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Dof {
    pub(crate) value: f64,
    pub(crate) rate: f64,
    pub(crate) acceleration: f64,
}

/// Roll, pitch, yaw (rad), surge, sway, heave (m).
pub(crate) type SixDof = [Dof; 6];
