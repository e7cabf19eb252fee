//! Navigations that followed their samples, and navigations that didn't, through whole runs.

use octant_base::control::Control;
use octant_endpoint::{Conclusion, Endpoint, EndpointError, InProcess};
use octant_fmu_bind::OpenedFmus;
use octant_run::{Parts, SteppedRun, StreamKeeping, assemble, core_of, run_method};
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{Epoch, Mode, Navigation, Output, Parameters};
use octant_scenario::{Method, Scenario};
use octant_score::summary::{Followed, FollowedScore, KnownNoise, Summary};
use octant_verdict::Verdict;
use std::path::Path;

/// Half an hour of calibration at two stops, then navigation, at 50 Hz.
fn scenario(navigation: &str, more: &str) -> Scenario {
    let text = format!(
        "schema = 1\nseed = 3\n[imu]\nrate = \"50 Hz\"\n[procedure.calibration]\nduration = \"30 min\"\n\
         stops = [{{ azimuth = \"0 deg\", roll = \"0 deg\" }}, {{ azimuth = \"0 deg\", roll = \"45 deg\" }}]\n\
         [procedure.navigation]\nduration = \"{navigation}\"\n{more}\n\
         [[requirements]]\nid = \"NEAR\"\ntext = \"It stays near.\"\n\
         measure = \"navigation.radial_error_nmi.max\"\nlimit = \"20 nmi\"\n"
    );
    Scenario::parse(&text, "followed.toml", Path::new(""), &[]).unwrap()
}

/// A core whose answers are altered.
struct Twisted<F> {
    core: InProcess,
    twist: F,
}

impl<F: FnMut(&Epoch, &mut Output)> Endpoint for Twisted<F> {
    fn step(&mut self, epoch: &Epoch, output: &mut Output) -> Result<(), EndpointError> {
        self.core.step(epoch, output)?;
        if output.mode == Mode::Navigating {
            (self.twist)(epoch, output);
        }
        Ok(())
    }

    fn uri(&self) -> String {
        "twisted".to_owned()
    }

    fn restart(&mut self, offset: Option<&Parameters>) -> Result<(), EndpointError> {
        self.core.restart(offset)
    }

    fn parameters(&self) -> ParameterEstimate {
        self.core.parameters()
    }

    fn conclusion(&mut self) -> Conclusion {
        self.core.conclusion()
    }
}

/// Runs a unit whose answers are altered.
fn run(scenario: &Scenario, twist: impl FnMut(&Epoch, &mut Output) + Send + 'static) -> Summary {
    let core = core_of(scenario, Method::Primary, scenario.seed).unwrap();
    let unit = Twisted { core: InProcess::new(&core).unwrap(), twist };
    let parts = Parts { unit: Some(("twisted".to_owned(), Box::new(unit))), ..Parts::default() };
    let fmus = OpenedFmus::default();
    let mut run = SteppedRun::new(
        scenario,
        Method::Primary,
        scenario.seed,
        StreamKeeping::None,
        parts,
        &fmus,
    )
    .unwrap();
    while run.step() {}
    assemble(scenario, scenario.seed, run.finish().unwrap(), None).unwrap().summary
}

fn followed(summary: &Summary) -> &FollowedScore {
    summary.followed.as_ref().unwrap()
}

/// Noise that a unit makes up: uniform, of variance 1.
struct MadeUp(u64);

impl MadeUp {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0) * 1.732
    }
}

#[test]
fn the_core_follows() {
    let scenario = scenario("1 h", "");
    let run = run_method(&scenario, Method::Primary, 3, StreamKeeping::None, &Control::default())
        .unwrap();
    let summary = assemble(&scenario, 3, run, None).unwrap().summary;
    let score = followed(&summary);
    assert_eq!(score.verdict, Followed::Followed);
    for channel in [score.attitude.unwrap(), score.velocity.unwrap()] {
        assert!((channel.slope - 1.0).abs() < 0.02 && channel.sigma < 0.01, "{channel:?}");
        assert_eq!(channel.lag_s, 0.0);
    }
    assert_eq!(summary.verdict, Verdict::Pass, "{:?}", summary.reasons);
}

