//! SBET, "smoothed best estimate of trajectory": records of 17 doubles, little endian, without a header.
//!
//! Time is in seconds of the GPS week, which may end in the file, angles in rad. Velocities are left out: the programs that write such files
//! don't agree about their axes. Heading counts from the platform's x axis, which the wander angle turns away from
//! north; they don't agree about its sign either, so an attitude is taken where it is zero.

use super::point::{
    GeodeticPosition, PointAttitude, PointSigma, Points, TimeScale, TrajectoryPoint,
};
use super::tally::Tally;
use std::fs::File;
use std::io::{BufReader, Read};

const FIELDS: usize = 17;
const RECORD: usize = 8 * FIELDS;

/// Seconds of a GPS week.
const WEEK_S: f64 = 604_800.0;
/// Longest gap over the end of a week.
const WEEK_GAP_MAX_S: f64 = 3600.0;

pub(crate) struct SbetReader {
    file: BufReader<File>,
    records: u64,
    /// Seconds of the weeks that ended in the file.
    weeks_s: f64,
    last_s: f64,
    tally: Tally,
}

impl SbetReader {
    pub(crate) fn new(file: File) -> Result<Self, String> {
        let bytes = file.metadata().map_err(|error| error.to_string())?.len();
        if bytes == 0 || !bytes.is_multiple_of(RECORD as u64) {
            return Err(format!("found {bytes} bytes, expected records of {RECORD} bytes"));
        }
        let file = BufReader::with_capacity(1 << 16, file);
        Ok(Self { file, records: 0, weeks_s: 0.0, last_s: 0.0, tally: Tally::default() })
    }
}

impl Points for SbetReader {
    fn next(&mut self) -> Result<Option<TrajectoryPoint>, String> {
        let mut bytes = [0; RECORD];
        let begun = self.file.read(&mut bytes[..1]).map_err(|error| error.to_string())?;
        if begun == 0 {
            return Ok(None);
        }
        self.records += 1;
        let read = self.file.read_exact(&mut bytes[1..]);
        read.map_err(|error| format!("{}: {error}", self.place()))?;
        let mut fields = [0.0; FIELDS];
        for (field, bytes) in fields.iter_mut().zip(bytes.as_chunks().0) {
            *field = f64::from_le_bytes(*bytes);
        }
        let [
            time_s,
            latitude_rad,
            longitude_rad,
            height_m,
            _,
            _,
            _,
            roll,
            pitch,
            heading,
            wander,
            ..,
        ] = fields;
        if !(0.0..1e9).contains(&time_s) {
            let place = self.place();
            return Err(format!("{place}: found time {time_s} s, expected seconds of a GPS week"));
        }
        // Seconds that begin again with the week; some files count on. Other steps back are none of the week.
        if time_s < self.last_s
            && self.last_s <= WEEK_S
            && time_s + WEEK_S - self.last_s < WEEK_GAP_MAX_S
        {
            self.weeks_s += WEEK_S;
        }
        self.last_s = time_s;
        self.tally.point(1);
        Ok(Some(TrajectoryPoint {
            time_ns: ((self.weeks_s + time_s) * 1e9).round() as i64,
            position: Some(GeodeticPosition { latitude_rad, longitude_rad, height_m }),
            velocity_mps: None,
            attitude: (wander == 0.0).then_some(PointAttitude::of([roll, pitch, heading])),
            sigma: PointSigma::default(),
            digit_rad: [0.0; 3],
            attitude_doubt_s: 0.0,
        }))
    }

    fn place(&self) -> String {
        format!("record {}", self.records)
    }

    fn scale(&self) -> TimeScale {
        TimeScale::GpsWeek
    }

    fn tally(&self) -> &Tally {
        &self.tally
    }

    fn tally_mut(&mut self) -> &mut Tally {
        &mut self.tally
    }

    fn unit(&self) -> [&'static str; 2] {
        ["record", "records"]
    }
}
