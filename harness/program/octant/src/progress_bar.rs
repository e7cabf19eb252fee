//! A bar of progress on the last line of a terminal; nothing where stderr is none.

use crate::terminal::{is_asking, note, printable};
use std::io::{IsTerminal, Write};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Shortest time between two drawings.
const REDRAW: Duration = Duration::from_millis(100);
/// Columns of a terminal that doesn't tell its width.
const COLUMNS: usize = 80;

/// Progress of some work.
#[derive(Debug)]
pub(crate) struct Progress {
    /// Units of work done.
    pub(crate) done: u64,
    /// Units of work in all, if known.
    pub(crate) total: Option<u64>,
    /// What is being done.
    pub(crate) message: String,
    drawn: Option<Instant>,
}

/// Renders a line of at most this many columns: the bar, if the total is known, and the words after it.
#[must_use]
pub fn bar_line(done: u64, total: Option<u64>, words: &str, columns: usize) -> String {
    let words: String = printable(words).chars().take(columns).collect();
    let room = columns.saturating_sub(words.chars().count() + 1);
    let (Some(total), 1..) = (total, room) else { return words };
    let share = done.min(total) as f64 / total.max(1) as f64;
    let full = (share * room as f64) as usize;
    format!("{}{} {words}", "█".repeat(full), "░".repeat(room - full))
}

/// A bar that threads may share.
#[derive(Debug)]
pub(crate) struct ProgressBar {
    progress: Mutex<Progress>,
    words: fn(&Progress) -> String,
    shown: bool,
}

impl ProgressBar {
    /// Makes a bar, with the text after it.
    pub(crate) fn new(total: Option<u64>, words: fn(&Progress) -> String) -> Self {
        let progress = Progress { done: 0, total, message: String::new(), drawn: None };
        Self { progress: Mutex::new(progress), words, shown: std::io::stderr().is_terminal() }
    }

    /// Changes the progress, and draws it if the last drawing is old.
    pub(crate) fn update(&self, change: impl FnOnce(&mut Progress)) {
        let mut progress = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        change(&mut progress);
        let is_due = progress.drawn.is_none_or(|at| at.elapsed() >= REDRAW);
        if self.shown && is_due && !is_asking() {
            self.draw(&mut progress);
        }
    }

    /// Returns whether the bar is shown: stderr is a terminal.
    pub(crate) fn is_shown(&self) -> bool {
        self.shown
    }

    /// Prints a line on stderr, above the bar.
    pub(crate) fn note(&self, line: &str) {
        let mut progress = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        clear(&mut progress);
        note!("{line}");
        if self.shown {
            self.draw(&mut progress);
        }
    }

    /// Takes the bar off the terminal.
    pub(crate) fn finish(&self) {
        clear(&mut self.progress.lock().unwrap_or_else(PoisonError::into_inner));
    }

    fn draw(&self, progress: &mut Progress) {
        // The last column stays free: some terminals break the line after it.
        let columns = columns().saturating_sub(1);
        let words = (self.words)(progress);
        let line = bar_line(progress.done, progress.total, &words, columns);
        progress.drawn = Some(Instant::now());
        write(&format!("\r{line:columns$}"));
    }
}

/// Clears the line, if something was drawn on it.
fn clear(progress: &mut Progress) {
    if progress.drawn.take().is_some() {
        write(&format!("\r{:1$}\r", "", columns().saturating_sub(1)));
    }
}

fn write(text: &str) {
    // A terminal that has gone is no failure of the work.
    let mut terminal = std::io::stderr().lock();
    let _ = terminal.write_all(text.as_bytes()).and_then(|()| terminal.flush());
}

#[cfg(target_os = "linux")]
fn columns() -> usize {
    let size = rustix::termios::tcgetwinsize(std::io::stderr());
    size.map_or(COLUMNS, |size| match size.ws_col {
        0 => COLUMNS,
        columns => columns.into(),
    })
}

#[cfg(not(target_os = "linux"))]
fn columns() -> usize {
    COLUMNS
}
