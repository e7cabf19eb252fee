//! FMU states: stored, set, and as bytes.

#![allow(unsafe_code, reason = "states go to and come from the importer's memory")]

use super::call::put;
use super::instance::Instance;
use super::mode::{self, Mode, Refusal};
use super::run::{Experiment, Run};
use super::ticks::Clocked;
use crate::values::CellValues;
use core::ffi::c_void;
use octant_state::{StateError, StateFormat, check_count};

/// Format of an FMU state as bytes: token, mode, experiment, time, the cells of all variables, and
/// the bytes of the component if there is one.
const FORMAT: StateFormat =
    StateFormat { magic: "OCTFMUST", version: 1, what: "the state of an FMU" };

impl Instance {
    /// Stores the present state: as a new one if `name` points to a null pointer, else in place of
    /// the named one.
    pub(super) fn get_state(&mut self, name: *mut *mut c_void) -> Result<(), Refusal> {
        self.require(mode::ALIVE)?;
        let present = read(name)?;
        if present.is_null() {
            let run = self.run.clone();
            return put(name, self.snapshots.keep(run), "the FMU state");
        }
        let place = self.snapshots.place(present)?;
        *self.snapshots.kept[place].1 = self.run.clone();
        Ok(())
    }

    /// Continues from a stored state, which stays stored.
    pub(super) fn set_state(&mut self, name: *mut c_void) -> Result<(), Refusal> {
        self.require(mode::ALIVE)?;
        let place = self.snapshots.place(name)?;
        self.run = Run::clone(&self.snapshots.kept[place].1);
        Ok(())
    }

    /// Frees a stored state.
    pub(super) fn free_state(&mut self, name: *mut *mut c_void) -> Result<(), Refusal> {
        self.require(mode::ALIVE)?;
        // A null address or a null state: there is nothing to free.
        if name.is_null() || read(name)?.is_null() {
            return Ok(());
        }
        let place = self.snapshots.place(read(name)?)?;
        self.snapshots.kept.swap_remove(place);
        put(name, core::ptr::null_mut(), "the FMU state")
    }

    /// Converts a stored state to bytes.
    pub(super) fn state_bytes(&self, name: *mut c_void) -> Result<Vec<u8>, Refusal> {
        self.require(mode::ALIVE)?;
        let place = self.snapshots.place(name)?;
        Ok(self.to_bytes(&self.snapshots.kept[place].1))
    }

    /// Writes a stored state into the importer's memory.
    pub(super) fn serialize_state(
        &self,
        name: *mut c_void,
        to: *mut u8,
        size: usize,
    ) -> Result<(), Refusal> {
        let bytes = self.state_bytes(name)?;
        if to.is_null() {
            return Err(Refusal::error("the place for the bytes is a null pointer"));
        }
        if size < bytes.len() {
            let expected = bytes.len();
            return Err(Refusal::error(format!(
                "there is room for {size} bytes, the FMU state has {expected}"
            )));
        }
        // SAFETY: the importer vouches for `size` bytes, and these are no more.
        unsafe { to.copy_from_nonoverlapping(bytes.as_ptr(), bytes.len()) };
        Ok(())
    }

    /// Stores a state given as bytes.
    pub(super) fn deserialize_state(
        &mut self,
        from: *const u8,
        size: usize,
        name: *mut *mut c_void,
    ) -> Result<(), Refusal> {
        self.require(mode::ALIVE)?;
        if from.is_null() || name.is_null() {
            return Err(Refusal::error(
                "the bytes, or the place for the FMU state, is a null pointer",
            ));
        }
        if size > isize::MAX as usize {
            return Err(Refusal::error(format!("{size} bytes are more than there can be")));
        }
        // SAFETY: the importer vouches for `size` bytes.
        let bytes = unsafe { core::slice::from_raw_parts(from, size) };
        let run = self.run_from_bytes(bytes).map_err(|reason| {
            Refusal::error(format!("the bytes are no state of this FMU: {reason}"))
        })?;
        put(name, self.snapshots.keep(run), "the FMU state")
    }
}

fn read(name: *mut *mut c_void) -> Result<*mut c_void, Refusal> {
    if name.is_null() {
        return Err(Refusal::error("the place for the FMU state is a null pointer"));
    }
    // SAFETY: it isn't null, and the importer vouches for the rest.
    Ok(unsafe { name.read_unaligned() })
}

impl Instance {
    fn to_bytes(&self, run: &Run) -> Vec<u8> {
        let Experiment { announced, start_s, stop_s } = run.experiment;
        let component = run.component.as_ref().map(|component| {
            let mut bytes = Vec::new();
            component.save(&mut bytes);
            bytes
        });
        let mut bytes = Vec::new();
        FORMAT.write(&mut bytes, |to| {
            to.value("token", self.maker().token(self.standard()));
            to.value("mode", &(run.mode as u8));
            to.value("experiment", &(announced, start_s, stop_s));
            to.value("stale", &run.stale);
            to.value("tick", &run.tick);
            to.value("cells", run.values.cells());
            to.value("component", &component);
            // Models without clocks keep their earlier format.
            if self.model().needs_clocks() {
                to.part("clocked", &run.clocked);
            }
        });
        bytes
    }

    fn run_from_bytes(&self, bytes: &[u8]) -> Result<Run, String> {
        let mut from = FORMAT.read(bytes).map_err(said)?;
        let token: &str = from.value("token").map_err(said)?;
        if token != self.maker().token(self.standard()) {
            return Err(format!("they are of another model or standard, with the token {token}"));
        }
        let mode: u8 = from.value("mode").map_err(said)?;
        let mode = Mode::ALL.into_iter().find(|known| *known as u8 == mode);
        let mode = match mode {
            // An instance within a step is never stored, nor a dead one.
            None | Some(Mode::IntermediateUpdate | Mode::Fatal) => {
                return Err("they are of no mode that can be kept".to_owned());
            }
            Some(Mode::Event) if !self.options.event_mode_used => Mode::Step,
            Some(mode) => mode,
        };
        let (announced, start_s, stop_s) = from.value("experiment").map_err(said)?;
        let experiment = Experiment { announced, start_s, stop_s };
        let stale = from.value("stale").map_err(said)?;
        let tick: u64 = from.value("tick").map_err(said)?;
        check_count("tick", tick).map_err(said)?;
        let cells: Vec<u64> = from.value("cells").map_err(said)?;
        let component: Option<Vec<u8>> = from.value("component").map_err(said)?;
        let mut clocked = Clocked::new(self.layout());
        if self.model().needs_clocks() {
            from.part("clocked", &mut clocked).map_err(said)?;
            clocked.check(self.layout())?;
        }
        from.end().map_err(said)?;

        let mut values = CellValues::new(self.model());
        if cells.len() != values.cells().len() {
            let (found, expected) = (cells.len(), values.cells().len());
            return Err(format!("they have {found} values, the model has {expected}"));
        }
        values.cells_mut().copy_from_slice(&cells);
        let component = component
            .map(|bytes| (self.maker().load)(&bytes, &values))
            .transpose()
            .map_err(|reason| format!("its component: {reason}"))?;
        if component.is_none() && matches!(mode, Mode::Step | Mode::Event) {
            return Err("there is no component in them".to_owned());
        }
        Ok(Run { mode, experiment, values, component, stale, tick, clocked })
    }
}

fn said(error: StateError) -> String {
    error.to_string()
}
