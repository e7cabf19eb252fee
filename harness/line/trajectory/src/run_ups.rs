//! Run-ups of a heading test in a solution: each begins when the unit is switched on, and the time of the run is that with
//! power.

use super::point::{SECOND_NS, TimeScale};
use super::survey::TrajectorySurvey;
use octant_base::number::plain;
use octant_scenario::trajectory::SolutionRunUps;

/// Time before the end of a run-up by which its last point has to be there, ns: readings may be off by as much.
const END_NS: i64 = SECOND_NS;

/// Run-ups of a solution; without one, the whole file is scored as it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct RunUps {
    /// Number of run-ups of the plan; 0: it is no heading test.
    count: usize,
    length_ns: i64,
    on_ns: Vec<i64>,
    azimuths_rad: Vec<f64>,
    /// Time of the last point in each run-up, ns since switching on.
    last_ns: Vec<Option<i64>>,
    /// Headings of each run-up in their order.
    headings: Vec<HeadingSequence>,
}

/// Headings in their order, as a hash (FNV-1a), and whether they change.
#[derive(Clone, Copy, Debug, PartialEq)]
struct HeadingSequence {
    hash: u64,
    count: u64,
    first: Option<u64>,
    varies: bool,
}

impl Default for HeadingSequence {
    fn default() -> Self {
        Self { hash: 0xcbf2_9ce4_8422_2325, count: 0, first: None, varies: false }
    }
}

impl HeadingSequence {
    fn push(&mut self, heading_rad: f64) {
        let bits = heading_rad.to_bits();
        for byte in bits.to_le_bytes() {
            self.hash = (self.hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
        self.count += 1;
        self.varies |= *self.first.get_or_insert(bits) != bits;
    }
}

/// Place of a point in the run-ups.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct InRunUp {
    /// Time with power since the first switching on, ns.
    pub(crate) time_ns: u64,
    /// Number of the run-up, from 0.
    pub(crate) number: usize,
    /// True for the first point of its run-up.
    pub(crate) is_first: bool,
    /// Angle by which the table has turned the unit, rad.
    pub(crate) azimuth_rad: f64,
}

impl RunUps {
    /// Run-ups of a plan in a file.
    pub(crate) fn of(plan: &SolutionRunUps, survey: &TrajectorySurvey) -> Result<Self, String> {
        let SolutionRunUps { count, length_ns, switched_on_ns, azimuths_rad } = plan;
        if *count == 0 {
            return Ok(Self::default());
        }
        if !switched_on_ns.is_empty() && survey.scale != TimeScale::Utc {
            return Err(format!(
                "found times of {}, expected UTC, in which source.solution.switched_on is",
                survey.scale.name()
            ));
        }
        let on_ns = match &switched_on_ns[..] {
            [] => vec![survey.span_ns.0],
            times => times.to_vec(),
        };
        for pair in on_ns.windows(2) {
            let apart_ns = pair[1] - pair[0];
            if apart_ns < *length_ns {
                return Err(format!(
                    "found a second switching on {} s after the first, expected {} s or more, the length of a run-up",
                    plain(apart_ns as f64 * 1e-9, 6),
                    plain(*length_ns as f64 * 1e-9, 6)
                ));
            }
        }
        let last_ns = vec![None; on_ns.len()];
        let headings = vec![HeadingSequence::default(); on_ns.len()];
        let (count, length_ns) = (*count as usize, *length_ns);
        Ok(Self { count, length_ns, on_ns, azimuths_rad: azimuths_rad.clone(), last_ns, headings })
    }

    /// True if there are none: no heading test.
    pub(crate) fn is_none(&self) -> bool {
        self.count == 0
    }

    /// Time with power of the plan, ns; `None`: there is no heading test.
    pub(crate) fn planned_ns(&self) -> Option<u64> {
        let all_ns = self.length_ns.saturating_mul(self.count as i64);
        u64::try_from(all_ns).ok().filter(|_| !self.is_none())
    }

    /// Takes a point of this time; `None`: the unit had no power then.
    pub(crate) fn take(&mut self, time_ns: i64) -> Option<InRunUp> {
        if self.is_none() {
            return Some(InRunUp::default());
        }
        let number = self.on_ns.partition_point(|on_ns| *on_ns <= time_ns).checked_sub(1)?;
        let since_ns = time_ns - self.on_ns[number];
        // The end of a run-up belongs to it where the unit isn't switched on again.
        if since_ns > self.length_ns {
            return None;
        }
        let is_first = self.last_ns[number].replace(since_ns).is_none();
        let before_ns = self.length_ns.saturating_mul(number as i64);
        let azimuth_rad = self.azimuths_rad.get(number).copied().unwrap_or(0.0);
        let time_ns = u64::try_from(before_ns.saturating_add(since_ns)).unwrap_or(0);
        Some(InRunUp { time_ns, number, is_first, azimuth_rad })
    }

    /// Takes a heading of a run-up, from 0, rad.
    pub(crate) fn heading(&mut self, number: usize, heading_rad: f64) {
        if let Some(sequence) = self.headings.get_mut(number) {
            sequence.push(heading_rad);
        }
    }

    /// Describes what the file lacks of the plan; `None`: nothing.
    pub(crate) fn doubt(&self, period_ns: i64) -> Option<String> {
        if self.on_ns.len() < self.count {
            return Some(format!("{} of {} run-ups were begun", self.on_ns.len(), self.count));
        }
        // A file with the same run-up twice would repeat without an error.
        for (number, one) in self.headings.iter().enumerate() {
            let twin = self.headings[..number].iter().position(|other| other == one && one.varies);
            if let Some(twin) = twin {
                return Some(format!(
                    "run-ups {} and {} have the same {} headings in the same order: one is a copy of the other",
                    twin + 1,
                    number + 1,
                    one.count
                ));
            }
        }
        // Headings that come seldom may end before the run-up does.
        let slack_ns = END_NS.max(2 * period_ns);
        (1..).zip(&self.last_ns).find_map(|(number, last_ns)| {
            let Some(last_ns) = last_ns else {
                return Some(format!("run-up {number} has no heading"));
            };
            (last_ns + slack_ns < self.length_ns).then(|| {
                format!(
                    "run-up {number} ends at {} s, expected {} s",
                    plain(*last_ns as f64 * 1e-9, 6),
                    plain(self.length_ns as f64 * 1e-9, 6)
                )
            })
        })
    }
}
