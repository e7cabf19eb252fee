//! A campaign as a project of StrictDoc.

use octant_requirements::strictdoc;
use octant_verdict::requirement::{
    Check, EnsembleRequirement, Limit, Requirement, Requirements, Verification,
};
use octant_verdict::trace::{CampaignTrace, TracedCase, TracedResult};
use octant_verdict::{Comparison, Verdict};

fn tested(id: &str, ensemble: Option<EnsembleRequirement>) -> Requirement {
    let check = Check {
        measure: "navigation.radial_error_nmi.max".to_owned(),
        comparison: Comparison::AtMost,
        limit: Limit::Quantity("1 nmi".to_owned()),
        secant_latitude: false,
        ensemble,
    };
    Requirement::new(id, "It stays close.", Verification::Test(check))
}

fn document(requirements: Vec<Requirement>) -> Requirements {
    Requirements { title: "T".to_owned(), requirements, ..Requirements::default() }
}

fn case(id: &str, checks: &[(&str, Verdict)]) -> TracedCase {
    let checks: Vec<(String, Verdict)> =
        checks.iter().map(|(id, verdict)| ((*id).to_owned(), *verdict)).collect();
    TracedCase {
        id: id.to_owned(),
        draw: id.bytes().fold(0, |draw, byte| 256 * draw + usize::from(byte)),
        verifies: checks.iter().map(|(id, _)| id.clone()).collect(),
        result: Some(TracedResult {
            verdict: checks.iter().map(|(_, v)| *v).max().unwrap_or(Verdict::Pass),
            checks,
            recording: Some(format!("runs/{id}/recording.mcap")),
            folder: Some(format!("runs/{id}")),
        }),
    }
}

#[test]
fn a_campaign_as_a_project_of_strictdoc() {
    let requirements = document(vec![tested("A", None), tested("B", None)]);
    let cases = [
        case("c1", &[("A", Verdict::Pass), ("B", Verdict::Inconclusive)]),
        TracedCase { id: "c2".to_owned(), verifies: vec!["A".to_owned()], draw: 2, result: None },
    ];
    let trace = CampaignTrace::new(&requirements, &cases);
    let files = strictdoc::folder(&requirements, &trace, "Night & day").unwrap();
    let text = |path: &str| files.iter().find(|(p, _)| p == path).unwrap().1.as_str();
    assert_eq!(text("cases/c1.toml"), "# @relation(A, B, scope=file)\ncase = \"c1\"\n");
    let report = text("campaign.lit.junit.xml");
    assert!(report.contains("tests=\"2\" failures=\"1\" skipped=\"1\" errors=\"0\""), "{report}");
    assert!(
        report.contains("<failure type=\"inconclusive\" message=\"A: pass; B: inconclusive\"/>"),
        "{report}"
    );
    assert!(report.contains("<property name=\"verifies\" value=\"A, B\"/>"), "{report}");
    let results = text("results.sdoc");
    assert!(
        results.contains("UID: c1\nSTATUS: inconclusive\nRECORDING: runs/c1/recording.mcap\n"),
        "{results}"
    );
    let outside = CampaignTrace::new(&requirements, &[case("../c1", &[("A", Verdict::Pass)])]);
    assert!(strictdoc::folder(&requirements, &outside, "T").is_err());
}
