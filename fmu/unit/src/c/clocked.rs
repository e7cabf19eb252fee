//! Clocks, and binary variables that have a value only at their ticks.
//!
//! A clock ticks when the importer sets it in event mode, and until the event ends. A binary input
//! is set while its clock ticks and passed to the model when the event ends; a binary output is
//! taken from the model while its clock ticks, when it is requested or at the latest when the event
//! ends, and is empty otherwise, so that nothing is passed on twice.

#![allow(unsafe_code, reason = "the importer's arrays are read and written")]

use super::instance::Instance;
use super::layout::ClockedBinary;
use super::mode::{self, Mode, Modes, Refusal};
use crate::table::Ticks;
use octant_fmi::fmi3::{
    Binary, Boolean, INTERVAL_CHANGED, INTERVAL_NOT_YET_KNOWN, INTERVAL_UNCHANGED,
};

/// Checks that an array of the importer is there if it has elements.
fn present<T>(count: usize, pointer: *const T, what: &str) -> Result<(), Refusal> {
    if count > 0 && pointer.is_null() {
        return Err(Refusal::error(format!("{what} are a null pointer")));
    }
    Ok(())
}

/// One element of an importer's array.
fn element<T: Copy>(array: *const T, i: usize) -> T {
    // SAFETY: `present` has seen that the array is there; the importer vouches for its length.
    unsafe { array.add(i).read_unaligned() }
}

/// Writes one element of an importer's array.
fn set_element<T>(array: *mut T, i: usize, value: T) {
    // SAFETY: as above.
    unsafe { array.add(i).write_unaligned(value) };
}

impl Instance {
    fn binary(&self, reference: u32) -> Result<(usize, ClockedBinary), Refusal> {
        let found = self.layout().binaries.iter().position(|binary| binary.slot == reference);
        let place = found.ok_or_else(|| self.no_such("Binary", reference))?;
        Ok((place, self.layout().binaries[place]))
    }

    fn clock(&self, reference: u32) -> Result<usize, Refusal> {
        let found = self.layout().clocks.iter().position(|clock| clock.slot == reference);
        found.ok_or_else(|| self.no_such("Clock", reference))
    }

    fn no_such(&self, kind: &str, reference: u32) -> Refusal {
        let of = self.model().name;
        Refusal::error(format!(
            "{of} has no variable of type {kind} with value reference {reference}"
        ))
    }

