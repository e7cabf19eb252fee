//! NovAtel's `INSPVA` (507), `INSPVAS` (508) and `INSPVAX` (1465), binary and ASCII.
//!
//! Heights of `INSPVA` are above the ellipsoid; `INSPVAX` has one above the geoid, and the undulation. Its time is that of the
//! header. Roll is right-handed about the forward axis, pitch about the right one, azimuth from north by east. A receiver
//! may send several of the logs: the first one with a solution counts, and the others are left out.

use super::reading::{NavigationReading, NavigationSigma, position_rad};
use super::time::gps;
use crate::bytes::Reader;
use crate::framing::{Extent, Framing, ReadingDefect};
use crate::novatel::{self, SYNC, ascii};

const INSPVA: u16 = 507;
const INSPVAS: u16 = 508;
const INSPVAX: u16 = 1465;
const INSPVA_BYTES: usize = 88;
const INSPVAX_BYTES: usize = 126;
/// A line of INSPVAX, with room.
const MAX_BYTES: usize = 768;

/// Status words of a solution, as numbers and as texts.
const SOLUTIONS: [(u32, &str); 4] = [
    (2, "INS_HIGH_VARIANCE"),
    (3, "INS_SOLUTION_GOOD"),
    (6, "INS_SOLUTION_FREE"),
    (7, "INS_ALIGNMENT_COMPLETE"),
];

/// Navigation messages of NovAtel.
#[derive(Clone, Copy, Debug, Default)]
pub struct NovatelNavigation {
    /// The log that counts.
    log: Option<u16>,
}

impl Framing for NovatelNavigation {
    type Found = NavigationReading;
    type Room = [u8; MAX_BYTES];
    const EMPTY: Self::Room = [0; MAX_BYTES];

    fn begins(&self, byte: u8) -> bool {
        byte == SYNC[0] || ascii::begins(byte)
    }

    fn extent(&self, bytes: &[u8]) -> Extent {
        novatel::extent(bytes, MAX_BYTES)
    }

    fn read(&mut self, frame: &[u8]) -> Result<Option<NavigationReading>, ReadingDefect> {
        let found = if frame.first() == Some(&SYNC[0]) { binary(frame)? } else { line(frame)? };
        let Some((log, reading)) = found else { return Ok(None) };
        if reading.position_rad.is_some() {
            self.log.get_or_insert(log);
        }
        let counts = self.log.is_none_or(|counts| counts == log);
        Ok(counts.then_some(reading))
    }
}

type Log = Option<(u16, NavigationReading)>;

/// Values in the order of both logs: latitude, longitude, height; north, east, up; roll, pitch, azimuth.
fn reading(
    time: (u32, f64),
    status: Option<&'static str>,
    height_m: f64,
    values: [f64; 9],
    sigma: NavigationSigma,
) -> Result<NavigationReading, ReadingDefect> {
    let time = gps(time.0, time.1)
        .ok_or(ReadingDefect::Unknown { field: "second of the week", found: time.1 as u32 })?;
    let Some(status) = status else { return Ok(NavigationReading::at(time)) };
    let [latitude, longitude, _, north, east, up, roll, pitch, azimuth] = values;
    Ok(NavigationReading {
        time,
        position_rad: position_rad([latitude, longitude]),
        height_m: Some(height_m),
        velocity_mps: Some([north, east, -up]),
        attitude_rad: Some([roll, pitch, azimuth].map(f64::to_radians)),
        sigma,
        quality: Some(status),
    })
}

/// Standard deviations in the order of INSPVAX: latitude, longitude, height, m; north, east, up, m/s; roll, pitch,
/// azimuth, deg.
fn sigma([a, b, c, d, e, f, g, h, i]: [f64; 9]) -> NavigationSigma {
    NavigationSigma {
        position_m: Some([a, b, c]),
        velocity_mps: Some([d, e, f]),
        attitude_rad: Some([g, h, i].map(f64::to_radians)),
    }
}

