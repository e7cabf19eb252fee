//! Memory of both processes, for exchanges. It consists of atomic numbers: anything that the other
//! process writes there, at any time, is a valid number.
#![allow(unsafe_code, reason = "memory is mapped")]

use rustix::fs::{MemfdFlags, SealFlags};
use rustix::mm::{MapFlags, ProtFlags};
use std::io;
use std::ops::Deref;
use std::os::fd::{AsFd, OwnedFd};
use std::ptr::{self, NonNull};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Number of words before the numbers. The words that one side writes have their own cache lines.
const HEAD: usize = 32;

/// Magic in the first word.
const MAGIC: u64 = u64::from_le_bytes(*b"octant1\0");

/// Smallest and largest capacity in each direction, numbers.
const NUMBERS_MIN: usize = 1 << 10;
const NUMBERS_MAX: usize = 1 << 20;

/// Mapped memory.
pub(super) struct Shared {
    words: NonNull<AtomicU64>,
    count: usize,
}

// SAFETY: it is atomic numbers, mapped for as long as this lives.
unsafe impl Send for Shared {}
// SAFETY: as above.
unsafe impl Sync for Shared {}

/// Words of the head.
#[derive(Clone, Copy)]
pub(super) enum Word {
    Magic = 0,
    // Written by the parent.
    Request = 8,
    Plan,
    Time,
    Step,
    ParentSleeps,
    // Written by the child.
    Answer = 16,
    Outcome,
    Reached,
    ChildSleeps,
    MessagesWait,
    // Written by the child at every call.
    Function = 24,
    // Written by the guard at the end.
    Status,
    // Written by the child at its start.
    Process,
}

impl Shared {
    /// Allocates memory for a number of numbers in each direction, and its file. The size is
    /// sealed: a change would end this process.
    pub(super) fn create(numbers: usize) -> io::Result<(Self, OwnedFd)> {
        let numbers = numbers.clamp(NUMBERS_MIN, NUMBERS_MAX);
        let count = HEAD + 2 * numbers;
        let file = rustix::fs::memfd_create(
            "octant-fmu",
            MemfdFlags::CLOEXEC | MemfdFlags::ALLOW_SEALING,
        )?;
        rustix::fs::ftruncate(&file, 8 * count as u64)?;
        rustix::fs::fcntl_add_seals(&file, SealFlags::SHRINK | SealFlags::GROW | SealFlags::SEAL)?;
        let shared = Self::map(&file, count)?;
        shared.word(Word::Magic).store(MAGIC, Ordering::Relaxed);
        Ok((shared, file))
    }

    /// Maps a file that [`Self::create`] made.
    pub(super) fn open(file: impl AsFd) -> io::Result<Self> {
        let bytes = rustix::fs::fstat(&file)?.st_size;
        let count = usize::try_from(bytes).unwrap_or(0) / 8;
        if !(HEAD..=HEAD + 2 * NUMBERS_MAX).contains(&count) {
            return Err(io::Error::other("it has another size"));
        }
        let shared = Self::map(file, count)?;
        if shared.word(Word::Magic).load(Ordering::Relaxed) != MAGIC {
            return Err(io::Error::other("it has another content"));
        }
        Ok(shared)
    }

    fn map(file: impl AsFd, count: usize) -> io::Result<Self> {
        // SAFETY: the kernel chooses the place, so it is nobody's; the file is as long as that.
        let address = unsafe {
            rustix::mm::mmap(
                ptr::null_mut(),
                8 * count,
                ProtFlags::READ | ProtFlags::WRITE,
                MapFlags::SHARED,
                file,
                0,
            )?
        };
        let words = NonNull::new(address.cast()).ok_or_else(|| io::Error::other("at null"))?;
        Ok(Self { words, count })
    }

    pub(super) fn word(&self, word: Word) -> &AtomicU64 {
        &self[word as usize]
    }

    /// Numbers on their way to the FMU.
    pub(super) fn inputs(&self) -> &[AtomicU64] {
        let numbers = self[HEAD..].len() / 2;
        &self[HEAD..HEAD + numbers]
    }

    /// Numbers on their way from the FMU.
    pub(super) fn outputs(&self) -> &[AtomicU64] {
        let numbers = self[HEAD..].len() / 2;
        &self[HEAD + numbers..HEAD + 2 * numbers]
    }
}

impl Deref for Shared {
    type Target = [AtomicU64];

    fn deref(&self) -> &[AtomicU64] {
        // SAFETY: so many words are mapped, aligned to a page, and zero when they are made.
        unsafe { std::slice::from_raw_parts(self.words.as_ptr(), self.count) }
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        // SAFETY: it was mapped with this length, and nothing borrows it any more.
        let _ = unsafe { rustix::mm::munmap(self.words.as_ptr().cast(), 8 * self.count) };
    }
}

/// Writes numbers.
pub(super) fn put(to: &[AtomicU64], numbers: &[f64]) {
    for (word, number) in to.iter().zip(numbers) {
        word.store(number.to_bits(), Ordering::Relaxed);
    }
}

/// Reads numbers.
pub(super) fn take(from: &[AtomicU64], numbers: &mut [f64]) {
    for (word, number) in from.iter().zip(numbers) {
        *number = f64::from_bits(word.load(Ordering::Relaxed));
    }
}

/// Polls a word for as long as polling is cheaper than sleeping.
///
/// If the other side has no processor on which to answer, polling only keeps it from getting one:
/// each failed poll halves the next, down to none, and one poll in [`TRY_AGAIN`] tests whether that
/// has changed.
pub(super) struct Spin {
    patience: Duration,
    since_in_vain: u32,
}

impl Spin {
    pub(super) fn new() -> Self {
        Self { patience: if *SPINS { SPIN } else { Duration::ZERO }, since_in_vain: 0 }
    }

    /// Polls a word until it isn't `old`; returns false if it still was at the end of the time.
    pub(super) fn until_changed(&mut self, word: &AtomicU64, old: u64) -> bool {
        if self.patience < SPIN && *SPINS {
            self.since_in_vain += 1;
            if self.since_in_vain == TRY_AGAIN {
                self.since_in_vain = 0;
                self.patience = SPIN;
            }
        }
        let changed = changes_within(word, old, self.patience);
        self.patience = match changed {
            true if self.patience > Duration::ZERO => SPIN,
            true => Duration::ZERO,
            false if self.patience > SPIN / 16 => self.patience / 2,
            false => Duration::ZERO,
        };
        changed
    }
}

fn changes_within(word: &AtomicU64, old: u64, patience: Duration) -> bool {
    if patience.is_zero() {
        return word.load(Ordering::Acquire) != old;
    }
    let mut until = None;
    loop {
        for _ in 0..64 {
            if word.load(Ordering::Acquire) != old {
                return true;
            }
            std::hint::spin_loop();
        }
        let now = Instant::now();
        match until {
            None => until = Some(now + patience),
            Some(until) if now >= until => return false,
            Some(_) => {}
        }
    }
}

/// Longest time for which a side polls before it sleeps: a multiple of the cost of sleeping and
/// waking.
const SPIN: Duration = Duration::from_micros(50);

/// Number of exchanges without polling before the next attempt.
const TRY_AGAIN: u32 = 64;

/// With one processor nothing can change while one side polls.
static SPINS: std::sync::LazyLock<bool> = std::sync::LazyLock::new(|| {
    std::thread::available_parallelism().is_ok_and(|processors| processors.get() > 1)
});
