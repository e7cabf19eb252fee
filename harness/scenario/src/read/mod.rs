//! From a checked and completed document to a [`Scenario`]: units are gone, what depends on several
//! keys is decided here, and contradictions are told.

pub mod drive;
pub mod faults;
pub mod fmu;
mod instrument;
pub mod instrument_port;
pub mod live;
mod procedure;
pub mod requirement;
pub mod source;

pub(super) use instrument::MOTIONS;
pub(super) use procedure::case_attitude;

use super::complete::{join, number};
use super::document::{Node, Table, Value};
use super::error::{Place, Problem};
use super::{Realtime, Record, Scenario, quantity};
use octant_plant::config as plant;
use std::path::Path;

/// A table of the completed document with its path and place. What the check has passed is there;
/// an accessor that meets anything else reports a problem all the same.
#[derive(Clone)]
pub struct Reader<'a> {
    table: &'a Table,
    path: String,
    place: Place,
}

impl<'a> Reader<'a> {
    /// Reads the table of a whole file.
    pub fn root(table: &'a Table) -> Self {
        Self { table, path: String::new(), place: Place::File { line: 1, column: 1 } }
    }

    /// Reads a table at a dotted path, which stands at a place.
    pub fn new(table: &'a Table, path: &str, place: &Place) -> Self {
        Self { table, path: path.to_owned(), place: place.clone() }
    }

    /// A problem with a key, or with the table where the key is left out.
    pub fn problem(&self, key: &str, message: impl Into<String>) -> Problem {
        let place = match self.table.get(key) {
            Some(Node { place: Place::Default, .. }) | None => &self.place,
            Some(node) => &node.place,
        };
        Problem { place: place.clone(), path: join(&self.path, key), message: message.into() }
    }

