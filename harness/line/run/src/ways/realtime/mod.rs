//! A run against the clock: sample k leaves at the start of the run plus k periods.
//!
//! `frames` keeps the results on the real-time thread: the loop waits in it for the frame and for
//! answers, and it puts the results into a ring (`entry`). It allocates nothing and touches no file.
//! `keep` runs on a second thread, which takes the entries out, records and observes. If the ring is
//! full an entry is dropped and counted, and the run is inconclusive.
//!
//! The clock has no effect on computed values: an endpoint that answers in time gives the bits of a
//! run in simulated time.

mod entry;
mod frames;
mod keep;

use self::frames::{Found, Frames, Limits};
use crate::bench::ended::TimeKeeping;
use crate::bench::steps::NoFaults;
use crate::bench::{Bench, Records};
use octant_endpoint::{Endpoint, RemoteClock};
use octant_realtime::lateness::Figures;
use octant_realtime::pace::FrameClock;
use octant_realtime::schedule;
use octant_realtime::series::{LatenessInterval, LatenessSeries};
use octant_scenario::Realtime;
use octant_score::summary::{DeviceClock, LatenessOverRun, LatenessQuantiles, PacingRecord};
use octant_source::Source;
use std::sync::atomic::{AtomicBool, Ordering};

/// Capacity of the ring: at 1 kHz the recorder may stall for eight seconds.
const ENTRIES: usize = 8192;

/// Runs a bench to its end as [`Bench::run`] does, but by the clock, on the calling thread,
/// which has the granted real-time settings until the run has ended. Time keeping stays with the bench
/// whatever the end was.
pub fn run<S: Source, E: Endpoint>(
    bench: &mut Bench<S, E, Records<'_>>,
    settings: &Realtime,
    period_ns: u64,
) {
    if bench.ended.is_some() {
        return;
    }
    // No frame begins after the last sample.
    bench.end_with_source();
    let (producer, consumer) = rtrb::RingBuffer::new(ENTRIES);
    let stop = AtomicBool::new(false);
    let Bench { source, endpoint, faulted, steps, keeper: records, .. } = bench;
    let (control, attended) = (records.control, records.attended.take());
    let (ended, kept, time) = std::thread::scope(|scope| {
        let stop = &stop;
        let keeper = scope.spawn(move || {
            let kept = keep::keep(consumer, records, stop);
            stop.store(true, Ordering::Relaxed);
            kept
        });
        let granted = schedule::apply(&schedule::Wish {
            priority: settings.priority,
            lock_memory: settings.lock_memory,
            cpu: settings.cpu,
        });
        let clock = clock(settings, period_ns, granted.is_realtime());
        let limits = Limits { silence_ns: settings.silence_ns, overruns_max: settings.overruns };
        let mut frames = Frames::new(clock, period_ns, limits, producer, stop, control, attended);
        let ended = match faulted {
            None => steps.go_on(source, &mut NoFaults, endpoint, &mut frames),
            Some(faulted) => steps.go_on(source, faulted, endpoint, &mut frames),
        };
        // Dropping the frames closes their end of the ring: the keeper takes the remaining entries,
        // and ends.
        let found = frames.found();
        schedule::release(&granted);
        let kept = keeper.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        let time =
            TimeKeeping { pacing: pacing(settings, &found, endpoint.remote_clock()), granted };
        (ended, kept, time)
    });
    bench.ended = Some(match kept {
        Ok(()) => ended,
        Err(error) => Err(error.into()),
    });
    bench.kept = Some(time);
}

/// Builds the figures of a run for its summary.
fn pacing(settings: &Realtime, found: &Found, clock: Option<RemoteClock>) -> PacingRecord {
    let report = found.clock.report();
    let of = |figures: Figures| LatenessQuantiles {
        p50: figures.p50_us,
        p99: figures.p99_us,
        p999: figures.p999_us,
        max: figures.max_us,
    };
    PacingRecord {
        frames: report.frames,
        period_us: report.period_us,
        lateness_us: of(report.lateness),
        lateness_histogram_ns: (found.clock.lateness().rows().iter())
            .map(|(edge_ns, count)| [*edge_ns, *count])
            .collect(),
        lateness_over_run: Some(over_run(found.clock.series())),
        overrun_us: settings.overrun_ns as f64 / 1e3,
        overruns: report.overruns,
        overruns_in_a_row: report.longest_row_of_overruns,
        first_overrun: report.first_overrun,
        slack_p1_us: report.slack_p1_us,
        answer_us: of(found.answers.figures()),
        late_answers: found.late_answers,
        missed_answers: found.missed_answers,
        not_sent: found.not_sent,
        device_clock: clock.map(|clock| DeviceClock {
            offset_us: clock.offset_ns / 1e3,
            bound_us: clock.bound_ns / 1e3,
            skew_ppm: clock.skew.map(|skew| skew * 1e6),
            exchanges: clock.exchanges,
        }),
        dropped_records: found.dropped,
    }
}

/// Lists the lateness over the run for its summary.
fn over_run(series: &LatenessSeries) -> LatenessOverRun {
    let of = |value: fn(&LatenessInterval) -> u64| series.intervals().iter().map(value).collect();
    LatenessOverRun {
        frames_per_interval: series.frames_per_interval(),
        least_ns: of(|interval| interval.least_ns),
        largest_ns: of(|interval| interval.largest_ns),
        overruns: of(|interval| interval.overruns),
    }
}

/// Creates the clock that paces the frames.
fn clock(settings: &Realtime, period_ns: u64, is_realtime: bool) -> FrameClock {
    FrameClock::start(octant_realtime::pace::FramePacing {
        period_ns,
        // Spinning without a real-time priority is worse than sleeping.
        spin_ns: if is_realtime { settings.spin_ns } else { 0 },
        overrun_ns: settings.overrun_ns,
    })
}
