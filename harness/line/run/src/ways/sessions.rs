//! Two sessions of one unit, with the faults and without them, where the unit isn't the core of this process: it may remember
//! the one that came first. The order is drawn from the seed, and the samples of the twin have a dither.

use crate::observers::session::Session;
use octant_random::draws::Draws;
use octant_scenario::{Method, Scenario};
use octant_source::session_dither::SessionDither;

/// The sessions of a method: with the faults, and without them.
#[derive(Clone, Copy, Debug)]
pub(super) struct BothSessions {
    pub(super) faulted: Session,
    pub(super) twin: Session,
}

impl BothSessions {
    /// Plans the sessions; `None` where both are computed by the core of this process, and where the samples aren't those of
    /// this program's plant, so that no two sessions have the same.
    pub(super) fn of(scenario: &Scenario, method: Method, seed: u64) -> Option<Self> {
        if scenario.endpoint.is_in_process() || !scenario.source.has_plant() {
            return None;
        }
        let stream = match method {
            Method::Primary => "session of the twin",
            Method::Baseline => "session of the twin, second method",
        };
        // By the clock, and with a person, the session with the faults is the one that they are there for.
        let attended = scenario.realtime.by_clock || !scenario.operator.is_empty();
        let twin_first = !attended && Draws::of(seed, stream, 0).below(2) == 0;
        let sample_s = scenario.sample_period_ns as f64 * 1e-9;
        let dither = SessionDither::below(scenario.imu.angle_random_walk, sample_s, seed, stream);
        Some(Self {
            faulted: Session { is_first: !twin_first, dither: None },
            twin: Session { is_first: twin_first, dither: Some(dither) },
        })
    }
}
