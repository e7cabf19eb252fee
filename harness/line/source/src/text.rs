//! Delimited text of a real instrument as a source.

use super::counting::{Counted, Counting, CountingError, Measured, RowWords};
use super::rows::Rows;
use super::temperature::TemperatureCheck;
use super::{Epoch, Source, SourceError};
use octant_account::Account;
use octant_base::number::counted;
use octant_plant::Truth;
use octant_recorder::event::BenchRecord;
use octant_sample::GimbalCommand;
use octant_scenario::recorded::{AxisColumn, TemperatureUnit, TextFiles, TextMapping, TimeUnit};
use std::path::Path;

/// Number of rows whose interval is looked at, for a table without a rate.
const PROBED: usize = 1000;

/// Streams delimited text.
///
/// The increment of an interval is its rate times the interval by the [fitted](octant_instruments::timeline) stamps; the
/// remainder after rounding to counts is carried. A value that does not fit a count saturates, is flagged in the sample, and is
/// counted.
pub struct TextSource {
    first: File,
    /// File of the accelerometers, where it is a second one.
    second: Option<File>,
    counting: Counting,
    rows: u64,
    temperatures: TemperatureCheck,
}

/// One file with the columns that are read from it.
struct File {
    rows: Rows,
    time: Option<(usize, TimeUnit)>,
    gyro: Option<[Resolved; 3]>,
    accel: Option<[Resolved; 3]>,
    gimbal: Option<[Resolved; 2]>,
    temperature: Option<(usize, TemperatureUnit)>,
}

/// Axis whose column was found.
#[derive(Clone, Copy)]
struct Resolved {
    index: usize,
    offset: f64,
    scale: f64,
}

impl TextSource {
    /// Opens the files of a mapping.
    ///
    /// # Errors
    /// If a file can't be read or has not the columns named.
    pub fn open(mapping: &TextMapping) -> Result<Self, SourceError> {
        let (path, second) = match &mapping.files {
            TextFiles::One(path) => (path, None),
            TextFiles::Split { gyro, accelerometer } => (gyro, Some(accelerometer)),
        };
        let fail = |reason| SourceError::Read { path: path.display().to_string(), reason };
        let words = RowWords {
            unit: ["row", "rows"],
            at: "line",
            other_times: "time_column = \"none\" and the rate of the rows leave the stamps out",
        };
        let (rate_hz, split) = (mapping.nominal_rate_hz, mapping.split);
        let counting = Counting::new(mapping.quantity, rate_hz, split, words).map_err(fail)?;
        Ok(Self {
            first: File::open(path, mapping, true, second.is_none())?,
            second: second.map(|path| File::open(path, mapping, false, true)).transpose()?,
            counting,
            rows: 0,
            temperatures: TemperatureCheck::default(),
        })
    }

    /// Median interval of the first stamps of a file, s, for a table whose rate nobody gave; `None` with fewer than two rows.
    ///
    /// # Errors
    /// If the file can't be read or has not the columns named.
    pub fn interval_s(path: &Path, mapping: &TextMapping) -> Result<Option<f64>, SourceError> {
        let mut file = File::open(path, mapping, true, true)?;
        let mut stamps = Vec::with_capacity(PROBED);
        while stamps.len() < PROBED && file.rows.advance()? {
            stamps.extend(file.time_ns()?);
        }
        let apart = stamps.windows(2).map(|pair| pair[1].saturating_sub(pair[0]));
        let mut apart: Vec<u64> = apart.collect();
        apart.sort_unstable();
        Ok(apart.get(apart.len() / 2).map(|ns| *ns as f64 * 1e-9))
    }

    /// Number of samples so far in which at least one count saturated.
    #[must_use]
    pub fn saturated(&self) -> u64 {
        self.counting.saturated()
    }

    fn placed(&self, error: CountingError) -> SourceError {
        self.first.rows.error_at(error.place, &error.reason)
    }

    fn advance(&mut self) -> Result<Option<Epoch>, SourceError> {
        loop {
            match self.counting.next().map_err(|error| self.placed(error))? {
                Counted::Sample(sample) => return Ok(Some(Epoch { sample, aiding: None })),
                Counted::End if self.rows == 0 => {
                    let reason = "the file ends, expected rows of numbers".to_owned();
                    return Err(self.first.rows.error(reason));
                }
                Counted::End => return Ok(None),
                Counted::More if self.read_row()? => {}
                Counted::More => self.counting.end(),
            }
        }
    }

