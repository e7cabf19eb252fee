//! Dialogue with an instrument that speaks SCPI.
//!
//! After each command and each query the error queue is read to its end, so an error is that of the line before it.

use crate::PowerError;
use crate::line::Line;
use std::time::Duration;

/// Most errors that are read from a queue: one that is longer never ends.
const ERRORS_MAX: usize = 32;
/// From here on a number stands for none or for infinity: 9.9E37 and 9.91E37 (SCPI-1999, volume 1, 7.2.1).
const NO_NUMBER: f64 = 9.9e37;
/// Query of the error queue.
const NEXT_ERROR: &str = "SYST:ERR?";

/// Dialogue with an instrument.
#[derive(Debug)]
pub struct ScpiDialogue {
    line: Line,
    identity: String,
}

impl ScpiDialogue {
    /// Opens the port of an instrument, takes it into remote control with `SYST:REM` if `remote` says so, clears its errors and
    /// asks who it is. Nothing is switched.
    ///
    /// # Errors
    /// If the port can't be opened, or no instrument answers.
    pub fn open(port: &str, reply: Duration, remote: bool) -> Result<Self, PowerError> {
        let mut line = Line::open(port, reply)?;
        // The end of a line that another program cut off.
        line.send("")?;
        if remote {
            line.send("SYST:REM")?;
        }
        line.send("*CLS")?;
        line.forget()?;
        let mut dialogue = Self { line, identity: String::new() };
        dialogue.identity = dialogue.query("*IDN?")?;
        Ok(dialogue)
    }

    /// Port of the instrument.
    #[must_use]
    pub fn port(&self) -> &str {
        self.line.name()
    }

    /// Reply to `*IDN?`: maker, model, serial number and firmware.
    #[must_use]
    pub fn identity(&self) -> &str {
        &self.identity
    }

    pub(crate) fn line(&self) -> &Line {
        &self.line
    }

    /// Sends a command.
    ///
    /// # Errors
    /// If the instrument reports an error, with its words, or doesn't answer.
    pub fn command(&mut self, command: &str) -> Result<(), PowerError> {
        self.line.forget()?;
        self.line.send(command)?;
        self.errors(command)
    }

    /// Asks a question and returns the reply.
    ///
    /// # Errors
    /// If no reply comes in time, or the instrument reports an error.
    pub fn query(&mut self, query: &str) -> Result<String, PowerError> {
        self.line.forget()?;
        let reply = self.ask(query)?;
        match reply {
            Some(reply) => self.errors(query).map(|()| reply),
            // A query that isn't understood has no reply, and the queue tells why.
            None => {
                self.errors(query)?;
                Err(self.silent(query))
            }
        }
    }

    /// Asks for a number.
    ///
    /// # Errors
    /// As [`Self::query`], and if the reply is no finite number.
    pub fn number(&mut self, query: &str) -> Result<f64, PowerError> {
        let reply = self.query(query)?;
        let number = reply.parse().ok().filter(|number: &f64| number.abs() < NO_NUMBER);
        number.ok_or_else(|| self.nonsense(query, reply, "a finite number"))
    }

    /// Asks for a state. The standard has 1 and 0; some instruments reply ON and OFF.
    ///
    /// # Errors
    /// As [`Self::query`], and if the reply is neither.
    pub fn state(&mut self, query: &str) -> Result<bool, PowerError> {
        let reply = self.query(query)?;
        match reply.to_ascii_uppercase().as_str() {
            "1" | "+1" | "ON" => Ok(true),
            "0" | "+0" | "OFF" => Ok(false),
            _ => Err(self.nonsense(query, reply, "1, 0, ON or OFF")),
        }
    }

    fn ask(&mut self, query: &str) -> Result<Option<String>, PowerError> {
        self.line.send(query)?;
        self.line.receive()
    }

    fn silent(&self, sent: &str) -> PowerError {
        PowerError::Silent {
            port: self.line.name().to_owned(),
            sent: sent.to_owned(),
            within: self.line.wait(),
        }
    }

    fn nonsense(&self, sent: &str, reply: String, expected: &'static str) -> PowerError {
        let (port, sent) = (self.line.name().to_owned(), sent.to_owned());
        PowerError::Nonsense { port, sent, reply, expected }
    }

    /// Reads the error queue to its end.
    fn errors(&mut self, sent: &str) -> Result<(), PowerError> {
        let mut words: Vec<String> = Vec::new();
        for _ in 0..ERRORS_MAX {
            let Some(reply) = self.ask(NEXT_ERROR)? else {
                return Err(self.silent(&format!("{sent}` and `{NEXT_ERROR}")));
            };
            let number = reply.split(',').next().unwrap_or_default().trim();
            match number.parse::<i32>() {
                Ok(0) if words.is_empty() => return Ok(()),
                Ok(0) => break,
                Ok(_) => words.push(reply),
                Err(_) => return Err(self.nonsense(NEXT_ERROR, reply, "NUMBER,\"TEXT\"")),
            }
        }
        let (port, sent) = (self.line.name().to_owned(), sent.to_owned());
        Err(PowerError::Refused { port, sent, words: words.join("; ") })
    }
}