    fn name(&self, reference: u32) -> &'static str {
        self.model().label(reference as usize)
    }

    /// Checks the number of value references of one call.
    fn check_count(&self, count: usize, value_count: usize) -> Result<(), Refusal> {
        let most = self.slots().len();
        if count > most {
            return Err(Refusal::error(format!(
                "{count} value references are more than the model has"
            )));
        }
        if value_count != count {
            return Err(Refusal::error(format!(
                "{value_count} values were given, the variables have {count}"
            )));
        }
        Ok(())
    }

    pub(super) fn get_binaries(
        &mut self,
        references: *const u32,
        count: usize,
        sizes: *mut usize,
        values: *mut Binary,
        value_count: usize,
    ) -> Result<(), Refusal> {
        self.require(mode::get(self.standard()))?;
        present(count, references, "the value references")?;
        present(count.max(value_count), sizes, "the sizes")?;
        present(count.max(value_count), values, "the values")?;
        self.check_count(count, value_count)?;
        for i in 0..count {
            self.binary(element(references, i))?;
        }
        for i in 0..count {
            let (place, binary) = self.binary(element(references, i))?;
            self.take(place, &binary);
            let bytes = &self.run.clocked.binaries[place];
            set_element(sizes, i, bytes.len());
            set_element(values, i, bytes.as_ptr());
        }
        Ok(())
    }

    /// Takes an output from the model, once while its clock ticks.
    fn take(&mut self, place: usize, binary: &ClockedBinary) {
        let clocked = &self.run.clocked;
        if binary.is_input || !clocked.ticks(binary.clock) || clocked.taken & 1 << place != 0 {
            return;
        }
        let time_s = self.time_s();
        let run = &mut self.run;
        let network = run.component.as_mut().and_then(|component| component.network());
        if let Some(network) = network {
            run.clocked.binaries[place] = network.send(time_s, binary.max_bytes, &mut run.values);
            run.clocked.taken |= 1 << place;
        }
    }

    pub(super) fn set_binaries(
        &mut self,
        references: *const u32,
        count: usize,
        sizes: *const usize,
        values: *const Binary,
        value_count: usize,
    ) -> Result<(), Refusal> {
        self.require(mode::SET)?;
        present(count, references, "the value references")?;
        present(count.max(value_count), sizes, "the sizes")?;
        present(count.max(value_count), values, "the values")?;
        self.check_count(count, value_count)?;
        for i in 0..count {
            let reference = element(references, i);
            let (_, binary) = self.binary(reference)?;
            let name = self.name(reference);
            if !binary.is_input {
                return Err(Refusal::error(format!("{name} can't be set")));
            }
            let before = matches!(self.mode(), Mode::Instantiated | Mode::Initialization);
            let ticks = self.mode() == Mode::Event && self.run.clocked.ticks(binary.clock);
            if !(before || ticks) {
                let clock = self.name(self.layout().clocks[binary.clock].slot);
                return Err(Refusal::error(format!("{name} can't be set: {clock} doesn't tick")));
            }
            let size = element(sizes, i);
            if size > binary.max_bytes {
                return Err(Refusal::discard(format!(
                    "{name} can't have {size} bytes; it has at most {}",
                    binary.max_bytes
                )));
            }
            if size > 0 {
                present(1, element(values, i), "the bytes")?;
            }
        }
        for i in 0..count {
            let (place, _) = self.binary(element(references, i))?;
            let (size, from) = (element(sizes, i), element(values, i));
            let bytes = &mut self.run.clocked.binaries[place];
            bytes.clear();
            if size > 0 {
                // SAFETY: it isn't null, and the importer vouches for `size` bytes.
                bytes.extend_from_slice(unsafe { core::slice::from_raw_parts(from, size) });
            }
        }
        Ok(())
    }

    pub(super) fn get_clocks(
        &self,
        modes: Modes,
        references: *const u32,
        count: usize,
        values: *mut Boolean,
    ) -> Result<(), Refusal> {
        self.require(modes)?;
        present(count, references, "the value references")?;
        present(count, values, "the values")?;
        self.check_count(count, count)?;
        for i in 0..count {
            self.clock(element(references, i))?;
        }
        for i in 0..count {
            let clock = self.clock(element(references, i))?;
            set_element(values, i, self.run.clocked.ticks(clock).into());
        }
        Ok(())
    }

    pub(super) fn set_clocks(
        &mut self,
        modes: Modes,
        references: *const u32,
        count: usize,
        values: *const Boolean,
    ) -> Result<(), Refusal> {
        self.require(modes)?;
        present(count, references, "the value references")?;
        present(count, values, "the values")?;
        self.check_count(count, count)?;
        for i in 0..count {
            let reference = element(references, i);
            self.clock(reference)?;
            if self.mode() != Mode::Event {
                let name = self.name(reference);
                return Err(Refusal::error(format!("{name} ticks in event mode only")));
            }
            let value = element(values, i);
            if value > 1 {
                let name = self.name(reference);
                return Err(Refusal::discard(format!("{name} can't be {value}; it is 0 or 1")));
            }
        }
        for i in 0..count {
            let clock = self.clock(element(references, i))?;
            let bit = 1 << clock;
            if element(values, i) == 1 {
                self.run.clocked.ticking |= bit;
            } else {
                self.run.clocked.ticking &= !bit;
            }
        }
        Ok(())
    }

    /// Time at which the model wants to send.
    pub(super) fn due_s(&mut self) -> Option<f64> {
        let time_s = self.time_s();
        let component = self.run.component.as_mut()?;
        component.network()?.due_s(time_s)
    }

    pub(super) fn get_intervals(
        &mut self,
        modes: Modes,
        references: *const u32,
        count: usize,
        intervals: *mut f64,
        qualifiers: *mut i32,
    ) -> Result<(), Refusal> {
        self.require(modes)?;
        present(count, references, "the value references")?;
        present(count, intervals, "the intervals")?;
        present(count, qualifiers, "the qualifiers")?;
        self.check_count(count, count)?;
        for i in 0..count {
            let reference = element(references, i);
            if self.layout().clocks[self.clock(reference)?].ticks != Ticks::Countdown {
                let name = self.name(reference);
                return Err(Refusal::error(format!("{name} is triggered, it has no interval")));
            }
        }
        for i in 0..count {
            let (interval_s, qualifier) = self.interval();
            set_element(intervals, i, interval_s);
            set_element(qualifiers, i, qualifier);
        }
        Ok(())
    }

    /// Time until the next tick of the countdown clock, and whether it has changed since the last
    /// report.
    fn interval(&mut self) -> (f64, i32) {
        let due_s = self.due_s();
        let time_s = self.time_s();
        let clocked = &mut self.run.clocked;
        let Some(due_s) = due_s else {
            clocked.announced_s = None;
            return (0.0, INTERVAL_NOT_YET_KNOWN);
        };
        let qualifier =
            if clocked.announced_s == Some(due_s) { INTERVAL_UNCHANGED } else { INTERVAL_CHANGED };
        clocked.announced_s = Some(due_s);
        ((due_s - time_s).max(0.0), qualifier)
    }

    /// Ends an event: the model gets the data that came, and the clocks stop ticking.
    pub(super) fn end_ticks(&mut self) -> Result<(), Refusal> {
        if self.run.clocked.ticking == 0 {
            return Ok(());
        }
        let time_s = self.time_s();
        let layout = self.layout();
        let run = &mut self.run;
        let binaries = layout.binaries.iter().zip(&mut run.clocked.binaries);
        for (place, (binary, bytes)) in binaries.enumerate() {
            if run.clocked.ticking & 1 << binary.clock == 0 {
                continue;
            }
            let bytes = core::mem::take(bytes);
            let network = run.component.as_mut().and_then(|component| component.network());
            let Some(network) = network else { continue };
            if binary.is_input {
                network.receive(&bytes, time_s, &mut run.values);
            } else if run.clocked.taken & 1 << place == 0 {
                // Sent, although the importer didn't read it.
                network.send(time_s, binary.max_bytes, &mut run.values);
            }
        }
        let counts_down = |(place, clock): (usize, &super::layout::Clock)| {
            clock.ticks == Ticks::Countdown && run.clocked.ticking & 1 << place != 0
        };
        if layout.clocks.iter().enumerate().any(counts_down) {
            run.clocked.announced_s = None;
        }
        run.clocked.ticking = 0;
        run.clocked.taken = 0;
        self.remark();
        Ok(())
    }
}
