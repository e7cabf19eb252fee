//! The table under the instrument.

use crate::SourceError;
use octant_base::number::counted;
use octant_recorder::event::{BenchAngles, BenchAxis, BenchShared, BenchTable};
use octant_sample::{GimbalAngles, GimbalCommand};
use octant_scenario::{Drive, TableDriver};
use octant_turntable::{Following, GuestEnd, TableAxis, TableGuest, TrackPoint};
use std::path::Path;
use std::time::{Duration, Instant};

/// Table under the instrument.
#[derive(Debug)]
pub struct Table {
    turns: Turns,
    drive: Drive,
    /// Name of the table's dialect.
    language: String,
    ages: Ages,
}

/// How the table is turned.
#[derive(Debug)]
enum Turns {
    /// It follows the set point of this run's core.
    Driven(Box<Following>),
    /// Another run drives it.
    Elsewhere(TableGuest),
}

impl Turns {
    fn at(&self, axis: TableAxis, when: Instant) -> Option<TrackPoint> {
        match self {
            Self::Driven(following) => following.at(axis, when),
            Self::Elsewhere(guest) => guest.at(axis, when),
        }
    }

    fn take_looks(&mut self) {
        match self {
            Self::Driven(following) => following.take_looks(),
            Self::Elsewhere(guest) => guest.take_looks(),
        }
    }

    fn is_stopped(&self) -> bool {
        match self {
            Self::Driven(following) => following.is_stopped(),
            Self::Elsewhere(guest) => guest.is_stopped(),
        }
    }

    fn stopped(&self) -> Option<String> {
        match self {
            Self::Driven(following) => following.stopped(),
            Self::Elsewhere(guest) => guest.stopped(),
        }
    }

    fn traffic(&self) -> octant_turntable::TableTraffic {
        match self {
            Self::Driven(following) => following.traffic(),
            Self::Elsewhere(guest) => guest.traffic(),
        }
    }

    /// Other runs at the table.
    fn shared(&self) -> Option<BenchShared> {
        let said = |end: &GuestEnd| match end {
            GuestEnd::Open => "still went on".to_owned(),
            GuestEnd::Done => "had all its samples".to_owned(),
            GuestEnd::Left(why) => format!("left: {why}"),
        };
        match self {
            Self::Driven(following) => {
                let host = following.host();
                (host.units() > 1).then(|| BenchShared {
                    driven_by_another: false,
                    others: host.ends().iter().map(said).collect(),
                    units: host.units(),
                })
            }
            Self::Elsewhere(guest) => Some(BenchShared {
                driven_by_another: true,
                others: Vec::new(),
                units: guest.units(),
            }),
        }
    }
}

/// Ages of the angles that samples were given.
#[derive(Clone, Copy, Debug, Default)]
struct Ages {
    given: u64,
    /// Number of samples without angles: the nearest reading of the table was too far away in time.
    without: u64,
    sum: Duration,
    largest: Duration,
    /// Half of the longest time from query to reply.
    within: Duration,
}

/// Summary of the table at the end of a run.
pub(super) struct TableSummary {
    pub(super) table: String,
    pub(super) angles: String,
    pub(super) figures: BenchTable,
}

impl Table {
    /// Takes over the table and moves it to the start position of a run; or waits for the run that does so.
    ///
    /// # Errors
    /// If it doesn't obey.
    pub fn start(drive: &Drive, folder: &Path) -> Result<Self, SourceError> {
        let made =
            |turns, language| Self { turns, drive: drive.clone(), language, ages: Ages::default() };
        if drive.driver == TableDriver::AnotherRun {
            let guest = TableGuest::join(&drive.port, drive.start).map_err(SourceError::Table)?;
            return Ok(made(Turns::Elsewhere(guest), "driven by another run".to_owned()));
        }
        let plan = drive.plan(folder).map_err(SourceError::Table)?;
        let program = std::env::current_exe().map_err(|error| {
            let reason = format!("failed to find this program: {error}");
            SourceError::Table(octant_turntable::Error::Guard { reason })
        })?;
        let mut guard = octant_base::child::command(program);
        guard.args(["turntable", "guard"]);
        let following = Following::start(&plan, &mut guard).map_err(SourceError::Table)?;
        let language = plan.dialect.name().to_owned();
        Ok(made(Turns::Driven(Box::new(following)), language))
    }

    fn stopped(&self, reason: String) -> SourceError {
        SourceError::TableStopped { port: self.drive.port.clone(), reason }
    }

    /// Fails if the table was stopped.
    ///
    /// # Errors
    /// If it was.
    pub fn check(&self) -> Result<(), SourceError> {
        if !self.turns.is_stopped() {
            return Ok(());
        }
        Err(self
            .stopped(self.turns.stopped().unwrap_or_else(|| "the table was stopped".to_owned())))
    }

    /// Commands the table to a gimbal target.
    ///
    /// # Errors
    /// If the table was stopped.
    pub fn command(&mut self, command: &GimbalCommand) -> Result<(), SourceError> {
        self.check()?;
        match &mut self.turns {
            Turns::Driven(following) => following.command(command),
            Turns::Elsewhere(guest) => guest.command(command),
        }
        Ok(())
    }

