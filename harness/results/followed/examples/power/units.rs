//! Units that follow their samples and units that don't, drawn at random.

use octant_earth::units::{ARCSEC, DEG_PER_HOUR, DEG_PER_SQRT_HOUR, MICRO_G};
use octant_random::draws::Draws;

/// Angle random walk of Table 1, rad/√s.
pub(crate) const ARW: f64 = 7e-4 * DEG_PER_SQRT_HOUR;
/// Velocity random walk of Table 1, m/s/√s.
pub(crate) const VRW: f64 = 50.0 * MICRO_G;

/// A way to compute and to give answers.
#[derive(Clone, Debug)]
pub(crate) struct Way {
    /// Name, as in the table.
    pub(crate) name: &'static str,
    /// Step of the integration, s.
    pub(crate) step_s: f64,
    /// Rule of the integration.
    pub(crate) scheme: Scheme,
    /// True if the velocity is kept in single precision.
    pub(crate) state_single: bool,
    /// True if every second sample counts twice, and the others not.
    pub(crate) skips: bool,
    /// Size of the errors of the parameters, in those of Table 1.
    pub(crate) parameters: f64,
    /// Errors of tilt and heading at the start, rad.
    pub(crate) start_rad: [f64; 2],
    /// Error of the integration, as noise in parts of the random walk.
    pub(crate) coning: f64,
    /// Bias instability, rad/s and m/s², with 1000 s.
    pub(crate) wander: [f64; 2],
    /// Time in which the levels are damped, s; infinite: they aren't.
    pub(crate) damped_s: f64,
    /// Time between two answers, s, and their delay, s.
    pub(crate) every_s: f64,
    pub(crate) late_s: f64,
    /// Time over which the answers are smoothed, s.
    pub(crate) smooth_s: f64,
    /// Resolution of attitude, rad, and velocity, m/s.
    pub(crate) digits: [f64; 2],
    /// True if the answers are in single precision.
    pub(crate) single: bool,
    /// Part of the samples' own noise in its errors, and part of noise that it makes up.
    pub(crate) noise: [f64; 2],
    /// White noise that is added to the answers, rad and m/s.
    pub(crate) jitter: [f64; 2],
    /// Attitude and velocity that are made up: none, sines, or what the encoders show.
    pub(crate) attitude: Made,
    pub(crate) velocity: Made,
}

/// Rule of an integration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scheme {
    /// Rates of the beginning.
    Euler,
    /// Rates of the middle.
    Midpoint,
    /// Mean of the rates of beginning and end.
    Heun,
}

/// Parts of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Made {
    /// Integrated noise.
    Integrated,
    /// Exact.
    Known,
    /// Sines of the Schuler period and of a day.
    Sines,
    /// The encoders, with their errors: another one in every dwell.
    Encoders,
}

/// Computes well, and answers at once.
pub(crate) const GOOD: Way = Way {
    name: "integrates every sample",
    step_s: 0.25,
    scheme: Scheme::Midpoint,
    state_single: false,
    skips: false,
    parameters: 0.1,
    start_rad: [ARCSEC, 10.0 * ARCSEC],
    coning: 0.0,
    wander: [0.0; 2],
    damped_s: f64::INFINITY,
    every_s: 1.0,
    late_s: 0.0,
    smooth_s: 0.0,
    digits: [0.0; 2],
    single: false,
    noise: [1.0, 0.0],
    jitter: [0.0; 2],
    attitude: Made::Integrated,
    velocity: Made::Integrated,
};

/// Random numbers of a trial.
pub(crate) struct Chance(pub(crate) Draws);

impl Chance {
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.unit()
    }

    /// Draws evenly in the logarithm.
    pub(crate) fn decades(&mut self, low: f64, high: f64) -> f64 {
        libm::exp(self.between(libm::log(low), libm::log(high)))
    }
}

/// Number of kinds of units that follow, and of those that don't.
pub(crate) const HONEST: usize = 20;
pub(crate) const ADAPTIVE: usize = 10;

