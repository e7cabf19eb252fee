//! `octant serve`: the core as a live endpoint that a harness drives.

use crate::arguments::{ScenarioArguments, load};
use crate::failure::Failure;
use crate::terminal::note;
use clap::Args;
use octant_base::interrupt;
use octant_endpoint::ServedCore;
use octant_link::Uri;
use octant_link::device::{Notice, serve};
use octant_realtime::schedule::{self, Wish};
use octant_run::{MethodError, SetupError, core_of};
use octant_scenario::{Method, Scenario};
use octant_verdict::Verdict;
use octant_wire::message::StepPacing;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Scenario that configures the core, the same as the harness runs; by default an empty one:
    /// every key has its default.
    #[arg(value_name = "SCENARIO")]
    scenario: Option<PathBuf>,
    /// Change one key of the scenario, as the harness does.
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    #[arg(long, value_name = "URI", help = octant_link::uri::server_help())]
    endpoint: String,
    /// Seed of the harness's run, instead of the scenario's.
    #[arg(long, value_name = "N", value_parser = crate::arguments::seed, allow_negative_numbers = true)]
    seed: Option<u64>,
    /// Seconds without a message after which the harness counts as gone; 0: never.
    #[arg(long, value_name = "S", default_value_t = 5.0)]
    silence: f64,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let Arguments { scenario: file, set, endpoint, seed, silence } = arguments;
    let uri: Uri = endpoint
        .parse()
        .map_err(|error| Failure::input(format!("failed to read --endpoint: {error}")))?;
    let silence_ms = silence_ms(*silence)?;
    let scenario = scenario(file.as_deref(), set)?;
    let seed = seed.unwrap_or(scenario.seed);
    let core =
        core_of(&scenario, Method::Primary, seed).map_err(|error| Failure::from(error).failed())?;
    let mut served = ServedCore::new(&core)
        .map_err(|error| Failure::from(MethodError::from(SetupError::Core(error))).failed())?;
    // However often it is interrupted, it ends in order.
    interrupt::watch(|| {})
        .map_err(|error| Failure::bench(format!("failed to wait for Ctrl-C: {error}")))?;
    // Called on the serving thread: for a session by the clock, this thread requests the real-time
    // settings of the harness's sample thread, at a slightly lower priority.
    let mut granted = None;
    let mut notice = |notice: &Notice| {
        note!("octant: {notice}");
        match notice {
            Notice::Began { pacing: StepPacing::RealTime, .. } => {
                let wish = Wish { priority: Some(79), lock_memory: false, cpu: None };
                granted = Some(schedule::apply(&wish));
            }
            Notice::Over { .. } => granted.take().iter().for_each(schedule::release),
            _ => {}
        }
    };
    let facts = served.facts(silence_ms);
    serve(&uri, facts, &mut served, &mut notice, interrupt::flag())
        .map_err(|error| Failure::bench(format!("failed to {error}")))?;
    note!("octant: stopped");
    Ok(Verdict::Pass)
}

fn silence_ms(seconds: f64) -> Result<u16, Failure> {
    let ms = (seconds * 1e3).round();
    if (0.0..=f64::from(u16::MAX)).contains(&ms) {
        return Ok(ms as u16);
    }
    Err(Failure::input(format!(
        "--silence: found {seconds}, expected seconds from 0 (never) to 65.535"
    )))
}

fn scenario(file: Option<&Path>, set: &[String]) -> Result<Scenario, Failure> {
    match file {
        Some(path) => {
            let arguments = ScenarioArguments { scenario: path.to_owned(), set: set.to_vec() };
            // The scenario describes a run with a device: its settings for the device take effect
            // here.
            let device = "endpoint.uri=\"serial:device\"".to_owned();
            load(&arguments, &[device])
        }
        None if set.is_empty() => {
            Scenario::parse("schema = 1\n", "no scenario", Path::new(""), &[])
                .map_err(Failure::input)
        }
        None => Err(Failure::input("--set: found no scenario, expected one to change")),
    }
}
