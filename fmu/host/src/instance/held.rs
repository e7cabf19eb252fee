//! Inputs that an FMU already has: it holds the values that were set until other ones are set.

use super::super::description::VariableType;
use super::group::{Access, VariableGroup};

/// Values to which the groups of an exchange were set last.
#[derive(Debug, Default)]
pub(super) struct Held {
    groups: Vec<Option<(Vec<u32>, Vec<f64>)>>,
}

impl Held {
    /// Returns whether setting a group to its present values can be skipped. Floating-point numbers
    /// and 64-bit integers, which are often counters, hardly ever stay the same; a clock ticks when
    /// it is set; and values that are set at events cause one.
    #[inline]
    pub(super) fn can_be(group: &VariableGroup, event_mode: bool) -> bool {
        let changes =
            matches!(group.kind, VariableType::Int64 | VariableType::UInt64 | VariableType::Clock);
        let rarely_changes = !group.kind.is_float() && !changes;
        let makes_event = match group.access {
            Access::Step => false,
            Access::Event => event_mode,
            Access::Configuration => true,
        };
        rarely_changes && !makes_event
    }

    /// Returns whether the FMU has these numbers.
    #[inline]
    pub(super) fn is(&self, place: usize, group: &VariableGroup, values: &[f64]) -> bool {
        let Some(Some((references, held))) = self.groups.get(place) else { return false };
        *references == group.references && held == values
    }

    /// Records that the FMU took these numbers.
    pub(super) fn keep(&mut self, place: usize, group: &VariableGroup, values: &[f64]) {
        if self.groups.len() <= place {
            self.groups.resize_with(place + 1, || None);
        }
        let (references, held) = self.groups[place].get_or_insert_default();
        references.clone_from(&group.references);
        held.clear();
        held.extend_from_slice(values);
    }

    /// Forgets all values: the FMU may have others.
    pub(super) fn forget(&mut self) {
        self.groups.iter_mut().for_each(|group| *group = None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn group(kind: VariableType, access: Access) -> VariableGroup {
        VariableGroup { kind, access, references: vec![3, 4], elements: 2 }
    }

    #[test]
    fn what_an_fmu_has_is_known_until_it_is_forgotten() {
        let of = group(VariableType::Int32, Access::Step);
        let mut held = Held::default();
        assert!(!held.is(1, &of, &[1.0, 2.0]));
        held.keep(1, &of, &[1.0, 2.0]);
        assert!(held.is(1, &of, &[1.0, 2.0]));
        assert!(!held.is(0, &of, &[1.0, 2.0]));
        assert!(!held.is(1, &of, &[1.0, 2.5]));
        let other = VariableGroup { references: vec![3, 5], ..of.clone() };
        assert!(!held.is(1, &other, &[1.0, 2.0]));
        held.keep(1, &of, &[1.0, f64::NAN]);
        assert!(!held.is(1, &of, &[1.0, f64::NAN]), "a number that is none is set again");
        held.forget();
        assert!(!held.is(1, &of, &[1.0, 2.0]));
    }

    #[test]
    fn what_acts_when_it_is_set_is_set_every_time() {
        for (kind, access, event_mode, expected) in [
            (VariableType::Boolean, Access::Step, true, true),
            (VariableType::Enumeration, Access::Event, false, true),
            (VariableType::Enumeration, Access::Event, true, false),
            (VariableType::Clock, Access::Event, false, false),
            (VariableType::UInt64, Access::Step, true, false),
            (VariableType::Int32, Access::Configuration, false, false),
            (VariableType::Float64, Access::Step, false, false),
        ] {
            assert_eq!(Held::can_be(&group(kind, access), event_mode), expected, "{kind:?}");
        }
    }
}
