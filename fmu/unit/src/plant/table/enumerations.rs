//! Types with named values.

use crate::table::{DeclaredEnumeration, enumerations, same};
use octant_faults::catalogue::Acts;
use octant_faults::kinds::KINDS;

pub use crate::calibrator::table::REFERENCE_KIND;

enumerations! {
    /// Motion of the case.
    pub MOTION "Motion" "How the case of the instrument moves." {
        0 static "Fixed to the ground.";
        1 dockside "On a moored ship: sums of sinusoids about a mean attitude and position.";
    }
    /// Quantity that the reference measures.
    pub AIDING "AidingSource"
        "What the reference of the calibration measures, with white noise of its own." {
        0 zero_velocity "Velocity of the ground or dock: zero. It doesn't know of sway.";
        1 velocity "True velocity of the instrument over ground.";
        2 dock_position "Position of the dock: constant. It doesn't know of sway.";
    }
}

/// Kinds of faults that can act inside the plant. The values are the positions in the catalogue,
/// from 1.
pub static FAULT_KIND: DeclaredEnumeration = DeclaredEnumeration {
    name: "FaultKind",
    description: "Kind of a fault, with its name in the catalogue. Those that restart the unit \
                  under test, or deliver several samples at once, are not among them: a plant has \
                  no such unit, and gives one sample a step.",
    items: &ITEMS,
};

static ITEMS: [(i32, &str, &str); COUNT] = items();

/// Kinds on delivery that never release more than one sample in a step.
const ONE_AT_A_TIME: &[&str] = &["dropout"];

/// Returns whether a kind can act inside the plant.
pub(crate) const fn acts_in_plant(kind: &octant_faults::FaultKind) -> bool {
    match kind.acts {
        Acts::Plant | Acts::Command | Acts::Samples => true,
        Acts::Delivery => {
            let (mut found, mut i) = (false, 0);
            while i < ONE_AT_A_TIME.len() {
                found |= same(kind.name, ONE_AT_A_TIME[i]);
                i += 1;
            }
            found
        }
        _ => false,
    }
}

/// Items of the enumeration: none, and the kinds that can act.
const COUNT: usize = {
    let (mut count, mut family) = (1, 0);
    while family < KINDS.len() {
        let mut i = 0;
        while i < KINDS[family].len() {
            count += acts_in_plant(KINDS[family][i]) as usize;
            i += 1;
        }
        family += 1;
    }
    count
};

const fn items() -> [(i32, &'static str, &'static str); COUNT] {
    let mut items = [(0, "none", "There is no fault."); COUNT];
    let (mut item, mut place, mut family) = (1, 1, 0);
    while family < KINDS.len() {
        let mut i = 0;
        while i < KINDS[family].len() {
            let kind = KINDS[family][i];
            if acts_in_plant(kind) {
                items[item] = (place, kind.name, kind.summary);
                item += 1;
            }
            place += 1;
            i += 1;
        }
        family += 1;
    }
    items
}
