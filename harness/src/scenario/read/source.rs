//! Where samples come from, as read from `[source]`.

use super::Reader;
use crate::scenario::error::Problem;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// The variable that a file name may start with.
const VARIABLE: &str = "OCTANT_RECORDINGS";

/// Where samples come from.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// Simulated.
    Plant,
    /// An MCAP file: of this program, or of another with the mapping of its channel.
    Replay {
        /// The file.
        file: FileName,
        /// The mapping of a foreign file.
        mapping: Option<Mcap>,
    },
    /// Text files of a real instrument.
    Text(TextFiles),
}

/// A file name as it was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileName(pub String);

impl FileName {
    /// The file's path: relative to the scenario's folder, with `${OCTANT_RECORDINGS}` expanded.
    ///
    /// # Errors
    /// If the variable is used and not set, or another one is used; a fragment that fits after
    /// "failed to …".
    pub fn path(&self, folder: &Path) -> Result<PathBuf, String> {
        self.path_with(folder, std::env::var_os(VARIABLE))
    }

    fn path_with(&self, folder: &Path, recordings: Option<OsString>) -> Result<PathBuf, String> {
        let Some(rest) = self.0.strip_prefix("${") else { return Ok(folder.join(&self.0)) };
        let Some(rest) = rest.strip_prefix(VARIABLE).and_then(|rest| rest.strip_prefix('}')) else {
            return Err(format!(
                "expand {:?}: ${{{VARIABLE}}} is the one variable that file names can have",
                self.0
            ));
        };
        match recordings {
            Some(value) => Ok(Path::new(&value).join(rest.trim_start_matches('/'))),
            None => Err(format!(
                "expand {:?}: the environment variable {VARIABLE} is not set; set it to the \
                 folder of the recordings",
                self.0
            )),
        }
    }
}

/// How text files are read.
#[derive(Clone, Debug, PartialEq)]
pub struct TextFiles {
    /// Nominal rate, ns between samples: equal to the scenario's sample period.
    pub period_ns: u64,
    /// What separates columns.
    pub delimiter: Delimiter,
    /// Lines to skip at the start.
    pub skip_lines: u64,
    /// The first line after those names the columns.
    pub header: bool,
    /// Lines that start with this are skipped; empty: none.
    pub comment: String,
    /// Column of the time stamp, in each file.
    pub time_column: Column,
    /// Seconds per unit of the time stamp.
    pub time_unit_s: f64,
    /// The gyros' file and columns.
    pub gyro: (FileName, Signal<Column>),
    /// The accelerometers' file and columns.
    pub accelerometer: (FileName, Signal<Column>),
    /// Columns of azimuth and roll in the gyros' file, and rad per unit.
    pub gimbal: Option<(Column, Column, f64)>,
}

/// What separates columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delimiter {
    /// Any run of blanks and tabs.
    Whitespace,
    /// This one character.
    Character(char),
}

/// A column of a text file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Column {
    /// Its number, from 1.
    Number(usize),
    /// Its name in the header.
    Name(String),
}

/// Names of the fields of an MCAP message.
pub type Fields = String;

/// Three axes of raw numbers and what they mean: `si = (raw − offset) · scale · unit`.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal<C> {
    /// Where raw x, y, z are.
    pub columns: [C; 3],
    /// Rate or increment.
    pub quantity: SignalQuantity,
    /// SI value of one unit after scaling.
    pub unit: f64,
    /// Units per raw number.
    pub scale: [f64; 3],
    /// Raw number of zero.
    pub offset: [f64; 3],
    /// Which instrument axis lies along body x, y, z.
    pub axes: [Axis; 3],
}

/// Whether numbers are rates or their integrals over the interval.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SignalQuantity {
    /// rad/s or m/s².
    Rate,
    /// rad or m/s.
    Increment,
}

/// An instrument axis with its sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axis {
    /// 0, 1, 2 for x, y, z.
    pub index: usize,
    /// It points the other way.
    pub negative: bool,
}

