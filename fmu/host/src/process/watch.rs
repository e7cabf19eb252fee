//! The child process: its start, its time limit, and its end.

use super::super::instance::call::{NOWHERE, function_name};
use super::super::instance::{InstanceError, OpenOptions};
use super::patience::Patience;
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

/// Interval at which this process, while it waits for an answer, checks that the child still lives:
/// the child's end of the socket may stay open in a process that the FMU started.
pub(super) const LOOK: Duration = Duration::from_millis(100);

/// Longest time for which the guard may take to end all processes, before it is killed itself.
const GUARD_MAX: Duration = Duration::from_secs(10);

/// Process of an FMU.
pub(super) struct Watch {
    name: String,
    /// The guard of the FMU's process.
    child: Child,
    /// This end of the socket: the guard ends everything when it is closed.
    line: UnixStream,
    ended: Option<InstanceError>,
}

impl Watch {
    /// Starts the program that hosts the FMU.
    pub(super) fn start(
        name: &str,
        options: &OpenOptions,
        (line, theirs): (UnixStream, UnixStream),
        memory: OwnedFd,
    ) -> Result<Self, InstanceError> {
        let cannot = |what: String| InstanceError::Process { fmu: name.into(), what };
        let program = match &options.program {
            Some(program) => program.clone(),
            None => octant().map_err(|e| cannot(format!("can't be started: {e}")))?,
        };
        let child = octant_base::child::foreign(&program)
            .args(["fmu", "host", "--name", name])
            .stdin(Stdio::from(OwnedFd::from(theirs)))
            .stdout(Stdio::from(memory))
            .stderr(Stdio::inherit())
            // Ctrl-C on the terminal is for this process only, which ends the run in order.
            .process_group(0)
            .spawn()
            .map_err(|e| cannot(format!("can't be started: {}: {e}", program.display())))?;
        Ok(Self { name: name.into(), child, line, ended: None })
    }

    /// Returns the reason why the child has ended, if it has.
    pub(super) fn gone(&self) -> Result<(), InstanceError> {
        self.ended.clone().map_or(Ok(()), Err)
    }

    /// Checks whether the child has ended by itself.
    pub(super) fn look(&mut self, shared: &Shared) -> Option<InstanceError> {
        if self.ended.is_none()
            && let Ok(Some(status)) = self.child.try_wait()
        {
            self.ended = Some(self.end(&describe(fmu_status(status, shared)), shared));
        }
        self.ended.clone()
    }

    /// Ends a child that closed its end or sent an invalid answer; it has 2 s to end by itself.
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

    /// Handles a child that exceeded the time limit.
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
            what: format!(
                "gave no answer to {what} for {} s, and was ended; --time-limit, or time_limit in a scenario, sets \
                 another limit",
                limit.as_secs_f64()
            ),
        };
        self.kill();
        self.ended = Some(error.clone());
        error
    }

    /// Waits for the end that was requested, after the FMU was freed.
    ///
    /// # Errors
    /// If the FMU's process crashes or hangs at its end, where destructors may run.
    pub(super) fn end_of_child(
        &mut self,
        shared: &Shared,
        limit: Duration,
    ) -> Result<(), InstanceError> {
        let mut patience = Patience::new(limit);
        let mut pause = Duration::from_micros(50);
        loop {
            match self.child.try_wait() {
                Ok(Some(status)) => {
                    let status = fmu_status(status, shared);
                    if !status.success() {
                        let error = self.end(&describe(status), shared);
                        self.ended = Some(error.clone());
                        return Err(error);
                    }
                    self.ended = Some(InstanceError::Order {
                        fmu: self.name.clone(),
                        what: "a call".into(),
                        when: "after it was freed".into(),
                    });
                    return Ok(());
                }
                _ if patience.is_over(shared) => return Err(self.hangs(shared, "the end", limit)),
                _ => std::thread::sleep(pause),
            }
            pause = (2 * pause).min(Duration::from_millis(20));
        }
    }

    /// Waits for the end that was requested; otherwise kills the child.
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

    /// Ends the child and the processes that it started: the guard does so when the line is closed.
    fn kill(&mut self) {
        let _ = self.line.shutdown(std::net::Shutdown::Both);
        let until = Instant::now() + GUARD_MAX;
        while Instant::now() < until {
            if !matches!(self.child.try_wait(), Ok(None)) {
                return;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        if let Ok(pid) = i32::try_from(self.child.id())
            && let Some(group) = Pid::from_raw(pid)
        {
            // The child hasn't been waited for, so that its number isn't used by another process.
            let _ = kill_process_group(group, Signal::KILL);
        }
        let _ = self.child.wait();
    }

    fn end(&self, how: &str, shared: &Shared) -> InstanceError {
        let place = function(shared).map_or(String::new(), |function| format!(" in {function}"));
        InstanceError::Process { fmu: self.name.clone(), what: format!("{how}{place}") }
    }
}

/// Finds the program: this one, or, if the library is used by another program, the `octant` beside
/// it: in its folder, or in the one above, where Cargo puts it for tests.
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

/// Function in which the child is, or was when it ended.
fn function(shared: &Shared) -> Option<&'static str> {
    let number = u32::try_from(shared.word(Word::Function).load(Ordering::Relaxed)).ok()?;
    (number != NOWHERE).then(|| function_name(number)).flatten()
}

/// Status of the FMU's process, or that of its guard if that was ended itself.
fn fmu_status(guard: ExitStatus, shared: &Shared) -> ExitStatus {
    super::guard::status(shared).unwrap_or(guard)
}

/// Describes the end of a process.
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
