//! Continuous supervision of a table.

use crate::{
    Driver, EmergencyStop, Error, TableAxis, TableLimits, TablePort, TableStatus, Turntable,
};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Factor by which a measured rate may exceed its limit: rates are noisy.
const RATE_SLACK: f64 = 1.1;

struct Shared<P: TablePort> {
    driver: Mutex<Driver<P>>,
    last: Mutex<Option<TableStatus>>,
    /// Reason for which it stopped the table.
    fault: Mutex<Option<String>>,
    ends: AtomicBool,
}

/// A table under supervision.
///
/// A thread asks for the status many times a second, feeds watchdog and guard, and stops the table if
/// an axis could no longer come to rest within its limits, is too fast or reports a fault, or if the
/// table's answers are invalid or missing. Then nothing moves any more: see [`EmergencyStop`].
pub struct Supervisor<P: TablePort + 'static> {
    shared: Arc<Shared<P>>,
    thread: Option<JoinHandle<()>>,
    limits: TableLimits,
    stop: EmergencyStop,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<P: TablePort + 'static> Supervisor<P> {
    /// Starts the supervision of a table, with a look each `period`.
    ///
    /// # Errors
    /// If the thread can't be started.
    pub fn new(driver: Driver<P>, period: Duration) -> Result<Self, Error> {
        Self::with_duty(driver, period, |_, _| Ok(()))
    }

    /// Starts the supervision like [`Supervisor::new`], with a duty that the same thread performs after
    /// each good look: for example to pass on the status, or to move the table. An error of the duty
    /// stops the table like any other error.
    ///
    /// # Errors
    /// If the thread can't be started.
    pub fn with_duty(
        driver: Driver<P>,
        period: Duration,
        duty: impl FnMut(&TableStatus, &mut Driver<P>) -> Result<(), Error> + Send + 'static,
    ) -> Result<Self, Error> {
        let (limits, stop) = (*driver.limits(), driver.emergency());
        let shared = Arc::new(Shared {
            driver: Mutex::new(driver),
            last: Mutex::new(None),
            fault: Mutex::new(None),
            ends: AtomicBool::new(false),
        });
        let (watched, trips) = (Arc::clone(&shared), stop.clone());
        let thread = std::thread::Builder::new()
            .name("table".into())
            .spawn(move || watch(&watched, &trips, period, duty))
            .map_err(|error| Error::Guard { reason: error.to_string() })?;
        Ok(Self { shared, thread: Some(thread), limits, stop })
    }

    /// Last status of the table.
    #[must_use]
    pub fn last(&self) -> Option<TableStatus> {
        *locked(&self.shared.last)
    }

    /// Reason for which it stopped the table, if it did.
    #[must_use]
    pub fn fault(&self) -> Option<String> {
        locked(&self.shared.fault).clone()
    }

    /// Ends the supervision, brakes the table and releases it.
    ///
    /// # Errors
    /// If the table doesn't stop.
    pub fn finish(mut self) -> Result<(), Error> {
        self.end();
        let shared = Arc::clone(&self.shared);
        drop(self);
        // The thread has ended, and this is the last reference.
        match Arc::into_inner(shared) {
            Some(shared) => {
                shared.driver.into_inner().unwrap_or_else(PoisonError::into_inner).finish()
            }
            None => Ok(()),
        }
    }

    fn end(&mut self) {
        self.shared.ends.store(true, Ordering::SeqCst);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl<P: TablePort + 'static> Drop for Supervisor<P> {
    fn drop(&mut self) {
        // The driver is dropped after the end of the thread, and stops the table.
        self.end();
    }
}

fn watch<P: TablePort>(
    shared: &Shared<P>,
    stop: &EmergencyStop,
    period: Duration,
    mut duty: impl FnMut(&TableStatus, &mut Driver<P>) -> Result<(), Error>,
) {
    let mut before = None;
    while !shared.ends.load(Ordering::SeqCst) {
        let asked = Instant::now();
        let looked = {
            let mut driver = locked(&shared.driver);
            let looked = driver.feed().and_then(|()| look(&mut *driver, before, period));
            looked.and_then(|status| duty(&status, &mut driver).map(|()| status))
        };
        match looked {
            Ok(status) => {
                before = Some((asked, Instant::now(), status));
                *locked(&shared.last) = Some(status);
            }
            Err(error) => {
                // If somebody tripped the stop, that reason counts, not the refusal to move that
                // follows from it.
                let why = match error {
                    Error::Stopped { why } => why,
                    error => error.to_string(),
                };
                stop.trip(&why);
                *locked(&shared.fault) = Some(why);
                return;
            }
        }
        std::thread::sleep(period);
    }
}

/// Asks a table for its status, and checks it.
fn look(
    table: &mut impl Turntable,
    before: Option<(Instant, Instant, TableStatus)>,
    period: Duration,
) -> Result<TableStatus, Error> {
    let status = table.status()?;
    let limits = *table.limits();
    for axis in TableAxis::ALL {
        let found = status.of(axis);
        if let Some(fault) = found.fault.filter(|fault| *fault != 0) {
            return Err(Error::Fault { axis, fault });
        }
        // If the language doesn't report a rate, it follows from the former angle. The time of that
        // angle is known only to lie between query and answer, which may be long on a busy host: from
        // the query on, the mean rate is the least possible one, and from the answer on about the true
        // one.
        let (least, rate) = match (found.rate_radps, before) {
            (Some(rate), _) => (rate, rate),
            (None, Some((asked, answered, status))) => {
                let turned = found.angle_rad - status.of(axis).angle_rad;
                let over = |since: Instant| turned / since.elapsed().as_secs_f64().max(1e-3);
                (over(asked), over(answered))
            }
            (None, None) => (0.0, 0.0),
        };
        limits.rate(axis, least / RATE_SLACK)?;
        // The axis must be able to stop if it is braked two periods from now.
        limits.can_stop(axis, found.angle_rad, rate, 2.0 * period.as_secs_f64())?;
    }
    Ok(status)
}

impl<P: TablePort + 'static> Turntable for Supervisor<P> {
    fn goto(
        &mut self,
        axis: TableAxis,
        angle_rad: f64,
        rate_radps: Option<f64>,
    ) -> Result<(), Error> {
        locked(&self.shared.driver).goto(axis, angle_rad, rate_radps)
    }

    fn rate(&mut self, axis: TableAxis, rate_radps: f64) -> Result<(), Error> {
        locked(&self.shared.driver).rate(axis, rate_radps)
    }

    fn stop(&mut self) -> Result<(), Error> {
        locked(&self.shared.driver).stop()
    }

    fn home(&mut self, axis: TableAxis) -> Result<(), Error> {
        locked(&self.shared.driver).home(axis)
    }

    fn status(&mut self) -> Result<TableStatus, Error> {
        locked(&self.shared.driver).status()
    }

    fn limits(&self) -> &TableLimits {
        &self.limits
    }

    fn emergency(&self) -> EmergencyStop {
        self.stop.clone()
    }
}
