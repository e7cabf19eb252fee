//! Pages: complete, well formed, offline. The rendered pages are kept in cargo's directory for test
//! files, for inspection.

use octant_base::display::DisplayUnits;
use octant_earth::units::{ARCSEC, DEG, DEG_PER_SQRT_HOUR, MICRO_G};
use octant_evidence::disposition::Dispositions;
use octant_report::{
    GimbalPoint, HealthEvent, NisPoint, ParameterPoint, ReportData, ReportProvenance,
    SolutionSeries, compare as page, run,
};
use octant_sample::Parameters;
use octant_sample::parameters::{NAMES, PARAMETER_COUNT, ParameterGroup};
use octant_score::compare::{Claim, Maxima, MethodComparison, PairedRun, compare};
use octant_score::drift::{DriftSample, DriftScorer};
use octant_score::floor::{Floor, MaximumFloor, SolutionValues};
use octant_score::judge::judge;
use octant_score::parameters;
use octant_score::reference::{ReferenceInput, reference};
use octant_score::summary::{
    BaselineMethod, CalibrationScore, HealthCounts, HeightChannel, NavigationScore, SCHEMA, Summary,
};
use octant_verdict::verdict::LimitCheck;
use octant_verdict::{Comparison as Sign, Verdict};
use std::collections::BTreeMap;

const LATITUDE: f64 = 30.5 * DEG;
const ARW: f64 = 7e-4 * DEG_PER_SQRT_HOUR;
const VRW: f64 = 50.0 * MICRO_G;

/// Returns numbers between −1 and 1 that look random but are deterministic.
fn chance(k: usize) -> f64 {
    let x = ((k as f64 + 1.0) * 12.9898).sin() * 43_758.545_3;
    2.0 * (x - x.floor()) - 1.0
}

fn truth() -> Parameters {
    let mut all = [0.0; PARAMETER_COUNT];
    for (i, value) in all.iter_mut().enumerate() {
        let group = ParameterGroup::of(i);
        let size = match group {
            ParameterGroup::GyroBias => 0.005,
            ParameterGroup::GyroScale | ParameterGroup::AccelScale => 30.0,
            ParameterGroup::GyroMisalignment | ParameterGroup::AccelMisalignment => 40.0,
            ParameterGroup::GDependent => 2e-3,
            ParameterGroup::AccelBias => 100.0,
        };
        *value = size * chance(i) * group.si_per_unit();
    }
    all[20] = 2.1e-3 * ParameterGroup::GDependent.si_per_unit();
    Parameters::from_array(&all)
}

fn final_sigma(i: usize) -> f64 {
    let group = ParameterGroup::of(i);
    let size = match group {
        ParameterGroup::GyroBias => 3.7e-4,
        ParameterGroup::GyroScale => 1.4,
        ParameterGroup::GyroMisalignment => 0.6,
        ParameterGroup::GDependent => 1.6e-4,
        ParameterGroup::AccelBias => 0.45,
        ParameterGroup::AccelScale => 0.55,
        ParameterGroup::AccelMisalignment => 0.4,
    };
    size * (1.0 + 0.3 * chance(i + 77)) * group.si_per_unit()
}

/// Returns estimate and σ when `part` of the calibration is over.
fn point(part: f64, hours: f64) -> ParameterPoint {
    let (mut estimate, mut sigma) = (truth().to_array(), [0.0; PARAMETER_COUNT]);
    for i in 0..PARAMETER_COUNT {
        let last = final_sigma(i);
        sigma[i] = last * (1.0 + 60.0 * (-9.0 * part).exp() + 2.0 * (1.0 - part));
        estimate[i] += sigma[i] * 1.7 * (chance(i + 200) + 0.25 * (40.0 * part + i as f64).sin());
    }
    ParameterPoint { hours, estimate: Parameters::from_array(&estimate), sigma }
}

