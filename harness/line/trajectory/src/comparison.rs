//! What a comparison of a solution with its reference shows of both, besides the errors themselves.

use super::bands::{EXPANDED, StatedBand};
use super::likeness::Likeness;
use super::point::{GeodeticPosition, TrajectoryPoint};
use super::track::ReferencePoint;
use octant_earth::ellipsoid::Ellipsoid;
use std::f64::consts::{PI, TAU};

/// Errors that have a band of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorName {
    /// North, m.
    Latitude,
    /// East, m.
    Longitude,
    /// Horizontal distance, m.
    Radial,
    /// Velocity to the north, m/s.
    North,
    /// Velocity to the east, m/s.
    East,
    /// Roll, rad.
    Roll,
    /// Pitch, rad.
    Pitch,
    /// Heading, rad.
    Heading,
}

/// Quantities whose likeness is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Position, m.
    Position,
    /// Velocity over ground, m/s.
    Velocity,
    /// Roll, rad.
    Roll,
    /// Pitch, rad.
    Pitch,
    /// Heading, rad.
    Heading,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::Position, Self::Velocity, Self::Roll, Self::Pitch, Self::Heading];

    /// Name in messages.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Position => "positions",
            Self::Velocity => "velocities",
            Self::Roll => "roll angles",
            Self::Pitch => "pitch angles",
            Self::Heading => "headings",
        }
    }
}

/// Angles of an attitude in its order.
const ANGLES: [(Quantity, ErrorName); 3] = [
    (Quantity::Roll, ErrorName::Roll),
    (Quantity::Pitch, ErrorName::Pitch),
    (Quantity::Heading, ErrorName::Heading),
];

/// Sums over all points that were compared.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Position of the first reference, rad: the zero of positions.
    zero_rad: Option<[f64; 2]>,
    likeness: [Likeness; 5],
    bands: [StatedBand; 8],
    /// Bands of roll, pitch and heading by the last digits of both.
    digits: [StatedBand; 3],
    /// Time and heading of the last reference, ns and rad.
    turned: Option<(u64, f64)>,
    headings: Vec<ComparedHeading>,
    /// Largest change of a heading of the solution by one in its last digit, rad, and the largest doubt of its time, s.
    coarsest: [f64; 2],
    /// Largest turn of the reference in the doubt of a heading's time, rad.
    late_rad: f64,
    /// Times of answers without a heading, ns of the run.
    without_ns: Vec<u64>,
}

/// Headings of solution and reference at one time of the run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComparedHeading {
    /// Time of the run, ns.
    pub time_ns: u64,
    /// Heading of the solution, rad.
    pub solution_rad: f64,
    /// Heading of the reference, rad.
    pub reference_rad: f64,
}

/// Most headings that are kept: five and a half hours at 100 Hz, 48 MB.
const HEADINGS_MAX: usize = 2_000_000;

impl Default for Comparison {
    fn default() -> Self {
        let axes = |quantity| match quantity {
            Quantity::Position | Quantity::Velocity => 2,
            _ => 1,
        };
        let likeness = Quantity::ALL.map(|quantity| Likeness::of_axes(axes(quantity)));
        Self {
            zero_rad: None,
            likeness,
            bands: Default::default(),
            digits: Default::default(),
            turned: None,
            headings: Vec::new(),
            coarsest: [0.0; 2],
            late_rad: 0.0,
            without_ns: Vec::new(),
        }
    }
}

impl Comparison {
    /// A comparison of so many points, for which it has the memory.
    pub(crate) fn of_points(points: u64) -> Self {
        let points = usize::try_from(points).unwrap_or(usize::MAX).min(HEADINGS_MAX);
        Self { headings: Vec::with_capacity(points), ..Self::default() }
    }

    /// Headings of solution and reference, so far as there are some and they are kept.
    #[must_use]
    pub fn headings(&self) -> &[ComparedHeading] {
        &self.headings
    }

    /// Largest change of a heading of the solution by one in its last digit, rad, and largest doubt of its time, s.
    #[must_use]
    pub fn coarsest_heading(&self) -> [f64; 2] {
        self.coarsest
    }

    /// Largest turn of the reference in the doubt of a heading's time, rad.
    #[must_use]
    pub fn late_rad(&self) -> f64 {
        self.late_rad
    }

    /// Times at which the instrument answered without a heading, ns of the run.
    #[must_use]
    pub fn without_heading_ns(&self) -> &[u64] {
        &self.without_ns
    }

    /// Takes an answer without a heading.
    pub(crate) fn push_without(&mut self, time_ns: u64) {
        self.without_ns.push(time_ns);
    }

    /// Likeness of a quantity; without points where both don't have it.
    #[must_use]
    pub fn likeness(&self, quantity: Quantity) -> &Likeness {
        &self.likeness[quantity as usize]
    }

    /// Band of an error by what the reference states.
    #[must_use]
    pub fn band(&self, error: ErrorName) -> &StatedBand {
        &self.bands[error as usize]
    }

