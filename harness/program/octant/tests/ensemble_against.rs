//! A predicted ensemble compared with a campaign: results drawn from the prediction agree with it,
//! and others are named.
//!
//! The results are synthetic, normal with the predicted σ, so that the expected outcome is known.

use crate::common::program::{ended, octant_in};
use octant_base::display::DisplayUnits;
use octant_campaign::against::{Against, RUNS_MIN, Selection, against};
use octant_campaign::execute::case::{self, CaseResult};
use octant_campaign::plan::Plan;
use octant_observe::ensemble::{Ensemble, ensemble};
use octant_random::normal::Ziggurat;
use octant_random::stream::{Phase, key};
use octant_sample::parameters::NAMES;
use octant_scenario::{Method, Scenario};
use octant_score::judge::judge;
use octant_score::summary::{
    CalibrationScore, ErrorScore, HealthCounts, HeightChannel, NavigationScore, ParameterScore,
    RadialScore, SCHEMA, Summary,
};
use octant_verdict::Verdict;
use std::collections::BTreeMap;
use tempfile::TempDir;

const SCENARIO: &str = "schema = 1\ntitle = \"short\"\n[imu]\nrate = \"20 Hz\"\n\
    [procedure.calibration]\nduration = \"24 min\"\n[procedure.navigation]\nduration = \"1 h\"\n";
const FAULT: &str = "[[faults]]\nid = \"spike-1\"\nkind = \"spike\"\ntrigger = { at = \"500 s\" }\n\
    channels = \"gyro x\"\namplitude = \"100 deg/h\"\n";

struct Bench {
    folder: TempDir,
    plan: Plan,
    predicted: Ensemble,
}

impl Bench {
    fn new(replicates: usize, scenario: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("short.toml"), scenario).unwrap();
        let campaign = format!(
            "schema = 1\ntitle = \"c\"\nreplicates = {replicates}\n\
             [[scenarios]]\nid = \"short\"\nfile = \"short.toml\"\n"
        );
        let path = folder.path().join("campaign.toml");
        std::fs::write(&path, campaign).unwrap();
        let plan = Plan::of(&path).unwrap();
        let scenario = Scenario::load(&folder.path().join("short.toml"), &[]).unwrap();
        let predicted = ensemble(&scenario, Method::Primary).unwrap();
        Self { folder, plan, predicted }
    }

    /// Stores results drawn from the prediction, after `change` has altered them.
    fn keep(&self, change: impl Fn(usize, &mut Summary)) {
        for (run, case) in self.plan.cases.iter().enumerate() {
            let mut summary = self.summary(run as u64);
            change(run, &mut summary);
            judge(&mut summary, &[], &[]).unwrap();
            let hash = case::hash_of(self.plan.planned(case).unwrap(), case);
            let result = CaseResult::of(&case.id, Some(hash), summary).unwrap();
            let json = result.to_json().unwrap();
            octant_campaign::store::keep(self.folder.path(), &case.id, json.as_bytes()).unwrap();
        }
    }

    fn summary(&self, run: u64) -> Summary {
        let normal = |name: &str| Ziggurat::shared().three(key(run, name, Phase::Draw), 0)[0];
        let parameter = |name: &str| {
            let state = self.predicted.states.iter().find(|state| state.name == name).unwrap();
            ParameterScore {
                r#true: Some(0.0),
                estimate: 0.0,
                sigma: state.believed,
                gain: None,
                error: Some(state.mean + state.sigma * normal(name)),
                normalized: None,
                unit: state.unit.clone(),
            }
        };
        let (north, east) = (normal("latitude"), normal("longitude"));
        let series = self.predicted.drift.iter().map(|band| {
            let [latitude, longitude] = [band.latitude_arcmin, band.longitude_arcmin];
            [
                band.hours,
                latitude.mean + latitude.sigma * north,
                longitude.mean + longitude.sigma * east,
            ]
        });
        let score = ErrorScore {
            max: 0.0,
            rms: 0.0,
            r#final: 0.0,
            slope_per_day: None,
            schuler_amplitude: None,
        };
        Summary {
            schema: SCHEMA,
            octant: "0.1.0".to_owned(),
            numerics: None,
            scenario: "short".to_owned(),
            seed: run,
            verdict: Verdict::None,
            reasons: Vec::new(),
            requirements: Vec::new(),
            findings: Vec::new(),
            decision: None,
            planned: None,
            done: None,
            faults: Vec::new(),
            inputs: Vec::new(),
            altered_streams: None,
            heading: None,
            false_alarms: None,
            followed: None,
            method: "eight".to_owned(),
            calibration: Some(CalibrationScore {
                reference: None,
                solution: None,
                positions: "eight".to_owned(),
                estimator: "kalman".to_owned(),
                duration_h: 0.4,
                parameters: NAMES.map(|name| (name.to_owned(), parameter(name))).into(),
                further: BTreeMap::new(),
                nis_mean: Some(3.0),
                nis_expected: None,
                rest: None,
                nees: BTreeMap::new(),
                worst_normalized_error: None,
                least_gain: None,
                refused: None,
                refusal_explained: Vec::new(),
                health: HealthCounts::default(),
                sigma_hours: Vec::new(),
            }),
            navigation: Some(NavigationScore {
                duration_h: 1.0,
                height: HeightChannel::Held,
                latitude_error_arcmin: Some(score),
                longitude_error_arcmin: Some(score),
                radial_error_nmi: Some(RadialScore {
                    max: 0.0,
                    rms: 0.0,
                    r#final: 0.0,
                    rate_per_h: 0.0,
                }),
                heading_output: None,
                heading_error_arcmin: None,
                pitch_error_arcmin: None,
                roll_error_arcmin: None,
                velocity_north_error_mps: None,
                velocity_east_error_mps: None,
                slope_window: None,
                marks: BTreeMap::new(),
                gaps: None,
                series_hours: std::iter::once([0.0; 3]).chain(series).collect(),
            }),
            alignment: None,
            counterfactual: None,
            baseline: None,
            reference: None,
            allan_deviation: None,
            pacing: None,
            stream_hash: format!("{run:064x}"),
        }
    }

    fn against(&self) -> Against {
        against(&self.plan, self.folder.path(), &Selection::default()).unwrap()
    }
}

