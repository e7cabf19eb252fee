//! A reference trajectory at any time.
//!
//! Between two points the position follows the cubic that has their velocities (Hermite), or a line where the file
//! has none: with an acceleration a, a line over the time T is wrong by a T²/8 at most. Velocity goes along a line,
//! attitude along the shortest turn.

use super::bands::EXPANDED;
use super::gaps::GapList;
use super::point::{GeodeticPosition, PointAttitude, PointSigma, TrajectoryPoint};
use super::reader::{TrajectoryError, TrajectoryReader};
use super::survey::TrajectorySurvey;
use octant_earth::UnitQuaternion;
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::frames::{c_nc, quaternion_from_matrix};
use std::f64::consts::{PI, TAU};

/// What a reference says at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferencePoint {
    /// Position; `None`: the file has headings alone.
    pub position: Option<GeodeticPosition>,
    /// Velocity over ground, north and east, m/s.
    pub velocity_mps: Option<[f64; 2]>,
    /// Attitude `q_nc` of the case: that of a level one, where the heading alone is known.
    pub q_nc: Option<UnitQuaternion<f64>>,
    /// True if roll and pitch are known.
    pub tilt: bool,
    /// Standard deviations that the file states: the larger of those of the points around it.
    pub sigma: PointSigma,
    /// Changes of roll, pitch and heading by one in their last digits, rad: the larger ones of the points around it.
    pub digit_rad: [f64; 3],
}

impl ReferencePoint {
    /// The reference of an instrument that a level table has turned by an angle.
    pub(crate) fn turned(self, azimuth_rad: f64) -> Self {
        if azimuth_rad == 0.0 {
            return self;
        }
        let turned = self
            .attitude_rad()
            .map(|[roll, pitch, heading]| q_nc([roll, pitch, heading + azimuth_rad]));
        Self { q_nc: turned, ..self }
    }

    /// Roll, pitch and heading, rad.
    #[must_use]
    pub fn attitude_rad(&self) -> Option<[f64; 3]> {
        let q = self.q_nc?;
        let [w, x, y, z] = [q.w, q.i, q.j, q.k];
        let sine = (2.0 * (w * y - z * x)).clamp(-1.0, 1.0);
        Some([
            libm::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
            libm::asin(sine),
            libm::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)),
        ])
    }
}

/// Attitude of the case as a quaternion `q_nc` from roll, pitch and heading.
#[must_use]
pub fn q_nc([roll, pitch, heading]: [f64; 3]) -> UnitQuaternion<f64> {
    quaternion_from_matrix(&c_nc(heading, pitch, roll))
}

/// Reference of a solution.
#[derive(Debug)]
pub(crate) enum Reference {
    /// A file, with what it holds.
    File(Box<ReferenceTrack>, Box<TrajectorySurvey>),
    /// The same at all times.
    Constant(ReferencePoint),
}

impl Reference {
    /// A heading that was surveyed, rad, with its expanded uncertainty (95 %).
    pub(crate) fn heading(heading_rad: f64, uncertainty_rad: Option<f64>) -> Self {
        let sigma_rad = uncertainty_rad.map(|uncertainty_rad| uncertainty_rad / EXPANDED);
        Self::Constant(ReferencePoint {
            position: None,
            velocity_mps: None,
            q_nc: Some(q_nc([0.0, 0.0, heading_rad])),
            tilt: false,
            sigma: PointSigma {
                attitude_rad: sigma_rad.map(|sigma_rad| [sigma_rad; 3]),
                ..PointSigma::default()
            },
            digit_rad: [0.0; 3],
        })
    }

    /// No reference: nothing is known of the truth.
    pub(crate) fn unknown() -> Self {
        Self::Constant(ReferencePoint {
            position: None,
            velocity_mps: None,
            q_nc: None,
            tilt: false,
            sigma: PointSigma::default(),
            digit_rad: [0.0; 3],
        })
    }

    /// Returns the reference at a time of its file, ns.
    ///
    /// # Errors
    /// If the file is damaged.
    pub(crate) fn at(&mut self, time_ns: i64) -> Result<Option<ReferencePoint>, TrajectoryError> {
        match self {
            Self::File(track, _) => track.at(time_ns),
            Self::Constant(point) => Ok(Some(*point)),
        }
    }

    /// Returns whether it has positions, and roll and pitch.
    pub(crate) fn has(&self) -> [bool; 2] {
        match self {
            Self::File(_, survey) => [survey.position, survey.tilt],
            Self::Constant(point) => [point.position.is_some(), point.tilt],
        }
    }
}

/// Reads a reference forward, for times that run forward.
#[derive(Debug)]
pub struct ReferenceTrack {
    reader: TrajectoryReader,
    gap_ns: i64,
    before: Option<TrajectoryPoint>,
    after: Option<TrajectoryPoint>,
    /// Gaps of its own period, so far as it was asked for.
    gaps: GapList,
}

