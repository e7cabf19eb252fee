//! Certificate of a heading test, the first page of a run's report.

use crate::run::data;
use octant_report::certificate::{Certificate, ROWS_MAX, Row, page};
use octant_report::run::render;
use octant_score::verdict::RequirementResult;
use octant_verdict::{Comparison, Verdict};

fn result(id: &str, measure: &str, value: Option<f64>) -> RequirementResult {
    RequirementResult {
        id: id.to_owned(),
        measure: measure.to_owned(),
        comparison: Comparison::AtMost,
        limit: 1.060_660_171_779_821_2,
        at_equator: Some(0.75),
        value,
        margin: value.map(|value| 1.060_660_171_779_821_2 - value),
        uncertainty: Some(0.05),
        verdict: if value.is_some() { Verdict::Pass } else { Verdict::Inconclusive },
        reason: None,
    }
}

#[test]
fn the_first_page_of_a_heading_test_is_its_certificate() {
    let mut data = data();
    assert!(!render(&data).contains("class=\"certificate\""), "a run without a heading test");
    data.summary.requirements.push(result("H-1", "|heading.settle_point_error_deg|", Some(0.25)));
    data.requirement_texts.insert("H-1".to_owned(), "It <points> north.".to_owned());
    data.requirement_clauses.insert("H-1".to_owned(), "IMO A.821(19), 4.1.2".to_owned());
    data.heading_condition = "latitude 45°, heading 40°, at rest".to_owned();
    let html = render(&data);
    let (before, after) = html.split_once("<section class=\"certificate\"").unwrap();
    assert!(!before.contains("<header>"), "it is the first");
    let (certificate, _) = after.split_once("</section>").unwrap();
    for text in [
        "It &lt;points&gt; north.",
        "IMO A.821(19), 4.1.2",
        "latitude 45°, heading 40°, at rest",
        "≤ 1.061 deg",
        "0.75 deg × sec φ",
        ">0.25 deg<",
        ">0.05 deg<",
        " pass</span>",
    ] {
        assert!(certificate.contains(text), "{text} is missing: {certificate}");
    }
    assert!(!certificate.contains("NAV-"), "other requirements are no part of it");
    // One sheet of its own when it is printed.
    assert!(html.contains("@page certificate { size: A4;"));
    assert!(html.contains(".certificate { page: certificate; break-after: page; }"));
}

#[test]
fn a_row_without_a_result_is_not_tested_and_more_rows_than_a_page_holds_are_counted() {
    let open = Row {
        test: "Voyage".to_owned(),
        clause: "4.2.3".to_owned(),
        condition: String::new(),
        result: None,
        verdict: None,
    };
    let none = result("H-1", "heading.repeatability_deg", None);
    let missing = Row { verdict: Some(none.verdict), result: Some(none), ..open.clone() };
    let mut certificate = Certificate {
        title: "Laboratory".to_owned(),
        lines: vec!["latitude: 0 deg, 45 deg".to_owned()],
        verdict: Verdict::Fail,
        rows: vec![missing, open.clone()],
    };
    let html = page(&certificate).into_string();
    assert_eq!(
        (html.matches("not tested").count(), html.matches(" inconclusive<").count()),
        (1, 1)
    );
    assert!(html.contains("latitude: 0 deg, 45 deg") && !html.contains(" more are among"));
    certificate.rows.resize(ROWS_MAX + 3, open);
    let html = page(&certificate).into_string();
    assert_eq!(html.matches("<tr>").count(), 1 + ROWS_MAX);
    assert!(html.contains("3 more are among the requirements below."));
}

#[test]
fn the_output_chain_has_a_section_with_an_uncertainty_for_each_measure() {
    let mut data = data();
    assert!(!render(&data).contains("id=\"heading-output\""), "a run without an output");
    let follow_up = octant_score::heading_output::FollowUpScore {
        max_deg: 0.42,
        rms_deg: 0.2,
        uncertainty_deg: 0.07,
        rate_max_degps: 9.5,
        points: 512,
    };
    data.summary.navigation.as_mut().unwrap().heading_output =
        Some(Box::new(octant_score::heading_output::HeadingOutputScore {
            resolution_deg: 0.1,
            constant_error_deg: -0.3,
            transmission_error_deg: 0.051,
            transmission_rms_deg: 0.03,
            transmission_uncertainty_deg: 0.012,
            latency_s: Some(0.123),
            latency_uncertainty_s: Some(0.017),
            follow_up_10: Some(follow_up),
            follow_up_20: None,
        }));
    let html = render(&data);
    let (_, section) = html.split_once("id=\"heading-output\"").unwrap();
    let (section, _) = section.split_once("</table>").unwrap();
    for text in [
        "Latency",
        ">0.123<",
        "± 0.0170",
        ">0.420<",
        "± 0.0700",
        "512 points",
        "not tested: no turn of this class in the reference",
        ">0.0510<",
        "± 0.0120",
        "± 0.0500",
    ] {
        assert!(section.contains(text), "{text} is missing: {section}");
    }
}
