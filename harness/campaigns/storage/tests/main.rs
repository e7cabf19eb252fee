//! Campaigns on object storage, without a service: in memory and in folders.
#![allow(clippy::unwrap_used, reason = "tests")]

mod bench;
mod names;
mod objects;
mod uploads;
mod work;