    /// Passes the next row to the counting; `false` at the end.
    fn read_row(&mut self) -> Result<bool, SourceError> {
        let more = self.first.rows.advance()?;
        if let Some(second) = &mut self.second {
            let more_there = second.rows.advance()?;
            if more != more_there {
                let (ended, other) =
                    if more { (second, &self.first) } else { (&mut self.first, &*second) };
                return Err(ended.rows.error(format!(
                    "the file ends after {}, and {} goes on: expected the same stamps in both",
                    counted(self.rows, "row", "rows"),
                    other.rows.path()
                )));
            }
        }
        if !more {
            return Ok(false);
        }
        self.rows += 1;
        let stamp_ns = self.first.time_ns()?;
        if let Some(second) = &self.second
            && let Some((there, time_ns)) = second.time_ns()?.zip(stamp_ns)
            && there != time_ns
        {
            return Err(second.rows.error(format!(
                "stamp {there} ns, expected {time_ns} ns as in {} line {}",
                self.first.rows.path(),
                self.first.rows.line()
            )));
        }
        let accel = match (&self.second, self.first.accel) {
            (Some(second), _) => second.values(second.accel)?,
            (None, accel) => self.first.values(accel)?,
        };
        let row = Measured {
            place: self.first.rows.line(),
            stamp_ns,
            gyro: self.first.values(self.first.gyro)?,
            accel,
            gimbal_rad: match self.first.gimbal {
                Some(gimbal) => Some(self.first.values(Some(gimbal))?),
                None => None,
            },
            temperature: self.first.temperature(),
        };
        self.counting.push(row);
        Ok(true)
    }
}

impl Source for TextSource {
    fn next(&mut self, _command: &GimbalCommand, epoch: &mut Epoch) -> Result<bool, SourceError> {
        Ok(epoch.take(self.advance()?))
    }

    fn truth(&self) -> Option<Truth> {
        None
    }

    fn temperature_c(&mut self) -> Result<Option<f64>, SourceError> {
        let Some((index, unit)) = self.first.temperature else { return Ok(None) };
        let Some(row) = self.counting.row() else { return Ok(None) };
        let (place, time_ns) = (row.place, row.stamp_ns.unwrap_or_default());
        let checked = self.temperatures.take(time_ns, row.temperature, unit);
        checked.map(Some).map_err(|reason| {
            self.placed(CountingError { place, reason: format!("column {}: {reason}", index + 1) })
        })
    }

    fn samples_total(&self) -> Option<u64> {
        None
    }

    fn cut_short(&self) -> Option<String> {
        self.counting.cut_short(self.first.rows.path())
    }

    fn accounts(&self) -> Vec<Account> {
        vec![self.counting.account(self.first.rows.path(), None)]
    }

    fn conclude(
        &mut self,
        _broken: Option<&str>,
    ) -> (Option<Box<BenchRecord>>, Option<SourceError>) {
        (self.counting.bench(self.first.rows.path()), None)
    }
}

impl File {
    fn open(
        path: &Path,
        mapping: &TextMapping,
        gyro: bool,
        accel: bool,
    ) -> Result<Self, SourceError> {
        let rows = Rows::open(
            path,
            mapping.delimiter,
            &mapping.comment,
            mapping.skip_lines,
            mapping.header,
        )?;
        let axis = |axis: &AxisColumn| -> Result<Resolved, SourceError> {
            Ok(Resolved {
                index: rows.column(&axis.column)?,
                offset: axis.offset,
                scale: axis.scale,
            })
        };
        let three = |axes: &[AxisColumn; 3]| -> Result<[Resolved; 3], SourceError> {
            Ok([axis(&axes[0])?, axis(&axes[1])?, axis(&axes[2])?])
        };
        let time = match &mapping.time {
            Some(time) => Some((rows.column(&time.column)?, time.unit)),
            None => None,
        };
        let gimbal = match &mapping.gimbal {
            Some(gimbal) if gyro => Some([axis(&gimbal.azimuth)?, axis(&gimbal.roll)?]),
            _ => None,
        };
        let temperature = match &mapping.temperature {
            Some(temperature) if gyro => {
                Some((rows.column(&temperature.column)?, temperature.unit))
            }
            _ => None,
        };
        let gyro = if gyro { Some(three(&mapping.gyro)?) } else { None };
        let accel = if accel { Some(three(&mapping.accelerometer)?) } else { None };
        Ok(Self { rows, time, gyro, accel, gimbal, temperature })
    }

    /// Temperature of this row, in the unit of the file; not a number if there is none.
    fn temperature(&self) -> f64 {
        let found = self.temperature.and_then(|(index, _)| self.rows.number(index).ok());
        found.unwrap_or(f64::NAN)
    }

    fn time_ns(&self) -> Result<Option<u64>, SourceError> {
        let Some((index, unit)) = self.time else { return Ok(None) };
        self.rows.time_ns(index, unit).map(Some)
    }

    /// Returns the values of the axes in SI units; zeros if there are no axes.
    fn values<const N: usize>(&self, axes: Option<[Resolved; N]>) -> Result<[f64; N], SourceError> {
        let mut values = [0.0; N];
        if let Some(axes) = axes {
            for (value, axis) in values.iter_mut().zip(&axes) {
                *value = (self.rows.number(axis.index)? - axis.offset) * axis.scale;
            }
        }
        Ok(values)
    }
}
