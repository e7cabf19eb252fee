//! Inputs that an FMU already has: it holds the values that were set until other ones are set.

use super::super::description::VariableType;
use super::group::{Access, VariableGroup};

/// Values to which the groups of an exchange were set last.
#[derive(Debug, Default)]
pub(super) struct Held {
    groups: Vec<Option<(Vec<u32>, Vec<f64>)>>,
    /// Groups that were set outside of an exchange, since other values were forgotten.
    learned: Vec<(VariableGroup, Vec<f64>)>,
}

impl Held {
    /// Returns whether setting a group to its present values can be skipped. Floating-point numbers
    /// and 64-bit integers, which are often counters, hardly ever stay the same, unless they are set at
    /// events, which a change alone causes; a clock ticks when it is set.
    #[inline]
    pub(super) fn can_be(group: &VariableGroup, event_mode: bool) -> bool {
        let changes = matches!(group.kind, VariableType::Int64 | VariableType::UInt64);
        let rarely_changes = !group.kind.is_float() && !changes;
        group.kind != VariableType::Clock
            && match group.access {
                Access::Step => rarely_changes,
                Access::Event => rarely_changes || event_mode,
                Access::Configuration => false,
            }
    }

    /// Returns whether the FMU has these numbers.
    #[inline]
    pub(super) fn is(&mut self, place: usize, group: &VariableGroup, values: &[f64]) -> bool {
        // Once an exchange has set its groups none of them is looked up again.
        if !self.learned.is_empty()
            && !matches!(self.groups.get(place), Some(Some(_)))
            && let Some(at) = self.learned.iter().position(|(known, _)| known == group)
        {
            let (_, held) = self.learned.swap_remove(at);
            self.keep(place, group, &held);
        }
        let Some(Some((references, held))) = self.groups.get(place) else { return false };
        let same = |(held, value): (&f64, &f64)| {
            held.to_bits() == value.to_bits() && (group.bits || !value.is_nan())
        };
        *references == group.references
            && held.len() == values.len()
            && held.iter().zip(values).all(same)
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

    /// Records that a group was set outside of an exchange.
    pub(super) fn learn(&mut self, group: &VariableGroup, values: &[f64]) {
        self.groups.iter_mut().for_each(|group| *group = None);
        self.learned.retain(|(known, _)| {
            known.kind != group.kind
                || !known.references.iter().any(|one| group.references.contains(one))
        });
        self.learned.push((group.clone(), values.to_vec()));
    }

    /// Forgets all values: the FMU may have others.
    pub(super) fn forget(&mut self) {
        self.groups.iter_mut().for_each(|group| *group = None);
        self.learned.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn group(kind: VariableType, access: Access) -> VariableGroup {
        VariableGroup { kind, access, references: vec![3, 4], elements: 2, bits: false }
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
        held.learn(&of, &[1.0, 2.0]);
        assert!(held.is(0, &of, &[1.0, 2.0]) && !held.is(1, &of, &[1.0, 2.0]));
        held.learn(&of, &[1.0, 2.0]);
        held.learn(&other, &[1.0, 3.0]);
        assert!(!held.is(0, &of, &[1.0, 2.0]), "its first variable was set anew");
        let exact = VariableGroup { bits: true, ..group(VariableType::Int64, Access::Event) };
        held.keep(2, &exact, &[f64::from_bits(u64::MAX), 0.0]);
        assert!(held.is(2, &exact, &[f64::from_bits(u64::MAX), 0.0]));
        assert!(!held.is(2, &exact, &[f64::from_bits(u64::MAX), -0.0]), "another whole number");
    }

    #[test]
    fn what_ticks_is_set_every_time_and_an_event_is_made_by_a_change() {
        for (kind, access, event_mode, expected) in [
            (VariableType::Boolean, Access::Step, true, true),
            (VariableType::Enumeration, Access::Event, false, true),
            (VariableType::Enumeration, Access::Event, true, true),
            (VariableType::Float64, Access::Event, true, true),
            (VariableType::UInt64, Access::Event, true, true),
            (VariableType::UInt64, Access::Event, false, false),
            (VariableType::Clock, Access::Event, true, false),
            (VariableType::Clock, Access::Event, false, false),
            (VariableType::UInt64, Access::Step, true, false),
            (VariableType::Int32, Access::Configuration, false, false),
            (VariableType::Float64, Access::Step, false, false),
        ] {
            assert_eq!(Held::can_be(&group(kind, access), event_mode), expected, "{kind:?}");
        }
    }
}
