//! Units of errors on the page: those that are chosen, each case's distances at its own site.

use super::bench::{Bench, CAMPAIGN, REQUIREMENTS, SCENARIO, drawn, final_nmi, rate};
use super::numbers::percentile;
use octant_base::number::significant;
use octant_campaign::plan::factor_values::FactorValue;
use octant_campaign::report::CampaignReport;
use serde_json::json;

/// Length of a minute of arc of longitude at the equator and at 60°, m, at this height: WGS 84 has
/// N = 6 378 137 m and 6 394 209.174 m there.
fn minute_of_longitude_m(at_60: bool, height_m: f64) -> f64 {
    let (normal_m, cosine) = if at_60 { (6_394_209.173_848, 0.5) } else { (6_378_137.0, 1.0) };
    (normal_m + height_m) * cosine * std::f64::consts::PI / 10_800.0
}

#[test]
fn a_page_in_other_units_equals_the_conversion_by_hand_and_the_files_keep_theirs() {
    let heading_arcmin = |index: usize| 60.0 * (1.0 + drawn(index));
    let (bench, plan, out) = Bench::filled(CAMPAIGN, |index, _, result| {
        let heading = &mut result["summary"]["navigation"]["heading_error_arcmin"];
        heading["max"] = heading_arcmin(index).into();
    });
    let (status, _) = bench.report();
    let names = ["statistics.json", "prediction.json", "junit.xml"];
    let files = names.map(|name| bench.read(name));
    let page = bench.read("report.html");
    for words in ["CEP50, nmi", "Rate 95 %, nmi/h", "heading, arcmin", "Longitude error, arcmin"] {
        assert!(page.contains(words), "{words}");
    }

    let shown = bench.octant(&["campaign", "report", "out", "--units", "km,deg,kn"]);
    assert_eq!(shown.status.code(), Some(status));
    assert_eq!(names.map(|name| bench.read(name)), files, "units are display only");
    let page = bench.read("report.html");
    for words in [
        "CEP50, km",
        "R95, km",
        "Largest, 95 %, km",
        "Rate 95 %, km/h",
        "Time-RMS 50 %, km",
        "heading, deg",
        "north, kn",
        "Latitude error, km",
        "Longitude error, km",
        "those of each case at its own site",
        "radial error at the end, km",
        "(in arcmin, nmi and m/s)",
        // 10 nmi.
        "navigation.radial_error_nmi.max</span> ≤ 18.52 km",
        "octant campaign report out --units km,deg,kn",
    ] {
        assert!(page.contains(words), "{words}");
    }
    let elsewhere = page.replace("(in arcmin, nmi and m/s)", "");
    for words in [", nmi", "nmi/h", ", arcmin", ", m/s"] {
        assert!(!elsewhere.contains(words), "{words}");
    }
    for place in 0..2 {
        let of = |f: &dyn Fn(usize) -> f64| -> Vec<f64> {
            (0..80).filter(|index| index % 2 == place).map(f).collect()
        };
        for (value, p) in [
            (of(&|index| 1.852 * final_nmi(index)), 0.5),
            (of(&|index| 1.852 * rate(index)), 0.95),
            (of(&|index| heading_arcmin(index) / 60.0), 0.95),
        ] {
            let text = format!("{}<div class=\"reason\">", significant(percentile(&value, p), 3));
            assert!(page.contains(&text), "{text}");
        }
    }

    // Errors over time: each case is converted at its own latitude and height before the percentiles.
    let mut report = CampaignReport::of(&plan, &out).unwrap();
    report.show_in("m".parse().unwrap()).unwrap();
    let height_m = |index: usize| match plan.cases[index].factors.get("north") {
        Some(FactorValue::Number(height)) => *height,
        _ => unreachable!(),
    };
    let metres = |index: usize| minute_of_longitude_m(index % 2 == 1, height_m(index));
    for place in 0..2 {
        let envelope = report.envelope(place).unwrap();
        let slopes: Vec<f64> = (0..80)
            .filter(|index| index % 2 == place)
            .map(|index| -2.0 * drawn(index + 1) * metres(index))
            .collect();
        for (curve, p) in [0.05, 0.25, 0.5, 0.75, 0.95].into_iter().enumerate() {
            let slope = percentile(&slopes, p);
            for (hours, found) in envelope.hours.iter().zip(&envelope.longitude[curve]) {
                let expected = slope * hours;
                assert!((found - expected).abs() <= 1e-8 * expected.abs(), "{found} {expected}");
            }
        }
    }
    // The same instrument is at both latitudes: at 60° a degree of longitude is half as long, and 0.25 %
    // more, by the ellipsoid.
    assert_eq!(height_m(0), height_m(1));
    let factors = [0, 1].map(|index| report.units.at(index).longitude().factor);
    assert!((factors[0] / metres(0) - 1.0).abs() < 1e-9, "{factors:?}");
    assert!((factors[1] / factors[0] - 0.501_26).abs() < 1e-5, "{factors:?}");
}

