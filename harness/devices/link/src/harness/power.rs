//! Sessions over losses of power: a new one after a loss, and the question whether the device lost its own.

use super::error::SessionError;
use super::greeting::greet;
use super::{ANEW, Harness, LinkEvent};
use crate::port::PortError;
use octant_wire::message::{Gathering, Hello, StepNumber};
use std::time::{Duration, Instant};

/// Interval between two attempts to open a port that isn't back.
const REOPEN_EVERY: Duration = Duration::from_millis(50);

/// Sign of life of a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SignOfLife {
    /// Reply in its session.
    InSession,
    /// Hellos of a device that has no session.
    Anew,
    /// Silence, or a port that is gone.
    Silence,
}

fn named(hello: &Hello) -> String {
    format!("{} {}", hello.name.as_str(), hello.firmware.as_str())
}

impl Harness {
    /// Begins a new session with the same device after it was without power: opens the port again and says hello, for
    /// as long as the hello of the first session is waited for.
    ///
    /// # Errors
    /// If port or device don't come back in that time, or another one answers.
    pub fn begin_again(&mut self) -> Result<(), SessionError> {
        let begun = Instant::now();
        let patience = self.options.patience.hello;
        let (theirs, agreement) = loop {
            let tried = match self.wire.reopen() {
                Ok(()) => {
                    let left = patience.saturating_sub(begun.elapsed());
                    greet(&mut self.wire, &self.options, left)
                }
                Err(error) => Err(error.into()),
            };
            match tried {
                Ok(found) => break found,
                Err(SessionError::Port(error)) => {
                    if begun.elapsed() >= patience {
                        return Err(error.into());
                    }
                    std::thread::sleep(REOPEN_EVERY);
                }
                Err(error) => return Err(error),
            }
        };
        if (theirs.name, theirs.firmware) != (self.theirs.name, self.theirs.firmware) {
            return Err(SessionError::OtherDevice {
                port: self.wire.name().to_owned(),
                found: named(&theirs),
                expected: named(&self.theirs),
            });
        }
        (self.theirs, self.agreement) = (theirs, agreement);
        (self.step, self.answered) = (StepNumber::default(), StepNumber::default());
        (self.request, self.aiding) = (None, None);
        (self.gathering, self.parameters, self.status) = (Gathering::new(), None, None);
        (self.bye, self.said_bye) = (None, false);
        Ok(())
    }

    /// Asks the device for its time until it answers, for as long as an answer is waited for. False: it doesn't, has no session
    /// any more, or its port is gone.
    ///
    /// # Errors
    /// If the port fails in another way.
    pub fn is_in_session(&mut self) -> Result<bool, SessionError> {
        Ok(self.sign_of_life(self.options.patience.answer)? == SignOfLife::InSession)
    }

    /// Asks the device for its time until it gives a sign of life, for so long.
    ///
    /// # Errors
    /// If the port fails in another way than by being gone.
    pub fn sign_of_life(&mut self, within: Duration) -> Result<SignOfLife, SessionError> {
        let begun = Instant::now();
        let repeat = self.options.patience.repeat.min(within);
        let mut anew = 0;
        while begun.elapsed() < within {
            match self.ask_for_time(repeat) {
                Ok(Some(LinkEvent::Time(_))) => return Ok(SignOfLife::InSession),
                // One alone may be an old frame.
                Ok(Some(LinkEvent::Anew)) => {
                    anew += 1;
                    if anew >= ANEW {
                        return Ok(SignOfLife::Anew);
                    }
                }
                Ok(_) => {}
                Err(SessionError::Port(PortError::Gone { .. }) | SessionError::Bye { .. }) => {
                    return Ok(SignOfLife::Silence);
                }
                Err(error) => return Err(error),
            }
        }
        Ok(SignOfLife::Silence)
    }

    /// Asks for the time, and returns the first event that tells of a session, or `None` after a time.
    fn ask_for_time(&mut self, within: Duration) -> Result<Option<LinkEvent>, SessionError> {
        self.request_time()?;
        let begun = Instant::now();
        while begun.elapsed() < within {
            let left = within.saturating_sub(begun.elapsed());
            match self.poll(left)? {
                Some(LinkEvent::Time(stamps)) if stamps.reply.id == self.time_id => {
                    return Ok(Some(LinkEvent::Time(stamps)));
                }
                Some(LinkEvent::Anew) => return Ok(Some(LinkEvent::Anew)),
                _ => {}
            }
        }
        Ok(None)
    }
}
