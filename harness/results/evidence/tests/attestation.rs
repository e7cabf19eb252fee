//! Results of attestations.

use octant_evidence::attestation::result;
use octant_verdict::Verdict;

#[test]
fn a_pass_alone_passes() {
    let passed = |verdict| result(verdict) == "PASSED";
    assert!(!passed(None) && result(None) == "WARNED");
    for verdict in Verdict::ALL {
        assert_eq!(passed(Some(verdict)), verdict == Verdict::Pass, "{}", verdict.name());
    }
    assert_eq!(result(Some(Verdict::Error)), "FAILED");
}