fn calibration(positions: &str, with_g: bool) -> (CalibrationScore, Parameters) {
    let ParameterPoint { mut estimate, mut sigma, .. } = point(1.0, 24.0);
    if !with_g {
        estimate.g_dependent = [0.0; 9];
        sigma[12..21].fill(0.0);
        for axis in 0..3 {
            estimate.gyro_bias[axis] += 6.0 * sigma[axis] * chance(axis + 5);
        }
    }
    let parameters = parameters::score(Some(&truth()), &estimate, &sigma);
    let calibration = CalibrationScore {
        reference: None,
        solution: None,
        positions: positions.to_owned(),
        estimator: "39-state Kalman filter (phi)".to_owned(),
        duration_h: 24.0,
        nis_mean: Some(3.004),
        nis_expected: None,
        rest: None,
        nees: parameters::nees(&parameters, &std::collections::BTreeMap::new()),
        worst_normalized_error: parameters::worst_normalized_error(&parameters, &[]),
        least_gain: None,
        parameters,
        further: BTreeMap::new(),
        refused: None,
        refusal_explained: Vec::new(),
        health: HealthCounts { measurements: 86_400, ..HealthCounts::default() },
        sigma_hours: Vec::new(),
    };
    (calibration, estimate)
}

fn navigation(residual_g_zz: f64, tilt_arcsec: f64) -> NavigationScore {
    let floor = Floor::new(LATITUDE, 0.0, 0.0, 0.0);
    let (mut scorer, gravity) = (DriftScorer::new(), 9.793_64);
    let initial =
        [tilt_arcsec * ARCSEC, 0.8 * tilt_arcsec * ARCSEC, 6.0 * ARCSEC, 0.0, 0.0, 0.0, 0.0];
    for k in 0..=864u32 {
        let t_s = f64::from(k) * 300.0;
        let error = [0.0, 0.0, -residual_g_zz * gravity, 0.0, 0.0];
        let [latitude_error_rad, longitude_error_rad] = floor.propagate(initial, &error, t_s);
        scorer.push(&DriftSample {
            t_s,
            position_error_rad: Some([latitude_error_rad, longitude_error_rad]),
            attitude_error: None,
            velocity_error_mps: None,
            latitude_rad: LATITUDE,
            height_m: 0.0,
        });
    }
    scorer.finish(HeightChannel::Held).unwrap()
}

