//! Columns of text.

use super::point::{
    GeodeticPosition, LINE_BYTES_MAX, PointAttitude, PointSigma, Points, TimeScale, TrajectoryPoint,
};
use super::tally::Tally;
use csv::StringRecord;
use octant_base::decimal::decimal_ns;
use octant_base::number::counted;
use octant_base::utc;
use octant_scenario::recorded::{Delimiter, RecordedColumn, TimeUnit};
use octant_scenario::trajectory::TrajectoryColumns;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};

/// Names of the columns in Octant's exports, in the order of time, position, velocity, attitude.
const NAMES: [&str; 9] = [
    "time_s",
    "latitude_deg",
    "longitude_deg",
    "height_m",
    "velocity_north_mps",
    "velocity_east_mps",
    "roll_deg",
    "pitch_deg",
    "heading_deg",
];

/// Number of columns that exports may have.
const EXPORTED: usize = NAMES.len();
/// Keys of the columns behind these, which exports don't have.
const FURTHER: [&str; 8] = [
    "sigma_north",
    "sigma_east",
    "sigma_velocity_north",
    "sigma_velocity_east",
    "sigma_roll",
    "sigma_pitch",
    "sigma_heading",
    "quality",
];

/// Reason of a row whose quality is one of those that were named.
const LEFT_OUT_QUALITY: &str = "rows of a quality that is left out";

/// Name of a column, or its key.
fn named(index: usize) -> &'static str {
    NAMES.iter().chain(&FURTHER).nth(index).copied().unwrap_or_default()
}

pub(crate) struct ColumnsReader {
    lines: Lines,
    time: (usize, TimeUnit),
    position: [usize; 2],
    height: Option<usize>,
    velocity: Option<[usize; 2]>,
    attitude: Option<[usize; 3]>,
    /// Standard deviations: position, velocity, attitude.
    position_sigma: Option<[usize; 2]>,
    velocity_sigma: Option<[usize; 2]>,
    attitude_sigma: Option<[usize; 3]>,
    quality: Option<usize>,
    /// Qualities whose rows are left out.
    left_out: Vec<String>,
    angle_rad: f64,
    velocity_mps: f64,
    scale: TimeScale,
    /// True if a time said no offset from UTC.
    unzoned: bool,
}

