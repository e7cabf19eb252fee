//! Reads `[source.solution]` and `[source.trajectory]`.

use crate::error::Problem;
use crate::keys::{
    At, HeadingTestKeys, ReferenceTrajectoryKeys, ScenarioKeys, SolutionKeys, SourceKeys,
    TrajectoryForm,
};
use crate::model::{EndpointSpec, FileName, HeadingTestSpec, Scenario, SourceSpec};
use crate::recorded::{Delimiter, RecordedColumn, TimeUnit};
use crate::trajectory::{
    HeadingDelay, HeadingTime, NmeaChoice, NmeaPoints, SolutionLine, SolutionReference,
    SolutionRunUps, SolutionSpec, TrajectoryColumns, TrajectoryFormat, TrajectorySpec,
};

/// Reads the solution of `source.uri = "solution:FILE"`, or of a port.
pub(super) fn solution(keys: &SourceKeys, file: &str) -> Result<SolutionSpec, Problem> {
    let spec = |file: &str, format| TrajectorySpec { file: FileName(file.to_owned()), format };
    let trajectory = keys.trajectory.as_ref();
    let reference = trajectory.map_or(Ok(SolutionReference::Unknown), |keys| reference(keys, spec));
    let reference = reference?;
    let line = line(keys, file)?;
    let named = if line.is_some() { "port.nmea" } else { file };
    let mut solution = match &keys.solution {
        Some(solution) => solution.format(named)?,
        None => format_of(None, named, NmeaChoice::default(), || Ok(TrajectoryColumns::default()))?,
    };
    if line.is_some() && !matches!(solution, TrajectoryFormat::Nmea(_)) {
        return Err(keys.uri.problem(format!(
            "found {file:?} with another format than \"nmea\", expected sentences of NMEA 0183 from a port"
        )));
    }
    // Beside a heading alone nothing else is scored.
    if let (
        SolutionReference::Heading { .. } | SolutionReference::Unknown,
        TrajectoryFormat::Nmea(choice),
    ) = (&reference, &mut solution)
    {
        choice.points.get_or_insert(NmeaPoints::Headings);
    }
    let switched_on = keys.solution.as_ref().map(|keys| switched_on(&keys.switched_on));
    Ok(SolutionSpec {
        line,
        rehearsal: keys.solution.as_ref().is_some_and(|keys| keys.rehearsal),
        run_ups: SolutionRunUps {
            switched_on_ns: switched_on.transpose()?.unwrap_or_default(),
            ..SolutionRunUps::default()
        },
        solution: spec(file, solution),
        skip_ns: keys.solution.as_ref().map_or(0, |keys| (keys.skip * 1e9).round() as i64),
        reference,
        offset_ns: trajectory.and_then(|keys| keys.offset).map(|s| (s * 1e9).round() as i64),
        offset_uncertainty_s: trajectory.map_or(0.0, |keys| keys.offset_uncertainty),
        gap_ns: trajectory.map_or(GAP_NS, |keys| (keys.gap * 1e9).round() as i64),
    })
}

/// Longest time between two rows of a reference that isn't there, ns.
const GAP_NS: i64 = 2_000_000_000;
/// Time without a byte that ends a run with a port, s.
const SILENCE_S: f64 = 10.0;

/// The port of a solution that comes while the run goes; `None`: it is a file.
fn line(keys: &SourceKeys, name: &str) -> Result<Option<SolutionLine>, Problem> {
    if !octant_link::Uri::is_one(name) {
        return Ok(None);
    }
    let uri: octant_link::Uri =
        name.parse().map_err(|error| keys.uri.problem(format!("found {name:?}: {error}")))?;
    if !matches!(
        uri,
        octant_link::Uri::Serial(_) | octant_link::Uri::Udp(_) | octant_link::Uri::Tcp(_)
    ) {
        return Err(keys.uri.problem(format!(
            "found {name:?}, expected serial:PORT, udp:HOST:PORT or tcp:HOST:PORT behind solution:"
        )));
    }
    let silence_s = keys.solution.as_ref().map_or(SILENCE_S, |keys| keys.silence);
    let silence_s = if silence_s > 0.0 { silence_s } else { NEVER_S };
    Ok(Some(SolutionLine {
        uri,
        silence: std::time::Duration::from_secs_f64(silence_s),
        rehearsal: keys.solution.as_ref().is_some_and(|keys| keys.rehearsal),
    }))
}

/// A silence that is never waited for, s: longer than any run.
const NEVER_S: f64 = 1e9;

