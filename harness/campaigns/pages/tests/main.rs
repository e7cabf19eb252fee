//! Tests of the pages of campaigns, in one program.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "tests")]

mod certificate;
