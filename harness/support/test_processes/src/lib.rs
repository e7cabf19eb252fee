//! Child processes of tests, which end with the test that started them.
//!
//! A failed test unwinds, and dropping its [`Started`] ends the child. A test program that is killed can't unwind:
//! on Linux the child gets SIGKILL then, by its parent-death signal. A child that a test leaves running would hold
//! files, ports and processor time of the tests after it. No test starts a process in another way; a test of the program
//! (`child_processes`) checks it.

use std::ffi::OsStr;
use std::io;
use std::ops::{Deref, DerefMut};
use std::process::{Child, Command, Output};
use std::sync::OnceLock;
use std::sync::mpsc::{Sender, channel};

/// Makes a command. Its process ends with the thread that starts it (Linux), so the methods of [`Command`] that wait for
/// the end may be called on it; [`start`] is for processes that run beside the test.
pub fn command(program: impl AsRef<OsStr>) -> Command {
    #[cfg_attr(not(target_os = "linux"), expect(unused_mut, reason = "nothing is added"))]
    let mut command = Command::new(program);
    #[cfg(target_os = "linux")]
    end_with_this(&mut command);
    command
}

/// Makes the process of a command end with the thread that starts it.
#[cfg(target_os = "linux")]
#[expect(unsafe_code, reason = "the child calls the system before it runs its program")]
fn end_with_this(command: &mut Command) {
    use rustix::process::{Pid, Signal, getpid, getppid, set_parent_process_death_signal};
    use std::os::unix::process::CommandExt;
    let parent: Pid = getpid();
    let end_with_parent = move || {
        set_parent_process_death_signal(Some(Signal::KILL))?;
        // A parent that was gone before sends no signal.
        if getppid() == Some(parent) { Ok(()) } else { Err(io::ErrorKind::NotConnected.into()) }
    };
    // SAFETY: between fork and exec the closure makes two system calls. It neither allocates nor takes a lock.
    unsafe { command.pre_exec(end_with_parent) };
}

/// Starts a process beside the test. The command is used up.
///
/// A thread that lives as long as the test program starts it: the parent-death signal comes with the end of the
/// thread that started the process, and tests start some in threads that end before.
///
/// # Panics
/// If the operating system refuses.
#[track_caller]
pub fn start(command: &mut Command) -> Started {
    type Request = (Command, Sender<io::Result<Child>>);
    static STARTER: OnceLock<Sender<Request>> = OnceLock::new();
    let starter = STARTER.get_or_init(|| {
        let (sender, requests) = channel::<Request>();
        std::thread::spawn(move || {
            for (mut command, reply) in requests {
                // Nobody waits after a panic; the child that was started then is dropped here and goes on until the end
                // of the test program.
                let _ = reply.send(command.spawn());
            }
        });
        sender
    });
    let program = command.get_program().to_owned();
    let command = std::mem::replace(command, Command::new(""));
    let (reply, started) = channel();
    let child = starter.send((command, reply)).ok().and_then(|()| started.recv().ok());
    match child {
        Some(Ok(child)) => Started(Some(child)),
        Some(Err(error)) => panic!("failed to start {}: {error}", program.display()),
        None => panic!(
            "failed to start {}: the thread that starts processes is gone",
            program.display()
        ),
    }
}

/// Process that ends when this is dropped, with its process group if it leads one.
#[derive(Debug)]
pub struct Started(Option<Child>);

const HELD: &str = "the process is held until this is used up";

impl Started {
    /// Returns the process to code that ends it itself.
    pub fn release(mut self) -> Child {
        self.0.take().expect(HELD)
    }

    /// Waits for the end of the process, and reads its outputs to their ends.
    ///
    /// # Panics
    /// If the operating system can't wait for it.
    #[track_caller]
    pub fn output(self) -> Output {
        self.release().wait_with_output().expect("the end of a process can be waited for")
    }
}

impl Deref for Started {
    type Target = Child;

    fn deref(&self) -> &Child {
        self.0.as_ref().expect(HELD)
    }
}

impl DerefMut for Started {
    fn deref_mut(&mut self) -> &mut Child {
        self.0.as_mut().expect(HELD)
    }
}

impl Drop for Started {
    fn drop(&mut self) {
        let Some(child) = &mut self.0 else { return };
        // A process that was waited for has no number of its own any more.
        if matches!(child.try_wait(), Ok(None)) {
            #[cfg(unix)]
            end_group(child);
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// Ends the process group that a child leads.
#[cfg(unix)]
fn end_group(child: &Child) {
    use rustix::process::{Pid, Signal, getpgid, kill_process_group};
    let group = Pid::from_child(child);
    if getpgid(Some(group)) == Ok(group) {
        let _ = kill_process_group(group, Signal::KILL);
    }
}

/// Time for which a wait in a test may last. It ends a test that hangs and never decides one: on a host that does
/// other work everything takes many times as long.
pub const HANGS: std::time::Duration = std::time::Duration::from_secs(300);

/// Waits until something is so.
///
/// # Panics
/// If it hangs.
#[track_caller]
pub fn wait_for(what: &str, mut is_so: impl FnMut() -> bool) {
    let begun = std::time::Instant::now();
    while !is_so() {
        assert!(begun.elapsed() < HANGS, "{what} did not come");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
}
