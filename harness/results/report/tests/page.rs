//! Content of the page of a run: contents, series for the script, requirements with units, plots.

use octant_report::{
    GimbalPoint, HealthEvent, NisPoint, ParameterPoint, ReportData, ReportProvenance,
    SolutionSeries, run,
};
use octant_sample::Parameters;
use octant_sample::parameters::{PARAMETER_COUNT, ParameterGroup};
use octant_score::allan::{InstrumentNoise, RestOctave, RestRecord};
use octant_score::floor::Floor;
use octant_score::summary::{AllanDeviation, Summary};
use octant_statistics::allan::DifferenceCounts;

/// Hours of the calibration, and of the navigation after it.
const CALIBRATION_H: f64 = 4.0;
const NAVIGATION_H: f64 = 24.0;

/// Deterministic numbers between −1 and 1.
fn chance(k: usize) -> f64 {
    let x = ((k as f64 + 1.0) * 12.9898).sin() * 43_758.545_3;
    2.0 * (x - x.floor()) - 1.0
}

fn convergence() -> Vec<ParameterPoint> {
    (1..=400usize)
        .map(|k| {
            let part = k as f64 / 400.0;
            let mut sigma = [0.0; PARAMETER_COUNT];
            let mut estimate = [0.0; PARAMETER_COUNT];
            for i in 0..PARAMETER_COUNT {
                sigma[i] =
                    ParameterGroup::of(i).si_per_unit() * (0.01 + 20.0 * (-12.0 * part).exp());
                estimate[i] = sigma[i] * (0.8 * chance(i) + 0.5 * (9.0 * part + i as f64).sin());
            }
            ParameterPoint {
                hours: CALIBRATION_H * part,
                estimate: Parameters::from_array(&estimate),
                sigma,
            }
        })
        .collect()
}

/// Errors that settle within the first half hour.
fn calibration_errors() -> SolutionSeries {
    let mut errors = SolutionSeries::of_stretches(500);
    for k in 0..(3600.0 * CALIBRATION_H) as usize {
        let hours = k as f64 / 3600.0;
        let settling = 5.0 * (-8.0 * hours).exp() + 0.1 * chance(k / 600);
        errors.push(hours, [settling, 0.1 * settling, -0.1 * settling, 1e-3 * settling, 0.0]);
    }
    errors
}

/// Octaves of a gyro with a random walk and a bias instability, and of an accelerometer with white noise
/// that scatter by a few per cent.
fn at_rest(base_moves: bool) -> RestRecord {
    let mut counts = DifferenceCounts::new(2);
    counts.add_stretch(2000);
    let octave = |k: usize| {
        let tau_s = 0.005 * (1u32 << k) as f64;
        let scatter = |channel: usize| 1.0 + 0.03 * chance(17 * k + channel);
        let (n, b, v) = (2e-7, 2e-8, 5e-4);
        let variance = std::array::from_fn(|channel| {
            let gyro = n * n / tau_s + 0.441_271 * b * b;
            scatter(channel) * if channel < 3 { gyro } else { v * v / tau_s }
        });
        RestOctave { tau_s, variance, counts }
    };
    RestRecord {
        sample_period_s: 0.005,
        base_moves,
        stretches: 19,
        at_rest_s: 14_000.0,
        longest_s: 1400.0,
        octaves: (0..16).map(octave).collect(),
    }
}

fn gimbals() -> Vec<GimbalPoint> {
    let mut points = Vec::new();
    for k in 0..8 + 240usize {
        let start = if k < 8 { 0.5 * k as f64 } else { CALIBRATION_H + 0.1 * (k - 8) as f64 };
        let length = if k < 8 { 0.5 } else { 0.1 };
        for (part, moving) in [(0.0, false), (0.85, true), (0.99, true)] {
            points.push(GimbalPoint {
                hours: start + part * length,
                azimuth_deg: 90.0 * (k % 4) as f64,
                roll_deg: 45.0 * (k % 3) as f64,
                moving,
                stop: None,
            });
        }
    }
    points
}

