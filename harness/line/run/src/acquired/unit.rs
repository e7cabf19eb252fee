//! Power of the unit, and the table under it.

use super::error::AcquireError;
use octant_base::control::Control;
use octant_endpoint::power_record;
use octant_power::PowerOutlet;
use octant_recorder::event::PowerRecord;
use octant_sample::{GimbalAngles, GimbalCommand};
use octant_scenario::{Drive, Scenario, SourceSpec};
use octant_source::{BenchTable, SourceError};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant, SystemTime};

/// Interval between two looks at a table that turns.
const LOOK: Duration = Duration::from_millis(20);

/// Things that this program switches and turns; the operator does the rest.
#[derive(Debug)]
pub(super) struct BenchUnit {
    outlet: Option<PowerOutlet>,
    table: Option<(BenchTable, Drive)>,
    azimuths_rad: Vec<f64>,
    is_begun: bool,
}

impl BenchUnit {
    /// Opens the supply, and takes over the table. The unit has no power yet.
    pub(super) fn start(scenario: &Scenario) -> Result<Self, AcquireError> {
        let outlet = scenario.power.as_ref().map(PowerOutlet::open).transpose()?;
        let table = match &scenario.drive {
            None => None,
            Some(drive) => Some((BenchTable::start(drive, &scenario.folder)?, drive.clone())),
        };
        let azimuths_rad = match &scenario.source {
            SourceSpec::Solution(spec) => spec.run_ups.azimuths_rad.clone(),
            _ => Vec::new(),
        };
        Ok(Self { outlet, table, azimuths_rad, is_begun: false })
    }

    /// Switches the unit, where this program does that.
    pub(super) fn switch(&mut self, on: bool) -> Result<(), AcquireError> {
        let Some(outlet) = &mut self.outlet else { return Ok(()) };
        if std::mem::replace(&mut self.is_begun, true) {
            outlet.switch(on, None)?;
        } else {
            // Off for its rest, then on with its settings.
            outlet.begin()?;
        }
        Ok(())
    }

    /// Time of the last switching by this program.
    pub(super) fn switched_at(&self) -> Option<SystemTime> {
        Some(self.outlet.as_ref()?.switchings().last()?.at)
    }

    /// Turns the table to the angle of a run-up, from 0, and waits until it is there.
    pub(super) fn turn(&mut self, run_up: usize, control: &Control) -> Result<(), AcquireError> {
        let Some((table, drive)) = &mut self.table else { return Ok(()) };
        let Some(azimuth_rad) = self.azimuths_rad.get(run_up) else { return Ok(()) };
        let target = GimbalAngles::from_rad(*azimuth_rad, 0.0);
        table.command(&GimbalCommand { target })?;
        let begun = Instant::now();
        loop {
            table.check()?;
            let there = table.angles(Instant::now());
            let is_there = there.is_some_and(|there| {
                (there.azimuth_rad() - azimuth_rad).abs() <= drive.tolerance_rad
            });
            if is_there || control.cancel.load(Ordering::Relaxed) {
                return Ok(());
            }
            if begun.elapsed() >= drive.start {
                let found = there.map_or("no angle".to_owned(), |there| {
                    format!("{:.4} deg", there.azimuth_rad().to_degrees())
                });
                return Err(AcquireError::Table(SourceError::TableStopped {
                    port: drive.port.clone(),
                    reason: format!(
                        "its azimuth didn't come to {:.4} deg in {:.0} s: found {found}",
                        azimuth_rad.to_degrees(),
                        drive.start.as_secs_f64()
                    ),
                }));
            }
            std::thread::sleep(LOOK);
        }
    }

    /// Brings power and table to their ends; returns the record of the power.
    pub(super) fn end(mut self, broken: bool) -> Result<Option<PowerRecord>, AcquireError> {
        let power = match &mut self.outlet {
            None => None,
            Some(outlet) => {
                outlet.end()?;
                let end = outlet.read()?;
                Some(power_record(outlet, Some(end)))
            }
        };
        if let Some((table, _)) = self.table {
            table.end(broken.then_some("the run broke off"))?;
        }
        Ok(power)
    }
}
