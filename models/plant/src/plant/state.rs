//! The plant as bytes, and back.
//!
//! The bytes hold the configuration and the changes since the start: time, gimbals, sensors and the
//! disturbances that faults have begun. Random numbers are made from the number of a sample and
//! need no state.

use super::Plant;
use crate::config::PlantConfig;
use octant_state::{State, StateError, StateFormat, StateReader, Writer, check_below, check_count};

/// Format of the state of a plant. Raise the version when the layout changes; a test compares the
/// layout with the stored one.
pub const FORMAT: StateFormat =
    StateFormat { magic: "OCTANTPL", version: 6, what: "the state of a plant" };

impl Plant {
    /// Appends everything that the plant needs to continue bit for bit after this step: the same
    /// plant gives the same bytes.
    pub fn save(&self, bytes: &mut Vec<u8>) {
        FORMAT.write(bytes, |to| {
            to.value("config", &self.config);
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

impl State for Plant {
    fn save(&self, to: &mut Writer) {
        let Self {
            config: _,
            sequence,
            // Time and number in the phase follow from the number of the sample.
            time_ns: _,
            in_phase: _,
            calibration_samples: _,
            body,
            sensors,
            encoders,
            encoder_noise: _,
            aider: _,
            until_aiding,
            non_orthogonality_rad: _,
            mounting: _,
            saturated_samples,
            increments,
            reading,
            is_still,
            angles,
            resting,
            flags,
        } = self;
        to.value("sequence", sequence);
        to.part("body", body);
        to.part("sensors", sensors);
        to.part("encoders", encoders);
        to.value("until_aiding", until_aiding);
        to.value("saturated_samples", saturated_samples);
        to.value("increments", increments);
        to.value("reading", reading);
        to.value("is_still", is_still);
        to.value("angles", angles);
        to.value("resting", resting);
        to.value("flags", flags);
    }

    fn load(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        self.sequence = from.value("sequence")?;
        let period_ns = self.body.period_ns();
        check_below("sequence", self.sequence, octant_state::COUNT_MAX / period_ns)?;
        self.time_ns = self.sequence * period_ns;
        self.in_phase = self.sequence;
        if let Some(navigated) = self.sequence.checked_sub(self.calibration_samples)
            && navigated > 0
        {
            self.in_phase = navigated;
            self.sensors.navigate();
            self.navigate_encoders();
        }
        from.part("body", &mut self.body)?;
        self.body.azimuth.check(self.time_ns)?;
        self.body.roll.check(self.time_ns)?;
        from.part("sensors", &mut self.sensors)?;
        self.sensors.check(self.time_ns)?;
        from.part("encoders", &mut self.encoders)?;
        self.until_aiding = from.value("until_aiding")?;
        check_below("until_aiding", self.until_aiding, self.aider.period_samples())?;
        if self.until_aiding == 0 {
            return Err(StateError::value("until_aiding", "0 was found, at least 1 is expected"));
        }
        self.saturated_samples = from.value("saturated_samples")?;
        check_count("saturated_samples", self.saturated_samples)?;
        self.increments = from.value("increments")?;
        self.reading = from.value("reading")?;
        self.is_still = from.value("is_still")?;
        self.angles = from.value("angles")?;
        self.resting = from.value("resting")?;
        self.flags = from.value("flags")?;
        Ok(())
    }
}
