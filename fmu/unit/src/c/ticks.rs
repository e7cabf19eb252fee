//! Clocks that tick, and the values of binary variables.

use super::layout::Layout;
use octant_state::{State, StateError, StateReader, Writer};

/// Clocks and binary variables of a run.
#[derive(Clone, Debug, Default)]
pub(super) struct Clocked {
    /// Clocks that tick now, a bit each.
    pub(super) ticking: u32,
    /// Values of the binary variables.
    pub(super) binaries: Vec<Vec<u8>>,
    /// Outputs taken from the model in this event, a bit each.
    pub(super) taken: u32,
    /// Time at which the countdown clock is to tick, as last reported to the importer.
    pub(super) announced_s: Option<f64>,
}

impl Clocked {
    pub(super) fn new(layout: &Layout) -> Self {
        Self { binaries: vec![Vec::new(); layout.binaries.len()], ..Self::default() }
    }

    /// Checks that the state can be that of a model.
    pub(super) fn check(&self, layout: &Layout) -> Result<(), String> {
        let fits = self.binaries.len() == layout.binaries.len()
            && self.binaries.iter().zip(&layout.binaries).all(|(v, of)| v.len() <= of.max_bytes)
            && self.ticking < 1 << layout.clocks.len()
            && self.taken < 1 << layout.binaries.len();
        if fits {
            Ok(())
        } else {
            Err("clocks or binary variables are not those of the model".into())
        }
    }

    pub(super) fn ticks(&self, clock: usize) -> bool {
        self.ticking & 1 << clock != 0
    }
}

impl State for Clocked {
    fn save(&self, to: &mut Writer) {
        to.value("ticking", &self.ticking);
        to.value("binaries", &self.binaries);
        to.value("taken", &self.taken);
        to.value("announced", &self.announced_s);
    }

    fn load(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        self.ticking = from.value("ticking")?;
        self.binaries = from.value("binaries")?;
        self.taken = from.value("taken")?;
        self.announced_s = from.value("announced")?;
        Ok(())
    }
}
