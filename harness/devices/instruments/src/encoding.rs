//! Shared parts of the encoders.

use crate::{MeasuredTriad, ReadingKind};

/// Error of a reading that lacks a value for a frame, or has one that doesn't fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a frame of {protocol} needs {what}")]
pub struct CannotCarry {
    /// Name of the protocol.
    pub protocol: &'static str,
    /// Missing or unsuitable value.
    pub what: &'static str,
}

/// Requirements on a reading that is to be encoded.
#[derive(Clone, Copy)]
pub(crate) struct Needs(pub(crate) &'static str);

impl Needs {
    pub(crate) fn some<T>(self, value: Option<T>, what: &'static str) -> Result<T, CannotCarry> {
        value.ok_or(CannotCarry { protocol: self.0, what })
    }

    /// Requires increments, which are also made from means if the interval is known.
    pub(crate) fn increments(
        self,
        measured: Option<MeasuredTriad>,
        interval_s: Option<f64>,
        what: &'static str,
    ) -> Result<[f64; 3], CannotCarry> {
        let measured = self.some(measured, what)?;
        match (measured.kind, interval_s) {
            (ReadingKind::Increment, _) => Ok(measured.value),
            (ReadingKind::Mean, Some(interval_s)) => Ok(measured.over(interval_s)),
            (ReadingKind::Mean, None) => Err(CannotCarry { protocol: self.0, what }),
        }
    }

    /// Requires means, which are also made from increments if the interval is known.
    pub(crate) fn means(
        self,
        measured: Option<MeasuredTriad>,
        interval_s: Option<f64>,
        what: &'static str,
    ) -> Result<[f64; 3], CannotCarry> {
        let measured = self.some(measured, what)?;
        match (measured.kind, interval_s) {
            (ReadingKind::Mean, _) => Ok(measured.value),
            (ReadingKind::Increment, Some(interval_s)) if interval_s > 0.0 => {
                Ok(measured.value.map(|value| value / interval_s))
            }
            _ => Err(CannotCarry { protocol: self.0, what }),
        }
    }
}