/// Times at which a unit was switched on, ns since 1970.
fn switched_on(key: &At<Option<Vec<String>>>) -> Result<Vec<i64>, Problem> {
    let mut times_ns = Vec::new();
    for text in key.value.iter().flatten() {
        let time = octant_base::utc::written(text, None).ok_or_else(|| {
            key.problem(format!("found {text:?}, expected a time such as 2027-03-31T08:00:00Z"))
        })?;
        if times_ns.last().is_some_and(|last| *last >= time.since_1970_ns) {
            return Err(key.problem(format!(
                "found {text:?} behind a later time, expected times that run forward"
            )));
        }
        times_ns.push(time.since_1970_ns);
    }
    Ok(times_ns)
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
        (_, None) if uncertainty.is_some() => {
            Err(uncertainty.problem("found without true_heading, whose uncertainty it is"))
        }
        (None, None) => Ok(SolutionReference::Unknown),
        (Some(file), None) => Ok(SolutionReference::File(spec(file, keys.format(file)?))),
        (None, Some(heading_rad)) => {
            Ok(SolutionReference::Heading { heading_rad, uncertainty_rad: **uncertainty })
        }
    }
}

/// Adds the run-ups of a heading test to the solution, and refuses what has no meaning for one that is made elsewhere.
pub(super) fn check(keys: &ScenarioKeys, mut scenario: Scenario) -> Result<Scenario, Problem> {
    let (run_up_s, is_named) =
        (scenario.navigation.as_ref().and_then(|plan| plan.duration_s), keys.source.uri.clone());
    let test = scenario.heading_test;
    let SourceSpec::Solution(spec) = &mut scenario.source else { return Ok(scenario) };
    let is_made = spec.line.is_none();
    let solution = keys.source.solution.as_ref();
    match (&test, &keys.procedure.heading_test.value) {
        (Some(test), Some(of_test)) => {
            let switched_on = solution.map(|keys| &keys.switched_on);
            add_run_ups(spec, test, run_up_s, (switched_on, of_test, &keys.source.uri))?;
        }
        _ => {
            if let Some(solution) = solution.filter(|keys| keys.switched_on.is_some()) {
                return Err(solution
                    .switched_on
                    .problem("found without [procedure.heading_test], whose run-ups they begin"));
            }
            if spec.reference == SolutionReference::Unknown {
                return Err(match &*keys.source.trajectory {
                    None => keys.source.trajectory.problem(
                        "missing, expected the trajectory that the solution of source.uri is scored against",
                    ),
                    Some(trajectory) => trajectory.file.problem(
                        "missing, expected the file of the reference, or true_heading of an instrument that stands still",
                    ),
                });
            }
        }
    }
    let problem = |what: &str| {
        let how = if is_made {
            "a solution is made already, and nothing is run"
        } else {
            "a solution is made elsewhere"
        };
        Err(is_named.problem(format!("{how}: expected {what}")))
    };
    if scenario.calibration.is_some() || scenario.baseline.is_some() {
        return problem("[procedure.navigation] alone, without a calibration or a baseline");
    }
    if scenario.navigation.is_none() {
        return problem("[procedure.navigation]");
    }
    if !is_made && run_up_s.is_none() {
        return problem("procedure.navigation.duration, with which the run ends");
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
    Ok(scenario)
}

/// Times at which the unit was switched on, the keys of the test, and the address of the source.
type OfRunUps<'a> = (Option<&'a At<Option<Vec<String>>>>, &'a HeadingTestKeys, &'a At<String>);

/// Adds the run-ups of a heading test to a solution.
fn add_run_ups(
    spec: &mut SolutionSpec,
    test: &HeadingTestSpec,
    run_up_s: Option<f64>,
    (switched_on, keys, of_uri): OfRunUps<'_>,
) -> Result<(), Problem> {
    let count = test.run_ups as usize;
    if *keys.resolution > 0.0 {
        return Err(keys.resolution.problem(
            "found with a solution, expected none: the last digit of its headings is their resolution",
        ));
    }
    let run_ups = &mut spec.run_ups;
    if let Some(key) = switched_on
        && run_ups.switched_on_ns.len() > count
    {
        return Err(key.problem(format!(
            "found {} times, expected {count}, as procedure.heading_test.run_ups says",
            run_ups.switched_on_ns.len()
        )));
    }
    if spec.skip_ns > 0 {
        return Err(of_uri.problem(
            "found source.solution.skip in a heading test, expected source.solution.switched_on: its times count from there",
        ));
    }
    if let TrajectoryFormat::Nmea(choice) = &mut spec.solution.format {
        choice.points.get_or_insert(NmeaPoints::Headings);
        choice.tells_none = true;
    }
    run_ups.count = test.run_ups;
    run_ups.length_ns = (run_up_s.unwrap_or(0.0) * 1e9).round() as i64;
    for text in keys.azimuths.iter().flatten() {
        let angle = crate::quantity::parse(text).ok();
        let angle = angle.filter(|angle| angle.is(crate::quantity::UnitDimension::ANGLE));
        let Some(angle) = angle else {
            return Err(keys
                .azimuths
                .problem(format!("found {text:?}, expected an angle such as \"90 deg\"")));
        };
        run_ups.azimuths_rad.push(angle.si);
    }
    if keys.azimuths.is_some() && run_ups.azimuths_rad.len() != count {
        return Err(keys.azimuths.problem(format!(
            "found {} angles, expected {count}, one for each run-up",
            run_ups.azimuths_rad.len()
        )));
    }
    if keys.azimuths.is_some() && !matches!(spec.reference, SolutionReference::Heading { .. }) {
        return Err(keys.azimuths.problem(
            "found without source.trajectory.true_heading, expected the true heading from which the table turns the unit",
        ));
    }
    Ok(())
}

