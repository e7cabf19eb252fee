//! Findings besides requirements that affect the verdict of a run: errors of unit and bench, and
//! missing evidence.

use super::clock_doubt::clock_doubt;
use super::compared::too_like;
use super::difference::between;
use super::method::{MethodRun, planned_of};
use super::refusal::Seen;
use crate::bench::ended::Ended;
use octant_account::Account;
use octant_base::number;
use octant_calibration::config::{Estimator, SwayNoise};
use octant_faults::Receipt;
use octant_faults::catalogue::Acts;
use octant_scenario::{CalibrationSpec, Method, Realtime, Scenario};
use octant_score::information::{Estimated, against_bound};
use octant_score::judge::Finding;
use octant_score::summary::{FollowedScore, PacingRecord};
use octant_score::work::{RunPart, duration};
use octant_source::OF_REFERENCE;
use octant_verdict::Verdict;

/// Lists the findings that affect the verdict of a run of one or two methods.
#[must_use]
pub fn findings(
    scenario: &Scenario,
    primary: &MethodRun,
    baseline: Option<&MethodRun>,
) -> Vec<Finding> {
    let mut findings: Vec<Finding> = broken(primary, baseline)
        .into_iter()
        .map(|reason| Finding::of_bench(Verdict::Error, reason))
        .collect();
    let methods = [
        Some((primary, Method::Primary, String::new())),
        baseline.map(|run| (run, Method::Baseline, format!(" in {}", run.label))),
    ];
    for (run, method, place) in methods.into_iter().flatten() {
        findings.extend(of_bench(scenario, run, &place));
        let too_like = too_like(scenario, run).into_iter();
        findings.extend(too_like.map(|reason| Finding::of_bench(Verdict::Inconclusive, reason)));
        findings.extend(of_unit(scenario, run, method, &place));
        findings.extend(of_run(&scenario.realtime, run, &place));
        let Some(twin) = &run.twin else { continue };
        let memory = between(scenario, run, twin).and_then(|found| found.sessions?.memory());
        let remembers =
            |reason| Finding::of_unit(Verdict::Inconclusive, format!("{reason}{place}"));
        findings.extend(memory.map(remembers));
        let in_twin = |reason: &str| format!("{reason}{place}, in the twin without faults");
        match &twin.observed.answers.misbehaved {
            Some(misbehaviour) => {
                let reason = in_twin(&misbehaviour.to_string());
                findings.push(Finding::of_unit(Verdict::Fail, reason));
            }
            None => {
                let reasons = twin.observed.answers.do_not_follow();
                let inconclusive =
                    |reason: String| Finding::of_unit(Verdict::Inconclusive, in_twin(&reason));
                findings.extend(reasons.into_iter().map(inconclusive));
            }
        }
    }
    findings
}

/// Lists errors of the bench.
fn of_bench(scenario: &Scenario, run: &MethodRun, place: &str) -> Vec<Finding> {
    let mut reasons = Vec::new();
    if let Some(broke) = &run.observed.answers.bench_broke {
        let at = duration(broke.at_s);
        let then = match run.ended {
            Ended::Lost => "the run was ended there, as --stop-when-lost asks",
            _ => "nothing after it is judged",
        };
        reasons.push(format!("the bench failed at {at}{place}: {}; {then}", broke.reason));
    } else if run.ended == Ended::Lost {
        reasons.push(format!("nothing was done{place}: the bench had failed before"));
    }
    // The unit isn't responsible for the missing rest of a file.
    reasons.extend(run.bench.cut_short.iter().map(|cut_short| format!("{cut_short}{place}")));
    let doubts = run.bench.inputs.iter().flat_map(Account::doubts);
    reasons.extend(doubts.map(|doubt| format!("{doubt}{place}")));
    let calibration = run.calibration.as_ref().filter(|c| c.refused.is_none());
    let clocks = run.bench.inputs.iter().filter_map(|input| clock_doubt(input, calibration?));
    reasons.extend(clocks.map(|doubt| format!("{doubt}{place}")));
    reasons.extend(lacking(scenario, run).map(|lacking| format!("{lacking}{place}")));
    let pacing = run.bench.kept.as_ref().map(|kept| &kept.pacing);
    reasons.extend(pacing.map(|pacing| too_late(&scenario.realtime, pacing)).unwrap_or_default());
    let inconclusive = |reason| Finding::of_bench(Verdict::Inconclusive, reason);
    reasons.into_iter().map(inconclusive).collect()
}

