//! Stored states, and states as bytes.

use super::super::description::Description;
use super::InstanceError;
use super::unit::{RawState, Unit};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;

/// Beginning of a state as bytes, with the version of the format.
const MAGIC: &[u8; 8] = b"OCTFMU\x00\x01";

/// Length of the checksum, bytes.
const SUM: usize = 32;

/// States by number. The importer's own data is stored with each.
pub(crate) struct States<Own> {
    next: u64,
    kept: BTreeMap<u64, (RawState, Own)>,
}

// SAFETY: the pointers are handles that only the FMU looks behind, in calls that one thread makes
// after another.
#[allow(unsafe_code, reason = "handles of the FMU are pointers")]
unsafe impl<Own: Send> Send for States<Own> {}

impl<Own: Clone + Serialize + DeserializeOwned> States<Own> {
    pub(crate) fn new() -> Self {
        Self { next: 1, kept: BTreeMap::new() }
    }

    /// Stores the present state.
    pub(crate) fn keep(&mut self, unit: &mut impl Unit, own: Own) -> Result<u64, InstanceError> {
        let raw = unit.state()?;
        Ok(self.insert(raw, own))
    }

    /// Returns to a state; returns the data stored with it.
    pub(crate) fn restore(
        &mut self,
        unit: &mut impl Unit,
        state: u64,
    ) -> Result<Own, InstanceError> {
        let (raw, own) = self.find(unit, state)?;
        unit.set_state(raw)?;
        Ok(own)
    }

    /// Frees a state.
    pub(crate) fn forget(&mut self, unit: &mut impl Unit, state: u64) -> Result<(), InstanceError> {
        let (raw, _) = self.find(unit, state)?;
        self.kept.remove(&state);
        unit.free_state(raw)
    }

    /// Frees all states, as far as the FMU can be called.
    pub(crate) fn clear(&mut self, unit: &mut impl Unit) {
        for (_, (raw, _)) in std::mem::take(&mut self.kept) {
            if unit.free_state(raw).is_err() {
                return;
            }
        }
    }

    /// Converts a state to bytes: the FMU's own state, the data stored beside it, the identity of
    /// the FMU, and a checksum.
    pub(crate) fn save(
        &mut self,
        unit: &mut impl Unit,
        state: u64,
    ) -> Result<Vec<u8>, InstanceError> {
        let (raw, own) = self.find(unit, state)?;
        let theirs = unit.serialize(raw)?;
        let name = &unit.base().name;
        let body = (whose(&unit.base().description), own, theirs);
        let mut bytes = MAGIC.to_vec();
        bytes.resize(MAGIC.len() + SUM, 0);
        let mut bytes = postcard::to_extend(&body, bytes).map_err(|e| InstanceError::State {
            fmu: name.clone(),
            reason: format!("can't be written: {e}"),
        })?;
        let sum = blake3::hash(&bytes[MAGIC.len() + SUM..]);
        bytes[MAGIC.len()..MAGIC.len() + SUM].copy_from_slice(sum.as_bytes());
        Ok(bytes)
    }

    /// Reads a state from bytes. Only bytes that are whole and of this FMU are passed to it.
    pub(crate) fn load(
        &mut self,
        unit: &mut impl Unit,
        bytes: &[u8],
    ) -> Result<u64, InstanceError> {
        let none = |reason: &str| InstanceError::State {
            fmu: unit.base().name.clone(),
            reason: reason.into(),
        };
        let rest = bytes
            .strip_prefix(MAGIC)
            .ok_or_else(|| none("doesn't begin as a state of this version does"))?;
        let (sum, body) =
            rest.split_at_checked(SUM).ok_or_else(|| none("ends before its checksum"))?;
        if blake3::hash(body).as_bytes() != sum {
            return Err(none("is damaged: its checksum is another"));
        }
        let (whose_it_is, own, theirs): (String, Own, Vec<u8>) =
            postcard::from_bytes(body).map_err(|e| none(&format!("can't be read: {e}")))?;
        if whose_it_is != whose(&unit.base().description) {
            return Err(none(&format!("is of another FMU, {whose_it_is}")));
        }
        let raw = unit.deserialize(&theirs)?;
        Ok(self.insert(raw, own))
    }

    fn insert(&mut self, raw: RawState, own: Own) -> u64 {
        let state = self.next;
        self.next += 1;
        self.kept.insert(state, (raw, own));
        state
    }

    fn find(&self, unit: &impl Unit, state: u64) -> Result<(RawState, Own), InstanceError> {
        self.kept.get(&state).cloned().ok_or_else(|| InstanceError::State {
            fmu: unit.base().name.clone(),
            reason: format!("{state} isn't one that it keeps"),
        })
    }
}

/// Identity of the FMU for its states: the token changes with the FMU.
fn whose(description: &Description) -> String {
    format!("{} {}", description.model_name, description.token)
}
