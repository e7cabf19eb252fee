//! The guided search: lines along the size of a fault, begun where harm was found before.
//!
//! Both the harm of a fault and its chance to be noticed grow with its size. The largest harm that goes
//! unnoticed is therefore just below the size at which it is noticed. A line looks for that size: it starts in
//! the middle, and tries next the size at which the harm, extrapolated, would be worse than all so far. Noticed
//! there, it ends; unnoticed, it goes on to the size at which it is noticed. New lines are begun at random for each
//! kind in turn, near the worst of what was found, or as two of its faults at once. After an earlier search they begin
//! with [faults that were noticed there](crate::earlier).
//!
//! Each proposal depends on the seed and the results before it alone.

use crate::candidate::{Candidate, PlacedFault};
use crate::earlier::{AskedFault, EarlierScreens};
use crate::space::{KeyValues, Space};
use crate::trial::Trial;
use octant_random::draws::Draws;

/// Runs of a line, at most.
const RUNS_MAX: u32 = 10;
/// Runs of a line that has found nothing unnoticed, at most.
const RUNS_MAX_NOTICED: u32 = 3;
/// Ratio of noticed to unnoticed size below which a line has found the edge.
const EDGE: f64 = 1.15;
/// Share of new lines that begin at random, once something was found.
const EXPLORE: f64 = 0.4;
/// Faults that new lines begin near.
const ELITES_MAX: usize = 12;
/// Those of one kind.
const ELITES_OF_A_KIND: usize = 3;
/// Standard deviation of a change of a value, in its range.
const CHANGE: f64 = 0.08;
/// Chance that a changed fault has another value of a choice, or any other value of a range.
const REDRAW: f64 = 0.2;
/// Harm that a line aims at, as a multiple of the worst so far: noticed there, it has nothing to add.
const BEYOND: f64 = 1.1;
/// Ratio of the sizes of a line that is the worst so far.
const CLIMB: f64 = 1.6;
/// Most decades between two sizes of a line.
const JUMP_MAX: f64 = 2.5;
/// Candidates that are proposed together while the screens of an earlier search are asked: each tells where to look next.
const ASKED_TOGETHER: usize = 4;
/// Harm that isn't extrapolated, and runs of a line that finds no more.
const HARMLESS: f64 = 1e-4;
const RUNS_MAX_HARMLESS: u32 = 2;

/// A guided search.
#[derive(Debug)]
pub struct Guide<'a> {
    space: &'a Space,
    seed: u64,
    /// Share of new lines with two faults.
    pairs: f64,
    lines: Vec<SizeLine>,
    begun: u64,
    /// Order in which the forms are tried, begun again when all were.
    order: Vec<usize>,
    /// Worst that went unnoticed, worst first.
    elites: Vec<Elite>,
    /// Screens of an earlier search.
    screens: EarlierScreens,
}

#[derive(Clone, Debug)]
struct Elite {
    candidate: Candidate,
    harm: f64,
}

/// A search along the size of the first fault of a candidate.
#[derive(Debug)]
struct SizeLine {
    candidate: Candidate,
    /// Key of the size; `None` for a fault without one, which is run once.
    key: Option<usize>,
    /// Largest place that went unnoticed, with its harm.
    low: Option<(f64, f64)>,
    /// Smallest place that was noticed.
    high: Option<f64>,
    runs: u32,
    /// Place that is run next; `None` when the line has ended.
    next: Option<f64>,
    /// Screen of an earlier search that noticed its beginning.
    screen: Option<usize>,
}

impl SizeLine {
    fn at(&self, place: f64) -> Candidate {
        let mut candidate = self.candidate.clone();
        if let Some(key) = self.key {
            candidate.faults[0].places[key] = place;
        }
        candidate
    }
}

