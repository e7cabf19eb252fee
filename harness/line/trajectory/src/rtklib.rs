//! Solutions of RTKLIB (`.pos`): latitude, longitude and height, with the velocity where it was written.
//!
//! Format: RTKLIB 2.4.2 manual, appendix B.1.

use super::point::{
    GeodeticPosition, LINE_BYTES_MAX, PointSigma, Points, SECOND_NS, TimeScale, TrajectoryPoint,
    WEEK_NS, gps_to_utc_ns,
};
use super::tally::Tally;
use octant_base::decimal::decimal_ns;
use octant_instruments::GPS_EPOCH_S;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::time::UNIX_EPOCH;

pub(crate) struct RtklibReader {
    file: BufReader<File>,
    text: String,
    line: u64,
    /// What the names of the columns say; `None`: they haven't come.
    columns: Option<RtklibColumns>,
    tally: Tally,
}

/// What a line that begins with `%` says of the rows.
#[derive(Clone, Copy, Debug)]
struct RtklibColumns {
    utc: bool,
    /// Position of the velocity north, counted from latitude; east follows.
    velocity: Option<usize>,
    /// Likewise the quality, and the standard deviations of position and velocity.
    quality: Option<usize>,
    sigma: Option<usize>,
    velocity_sigma: Option<usize>,
}

impl RtklibReader {
    pub(crate) fn new(file: File) -> Result<Self, String> {
        let file = BufReader::with_capacity(1 << 16, file);
        Ok(Self { file, text: String::new(), line: 0, columns: None, tally: Tally::default() })
    }

    fn read_line(&mut self) -> Result<bool, String> {
        self.text.clear();
        self.line += 1;
        let read = (&mut self.file).take(LINE_BYTES_MAX).read_line(&mut self.text);
        match read {
            Err(error) => Err(format!("line {}: {error}", self.line)),
            Ok(n) if n as u64 == LINE_BYTES_MAX => {
                Err(format!("line {}: longer than {LINE_BYTES_MAX} bytes", self.line))
            }
            Ok(n) => Ok(n > 0),
        }
    }

    fn point(&self, columns: RtklibColumns) -> Result<(TrajectoryPoint, &'static str), String> {
        let separated = |c: char| c.is_whitespace() || c == ',';
        let fields: Vec<&str> =
            self.text.split(separated).filter(|field| !field.is_empty()).collect();
        let [date, time, values @ ..] = fields.as_slice() else {
            return Err(self.error("found fewer than two columns, expected a time and a position"));
        };
        let number = |index: usize| -> Result<f64, String> {
            let text = values.get(index).copied().unwrap_or_default();
            let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
            value.ok_or_else(|| {
                self.error(&format!("column {}: found {text:?}, expected a number", index + 3))
            })
        };
        let time_ns = time_ns(date, time, columns.utc).ok_or_else(|| {
            self.error(&format!(
                "found {date:?} and {time:?}, expected a date and a time from 1999 on, or a GPS week \
                 and its second"
            ))
        })?;
        let two = |north: Option<usize>| match north {
            Some(north) => Ok::<_, String>(Some([number(north)?, number(north + 1)?])),
            None => Ok(None),
        };
        let quality = match columns.quality {
            Some(index) => quality(values.get(index).copied().unwrap_or_default()),
            None => "no stated quality",
        };
        // Zeros: the program had no estimate.
        let known = |sigma: &[f64; 2]| sigma.iter().any(|sigma| *sigma > 0.0);
        let sigma = PointSigma {
            position_m: two(columns.sigma)?.filter(known),
            velocity_mps: two(columns.velocity_sigma)?.filter(known),
            attitude_rad: None,
        };
        let point = TrajectoryPoint {
            time_ns,
            position: Some(GeodeticPosition {
                latitude_rad: number(0)?.to_radians(),
                longitude_rad: number(1)?.to_radians(),
                height_m: number(2)?,
            }),
            velocity_mps: two(columns.velocity)?,
            attitude: None,
            sigma,
            digit_rad: [0.0; 3],
            attitude_doubt_s: 0.0,
        };
        Ok((point, quality))
    }

    fn error(&self, reason: &str) -> String {
        format!("line {}: {reason}", self.line)
    }
}

impl Points for RtklibReader {
    fn next(&mut self) -> Result<Option<TrajectoryPoint>, String> {
        while self.read_line()? {
            if let Some(comment) = self.text.strip_prefix('%') {
                if let Some(columns) = columns_of(comment).map_err(|reason| self.error(&reason))? {
                    self.columns = Some(columns);
                }
                continue;
            }
            if self.text.trim().is_empty() {
                continue;
            }
            let Some(columns) = self.columns else {
                return Err(self.error(
                    "found no line before it that begins with % and names latitude(deg) and longitude(deg), \
                     as a solution of RTKLIB has it",
                ));
            };
            let (point, quality) = self.point(columns)?;
            self.tally.point(1);
            self.tally.quality(quality);
            return Ok(Some(point));
        }
        Ok(None)
    }