#[test]
fn a_unit_that_knows_where_it_stands_did_not_follow() {
    let scenario = scenario("1 h", "");
    let (mut first, mut noise) = (None, MadeUp(1));
    let summary = run(&scenario, move |_, output| {
        let mut site: Navigation = *first.get_or_insert(output.navigation);
        site.velocity_mps = [0.0; 3];
        site.latitude_rad += 1e-12 * noise.next();
        site.velocity_mps[0] += 1e-12 * noise.next();
        site.velocity_mps[1] += 1e-12 * noise.next();
        // The attitude is the unit's own.
        site.q_nb = output.navigation.q_nb;
        output.navigation = site;
    });
    let score = followed(&summary);
    assert_eq!(score.verdict, Followed::NotFollowed);
    assert_eq!(summary.verdict, Verdict::Inconclusive, "{:?}", summary.reasons);
}

#[test]
fn an_attitude_from_the_encoders_did_not_follow() {
    let scenario = scenario("1 h", "");
    let mut noise = MadeUp(2);
    let summary = run(&scenario, move |epoch, output| {
        let (azimuth, roll) = (epoch.sample.gimbal.azimuth_rad(), epoch.sample.gimbal.roll_rad());
        let c =
            octant_earth::frames::c_nc(0.0, 0.0, 0.0) * octant_earth::frames::c_cb(azimuth, roll);
        let q = octant_earth::frames::quaternion_from_matrix(&c);
        output.navigation.q_nb = [q.w, q.i, q.j, q.k].map(|part| part + 1e-12 * noise.next());
    });
    let score = followed(&summary);
    assert_eq!(score.verdict, Followed::NotFollowed);
    assert_eq!(score.velocity.unwrap().verdict, Followed::Followed);
    assert!(
        summary.reasons[0].contains("the attitude of the navigation doesn't follow"),
        "{summary:?}"
    );
    assert_eq!(summary.verdict, Verdict::Inconclusive);
}

#[test]
fn a_short_navigation_is_not_tested_and_says_so() {
    let scenario = scenario("20 s", "");
    let summary = run(&scenario, |_, _| {});
    let score = followed(&summary);
    assert_eq!(score.verdict, Followed::NotTested);
    assert!(score.reason.as_ref().unwrap().contains("too few"), "{score:?}");
    assert_eq!(summary.verdict, Verdict::Pass, "{:?}", summary.reasons);
}

#[test]
fn a_gain_and_the_alarms_are_measures() {
    let scenario = scenario("2 min", "");
    let summary = run(&scenario, |_, _| {});
    let calibration = summary.calibration.as_ref().unwrap();
    let least = calibration.least_gain.unwrap();
    assert!((1.0..1.5).contains(&least), "two stops leave a parameter as it was: {least}");
    let gain = calibration.parameters["accel_bias_z"].gain.unwrap();
    assert!(gain > least, "{gain}");
    assert_eq!(summary.false_alarms, Some(0));
}

/// Records a simulated run, and replays its samples with dither to a core in this process.
fn replayed(dither: Option<f64>) -> Summary {
    let folder = tempfile::tempdir().unwrap();
    let recorded = scenario("3 h", "[record]\nsamples = \"full\"");
    let file = folder.path().join("recording.mcap");
    let keeping = StreamKeeping::File(&file);
    run_method(&recorded, Method::Primary, 3, keeping, &Control::default()).unwrap();
    let dither = dither.map_or(String::new(), |part| format!("dither = {part}\n"));
    let again =
        scenario("3 h", &format!("[source]\nuri = \"replay:{}\"\n{dither}", file.display()));
    let run = run_method(&again, Method::Primary, 3, StreamKeeping::None, &Control::default());
    assemble(&again, 3, run.unwrap(), None).unwrap().summary
}

#[test]
fn a_recording_is_tested_with_dither_alone() {
    let without = replayed(None);
    let score = followed(&without);
    assert_eq!(score.verdict, Followed::NotTested);
    assert!(score.reason.as_ref().unwrap().contains("isn't known"), "{score:?}");
    let with = replayed(Some(0.5));
    let score = followed(&with);
    assert_eq!((score.verdict, score.known), (Followed::Followed, Some(KnownNoise::Dither)));
    let attitude = score.attitude.unwrap();
    assert!((attitude.slope - 1.0).abs() < 5.0 * attitude.sigma, "{attitude:?}");
}