/// Describes an input that lacks what the calibration was refused for: the unit isn't responsible.
fn lacking(scenario: &Scenario, run: &MethodRun) -> Option<String> {
    let refused = run.calibration.as_ref()?.refused.as_ref()?;
    let mut inputs = run.bench.inputs.iter().filter(|_| scenario.faults.is_empty());
    let (input, lacks) = match Seen::of(refused) {
        Seen::Samples => {
            let lacks = |input: &&Account| input.missing_count() + input.left_out_count() > 0;
            (inputs.find(lacks)?, "samples")
        }
        Seen::Reference => {
            (inputs.find(|input| input.name().ends_with(OF_REFERENCE))?, "measurements")
        }
        _ => return None,
    };
    Some(format!("{}: the calibration was refused for the {lacks} that it lacks", input.headline()))
}

/// Lists where the bench was late, lost samples, or did not send them.
#[must_use]
pub fn too_late(limits: &Realtime, pacing: &PacingRecord) -> Vec<String> {
    let mut reasons = Vec::new();
    if pacing.overruns > limits.overruns {
        reasons.push(format!(
            "the bench was late: {} of {} samples left more than {} us late, {} may; the latest {} us",
            pacing.overruns,
            pacing.frames,
            number::plain(pacing.overrun_us, 5),
            limits.overruns,
            number::plain(pacing.lateness_us.max, 5),
        ));
    }
    if let Some(limit_ns) = limits.lateness_p99_ns
        && pacing.lateness_us.p99 * 1e3 > limit_ns as f64
    {
        reasons.push(format!(
            "the bench was late: the lateness of 99 % of the samples is {} us, {} us are allowed",
            number::plain(pacing.lateness_us.p99, 5),
            number::plain(limit_ns as f64 / 1e3, 5),
        ));
    }
    if pacing.not_sent > 0 {
        reasons.push(format!("{} samples could not be sent", pacing.not_sent));
    }
    if pacing.dropped_records > 0 {
        reasons.push(format!(
            "{} steps found no room on their way to the recorder: the recording is not complete",
            pacing.dropped_records
        ));
    }
    reasons
}

/// Lists errors of the unit, and parts of its answers that are no evidence.
fn of_unit(scenario: &Scenario, run: &MethodRun, method: Method, place: &str) -> Vec<Finding> {
    let mut findings = Vec::new();
    if let Some(misbehaviour) = &run.observed.answers.misbehaved {
        findings.push(match altered(scenario, &run.receipts, misbehaviour.sample) {
            None => Finding::of_unit(Verdict::Fail, format!("{misbehaviour}{place}")),
            Some(id) => Finding::of_unit(
                Verdict::Inconclusive,
                format!("{misbehaviour}{place}, while fault {id} was on the wire"),
            ),
        });
        return findings;
    }
    let mut reasons = run.observed.answers.do_not_follow();
    reasons.extend(run.followed.as_ref().and_then(FollowedScore::doubt).map(str::to_owned));
    let plan = scenario.calibration_of(method);
    reasons.extend(plan.and_then(|plan| not_estimated(scenario, plan, run)));
    reasons.extend(plan.and_then(|plan| not_white(plan, run)));
    reasons.extend(plan.and_then(|plan| too_good(scenario, plan, run)));
    let inconclusive = |reason| Finding::of_unit(Verdict::Inconclusive, format!("{reason}{place}"));
    findings.extend(reasons.into_iter().map(inconclusive));
    findings
}

/// Returns the fault of the wire that may have altered the answer to a sample.
fn altered<'a>(scenario: &'a Scenario, receipts: &[Receipt], sample: u64) -> Option<&'a str> {
    let wired = scenario.faults.iter().filter(|fault| fault.spec.kind.acts == Acts::Wire);
    let hit = |id: &str| {
        receipts.iter().any(|receipt| {
            receipt.id == id
                && receipt.first_sample.is_some_and(|first| first <= sample)
                && receipt.last_sample.is_none_or(|last| sample <= last)
        })
    };
    wired.map(|fault| fault.spec.id.as_str()).find(|id| hit(id))
}

