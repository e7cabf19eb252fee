//! Certificates that have expired.

use octant_score::equipment::findings;
use octant_score::judge::FindingSubject;
use octant_verdict::Verdict;
use octant_verdict::equipment::{Day, Equipment};

#[test]
fn a_certificate_holds_through_its_last_day() {
    let piece = |expires: &str| Equipment {
        name: "table".to_owned(),
        serial: Some("17".to_owned()),
        certificate: "K-4".to_owned(),
        expires: Day::parse(expires).unwrap(),
    };
    let all = [piece("2027-03-31"), piece("2027-03-30")];
    let found = findings(&all, Some(&Day::parse("2027-03-31").unwrap()));
    assert_eq!(found.len(), 1);
    assert_eq!(
        (found[0].verdict, found[0].about),
        (Verdict::Inconclusive, FindingSubject::Equipment)
    );
    for told in ["K-4", "table", "17", "until 2027-03-30", "on 2027-03-31"] {
        assert!(found[0].reason.contains(told), "{told}: {}", found[0].reason);
    }
    assert_eq!(findings(&all, None).len(), 2);
    assert_eq!(findings(&[], None), []);
}
