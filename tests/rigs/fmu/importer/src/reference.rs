//! Reference inputs and results that an FMU carries, and their comparison with what an importer computes.

use crate::Anything;
use std::path::Path;

/// Communication step, s.
pub const STEP_S: f64 = 0.005;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    Real,
    Integer,
    Count,
    Boolean,
    Enumeration,
}

/// One variable at a time: slow, and plain.
pub trait Steps {
    fn set(&mut self, reference: u32, kind: Kind, values: &[f64]) -> Anything<()>;
    fn get(&mut self, reference: u32, kind: Kind, values: &mut [f64]) -> Anything<()>;
    fn step(&mut self, time_s: f64) -> Anything<()>;
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

pub struct Reference {
    inputs: Table,
    results: Table,
}

impl Reference {
    pub fn of(folder: &Path, suffix: &str) -> Anything<Self> {
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

    pub fn compare(
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
