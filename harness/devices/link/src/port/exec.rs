//! A program as the device: its standard input and output are the line. [`ExecPort`] is the end of the
//! harness, [`StdioPort`] that of the device.

use super::bytes::Bytes;
use super::error::PortError;
use crate::Uri;
use crate::uri::Exec;
use octant_base::child::{InputPipe, OutputLimit, PassedOn};
use std::io::{ErrorKind, Read, Write};
use std::process::{Child, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::{Duration, Instant};

/// Pieces of output that are kept until they are received.
const PIECES: usize = 64;
/// Largest piece of output.
const PIECE_BYTES: usize = 4096;
/// Time in which a program that closed a pipe, or was killed, has to be over.
const END_MAX: Duration = Duration::from_secs(1);
/// Interval at which the end of a program is looked for.
const LOOK: Duration = Duration::from_millis(1);
/// Limit of what is shown of a program's standard error.
pub const ERROR_OUTPUT: OutputLimit = OutputLimit { bytes: 64 << 10, bytes_per_s: 4 << 10 };
/// Beginning of the lines of a program's standard error.
const ORIGIN: &str = "device";

/// A program that was started. The lines that it writes to standard error are [passed on](PassedOn).
#[derive(Debug)]
pub struct ExecPort {
    uri: String,
    exec: Exec,
    running: Option<Running>,
}

#[derive(Debug)]
struct Running {
    child: Child,
    input: InputPipe,
    /// Rest of a frame that the pipe had no room for.
    unsent: Vec<u8>,
    output: Pieces,
    /// `None` once it has ended.
    errors: Option<PassedOn>,
}

/// Bytes of a pipe, read by a thread that ends with it.
#[derive(Debug)]
struct Pieces {
    from: Receiver<Vec<u8>>,
    /// Rest of a piece that the receiver had no room for.
    rest: Vec<u8>,
}

/// The pipe has ended.
struct Over;

impl Pieces {
    fn of(mut pipe: impl Read + Send + 'static) -> std::io::Result<Self> {
        let (to, from) = sync_channel(PIECES);
        std::thread::Builder::new().name("pipe".into()).spawn(move || {
            let mut piece = [0; PIECE_BYTES];
            loop {
                match pipe.read(&mut piece) {
                    Ok(0) => return,
                    Ok(count) => {
                        if to.send(piece[..count].to_vec()).is_err() {
                            return;
                        }
                    }
                    Err(error) if error.kind() == ErrorKind::Interrupted => {}
                    Err(_) => return,
                }
            }
        })?;
        Ok(Self { from, rest: Vec::new() })
    }

    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<usize, Over> {
        if self.rest.is_empty() {
            match self.from.recv_timeout(wait) {
                Ok(piece) => self.rest = piece,
                Err(RecvTimeoutError::Timeout) => return Ok(0),
                Err(RecvTimeoutError::Disconnected) => return Err(Over),
            }
        }
        let count = self.rest.len().min(buffer.len());
        buffer[..count].copy_from_slice(&self.rest[..count]);
        self.rest.drain(..count);
        Ok(count)
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // It has no more work: a program that ended before is only waited for.
        let _ = self.child.kill();
        let _ = self.over(END_MAX);
        if let Some(errors) = self.errors.take() {
            errors.finish(END_MAX);
        }
    }
}

impl Running {
    /// Waits for the end of the program within a time; `None`: it lives on.
    fn over(&mut self, wait: Duration) -> std::io::Result<Option<ExitStatus>> {
        let until = Instant::now() + wait;
        loop {
            match self.child.try_wait()? {
                None if Instant::now() < until => std::thread::sleep(LOOK),
                status => return Ok(status),
            }
        }
    }

    /// Sends bytes within a time; false: none of them were taken.
    fn send(&mut self, bytes: &[u8], wait: Duration) -> std::io::Result<bool> {
        let until = Instant::now() + wait;
        if !self.unsent.is_empty() {
            let taken = self.input.write_within(&self.unsent, wait)?;
            self.unsent.drain(..taken);
            if !self.unsent.is_empty() {
                return Ok(false);
            }
        }
        let left = until.saturating_duration_since(Instant::now());
        let taken = self.input.write_within(bytes, left)?;
        // The rest of a frame goes before the next one.
        if taken > 0 {
            self.unsent.extend_from_slice(&bytes[taken..]);
        }
        Ok(taken > 0 || bytes.is_empty())
    }
}

impl ExecPort {
    /// Starts the program.
    ///
    /// # Errors
    /// If it can't be started.
    pub fn open(exec: &Exec) -> Result<Self, PortError> {
        let uri = Uri::Exec(exec.clone()).to_string();
        let running = start(exec).map_err(|error| PortError::open(&uri, explain(&error)))?;
        Ok(Self { uri, exec: exec.clone(), running: Some(running) })
    }
}

fn explain(error: &std::io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => {
            format!("{error}; expected a program, found from the current folder or on the path")
        }
        ErrorKind::PermissionDenied => format!("{error}; expected a file that may be executed"),
        _ => error.to_string(),
    }
}

