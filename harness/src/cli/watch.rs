//! `octant watch`.

use super::progress::interrupts;
use super::{Failure, print};
use crate::watch::dashboard::{self, Page};
use crate::watch::follow::{Follow, Stage};
use crate::watch::place::Place;
use crate::watch::plain;
use clap::Args;
use octant_requirements::Verdict;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEventKind, KeyModifiers};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Folder of runs that aren't named.
const RUNS: &str = "runs";
/// From one look at the recording to the next: it grows four times a second.
const LOOK: Duration = Duration::from_millis(125);
/// From one line to the next.
const LINE: Duration = Duration::from_secs(1);

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The run: its folder, or a recording. By default the one that began last in ./runs and goes on.
    #[arg(value_name = "RUN")]
    run: Option<PathBuf>,
    /// A line a second on stdout, until the run ends. It is so anyway where stdout is no terminal.
    #[arg(long)]
    plain: bool,
    /// Print what is known at this moment, and leave.
    #[arg(long, conflicts_with = "plain")]
    once: bool,
    /// Serve the run to Foxglove instead of showing it.
    #[arg(
        long,
        value_name = "ADDRESS",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = super::live::DEFAULT_ADDRESS,
        conflicts_with_all = ["plain", "once"]
    )]
    foxglove: Option<String>,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let place = match &arguments.run {
        Some(run) => Place::of(run),
        None => Place::newest(Path::new(RUNS)),
    };
    let place = place.map_err(|error| Failure::input(format!("failed to {error}")))?;
    let follow = Follow::new(place);
    if let Some(address) = &arguments.foxglove {
        return super::live::serve(follow, address);
    }
    if arguments.once {
        return once(follow);
    }
    if arguments.plain || !std::io::stdout().is_terminal() {
        return lines(follow);
    }
    screen(follow)
}

/// Looks until all that is there at the moment is known.
pub(super) fn catch_up(follow: &mut Follow) -> Result<(), Failure> {
    while follow.look(|_, _, _| {}).map_err(unreadable)? {}
    Ok(())
}

/// A recording that can't be read is bad input.
pub(super) fn unreadable(error: impl std::fmt::Display) -> Failure {
    Failure::input(format!("failed to {error}"))
}

fn once(mut follow: Follow) -> Result<Verdict, Failure> {
    catch_up(&mut follow)?;
    // One look can't tell a run that has just ended from one that was killed; two can.
    catch_up(&mut follow)?;
    if follow.stage == Stage::Starting {
        let folder = follow.place.folder().display();
        return Err(Failure::input(format!("{folder}: nothing is recorded yet")));
    }
    print(&plain::page(&follow))?;
    verdict(&follow)
}

fn lines(mut follow: Follow) -> Result<Verdict, Failure> {
    catch_up(&mut follow)?;
    let about = follow.place.folder().display().to_string();
    let title = &follow.state.about.title;
    print(&if title.is_empty() { format!("{about}\n") } else { format!("{about}: {title}\n") })?;
    let mut next = Instant::now();
    loop {
        catch_up(&mut follow)?;
        let is_over = follow.stage.is_over();
        if is_over || Instant::now() >= next {
            print(&(plain::line(&follow) + "\n"))?;
            next += LINE;
        }
        if is_over {
            print(&plain::end(&follow))?;
            return verdict(&follow);
        }
        std::thread::sleep(LOOK);
    }
}

/// That of a run that has ended; one that was left while it went on has none yet.
pub(super) fn verdict(follow: &Follow) -> Result<Verdict, Failure> {
    match &follow.stage {
        Stage::Ended(summary) => Ok(summary.verdict),
        Stage::Starting | Stage::Running | Stage::Recorded => Ok(Verdict::Pass),
        Stage::BrokenOff | Stage::Unjudged => {
            let folder = follow.place.folder().display();
            Err(Failure::bench(format!("{folder}: {}", plain::stage(follow))))
        }
    }
}

/// The terminal is given back as it was, also where a part of this panics.
fn screen(mut follow: Follow) -> Result<Verdict, Failure> {
    let mut terminal = ratatui::try_init()
        .map_err(|error| Failure::bench(format!("failed to take the terminal: {error}")))?;
    // Who is told to end gives the terminal back, too.
    interrupts::watch();
    let shown = show(&mut terminal, &mut follow);
    ratatui::restore();
    shown?;
    // What was on the screen is gone with it.
    print(&(plain::line(&follow) + "\n" + &plain::end(&follow)))?;
    verdict(&follow)
}

fn show(terminal: &mut ratatui::DefaultTerminal, follow: &mut Follow) -> Result<(), Failure> {
    let failed =
        |error: std::io::Error| Failure::bench(format!("failed to use the terminal: {error}"));
    let mut page = Page::default();
    // Somebody who was killed may have left something there.
    terminal.clear().map_err(failed)?;
    let events = events().map_err(failed)?;
    while !interrupts::seen() {
        // One look at a time: a long recording fills the screen while it is read.
        let more = follow.look(|_, _, _| {}).map_err(unreadable)?;
        terminal.draw(|frame| dashboard::draw(frame, follow, page)).map_err(failed)?;
        let wait = if more { Duration::ZERO } else { LOOK };
        let event = match events.recv_timeout(wait) {
            Ok(event) => event.map_err(failed)?,
            Err(RecvTimeoutError::Timeout) => continue,
            // The terminal has gone.
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

/// What comes from the keyboard. Read on a thread of its own, that ends with the program: a terminal
/// that is closed can hold who reads it.
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
