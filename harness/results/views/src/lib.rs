//! Topics for other tools: what viewers and ROS 2 show of a run, made from the messages of its recording.
//!
//! - [`state`] follows a run message by message, [`about`] knows its scenario
//! - [`published`] makes JSON of both, [`standard`] messages of ROS 2 from the parts of an epoch, in the layout of
//!   [`ros`]
//! - [`ros_published`] makes messages of ROS 2 of those in JSON
//! - [`publisher`] makes all of them while a run is recorded, for its own recording
//!
//! A recording, a live run and an export have the same messages, because all three are made here.

pub mod about;
pub mod boundary;
pub mod published;
pub mod publisher;
pub mod ros;
pub mod ros_published;
pub mod series;
pub mod solution;
pub mod standard;
pub mod state;

pub use publisher::publishing;