pub(crate) fn data() -> ReportData {
    let (eight, estimate) = calibration("eight", true);
    let (six, six_estimate) = calibration("six", false);
    let g = |p: &Parameters| p.g_dependent[8];
    let mut summary = Summary {
        schema: SCHEMA,
        octant: "0.1.0".to_owned(),
        numerics: None,
        scenario: "Table 1 instrument, static, G 2e-3 <deg/h/g> & 24 h".to_owned(),
        seed: 42,
        verdict: Verdict::Pass,
        reasons: vec![],
        requirements: vec![],
        findings: Vec::new(),
        decision: None,
        planned: None,
        done: None,
        faults: vec![],
        inputs: Vec::new(),
        altered_streams: None,
        followed: None,
        false_alarms: None,
        heading: None,
        method: "eight positions".to_owned(),
        calibration: Some(eight),
        navigation: Some(navigation(g(&truth()) - g(&estimate), 1.5)),
        baseline: Some(BaselineMethod {
            planned: None,
            done: None,
            followed: None,
            label: "six positions".to_owned(),
            calibration: Some(six),
            navigation: Some(navigation(g(&truth()) - g(&six_estimate), 2.5)),
            alignment: None,
            counterfactual: None,
            faults: vec![],
            stream_hash: "6a1f0c55d0f2f7be6c3c8c5d88a64f6d4c8f4bb0c6a5b8d2e1f30b9a5d7c4e21"
                .to_owned(),
        }),
        reference: Some(reference(&ReferenceInput {
            latitude_rad: LATITUDE,
            height_m: 0.0,
            heading_rad: 0.0,
            angle_random_walk: ARW,
            velocity_random_walk: VRW,
            calibration_s: Some(86_400.0),
            navigation_s: Some(72.0 * 3600.0),
            true_g_zz: Some(g(&truth())),
            estimated_g_zz: Some(g(&estimate)),
            baseline_estimated_g_zz: Some(0.0),
        })),
        alignment: None,
        counterfactual: None,
        allan_deviation: None,
        pacing: None,
        stream_hash: "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855".to_owned(),
    };
    let requirement = |id: &str, measure: &str, limit| LimitCheck {
        id: id.to_owned(),
        measure: measure.to_owned(),
        comparison: Sign::AtMost,
        limit,
        secant_latitude: false,
    };
    let requirements = [
        requirement("NAV-LAT", "navigation.latitude_error_arcmin.max", 1.0),
        requirement("NAV-LON-24", "navigation.marks.24h.longitude_max_arcmin", 1.0),
        requirement("NAV-RATE", "navigation.radial_error_nmi.rate_per_h", 0.005),
        requirement("CAL-GZZ", "|calibration.parameters.g_zz.normalized|", 3.0),
        requirement("NAV-96", "navigation.marks.96h.longitude_max_arcmin", 3.0),
    ];
    judge(&mut summary, &requirements, &[]).unwrap();
    let fact = |a: &str, b: &str| (a.to_owned(), b.to_owned());
    ReportData {
        stops: Vec::new(),
        solution: SolutionSeries::default(),
        baseline_solution: SolutionSeries::default(),
        calibration_errors: SolutionSeries::default(),
        baseline_calibration_errors: SolutionSeries::default(),
        navigation_start_h: Some(24.0),
        latitude_rad: Some(LATITUDE),
        sample_period_s: Some(0.005),
        covariance: None,
        requirement_clauses: BTreeMap::new(),
        heading_condition: String::new(),
        requirement_texts: BTreeMap::new(),
        units: DisplayUnits::default(),
        summary,
        axes_of_source: None,
        facts: vec![
            fact("Site", "30.5° N 114.3° E, 0 m"),
            fact("Motion", "static"),
            fact("Instrument", "Table 1, drawn from the seed"),
        ],
        truth: Some(truth()),
        convergence: (0..200u32)
            .map(|k| point(f64::from(k) / 199.0, 24.0 * f64::from(k) / 199.0))
            .collect(),
        nis: (0..86_400usize)
            .map(|k| {
                let x = 1.0 + 0.8 * (chance(k) + chance(k + 7) + chance(k + 13));
                NisPoint { hours: (k + 1) as f64 / 3600.0, nis: x * x + 1.08, innovation: None }
            })
            .collect(),
        gimbals: gimbals(),
        events: vec![HealthEvent {
            hours: 5.2514,
            duration_s: 1.0,
            name: "innovation rejected".to_owned(),
            detail: "NIS 31.2 above the gate of 25".to_owned(),
        }],
        dispositions: Dispositions::default(),
        provenance: ReportProvenance {
            entries: vec![fact("rustc", "1.95.0"), fact("host", "x86_64-unknown-linux-gnu")],
            rerun: "octant run scenario.toml --seed 42".to_owned(),
        },
    }
}

fn gimbals() -> Vec<GimbalPoint> {
    let stops = [
        (0, 0),
        (0, 45),
        (0, 90),
        (0, 180),
        (0, 270),
        (0, 180),
        (0, 90),
        (90, 90),
        (180, 90),
        (270, 90),
        (180, 90),
        (90, 90),
        (90, 180),
        (90, 270),
        (90, 180),
        (90, 90),
        (90, 45),
        (90, 0),
        (0, 0),
    ];
    let mut points = Vec::new();
    for (k, (azimuth, roll)) in stops.iter().enumerate() {
        for (part, moving) in [(0.0, false), (0.985, false), (0.99, true), (1.0, true)] {
            points.push(GimbalPoint {
                hours: (k as f64 + part) * 24.0 / 19.0,
                azimuth_deg: f64::from(*azimuth),
                roll_deg: f64::from(*roll),
                moving,
                stop: None,
            });
        }
    }
    points
}