fn error<'a>(summary: &'a mut Summary, name: &str) -> &'a mut f64 {
    let parameters = &mut summary.calibration.as_mut().unwrap().parameters;
    parameters.get_mut(name).unwrap().error.as_mut().unwrap()
}

#[test]
fn what_is_drawn_from_the_prediction_agrees_with_it() {
    let bench = Bench::new(200, SCENARIO);
    bench.keep(|_, _| ());
    let found = bench.against();
    let [one] = found.compared.as_slice() else { panic!("{found:?}") };
    assert_eq!((one.runs, one.open, one.without, one.stands), (200, 0, 0, Some(true)));
    assert_eq!((one.states.len(), one.drift.len()), (30, 12));
    // Mean of thirty σ of 200 runs each: the σ have an error of 5 %, so the mean has 5 %/√30, about
    // 1 %.
    assert!((one.mean_ratio.unwrap() - 1.0).abs() < 0.03, "{:?}", one.mean_ratio);
    for row in one.states.iter().chain(&one.drift) {
        assert!(row.simulated_sigma.low < row.simulated_sigma.value, "{row:?}");
        assert!((row.ratio.unwrap() - 1.0).abs() < 0.2, "{row:?}");
    }
    assert!(one.words[0].contains("can stand for these runs"), "{:?}", one.words);
    // Read again as a report does.
    let read: Against = serde_json::from_str(&serde_json::to_string(&found).unwrap()).unwrap();
    assert_eq!(read.compared[0].states.len(), 30);
}

#[test]
fn what_differs_is_named_with_how_much() {
    let bench = Bench::new(100, SCENARIO);
    let sigma =
        |name: &str| bench.predicted.states.iter().find(|state| state.name == name).unwrap().sigma;
    let shift = sigma("accel_bias_y");
    bench.keep(|_, summary| {
        *error(summary, "g_zz") *= 2.0;
        *error(summary, "accel_bias_y") += shift;
    });
    let found = bench.against();
    let one = &found.compared[0];
    assert_eq!(one.stands, Some(false));
    let differing: Vec<&str> =
        one.states.iter().filter(|row| !row.agrees).map(|row| row.name.as_str()).collect();
    assert_eq!(differing, ["g_zz", "accel_bias_y"]);
    assert!(one.words[0].contains("can't stand"), "{:?}", one.words);
    assert!(one.words.iter().any(|w| w.starts_with("g_zz: σ is")), "{:?}", one.words);
    assert!(one.words.iter().any(|w| w.starts_with("accel_bias_y: the mean")), "{:?}", one.words);
}

#[test]
fn too_few_runs_say_nothing_and_refused_ones_are_counted() {
    let bench = Bench::new(RUNS_MIN - 20, SCENARIO);
    bench.keep(|run, summary| {
        if run < 3 {
            summary.calibration.as_mut().unwrap().refused = Some("it drifts".to_owned());
        }
    });
    let one = &bench.against().compared[0];
    assert_eq!((one.runs, one.without, one.stands), (RUNS_MIN - 23, 3, None));
    assert!(one.words[0].contains("only"), "{:?}", one.words);
    let detects = one.detects.unwrap();
    assert!(detects.ratio_below < 0.6 && detects.ratio_above > 1.5, "{detects:?}");
    // However many others agree, a prediction doesn't hold for runs without a result.
    let bench = Bench::new(RUNS_MIN + 10, SCENARIO);
    bench.keep(|run, summary| {
        if run < 1 {
            summary.calibration.as_mut().unwrap().refused = Some("it drifts".to_owned());
        }
    });
    let one = &bench.against().compared[0];
    assert_eq!((one.runs, one.without, one.stands), (RUNS_MIN + 9, 1, None));
    assert!(one.words[0].contains("it can't stand for them"), "{:?}", one.words);
}

