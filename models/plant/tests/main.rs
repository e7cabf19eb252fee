//! Integration tests of the plant, in one program.
#![allow(clippy::unwrap_used)]

mod common;
mod compared;
mod disturbed_arbitrary;
mod disturbed_strapdown;
mod kinds_physics;
mod kinds_turntable;
mod noise;
mod nonlinear;
mod sensors;
mod state;
mod strapdown;
mod tune;
mod turntable;
