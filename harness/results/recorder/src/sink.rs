//! End of the pipe, which counts written bytes and writes nothing after a failure.

use mcap::write::NoSeek;
use std::io::{self, BufWriter, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Container that a recording is written into.
pub(super) type Container<W> = mcap::Writer<NoSeek<BufWriter<Sink<W>>>>;

/// Writes through to `inner` until it fails once. Every later write fails: a summary after a torn
/// record would look like a complete file.
pub(super) struct Sink<W: Write> {
    inner: W,
    written: Arc<AtomicU64>,
    failed: Option<io::ErrorKind>,
}

impl<W: Write> Sink<W> {
    pub(super) fn new(inner: W) -> (Self, Arc<AtomicU64>) {
        let written = Arc::new(AtomicU64::new(0));
        (Self { inner, written: Arc::clone(&written), failed: None }, written)
    }
}

impl<W: Write> Write for Sink<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if let Some(kind) = self.failed {
            return Err(kind.into());
        }
        match self.inner.write(bytes) {
            Ok(n) => {
                self.written.fetch_add(n as u64, Ordering::Relaxed);
                Ok(n)
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => Err(error),
            Err(error) => {
                self.failed = Some(error.kind());
                Err(error)
            }
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        if let Some(kind) = self.failed {
            return Err(kind.into());
        }
        self.inner.flush()
    }
}