    /// The value of a key.
    pub fn node(&self, key: &str) -> Option<&'a Node> {
        self.table.get(key)
    }

    /// Dotted path of a key.
    pub fn join(&self, key: &str) -> String {
        join(&self.path, key)
    }

    /// Whether the scenario itself gives the key, not its default.
    pub fn given(&self, key: &str) -> bool {
        self.table.get(key).is_some_and(|node| node.place != Place::Default)
    }

    /// The key that was written first.
    pub fn first_key(&self) -> &'a str {
        let given = |entry: &&super::document::Entry| entry.node.place != Place::Default;
        self.table.entries.iter().find(given).map_or("", |entry| &entry.key)
    }

    fn missing(&self, key: &str) -> Problem {
        self.problem(key, "missing")
    }

    /// The table under a key.
    ///
    /// # Errors
    /// If it is missing.
    pub fn table(&self, key: &str) -> Result<Reader<'a>, Problem> {
        self.optional_table(key).ok_or_else(|| self.missing(key))
    }

    /// The table under a key, where it is given.
    pub fn optional_table(&self, key: &str) -> Option<Reader<'a>> {
        let Some(Node { value: Value::Table(table), place }) = self.node(key) else { return None };
        let place = if *place == Place::Default { &self.place } else { place };
        Some(Reader::new(table, &join(&self.path, key), place))
    }

    /// The tables of an array.
    pub fn tables(&self, key: &str) -> Vec<Reader<'a>> {
        let Some(Node { value: Value::Array(entries), .. }) = self.node(key) else {
            return Vec::new();
        };
        let path = join(&self.path, key);
        entries
            .iter()
            .enumerate()
            .filter_map(|(index, node)| match &node.value {
                Value::Table(table) => {
                    Some(Reader::new(table, &format!("{path}[{index}]"), &node.place))
                }
                _ => None,
            })
            .collect()
    }

    /// The text under a key, where it is given.
    pub fn optional_text(&self, key: &str) -> Option<&'a str> {
        match &self.node(key)?.value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The text under a key.
    ///
    /// # Errors
    /// If it is missing.
    pub fn text(&self, key: &str) -> Result<&'a str, Problem> {
        self.optional_text(key).ok_or_else(|| self.missing(key))
    }

    /// The texts of an array.
    pub fn texts(&self, key: &str) -> Vec<&'a str> {
        let Some(Node { value: Value::Array(entries), .. }) = self.node(key) else {
            return Vec::new();
        };
        let text = |node: &'a Node| match &node.value {
            Value::Text(text) => Some(text.as_str()),
            _ => None,
        };
        entries.iter().filter_map(text).collect()
    }

    /// The boolean under a key.
    ///
    /// # Errors
    /// If it is missing.
    pub fn boolean(&self, key: &str) -> Result<bool, Problem> {
        match self.node(key) {
            Some(Node { value: Value::Boolean(value), .. }) => Ok(*value),
            _ => Err(self.missing(key)),
        }
    }

    /// The whole number under a key.
    ///
    /// # Errors
    /// If it is missing, or too large for its type.
    pub fn integer<T: TryFrom<i64>>(&self, key: &str) -> Result<T, Problem> {
        match self.node(key) {
            Some(Node { value: Value::Integer(value), .. }) => {
                T::try_from(*value).map_err(|_| self.problem(key, format!("{value} is too large")))
            }
            _ => Err(self.missing(key)),
        }
    }

    /// The plain number under a key.
    ///
    /// # Errors
    /// If it is missing.
    pub fn number(&self, key: &str) -> Result<f64, Problem> {
        self.node(key).and_then(|node| number(&node.value)).ok_or_else(|| self.missing(key))
    }

    /// The plain numbers of an array of known length.
    ///
    /// # Errors
    /// If there are more or fewer.
    pub fn numbers<const N: usize>(&self, key: &str) -> Result<[f64; N], Problem> {
        let Some(Node { value: Value::Array(entries), .. }) = self.node(key) else {
            return Err(self.missing(key));
        };
        let all: Vec<f64> = entries.iter().filter_map(|node| number(&node.value)).collect();
        all.try_into().map_err(|_| self.missing(key))
    }

    /// A quantity in SI, where it is given.
    pub fn optional_si(&self, key: &str) -> Option<f64> {
        quantity::parse(self.optional_text(key)?).ok().map(|quantity| quantity.si)
    }

    /// A quantity in SI.
    pub fn si(&self, key: &str) -> Result<f64, Problem> {
        self.optional_si(key).ok_or_else(|| self.missing(key))
    }

    /// The quantities of an array in SI, where it is given.
    pub fn optional_si_vec(&self, key: &str) -> Option<Vec<f64>> {
        self.node(key)?;
        let texts = self.texts(key);
        texts.iter().map(|text| quantity::parse(text).ok().map(|quantity| quantity.si)).collect()
    }

    /// The quantities of an array of known length in SI, where it is given.
    pub fn optional_si_array<const N: usize>(&self, key: &str) -> Option<[f64; N]> {
        self.optional_si_vec(key)?.try_into().ok()
    }

    /// The quantities of an array of known length in SI.
    ///
    /// # Errors
    /// If it is missing.
    pub fn si_array<const N: usize>(&self, key: &str) -> Result<[f64; N], Problem> {
        self.optional_si_array(key).ok_or_else(|| self.missing(key))
    }
}

/// Reads a completed document.
pub fn scenario(document: Table, folder: &Path) -> Result<Scenario, Problem> {
    let root = Reader::root(&document);

    let imu = root.table("imu")?;
    let sample_period_ns = instrument::sample_period_ns(&imu)?;
    let source = source::read(&root.table("source")?, sample_period_ns)?;
    let site = root.table("site")?;
    let site = plant::Site {
        latitude_rad: site.si("latitude")?,
        longitude_rad: site.si("longitude")?,
        height_m: site.si("height")?,
    };
    let motion = instrument::motion(&root.table("motion")?)?;
    let turntable_table = root.table("turntable")?;
    let turntable = instrument::turntable(&turntable_table)?;
    let drive = drive::drive(&turntable_table, &turntable)?;
    let screening = procedure::screening(&root.table("screening")?)?;
    let setting = procedure::Setting {
        sample_period_ns,
        motion: &motion,
        turntable: &turntable,
        endless: !source.is_recorded(),
        folder,
    };
    let procedure_table = root.table("procedure")?;
    let procedure = procedure::procedure(&procedure_table, &setting)?;
    let baseline = procedure::baseline(&root, &setting)?;
    let endpoint = fmu::endpoint(&root.table("endpoint")?, sample_period_ns)?;
    check_motion(&source, &motion)?;
    let scenario = Scenario {
        title: root.text("title")?.to_owned(),
        seed: root.integer("seed")?,
        sample_period_ns,
        site,
        parameters: instrument::parameters(&imu)?,
        imu: instrument::imu(&imu)?,
        turntable,
        drive,
        alignment: procedure.alignment,
        initial_parameters: procedure.initial_parameters,
        calibration: procedure.calibration,
        baseline,
        aiding: procedure.aiding,
        navigation: procedure.navigation,
        screening,
        faults: Vec::new(),
        requirements: requirement::read(&root)?,
        decision: requirement::decision(&root.table("decision")?)?,
        equipment: requirement::equipment(&root)?,
        record: record(&root.table("record")?, sample_period_ns)?,
        source,
        endpoint,
        realtime: realtime(&root.table("realtime")?)?,
        motion,
        file: String::new(),
        folder: folder.to_owned(),
        document: Table::default(),
    };
    check_once(&root, &scenario)?;
    drive::check_reach(&root, &scenario)?;
    let faults = faults::read(&root, &scenario)?;
    Ok(Scenario { document, faults, ..scenario })
}

