//! The result: whether the errors of a navigation contain the noise of its samples.

use crate::interval::Told;
use crate::regression::Slope;
use crate::window::Windows;
use serde::{Deserialize, Serialize};

/// Largest standard deviation of a slope that says something.
pub const SIGMA_MAX: f64 = 0.05;
/// Deviation from 1 beyond three standard deviations that a slope may have: answers that lag by parts of a second, or are
/// smoothed over seconds, lose a part of the noise.
pub const TOLERANCE: f64 = 0.2;
/// Number of standard deviations.
const SIGMAS: f64 = 3.0;

/// Noise that the bench knows to be in the samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum KnownNoise {
    /// White noise of the simulated instrument.
    Simulated,
    /// Dither that the bench adds.
    Dither,
}

/// Verdict of the test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Followed {
    /// The navigation was computed from the samples.
    Followed,
    /// Not followed.
    NotFollowed,
    /// There is too little information.
    NotTested,
}

impl Followed {
    /// The name in words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Followed => "followed",
            Self::NotFollowed => "not followed",
            Self::NotTested => "not tested",
        }
    }
}

/// Test of a navigation: regression of what its errors do against the error dynamics on the known noise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FollowedScore {
    /// Verdict.
    pub verdict: Followed,
    /// Reason for a verdict other than followed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Noise that is known; left out: none is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub known: Option<KnownNoise>,
    /// Horizontal attitude; left out where the unit tells none, or nothing was regressed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub attitude: Option<Channel>,
    /// Horizontal velocity; likewise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity: Option<Channel>,
}

/// Regression of one quantity, north and east together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Channel {
    /// Verdict.
    pub verdict: Followed,
    /// Slope on the known noise: 1 where the samples were integrated.
    pub slope: f64,
    /// Its standard deviation.
    pub sigma: f64,
    /// Information on the slope, 1/σ².
    pub information: f64,
    /// Root mean square of what is left, in units of that of the known noise.
    pub residual: f64,
    /// Length of the windows, s.
    pub window_s: f64,
    /// Lag of the answers behind the samples at which it was found, s.
    pub lag_s: f64,
    /// Number of windows.
    pub windows: u64,
}

/// Material that a result is derived from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Material<'a> {
    pub(crate) told: Told,
    pub(crate) known: KnownNoise,
    pub(crate) windows: &'a [Windows],
    pub(crate) compared: u64,
    pub(crate) breaks: u64,
    pub(crate) unknown: u64,
    pub(crate) nonlinear: u64,
    pub(crate) turned: u64,
}

impl Channel {
    fn of(windows: &Windows, (lag_s, slope): (usize, Slope)) -> Self {
        let Slope { value, sigma, regressor_rms, residual_rms } = slope;
        let off = (value - 1.0).abs();
        let verdict = if !(sigma <= SIGMA_MAX) {
            Followed::NotTested
        } else if off <= TOLERANCE + SIGMAS * sigma {
            Followed::Followed
        } else {
            Followed::NotFollowed
        };
        Self {
            verdict,
            slope: value,
            sigma,
            information: (sigma * sigma).recip().min(f64::MAX),
            residual: residual_rms / regressor_rms,
            window_s: windows.length_s() as f64,
            lag_s: lag_s as f64,
            windows: windows.count(),
        }
    }

    /// Selects the regression that says most of those that follow; else the one closest to 1 of those that say something;
    /// else the one that says most.
    fn best(all: impl Iterator<Item = Self>) -> Option<Self> {
        let key = |channel: &Self| match channel.verdict {
            Followed::Followed => (0, channel.sigma),
            Followed::NotFollowed => (1, (channel.slope - 1.0).abs()),
            Followed::NotTested => (2, channel.sigma),
        };
        all.min_by(|a, b| key(a).partial_cmp(&key(b)).unwrap_or(std::cmp::Ordering::Equal))
    }

    /// Describes the slope.
    fn words(&self) -> String {
        format!("{:.3} ± {:.3}", self.slope, self.sigma)
    }
}

