//! The recorder's side in the run loop, which takes an epoch in a few nanoseconds.
//!
//! Epochs are collected in a block; a full block goes to the recorder's thread over a bounded queue,
//! and an empty one comes back. If only hashes are wanted, the loop computes them itself. Nothing is
//! allocated in steady state. When all blocks are in use the loop waits: in simulated time nothing is
//! dropped. The thread asks for an unfinished block from time to time ([`FLUSH_INTERVAL`]), so that a
//! slow run, too, is written to the file; checking for that costs the loop one relaxed load.

use super::block::Block;
use super::digest::{Digest, RecorderSummary};
use super::published::next_on_grid;
use super::trouble::{Disk, RecorderTrouble};
use super::writer::RecordingWriter;
use super::{EpochFrame, Event, Extra, FLUSH_INTERVAL, RecorderError, RecorderOptions};
use octant_sample::Epoch;
use octant_sample::{Mode, Output};
use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread::JoinHandle;

/// Takes epochs from the run loop.
///
/// If it is dropped without [`Recorder::finish`], it still writes the epochs that it has; errors are
/// then lost.
#[derive(Debug)]
pub struct Recorder {
    /// The block being filled.
    block: Block,
    epochs_per_block: usize,
    next_due_ns: u64,
    period_ns: u64,
    truth_due: bool,
    /// Mode of the last output; `None` before the first.
    mode: Option<Mode>,
    /// True if a file is written.
    writes: bool,
    revision: u32,
    parameters_due: bool,
    worker: Option<Worker>,
}

/// Place where full blocks are processed.
#[derive(Debug)]
enum Worker {
    /// The loop's own thread: computing only hashes is faster than handing a block over.
    Here(Box<Digest>),
    /// A separate thread, which also writes the file.
    Thread(Thread),
}

impl Worker {
    #[inline]
    fn wants_block(&self) -> bool {
        match self {
            Self::Here(_) => false,
            Self::Thread(thread) => thread.wanted.load(Ordering::Relaxed),
        }
    }
}

/// What goes to the recorder's thread.
#[allow(
    clippy::large_enum_variant,
    reason = "almost all are blocks, and a box would be an allocation for each"
)]
#[derive(Debug)]
enum ForThread {
    /// A full block.
    Block(Block),
    /// The wish for the hashes so far.
    Digest(SyncSender<Digest>),
}

#[derive(Debug)]
struct Thread {
    full: SyncSender<ForThread>,
    empty: Receiver<Block>,
    /// Set by the thread when it asks for the unfinished block.
    wanted: Arc<AtomicBool>,
    thread: JoinHandle<Result<RecorderSummary, RecorderError>>,
}

impl Recorder {
    /// Records into a new file.
    ///
    /// # Errors
    /// If the file exists or can't be written.
    pub fn to_file(path: &Path, options: &RecorderOptions) -> Result<Self, RecorderError> {
        let file = File::create_new(path)
            .map_err(|source| RecorderError::Create { path: path.display().to_string(), source })?;
        let kept = file
            .try_clone()
            .map_err(|source| RecorderError::Create { path: path.display().to_string(), source })?;
        let disk = Disk::new(file, options.trouble.clone());
        let writer = RecordingWriter::new(disk, options)?;
        Self::start(options, writer, Some(kept))
    }

