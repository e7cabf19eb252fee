//! Faults of a recorder and its disk, raised from another thread.

use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

/// Handle to the disk and the thread of a recorder, for faults. By default there are none. Raising a
/// fault is a store: it takes no lock and allocates nothing.
#[derive(Clone, Debug, Default)]
pub struct RecorderTrouble(Arc<Raised>);

#[derive(Debug, Default)]
struct Raised {
    full: AtomicBool,
    pause_ns: AtomicU64,
}

impl RecorderTrouble {
    /// Makes the disk full from now on.
    pub fn fill_disk(&self) {
        self.0.full.store(true, Ordering::Relaxed);
    }

    /// Asks the recorder's thread to pause for a time.
    pub fn stall(&self, pause_ns: u64) {
        self.0.pause_ns.fetch_add(pause_ns, Ordering::Relaxed);
    }

    /// Pauses for the time that was asked for since the last pause.
    pub(super) fn stand_still(&self) {
        if self.0.pause_ns.load(Ordering::Relaxed) > 0 {
            std::thread::sleep(Duration::from_nanos(self.0.pause_ns.swap(0, Ordering::Relaxed)));
        }
    }
}

/// File on a disk that can be full.
pub(super) struct Disk<W> {
    inner: W,
    trouble: RecorderTrouble,
}

impl<W> Disk<W> {
    pub(super) fn new(inner: W, trouble: RecorderTrouble) -> Self {
        Self { inner, trouble }
    }
}

impl<W: Write> Write for Disk<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.trouble.0.full.load(Ordering::Relaxed) {
            return Err(no_space());
        }
        self.inner.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

/// Error that the system gives for a full disk.
fn no_space() -> io::Error {
    #[cfg(target_os = "linux")]
    return rustix::io::Errno::NOSPC.into();
    #[cfg(not(target_os = "linux"))]
    return io::ErrorKind::StorageFull.into();
}
