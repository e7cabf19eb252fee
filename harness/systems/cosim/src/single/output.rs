//! Writes rows of an FMU's outputs, as CSV or as an MCAP file of JSON messages.

use octant_fmu_bind::find::{UnknownVariable, count, find, unknown};
use octant_fmu_host::description::{Causality, Description, Variable, VariableType};
use octant_fmu_host::instance::{AccessPlan, Instance, InstanceError, VariableGroup, whole};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Values that are read at every row.
#[derive(Clone, Debug)]
pub struct Outputs {
    /// Groups of numbers that are read.
    pub plan: AccessPlan,
    /// Groups of texts and bytes that are read.
    pub texts: Vec<VariableGroup>,
    /// Columns except time.
    pub columns: Vec<OutputColumn>,
    /// Outputs that are left out: clocks, and what has a value at their ticks alone.
    pub left_out: Vec<String>,
}

/// Reason why variables can't be recorded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OutputError {
    /// No variable has the name.
    #[error(transparent)]
    Unknown(#[from] UnknownVariable),
    /// The variable is a clock, or has a value at the ticks of one alone.
    #[error("{variable} {}: expected a variable that has a value after each step", if *.is_clock {
        "is a clock"
    } else {
        "has a value at the ticks of its clock alone"
    })]
    Clocked {
        /// Name of the variable.
        variable: String,
        /// True of a clock itself.
        is_clock: bool,
    },
    /// The variables can't be read together.
    #[error(transparent)]
    Instance(#[from] InstanceError),
}

/// Reason why a file for rows can't be made.
#[derive(Debug, thiserror::Error)]
pub enum SinkError {
    /// The file can't be created.
    #[error("create {}: {error}", .path.display())]
    Create {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        error: io::Error,
    },
    /// The head of a CSV file can't be written.
    #[error("write {}: {error}", .path.display())]
    Csv {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        error: io::Error,
    },
    /// The head of an MCAP file can't be written.
    #[error("write {}: {error}", .path.display())]
    Mcap {
        /// The file.
        path: PathBuf,
        /// Error of the format.
        error: mcap::McapError,
    },
    /// The name has another extension.
    #[error("write {}: expected a name that ends in .csv or .mcap", .path.display())]
    Name {
        /// Name found.
        path: PathBuf,
    },
}

/// A column.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputColumn {
    /// Name of the variable, with the index of the element in an array.
    pub name: String,
    /// Type of its values.
    pub kind: VariableType,
    /// Place among the numbers that are read; of texts and bytes, among the texts.
    pub place: usize,
    /// Unit, if there is one.
    pub unit: Option<String>,
}

