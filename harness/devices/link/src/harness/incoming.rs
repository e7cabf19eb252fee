//! Messages that arrive at the harness end of a session, as events.

use super::Harness;
use super::error::SessionError;
use super::event::LinkEvent;
use super::greeting::heard;
use crate::clock::Stamps;
use crate::wire::{Incoming, TrafficCounts};
use octant_wire::message::{EndRole, Message, StepNumber, StepPacing};
use std::time::Duration;

impl Harness {
    #[cold]
    pub(super) fn no_answer(
        &self,
        before: &TrafficCounts,
        step: StepNumber,
        what: &str,
        waited: Duration,
        asked: u32,
    ) -> SessionError {
        SessionError::NoAnswer {
            port: self.wire.name().to_owned(),
            waited_for: format!("{what} to step {}", step.number()),
            waited,
            asked,
            heard: heard(&self.wire, before, self.bye),
        }
    }

    /// Converts an incoming message to an event.
    pub(super) fn take(
        &mut self,
        incoming: Incoming,
        during: &str,
    ) -> Result<LinkEvent, SessionError> {
        let message = match incoming {
            Incoming::Message(message) => message,
            // The two ends have agreed on a version: on a bus a damaged frame can look like another
            // one.
            Incoming::Newer(_) => return Ok(LinkEvent::Other),
        };
        Ok(match message {
            Message::Output(output) => {
                if self.options.pacing == StepPacing::RealTime
                    && output.step.since(self.answered) > 0
                    && output.step.since(self.step) <= 0
                {
                    self.answered = output.step;
                }
                LinkEvent::Output(output)
            }
            Message::Parameters(segment) => match self.gathering.add(&segment) {
                Some(gathered) => {
                    self.parameters = Some(gathered);
                    LinkEvent::Parameters(gathered)
                }
                None => LinkEvent::Other,
            },
            Message::Ready(ready) => {
                if self.options.pacing == StepPacing::RealTime {
                    self.answered = ready.step;
                }
                LinkEvent::Ready(ready.step)
            }
            Message::Status(status) => {
                self.status = Some(status);
                LinkEvent::Status(status)
            }
            Message::Heartbeat(heartbeat) => LinkEvent::Heartbeat(heartbeat),
            Message::TimeReply(reply) => {
                LinkEvent::Time(Stamps { reply, harness_received: self.wire.now() })
            }
            // Answer to a hello that was sent twice.
            Message::Hello(hello) if hello.session == self.agreement.session => LinkEvent::Other,
            Message::Hello(hello) if hello.role != EndRole::Harness => LinkEvent::Anew,
            Message::Bye(bye) => {
                self.said_bye = true;
                return Err(SessionError::Bye {
                    port: self.wire.name().to_owned(),
                    during: during.to_owned(),
                    bye,
                });
            }
            Message::Sample(sample) => LinkEvent::Sample(sample),
            Message::Aiding(aiding) => LinkEvent::Aiding(aiding),
            _ => LinkEvent::Other,
        })
    }
}
