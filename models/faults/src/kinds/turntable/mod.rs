//! Gimbals, drives and encoders.

mod command;

use crate::catalogue::Kind;

pub(super) static KINDS: &[&Kind] = &[
    &command::SKIPPED_POSITION,
    &command::REPEATED_POSITION,
    &command::WRONG_DIRECTION,
    &command::COMMAND_LATE,
    &command::COMMAND_LOST,
];