/// Draws a unit that follows its samples.
pub(crate) fn honest(kind: usize, seed: u64) -> Way {
    let mut by = Chance(Draws::of(seed, "power.honest", kind as u64));
    let start = by.decades(0.1, 30.0);
    let mut way = Way {
        parameters: by.decades(1e-3, 0.3),
        start_rad: [start * ARCSEC, 10.0 * start * ARCSEC],
        ..GOOD
    };
    match kind {
        0 => {}
        1 => (way.name, way.parameters) = ("compensates nothing", by.between(0.5, 1.0)),
        2 => {
            way.name = "detuned: starts with ten times the errors";
            way.start_rad = way.start_rad.map(|rad| 10.0 * rad);
        }
        3 => (way.name, way.step_s) = ("integrates in steps of 0.5 s", 0.5),
        4 => (way.name, way.step_s) = ("integrates in steps of 1 s", 1.0),
        5 => (way.name, way.scheme) = ("integrates by Euler's rule", Scheme::Euler),
        6 => (way.name, way.scheme) = ("integrates by Heun's rule", Scheme::Heun),
        7 => {
            (way.name, way.coning) =
                ("integrates roughly, as without coning", by.between(0.05, 0.5))
        }
        8 => (way.name, way.state_single) = ("computes its velocity in single precision", true),
        9 => (way.name, way.single) = ("answers in single precision", true),
        10 => {
            way.name = "answers in coarse digits";
            way.digits = [by.decades(0.001, 0.2) * ARCSEC, by.decades(1e-5, 2e-3)];
        }
        11 => {
            way.name = "answers every 2, 5, 10 or 50 s";
            way.every_s = [2.0, 5.0, 10.0, 50.0][by.0.below(4)];
        }
        12 => (way.name, way.late_s) = ("answers late by up to 2 s", by.between(0.0, 2.0)),
        13 => {
            (way.name, way.smooth_s) = ("smooths its answers over up to 3 s", by.between(0.5, 3.0))
        }
        14 => {
            way.name = "has unstable biases";
            way.wander = [by.decades(1e-4, 2e-3) * DEG_PER_HOUR, by.decades(0.1, 5.0) * MICRO_G];
        }
        15 => {
            way.name = "damps its levels in 20 to 60 min";
            way.damped_s = by.between(1200.0, 3600.0);
        }
        16 => (way.name, way.skips) = ("reads every second sample, twice", true),
        17 => {
            (way.name, way.noise) =
                ("adds 0 to 0.3 of the noise of its own", [1.0, by.between(0.0, 0.3)])
        }
        18 => {
            way.name = "compensates nothing, late, in single precision";
            (way.parameters, way.late_s, way.single) = (1.0, by.between(0.0, 1.0), true);
        }
        _ => {
            way.name = "steps of 1 s, coarse digits, every 2 s";
            (way.step_s, way.every_s) = (1.0, 2.0);
            way.digits = [by.decades(0.001, 0.1) * ARCSEC, by.decades(1e-5, 1e-3)];
        }
    }
    way
}

/// Draws a unit that doesn't follow its samples.
pub(crate) fn adaptive(kind: usize, seed: u64) -> Way {
    let mut by = Chance(Draws::of(seed, "power.adaptive", kind as u64));
    let none = Way { noise: [0.0; 2], parameters: by.decades(1e-3, 0.3), ..GOOD };
    let known = Way { attitude: Made::Known, velocity: Made::Known, ..none.clone() };
    match kind {
        0 => Way { name: "knows the site, with 1e-12 of jitter", jitter: [1e-12; 2], ..known },
        1 => Way {
            name: "makes up a Schuler curve",
            attitude: Made::Sines,
            velocity: Made::Sines,
            jitter: [1e-10, 1e-8],
            ..none
        },
        2 => Way { name: "simulates itself, with other noise", noise: [0.0, 1.0], ..none },
        3 => Way {
            name: "simulates itself, with less noise",
            noise: [0.0, by.between(0.1, 0.9)],
            ..none
        },
        4 => Way {
            name: "takes its attitude from the encoders",
            attitude: Made::Encoders,
            jitter: [1e-9, 0.0],
            noise: [1.0, 0.0],
            ..none
        },
        5 => Way {
            name: "is drawn to the site: 0 to 0.6 of its own errors",
            noise: [by.between(0.0, 0.6), 0.0],
            ..none
        },
        6 => Way {
            name: "smooths its answers over 5 to 20 min",
            smooth_s: by.between(300.0, 1200.0),
            ..GOOD
        },
        7 => Way { name: "answers 2 to 20 min late", late_s: by.between(120.0, 1200.0), ..GOOD },
        8 => Way {
            name: "knows its velocity, and integrates attitude alone",
            velocity: Made::Known,
            noise: [1.0, 0.0],
            jitter: [0.0, 1e-6],
            ..none
        },
        _ => Way {
            name: "adds noise to the site, like that of a sample",
            jitter: [by.decades(1e-10, 0.1 * ARW), by.decades(1e-8, 0.1 * VRW)],
            ..known
        },
    }
}