/// Takes the bench off a solution that is made already: operator, power and table are those of the run that made it.
pub(super) fn without_bench(scenario: Scenario) -> Scenario {
    match &scenario.source {
        SourceSpec::Solution(spec) if spec.line.is_none() => {
            Scenario { operator: Vec::new(), power: None, drive: None, ..scenario }
        }
        _ => scenario,
    }
}

/// Refuses a step of the operator that would hold a unit that sends on: only between two run-ups, without power, time is not
/// the unit's.
pub(super) fn check_steps(keys: &ScenarioKeys, scenario: &Scenario) -> Result<(), Problem> {
    if scenario.solution_line().is_none() {
        return Ok(());
    }
    let period_s = scenario.sample_period_ns as f64 * 1e-9;
    let run_up_s = scenario.navigation.as_ref().and_then(|plan| plan.duration_s).unwrap_or(0.0);
    let pauses: Vec<[f64; 2]> =
        scenario.heading_test.iter().flat_map(|test| test.pauses_s(run_up_s)).collect();
    for step in &scenario.operator {
        let refused =
            |what: &str| Err(keys.operator.problem(format!("step {:?}: {what}", step.id)));
        let at_s = match &step.trigger {
            None => continue,
            Some(octant_faults::trigger::Trigger::Epoch(epoch)) => (epoch - 1) as f64 * period_s,
            Some(_) => {
                return refused(
                    "found a trigger of a core, expected trigger = { at = … }: a solution's run has its time alone",
                );
            }
        };
        let is_off =
            pauses.iter().any(|[off_s, on_s]| at_s >= off_s - period_s && at_s <= on_s + period_s);
        if step.holds && !is_off {
            return refused(
                "the unit sends on while a question is open: expected hold = false, or a time from the end of a run-up to the \
                 beginning of the next one",
            );
        }
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
            sigma: [const { None }; 7],
            quality: None,
            left_out: Vec::new(),
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

/// Place of a heading without a time in its cycle.
fn heading_delay(
    delay: &At<Option<f64>>,
    uncertainty: &At<f64>,
) -> Result<Option<HeadingDelay>, Problem> {
    match **delay {
        Some(delay_s) => Ok(Some(HeadingDelay { delay_s, uncertainty_s: **uncertainty })),
        None if **uncertainty > 0.0 => {
            Err(uncertainty.problem("found without heading_delay, whose uncertainty it is"))
        }
        None => Ok(None),
    }
}

/// Qualities whose rows are left out.
fn left_out(
    quality: &At<Option<RecordedColumn>>,
    left_out: &At<Vec<String>>,
) -> Result<Vec<String>, Problem> {
    if quality.is_none() && !left_out.is_empty() {
        return Err(left_out.problem("found without quality, the column that has them"));
    }
    Ok(left_out.value.clone())
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
                    heading_delay: heading_delay(
                        &self.heading_delay,
                        &self.heading_delay_uncertainty,
                    )?,
                    tells_none: false,
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
                        sigma: [
                            &self.sigma_north,
                            &self.sigma_east,
                            &self.sigma_velocity_north,
                            &self.sigma_velocity_east,
                            &self.sigma_roll,
                            &self.sigma_pitch,
                            &self.sigma_heading,
                        ]
                        .map(column),
                        quality: column(&self.quality),
                        left_out: left_out(&self.quality, &self.quality_left_out)?,
                        angle_rad: self.angle_unit.unit_si()?,
                        velocity_mps: self.velocity_unit.unit_si()?,
                    })
                })?;
                if !matches!(format, TrajectoryFormat::Csv(_)) {
                    let sigma = [&self.sigma_north, &self.sigma_east, &self.sigma_velocity_north, &self.sigma_velocity_east, &self.sigma_roll, &self.sigma_pitch, &self.sigma_heading, &self.quality];
                    let of_columns = format!("found with {file}, which isn't columns of text, expected none");
                    if let Some(key) = sigma.into_iter().find(|key| key.is_some()) {
                        return Err(key.problem(of_columns));
                    }
                    if !self.quality_left_out.is_empty() {
                        return Err(self.quality_left_out.problem(of_columns));
                    }
                }
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
                if self.heading_delay.is_some() {
                    return Err(self.heading_delay.problem(not_nmea("heading_delay")));
                }
                Ok(format)
            }
        }
    )+ };
}

columns_of!(SolutionKeys: false, ReferenceTrajectoryKeys: true);
