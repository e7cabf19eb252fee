//! The calibration core as a component.
