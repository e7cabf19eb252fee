//! Values of defaults that depend on other keys. The table of keys shows them, and
//! [`derive`](crate::derive) sets them.

use super::definition::CaseValue::{self, Number, Value, Words};
use octant_calibration::drift::{LIMIT_MOVING_SIGMAS, LIMIT_SIGMAS};

/// `endpoint.fmu.time_limit` and `source.fmu.time_limit` in a process of its own.
pub(crate) const TIME_LIMIT: &str = "10 s";
/// `turntable.drive.guard`, where the system has guards and elsewhere.
pub(crate) const GUARD: [&str; 2] = ["1 s", "0 s"];
/// `procedure.calibration.prior.g_dependent`, where the scenario doesn't draw them.
pub(crate) const G_DEPENDENT: &str = "0.0005 deg/h/g";
/// `procedure.calibration.prior.position`: of a simulated instrument at rest, which is where the site is, and elsewhere.
/// A metre of height is 0.3 µg of gravity, which the accelerometers' scale factors take.
pub(crate) const POSITION: [&str; 2] = ["1 cm", "1 m"];
/// `procedure.calibration.aiding.reference`, at rest and at the dockside.
pub(crate) const REFERENCES: [&str; 2] = ["zero-velocity", "dock-position"];
/// `procedure.calibration.aiding.sigma` and `noise` of a velocity.
pub(crate) const OF_VELOCITY: [&str; 2] = ["1 mm/s", "1 mm/s"];
/// The same of the position of the dock, with white sway and with coloured.
pub(crate) const OF_POSITION: [[&str; 2]; 2] = [["0.15 m", "0.01 m"], ["0.01 m", "0.01 m"]];
/// `screening.drift`, at rest and at the dockside.
pub(crate) const DRIFT_SIGMAS: [f64; 2] = [LIMIT_SIGMAS, LIMIT_MOVING_SIGMAS];

/// Cases of a default, each with its value.
pub(crate) type Cases = &'static [(&'static str, CaseValue)];

pub(super) const TIME_LIMITS: Cases = &[
    ("in a process of its own", Value(TIME_LIMIT)),
    ("in the shared one", Words("none, nothing can end a call")),
];
pub(super) const GUARDS: Cases =
    &[("where the system has guards", Value(GUARD[0])), ("elsewhere", Value(GUARD[1]))];
pub(super) const G_DEPENDENTS: Cases = &[
    ("where imu.g_dependent is drawn", Words("its standard deviation")),
    ("elsewhere", Value(G_DEPENDENT)),
];
pub(super) const PRIOR_POSITIONS: Cases =
    &[("simulated at rest", Value(POSITION[0])), ("elsewhere", Value(POSITION[1]))];
pub(super) const REFERENCE_CASES: Cases =
    &[("static", Value(REFERENCES[0])), ("dockside", Value(REFERENCES[1]))];
pub(super) const SIGMAS: Cases = &[
    ("velocities", Value(OF_VELOCITY[0])),
    ("dock-position", Value(OF_POSITION[0][0])),
    ("with sway = \"coloured\"", Value(OF_POSITION[1][0])),
];
pub(super) const NOISES: Cases =
    &[("velocities", Value(OF_VELOCITY[1])), ("dock-position", Value(OF_POSITION[0][1]))];
pub(super) const DRIFTS: Cases =
    &[("static", Number(DRIFT_SIGMAS[0])), ("dockside", Number(DRIFT_SIGMAS[1]))];