/// Which fields of another program's MCAP file are read.
#[derive(Clone, Debug, PartialEq)]
pub struct Mcap {
    /// Topic of the samples.
    pub topic: String,
    /// Field with the time stamp; `None`: the message's log time.
    pub time_field: Option<Fields>,
    /// Seconds per unit of the time stamp.
    pub time_unit_s: f64,
    /// Nominal rate, ns between samples: equal to the scenario's sample period.
    pub period_ns: u64,
    /// Fields of the gyros.
    pub gyro: Signal<Fields>,
    /// Fields of the accelerometers.
    pub accelerometer: Signal<Fields>,
}

pub(super) fn read(table: &Reader<'_>, sample_period_ns: u64) -> Result<Source, Problem> {
    let uri = table.text("uri")?;
    match uri.split_once(':') {
        None if uri == "plant" => Ok(Source::Plant),
        Some(("replay", file)) if !file.is_empty() => Ok(Source::Replay {
            file: FileName(file.to_owned()),
            mapping: match table.optional_table("mcap") {
                Some(mcap) => Some(read_mcap(&mcap, sample_period_ns)?),
                None => None,
            },
        }),
        Some(("text", file)) if !file.is_empty() => {
            let Some(text) = table.optional_table("text") else {
                let message = "missing, expected the columns of the text files of source.uri";
                return Err(table.problem("text", message));
            };
            Ok(Source::Text(read_text(&text, file, sample_period_ns)?))
        }
        _ => Err(table
            .problem("uri", format!("found {uri:?}, expected plant, replay:FILE or text:FILE"))),
    }
}

fn read_text(table: &Reader<'_>, file: &str, sample_period_ns: u64) -> Result<TextFiles, Problem> {
    let header = table.boolean("header")?;
    let column = |table: &Reader<'_>, key: &str| -> Result<Column, Problem> {
        match table.optional_text(key) {
            None => Ok(Column::Number(table.integer(key)?)),
            Some(name) if header => Ok(Column::Name(name.to_owned())),
            Some(name) => Err(table.problem(
                key,
                format!("found the name {name:?} with header = false, expected a column number"),
            )),
        }
    };
    let sensor = |key: &str| -> Result<(FileName, Signal<Column>), Problem> {
        let sensor = table.table(key)?;
        let columns = [column(&sensor, "x")?, column(&sensor, "y")?, column(&sensor, "z")?];
        let file = FileName(sensor.optional_text("file").unwrap_or(file).to_owned());
        Ok((file, signal(&sensor, columns)?))
    };
    Ok(TextFiles {
        period_ns: period_ns(table, sample_period_ns)?,
        delimiter: match table.text("delimiter")? {
            "comma" => Delimiter::Character(','),
            "semicolon" => Delimiter::Character(';'),
            "tab" => Delimiter::Character('\t'),
            _ => Delimiter::Whitespace,
        },
        skip_lines: table.integer("skip_lines")?,
        header,
        comment: table.text("comment")?.to_owned(),
        time_column: column(table, "time_column")?,
        time_unit_s: time_unit_s(table)?,
        gyro: sensor("gyro")?,
        accelerometer: sensor("accelerometer")?,
        gimbal: match table.optional_table("gimbal") {
            None => None,
            Some(gimbal) => Some((
                column(&gimbal, "azimuth")?,
                column(&gimbal, "roll")?,
                unit_si(&gimbal, "unit")?,
            )),
        },
    })
}

fn read_mcap(table: &Reader<'_>, sample_period_ns: u64) -> Result<Mcap, Problem> {
    let sensor = |key: &str| -> Result<Signal<Fields>, Problem> {
        let sensor = table.table(key)?;
        let field = |axis| sensor.text(axis).map(str::to_owned);
        signal(&sensor, [field("x")?, field("y")?, field("z")?])
    };
    Ok(Mcap {
        topic: table.text("topic")?.to_owned(),
        time_field: table.optional_text("time_field").map(str::to_owned),
        time_unit_s: time_unit_s(table)?,
        period_ns: period_ns(table, sample_period_ns)?,
        gyro: sensor("gyro")?,
        accelerometer: sensor("accelerometer")?,
    })
}

