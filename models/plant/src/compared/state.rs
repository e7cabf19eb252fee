//! The plant with its copies as bytes, and back.

use super::{ComparedPlant, Copied};
use crate::config::PlantConfig;
use octant_state::{State, StateError, StateFormat, Writer, check_count};

/// Format of the state of a plant with its copies. Raise the version when the layout changes, or that of a plant; a
/// test compares the layout with the stored one.
pub const FORMAT: StateFormat =
    StateFormat { magic: "OCTANTPC", version: 2, what: "the state of a plant with its copies" };

impl ComparedPlant {
    /// Appends everything that the plant needs to continue bit for bit after this step: the same
    /// plant gives the same bytes.
    pub fn save(&self, bytes: &mut Vec<u8>) {
        FORMAT.write(bytes, |to| {
            to.value("config", self.plant.config());
            to.part("plant", self);
        });
    }

    /// Makes a plant that continues where another was when [`Self::save`] wrote these bytes.
    ///
    /// # Errors
    /// If the bytes are not those of a plant of this version, whole and unaltered. Neither this
    /// function nor the resulting plant panics, whatever the bytes.
    pub fn load(bytes: &[u8]) -> Result<Self, StateError> {
        let mut from = FORMAT.read(bytes)?;
        let config: PlantConfig = from.value("config")?;
        let mut plant =
            Self::new(&config).map_err(|error| StateError::value("config", error.to_string()))?;
        from.part("plant", &mut plant)?;
        from.end()?;
        Ok(plant)
    }
}

impl State for ComparedPlant {
    fn save(&self, to: &mut Writer) {
        let Self { plant, copies } = self;
        to.part("plant", plant);
        let handles: Vec<u32> = copies.iter().map(|copy| copy.handle).collect();
        to.value("handles", &handles);
        for copy in copies {
            // An epoch is used in the step that makes it.
            let Copied { handle: _, plant, epoch: _, calm, settled } = copy;
            to.value("calm", calm);
            to.value("settled", settled);
            to.part("copy", plant);
        }
    }

    fn load(&mut self, from: &mut octant_state::StateReader<'_>) -> Result<(), StateError> {
        let fresh = self.plant.clone();
        from.part("plant", &mut self.plant)?;
        let handles: Vec<u32> = from.value("handles")?;
        if !handles.is_sorted_by(|a, b| a < b) {
            return Err(StateError::value("handles", "they are not in ascending order"));
        }
        for handle in handles {
            let mut copy = Copied::new(handle, fresh.clone());
            copy.calm = from.value("calm")?;
            check_count("calm", copy.calm)?;
            copy.settled = from.value("settled")?;
            from.part("copy", &mut copy.plant)?;
            if copy.plant.samples() != self.plant.samples() {
                let problem = format!(
                    "after {} samples, {} are expected",
                    copy.plant.samples(),
                    self.plant.samples()
                );
                return Err(StateError::value("copy", problem));
            }
            self.copies.push(copy);
        }
        Ok(())
    }
}
