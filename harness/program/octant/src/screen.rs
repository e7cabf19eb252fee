//! The dashboard of `octant watch`.

use crate::failure::Failure;
use crate::followed::{unreadable, verdict};
use crate::progress::watch_interrupts;
use crate::terminal::print;
use octant_base::interrupt;
use octant_verdict::Verdict;
use octant_watch::dashboard::{self, Page};
use octant_watch::follow::Follow;
use octant_watch::plain;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEventKind, KeyModifiers};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

/// Shows a run on the whole terminal, looking at it after so long; the terminal is restored
/// afterwards, even after a panic.
pub(super) fn show(mut follow: Follow, look: Duration) -> Result<Verdict, Failure> {
    let mut terminal = ratatui::try_init()
        .map_err(|error| Failure::bench(format!("failed to set up the terminal: {error}")))?;
    // An interrupt restores the terminal too.
    watch_interrupts();
    let shown = frames(&mut terminal, &mut follow, look);
    ratatui::restore();
    shown?;
    // The content of the screen is gone with it.
    print(&(plain::line(&follow) + "\n" + &plain::end(&follow)))?;
    verdict(&follow)
}

fn frames(
    terminal: &mut ratatui::DefaultTerminal,
    follow: &mut Follow,
    look: Duration,
) -> Result<(), Failure> {
    let failed =
        |error: std::io::Error| Failure::bench(format!("failed to use the terminal: {error}"));
    let mut page = Page::default();
    // A killed program may have left content there.
    terminal.clear().map_err(failed)?;
    let events = events().map_err(failed)?;
    while !interrupt::seen() {
        // One poll per frame: a long recording fills the screen while it is read.
        let more = follow.look(|_, _, _| {}).map_err(unreadable)?;
        terminal.draw(|frame| dashboard::draw(frame, follow, page)).map_err(failed)?;
        let wait = if more { Duration::ZERO } else { look };
        let event = match events.recv_timeout(wait) {
            Ok(event) => event.map_err(failed)?,
            Err(RecvTimeoutError::Timeout) => continue,
            // The terminal is gone.
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        };
        let Event::Key(key) = event else { continue };
        if key.kind == KeyEventKind::Release {
            continue;
        }
        match key.code {
            KeyCode::Char('q') | KeyCode::Esc => return Ok(()),
            KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => return Ok(()),
            KeyCode::Tab => page = page.next(),
            KeyCode::Char(key) => page = Page::of_key(key).unwrap_or(page),
            _ => {}
        }
    }
    Ok(())
}

/// Returns the keyboard events. They are read on a thread of their own, which ends with the
/// program: a terminal that is closed can block its reader.
fn events() -> std::io::Result<Receiver<std::io::Result<Event>>> {
    let (sender, receiver) = channel();
    std::thread::Builder::new().name("keys".to_owned()).spawn(move || {
        loop {
            let event = event::read();
            let is_last = event.is_err();
            if sender.send(event).is_err() || is_last {
                return;
            }
        }
    })?;
    Ok(receiver)
}
