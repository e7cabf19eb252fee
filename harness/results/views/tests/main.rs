//! Tests of topics for other tools, in one program.
#![allow(clippy::unwrap_used)]

mod boundary;
mod layouts;
mod recording;
mod recordings;
mod ros;
mod ros_published;
mod series;
mod solution;
mod standard;
