//! Navigation messages of units, in the bytes that they sent.
//!
//! Messages of one time belong to one point. Once a unit knows GPS time or UTC its points have that; those before, which have
//! its own clock alone, are left out, and so is what has no position that is valid. A unit that never knows it has a scale of its own.

use super::point::{Points, TimeScale, TrajectoryPoint, gps_to_utc_ns};
use octant_instruments::FramingEvent;
use octant_instruments::navigation::{
    NavigationDecoder, NavigationProtocol, NavigationReading, NavigationTime,
};
use std::fs::File;
use std::io::{ErrorKind, Read, Seek};

/// Bytes that are read at a time.
const PIECE: usize = 1 << 16;

pub(crate) struct MessageReader {
    scale: TimeScale,
    messages: Messages,
    begun: Option<(i64, NavigationReading)>,
    heard_ns: Option<i64>,
}

impl MessageReader {
    pub(crate) fn new(file: File, protocol: NavigationProtocol) -> Result<Self, String> {
        let mut messages = Messages::new(file, protocol);
        let (mut positions, mut is_utc) = (0_u64, false);
        while let Some(reading) = messages.next()? {
            positions += u64::from(reading.position_rad.is_some());
            is_utc = is_utc || utc_ns(reading.time).is_some();
            if is_utc && positions > 0 {
                break;
            }
        }
        if positions == 0 {
            let counters = messages.decoder.counters();
            return Err(format!(
                "found {} bytes with {} intact frames and no valid position, expected {}",
                counters.bytes,
                counters.readings + counters.other + counters.unknown,
                protocol.messages()
            ));
        }
        let mut file = messages.file;
        file.rewind().map_err(|error| error.to_string())?;
        let scale = if is_utc { TimeScale::Utc } else { TimeScale::Own };
        Ok(Self { scale, messages: Messages::new(file, protocol), begun: None, heard_ns: None })
    }

    fn time_ns(&self, time: NavigationTime) -> Option<i64> {
        match (self.scale, time) {
            (TimeScale::Own, NavigationTime::Own(ns)) => i64::try_from(ns).ok(),
            (TimeScale::Own, _) => None,
            _ => utc_ns(time),
        }
    }

    /// Takes a reading; returns the point that it ends.
    fn take(&mut self, reading: NavigationReading) -> Option<TrajectoryPoint> {
        let time_ns = self.time_ns(reading.time)?;
        self.heard_ns = self.heard_ns.max(Some(time_ns));
        match &mut self.begun {
            Some((begun_ns, begun)) if *begun_ns == time_ns => {
                begun.position_rad = begun.position_rad.or(reading.position_rad);
                begun.height_m = begun.height_m.or(reading.height_m);
                begun.velocity_mps = begun.velocity_mps.or(reading.velocity_mps);
                begun.attitude_rad = begun.attitude_rad.or(reading.attitude_rad);
                None
            }
            begun => begun.replace((time_ns, reading)).and_then(point),
        }
    }
}

fn utc_ns(time: NavigationTime) -> Option<i64> {
    match time {
        NavigationTime::Utc(ns) => Some(ns),
        NavigationTime::Gps(ns) => gps_to_utc_ns(i64::try_from(ns).ok()?),
        NavigationTime::Own(_) => None,
    }
}

fn point((time_ns, reading): (i64, NavigationReading)) -> Option<TrajectoryPoint> {
    let [latitude_rad, longitude_rad] = reading.position_rad?;
    Some(TrajectoryPoint {
        time_ns,
        latitude_rad,
        longitude_rad,
        height_m: reading.height_m.unwrap_or(0.0),
        velocity_mps: reading.velocity_mps.map(|[north, east, _]| [north, east]),
        attitude_rad: reading.attitude_rad,
    })
}

impl Points for MessageReader {
    fn next(&mut self) -> Result<Option<TrajectoryPoint>, String> {
        loop {
            let Some(reading) = self.messages.next()? else {
                return Ok(self.begun.take().and_then(point));
            };
            let ended = self.take(reading);
            if ended.is_some() {
                return Ok(ended);
            }
        }
    }

    fn place(&self) -> String {
        format!("before byte {}", self.messages.decoder.counters().bytes)
    }

    fn scale(&self) -> TimeScale {
        self.scale
    }

    fn heard_ns(&self) -> Option<i64> {
        self.heard_ns
    }
}

/// The messages of a file, one after the other.
struct Messages {
    file: File,
    decoder: NavigationDecoder,
    piece: Vec<u8>,
    /// Bytes of the piece that were taken.
    taken: usize,
    ended: bool,
}

impl Messages {
    fn new(file: File, protocol: NavigationProtocol) -> Self {
        let decoder = NavigationDecoder::new(protocol);
        Self { file, decoder, piece: Vec::new(), taken: 0, ended: false }
    }

    /// The next reading; damaged frames and other messages are passed over.
    fn next(&mut self) -> Result<Option<NavigationReading>, String> {
        loop {
            let event = if self.ended {
                match self.decoder.end() {
                    None => return Ok(None),
                    event => event,
                }
            } else {
                let mut rest = &self.piece[self.taken..];
                let event = self.decoder.next(&mut rest);
                self.taken = self.piece.len() - rest.len();
                event
            };
            match event {
                Some(FramingEvent::Reading(reading)) => return Ok(Some(reading)),
                Some(FramingEvent::Lost(_)) => {}
                None => self.refill()?,
            }
        }
    }

