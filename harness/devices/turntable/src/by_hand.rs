//! Status, moves and the stop of a table by hand.

use crate::following::rest;
use crate::stop::{PAUSE, TIMES};
use crate::{
    Button, Dialect, Driver, DriverSettings, Error, Supervisor, TableAxis, TableHost, TablePlan,
    TablePort, TableStatus, Turntable, on_panic, on_signals, open, press,
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

/// Stops a table by hand, whichever program drives it: through a driving program of this host, and on
/// the port itself if that can be opened. Returns the ways that worked.
///
/// # Errors
/// If none worked, with the reason.
pub fn stop_by_hand(name: &str, dialect: &Dialect) -> Result<Vec<String>, Error> {
    let mut stopped = Vec::new();
    let mut failure = None;
    match press(Some(name)) {
        Ok(pressed) => {
            stopped.extend(
                pressed
                    .iter()
                    .filter(|pressed| pressed.written)
                    .map(|pressed| format!("the program that drives {}", pressed.port)),
            );
        }
        Err(error) => failure = Some(error),
    }
    // Both ways are used: stopping a table twice does no harm.
    match open(name).and_then(|port| stop_line(port, name, dialect)) {
        Ok(()) => stopped.push("its own port, without waiting for an answer".to_owned()),
        Err(error) => failure = failure.or(Some(error)),
    }
    match failure {
        Some(error) if stopped.is_empty() => Err(error),
        _ => Ok(stopped),
    }
}

/// Stops a table on a port that no program drives, by hand. Its replies are not waited for.
///
/// # Errors
/// If the port doesn't accept the bytes.
pub fn stop_line(mut port: impl TablePort, name: &str, dialect: &Dialect) -> Result<(), Error> {
    let gone = |reason| Error::Gone { port: name.to_owned(), reason };
    for time in 0..TIMES {
        if time > 0 {
            std::thread::sleep(PAUSE);
        }
        port.write_all(&dialect.emergency()).and_then(|()| port.flush()).map_err(gone)?;
    }
    // The bytes must be on their way before the port is closed.
    std::thread::sleep(10 * PAUSE);
    Ok(())
}
