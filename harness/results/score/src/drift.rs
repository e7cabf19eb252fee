//! Drift of a navigation solution (position, attitude, velocity): maximum, rms, final value, secular
//! slope and Schuler oscillation, radial error.

use super::attitude::CaseAngles;
use super::every_answer::{AnsweredSolution, EveryAnswer, LargestErrors, StandingTruth};
use super::gaps::{self, GapBridge};
use super::regression::{SecularSlope, Slopes};
use super::series::ErrorSeries;
use super::summary::{ErrorScore, HeightChannel, Mark, NavigationScore, RadialScore, SlopeWindow};
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::units::{ARCMIN, NAUTICAL_MILE_M};
use std::collections::BTreeMap;

/// Hours at which intermediate scores are given, if the run gets there.
pub const MARKS_H: [u32; 2] = [24, 72];

/// Error of the navigation solution at one time: navigation minus truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriftSample {
    /// Time since the start of the navigation, s.
    pub t_s: f64,
    /// Errors of latitude and longitude, rad; `None` if they aren't known.
    pub position_error_rad: Option<[f64; 2]>,
    /// Attitude error of the case; `None` if it isn't known. Roll and pitch are NaN where the heading alone is.
    pub attitude_error: Option<CaseAngles>,
    /// Error of the velocity over ground, north and east, m/s; `None` if it isn't known.
    pub velocity_error_mps: Option<[f64; 2]>,
    /// True geodetic latitude, rad.
    pub latitude_rad: f64,
    /// True height above the ellipsoid, m.
    pub height_m: f64,
}

/// Error of a drift that can't be scored.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum DriftError {
    /// No samples were scored.
    #[error("score the drift: no sample of the navigation, at least 2 are needed")]
    Empty,
    /// A value is not a number.
    #[error("score the drift: sample {sample} at {t_s} s has an error that is not finite")]
    NotFinite {
        /// Number of the sample, from 0.
        sample: u64,
        /// Time of the sample, s.
        t_s: f64,
    },
    /// Time doesn't increase.
    #[error("score the drift: sample {sample} is at {t_s} s, after one at {previous_s} s")]
    Order {
        /// Number of the sample, from 0.
        sample: u64,
        /// Time of the sample, s.
        t_s: f64,
        /// Time of the sample before it, s.
        previous_s: f64,
    },
}

/// Number of errors with a score each.
const ERRORS: usize = 7;
/// Place of each error in the unit of its score: arcmin, and m/s for the velocity.
const LATITUDE: usize = 0;
const LONGITUDE: usize = 1;
const HEADING: usize = 2;
const PITCH: usize = 3;
const ROLL: usize = 4;
const NORTH: usize = 5;
const EAST: usize = 6;

/// Errors at one time, in the units of the scores.
#[derive(Clone, Copy, Debug)]
struct Errors {
    t_s: f64,
    each: [f64; ERRORS],
    radial_nmi: f64,
}

impl Errors {
    /// All errors, the radial one last.
    fn with_radial(&self) -> [f64; gaps::ERRORS] {
        let mut all = [self.radial_nmi; gaps::ERRORS];
        all[..ERRORS].copy_from_slice(&self.each);
        all
    }
}

/// Largest magnitude and ∫x²dt of one error.
#[derive(Clone, Copy, Debug, Default)]
struct Extent {
    max: f64,
    square_integral: f64,
}

impl Extent {
    fn take(&mut self, value: f64) {
        self.max = self.max.max(value.abs());
    }

    /// Adds ∫x²dt of a straight line between two samples: exact for a ramp.
    fn integrate(&mut self, from: f64, to: f64, dt_s: f64) {
        self.square_integral += dt_s * (from * from + from * to + to * to) / 3.0;
    }

    fn rms(&self, duration_s: f64) -> f64 {
        libm::sqrt(self.square_integral / duration_s)
    }
}

