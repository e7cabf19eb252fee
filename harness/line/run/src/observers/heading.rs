//! Headings of a unit over its run-ups, as a heading test reads them.

use octant_endpoint::Tells;
use octant_heading::score::{HeadingPlan, HeadingScore, HeadingTest};
use octant_heading::{Reading, Series, angle};
use octant_sample::{Mode, Output, Truth};
use octant_scenario::{HeadingTestKind, HeadingTestSpec, MotionSpec, Scenario, SourceSpec};
use octant_score::attitude::CaseAngles;

/// Time between two readings at rest, ns.
const AT_REST_NS: u64 = 1_000_000_000;
/// Time between two readings of a test that looks at the error in a motion, ns: 60 of the shortest period, 6 s.
const IN_MOTION_NS: u64 = 100_000_000;

/// Readings of a heading test.
#[derive(Clone, Debug)]
pub struct HeadingReadings {
    plan: HeadingPlan,
    /// Time at which the unit was switched on, ns; `None`: it is off.
    on_ns: Option<u64>,
    /// Series of each run-up, the present one last.
    run_ups: Vec<Series>,
    /// Period of a solution, ns, whose run has the time with power: run-ups follow each other without a pause. `None`: the
    /// unit is switched on in the run.
    of_solution_ns: Option<u64>,
}

impl HeadingReadings {
    /// Readings of a scenario's heading test; `None` without one.
    #[must_use]
    pub fn of(scenario: &Scenario) -> Option<Box<Self>> {
        let plan = plan(scenario, scenario.heading_test.as_ref()?);
        let is_solution = matches!(scenario.source, SourceSpec::Solution(_));
        let of_solution_ns = is_solution.then_some(scenario.sample_period_ns);
        let run_ups = vec![Series::default()];
        Some(Box::new(Self { plan, on_ns: Some(0), run_ups, of_solution_ns }))
    }

    /// Place of a time of a solution's run: number of the run-up, and time since switching on, s.
    fn place(&self, now_ns: u64, period_ns: u64) -> (usize, f64) {
        let since_s = now_ns.saturating_sub(period_ns) as f64 * 1e-9;
        let last = self.plan.run_ups.saturating_sub(1);
        let number = ((since_s / self.plan.run_up_s) as usize).min(last);
        (number, since_s - number as f64 * self.plan.run_up_s)
    }

    /// Adds what a solution tells besides its headings: the times at which the unit answered without one, ns of the run, and
    /// the last digit of its headings, rad.
    pub(crate) fn complete(&mut self, without_heading_ns: &[u64], digit_rad: f64) {
        let Some(period_ns) = self.of_solution_ns else { return };
        self.plan.resolution_deg = digit_rad.to_degrees();
        let mut all: Vec<Vec<Reading>> = vec![Vec::new(); self.plan.run_ups.max(1)];
        for (number, series) in self.run_ups.iter().enumerate() {
            all[number].extend(series.readings());
        }
        for now_ns in without_heading_ns {
            let (number, t_s) = self.place(*now_ns, period_ns);
            let moving = self.moves_at(t_s);
            all[number].push(Reading { t_s, heading_deg: None, true_deg: None, moving });
        }
        self.run_ups = all
            .into_iter()
            .map(|mut readings| {
                readings.sort_by(|a, b| a.t_s.total_cmp(&b.t_s));
                readings.into_iter().collect()
            })
            .collect();
    }

    /// True while the table moves.
    fn moves_at(&self, t_s: f64) -> bool {
        let [from_s, to_s] = self.plan.motion_s.unwrap_or([f64::INFINITY; 2]);
        from_s < t_s && t_s < to_s
    }

    /// Time between two readings, ns.
    pub(super) fn period_ns(&self) -> u64 {
        match self.plan.test {
            HeadingTest::Dynamic => IN_MOTION_NS,
            HeadingTest::Settle | HeadingTest::SettleInMotion | HeadingTest::Scorsby => AT_REST_NS,
        }
    }

    /// Begins with a run-up: the unit was switched on after the sample of this time, ns.
    #[cold]
    pub(super) fn switched_on(&mut self, now_ns: u64) {
        self.on_ns = Some(now_ns);
        self.run_ups.push(Series::default());
    }

    /// Takes an answer with its truth.
    pub(super) fn read(&mut self, tells: Tells, now_ns: u64, output: &Output, truth: &Truth) {
        let Some(on_ns) = self.on_ns else { return };
        let (number, t_s) = match self.of_solution_ns {
            Some(period_ns) => self.place(now_ns, period_ns),
            None => (self.run_ups.len() - 1, now_ns.saturating_sub(on_ns) as f64 * 1e-9),
        };
        while self.run_ups.len() <= number {
            self.run_ups.push(Series::default());
        }
        let moving = self.moves_at(t_s);
        let known = truth.q_nb.iter().all(|q| q.is_finite());
        let true_heading = known.then(|| CaseAngles::of(truth.q_nb, truth.gimbal_rad).heading_rad);
        let has_heading = tells.attitude
            && matches!(output.mode, Mode::Calibrating | Mode::Navigating | Mode::Done);
        // Turned by the true gimbal angles, so that errors of the encoders aren't errors of the heading.
        let shown = has_heading
            .then(|| CaseAngles::of(output.navigation.q_nb, truth.gimbal_rad).heading_rad);
        self.run_ups[number].push(Reading {
            t_s,
            heading_deg: shown
                .map(|rad| angle::rounded(rad.to_degrees(), self.plan.resolution_deg)),
            true_deg: true_heading.map(|rad| angle::heading(rad.to_degrees())),
            moving,
        });
    }

    /// Scores the readings.
    #[must_use]
    pub fn score(&self) -> HeadingScore {
        HeadingScore::of(&self.plan, &self.run_ups)
    }

    /// Readings of each run-up.
    #[must_use]
    pub fn run_ups(&self) -> &[Series] {
        &self.run_ups
    }
}

/// Plan of a scenario's heading test.
fn plan(scenario: &Scenario, spec: &HeadingTestSpec) -> HeadingPlan {
    let samples = scenario.run_up_samples().unwrap_or(u64::MAX);
    let run_up_s = samples as f64 * scenario.sample_period_ns as f64 * 1e-9;
    let motion_s = match &scenario.motion {
        MotionSpec::Static(_) => None,
        MotionSpec::Dockside(ship) => Some(ship.span.map_or([0.0, run_up_s], |span| {
            let (from_s, to_s) = span.from_to_s();
            [from_s, to_s.unwrap_or(run_up_s)]
        })),
    };
    HeadingPlan {
        test: match spec.test {
            HeadingTestKind::Settle => HeadingTest::Settle,
            HeadingTestKind::SettleInMotion => HeadingTest::SettleInMotion,
            HeadingTestKind::Scorsby => HeadingTest::Scorsby,
            HeadingTestKind::Dynamic => HeadingTest::Dynamic,
        },
        run_up_s,
        run_ups: spec.run_ups as usize,
        motion_s,
        resolution_deg: spec.resolution_rad.to_degrees(),
        latitude_deg: scenario.site.latitude_rad.to_degrees(),
    }
}
