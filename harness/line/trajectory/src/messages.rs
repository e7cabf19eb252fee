//! Navigation messages of units, in the bytes that they sent.
//!
//! Messages of one time belong to one point. Once a unit knows GPS time or UTC its points have that; those before, which have
//! its own clock alone, are left out, and so is what has no position that is valid. A unit that never knows it has a scale of its own.

use super::point::{
    GeodeticPosition, PointAttitude, PointSigma, Points, TimeScale, TrajectoryPoint, gps_to_utc_ns,
};
use super::tally::{OUT_OF_ORDER, Tally};
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
    begun: Option<Begun>,
    heard_ns: Option<i64>,
    /// Latest time of a point.
    given_ns: Option<i64>,
    tally: Tally,
    /// Frames of the decoder that are counted already: others, those that can't be decoded, damaged ones.
    frames: [u64; 3],
}

/// A point whose messages are still coming.
#[derive(Clone, Copy, Debug)]
struct Begun {
    time_ns: i64,
    messages: u64,
    reading: NavigationReading,
}

const FRAMES: [&str; 3] =
    ["frames of other messages", "frames that can't be decoded", "frames that are damaged"];
const NO_TIME: &str = "messages before the unit knew UTC or GPS time";
const INVALID: &str = "messages in which the unit says that nothing is valid";
const NO_POSITION: &str = "messages of times without a valid position";

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
        Ok(Self {
            scale,
            messages: Messages::new(file, protocol),
            begun: None,
            heard_ns: None,
            given_ns: None,
            tally: Tally::default(),
            frames: [0; 3],
        })
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
        let Some(time_ns) = self.time_ns(reading.time) else {
            self.leave_out(1, NO_TIME);
            return None;
        };
        let begun_ns = self.begun.map(|begun| begun.time_ns).or(self.given_ns);
        if let Some(begun_ns) = begun_ns.filter(|begun_ns| time_ns < *begun_ns) {
            let before_s = (begun_ns - time_ns) as f64 * 1e-9;
            let place = self.place();
            self.tally.left_out(1, OUT_OF_ORDER, || {
                format!("{place}: found a time {before_s:.9} s before the point before it")
            });
            return None;
        }
        self.heard_ns = self.heard_ns.max(Some(time_ns));
        let NavigationReading { position_rad, height_m, velocity_mps, attitude_rad, .. } = reading;
        if position_rad.is_none() && velocity_mps.is_none() && attitude_rad.is_none() {
            self.leave_out(1, INVALID);
            return None;
        }
        match &mut self.begun {
            Some(begun) if begun.time_ns == time_ns => {
                begun.messages += 1;
                let begun = &mut begun.reading;
                begun.position_rad = begun.position_rad.or(position_rad);
                begun.height_m = begun.height_m.or(height_m);
                begun.velocity_mps = begun.velocity_mps.or(velocity_mps);
                begun.attitude_rad = begun.attitude_rad.or(attitude_rad);
                begun.quality = begun.quality.or(reading.quality);
                begun.sigma = begun.sigma.or(reading.sigma);
                None
            }
            begun => {
                let last = begun.replace(Begun { time_ns, messages: 1, reading });
                last.and_then(|last| self.end(&last))
            }
        }
    }

    fn leave_out(&mut self, messages: u64, reason: &'static str) {
        let place = self.place();
        self.tally.left_out(messages, reason, || place);
    }

    /// Counts the messages of a point that is complete; returns it, where it has a position.
    fn end(&mut self, begun: &Begun) -> Option<TrajectoryPoint> {
        let Some(point) = point(begun) else {
            self.leave_out(begun.messages, NO_POSITION);
            return None;
        };
        self.tally.point(begun.messages);
        self.tally.quality(begun.reading.quality.unwrap_or("no stated mode"));
        self.given_ns = Some(point.time_ns);
        Some(point)
    }

    /// Counts the frames that the decoder passed over.
    fn count_frames(&mut self) {
        let counters = self.messages.decoder.counters();
        let now = [
            counters.other,
            counters.unknown,
            counters.checksum.saturating_add(counters.malformed),
        ];
        for (kind, (before, now)) in FRAMES.into_iter().zip(self.frames.into_iter().zip(now)) {
            self.leave_out(now.saturating_sub(before), kind);
        }
        self.frames = now;
    }
}

fn utc_ns(time: NavigationTime) -> Option<i64> {
    match time {
        NavigationTime::Utc(ns) => Some(ns),
        NavigationTime::Gps(ns) => gps_to_utc_ns(i64::try_from(ns).ok()?),
        NavigationTime::Own(_) => None,
    }
}

fn point(begun: &Begun) -> Option<TrajectoryPoint> {
    let Begun { time_ns, reading, .. } = *begun;
    let [latitude_rad, longitude_rad] = reading.position_rad?;
    let horizontal = |[north, east, _]: [f64; 3]| [north, east];
    Some(TrajectoryPoint {
        time_ns,
        position: Some(GeodeticPosition {
            latitude_rad,
            longitude_rad,
            height_m: reading.height_m.unwrap_or(0.0),
        }),
        velocity_mps: reading.velocity_mps.map(horizontal),
        attitude: reading.attitude_rad.map(PointAttitude::of),
        sigma: PointSigma {
            position_m: reading.sigma.position_m.map(horizontal),
            velocity_mps: reading.sigma.velocity_mps.map(horizontal),
            attitude_rad: reading.sigma.attitude_rad,
        },
        digit_rad: [0.0; 3],
        attitude_doubt_s: 0.0,
    })
}

impl Points for MessageReader {
    fn next(&mut self) -> Result<Option<TrajectoryPoint>, String> {
        loop {
            let next = self.messages.next()?;
            self.count_frames();
            let Some(reading) = next else {
                let last = self.begun.take();
                return Ok(last.and_then(|last| self.end(&last)));
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

    fn looks_ahead(&self) -> bool {
        true
    }

    fn tally(&self) -> &Tally {
        &self.tally
    }

    fn tally_mut(&mut self) -> &mut Tally {
        &mut self.tally
    }

    fn unit(&self) -> [&'static str; 2] {
        ["frame", "frames"]
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
        assert_eq!(survey.first.position.unwrap().height_m, 100.25);
        assert_eq!(survey.first.velocity_mps, Some([1.5, -2.25]));
        assert!(
            (survey.first.position.unwrap().latitude_rad.to_degrees() - 53.000_001).abs() < 1e-10
        );
        assert_eq!(survey.first.attitude_rad(), Some([2.0, -3.0, 271.5].map(f64::to_radians)));
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
