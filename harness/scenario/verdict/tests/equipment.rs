//! Days of certificates.

use octant_verdict::equipment::Day;

#[test]
fn a_day_is_one_that_the_calendar_has() {
    for day in ["2027-03-31", "2028-02-29", "1999-12-31"] {
        assert_eq!(Day::parse(day).unwrap().to_string(), day);
    }
    for bad in
        ["2027-02-29", "2027-13-01", "2027-00-10", "2027-3-31", "31.03.2027", "", "2027-03-31 "]
    {
        assert!(Day::parse(bad).unwrap_err().to_string().contains("2027-03-31"), "{bad}");
    }
    assert!(Day::parse("2027-03-31").unwrap() < Day::parse("2027-04-01").unwrap());
    let midnight = Day::of_text("2027-03-31T23:59:59.999Z").unwrap();
    assert_eq!(midnight, Day::parse("2027-03-31").unwrap());
}