impl FollowedScore {
    /// Makes the result of a run that can't be tested, with the reason.
    #[must_use]
    pub fn not_tested(reason: &str) -> Self {
        Self {
            verdict: Followed::NotTested,
            reason: Some(reason.to_owned()),
            known: None,
            attitude: None,
            velocity: None,
        }
    }

    /// Derives the result, which happens only here.
    pub(crate) fn of(material: &Material<'_>) -> Self {
        let Material { told, known, windows, .. } = *material;
        if !(told.attitude || told.velocity) {
            return Self::not_tested("the unit tells neither attitude nor velocity");
        }
        if material.unknown == material.compared {
            return Self::not_tested("the noise of the samples isn't known");
        }
        let attitude =
            windows.iter().flat_map(|of| of.attitude().map(move |slope| Channel::of(of, slope)));
        let velocity =
            windows.iter().flat_map(|of| of.velocity().map(move |slope| Channel::of(of, slope)));
        let attitude = told.attitude.then(|| Channel::best(attitude)).flatten();
        let velocity = told.velocity.then(|| Channel::best(velocity)).flatten();
        let named = [("attitude", attitude), ("velocity", velocity)];
        let channels =
            || named.iter().filter_map(|(name, channel)| Some((*name, channel.as_ref()?)));
        let ignored: Vec<String> = channels()
            .filter(|(_, channel)| channel.verdict == Followed::NotFollowed)
            .map(|(name, channel)| {
                format!(
                    "the {name} of the navigation doesn't follow the samples: slope {} on their noise, expected 1, \
                     in {} windows of {} s",
                    channel.words(),
                    channel.windows,
                    channel.window_s
                )
            })
            .collect();
        let tested = channels().any(|(_, channel)| channel.verdict == Followed::Followed);
        let (verdict, reason) = if !ignored.is_empty() {
            (Followed::NotFollowed, Some(ignored.join("; ")))
        } else if tested {
            (Followed::Followed, None)
        } else {
            (Followed::NotTested, Some(material.too_little(channels())))
        };
        Self { verdict, reason, known: Some(known), attitude, velocity }
    }

    /// Reason why the run is no evidence, if the navigation didn't follow its samples.
    #[must_use]
    pub fn doubt(&self) -> Option<&str> {
        self.reason.as_deref().filter(|_| self.verdict == Followed::NotFollowed)
    }

    /// Describes the result on one line.
    #[must_use]
    pub fn line(&self) -> String {
        let channel = |name: &str, channel: &Option<Channel>| {
            let channel = channel.as_ref()?;
            let tested = if channel.verdict == Followed::NotTested { ", not tested" } else { "" };
            Some(format!("{name} {}{tested}", channel.words()))
        };
        let slopes = [channel("attitude", &self.attitude), channel("velocity", &self.velocity)];
        let slopes: Vec<String> = slopes.into_iter().flatten().collect();
        match &self.reason {
            Some(reason) if self.verdict == Followed::NotTested => format!("not tested: {reason}"),
            _ => format!("{} (1 expected): {}", self.verdict.name(), slopes.join(", ")),
        }
    }
}

impl Material<'_> {
    /// Says why there is too little information.
    fn too_little<'a>(&self, channels: impl Iterator<Item = (&'a str, &'a Channel)>) -> String {
        let scatter: Vec<String> = channels
            .map(|(name, channel)| {
                format!(
                    "{name}: slope {} in {} windows of {} s, the rest is {:.1} times the known noise",
                    channel.words(),
                    channel.windows,
                    channel.window_s,
                    channel.residual
                )
            })
            .collect();
        if !scatter.is_empty() {
            return scatter.join("; ");
        }
        let Self { compared, breaks, nonlinear, turned, .. } = self;
        let windows = self.windows.iter().map(Windows::count).max().unwrap_or_default();
        format!(
            "{windows} windows of free navigation are too few, or have no noise: {compared} comparisons, {breaks} breaks, \
             {turned} turns, {nonlinear} errors that are large or unknown"
        )
    }
}
