//! Tests of recordings, in one program.
#![allow(clippy::unwrap_used)]

mod concluded;
mod events;
mod stream_hash;
