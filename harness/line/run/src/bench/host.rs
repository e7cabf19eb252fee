//! Faults of the host that the harness runs on: occupied processors, a full disk, a stalled
//! recorder.
//!
//! The thread of the samples triggers them ([`Hosted::begin`]) with a store and, for starved
//! processors, by waking one thread. Other threads carry them out: the recorder's thread, its file,
//! and threads that were started before the run.

use super::error::SetupError;
use super::recording::StreamKeeping;
use octant_faults::FaultKind;
use octant_faults::catalogue::Acts;
use octant_faults::kinds::host::{FULL, STALLED, STARVED};
use octant_faults::rule::{HostAction, Hosted};
use octant_realtime::clock::{MonotonicTime, now};
use octant_realtime::schedule::{self, Granted, Wish};
use octant_recorder::{Event, RecorderTrouble};
use octant_scenario::Scenario;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::sync_channel;
use std::thread::{JoinHandle, Thread};

/// Host of one run. By default it is no target for faults.
#[derive(Debug, Default)]
pub struct RunHost {
    recorder: Option<RecorderTrouble>,
    burners: Option<Burners>,
}

impl RunHost {
    /// Creates the host of a scenario's run, as a target for its faults; `recorder` is the trouble
    /// switch of the run's recorder.
    ///
    /// # Errors
    /// If a fault has no target in such a run.
    pub fn new(
        scenario: &Scenario,
        recording: &StreamKeeping<'_>,
        recorder: &RecorderTrouble,
    ) -> Result<Self, SetupError> {
        let mut host = Self::default();
        let of_host = |fault: &&octant_scenario::Fault| fault.spec.kind.acts == Acts::Host;
        for fault in scenario.faults.iter().filter(of_host) {
            let refused = |reason: String| SetupError::Fault { id: fault.spec.id.clone(), reason };
            if let Some(reason) = without(fault.spec.kind, recording) {
                return Err(refused(reason.to_owned()));
            }
            host.recorder.get_or_insert_with(|| recorder.clone());
            if fault.spec.kind.name == STARVED.name {
                let threads = fault.spec.values.integer("threads").unwrap_or(1).max(1) as usize;
                let priority = scenario.realtime.priority;
                let most = threads.max(host.burners.as_ref().map_or(0, |b| b.threads));
                host.burners = Some(Burners::start(most, priority).map_err(|error| {
                    refused(format!("no threads to take the processors with: {error}"))
                })?);
            }
        }
        Ok(host)
    }

    /// Returns the event that is recorded at the end of a run.
    pub(crate) fn event(&self) -> Option<Event> {
        let burners = self.burners.as_ref()?;
        let all_ns = burners.shared.burned_ns.load(Ordering::Relaxed);
        Some(Event::Host {
            scheduling: burners.granted.scheduling.text(),
            taken_s: all_ns as f64 * 1e-9,
            threads: burners.all.len(),
        })
    }
}