    fn refill(&mut self) -> Result<(), String> {
        self.piece.resize(PIECE, 0);
        self.taken = 0;
        let read = loop {
            match self.file.read(&mut self.piece) {
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                read => break read.map_err(|error| error.to_string())?,
            }
        };
        self.piece.truncate(read);
        self.ended = read == 0;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{TrajectoryReader, TrajectorySurvey};
    use octant_scenario::trajectory::TrajectoryFormat;

    /// The reflected CRC-32 of NovAtel, bit by bit.
    fn crc(bytes: &[u8]) -> u32 {
        bytes.iter().fold(0, |crc, byte| {
            (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
                if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 }
            })
        })
    }

    /// A line of INSPVAS at a second of GPS week 2345.
    fn line(second: f64, latitude: f64, status: &str) -> String {
        let text = format!(
            "INSPVASA,2345,{second:.3};2345,{second:.9},{latitude:.11},-6.5,100.25,1.5,-2.25,0.125,2,-3,271.5,{status}"
        );
        format!("%{text}*{:08x}\r\n", crc(text.as_bytes()))
    }

    fn file(bytes: &[u8]) -> tempfile::NamedTempFile {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), bytes).unwrap();
        file
    }

    const NOVATEL: TrajectoryFormat = TrajectoryFormat::Messages(NavigationProtocol::Novatel);

    #[test]
    fn lines_become_points_in_utc() {
        let mut text = line(345_600.0, 0.0, "INS_ALIGNING");
        for k in 1..=5 {
            text +=
                &line(345_600.0 + f64::from(k), 53.0 + f64::from(k) * 1e-6, "INS_SOLUTION_GOOD");
        }
        let file = file(text.as_bytes());
        let survey = TrajectorySurvey::of(file.path(), &NOVATEL).unwrap();
        assert_eq!((survey.points, survey.period_ns), (5, 1_000_000_000));
        assert_eq!((survey.scale, survey.velocity, survey.attitude), (TimeScale::Utc, true, true));
        // Second 345601 of week 2345 is 18 leap seconds after midnight of the Thursday 2024-12-19.
        let midnight = octant_base::utc::parse("2024-12-19T00:00:00Z").unwrap();
        let ns = midnight.duration_since(std::time::UNIX_EPOCH).unwrap().as_nanos() as i64;
        assert_eq!(survey.first.time_ns, ns + 1_000_000_000 - 18_000_000_000);
        assert_eq!(survey.first.height_m, 100.25);
        assert_eq!(survey.first.velocity_mps, Some([1.5, -2.25]));
        assert!((survey.first.latitude_rad.to_degrees() - 53.000_001).abs() < 1e-10);
        assert_eq!(survey.first.attitude_rad, Some([2.0, -3.0, 271.5].map(f64::to_radians)));
    }

    #[test]
    fn a_damaged_line_is_a_missing_point() {
        let lines: Vec<String> =
            (0..5).map(|k| line(100.0 + f64::from(k), 53.0, "INS_SOLUTION_FREE")).collect();
        let damaged = lines[2].replace("53.", "54.");
        let text =
            [&lines[0], &lines[1], &damaged, &lines[3], &lines[4]].map(String::as_str).concat();
        let survey = TrajectorySurvey::of(file(text.as_bytes()).path(), &NOVATEL).unwrap();
        assert_eq!(survey.points, 4);
        // Cut in the middle of a line, it has the points before.
        let cut = file(&text.as_bytes()[..text.len() - 20]);
        assert_eq!(TrajectorySurvey::of(cut.path(), &NOVATEL).unwrap().points, 3);
    }

    #[test]
    fn what_has_no_position_is_told() {
        let refused = |bytes: &[u8], format: &TrajectoryFormat| {
            TrajectoryReader::open(file(bytes).path(), format).unwrap_err().to_string()
        };
        let aligning = line(1.0, 53.0, "INS_ALIGNING");
        let said = refused(aligning.as_bytes(), &NOVATEL);
        assert!(said.contains("1 intact frames and no valid position, expected INSPVA"), "{said}");
        let sbg = TrajectoryFormat::Messages(NavigationProtocol::Sbg);
        let said = refused(line(1.0, 53.0, "INS_SOLUTION_GOOD").as_bytes(), &sbg);
        assert!(said.contains("0 intact frames and no valid position, expected EKF_NAV"), "{said}");
        assert!(refused(b"", &NOVATEL).contains("found 0 bytes"));
    }

    #[test]
    fn time_that_runs_back_is_refused() {
        let text =
            [line(2.0, 53.0, "INS_SOLUTION_GOOD"), line(1.0, 53.0, "INS_SOLUTION_GOOD")].concat();
        let file = file(text.as_bytes());
        let said = TrajectorySurvey::of(file.path(), &NOVATEL).unwrap_err().to_string();
        assert!(said.contains("found a time 1.000000000 s before"), "{said}");
        let nan = line(1.0, 53.0, "INS_SOLUTION_GOOD").replace(",1.5,", ",NaN,");
        let body = nan.split('*').next().unwrap().trim_start_matches('%').to_owned();
        let nan = format!("%{body}*{:08x}\r\n", crc(body.as_bytes()));
        let said = TrajectorySurvey::of(self::file(nan.as_bytes()).path(), &NOVATEL).unwrap_err();
        assert!(said.to_string().contains("found velocity north NaN m/s"), "{said}");
    }
}
