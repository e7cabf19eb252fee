//! A real table that is moved by the core's set points.

use super::file_name::FileName;
use octant_turntable::{Dialect, DriverSettings, Error, TablePlan};
use std::path::Path;
use std::time::Duration;

/// Run that drives a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableDriver {
    /// This one.
    ThisRun,
    /// Another one on the same host, whose angles this one gets.
    AnotherRun,
}

/// A real table that is moved by the core's set points.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    /// Port.
    pub port: String,
    /// Run that drives it.
    pub driver: TableDriver,
    /// Number of runs on it; of importance where this one drives.
    pub units: usize,
    /// Dialect, by its built-in name or its file: see [`Drive::plan`].
    pub dialect: FileName,
    /// Limits, time limits and watchdog.
    pub settings: DriverSettings,
    /// Interval between two looks at the table.
    pub look: Duration,
    /// Longest time from a sample to the nearest look.
    pub oldest: Duration,
    /// Silence after which the guard stops the table; `None`: no guard.
    pub guard: Option<Duration>,
    /// True if both axes first find their reference.
    pub home: bool,
    /// Longest time for homing and the move to zero.
    pub start: Duration,
    /// Largest angle from zero at which a gimbal may rest at the start, rad.
    pub tolerance_rad: f64,
}

impl Drive {
    /// Makes the plan for the table, with the dialect read from its file.
    ///
    /// # Errors
    /// If the file can't be read, or has no table of patterns.
    pub fn plan(&self, folder: &Path) -> Result<TablePlan, Error> {
        let file = match self.dialect.0.as_str() {
            Dialect::BUILT_IN => Dialect::BUILT_IN.into(),
            _ => self.dialect.path(folder).map_err(|error| Error::Dialect {
                place: "turntable.drive.dialect".to_owned(),
                what: error.to_string(),
            })?,
        };
        Ok(TablePlan {
            port: self.port.clone(),
            dialect: Dialect::load(&file)?,
            settings: self.settings,
            period: self.look,
            guard: self.guard,
            home: self.home,
            start: self.start,
            tolerance_rad: self.tolerance_rad,
            units: self.units,
        })
    }
}
