//! The station as bytes, and back.
//!
//! The bytes hold the changes since the start: of each fault its clock, its receipt and the state
//! of its rule. A station to be loaded is built from the same faults.

use super::{FaultSpec, OCCURRENCES_MAX, Occurrence, Stage, Station};
use crate::rule::UnitEvent;
use crate::setup::Setup;
use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use octant_state::{State, StateError, StateFormat, StateReader, Writer, check_below, check_count};

/// Format of the state of a station. Raise the version when the layout changes; a test compares the
/// layout with the stored one.
pub const FORMAT: StateFormat =
    StateFormat { magic: "OCTANTST", version: 2, what: "the state of a station of faults" };

impl Station {
    /// Appends everything that the station needs to continue bit for bit after this epoch: the same
    /// station gives the same bytes.
    pub fn save(&self, bytes: &mut Vec<u8>) {
        FORMAT.write(bytes, |to| to.part("station", self));
    }

    /// Makes a station that continues where another was when [`Self::save`] wrote these bytes;
    /// `specs` and `setup` are those with which that one was built.
    ///
    /// # Errors
    /// If the bytes are not those of a station of these faults and this version, whole and
    /// unaltered, or if the station can't be built. Neither this function nor the resulting station
    /// panics, whatever the bytes.
    pub fn load(specs: &[FaultSpec], setup: &Setup, bytes: &[u8]) -> Result<Self, StateError> {
        let mut from = FORMAT.read(bytes)?;
        let mut station = Self::new(specs, setup)
            .map_err(|(id, error)| StateError::value("faults", format!("{id:?}: {error}")))?;
        from.part("station", &mut station)?;
        from.end()?;
        Ok(station)
    }
}

impl Stage {
    /// Id and kind, which identify the stage.
    fn name(&self) -> (&str, &'static str) {
        (&self.id, self.kind.name)
    }
}

impl State for Station {
    fn save(&self, to: &mut Writer) {
        let Self {
            stages,
            dt_s: _,
            calibration_samples: _,
            epoch,
            // Follows from the other fields.
            wake: _,
            busy: _,
            compares: _,
            remember: _,
            seen,
            scene,
            conditions: _,
            truth: _,
            commands: _,
            set_points,
            last,
            // Filled and emptied within an epoch.
            undisturbed: _,
            flight: _,
            landed: _,
            burst: _,
            occurrences,
            events,
            without_power,
        } = self;
        to.value("epoch", epoch);
        to.value("seen", seen);
        to.value("scene", scene);
        to.value("set_points", set_points);
        to.value("last", last);
        to.value("occurrences", occurrences);
        to.value("events", events);
        to.value("without_power", without_power);
        for stage in stages {
            to.value("fault", &stage.name());
            let Stage { id: _, kind: _, rule, clock, ledger, fresh, compares, goes_on } = stage;
            to.value("fresh", fresh);
            to.value("plant", &(compares, goes_on));
            to.part("clock", clock);
            to.part("ledger", ledger);
            to.part("rule", rule);
        }
    }

    fn load(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        self.epoch = from.value("epoch")?;
        check_count("epoch", self.epoch)?;
        self.seen = from.value("seen")?;
        self.scene = from.value("scene")?;
        self.set_points = from.value("set_points")?;
        self.last = from.value("last")?;
        let occurrences: Vec<Occurrence> = from.value("occurrences")?;
        check_below("occurrences", occurrences.len() as u64, OCCURRENCES_MAX as u64)?;
        self.occurrences.extend(occurrences);
        let events: Vec<UnitEvent> = from.value("events")?;
        check_below("events", events.len() as u64, self.stages.len() as u64 + 1)?;
        self.events.extend(events);
        self.without_power = from.value("without_power")?;
        for stage in &mut self.stages {
            let (id, kind): (String, String) = from.value("fault")?;
            if (id.as_str(), kind.as_str()) != stage.name() {
                let (expected, of) = stage.name();
                let problem = format!("{id:?} ({kind}) was found, {expected:?} ({of}) is expected");
                return Err(StateError::value("fault", problem.to_string()));
            }
            stage.fresh = from.value("fresh")?;
            (stage.compares, stage.goes_on) = from.value("plant")?;
            from.part("clock", &mut stage.clock)?;
            stage.clock.check(self.epoch)?;
            from.part("ledger", &mut stage.ledger)?;
            from.part("rule", &mut stage.rule)?;
        }
        self.plan();
        Ok(())
    }
}
