//! The process between this program and that of the FMU: it ends every process that the FMU has
//! started, however the FMU ends, and limits the FMU's output.
//!
//! A process that the FMU starts may leave its group and outlive its parent; then the guard becomes
//! its parent, because it is a subreaper. The guard runs no code of the FMU, so that no crash ends
//! it. Requests and answers don't go through it: the FMU's process has the same socket and memory.

use super::shared::{Shared, Word};
use octant_base::child::{ForeignLines, OutputLimit};
use octant_base::printable::printable;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::process::{Pid, PidfdFlags, Signal, WaitOptions};
use std::io::{self, PipeReader, Read, Write};
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Bytes of the FMU's output, standard and error together, that are passed on.
pub const OUTPUT_BYTES_MAX: u64 = 1 << 20;

/// Mark of a status that is known, beside its bits.
const KNOWN: u64 = 1 << 32;

/// Interval at which the process of the FMU is looked at where its end can't be waited for.
const LOOK: Timespec = Timespec { tv_sec: 0, tv_nsec: 20_000_000 };

/// Longest time for ending the processes that the FMU has started.
const END_MAX: Duration = Duration::from_secs(5);

/// Starts the process of an FMU, and waits for its end. `name` is the FMU's name in messages.
///
/// # Errors
/// If no process that serves an FMU started this one, or the FMU's can't be started.
pub fn guard(name: &str) -> Result<(), FmuServeError> {
    let connect = || -> io::Result<(OwnedFd, Shared)> {
        let socket = rustix::io::fcntl_dupfd_cloexec(io::stdin(), 3)?;
        rustix::net::sockopt::socket_type(&socket)?;
        Ok((socket, Shared::open(io::stdout())?))
    };
    let (socket, shared) = connect().map_err(|error| FmuServeError::NotStarted { error })?;
    let watch = |error: io::Error| FmuServeError::Watch { error };
    rustix::process::set_child_subreaper(Some(rustix::process::getpid()))
        .map_err(|error| watch(error.into()))?;
    let (output, theirs) = io::pipe().map_err(watch)?;
    let program = std::env::current_exe().map_err(watch)?;
    let mut fmu = octant_base::child::foreign(program)
        .args(["fmu", "host", "--unguarded"])
        .stderr(theirs)
        .process_group(0)
        .spawn()
        .map_err(watch)?;
    let release = || -> io::Result<()> {
        // The socket is closed for the other process when the FMU's is closed and this one ends.
        let empty = std::fs::File::options().read(true).write(true).open("/dev/null")?;
        rustix::stdio::dup2_stdin(&empty)?;
        Ok(rustix::stdio::dup2_stdout(&empty)?)
    };
    release().map_err(watch)?;
    let limit = OutputLimit { bytes: OUTPUT_BYTES_MAX, bytes_per_s: 0 };
    let lines = ForeignLines::new(name, limit, io::stderr());
    let mut passed = Output { name, pipe: output, lines, open: true };
    let own = Pid::from_child(&fmu);
    let watched = wait(&socket, own, &mut passed);
    // The FMU's process hasn't been waited for, so that no other process has its number. A process
    // that is gone already can't be killed.
    let _ = rustix::process::kill_process_group(own, Signal::KILL);
    let status = fmu.wait();
    end_children();
    passed.rest();
    if let Ok(status) = status {
        let bits = u64::from(status.into_raw().cast_unsigned());
        shared.word(Word::Status).store(KNOWN | bits, Ordering::Release);
    }
    watched.map_err(watch)
}

/// Status with which the process of the FMU ended, if the guard has told it.
pub(super) fn status(shared: &Shared) -> Option<std::process::ExitStatus> {
    let bits = shared.word(Word::Status).load(Ordering::Acquire);
    let raw = (bits as u32).cast_signed();
    (bits & KNOWN != 0).then(|| std::process::ExitStatus::from_raw(raw))
}