impl Outputs {
    /// Chooses the variables of these names; without names, the outputs of the FMU.
    ///
    /// # Errors
    /// If there is no such variable, or it is a clock or has one.
    pub fn choose(description: &Description, names: &[String]) -> Result<Self, OutputError> {
        let is_text = |variable: &Variable| {
            matches!(variable.kind, VariableType::String | VariableType::Binary)
        };
        // Numbers that a clock has are read between its ticks too; texts and bytes aren't.
        let is_read = |variable: &Variable| {
            variable.kind != VariableType::Clock
                && (!is_text(variable) || variable.clocks.is_empty())
        };
        let mut elements: Vec<(&Variable, usize)> = Vec::new();
        let mut left_out = Vec::new();
        if names.is_empty() {
            for variable in &description.variables {
                if variable.causality != Causality::Output {
                    continue;
                }
                if is_read(variable) {
                    elements.extend((0..count(description, variable)).map(|n| (variable, n)));
                } else {
                    left_out.push(variable.name.clone());
                }
            }
        }
        for name in names {
            // First as one element: an array of scalars has no variable of its own name.
            let array = || (2..=4096).rev().find_map(|n| scalars(description, name, n));
            let found = find(description, name, 1)
                .filter(|found| !found.negated)
                .map(|found| found.elements)
                .or_else(array)
                .ok_or_else(|| unknown(description, name, |_| true))?;
            if let Some((variable, _)) = found.iter().find(|(variable, _)| !is_read(variable)) {
                return Err(OutputError::Clocked {
                    variable: variable.name.clone(),
                    is_clock: variable.kind == VariableType::Clock,
                });
            }
            elements.extend(found);
        }
        let mut variables: Vec<&Variable> = Vec::new();
        for (variable, _) in &elements {
            if !variables.iter().any(|known| std::ptr::eq(*known, *variable)) {
                variables.push(variable);
            }
        }
        let (texts, numbers): (Vec<&Variable>, Vec<&Variable>) =
            variables.into_iter().partition(|variable| is_text(variable));
        let plan = AccessPlan::exactly(description, &numbers)?;
        let groups = texts.iter().map(|variable| VariableGroup::of(description, variable));
        let groups: Vec<VariableGroup> = groups.collect::<Result<_, _>>()?;
        let place_of = |variable: &Variable| {
            let place =
                |all: &[&Variable]| all.iter().position(|known| std::ptr::eq(*known, variable));
            if let Some(index) = place(&texts) {
                return groups[..index].iter().map(|group| group.elements).sum();
            }
            place(&numbers).map_or(0, |index| plan.places[index].start)
        };
        let column = |(variable, element): &(&Variable, usize)| OutputColumn {
            name: element_name(description, variable, *element),
            kind: variable.kind,
            place: place_of(variable) + element,
            unit: variable.unit.clone(),
        };
        let columns = elements.iter().map(column).collect();
        Ok(Self { plan, texts: groups, columns, left_out })
    }

    /// Reads the texts, and the bytes as hexadecimal digits.
    ///
    /// # Errors
    /// If the FMU fails.
    pub fn read_texts(
        &self,
        instance: &mut dyn Instance,
        texts: &mut Vec<String>,
    ) -> Result<(), InstanceError> {
        texts.clear();
        self.texts.iter().try_for_each(|group| read_texts(instance, group, texts))
    }
}

/// Appends the texts of a group, and bytes as hexadecimal digits.
pub(crate) fn read_texts(
    instance: &mut dyn Instance,
    group: &VariableGroup,
    texts: &mut Vec<String>,
) -> Result<(), InstanceError> {
    if group.kind == VariableType::String {
        texts.extend(instance.get_strings(group)?);
    } else {
        texts.extend(instance.get_binaries(group)?.iter().map(|bytes| hexadecimal(bytes)));
    }
    Ok(())
}

/// Returns all elements of an array that is exactly this many scalars in the file.
fn scalars<'a>(
    description: &'a Description,
    name: &str,
    elements: usize,
) -> Option<Vec<(&'a Variable, usize)>> {
    let last = format!("{name}[{elements}]");
    // The cheap check comes first: most names have no such element.
    description.variables.iter().find(|variable| variable.name == last)?;
    find(description, name, elements).filter(|found| !found.negated).map(|found| found.elements)
}

