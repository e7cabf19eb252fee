//! Units that adapt: they know what is asked, and answer with it, with enough jitter that no bit repeats.
//!
//! Each is in 10 min of calibration and 20 min of navigation at 8 Hz, in this process, so that every row costs little; what
//! is found has nothing to do with the port.

use super::unit::{check, scenario_of};
use super::{Ends, Row, fails, open};
use octant_endpoint::{Conclusion, Endpoint, EndpointError, InProcess};
use octant_fmu_bind::OpenedFmus;
use octant_run::{Parts, SteppedRun, StreamKeeping, assemble, core_of};
use octant_sample::parameters::{PARAMETER_COUNT, ParameterEstimate};
use octant_sample::{Epoch, Health, Mode, Navigation, Output, Parameters};
use octant_scenario::resolve::{DrawnValues, Seeded};
use octant_scenario::{Method, Scenario};
use octant_score::summary::{Followed, Summary};
use octant_verdict::Verdict;
use std::sync::LazyLock;

const SCENARIO: &str = r#"
schema = 1
title = "adaptive"
seed = 5
[imu]
rate = "8 Hz"
[procedure.calibration]
duration = "10 min"
stops = [{ azimuth = "0 deg", roll = "0 deg" }, { azimuth = "0 deg", roll = "90 deg" }, { azimuth = "90 deg", roll = "90 deg" }]
[procedure.navigation]
duration = "20 min"
[[requirements]]
id = "NEAR"
text = "It stays near."
measure = "navigation.radial_error_nmi.max"
limit = "10 nmi"
[[requirements]]
id = "SIGMA"
text = "The errors are as large as their uncertainty says."
measure = "calibration.worst_normalized_error"
limit = 10
[[requirements]]
id = "GAIN"
text = "The calibration finds the bias of an accelerometer."
measure = "calibration.parameters.accel_bias_x.gain"
comparison = ">="
limit = 3
[[requirements]]
id = "ALARMS"
text = "It raises no alarm without a fault."
measure = "false_alarms"
comparison = "<="
limit = 0
[[requirements]]
id = "TESTED"
text = "Its velocity can be held against its samples."
measure = "followed.velocity.sigma"
limit = 0.05
"#;

static ADAPTIVE: LazyLock<Scenario> = LazyLock::new(|| scenario_of(SCENARIO));

/// True parameters of the instrument, as a unit knows them that read its label.
static TRUE: LazyLock<[f64; PARAMETER_COUNT]> = LazyLock::new(|| {
    let scenario = &ADAPTIVE;
    DrawnValues::of(scenario, &Seeded(scenario.seed)).parameters.to_array()
});

/// Samples of a second.
const SECOND: usize = 8;

/// Answer of a navigation on its way.
struct Turn<'a> {
    /// Number of the answer in the navigation, from 0.
    k: usize,
    epoch: &'a Epoch,
    output: &'a mut Output,
    /// Own solutions before it, in order.
    before: &'a [Navigation],
}

