//! Events of the unit under test in the recording: a replay applies them again.

use octant_endpoint::{Endpoint, EndpointError};
use octant_faults::rule::UnitEvent;
use octant_recorder::Event;
use octant_recorder::event::{UnitAction, by_name};
use octant_sample::Parameters;
use octant_sample::parameters::NAMES;
use serde_json::Value;
use std::time::Duration;

/// Builds the event that happened before the unit got the sample of this number.
#[must_use]
pub fn event(event: &UnitEvent, sample: u64) -> Event {
    let (action, offset) = match event {
        // Of a dip only a restart is an event of the unit.
        UnitEvent::VoltageDip { .. } | UnitEvent::Restart => (UnitAction::Restart, None),
        UnitEvent::PowerOff => (UnitAction::PowerOff, None),
        UnitEvent::PowerOn => (UnitAction::PowerOn, None),
        UnitEvent::RestartWith { offset } => {
            (UnitAction::RestartWith, Some(by_name(&offset.to_array())))
        }
    };
    Event::Unit { action, offset, sample }
}

/// Reason why a unit's event can't be read: a fragment that fits after "failed to …".
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UnitEventError {
    /// The offset of a parameter is missing.
    #[error("do what happened to the unit again: no {expected} in it")]
    Offset {
        /// Name of the parameter.
        expected: &'static str,
    },
    /// The action isn't known.
    #[error(
        "do what happened to the unit again: found {found:?}, expected restart, restart-with, \
         power-off or power-on"
    )]
    Action {
        /// Action found.
        found: String,
    },
}

/// Reads the unit's event; `None` for another event.
///
/// # Errors
/// If it can't be read.
pub fn of(event: &Event) -> Result<Option<UnitEvent>, UnitEventError> {
    let (action, offset) = match event {
        Event::Unit { action, offset, .. } => (action, offset),
        Event::Other { kind, detail } if kind == "unit" => {
            let found = detail.get("action").and_then(Value::as_str).unwrap_or_default();
            return Err(UnitEventError::Action { found: found.to_owned() });
        }
        _ => return Ok(None),
    };
    Ok(Some(match action {
        UnitAction::Restart => UnitEvent::Restart,
        UnitAction::PowerOff => UnitEvent::PowerOff,
        UnitAction::PowerOn => UnitEvent::PowerOn,
        UnitAction::RestartWith => {
            let mut values = [0.0; NAMES.len()];
            for (value, name) in values.iter_mut().zip(NAMES) {
                *value = offset
                    .as_ref()
                    .and_then(|offset| *offset.get(name)?)
                    .ok_or(UnitEventError::Offset { expected: name })?;
            }
            UnitEvent::RestartWith { offset: Parameters::from_array(&values) }
        }
    }))
}

/// Applies the event, which comes before the epoch of this number, to an endpoint. Returns what a replay has to apply: of a dip
/// it is the restart, where there was one.
///
/// # Errors
/// If the endpoint can't.
pub(crate) fn happen<E: Endpoint + ?Sized>(
    event: &UnitEvent,
    sample: u64,
    endpoint: &mut E,
) -> Result<Option<UnitEvent>, EndpointError> {
    match event {
        UnitEvent::PowerOff => endpoint.power_off(sample)?,
        UnitEvent::PowerOn => endpoint.power_on(sample)?,
        UnitEvent::Restart => endpoint.restart(None)?,
        UnitEvent::RestartWith { offset } => endpoint.restart(Some(offset))?,
        UnitEvent::VoltageDip { voltage_v, length_s } => {
            let length = Duration::try_from_secs_f64(*length_s).unwrap_or_default();
            let restarted = endpoint.voltage_dip(*voltage_v, length, sample)?;
            return Ok(restarted.then_some(UnitEvent::Restart));
        }
    }
    Ok(Some(*event))
}
