//! What a comparison of a solution with its reference shows of both, besides the errors themselves.

use super::bands::StatedBand;
use super::likeness::Likeness;
use super::point::TrajectoryPoint;
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

/// Sums over all points that were compared.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Position of the first reference, rad: the zero of positions.
    zero_rad: Option<[f64; 2]>,
    likeness: [Likeness; 5],
    bands: [StatedBand; 8],
}

impl Default for Comparison {
    fn default() -> Self {
        let axes = |quantity| match quantity {
            Quantity::Position | Quantity::Velocity => 2,
            _ => 1,
        };
        let likeness = Quantity::ALL.map(|quantity| Likeness::of_axes(axes(quantity)));
        Self { zero_rad: None, likeness, bands: Default::default() }
    }
}

impl Comparison {
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

    /// Takes a point of the solution and its reference.
    pub(crate) fn push(&mut self, time_ns: u64, point: &TrajectoryPoint, there: &ReferencePoint) {
        let zero_rad = *self.zero_rad.get_or_insert([there.latitude_rad, there.longitude_rad]);
        let earth = Ellipsoid::at(there.latitude_rad, there.height_m);
        let across_m = earth.transverse_radius_m * earth.cos_latitude;
        let metres = |latitude_rad: f64, longitude_rad: f64| {
            [
                (latitude_rad - zero_rad[0]) * earth.meridian_radius_m,
                wrapped(longitude_rad - zero_rad[1]) * across_m,
            ]
        };
        let here_m = metres(point.latitude_rad, point.longitude_rad);
        let there_m = metres(there.latitude_rad, there.longitude_rad);
        self.likeness[Quantity::Position as usize].push(time_ns, here_m, there_m);
        let off_m = [0, 1].map(|axis| here_m[axis] - there_m[axis]);
        let mut band = |error: ErrorName, value: f64, sigma: f64| {
            self.bands[error as usize].push(value, sigma);
        };
        if let Some([north, east]) = there.sigma.position_m {
            band(ErrorName::Latitude, off_m[0], north);
            band(ErrorName::Longitude, off_m[1], east);
            band(ErrorName::Radial, libm::hypot(off_m[0], off_m[1]), north.max(east));
        }
        if let (Some(here), Some(there_mps)) = (point.velocity_mps, there.velocity_mps) {
            if let Some([north, east]) = there.sigma.velocity_mps {
                band(ErrorName::North, here[0] - there_mps[0], north);
                band(ErrorName::East, here[1] - there_mps[1], east);
            }
            self.likeness[Quantity::Velocity as usize].push(time_ns, here, there_mps);
        }
        let (Some(here), Some(there_rad)) = (point.attitude_rad, there.attitude_rad()) else {
            return;
        };
        let angles = [
            (Quantity::Roll, ErrorName::Roll),
            (Quantity::Pitch, ErrorName::Pitch),
            (Quantity::Heading, ErrorName::Heading),
        ];
        for (axis, (quantity, error)) in angles.into_iter().enumerate() {
            let off = wrapped(here[axis] - there_rad[axis]);
            if let Some(sigma) = there.sigma.attitude_rad {
                self.bands[error as usize].push(off, sigma[axis]);
            }
            let likeness = &mut self.likeness[quantity as usize];
            likeness.push(time_ns, [there_rad[axis] + off, 0.0], [there_rad[axis], 0.0]);
        }
    }
}

/// An angle within half a turn.
fn wrapped(rad: f64) -> f64 {
    (rad + PI).rem_euclid(TAU) - PI
}
