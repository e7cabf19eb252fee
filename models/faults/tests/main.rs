//! Integration tests of the fault pipeline and of its kinds, in one program.
#![allow(clippy::unwrap_used)]

mod any_fault;
mod common;
mod connection;
mod delivery_properties;
mod kinds_aiding;
mod kinds_analogue;
mod kinds_delivery;
mod kinds_digital;
mod kinds_host;
mod kinds_ring_laser;
mod kinds_time;
mod kinds_turntable_command;
mod kinds_unit;
mod kinds_wire;
mod station;
