//! True physics of a run: motion of the case, the two-gimbal turntable, the sensors and their
//! noise.
//!
//! The plant makes integer counts, stamped at the end of their interval, and follows the gimbal
//! commands of the core. It never sees the estimates of the core.
//!
//! A sample is made in this order: the case moves (fixed, or on a moored ship), the gimbals turn
//! the body in it, the body's angular rate and specific force are integrated over the interval, the
//! sensors distort the integrals and add their noise, and counters digitise them. The reference
//! that aids a calibration is made at the same stamp.
//!
//! Random numbers come from named streams ([`octant_random`]): `gyro.noise`, `accelerometer.noise`,
//! `gyro.gauss_markov`, `gyro.rate_random_walk`, `accelerometer.gauss_markov`, `gyro.flicker.0` to
//! `gyro.flicker.8` and `accelerometer.flicker.0` to `accelerometer.flicker.8` ([`flicker`]),
//! `aiding.noise`, `turntable.encoder.azimuth`, `turntable.encoder.roll`,
//! `turntable.encoder.noise`, and `draw.*` for numbers
//! drawn before a run ([`draw`]). No stream affects another.

mod case;
mod compared;
pub mod config;
pub mod course;
mod disturbed;
pub mod draw;
mod encoder;
mod envelope;
pub mod flicker;
pub mod further;
mod gimbal;
mod imu;
mod increments;
pub mod interpolation;
mod kinematics;
pub mod motion;
mod plant;
mod processes;
mod reference;
pub mod sea;
mod ship;
mod sway;
pub mod table;
mod trig;
mod validate;
mod vibration;
mod window;

pub use compared::{ComparedPlant, STATE_FORMAT as COMPARED_STATE_FORMAT};
pub use octant_sample::Truth;
pub use plant::{Plant, PlantStep, STATE_FORMAT};
pub use validate::PlantConfigError;

// The tests name the crate as its users do. They are a part of it because what they look at is
// private: inlined where samples pass, and in no interface.
#[cfg(test)]
extern crate self as octant_plant;
#[cfg(test)]
#[path = "../tests/main.rs"]
mod tests;
