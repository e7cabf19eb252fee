//! The child: how it is started, how long it may take, and how it ended.

use super::super::instance::call::{NOWHERE, function_name};
use super::super::instance::{InstanceError, Options};
use super::shared::{Shared, Word};
use rustix::process::{Pid, Signal, kill_process_group};
use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::PathBuf;
use std::process::{Child, ExitStatus, Stdio};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// While it waits for an answer, this process looks so often whether the child still lives: its end of
/// the socket may live on in a process that the FMU started.
pub(super) const LOOK: Duration = Duration::from_millis(100);

/// The process of an FMU.
pub(super) struct Watch {
    name: String,
    child: Child,
    ended: Option<InstanceError>,
}

impl Watch {
    /// Starts the program that holds the FMU.
    pub(super) fn start(
        name: &str,
        options: &Options,
        socket: UnixStream,
        memory: OwnedFd,
    ) -> Result<Self, InstanceError> {
        let cannot = |what: String| InstanceError::Process { fmu: name.into(), what };
        let program = match &options.program {
            Some(program) => program.clone(),
            None => octant().map_err(|e| cannot(format!("can't be started: {e}")))?,
        };
        let child = octant_base::child::command(&program)
            .args(["fmu", "host"])
            .stdin(Stdio::from(OwnedFd::from(socket)))
            .stdout(Stdio::from(memory))
            .stderr(Stdio::inherit())
            // Ctrl-C on the terminal is for this process, which ends the run in order.
            .process_group(0)
            .spawn()
            .map_err(|e| cannot(format!("can't be started: {}: {e}", program.display())))?;
        Ok(Self { name: name.into(), child, ended: None })
    }

    /// Why it is gone, if it is.
    pub(super) fn gone(&self) -> Result<(), InstanceError> {
        self.ended.clone().map_or(Ok(()), Err)
    }

    /// The end of the child, if it came by itself.
    pub(super) fn look(&mut self, shared: &Shared) -> Option<InstanceError> {
        if self.ended.is_none()
            && let Ok(Some(status)) = self.child.try_wait()
        {
            self.ended = Some(self.end(&describe(status), shared));
        }
        self.ended.clone()
    }

    /// The child closed its end or speaks another language: it is on its way out, or is helped.
    pub(super) fn lost(&mut self, shared: &Shared, why: &io::Error) -> InstanceError {
        let until = Instant::now() + Duration::from_secs(2);
        while Instant::now() < until {
            if let Some(error) = self.look(shared) {
                return error;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        self.kill();
        let error = self.end(&format!("stopped talking ({why})"), shared);
        self.ended = Some(error.clone());
        error
    }

    /// The child took too long.
    pub(super) fn hangs(
        &mut self,
        shared: &Shared,
        request: &str,
        limit: Duration,
    ) -> InstanceError {
        if let Some(error) = self.look(shared) {
            return error;
        }
        let what = function(shared).unwrap_or(request);
        let error = InstanceError::Process {
            fmu: self.name.clone(),
            what: format!("gave no answer to {what} for {} s, and was ended", limit.as_secs_f64()),
        };
        self.kill();
        self.ended = Some(error.clone());
        error
    }

    /// Waits for the end that it was asked for; else makes it.
    pub(super) fn finish(&mut self, limit: Duration) {
        let until = Instant::now() + limit;
        let mut pause = Duration::from_micros(50);
        while self.ended.is_none() && Instant::now() < until {
            if !matches!(self.child.try_wait(), Ok(None)) {
                return;
            }
            std::thread::sleep(pause);
            pause = (2 * pause).min(Duration::from_millis(20));
        }
        if self.ended.is_none() {
            self.kill();
        }
    }

    /// Ends it and what it started.
    fn kill(&mut self) {
        if let Ok(pid) = i32::try_from(self.child.id())
            && let Some(group) = Pid::from_raw(pid)
        {
            // It is a child that wasn't waited for: nobody else has its number.
            let _ = kill_process_group(group, Signal::KILL);
        }
        let _ = self.child.wait();
    }

    fn end(&self, how: &str, shared: &Shared) -> InstanceError {
        let place = function(shared).map_or(String::new(), |function| format!(" in {function}"));
        InstanceError::Process { fmu: self.name.clone(), what: format!("{how}{place}") }
    }
}

/// This program, or, where the library is used by another, the `octant` beside it: in its folder, or
/// in the one above, where Cargo puts it for tests.
fn octant() -> io::Result<PathBuf> {
    let program = std::env::current_exe()?;
    if program.file_name().is_some_and(|name| name == "octant") {
        return Ok(program);
    }
    let folders = program.ancestors().skip(1).take(2);
    let mut places = folders.map(|folder| folder.join("octant"));
    places
        .find(|place| place.is_file())
        .ok_or_else(|| io::Error::other(format!("there is no octant beside {}", program.display())))
}

/// The function in which it is, or was when it ended.
fn function(shared: &Shared) -> Option<&'static str> {
    let number = u32::try_from(shared.word(Word::Function).load(Ordering::Relaxed)).ok()?;
    (number != NOWHERE).then(|| function_name(number)).flatten()
}

/// How a process ended.
fn describe(status: ExitStatus) -> String {
    let Some(signal) = status.signal() else {
        let code = status.code().unwrap_or(-1);
        return format!("ended by itself with exit status {code}");
    };
    let name = match Signal::from_named_raw(signal) {
        Some(Signal::SEGV) => "SIGSEGV",
        Some(Signal::ABORT) => "SIGABRT",
        Some(Signal::BUS) => "SIGBUS",
        Some(Signal::FPE) => "SIGFPE",
        Some(Signal::ILL) => "SIGILL",
        Some(Signal::KILL) => "SIGKILL",
        Some(Signal::TERM) => "SIGTERM",
        Some(Signal::TRAP) => "SIGTRAP",
        Some(Signal::SYS) => "SIGSYS",
        Some(Signal::XCPU) => "SIGXCPU",
        Some(Signal::ALARM) => "SIGALRM",
        Some(Signal::PIPE) => "SIGPIPE",
        _ => return format!("was ended by signal {signal}"),
    };
    format!("was ended by {name}")
}
