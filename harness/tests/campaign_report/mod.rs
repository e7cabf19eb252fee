//! Reports of campaigns: their numbers by another path, their bytes, dispositions, manifests, and
//! everything that must not look like a pass.
#![allow(clippy::cast_precision_loss)]

pub(crate) mod bench;
mod dispositions;
mod draws;
mod evidence;
mod findings;
mod numbers;
mod two_persons;
