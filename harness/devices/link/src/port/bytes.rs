//! Ports that carry bytes.

use super::error::PortError;
use octant_faults::wire::Wired;
use std::fmt::Debug;
use std::time::{Duration, SystemTime};

/// A port that carries bytes: a line, or datagrams. The bytes of one call of [`Self::send`] are one
/// frame.
pub trait Bytes: Debug + Send {
    /// Sends all bytes within a time. False: the port did not accept them all, and those that it did
    /// are a piece of a frame.
    ///
    /// # Errors
    /// If the port is gone.
    fn send(&mut self, bytes: &[u8], wait: Duration) -> Result<bool, PortError>;

    /// Receives at least one byte within a time; 0: nothing came. With a zero wait it returns at once.
    ///
    /// # Errors
    /// If the port is gone.
    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<usize, PortError>;

    /// True if [`Self::receive`] gives whole datagrams, not pieces of a line.
    fn datagrams(&self) -> bool;

    /// Number of connections that were made so far; 0: the port makes none. What comes from another one doesn't continue
    /// what came before.
    fn connections(&self) -> u64 {
        0
    }

    /// Name under which the other end reaches this port.
    fn reached_at(&self) -> String;

    /// Number of datagrams that don't have the seal of the [secret](crate::uri::Udp::secret), and were dropped.
    fn unsealed(&self) -> u64 {
        0
    }

    /// Binds the port to the peer that was heard last, for a session, or releases it. While it is
    /// bound, nobody else is heard.
    fn hold_peer(&mut self, hold: bool);

    /// Asks the kernel for the times at which data arrives. False: it has none for this port.
    fn stamp_arrivals(&mut self) -> bool {
        false
    }

    /// Time by the kernel's realtime clock at which the data of the last [`Self::receive`] arrived.
    fn arrived(&self) -> Option<SystemTime> {
        None
    }

    /// Closes the port, which is gone until it is opened again.
    fn close(&mut self);

    /// Opens the port again after it went away.
    ///
    /// # Errors
    /// If the port isn't back.
    fn reopen(&mut self) -> Result<(), PortError>;

    /// Fault injection of this port, if it has one.
    fn wired(&mut self) -> Option<&mut dyn Wired> {
        None
    }
}