    /// Band of an error by the last digits of solution and reference, and by the doubt of a heading's time: a rounded number
    /// is off by half of its last digit. `None`: the error has none.
    #[must_use]
    pub fn digits(&self, error: ErrorName) -> Option<&StatedBand> {
        Some(&self.digits[ANGLES.iter().position(|(_, angle)| *angle == error)?])
    }

    /// Takes a point of the solution and its reference.
    pub(crate) fn push(&mut self, time_ns: u64, point: &TrajectoryPoint, there: &ReferencePoint) {
        if let Some((here, there_at)) = point.position.zip(there.position) {
            self.push_position(time_ns, &here, &there_at, there.sigma.position_m);
        }
        if let (Some(here), Some(there_mps)) = (point.velocity_mps, there.velocity_mps) {
            if let Some([north, east]) = there.sigma.velocity_mps {
                self.bands[ErrorName::North as usize].push(here[0] - there_mps[0], north);
                self.bands[ErrorName::East as usize].push(here[1] - there_mps[1], east);
            }
            self.likeness[Quantity::Velocity as usize].push(time_ns, here, there_mps);
        }
        if point.attitude.is_some() {
            self.coarsest[0] = self.coarsest[0].max(point.digit_rad[2]);
            self.coarsest[1] = self.coarsest[1].max(point.attitude_doubt_s);
        }
        if let (Some(here), Some(there_rad)) = (point.attitude, there.attitude_rad()) {
            let tilt = here.tilt_rad.is_some() && there.tilt;
            let here_rad = here.or_level_rad();
            let rate_radps = self.rate_radps(time_ns, there_rad[2]);
            if self.headings.len() < self.headings.capacity() {
                let (solution_rad, reference_rad) = (here_rad[2], there_rad[2]);
                self.headings.push(ComparedHeading { time_ns, solution_rad, reference_rad });
            }
            self.late_rad = self.late_rad.max(rate_radps * point.attitude_doubt_s);
            for (axis, (quantity, error)) in ANGLES.into_iter().enumerate() {
                if !(tilt || error == ErrorName::Heading) {
                    continue;
                }
                let off = wrapped(here_rad[axis] - there_rad[axis]);
                if let Some(sigma) = there.sigma.attitude_rad {
                    self.bands[error as usize].push(off, sigma[axis]);
                }
                let half = 0.5 * libm::hypot(point.digit_rad[axis], there.digit_rad[axis]);
                let is_heading = error == ErrorName::Heading;
                let late = if is_heading { rate_radps * point.attitude_doubt_s } else { 0.0 };
                self.digits[axis].push(off, libm::hypot(half, late) / EXPANDED);
                let likeness = &mut self.likeness[quantity as usize];
                likeness.push(time_ns, [there_rad[axis] + off, 0.0], [there_rad[axis], 0.0]);
            }
        }
    }

    /// Rate of turn of the reference since its last point.
    fn rate_radps(&mut self, time_ns: u64, heading_rad: f64) -> f64 {
        let last = self.turned.replace((time_ns, heading_rad));
        last.filter(|(last_ns, _)| *last_ns < time_ns).map_or(0.0, |(last_ns, last_rad)| {
            wrapped(heading_rad - last_rad).abs() * 1e9 / (time_ns - last_ns) as f64
        })
    }

    fn push_position(
        &mut self,
        time_ns: u64,
        here: &GeodeticPosition,
        there: &GeodeticPosition,
        sigma_m: Option<[f64; 2]>,
    ) {
        let zero_rad = *self.zero_rad.get_or_insert([there.latitude_rad, there.longitude_rad]);
        let earth = Ellipsoid::at(there.latitude_rad, there.height_m);
        let across_m = earth.transverse_radius_m * earth.cos_latitude;
        let metres = |latitude_rad: f64, longitude_rad: f64| {
            [
                (latitude_rad - zero_rad[0]) * earth.meridian_radius_m,
                wrapped(longitude_rad - zero_rad[1]) * across_m,
            ]
        };
        let here_m = metres(here.latitude_rad, here.longitude_rad);
        let there_m = metres(there.latitude_rad, there.longitude_rad);
        self.likeness[Quantity::Position as usize].push(time_ns, here_m, there_m);
        let off_m = [0, 1].map(|axis| here_m[axis] - there_m[axis]);
        let mut band = |error: ErrorName, value: f64, sigma: f64| {
            self.bands[error as usize].push(value, sigma);
        };
        if let Some([north, east]) = sigma_m {
            band(ErrorName::Latitude, off_m[0], north);
            band(ErrorName::Longitude, off_m[1], east);
            band(ErrorName::Radial, libm::hypot(off_m[0], off_m[1]), north.max(east));
        }
    }
}

/// An angle within half a turn.
fn wrapped(rad: f64) -> f64 {
    (rad + PI).rem_euclid(TAU) - PI
}