    /// Records into any writer.
    ///
    /// # Errors
    /// If the first bytes can't be written.
    pub fn to_writer<W: Write + Send + 'static>(
        inner: W,
        options: &RecorderOptions,
    ) -> Result<Self, RecorderError> {
        Self::start(options, RecordingWriter::new(inner, options)?, None)
    }

    /// Computes the stream hash and those of altered streams, and writes no file.
    #[must_use]
    pub fn hash_only(options: &RecorderOptions) -> Self {
        Self::digesting(options, Digest::new())
    }

    /// Computes the stream hash only: those of altered streams cost as much again.
    #[must_use]
    pub fn stream_hash_only(options: &RecorderOptions) -> Self {
        Self::digesting(options, Digest { compares: false, ..Digest::new() })
    }

    fn digesting(options: &RecorderOptions, digest: Digest) -> Self {
        let mut recorder = Self::with_blocks(options);
        recorder.worker = Some(Worker::Here(Box::new(digest)));
        recorder
    }

    /// Records nothing, to measure a run's cost without a recorder.
    #[must_use]
    pub fn none() -> Self {
        Self {
            block: Block::default(),
            epochs_per_block: 0,
            next_due_ns: u64::MAX,
            period_ns: 1,
            truth_due: false,
            mode: None,
            writes: false,
            revision: 0,
            parameters_due: false,
            worker: None,
        }
    }

    /// Makes a second recorder that goes on from here on its own. It writes no file: of a recorder that
    /// writes one it has the hashes.
    ///
    /// # Errors
    /// If the recorder failed.
    pub fn branch(&mut self) -> Result<Self, RecorderError> {
        let digest = match &self.worker {
            None => None,
            Some(Worker::Here(digest)) => Some(digest.clone()),
            Some(Worker::Thread(_)) => Some(Box::new(self.digest()?)),
        };
        let worker = digest.map(Worker::Here);
        Ok(Self { block: self.block.clone(), worker, writes: false, ..*self })
    }

    /// Asks the recorder's thread for its hashes up to the unfinished block.
    fn digest(&mut self) -> Result<Digest, RecorderError> {
        let (back, digest) = sync_channel(1);
        if let Some(Worker::Thread(thread)) = &self.worker {
            // A thread that is gone drops the other end.
            let _ = thread.full.send(ForThread::Digest(back));
        }
        digest.recv().map_err(|_| self.failure())
    }

    /// Makes a recorder with an empty block, and without a worker for full ones.
    fn with_blocks(options: &RecorderOptions) -> Self {
        let mut recorder = Self::none();
        recorder.epochs_per_block = options.epochs_per_block.clamp(1, 1 << 20);
        recorder.block = Block::new(recorder.epochs_per_block);
        recorder.next_due_ns = 0;
        recorder.period_ns = options.policy.period_ns.max(1);
        recorder
    }

    fn start<W: Write + Send + 'static>(
        options: &RecorderOptions,
        writer: RecordingWriter<W>,
        sync: Option<File>,
    ) -> Result<Self, RecorderError> {
        let mut recorder = Self::with_blocks(options);
        let epochs_per_block = recorder.epochs_per_block;
        let blocks = options.blocks.clamp(2, 1024);
        let (full, full_receiver) = sync_channel(blocks);
        let (empty_sender, empty) = sync_channel(blocks);
        for _ in 1..blocks {
            // The queue has room for every block, so this never waits.
            let _ = empty_sender.send(Block::new(epochs_per_block));
        }
        let wanted = Arc::new(AtomicBool::new(false));
        let (wanted_here, trouble) = (Arc::clone(&wanted), options.trouble.clone());
        let thread = std::thread::Builder::new()
            .name("recorder".into())
            .spawn(move || {
                work(writer, sync, &full_receiver, &empty_sender, &wanted_here, &trouble)
            })
            .map_err(|error| RecorderError::Format {
                reason: format!("no thread for the recorder: {error}"),
            })?;
        recorder.worker = Some(Worker::Thread(Thread { full, empty, wanted, thread }));
        recorder.writes = true;
        Ok(recorder)
    }

    /// Takes one epoch.
    ///
    /// # Errors
    /// If the recorder failed (with the error of its thread), or the parameters announced by the frame
    /// before are missing.
    #[inline(always)]
    pub fn push(&mut self, frame: EpochFrame<'_>) -> Result<(), RecorderError> {
        let Some(worker) = &self.worker else { return Ok(()) };
        if self.parameters_due {
            return Err(RecorderError::ParametersMissing {
                sequence: frame.output.sequence,
                revision: self.revision,
            });
        }
        // The block is handed over before the frame and not after it, so that truth and parameters,
        // which follow their frame, are in the same block.
        if self.block.len() >= self.epochs_per_block || worker.wants_block() {
            self.hand_over()?;
        }
        let time_ns = frame.clean.sample.device_time.ns;
        let on_grid = time_ns >= self.next_due_ns;
        if on_grid {
            self.next_due_ns = next_on_grid(time_ns, self.period_ns);
        }
        // A change of mode marks the last parameters and the start of navigation.
        let due = on_grid || self.mode != Some(frame.output.mode);
        self.mode = Some(frame.output.mode);
        self.truth_due = due;
        if frame.output.parameters_revision != self.revision {
            self.revision = frame.output.parameters_revision;
            self.parameters_due = true;
        }
        match &mut self.worker {
            Some(Worker::Here(digest)) if !frame.is_altered() => {
                digest.take_up(&mut self.block);
                digest.epoch(&frame);
            }
            _ => self.block.push(&frame, due),
        }
        Ok(())
    }

    /// Takes an epoch of the source that didn't reach the core in its step: it was lost, or is late, or
    /// the unit was off.
    ///
    /// # Errors
    /// As [`Recorder::push`].
    pub fn lost(&mut self, clean: &Epoch) -> Result<(), RecorderError> {
        let time_ns = clean.sample.device_time.ns;
        self.make_room(clean.sample.sequence)?;
        let due = time_ns >= self.next_due_ns;
        if due {
            self.next_due_ns = next_on_grid(time_ns, self.period_ns);
        }
        self.truth_due = due;
        if self.worker.is_some() {
            self.block.lost(clean, due);
        }
        Ok(())
    }

    /// Takes an epoch that reached the core in a step of the source in which another one had: `step_ns`
    /// is the stamp of the source's epoch in that step.
    ///
    /// # Errors
    /// As [`Recorder::push`].
    pub fn added(
        &mut self,
        step_ns: u64,
        faulted: &Epoch,
        output: &Output,
    ) -> Result<(), RecorderError> {
        self.make_room(output.sequence)?;
        let due = self.mode != Some(output.mode);
        self.mode = Some(output.mode);
        self.truth_due = false;
        if output.parameters_revision != self.revision {
            self.revision = output.parameters_revision;
            self.parameters_due = self.worker.is_some();
        }
        if self.worker.is_some() {
            self.block.added(step_ns, faulted, output, due);
        }
        Ok(())
    }

    /// Checks that no parameters are missing, and hands over a full block.
    fn make_room(&mut self, sequence: u64) -> Result<(), RecorderError> {
        let Some(worker) = &self.worker else { return Ok(()) };
        if self.parameters_due {
            let revision = self.revision;
            return Err(RecorderError::ParametersMissing { sequence, revision });
        }
        if self.block.len() >= self.epochs_per_block || worker.wants_block() {
            self.hand_over()?;
        }
        Ok(())
    }

    /// True if truth at the last frame will be kept: ask the source for it.
    #[must_use]
    #[inline]
    pub fn truth_due(&self) -> bool {
        self.truth_due && self.writes
    }

    /// True if the last output announced new parameters, which have to come before the next frame.
    #[must_use]
    #[inline]
    pub fn parameters_due(&self) -> bool {
        self.parameters_due
    }

    /// Takes an addition to the last frame. Parameters that the frame didn't announce are not recorded.
    pub fn extra(&mut self, extra: &Extra) {
        if self.worker.is_none() {
            return;
        }
        // Hashes alone need neither.
        if !self.writes && matches!(extra, Extra::Innovation(_) | Extra::Covariance(_)) {
            return;
        }
        if let Extra::Parameters(estimate) = extra {
            if !self.parameters_due {
                return;
            }
            self.parameters_due = false;
            if let (Some(Worker::Here(digest)), true) = (&mut self.worker, self.block.is_empty()) {
                return digest.hash.parameters(estimate);
            }
        }
        self.block.extra(extra);
    }

    /// Takes an event at the time of the last frame.
    pub fn event(&mut self, event: Event) {
        if self.worker.is_some() {
            self.block.event(event);
        }
    }

    /// Hands over the unfinished block. Useful before a long wait.
    ///
    /// # Errors
    /// If the recorder failed.
    #[cold]
    pub fn hand_over(&mut self) -> Result<(), RecorderError> {
        let block = &mut self.block;
        let handed = match &mut self.worker {
            None => true,
            Some(Worker::Here(digest)) => {
                digest.take_up(block);
                true
            }
            Some(Worker::Thread(thread)) => {
                thread.wanted.store(false, Ordering::Relaxed);
                block.is_empty()
                    || thread.empty.recv().ok().is_some_and(|empty| {
                        let full = std::mem::replace(block, empty);
                        thread.full.send(ForThread::Block(full)).is_ok()
                    })
            }
        };
        if handed { Ok(()) } else { Err(self.failure()) }
    }

    /// Ends the recording.
    ///
    /// # Errors
    /// If the recording could not be written to its end.
    pub fn finish(mut self) -> Result<RecorderSummary, RecorderError> {
        if self.parameters_due {
            return Err(RecorderError::ParametersMissing {
                sequence: self.block.outputs.last().map_or(0, |output| output.sequence),
                revision: self.revision,
            });
        }
        self.hand_over()?;
        self.join()
    }

    /// Reason why the thread ended early.
    fn failure(&mut self) -> RecorderError {
        match self.join() {
            Err(error) => error,
            Ok(_) => RecorderError::Gone,
        }
    }

    fn join(&mut self) -> Result<RecorderSummary, RecorderError> {
        match self.worker.take() {
            None => Ok(RecorderSummary::default()),
            Some(Worker::Here(digest)) => Ok(digest.finish()),
            Some(Worker::Thread(Thread { full, empty, thread, .. })) => {
                drop((full, empty));
                thread.join().unwrap_or(Err(RecorderError::Gone))
            }
        }
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        // Errors can't be returned here; `finish` returns them.
        let _ = self.hand_over();
        let _ = self.join();
    }
}

