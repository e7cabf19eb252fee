//! A table that follows a run.

use crate::{
    Button, Dialect, Driver, DriverSettings, EmergencyStop, Error, Follower, Supervisor, TableAxis,
    TableHost, TablePort, TableStatus, Track, TrackPoint, Turntable, on_panic, open,
};
use octant_sample::{GimbalAngles, GimbalCommand};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Number of looks that may wait for the thread of the samples. If that is busy for longer, the newest
/// are dropped.
const LOOKS: usize = 256;
/// Time for which an axis must rest: a move begins a moment after its command.
const RESTED: Duration = Duration::from_millis(250);
/// Interval between two looks at a table that comes to rest.
const WAIT: Duration = Duration::from_millis(20);
/// Change of angle between two looks below which an axis rests, if its language doesn't report moves,
/// rad.
const STILL_RAD: f64 = 1e-6;

/// Requirements of a run on its table.
#[derive(Clone, Debug)]
pub struct TablePlan {
    /// Port, as for [`open`].
    pub port: String,
    /// Command language.
    pub dialect: Dialect,
    /// Limits, timeout and watchdog.
    pub settings: DriverSettings,
    /// Interval between two looks.
    pub period: Duration,
    /// Silence of this program after which a guard stops the table; `None`: no guard.
    pub guard: Option<Duration>,
    /// True if both axes are homed first.
    pub home: bool,
    /// Longest time for homing and for the move to zero, each.
    pub start: Duration,
    /// Largest angle from zero at which an axis may rest at the start, rad.
    pub tolerance_rad: f64,
    /// Number of runs at the table, this one among them: see [`TableHost`].
    pub units: usize,
}

/// Counts of the communication between a run and its table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TableTraffic {
    /// Number of looks at the table.
    pub looks: u64,
    /// Number of set points sent.
    pub commands: u64,
}

/// State shared by the two threads.
#[derive(Default)]
struct Shared {
    /// Set point, both counts in one word.
    target: AtomicU64,
    /// True once the table follows the set point.
    follows: AtomicBool,
    looks: AtomicU64,
    commands: AtomicU64,
}

/// A table that follows a run, under supervision. On drop it is stopped.
///
/// The thread of the samples neither waits nor takes a lock: it stores a set point, and takes the
/// queued looks.
pub struct Following {
    supervisor: Supervisor<Box<dyn TablePort>>,
    stop: EmergencyStop,
    shared: Arc<Shared>,
    looks: rtrb::Consumer<TableStatus>,
    track: Track,
    host: TableHost,
    /// Removed after the table is stopped.
    _button: Button,
}

impl std::fmt::Debug for Following {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Following").field("traffic", &self.traffic()).finish_non_exhaustive()
    }
}

/// Packs a set point into one word, which crosses threads whole.
#[must_use]
pub fn packed(target: GimbalAngles) -> u64 {
    let bits = |count: i32| u64::from(count.cast_unsigned());
    bits(target.azimuth) << 32 | bits(target.roll)
}

/// Unpacks the set point of [`packed`].
#[must_use]
pub fn unpacked(word: u64) -> GimbalAngles {
    let count = |bits: u64| (bits as u32).cast_signed();
    GimbalAngles { azimuth: count(word >> 32), roll: count(word) }
}

impl Following {
    /// Takes a table over, homes it if requested, and moves both gimbals to zero, where a run starts.
    /// From then on a panic in any thread stops the table. `guard` is the program of the guard.
    ///
    /// # Errors
    /// If the table can't be taken over, doesn't execute a command or doesn't arrive. By then every
    /// stop command was sent.
    pub fn start(plan: &TablePlan, guard: &mut std::process::Command) -> Result<Self, Error> {
        plan.settings.limits.check()?;
        for axis in TableAxis::ALL {
            plan.settings.limits.angle(axis, 0.0)?;
        }
        let port = open(&plan.port)?;
        let (dialect, settings) = (plan.dialect.clone(), plan.settings);
        let mut driver = Driver::new(port, &plan.port, dialect, settings)?;
        on_panic();
        let stop = driver.emergency();
        let host = TableHost::new(plan.units);
        let button = Button::offer(&plan.port, stop.clone(), host.clone())?;
        if let Some(silence) = plan.guard {
            driver.guard(guard, silence)?;
        }
        if plan.home {
            // Homing comes before supervision: without a reference the angles are meaningless.
            for axis in TableAxis::ALL {
                driver.home(axis)?;
                let status = rest(&mut driver, &plan.port, plan.start, Driver::feed)?;
                if status.of(axis).homed == Some(false) {
                    return Err(Error::NotHomed { axis });
                }
            }
        }
        let shared = Arc::new(Shared::default());
        let (mut producer, mut looks) = rtrb::RingBuffer::new(LOOKS);
        let (of_table, mut follower) = (Arc::clone(&shared), Follower::new());
        let of_guests = host.clone();
        let duty = move |status: &TableStatus, driver: &mut Driver<Box<dyn TablePort>>| {
            of_table.looks.fetch_add(1, Ordering::Relaxed);
            // A full queue means that the run doesn't take them: the angles of its samples then become
            // too old, which is noticed.
            let _ = producer.push(*status);
            let follows = of_table.follows.load(Ordering::Acquire);
            let target = follows.then(|| unpacked(of_table.target.load(Ordering::Acquire)));
            of_guests.look(status, target);
            if let Some(target) = target
                && follower.command(driver, &GimbalCommand { target })?
            {
                of_table.commands.fetch_add(1, Ordering::Relaxed);
            }
            Ok(())
        };
        let mut supervisor = Supervisor::with_duty(driver, plan.period, duty)?;
        for axis in TableAxis::ALL {
            supervisor.goto(axis, 0.0, None)?;
        }
        let status = rest(&mut supervisor, &plan.port, plan.start, |supervisor| {
            supervisor.emergency().check()
        })?;
        for axis in TableAxis::ALL {
            let found_rad = status.of(axis).angle_rad;
            if !(found_rad.abs() <= plan.tolerance_rad) {
                return Err(Error::Elsewhere {
                    axis,
                    found: found_rad.to_degrees(),
                    expected: 0.0,
                    tolerance: plan.tolerance_rad.to_degrees(),
                });
            }
        }
        others(&host, plan, &stop)?;
        // Looks from the way to zero would leave no room for the next ones.
        while looks.pop().is_ok() {}
        Ok(Self { supervisor, stop, shared, looks, track: Track::new(), host, _button: button })
    }

