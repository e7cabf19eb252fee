//! Status and moves of a table by hand.

use crate::following::rest;
use crate::{
    Button, Driver, DriverSettings, Error, Supervisor, TableAxis, TableHost, TablePlan,
    TableStatus, Turntable, on_panic, on_signals, open,
};

/// Move by hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Move {
    /// Homing of an axis.
    Home(TableAxis),
    /// Turn of an axis to an angle, rad, with at most a rate, rad/s.
    Goto(TableAxis, f64, Option<f64>),
}

/// Asks a table for its status. Nothing is switched on, moved or stopped.
///
/// # Errors
/// If the table doesn't answer.
pub fn look(plan: &TablePlan) -> Result<TableStatus, Error> {
    let settings = DriverSettings { watchdog: None, ..plan.settings };
    let port = open(&plan.port)?;
    Driver::on(port, &plan.port, plan.dialect.clone(), settings)?.status()
}

/// Takes a table over, moves it, waits until it rests and releases it; returns its status then. A panic
/// or a signal stops the table. `guard` is the program of the guard.
///
/// # Errors
/// If the table can't be taken over, a move is beyond the limits, or the table doesn't do it. By then
/// every stop command was sent.
pub fn move_by_hand(
    plan: &TablePlan,
    moves: &[Move],
    guard: &mut std::process::Command,
) -> Result<TableStatus, Error> {
    // Moves beyond the limits are refused before the table is switched on.
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
    let _button = Button::offer(&plan.port, driver.emergency(), TableHost::new(1))?;
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