/// What goes by a clock of its own, or happens once, can't be asked for twice or at another time.
fn check_once(root: &Reader<'_>, scenario: &Scenario) -> Result<(), Problem> {
    let by_clock = scenario.realtime.by_clock;
    if matches!(scenario.source, source::Source::Live(_)) {
        if scenario.baseline.is_some() {
            return Err(root.problem(
                "baseline",
                "a second method needs the same samples again, which a real instrument doesn't \
                 give: expected it on the recording of the first, with source.uri = \"replay:FILE\"",
            ));
        }
        if by_clock {
            return Err(root.table("realtime")?.problem(
                "pace",
                "a real instrument sends by a clock of its own: expected \"free\"",
            ));
        }
    }
    if let super::Endpoint::Live(live) = &scenario.endpoint
        && by_clock
        && live.reconnect_s > 0.0
    {
        return Err(root.table("endpoint")?.table("link")?.problem(
            "reconnect",
            "by the clock a port that goes away ends the run: expected \"0 s\" with realtime.pace \
             = \"clock\"",
        ));
    }
    Ok(())
}

/// A case that an FMU moves is a case that moves.
fn check_motion(source: &source::Source, motion: &super::Motion) -> Result<(), Problem> {
    match source {
        source::Source::Fmu(fmu) if fmu.is_motion() => match motion {
            super::Motion::Dockside(_) => Ok(()),
            super::Motion::Static(_) => Err(fmu.at.problem(
                "the FMU moves the case, and motion.kind is \"static\": expected \"dockside\", whose \
                 sway tells the core what to expect",
            )),
        },
        _ => Ok(()),
    }
}

fn record(record: &Reader<'_>, sample_period_ns: u64) -> Result<Record, Problem> {
    let samples = 1e9 / record.si("rate")? / sample_period_ns as f64;
    let every_samples = samples.round();
    if every_samples < 1.0 || (samples - every_samples).abs() > 1e-6 * samples {
        return Err(record.problem(
            "rate",
            format!(
                "found {:?}, which is {samples} samples of {} ns apart, expected a whole number",
                record.text("rate")?,
                sample_period_ns
            ),
        ));
    }
    Ok(Record {
        every_samples: every_samples as u64,
        full_samples: record.text("samples")? == "full",
        parameters_period_ns: (record.si("parameters")? * 1e9).round() as u64,
    })
}

fn realtime(realtime: &Reader<'_>) -> Result<Realtime, Problem> {
    let ns = |key: &str| realtime.si(key).map(|s| (s * 1e9).round() as u64);
    let priority: u8 = realtime.integer("priority")?;
    Ok(Realtime {
        by_clock: realtime.text("pace")? == "clock",
        overrun_ns: ns("overrun")?,
        overruns: realtime.integer("overruns")?,
        lateness_p99_ns: realtime.optional_si("lateness_p99").map(|s| (s * 1e9).round() as u64),
        late_answers: realtime.integer("late_answers")?,
        silence_ns: ns("silence")?,
        priority: (priority > 0).then_some(priority),
        cpu: if realtime.node("cpu").is_some() { Some(realtime.integer("cpu")?) } else { None },
        lock_memory: realtime.boolean("lock_memory")?,
        spin_ns: ns("spin")?,
    })
}

/// A time as whole nanoseconds, if it is a multiple of the sample period.
fn samples_of(time_s: f64, sample_period_ns: u64) -> Option<u64> {
    let ns = (time_s * 1e9).round() as u64;
    (ns > 0 && ns.is_multiple_of(sample_period_ns)).then(|| ns / sample_period_ns)
}