/// Scores the drift of one navigation while it runs: integrals and regressions at 1 Hz or any slower rate,
/// maxima over all answers between, too. Memory doesn't grow with the length of the run.
#[derive(Clone, Debug)]
pub struct DriftScorer {
    samples: u64,
    first_s: f64,
    previous: Option<Errors>,
    extents: [Extent; ERRORS],
    /// True as long as every sample has had a position error.
    position: bool,
    /// True as long as every sample has had a heading error.
    attitude: bool,
    /// True as long as every sample has had errors of roll and pitch.
    tilt: bool,
    /// True as long as every sample has had a velocity error.
    velocity: bool,
    radial: Extent,
    /// Sums Σ r t and Σ t² of the regression through the origin.
    radial_time: f64,
    time_square: f64,
    slope: Option<SecularSlope<ERRORS>>,
    marks: BTreeMap<String, Mark>,
    between: EveryAnswer,
    /// Next mark of the answers between, ns.
    mark_ns: u64,
    /// Last mark that they passed, s, with their largest errors up to it.
    at_mark: Option<(f64, LargestErrors)>,
    series: ErrorSeries,
    gaps: Option<Box<GapBridge>>,
    broken: Option<DriftError>,
}

/// Returns the first mark after a time of the navigation, ns; the largest number if there is none.
fn next_mark_ns(after_ns: u64) -> u64 {
    let marks_ns = MARKS_H.map(|hour| u64::from(hour) * 3_600_000_000_000);
    marks_ns.into_iter().find(|mark_ns| *mark_ns > after_ns).unwrap_or(u64::MAX)
}

impl Default for DriftScorer {
    fn default() -> Self {
        Self::new()
    }
}

impl DriftScorer {
    /// Makes a scorer without samples.
    #[must_use]
    pub fn new() -> Self {
        Self {
            samples: 0,
            first_s: 0.0,
            previous: None,
            extents: [Extent::default(); ERRORS],
            position: true,
            attitude: true,
            tilt: true,
            velocity: true,
            radial: Extent::default(),
            radial_time: 0.0,
            time_square: 0.0,
            slope: None,
            marks: BTreeMap::new(),
            between: EveryAnswer::default(),
            mark_ns: next_mark_ns(0),
            at_mark: None,
            series: ErrorSeries::new(),
            gaps: None,
            broken: None,
        }
    }

    /// Makes a scorer of samples that are this time apart, s, where they have no gap between them.
    #[must_use]
    pub fn with_gaps(period_s: f64) -> Self {
        Self { gaps: Some(Box::new(GapBridge::new(period_s))), ..Self::new() }
    }

    /// Takes one sample. [`Self::finish`] reports errors in it; samples after the first invalid one are
    /// ignored.
    pub fn push(&mut self, sample: &DriftSample) {
        if self.broken.is_some() {
            return;
        }
        let earth = Ellipsoid::at(sample.latitude_rad, sample.height_m);
        let [latitude_rad, longitude_rad] = sample.position_error_rad.unwrap_or_default();
        let north_m = latitude_rad * earth.meridian_radius_m;
        let east_m = longitude_rad * earth.transverse_radius_m * earth.cos_latitude;
        let mut attitude = sample.attitude_error.unwrap_or_default();
        let tilt = sample.attitude_error.is_some_and(CaseAngles::has_tilt);
        if !tilt {
            (attitude.pitch_rad, attitude.roll_rad) = (0.0, 0.0);
        }
        let [north_mps, east_mps] = sample.velocity_error_mps.unwrap_or_default();
        let mut each = [0.0; ERRORS];
        each[LATITUDE] = latitude_rad / ARCMIN;
        each[LONGITUDE] = longitude_rad / ARCMIN;
        each[HEADING] = attitude.heading_rad / ARCMIN;
        each[PITCH] = attitude.pitch_rad / ARCMIN;
        each[ROLL] = attitude.roll_rad / ARCMIN;
        (each[NORTH], each[EAST]) = (north_mps, east_mps);
        let now = Errors {
            t_s: sample.t_s,
            each,
            radial_nmi: libm::sqrt(north_m * north_m + east_m * east_m) / NAUTICAL_MILE_M,
        };
        if !(now.t_s.is_finite()
            && now.radial_nmi.is_finite()
            && each.iter().all(|x| x.is_finite()))
        {
            self.broken = Some(DriftError::NotFinite { sample: self.samples, t_s: now.t_s });
            return;
        }
        match self.previous {
            None => self.first_s = now.t_s,
            Some(before) if now.t_s > before.t_s => self.step(&before, &now),
            Some(before) => {
                self.broken = Some(DriftError::Order {
                    sample: self.samples,
                    t_s: now.t_s,
                    previous_s: before.t_s,
                });
                return;
            }
        }
        if let Some(gaps) = &mut self.gaps {
            let place = (sample.latitude_rad, sample.height_m);
            gaps.push(now.t_s, &now.with_radial(), place, sample.velocity_error_mps);
        }
        self.samples += 1;
        self.between.scored();
        self.position &= sample.position_error_rad.is_some();
        self.attitude &= sample.attitude_error.is_some();
        self.tilt &= tilt;
        self.velocity &= sample.velocity_error_mps.is_some();
        for (extent, error) in self.extents.iter_mut().zip(&each) {
            extent.take(*error);
        }
        self.radial.take(now.radial_nmi);
        self.radial_time += now.radial_nmi * now.t_s;
        self.time_square += now.t_s * now.t_s;
        self.slope
            .get_or_insert_with(|| SecularSlope::new(sample.latitude_rad, sample.height_m))
            .push(now.t_s, &each);
        if sample.position_error_rad.is_some() {
            self.series.push([now.t_s / 3600.0, each[LATITUDE], each[LONGITUDE]]);
        }
        self.previous = Some(now);
    }

