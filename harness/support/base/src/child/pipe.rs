//! Standard input of a process, written within a time.

use std::io::{self, Write};
use std::process::ChildStdin;
use std::time::Duration;

/// Standard input of a process. A process that doesn't read holds up nothing.
///
/// Where pipes can't be waited for, which is so on Windows, a write waits until the process reads or ends.
#[derive(Debug)]
pub struct InputPipe(ChildStdin);

impl InputPipe {
    /// Takes the pipe.
    ///
    /// # Errors
    /// If the operating system refuses writes that don't wait.
    pub fn new(pipe: ChildStdin) -> io::Result<Self> {
        #[cfg(unix)]
        {
            // The flag is that of this end, which no other process has.
            let flags = rustix::fs::fcntl_getfl(&pipe)?;
            rustix::fs::fcntl_setfl(&pipe, flags | rustix::fs::OFlags::NONBLOCK)?;
        }
        Ok(Self(pipe))
    }

    /// Writes bytes within a time; returns how many of them the pipe took.
    ///
    /// # Errors
    /// If the process closed its end.
    #[cfg(unix)]
    pub fn write_within(&mut self, bytes: &[u8], wait: Duration) -> io::Result<usize> {
        use rustix::event::{PollFd, PollFlags, Timespec, poll};
        use std::io::ErrorKind;
        use std::time::Instant;
        let until = Instant::now() + wait;
        let mut taken = 0;
        while taken < bytes.len() {
            match self.0.write(&bytes[taken..]) {
                Ok(count) => taken += count,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    let left = until.saturating_duration_since(Instant::now());
                    if left.is_zero() {
                        break;
                    }
                    let left = Timespec {
                        tv_sec: left.as_secs().try_into().unwrap_or(i64::MAX),
                        tv_nsec: left.subsec_nanos().into(),
                    };
                    // An interrupt or an error shows at the next write.
                    let _ = poll(&mut [PollFd::new(&self.0, PollFlags::OUT)], Some(&left));
                }
                Err(error) => return Err(error),
            }
        }
        Ok(taken)
    }

    /// Writes bytes; returns how many of them the pipe took.
    ///
    /// # Errors
    /// If the process closed its end.
    #[cfg(not(unix))]
    pub fn write_within(&mut self, bytes: &[u8], _: Duration) -> io::Result<usize> {
        self.0.write_all(bytes).and_then(|()| self.0.flush()).map(|()| bytes.len())
    }
}
