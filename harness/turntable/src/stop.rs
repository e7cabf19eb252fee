//! The emergency stop.
//!
//! It has a handle of its own on the port and its bytes ready: to trip it takes no reply, no memory and
//! no lock that the driver holds. All stops of the program are in a register, so that a panic anywhere and
//! a signal trip them.

use crate::{Dialect, Error, Port};
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, Once, PoisonError, TryLockError, Weak};
use std::time::Duration;

/// How often the bytes are written: a line can lose some.
const TIMES: u32 = 2;
/// Between them.
const PAUSE: Duration = Duration::from_millis(20);
/// How long somebody else may be writing them.
const PATIENCE: u32 = 20;

struct Inner {
    tripped: AtomicBool,
    why: Mutex<String>,
    line: Mutex<Box<dyn Write + Send>>,
    bytes: Vec<u8>,
}

/// Stops a table. Clones stop the same one.
#[derive(Clone)]
pub struct EmergencyStop {
    inner: Arc<Inner>,
}

static REGISTER: Mutex<Vec<Weak<Inner>>> = Mutex::new(Vec::new());

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl EmergencyStop {
    /// With a handle and what is written to it.
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

    /// Stops the table, and keeps it from being moved until [`EmergencyStop::reset`]. Whether the bytes
    /// could be written.
    pub fn trip(&self, why: &str) -> bool {
        self.inner.trip(why)
    }

    /// It was tripped.
    #[must_use]
    pub fn is_tripped(&self) -> bool {
        self.inner.tripped.load(Ordering::SeqCst)
    }

    /// As an error, when it was tripped.
    ///
    /// # Errors
    /// If it was tripped.
    pub fn check(&self) -> Result<(), Error> {
        if self.is_tripped() {
            return Err(Error::Stopped { why: locked(&self.inner.why).clone() });
        }
        Ok(())
    }

    /// The table may be moved again: somebody has looked at it.
    pub fn reset(&self) {
        locked(&self.inner.why).clear();
        self.inner.tripped.store(false, Ordering::SeqCst);
    }
}

impl Inner {
    fn trip(&self, why: &str) -> bool {
        // The first reason is the reason.
        if !self.tripped.swap(true, Ordering::SeqCst)
            && let Ok(mut reason) = self.why.try_lock()
        {
            why.clone_into(&mut reason);
        }
        for _ in 0..PATIENCE {
            let mut line = match self.line.try_lock() {
                Ok(line) => line,
                // Who panicked with it wrote half of it: it begins with the end of a line.
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

/// Trips every stop of the program: nothing that it drives moves any more.
pub fn stop_all(why: &str) {
    // Not waited for: the thread that panics may hold it.
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

/// From now on a panic in any thread stops every table, before anything else is done about it: also
/// in a program that aborts on a panic.
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

/// From now on an interrupt, a hang-up, a quit or a termination stops every table, and then ends the program
/// as it would have without this.
///
/// # Errors
/// If the signals can't be caught.
#[cfg(unix)]
pub fn on_signals() -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
    let mut signals = signal_hook::iterator::Signals::new([SIGHUP, SIGINT, SIGQUIT, SIGTERM])?;
    std::thread::Builder::new().name("table stop".into()).spawn(move || {
        for signal in signals.forever() {
            stop_all("the harness was ended by a signal");
            let _ = signal_hook::low_level::emulate_default_handler(signal);
        }
    })?;
    Ok(())
}

/// There are no signals here to be caught: the guard and the controller's watchdog are what is left.
///
/// # Errors
/// Never.
#[cfg(not(unix))]
pub fn on_signals() -> std::io::Result<()> {
    Ok(())
}

/// Stops a table by hand, whoever drives it: through a program of this host that does, and on the port
/// itself as far as that can be opened. Who stopped it.
///
/// # Errors
/// If nobody could: why not.
pub fn stop_by_hand(name: &str, dialect: &Dialect) -> Result<Vec<String>, Error> {
    let mut stopped = Vec::new();
    let mut failure = None;
    match crate::press(Some(name)) {
        Ok(pressed) => {
            stopped.extend(
                pressed
                    .iter()
                    .filter(|pressed| pressed.written)
                    .map(|pressed| format!("the program that drives {}", pressed.port)),
            );
        }
        Err(error) => failure = Some(error),
    }
    // Both ways, if there are two: a table is stopped as often as one likes.
    match crate::open(name).and_then(|port| stop_line(port, name, dialect)) {
        Ok(()) => stopped.push("its own port, without waiting for an answer".to_owned()),
        Err(error) => failure = failure.or(Some(error)),
    }
    match failure {
        Some(error) if stopped.is_empty() => Err(error),
        _ => Ok(stopped),
    }
}

/// Stops a table on a port that nobody drives: by hand. Its replies are not waited for.
///
/// # Errors
/// If the port doesn't take it.
pub fn stop_line(mut port: impl Port, name: &str, dialect: &Dialect) -> Result<(), Error> {
    let gone = |reason| Error::Gone { port: name.to_owned(), reason };
    for time in 0..TIMES {
        if time > 0 {
            std::thread::sleep(PAUSE);
        }
        port.write_all(&dialect.emergency()).and_then(|()| port.flush()).map_err(gone)?;
    }
    // What was written is on its way before the port is closed.
    std::thread::sleep(10 * PAUSE);
    Ok(())
}
