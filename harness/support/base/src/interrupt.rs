//! Signals that end the program: one place that handles them.
//!
//! The first interrupt is only noted, and the work ends in order when it looks at it. The library
//! that catches signals hands them to a thread, so that a handler may do anything.

use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock};

static SEEN: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);
static HANDLED: AtomicBool = AtomicBool::new(false);

/// Returns the flag that the first interrupt sets.
#[must_use]
pub fn flag() -> &'static AtomicBool {
    &SEEN
}

/// Returns whether an interrupt came.
#[must_use]
pub fn seen() -> bool {
    flag().load(Ordering::Relaxed)
}

/// Leaves interrupts to their default from now on, which ends the program at once.
pub fn leave() {
    HANDLED.store(true, Ordering::Relaxed);
}

/// Handles Ctrl-C, termination and hang-up from now on: the first one sets the flag, each further
/// one calls `again`. A second call does nothing.
///
/// # Errors
/// If the signals can't be caught; the default remains.
pub fn watch(again: fn()) -> io::Result<()> {
    if HANDLED.swap(true, Ordering::Relaxed) {
        return Ok(());
    }
    #[cfg(unix)]
    {
        use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
        let heard = move |_| {
            if flag().swap(true, Ordering::Relaxed) {
                again();
            }
        };
        handle(&[SIGHUP, SIGINT, SIGTERM], heard)
    }
    #[cfg(not(unix))]
    {
        use signal_hook::consts::{SIGINT, SIGTERM};
        // Without a thread to call `again` on, a second interrupt ends the program.
        let _ = again;
        for signal in [SIGINT, SIGTERM] {
            signal_hook::flag::register_conditional_default(signal, Arc::clone(&SEEN))?;
            signal_hook::flag::register(signal, Arc::clone(&SEEN))?;
        }
        Ok(())
    }
}

/// Calls `act` before an interrupt, a hang-up, a quit or a termination ends the program as it would
/// have otherwise. Does nothing where there are no such signals.
///
/// # Errors
/// If the signals can't be caught.
pub fn before_end(act: fn()) -> io::Result<()> {
    #[cfg(unix)]
    {
        use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
        let heard = move |signal| {
            act();
            let _ = signal_hook::low_level::emulate_default_handler(signal);
        };
        handle(&[SIGHUP, SIGINT, SIGQUIT, SIGTERM], heard)?;
    }
    #[cfg(not(unix))]
    let _ = act;
    Ok(())
}

#[cfg(unix)]
fn handle(signals: &[i32], heard: impl Fn(i32) + Send + 'static) -> io::Result<()> {
    let mut signals = signal_hook::iterator::Signals::new(signals)?;
    let wait = move || signals.forever().for_each(heard);
    std::thread::Builder::new().name("signals".into()).spawn(wait)?;
    Ok(())
}
