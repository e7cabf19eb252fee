//! Names of measures.

use octant_design::measure::DesignMeasure;

#[test]
fn names_are_unique_and_found() {
    for measure in DesignMeasure::all() {
        assert_eq!(DesignMeasure::named(&measure.name()), Some(measure));
    }
    assert!(
        DesignMeasure::named("longitude").is_some() && DesignMeasure::named("sigma.g_zz").is_some()
    );
    assert_eq!(DesignMeasure::named("longitudes"), None);
}