    /// Returns the gimbal angles at a time, if a reading of the table is near enough.
    pub fn angles(&mut self, when: Instant) -> Option<GimbalAngles> {
        self.turns.take_looks();
        let place = |axis| {
            let place = self.turns.at(axis, when)?;
            (place.age <= self.drive.oldest).then_some(place)
        };
        let ages = &mut self.ages;
        let (Some(azimuth), Some(roll)) = (place(TableAxis::Azimuth), place(TableAxis::Roll))
        else {
            ages.without += 1;
            return None;
        };
        let age = azimuth.age.max(roll.age);
        ages.given += 1;
        ages.sum += age;
        ages.largest = ages.largest.max(age);
        ages.within = ages.within.max(azimuth.within).max(roll.within);
        Some(GimbalAngles::from_rad(azimuth.angle_rad, roll.angle_rad))
    }

    /// Summarises the table's run.
    pub(super) fn summary(&self) -> TableSummary {
        let (drive, ages) = (&self.drive, &self.ages);
        let axis = |axis: TableAxis| {
            let limits = drive.settings.limits.of(axis);
            BenchAxis {
                acceleration_degps2: limits.acceleration_radps2.to_degrees(),
                greatest_deg: limits.most_rad.to_degrees(),
                least_deg: limits.least_rad.to_degrees(),
                rate_degps: limits.rate_radps.to_degrees(),
            }
        };
        let went = self.turns.traffic();
        let seconds = |time: Option<Duration>| time.map(|time| time.as_secs_f64());
        let ms = |time: Duration| time.as_secs_f64() * 1e3;
        let mean_ms = ms(ages.sum) / ages.given.max(1) as f64;
        let stopped = self.turns.stopped();
        let figures = BenchTable {
            angles: BenchAngles {
                age_max_ms: ms(ages.largest),
                age_mean_ms: mean_ms,
                samples: ages.given,
                samples_without: ages.without,
                time_within_ms: ms(ages.within),
            },
            azimuth: axis(TableAxis::Azimuth),
            commands: went.commands,
            dialect: self.language.clone(),
            guard_s: seconds(drive.guard),
            looks: went.looks,
            port: drive.port.clone(),
            roll: axis(TableAxis::Roll),
            shared: self.turns.shared(),
            stopped: stopped.clone(),
            watchdog_s: seconds(drive.settings.watchdog),
        };
        let range = |axis: TableAxis| {
            let limits = drive.settings.limits.of(axis);
            let (least, most) = (limits.least_rad.to_degrees(), limits.most_rad.to_degrees());
            format!("{axis} {least:.4} to {most:.4}°")
        };
        let mut how = stopped.map_or_else(String::new, |why| format!("; stopped: {why}"));
        if let Some(shared) = figures.shared.as_ref().filter(|shared| !shared.driven_by_another) {
            let others: Vec<String> =
                (2..).zip(&shared.others).map(|(unit, end)| format!("unit {unit} {end}")).collect();
            how += &format!("; {} units: {}", shared.units, others.join(", "));
        }
        let angles = if ages.given + ages.without == 0 {
            "measured by the instrument".to_owned()
        } else {
            format!(
                "in {}, {} without; {mean_ms:.1} ms from the nearest look, {:.1} ms at most; times of \
                 looks within {:.1} ms",
                counted(ages.given, "sample", "samples"),
                ages.without,
                ms(ages.largest),
                ms(ages.within),
            )
        };
        TableSummary {
            table: format!(
                "{}, {}, {}, {}; {}{how}",
                drive.port,
                self.language,
                range(TableAxis::Azimuth),
                range(TableAxis::Roll),
                counted(went.commands, "set point", "set points")
            ),
            angles,
            figures,
        }
    }

    /// Waits for the other runs at a table that this one drives.
    pub(super) fn wait_for_others(&self) -> Result<(), SourceError> {
        match &self.turns {
            Turns::Driven(following) => {
                let waited = following.wait_for_others(self.drive.start);
                waited.map_err(|error| self.stopped(error.to_string()))
            }
            Turns::Elsewhere(_) => Ok(()),
        }
    }

    /// Ends the run: the table is braked, immediately where the run was aborted.
    ///
    /// # Errors
    /// If the table was stopped before, or doesn't brake.
    pub fn end(self, broken: Option<&str>) -> Result<(), SourceError> {
        let port = self.drive.port;
        let following = match self.turns {
            Turns::Driven(following) => following,
            Turns::Elsewhere(guest) => {
                // A stop that came with the last sample is reported too.
                let stopped = if broken.is_none() { guest.stopped() } else { None };
                guest.leave(broken.or(stopped.as_deref()));
                return match stopped {
                    Some(reason) => Err(SourceError::TableStopped { port, reason }),
                    None => Ok(()),
                };
            }
        };
        if let Some(why) = broken {
            following.trip(why);
        }
        // A stop that came with the last sample is reported too.
        let stopped = if broken.is_none() { following.stopped() } else { None };
        let ended = following.finish().map_err(|error| error.to_string());
        match (stopped, ended) {
            (Some(reason), _) | (None, Err(reason)) => {
                Err(SourceError::TableStopped { port, reason })
            }
            (None, Ok(())) => Ok(()),
        }
    }
}
