//! Checks that a unit's answers follow its input: a constant solution, a NIS or parameters that
//! never change, and errors of exactly zero are neither navigation nor calibration. Successive answers
//! fit each other.
//!
//! Sensors have noise, so a solution computed from them changes with every sample. A finding here
//! proves nothing against a unit; it shows that the run is no evidence.

use super::fit::AnswerFit;
use octant_endpoint::Tells;
use octant_sample::{Health, Mode, Navigation, Output, Sample};

/// Time for which a navigation solution may stay the same, ns: units that update once a second are
/// common, once a minute none.
const STANDING_NS: u64 = 60_000_000_000;
/// Number of solutions, at most one a second, with which a new one is compared.
const REMEMBERED: usize = 64;
/// Minimum number of NIS values for the statement that all are equal.
const NIS_LEAST: u64 = 8;

/// Follows one run, without allocating memory.
#[derive(Clone, Debug)]
pub struct RunFollower {
    /// Navigation solution at the last answer.
    before: Navigation,
    /// Time since which each part of it stays the same, ns.
    since_ns: [u64; 3],
    /// Longest time for which a part stayed the same, ns, with its start.
    longest: [(u64, u64); 3],
    /// Hashes of the last solutions that differ from the one a second before.
    remembered: [u64; REMEMBERED],
    renewed: u64,
    repeated: u64,
    next_ns: u64,
    began_ns: Option<u64>,
    last_ns: u64,
    /// Duration of the longest navigation that ended, ns.
    navigated_ns: u64,
    nis: Nis,
    fit: AnswerFit,
    /// True if an answer that isn't compared lies between.
    unseen: bool,
    told: [bool; 3],
}

/// The NIS values so far.
#[derive(Clone, Copy, Debug)]
struct Nis {
    /// Bits of the first one.
    first: Option<u64>,
    count: u64,
    alike: bool,
}

impl Nis {
    #[inline]
    fn take(&mut self, nis: f64) {
        let bits = nis.to_bits();
        self.alike &= *self.first.get_or_insert(bits) == bits;
        self.count += 1;
    }
}

/// Names of the parts.
const PARTS: [&str; 3] = ["position", "velocity", "attitude"];

impl RunFollower {
    /// Creates the checks of a unit that reports these quantities; `None`: its solution isn't checked.
    #[must_use]
    pub fn new(tells: Option<Tells>) -> Self {
        Self {
            told: tells
                .filter(|tells| tells.follows)
                .map_or([false; 3], |tells| [tells.position, tells.velocity, tells.attitude]),
            before: Navigation::default(),
            since_ns: [0; 3],
            longest: [(0, 0); 3],
            remembered: [0; REMEMBERED],
            renewed: 0,
            repeated: 0,
            next_ns: 0,
            began_ns: None,
            last_ns: 0,
            navigated_ns: 0,
            nis: Nis { first: None, count: 0, alike: true },
            fit: AnswerFit::new(tells),
            unseen: false,
        }
    }

    /// Checks an answer, with the time of its sample, ns, and the sample; `None`: solutions aren't held against
    /// samples.
    #[inline]
    pub fn epoch(&mut self, now_ns: u64, output: &Output, sample: Option<&Sample>) {
        if !output.nis.is_nan() {
            self.nis.take(output.nis);
        }
        if output.mode != Mode::Navigating {
            self.ends();
            return;
        }
        let before_ns = std::mem::replace(&mut self.last_ns, now_ns);
        let n = &output.navigation;
        if self.began_ns.is_none() {
            self.began_ns = Some(now_ns);
            self.since_ns = [now_ns; 3];
            self.next_ns = now_ns;
            self.fit.begin();
        } else {
            // In a good run the first number of each part differs.
            let before = &self.before;
            let moves = n.latitude_rad != before.latitude_rad
                && n.velocity_mps[0] != before.velocity_mps[0]
                && n.q_nb[0] != before.q_nb[0];
            let unseen = std::mem::take(&mut self.unseen);
            if unseen {
                self.fit.begin();
            } else if let Some(sample) = sample {
                let (before, now) = ((before_ns, before), (now_ns, n));
                self.fit.take(before, now, sample, moves, is_free(output));
            }
            if moves { self.since_ns = [now_ns; 3] } else { self.compare(now_ns, n) }
        }
        self.before = *n;
        if now_ns >= self.next_ns {
            let before_ns = self.next_ns.saturating_sub(1_000_000_000);
            self.next_ns = now_ns + 1_000_000_000;
            let held = self.since_ns.iter().all(|since_ns| *since_ns <= before_ns);
            let bits =
                [mix(&[n.latitude_rad, n.longitude_rad]), mix(&n.velocity_mps), mix(&n.q_nb)];
            // A solution that is held isn't repeated: units may answer anew less than once a second.
            if !held {
                self.second(bits[0] ^ bits[1].rotate_left(21) ^ bits[2].rotate_left(42));
            }
            if sample.is_some() {
                self.fit.second(now_ns, n, is_free(output));
            }
        }
    }