/// A run of 28 h at full length: 1 Hz of errors, every measurement of NIS that an observer keeps.
fn data() -> ReportData {
    let mut solution = SolutionSeries::default();
    for k in 0..(3600.0 * NAVIGATION_H) as usize {
        let hours = k as f64 / 3600.0;
        let schuler = (std::f64::consts::TAU * hours / 1.407).sin();
        let noise = 0.02 * chance(k);
        solution.push(
            hours,
            [
                0.8 * (hours / 6.0).sin() + noise,
                0.1 * schuler + noise,
                0.07 * schuler,
                0.2 * schuler + noise,
                -0.1 * schuler,
            ],
        );
    }
    let mut covariance = Box::new([[0.0; PARAMETER_COUNT]; PARAMETER_COUNT]);
    for i in 0..PARAMETER_COUNT {
        for j in 0..PARAMETER_COUNT {
            covariance[i][j] =
                if i == j { 1.0 } else { 0.9 * chance(i.max(j) * 31 + i.min(j)).powi(5) };
        }
    }
    let event = |hours: f64, name: &str| HealthEvent {
        hours,
        duration_s: 12.0,
        name: name.to_owned(),
        detail: "3 epochs".to_owned(),
    };
    let chi = |k: usize| (0..3).map(|axis| 3.0 * chance(3 * k + axis).powi(2)).sum::<f64>();
    let instrument = InstrumentNoise {
        gyro: [0.0, 2e-7, 2e-8, 0.0, 0.0],
        accelerometer: [0.0, 5e-4, 0.0, 0.0, 0.0],
    };
    let mut summary = Summary::from_json(include_str!("summary.json")).unwrap();
    summary.allan_deviation = AllanDeviation::of(&at_rest(false), Some(&instrument)).map(Box::new);
    let sigma = |k: usize| {
        let hours = CALIBRATION_H * k as f64 / 400.0;
        let sigma = 6.0 * (-8.0 * hours).exp() + 0.15;
        [hours, sigma, 0.1 * sigma, 0.1 * sigma, 1e-3 * sigma, 1e-3 * sigma]
    };
    summary.calibration.as_mut().unwrap().sigma_hours = (1..=400).map(sigma).collect();
    ReportData {
        stops: Vec::new(),
        summary,
        axes_of_source: None,
        facts: vec![("site".to_owned(), "30.5° latitude".to_owned())],
        truth: Some(Parameters::from_array(&[0.0; PARAMETER_COUNT])),
        convergence: convergence(),
        nis: (1..14_400)
            .map(|k| NisPoint { hours: k as f64 / 3600.0, nis: chi(k), innovation: None })
            .collect(),
        gimbals: gimbals(),
        baseline_solution: solution.clone(),
        calibration_errors: calibration_errors(),
        baseline_calibration_errors: SolutionSeries::default(),
        solution,
        navigation_start_h: Some(CALIBRATION_H),
        latitude_rad: Some(0.53),
        sample_period_s: Some(0.005),
        covariance: Some(covariance),
        requirement_clauses: std::collections::BTreeMap::new(),
        heading_condition: String::new(),
        requirement_texts: [("NAV-1".to_owned(), "The longitude <shall> stay close.".to_owned())]
            .into(),
        events: vec![event(1.2, "innovation rejected"), event(7.5, "gap")],
        dispositions: Default::default(),
        provenance: ReportProvenance { entries: vec![], rerun: "octant run".to_owned() },
        units: Default::default(),
    }
}

/// The page, kept beside the tests to be looked at.
fn page(data: &ReportData) -> String {
    let html = run::render(data);
    std::fs::write(std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("run.html"), &html)
        .unwrap();
    html
}

#[test]
fn a_run_of_28_h_is_one_small_file_with_every_plot() {
    let html = page(&data());
    assert!(html.len() < 3_000_000, "{} bytes", html.len());
    for title in [
        "Latitude error",
        "Longitude error",
        "Heading error",
        "Pitch error",
        "Roll error",
        "Velocity error north",
        "Velocity error east",
        "Mean NIS",
        "NIS",
        "Autocorrelation of the NIS",
        "Gimbal angles",
        "Correlation of the parameters",
        "Ground track of the position error",
        "gyro_bias_x",
        "accel_misalignment_zy",
        "Heading error during the calibration",
        "Velocity error east during the calibration",
        "Gyro x, deg/h",
        "Accelerometer z, ug",
    ] {
        assert!(html.contains(&format!("aria-label=\"{title}\"")), "no drawing of {title}");
    }
    assert!(!html.contains("NaN,") && !html.contains("\"d=\"NaN"));
}

