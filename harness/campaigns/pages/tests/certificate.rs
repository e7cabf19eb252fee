//! First page of a campaign of heading tests.

use octant_base::control::Control;
use octant_campaign::execute::case;
use octant_campaign::plan::Plan;
use octant_campaign::report::CampaignReport;
use octant_campaign::store::keep;
use octant_campaign_pages::campaign::render;
use std::path::Path;

/// Cells of the certificate's rows, without markup; empty if the page has no certificate.
fn rows(page: &str) -> Vec<Vec<String>> {
    let Some((_, rest)) = page.split_once("<section class=\"certificate\"") else {
        return Vec::new();
    };
    let body = rest.split_once("<tbody>").unwrap().1.split_once("</tbody>").unwrap().0;
    let text = |cell: &str| {
        let (_, inside) = cell.split_once('>').unwrap();
        let parts =
            inside.split('<').map(|part| part.split_once('>').map_or(part, |(_, text)| text));
        parts.map(str::trim).filter(|part| !part.is_empty()).collect::<Vec<_>>().join(" ")
    };
    body.split("<tr>").skip(1).map(|row| row.split("<td").skip(1).map(text).collect()).collect()
}

/// Page of a campaign of which the first `run` cases have run.
fn page(campaign: &str, folder: &Path, run: usize) -> String {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures/campaigns");
    let plan = Plan::of(&fixtures.join(campaign)).unwrap();
    plan.write(folder, false).unwrap();
    for case in plan.cases.iter().take(run) {
        let result = case::run(plan.planned(case).unwrap(), case, &Control::default()).unwrap();
        keep(folder, &case.id, result.to_json().unwrap().as_bytes()).unwrap();
    }
    render(&CampaignReport::of(&plan, folder).unwrap(), false)
}

#[test]
fn the_laboratory_has_one_instrument_that_passes_and_two_that_fail() {
    let folder = tempfile::tempdir().unwrap();
    let page = page("heading-laboratory.toml", folder.path(), 6);
    let rows = rows(&page);
    // Six requirements of three instruments, and the four that need a voyage.
    assert_eq!(rows.len(), 6 * 3 + 4, "{rows:?}");
    let of = |clause: &str, instrument: &str| {
        let found = rows.iter().find(|row| {
            row[1] == format!("IMO A.821(19), {clause}") && row[2].starts_with(instrument)
        });
        found.unwrap_or_else(|| panic!("{clause}, {instrument}: {rows:?}"))
    };
    let rest = "latitude 45°, heading 0°, at rest";
    let point = of("4.1.2", "A: ");
    assert_eq!(point[2], format!("A: {rest}"));
    assert_eq!(point[3], "≤ 1.061 deg 0.75 deg × sec φ");
    assert_eq!(point[6], "✓ pass");
    for (row, name) in rows.iter().map(|row| (row, &row[2])) {
        let expected = match name {
            name if name.starts_with("A") => "✓ pass",
            name if name.starts_with("B: ") && row[0] == "Settle point error" => "✕ fail",
            name if name.starts_with("B") => "✓ pass",
            name if name.starts_with("C: ") => "✓ pass",
            name if name.starts_with("C in motion: ") && row[0].starts_with("Settling") => "✕ fail",
            // A unit that didn't settle has no settle point.
            name if name.starts_with("C in motion: ") => "? inconclusive",
            _ => "not tested",
        };
        assert_eq!(row[6], expected, "{row:?}");
    }
    // 0.25 deg/h of the Earth's rate in the horizon: asin(0.25 / (15.041 x cos 45 deg)) is 1.347 deg.
    let off: f64 = of("4.1.2", "B: ")[4].trim_end_matches(" deg").parse().unwrap();
    assert!((off - 1.347).abs() < 0.02, "{off}");
    let moving = &of("4.2.1", "C in motion: ")[2];
    assert!(
        moving.ends_with("heading 0°, roll 5°/15 s, pitch 5°/6 s, from 0 h for 6 h"),
        "{moving}"
    );
    // The certificate is the first of the page.
    assert!(page.find("class=\"certificate\"") < page.find("<header>"));
}

#[test]
fn cases_that_have_not_run_pass_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let page = page("heading-laboratory.toml", folder.path(), 0);
    let rows = rows(&page);
    assert_eq!(rows.len(), 22);
    for row in &rows {
        let tested = row[2] != "–";
        assert_eq!(row[6], if tested { "? inconclusive" } else { "not tested" }, "{row:?}");
        assert!(!tested || row[2].ends_with(": no case has run"), "{row:?}");
        assert_eq!(row[4], "–");
    }
}

#[test]
fn a_grid_names_its_factors() {
    let folder = tempfile::tempdir().unwrap();
    let page = page("heading.toml", folder.path(), 0);
    assert!(page.contains("latitude: 0 deg, 45 deg, 70 deg, -33 deg"));
    assert_eq!(rows(&page).len(), 6 + 4);
}

#[test]
fn a_campaign_without_a_heading_test_has_no_certificate() {
    let folder = tempfile::tempdir().unwrap();
    let page = page("nightly.toml", folder.path(), 0);
    assert!(rows(&page).is_empty());
}
