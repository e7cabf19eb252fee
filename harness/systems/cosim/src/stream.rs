//! Hash of a system's stream: the recorded inputs, outputs and parameters of its FMUs at every
//! communication point.

use super::simulation::Simulation;
use super::system::System;
use super::tuning::Tuning;
use octant_fmu_bind::settings::Starts;
use octant_fmu_host::description::Description;
use std::collections::BTreeMap;

/// BLAKE3 over a head and every communication point. All numbers are little-endian, texts and bytes
/// stand after their length (u64).
///
/// The head has start and step, s (f64); then, for each FMU in the order of the structure, its name,
/// and the values of its parameters and inputs before the initialization: name of the type, value
/// reference (u32), the values as bytes.
///
/// A point has its number (u64); the values that every connected input got at the beginning of the
/// step to it, in the order of the connections (none at point 0); the numbers of every output of each
/// FMU, the connected ones first, each as the 64 bits of its float64, or of a whole number of 64 bits;
/// the outputs that are texts, and bytes as hexadecimal digits; and the parameters that got another value
/// at the beginning of the step, in the form of the head.
#[derive(Debug)]
pub struct SystemHash {
    hasher: blake3::Hasher,
    bytes: Vec<u8>,
    /// Values that are set in each FMU.
    present: Vec<Values>,
    /// Number of changes of parameters so far.
    tuned: usize,
}

/// Values as bytes, by type and value reference.
type Values = BTreeMap<(&'static str, u32), Vec<u8>>;

/// Number of bytes gathered before the hash function is called, which is faster on large blocks.
const GATHER_BYTES: usize = 128 * 1024;

impl SystemHash {
    /// Begins with the head of a run.
    #[must_use]
    pub fn new(
        system: &System,
        descriptions: &[&Description],
        starts: &[Starts],
        (start_s, step_s): (f64, f64),
    ) -> Self {
        let mut hash = Self {
            hasher: blake3::Hasher::new(),
            bytes: Vec::new(),
            present: Vec::new(),
            tuned: 0,
        };
        hash.number(start_s);
        hash.number(step_s);
        for ((node, description), starts) in system.nodes.iter().zip(descriptions).zip(starts) {
            hash.put(node.name.as_bytes());
            let values = starts.effective(description);
            hash.values(&values);
            hash.present.push(values);
        }
        hash
    }

    /// Adds a communication point.
    pub fn add(&mut self, simulation: &Simulation<'_>, descriptions: &[&Description]) {
        self.bytes.extend_from_slice(&simulation.steps().to_le_bytes());
        if simulation.steps() > 0 {
            simulation.delivered().iter().for_each(|value| self.number(*value));
        }
        for node in 0..descriptions.len() {
            simulation.outputs(node).iter().for_each(|value| self.number(*value));
            simulation.watched(node).iter().for_each(|value| self.number(*value));
        }
        simulation.written().iter().for_each(|text| self.put(text.as_bytes()));
        let changes = simulation.changes().get(self.tuned..).unwrap_or_default();
        for change in changes.iter().take_while(|change| change.told.done) {
            self.change(change, descriptions);
            self.tuned += 1;
        }
        if self.bytes.len() >= GATHER_BYTES {
            self.hasher.update(&self.bytes);
            self.bytes.clear();
        }
    }

    /// Returns the hash, 64 hexadecimal digits.
    #[must_use]
    pub fn hex(mut self) -> String {
        self.hasher.update(&self.bytes);
        self.hasher.finalize().to_hex().to_string()
    }

    fn change(&mut self, change: &Tuning, descriptions: &[&Description]) {
        let Some(description) = descriptions.get(change.node) else { return };
        let mut values = change.values.as_bytes(description);
        if let Some(present) = self.present.get_mut(change.node) {
            values.retain(|key, value| present.insert(*key, value.clone()).as_ref() != Some(value));
        }
        if !values.is_empty() {
            self.put(change.told.fmu.as_bytes());
            self.values(&values);
        }
    }

    fn values(&mut self, values: &Values) {
        for ((kind, reference), bytes) in values {
            self.put(kind.as_bytes());
            self.bytes.extend_from_slice(&reference.to_le_bytes());
            self.put(bytes);
        }
    }

    fn put(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(&(bytes.len() as u64).to_le_bytes());
        self.bytes.extend_from_slice(bytes);
    }

    fn number(&mut self, number: f64) {
        self.bytes.extend_from_slice(&number.to_bits().to_le_bytes());
    }
}
