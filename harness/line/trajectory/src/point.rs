//! A position with velocity and attitude at a time, and the forms of files that hold such points.

use super::tally::Tally;
use octant_instruments::GPS_EPOCH_S;

/// Nanoseconds of a second.
pub const SECOND_NS: i64 = 1_000_000_000;
/// Nanoseconds of a week.
pub const WEEK_NS: i64 = 604_800 * SECOND_NS;

/// GPS time minus UTC, s, from a time on, s since 1970 (IERS Bulletin C).
const LEAP_SECONDS: [(i64, i64); 6] = [
    (1_483_228_800, 18), // 2017-01-01
    (1_435_708_800, 17), // 2015-07-01
    (1_341_100_800, 16), // 2012-07-01
    (1_230_768_000, 15), // 2009-01-01
    (1_136_073_600, 14), // 2006-01-01
    (915_148_800, 13),   // 1999-01-01
];

/// Scale on which a file tells the time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeScale {
    /// The file's own: nothing is known of its zero.
    Own,
    /// UTC, ns since 1970.
    Utc,
    /// GPS time in an unknown week, ns since its beginning; it goes on beyond the week's end.
    GpsWeek,
}

impl TimeScale {
    /// Name in messages.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Own => "a scale of its own",
            Self::Utc => "UTC",
            Self::GpsWeek => "seconds of a GPS week",
        }
    }

    /// What has to be added to a time of this scale, ns, to get that of another; `None` if it isn't known.
    /// `at_ns` is a time of this scale, and `other_ns` one of the other, of the same hours: they decide leap
    /// seconds and week.
    #[must_use]
    pub fn offset_to(self, other: Self, at_ns: i64, other_ns: i64) -> Option<i64> {
        match (self, other) {
            (Self::Utc, Self::Utc) => Some(0),
            (Self::GpsWeek, Self::GpsWeek) => Some(whole_weeks(other_ns - at_ns)),
            (Self::Utc, Self::GpsWeek) => {
                let of_gps = utc_to_gps_ns(at_ns)? - at_ns;
                Some(of_gps + whole_weeks(other_ns - (at_ns + of_gps)))
            }
            (Self::GpsWeek, Self::Utc) => {
                other.offset_to(self, other_ns, at_ns).map(|offset_ns| -offset_ns)
            }
            (Self::Own, _) | (_, Self::Own) => None,
        }
    }
}

/// The multiple of a week that is nearest.
fn whole_weeks(ns: i64) -> i64 {
    (ns + WEEK_NS / 2).div_euclid(WEEK_NS) * WEEK_NS
}

/// GPS time, ns since its epoch, of a UTC time, ns since 1970; `None` before 1999.
#[must_use]
pub fn utc_to_gps_ns(utc_ns: i64) -> Option<i64> {
    let utc_s = utc_ns.div_euclid(SECOND_NS);
    let leap_s = LEAP_SECONDS.iter().find(|(from_s, _)| utc_s >= *from_s)?.1;
    utc_ns.checked_add((leap_s - GPS_EPOCH_S) * SECOND_NS)
}

/// UTC, ns since 1970, of a GPS time, ns since its epoch; `None` before 1999.
#[must_use]
pub fn gps_to_utc_ns(gps_ns: i64) -> Option<i64> {
    let as_if_ns = gps_ns.checked_add(GPS_EPOCH_S * SECOND_NS)?;
    LEAP_SECONDS.iter().find_map(|(from_s, leap_s)| {
        let utc_ns = as_if_ns - leap_s * SECOND_NS;
        (utc_ns >= from_s * SECOND_NS).then_some(utc_ns)
    })
}

/// Standard deviations that a file states for one point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointSigma {
    /// Position, north and east, m.
    pub position_m: Option<[f64; 2]>,
    /// Velocity, north and east, m/s.
    pub velocity_mps: Option<[f64; 2]>,
    /// Roll, pitch and heading, rad.
    pub attitude_rad: Option<[f64; 3]>,
}

impl PointSigma {
    /// The larger one of both, axis by axis; that of one where the other has none.
    #[must_use]
    pub(crate) fn larger(self, other: Self) -> Self {
        fn each<const N: usize>(a: Option<[f64; N]>, b: Option<[f64; N]>) -> Option<[f64; N]> {
            match (a, b) {
                (Some(a), Some(b)) => Some(std::array::from_fn(|axis| a[axis].max(b[axis]))),
                (a, b) => a.or(b),
            }
        }
        Self {
            position_m: each(self.position_m, other.position_m),
            velocity_mps: each(self.velocity_mps, other.velocity_mps),
            attitude_rad: each(self.attitude_rad, other.attitude_rad),
        }
    }
}

/// A position on the ellipsoid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeodeticPosition {
    /// Geodetic latitude, rad.
    pub latitude_rad: f64,
    /// Longitude, rad.
    pub longitude_rad: f64,
    /// Height above the ellipsoid, m; 0 where the file has none.
    pub height_m: f64,
}

/// Attitude of the case, or its heading alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointAttitude {
    /// Heading from north by east, rad.
    pub heading_rad: f64,
    /// Roll and pitch, rad; `None`: the file has the heading alone.
    pub tilt_rad: Option<[f64; 2]>,
}

