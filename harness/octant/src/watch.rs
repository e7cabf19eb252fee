//! `octant watch`.

use super::progress::watch_interrupts;
use crate::failure::Failure;
use crate::followed::{unreadable, verdict};
use crate::terminal::print;
use clap::Args;
use octant_base::interrupt;
use octant_requirements::Verdict;
use octant_watch::dashboard::{self, Page};
use octant_watch::follow::{Follow, Stage};
use octant_watch::place::Place;
use octant_watch::plain;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEventKind, KeyModifiers};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Default folder of runs.
const RUNS: &str = "runs";
/// Interval of the polls: the recording grows four times a second.
const LOOK: Duration = Duration::from_millis(125);
/// Interval of the lines.
const LINE: Duration = Duration::from_secs(1);

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder of the run, or its recording. By default the latest run in progress in ./runs.
    #[arg(value_name = "RUN")]
    run: Option<PathBuf>,
    /// Print a line a second until the run ends; the default where stdout is no terminal.
    #[arg(long)]
    plain: bool,
    /// Print the present state, and exit.
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

/// Polls until everything present is known.
pub(super) fn catch_up(follow: &mut Follow) -> Result<(), Failure> {
    while follow.look(|_, _, _| {}).map_err(unreadable)? {}
    Ok(())
}

fn once(mut follow: Follow) -> Result<Verdict, Failure> {
    catch_up(&mut follow)?;
    // One poll can't tell a run that has just ended from one that was killed; two can.
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

/// Shows the dashboard. The terminal is restored, even after a panic.
fn screen(mut follow: Follow) -> Result<Verdict, Failure> {
    let mut terminal = ratatui::try_init()
        .map_err(|error| Failure::bench(format!("failed to set up the terminal: {error}")))?;
    // An interrupt restores the terminal too.
    watch_interrupts();
    let shown = show(&mut terminal, &mut follow);
    ratatui::restore();
    shown?;
    // The content of the screen is gone with it.
    print(&(plain::line(&follow) + "\n" + &plain::end(&follow)))?;
    verdict(&follow)
}

fn show(terminal: &mut ratatui::DefaultTerminal, follow: &mut Follow) -> Result<(), Failure> {
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
        let wait = if more { Duration::ZERO } else { LOOK };
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
