//! Reads `[source.solution]` and `[source.trajectory]`.

use crate::error::Problem;
use crate::keys::{
    At, ReferenceTrajectoryKeys, ScenarioKeys, SolutionKeys, SourceKeys, TrajectoryForm,
};
use crate::model::{EndpointSpec, FileName, Scenario, SourceSpec};
use crate::recorded::{Delimiter, RecordedColumn, TimeUnit};
use crate::trajectory::{
    HeadingTime, NmeaChoice, NmeaPoints, SolutionReference, SolutionSpec, TrajectoryColumns,
    TrajectoryFormat, TrajectorySpec,
};

/// Reads the solution of `source.uri = "solution:FILE"`.
pub(super) fn solution(keys: &SourceKeys, file: &str) -> Result<SolutionSpec, Problem> {
    let Some(trajectory) = &*keys.trajectory else {
        return Err(keys.trajectory.problem(
            "missing, expected the trajectory that the solution of source.uri is scored against",
        ));
    };
    let spec = |file: &str, format| TrajectorySpec { file: FileName(file.to_owned()), format };
    let reference = reference(trajectory, spec)?;
    let mut solution = match &keys.solution {
        Some(solution) => solution.format(file)?,
        None => format_of(None, file, NmeaChoice::default(), || Ok(TrajectoryColumns::default()))?,
    };
    // Beside a heading alone nothing else is scored.
    if let (SolutionReference::Heading { .. }, TrajectoryFormat::Nmea(choice)) =
        (&reference, &mut solution)
    {
        choice.points.get_or_insert(NmeaPoints::Headings);
    }
    Ok(SolutionSpec {
        solution: spec(file, solution),
        skip_ns: keys.solution.as_ref().map_or(0, |keys| (keys.skip * 1e9).round() as i64),
        reference,
        offset_ns: trajectory.offset.map(|offset_s| (offset_s * 1e9).round() as i64),
        offset_uncertainty_s: trajectory.offset_uncertainty,
        gap_ns: (trajectory.gap * 1e9).round() as i64,
    })
}

/// Reads the reference: a file or a heading.
fn reference(
    keys: &ReferenceTrajectoryKeys,
    spec: impl Fn(&str, TrajectoryFormat) -> TrajectorySpec,
) -> Result<SolutionReference, Problem> {
    let uncertainty = &keys.true_heading_uncertainty;
    match (&*keys.file, keys.true_heading) {
        (Some(_), Some(_)) => Err(keys.file.problem(
            "found beside true_heading, expected one reference: a file, or a heading that was surveyed",
        )),
        (None, None) => Err(keys.file.problem(
            "missing, expected the file of the reference, or true_heading of an instrument that stands still",
        )),
        (Some(_), None) if uncertainty.is_some() => {
            Err(uncertainty.problem("found without true_heading, whose uncertainty it is"))
        }
        (Some(file), None) => Ok(SolutionReference::File(spec(file, keys.format(file)?))),
        (None, Some(heading_rad)) => {
            Ok(SolutionReference::Heading { heading_rad, uncertainty_rad: **uncertainty })
        }
    }
}

/// Refuses what has no meaning for a solution that is made already.
pub(super) fn check(keys: &ScenarioKeys, scenario: &Scenario) -> Result<(), Problem> {
    if !matches!(scenario.source, SourceSpec::Solution(_)) {
        return Ok(());
    }
    let problem = |what: &str| {
        Err(keys
            .source
            .uri
            .problem(format!("a solution is made already, and nothing is run: expected {what}")))
    };
    if scenario.calibration.is_some() || scenario.baseline.is_some() {
        return problem("[procedure.navigation] alone, without a calibration or a baseline");
    }
    if scenario.navigation.is_none() {
        return problem("[procedure.navigation]");
    }
    if scenario.endpoint != EndpointSpec::InProcess {
        return problem("no endpoint");
    }
    if keys.faults.as_ref().is_some_and(|faults| !faults.is_empty()) {
        return problem("no faults");
    }
    if scenario.realtime.by_clock {
        return problem("realtime.pace = \"free\"");
    }
    Ok(())
}

impl Default for TrajectoryColumns {
    fn default() -> Self {
        Self {
            truth_first: false,
            delimiter: Delimiter::Character(b','),
            skip_lines: 0,
            comment: "#".to_owned(),
            time: (None, TimeUnit::Second),
            position: [const { None }; 3],
            velocity: [const { None }; 2],
            attitude: [const { None }; 3],
            angle_rad: 1.0_f64.to_radians(),
            velocity_mps: 1.0,
        }
    }
}

