//! Greeting of a session: hellos until the other end answers.

use super::error::{HeardTraffic, SessionError};
use super::options::{Patience, SessionOptions};
use crate::asking::Taken;
use crate::wire::{Incoming, TrafficCounts, Wire};
use octant_wire::Text;
use octant_wire::message::{
    Agreement, Bye, Capabilities, EndLimits, EndRole, Hello, Message, Reason, agree,
};
use std::time::{Duration, Instant};

/// Draws a random session number other than 0, so that no recent session has the same.
fn draw_session() -> u32 {
    use std::hash::{BuildHasher, Hasher};
    // `RandomState` is keyed by random numbers of the system.
    let mut hasher = std::collections::hash_map::RandomState::new().build_hasher();
    hasher.write_u32(std::process::id());
    (hasher.finish() as u32).max(1)
}

fn newer(wire: &Wire, found: u16) -> SessionError {
    SessionError::Newer {
        port: wire.name().to_owned(),
        reason: octant_wire::Unreadable::NewerVersion { found },
    }
}

pub(super) fn heard(wire: &Wire, before: &TrafficCounts, bye: Option<Reason>) -> HeardTraffic {
    let now = wire.counts();
    HeardTraffic {
        messages: now.received - before.received,
        lost: now.lost - before.lost,
        damaged: now.damaged - before.damaged,
        missing: now.missing - before.missing,
        unreadable: (now.unreadable > before.unreadable)
            .then(|| {
                wire.last_unreadable().map(|reason| (now.unreadable - before.unreadable, reason))
            })
            .flatten(),
        unsealed: wire.unsealed(),
        not_sent: now.not_sent - before.not_sent,
        off_bus: wire.is_off_bus(),
        bye,
    }
}

/// True if a reason refuses a session; the others end one.
fn refuses(reason: Reason) -> bool {
    matches!(
        reason,
        Reason::VERSION
            | Reason::ROLE
            | Reason::SESSION
            | Reason::PACING
            | Reason::PERIOD
            | Reason::CONFIGURATION
            | Reason::UNSUPPORTED
    )
}

/// True if a terminal would execute a character, or reorder the line because of it.
fn is_control(c: char) -> bool {
    c.is_control() || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

fn say_hello(
    wire: &mut Wire,
    ours: &Hello,
    patience: &Patience,
    stale: &mut Option<Reason>,
) -> Result<Hello, SessionError> {
    let before = wire.counts();
    let waited_before = wire.waited.total();
    let mut intervals = Taken::default().ask(patience.repeat, patience.hello);
    let (mut asked, mut newer_seen) = (0, None);
    loop {
        wire.send(&Message::Hello(*ours), patience.repeat)?;
        asked += 1;
        let asked_at = Instant::now();
        loop {
            let left = intervals.now().saturating_sub(asked_at.elapsed());
            match wire.receive(left)? {
                // No checksum protects the version of a hello on a bus: it must arrive twice.
                Some(Incoming::Newer(found)) if newer_seen.replace(found) == Some(found) => {
                    return Err(newer(wire, found));
                }
                Some(Incoming::Message(Message::Hello(theirs)))
                    if theirs.session == ours.session =>
                {
                    return Ok(theirs);
                }
                // A bye by which the device ended an earlier session may still be on the line.
                Some(Incoming::Message(Message::Bye(bye))) if !refuses(bye.reason) => {
                    *stale = Some(bye.reason);
                }
                Some(Incoming::Message(Message::Bye(bye))) => {
                    return Err(SessionError::Bye {
                        port: wire.name().to_owned(),
                        during: "its hello".to_owned(),
                        bye,
                    });
                }
                _ => {}
            }
            if asked_at.elapsed() >= intervals.now() {
                break;
            }
        }
        intervals.again();
        let waited = wire.waited.total() - waited_before;
        if waited >= patience.hello {
            return Err(SessionError::NoAnswer {
                port: wire.name().to_owned(),
                waited_for: "hello".to_owned(),
                waited,
                asked,
                heard: heard(wire, &before, *stale),
            });
        }
    }
}

/// Says hello until the other end answers, for as long as `hello`, and checks that the two fit together.
pub(super) fn greet(
    wire: &mut Wire,
    options: &SessionOptions,
    hello: Duration,
) -> Result<(Hello, Agreement), SessionError> {
    let session = draw_session();
    let ours = Hello {
        role: EndRole::Harness,
        pacing: options.pacing,
        session,
        capabilities: Capabilities::empty(),
        sample_period_ns: options.sample_period_ns,
        limits: EndLimits::default(),
        configuration: options.configuration,
        name: options.name,
        firmware: options.firmware,
        ..Hello::default()
    };
    let mut stale = None;
    let theirs = say_hello(wire, &ours, &Patience { hello, ..options.patience }, &mut stale)?;
    for (field, text) in [("name", theirs.name.as_str()), ("firmware", theirs.firmware.as_str())] {
        let Some(character) = text.chars().find(|c| is_control(*c)) else { continue };
        let bye =
            Bye { reason: Reason::FAILED, text: Text::fitting("control characters in a name") };
        let _ = wire.send(&Message::Bye(bye), options.patience.repeat);
        return Err(SessionError::Control {
            port: wire.name().to_owned(),
            field,
            found: text.to_owned(),
            character,
        });
    }
    let agreement = agree(&ours, &theirs).map_err(|reason| {
        // The device may be gone before it receives the bye.
        let _ = wire.send(&Message::Bye(reason.bye()), options.patience.repeat);
        SessionError::Refused { port: wire.name().to_owned(), reason }
    })?;
    Ok((theirs, agreement))
}
