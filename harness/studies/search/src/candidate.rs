//! Candidates of a search: one fault or two, each a form with the places of its values.

use crate::space::Space;
use octant_random::draws::Draws;
use serde::{Deserialize, Serialize};

/// One fault or several at once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Candidate {
    /// The faults.
    pub faults: Vec<PlacedFault>,
}

/// A fault of a candidate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlacedFault {
    /// Index of its form in the space.
    pub form: usize,
    /// Places of the values of its keys, each from 0 to 1.
    pub places: Vec<f64>,
}

impl PlacedFault {
    /// A fault of a form with random values.
    pub(crate) fn random(space: &Space, form: usize, draws: &mut Draws) -> Self {
        let places = space.forms[form].keys.iter().map(|_| draws.unit()).collect();
        Self { form, places }
    }

    /// True for a fault that a space has.
    pub(crate) fn is_in(&self, space: &Space) -> bool {
        let keys = space.forms.get(self.form).map(|form| form.keys.len());
        keys == Some(self.places.len())
            && self.places.iter().all(|place| (0.0..=1.0).contains(place))
    }
}

impl Candidate {
    /// Writes the faults as entries of a scenario, with the ids `search-1`, `search-2`.
    #[must_use]
    pub fn to_toml(&self, space: &Space) -> String {
        let mut out = String::new();
        for (number, fault) in self.faults.iter().enumerate() {
            let form = &space.forms[fault.form];
            out += &format!(
                "[[faults]]\nid = \"search-{}\"\nkind = {:?}\n",
                number + 1,
                form.kind.name
            );
            for (key, place) in form.keys.iter().zip(&fault.places) {
                out += &(key.line(*place) + "\n");
            }
        }
        out
    }

    /// Names the faults on one line: kinds and values.
    #[must_use]
    pub fn words(&self, space: &Space) -> String {
        let one = |fault: &PlacedFault| {
            let form = &space.forms[fault.form];
            let keys = form.keys.iter().zip(&fault.places).map(|(key, place)| key.line(*place));
            let keys = keys.map(|line| line.replace(" = ", " ").replace('"', ""));
            format!("{}: {}", form.kind.name, keys.collect::<Vec<_>>().join(", "))
        };
        self.faults.iter().map(one).collect::<Vec<_>>().join(" + ")
    }
}