impl<'a> Guide<'a> {
    /// Begins a search. `pairs` is the share of new lines with two faults at once.
    #[must_use]
    pub fn new(space: &'a Space, seed: u64, pairs: f64) -> Self {
        let (lines, order, elites) = (Vec::new(), Vec::new(), Vec::new());
        let screens = EarlierScreens::default();
        Self { space, seed, pairs, lines, begun: 0, order, elites, screens }
    }

    /// Asks the screens of an earlier search first.
    pub(crate) fn after(self, screens: EarlierScreens) -> Self {
        Self { screens, ..self }
    }

    /// Proposes candidates. Their results are taken by [`Self::learn`], in the same order, before the next ones
    /// are proposed.
    pub fn propose(&mut self, count: usize) -> Vec<Candidate> {
        self.lines.retain(|line| line.next.is_some());
        let count = if self.screens.are_asked() { count.min(ASKED_TOGETHER) } else { count };
        while self.lines.len() < count {
            let line = self.begin();
            self.lines.push(line);
        }
        self.lines.truncate(count);
        self.lines.iter().map(|line| line.at(line.next.unwrap_or(0.5))).collect()
    }

    /// Takes the results of the candidates that were proposed last.
    pub fn learn(&mut self, trials: &[Trial]) {
        // What a line aims at is the same for all of one proposal.
        let worst = self.elites.first().map_or(1.0, |elite| elite.harm).max(1.0);
        for (place, trial) in trials.iter().enumerate() {
            let Some(line) = self.lines.get_mut(place) else { continue };
            if line.runs == 0
                && let Some(screen) = line.screen
                && !self.screens.learn(screen, trial)
            {
                line.next = None;
                continue;
            }
            follow(line, self.space, trial, worst);
            if let Some(harm) = trial.unnoticed_harm().filter(|harm| *harm > 0.0) {
                self.elites.push(Elite { candidate: trial.candidate.clone(), harm });
            }
        }
        self.keep_the_worst();
    }

    /// Sorts what was found, worst first, and keeps a few of each kind.
    fn keep_the_worst(&mut self) {
        // Stable: of two alike the one that was found first.
        self.elites.sort_by(|a, b| b.harm.total_cmp(&a.harm));
        let mut kept: Vec<Elite> = Vec::new();
        for elite in self.elites.drain(..) {
            let forms = |candidate: &Candidate| -> Vec<usize> {
                candidate.faults.iter().map(|fault| fault.form).collect()
            };
            let alike = kept.iter().filter(|k| forms(&k.candidate) == forms(&elite.candidate));
            if alike.count() < ELITES_OF_A_KIND {
                kept.push(elite);
            }
        }
        kept.truncate(ELITES_MAX);
        self.elites = kept;
    }

    /// Begins a line.
    fn begin(&mut self) -> SizeLine {
        let mut draws = Draws::of(self.seed, "faults search", self.begun);
        self.begun += 1;
        if let Some(AskedFault { candidate, screen }) = self.screens.next() {
            let (key, start) = (self.size_key(&candidate), self.size_of(&candidate).unwrap_or(0.5));
            let next = Some(start);
            return SizeLine {
                candidate,
                key,
                low: None,
                high: None,
                runs: 0,
                next,
                screen: Some(screen),
            };
        }
        let is_pair = draws.unit() < self.pairs;
        let explores = self.elites.is_empty() || draws.unit() < EXPLORE;
        let (mut candidate, start) = if explores {
            let form = self.next_form(&mut draws);
            let fault = PlacedFault::random(self.space, form, &mut draws);
            // Not at an end of the range, from which a line goes one way only.
            (Candidate { faults: vec![fault] }, 0.3 + 0.4 * draws.unit())
        } else {
            let near = self.elites[self.one_of_the_worst(&mut draws)].candidate.clone();
            let faults = near.faults.iter().map(|fault| self.changed(fault, &mut draws)).collect();
            let start = self.size_of(&near).unwrap_or(0.5);
            (Candidate { faults }, start)
        };
        if is_pair && candidate.faults.len() == 1 {
            let second = if self.elites.is_empty() || draws.unit() < 0.5 {
                let form = draws.below(self.space.forms.len());
                PlacedFault::random(self.space, form, &mut draws)
            } else {
                let elite = &self.elites[self.one_of_the_worst(&mut draws)];
                let one = draws.below(elite.candidate.faults.len());
                self.changed(&elite.candidate.faults[one], &mut draws)
            };
            candidate.faults.push(second);
        }
        let key = self.size_key(&candidate);
        SizeLine { candidate, key, low: None, high: None, runs: 0, next: Some(start), screen: None }
    }

