//! Runs a command that starts processes of its own, and sends signals to any of them.

use super::program::program;
use octant_test_processes::{HANGS, Started, start};
use rustix::process::{Pid, Signal, kill_process, kill_process_group};
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Output, Stdio};
use std::time::{Duration, Instant};

/// Receiver of a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// The command.
    Parent,
    /// The command with its group, as signalled by a terminal.
    Group,
    /// One of the processes that the command started.
    Child,
}

/// Running command, in a group of its own.
pub struct Running {
    child: Started,
}

impl Running {
    /// Starts the program in a folder.
    pub fn start(folder: &Path, arguments: &[&str]) -> Self {
        let mut command = program(arguments);
        command.current_dir(folder).process_group(0);
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        Self { child: start(&mut command) }
    }

    /// Waits for processes of the command; empty if it has ended.
    pub fn children(&mut self) -> Vec<Pid> {
        let begun = Instant::now();
        loop {
            let found = children_of(self.child.id());
            if !found.is_empty() || self.child.try_wait().unwrap().is_some() {
                return found;
            }
            assert!(begun.elapsed() < HANGS, "it starts no process and doesn't end");
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// Sends a signal. A process that has ended gets none.
    pub fn signal(&self, target: Target, signal: Signal) {
        let this = Pid::from_raw(i32::try_from(self.child.id()).unwrap()).unwrap();
        let _ = match target {
            Target::Parent => kill_process(this, signal),
            Target::Group => kill_process_group(this, signal),
            Target::Child => match children_of(self.child.id()).first() {
                Some(child) => kill_process(*child, signal),
                None => Ok(()),
            },
        };
    }

    /// Returns whether the command has ended.
    pub fn has_ended(&mut self) -> bool {
        self.child.try_wait().unwrap().is_some()
    }

    /// Waits for the end of the command.
    pub fn end(mut self) -> Output {
        let begun = Instant::now();
        while !self.has_ended() {
            assert!(begun.elapsed() < HANGS, "it doesn't end");
            std::thread::sleep(Duration::from_millis(2));
        }
        self.child.output()
    }
}

/// Waits until these processes are gone.
pub fn gone(processes: &[Pid]) {
    let begun = Instant::now();
    while processes.iter().any(|pid| stat(pid.as_raw_nonzero().get()).is_some()) {
        assert!(begun.elapsed() < HANGS, "a process is left behind");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Returns the parent of a living process.
fn stat(pid: i32) -> Option<u32> {
    let text = std::fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    // The name is in parentheses, and may contain some.
    let mut words = text.rsplit_once(')')?.1.split_whitespace();
    let state = words.next()?;
    (!matches!(state, "Z" | "X")).then(|| words.next()?.parse().ok())?
}

fn children_of(parent: u32) -> Vec<Pid> {
    let entries = std::fs::read_dir("/proc").unwrap().flatten();
    let pids = entries.filter_map(|entry| entry.file_name().to_str()?.parse::<i32>().ok());
    pids.filter(|pid| stat(*pid) == Some(parent)).filter_map(Pid::from_raw).collect()
}