    /// Takes the truth with which the answers between two samples are compared; `None`: it isn't known.
    pub fn stand(&mut self, truth: Option<StandingTruth>) {
        self.between.stand(truth);
    }

    /// Returns whether answers between two samples are compared with this truth.
    #[must_use]
    pub fn stands_at(&self, truth: &StandingTruth) -> bool {
        self.between.stands_at(truth)
    }

    /// True if there is a truth with which answers between two samples can be compared.
    #[inline(always)]
    #[must_use]
    pub fn has_truth(&self) -> bool {
        self.between.has_truth()
    }

    /// Returns whether an answer between two samples is to be compared with its truth, which moves.
    #[inline(always)]
    pub fn strays(&mut self, answer: &AnsweredSolution) -> bool {
        self.between.strays(answer)
    }

    /// Takes an answer between two samples, with its time since the start of the navigation, ns, at the
    /// truth that stands: for the maxima.
    #[inline(always)]
    pub fn between(&mut self, t_ns: u64, answer: &AnsweredSolution) {
        if t_ns > self.mark_ns {
            self.pass_mark();
        }
        self.between.take(answer);
    }

    /// Keeps the largest errors between up to the next mark.
    #[cold]
    fn pass_mark(&mut self) {
        self.at_mark = Some((self.mark_ns as f64 * 1e-9, self.between.largest()));
        self.mark_ns = next_mark_ns(self.mark_ns);
    }

    /// Adds the interval between two samples: integrals, and marks that are reached.
    fn step(&mut self, before: &Errors, now: &Errors) {
        let dt_s = now.t_s - before.t_s;
        for hour in MARKS_H {
            let mark_s = f64::from(hour) * 3600.0;
            if before.t_s < mark_s && mark_s <= now.t_s {
                if let Some(gaps) = &mut self.gaps {
                    gaps.mark(format!("{hour}h"), before.t_s, (now.t_s, &now.with_radial()));
                }
                let part = (mark_s - before.t_s) / dt_s;
                let at = |a: f64, b: f64| a + part * (b - a);
                let latitude = at(before.each[LATITUDE], now.each[LATITUDE]);
                let longitude = at(before.each[LONGITUDE], now.each[LONGITUDE]);
                let radial = at(before.radial_nmi, now.radial_nmi);
                let passed = self.at_mark.filter(|(at_s, _)| *at_s == mark_s);
                let between = passed.map_or_else(|| self.between.largest(), |(_, largest)| largest);
                let largest = |error: usize, at: f64| {
                    self.extents[error].max.max(at.abs()).max(between.each[error])
                };
                self.marks.insert(
                    format!("{hour}h"),
                    Mark {
                        latitude_arcmin: latitude,
                        longitude_arcmin: longitude,
                        radial_nmi: radial,
                        latitude_max_arcmin: largest(LATITUDE, latitude),
                        longitude_max_arcmin: largest(LONGITUDE, longitude),
                        radial_max_nmi: self.radial.max.max(radial).max(between.radial_nmi),
                    },
                );
            }
        }
        for (i, extent) in self.extents.iter_mut().enumerate() {
            extent.integrate(before.each[i], now.each[i], dt_s);
        }
        self.radial.integrate(before.radial_nmi, now.radial_nmi, dt_s);
    }

