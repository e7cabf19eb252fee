//! Processes with a time limit.
//!
//! A process that was ended from outside is distinguished from one that crashed.

use std::io::{self, Read, Write};
use std::process::{Child, ExitStatus};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Interval at which a process is polled.
pub(super) const LOOK: Duration = Duration::from_millis(5);
/// Longest interval between polls that counts in full: after a longer one, this process was
/// stopped, or the host had no time for it.
const LOOK_MAX: Duration = Duration::from_millis(100);
/// Total time for which a process may be stopped; after it the process is ended.
const STOPPED_MAX: Duration = Duration::from_secs(3600);

/// Ways in which a process ended.
#[derive(Debug)]
pub enum ChildEnded {
    /// Ended by itself, or crashed.
    Status(ExitStatus),
    /// Ended by this process: it ran for longer than its limit.
    TooLong,
    /// Ended by this process on request.
    Cancelled,
    /// Ended from outside: names the signal, or the time for which it was stopped.
    Outside(String),
}

/// End of a process, and what it wrote to its pipes.
#[derive(Debug)]
pub struct ChildOutcome {
    /// Way in which it ended.
    pub ended: ChildEnded,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

/// Writes the input of a process, keeps at most `most` bytes of each output, and waits for its end;
/// ends it on request or when it ran for longer than `limit`. Time in which either process is
/// stopped doesn't count.
///
/// # Errors
/// If the operating system can't wait for it.
pub fn finish(
    mut child: Child,
    input: &[u8],
    most: u64,
    limit: Duration,
    cancel: &AtomicBool,
) -> io::Result<ChildOutcome> {
    let (stdin, out, err) = (child.stdin.take(), child.stdout.take(), child.stderr.take());
    // The pipes are served at the same time: a full one would block the process, or this one if the
    // process doesn't read its input.
    std::thread::scope(|scope| {
        let out = scope.spawn(|| all(out, most));
        let err = scope.spawn(|| all(err, most));
        if let Some(mut stdin) = stdin {
            // If the process has ended already, its status tells.
            scope.spawn(move || stdin.write_all(input));
        }
        let ended = wait(&mut child, limit, cancel)?;
        let (out, err) = (out.join().unwrap_or_default(), err.join().unwrap_or_default());
        Ok(ChildOutcome { ended, out, err })
    })
}

/// Reads a pipe to its end, and keeps the first bytes.
fn all(pipe: Option<impl Read>, most: u64) -> String {
    let mut bytes = Vec::new();
    if let Some(mut pipe) = pipe {
        // Output that can't be read counts as absent.
        let _ = pipe.by_ref().take(most).read_to_end(&mut bytes);
        let _ = io::copy(&mut pipe, &mut io::sink());
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Waits for the end of a process as [`finish`].
fn wait(child: &mut Child, limit: Duration, cancel: &AtomicBool) -> io::Result<ChildEnded> {
    let mut clock = RunClock::start();
    loop {
        if let Some(ended) = clock.look(child, limit, cancel)? {
            return Ok(ended);
        }
        std::thread::sleep(LOOK);
    }
}

/// Time for which a process ran and was stopped, from its polls.
#[derive(Debug)]
pub(super) struct RunClock {
    ran: Duration,
    stopped: Duration,
    is_stopped: bool,
    before: Instant,
}

impl RunClock {
    pub(super) fn start() -> Self {
        let (ran, stopped) = (Duration::ZERO, Duration::ZERO);
        Self { ran, stopped, is_stopped: false, before: Instant::now() }
    }

    /// Polls a process: `None` while it runs. Ends it on request, or when it ran for longer than `limit`.
    pub(super) fn look(
        &mut self,
        child: &mut Child,
        limit: Duration,
        cancel: &AtomicBool,
    ) -> io::Result<Option<ChildEnded>> {
        if let Some(status) = child.try_wait()? {
            let outside = outside(status);
            return Ok(Some(outside.map_or(ChildEnded::Status(status), ChildEnded::Outside)));
        }
        let now = Instant::now();
        let passed = now.duration_since(self.before).min(LOOK_MAX);
        self.before = now;
        self.is_stopped = stops(child, self.is_stopped);
        *(if self.is_stopped { &mut self.stopped } else { &mut self.ran }) += passed;
        let ended = if cancel.load(Ordering::Relaxed) {
            ChildEnded::Cancelled
        } else if self.ran > limit {
            ChildEnded::TooLong
        } else if self.stopped > STOPPED_MAX {
            ChildEnded::Outside(format!("a stop of more than {} s", STOPPED_MAX.as_secs()))
        } else {
            return Ok(None);
        };
        // A process that has just ended by itself can't be killed.
        let _ = child.kill();
        child.wait()?;
        Ok(Some(ended))
    }
}

/// Returns whether a process is stopped now.
#[cfg(target_os = "linux")]
fn stops(child: &Child, before: bool) -> bool {
    use rustix::process::{Pid, WaitId, WaitIdOptions, waitid};
    let Some(pid) = i32::try_from(child.id()).ok().and_then(Pid::from_raw) else { return before };
    // The end isn't queried here, because `try_wait` needs it.
    let of = WaitIdOptions::STOPPED | WaitIdOptions::CONTINUED | WaitIdOptions::NOHANG;
    match waitid(WaitId::Pid(pid), of) {
        Ok(Some(status)) => status.stopped(),
        _ => before,
    }
}

#[cfg(not(target_os = "linux"))]
fn stops(_: &Child, _: bool) -> bool {
    false
}

/// Returns the signal by which a process was ended from outside. Crashes have other signals.
#[cfg(unix)]
fn outside(status: ExitStatus) -> Option<String> {
    // Signal numbers of POSIX.
    let name = match std::os::unix::process::ExitStatusExt::signal(&status)? {
        1 => "SIGHUP",
        2 => "SIGINT",
        9 => "SIGKILL",
        15 => "SIGTERM",
        _ => return None,
    };
    Some(name.to_owned())
}

#[cfg(not(unix))]
fn outside(_: ExitStatus) -> Option<String> {
    None
}

#[cfg(test)]
#[cfg(target_os = "linux")]
mod tests {
    use super::*;
    use octant_test_processes::{Started, command, start};
    use rustix::process::{Pid, Signal, kill_process};
    use std::process::Stdio;

    fn started() -> (Started, Pid) {
        let child = start(command("sleep").arg("1000"));
        let pid = Pid::from_raw(i32::try_from(child.id()).unwrap()).unwrap();
        (child, pid)
    }

    #[test]
    fn time_in_which_it_is_stopped_does_not_count() {
        let (mut child, pid) = started();
        kill_process(pid, Signal::STOP).unwrap();
        let (cancel, limit) = (AtomicBool::new(false), Duration::from_millis(500));
        std::thread::scope(|scope| {
            scope.spawn(|| {
                std::thread::sleep(3 * limit);
                cancel.store(true, Ordering::Relaxed);
            });
            let ended = wait(&mut child, limit, &cancel).unwrap();
            assert!(matches!(ended, ChildEnded::Cancelled), "{ended:?}");
        });
        let (mut child, pid) = started();
        kill_process(pid, Signal::STOP).unwrap();
        kill_process(pid, Signal::CONT).unwrap();
        let ended = wait(&mut child, limit, &AtomicBool::new(false)).unwrap();
        assert!(matches!(ended, ChildEnded::TooLong), "{ended:?}");
    }

    #[test]
    fn input_that_is_not_read_does_not_outlast_the_limit() {
        let child = start(command("sleep").arg("1000").stdin(Stdio::piped())).release();
        // More than a pipe holds.
        let input = vec![0; 1 << 20];
        let never = AtomicBool::new(false);
        let outcome = finish(child, &input, 0, Duration::from_millis(100), &never).unwrap();
        assert!(matches!(outcome.ended, ChildEnded::TooLong), "{outcome:?}");
    }

    #[test]
    fn who_ended_it_is_told_apart() {
        use std::os::unix::process::ExitStatusExt;
        for (signal, expected) in [
            (Signal::HUP, Some("SIGHUP")),
            (Signal::INT, Some("SIGINT")),
            (Signal::TERM, Some("SIGTERM")),
            (Signal::KILL, Some("SIGKILL")),
            (Signal::SEGV, None),
            (Signal::ABORT, None),
            (Signal::FPE, None),
        ] {
            let status = ExitStatus::from_raw(signal.as_raw());
            assert_eq!(outside(status).as_deref(), expected);
        }
        assert_eq!(outside(ExitStatus::from_raw(0)), None);
        // Other signals may be ignored, if the program that started the tests set that.
        let never = AtomicBool::new(false);
        let (mut child, pid) = started();
        kill_process(pid, Signal::KILL).unwrap();
        let ended = wait(&mut child, Duration::MAX, &never).unwrap();
        assert!(matches!(&ended, ChildEnded::Outside(by) if by == "SIGKILL"), "{ended:?}");
        let (mut child, pid) = started();
        kill_process(pid, Signal::SEGV).unwrap();
        let ended = wait(&mut child, Duration::MAX, &never).unwrap();
        assert!(matches!(ended, ChildEnded::Status(_)), "{ended:?}");
    }
}
