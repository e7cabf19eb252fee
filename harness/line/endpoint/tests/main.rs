//! Tests of endpoints, in one program.
#![allow(clippy::unwrap_used)]

mod answer;
mod fmu;
mod fmu_bits;
mod fmu_plant;