impl ColumnsReader {
    pub(crate) fn new(file: File, columns: &TrajectoryColumns) -> Result<Self, String> {
        let mut lines = Lines::new(file, columns);
        let TrajectoryColumns { time, position, velocity, attitude, sigma, quality, .. } = columns;
        let chosen: Vec<&Option<RecordedColumn>> = [&time.0]
            .into_iter()
            .chain(position)
            .chain(velocity)
            .chain(attitude)
            .chain(sigma)
            .chain([quality])
            .collect();
        lines.skip(columns.skip_lines)?;
        // Without a single name or default, all columns are numbers and there may be no header.
        let has_names = chosen[..EXPORTED]
            .iter()
            .any(|column| !matches!(column, Some(RecordedColumn::Number(_))));
        let only_numbers =
            chosen.iter().all(|c| matches!(c, None | Some(RecordedColumn::Number(_))))
                && time.0.is_some()
                && position[0].is_some();
        let header = if has_names && !only_numbers { Some(lines.header()?) } else { None };
        let has_truth =
            header.iter().flatten().any(|name| name == format!("true_{}", NAMES[1]).as_str());
        let place = |index: usize| -> Result<Option<usize>, String> {
            let name = match chosen[index] {
                Some(RecordedColumn::Number(0)) => {
                    return Err("found column 0, expected a number from 1".to_owned());
                }
                Some(RecordedColumn::Number(number)) => return Ok(Some(number - 1)),
                Some(RecordedColumn::Name(name)) => name.as_str(),
                // The exports have none of the others.
                None if index >= EXPORTED => return Ok(None),
                None => NAMES[index],
            };
            let Some(header) = &header else { return Ok(None) };
            let same = |wanted: &str| -> Result<Option<usize>, String> {
                let mut places = header.iter().enumerate().filter(|(_, found)| *found == wanted);
                let first = places.next().map(|(place, _)| place);
                match (first, places.next()) {
                    (Some(one), Some((other, _))) => Err(format!(
                        "found two columns {wanted:?}, {} and {}, expected one: say which by its number",
                        one + 1,
                        other + 1
                    )),
                    _ => Ok(first),
                }
            };
            // Where a table has the truth beside a solution, what it lacks isn't taken from the solution.
            let truth = same(&format!("true_{name}"))?;
            let found = match (has_truth, columns.truth_first && index > 0) {
                (true, true) => truth,
                _ => same(name)?.or(truth),
            };
            match (found, chosen[index]) {
                (None, Some(_)) => {
                    let names: Vec<&str> = header.iter().collect();
                    Err(format!("found no column {name:?}, the header has {}", names.join(", ")))
                }
                (found, _) => Ok(found),
            }
        };
        let needed = |index: usize| {
            place(index)?.ok_or_else(|| {
                let names = header.as_ref().map(|h| h.iter().collect::<Vec<_>>().join(", "));
                format!(
                    "found no column {:?}{}; expected it, or the scenario to say which column it is",
                    NAMES[index],
                    names.map_or_else(String::new, |names| format!(", the header has {names}"))
                )
            })
        };
        let all = |indices: &[usize]| -> Result<Option<Vec<usize>>, String> {
            let found: Vec<Option<usize>> =
                indices.iter().map(|index| place(*index)).collect::<Result<_, _>>()?;
            match found.iter().flatten().count() {
                0 => Ok(None),
                n if n == indices.len() => Ok(Some(found.into_iter().flatten().collect())),
                _ => {
                    let names: Vec<&str> = indices.iter().map(|index| named(*index)).collect();
                    Err(format!("found some of {}, expected all or none", names.join(", ")))
                }
            }
        };
        Ok(Self {
            time: (needed(0)?, time.1),
            position: [needed(1)?, needed(2)?],
            height: place(3)?,
            velocity: all(&[4, 5])?.map(|found| [found[0], found[1]]),
            attitude: all(&[6, 7, 8])?.map(|found| [found[0], found[1], found[2]]),
            position_sigma: all(&[9, 10])?.map(|found| [found[0], found[1]]),
            velocity_sigma: all(&[11, 12])?.map(|found| [found[0], found[1]]),
            attitude_sigma: all(&[13, 14, 15])?.map(|found| [found[0], found[1], found[2]]),
            quality: place(16)?,
            left_out: columns.left_out.clone(),
            angle_rad: columns.angle_rad,
            velocity_mps: columns.velocity_mps,
            scale: TimeScale::Own,
            unzoned: false,
            lines,
        })
    }

    /// Reads the time of a row: a number, or a date with a time.
    fn time_ns(&mut self) -> Result<i64, String> {
        let (index, unit) = self.time;
        let text = self.lines.field(index)?;
        let (found, scale, unzoned) = match utc::written(text, self.lines.fields.get(index + 1)) {
            Some(time) => (Some(time.since_1970_ns), TimeScale::Utc, !time.zoned),
            None => {
                let ns = decimal_ns(text, unit.nanosecond_exponent());
                (ns.and_then(|ns| i64::try_from(ns).ok()), TimeScale::Own, false)
            }
        };
        (self.scale, self.unzoned) = (scale, self.unzoned || unzoned);
        found.ok_or_else(|| {
            let found = self.lines.field(index).unwrap_or_default();
            self.lines.error(index, &format!("found {found:?}, expected a time"))
        })
    }
}

impl ColumnsReader {
    /// Returns whether the row has a quality that is left out.
    fn is_left_out(&self) -> Result<bool, String> {
        let Some(index) = self.quality.filter(|_| !self.left_out.is_empty()) else {
            return Ok(false);
        };
        let quality = self.lines.field(index)?;
        Ok(self.left_out.iter().any(|left_out| left_out == quality))
    }

