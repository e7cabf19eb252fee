//! Driver of a table with a command language.

use crate::dialect::{Command, Fields, Pattern, Values};
use crate::{
    AxisStatus, Dialect, EmergencyStop, Error, Guard, TableAxis, TableLimits, TablePort,
    TableStatus, Turntable,
};
use std::io;
use std::time::{Duration, Instant};

/// Longest line that is accepted.
const MAX_LINE_BYTES: usize = 4096;
/// Longest wait of one read, which bounds the delay in noticing a timeout.
const WAIT: Duration = Duration::from_millis(10);
/// Number of times that a query is sent if its reply is invalid.
const ASKED: u32 = 3;

/// Settings of a driver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriverSettings {
    /// Limits of angle and rate.
    pub limits: TableLimits,
    /// Longest wait for a reply.
    pub reply_within: Duration,
    /// Silence after which the controller's watchdog stops the table; `None`: the watchdog isn't used.
    pub watchdog: Option<Duration>,
}

/// Drives a table. On drop the table is stopped.
pub struct Driver<P: TablePort> {
    port: P,
    name: String,
    dialect: Dialect,
    settings: DriverSettings,
    stop: EmergencyStop,
    guard: Option<Guard>,
    /// Bytes of an incomplete reply.
    pending: Vec<u8>,
    /// True if a reply that nobody waits for may still arrive.
    stale: bool,
    /// True if it has taken the table over, and stops it on drop.
    drives: bool,
}

impl<P: TablePort> Driver<P> {
    /// Takes a table over: enables its drives, starts its watchdog, and asks for its status. `name` is
    /// the port's name in messages.
    ///
    /// # Errors
    /// If the limits are invalid, the language has no watchdog but one is requested, or the table
    /// doesn't answer.
    pub fn new(
        port: P,
        name: &str,
        dialect: Dialect,
        settings: DriverSettings,
    ) -> Result<Self, Error> {
        settings.limits.check()?;
        let lacking = settings.watchdog.is_some() && dialect.lines(Command::Feed).is_empty();
        if lacking {
            return Err(Error::Lacking { dialect: dialect.name, what: "watchdog" });
        }
        let mut driver = Self::on(port, name, dialect, settings)?;
        driver.drives = true;
        driver.command(Command::Begin, &Values::default())?;
        for axis in TableAxis::ALL {
            driver.command(Command::Enable, &Values { axis: Some(axis), ..Values::default() })?;
        }
        driver.feed()?;
        driver.status()?;
        Ok(driver)
    }

    /// Makes a driver for a port without sending anything. As long as it doesn't drive the table it
    /// only queries it.
    pub(crate) fn on(
        mut port: P,
        name: &str,
        dialect: Dialect,
        settings: DriverSettings,
    ) -> Result<Self, Error> {
        let gone = |reason| Error::Gone { port: name.to_owned(), reason };
        port.set_wait(WAIT).map_err(gone)?;
        let stop = EmergencyStop::new(port.writer().map_err(gone)?, dialect.emergency());
        Ok(Self {
            port,
            name: name.into(),
            dialect,
            settings,
            stop,
            guard: None,
            pending: Vec::new(),
            stale: true,
            drives: false,
        })
    }

    /// Starts a guard: a process that stops the table when this one dies or is silent for a time.
    /// `program` is one that calls [`crate::run_guard`].
    ///
    /// # Errors
    /// If the guard can't be started.
    #[cfg(unix)]
    pub fn guard(
        &mut self,
        program: &mut std::process::Command,
        silence: Duration,
    ) -> Result<(), Error> {
        let line = self.port.duplicate();
        let line = line.map_err(|reason| Error::Gone { port: self.name.clone(), reason })?;
        self.guard = Some(Guard::spawn(program, line, &self.dialect.emergency(), silence)?);
        Ok(())
    }

    /// Fails, because guards don't exist on this system: only the controller's watchdog remains.
    ///
    /// # Errors
    /// Always.
    #[cfg(not(unix))]
    pub fn guard(&mut self, _: &mut std::process::Command, _: Duration) -> Result<(), Error> {
        let reason =
            "a process can't be given a port on this system: use the controller's watchdog";
        Err(Error::Guard { reason: reason.into() })
    }

    /// Feeds the controller's watchdog and the guard. To be called at intervals shorter than their
    /// silence; [`crate::Supervisor`] does that.
    ///
    /// # Errors
    /// If the controller refuses it, or the guard is gone.
    pub fn feed(&mut self) -> Result<(), Error> {
        if let Some(guard) = &mut self.guard {
            guard.alive()?;
        }
        if let Some(silence) = self.settings.watchdog {
            let ms = u32::try_from(silence.as_millis()).unwrap_or(u32::MAX);
            self.command(Command::Feed, &Values { ms: Some(ms), ..Values::default() })?;
        }
        Ok(())
    }

