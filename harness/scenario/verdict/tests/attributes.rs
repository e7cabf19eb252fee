//! Values of attributes of another tool.

use octant_verdict::requirement::AttributeKind;

#[test]
fn an_attribute_of_one_value_has_exactly_one_that_fits() {
    for (kind, good, bad) in [
        (AttributeKind::Integer, "3", "3.5"),
        (AttributeKind::Real, "3.5", "inf"),
        (AttributeKind::Boolean, "true", "yes"),
        (AttributeKind::Date, "2026-11-25", "today"),
    ] {
        let misfit = |values: &[&str]| {
            let values: Vec<String> = values.iter().map(|value| (*value).to_owned()).collect();
            octant_verdict::file::misfit(&kind, &values)
        };
        assert_eq!(misfit(&[good]), None, "{kind:?}");
        assert!(misfit(&[bad]).is_some(), "{kind:?}");
        assert!(misfit(&[good, good]).is_some(), "{kind:?}");
        assert!(misfit(&[]).is_some(), "{kind:?}");
    }
}