    /// Standard deviations of the row. Zeros of all axes state none.
    fn sigma(&self) -> Result<PointSigma, String> {
        Ok(PointSigma {
            position_m: self.lines.sigma(self.position_sigma, 1.0)?,
            velocity_mps: self.lines.sigma(self.velocity_sigma, self.velocity_mps)?,
            attitude_rad: self.lines.sigma(self.attitude_sigma, self.angle_rad)?,
        })
    }
}

impl Points for ColumnsReader {
    fn next(&mut self) -> Result<Option<TrajectoryPoint>, String> {
        loop {
            if !self.lines.advance()? {
                return Ok(None);
            }
            // Programs write no number, or none that is one, where a unit has no position.
            let no_number = |index: usize| {
                let text = self.lines.fields.get(index);
                text.is_some_and(|text| text.is_empty() || text.eq_ignore_ascii_case("nan"))
            };
            let reason = if self.is_left_out()? {
                LEFT_OUT_QUALITY
            } else if self.position.into_iter().all(no_number) {
                "rows without a position"
            } else {
                break;
            };
            let line = self.lines.line;
            self.lines.tally.left_out(1, reason, || format!("line {line}"));
        }
        let time_ns = self.time_ns()?;
        let lines = &self.lines;
        let angle = |index: usize| Ok::<_, String>(lines.number(index)? * self.angle_rad);
        let [latitude_rad, longitude_rad] = [angle(self.position[0])?, angle(self.position[1])?];
        let height_m = self.height.map_or(Ok(0.0), |index| lines.number(index))?;
        let velocity_mps = match self.velocity {
            None => None,
            Some(columns) => {
                let mps = |index| Ok::<_, String>(lines.number(index)? * self.velocity_mps);
                Some([mps(columns[0])?, mps(columns[1])?])
            }
        };
        let attitude_rad = match self.attitude {
            None => None,
            Some([roll, pitch, heading]) => Some([angle(roll)?, angle(pitch)?, angle(heading)?]),
        };
        let sigma = self.sigma()?;
        self.lines.tally.point(1);
        if let Some(index) = self.quality {
            let quality = self.lines.field(index)?.to_owned();
            self.lines.tally.quality(&format!("quality {quality}"));
        }
        Ok(Some(TrajectoryPoint {
            time_ns,
            position: Some(GeodeticPosition { latitude_rad, longitude_rad, height_m }),
            velocity_mps,
            attitude: attitude_rad.map(PointAttitude::of),
            sigma,
            digit_rad: [0.0; 3],
            attitude_doubt_s: 0.0,
        }))
    }

    fn tally(&self) -> &Tally {
        &self.lines.tally
    }

    fn tally_mut(&mut self) -> &mut Tally {
        &mut self.lines.tally
    }

    fn unit(&self) -> [&'static str; 2] {
        ["row", "rows"]
    }

    fn choices(&self) -> Vec<&'static str> {
        let unzoned = "times without an offset from UTC are taken as UTC";
        self.unzoned.then_some(unzoned).into_iter().collect()
    }

    fn place(&self) -> String {
        format!("line {}", self.lines.line)
    }

    fn scale(&self) -> TimeScale {
        self.scale
    }
}

/// Rows of a file, with the number of the line.
struct Lines {
    file: BufReader<File>,
    delimiter: Delimiter,
    comment: String,
    text: String,
    line: u64,
    fields: StringRecord,
    /// True after the first row that isn't a header.
    within: bool,
    tally: Tally,
}

impl Lines {
    fn new(file: File, columns: &TrajectoryColumns) -> Self {
        Self {
            file: BufReader::with_capacity(1 << 16, file),
            delimiter: columns.delimiter,
            comment: columns.comment.clone(),
            text: String::new(),
            line: 0,
            fields: StringRecord::new(),
            within: false,
            tally: Tally::default(),
        }
    }

