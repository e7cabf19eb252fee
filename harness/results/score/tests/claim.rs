//! The verdict on the published claim.

use octant_score::compare::Claim;
use octant_statistics::paired::Improvement;

#[test]
fn an_end_of_the_interval_on_its_edge_shows_nothing_more() {
    let of = |low, value, high| Claim::of(&Improvement { value, low, high, detectable: None });
    assert_eq!(of(-0.4, -0.2, -0.1), Claim::Worse);
    assert_eq!(of(-0.4, -0.2, 0.0), Claim::NotShown);
    assert_eq!(of(0.0, 0.2, 0.4), Claim::NotShown);
    assert_eq!(of(0.1, 0.2, 0.5), Claim::BetterByLess);
    assert_eq!(of(0.1, 0.5, 0.6), Claim::Better);
    assert_eq!(of(0.5, 0.6, 0.7), Claim::Likely);
    assert_eq!(of(0.51, 0.6, 0.7), Claim::Holds);
}
