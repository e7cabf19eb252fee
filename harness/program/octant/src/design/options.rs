//! Options of `octant design`.

use crate::arguments::{ScenarioArguments, seconds, seed};
use crate::failure::Failure;
use clap::{ArgGroup, Args, ValueEnum};
use octant_base::names::suggestion;
use octant_base::pool;
use octant_design::Rotation;
use octant_design::candidate::{Gimbals, Limits};
use octant_design::measure::DesignMeasure;
use octant_design::search::SearchEffort;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("kept").args(["out", "state"]).multiple(true)))]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(super) scenario: ScenarioArguments,
    /// Measure to minimise: longitude, latitude or radial, the rms in the last 3 h of navigation; with
    /// .time-rms over all of it, with .final at its end, with .largest the largest error, by draws; or the σ of
    /// a parameter, such as sigma.g_zz.
    #[arg(long, value_name = "MEASURE", default_value = "longitude")]
    pub(super) minimise: String,
    /// Duration of the calibration, in place of the scenario's; with --shortest the longest.
    #[arg(long, value_name = "TIME")]
    pub(super) duration: Option<String>,
    /// Rotation in navigation that the sequence is designed for.
    #[arg(long, value_enum, default_value_t = RotationChoice::Scenario)]
    pub(super) rotation: RotationChoice,
    #[command(flatten)]
    pub(super) limits: LimitArguments,
    /// Seed of the search.
    #[arg(long, value_name = "N", default_value = "1", value_parser = seed)]
    pub(super) seed: u64,
    /// Work of the search.
    #[arg(long, value_enum, default_value_t = EffortChoice::Normal)]
    pub(super) effort: EffortChoice,
    /// Number of threads; by default the number of processors. The result doesn't depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(super) jobs: Option<u16>,
    /// Find the shortest calibration that keeps the drift of eight positions in 4 h.
    #[arg(long, conflicts_with_all = ["state", "resume"])]
    pub(super) shortest: bool,
    /// Evaluate continuous rotation too, beside the design.
    #[arg(long)]
    pub(super) continuous: bool,
    /// Confirm the design by simulation: this many paired runs of it and of eight positions with the sixteen
    /// moves in the same time, on the same instruments with the same noise. A design that doesn't keep its
    /// promise is told, and the search goes on.
    #[arg(long, value_name = "SEEDS", conflicts_with = "shortest", value_parser = clap::value_parser!(u64).range(2..=100_000))]
    pub(super) confirm: Option<u64>,
    /// Sample rate of these runs.
    #[arg(long, value_name = "RATE", default_value = "20 Hz", requires = "confirm")]
    pub(super) confirm_rate: String,
    /// Largest number of designs that are tried.
    #[arg(long, value_name = "N", default_value_t = 3, requires = "confirm", value_parser = clap::value_parser!(u8).range(1..=16))]
    pub(super) confirm_attempts: u8,
    /// Write the scenario with the designed sequence and its rotation to this file.
    #[arg(long, value_name = "FILE")]
    pub(super) out: Option<PathBuf>,
    /// Keep the state of the search in this file, after every round.
    #[arg(long, value_name = "FILE")]
    pub(super) state: Option<PathBuf>,
    /// Go on from the state in --state.
    #[arg(long, requires = "state")]
    pub(super) resume: bool,
    /// Replace the files of --out and --state.
    #[arg(long, requires = "kept")]
    pub(super) force: bool,
    /// Print one JSON object.
    #[arg(long)]
    pub(super) json: bool,
}

