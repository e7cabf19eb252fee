//! Processes that run cases: not reached by signals to this process's group, and ended together with
//! this process.
//!
//! An interrupt is a state of the work and never the result of a case. A signal from a terminal or
//! a scheduler goes to a whole group, so each of these processes has a group of its own and this
//! process decides what ends.

use std::path::Path;
use std::process::Command;

/// Number of attempts at a case whose process is ended from outside, before that is reported.
pub const TRIES: u32 = 3;
/// Option of the program that gives the id of the starting process.
const PARENT: &str = "--parent";

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

/// Limits the memory of this process: when it needs more it ends, and leaves other cases undisturbed.
///
/// # Errors
/// If the operating system refuses.
pub fn limit_memory(mib: u64) -> std::io::Result<()> {
    #[cfg(target_os = "linux")]
    {
        use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
        let bytes = Some(mib.saturating_mul(1 << 20));
        let most = getrlimit(Resource::As).maximum;
        let limit = Rlimit { current: bytes.min(most.or(bytes)), maximum: most };
        setrlimit(Resource::As, limit)?;
    }
    #[cfg(not(target_os = "linux"))]
    let _ = mib;
    Ok(())
}

/// Makes this process end together with the one that started it. If that one is gone already, this
/// process ends at once.
///
/// # Errors
/// If the operating system refuses.
pub fn end_with(parent: u32) -> std::io::Result<()> {
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
                std::thread::sleep(std::time::Duration::from_millis(100));
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
        std::process::exit(i32::from(octant_verdict::Verdict::Error.exit_code()));
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
