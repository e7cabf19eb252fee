//! Datagrams sealed with a shared secret, which is in a file: who doesn't have it can neither begin a session nor enter one.
//!
//! Behind the frames of a datagram stand the sender's nonce, a counter and a tag, in all [`SEAL_LEN`] bytes:
//!
//! ```text
//! frames | nonce of the sender, 8 | counter, u64 | tag, 16
//! tag = the first 16 bytes of HMAC-SHA-256(secret, direction | nonce of the receiver | nonce of the sender | counter | frames)
//! ```
//!
//! The receiver's nonce is in no datagram to it, so that one that was sealed for an earlier session opens nothing later; the
//! counter takes care of repetitions within a session, as the sequence number of IPsec does (RFC 4303, 3.4.3). A device that gets a
//! datagram that it can't open answers with one without frames and with counter 0, from which the harness learns the nonce. It
//! is as long as the shortest datagram that asks for it, so that nobody is flooded by it.

use hmac::{Hmac, Mac};
use sha2::Sha256;
use std::fmt;
use std::hash::{BuildHasher, Hasher};

/// Bytes of a seal.
pub const SEAL_LEN: usize = 32;
/// Fewest bytes of a secret: as many as the tag has.
pub const SECRET_LEN_MIN: usize = 16;
const NONCE: usize = 8;
const COUNTER: usize = 8;
const TAG: usize = SEAL_LEN - NONCE - COUNTER;

/// Reads a secret: the bytes of a file, without the end of its last line.
///
/// # Errors
/// In words, if the file can't be read, can be read by others than its owner, or has too few bytes.
pub(super) fn secret_in(file: &str) -> Result<Vec<u8>, String> {
    let cant = |error: std::io::Error| format!("read the secret in {file}: {error}");
    let mut secret = std::fs::read(file).map_err(cant)?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = std::fs::metadata(file).map_err(cant)?.permissions().mode() & 0o777;
        if mode & 0o077 != 0 {
            return Err(format!(
                "the secret in {file} is open to other users, found mode {mode:03o}, expected 600"
            ));
        }
    }
    while matches!(secret.last(), Some(b'\n' | b'\r')) {
        secret.pop();
    }
    if secret.len() < SECRET_LEN_MIN {
        return Err(format!(
            "the secret in {file} has {} bytes, expected {SECRET_LEN_MIN} or more",
            secret.len()
        ));
    }
    Ok(secret)
}

/// Random bytes of an end.
pub type Nonce = [u8; NONCE];

/// Which end a port is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SealEnd {
    /// Talks to one device.
    Harness,
    /// Listens, and is bound by a session.
    Device,
}

impl SealEnd {
    /// First byte under the tag of what this end sends, so that nothing can be sent back to its sender.
    const fn direction(self) -> u8 {
        match self {
            Self::Harness => 1,
            Self::Device => 2,
        }
    }

    const fn other(self) -> Self {
        match self {
            Self::Harness => Self::Device,
            Self::Device => Self::Harness,
        }
    }
}

/// Outcome of opening a datagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OpenedSeal {
    /// Frames of the peer, this many bytes.
    Frames(usize),
    /// The peer told its nonce: what was sent last has to be sent again.
    Learnt,
    /// Not sealed for this end now, which the sender may learn of.
    Unknown,
    /// A repetition, or no seal at all.
    Dropped,
}

/// The other end, once its nonce is known.
#[derive(Clone, Copy, Debug)]
struct Peer {
    nonce: Nonce,
    /// Largest counter that came, and which of the 64 up to it did.
    largest: u64,
    came: u64,
}

impl Peer {
    /// True once for each counter.
    fn takes(&mut self, counter: u64) -> bool {
        if counter > self.largest {
            let ahead = counter - self.largest;
            self.came = if ahead < 64 { self.came << ahead | 1 } else { 1 };
            self.largest = counter;
            return true;
        }
        let behind = self.largest - counter;
        if behind >= 64 || self.came >> behind & 1 == 1 {
            return false;
        }
        self.came |= 1 << behind;
        true
    }
}

/// Seals what one end sends, and opens what it receives.
pub struct Seal {
    end: SealEnd,
    keyed: Hmac<Sha256>,
    /// Nonce of this end towards the peer.
    nonce: Nonce,
    /// Nonce of this end towards whoever comes next. At the harness end nobody does.
    next: Nonce,
    counter: u64,
    peer: Option<Peer>,
}

impl fmt::Debug for Seal {
    /// Without the secret.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Seal")
            .field("end", &self.end)
            .field("peer", &self.peer)
            .finish_non_exhaustive()
    }
}

/// A number that nobody can foresee: the hasher is keyed by random numbers of the system.
fn draw() -> Nonce {
    let mut hasher = std::collections::hash_map::RandomState::new().build_hasher();
    hasher.write_u32(std::process::id());
    hasher.finish().to_le_bytes()
}

impl Seal {
    /// Begins with nonces of its own, and without a peer. `None`: the secret has too few bytes.
    pub fn new(end: SealEnd, secret: &[u8]) -> Option<Self> {
        if secret.len() < SECRET_LEN_MIN {
            return None;
        }
        Self::with_nonces(end, secret, draw(), draw())
    }