impl PointAttitude {
    /// The attitude of roll, pitch and heading, rad.
    #[must_use]
    pub const fn of([roll, pitch, heading]: [f64; 3]) -> Self {
        Self { heading_rad: heading, tilt_rad: Some([roll, pitch]) }
    }

    /// Roll, pitch and heading, rad: those of a level case, where the heading alone is known.
    #[must_use]
    pub fn or_level_rad(self) -> [f64; 3] {
        let [roll, pitch] = self.tilt_rad.unwrap_or_default();
        [roll, pitch, self.heading_rad]
    }
}

/// A point of a trajectory: at least one of position and attitude, or the answer of an instrument that has neither yet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrajectoryPoint {
    /// Time on the scale of the file, ns.
    pub time_ns: i64,
    /// Position; `None`: the file has headings alone.
    pub position: Option<GeodeticPosition>,
    /// Velocity over ground, north and east, m/s.
    pub velocity_mps: Option<[f64; 2]>,
    /// Attitude of the case.
    pub attitude: Option<PointAttitude>,
    /// Standard deviations that the file states.
    pub sigma: PointSigma,
    /// Change of roll, pitch and heading by one in their last digits, rad; 0 where the file has all digits.
    pub digit_rad: [f64; 3],
    /// How far the time of the attitude may be off, s: that of a sentence without one.
    pub attitude_doubt_s: f64,
}

impl TrajectoryPoint {
    /// True for the answer of an instrument that has no heading yet.
    #[must_use]
    pub fn is_without(&self) -> bool {
        self.position.is_none() && self.attitude.is_none()
    }

    /// Roll, pitch and heading, rad, where all three are known.
    #[must_use]
    pub fn attitude_rad(&self) -> Option<[f64; 3]> {
        self.attitude
            .filter(|attitude| attitude.tilt_rad.is_some())
            .map(PointAttitude::or_level_rad)
    }
}

/// Longest line of text, bytes: a file of another kind may have no line ends and must not fill the memory.
pub(crate) const LINE_BYTES_MAX: u64 = 64 * 1024;

/// A form of file.
pub(crate) trait Points: Send {
    /// Returns the next point; `None` at the end.
    fn next(&mut self) -> Result<Option<TrajectoryPoint>, String>;
    /// Place of the last point, as in "line 17".
    fn place(&self) -> String;
    fn scale(&self) -> TimeScale;
    /// Counts of what became of the units read so far.
    fn tally(&self) -> &Tally;
    fn tally_mut(&mut self) -> &mut Tally;
    /// Name of the units that are counted, singular and plural.
    fn unit(&self) -> [&'static str; 2];
    /// Latest time that the file told so far, also of what isn't valid and so no point; `None`: that of the last point.
    fn heard_ns(&self) -> Option<i64> {
        None
    }
    /// True if a point is given once the next one has begun: what was left out between both is counted by then.
    fn looks_ahead(&self) -> bool {
        false
    }
    /// Choices that were made in reading the file, in words that follow its name.
    fn choices(&self) -> Vec<&'static str> {
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gps_time_is_ahead_of_utc_by_the_leap_seconds() {
        // 2017-01-01T00:00:00 UTC is second 18 of GPS week 1930 (IGS's calendar of GPS weeks).
        let gps_ns = utc_to_gps_ns(1_483_228_800 * SECOND_NS).unwrap();
        assert_eq!(gps_ns, 1930 * WEEK_NS + 18 * SECOND_NS);
        // A second earlier it was 17 seconds ahead.
        let before_ns = utc_to_gps_ns(1_483_228_799 * SECOND_NS).unwrap();
        assert_eq!(before_ns, 1930 * WEEK_NS + 16 * SECOND_NS);
        for utc_s in [1_483_228_799, 1_483_228_800, 1_795_000_000, 915_148_800] {
            let utc_ns = utc_s * SECOND_NS;
            assert_eq!(gps_to_utc_ns(utc_to_gps_ns(utc_ns).unwrap()), Some(utc_ns));
        }
        assert_eq!(utc_to_gps_ns(0), None);
    }

    #[test]
    fn scales_that_are_known_have_an_offset() {
        let utc_ns = 1_806_480_000 * SECOND_NS;
        let week_ns = utc_to_gps_ns(utc_ns).unwrap().rem_euclid(WEEK_NS);
        let offset_ns = TimeScale::Utc.offset_to(TimeScale::GpsWeek, utc_ns, week_ns).unwrap();
        assert_eq!(utc_ns + offset_ns, week_ns);
        let back_ns = TimeScale::GpsWeek.offset_to(TimeScale::Utc, week_ns, utc_ns);
        assert_eq!(back_ns, Some(-offset_ns));
        // A file that counts on beyond the end of its week, beside one that begins anew.
        let (on_ns, anew_ns) = (WEEK_NS + 5 * SECOND_NS, 7 * SECOND_NS);
        assert_eq!(
            TimeScale::GpsWeek.offset_to(TimeScale::GpsWeek, on_ns, anew_ns),
            Some(-WEEK_NS)
        );
        assert_eq!(TimeScale::Own.offset_to(TimeScale::Utc, 0, 0), None);
        assert_eq!(TimeScale::Own.offset_to(TimeScale::Own, 0, 0), None);
    }
}