/// Returns the name of an element in FMI 2.0, `w[2]` or `m[2,1]`, counted from 1, row-major.
fn element_name(description: &Description, variable: &Variable, element: usize) -> String {
    if variable.dimensions.is_empty() {
        return variable.name.clone();
    }
    let one = |dimension: &octant_fmu_host::description::ArrayDimension| {
        let alone = Variable { dimensions: vec![*dimension], ..variable.clone() };
        count(description, &alone).max(1)
    };
    let mut rest = element;
    let mut subscripts = Vec::with_capacity(variable.dimensions.len());
    for dimension in variable.dimensions.iter().rev() {
        let size = one(dimension);
        subscripts.push((rest % size + 1).to_string());
        rest /= size;
    }
    subscripts.reverse();
    format!("{}[{}]", variable.name, subscripts.join(","))
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Writes a text between quotes, as RFC 4180 has it.
fn write_quoted(out: &mut (impl Write + ?Sized), text: &str) -> io::Result<()> {
    write!(out, "\"{}\"", text.replace('"', "\"\""))
}

/// Writes a value in the form of its type: whole numbers without a point, those of 64 bits from their
/// bits, all others so that they read back to the same bits.
fn write_value(out: &mut impl Write, kind: VariableType, value: f64) -> io::Result<()> {
    match kind {
        _ if whole::is_wide(kind) => write!(out, "{}", whole::from_bits(kind, value)),
        VariableType::Float64 => write!(out, "{value:?}"),
        VariableType::Float32 => write!(out, "{:?}", value as f32),
        _ if value.fract() == 0.0 && value.abs() < 1e18 => write!(out, "{}", value as i64),
        _ => write!(out, "{value:?}"),
    }
}

/// Destination of rows.
pub enum Sink {
    /// No file.
    None,
    /// A CSV file, in the form that FMPy reads.
    Csv(BufWriter<File>),
    /// MCAP file with one JSON message per row.
    Mcap(Box<Mcap>),
}

/// An MCAP file of rows.
pub struct Mcap {
    writer: mcap::Writer<BufWriter<File>>,
    channel: u16,
    /// Channel of events, created with the first one.
    events: Option<u16>,
    sequence: u32,
    text: Vec<u8>,
}

/// Schema of events.
const EVENT: &str = "octant.Event";

/// Topic of the rows in an MCAP file.
pub const TOPIC: &str = "/fmu/outputs";

impl Sink {
    /// Creates a file by its name: `.csv` or `.mcap`.
    ///
    /// # Errors
    /// If it can't be made, or has another extension.
    pub fn file(path: &Path, outputs: &Outputs, model: &str) -> Result<Self, SinkError> {
        let place = || path.to_owned();
        let create =
            || File::create(path).map_err(|error| SinkError::Create { path: place(), error });
        match path.extension().and_then(|extension| extension.to_str()) {
            Some("csv") => {
                let mut sink = Self::Csv(BufWriter::new(create()?));
                sink.header(outputs).map_err(|error| SinkError::Csv { path: place(), error })?;
                Ok(sink)
            }
            Some("mcap") => Ok(Self::Mcap(Box::new(
                Mcap::new(create()?, outputs, model)
                    .map_err(|error| SinkError::Mcap { path: place(), error })?,
            ))),
            _ => Err(SinkError::Name { path: place() }),
        }
    }

    /// Writes the names of the columns of a CSV file.
    ///
    /// # Errors
    /// If it can't be written.
    pub fn header(&mut self, outputs: &Outputs) -> io::Result<()> {
        let write = |out: &mut dyn Write| {
            write!(out, "\"time\"")?;
            for column in &outputs.columns {
                out.write_all(b",")?;
                write_quoted(out, &column.name)?;
            }
            writeln!(out)
        };
        match self {
            Self::Csv(out) => write(out),
            Self::None | Self::Mcap(_) => Ok(()),
        }
    }

    /// Writes a row.
    ///
    /// # Errors
    /// If it can't be written.
    pub fn row(
        &mut self,
        time_s: f64,
        outputs: &Outputs,
        numbers: &[f64],
        texts: &[String],
    ) -> io::Result<()> {
        match self {
            Self::None => Ok(()),
            Self::Csv(out) => {
                write!(out, "{time_s:?}")?;
                for column in &outputs.columns {
                    out.write_all(b",")?;
                    match column.kind {
                        VariableType::String | VariableType::Binary => {
                            write_quoted(out, &texts[column.place])?;
                        }
                        kind => write_value(out, kind, numbers[column.place])?,
                    }
                }
                out.write_all(b"\n")
            }
            Self::Mcap(mcap) => mcap.row(time_s, outputs, numbers, texts),
        }
    }

    /// Notes an event, if the file has a place for it.
    ///
    /// # Errors
    /// If it can't be written.
    pub fn event(&mut self, time_s: f64, event: &octant_recorder::Event) -> io::Result<()> {
        match self {
            Self::Mcap(mcap) => mcap.event(time_s, event),
            Self::None | Self::Csv(_) => Ok(()),
        }
    }

    /// Writes the remaining data and closes the file.
    ///
    /// # Errors
    /// If it can't be written.
    pub fn finish(self) -> io::Result<()> {
        match self {
            Self::None => Ok(()),
            Self::Csv(mut out) => out.flush(),
            Self::Mcap(mut mcap) => mcap.writer.finish().map(|_| ()).map_err(io::Error::other),
        }
    }
}

impl Mcap {
    fn new(file: File, outputs: &Outputs, model: &str) -> Result<Self, mcap::McapError> {
        let mut writer = mcap::WriteOptions::new()
            .profile("")
            .library(concat!("octant ", env!("CARGO_PKG_VERSION")))
            .compression(Some(mcap::Compression::Zstd))
            .compression_threads(0)
            .create(BufWriter::new(file))?;
        let property = |column: &OutputColumn| {
            let kind = match column.kind {
                VariableType::Boolean => "boolean",
                VariableType::Float64 | VariableType::Float32 => "number",
                VariableType::String | VariableType::Binary => "string",
                _ => "integer",
            };
            let mut property = serde_json::json!({ "type": [kind, "null"] });
            if let Some(unit) = &column.unit {
                property["description"] = format!("in {unit}").into();
            }
            if column.kind == VariableType::Binary {
                property["description"] = "bytes as hexadecimal digits".into();
            }
            (column.name.clone(), property)
        };
        let mut properties: serde_json::Map<String, serde_json::Value> =
            outputs.columns.iter().map(property).collect();
        properties
            .insert("time".into(), serde_json::json!({ "type": "number", "description": "s" }));
        let schema =
            serde_json::json!({ "title": model, "type": "object", "properties": properties });
        let schema = writer.add_schema(model, "jsonschema", schema.to_string().as_bytes())?;
        let channel = writer.add_channel(schema, TOPIC, "json", &BTreeMap::new())?;
        Ok(Self { writer, channel, events: None, sequence: 0, text: Vec::new() })
    }

    fn row(
        &mut self,
        time_s: f64,
        outputs: &Outputs,
        numbers: &[f64],
        texts: &[String],
    ) -> io::Result<()> {
        let text = &mut self.text;
        text.clear();
        write!(text, "{{\"time\":{time_s:?}")?;
        for column in &outputs.columns {
            text.extend_from_slice(b",");
            serde_json::to_writer(&mut *text, &column.name)?;
            text.extend_from_slice(b":");
            if matches!(column.kind, VariableType::String | VariableType::Binary) {
                serde_json::to_writer(&mut *text, &texts[column.place])?;
                continue;
            }
            let value = numbers[column.place];
            match column.kind {
                VariableType::Boolean => write!(text, "{}", value != 0.0)?,
                // JSON can't express infinities and NaN.
                kind if !whole::is_wide(kind) && !value.is_finite() => {
                    text.extend_from_slice(b"null")
                }
                kind => write_value(text, kind, value)?,
            }
        }
        text.extend_from_slice(b"}");
        self.put(self.channel, time_s)
    }

    fn event(&mut self, time_s: f64, event: &octant_recorder::Event) -> io::Result<()> {
        let channel = match self.events {
            Some(channel) => channel,
            None => {
                let schema = serde_json::json!({
                    "title": EVENT,
                    "type": "object",
                    "properties": { "kind": { "type": "string" }, "detail": {} },
                });
                let schema = schema.to_string();
                let schema = self.writer.add_schema(EVENT, "jsonschema", schema.as_bytes());
                let schema = schema.map_err(io::Error::other)?;
                let channel = self.writer.add_channel(schema, "/event", "json", &BTreeMap::new());
                *self.events.insert(channel.map_err(io::Error::other)?)
            }
        };
        self.text.clear();
        serde_json::to_writer(&mut self.text, event)?;
        self.put(channel, time_s)
    }

    /// Writes the message in `self.text`.
    fn put(&mut self, channel: u16, time_s: f64) -> io::Result<()> {
        let time_ns = (time_s.max(0.0) * 1e9).round() as u64;
        self.sequence = self.sequence.wrapping_add(1);
        let header = mcap::records::MessageHeader {
            channel_id: channel,
            sequence: self.sequence,
            log_time: time_ns,
            publish_time: time_ns,
        };
        self.writer.write_to_known_channel(&header, &self.text).map_err(io::Error::other)
    }
}