#[test]
fn a_run_that_is_told_again_is_no_second_draw() {
    let bench = Bench::new(RUNS_MIN + 10, SCENARIO);
    let first = bench.summary(0);
    bench.keep(|run, summary| {
        if run < 20 {
            *summary = first.clone();
        }
    });
    let one = &bench.against().compared[0];
    assert_eq!((one.runs, one.repeated, one.without, one.stands), (RUNS_MIN - 9, 19, 0, None));
    assert!(
        one.words.iter().any(|w| w.starts_with("19 cases are the same runs")),
        "{:?}",
        one.words
    );
    let bench = Bench::new(12, SCENARIO);
    bench.keep(|_, summary| *summary = first.clone());
    let found = bench.against();
    assert!(found.compared.is_empty() && found.left_out[0].contains("11 more"));
}

#[test]
fn cases_with_faults_are_left_out() {
    let bench = Bench::new(4, &format!("{SCENARIO}{FAULT}"));
    bench.keep(|_, _| ());
    let found = bench.against();
    assert!(found.compared.is_empty());
    assert!(found.left_out[0].contains("4 cases have faults"), "{:?}", found.left_out);
    let other = Selection { blake3: Some("00"), set: None };
    assert!(against(&bench.plan, bench.folder.path(), &other).is_err());
}

/// At the site of the scenario, 30.5° N, WGS 84 has minutes of arc of 1847.682 m and 1599.982 m.
#[test]
fn a_comparison_in_other_units_is_converted_and_concludes_the_same() {
    let bench = Bench::new(RUNS_MIN + 10, SCENARIO);
    bench.keep(|_, summary| {
        let series = &mut summary.navigation.as_mut().unwrap().series_hours;
        series.iter_mut().for_each(|[_, latitude, _]| *latitude *= 3.0);
    });
    let found = bench.against();
    let one = &found.compared[0];
    let units = DisplayUnits { arcmin_m: [1850.0, 930.0], ..DisplayUnits::default() };
    let other = one.shown(&units.with("m,deg".parse().unwrap()));
    assert_eq!((other.stands, &other.states), (Some(false), &one.states));
    for (own, shown) in one.drift.iter().zip(&other.drift) {
        let factor = if own.name.starts_with("latitude") { 1850.0 } else { 930.0 };
        assert_eq!((own.unit.as_str(), shown.unit.as_str()), ("arcmin", "m"));
        assert_eq!((own.agrees, own.ratio), (shown.agrees, shown.ratio));
        for (own, shown) in [
            (own.predicted_sigma, shown.predicted_sigma),
            (own.predicted_mean, shown.predicted_mean),
            (own.simulated_sigma.high, shown.simulated_sigma.high),
            (own.simulated_mean.low, shown.simulated_mean.low),
        ] {
            assert_eq!(own * factor, shown);
        }
    }
    let told = |words: &[String]| words.iter().find(|w| w.starts_with("latitude at")).cloned();
    let row = other.drift.iter().find(|row| !row.agrees).unwrap();
    let expected = format!(
        "{}: σ is {:.2} m predicted and {:.2} simulated",
        row.name, row.predicted_sigma, row.simulated_sigma.value
    );
    assert_eq!(told(&other.words), Some(expected));
    assert!(told(&one.words).unwrap().contains(" arcmin predicted"));
    assert_eq!(one.shown(&DisplayUnits::default()), *one);

    bench.plan.write(bench.folder.path(), false).unwrap();
    let observed = |more: &[&str]| {
        let words = ["observe", "short.toml", "--ensemble", "--against", "."];
        ended(octant_in(bench.folder.path(), &[&words[..], more].concat()), 1).0
    };
    let text = observed(&["--units", "m,deg"]);
    for (name, metres) in [("latitude", 1_847.681_861), ("longitude", 1_599.982_122)] {
        let row = one.drift.iter().find(|row| row.name.starts_with(name)).unwrap();
        let line = text.lines().find(|line| {
            // Rows of the table only: the conclusion below it names the same quantities.
            line.trim_start().starts_with(&row.name) && !line.contains("predicted and")
        });
        let line = line.unwrap_or_else(|| panic!("no {} in {text}", row.name));
        let predicted = octant_base::number::significant(row.predicted_sigma * metres, 4);
        assert!(line.contains(&format!(" {predicted} ")) && line.contains("  m"), "{line}");
    }
}
