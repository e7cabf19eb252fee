//! The points of a solution, each with the reference at its time.
//!
//! Time of the run begins with the first point that has a reference. Points without one are left out, and so are
//! points that lack a velocity or an attitude that the others have; what is missing is told at the end.

pub use super::pairs_error::PairsError;

use super::comparison::{Comparison, Quantity};
use super::gaps::GapList;
use super::point::{GeodeticPosition, TrajectoryPoint};
use super::reader::{TrajectoryError, TrajectoryReader};
use super::run_ups::RunUps;
use super::survey::TrajectorySurvey;
use super::tally::Tally;
use super::track::{Reference, ReferencePoint, ReferenceTrack, q_nc};
use octant_account::{Account, AccountEntry};
use octant_earth::ellipsoid::Ellipsoid;
use octant_scenario::FileNameError;
use octant_scenario::trajectory::{SolutionReference, SolutionSpec, TrajectorySpec};
use std::f64::consts::{PI, TAU};
use std::path::{Path, PathBuf};

/// Units of the account of points.
const POINT: [&str; 2] = ["point", "points"];

/// Share of the points that may be missing.
const MISSING_SHARE: f64 = 0.01;

/// A point of the solution and the reference at its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolutionPair {
    /// Number, from 1.
    pub sequence: u64,
    /// Time of the run, ns: the first point is at one period.
    pub time_ns: u64,
    /// The solution.
    pub solution: TrajectoryPoint,
    /// The reference.
    pub reference: ReferencePoint,
}

