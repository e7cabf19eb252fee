//! Tests of requirements in the files of other tools, in one program.
#![allow(clippy::unwrap_used)]

mod accounts;
mod archive;
mod dialects;
#[cfg(feature = "doorstop")]
mod doorstop;
mod errors;
mod formats;
mod needs;
mod reqif;
mod strictdoc;
mod texts;
