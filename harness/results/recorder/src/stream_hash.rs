//! The stream hash, which tells whether two runs were the same.
//!
//! BLAKE3 over the canonical bytes ([`octant_sample::canonical`]) of the core's input and output, epoch
//! by epoch: the faulted sample, the aiding if there was any, the output, and the parameters with their
//! σ when the output's revision changed. It is computed at full rate, before any decimation, and
//! contains no host time: recording policy, block size and realisation don't change it.

use octant_sample::canonical::{
    self, AIDING_BYTES, OUTPUT_BYTES, PARAMETERS_BYTES, PLAIN_BYTES, SAMPLE_BYTES,
};
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{Aiding, Output, Sample};

/// Number of bytes gathered before the hash function is called: BLAKE3 is several times faster on
/// pieces of many kilobytes (it hashes up to sixteen blocks of 1 KiB in parallel) than on the 50 bytes
/// of a sample. It is a power of two, and each piece has exactly this size: so a piece is a whole
/// subtree of its own.
const PIECE_BYTES: usize = 64 * 1024;
/// Room for bytes that reach into the next piece.
const GATHER_BYTES: usize = PIECE_BYTES + 1024;

/// Hash of a stream so far.
#[derive(Clone, Debug)]
pub struct StreamHash {
    hasher: blake3::Hasher,
    /// [`GATHER_BYTES`], of which the first `filled` are to be hashed: bytes are written where they are hashed.
    gathered: Vec<u8>,
    filled: usize,
}

impl Default for StreamHash {
    fn default() -> Self {
        Self::new()
    }
}

impl StreamHash {
    /// Makes the hash of an empty stream.
    #[must_use]
    pub fn new() -> Self {
        Self { hasher: blake3::Hasher::new(), gathered: vec![0; GATHER_BYTES], filled: 0 }
    }

    /// Adds one epoch: the core's input and its output.
    #[inline]
    pub fn epoch(&mut self, sample: &Sample, aiding: Option<&Aiding>, output: &Output) {
        match aiding {
            None => self.plain(sample, output),
            Some(_) => {
                self.input(sample, aiding);
                self.put::<OUTPUT_BYTES>(|bytes| canonical::output(output, bytes));
            }
        }
    }

    /// Adds one epoch without aiding.
    #[inline]
    pub(super) fn plain(&mut self, sample: &Sample, output: &Output) {
        self.put::<PLAIN_BYTES>(|bytes| canonical::sample_and_output(sample, output, bytes));
    }

    /// Adds only a sample and its aiding.
    #[inline]
    pub(super) fn input(&mut self, sample: &Sample, aiding: Option<&Aiding>) {
        self.put::<SAMPLE_BYTES>(|bytes| canonical::sample(sample, bytes));
        if let Some(aiding) = aiding {
            self.put::<AIDING_BYTES>(|bytes| canonical::aiding(aiding, bytes));
        }
    }

    /// Adds the parameters that changed with the last epoch.
    pub fn parameters(&mut self, estimate: &ParameterEstimate) {
        self.put::<PARAMETERS_BYTES>(|bytes| {
            canonical::parameters(&estimate.parameters, &estimate.sigma, bytes);
        });
    }

    /// Hash of everything added, 64 hexadecimal digits.
    #[must_use]
    pub fn hex(&mut self) -> String {
        self.hasher.update(&self.gathered[..self.filled]);
        self.filled = 0;
        self.hasher.finalize().to_hex().to_string()
    }

    #[inline]
    fn put<const N: usize>(&mut self, write: impl FnOnce(&mut [u8; N])) {
        const { assert!(N <= GATHER_BYTES - PIECE_BYTES) }
        // Always so: what is filled never exceeds a piece, and the room behind it is larger than N.
        let rest = self.gathered.get_mut(self.filled..);
        if let Some(bytes) = rest.and_then(<[u8]>::first_chunk_mut) {
            write(bytes);
            self.filled += N;
        }
        if self.filled >= PIECE_BYTES {
            self.hash_piece();
        }
    }

    #[inline(never)]
    fn hash_piece(&mut self) {
        self.hasher.update(&self.gathered[..PIECE_BYTES]);
        self.gathered.copy_within(PIECE_BYTES..self.filled, 0);
        self.filled -= PIECE_BYTES;
    }
}
