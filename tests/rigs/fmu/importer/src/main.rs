//! Steps FMUs with the `fmi` crate over the reference inputs that they carry, and compares every
//! output with the reference result, bit for bit.
//!
//! Usage: importer FMU...

use fmi::fmi2::import::Fmi2Import;
use fmi::fmi2::instance::Common as _;
use fmi::fmi2::schema::ScalarVariableElement;
use fmi::fmi3::import::Fmi3Import;
use fmi::fmi3::schema::VariableType;
use fmi::fmi3::{Common as _, Fmi3Model as _};
use fmi::schema::MajorVersion;
use fmi::schema::traits::FmiModelDescription as _;
use fmi::traits::FmiImport;
use std::error::Error;
use std::path::Path;
use std::process::ExitCode;

const STEP_S: f64 = 0.005;

fn main() -> ExitCode {
    let mut failed = std::env::args().len() < 2;
    for path in std::env::args().skip(1) {
        match check(Path::new(&path)) {
            Ok(compared) => println!("ok   {path}: {compared}"),
            Err(error) => {
                println!("FAIL {path}: {error}");
                failed = true;
            }
        }
    }
    if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

type Anything<T> = Result<T, Box<dyn Error>>;

fn check(path: &Path) -> Anything<String> {
    match fmi::import::peek_descr_path(path)?.major_version()? {
        MajorVersion::FMI2 => {
            let import: Fmi2Import = fmi::import::from_path(path)?;
            let files = Reference::of(import.archive_path(), "fmi2")?;
            let variables = &import.model_description().model_variables.variables;
            let find = |name: &str| {
                let variable = variables.iter().find(|variable| variable.name == name)?;
                let kind = match variable.elem {
                    ScalarVariableElement::Real(_) => Kind::Real,
                    ScalarVariableElement::Boolean(_) => Kind::Boolean,
                    _ => Kind::Integer,
                };
                Some((variable.value_reference, kind))
            };
            let mut instance = import.instantiate_cs("importer", false, false)?;
            instance.setup_experiment(None, 0.0, None)?;
            instance.enter_initialization_mode()?;
            instance.exit_initialization_mode()?;
            files.compare(&find, &mut Second(&mut instance))
        }
        MajorVersion::FMI3 => {
            let import: Fmi3Import = fmi::import::from_path(path)?;
            let files = Reference::of(import.archive_path(), "fmi3")?;
            let variables = &import.model_description().model_variables;
            let text = std::fs::read_to_string(import.archive_path().join("modelDescription.xml"))?;
            let find = |name: &str| {
                if let Some(variable) = variables.iter_abstract().find(|v| v.name() == name) {
                    let kind = match variable.data_type() {
                        VariableType::FmiFloat64 => Kind::Real,
                        VariableType::FmiBoolean => Kind::Boolean,
                        VariableType::FmiUInt64 => Kind::Count,
                        _ => Kind::Integer,
                    };
                    return Some((variable.value_reference(), kind));
                }
                // This crate leaves enumerations out: what is in the file is asked instead.
                let (_, rest) =
                    text.split_once(&format!("<Enumeration name=\"{name}\" valueReference=\""))?;
                Some((rest.split('"').next()?.parse().ok()?, Kind::Enumeration))
            };
            let mut instance =
                import.instantiate_cs("importer", false, false, false, false, &[])?;
            instance.enter_initialization_mode(None, 0.0, None)?;
            instance.exit_initialization_mode()?;
            files.compare(&find, &mut Third(&mut instance))
        }
        version => Err(format!("FMI {version:?}").into()),
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Real,
    Integer,
    Count,
    Boolean,
    Enumeration,
}

/// One variable at a time: slow, and plain.
trait Steps {
    fn set(&mut self, reference: u32, kind: Kind, values: &[f64]) -> Anything<()>;
    fn get(&mut self, reference: u32, kind: Kind, values: &mut [f64]) -> Anything<()>;
    fn step(&mut self, time_s: f64) -> Anything<()>;
}

struct Second<'a, T>(&'a mut T);

impl<T: fmi::fmi2::instance::CoSimulation> Steps for Second<'_, T> {
    fn set(&mut self, reference: u32, kind: Kind, values: &[f64]) -> Anything<()> {
        match kind {
            Kind::Real => self.0.set_real(&[reference], values)?,
            Kind::Boolean => self.0.set_boolean(&[reference], &[values[0] as i32])?,
            _ => self.0.set_integer(&[reference], &[values[0] as i32])?,
        };
        Ok(())
    }

    fn get(&mut self, reference: u32, kind: Kind, values: &mut [f64]) -> Anything<()> {
        let mut integer = [0];
        match kind {
            Kind::Real => {
                self.0.get_real(&[reference], values)?;
                return Ok(());
            }
            Kind::Boolean => self.0.get_boolean(&[reference], &mut integer)?,
            _ => self.0.get_integer(&[reference], &mut integer)?,
        };
        values[0] = f64::from(integer[0]);
        Ok(())
    }

    fn step(&mut self, time_s: f64) -> Anything<()> {
        self.0.do_step(time_s, STEP_S, true)?;
        Ok(())
    }
}

struct Third<'a, T>(&'a mut T);