/// What a file is: as the scenario says, or by its name.
fn format_of(
    form: Option<TrajectoryForm>,
    file: &str,
    choice: NmeaChoice,
    columns: impl FnOnce() -> Result<TrajectoryColumns, Problem>,
) -> Result<TrajectoryFormat, Problem> {
    let name = file.to_ascii_lowercase();
    let ends = |endings: &[&str]| {
        endings
            .iter()
            .any(|ending| name.rsplit_once('.').is_some_and(|(_, found)| found == *ending))
    };
    Ok(match form {
        Some(TrajectoryForm::Nmea) => TrajectoryFormat::Nmea(choice),
        Some(TrajectoryForm::Rtklib) => TrajectoryFormat::Rtklib,
        Some(TrajectoryForm::Sbet) => TrajectoryFormat::Sbet,
        Some(TrajectoryForm::Messages(protocol)) => TrajectoryFormat::Messages(protocol),
        None if ends(&["nmea", "nma"]) => TrajectoryFormat::Nmea(choice),
        None if ends(&["pos"]) => TrajectoryFormat::Rtklib,
        None if ends(&["sbet", "out"]) => TrajectoryFormat::Sbet,
        Some(TrajectoryForm::Csv) | None => TrajectoryFormat::Csv(Box::new(columns()?)),
    })
}

/// Letters of a talker.
fn talker(key: &At<Option<String>>) -> Result<Option<String>, Problem> {
    match &key.value {
        Some(talker)
            if !(1..=5).contains(&talker.len())
                || !talker.bytes().all(|byte| byte.is_ascii_alphanumeric()) =>
        {
            Err(key.problem(format!(
                "found {talker:?}, expected the letters of a talker, such as \"GP\""
            )))
        }
        talker => Ok(talker.as_deref().map(str::to_ascii_uppercase)),
    }
}

/// Keys that say how headings get their times.
fn heading_time(
    by: &At<Option<HeadingTime>>,
    rate: &At<Option<f64>>,
    start: &At<Option<String>>,
) -> Result<Option<HeadingTime>, Problem> {
    let Some(rate_hz) = **rate else {
        return match &**start {
            None => Ok(**by),
            Some(_) => Err(start.problem("found without heading_rate, whose first time it is")),
        };
    };
    if by.is_some() {
        return Err(by.problem("found beside heading_rate, expected one of both"));
    }
    let start_ns = match &**start {
        None => None,
        Some(text) => Some(
            octant_base::utc::written(text, None)
                .ok_or_else(|| {
                    start.problem(format!(
                        "found {text:?}, expected a time such as 2027-03-31T08:00:00Z"
                    ))
                })?
                .since_1970_ns,
        ),
    };
    Ok(Some(HeadingTime::Rate(rate_hz, start_ns)))
}

macro_rules! columns_of {
    ($($keys:ty: $truth_first:literal),+) => { $(
        impl $keys {
            fn format(&self, file: &str) -> Result<TrajectoryFormat, Problem> {
                let choice = NmeaChoice {
                    talker: talker(&self.talker)?,
                    fixes_alone: $truth_first,
                    points: *self.points,
                    heading_time: heading_time(
                        &self.heading_time,
                        &self.heading_rate,
                        &self.heading_start,
                    )?,
                };
                let format = format_of(self.format, file, choice, || {
                    let column = |key: &At<Option<RecordedColumn>>| key.value.clone();
                    Ok(TrajectoryColumns {
                        truth_first: $truth_first,
                        delimiter: self.delimiter,
                        skip_lines: self.skip_lines,
                        comment: self.comment.clone(),
                        time: (column(&self.time_column), self.time_unit),
                        position: [&self.latitude, &self.longitude, &self.height].map(column),
                        velocity: [&self.north, &self.east].map(column),
                        attitude: [&self.roll, &self.pitch, &self.heading].map(column),
                        angle_rad: self.angle_unit.unit_si()?,
                        velocity_mps: self.velocity_unit.unit_si()?,
                    })
                })?;
                if matches!(format, TrajectoryFormat::Nmea(_)) {
                    return Ok(format);
                }
                let not_nmea = |name: &str| {
                    format!("found with {file}, which is no NMEA 0183, expected format = \"nmea\" or no {name}")
                };
                if self.talker.is_some() {
                    return Err(self.talker.problem(not_nmea("talker")));
                }
                if self.points.is_some() {
                    return Err(self.points.problem(not_nmea("points")));
                }
                if self.heading_time.is_some() {
                    return Err(self.heading_time.problem(not_nmea("heading_time")));
                }
                if self.heading_rate.is_some() {
                    return Err(self.heading_rate.problem(not_nmea("heading_rate")));
                }
                Ok(format)
            }
        }
    )+ };
}

columns_of!(SolutionKeys: false, ReferenceTrajectoryKeys: true);