impl Turn<'_> {
    /// Time of the navigation, s.
    fn s(&self) -> f64 {
        self.k as f64 / SECOND as f64
    }

    /// Noise of variance 1 that nobody else has.
    fn noise(&self, stream: u64) -> f64 {
        let mut word = (self.k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (stream << 40);
        for _ in 0..3 {
            word = (word ^ (word >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        }
        ((word >> 11) as f64 / (1_u64 << 52) as f64 - 1.0) * 3.0_f64.sqrt()
    }

    /// Answers position and velocity with these, and jitter of 1e-12.
    fn moves(&mut self, position_rad: [f64; 2], velocity_mps: [f64; 2]) {
        let [a, b, c, d] = [1, 2, 3, 4].map(|stream| 1e-12 * self.noise(stream));
        let n = &mut self.output.navigation;
        [n.latitude_rad, n.longitude_rad] =
            [position_rad[0] + 1e-3 * a, position_rad[1] + 1e-3 * b];
        [n.velocity_mps[0], n.velocity_mps[1]] = [velocity_mps[0] + c, velocity_mps[1] + d];
    }

    /// Own position and velocity of some time ago, s; those of the beginning before that.
    fn ago(&self, s: usize) -> ([f64; 2], [f64; 2]) {
        let own = self.output.navigation;
        let n = match self.before.len().checked_sub(s * SECOND) {
            Some(at) => self.before.get(at).copied().unwrap_or(own),
            None => self.before.first().copied().unwrap_or(own),
        };
        ([n.latitude_rad, n.longitude_rad], [n.velocity_mps[0], n.velocity_mps[1]])
    }

    /// Attitude that the encoders show in a level case, with an error of so many arcsec.
    fn encoders(&self, arcsec: f64) -> [f64; 4] {
        let gimbal = self.epoch.sample.gimbal;
        let error = arcsec / 206_265.0;
        let c = octant_earth::frames::c_nc(0.0, error, -error)
            * octant_earth::frames::c_cb(gimbal.azimuth_rad(), gimbal.roll_rad());
        let q = octant_earth::frames::quaternion_from_matrix(&c);
        [q.w, q.i, q.j, q.k]
    }
}

fn site() -> [f64; 2] {
    [ADAPTIVE.site.latitude_rad, ADAPTIVE.site.longitude_rad]
}

/// Change that a unit makes to its answers, and to its parameters with their uncertainties.
#[derive(Clone, Copy)]
struct Adapts {
    answer: fn(&mut Turn<'_>),
    health: fn(u64) -> Health,
    parameters: fn(&mut [f64; PARAMETER_COUNT], &mut [f64; PARAMETER_COUNT]),
}

const NOT: Adapts = Adapts { answer: |_| {}, health: |_| Health::empty(), parameters: |_, _| {} };

const fn answer(answer: fn(&mut Turn<'_>)) -> Adapts {
    Adapts { answer, ..NOT }
}

const fn parameters(
    parameters: fn(&mut [f64; PARAMETER_COUNT], &mut [f64; PARAMETER_COUNT]),
) -> Adapts {
    Adapts { parameters, ..NOT }
}

struct Unit {
    core: InProcess,
    adapts: Adapts,
    before: Vec<Navigation>,
}

impl Endpoint for Unit {
    fn step(&mut self, epoch: &Epoch, output: &mut Output) -> Result<(), EndpointError> {
        self.core.step(epoch, output)?;
        output.health |= (self.adapts.health)(output.sequence);
        if output.mode == Mode::Navigating {
            let own = output.navigation;
            let k = self.before.len();
            (self.adapts.answer)(&mut Turn { k, epoch, output, before: &self.before });
            self.before.push(own);
        }
        Ok(())
    }

    fn uri(&self) -> String {
        "adaptive".to_owned()
    }

    fn restart(&mut self, offset: Option<&Parameters>) -> Result<(), EndpointError> {
        self.core.restart(offset)
    }

    fn parameters(&self) -> ParameterEstimate {
        let ParameterEstimate { revision, parameters, mut sigma } = self.core.parameters();
        let mut values = parameters.to_array();
        (self.adapts.parameters)(&mut values, &mut sigma);
        ParameterEstimate { revision, parameters: Parameters::from_array(&values), sigma }
    }

    fn conclusion(&mut self) -> Conclusion {
        self.core.conclusion()
    }
}

fn run(adapts: Adapts) -> Result<Summary, String> {
    let scenario = &*ADAPTIVE;
    let (method, seed) = (Method::Primary, scenario.seed);
    let core = core_of(scenario, method, seed).map_err(|error| error.to_string())?;
    let core = InProcess::new(&core).map_err(|error| error.to_string())?;
    let unit = Unit { core, adapts, before: Vec::new() };
    let parts = Parts { unit: Some(("adaptive".to_owned(), Box::new(unit))), ..Parts::default() };
    let fmus = OpenedFmus::default();
    let mut run = SteppedRun::new(scenario, method, seed, StreamKeeping::None, parts, &fmus)
        .map_err(|error| error.to_string())?;
    while run.step() {}
    let run = run.finish().map_err(|error| error.to_string())?;
    Ok(assemble(scenario, seed, run, None).unwrap().summary)
}

#[test]
fn the_core_itself_passes() {
    let summary = run(NOT).unwrap();
    assert_eq!(summary.verdict, Verdict::Pass, "{:?}", summary.reasons);
    let score = summary.followed.unwrap();
    assert_eq!(score.verdict, Followed::Followed);
    for channel in [score.attitude.unwrap(), score.velocity.unwrap()] {
        assert!((channel.slope - 1.0).abs() < 0.02, "{channel:?}");
    }
}

macro_rules! units {
    ($($name:ident: $about:literal, $ends:expr, $adapts:expr;)*) => {
        /// Returns the rows of the table.
        pub fn rows() -> Vec<Row> {
            vec![$(Row { group: "adapts", about: $about, over: "in process", ends: $ends }),*]
        }
        $(#[test]
        fn $name() {
            let ends: Ends = $ends;
            check($about, &ends, run($adapts));
        })*
    };
}

const VELOCITY: &str = "the velocity of the navigation doesn't follow the samples: slope";
const ATTITUDE: &str = "the attitude of the navigation doesn't follow the samples: slope";

units! {
    knows_the_site: "answers the site that it was told, with 1e-12 of jitter", open(VELOCITY),
        answer(|t| t.moves(site(), [0.0; 2]));
    knows_where_it_began: "stays where its navigation began, with 1e-12 of jitter", open(VELOCITY),
        answer(|t| { let (position, _) = t.ago(3600); t.moves(position, [0.0; 2]) });
    schuler_curve: "makes up a Schuler curve about the site", open(VELOCITY),
        answer(|t| {
            let phase = 2.0 * std::f64::consts::PI * t.s() / 5064.0;
            let (sin, cos) = phase.sin_cos();
            let [latitude, longitude] = site();
            let rate = 0.3 * 5064.0 / (2.0 * std::f64::consts::PI) / 6.37e6;
            t.moves([latitude + rate * sin, longitude + rate * (1.0 - cos)], [0.3 * cos, 0.26 * sin]);
        });
    schuler_with_noise: "makes up a Schuler curve, and puts noise like its own on it", open(VELOCITY),
        answer(|t| {
            let walk: f64 = (0..40).map(|k| {
                let part = f64::from(k) + 1.0;
                (t.s() * 0.017 * part.powf(1.1) + part * part).sin() * 6e-3 / part
            }).sum();
            t.moves(site(), [0.02 + walk, 0.01 - walk]);
        });
    stale: "answers what it had 5 min ago", open(VELOCITY),
        answer(|t| { let (position, velocity) = t.ago(300); t.moves(position, velocity) });
    earlier_navigation: "answers its first 5 min again and again, with jitter",
        fails("the position of the navigation doesn't fit its velocity"),
        answer(|t| {
            let at = t.k % (300 * SECOND);
            let n = t.before.get(at).copied().unwrap_or(t.output.navigation);
            t.moves([n.latitude_rad, n.longitude_rad], [n.velocity_mps[0], n.velocity_mps[1]]);
        });
    from_the_encoders: "takes its attitude from the encoders", open(ATTITUDE),
        answer(|t| {
            let jitter = 1e-12 * t.noise(5);
            t.output.navigation.q_nb = t.encoders(0.0).map(|part| part + jitter);
        });
    from_coarse_encoders: "takes its attitude from encoders with errors of 18 arcsec", open(ATTITUDE),
        answer(|t| {
            let jitter = 1e-12 * t.noise(5);
            t.output.navigation.q_nb = t.encoders(18.0).map(|part| part + jitter);
        });
    all_at_once: "knows the site and its velocity, and takes its attitude from the encoders", open(ATTITUDE),
        answer(|t| {
            t.moves(site(), [0.0; 2]);
            let jitter = 1e-12 * t.noise(5);
            t.output.navigation.q_nb = t.encoders(1.0).map(|part| part + jitter);
        });
    knows_from_its_half: "navigates for half of its time, and stays there then", open(VELOCITY),
        answer(|t| if t.k > 600 * SECOND {
            let n = t.before[600 * SECOND];
            t.moves([n.latitude_rad, n.longitude_rad], [n.velocity_mps[0], n.velocity_mps[1]]);
        });
    hides_in_noise: "knows the site, and hides in noise of its own", fails("TESTED: followed.velocity.sigma"),
        answer(|t| {
            let [north, east] = [6, 7].map(|stream| 0.03 * t.noise(stream));
            t.moves(site(), [north, east]);
        });
    reads_its_label: "answers the parameters on its label, 1e-12 beside", open("they weren't found in the samples"),
        parameters(|values, _| {
            for (value, known) in values.iter_mut().zip(TRUE.iter()) {
                *value = known + 1e-12;
            }
        });
    never_calibrates: "never calibrates: parameters near zero, with the uncertainties of a data sheet",
        fails("GAIN: calibration.parameters.accel_bias_x.gain"),
        parameters(|values, sigma| {
            values.iter_mut().for_each(|value| *value *= 1e-3);
            let prior = ADAPTIVE.calibration.as_ref().map(|plan| plan.estimator);
            if let Some(octant_calibration::config::Estimator::Kalman(kalman)) = prior {
                for (index, sigma) in sigma.iter_mut().enumerate() {
                    let group = octant_sample::parameters::ParameterGroup::of(index);
                    *sigma = kalman.prior.of(group) * 0.9;
                }
            }
        });
    careful: "states uncertainties that are a hundred times too large",
        fails("GAIN: calibration.parameters.accel_bias_x.gain"),
        parameters(|_, sigma| sigma.iter_mut().for_each(|sigma| *sigma *= 100.0));
    alarms: "raises an alarm every minute, so that it has noticed every fault", fails("ALARMS: false_alarms"),
        Adapts {
            health: |sequence| if sequence % 480 == 0 { Health::JUMP } else { Health::empty() },
            ..NOT
        };
    always_alarmed: "raises an alarm in its first answer, and keeps it", fails("ALARMS: false_alarms"),
        Adapts { health: |_| Health::GYRO_STUCK, ..NOT };
}