impl<T: fmi::fmi3::CoSimulation> Steps for Third<'_, T> {
    fn set(&mut self, reference: u32, kind: Kind, values: &[f64]) -> Anything<()> {
        match kind {
            Kind::Real => self.0.set_float64(&[reference], values)?,
            Kind::Integer => self.0.set_int32(&[reference], &map(values, |v| v as i32))?,
            Kind::Count => self.0.set_uint64(&[reference], &map(values, |v| v as u64))?,
            Kind::Boolean => self.0.set_boolean(&[reference], &map(values, |v| v != 0.0))?,
            Kind::Enumeration => self.0.set_int64(&[reference], &map(values, |v| v as i64))?,
        };
        Ok(())
    }

    fn get(&mut self, reference: u32, kind: Kind, values: &mut [f64]) -> Anything<()> {
        let count = values.len();
        let mut put = |found: Vec<f64>| values.copy_from_slice(&found);
        match kind {
            Kind::Real => {
                self.0.get_float64(&[reference], values)?;
            }
            Kind::Integer => {
                let mut found = vec![0; count];
                self.0.get_int32(&[reference], &mut found)?;
                put(map(&found, f64::from));
            }
            Kind::Count => {
                let mut found = vec![0; count];
                self.0.get_uint64(&[reference], &mut found)?;
                put(map(&found, |v| v as f64));
            }
            Kind::Boolean => {
                let mut found = vec![false; count];
                self.0.get_boolean(&[reference], &mut found)?;
                put(map(&found, |v| f64::from(u8::from(v))));
            }
            Kind::Enumeration => {
                let mut found = vec![0; count];
                self.0.get_int64(&[reference], &mut found)?;
                put(map(&found, |v| v as f64));
            }
        }
        Ok(())
    }

    fn step(&mut self, time_s: f64) -> Anything<()> {
        let [mut event, mut terminate, mut early] = [false; 3];
        let mut last = 0.0;
        self.0.do_step(time_s, STEP_S, true, &mut event, &mut terminate, &mut early, &mut last)?;
        if event || terminate || early {
            return Err(format!(
                "at {time_s} s: event {event}, terminate {terminate}, early {early}"
            )
            .into());
        }
        Ok(())
    }
}

fn map<A: Copy, B>(values: &[A], to: impl Fn(A) -> B) -> Vec<B> {
    values.iter().map(|value| to(*value)).collect()
}

/// A column: name, and rows of elements.
struct Table {
    names: Vec<String>,
    times: Vec<f64>,
    rows: Vec<Vec<Vec<f64>>>,
}

impl Table {
    fn read(path: &Path) -> Anything<Self> {
        let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let mut lines = text.lines();
        let names = lines.next().ok_or("no header")?.split(',').skip(1);
        let names = names.map(|name| name.trim_matches('"').to_owned()).collect();
        let (mut times, mut rows) = (Vec::new(), Vec::new());
        for line in lines {
            let mut cells = line.split(',');
            times.push(cells.next().ok_or("no time")?.parse()?);
            let row = cells.map(|cell| cell.split(' ').map(str::parse).collect());
            rows.push(row.collect::<Result<Vec<Vec<f64>>, _>>()?);
        }
        Ok(Self { names, times, rows })
    }
}

struct Reference {
    inputs: Table,
    results: Table,
}

impl Reference {
    fn of(folder: &Path, suffix: &str) -> Anything<Self> {
        let folder = folder.join("documentation");
        let mut stem = None;
        for entry in std::fs::read_dir(&folder)? {
            let name = entry?.file_name().to_string_lossy().into_owned();
            if let Some(found) = name.strip_suffix(&format!("_{suffix}_in.csv")) {
                stem = Some(found.to_owned());
            }
        }
        let stem = stem.ok_or("no reference input in documentation")?;
        let file = |what: &str| Table::read(&folder.join(format!("{stem}_{suffix}_{what}.csv")));
        Ok(Self { inputs: file("in")?, results: file("ref")? })
    }

    fn compare(
        &self,
        find: &dyn Fn(&str) -> Option<(u32, Kind)>,
        steps: &mut dyn Steps,
    ) -> Anything<String> {
        let all = |table: &Table| {
            let found =
                table.names.iter().map(|name| find(name).ok_or(format!("no variable {name}")));
            found.collect::<Result<Vec<_>, _>>()
        };
        let (inputs, outputs) = (all(&self.inputs)?, all(&self.results)?);
        let mut compared = 0;
        let mut results = self.results.times.iter().zip(&self.results.rows).peekable();
        for (time_s, row) in self.inputs.times.iter().zip(&self.inputs.rows) {
            if let Some((_, expected)) = results.next_if(|(at, _)| (**at - time_s).abs() < 1e-9) {
                for ((name, (reference, kind)), expected) in
                    self.results.names.iter().zip(&outputs).zip(expected)
                {
                    let mut found = vec![0.0; expected.len()];
                    steps.get(*reference, *kind, &mut found)?;
                    // A value that is no number has one meaning, whatever its bits.
                    let same = |(a, b): (&f64, &f64)| {
                        a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()
                    };
                    if !expected.iter().zip(&found).all(same) {
                        return Err(format!(
                            "{name} at {time_s} s is {found:?}, expected {expected:?}"
                        )
                        .into());
                    }
                    compared += found.len();
                }
            }
            if results.peek().is_none() {
                break;
            }
            for ((reference, kind), values) in inputs.iter().zip(row) {
                steps.set(*reference, *kind, values)?;
            }
            steps.step(*time_s)?;
        }
        if results.next().is_some() {
            return Err("rows of the reference were not reached".into());
        }
        Ok(format!("{compared} values equal bit for bit"))
    }
}