    /// Notes an epoch that was altered on its way to the unit: the answers around it aren't compared with samples.
    #[inline]
    pub fn altered(&mut self) {
        self.unseen = true;
    }

    /// Notes the duration of a navigation that is over.
    #[inline]
    fn ends(&mut self) {
        if let Some(began_ns) = self.began_ns.take() {
            self.navigated_ns = self.navigated_ns.max(self.last_ns.saturating_sub(began_ns));
        }
    }

    /// Compares the solution with the one before, bit by bit, and notes how long a part has been the same.
    #[inline(never)]
    fn compare(&mut self, now_ns: u64, n: &Navigation) {
        let before = &self.before;
        let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits());
        let stands = [
            same(&[n.latitude_rad, n.longitude_rad], &[before.latitude_rad, before.longitude_rad]),
            same(&n.velocity_mps, &before.velocity_mps),
            same(&n.q_nb, &before.q_nb),
        ];
        for (part, stands) in stands.into_iter().enumerate() {
            let standing_ns = now_ns.saturating_sub(self.since_ns[part]);
            if !stands {
                self.since_ns[part] = now_ns;
            } else if standing_ns > self.longest[part].0 {
                self.longest[part] = (standing_ns, self.since_ns[part]);
            }
        }
    }

    /// Compares the solution of a second with those before.
    fn second(&mut self, hash: u64) {
        let there = self.remembered.len().min(self.renewed as usize);
        self.repeated += u64::from(self.remembered[..there].contains(&hash));
        self.remembered[self.renewed as usize % REMEMBERED] = hash;
        self.renewed += 1;
    }

    /// Returns whether the solution has to follow the samples.
    #[must_use]
    pub(super) fn has_to(&self) -> bool {
        self.told.contains(&true)
    }

    /// Number of steps of the solution where a correction was at work.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.fit.steps
    }

    /// Describes the answers that don't follow, in plain words.
    #[must_use]
    pub fn reasons(&self) -> Vec<String> {
        let mut reasons = Vec::new();
        let present_ns = self.began_ns.map_or(0, |began| self.last_ns.saturating_sub(began));
        let navigated_ns = self.navigated_ns.max(present_ns);
        // In a short navigation half of its length is enough.
        let standing_ns = STANDING_NS.min((navigated_ns / 2).max(1_000_000_000));
        for (i, part) in PARTS.into_iter().enumerate() {
            let (longest_ns, since_ns) = self.longest[i];
            if self.told[i] && longest_ns >= standing_ns {
                reasons.push(format!(
                    "the {part} of the navigation doesn't follow the samples: not a bit of it changed \
                     for {:.3} s from {:.3} s on",
                    longest_ns as f64 * 1e-9,
                    since_ns as f64 * 1e-9
                ));
            }
        }
        if reasons.is_empty()
            && self.told.contains(&true)
            && self.renewed >= 8
            && self.repeated * 2 > self.renewed
        {
            reasons.push(format!(
                "the navigation doesn't follow the samples: {} of {} solutions, at most one a second, are \
                 repetitions of those before",
                self.repeated, self.renewed
            ));
        }
        reasons.extend(self.fit.reasons());
        if self.nis.count >= NIS_LEAST && self.nis.alike {
            reasons.push(format!(
                "the NIS doesn't follow the samples: all {} are {}",
                self.nis.count,
                self.nis.first.map_or(f64::NAN, f64::from_bits)
            ));
        }
        reasons
    }
}

/// Returns whether an answer is of free navigation: no measurement and no recovery corrects it.
#[inline]
pub(super) fn is_free(output: &Output) -> bool {
    output.nis.is_nan() && !output.health.contains(Health::RECOVERING)
}

/// Mixes the bits of some numbers into one word: equal numbers give equal words.
#[inline]
fn mix(values: &[f64]) -> u64 {
    values.iter().fold(0, |word: u64, value| {
        (word.rotate_left(23) ^ value.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15)
    })
}
