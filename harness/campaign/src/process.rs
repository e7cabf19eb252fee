//! Processes that run cases: not reached by signals to this process's group, ended together with
//! this process, and limited in their running time.
//!
//! An interrupt is a state of the work and never the result of a case. A signal from a terminal or
//! a scheduler goes to a whole group, so each of these processes has a group of its own and this
//! process decides what ends. A process that was ended from outside is distinguished from one that
//! crashed.

use std::io;
use std::path::Path;
use std::process::{Child, Command, ExitStatus};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Number of attempts at a case whose process is ended from outside, before that is reported.
pub const TRIES: u32 = 3;
/// Option of the program that gives the id of the starting process.
const PARENT: &str = "--parent";
/// Interval at which a process is polled.
const LOOK: Duration = Duration::from_millis(5);
/// Longest interval between polls that counts in full: after a longer one, this process was
/// stopped, or the host had no time for it.
const LOOK_MAX: Duration = Duration::from_millis(100);
/// Total time for which a process may be stopped; after it the process is ended.
const STOPPED_MAX: Duration = Duration::from_secs(3600);

/// Ways in which a process ended.
#[derive(Debug)]
pub enum Ended {
    /// Ended by itself, or crashed.
    Status(ExitStatus),
    /// Ended by this process: it ran for longer than its limit.
    TooLong,
    /// Ended by this process on request.
    Cancelled,
    /// Ended from outside: names the signal, or the time for which it was stopped.
    Outside(String),
}

/// Builds the command of a process that isn't reached by signals to this group, and that ends with
/// this process.
///
/// The thread that starts it must wait for it: Linux ends it with that thread.
pub fn command(program: &Path) -> Command {
    let mut command = octant_base::child::command(program);
    command.arg(PARENT).arg(std::process::id().to_string());
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    command
}

/// Makes this process end together with the one that started it. If that one is gone already, this
/// process ends at once.
///
/// # Errors
/// If the operating system refuses.
pub fn end_with(parent: u32) -> io::Result<()> {
    #[cfg(target_os = "linux")]
    {
        use rustix::process::{Signal, set_parent_process_death_signal};
        set_parent_process_death_signal(Some(Signal::KILL))?;
        end_if_left(parent);
    }
    #[cfg(all(unix, not(target_os = "linux")))]
    {
        end_if_left(parent);
        let watch = move || {
            loop {
                std::thread::sleep(LOOK_MAX);
                end_if_left(parent);
            }
        };
        std::thread::Builder::new().name("parent".into()).spawn(watch)?;
    }
    #[cfg(not(unix))]
    let _ = parent;
    Ok(())
}

#[cfg(unix)]
/// Ends this process if its parent is gone.
pub fn end_if_left(parent: u32) {
    if std::os::unix::process::parent_id() != parent && !is_there(parent) {
        std::process::exit(i32::from(octant_requirements::Verdict::Error.exit_code()));
    }
}

/// Returns whether the process that started this one still exists, even if a wrapper of the program
/// is between the two.
#[cfg(target_os = "linux")]
pub fn is_there(parent: u32) -> bool {
    use rustix::process::{Pid, test_kill_process};
    let pid = i32::try_from(parent).ok().and_then(Pid::from_raw);
    pid.is_some_and(|pid| test_kill_process(pid) != Err(rustix::io::Errno::SRCH))
}

#[cfg(all(unix, not(target_os = "linux")))]
fn is_there(_: u32) -> bool {
    false
}

/// Waits for the end of a process, and ends it on request or when it ran for longer than `limit`.
/// Time in which either process is stopped doesn't count.
pub fn wait(child: &mut Child, limit: Duration, cancel: &AtomicBool) -> io::Result<Ended> {
    let (mut ran, mut stopped) = (Duration::ZERO, Duration::ZERO);
    let mut is_stopped = false;
    let mut before = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(outside(status).map_or(Ended::Status(status), Ended::Outside));
        }
        let now = Instant::now();
        let passed = now.duration_since(before).min(LOOK_MAX);
        before = now;
        is_stopped = stops(child, is_stopped);
        *(if is_stopped { &mut stopped } else { &mut ran }) += passed;
        let ended = if cancel.load(Ordering::Relaxed) {
            Ended::Cancelled
        } else if ran > limit {
            Ended::TooLong
        } else if stopped > STOPPED_MAX {
            Ended::Outside(format!("a stop of more than {} s", STOPPED_MAX.as_secs()))
        } else {
            std::thread::sleep(LOOK);
            continue;
        };
        // A process that has just ended by itself can't be killed.
        let _ = child.kill();
        child.wait()?;
        return Ok(ended);
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
    use rustix::process::{Pid, Signal, kill_process};

    fn started() -> (Child, Pid) {
        let child = Command::new("sleep").arg("1000").spawn().unwrap();
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
            assert!(matches!(ended, Ended::Cancelled), "{ended:?}");
        });
        let (mut child, pid) = started();
        kill_process(pid, Signal::STOP).unwrap();
        kill_process(pid, Signal::CONT).unwrap();
        let ended = wait(&mut child, limit, &AtomicBool::new(false)).unwrap();
        assert!(matches!(ended, Ended::TooLong), "{ended:?}");
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
        assert!(matches!(&ended, Ended::Outside(by) if by == "SIGKILL"), "{ended:?}");
        let (mut child, pid) = started();
        kill_process(pid, Signal::SEGV).unwrap();
        let ended = wait(&mut child, Duration::MAX, &never).unwrap();
        assert!(matches!(ended, Ended::Status(_)), "{ended:?}");
    }
}