/// Numbers of a column: singles, little-endian, in base64 with a tilde for N.
fn singles(column: &str) -> Vec<f32> {
    let digits = b"ABCDEFGHIJKLM~OPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let value = |c: u8| digits.iter().position(|digit| *digit == c).unwrap() as u32;
    let column = column.trim_end_matches('=').as_bytes();
    let bits = column.iter().flat_map(|c| (0..6).rev().map(|bit| (value(*c) >> bit) & 1));
    let bits: Vec<u32> = bits.collect();
    let bytes: Vec<u8> = bits
        .chunks_exact(8)
        .map(|byte| byte.iter().fold(0, |all, bit| 2 * all + *bit as u8))
        .collect();
    bytes.chunks_exact(4).map(|four| f32::from_le_bytes(four.try_into().unwrap())).collect()
}

#[test]
fn attitude_and_velocity_have_the_band_of_the_noise_and_say_so() {
    let block = |html: &str, title: &str| {
        let chart = html.split(&format!("aria-label=\"{title}\"")).nth(1).unwrap();
        let block = chart.split("application/json\">").nth(1).unwrap();
        block.split("</script>").next().unwrap().to_owned()
    };
    let mut data = data();
    let units = "arcsec,kn".parse().unwrap();
    data.units = data.units.with(units);
    let floor = Floor::new(0.53, 0.0, 2e-7, 5e-4).summary(3600.0 * NAVIGATION_H);
    let last = floor.sigma.last().unwrap();
    let sigma = last.solution.unwrap().heading_arcmin;
    data.summary.reference.as_mut().unwrap().random_walk = Some(floor.clone());
    let html = page(&data);
    for title in ["Heading", "Pitch", "Roll", "Velocity error north", "Velocity error east"] {
        let title = if title.contains(' ') { title.to_owned() } else { format!("{title} error") };
        assert!(block(&html, &title).contains("±1σ of random walk alone"), "{title}");
    }
    // The last column is the upper edge of the band, in arcsec.
    let heading = block(&html, "Heading error");
    let columns = heading.split("\"columns\":[").nth(1).unwrap().split(']').next().unwrap();
    let upper = singles(columns.rsplit(',').next().unwrap().trim_matches('"'));
    assert_eq!((upper.len(), upper[0]), (floor.sigma.len(), 0.0));
    let (found, expected) = (upper[upper.len() - 1], 60.0 * sigma);
    assert!((f64::from(found) / expected - 1.0).abs() < 1e-6, "found {found}, expected {expected}");
    // A summary from before the σ were kept: a plain legend.
    let old = data.summary.reference.as_mut().unwrap().random_walk.as_mut().unwrap();
    old.sigma.iter_mut().for_each(|point| point.solution = None);
    let html = page(&data);
    assert!(!block(&html, "Heading error").contains("random walk"));
    assert!(block(&html, "Latitude error").contains("±1σ of random walk alone"));
    assert!(!html.contains("The core tells no covariance"));
}

/// Numbers of a drawing: the block for the script.
fn block<'a>(html: &'a str, title: &str) -> &'a str {
    let chart = html.split(&format!("aria-label=\"{title}\"")).nth(1).unwrap();
    let block = chart.split("application/json\">").nth(1).unwrap();
    block.split("</script>").next().unwrap()
}

#[test]
fn the_noise_at_rest_has_points_curve_and_terms_in_the_units_of_data_sheets() {
    let data = data();
    let html = page(&data);
    let gyro = block(&html, "Gyro x, deg/h");
    for part in
        ["\"decades\":true", "\"dots\":true", "scenario\\u0027s instrument", "sum of the terms"]
    {
        assert!(gyro.contains(part), "{part} is not in {gyro}");
    }
    let columns = gyro.split("\"columns\":[").nth(1).unwrap();
    let columns: Vec<Vec<f32>> = columns
        .split(']')
        .next()
        .unwrap()
        .split(',')
        .map(|column| singles(column.trim_matches('"')))
        .collect();
    // The axis of x has the decimal logarithm of the averaging time.
    let series = &data.summary.allan_deviation.as_ref().unwrap().gyro.x.series;
    let times = columns.iter().find(|column| column.len() == series.len()).unwrap();
    assert!((f64::from(times[3]) - 0.04f64.log10()).abs() < 1e-6, "{times:?}");
    let section = html.split("<h2 id=\"noise\">").nth(1).unwrap().split("</section>").next();
    let section = section.unwrap();
    // 2e-7 rad/√s, 2e-8 rad/s; 5e-4 (m/s²)/√Hz.
    for part in ["19 stretches", "deg/sqrt(h)", "0.000688", "0.00413", "ug/sqrt(Hz)", "51.0"] {
        assert!(section.contains(part), "{part} is not in {section}");
    }
    assert!(section.contains("below ") && !section.contains("The base may move"));
    assert!(!section.contains("don't describe"));
}