fn binary(frame: &[u8]) -> Result<Log, ReadingDefect> {
    let log = novatel::checked(frame)?;
    let fields = &mut Reader::new(log.data);
    let status_of =
        |status: u32| SOLUTIONS.iter().find(|(number, _)| *number == status).map(|(_, name)| *name);
    let is = |bytes: usize| {
        let found = log.data.len();
        let unknown = ReadingDefect::Unknown { field: "length of the log", found: found as u32 };
        if found == bytes { Ok(()) } else { Err(unknown) }
    };
    match log.message {
        INSPVA | INSPVAS => {
            is(INSPVA_BYTES)?;
            let time = (fields.u32_le(), fields.f64_le());
            let values: [f64; 9] = core::array::from_fn(|_| fields.f64_le());
            let status = status_of(fields.u32_le());
            let none = NavigationSigma::default();
            Ok(Some((INSPVA, reading(time, status, values[2], values, none)?)))
        }
        INSPVAX => {
            is(INSPVAX_BYTES)?;
            let status = fields.u32_le();
            fields.skip(4);
            let position: [f64; 3] = core::array::from_fn(|_| fields.f64_le());
            let undulation_m = f64::from(fields.f32_le());
            let rest: [f64; 6] = core::array::from_fn(|_| fields.f64_le());
            let ([a, b, c], [d, e, f, g, h, i]) = (position, rest);
            let values = [a, b, c, d, e, f, g, h, i];
            let sigma = sigma(core::array::from_fn(|_| f64::from(fields.f32_le())));
            let time = (u32::from(log.time.0), f64::from(log.time.1) * 1e-3);
            let reading = reading(time, status_of(status), c + undulation_m, values, sigma)?;
            Ok(Some((INSPVAX, reading)))
        }
        _ => Ok(None),
    }
}

fn line(frame: &[u8]) -> Result<Log, ReadingDefect> {
    let (_, text) = ascii::checked(frame)?;
    let Some((head, data)) = text.split_once(';') else { return Ok(None) };
    let no_number = |field| ReadingDefect::NoNumber { field };
    let number = |text: Option<&str>, field| {
        text.and_then(|text| text.parse::<f64>().ok()).ok_or(no_number(field))
    };
    let status_of = |status: Option<&str>| {
        SOLUTIONS.iter().find(|(_, name)| status == Some(*name)).map(|(_, name)| *name)
    };
    let mut heads = head.split(',');
    let mut fields = data.split(',');
    match heads.next() {
        Some("INSPVAA" | "INSPVASA") => {
            let week = fields.next().and_then(|text| text.parse().ok()).ok_or(no_number("week"))?;
            let time = (week, number(fields.next(), "seconds")?);
            let mut values = [0.0; 9];
            for value in &mut values {
                *value = number(fields.next(), "solution")?;
            }
            let status = status_of(fields.next());
            let none = NavigationSigma::default();
            Ok(Some((INSPVA, reading(time, status, values[2], values, none)?)))
        }
        Some("INSPVAXA") => {
            // Port, sequence, idle time and time status come before the time.
            let mut heads = heads.skip(4);
            let week = heads.next().and_then(|text| text.parse().ok()).ok_or(no_number("week"))?;
            let time = (week, number(heads.next(), "seconds")?);
            let status = fields.next();
            let mut fields = fields.skip(1);
            let mut all = [0.0; 10];
            for value in &mut all {
                *value = number(fields.next(), "solution")?;
            }
            let mut stated = [0.0; 9];
            for value in &mut stated {
                *value = number(fields.next(), "standard deviation")?;
            }
            let [a, b, c, undulation_m, d, e, f, g, h, i] = all;
            let values = [a, b, c, d, e, f, g, h, i];
            let (status, height_m) = (status_of(status), c + undulation_m);
            Ok(Some((INSPVAX, reading(time, status, height_m, values, sigma(stated))?)))
        }
        _ => Ok(None),
    }
}
