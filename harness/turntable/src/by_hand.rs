//! A table that is looked at and moved by hand.

use crate::following::rest;
use crate::{
    Axis, Button, Driver, Error, Plan, Settings, Status, Supervisor, Turntable, on_panic,
    on_signals, open,
};

/// What is done by hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Move {
    /// An axis finds its reference.
    Home(Axis),
    /// An axis turns to an angle, with at most a rate, rad and rad/s.
    Goto(Axis, f64, Option<f64>),
}

/// Asks a table where it is. Nothing is switched on, moved or stopped.
///
/// # Errors
/// If it doesn't say it.
pub fn look(plan: &Plan) -> Result<Status, Error> {
    let settings = Settings { watchdog: None, ..plan.settings };
    let port = open(&plan.port)?;
    Driver::on(port, &plan.port, plan.dialect.clone(), settings)?.status()
}

/// Takes a table over, moves it, waits until it rests and lets it go; where it is then. A panic or a signal
/// stops it on the way. `guard` is the program of the guard.
///
/// # Errors
/// If the table can't be had, may not or doesn't do it. It has been told to stop then.
pub fn move_by_hand(
    plan: &Plan,
    moves: &[Move],
    guard: &mut std::process::Command,
) -> Result<Status, Error> {
    // Refused before it is switched on.
    for one in moves {
        if let Move::Goto(axis, angle_rad, rate_radps) = *one {
            plan.settings.limits.angle(axis, angle_rad)?;
            plan.settings.limits.rate(axis, rate_radps.unwrap_or(0.0))?;
        }
    }
    let port = open(&plan.port)?;
    let mut driver = Driver::new(port, &plan.port, plan.dialect.clone(), plan.settings)?;
    on_panic();
    on_signals().map_err(|error| Error::Guard { reason: format!("signals: {error}") })?;
    let _button = Button::offer(&plan.port, driver.emergency())?;
    if let Some(silence) = plan.guard {
        driver.guard(guard, silence)?;
    }
    for one in moves {
        if let Move::Home(axis) = *one {
            driver.home(axis)?;
            let status = rest(&mut driver, &plan.port, plan.start, Driver::feed)?;
            if status.of(axis).homed == Some(false) {
                return Err(Error::NotHomed { axis });
            }
        }
    }
    let mut supervisor = Supervisor::new(driver, plan.period)?;
    for one in moves {
        if let Move::Goto(axis, angle_rad, rate_radps) = *one {
            supervisor.goto(axis, angle_rad, rate_radps)?;
            rest(&mut supervisor, &plan.port, plan.start, |table| table.emergency().check())?;
        }
    }
    let status = supervisor.status()?;
    supervisor.finish()?;
    Ok(status)
}
