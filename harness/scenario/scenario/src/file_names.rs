//! Names of the inertial channels: the body's axis, and beside it the name that the file or the unit has for it.

use crate::model::SourceSpec;
use crate::recorded::{AxisColumn, MappedField, RecordedColumn};
use octant_instruments::Axes;

/// Number of inertial channels.
pub const CHANNELS: usize = 6;

/// Names of the channels.
pub const NAMES: [&str; CHANNELS] =
    ["gyro_x", "gyro_y", "gyro_z", "accelerometer_x", "accelerometer_y", "accelerometer_z"];

/// Names that a file or a unit has for gyros x, y, z and accelerometers x, y, z of the body; none where it has the
/// body's.
///
/// A minus before a name says that the body's axis is the opposite of the file's. Scale and offset of the mapping are
/// not in it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FileNames(pub Option<[String; CHANNELS]>);

impl FileNames {
    /// Names of the columns or fields that a source maps, or of a unit's axes that aren't the body's.
    #[must_use]
    pub fn of(source: &SourceSpec) -> Self {
        let signed = |scale: f64, name: String| match scale < 0.0 {
            true => format!("−{name}"),
            false => name,
        };
        let of_text = |axis: &AxisColumn| {
            let name = match &axis.column {
                RecordedColumn::Number(number) => format!("column {number}"),
                RecordedColumn::Name(name) => name.clone(),
            };
            signed(axis.scale, name)
        };
        let of_mcap = |field: &MappedField| signed(field.scale, field.path.clone());
        let of_unit = |axes: &Axes| {
            axes.names().map(|(name, opposite)| match opposite {
                true => format!("−{name} of the unit"),
                false => format!("{name} of the unit"),
            })
        };
        let [[a, b, c], [d, e, f]] = match source {
            SourceSpec::Text(mapping) => {
                let accelerometer = mapping.accelerometer.each_ref().map(of_text);
                [mapping.gyro.each_ref().map(of_text), accelerometer]
            }
            SourceSpec::Replay { mapping: Some(mapping), .. } => {
                let accelerometer = mapping.accelerometer.each_ref().map(of_mcap);
                [mapping.gyro.each_ref().map(of_mcap), accelerometer]
            }
            SourceSpec::Log(log) if log.axes != Axes::SAME => {
                [of_unit(&log.axes), of_unit(&log.axes)]
            }
            SourceSpec::Live(unit) if unit.axes != Axes::SAME => {
                [of_unit(&unit.axes), of_unit(&unit.axes)]
            }
            _ => return Self(None),
        };
        Self(Some([a, b, c, d, e, f]))
    }

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

    /// All of them in a line; `None` where the file has the body's.
    #[must_use]
    pub fn line(&self) -> Option<String> {
        let [a, b, c, d, e, f] = self.0.as_ref()?;
        Some(format!("gyro x, y, z: {a}, {b}, {c}; accelerometer x, y, z: {d}, {e}, {f}"))
    }
}
