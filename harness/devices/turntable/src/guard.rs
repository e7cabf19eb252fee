//! The guard, a process that stops the table when the harness can't.
//!
//! The guard has the port as its standard output and a pipe from the harness as its input. Through the
//! pipe come the bytes that stop the table, then a byte from time to time, and at the end a farewell.
//! If the pipe ends without the farewell (whatever ended the harness, including SIGKILL), or nothing
//! arrives for too long (the harness hangs), the guard writes the bytes. It has its own process group,
//! so that an interrupt from the terminal doesn't reach it.
//!
//! The guard can't stop a table whose line is cut, or whose computer lost its power or had all of its
//! processes killed. For these cases there is the watchdog of the controller.

use crate::Error;
use std::io::{self, Read, Write};
use std::process::{Child, ChildStdin};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

const ALIVE: u8 = b'.';
/// Byte that releases the guard.
pub const FAREWELL: u8 = b'q';
/// Limit of the bytes that stop a table; no table needs more.
const MAX_BYTES: u32 = 65_536;

fn failed(reason: impl ToString) -> Error {
    Error::Guard { reason: reason.to_string() }
}

/// The harness's handle of a guard. Dropped without a farewell, it makes the guard stop the table.
#[derive(Debug)]
pub struct Guard {
    child: Child,
    silence: Duration,
    pipe: Option<ChildStdin>,
}

impl Guard {
    /// Starts a guard on a handle of the port.
    #[cfg(unix)]
    pub(crate) fn spawn(
        program: &mut std::process::Command,
        line: std::os::fd::OwnedFd,
        bytes: &[u8],
        silence: Duration,
    ) -> Result<Self, Error> {
        use std::os::unix::process::CommandExt;
        use std::process::Stdio;
        let mut child = program
            .stdin(Stdio::piped())
            .stdout(Stdio::from(line))
            .process_group(0)
            .spawn()
            .map_err(failed)?;
        let mut pipe = child.stdin.take();
        let silence_ms = u32::try_from(silence.as_millis()).unwrap_or(u32::MAX);
        let mut head = Vec::new();
        head.extend(silence_ms.to_le_bytes());
        head.extend((bytes.len() as u32).to_le_bytes());
        head.extend(bytes);
        let written = pipe.as_mut().map(|pipe| pipe.write_all(&head).and_then(|()| pipe.flush()));
        written.unwrap_or(Err(io::ErrorKind::BrokenPipe.into())).map_err(failed)?;
        Ok(Self { child, silence, pipe })
    }

    /// Sends a sign of life.
    pub(crate) fn alive(&mut self) -> Result<(), Error> {
        if let Some(status) = self.child.try_wait().map_err(failed)? {
            // Status 1 is that of `run_guard` where the table had to be stopped.
            return Err(failed(if status.code() == Some(1) {
                format!(
                    "it stopped the table, because this program gave no sign of life for {} s: it stood still, stopped, \
                     suspended or short of processor time",
                    self.silence.as_secs_f64()
                )
            } else {
                format!("it ended without being asked to: {status}")
            }));
        }
        let pipe = self.pipe.as_mut().ok_or_else(|| failed("it was released"))?;
        pipe.write_all(&[ALIVE]).map_err(failed)
    }

    /// Sends the farewell, when the table rests and isn't used any more.
    pub(crate) fn release(mut self) -> Result<(), Error> {
        if let Some(mut pipe) = self.pipe.take() {
            pipe.write_all(&[FAREWELL]).map_err(failed)?;
        }
        self.child.wait().map_err(failed)?;
        Ok(())
    }
}

impl Drop for Guard {
    fn drop(&mut self) {
        // The pipe ends without a farewell: the guard stops the table, and ends.
        drop(self.pipe.take());
        let _ = self.child.wait();
    }
}

/// Runs the guard, from its standard input to its standard output. A program for
/// [`crate::Driver::guard`] calls this, writes nothing to its standard output, and ends. Returns true
/// after a farewell; otherwise the guard had to stop the table.
#[must_use]
pub fn run_guard() -> bool {
    guard(io::stdin(), &mut io::stdout()).unwrap_or(false)
}

/// Runs the guard between any input and line; true after a farewell. The input begins with the longest silence in ms
/// (zero: any) and the number of the bytes that stop the table, 32 bits each, little-endian, and these bytes.
///
/// # Errors
/// If the input ends before the bytes do, or the line can't be written.
pub fn guard(mut input: impl Read + Send + 'static, line: &mut impl Write) -> io::Result<bool> {
    let mut head = [0; 8];
    input.read_exact(&mut head)?;
    let number =
        |at: usize| u32::from_le_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]);
    let (silence_ms, length) = (number(0), number(4).min(MAX_BYTES));
    let mut bytes = vec![0; length as usize];
    input.read_exact(&mut bytes)?;
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || {
        let mut buffer = [0; 64];
        loop {
            let heard = input.read(&mut buffer).unwrap_or(0);
            if sender.send(buffer[..heard].to_vec()).is_err() || heard == 0 {
                return;
            }
        }
    });
    let silence = Duration::from_millis(silence_ms.into());
    loop {
        let heard = if silence_ms == 0 {
            receiver.recv().map_err(|_| RecvTimeoutError::Disconnected)
        } else {
            receiver.recv_timeout(silence)
        };
        match heard {
            Ok(heard) if heard.contains(&FAREWELL) => return Ok(true),
            Ok(heard) if !heard.is_empty() => {}
            // The pipe ended without a farewell, or was silent: the bytes are written again after a
            // moment, for a line that loses bytes.
            _ => {
                let first = line.write_all(&bytes).and_then(|()| line.flush());
                std::thread::sleep(Duration::from_millis(50));
                line.write_all(&bytes).and_then(|()| line.flush()).or(first)?;
                return Ok(false);
            }
        }
    }
}
