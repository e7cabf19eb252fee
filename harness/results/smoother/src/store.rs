//! Measurements of the filter, as the smoother needs them, in a file without a name that is read backward: memory doesn't grow with
//! the length of the history.

use octant_calibration::covariance::{MOVING, STATE_COUNT};
use octant_sample::parameters::PARAMETER_COUNT;
use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};

/// A row over the states.
pub type Row = [f64; STATE_COUNT];

/// One measurement that the filter used, of three states in a row.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Time of the filter, s.
    pub time_s: f64,
    /// Rows of the moving states of the transition since the measurement before.
    pub transition: [Row; MOVING],
    /// First of the measured states.
    pub first: usize,
    /// Variance of the measurement, of each axis.
    pub variance: f64,
    /// Measured minus expected: the error that the measurement shows, m/s or m.
    pub innovation: [f64; 3],
    /// Rows of the measured states of the covariance after it.
    pub covariance: [Row; 3],
    /// All of the filter, where it is looked at.
    pub node: Option<Box<Node>>,
}

/// The filter at one time, after the measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Covariance of all states.
    pub covariance: [Row; STATE_COUNT],
    /// Estimates of the parameters, SI.
    pub parameters: [f64; PARAMETER_COUNT],
}

/// Numbers of a measurement in the file: time, first state, variance, innovation, transition, covariance.
const NUMBERS: usize = 6 + (MOVING + 3) * STATE_COUNT;
/// Numbers of a node behind them.
const NODE_NUMBERS: usize = STATE_COUNT * STATE_COUNT + PARAMETER_COUNT;

/// Reasons why a history can't be kept.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The folder of temporary files takes no file.
    #[error("make a file for the history in {folder}: {error}")]
    Make {
        /// Folder of temporary files.
        folder: String,
        /// What the system says.
        error: io::Error,
    },
    /// The file can't be written or read.
    #[error("keep the history in {folder}: {error}")]
    Keep {
        /// Folder of temporary files.
        folder: String,
        /// What the system says.
        error: io::Error,
    },
}

fn folder() -> String {
    std::env::temp_dir().display().to_string()
}

fn keep(error: io::Error) -> StoreError {
    StoreError::Keep { folder: folder(), error }
}

/// Measurements in the order in which they came.
#[derive(Debug)]
pub struct Store {
    file: BufWriter<File>,
    /// Place of each measurement, and whether it is a node.
    places: Vec<(u64, bool)>,
    end: u64,
}

impl Store {
    /// Makes an empty store.
    ///
    /// # Errors
    /// If the folder of temporary files takes no file.
    pub fn new() -> Result<Self, StoreError> {
        let file =
            tempfile::tempfile().map_err(|error| StoreError::Make { folder: folder(), error })?;
        Ok(Self { file: BufWriter::new(file), places: Vec::new(), end: 0 })
    }

    /// Number of measurements.
    #[must_use]
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Returns whether there is no measurement.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Drops all measurements.
    ///
    /// # Errors
    /// If the file can't be written.
    pub fn clear(&mut self) -> Result<(), StoreError> {
        self.places.clear();
        self.end = 0;
        self.file.rewind().map_err(keep)
    }

    /// Adds a measurement.
    ///
    /// # Errors
    /// If the file can't be written.
    pub fn push(&mut self, measured: &Measured) -> Result<(), StoreError> {
        let Measured { time_s, transition, first, variance, innovation, covariance, node } =
            measured;
        self.places.push((self.end, node.is_some()));
        let head = [*time_s, *first as f64, *variance];
        let parts = [&head[..], innovation, transition.as_flattened(), covariance.as_flattened()];
        for part in parts {
            self.write(part).map_err(keep)?;
        }
        if let Some(node) = node {
            self.write(node.covariance.as_flattened()).map_err(keep)?;
            self.write(&node.parameters).map_err(keep)?;
        }
        Ok(())
    }

    fn write(&mut self, numbers: &[f64]) -> io::Result<()> {
        for number in numbers {
            self.file.write_all(&number.to_le_bytes())?;
        }
        self.end += 8 * numbers.len() as u64;
        Ok(())
    }

    /// Reads measurement `k`.
    ///
    /// # Errors
    /// If the file can't be read.
    ///
    /// # Panics
    /// If there are no more than `k`.
    pub fn read(&mut self, k: usize) -> Result<Measured, StoreError> {
        let (place, is_node) = self.places[k];
        let mut bytes = vec![0; 8 * (NUMBERS + if is_node { NODE_NUMBERS } else { 0 })];
        // Seeking writes what is still in the buffer.
        self.file.seek(SeekFrom::Start(place)).map_err(keep)?;
        self.file.get_mut().read_exact(&mut bytes).map_err(keep)?;
        self.file.seek(SeekFrom::Start(self.end)).map_err(keep)?;
        let mut numbers = bytes.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes));
        let mut next = || numbers.next().unwrap_or(f64::NAN);
        let (time_s, first, variance) = (next(), next() as usize, next());
        let innovation = core::array::from_fn(|_| next());
        let mut row = || -> Row { core::array::from_fn(|_| next()) };
        let transition = core::array::from_fn(|_| row());
        let covariance = core::array::from_fn(|_| row());
        let all = is_node.then(|| core::array::from_fn(|_| row()));
        let node = all.map(|covariance| {
            Box::new(Node { covariance, parameters: core::array::from_fn(|_| next()) })
        });
        Ok(Measured { time_s, transition, first, variance, innovation, covariance, node })
    }
}
