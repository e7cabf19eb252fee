//! Units of the quantities.

use octant_fmu::quantities::OF_GROUP;
use octant_sample::parameters::ParameterGroup;

#[test]
fn display_units_are_those_of_the_groups() {
    for (group, quantity) in ParameterGroup::ALL.into_iter().zip(OF_GROUP) {
        let shown = quantity.display.unwrap();
        assert_eq!(shown, group.unit());
        let (_, per_unit) = quantity.unit.display.iter().find(|(name, _)| *name == shown).unwrap();
        let found = 1.0 / per_unit;
        assert!((found / group.si_per_unit() - 1.0).abs() < 1e-15, "{group:?}: {found}");
    }
}
