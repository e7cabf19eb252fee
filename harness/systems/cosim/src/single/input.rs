//! Reads inputs of an FMU from a CSV file: the first column is time, every other one a variable.
//!
//! Continuous variables are interpolated linearly, all others are held from their row on; two rows
//! of the same time are a step. Before the first row and after the last, the nearest row holds. An
//! array has a column for each element, or one column with all of them separated by blanks, as in
//! the inputs that FMI 3.0 FMUs contain. A triggered clock ticks once for each row that has a 1.

use octant_fmu_bind::find::{ValueWay, allowed, count, find, unknown};
use octant_fmu_host::description::units::{UnitConversion, known};
use octant_fmu_host::description::{
    Causality, Description, IntervalVariability, Variability, Variable, VariableType,
};
use octant_fmu_host::instance::{AccessPlan, InstanceError, VariableGroup, whole};
use std::path::Path;

/// Reasons why inputs can't be read.
#[derive(Debug, thiserror::Error)]
pub enum InputFileError {
    /// The file can't be read.
    #[error("read {path}: {source}")]
    Open {
        /// The file.
        path: String,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The content of the file isn't valid.
    #[error("{path}:{line}:{column}: {reason}")]
    Content {
        /// The file.
        path: String,
        /// Line, from 1.
        line: u64,
        /// Column of the table, from 1.
        column: usize,
        /// Found and expected.
        reason: String,
    },
    /// The variables can't be set together.
    #[error(transparent)]
    Instance(#[from] InstanceError),
}

/// Table, with the destinations of its columns.
#[derive(Clone, Debug)]
pub struct Inputs {
    /// The groups that are set.
    pub plan: AccessPlan,
    /// Numbers of the groups.
    pub numbers: Vec<f64>,
    time_s: Vec<f64>,
    columns: Vec<Column>,
    clocks: Vec<ClockColumn>,
    /// Index of the last row at or before the last requested time.
    row: usize,
    /// Number of rows at or before the last requested time.
    reached: usize,
    /// Number of rows whose ticks were asked for.
    ticked: usize,
    /// Times of rows at which an input doesn't go on as before, s: a held value changes, two rows of one
    /// time are a step, or a clock ticks.
    jumps_s: Vec<f64>,
    /// Difference within which a row's time is a requested time, s.
    close_s: f64,
}

/// Column of a triggered clock.
#[derive(Clone, Debug)]
struct ClockColumn {
    group: VariableGroup,
    /// Whether it ticks at a row.
    ticks: Vec<bool>,
}

#[derive(Clone, Debug)]
struct Column {
    /// Place in the numbers.
    place: usize,
    continuous: bool,
    values: Vec<f64>,
}

/// Parsed header of a column.
struct Header<'a> {
    /// Elements whose values stand in each field, separated by blanks.
    elements: Vec<(&'a Variable, usize)>,
    units: UnitConversion,
}

impl<'a> Header<'a> {
    /// The clock that ticks by the column, if it is one.
    fn clock(&self) -> Option<&'a Variable> {
        let (variable, _) = self.elements.first()?;
        (variable.kind == VariableType::Clock).then_some(*variable)
    }

    /// Reads a value as it is exchanged: whole numbers of 64 bits as their bits.
    fn value(&self, text: &str, kind: VariableType) -> Result<f64, String> {
        if !whole::is_wide(kind) {
            return Ok(self.units.apply(number(text, kind)?));
        }
        let found = match self.units.is_identity() {
            true => whole::parse(text),
            false => text.parse().ok().and_then(|number| whole::of(self.units.apply(number))),
        };
        let bits = found.and_then(|found| whole::to_bits(kind, found));
        bits.ok_or_else(|| format!("found {text:?}, expected a whole number of {}", kind.name()))
    }
}

impl Inputs {
    /// Reads a file for an FMU.
    ///
    /// # Errors
    /// If it can't be read, a column isn't an input of the FMU, or a field isn't a number: with
    /// line and column.
    pub fn read(path: &Path, description: &Description) -> Result<Self, InputFileError> {
        let name = path.display().to_string();
        let file = std::fs::File::open(path)
            .map_err(|source| InputFileError::Open { path: name.clone(), source })?;
        Self::from_reader(std::io::BufReader::new(file), &name, description)
    }