    /// The same with nonces that are known, so that the bytes can be compared.
    pub fn with_nonces(end: SealEnd, secret: &[u8], nonce: Nonce, next: Nonce) -> Option<Self> {
        let keyed = Hmac::new_from_slice(secret).ok()?;
        Some(Self { end, keyed, nonce, next, counter: 0, peer: None })
    }

    fn tag(&self, from: SealEnd, to: &Nonce, sealed: &[u8]) -> Hmac<Sha256> {
        let (frames, rest) = sealed.split_at(sealed.len() - SEAL_LEN);
        let mut mac = self.keyed.clone();
        mac.update(&[from.direction()]);
        mac.update(to);
        mac.update(&rest[..NONCE + COUNTER]);
        mac.update(frames);
        mac
    }

    fn close(&self, to: &Nonce, from: &Nonce, counter: u64, datagram: &mut [u8]) {
        let at = datagram.len() - SEAL_LEN;
        datagram[at..at + NONCE].copy_from_slice(from);
        datagram[at + NONCE..at + NONCE + COUNTER].copy_from_slice(&counter.to_le_bytes());
        let tag = self.tag(self.end, to, datagram).finalize().into_bytes();
        datagram[at + NONCE + COUNTER..].copy_from_slice(&tag[..TAG]);
    }

    /// Seals a datagram, whose last [`SEAL_LEN`] bytes are room for the seal.
    pub fn seal(&mut self, datagram: &mut [u8]) {
        self.counter += 1;
        let to = self.peer.map_or([0; NONCE], |peer| peer.nonce);
        self.close(&to, &self.nonce, self.counter, datagram);
    }

    /// Answer to a datagram that couldn't be opened, by which its sender learns this end's nonce.
    pub fn challenge(&self, datagram: &[u8]) -> [u8; SEAL_LEN] {
        let mut answer = [0; SEAL_LEN];
        let at = datagram.len() - SEAL_LEN;
        let mut theirs = [0; NONCE];
        theirs.copy_from_slice(&datagram[at..at + NONCE]);
        self.close(&theirs, &self.next, 0, &mut answer);
        answer
    }

    fn is_sealed_for(&self, nonce: &Nonce, datagram: &[u8]) -> bool {
        let tag = self.tag(self.end.other(), nonce, datagram);
        tag.verify_truncated_left(&datagram[datagram.len() - TAG..]).is_ok()
    }

    /// Opens a datagram.
    pub fn open(&mut self, datagram: &[u8]) -> OpenedSeal {
        let Some(length) = datagram.len().checked_sub(SEAL_LEN) else { return OpenedSeal::Dropped };
        let (mut nonce, mut counter) = ([0; NONCE], [0; COUNTER]);
        nonce.copy_from_slice(&datagram[length..length + NONCE]);
        counter.copy_from_slice(&datagram[length + NONCE..length + NONCE + COUNTER]);
        let counter = u64::from_le_bytes(counter);
        match self.end {
            SealEnd::Harness => self.open_of_device(datagram, length, nonce, counter),
            SealEnd::Device => self.open_of_harness(datagram, length, nonce, counter),
        }
    }

    fn open_of_device(
        &mut self,
        all: &[u8],
        length: usize,
        nonce: Nonce,
        counter: u64,
    ) -> OpenedSeal {
        if !self.is_sealed_for(&self.nonce, all) {
            return OpenedSeal::Dropped;
        }
        if let Some(peer) = &mut self.peer
            && peer.nonce == nonce
        {
            let fresh = counter > 0 && length > 0 && peer.takes(counter);
            return if fresh { OpenedSeal::Frames(length) } else { OpenedSeal::Dropped };
        }
        if counter != 0 || length != 0 {
            return OpenedSeal::Dropped;
        }
        // The device is new, or started anew. What an earlier one said was sealed for the earlier nonce.
        self.peer = Some(Peer { nonce, largest: 0, came: 0 });
        self.nonce = draw();
        OpenedSeal::Learnt
    }

    fn open_of_harness(
        &mut self,
        all: &[u8],
        length: usize,
        nonce: Nonce,
        counter: u64,
    ) -> OpenedSeal {
        if counter == 0 || length == 0 {
            return OpenedSeal::Dropped;
        }
        if let Some(peer) = self.peer
            && peer.nonce == nonce
            && self.is_sealed_for(&self.nonce, all)
        {
            let fresh = self.peer.as_mut().is_some_and(|peer| peer.takes(counter));
            return if fresh { OpenedSeal::Frames(length) } else { OpenedSeal::Dropped };
        }
        if !self.is_sealed_for(&self.next, all) {
            return OpenedSeal::Unknown;
        }
        // The nonce that was told is used up: nothing that was ever sealed for it begins another session.
        self.nonce = std::mem::replace(&mut self.next, draw());
        self.counter = 0;
        let mut peer = Peer { nonce, largest: 0, came: 0 };
        peer.takes(counter);
        self.peer = Some(peer);
        OpenedSeal::Frames(length)
    }
}
