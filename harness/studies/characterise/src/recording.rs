//! The recording: any source of samples that a scenario describes, read from its start as often as it is needed.

use super::deviations::{CHANNELS, RateChannels};
use super::error::CharacteriseError;
use octant_account::Account;
use octant_recorder::reader::Recording;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{GimbalCommand, Status};
use octant_scenario::file_names::FileNames;
use octant_scenario::recorded::TextFiles;
use octant_scenario::resolve::{DrawnValues, Seeded};
use octant_scenario::{Scenario, SourceSpec};
use octant_source::{AnySource, Epoch, Source, TextSource};
use std::path::Path;

/// Loads a scenario, and adds what it lacks to be one of a run: a recording's noise needs neither procedure nor reference.
fn with_procedure(file: &Path, set: &[String]) -> Result<Scenario, CharacteriseError> {
    const CALIBRATION: &str = "procedure.calibration";
    const NAVIGATION: &str = "procedure.navigation";
    const REFERENCE: &str = "source.reference";
    const MCAP: &str = "source.mcap";
    const ALIGNMENT: &str = "procedure.alignment";
    let keys = [CALIBRATION, NAVIGATION, REFERENCE, MCAP, ALIGNMENT, "source.text", "source.log"];
    let absent = Scenario::absent(file, set, &keys)?;
    let lacks = |key: &str| absent.contains(&key);
    let columns = ["source.text", "source.log", MCAP].iter().any(|key| !lacks(key));
    let mut more = Vec::new();
    match (lacks(CALIBRATION), lacks(REFERENCE)) {
        (true, true) if lacks(NAVIGATION) => more.push(format!("{NAVIGATION}={{}}")),
        // A reference is for a calibration.
        (true, false) => {
            more.push(format!(
                "{CALIBRATION}={{ duration = \"1 h\", name = \"at rest\", stops = [{{ azimuth = \"0 deg\", roll = \"0 deg\" }}] }}"
            ));
            if lacks(ALIGNMENT) {
                more.push(format!(
                    "{ALIGNMENT}={{ method = \"inertial\", duration = \"10 min\" }}"
                ));
            }
        }
        (false, true) if columns => more.push(format!("{REFERENCE}={{ kind = \"static\" }}")),
        _ => {}
    }
    Ok(Scenario::load(file, &[&more[..], set].concat())?)
}

/// Scenario of a recording that brings none, of a file of `octant export` or of a recording of Octant.
const PLAIN: &str = "schema = 1\n[procedure.alignment]\nmethod = \"inertial\"\nduration = \"10 min\"\n\
    [procedure.calibration]\nduration = \"1 h\"\nname = \"at rest\"\nstops = [{ azimuth = \"0 deg\", roll = \"0 deg\" }]\n";
const EXPORTED: &str = "[source]\n[source.reference]\nkind = \"static\"\n[source.text]\ndelimiter = \"comma\"\nheader = true\n\
    time_column = \"device_time_s\"\n[source.text.gyro]\nx = \"delta_theta_x_rad\"\ny = \"delta_theta_y_rad\"\n\
    z = \"delta_theta_z_rad\"\nunit = \"rad\"\nquantity = \"increment\"\n[source.text.accelerometer]\n\
    x = \"delta_velocity_x_mps\"\ny = \"delta_velocity_y_mps\"\nz = \"delta_velocity_z_mps\"\nunit = \"m/s\"\n\
    quantity = \"increment\"\n";
/// Intervals at the start from which the period is told.
const PROBED: usize = 1000;
/// Largest deviation of the period from the scenario's.
const PERIOD_OFF_MAX: f64 = 0.01;
/// Longest interval between two samples, in periods: a longer one is a gap.
const GAP: f64 = 1.5;

/// A recording with what describes it.
#[derive(Debug)]
pub struct RestingRecording {
    name: String,
    scenario: Scenario,
    names: FileNames,
}

/// Reports at the end of a recording.
#[derive(Clone, Debug, Default)]
pub struct RecordingEnd {
    /// How it was cut short, if it was.
    pub cut_short: Option<String>,
    /// Accounts of what was read.
    pub inputs: Vec<Account>,
}

/// A sample as rates.
#[derive(Clone, Copy, Debug)]
pub struct RateSample {
    /// Stamp, s.
    pub time_s: f64,
    /// Rates, rad/s and m/s².
    pub rates: RateChannels,
    /// False if samples are missing before it, or it is flagged as invalid or saturated.
    pub follows: bool,
    /// True if the sample is to be used.
    pub valid: bool,
    /// Temperature, °C.
    pub temperature_c: Option<f64>,
}

