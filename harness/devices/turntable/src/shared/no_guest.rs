//! A guest at a table on systems where it can't share the time of the driving run.

use crate::{Error, TableAxis, TableTraffic, TrackPoint};
use octant_sample::GimbalCommand;
use std::time::{Duration, Instant};

/// A guest at a table, which doesn't exist on this system.
#[derive(Debug)]
pub enum NoTableGuest {}

impl NoTableGuest {
    /// Refuses.
    ///
    /// # Errors
    /// Always.
    pub fn join(port: &str, _: Duration) -> Result<Self, Error> {
        let reason = "runs share a table on Linux only".to_owned();
        Err(Error::Shared { port: port.to_owned(), reason })
    }

    /// Is never called.
    #[must_use]
    pub fn units(&self) -> usize {
        match *self {}
    }

    /// Is never called.
    pub fn command(&mut self, _: &GimbalCommand) {
        match *self {}
    }

    /// Is never called.
    pub fn take_looks(&mut self) {
        match *self {}
    }

    /// Is never called.
    #[must_use]
    pub fn at(&self, _: TableAxis, _: Instant) -> Option<TrackPoint> {
        match *self {}
    }

    /// Is never called.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        match *self {}
    }

    /// Is never called.
    #[must_use]
    pub fn stopped(&self) -> Option<String> {
        match *self {}
    }

    /// Is never called.
    #[must_use]
    pub fn traffic(&self) -> TableTraffic {
        match *self {}
    }

    /// Is never called.
    pub fn leave(self, _: Option<&str>) {
        match self {}
    }
}
