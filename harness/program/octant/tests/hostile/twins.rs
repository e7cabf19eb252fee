//! Attacks on the comparison of a faulted run with its twin: units that remember one session and repeat it in the other.

use super::unit::{Over, SCENARIO, check, serve};
use super::{Ends, Row, fails, open};
use octant_base::control::Control;
use octant_endpoint::ServedCore;
use octant_fmu_bind::OpenedFmus;
use octant_link::device::Steps;
use octant_run::many::{Beginnings, OneOfMany, judge_each};
use octant_run::{Prepared, StreamKeeping, assemble};
use octant_sample::parameters::PARAMETER_COUNT;
use octant_sample::{Aiding, Health, Mode, Output, Parameters, Sample};
use octant_scenario::Scenario;
use octant_score::sessions::FirstSession;
use octant_score::summary::Summary;
use std::path::Path;
use std::sync::Mutex;

/// A fault in the calibration, and a limit on what it does.
const FAULT: &str = "[[faults]]
id = \"spike-1\"
kind = \"spike\"
trigger = { at = \"60 s\" }
duration = \"2 samples\"
channels = \"gyro x\"
amplitude = \"30 deg/h\"
[[requirements]]
id = \"SHIFT\"
text = \"No parameter moves.\"
measure = \"counterfactual.worst_shift_sigma\"
limit = 100
";

/// A limit on false alarms, which a unit that repeats what it reported of a fault breaks.
const ALARMS: &str = "[[requirements]]
id = \"QUIET\"
text = \"No false alarms.\"
measure = \"counterfactual.false_alarms\"
limit = 0
";

/// Gyro counts between two sessions that only a fault makes.
const OF_A_FAULT: i32 = 20_000;

/// Behaviour of a unit in a session after the first one.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Memory {
    /// Navigates anew.
    None,
    /// Repeats all answers of the first session.
    All,
    /// Repeats them with jitter in attitude and parameters.
    Jitter,
    /// Repeats them, with jitter in the parameters, from the first sample on that differs by more than the dither.
    FromTheFault,
    /// Repeats the parameters alone.
    Parameters,
    /// Finds that no fault comes, and states uncertainties that are far too large.
    Wide,
    /// Finds that no fault comes, and refuses its calibration.
    Refuses,
    /// Reports a fault all of the time, in each session.
    Alarmed,
}

/// Part of a step that the unit kept.
#[derive(Clone)]
struct Kept {
    sample: Sample,
    output: Output,
    parameters: (Parameters, [f64; PARAMETER_COUNT]),
}

/// The core, with a memory of its first session.
struct Remembering {
    core: ServedCore,
    memory: Memory,
    sessions: usize,
    first: Vec<Kept>,
    /// Steps of this session.
    step: usize,
    has_seen_the_fault: bool,
}

impl Remembering {
    fn of(core: ServedCore, memory: Memory) -> Self {
        let (sessions, step) = (0, 0);
        Self { core, memory, sessions, first: Vec::new(), step, has_seen_the_fault: false }
    }

    /// Answer that it repeats in place of that to this step.
    fn repeated(&self) -> Option<&Kept> {
        let kept = self.first.get(self.step.checked_sub(1)?).filter(|_| self.sessions > 1);
        kept.filter(|_| self.memory != Memory::FromTheFault || self.has_seen_the_fault)
    }
}

impl Steps for Remembering {
    fn restart(&mut self, offset: Option<&Parameters>) -> Result<(), String> {
        self.sessions += usize::from(self.step > 0 || self.sessions == 0);
        (self.step, self.has_seen_the_fault) = (0, false);
        self.core.restart(offset)
    }

    fn step(&mut self, sample: &Sample, aiding: Option<&Aiding>, output: &mut Output) {
        // A session begins with its first sample, whether it was started anew or not.
        if self.sessions == 0 {
            self.sessions = 1;
        }
        self.core.step(sample, aiding, output);
        self.step += 1;
        if self.memory == Memory::Alarmed {
            output.health |= Health::GYRO_STUCK;
        }
        if self.sessions == 1 {
            let parameters = self.core.parameters();
            self.first.push(Kept { sample: *sample, output: *output, parameters });
            return;
        }
        if let Some(kept) = self.first.get(self.step - 1) {
            let differs = |axis: usize| {
                sample.delta_theta[axis].abs_diff(kept.sample.delta_theta[axis]) as i32 > OF_A_FAULT
            };
            self.has_seen_the_fault |= (0..3).any(differs);
        }
        let jitter = 1e-10 * (self.step as f64 * 12.9898).sin();
        match (self.memory, self.repeated()) {
            (Memory::Refuses, _) if output.mode == Mode::Navigating => output.mode = Mode::Refused,
            (Memory::All | Memory::FromTheFault, Some(kept)) => *output = kept.output,
            (Memory::Jitter, Some(kept)) => {
                *output = kept.output;
                output.navigation.q_nb[1] += jitter;
            }
            _ => {}
        }
    }

    fn end(&mut self) -> Output {
        self.core.end()
    }

    fn parameters(&self) -> (Parameters, [f64; PARAMETER_COUNT]) {
        let own = self.core.parameters();
        match (self.memory, self.repeated()) {
            (Memory::None | Memory::Refuses | Memory::Alarmed, _) | (_, None) => own,
            (Memory::Wide, _) => (own.0, own.1.map(|sigma| 1000.0 * sigma)),
            (Memory::Jitter | Memory::FromTheFault, Some(kept)) => {
                let (parameters, sigma) = &kept.parameters;
                let values = parameters.to_array().map(|value| value * (1.0 + 1e-6));
                (Parameters::from_array(&values), *sigma)
            }
            (_, Some(kept)) => kept.parameters,
        }
    }
}