    /// Reads as [`Self::read`], from any reader; `name` is for messages.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn from_reader(
        reader: impl std::io::Read,
        name: &str,
        description: &Description,
    ) -> Result<Self, InputFileError> {
        let content = |line: u64, column: usize, reason: String| InputFileError::Content {
            path: name.to_owned(),
            line,
            column,
            reason,
        };
        let mut rows = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .flexible(true)
            .from_reader(reader);
        let header = rows.headers().map_err(|e| content(1, 1, e.to_string()))?.clone();
        let line = header.position().map_or(1, csv::Position::line);
        let first = header.get(0).unwrap_or_default().trim_start_matches('\u{feff}');
        let time_factor = time(first).ok_or_else(|| {
            content(line, 1, format!("found {first:?}, expected time as the first column"))
        })?;
        let headers = (1..header.len()).map(|index| {
            of_header(description, &header[index]).map_err(|e| content(line, index + 1, e))
        });
        let headers: Vec<Header<'_>> = headers.collect::<Result<_, _>>()?;
        let mut seen: Vec<(&Variable, usize)> = Vec::new();
        for (index, one) in headers.iter().enumerate() {
            let is_seen = |(variable, element): &(&Variable, usize)| {
                seen.iter().any(|(v, e)| std::ptr::eq(*v, *variable) && e == element)
            };
            if one.elements.iter().any(is_seen) {
                let reason = format!("{} a second time", &header[index + 1]);
                return Err(content(line, index + 2, reason));
            }
            seen.extend(&one.elements);
        }
        // The other elements of a parameter have values that this file doesn't know.
        for (variable, _) in seen.iter().filter(|(v, _)| v.causality == Causality::Parameter) {
            let (found, expected) = (
                seen.iter().filter(|(other, _)| std::ptr::eq(*other, *variable)).count(),
                count(description, variable),
            );
            if found != expected {
                let name = &variable.name;
                let reason = format!(
                    "found columns for {found} of {expected} elements of the parameter {name}, expected all of them"
                );
                return Err(content(line, 1, reason));
            }
        }

        let mut clocks = Vec::new();
        for variable in headers.iter().filter_map(Header::clock) {
            let group = VariableGroup::of(description, variable)?;
            clocks.push(ClockColumn { group, ticks: Vec::new() });
        }
        seen.retain(|(variable, _)| variable.kind != VariableType::Clock);
        let mut variables: Vec<&Variable> = Vec::new();
        for (variable, _) in &seen {
            if !variables.iter().any(|known| std::ptr::eq(*known, *variable)) {
                variables.push(variable);
            }
        }
        let plan = AccessPlan::exactly(description, &variables)?;
        let mut numbers = vec![0.0; plan.elements];
        for (variable, place) in variables.iter().zip(&plan.places) {
            octant_fmu_bind::bind::start_exactly(variable, &mut numbers[place.clone()]);
        }
        let column = |(variable, element): &(&Variable, usize)| {
            let known = variables.iter().position(|known| std::ptr::eq(*known, *variable));
            Column {
                place: known.map_or(0, |index| plan.places[index].start) + element,
                continuous: variable.kind.is_float()
                    && variable.variability == Variability::Continuous,
                values: Vec::new(),
            }
        };
        let mut columns: Vec<Column> = seen.iter().map(column).collect();
        let mut time_s: Vec<f64> = Vec::new();
        let mut record = csv::StringRecord::new();
        loop {
            let line = rows.position().line();
            match rows.read_record(&mut record) {
                Ok(false) => break,
                Ok(true) => {}
                Err(error) => return Err(content(line, 1, error.to_string())),
            }
            let line = record.position().map_or(line, csv::Position::line);
            if record.len() != header.len() {
                let reason = format!("found {} columns, expected {}", record.len(), header.len());
                return Err(content(line, record.len().min(header.len()), reason));
            }
            let now = number(&record[0], VariableType::Float64)
                .map_err(|reason| content(line, 1, reason))?
                * time_factor;
            if let Some(before) = time_s.last().filter(|before| **before > now) {
                let reason = format!("found the time {now} s after {before} s");
                return Err(content(line, 1, reason));
            }
            time_s.push(now);
            let (mut columns, mut clocks) = (columns.iter_mut(), clocks.iter_mut());
            for (index, header) in headers.iter().enumerate() {
                let wrong = |reason: String| content(line, index + 2, reason);
                let field = &record[index + 1];
                if header.clock().is_some() {
                    let ticks = number(field, VariableType::Boolean).map_err(wrong)?;
                    clocks.by_ref().take(1).for_each(|clock| clock.ticks.push(ticks != 0.0));
                    continue;
                }
                let expected = header.elements.len();
                let texts = field.split_ascii_whitespace().count();
                // A scalar field is parsed as it is: the parser's message for an empty field or for
                // two numbers says more.
                if expected > 1 && texts != expected {
                    return Err(wrong(format!("found {texts} numbers, expected {expected}")));
                }
                let mut rest = field.split_ascii_whitespace();
                for ((variable, _), column) in header.elements.iter().zip(&mut columns) {
                    let text = if expected > 1 { rest.next().unwrap_or_default() } else { field };
                    let value = header.value(text, variable.kind).map_err(wrong)?;
                    column.values.push(value);
                }
            }
        }
        if time_s.is_empty() {
            return Err(content(line + 1, 1, "the file ends, expected a row of numbers".into()));
        }
        let jumps_s = jumps_s(&time_s, &columns, &clocks);
        Ok(Self {
            plan,
            numbers,
            time_s,
            columns,
            clocks,
            row: 0,
            reached: 0,
            ticked: 0,
            jumps_s,
            close_s: 0.0,
        })
    }

