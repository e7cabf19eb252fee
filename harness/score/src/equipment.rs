//! Findings about the equipment of a run, from its certificates and the day on which the run ended.

use super::finding::{Finding, FindingSubject};
use octant_requirements::Verdict;
use octant_requirements::equipment::{Day, Equipment};

/// Findings about the equipment of a run that ended on a day: one for each piece whose certificate had
/// expired. Without a known day there is one for every piece.
#[must_use]
pub fn findings(equipment: &[Equipment], ended: Option<&Day>) -> Vec<Finding> {
    let one = |piece: &Equipment| {
        let reason = match ended {
            None => format!(
                "the run has no date, against which certificate {} of {} could be held",
                piece.certificate,
                piece.named()
            ),
            Some(ended) if *ended <= piece.expires => return None,
            Some(ended) => format!(
                "certificate {} of {} had expired: it held until {}, the run ended on {ended}",
                piece.certificate,
                piece.named(),
                piece.expires
            ),
        };
        Some(Finding { verdict: Verdict::Inconclusive, about: FindingSubject::Equipment, reason })
    };
    equipment.iter().filter_map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
