//! Campaigns on object storage, without a service: in memory and in folders.

mod bench;
mod names;
mod objects;
mod uploads;
mod work;