    fn skip(&mut self, lines: usize) -> Result<(), String> {
        for _ in 0..lines {
            if !self.read_line()? {
                let lines = counted(lines, "line", "lines");
                return Err(format!("the file ends within the {lines} to skip"));
            }
        }
        Ok(())
    }

    fn header(&mut self) -> Result<StringRecord, String> {
        if self.advance()? {
            self.within = false;
            Ok(self.fields.clone())
        } else {
            Err("the file ends, expected a line with the names of the columns".to_owned())
        }
    }

    fn read_line(&mut self) -> Result<bool, String> {
        self.text.clear();
        self.line += 1;
        let read = (&mut self.file).take(LINE_BYTES_MAX).read_line(&mut self.text);
        match read {
            Err(error) => Err(format!("line {}: {error}", self.line)),
            Ok(0) => Ok(false),
            Ok(n) if n as u64 == LINE_BYTES_MAX && !self.text.ends_with('\n') => {
                Err(format!("line {}: longer than {LINE_BYTES_MAX} bytes", self.line))
            }
            Ok(_) => Ok(true),
        }
    }

    /// Advances to the next row; `false` at the end.
    fn advance(&mut self) -> Result<bool, String> {
        loop {
            if !self.read_line()? {
                return Ok(false);
            }
            let line = self.text.trim_start_matches('\u{feff}').trim_end_matches(['\r', '\n']);
            let is_comment = !self.comment.is_empty() && line.starts_with(&self.comment);
            if line.trim().is_empty() {
                continue;
            }
            if is_comment {
                // Comments before the rows say what the file is; between them they may be rows.
                if self.within {
                    let line = self.line;
                    self.tally.left_out(
                        1,
                        "lines among the rows that begin with the comment mark",
                        || format!("line {line}"),
                    );
                }
                continue;
            }
            self.within = true;
            self.fields.clear();
            match self.delimiter {
                Delimiter::Blanks => self.fields.extend(line.split_ascii_whitespace()),
                Delimiter::Character(delimiter) if !line.contains('"') => {
                    self.fields.extend(line.split(char::from(delimiter)).map(str::trim));
                }
                // Quotes are rare in data; the csv crate has their rules.
                Delimiter::Character(delimiter) => {
                    let mut reader = csv::ReaderBuilder::new()
                        .delimiter(delimiter)
                        .has_headers(false)
                        .flexible(true)
                        .trim(csv::Trim::All)
                        .from_reader(line.as_bytes());
                    let read = reader.read_record(&mut self.fields);
                    read.map_err(|error| format!("line {}: {error}", self.line))?;
                }
            }
            return Ok(true);
        }
    }

    fn field(&self, index: usize) -> Result<&str, String> {
        self.fields.get(index).ok_or_else(|| {
            let found = counted(self.fields.len(), "column", "columns");
            format!("line {}: found {found}, expected {} or more", self.line, index + 1)
        })
    }

    fn number(&self, index: usize) -> Result<f64, String> {
        let text = self.field(index)?;
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(self.error(index, &format!("found {text:?}, expected a finite number"))),
        }
    }

    /// Standard deviations of some columns, in SI.
    fn sigma<const N: usize>(
        &self,
        columns: Option<[usize; N]>,
        unit: f64,
    ) -> Result<Option<[f64; N]>, String> {
        let Some(columns) = columns else { return Ok(None) };
        let mut sigma = [0.0; N];
        for (sigma, index) in sigma.iter_mut().zip(columns) {
            *sigma = self.number(index)? * unit;
            if *sigma < 0.0 {
                let found = self.field(index)?;
                let reason = format!("found {found:?}, expected a standard deviation of 0 or more");
                return Err(self.error(index, &reason));
            }
        }
        Ok(sigma.iter().any(|sigma| *sigma > 0.0).then_some(sigma))
    }

    fn error(&self, index: usize, reason: &str) -> String {
        format!("line {}: column {}: {reason}", self.line, index + 1)
    }
}