#[test]
fn a_deviation_of_a_moving_base_says_so_and_has_no_terms() {
    let mut data = data();
    data.summary.allan_deviation = AllanDeviation::of(&at_rest(true), None).map(Box::new);
    let html = page(&data);
    let section = html.split("<h2 id=\"noise\">").nth(1).unwrap().split("</section>").next();
    let section = section.unwrap();
    assert!(section.contains("The base may move.") && !section.contains("Noise terms"));
    assert!(!block(&html, "Gyro x, deg/h").contains("sum of the terms"));
    data.summary.allan_deviation = None;
    assert!(!page(&data).contains("id=\"noise\""), "a run without a stretch at rest");
}

#[test]
fn errors_during_the_calibration_have_the_band_of_the_filter() {
    let mut data = data();
    let html = page(&data);
    let heading = block(&html, "Heading error during the calibration");
    assert!(heading.contains("±σ of the filter") && heading.contains("\"offset\":0,"));
    // The first tenth, with errors of 5 arcmin, doesn't set the scale.
    let range = heading.split("\"range\":[").nth(1).unwrap().split(']').next().unwrap();
    let high: f64 = range.split(',').nth(1).unwrap().parse().unwrap();
    assert!((0.2..2.0).contains(&high), "{range}");
    // A core over a wire tells no σ.
    data.summary.calibration.as_mut().unwrap().sigma_hours.clear();
    let html = page(&data);
    assert!(!block(&html, "Heading error during the calibration").contains("±σ of the filter"));
    assert!(html.contains("The filter's σ isn't known"));
    data.calibration_errors = SolutionSeries::default();
    assert!(!page(&data).contains("during the calibration\""));
}

#[test]
fn every_section_has_an_anchor_and_an_entry_in_the_contents() {
    let html = page(&data());
    let anchors: Vec<&str> =
        html.split("<h2 id=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
    assert!(anchors.len() >= 6, "{anchors:?}");
    let contents = html.split("<nav").nth(1).unwrap().split("</nav>").next().unwrap();
    for anchor in &anchors {
        assert!(
            contents.contains(&format!("href=\"#{anchor}\"")),
            "{anchor} isn't in the contents"
        );
    }
    assert_eq!(contents.matches("<a ").count(), anchors.len());
    // Sections without content are in neither.
    assert!(!anchors.contains(&"faults"));
}

#[test]
fn a_requirement_has_its_unit_and_its_text() {
    let html = page(&data());
    let row = html.split("<tr id=\"req-NAV-1\">").nth(1).unwrap().split("</tr>").next().unwrap();
    for part in ["arcmin", "The longitude &lt;shall&gt; stay close.", "≤ 3", "badge pass", "0.7507"]
    {
        assert!(row.contains(part), "{part} is not in {row}");
    }
}

#[test]
fn markers_have_the_times_of_the_run() {
    let html = page(&data());
    let marks = html.split("<script id=\"marks\" type=\"application/json\">").nth(1).unwrap();
    let marks = marks.split("</script>").next().unwrap();
    assert!(marks.contains("[7.500000,7.503333,\"gap\"]"), "{marks}");
    assert!(marks.contains("\"stops\":[[0.000000,0.425000,\"1\"]"), "{marks}");
}

#[test]
fn plots_over_the_navigation_begin_where_it_began() {
    let html = page(&data());
    let heading = html.split("aria-label=\"Heading error\"").nth(1).unwrap();
    let block =
        heading.split("application/json\">").nth(1).unwrap().split("</script>").next().unwrap();
    assert!(block.contains("\"offset\":4,"), "{}", &block[..200]);
    // Errors of 86 400 s in at most 2000 stretches of two points: columns of x and y for two methods.
    assert!(block.len() < 100_000, "{}", block.len());
}

#[test]
fn many_moves_are_drawn_from_their_beginning() {
    let html = page(&data());
    assert!(html.contains("240 moves in") && html.contains("The first 32 moves are drawn."));
}
