//! Progress on a terminal: simulated time, speed and time left. Silent elsewhere.

use crate::case_progress::duration;
use crate::progress_bar::ProgressBar;
use octant_base::control::{Control, SetAtEnd};
use octant_base::interrupt;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Shows the progress of some runs while `work` does them, and passes Ctrl-C on.
///
/// `epochs` is the total that the controls will count, `sample_s` the length of one.
pub(super) fn with_progress<T>(
    controls: &[Control],
    epochs: Option<u64>,
    sample_s: f64,
    work: impl FnOnce() -> T,
) -> T {
    Follower::Terminal.follow(controls, epochs, sample_s, work)
}

/// Does `work` without a line of progress, and passes Ctrl-C on to its control.
pub(super) fn interruptible<T>(work: impl FnOnce(&Control) -> T) -> T {
    let control = Control::default();
    watch_interrupts();
    let stop = |controls: &[Control], _: Option<u64>| {
        if interrupt::seen() {
            controls.iter().for_each(|control| control.cancel.store(true, Ordering::Relaxed));
        }
    };
    let controls = std::slice::from_ref(&control);
    Follower::Host(&stop).follow(controls, None, 0.0, || work(&control))
}

/// Program that follows the progress of runs, and may end them.
pub(crate) enum Follower<'a> {
    /// This one, on a terminal.
    Terminal,
    /// Another one: a function with the controls and the total, called 50 times a second.
    Host(&'a (dyn Fn(&[Control], Option<u64>) + Sync)),
}

impl Follower<'_> {
    /// Handles interrupts from now on if this program is the one that follows: before a run has a folder, so that
    /// no interrupt leaves one without a word.
    pub(crate) fn watch_interrupts(&self) {
        if matches!(self, Self::Terminal) {
            watch_interrupts();
        }
    }

    /// Follows some runs while `work` does them.
    ///
    /// `epochs` is the total that the controls will count, `sample_s` the length of one.
    pub(crate) fn follow<T>(
        &self,
        controls: &[Control],
        epochs: Option<u64>,
        sample_s: f64,
        work: impl FnOnce() -> T,
    ) -> T {
        let done = std::sync::atomic::AtomicBool::new(false);
        let done = &done;
        self.watch_interrupts();
        std::thread::scope(|scope| {
            scope.spawn(move || match self {
                Self::Terminal => show(controls, epochs, sample_s, done),
                Self::Host(look) => {
                    while !done.load(Ordering::Relaxed) {
                        std::thread::sleep(Duration::from_millis(20));
                        look(controls, epochs);
                    }
                }
            });
            let _done = SetAtEnd(done);
            work()
        })
    }
}

fn show(
    controls: &[Control],
    epochs: Option<u64>,
    sample_s: f64,
    done: &std::sync::atomic::AtomicBool,
) {
    let bar = ProgressBar::new(epochs, |progress| match progress.total {
        Some(total) => {
            let percent = 100 * progress.done.min(total) / total.max(1);
            format!("{percent:>3} %  {}", progress.message)
        }
        None => progress.message.clone(),
    });
    let started = Instant::now();
    let mut stopped = false;
    while !done.load(Ordering::Relaxed) {
        std::thread::sleep(Duration::from_millis(20));
        if interrupt::seen() {
            for control in controls {
                control.cancel.store(true, Ordering::Relaxed);
            }
            // A table is stopped at once, before the run notices the interrupt.
            if !std::mem::replace(&mut stopped, true) {
                octant_turntable::stop_all("the run was interrupted");
            }
        }
        let passed: u64 = controls.iter().map(|c| c.epochs.load(Ordering::Relaxed)).sum();
        let wall_s = started.elapsed().as_secs_f64();
        let simulated_s = passed as f64 * sample_s;
        let left = match epochs {
            Some(epochs) if (1..epochs).contains(&passed) => {
                let left_s = wall_s * (epochs as f64 / passed as f64 - 1.0);
                format!(", {} left", duration(left_s))
            }
            _ => String::new(),
        };
        let speed = simulated_s / wall_s.max(1e-3);
        bar.update(|progress| {
            progress.done = passed;
            let hours = simulated_s / 3600.0;
            progress.message = format!("{hours:.1} h simulated, {speed:.0} times real time{left}");
        });
    }
    bar.finish();
}

/// Handles Ctrl-C: the first one ends the run in order, the second one at once.
pub(super) fn watch_interrupts() {
    // If no handler can be set, Ctrl-C ends the program at once; the recording survives.
    let _ = interrupt::watch(|| {
        octant_turntable::stop_all("the program was interrupted");
        octant_power::write_all_ends();
        std::process::exit(i32::from(octant_verdict::Verdict::Error.exit_code()));
    });
}

/// Leaves interrupts to the process that started this one: a signal ends this one at once,
/// which tells the other that there is no result.
pub(super) fn leave_interrupts_to(parent: u32) -> std::io::Result<()> {
    interrupt::leave();
    octant_campaign::execute::process::end_with(parent)
}