/// Returns the reason why a kind has no effect in such a run.
fn without(kind: &FaultKind, recording: &StreamKeeping<'_>) -> Option<&'static str> {
    match recording {
        StreamKeeping::File(_) => None,
        StreamKeeping::Hash | StreamKeeping::HashAlone | StreamKeeping::None => match kind.name {
            name if name == FULL.name => {
                Some("it happens to the file of a recording, and this run writes none")
            }
            name if name == STALLED.name => {
                Some("it happens to the thread of a recorder, and this run has none")
            }
            _ => None,
        },
    }
}

impl Hosted for RunHost {
    fn begin(&mut self, action: &HostAction) -> bool {
        let ns = |time_s: f64| (time_s * 1e9) as u64;
        match (action, &self.recorder, &self.burners) {
            (HostAction::Starve { lasts_s, threads }, _, Some(burners)) => {
                burners.begin(ns(*lasts_s), *threads);
                true
            }
            (HostAction::FillDisk, Some(recorder), _) => {
                recorder.fill_disk();
                true
            }
            (HostAction::StallRecorder { pause_s }, Some(recorder), _) => {
                recorder.stall(ns(*pause_s));
                true
            }
            _ => false,
        }
    }
}

/// Threads that occupy the processors. They sleep until they are woken.
#[derive(Debug)]
struct Burners {
    shared: Arc<Shared>,
    /// Number of threads per processor.
    threads: usize,
    /// Thread that wakes the others; the thread of the samples wakes this one.
    first: Thread,
    all: Vec<JoinHandle<()>>,
    /// Real-time settings that the host granted them.
    granted: Granted,
}

#[derive(Debug, Default)]
struct Shared {
    /// End of the burning, ns of the host's clock.
    until_ns: AtomicU64,
    /// Number of threads per processor that burn.
    threads: AtomicU64,
    /// Total time of burning, ns.
    burned_ns: AtomicU64,
    over: AtomicBool,
}

/// Rounds between two readings of the clock: about a microsecond.
const ROUNDS: u32 = 1000;

/// Stack of a thread that only counts, bytes. All of it may be locked in memory.
const STACK_BYTES: usize = 64 * 1024;

impl Burners {
    /// Starts this number of threads for each processor.
    fn start(threads: usize, priority: Option<u8>) -> std::io::Result<Self> {
        let cpus = schedule::processors();
        let processors = cpus.len();
        let shared = Arc::new(Shared::default());
        let (tell, told) = sync_channel(1);
        let mut all = Vec::with_capacity(processors * threads);
        // The last one started is woken first: it knows the others.
        for number in (0..processors * threads).rev() {
            let (here, tell) = (Arc::clone(&shared), tell.clone());
            let others: Vec<Thread> = match number {
                0 => all.iter().map(|other: &JoinHandle<()>| other.thread().clone()).collect(),
                _ => Vec::new(),
            };
            // A thread pinned to a processor outside this process's set would run on any other.
            let cpu = cpus.get(number % processors).copied();
            let burn = move || {
                let granted = schedule::apply(&Wish { priority, lock_memory: false, cpu });
                if number == 0 {
                    let _ = tell.send(granted);
                }
                here.serve((number / processors) as u64, &others);
            };
            let thread = std::thread::Builder::new()
                .name("burner".into())
                .stack_size(STACK_BYTES)
                .spawn(burn);
            match thread {
                Ok(thread) => all.push(thread),
                Err(error) => {
                    end(&shared, all);
                    return Err(error);
                }
            }
        }
        let first = match all.last() {
            Some(first) => first.thread().clone(),
            None => return Err(std::io::ErrorKind::NotFound.into()),
        };
        let granted = told.recv().map_err(|_| std::io::ErrorKind::BrokenPipe)?;
        Ok(Self { shared, threads, first, all, granted })
    }

    /// Lets the threads burn for a time from now on.
    fn begin(&self, lasts_ns: u64, threads: u32) {
        self.shared.threads.store(threads.into(), Ordering::Relaxed);
        self.shared.until_ns.fetch_max(now().after(lasts_ns).ns, Ordering::Release);
        self.first.unpark();
    }
}

impl Shared {
    /// Runs a thread, the `nth` of its processor.
    fn serve(&self, nth: u64, others: &[Thread]) {
        let mut done_ns = 0;
        while !self.over.load(Ordering::Relaxed) {
            let until = MonotonicTime { ns: self.until_ns.load(Ordering::Acquire) };
            if until.ns == done_ns {
                std::thread::park();
                continue;
            }
            done_ns = until.ns;
            others.iter().for_each(Thread::unpark);
            if nth < self.threads.load(Ordering::Relaxed) {
                self.burn(until);
            }
        }
    }

    fn burn(&self, until: MonotonicTime) {
        let began = now();
        let mut at = began;
        while at < until && !self.over.load(Ordering::Relaxed) {
            for round in 0..ROUNDS {
                std::hint::black_box(round);
            }
            at = now();
        }
        self.burned_ns.fetch_add(at.since(began), Ordering::Relaxed);
    }
}

impl Drop for Burners {
    fn drop(&mut self) {
        end(&self.shared, std::mem::take(&mut self.all));
    }
}

/// Ends threads, even those that burn at this moment.
fn end(shared: &Shared, all: Vec<JoinHandle<()>>) {
    shared.over.store(true, Ordering::Relaxed);
    for thread in all {
        thread.thread().unpark();
        // The thread can't panic, and no one is left to report to.
        let _ = thread.join();
    }
}