fn scenario(seed: u64, uri: Option<&str>, more: &str) -> Scenario {
    let text = SCENARIO.split("[[requirements]]").next().unwrap();
    let text = text.replace("\"20 s\"", "\"100 s\"").replace("\"10 s\"", "\"20 s\"");
    let mut set = vec![format!("seed={seed}")];
    if let Some(uri) = uri {
        set.push(format!("endpoint.uri={uri:?}"));
        set.extend(["answer", "hello"].map(|limit| format!("endpoint.link.{limit}=\"300 s\"")));
    }
    Scenario::parse(&format!("{text}{FAULT}{more}"), "twins.toml", Path::new(""), &set).unwrap()
}

/// Runs the unit with the fault and without it, as `octant run` does, or as a case of a campaign.
fn run(over: Over, seed: u64, memory: Memory) -> Summary {
    let more = if memory == Memory::Alarmed { ALARMS } else { "" };
    let served =
        serve(over, &scenario(seed, None, more), move |core| Remembering::of(core, memory));
    let live = scenario(seed, Some(&served.uri), more);
    if over == Over::Udp {
        let one =
            OneOfMany { scenario: &live, seed, keeping: StreamKeeping::HashAlone, twin: true };
        let found = Mutex::new(None);
        judge_each(&[one], Beginnings::Shared, 1, &Control::default(), &|_, run| {
            *found.lock().unwrap() = Some(run.unwrap().summary);
        });
        return found.into_inner().unwrap().unwrap();
    }
    let prepared = Prepared::of(&live, seed, true, &OpenedFmus::default()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let method = prepared.run(folder.path()).unwrap().remove(0);
    assemble(&live, seed, method, None).unwrap().summary
}

const REPEATS: Ends = open("don't differ as their samples do");
const SAME: Ends = open("the parameters of the unit are the same with the faults and without them");
const WIDE: Ends = open("times the uncertainty without the faults that it has with them");
const REFUSED: Ends =
    open("met against a twin without faults that isn't whole: its calibration was refused");
const ALARMED: Ends = fails("QUIET: counterfactual.false_alarms is 1");

/// Returns the rows of the table.
pub fn rows() -> Vec<Row> {
    let row = |about, ends| Row { group: "twin", about, over: "serial, UDP", ends };
    vec![
        row(
            "remembers its first session, and repeats all of its answers in the twin or with the fault",
            SAME,
        ),
        row("repeats them with jitter in attitude and parameters", REPEATS),
        row("repeats them from the first sample on that differs by more than noise", REPEATS),
        row("repeats the parameters of its first session alone", SAME),
        row("finds that no fault comes, and states uncertainties a thousand times too large", WIDE),
        row("finds that no fault comes, and refuses its calibration", REFUSED),
        row("reports a fault all of the time, with one and without", ALARMED),
    ]
}

/// Seeds of which the first draws the session with the fault as the first, the second the twin.
fn orders() -> [(u64, FirstSession); 2] {
    [(1, FirstSession::Faulted), (2, FirstSession::Twin)]
}

#[test]
fn a_unit_without_a_memory_passes_in_both_orders() {
    for (seed, first) in orders() {
        for over in [Over::Serial, Over::Udp] {
            let summary = run(over, seed, Memory::None);
            assert_eq!(summary.verdict.exit_code(), 0, "{:?}", summary.reasons);
            let found = summary.counterfactual.unwrap();
            let sessions = found.sessions.unwrap();
            assert_eq!((sessions.first, sessions.dither_counts), (first, 66), "{sessions:?}");
            // After the spike the filter is open for a while: so short a rest may show too little.
            assert!(sessions.before.is_some(), "{sessions:?}");
            for share in sessions.before.iter().chain(&sessions.after) {
                assert!((share.share - 1.0).abs() < 0.1, "{share:?}");
            }
            // The same with the core in this process, which has no dither.
            let own = scenario(seed, None, "");
            let prepared = Prepared::of(&own, seed, true, &OpenedFmus::default()).unwrap();
            let folder = tempfile::tempdir().unwrap();
            let method = prepared.run(folder.path()).unwrap().remove(0);
            let here = assemble(&own, seed, method, None).unwrap().summary.counterfactual.unwrap();
            let shift = (found.worst_shift_sigma.unwrap(), here.worst_shift_sigma.unwrap());
            assert!((shift.0 - shift.1).abs() < 0.1, "{shift:?}");
            assert!(here.sessions.is_none() && summary.stream_hash.len() == 64);
        }
    }
}

macro_rules! twins {
    ($($name:ident: $row:literal, $memory:expr;)*) => {
        $(#[test]
        fn $name() {
            let row = &rows()[$row];
            let [faulted_first, twin_first] = orders().map(|(seed, _)| seed);
            check(row.about, &row.ends, Ok(run(Over::Serial, faulted_first, $memory)));
            check(row.about, &row.ends, Ok(run(Over::Udp, twin_first, $memory)));
        })*
    };
}

twins! {
    repeats_everything: 0, Memory::All;
    repeats_with_jitter: 1, Memory::Jitter;
    repeats_from_the_fault: 2, Memory::FromTheFault;
    repeats_parameters: 3, Memory::Parameters;
    reports_all_of_the_time: 6, Memory::Alarmed;
}

/// These act in the session that comes second, which has to be the twin.
#[test]
fn what_is_done_where_no_fault_comes_is_seen() {
    let (faulted_first, _) = orders()[0];
    for (row, memory) in [(4, Memory::Wide), (5, Memory::Refuses)] {
        let row = &rows()[row];
        for over in [Over::Serial, Over::Udp] {
            check(row.about, &row.ends, Ok(run(over, faulted_first, memory)));
        }
    }
}