    /// The next form in a random order of all.
    fn next_form(&mut self, draws: &mut Draws) -> usize {
        if self.order.is_empty() {
            self.order = (0..self.space.forms.len()).collect();
            for last in (1..self.order.len()).rev() {
                self.order.swap(last, draws.below(last + 1));
            }
        }
        self.order.pop().unwrap_or(0)
    }

    /// Index of something found; the worst are taken more often.
    fn one_of_the_worst(&self, draws: &mut Draws) -> usize {
        let place = draws.unit().powi(2);
        ((place * self.elites.len() as f64) as usize).min(self.elites.len() - 1)
    }

    /// Key of the size of a candidate.
    fn size_key(&self, candidate: &Candidate) -> Option<usize> {
        self.space.forms[candidate.faults[0].form].size()
    }

    /// Place of the size of a candidate.
    fn size_of(&self, candidate: &Candidate) -> Option<f64> {
        candidate.faults[0].places.get(self.size_key(candidate)?).copied()
    }

    /// A fault near another one.
    fn changed(&self, fault: &PlacedFault, draws: &mut Draws) -> PlacedFault {
        let keys = &self.space.forms[fault.form].keys;
        let places = keys.iter().zip(&fault.places).map(|(key, place)| {
            let redrawn = draws.unit() < REDRAW;
            match &key.values {
                KeyValues::Fixed(_) => *place,
                _ if redrawn => draws.unit(),
                KeyValues::OneOf(_) => *place,
                KeyValues::Between(_) | KeyValues::Multiple(_) => {
                    (place + CHANGE * draws.normal()).clamp(0.0, 1.0)
                }
            }
        });
        PlacedFault { form: fault.form, places: places.collect() }
    }
}