    /// Takes the times of rows for requested times where they differ by so little, s.
    pub fn take_as_close(&mut self, close_s: f64) {
        self.close_s = close_s;
    }

    /// Lists the times between two times at which an input doesn't go on as before, s.
    pub fn jumps_between(&self, after_s: f64, before_s: f64) -> impl Iterator<Item = f64> + '_ {
        let first =
            self.jumps_s.partition_point(|time_s| *time_s <= after_s + self.close_to(after_s));
        let before_s = before_s - self.close_to(before_s);
        self.jumps_s[first..].iter().copied().take_while(move |time_s| *time_s < before_s)
    }

    /// A communication point is a product, and may differ in the last digits from a row's decimal time.
    fn close_to(&self, time_s: f64) -> f64 {
        self.close_s.max(1e-12 * time_s.abs())
    }

    /// Returns first and last time of the table, s.
    #[must_use]
    pub fn span_s(&self) -> (f64, f64) {
        (self.time_s[0], self.time_s[self.time_s.len() - 1])
    }

    /// Writes the inputs at a time into the numbers. Times must come in order.
    pub fn at(&mut self, time_s: f64) {
        let reached = time_s + self.close_to(time_s);
        if self.time_s[self.row] > reached {
            self.row = 0;
        }
        while self.time_s.get(self.row + 1).is_some_and(|next| *next <= reached) {
            self.row += 1;
        }
        // Before the first row its values hold, and it doesn't tick.
        self.reached = if self.time_s[self.row] > reached { 0 } else { self.row + 1 };
        let (row, next) = (self.row, self.row + 1);
        let here = self.time_s[row];
        let part = match self.time_s.get(next) {
            Some(there) if *there > here && time_s > here => (time_s - here) / (there - here),
            _ => 0.0,
        };
        for column in &self.columns {
            let value = column.values[row];
            self.numbers[column.place] = if column.continuous && part > 0.0 {
                value + part * (column.values[next] - value)
            } else {
                value
            };
        }
    }
}

impl Inputs {
    /// Returns the time of the next row at which a clock ticks, s, of those that [`Self::ticks`] hasn't
    /// told yet.
    #[must_use]
    pub fn next_tick_s(&self) -> Option<f64> {
        let ticks = |row: &usize| self.clocks.iter().any(|clock| clock.ticks[*row]);
        (self.ticked..self.time_s.len()).find(ticks).map(|row| self.time_s[row])
    }

    /// Returns the clocks that tick at the last requested time: those of each row since the last call.
    pub fn ticks(&mut self) -> Option<VariableGroup> {
        let (first, end) = (self.ticked, self.reached);
        self.ticked = first.max(end);
        let ticks = |clock: &&ClockColumn| {
            clock.ticks.get(first..end).is_some_and(|ticks| ticks.contains(&true))
        };
        let mut due = self.clocks.iter().filter(ticks);
        let mut group = due.next()?.group.clone();
        for clock in due {
            group.references.extend(&clock.group.references);
            group.elements += clock.group.elements;
        }
        Some(group)
    }
}

