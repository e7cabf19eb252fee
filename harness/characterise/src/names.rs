//! Names of the channels: the body's axis, and beside it the name that the file of the recording has for it.

use super::analysis::NAMES;
use super::deviations::CHANNELS;
use serde::Serialize;

/// Names that the file has for gyros x, y, z and accelerometers x, y, z of the body; none where it names none.
///
/// A minus before a name says that the body's axis is the opposite of the file's. Scale and offset of the mapping are
/// not in it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(transparent)]
pub struct FileNames(pub Option<[String; CHANNELS]>);

impl FileNames {
    fn of_file(&self, index: usize) -> Option<&str> {
        self.0.as_ref()?.get(index).map(String::as_str)
    }

    /// Name of a channel of the analysis with the file's: `gyro_x (GyroXCalib)`.
    #[must_use]
    pub fn channel(&self, name: &str) -> String {
        let index = NAMES.iter().position(|known| *known == name);
        match index.and_then(|index| self.of_file(index)) {
            Some(of_file) => format!("{name} ({of_file})"),
            None => name.to_owned(),
        }
    }

    /// Axis with the file's name: `x (GyroXCalib)`. Triad 0 is that of the gyros, 1 that of the accelerometers.
    #[must_use]
    pub fn axis(&self, triad: usize, axis: usize) -> String {
        let name = ["x", "y", "z"].get(axis).copied().unwrap_or_default();
        match self.of_file(3 * triad + axis) {
            Some(of_file) => format!("{name} ({of_file})"),
            None => name.to_owned(),
        }
    }

    /// The file's name of an axis.
    #[must_use]
    pub fn column(&self, triad: usize, axis: usize) -> Option<&str> {
        self.of_file(3 * triad + axis)
    }
}
