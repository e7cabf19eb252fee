//! Errors over time of many cases, in a temporary file.
//!
//! Percentiles at a time need the errors of all cases at that time. All errors at all times would be
//! gigabytes of memory for a large campaign.

use octant_statistics::envelope::resampled;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::sync::{Arc, Mutex, PoisonError};

/// Bytes that are written at a time.
const WRITTEN: usize = 1 << 20;

/// Maximum number of points of a drift.
const POINTS_MAX: f64 = 500.0;
/// Distances between points, s.
const STEPS_S: [f64; 14] =
    [0.1, 1.0, 2.0, 5.0, 10.0, 30.0, 60.0, 120.0, 300.0, 600.0, 1800.0, 3600.0, 7200.0, 21_600.0];

/// Errors over time, at whole multiples of a step from the start of the navigation.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The step, s: the same for navigations of the same length.
    pub step_s: f64,
    /// Latitude error, arcmin.
    pub latitude_arcmin: Vec<f64>,
    /// Longitude error, arcmin.
    pub longitude_arcmin: Vec<f64>,
}

/// Writes curves one after another.
#[derive(Debug)]
pub(super) struct CurveWriter {
    file: Arc<CurveFile>,
    buffer: Vec<u8>,
    end: u64,
}

/// Temporary file without a name, made when it is needed, and the first error of using it.
#[derive(Debug, Default)]
pub(super) struct CurveFile(Mutex<(Option<File>, Option<io::Error>)>);

/// Errors over time of one case.
#[derive(Clone, Debug)]
pub struct StoredCurve {
    /// The step, s.
    pub step_s: f64,
    /// Number of points.
    pub points: usize,
    at: u64,
    file: Arc<CurveFile>,
}

impl CurveWriter {
    pub(super) fn new() -> Self {
        Self { file: Arc::default(), buffer: Vec::new(), end: 0 }
    }

    /// Stores a curve, whose two axes have the same number of points.
    pub(super) fn push(&mut self, curve: &Curve) -> io::Result<StoredCurve> {
        let Curve { step_s, latitude_arcmin, longitude_arcmin } = curve;
        let points = latitude_arcmin.len().min(longitude_arcmin.len());
        let stored =
            StoredCurve { step_s: *step_s, points, at: self.end, file: Arc::clone(&self.file) };
        for axis in [latitude_arcmin, longitude_arcmin] {
            let values = axis.iter().take(points).flat_map(|value| value.to_le_bytes());
            self.buffer.extend(values);
        }
        self.end += 16 * points as u64;
        if self.buffer.len() >= WRITTEN {
            self.flush()?;
        }
        Ok(stored)
    }

    /// Writes what isn't written yet: curves are read after it.
    pub(super) fn flush(&mut self) -> io::Result<()> {
        let mut inner = self.file.0.lock().unwrap_or_else(PoisonError::into_inner);
        let file = match &mut inner.0 {
            Some(file) => file,
            none => none.insert(tempfile::tempfile()?),
        };
        file.write_all(&self.buffer)?;
        self.buffer.clear();
        Ok(())
    }

    /// Returns the file of the curves.
    pub(super) fn file(&self) -> Arc<CurveFile> {
        Arc::clone(&self.file)
    }
}

impl CurveFile {
    /// Takes the first error of reading.
    pub(super) fn error(&self) -> Option<io::Error> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).1.take()
    }
}

impl StoredCurve {
    /// Names a curve in a file.
    pub(super) fn new(step_s: f64, points: usize, at: u64, file: Arc<CurveFile>) -> Self {
        Self { step_s, points, at, file }
    }

    /// Byte at which it begins in its file.
    pub(super) fn at(&self) -> u64 {
        self.at
    }

    /// Reads the points of both axes, latitude before longitude, arcmin. `None` if they can't be read, which the file
    /// of the curves remembers.
    pub(super) fn read(&self) -> Option<Vec<f64>> {
        let mut bytes = vec![0; 16 * self.points];
        let mut inner = self.file.0.lock().unwrap_or_else(PoisonError::into_inner);
        let (file, error) = &mut *inner;
        let read = match file {
            Some(file) => {
                file.seek(SeekFrom::Start(self.at)).and_then(|_| file.read_exact(&mut bytes))
            }
            None => Err(io::ErrorKind::UnexpectedEof.into()),
        };
        if let Err(wrong) = read {
            error.get_or_insert(wrong);
            return None;
        }
        let (values, _) = bytes.as_chunks::<8>();
        Some(values.iter().map(|value| f64::from_le_bytes(*value)).collect())
    }

    /// Remembers an error of a file that was made of curves, as one of reading them.
    pub(super) fn fail(&self, wrong: io::Error) {
        let mut inner = self.file.0.lock().unwrap_or_else(PoisonError::into_inner);
        inner.1.get_or_insert(wrong);
    }
}

impl Curve {
    /// Interpolates the points of a drift, which differ from case to case, onto a common grid.
    // One copy, so that the self-test checks the one that reports use.
    #[inline(never)]
    pub fn of(series_hours: &[[f64; 3]]) -> Option<Self> {
        let (first, last) = (series_hours.first()?[0], series_hours.last()?[0]);
        // A series may begin with the first sample instead of before it.
        let duration_s = (last - first) * 3600.0;
        let step_s = STEPS_S.into_iter().find(|step| duration_s / step <= POINTS_MAX)?;
        // Times are rounded to a millionth of an hour.
        let points = libm::floor(duration_s / step_s + 0.01);
        let grid: Vec<f64> = (0..=points as u32)
            .map(|k| (first + f64::from(k) * step_s / 3600.0).min(last))
            .collect();
        let column = |column: usize| {
            let points: Vec<[f64; 2]> =
                series_hours.iter().map(|point| [point[0], point[column]]).collect();
            resampled(&points, &grid)
        };
        Some(Self { step_s, latitude_arcmin: column(1)?, longitude_arcmin: column(2)? })
    }
}
