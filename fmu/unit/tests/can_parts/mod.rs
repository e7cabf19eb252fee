//! Parts of the device on a CAN bus that the library keeps to itself. Their files are compiled into this program
//! once more, so that nothing of the library has to be public for its tests.
#![allow(dead_code, reason = "the library uses the rest")]

#[path = "../../src/calibrator_can/controller.rs"]
mod controller;
mod controllers;
#[path = "../../src/calibrator_can/operation.rs"]
mod operation;
mod operations;