/// Three instruments at each latitude, with the largest longitude error of 5, 6, 7 … arcmin and a limit of
/// 20 arcmin.
fn of_longitude(latitudes: &str, display: &str) -> Bench {
    let campaign = format!(
        "schema = 1\ntitle = \"c\"\nreplicates = 3\nrequirements = \"requirements.toml\"\n\
         [[scenarios]]\nid = \"short\"\nfile = \"short.toml\"\n\
         [[factors]]\nname = \"latitude\"\nkey = \"site.latitude\"\nvalues = [{latitudes}]\n"
    );
    let bench = Bench::new(&campaign);
    let fault = SCENARIO.find("[[faults]]").unwrap()..SCENARIO.find("[[requirements]]").unwrap();
    let scenario = SCENARIO.replace(&SCENARIO[fault], display);
    std::fs::write(bench.at("short.toml"), scenario).unwrap();
    let measure = "navigation.longitude_error_arcmin.max";
    let requirement = format!(
        "[[requirements]]\nid = \"LON-1\"\ntext = \"It stays.\"\nmeasure = \"{measure}\"\nlimit = \"20 arcmin\"\n"
    );
    std::fs::write(bench.at("requirements.toml"), format!("{REQUIREMENTS}{requirement}")).unwrap();
    let (bench, ..) = bench.fill(|index, _, result| {
        let value = 5.0 + index as f64;
        let summary = &mut result["summary"];
        summary["navigation"]["longitude_error_arcmin"]["max"] = value.into();
        summary["requirements"].as_array_mut().unwrap().push(json!({
            "id": "LON-1", "measure": measure, "comparison": "<=", "limit": 20.0, "value": value,
            "margin": 20.0 - value, "verdict": "pass", "reason": null,
        }));
    });
    bench
}

#[test]
fn a_limit_of_longitude_is_a_distance_where_all_cases_have_one_site() {
    let limit = |bench: &Bench| {
        let page = bench.read("report.html");
        let (_, rest) = page.split_once("navigation.longitude_error_arcmin.max</span> ≤ ").unwrap();
        let (limit, rest) = rest.split_once('<').unwrap();
        let row = rest.split_once("</tr>").unwrap().0.to_owned();
        (limit.trim().to_owned(), row, page.contains("stay in minutes of arc"))
    };
    // A minute of longitude has 930.000 m at 60°: 20 of them are 10.0432 nmi, the margin of 13 is 6.53 nmi.
    let one = of_longitude("\"60 deg\"", "");
    one.octant(&["campaign", "report", "out", "--units", "nmi"]);
    let (found, row, stays) = limit(&one);
    assert_eq!((found.as_str(), stays), ("10.0432 nmi", false));
    assert!(row.contains("6.53 nmi"), "{row}");
    // In the scenario the choice is the same.
    let own = of_longitude("\"60 deg\"", "[display]\nposition = \"nmi\"\n");
    own.report();
    assert_eq!(limit(&own).0, "10.0432 nmi");
    assert!(!own.read("report.html").contains("--units"));
    // At two latitudes the limit has two lengths.
    let two = of_longitude("\"0 deg\", \"60 deg\"", "");
    two.octant(&["campaign", "report", "out", "--units", "nmi"]);
    let (found, row, stays) = limit(&two);
    assert_eq!((found.as_str(), stays), ("20 arcmin", true));
    assert!(row.contains("10.0 arcmin"), "{row}");
    assert!(two.read("report.html").contains("Longitude error, nmi"));
}

#[test]
fn distances_are_refused_where_no_site_is_known() {
    let bench = of_longitude("\"60 deg\"", "");
    std::fs::remove_file(bench.at("short.toml")).unwrap();
    let refused = bench.octant(&["campaign", "report", "out", "--units", "km"]);
    let said = String::from_utf8(refused.stderr).unwrap();
    assert_eq!(refused.status.code(), Some(2), "{said}");
    for words in ["longitude errors in km", "short.toml", "arcmin as the unit of position"] {
        assert!(said.contains(words), "{words}: {said}");
    }
    assert!(!bench.at("out/report.html").exists(), "nothing is written");
    // An angle needs no site.
    let shown = bench.octant(&["campaign", "report", "out", "--units", "deg"]);
    assert_ne!(shown.status.code(), Some(2));
    // The copy in the folder of a report is as good as the file.
    let bench = of_longitude("\"60 deg\"", "");
    bench.report();
    std::fs::remove_file(bench.at("short.toml")).unwrap();
    let shown = bench.octant(&["campaign", "report", "out", "--units", "km"]);
    assert_ne!(shown.status.code(), Some(2));
    assert!(bench.read("report.html").contains("Longitude error, km"));
    let wrong = bench.octant(&["campaign", "report", "out", "--units", "furlong"]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(String::from_utf8(wrong.stderr).unwrap().contains("\"furlong\""));
}
