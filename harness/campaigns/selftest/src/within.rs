//! A case on a thread of its own, which is left when it takes too long.

use crate::bench::CaseBench;
use crate::case::Case;
use crate::error::CaseSetupError;
use crate::judge::CaseOutcome;
use octant_base::pool::STACK;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Time between two looks at an interrupt.
const LOOK: Duration = Duration::from_millis(20);
/// Time in which a case ends the programs that it has started after an interrupt.
const ENDING: Duration = Duration::from_secs(5);

/// Runs a case. After its limit, and after an interrupt, its thread is left; it ends with this program. A thread that can't
/// be ended may compute on: what it finds isn't asked for any more.
pub(crate) fn outcome(
    program: &Path,
    folder: &Path,
    case: &Case,
    cancel: &AtomicBool,
) -> Result<CaseOutcome, CaseSetupError> {
    let (found, outcome) = channel();
    let ended = Arc::new(AtomicBool::new(false));
    let (program, folder, its, work) =
        (program.to_owned(), folder.to_owned(), Arc::clone(&ended), case.run);
    let thread = std::thread::Builder::new().name(case.id.to_owned()).stack_size(STACK);
    let spawned = thread.spawn(move || {
        let outcome = CaseBench::new(&program, &folder, &its)
            .map_err(CaseSetupError::from)
            .and_then(|bench| work(&bench));
        // Nobody waits any more after the limit.
        let _ = found.send(outcome);
    });
    spawned.map_err(|error| format!("start a thread: {error}"))?;
    let failed = |said: String| Ok(CaseOutcome { said, ..CaseOutcome::default() });
    let started = Instant::now();
    let mut interrupted = None;
    loop {
        match outcome.recv_timeout(LOOK) {
            Ok(outcome) => return outcome,
            Err(RecvTimeoutError::Disconnected) => {
                return failed("it panicked: its message is on standard error".to_owned());
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
        if cancel.load(Ordering::Relaxed) {
            ended.store(true, Ordering::Relaxed);
            let since = *interrupted.get_or_insert_with(Instant::now);
            if since.elapsed() > ENDING {
                return failed("it was interrupted".to_owned());
            }
        }
        if started.elapsed() > case.limit {
            ended.store(true, Ordering::Relaxed);
            let limit_s = case.limit.as_secs_f64();
            return failed(format!("it took longer than its limit of {limit_s} s, and was left"));
        }
    }
}