    fn place(&self) -> String {
        format!("line {}", self.line)
    }

    fn scale(&self) -> TimeScale {
        TimeScale::Utc
    }

    fn tally(&self) -> &Tally {
        &self.tally
    }

    fn tally_mut(&mut self) -> &mut Tally {
        &mut self.tally
    }

    fn unit(&self) -> [&'static str; 2] {
        ["row", "rows"]
    }
}

/// Words for a quality flag.
fn quality(flag: &str) -> &'static str {
    match flag {
        "1" => "quality 1 (fixed ambiguities)",
        "2" => "quality 2 (float ambiguities)",
        "3" => "quality 3 (SBAS)",
        "4" => "quality 4 (DGPS)",
        "5" => "quality 5 (single)",
        "6" => "quality 6 (PPP)",
        "7" => "quality 7 (dead reckoning)",
        _ => "another quality",
    }
}

/// Reads the line with the names of the columns; `None` for another comment.
fn columns_of(comment: &str) -> Result<Option<RtklibColumns>, String> {
    let names: Vec<&str> =
        comment.split([' ', ',', '\t']).filter(|name| !name.is_empty()).collect();
    let at = |wanted: &str| names.iter().position(|name| *name == wanted);
    let Some(latitude) = at("latitude(deg)") else {
        let other = ["x-ecef(m)", "e-baseline(m)", "latitude(d'\")"];
        return match names.iter().find(|name| other.contains(name)) {
            Some(found) => Err(format!(
                "found the column {found}, expected latitude(deg): RTKLIB's solution format \"Lat/Lon/Height\" \
                 in \"ddd.ddddddd\""
            )),
            None => Ok(None),
        };
    };
    let utc = match names.first() {
        Some(&"UTC") => true,
        Some(&"GPST") => false,
        found => {
            return Err(format!(
                "found times in {}, expected GPST or UTC",
                found.copied().unwrap_or_default()
            ));
        }
    };
    let after = |name: &str| at(name).map(|place| place - latitude);
    Ok(Some(RtklibColumns {
        utc,
        velocity: after("vn(m/s)"),
        quality: after("Q"),
        sigma: after("sdn(m)"),
        velocity_sigma: after("sdvn"),
    }))
}

/// Time of a row, UTC.
fn time_ns(date: &str, time: &str, utc: bool) -> Option<i64> {
    if let Ok(week) = date.parse::<u16>() {
        let of_week_ns = i64::try_from(decimal_ns(time, 9)?).ok()?;
        return gps_to_utc_ns(i64::from(week) * WEEK_NS + of_week_ns);
    }
    let (time, fraction) = time.split_once('.').unwrap_or((time, ""));
    let whole = octant_base::utc::parse(&format!("{}T{time}Z", date.replace('/', "-"))).ok()?;
    let whole_s = whole.duration_since(UNIX_EPOCH).ok()?.as_secs();
    let fraction_ns = i64::try_from(decimal_ns(&format!("0.{fraction}0"), 9)?).ok()?;
    let as_if_ns = i64::try_from(whole_s).ok()?.checked_mul(SECOND_NS)?.checked_add(fraction_ns)?;
    if utc {
        return Some(as_if_ns);
    }
    // Of GPS time the calendar is that of UTC without leap seconds.
    gps_to_utc_ns(as_if_ns.checked_sub(GPS_EPOCH_S * SECOND_NS)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_of_all_three_forms_are_the_same() {
        // 2017-01-01T00:00:00 UTC is second 18 of GPS week 1930.
        let utc_ns = 1_483_228_800 * SECOND_NS + 250_000_000;
        assert_eq!(time_ns("2017/01/01", "00:00:00.250", true), Some(utc_ns));
        assert_eq!(time_ns("2017/01/01", "00:00:18.25", false), Some(utc_ns));
        assert_eq!(time_ns("1930", "18.250", false), Some(utc_ns));
        for (date, time) in [("2017/13/01", "00:00:00"), ("x", "1"), ("1930", "-1"), ("1", "0")] {
            assert_eq!(time_ns(date, time, false), None, "{date} {time}");
        }
    }

    #[test]
    fn other_solutions_are_named() {
        let found = columns_of("  GPST  x-ecef(m)  y-ecef(m)").unwrap_err();
        assert!(found.contains("x-ecef(m)") && found.contains("latitude(deg)"), "{found}");
        assert!(columns_of(" JST latitude(deg) longitude(deg)").unwrap_err().contains("JST"));
        assert!(columns_of(" program   : RTKPOST ver.2.4.2").unwrap().is_none());
    }
}