    /// Stores the set point of the core.
    pub fn command(&self, command: &GimbalCommand) {
        self.shared.target.store(packed(command.target), Ordering::Release);
        self.shared.follows.store(true, Ordering::Release);
    }

    /// Takes the looks since the last call.
    pub fn take_looks(&mut self) {
        while let Ok(status) = self.looks.pop() {
            self.track.add(&status);
        }
    }

    /// Angle of an axis at a time, as far as the looks were taken.
    #[must_use]
    pub fn at(&self, axis: TableAxis, when: Instant) -> Option<TrackPoint> {
        self.track.at(axis, when)
    }

    /// True if the table was stopped. Takes no lock.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.stop.is_tripped()
    }

    /// Reason for the stop, if there was one.
    #[must_use]
    pub fn stopped(&self) -> Option<String> {
        self.stop.check().err().map(|error| match error {
            Error::Stopped { why } => why,
            error => error.to_string(),
        })
    }

    /// Stops the table at once, and for good.
    pub fn trip(&self, why: &str) {
        self.stop.trip(why);
        self.host.stopped(why);
    }

    /// Other runs at the table.
    #[must_use]
    pub fn host(&self) -> &TableHost {
        &self.host
    }

    /// Waits, while the table rests at its last set point, until the other runs have ended or the program is interrupted.
    ///
    /// # Errors
    /// If one of them still goes on after `within`, or the table was stopped.
    pub fn wait_for_others(&self, within: Duration) -> Result<(), Error> {
        let until = Instant::now() + within;
        while self.host.has_open() && !octant_base::interrupt::seen() {
            self.stop.check()?;
            if Instant::now() > until {
                return Err(Error::Unended { within });
            }
            std::thread::sleep(WAIT);
        }
        Ok(())
    }

    /// Counts of the communication so far.
    #[must_use]
    pub fn traffic(&self) -> TableTraffic {
        TableTraffic {
            looks: self.shared.looks.load(Ordering::Relaxed),
            commands: self.shared.commands.load(Ordering::Relaxed),
        }
    }

    /// Brakes the table, waits until it rests, and releases it.
    ///
    /// # Errors
    /// If the table doesn't come to rest: by then every stop command was sent.
    pub fn finish(self) -> Result<(), Error> {
        match self.stopped() {
            Some(why) => self.host.stopped(&why),
            None => self.host.end(),
        }
        self.supervisor.finish()
    }
}

/// Waits at zero for the other runs, and lets all begin.
fn others(host: &TableHost, plan: &TablePlan, stop: &EmergencyStop) -> Result<(), Error> {
    let until = Instant::now() + plan.start;
    while !host.is_complete() {
        stop.check()?;
        if octant_base::interrupt::seen() {
            return Err(Error::Interrupted);
        }
        if Instant::now() > until {
            return Err(Error::Alone {
                port: plan.port.clone(),
                found: host.present(),
                expected: host.units(),
                within: plan.start,
            });
        }
        std::thread::sleep(WAIT);
    }
    host.begin();
    Ok(())
}

/// Waits until both axes have rested for a while; returns their status then.
pub(crate) fn rest<T: Turntable>(
    table: &mut T,
    port: &str,
    within: Duration,
    mut meanwhile: impl FnMut(&mut T) -> Result<(), Error>,
) -> Result<TableStatus, Error> {
    let until = Instant::now() + within;
    let mut before: Option<TableStatus> = None;
    let mut since = Instant::now();
    loop {
        meanwhile(table)?;
        let status = table.status()?;
        let rests = |axis: TableAxis| match status.of(axis).moving {
            Some(moving) => !moving,
            None => before.is_some_and(|before| {
                (status.of(axis).angle_rad - before.of(axis).angle_rad).abs() < STILL_RAD
            }),
        };
        if !TableAxis::ALL.into_iter().all(rests) {
            since = Instant::now();
        } else if since.elapsed() >= RESTED {
            return Ok(status);
        }
        if Instant::now() > until {
            return Err(Error::Moving { port: port.to_owned(), within });
        }
        before = Some(status);
        std::thread::sleep(WAIT);
    }
}