/// Main function of the recorder's thread.
fn work<W: Write>(
    mut writer: RecordingWriter<W>,
    sync: Option<File>,
    full: &Receiver<ForThread>,
    empty: &SyncSender<Block>,
    wanted: &AtomicBool,
    trouble: &RecorderTrouble,
) -> Result<RecorderSummary, RecorderError> {
    let mut digest = Digest::new();
    let mut asked = std::time::Instant::now();
    loop {
        let received = full.recv_timeout(FLUSH_INTERVAL);
        trouble.stand_still();
        match received {
            Ok(ForThread::Digest(back)) => {
                // Whoever asked may be gone.
                let _ = back.send(digest.clone());
            }
            Ok(ForThread::Block(mut block)) => {
                digest.take(&block);
                writer.block(&block)?;
                block.clear();
                // The loop may already be gone; then nobody needs the block.
                let _ = empty.try_send(block);
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
        writer.flush_if_due()?;
        if asked.elapsed() >= FLUSH_INTERVAL {
            wanted.store(true, Ordering::Relaxed);
            asked = std::time::Instant::now();
        }
    }
    let mut summary = digest.finish();
    (summary.messages, summary.bytes) = writer.finish()?;
    if let Some(file) = sync {
        file.sync_all()
            .map_err(|source| RecorderError::Write { written_bytes: summary.bytes, source })?;
    }
    Ok(summary)
}
