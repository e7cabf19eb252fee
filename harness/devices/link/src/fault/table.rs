//! The faults of a wire and what each has altered.

use octant_faults::wire::{Altered, Way, WireAction, WireFault};
use std::time::{Duration, Instant};

/// One fault.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    handle: u32,
    pub(super) fault: WireFault,
    active: bool,
    /// Time at which it began.
    pub(super) since: Instant,
    /// Number of frames that it has seen in each direction.
    seen: [u64; 2],
    altered: u64,
    clean: crc32fast::Hasher,
    faulted: crc32fast::Hasher,
}

impl Entry {
    /// True if the fault acts now. A fault with a duration of its own may outlast the end of its
    /// window.
    pub(super) fn acts(&self, now: Instant) -> bool {
        match own_time(&self.fault.action) {
            Some(time) => now.saturating_duration_since(self.since) < time,
            None => self.active,
        }
    }

    /// If the fault acts on the next frame of a direction, the frame's number and its random numbers.
    pub(super) fn next(&mut self, way: Way) -> Option<(u64, [f64; 3])> {
        let nth = self.seen[way as usize];
        self.seen[way as usize] += 1;
        self.fault.acts_on(way, nth).map(|numbers| (nth, numbers))
    }

    /// Counts an altered frame and adds it, before and after, to the checksums.
    pub(super) fn altered<'a>(
        &mut self,
        clean: &[u8],
        faulted: impl IntoIterator<Item = &'a [u8]>,
    ) {
        self.altered += 1;
        self.clean.update(clean);
        faulted.into_iter().for_each(|bytes| self.faulted.update(bytes));
    }
}

/// Duration that an action has by itself.
fn own_time(action: &WireAction) -> Option<Duration> {
    let seconds = match *action {
        WireAction::Break { lasts_s } => lasts_s,
        WireAction::HangUp { away_s } => away_s,
        WireAction::SlowReader { pause_s } => pause_s,
        WireAction::BusOff { off_s } => off_s,
        _ => return None,
    };
    Some(Duration::from_secs_f64(seconds.clamp(0.0, 1e6)))
}

/// All faults of a wire.
#[derive(Clone, Debug, Default)]
pub(super) struct Table {
    entries: Vec<Entry>,
}

impl Table {
    pub(super) fn begin(&mut self, handle: u32, fault: &WireFault) {
        let since = Instant::now();
        match self.entries.iter_mut().find(|entry| entry.handle == handle) {
            Some(entry) => {
                (entry.fault, entry.active, entry.since) = (*fault, true, since);
                entry.seen = [0; 2];
            }
            None => {
                self.entries.push(Entry {
                    handle,
                    fault: *fault,
                    active: true,
                    since,
                    seen: [0; 2],
                    altered: 0,
                    clean: crc32fast::Hasher::new(),
                    faulted: crc32fast::Hasher::new(),
                });
                // Faults act in the order of the scenario.
                self.entries.sort_by_key(|entry| entry.handle);
            }
        }
    }

    pub(super) fn end(&mut self, handle: u32) {
        if let Some(entry) = self.entries.iter_mut().find(|entry| entry.handle == handle) {
            entry.active = false;
        }
    }

    pub(super) fn take(&mut self, handle: u32) -> Altered {
        match self.entries.iter_mut().find(|entry| entry.handle == handle) {
            Some(entry) => Altered {
                frames: std::mem::take(&mut entry.altered),
                clean_crc32: entry.clean.clone().finalize(),
                faulted_crc32: entry.faulted.clone().finalize(),
            },
            None => Altered::default(),
        }
    }

    /// Faults that act now.
    pub(super) fn acting(&mut self, now: Instant) -> impl Iterator<Item = &mut Entry> {
        self.entries.iter_mut().filter(move |entry| entry.acts(now))
    }

    /// First acting fault with a matching action, and the time that it still lasts.
    pub(super) fn lasting(
        &mut self,
        now: Instant,
        of: impl Fn(&WireAction) -> bool,
    ) -> Option<(&mut Entry, Duration)> {
        let entry = self.entries.iter_mut().find(|e| of(&e.fault.action) && e.acts(now))?;
        let lasted = now.saturating_duration_since(entry.since);
        let left = own_time(&entry.fault.action).unwrap_or_default().saturating_sub(lasted);
        Some((entry, left))
    }
}