/// Passes on the output until the process of the FMU ends, or the one that it serves.
fn wait(socket: &OwnedFd, fmu: Pid, output: &mut Output<'_>) -> io::Result<()> {
    let ended = rustix::process::pidfd_open(fmu, PidfdFlags::empty()).ok();
    loop {
        // No event of the socket is requested: the only one reported is that its other end is
        // closed.
        let mut events = vec![PollFd::new(socket, PollFlags::empty())];
        if output.open {
            events.push(PollFd::new(&output.pipe, PollFlags::IN));
        }
        if let Some(ended) = &ended {
            events.push(PollFd::new(ended, PollFlags::IN));
        }
        let limit = if ended.is_some() { None } else { Some(&LOOK) };
        match poll(&mut events, limit) {
            Err(rustix::io::Errno::INTR) => continue,
            other => other?,
        };
        let happened: Vec<bool> = events.iter().map(|event| !event.revents().is_empty()).collect();
        let is_output = output.open && happened[1];
        if is_output {
            output.pass();
        }
        let has_ended = match &ended {
            Some(_) => happened.last() == Some(&true),
            None => has_ended(fmu)?,
        };
        if happened[0] || has_ended {
            return Ok(());
        }
    }
}

/// Returns whether a child has ended, without waiting for it.
fn has_ended(child: Pid) -> io::Result<bool> {
    use rustix::process::{WaitId, WaitIdOptions, waitid};
    let options = WaitIdOptions::EXITED | WaitIdOptions::NOWAIT | WaitIdOptions::NOHANG;
    Ok(waitid(WaitId::Pid(child), options)?.is_some())
}

/// Ends all children of this process: those that the FMU started, and their children in turn, which
/// become children of this process when their parents have ended.
fn end_children() {
    let until = Instant::now() + END_MAX;
    loop {
        let children = children_of(rustix::process::getpid());
        if children.is_empty() || Instant::now() > until {
            return;
        }
        for child in children {
            let _ = rustix::process::kill_process(child, Signal::KILL);
        }
        while let Ok(Some(_)) = rustix::process::wait(WaitOptions::NOHANG) {}
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Processes with this parent.
fn children_of(parent: Pid) -> Vec<Pid> {
    let parent = parent.as_raw_nonzero().get();
    let child = |entry: io::Result<std::fs::DirEntry>| -> Option<Pid> {
        let name = entry.ok()?.file_name();
        let pid: i32 = name.to_str()?.parse().ok()?;
        let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
        // The name, in brackets, may have anything in it; state and parent follow.
        let of: i32 = stat.rsplit(')').next()?.split_whitespace().nth(1)?.parse().ok()?;
        (of == parent).then(|| Pid::from_raw(pid)).flatten()
    };
    std::fs::read_dir("/proc").into_iter().flatten().filter_map(child).collect()
}

/// Output of the FMU.
struct Output<'a> {
    name: &'a str,
    pipe: PipeReader,
    lines: ForeignLines<io::Stderr>,
    /// False after the last process that could write has closed it.
    open: bool,
}

impl Output<'_> {
    /// Reads once, and passes on what there is room for.
    fn pass(&mut self) {
        let mut buffer = [0; 64 << 10];
        let length = match self.pipe.read(&mut buffer) {
            Ok(0) => {
                self.open = false;
                return;
            }
            Ok(length) => length,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => return,
            Err(_) => {
                self.open = false;
                return;
            }
        };
        self.lines.take(&buffer[..length]);
    }

    /// Passes on what is left after the end of all processes, and tells how much was dropped.
    fn rest(&mut self) {
        while self.open && is_readable(&self.pipe) {
            self.pass();
        }
        let dropped = self.lines.end();
        if dropped > 0 {
            let _ = writeln!(
                io::stderr(),
                "octant: {}: {dropped} more bytes of its output were dropped, expected at most \
                 {OUTPUT_BYTES_MAX}",
                printable(self.name)
            );
        }
    }
}

fn is_readable(pipe: &impl AsFd) -> bool {
    let mut events = [PollFd::new(pipe, PollFlags::IN)];
    let now = Timespec { tv_sec: 0, tv_nsec: 0 };
    poll(&mut events, Some(&now)).is_ok_and(|ready| ready > 0)
}

/// Reason why the process of an FMU ends early.
#[derive(Debug, thiserror::Error)]
pub enum FmuServeError {
    /// No process that provides its input and output started this one.
    #[error("octant fmu host is started by octant itself, for an FMU that runs apart ({error})")]
    NotStarted {
        /// Error of the operating system.
        error: io::Error,
    },
    /// The other process can't be watched.
    #[error("{error}")]
    Watch {
        /// Error of the operating system.
        error: io::Error,
    },
    /// The thread that watches the other process can't be started.
    #[error("start a thread: {error}")]
    Thread {
        /// Error of the operating system.
        error: io::Error,
    },
    /// The other process is gone.
    #[error("octant fmu host lost the process that it serves: {error}")]
    Lost {
        /// Error of the operating system.
        error: io::Error,
    },
}
