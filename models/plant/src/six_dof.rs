//! Motion in six degrees of freedom at one time.

/// Value, rate and acceleration of one degree of freedom.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Dof {
    pub(crate) value: f64,
    pub(crate) rate: f64,
    pub(crate) acceleration: f64,
}

/// Roll, pitch, yaw (rad), surge, sway, heave (m).
pub(crate) type SixDof = [Dof; 6];