impl ReferenceTrack {
    /// A track whose points have a gap between them if they are further apart than `gap_ns`; normally they are
    /// `period_ns` apart.
    ///
    /// # Errors
    /// If the file can't be read.
    pub fn new(
        mut reader: TrajectoryReader,
        gap_ns: i64,
        period_ns: i64,
    ) -> Result<Self, TrajectoryError> {
        let after = reader.next()?;
        Ok(Self { reader, gap_ns, before: None, after, gaps: GapList::new(period_ns) })
    }

    /// Gaps of the reference between its points, so far as it was asked for.
    pub(crate) fn gaps(&self) -> &GapList {
        &self.gaps
    }

    /// Returns the reference at a time of its file, ns; `None` before its beginning, after its end and in a gap.
    ///
    /// # Errors
    /// If the file is damaged.
    pub fn at(&mut self, time_ns: i64) -> Result<Option<ReferencePoint>, TrajectoryError> {
        while let Some(after) = self.after.filter(|after| after.time_ns <= time_ns) {
            self.before = Some(after);
            self.after = self.reader.next()?;
            if let Some(next) = &self.after {
                let bridged = next.time_ns - after.time_ns <= self.gap_ns;
                self.gaps.step(after.time_ns, next.time_ns, || {
                    if bridged { "interpolated" } else { "nothing is scored in it" }.to_owned()
                });
            }
        }
        Ok(match (&self.before, &self.after) {
            (Some(before), Some(after)) if after.time_ns - before.time_ns <= self.gap_ns => {
                Some(between(before, after, time_ns))
            }
            // On a point itself nothing is interpolated.
            (Some(before), _) if before.time_ns == time_ns => {
                Some(between(before, before, time_ns))
            }
            _ => None,
        })
    }
}

fn between(a: &TrajectoryPoint, b: &TrajectoryPoint, time_ns: i64) -> ReferencePoint {
    let length_s = (b.time_ns - a.time_ns) as f64 * 1e-9;
    let share = if length_s > 0.0 { (time_ns - a.time_ns) as f64 * 1e-9 / length_s } else { 0.0 };
    let line = |a: f64, b: f64| a + (b - a) * share;
    let velocities = a.velocity_mps.zip(b.velocity_mps);
    let turns = a.attitude.zip(b.attitude);
    let quaternion = |attitude: PointAttitude| q_nc(attitude.or_level_rad());
    ReferencePoint {
        position: a
            .position
            .zip(b.position)
            .map(|(from, to)| moved(&from, &to, velocities, share, length_s)),
        velocity_mps: velocities.map(|(a, b)| [line(a[0], b[0]), line(a[1], b[1])]),
        // Two attitudes on opposite sides have no shortest turn; the first is as good as any.
        q_nc: turns.map(|(a, b)| {
            let (a, b) = (quaternion(a), quaternion(b));
            a.try_slerp(&b, share, 1e-12).unwrap_or(a)
        }),
        tilt: turns.is_some_and(|(a, b)| a.tilt_rad.is_some() && b.tilt_rad.is_some()),
        sigma: a.sigma.larger(b.sigma),
        digit_rad: std::array::from_fn(|axis| a.digit_rad[axis].max(b.digit_rad[axis])),
    }
}

/// Position between two others that are a time apart, s, at a share of it.
fn moved(
    a: &GeodeticPosition,
    b: &GeodeticPosition,
    velocities: Option<([f64; 2], [f64; 2])>,
    share: f64,
    length_s: f64,
) -> GeodeticPosition {
    let east_rad = (b.longitude_rad - a.longitude_rad + PI).rem_euclid(TAU) - PI;
    let north_rad = b.latitude_rad - a.latitude_rad;
    let mut moved = [north_rad * share, east_rad * share];
    if let Some((va, vb)) = velocities {
        let [ra, rb] = [(a, va), (b, vb)].map(|(place, [north, east])| {
            let earth = Ellipsoid::at(place.latitude_rad, place.height_m);
            let across_m = earth.transverse_radius_m * earth.cos_latitude;
            [north / earth.meridian_radius_m, east / across_m].map(|rate| rate * length_s)
        });
        let (s, ends) = (share, [north_rad, east_rad]);
        for axis in 0..2 {
            moved[axis] = s * s * (3.0 - 2.0 * s) * ends[axis]
                + s * (1.0 - s) * ((1.0 - s) * ra[axis] - s * rb[axis]);
        }
    }
    GeodeticPosition {
        latitude_rad: a.latitude_rad + moved[0],
        longitude_rad: a.longitude_rad + moved[1],
        height_m: a.height_m + (b.height_m - a.height_m) * share,
    }
}