/// Checks that a page is well formed and loads nothing, and keeps it for inspection.
fn check(html: &str, file: &str) {
    std::fs::write(std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(file), html).unwrap();
    // Void elements of HTML, closed as in XML.
    let mut xml = html.replacen("<!DOCTYPE html>", "", 1);
    for (at, _) in html.match_indices("<meta ").collect::<Vec<_>>().iter().rev() {
        let at = at - "<!DOCTYPE html>".len();
        let end = at + xml[at..].find('>').unwrap();
        xml.insert(end, '/');
    }
    let document = roxmltree::Document::parse(&xml).unwrap();
    for node in document.descendants().filter(roxmltree::Node::is_element) {
        for attribute in node.attributes() {
            // Links within the page load nothing.
            let inside = attribute.name() == "href" && attribute.value().starts_with('#');
            assert!(
                inside
                    || !["src", "href", "srcset", "action", "data", "poster"]
                        .contains(&attribute.name()),
                "{} loads {}",
                node.tag_name().name(),
                attribute.value()
            );
        }
        assert!(!["link", "img", "iframe", "object"].contains(&node.tag_name().name()));
    }
    for load in ["http:", "https:", "url(", "@import", "fetch(", "XMLHttp", "//cdn"] {
        assert!(!html.contains(load), "the page holds {load}");
    }
    let (shown, _) = html.split_once("<script>").unwrap();
    assert!(!shown.contains("NaN") && !shown.contains("inf "), "a number is not one");
}

#[test]
fn the_report_holds_every_parameter_and_loads_nothing() {
    let data = data();
    let html = run::render(&data);
    check(&html, "report.html");
    for name in NAMES {
        assert!(html.contains(&format!(">{name}<")), "{name} is not in the report");
    }
    for text in
        ["NAV-LON-24", "six positions", "Schuler period 84.3 min", "octant run scenario.toml"]
    {
        assert!(html.contains(text), "{text} is not in the report");
    }
    assert!(html.contains("&lt;deg/h/g&gt; &amp; 24 h"), "a name is not escaped");
    assert!(html.len() < 3_000_000, "{} bytes", html.len());
    assert_eq!(html, run::render(&data));
}

#[test]
fn a_refusal_stands_above_the_parameters_with_its_causes() {
    let mut data = data();
    assert!(!run::render(&data).contains("Refused: "));
    let calibration = data.summary.calibration.as_mut().unwrap();
    calibration.refused = Some("the mean NIS of 12 is above 9".to_owned());
    calibration.refusal_explained =
        vec!["likely: the sea <is> larger".to_owned(), "try: coloured".to_owned()];
    let html = run::render(&data);
    let at = |text: &str| html.find(text).unwrap_or_else(|| panic!("{text} is not in the report"));
    let refused = at("<strong>Refused: </strong>the mean NIS of 12 is above 9.");
    assert!(refused < at("<li>likely: the sea &lt;is&gt; larger</li><li>try: coloured</li>"));
    assert!(refused < at(&format!(">{}<", NAMES[0])));
    // Nothing of it is told as a result.
    data.summary.navigation = None;
    let html = run::render(&data);
    assert!(html.contains("The calibration through the eight positions was refused after 24 h"));
    assert!(!html.contains("was calibrated for") && !html.contains("Worst parameter error"));
}

#[test]
fn a_report_of_next_to_nothing_is_still_a_page() {
    let mut data = data();
    data.summary.calibration = None;
    data.summary.navigation = None;
    data.summary.baseline = None;
    data.summary.reference = None;
    data.truth = None;
    (data.convergence, data.nis, data.gimbals, data.events) = (vec![], vec![], vec![], vec![]);
    judge(&mut data.summary, &[], &[]).unwrap();
    let html = run::render(&data);
    check(&html, "empty.html");
    assert!(html.contains("nothing was required"));
}

