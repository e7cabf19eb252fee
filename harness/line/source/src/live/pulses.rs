//! Pulses at the whole seconds of an instrument's stamps.

use octant_base::number::counted;
use octant_instruments::align::UnitClockEstimate;
use octant_instruments::pulses::{PulseAlignment, PulseEstimate};
use octant_realtime::pps::{HostPulse, PulseEdge, PulseLooks, PulseReader};
use octant_recorder::event::BenchPulses;
use octant_scenario::UnitPulses;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Pause between two looks at the kernel's file. A pulse about a step of the clock is lost: the pause
/// is short against a second.
const LOOK: Duration = Duration::from_millis(10);
/// Number of pulses that may wait for the thread of the samples.
const WAITING: usize = 64;

/// Counts that the thread of the looks leaves, and the file with its last problem.
#[derive(Debug, Default)]
struct Shared {
    ends: AtomicBool,
    seen: Mutex<(PulseLooks, String)>,
}

/// Pulses, looked for by a thread of their own. The thread of the samples takes them without a lock.
#[derive(Debug)]
pub(super) struct Pulses {
    plan: UnitPulses,
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
    waiting: rtrb::Consumer<HostPulse>,
    alignment: PulseAlignment,
    /// Time of the last pulse that was taken; before it that of the start.
    last: Instant,
    /// Largest bound of the conversion of a pulse's time.
    converted_within: Duration,
}

impl Pulses {
    /// Opens the pulses of a scenario; file names are relative to `folder`.
    pub(super) fn open(plan: &UnitPulses, folder: &Path) -> Result<Self, String> {
        let edge = if plan.at_clear { PulseEdge::Clear } else { PulseEdge::Assert };
        let device = folder.join(&plan.device);
        let mut reader = PulseReader::open(&device.to_string_lossy(), edge)
            .map_err(|reason| format!("source.live.pps: {reason}"))?;
        let shared = Arc::new(Shared::default());
        let (mut found, waiting) = rtrb::RingBuffer::new(WAITING);
        let of_thread = Arc::clone(&shared);
        let looks = move || {
            while !of_thread.ends.load(Ordering::Acquire) {
                if let Some(pulse) = reader.look() {
                    // Without room nobody takes samples, and the silence is noticed.
                    let _ = found.push(pulse);
                }
                let mut seen = of_thread.seen.lock().unwrap_or_else(PoisonError::into_inner);
                *seen = (reader.looks(), reader.told());
                drop(seen);
                std::thread::sleep(LOOK);
            }
        };
        let thread = std::thread::Builder::new().name("pulses".to_owned()).spawn(looks);
        Ok(Self {
            plan: plan.clone(),
            shared,
            thread: Some(thread.map_err(|error| format!("source.live.pps: {error}"))?),
            waiting,
            alignment: PulseAlignment::new(),
            last: Instant::now(),
            converted_within: Duration::ZERO,
        })
    }

    /// Takes the pulses that came, with the clock by the arrivals; `host_ns` is the host time of an
    /// instant. Fails if they contradict each other or the arrivals, or if none came for long.
    pub(super) fn take(
        &mut self,
        arrivals: &UnitClockEstimate,
        now: Instant,
        host_ns: impl Fn(Instant) -> u64,
    ) -> Result<Option<PulseEstimate>, String> {
        while let Ok(pulse) = self.waiting.pop() {
            self.alignment
                .add(host_ns(pulse.at), arrivals)
                .map_err(|mismatch| format!("source.live.pps: {mismatch}"))?;
            self.last = pulse.at;
            self.converted_within = self.converted_within.max(pulse.within);
        }
        let silent = now.saturating_duration_since(self.last);
        if silent.as_secs_f64() > self.plan.silence_s {
            return Err(self.silent());
        }
        Ok(self.alignment.estimate())
    }

    /// Bound of the error of a time by the pulses, besides their jitter.
    pub(super) fn within(&self) -> Duration {
        self.converted_within + Duration::from_secs_f64(self.plan.within_s)
    }

    fn silent(&self) -> String {
        let (looks, file) = self.seen();
        format!(
            "source.live.pps: no pulse for {} s; seen so far: {}, {} of a number that stood still, {} at \
             another time than the host's, {} without a pulse's line; {file}",
            self.plan.silence_s,
            counted(looks.seen, "pulse", "pulses"),
            looks.repeated,
            looks.untimely,
            counted(looks.unread, "look", "looks"),
        )
    }

    fn seen(&self) -> (PulseLooks, String) {
        self.shared.seen.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Figures so far.
    pub(super) fn told(&self) -> BenchPulses {
        let ((looks, _), counts) = (self.seen(), self.alignment.counts());
        let estimate = self.alignment.estimate();
        BenchPulses {
            clock_steps: looks.steps,
            clock_step_largest_ms: looks.step_largest_ns as f64 * 1e-6,
            device: self.plan.device.clone(),
            off: counts.off,
            missing: counts.missing,
            repeated: looks.repeated,
            residual_us: estimate.map(|estimate| estimate.residual_ns * 1e-3),
            sigma_us: estimate.map(|estimate| estimate.sigma_ns * 1e-3),
            skew_ppm: estimate.map(|estimate| estimate.skew * 1e6),
            taken: counts.taken,
            unread: looks.unread,
            untimely: looks.untimely + looks.about_steps,
        }
    }
}

impl Drop for Pulses {
    fn drop(&mut self) {
        self.shared.ends.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            // A panic of the thread has nothing to add: pulses are missing then, which is noticed.
            let _ = thread.join();
        }
    }
}
