//! A folder of CSV files, one a table, with `export.json` beside them for units and descriptions.

use super::error::ExportFailure;
use super::job::{Job, NewFile};
use super::table::Cell;
use std::io::BufWriter;
use std::path::PathBuf;

/// Name of the description beside the tables.
pub(crate) const ABOUT: &str = "export.json";

/// Writes `TABLE.csv` for every table, and `export.json`; returns the files.
pub(crate) fn write(job: &Job<'_>) -> Result<Vec<PathBuf>, ExportFailure> {
    let mut files = Vec::new();
    for table in &job.survey.tables {
        let path = job.out.join(format!("{}.csv", table.table.name()));
        let new = NewFile::create(&path, job.force)?;
        let mut writer = csv::Writer::from_writer(BufWriter::new(new.file()?));
        let names = table.columns.iter().map(|found| found.column.name.as_str());
        writer.write_record(names).map_err(|error| new.format(error))?;
        files.push((new, writer));
    }
    let about = about_file(job)?;
    let mut text = String::new();
    job.rows(&mut |index, cells| {
        let (new, writer) = &mut files[index];
        for found in &job.survey.tables[index].columns {
            field(&cells[found.place], &mut text);
            writer.write_field(&text).map_err(|error| new.format(error))?;
        }
        writer.write_record(None::<&[u8]>).map_err(|error| new.format(error))
    })?;
    let mut written = Vec::new();
    for (new, mut writer) in files {
        writer.flush().map_err(|error| new.system(error))?;
        drop(writer);
        written.push(new.finish()?);
    }
    written.push(about.finish()?);
    Ok(written)
}

/// Writes the description of the export, without its name yet.
pub(crate) fn about_file(job: &Job<'_>) -> Result<NewFile, ExportFailure> {
    let new = NewFile::create(&job.out.join(ABOUT), job.force)?;
    let mut file = new.file()?;
    let text = format!("{:#}\n", job.about());
    std::io::Write::write_all(&mut file, text.as_bytes()).map_err(|error| new.system(error))?;
    Ok(new)
}

/// Writes a cell as text: a number with the fewest digits that read back as the same bits.
fn field(cell: &Cell, text: &mut String) {
    use std::fmt::Write as _;
    text.clear();
    // Writing to a string doesn't fail.
    let _ = match cell {
        Cell::Empty => Ok(()),
        Cell::Number(number) => {
            let size = number.abs();
            if size != 0.0 && !(1e-5..1e16).contains(&size) {
                write!(text, "{number:e}")
            } else {
                write!(text, "{number}")
            }
        }
        Cell::Integer(number) => write!(text, "{number}"),
        Cell::Boolean(value) => write!(text, "{value}"),
        Cell::Text(words) => text.write_str(words),
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_as_the_same_bits() {
        let mut text = String::new();
        for number in [0.0, -0.0, 1.0, 0.1, -1e-5, 9.999e-6, 1e16, 1.0 / 3.0, 5e-324, f64::MAX] {
            field(&Cell::Number(number), &mut text);
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), number.to_bits(), "{text}");
            assert!(text.len() < 25, "{text}");
        }
        field(&Cell::from(f64::NAN), &mut text);
        assert_eq!(text, "");
        field(&Cell::Boolean(true), &mut text);
        assert_eq!(text, "true");
    }
}