    /// Brakes the table, waits until it rests, and ends watchdog and guard. The table stays where it
    /// is.
    ///
    /// # Errors
    /// If the table doesn't come to rest: by then every stop command was sent.
    pub fn finish(mut self) -> Result<(), Error> {
        self.stop()?;
        let limits = self.settings.limits;
        let longest = limits.axes.iter().map(|axis| axis.rate_radps / axis.acceleration_radps2);
        let until = Instant::now()
            + Duration::from_secs_f64(longest.fold(0.0, f64::max).min(3600.0))
            + self.settings.reply_within;
        loop {
            let status = self.status()?;
            if status.axes.iter().all(|axis| axis.moving != Some(true)) {
                break;
            }
            if Instant::now() > until {
                let why = "the table did not come to rest at the end".to_owned();
                self.stop.trip(&why);
                return Err(Error::Stopped { why });
            }
            self.feed()?;
            std::thread::sleep(WAIT);
        }
        if self.settings.watchdog.is_some() {
            self.command(Command::Feed, &Values { ms: Some(0), ..Values::default() })?;
        }
        if let Some(guard) = self.guard.take() {
            guard.release()?;
        }
        Ok(())
    }

    /// Sends the lines of a command, and checks that each was done.
    fn command(&mut self, command: Command, values: &Values) -> Result<(), Error> {
        let fields = self.dialect.write(values);
        for pattern in self.dialect.lines(command).to_vec() {
            let sent = self.filled(&pattern, &fields)?;
            match self.dialect.done.clone() {
                Some(done) => drop(self.exchange(&sent, &done)?),
                None => self.send(&sent)?,
            }
        }
        Ok(())
    }

    fn filled(&self, pattern: &Pattern, fields: &Fields) -> Result<String, Error> {
        pattern.write(fields).ok_or_else(|| Error::Dialect {
            place: self.dialect.name.clone(),
            what: format!("found a field in `{}` that its command doesn't have", pattern.text()),
        })
    }

    /// Sends a line and reads its reply.
    fn exchange(&mut self, sent: &str, expected: &Pattern) -> Result<Fields, Error> {
        self.send(sent)?;
        let reply = self.line(sent)?;
        if let Some(fields) = expected.read(&reply) {
            return Ok(fields);
        }
        if self.dialect.refused.iter().any(|refused| refused.read(&reply).is_some()) {
            return Err(Error::Refused { port: self.name.clone(), sent: sent.into(), reply });
        }
        self.stale = true;
        Err(self.nonsense(sent, reply, expected))
    }

    fn nonsense(&self, sent: &str, reply: String, expected: &Pattern) -> Error {
        let (port, expected) = (self.name.clone(), expected.text().to_owned());
        Error::Nonsense { port, sent: sent.into(), reply, expected }
    }

    fn send(&mut self, line: &str) -> Result<(), Error> {
        // Replies to an emergency stop were read by nobody.
        if self.stale || self.stop.is_tripped() {
            self.drain()?;
        }
        let bytes = format!("{line}{}", self.dialect.end);
        let written = self.port.write_all(bytes.as_bytes()).and_then(|()| self.port.flush());
        written.map_err(|reason| Error::Gone { port: self.name.clone(), reason })
    }

    /// Discards unexpected bytes, until nothing arrives for a moment.
    fn drain(&mut self) -> Result<(), Error> {
        self.pending.clear();
        let until = Instant::now() + self.settings.reply_within;
        while Instant::now() < until && self.receive()? > 0 {
            self.pending.clear();
        }
        self.pending.clear();
        self.stale = false;
        Ok(())
    }

    /// Receives bytes for at most [`WAIT`].
    fn receive(&mut self) -> Result<usize, Error> {
        let mut bytes = [0; 512];
        let gone = |reason| Error::Gone { port: self.name.clone(), reason };
        match self.port.read(&mut bytes) {
            Ok(0) => Err(gone(io::ErrorKind::UnexpectedEof.into())),
            Ok(count) => {
                self.pending.extend(&bytes[..count]);
                Ok(count)
            }
            Err(error) => match error.kind() {
                io::ErrorKind::TimedOut
                | io::ErrorKind::WouldBlock
                | io::ErrorKind::Interrupted => Ok(0),
                _ => Err(gone(error)),
            },
        }
    }

    /// Reads the next line.
    fn line(&mut self, sent: &str) -> Result<String, Error> {
        let until = Instant::now() + self.settings.reply_within;
        loop {
            let end = self.dialect.end.as_bytes();
            if let Some(at) = self.pending.windows(end.len()).position(|window| window == end) {
                let line = String::from_utf8_lossy(&self.pending[..at]).into_owned();
                self.pending.drain(..at + end.len());
                return Ok(line);
            }
            if self.pending.len() > MAX_LINE_BYTES {
                self.stale = true;
                let mut reply = String::from_utf8_lossy(&self.pending[..40]).into_owned();
                reply.push_str("… without an end of line");
                let any = Pattern::parse("{any}").unwrap_or_else(|_| unreachable!());
                return Err(self.nonsense(sent, reply, &any));
            }
            if Instant::now() > until {
                self.stale = true;
                let (port, within) = (self.name.clone(), self.settings.reply_within);
                return Err(Error::Silent { port, sent: sent.into(), within });
            }
            self.receive()?;
        }
    }