/// Reads both files forward.
#[derive(Debug)]
pub struct SolutionPairs {
    solution: TrajectoryReader,
    reference: Reference,
    survey: TrajectorySurvey,
    /// Time of the first point that is scored.
    from_ns: i64,
    run_ups: RunUps,
    rehearsal: bool,
    offset_ns: i64,
    period_ns: u64,
    /// Longest time of the run, ns.
    until_ns: u64,
    first_ns: Option<i64>,
    last_ns: u64,
    pairs: u64,
    /// True as long as every position, velocity and attitude of the solution is that of the reference.
    identical: [bool; 3],
    /// First heading, rad, and whether another one is different.
    first_heading_rad: Option<f64>,
    heading_varies: bool,
    comparison: Comparison,
    /// Points of the solution that are scored, and left out for a reason.
    points: Tally,
    /// Units that the file left out up to the present point, all and for each reason.
    of_file: (u64, Vec<(&'static str, u64)>),
    gaps: GapList,
    scored: Option<Scored>,
    apart: Apart,
}

const OFF: &str = "points while the unit was without power, or before it was switched on";
const SKIPPED: &str = "points before the time that is scored";
const INCOMPLETE: &str = "points without the position, velocity or attitude that the others have";
const UNREFERRED: &str = "points without a reference at their time";

/// The last point that was scored.
#[derive(Debug)]
struct Scored {
    last_ns: i64,
    /// Number of points and of the file's units that were left out up to it, and the number for each reason.
    left_out_then: u64,
    reasons_then: Vec<(&'static str, u64)>,
}

/// Words for files of different times.
#[derive(Clone, Debug, Default)]
struct Apart {
    solution: String,
    reference: String,
    spans_s: [f64; 4],
}

/// Largest distance of the first position from the site, m: within it a minute of longitude changes by less
/// than 2 % at 50° of latitude.
const SITE_MAX_M: f64 = 100e3;

/// Checks that a reference begins near the site.
fn near(
    path: &Path,
    reference: &TrajectorySurvey,
    [latitude_rad, longitude_rad]: [f64; 2],
) -> Result<(), PairsError> {
    let Some(first) = reference.first.position else { return Ok(()) };
    let GeodeticPosition { latitude_rad: first_rad, longitude_rad: first_east_rad, .. } = first;
    let earth = Ellipsoid::at(latitude_rad, 0.0);
    let east_rad = (first_east_rad - longitude_rad + PI).rem_euclid(TAU) - PI;
    let off_m = libm::hypot(
        (first_rad - latitude_rad) * earth.meridian_radius_m,
        east_rad * earth.transverse_radius_m * earth.cos_latitude,
    );
    if off_m <= SITE_MAX_M {
        return Ok(());
    }
    let position_deg = [first_rad.to_degrees(), first_east_rad.to_degrees()];
    Err(PairsError::Site { reference: path.display().to_string(), off_m, position_deg })
}

impl SolutionPairs {
    /// Opens both files, relative to a folder; they begin near the site, whose latitude converts units. A run of `duration_s` ends then; without one, with the files.
    ///
    /// # Errors
    /// If a file can't be read to its end, or the times of both can't be compared.
    pub fn open(
        spec: &SolutionSpec,
        (folder, site_rad): (&Path, [f64; 2]),
        period_ns: u64,
        duration_s: Option<f64>,
    ) -> Result<Self, PairsError> {
        let path = |trajectory: &TrajectorySpec| -> Result<PathBuf, FileNameError> {
            trajectory.file.path(folder)
        };
        let of_solution = path(&spec.solution)?;
        let survey = TrajectorySurvey::of(&of_solution, &spec.solution.format)?;
        let (reference, offset_ns, apart) = match &spec.reference {
            SolutionReference::Heading { heading_rad, uncertainty_rad } => {
                (Reference::heading(*heading_rad, *uncertainty_rad), 0, Apart::default())
            }
            SolutionReference::Unknown => (Reference::unknown(), 0, Apart::default()),
            SolutionReference::File(file) => {
                let named = (of_solution.display().to_string(), &survey);
                Self::open_reference(named, spec, (&path(file)?, file), site_rad)?
            }
        };
        let run_ups = RunUps::of(&spec.run_ups, &survey)
            .map_err(|reason| TrajectoryError::new(&of_solution, reason))?;
        // The plan of a heading test is that of its run-ups.
        let duration_s = duration_s.filter(|_| run_ups.is_none());
        Ok(Self {
            solution: TrajectoryReader::open(&of_solution, &spec.solution.format)?,
            reference,
            run_ups,
            rehearsal: spec.rehearsal,
            from_ns: survey.span_ns.0.saturating_add(spec.skip_ns),
            gaps: GapList::new(survey.period_ns),
            comparison: Comparison::of_points(survey.points),
            survey,
            offset_ns,
            period_ns,
            until_ns: duration_s.map_or(u64::MAX, |s| (s * 1e9).round() as u64),
            first_ns: None,
            last_ns: 0,
            pairs: 0,
            identical: [true; 3],
            first_heading_rad: None,
            heading_varies: false,
            points: Tally::default(),
            of_file: (0, Vec::new()),
            scored: None,
            apart,
        })
    }

    /// Opens the file of the reference; returns it with what is added to the solution's times.
    fn open_reference(
        (solution_name, survey): (String, &TrajectorySurvey),
        spec: &SolutionSpec,
        (of_reference, file): (&Path, &TrajectorySpec),
        site_rad: [f64; 2],
    ) -> Result<(Reference, i64, Apart), PairsError> {
        let reference = TrajectorySurvey::of_role(of_reference, &file.format, "reference")?;
        near(of_reference, &reference, site_rad)?;
        let reference_name = of_reference.display().to_string();
        let scales = (survey.scale, reference.scale);
        let known_ns = scales.0.offset_to(scales.1, survey.span_ns.0, reference.span_ns.0);
        let offset_ns = match (known_ns, spec.offset_ns) {
            (None, None) => {
                return Err(PairsError::Scales {
                    solution: solution_name,
                    reference: reference_name,
                    scales,
                });
            }
            (known_ns, given_ns) => known_ns.unwrap_or(0).saturating_add(given_ns.unwrap_or(0)),
        };
        let s = |ns: i64| ns as f64 * 1e-9;
        let spans_s = [
            s(survey.span_ns.0.saturating_add(offset_ns)),
            s(survey.span_ns.1.saturating_add(offset_ns)),
            s(reference.span_ns.0),
            s(reference.span_ns.1),
        ];
        if spans_s[1] < spans_s[2] || spans_s[3] < spans_s[0] {
            let (solution, reference) = (solution_name, reference_name);
            return Err(PairsError::Apart { solution, reference, spans_s });
        }
        let apart = Apart { solution: solution_name, reference: reference_name, spans_s };
        let reader = TrajectoryReader::open(of_reference, &file.format)?;
        let track = ReferenceTrack::new(reader, spec.gap_ns, reference.period_ns)?;
        Ok((Reference::File(Box::new(track), Box::new(reference)), offset_ns, apart))
    }

    /// What the file of the solution holds.
    #[must_use]
    pub fn survey(&self) -> &TrajectorySurvey {
        &self.survey
    }

    /// Returns whether both have positions, and both roll and pitch.
    #[must_use]
    pub fn compares(&self) -> [bool; 2] {
        let [position, tilt] = self.reference.has();
        [position && self.survey.position, tilt && self.survey.tilt]
    }

    /// Number of points that a solution without gaps has in the time from its first to its last point, or
    /// in the duration.
    #[must_use]
    pub fn planned(&self) -> u64 {
        if let Some(planned_ns) = self.run_ups.planned_ns() {
            return planned_ns / self.period_ns;
        }
        let span_ns = u64::try_from(self.survey.span_ns.1 - self.from_ns).unwrap_or(0);
        let whole = (span_ns + self.period_ns / 2) / self.period_ns + 1;
        whole.min((self.until_ns.saturating_add(self.period_ns / 2)) / self.period_ns)
    }

    /// Returns the next pair; `None` at the end.
    ///
    /// # Errors
    /// If a file is damaged, or no point has a reference.
    pub fn next_pair(&mut self) -> Result<Option<SolutionPair>, PairsError> {
        while let Some(point) = self.next_point()? {
            let Some(run_up) = self.run_ups.take(point.time_ns) else {
                let place = self.solution.place();
                self.points.left_out(1, OFF, || place);
                continue;
            };
            if run_up.is_first {
                // Nothing is missing while the unit has no power.
                self.scored = None;
            }
            if point.is_without() {
                self.points.point(1);
                self.comparison.push_without(run_up.time_ns.saturating_add(self.period_ns));
                continue;
            }
            let lacks = (self.survey.position && point.position.is_none())
                || (self.survey.velocity && point.velocity_mps.is_none())
                || (self.survey.attitude && point.attitude.is_none())
                || (self.survey.tilt && point.attitude_rad().is_none());
            let reason = if point.time_ns < self.from_ns {
                Some(SKIPPED)
            } else if lacks {
                Some(INCOMPLETE)
            } else {
                None
            };
            let at_ns = point.time_ns.saturating_add(self.offset_ns);
            let reference = match reason {
                None => {
                    let there = self.reference.at(at_ns)?.ok_or(UNREFERRED);
                    there.map(|there| there.turned(run_up.azimuth_rad))
                }
                Some(reason) => Err(reason),
            };
            let reference = match reference {
                Ok(reference) => reference,
                Err(reason) => {
                    let place = self.solution.place();
                    self.points.left_out(1, reason, || place);
                    continue;
                }
            };
            let mut point = point;
            if let (Some(here), Some(there)) = (&mut point.position, &reference.position) {
                // Longitudes may count from 0 to 360° in one file and from -180° in the other.
                let turns = ((here.longitude_rad - there.longitude_rad) / TAU).round();
                here.longitude_rad -= turns * TAU;
            }
            let first_ns = *self.first_ns.get_or_insert(point.time_ns);
            let since_ns = match self.run_ups.is_none() {
                true => u64::try_from(point.time_ns - first_ns).unwrap_or(0),
                false => run_up.time_ns,
            };
            let time_ns = since_ns.saturating_add(self.period_ns);
            if time_ns > self.until_ns.saturating_add(self.period_ns / 2) {
                break;
            }
            self.pairs += 1;
            self.last_ns = time_ns;
            self.points.point(1);
            self.step(point.time_ns);
            self.comparison.push(time_ns, &point, &reference);
            if let Some(attitude) = point.attitude {
                self.run_ups.heading(run_up.number, attitude.heading_rad);
                let first_rad = *self.first_heading_rad.get_or_insert(attitude.heading_rad);
                self.heading_varies |= first_rad != attitude.heading_rad;
            }
            let same = [
                point.position.zip(reference.position).is_some_and(|(here, there)| {
                    here.latitude_rad == there.latitude_rad
                        && here.longitude_rad == there.longitude_rad
                }),
                point.velocity_mps.is_some() && point.velocity_mps == reference.velocity_mps,
                point
                    .attitude
                    .is_some_and(|attitude| Some(q_nc(attitude.or_level_rad())) == reference.q_nc),
            ];
            for (identical, same) in self.identical.iter_mut().zip(same) {
                *identical &= same;
            }
            return Ok(Some(SolutionPair {
                sequence: self.pairs,
                time_ns,
                solution: point,
                reference,
            }));
        }
        if self.pairs == 0 {
            let Apart { solution, reference, spans_s } = self.apart.clone();
            return Err(PairsError::Apart { solution, reference, spans_s });
        }
        Ok(None)
    }

    /// Returns the next point of the solution, with the counts of what the file left out up to it.
    fn next_point(&mut self) -> Result<Option<TrajectoryPoint>, TrajectoryError> {
        let ahead = self.solution.looks_ahead();
        if ahead {
            self.count_file();
        }
        let point = self.solution.next()?;
        if !ahead {
            self.count_file();
        }
        Ok(point)
    }

    fn count_file(&mut self) {
        let tally = self.solution.tally();
        let (count, reasons) = &mut self.of_file;
        if *count != tally.left_out_count() {
            *count = tally.left_out_count();
            reasons.clear();
            reasons.extend(tally.reasons());
        }
    }

    /// Takes the time of a point that is scored, for the gaps.
    fn step(&mut self, now_ns: i64) {
        let (of_file_count, of_file) = &self.of_file;
        let left_out = self.points.left_out_count() + of_file_count;
        let reasons = || self.points.reasons().chain(of_file.iter().copied());
        let Some(Scored { last_ns, left_out_then, reasons_then }) = &mut self.scored else {
            let reasons_then = reasons().collect();
            self.scored = Some(Scored { last_ns: now_ns, left_out_then: left_out, reasons_then });
            return;
        };
        self.gaps.step(*last_ns, now_ns, || {
            // Only what was left out within the gap is its cause.
            let since = |(kind, count): (&'static str, u64)| {
                let then = reasons_then.iter().find(|(there, _)| *there == kind);
                (kind, count - then.map_or(0, |(_, then)| *then))
            };
            let causes = reasons().map(since).filter(|(_, count)| *count > 0);
            let place = [format!("before {}", self.solution.place())];
            let causes = causes.map(|(kind, count)| format!("{count} {kind}"));
            place.into_iter().chain(causes).collect::<Vec<_>>().join(", ")
        });
        *last_ns = now_ns;
        if left_out != *left_out_then {
            *left_out_then = left_out;
            reasons_then.clear();
            reasons_then.extend(reasons());
        }
    }

    /// Returns the findings of the comparison so far, besides the errors.
    #[must_use]
    pub fn comparison(&self) -> &Comparison {
        &self.comparison
    }

    /// Accounts of both files, and of the points of the solution. Known at the end.
    #[must_use]
    pub fn accounts(&self) -> Vec<Account> {
        let points = self.points.account("points of the solution", POINT);
        let rest = self.survey.points.saturating_sub(points.read());
        let points =
            points.left_out(AccountEntry::new(rest, "points after the time that is scored"));
        let zero_ns = self.first_ns.unwrap_or(self.from_ns);
        let reference = match &self.reference {
            Reference::File(track, survey) => {
                let zero_ns = zero_ns.saturating_add(self.offset_ns);
                Some(track.gaps().tell(survey.account.clone(), POINT, zero_ns))
            }
            Reference::Constant(_) => None,
        };
        let points = self.gaps.tell(points, POINT, zero_ns);
        std::iter::once(self.survey.account.clone()).chain(reference).chain([points]).collect()
    }

    /// Describes what makes the comparison so far no evidence; `None`: nothing does.
    #[must_use]
    pub fn doubt(&self) -> Option<String> {
        if self.rehearsal {
            return Some(
                "a rehearsal with a simulated unit, whose TAG blocks tell the time, is no evidence"
                    .to_owned(),
            );
        }
        if !self.run_ups.is_none() {
            return self.run_ups.doubt(self.survey.period_ns).or_else(|| self.likeness_doubt());
        }
        let expected = (self.last_ns + self.period_ns / 2) / self.period_ns;
        let missing = expected.saturating_sub(self.pairs);
        if missing as f64 > MISSING_SHARE * expected as f64 {
            return Some(format!(
                "{missing} of {expected} points of the solution are missing, incomplete, or have no reference"
            ));
        }
        self.likeness_doubt()
    }

    /// Describes a solution that is constant, or that of its reference.
    fn likeness_doubt(&self) -> Option<String> {
        let likeness = |quantity| self.comparison.likeness(quantity);
        let quantities = Quantity::ALL.map(likeness);
        // A table that turns the unit rounds the differences of a constant heading.
        let varies = match self.run_ups.is_none() {
            true => quantities.iter().any(|likeness| likeness.solution_varies()),
            false => self.heading_varies,
        };
        if self.pairs > 1 && !varies {
            return Some(format!(
                "no number of the solution changes over its {} points: constants show nothing of an instrument",
                self.pairs
            ));
        }
        // Constants that agree, such as velocities at rest, don't show that one was made of the other.
        let attitude = [Quantity::Roll, Quantity::Pitch, Quantity::Heading];
        let varies = [
            likeness(Quantity::Position).varies(),
            likeness(Quantity::Velocity).varies(),
            attitude.into_iter().any(|quantity| likeness(quantity).varies()),
        ];
        let names = ["positions", "velocities", "attitudes"];
        let mut identical = names.iter().zip(self.identical).zip(varies);
        let found = identical.find(|((_, identical), varies)| *identical && *varies);
        found.map(|((name, _), _)| {
            format!("all {} {name} of the solution are exactly those of the reference", self.pairs)
        })
    }
}
