//! Instances by handle.
//!
//! The importer holds a number in the form of a pointer: the place of the instance and the
//! generation of that place. It is looked up, never dereferenced, so that a null, foreign or freed
//! handle gives an answer and not a crash. The look-up is two atomic operations; places are
//! allocated and returned under a lock, only at instantiation and at its end.

#![allow(unsafe_code, reason = "an instance is reached by whoever holds its place's mark")]

use core::cell::UnsafeCell;
use core::ffi::c_void;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

/// Bits of a handle that name the place; the rest are its generation.
pub(super) const PLACE_BITS: u32 = 16;
/// Places of the first row; every further row has twice as many.
const FIRST_ROW: usize = 64;
const ROWS: usize = 10;
/// Largest number of instances at a time.
pub(super) const INSTANCES_MAX: usize = FIRST_ROW * ((1 << ROWS) - 1);
/// Largest generation of a place: after one more, a handle of the first would be valid again.
const GENERATION_MAX: usize = usize::MAX >> PLACE_BITS;

const EMPTY: usize = 0;
const IDLE: usize = 1;
const BUSY: usize = 2;
/// Bits of a place's mark for its state; the generation is above.
const STATE_BITS: u32 = 2;

const fn mark(generation: usize, state: usize) -> usize {
    generation << STATE_BITS | state
}

struct Place<T> {
    mark: AtomicUsize,
    instance: UnsafeCell<Option<Box<T>>>,
}

// SAFETY: the instance of a place is touched by the one thread that has set its mark to busy, or
// that holds it as an empty place under the lock.
unsafe impl<T: Send> Sync for Place<T> {}

/// Reason why a handle has no instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoInstance {
    /// The handle is null or foreign, or its instance has been freed.
    Unknown,
    /// Another call is in the instance: of another thread, or the one that waits for the present
    /// callback.
    InUse,
}

/// Instances of all models.
pub(super) struct Registry<T> {
    rows: [OnceLock<Box<[Place<T>]>>; ROWS],
    /// Places that are empty again, with their generation, and the number of places ever used.
    spare: Mutex<(Vec<(usize, usize)>, usize)>,
}

impl<T> Registry<T> {
    pub(super) const fn new() -> Self {
        Self { rows: [const { OnceLock::new() }; ROWS], spare: Mutex::new((Vec::new(), 0)) }
    }

    /// Row of a place, and its column in the row.
    #[inline]
    const fn coordinates(place: usize) -> (usize, usize) {
        let shifted = place + FIRST_ROW;
        let row = (shifted / FIRST_ROW).ilog2() as usize;
        (row, shifted - (FIRST_ROW << row))
    }

    #[inline]
    fn place(&self, place: usize) -> Option<&Place<T>> {
        let (row, column) = Self::coordinates(place);
        self.rows.get(row)?.get()?.get(column)
    }

    /// Registers a new instance and returns its handle; `None`: there are too many.
    pub(super) fn insert(&self, instance: Box<T>) -> Option<*mut c_void> {
        let mut spare = self.spare.lock().unwrap_or_else(PoisonError::into_inner);
        let (place, generation) = match spare.0.pop() {
            Some(known) => known,
            None if spare.1 < INSTANCES_MAX => {
                spare.1 += 1;
                (spare.1 - 1, 1)
            }
            None => return None,
        };
        let (row, column) = Self::coordinates(place);
        let places = self.rows[row].get_or_init(|| {
            let empty = || Place {
                mark: AtomicUsize::new(mark(0, EMPTY)),
                instance: UnsafeCell::new(None),
            };
            core::iter::repeat_with(empty).take(FIRST_ROW << row).collect()
        });
        let found = &places[column];
        // SAFETY: the place is empty and was taken out of the spare ones under the lock: nobody else
        // has it, and no handle of its generation exists yet.
        unsafe { *found.instance.get() = Some(instance) };
        found.mark.store(mark(generation, IDLE), Ordering::Release);
        Some(core::ptr::without_provenance_mut(generation << PLACE_BITS | place))
    }

    /// Executes work on an instance, exclusively.
    #[inline]
    pub(super) fn with<R>(
        &self,
        handle: *mut c_void,
        work: impl FnOnce(&mut T) -> R,
    ) -> Result<R, NoInstance> {
        let held = self.hold(handle)?;
        // SAFETY: the mark is ours until `held` is dropped.
        let instance = unsafe { &mut *held.place.instance.get() };
        instance.as_deref_mut().map(work).ok_or(NoInstance::Unknown)
    }

    /// Removes an instance; its handle is invalid afterwards.
    pub(super) fn remove(&self, handle: *mut c_void) -> Result<Box<T>, NoInstance> {
        let held = self.hold(handle)?;
        let place = held.place;
        // From here on the place is empty and belongs to the next generation.
        core::mem::forget(held);
        // SAFETY: the mark was ours, and stays so until it is stored below.
        let instance = unsafe { (*place.instance.get()).take() };
        let generation = handle.addr() >> PLACE_BITS;
        place.mark.store(mark(generation, EMPTY), Ordering::Release);
        if generation < GENERATION_MAX {
            let mut spare = self.spare.lock().unwrap_or_else(PoisonError::into_inner);
            spare.0.push((handle.addr() & ((1 << PLACE_BITS) - 1), generation + 1));
        }
        instance.ok_or(NoInstance::Unknown)
    }

    #[inline]
    fn hold(&self, handle: *mut c_void) -> Result<Held<'_, T>, NoInstance> {
        let (place, generation) =
            (handle.addr() & ((1 << PLACE_BITS) - 1), handle.addr() >> PLACE_BITS);
        let place = self.place(place).ok_or(NoInstance::Unknown)?;
        // The mark of an unused place is 0, which no handle gives.
        let (idle, busy) = (mark(generation, IDLE), mark(generation, BUSY));
        match place.mark.compare_exchange(idle, busy, Ordering::Acquire, Ordering::Relaxed) {
            Ok(_) => Ok(Held { place, idle }),
            Err(found) if found == busy => Err(NoInstance::InUse),
            Err(_) => Err(NoInstance::Unknown),
        }
    }
}

/// A place marked as busy until this is dropped.
struct Held<'a, T> {
    place: &'a Place<T>,
    idle: usize,
}

impl<T> Drop for Held<'_, T> {
    #[inline]
    fn drop(&mut self) {
        self.place.mark.store(self.idle, Ordering::Release);
    }
}
