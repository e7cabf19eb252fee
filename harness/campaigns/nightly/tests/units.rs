//! Units on the page of trends.

use octant_base::display::DisplayUnits;
use octant_nightly::units::TrendUnits;

#[test]
fn a_distance_is_refused_with_what_to_write_instead() {
    let check = |text: &str| TrendUnits::check(text.parse().unwrap());
    for text in ["nmi", "m,deg", "km,kn"] {
        let error = check(text).unwrap_err().to_string();
        assert!(error.contains("latitude of each case; expected arcmin"), "{error}");
    }
    for text in ["arcmin", "deg,kn", "arcmin,mrad"] {
        assert_eq!(check(text), Ok(()), "{text}");
    }
}

#[test]
fn a_scenario_keeps_arcmin_and_is_told_why() {
    let key = ("night".to_owned(), "short".to_owned());
    let wants = DisplayUnits::default().with("km,deg".parse().unwrap());
    let units = TrendUnits::new([(key, wants)].into(), "kn".parse().unwrap());
    let shown = units.of("night", "short");
    assert_eq!((shown.longitude().name, shown.radial().name), ("arcmin", "nmi"));
    assert_eq!((shown.attitude().name, shown.velocity().name), ("deg", "kn"));
    assert!(units.remark("night", "short").unwrap().contains("asks for km"));
    assert_eq!(units.remark("night", "other"), None);
    assert_eq!(units.of("night", "other").velocity().name, "kn");
}
