//! Stand-in for instruments on a CAN bus in a program that was built without them.

use super::arrival::Arrival;
use crate::SourceError;
use octant_account::Account;
use octant_instruments::Reading;
use octant_link::Uri;
use octant_scenario::Messages;
use std::path::Path;
use std::time::Duration;

/// Uninhabited: no bus can be opened.
#[derive(Debug)]
pub(super) enum Bus {}

impl Bus {
    pub(super) fn open(_: &Uri, _: &Messages, _: &Path) -> Result<Self, SourceError> {
        Err(SourceError::WithoutCan)
    }

    pub(super) fn reading(&mut self) -> Option<(Reading, Arrival)> {
        match *self {}
    }

    pub(super) fn receive(&mut self, _: Duration) -> Result<bool, String> {
        match *self {}
    }

    pub(super) fn losses(&self, _: Account) -> Account {
        match *self {}
    }

    pub(super) fn said(&self) -> String {
        match *self {}
    }
}

pub(super) fn check(_: &Messages, _: &Path) -> Result<(), SourceError> {
    Err(SourceError::WithoutCan)
}
