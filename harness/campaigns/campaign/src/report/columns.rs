//! Errors of many cases at each time: curves by time instead of by case, in a temporary file.
//!
//! Percentiles at a time need the errors of all cases at that time. The file of the curves has them case by case, and
//! to pick one of each would take a system call for every value.

use super::curves::StoredCurve;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};

/// Number of curves of a block: a curve of a thousand points takes 16 kB of it, twice while it is written.
const BLOCK: usize = 256;

/// Curves in blocks. A block has latitude before longitude, and of each the values of all of its curves at the first
/// time, then at the second.
#[derive(Debug)]
pub(super) struct CurveColumns {
    pub(super) step_s: f64,
    /// Number of points that all curves have.
    pub(super) points: usize,
    /// Number of curves.
    pub(super) count: usize,
    file: File,
    blocks: Vec<CurveBlock>,
}

#[derive(Clone, Copy, Debug)]
struct CurveBlock {
    /// Byte at which it begins.
    at: u64,
    curves: usize,
    /// Points of each curve.
    points: usize,
}

/// Outcome of collecting curves.
#[derive(Debug)]
pub(super) enum Collected {
    Columns(CurveColumns),
    /// No curve, or curves with different steps.
    None,
    /// A curve can't be read, which its file remembers.
    Unread,
}

impl CurveColumns {
    /// Collects curves, each with the number of units in a minute of arc of latitude and of longitude, by which its
    /// errors are multiplied.
    pub(super) fn of(curves: impl Iterator<Item = (StoredCurve, [f64; 2])>) -> Collected {
        let mut columns: Option<Self> = None;
        let mut block: Vec<Vec<f64>> = Vec::new();
        let mut first: Option<StoredCurve> = None;
        let collect = || -> io::Result<Collected> {
            for (curve, factors) in curves {
                first.get_or_insert_with(|| curve.clone());
                let columns = match &mut columns {
                    Some(columns) if columns.step_s != curve.step_s => return Ok(Collected::None),
                    Some(columns) => columns,
                    none => none.insert(Self {
                        step_s: curve.step_s,
                        points: curve.points,
                        count: 0,
                        file: tempfile::tempfile()?,
                        blocks: Vec::new(),
                    }),
                };
                let Some(mut values) = curve.read() else { return Ok(Collected::Unread) };
                let (latitude, longitude) = values.split_at_mut(curve.points);
                latitude.iter_mut().for_each(|value| *value *= factors[0]);
                longitude.iter_mut().for_each(|value| *value *= factors[1]);
                columns.points = columns.points.min(curve.points);
                columns.count += 1;
                block.push(values);
                if block.len() == BLOCK {
                    columns.write(&mut block)?;
                }
            }
            let Some(mut columns) = columns.take() else { return Ok(Collected::None) };
            columns.write(&mut block)?;
            Ok(Collected::Columns(columns))
        };
        let collected = collect();
        collected.unwrap_or_else(|error| {
            if let Some(curve) = first {
                curve.fail(error);
            }
            Collected::Unread
        })
    }

    /// Writes a block, and empties it.
    fn write(&mut self, block: &mut Vec<Vec<f64>>) -> io::Result<()> {
        // Points beyond those of the shortest curve so far are not needed.
        let points = self.points;
        let mut bytes = Vec::with_capacity(16 * points * block.len());
        for axis in 0..2 {
            for point in 0..points {
                let value = |curve: &Vec<f64>| curve[axis * (curve.len() / 2) + point];
                block.iter().for_each(|curve| bytes.extend(value(curve).to_le_bytes()));
            }
        }
        let at = self.blocks.last().map_or(0, |last| last.at + last.bytes());
        self.file.write_all(&bytes)?;
        self.blocks.push(CurveBlock { at, curves: block.len(), points });
        block.clear();
        Ok(())
    }

    /// Reads the errors of all curves at a time, given by its place, of an axis: 0 latitude, 1 longitude.
    pub(super) fn read(&mut self, axis: usize, point: usize, to: &mut Vec<f64>) -> io::Result<()> {
        to.clear();
        let mut bytes = Vec::new();
        for block in &self.blocks {
            bytes.resize(8 * block.curves, 0);
            let before = (axis * block.points + point) * block.curves;
            self.file.seek(SeekFrom::Start(block.at + 8 * before as u64))?;
            self.file.read_exact(&mut bytes)?;
            let (values, _) = bytes.as_chunks::<8>();
            to.extend(values.iter().map(|value| f64::from_le_bytes(*value)));
        }
        Ok(())
    }
}

impl CurveBlock {
    fn bytes(&self) -> u64 {
        16 * (self.points * self.curves) as u64
    }
}