/// Sets where a line goes on after a result.
fn follow(line: &mut SizeLine, space: &Space, trial: &Trial, worst: f64) {
    let Some(place) = line.next.take() else { return };
    line.runs += 1;
    let Some(key) = line.key else { return };
    let Some(effect) = trial.effect().filter(|effect| effect.fired) else { return };
    if effect.is_unnoticed() {
        if line.low.is_none_or(|(low, _)| place >= low) {
            line.low = Some((place, effect.harm()));
        }
    } else if line.high.is_none_or(|high| place < high) {
        line.high = Some(place);
    }
    let runs_max = if line.low.is_none() { RUNS_MAX_NOTICED } else { RUNS_MAX };
    if line.runs >= runs_max {
        return;
    }
    let form = &space.forms[line.candidate.faults[0].form];
    let Some(range) = form.keys[key].values.range() else { return };
    let (Some(edge), Some(decade)) = (range.distance_of(EDGE), range.distance_of(10.0)) else {
        return;
    };
    if line.screen.is_some() && line.low.is_none() {
        // Another screen notices it. Between this size and the one that is just harmful may be those that only the screen
        // of the earlier search noticed.
        let harm = effect.harm();
        let down = range.distance_of((harm / BEYOND).max(1.0).sqrt()).filter(|down| *down > edge);
        line.next = down.filter(|down| *down < place).map(|down| place - down);
        return;
    }
    let Some((low, harm)) = line.low else {
        // What is noticed at one size may be harmless at a tenth of it.
        line.next = line.high.filter(|high| *high > 0.0).map(|high| (high - decade).max(0.0));
        return;
    };
    let up = |distance: f64| (low < 1.0).then(|| (low + distance).min(1.0));
    let next = if harm > worst {
        // The worst so far: on to the edge.
        match line.high {
            Some(high) => (high - low > edge).then_some(0.5 * (low + high)),
            None => range.distance_of(CLIMB).and_then(up),
        }
    } else if harm < HARMLESS {
        // Nothing to extrapolate.
        (line.runs <= RUNS_MAX_HARMLESS).then(|| up(decade)).flatten()
    } else {
        range.distance_of(BEYOND * worst / harm).and_then(|jump| up(jump.min(JUMP_MAX * decade)))
    };
    line.next = next.filter(|next| line.high.is_none_or(|high| *next < high));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::{Form, FormKey, NumberRange};
    use crate::trial::{TrialEffect, TrialResult};

    fn space() -> Space {
        let kind = octant_faults::kinds::named("bias-step").unwrap();
        let unit = "deg/h".to_owned();
        let range = |from, to, is_logarithmic| {
            let unit = unit.clone();
            KeyValues::Between(NumberRange {
                from,
                to,
                unit,
                is_logarithmic,
                is_whole: false,
                digits: 3,
            })
        };
        let key = |name: &str, values| FormKey { name: name.to_owned(), values };
        let axes = ["x", "y", "z"].iter().map(|axis| format!("\"gyro {axis}\"")).collect();
        let keys = vec![
            key("channels", KeyValues::OneOf(axes)),
            key("amplitude", range(1e-3, 1e3, true)),
            key("onset", range(0.0, 100.0, false)),
        ];
        Space { forms: vec![Form { kind, keys }] }
    }

    /// An instrument whose harm is the size, and which notices everything but a narrow window: y channel, from
    /// 40 to 60 s, below 30.
    fn effect(space: &Space, candidate: &Candidate) -> TrialEffect {
        let [channel, size, onset] = candidate.faults[0].places[..] else { panic!() };
        let KeyValues::Between(range) = &space.forms[0].keys[1].values else { panic!() };
        let size = range.at(size);
        let is_open = (1.0 / 3.0..2.0 / 3.0).contains(&channel) && (0.4..0.6).contains(&onset);
        let noticed = size > if is_open { 30.0 } else { 0.5 };
        TrialEffect {
            fired: true,
            noticed_by: noticed.then(|| "gap".to_owned()),
            worst: Some(("gyro_bias_y".to_owned(), 3.0 * size)),
            ..TrialEffect::default()
        }
    }

    fn worst_of(runs: usize, seed: u64) -> (f64, usize) {
        let space = space();
        let mut guide = Guide::new(&space, seed, 0.0);
        let (mut worst, mut done) = (0.0f64, 0);
        let mut first = usize::MAX;
        while done < runs {
            let trials: Vec<Trial> = (guide.propose(8).into_iter())
                .map(|candidate| {
                    let result = TrialResult::Ran(effect(&space, &candidate));
                    Trial { candidate, result }
                })
                .collect();
            for trial in &trials {
                done += 1;
                worst = worst.max(trial.unnoticed_harm().unwrap_or(0.0));
                if worst > 1.0 {
                    first = first.min(done);
                }
            }
            guide.learn(&trials);
        }
        (worst, first)
    }

    #[test]
    fn a_narrow_window_is_found_and_its_edge_too() {
        for seed in 0..20 {
            let (worst, first) = worst_of(400, seed);
            // A third of the channels, a fifth of the onsets, a quarter of the sizes: one in sixty at random.
            assert!(first < 250, "seed {seed}: {first}");
            assert!(worst > 30.0 / EDGE / 1.05 && worst <= 30.0, "seed {seed}: {worst}");
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_candidates() {
        assert_eq!(worst_of(200, 3), worst_of(200, 3));
        assert_ne!(worst_of(40, 3), worst_of(40, 4));
    }
}
