//! Reports of campaigns: their numbers computed independently, their bytes, dispositions,
//! manifests, and all cases that must not look like a pass.
#![allow(clippy::cast_precision_loss)]

pub(crate) mod bench;
mod dispositions;
mod draws;
mod evidence;
mod findings;
mod numbers;
mod two_persons;
mod units;
