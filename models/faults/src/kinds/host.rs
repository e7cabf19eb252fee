//! The harness's own host: processors, disk, recorder.

use crate::catalogue::{
    Acts, Dimension, Example, Family, FaultKind, FaultParameter, Lasts, ParameterBounds, Takes,
};
use crate::rule::{FaultRule, HostAction};
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;

pub(super) static KINDS: &[&FaultKind] = &[&STARVED, &FULL, &STALLED];

/// Needs a run by the clock: in other runs no thread can be late.
pub static STARVED: FaultKind = host(
    "host-cpu-starved",
    "Other work takes all processors from the harness.",
    "From its onset `threads` threads on each processor of the host compute without a pause, for \
     `length` of host time. They have the priority of the thread of the samples, SCHED_FIFO and \
     `realtime.priority`, where the host permits it: whoever sleeps then waits until they are through, \
     and samples leave late, all of those that were due, one right after the other. Where it isn't \
     permitted the threads are of the usual priority, and so is that of the samples: the scheduler \
     gives each its share, and samples are some milliseconds late. Which of the two it was is in the \
     recording, in an event of kind `host`.\n\n\
     Only by the clock can a sample be late: with `realtime.pace = \"free\"` it is refused. It lasts in \
     time of the host and not of the source, since the thread that counts samples is the one that is \
     starved.",
    &[
        time("length", "200 ms", "How long; host time."),
        FaultParameter {
            name: "threads",
            takes: Takes::Integer(1, 64),
            default: Some("4"),
            doc: "Threads on each processor; with SCHED_FIFO one is as good as many.",
        },
    ],
    |values, _| {
        let threads = u32::try_from(values.integer("threads")?)
            .map_err(|_| FaultBuildError::missing("threads"))?;
        Ok(FaultRule::Host(HostAction::Starve { lasts_s: above_zero(values, "length")?, threads }))
    },
);

/// Needs a recording in a file.
pub static FULL: FaultKind = host(
    "host-disk-full",
    "The disk of the recording is full.",
    "From its onset on the system takes not one byte more of the recording: every write to its file \
     fails as on a full disk, and so does the next flush of what was recorded. The disk stays full. The run \
     ends as a failure of the bench, exit status 4, within a second; what was written before stays \
     readable. It needs a recording: where a run keeps none, as in a sweep, it is refused.",
    &[],
    |_, _| Ok(FaultRule::Host(HostAction::FillDisk)),
);

/// Needs a recorder thread.
pub static STALLED: FaultKind = host(
    "host-recorder-stalled",
    "The recorder stands still for a time.",
    "From the next time that the recorder's thread is handed something, at most 250 ms after the onset, \
     it stands still for `pause` of host time, and the queue before it fills. In simulated time the run \
     waits where the queue is full: nothing is lost, and no bit of the result changes. By the clock \
     nothing waits: what finds no room is dropped and counted, and the run is inconclusive. The queue \
     has room for 8192 samples and the blocks of the recorder for 1024 more: 9 s at 1 kHz, 46 s at \
     200 Hz. A pause that is shorter is borne.",
    &[time("pause", "1 s", "How long it stands still; host time.")],
    |values, _| {
        Ok(FaultRule::Host(HostAction::StallRecorder { pause_s: above_zero(values, "pause")? }))
    },
);

const fn host(
    name: &'static str,
    summary: &'static str,
    model: &'static str,
    parameters: &'static [FaultParameter],
    build: fn(&Values, &Setup) -> Result<FaultRule, FaultBuildError>,
) -> FaultKind {
    let (family, acts, lasts) = (Family::Host, Acts::Host, Lasts::Instant);
    let example = Example::NONE;
    FaultKind { name, family, acts, summary, model, parameters, lasts, example, build }
}

const fn time(name: &'static str, default: &'static str, doc: &'static str) -> FaultParameter {
    let bounds = ParameterBounds::Within(0.0, 600.0, "above 0 s, up to 10 min");
    let takes = Takes::Quantity(&[Dimension::Time], bounds);
    FaultParameter { name, takes, default: Some(default), doc }
}

/// Reads a time, which has to be above zero to have an effect.
fn above_zero(values: &Values, name: &'static str) -> Result<f64, FaultBuildError> {
    let time_s = values.quantity(name)?;
    if time_s > 0.0 {
        return Ok(time_s);
    }
    Err(FaultBuildError::value(name, alloc::format!("{time_s} s, a time above 0 s is expected")))
}
