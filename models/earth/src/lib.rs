//! Earth: WGS-84 ellipsoid, normal gravity, frames and rotations.
//!
//! Frames: `i` inertial, `e` Earth, `n` north-east-down at the instrument, `c` case, `b` body.
//! `c_nb` takes a vector in b into n; `q_nb` is the same as a unit quaternion (Hamilton).
#![no_std]

pub mod ellipsoid;
pub mod frames;
pub mod rotation;
pub mod units;

pub use nalgebra::{Matrix3, UnitQuaternion, Vector3};