impl RestingRecording {
    /// Finds the description of a recording: a scenario with a source; a recording of Octant; text or MCAP with a
    /// scenario that has the columns; a table `samples` of `octant export`.
    ///
    /// # Errors
    /// If the scenario is wrong or the recording can't be read.
    pub fn of(
        path: &Path,
        described: Option<&Path>,
        set: &[String],
    ) -> Result<Self, CharacteriseError> {
        let name = path.display().to_string();
        let fail = |reason: String| CharacteriseError::Recording { name: name.clone(), reason };
        let whole = std::path::absolute(path).map_err(|error| fail(error.to_string()))?;
        let is = |end: &str| path.extension().is_some_and(|extension| extension == end);
        let kind = if is("mcap") { "replay" } else { "text" };
        let uri = format!("source.uri={kind}:{}", whole.display());
        let parse = |text: &str, more: &[String]| {
            let set = [more, set].concat();
            Scenario::parse(text, &name, path.parent().unwrap_or(Path::new("")), &set)
        };
        let mut of_table = false;
        let scenario = match described {
            Some(file) => with_procedure(file, &[&[uri][..], set].concat())?,
            None if is("toml") => with_procedure(path, set)?,
            None if is("mcap") => {
                let read = Recording::open(path).map_err(|error| {
                    fail(format!("{error}; the file of another program needs --scenario, with its topic and fields"))
                })?;
                let stored = Scenario::parse(&read.info().scenario, &name, Path::new(""), &[])?;
                let rate = format!("imu.rate={} Hz", 1e9 / stored.sample_period_ns as f64);
                parse(PLAIN, &[uri, rate])?
            }
            None => {
                of_table = true;
                parse(&format!("{PLAIN}{EXPORTED}"), std::slice::from_ref(&uri))?
            }
        };
        // Columns of octant export have the names of the channels.
        let names = if of_table { FileNames(None) } else { FileNames::of(&scenario.source) };
        let mut recording = Self { name: name.clone(), scenario: unsplit(scenario)?, names };
        recording.refuse_others()?;
        let probed = if of_table { recording.probe_table() } else { recording.probe() };
        let found_s = probed.map_err(|error| match error {
            CharacteriseError::Source(error) if of_table && path.exists() => fail(format!(
                "{error}; without --scenario, which names its columns, a table has to be the samples of octant export"
            )),
            other => other,
        })?;
        if of_table {
            let rate = format!("imu.rate={} Hz", octant_base::number::plain(1.0 / found_s, 9));
            recording.scenario = parse(
                &format!("{PLAIN}{EXPORTED}"),
                &[format!("source.uri=text:{}", whole.display()), rate],
            )?;
        }
        let period_s = recording.period_s();
        if (found_s / period_s - 1.0).abs() > PERIOD_OFF_MAX {
            return Err(fail(format!(
                "samples are {} s apart, expected {} s of the rate in the scenario: set imu.rate to {} Hz, or the unit of \
                 the time column",
                octant_base::number::plain(found_s, 6),
                octant_base::number::plain(period_s, 6),
                octant_base::number::plain(1.0 / found_s, 6)
            )));
        }
        Ok(recording)
    }

    /// Name of the recording.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Names that the file has for the channels.
    #[must_use]
    pub fn names(&self) -> &FileNames {
        &self.names
    }

    /// Nominal period, s.
    #[must_use]
    pub fn period_s(&self) -> f64 {
        self.scenario.sample_period_ns as f64 * 1e-9
    }

    /// Scenario that describes the recording.
    #[must_use]
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    fn refuse_others(&self) -> Result<(), CharacteriseError> {
        let found = match &self.scenario.source {
            SourceSpec::Replay { .. } | SourceSpec::Text(_) | SourceSpec::Log(_) => return Ok(()),
            SourceSpec::Plant => "the plant, which is simulated",
            SourceSpec::Solution(_) => "a solution, which has no samples",
            SourceSpec::Live(_) => "an instrument on a port: record it with octant run first",
            SourceSpec::Fmu(_) => "an FMU",
        };
        Err(CharacteriseError::Recording {
            name: self.name.clone(),
            reason: format!(
                "its source.uri is {found}, expected replay:FILE, text:FILE or log:FILE"
            ),
        })
    }

