//! Tests of recordings, in one program.
#![allow(clippy::unwrap_used)]

mod common;

mod concluded;
mod events;
mod other_readers;
mod recording;
mod stream_hash;