/// The nominal rate is that of the scenario: the core has one sample period.
fn period_ns(table: &Reader<'_>, sample_period_ns: u64) -> Result<u64, Problem> {
    let found_ns = super::instrument::sample_period_ns(table)?;
    if found_ns == sample_period_ns {
        return Ok(found_ns);
    }
    Err(table.problem(
        "rate",
        format!(
            "found {:?}, a period of {found_ns} ns, but imu.rate gives {sample_period_ns} ns: \
             expected the same",
            table.text("rate")?
        ),
    ))
}

fn time_unit_s(table: &Reader<'_>) -> Result<f64, Problem> {
    unit_si(table, "time_unit")
}

/// SI value of one of a unit.
fn unit_si(table: &Reader<'_>, key: &str) -> Result<f64, Problem> {
    let unit = table.text(key)?;
    crate::scenario::quantity::parse(&format!("1 {unit}"))
        .map(|quantity| quantity.si)
        .map_err(|_| table.problem(key, format!("found the unknown unit {unit:?}")))
}

fn signal<C>(table: &Reader<'_>, columns: [C; 3]) -> Result<Signal<C>, Problem> {
    let quantity = match table.text("quantity")? {
        "increment" => SignalQuantity::Increment,
        _ => SignalQuantity::Rate,
    };
    let unit = table.text("unit")?;
    let integral = matches!(unit, "rad" | "deg" | "arcsec" | "m/s" | "mm/s");
    if integral != (quantity == SignalQuantity::Increment) {
        let quantity = table.text("quantity")?;
        return Err(table.problem(
            "unit",
            format!("found {unit:?}, which is not the unit of quantity = {quantity:?}"),
        ));
    }
    let scale: [f64; 3] = table.numbers("scale")?;
    if scale.contains(&0.0) {
        return Err(table.problem("scale", "found 0, expected other numbers than zero"));
    }
    Ok(Signal {
        columns,
        quantity,
        unit: unit_si(table, "unit")?,
        scale,
        offset: table.numbers("offset")?,
        axes: axes(table)?,
    })
}

fn axes(table: &Reader<'_>) -> Result<[Axis; 3], Problem> {
    let texts = table.texts("axes");
    let axis = |text: &&str| {
        let negative = text.starts_with('-');
        let index = ["x", "y", "z"].iter().position(|name| *name == text.trim_start_matches('-'));
        index.map(|index| Axis { index, negative })
    };
    let axes: Vec<Axis> = texts.iter().filter_map(axis).collect();
    let mut indices: Vec<usize> = axes.iter().map(|axis| axis.index).collect();
    indices.sort_unstable();
    match <[Axis; 3]>::try_from(axes) {
        Ok(axes) if indices == [0, 1, 2] => Ok(axes),
        _ => Err(table.problem(
            "axes",
            format!(
                "found {texts:?}, expected x, y and z once each, such as [\"y\", \"x\", \"-z\"]"
            ),
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_start_at_the_scenario_or_at_the_recordings() {
        let path = |name: &str, recordings: Option<&str>| {
            FileName(name.to_owned()).path_with(Path::new("/runs"), recordings.map(OsString::from))
        };
        assert_eq!(path("a.txt", None), Ok(PathBuf::from("/runs/a.txt")));
        assert_eq!(path("/b/a.txt", None), Ok(PathBuf::from("/b/a.txt")));
        let recorded = "${OCTANT_RECORDINGS}/x/a.txt";
        assert_eq!(path(recorded, Some("/data")), Ok(PathBuf::from("/data/x/a.txt")));
        assert!(path(recorded, None).unwrap_err().contains("OCTANT_RECORDINGS is not set"));
        let other = path("${HOME}/a.txt", Some("/data")).unwrap_err();
        assert!(other.contains("the one variable"), "{other}");
    }
}