/// Describes parameters that were to be estimated and weren't, or never changed.
fn not_estimated(scenario: &Scenario, plan: &CalibrationSpec, run: &MethodRun) -> Option<String> {
    let calibration = run.calibration.as_ref().filter(|c| c.refused.is_none())?;
    let (planned, done) = run.observed.done.planned_and_done();
    if planned.short_of(&done).iter().any(|short| short.part == RunPart::Calibration) {
        return None;
    }
    let planned = planned_of(plan);
    let without: Vec<&str> = planned
        .iter()
        .copied()
        .filter(|name| calibration.parameters.get(*name).is_none_or(|p| p.sigma.is_none()))
        .collect();
    // A unit that reports no parameters at all needn't, unless a requirement needs them.
    let asked = scenario
        .requirements
        .iter()
        .any(|requirement| RunPart::of(&requirement.check.measure) == Some(RunPart::Calibration));
    if !without.is_empty() && (without.len() < planned.len() || asked) {
        return Some(format!(
            "{} of the {} parameters that were to be estimated have no uncertainty above zero: {}",
            without.len(),
            planned.len(),
            without.join(" ")
        ));
    }
    let estimate = run.observed.convergence.last?;
    let still = estimate.parameters == scenario.initial_parameters;
    (without.is_empty() && !planned.is_empty() && still).then(|| {
        "the calibration doesn't follow the samples: not one parameter moved from where it began"
            .to_owned()
    })
}

/// Says that the errors of the parameters are smaller than the noise of the samples allows.
fn too_good(scenario: &Scenario, plan: &CalibrationSpec, run: &MethodRun) -> Option<String> {
    run.calibration.as_ref().filter(|c| c.refused.is_none())?;
    let planned = planned_of(plan);
    let estimated = Estimated {
        truth: run.truth.as_ref()?,
        initial: &scenario.initial_parameters,
        estimate: &run.observed.convergence.last?.parameters,
        planned: &planned,
        random_walks: [scenario.imu.angle_random_walk, scenario.imu.velocity_random_walk],
    };
    against_bound(&run.observed.information.sum, &estimated)?.doubt()
}

/// Says that the sway of a ship isn't white, where an accepted calibration takes it for white noise.
fn not_white(plan: &CalibrationSpec, run: &MethodRun) -> Option<String> {
    let Estimator::Kalman(kalman) = &plan.estimator else { return None };
    let calibration = run.calibration.as_ref().filter(|c| c.refused.is_none())?;
    let white = kalman.sway == SwayNoise::White;
    white.then(|| run.observed.measurements.whiteness.doubt(calibration.nis_mean?)).flatten()
}

/// Lists the missing evidence of the run.
fn of_run(limits: &Realtime, run: &MethodRun, place: &str) -> Vec<Finding> {
    let mut reasons = Vec::new();
    if run.ended == Ended::Cancelled {
        let after_s = run.observed.elapsed_s();
        reasons.push(format!("interrupted after {after_s:.1} s of the run{place}"));
    }
    let unlisted = run.observed.measurements.health.unlisted();
    if unlisted > 0 {
        reasons.push(format!("{unlisted} reports of the core found no place in the list{place}"));
    }
    if let Some(kept) = &run.bench.kept {
        let pacing = &kept.pacing;
        if pacing.late_answers > limits.late_answers {
            reasons.push(format!(
                "{} of {} periods ended without an answer, {} may{place}",
                pacing.late_answers, pacing.frames, limits.late_answers
            ));
        }
        if pacing.missed_answers > 0 {
            reasons.push(format!("{} samples were never answered{place}", pacing.missed_answers));
        }
    }
    reasons.into_iter().map(Finding::of_run).collect()
}

/// Lists time and place of failures, in the methods of a run and their twins.
#[must_use]
pub fn broken(primary: &MethodRun, baseline: Option<&MethodRun>) -> Vec<String> {
    let baseline = baseline.map(|run| (run, format!(" in {}", run.label)));
    let sides =
        std::iter::once((primary, String::new())).chain(baseline).flat_map(|(run, place)| {
            let twin = run.twin.as_deref();
            let twin = twin.map(|twin| (twin, format!("{place} in the twin without faults")));
            std::iter::once((run, place)).chain(twin)
        });
    sides
        .filter_map(|(run, place)| {
            let error = run.bench.broken.as_ref()?;
            let at_s = run.observed.elapsed_s();
            Some(format!("after {at_s:.3} s{place}: {error}"))
        })
        .collect()
}
