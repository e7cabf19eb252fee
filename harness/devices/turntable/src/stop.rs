//! Emergency stop of tables.
//!
//! The stop has its own handle of the port with its bytes ready: tripping it needs no reply and no lock that
//! the driver holds. All stops of the program are in a register, so that a panic in any thread and a
//! signal trip them.

use crate::Error;
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, Once, PoisonError, TryLockError, Weak};
use std::time::Duration;

/// Number of times that the bytes are written: a line can lose some.
pub(crate) const TIMES: u32 = 2;
/// Pause between two writes.
pub(crate) const PAUSE: Duration = Duration::from_millis(20);
/// Number of attempts while another thread writes them.
const PATIENCE: u32 = 20;

struct Inner {
    tripped: AtomicBool,
    why: Mutex<String>,
    line: Mutex<Box<dyn Write + Send>>,
    bytes: Vec<u8>,
}

/// Stops a table. Clones stop the same table.
#[derive(Clone)]
pub struct EmergencyStop {
    inner: Arc<Inner>,
}

static REGISTER: Mutex<Vec<Weak<Inner>>> = Mutex::new(Vec::new());

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl EmergencyStop {
    /// Makes a stop from a handle and the bytes that are written to it.
    pub(crate) fn new(line: Box<dyn Write + Send>, bytes: Vec<u8>) -> Self {
        let inner = Arc::new(Inner {
            tripped: AtomicBool::new(false),
            why: Mutex::new(String::new()),
            line: Mutex::new(line),
            bytes,
        });
        let mut register = locked(&REGISTER);
        register.retain(|weak| weak.strong_count() > 0);
        register.push(Arc::downgrade(&inner));
        Self { inner }
    }

    /// Stops the table, and keeps it from being moved until [`EmergencyStop::reset`]. Returns true if
    /// the bytes could be written.
    pub fn trip(&self, why: &str) -> bool {
        self.inner.trip(why)
    }

    /// True if it was tripped.
    #[must_use]
    pub fn is_tripped(&self) -> bool {
        self.inner.tripped.load(Ordering::SeqCst)
    }

    /// Returns an error if it was tripped.
    ///
    /// # Errors
    /// If it was tripped.
    pub fn check(&self) -> Result<(), Error> {
        if self.is_tripped() {
            return Err(Error::Stopped { why: locked(&self.inner.why).clone() });
        }
        Ok(())
    }

    /// Allows moves again, after somebody has inspected the table.
    pub fn reset(&self) {
        locked(&self.inner.why).clear();
        self.inner.tripped.store(false, Ordering::SeqCst);
    }
}

impl Inner {
    fn trip(&self, why: &str) -> bool {
        // The first reason is kept.
        if !self.tripped.swap(true, Ordering::SeqCst)
            && let Ok(mut reason) = self.why.try_lock()
        {
            why.clone_into(&mut reason);
        }
        for _ in 0..PATIENCE {
            let mut line = match self.line.try_lock() {
                Ok(line) => line,
                // A thread that panicked while writing has written only a part: the bytes begin with an
                // end of line.
                Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
                Err(TryLockError::WouldBlock) => {
                    std::thread::sleep(PAUSE);
                    continue;
                }
            };
            let mut written = false;
            for time in 0..TIMES {
                if time > 0 {
                    std::thread::sleep(PAUSE);
                }
                written |= line.write_all(&self.bytes).and_then(|()| line.flush()).is_ok();
            }
            return written;
        }
        false
    }
}

/// Trips every stop of the program, after which none of its tables moves.
pub fn stop_all(why: &str) {
    // The lock isn't waited for without limit: the thread that panics may hold it.
    let mut stops = Vec::new();
    for _ in 0..PATIENCE {
        match REGISTER.try_lock() {
            Ok(register) => stops = register.iter().filter_map(Weak::upgrade).collect(),
            Err(TryLockError::Poisoned(poisoned)) => {
                stops = poisoned.into_inner().iter().filter_map(Weak::upgrade).collect();
            }
            Err(TryLockError::WouldBlock) => {
                std::thread::sleep(PAUSE);
                continue;
            }
        }
        break;
    }
    for stop in stops {
        stop.trip(why);
    }
}

/// Makes a panic in any thread stop every table from now on, before it is handled otherwise: also in a
/// program that aborts on a panic.
pub fn on_panic() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            stop_all("the harness panicked");
            before(panic);
        }));
    });
}

/// Makes an interrupt, a hang-up, a quit or a termination stop every table from now on; the signal then
/// ends the program as it would have otherwise.
///
/// # Errors
/// If the signals can't be caught.
pub fn on_signals() -> std::io::Result<()> {
    octant_base::interrupt::before_end(|| stop_all("the harness was ended by a signal"))
}