fn start(exec: &Exec) -> std::io::Result<Running> {
    let mut child = octant_base::child::foreign(&exec.program)
        .args(&exec.arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()?;
    let (Some(input), Some(output), Some(errors)) =
        (child.stdin.take(), child.stdout.take(), child.stderr.take())
    else {
        return Err(ErrorKind::BrokenPipe.into());
    };
    Ok(Running {
        child,
        input: InputPipe::new(input)?,
        unsent: Vec::new(),
        output: Pieces::of(output)?,
        errors: Some(PassedOn::start(ORIGIN, ERROR_OUTPUT, errors)?),
    })
}

/// Error of a program that has closed a pipe, with its status if it has ended.
fn ended(uri: &str, running: &mut Running, closed: &str) -> PortError {
    let reason = match running.over(END_MAX) {
        Ok(Some(status)) => format!("the program ended: {status}"),
        Ok(None) => format!("the program closed its standard {closed} and goes on"),
        Err(error) => format!("the program ended: {error}"),
    };
    // Its last words stand before the message.
    if let Some(errors) = &running.errors {
        errors.settle(END_MAX);
    }
    PortError::gone(uri, reason)
}

impl Bytes for ExecPort {
    fn send(&mut self, bytes: &[u8], wait: Duration) -> Result<bool, PortError> {
        let Some(running) = &mut self.running else { return Err(closed(&self.uri)) };
        running.send(bytes, wait).map_err(|_| ended(&self.uri, running, "input"))
    }

    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<usize, PortError> {
        let Some(running) = &mut self.running else { return Err(closed(&self.uri)) };
        running.output.receive(buffer, wait).map_err(|Over| ended(&self.uri, running, "output"))
    }

    fn datagrams(&self) -> bool {
        false
    }

    fn reached_at(&self) -> String {
        self.uri.clone()
    }

    /// A pipe has only one other end.
    fn hold_peer(&mut self, _: bool) {}

    fn close(&mut self) {
        self.running = None;
    }

    /// Starts the program anew.
    fn reopen(&mut self) -> Result<(), PortError> {
        self.running = None;
        *self = Self::open(&self.exec)?;
        Ok(())
    }
}

fn closed(uri: &str) -> PortError {
    PortError::gone(uri, "it is closed")
}

/// Standard input and output of this program, as the line to the harness that started it.
#[derive(Debug)]
pub struct StdioPort {
    input: Pieces,
}

impl StdioPort {
    /// Takes standard input and output.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn open() -> Result<Self, PortError> {
        let refused = |error: std::io::Error| PortError::open(Uri::Stdio, error);
        Ok(Self { input: Pieces::of(std::io::stdin()).map_err(refused)? })
    }
}

impl Bytes for StdioPort {
    fn send(&mut self, bytes: &[u8], _: Duration) -> Result<bool, PortError> {
        let mut output = std::io::stdout().lock();
        output
            .write_all(bytes)
            .and_then(|()| output.flush())
            .map(|()| true)
            .map_err(|error| PortError::gone(Uri::Stdio, error))
    }

    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<usize, PortError> {
        self.input
            .receive(buffer, wait)
            .map_err(|Over| PortError::gone(Uri::Stdio, "standard input has ended"))
    }

    fn datagrams(&self) -> bool {
        false
    }

    fn reached_at(&self) -> String {
        Uri::Stdio.to_string()
    }

    /// A pipe has only one other end.
    fn hold_peer(&mut self, _: bool) {}

    fn close(&mut self) {}

    fn reopen(&mut self) -> Result<(), PortError> {
        Err(PortError::gone(Uri::Stdio, "standard input doesn't come back"))
    }
}