    /// Why the recording has no temperature.
    pub(crate) fn without_temperature(&self) -> &'static str {
        match &self.scenario.source {
            SourceSpec::Text(_) => {
                "the recording has none: source.text.temperature_column would name its column"
            }
            SourceSpec::Replay { mapping: Some(_), .. } => {
                "the recording has none: source.mcap.temperature_field would name its field"
            }
            SourceSpec::Log(_) => "the instrument sent none",
            _ => "a recording of Octant has none",
        }
    }

    fn open(&self) -> Result<AnySource, CharacteriseError> {
        let draws = DrawnValues::of(&self.scenario, &Seeded(self.scenario.seed));
        let plant = self.scenario.plant(self.scenario.seed, &draws);
        octant_source::open(&self.scenario, &plant)?.ok_or_else(|| CharacteriseError::Recording {
            name: self.name.clone(),
            reason: "its source is the plant, expected a recording".to_owned(),
        })
    }

    /// Median interval at the start of a table whose rate isn't known yet, s.
    fn probe_table(&self) -> Result<f64, CharacteriseError> {
        let SourceSpec::Text(mapping) = &self.scenario.source else { return self.probe() };
        let TextFiles::One(path) = &mapping.files else { return self.probe() };
        match TextSource::interval_s(path, mapping)? {
            Some(interval_s) if interval_s > 0.0 => Ok(interval_s),
            // Too few rows, or none that follow each other: the samples say so.
            _ => self.probe(),
        }
    }

    /// Median interval at the start, s.
    fn probe(&self) -> Result<f64, CharacteriseError> {
        let mut source = self.open()?;
        let (mut epoch, command) = (Epoch::default(), GimbalCommand::default());
        let mut stamps = Vec::with_capacity(PROBED);
        while stamps.len() < PROBED && source.next(&command, &mut epoch)? {
            stamps.push(epoch.sample.device_time.ns);
        }
        let mut intervals: Vec<u64> =
            stamps.windows(2).map(|pair| pair[1].saturating_sub(pair[0])).collect();
        intervals.sort_unstable();
        match intervals.get(intervals.len() / 2) {
            Some(0) => Err(self.unusable("stamps repeat, expected one for each sample".to_owned())),
            Some(median) => Ok(*median as f64 * 1e-9),
            None => Err(self.unusable(format!(
                "it has {}, expected at least a minute of them",
                octant_base::number::counted(stamps.len() as u64, "sample", "samples")
            ))),
        }
    }

    pub(crate) fn unusable(&self, reason: String) -> CharacteriseError {
        CharacteriseError::Recording { name: self.name.clone(), reason }
    }

    /// Reads the recording from its first sample to its last; returns how it ended.
    ///
    /// # Errors
    /// If it can't be read, or a stamp doesn't follow the one before.
    pub fn read(
        &self,
        mut take: impl FnMut(&RateSample),
    ) -> Result<RecordingEnd, CharacteriseError> {
        let mut source = self.open()?;
        let (mut epoch, command) = (Epoch::default(), GimbalCommand::default());
        let nominal_s = self.period_s();
        let mut before: Option<u64> = None;
        while source.next(&command, &mut epoch)? {
            let sample = &epoch.sample;
            let now = sample.device_time.ns;
            let interval_s = match before {
                None => nominal_s,
                Some(before) if now > before => (now - before) as f64 * 1e-9,
                Some(before) => {
                    return Err(self.unusable(format!(
                        "sample {} is stamped {now} ns, expected a stamp after the one before, {before} ns",
                        sample.sequence
                    )));
                }
            };
            let saturated = Status::GYRO_SATURATED | Status::ACCELEROMETER_SATURATED;
            let valid = !sample.status.intersects(saturated | Status::INERTIAL_INVALID)
                && interval_s < GAP * nominal_s;
            let mut rates = [0.0; CHANNELS];
            for axis in 0..3 {
                rates[axis] =
                    f64::from(sample.delta_theta[axis]) * DELTA_THETA_LSB_RAD / interval_s;
                rates[axis + 3] =
                    f64::from(sample.delta_velocity[axis]) * DELTA_VELOCITY_LSB_MPS / interval_s;
            }
            let follows = before.is_some() && interval_s < GAP * nominal_s;
            let temperature_c = source.temperature_c()?;
            take(&RateSample { time_s: now as f64 * 1e-9, rates, follows, valid, temperature_c });
            before = Some(now);
        }
        Ok(RecordingEnd { cut_short: source.cut_short(), inputs: source.accounts() })
    }
}

/// Takes rows whole, where the scenario splits them into samples.
fn unsplit(scenario: Scenario) -> Result<Scenario, CharacteriseError> {
    let (key, split, rate_hz) = match &scenario.source {
        SourceSpec::Text(mapping) => ("text", mapping.split, mapping.nominal_rate_hz),
        SourceSpec::Replay { mapping: Some(mapping), .. } => {
            ("mcap", mapping.split, mapping.nominal_rate_hz)
        }
        _ => return Ok(scenario),
    };
    if split <= 1 {
        return Ok(scenario);
    }
    let changes = [format!("source.{key}.split=1"), format!("imu.rate={rate_hz} Hz")];
    let fail = |reason| CharacteriseError::Recording { name: scenario.file.clone(), reason };
    let text = scenario.to_toml_with(&changes, &[]).map_err(|problem| fail(problem.message))?;
    let folder = scenario.folder.clone();
    Ok(Scenario::parse(&text, &scenario.file, &folder, &[])?)
}
