//! `octant watch`.

use crate::failure::Failure;
use crate::followed::{unreadable, verdict};
#[cfg(not(feature = "dashboard"))]
use crate::terminal::note;
use crate::terminal::print;
use clap::Args;
use octant_verdict::Verdict;
use octant_watch::follow::{Follow, Stage};
use octant_watch::place::RunPlace;
use octant_watch::plain;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
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
    let Arguments { run, plain, once: now, foxglove } = arguments;
    let place = match run {
        Some(run) => RunPlace::of(run),
        None => RunPlace::newest(Path::new(RUNS)),
    };
    let place = place.map_err(|error| Failure::input(format!("failed to {error}")))?;
    let follow = Follow::new(place);
    if let Some(address) = foxglove {
        return super::live::serve(follow, address);
    }
    if *now {
        return once(follow);
    }
    if *plain || !std::io::stdout().is_terminal() {
        return lines(follow);
    }
    #[cfg(feature = "dashboard")]
    return crate::screen::show(follow, LOOK);
    #[cfg(not(feature = "dashboard"))]
    {
        note!(
            "this program was built without the dashboard (cargo build --release --features \
             octant/dashboard): here is a line a second",
        );
        lines(follow)
    }
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
