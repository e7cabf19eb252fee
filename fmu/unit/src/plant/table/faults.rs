//! Faults: a number of them, each with its kind, its numbers, its schedule, and its receipt.

use super::enumerations as of;
use crate::quantities as q;
use crate::table::ElementType::{Boolean, Count, Enumeration, Real};
use crate::table::{DeclaredVariable, concatenated, variables};

/// Largest number of faults.
pub const FAULT_SLOTS: usize = 4;

/// Largest number of numbers of a fault.
pub const FAULT_NUMBERS: usize = 14;

macro_rules! inputs {
    ($($fault:literal)*) => {
        variables! {$(
            input(concat!("fault[", $fault, "].fire"), Boolean):
                concat!("Where fault[", $fault, "].by_hand is true: the fault sets in with the \
                     step in which this becomes true. With a duration it lasts so long, else for \
                     as long as this is true.");
        )*}
    };
}

macro_rules! outputs {
    ($($fault:literal)*) => {
        concatenated(&[$(&variables! {
            output(concat!("fault[", $fault, "].armed"), Boolean): "There is such a fault.";
            output(concat!("fault[", $fault, "].active"), Boolean):
                "It lasts, or fades, at the sample.";
            output(concat!("fault[", $fault, "].fired"), Boolean):
                "It has altered something so far.";
            output(concat!("fault[", $fault, "].samples_altered"), Count):
                "Samples, or set points, that it has altered so far, found by comparison.";
        }),*])
    };
}

macro_rules! parameters {
    ($($fault:literal)*) => {
        concatenated(&[$(&variables! {
            parameter(concat!("fault[", $fault, "].kind"), Enumeration(&of::FAULT_KIND)):
                concat!("Kind of the fault. Its random numbers are those of a fault with the id \
                     fault[", $fault, "].");
            parameter(concat!("fault[", $fault, "].by_hand"), Boolean):
                concat!("It waits for fault[", $fault, "].fire; else it sets in at its start.");
            parameter(concat!("fault[", $fault, "].start"), Real) of(&q::TIME) min(0.0)
                nominal(100.0):
                "Time after the start at which it sets in, to the nearest sample: the first sample \
                 that it alters is the one whose interval begins there.";
            parameter(concat!("fault[", $fault, "].duration"), Real) of(&q::TIME) min(0.0)
                nominal(10.0):
                "How long it lasts, to the nearest sample; 0: to the end. Of no meaning for kinds \
                 that are over in an instant.";
            parameter(concat!("fault[", $fault, "].recovery"), Real) of(&q::TIME) min(0.0)
                nominal(10.0):
                "How long it fades after that, down a straight line; 0 for kinds that don't fade.";
            parameter(concat!("fault[", $fault, "].values"), Real) elements(FAULT_NUMBERS):
                "What the kind takes, SI, in the order of the catalogue; those that it doesn't \
                 need are 0. A quantity is one number, a vector three; where it may be of several \
                 dimensions, the place of the one that is meant follows, from 0. A choice is the \
                 place of the chosen name, from 0; yes is 1, no is 0. Channels are added up: 1, 2, \
                 4 for the gyros x, y, z, 8, 16, 32 for the accelerometers.";
        }),*])
    };
}

pub(super) const INPUTS: [DeclaredVariable; FAULT_SLOTS] = inputs!("1" "2" "3" "4");
pub(super) const OUTPUTS: [DeclaredVariable; 4 * FAULT_SLOTS] = outputs!("1" "2" "3" "4");
pub(super) const PARAMETERS: [DeclaredVariable; 6 * FAULT_SLOTS] = parameters!("1" "2" "3" "4");