/// Lists the times of rows at which an input doesn't go on as before.
fn jumps_s(time_s: &[f64], columns: &[Column], clocks: &[ClockColumn]) -> Vec<f64> {
    let jumps = |row: &usize| {
        let row = *row;
        let ticks = clocks.iter().any(|clock| clock.ticks.get(row) == Some(&true));
        let changes = |column: &Column| {
            row > 0
                && column.values[row].to_bits() != column.values[row - 1].to_bits()
                && (!column.continuous || time_s[row] == time_s[row - 1])
        };
        ticks || columns.iter().any(changes)
    };
    let mut times_s: Vec<f64> = (0..time_s.len()).filter(jumps).map(|row| time_s[row]).collect();
    times_s.dedup();
    times_s
}

/// Returns the SI value of a time column's unit; `None` if the column isn't time.
fn time(header: &str) -> Option<f64> {
    let (name, unit) = split_unit(header);
    if !name.eq_ignore_ascii_case("time") {
        return None;
    }
    let Some(unit) = unit else { return Some(1.0) };
    let units = known(unit);
    units.iter().find(|unit| unit.exponents == [0, 0, 1, 0, 0, 0, 0, 0]).map(|unit| unit.factor)
}

/// Splits a name and the unit in brackets after a blank: `imu.w[1] [deg/s]`.
fn split_unit(header: &str) -> (&str, Option<&str>) {
    let header = header.trim();
    let unit = header.strip_suffix(']').and_then(|rest| rest.rsplit_once(" ["));
    unit.map_or((header, None), |(name, unit)| (name.trim(), Some(unit.trim())))
}

fn of_header<'a>(description: &'a Description, header: &str) -> Result<Header<'a>, String> {
    let is_input = |variable: &Variable| variable.causality == Causality::Input;
    let (name, unit) = split_unit(header);
    let found = find(description, name, 1).filter(|found| !found.negated);
    let Some(found) = found else { return Err(unknown(description, name, is_input).to_string()) };
    for (variable, element) in &found.elements {
        allowed(variable, ValueWay::In).map_err(|error| error.to_string())?;
        if let Some(clock) = &variable.clock
            && clock.interval_variability != IntervalVariability::Triggered
        {
            return Err(format!(
                "{name} is a clock with times of its own, expected a triggered one"
            ));
        }
        if matches!(variable.kind, VariableType::String | VariableType::Binary) {
            return Err(format!(
                "{name} is a {:?}, and a column of numbers can't be one",
                variable.kind
            ));
        }
        debug_assert!(*element < count(description, variable).max(1));
    }
    let Some((variable, _)) = found.elements.first() else {
        return Err(format!("{name} is an array without elements, expected a number"));
    };
    let units = match unit {
        None => UnitConversion::IDENTITY,
        Some(unit) => units(description, variable, unit)?,
    };
    Ok(Header { elements: found.elements, units })
}

/// Returns the conversion from a column's unit to the variable's.
fn units(
    description: &Description,
    variable: &Variable,
    unit: &str,
) -> Result<UnitConversion, String> {
    let Some(own) = &variable.unit else {
        return Err(format!("found the unit {unit:?}, and {} has none", variable.name));
    };
    UnitConversion::between(description, unit, own)
        .map_err(|error| format!("{}: {error}", variable.name))
}

fn number(text: &str, kind: VariableType) -> Result<f64, String> {
    match (text, kind) {
        ("true", VariableType::Boolean) => return Ok(1.0),
        ("false", VariableType::Boolean) => return Ok(0.0),
        _ => {}
    }
    let value: f64 = text.parse().map_err(|_| format!("found {text:?}, expected a number"))?;
    let fits = match kind {
        VariableType::Boolean => value == 0.0 || value == 1.0,
        VariableType::Float64 | VariableType::Float32 => true,
        _ => value.fract() == 0.0,
    };
    if fits {
        return Ok(value);
    }
    Err(match kind {
        VariableType::Boolean => format!("found {text:?}, expected 0, 1, true or false"),
        _ => format!("found {text:?}, expected a whole number"),
    })
}