    /// Sends a query until its answer is valid.
    fn ask(
        &mut self,
        sent: &str,
        expected: &Pattern,
    ) -> Result<(Values, Instant, Duration), Error> {
        let mut asked = 1;
        loop {
            let before = Instant::now();
            let result = self.exchange(sent, expected).and_then(|fields| {
                self.dialect.read(&fields).ok_or_else(|| {
                    let reply = expected.write(&fields).unwrap_or_default();
                    self.nonsense(sent, reply, expected)
                })
            });
            match result {
                Err(Error::Nonsense { .. }) if asked < ASKED => {
                    self.stale = true;
                    asked += 1;
                }
                result => {
                    let half = before.elapsed() / 2;
                    return result.map(|values| (values, before + half, half));
                }
            }
        }
    }
}

impl<P: TablePort> Turntable for Driver<P> {
    fn goto(
        &mut self,
        axis: TableAxis,
        angle_rad: f64,
        rate_radps: Option<f64>,
    ) -> Result<(), Error> {
        self.stop.check()?;
        let limits = *self.settings.limits.of(axis);
        let rate = rate_radps.unwrap_or(limits.rate_radps);
        self.settings.limits.angle(axis, angle_rad)?;
        self.settings.limits.rate(axis, rate)?;
        if rate <= 0.0 {
            let (found, most) = (rate.to_degrees(), limits.rate_radps.to_degrees());
            return Err(Error::Rate { axis, found, most });
        }
        let values = Values {
            axis: Some(axis),
            angle_rad: Some(angle_rad),
            rate_radps: Some(rate),
            acceleration_radps2: Some(limits.acceleration_radps2),
            ..Values::default()
        };
        self.command(Command::Goto, &values)
    }

    fn rate(&mut self, axis: TableAxis, rate_radps: f64) -> Result<(), Error> {
        self.stop.check()?;
        self.settings.limits.rate(axis, rate_radps)?;
        if self.dialect.lines(Command::Rate).is_empty() {
            let dialect = self.dialect.name.clone();
            return Err(Error::Lacking { dialect, what: "command for a rate" });
        }
        let values = Values {
            axis: Some(axis),
            rate_radps: Some(rate_radps),
            acceleration_radps2: Some(self.settings.limits.of(axis).acceleration_radps2),
            ..Values::default()
        };
        self.command(Command::Rate, &values)
    }

    fn stop(&mut self) -> Result<(), Error> {
        let mut result = Ok(());
        for axis in TableAxis::ALL {
            let values = Values { axis: Some(axis), ..Values::default() };
            // The second axis is stopped whatever the result for the first one.
            result = result.and(self.command(Command::Stop, &values));
        }
        if let Err(error) = &result {
            self.stop.trip(&format!("the table did not obey the stop command: {error}"));
        }
        result
    }

    fn home(&mut self, axis: TableAxis) -> Result<(), Error> {
        self.stop.check()?;
        if self.dialect.lines(Command::Home).is_empty() {
            let dialect = self.dialect.name.clone();
            return Err(Error::Lacking { dialect, what: "command for homing" });
        }
        self.command(Command::Home, &Values { axis: Some(axis), ..Values::default() })
    }

    fn status(&mut self) -> Result<TableStatus, Error> {
        let mut status = TableStatus::default();
        for axis in TableAxis::ALL {
            let fields = self.dialect.write(&Values { axis: Some(axis), ..Values::default() });
            let mut found = AxisStatus::default();
            for question in self.dialect.status.clone() {
                let sent = self.filled(&question.send, &fields)?;
                let (values, at, within) = self.ask(&sent, &question.reply)?;
                if values.angle_rad.is_some() {
                    (found.at, found.at_within) = (Some(at), within);
                }
                let bit = |bit: Option<u32>| Some(values.bits?.checked_shr(bit?)? & 1 == 1);
                let bits = self.dialect.bits;
                found.angle_rad = values.angle_rad.unwrap_or(found.angle_rad);
                found.rate_radps = values.rate_radps.or(found.rate_radps);
                found.moving = values.moving.or(bit(bits.moving)).or(found.moving);
                found.homed = values.homed.or(bit(bits.homed)).or(found.homed);
                found.enabled = values.enabled.or(bit(bits.enabled)).or(found.enabled);
                found.fault = values.fault.or(found.fault);
            }
            status.axes[axis.index()] = found;
        }
        Ok(status)
    }

    fn limits(&self) -> &TableLimits {
        &self.settings.limits
    }

    fn emergency(&self) -> EmergencyStop {
        self.stop.clone()
    }
}

impl<P: TablePort> Drop for Driver<P> {
    fn drop(&mut self) {
        // After `finish` the table rests, and stopping it again does no harm.
        if self.drives {
            self.stop.trip("the driver of the table ended");
        }
    }
}
