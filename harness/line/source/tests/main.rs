//! Tests of sources from outside, in the one test program of the crate.

#[path = "../../../results/recorder/tests/common"]
mod common {
    pub(super) mod epochs;
    pub(super) mod stream;
}

mod accounts;
#[cfg(unix)]
#[cfg(feature = "can")]
mod can_source;
mod counting;
mod described_files;
mod mcap_dialects;
mod reference_rows;
mod replay;
mod tcp_source;
mod text;
mod udp_source;
mod unit_frames;
