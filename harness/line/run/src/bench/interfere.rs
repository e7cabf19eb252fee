//! Faults that the harness doesn't know: functions between source and endpoint.

use super::ended::RunError;
use super::faulted::Faulted;
use super::steps::Injects;
use octant_endpoint::Endpoint;
use octant_faults::Receipt;
use octant_faults::rule::UnitEvent;
use octant_faults::station::{Delivered, Occurrence, Passed};
use octant_sample::canonical::{self, AIDING_BYTES, SAMPLE_BYTES};
use octant_sample::{Epoch, GimbalCommand, LargestChange, Output};
use octant_source::Source;

/// Kind of such faults in receipts.
const KIND: &str = "function";

/// A function that acts on epochs on their way to the core.
pub trait Interferes {
    /// Id of the fault in receipts.
    fn id(&self) -> &str;

    /// Acts on the epochs that one step of the source delivers: alters, drops or adds some. `number`
    /// is that of the step, from 1; `output` the core's last answer.
    fn act(&mut self, number: u64, output: &Output, delivered: &mut Vec<Epoch>);
}

/// Faults of the scenario, and functions after them.
pub(crate) struct Interfered<'a> {
    pub(crate) faulted: Option<&'a mut Faulted>,
    pub(crate) functions: &'a mut Functions,
}

/// Functions in the order in which they act, with their receipts.
#[derive(Default)]
pub(crate) struct Functions {
    all: Vec<(Box<dyn Interferes + Send>, Altered)>,
    number: u64,
    delivered: Vec<Epoch>,
    before: Vec<Epoch>,
}

/// Epochs that one function altered.
#[derive(Default)]
struct Altered {
    first: Option<u64>,
    last: Option<u64>,
    steps: u64,
    clean: crc32fast::Hasher,
    faulted: crc32fast::Hasher,
    largest: Option<LargestChange>,
}

impl Functions {
    pub(crate) fn new(all: Vec<Box<dyn Interferes + Send>>) -> Self {
        let all = all.into_iter().map(|function| (function, Altered::default())).collect();
        Self { all, ..Self::default() }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Receipts in order.
    pub(crate) fn receipts(&self) -> Vec<Receipt> {
        let receipt = |(function, altered): &(Box<dyn Interferes + Send>, Altered)| Receipt {
            id: function.id().to_owned(),
            kind: KIND,
            armed: true,
            firings: u32::from(altered.steps > 0),
            first_sample: altered.first,
            last_sample: altered.last,
            samples_altered: altered.steps,
            clean_crc32: altered.clean.clone().finalize(),
            faulted_crc32: altered.faulted.clone().finalize(),
            largest_change: altered.largest,
        };
        self.all.iter().map(receipt).collect()
    }

    /// Passes the epochs of a step through all functions; true if one altered them.
    fn pass(&mut self, number: u64, output: &Output) -> bool {
        let Self { all, delivered, before, .. } = self;
        let mut touched = false;
        for (function, altered) in all {
            before.clear();
            before.extend_from_slice(delivered);
            function.act(number, output, delivered);
            let same = before.len() == delivered.len()
                && before.iter().zip(delivered.iter()).all(|(a, b)| a.same_bits(b));
            if !same {
                touched = true;
                altered.first.get_or_insert(number);
                altered.last = Some(number);
                altered.steps += 1;
                if let ([one], [other]) = (before.as_slice(), delivered.as_slice()) {
                    altered.largest.get_or_insert_default().take(one, other);
                }
                before.iter().for_each(|epoch| digest(&mut altered.clean, epoch));
                delivered.iter().for_each(|epoch| digest(&mut altered.faulted, epoch));
            }
        }
        touched
    }
}

fn digest(hasher: &mut crc32fast::Hasher, epoch: &Epoch) {
    let mut bytes = [0; SAMPLE_BYTES];
    canonical::sample(&epoch.sample, &mut bytes);
    hasher.update(&bytes);
    if let Some(aiding) = &epoch.aiding {
        let mut bytes = [0; AIDING_BYTES];
        canonical::aiding(aiding, &mut bytes);
        hasher.update(&bytes);
    }
}

impl<S: Source + ?Sized, E: Endpoint + ?Sized> Injects<S, E> for Interfered<'_> {
    fn before(
        &mut self,
        number: u64,
        command: &mut GimbalCommand,
        output: &Output,
        source: &mut S,
        endpoint: &mut E,
    ) {
        self.functions.number = number;
        if let Some(faulted) = &mut self.faulted {
            faulted.before(number, command, output, source, endpoint);
        }
    }

    fn unit_events(&mut self, source: &S) -> Result<&[UnitEvent], RunError> {
        match &mut self.faulted {
            Some(faulted) => Injects::<S, E>::unit_events(&mut **faulted, source),
            None => Ok(&[]),
        }
    }

    fn after(
        &mut self,
        epoch: &Epoch,
        output: &Output,
        source: &mut S,
        endpoint: &mut E,
    ) -> Passed<'_> {
        let passed = match &mut self.faulted {
            Some(faulted) => faulted.after(epoch, output, source, endpoint),
            None => Passed { delivered: Delivered::Untouched, undisturbed: None },
        };
        if self.functions.is_empty() {
            return passed;
        }
        let Passed { delivered, undisturbed } = passed;
        let functions = &mut *self.functions;
        functions.delivered.clear();
        let untouched = match delivered {
            Delivered::Untouched => {
                functions.delivered.push(*epoch);
                true
            }
            Delivered::These(these) => {
                functions.delivered.extend_from_slice(these);
                false
            }
        };
        let touched = functions.pass(functions.number, output);
        let delivered = if untouched && !touched {
            Delivered::Untouched
        } else {
            Delivered::These(&functions.delivered)
        };
        Passed { delivered, undisturbed }
    }

    fn exchanged(&mut self, endpoint: &mut E) {
        if let Some(faulted) = &mut self.faulted {
            Injects::<S, E>::exchanged(&mut **faulted, endpoint);
        }
    }

    fn tell(&mut self, to: impl FnMut(&Occurrence)) {
        if let Some(faulted) = &mut self.faulted {
            Injects::<S, E>::tell(&mut **faulted, to);
        }
    }
}
