//! Order of requests: those that a device does, answers again or ignores, by the tables of "What is
//! said when" in `README.md`.

use crate::message::{AidingMessage, DeviceStatus, SampleMessage, StepNumber, StepPacing};
use octant_sample::Aiding;

/// Decision of a device about a request.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RequestDecision {
    /// Do it and answer; a sample with this aiding.
    Do(Option<Aiding>),
    /// Send the last answer again.
    Again,
    /// Ignore it: it comes too late or too early, or without its aiding, and will be repeated.
    Nothing,
}

/// Keeps the steps of a session in order, at the device.
#[derive(Clone, Copy, Debug)]
pub struct Requests {
    pacing: StepPacing,
    aiding: Option<AidingMessage>,
    answered: bool,
    status: DeviceStatus,
}

impl Requests {
    /// Begins a session.
    #[must_use]
    pub fn new(pacing: StepPacing) -> Self {
        Self { pacing, aiding: None, answered: false, status: DeviceStatus::default() }
    }

    /// Last step done.
    #[must_use]
    pub fn last(&self) -> StepNumber {
        self.status.step
    }

    /// Counts of steps and requests; the decoder has those of the line.
    #[must_use]
    pub fn status(&self) -> DeviceStatus {
        self.status
    }

    /// Stores aiding until its sample arrives.
    pub fn aiding(&mut self, aiding: &AidingMessage) {
        self.aiding = Some(*aiding);
    }

    /// Decides about a sample.
    #[must_use]
    pub fn sample(&mut self, message: &SampleMessage) -> RequestDecision {
        let order = self.order(message.step);
        if order != RequestDecision::Do(None) || !message.aided {
            return self.decide(message.step, order);
        }
        let aiding = self.aiding.filter(|aiding| aiding.step == message.step);
        match (aiding, self.pacing) {
            (Some(aiding), _) => {
                self.decide(message.step, RequestDecision::Do(Some(aiding.aiding)))
            }
            (None, pacing) => {
                add(&mut self.status.aiding_missing, 1);
                match pacing {
                    StepPacing::LockStep => RequestDecision::Nothing,
                    StepPacing::RealTime => self.decide(message.step, order),
                }
            }
        }
    }

    /// Decides about a restart or the end.
    #[must_use]
    pub fn other(&mut self, step: StepNumber) -> RequestDecision {
        let order = self.order(step);
        self.decide(step, order)
    }

    fn order(&self, step: StepNumber) -> RequestDecision {
        match (step.since(self.status.step), self.pacing) {
            (1, _) | (2.., StepPacing::RealTime) => RequestDecision::Do(None),
            (0, StepPacing::LockStep) if self.answered => RequestDecision::Again,
            _ => RequestDecision::Nothing,
        }
    }

    fn decide(&mut self, step: StepNumber, verdict: RequestDecision) -> RequestDecision {
        let status = &mut self.status;
        match verdict {
            RequestDecision::Do(_) => {
                let between = step.since(status.step) - 1;
                add(&mut status.skipped, between.unsigned_abs().into());
                add(&mut status.steps, 1);
                status.step = step;
                self.answered = true;
            }
            RequestDecision::Again => add(&mut status.repeated, 1),
            RequestDecision::Nothing => {}
        }
        verdict
    }
}

#[cfg(feature = "state")]
mod state {
    use super::{AidingMessage, Requests, StepPacing};
    use crate::{Message, MessageKind};
    use octant_state::{State, StateError, StateReader, Writer};

    impl State for Requests {
        fn save(&self, to: &mut Writer) {
            to.value("real time", &(self.pacing == StepPacing::RealTime));
            let aiding = self.aiding.map(|aiding| Message::Aiding(aiding).payload());
            to.value("aiding", &aiding.as_ref().map(|payload| payload.bytes()));
            to.value("answered", &self.answered);
            to.value("status", Message::Status(self.status).payload().bytes());
        }

        fn load(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
            let none = |field| move |_| StateError::value(field, "it is no message");
            let real_time: bool = from.value("real time")?;
            self.pacing = if real_time { StepPacing::RealTime } else { StepPacing::LockStep };
            let aiding: Option<&[u8]> = from.value("aiding")?;
            self.aiding = aiding
                .map(|bytes| {
                    let read = Message::read(MessageKind::Aiding, bytes).map_err(none("aiding"))?;
                    Ok::<Option<AidingMessage>, StateError>(match read {
                        Message::Aiding(aiding) => Some(aiding),
                        _ => None,
                    })
                })
                .transpose()?
                .flatten();
            self.answered = from.value("answered")?;
            let status = Message::read(MessageKind::Status, from.value("status")?);
            if let Message::Status(status) = status.map_err(none("status"))? {
                self.status = status;
            }
            Ok(())
        }
    }
}

/// Adds to a count, which stays at its largest value.
fn add(count: &mut u32, more: u32) {
    *count = count.saturating_add(more);
}