/// Makes pairs whose second method is `ratio` times the first, with some scatter.
fn comparison(ratio: f64, scatter: f64, floor: f64) -> MethodComparison {
    let runs: Vec<PairedRun> = (0..20usize)
        .map(|k| {
            let first = 1.0 + 0.6 * chance(k);
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            let second = first * ratio + scatter * sign;
            let maxima = |x: f64| Maxima {
                latitude_24h: Some(0.6 * x),
                longitude_24h: Some(x),
                latitude_72h: Some(0.9 * x),
                longitude_72h: Some(2.6 * x),
                heading: Some(4.0 * x),
                velocity_north_mps: Some(0.1 * x),
                ..Maxima::default()
            };
            PairedRun {
                seed: k as u64 + 1,
                first: maxima(first),
                second: maxima(second.abs()),
                ..PairedRun::default()
            }
        })
        .collect();
    let floors = [24.0, 72.0].map(|hours| MaximumFloor {
        hours,
        latitude_arcmin: floor,
        longitude_arcmin: floor * hours / 28.0,
        solution: SolutionValues {
            heading_arcmin: 0.4,
            velocity_north_mps: 0.02,
            ..SolutionValues::default()
        },
    });
    compare("G 2e-3, 24 h", "six", "eight", &runs, &floors, Some(72.0))
}

#[test]
fn a_comparison_says_in_words_what_it_shows() {
    let holds = comparison(0.35, 0.05, 0.2);
    assert_eq!(holds.cells.len(), 6);
    assert!(holds.cells.iter().all(|c| c.claim == Claim::Holds));
    assert!(
        holds.words[0].starts_with(
            "the claim (more than 50 % better) holds: the largest error in longitude to 72 h is 65 % smaller with eight than with six"
        ),
        "{}",
        holds.words[0]
    );

    let hidden = comparison(1.0, 0.3, 0.9);
    assert_eq!(hidden.cells[3].claim, Claim::NotShown);
    assert!(
        hidden.words[0].starts_with("no claim: the random walk hides it: the interval"),
        "{}",
        hidden.words[0]
    );
    assert!(
        hidden.words[2].starts_with("no method could improve on six by more than about"),
        "{:?}",
        hidden.words
    );

    let less = comparison(0.7, 0.02, 0.2);
    assert_eq!(less.cells[0].claim, Claim::BetterByLess);
    assert!(less.words[0].starts_with("better, and by less than 50 %"), "{}", less.words[0]);
    assert_eq!(comparison(1.5, 0.02, 0.2).cells[0].claim, Claim::Worse);

    let none = compare("s", "six", "eight", &[], &[], None);
    assert!(none.cells.is_empty() && none.words[0].starts_with("nothing to compare"));
}

#[test]
fn a_comparison_is_a_table_a_page_and_a_file() {
    let comparison = comparison(0.35, 0.1, 0.2);
    let text = page::table(&comparison, &DisplayUnits::default());
    assert_eq!(text.lines().count(), 1 + 6 + 1 + comparison.words.len());
    // Attitude and velocity have the floor of the whole navigation.
    let floors: Vec<Option<f64>> = comparison.cells.iter().map(|cell| cell.floor).collect();
    assert_eq!(floors[4..], [Some(0.4), Some(0.02)]);
    assert!(
        text.lines().any(|l| l.starts_with("heading, arcmin") && l.contains("0.400")),
        "{text}"
    );
    let html = page::render(
        &comparison,
        &[("rustc".to_owned(), "1.95.0".to_owned())],
        &DisplayUnits::default(),
    );
    check(&html, "compare.html");
    let json = serde_json::to_string(&comparison).unwrap();
    assert_eq!(serde_json::from_str::<MethodComparison>(&json).unwrap(), comparison);
    assert!(json.contains(r#""measure":"longitude_72h""#) && json.contains(r#""claim":"holds""#));
}