/// Limits of gimbals and sequence.
#[derive(Debug, Args)]
pub(super) struct LimitArguments {
    /// Gimbals that may turn in one move.
    #[arg(long, value_enum, default_value_t = GimbalChoice::Both)]
    gimbals: GimbalChoice,
    /// Range of the azimuth gimbal, cumulative, deg.
    #[arg(long, value_name = "LOW..HIGH", default_value = "-360..360", value_parser = range, allow_hyphen_values = true)]
    azimuth_range: Range,
    /// Range of the roll gimbal, cumulative, deg.
    #[arg(long, value_name = "LOW..HIGH", default_value = "-360..360", value_parser = range, allow_hyphen_values = true)]
    roll_range: Range,
    /// Grid of the angles, deg.
    #[arg(long, value_name = "DEG", default_value_t = 45)]
    grid: i32,
    /// Largest number of stops.
    #[arg(long, value_name = "N", default_value_t = 40)]
    stops: usize,
    /// Time at rest at zero with which the sequence starts: the level alignment.
    #[arg(long, value_name = "TIME", default_value = "300 s")]
    lead_in: String,
    /// Duration of a quick round of the eight positions after it, with its moves: the errors are small then
    /// before the long dwells. By default there is none.
    #[arg(long, value_name = "TIME")]
    lead_in_round: Option<String>,
    /// Shortest dwell.
    #[arg(long, value_name = "TIME", default_value = "30 s")]
    dwell_min: String,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum RotationChoice {
    /// That of the scenario
    Scenario,
    /// Sixteen moves of 180 deg
    Sixteen,
    /// Twelve attitudes, out and back
    Tetrahedral,
    /// A sequence for each of the two shipped schemes, and the better pair of them
    Both,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum GimbalChoice {
    /// Both at once
    Both,
    /// One a move
    One,
    /// The azimuth gimbal alone
    Azimuth,
    /// The roll gimbal alone
    Roll,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum EffortChoice {
    /// Some seconds, for a first look
    Quick,
    /// Below five minutes on two processors
    Normal,
    /// Four times that
    Thorough,
}

impl EffortChoice {
    pub(super) fn work(self) -> SearchEffort {
        match self {
            Self::Quick => SearchEffort { chains: 8, rounds: 10, steps: 40 },
            Self::Normal => SearchEffort { chains: 16, rounds: 30, steps: 80 },
            Self::Thorough => SearchEffort { chains: 32, rounds: 60, steps: 80 },
        }
    }
}

/// Range of a gimbal, deg.
#[derive(Clone, Copy, Debug)]
pub(super) struct Range(i32, i32);

/// Parses a range on the command line.
pub(super) fn range(text: &str) -> Result<Range, String> {
    let expected = || "expected whole degrees such as -90..270".to_owned();
    let (low, high) = text.split_once("..").ok_or_else(expected)?;
    let number = |text: &str| text.trim().parse::<i32>().map_err(|_| expected());
    Ok(Range(number(low)?, number(high)?))
}

/// Finds the measure of --minimise.
pub(super) fn measure(name: &str) -> Result<DesignMeasure, Failure> {
    DesignMeasure::named(name).ok_or_else(|| {
        let all: Vec<String> = DesignMeasure::all().map(|measure| measure.name()).collect();
        let known = suggestion(name, all.iter().map(String::as_str), "measures");
        Failure::input(format!("--minimise: unknown measure {name:?}, {known}"))
    })
}

/// Rotations that a sequence is designed for.
pub(super) fn rotations(choice: RotationChoice) -> &'static [Rotation] {
    match choice {
        RotationChoice::Scenario => &[Rotation::Given],
        RotationChoice::Sixteen => &[Rotation::Sixteen],
        RotationChoice::Tetrahedral => &[Rotation::Tetrahedral],
        RotationChoice::Both => &[Rotation::Sixteen, Rotation::Tetrahedral],
    }
}

/// Limits of gimbals and sequence.
pub(super) fn limits(arguments: &LimitArguments) -> Result<Limits, Failure> {
    let LimitArguments {
        gimbals,
        azimuth_range,
        roll_range,
        grid,
        stops,
        lead_in,
        lead_in_round,
        dwell_min,
    } = arguments;
    let positive = |name: &str, text: &str| {
        let time_s = seconds(name, text)?;
        if time_s >= 0.0 {
            return Ok(time_s);
        }
        Err(Failure::input(format!("{name}: found {text:?}, expected a time of 0 or more")))
    };
    Ok(Limits {
        gimbals: match gimbals {
            GimbalChoice::Both => Gimbals::Both,
            GimbalChoice::One => Gimbals::One,
            GimbalChoice::Azimuth => Gimbals::Azimuth,
            GimbalChoice::Roll => Gimbals::Roll,
        },
        azimuth_deg: (azimuth_range.0, azimuth_range.1),
        roll_deg: (roll_range.0, roll_range.1),
        grid_deg: *grid,
        stops_max: *stops,
        dwell_min_s: positive("--dwell-min", dwell_min)?,
        lead_in_s: positive("--lead-in", lead_in)?,
        round_s: match lead_in_round {
            Some(time) => positive("--lead-in-round", time)?,
            None => 0.0,
        },
    })
}

/// Checks, before the search, that no file is lost to its result.
pub(super) fn refuse_to_replace(out: Option<&Path>, state: Option<&Path>) -> Result<(), Failure> {
    for (option, file) in [("--out", out), ("--state", state)] {
        if let Some(file) = file.filter(|file| file.exists()) {
            return Err(Failure::input(format!(
                "{option}: {} exists already, expected another name, or --force",
                file.display()
            )));
        }
    }
    Ok(())
}

/// Number of threads.
pub(super) fn threads(jobs: Option<u16>) -> usize {
    jobs.map_or_else(pool::processors, usize::from)
}