    /// Scores of all samples so far.
    ///
    /// `height` is the treatment of the vertical channel: a free one diverges and affects the
    /// horizontal ones, so scores with different treatments can't be compared.
    ///
    /// # Errors
    /// If there are fewer than two samples, one was not finite, or time did not increase.
    pub fn finish(&self, height: HeightChannel) -> Result<NavigationScore, DriftError> {
        if let Some(broken) = self.broken {
            return Err(broken);
        }
        let last = self.previous.filter(|_| self.samples > 1).ok_or(DriftError::Empty)?;
        let duration_s = last.t_s - self.first_s;
        let slopes: Option<Slopes<ERRORS>> = self.slope.as_ref().and_then(SecularSlope::slopes);
        let between = self.between.largest();
        let largest = |error: usize| self.extents[error].max.max(between.each[error]);
        let score = |error: usize| ErrorScore {
            max: largest(error),
            rms: self.extents[error].rms(duration_s),
            r#final: last.each[error],
            slope_per_day: slopes.map(|s| s.per_day[error]),
            schuler_amplitude: slopes.and_then(|s| Some(s.schuler?[error])),
        };
        let scored = |error: usize| match error {
            HEADING => self.attitude,
            PITCH | ROLL => self.tilt,
            NORTH | EAST => self.velocity,
            _ => self.position,
        };
        let known = |error: usize| scored(error).then(|| score(error));
        let extent = |name, extent: &Extent| Some((name, extent.max, extent.rms(duration_s)));
        let names = [
            "latitude_error_arcmin",
            "longitude_error_arcmin",
            "heading_error_arcmin",
            "pitch_error_arcmin",
            "roll_error_arcmin",
            "velocity_north_error_mps",
            "velocity_east_error_mps",
        ];
        // Marks are of positions alone.
        let none = BTreeMap::new();
        let marks = if self.position { &self.marks } else { &none };
        let gaps = self.gaps.as_ref().and_then(|gaps| {
            let radial = extent("radial_error_nmi", &self.radial).filter(|_| self.position);
            let mut scores = [radial; gaps::ERRORS];
            for (error, name) in names.into_iter().enumerate() {
                scores[error] = extent(name, &self.extents[error]).filter(|_| scored(error));
            }
            gaps.score(scores, duration_s, marks)
        });
        Ok(NavigationScore {
            gaps: gaps.map(Box::new),
            heading_output: None,
            duration_h: duration_s / 3600.0,
            height,
            latitude_error_arcmin: known(LATITUDE),
            longitude_error_arcmin: known(LONGITUDE),
            heading_error_arcmin: known(HEADING),
            pitch_error_arcmin: known(PITCH),
            roll_error_arcmin: known(ROLL),
            velocity_north_error_mps: known(NORTH),
            velocity_east_error_mps: known(EAST),
            radial_error_nmi: self.position.then(|| RadialScore {
                max: self.radial.max.max(between.radial_nmi),
                rms: self.radial.rms(duration_s),
                r#final: last.radial_nmi,
                rate_per_h: 3600.0 * self.radial_time / self.time_square,
            }),
            slope_window: slopes.map(|s| SlopeWindow {
                of: if s.sidereal { "sidereal days" } else { "schuler periods" }.to_owned(),
                periods: s.periods,
                hours: s.window_s / 3600.0,
            }),
            marks: marks.clone(),
            series_hours: self.series.points(),
        })
    }
}
