//! State of a receiver as bytes: incomplete messages and counts.

use super::{CanTraffic, Reassembler, Slot};
use octant_state::{State, StateError, StateReader, Writer, check_below, check_count};

/// Counts in the order of writing.
fn counts(counters: &mut CanTraffic) -> [(&'static str, &mut u64); 11] {
    let CanTraffic {
        frames,
        foreign,
        messages,
        duplicated,
        missing,
        disordered,
        orphaned,
        incomplete,
        mixed,
        malformed,
        unreadable,
    } = counters;
    [
        ("frames", frames),
        ("foreign", foreign),
        ("messages", messages),
        ("duplicated", duplicated),
        ("missing", missing),
        ("disordered", disordered),
        ("orphaned", orphaned),
        ("incomplete", incomplete),
        ("mixed", mixed),
        ("malformed", malformed),
        ("unreadable", unreadable),
    ]
}

impl State for Reassembler {
    fn save(&self, to: &mut Writer) {
        for progress in &self.progress {
            to.value("held", &(progress.held as u8));
            to.value("dropped", &progress.dropped);
        }
        to.value("images", &self.images[..]);
        let mut counters = self.counters;
        for (name, count) in counts(&mut counters) {
            to.value(name, &*count);
        }
    }

    fn load(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        for (slot, progress) in Slot::ALL.iter().zip(&mut self.progress) {
            let held: u8 = from.value("held")?;
            check_below("held", held.into(), slot.segments(self.format) as u64)?;
            progress.held = held.into();
            progress.dropped = from.value("dropped")?;
        }
        let images: &[u8] = from.value("images")?;
        if images.len() != self.images.len() {
            return Err(StateError::value("images", "they have another length"));
        }
        self.images.copy_from_slice(images);
        for (name, count) in counts(&mut self.counters) {
            *count = from.value(name)?;
            check_count(name, *count)?;
        }
        Ok(())
    }
}
