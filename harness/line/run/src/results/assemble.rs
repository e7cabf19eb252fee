//! Assembles summary, report and verdict from the methods of a run.

use super::compared::{heading_output, stated, timing};
use super::difference::difference;
use super::findings::findings;
use super::known_noise::{dither_fact, false_alarms};
use super::method::MethodRun;
use super::refusal::{RefusedRun, explained};
use super::scores_text::{alignment_line, heading_lines, navigation_lines, solution_line};
use super::uncertainty::{Found, uncertainty};
use crate::observers::at_rest::instrument_noise;
use octant_base::display::DisplayUnits;
use octant_base::number;
use octant_calibration::sequence::{Sequence, Stop};
use octant_earth::frames::c_cb;
use octant_earth::units::{DEG, DEG_PER_HOUR, DEG_PER_SQRT_HOUR, MICRO_G};
use octant_evidence::disposition::Dispositions;
use octant_recorder::event::FaultResult;
use octant_report::counterfactual::in_words;
use octant_report::{ReportData, ReportProvenance, SolutionSeries, StopLabel};
use octant_sample::parameters::NAMES;
use octant_scenario::file_names::FileNames;
use octant_scenario::{CalibrationSpec, HeadingCondition, MotionSpec, Scenario, SourceSpec};
use octant_score::counterfactual::Counterfactual;
use octant_score::equipment;
use octant_score::judge::{Finding, judge_by};
use octant_score::numerics::NUMERICS;
use octant_score::reference::{ReferenceInput, reference};
use octant_score::summary::{
    AllanDeviation, AlteredStreamSummary, BaselineMethod, CalibrationScore, ParameterScore,
    Summary, WITH_FINDINGS, results,
};
use octant_turntable::TableAxis;
use octant_verdict::Verdict;
use octant_verdict::decision::NavigationContext;
use octant_verdict::equipment::Day;
use std::collections::BTreeMap;

/// A run of one or two methods, scored and judged.
#[derive(Debug)]
pub struct Run {
    /// Content of `summary.json`.
    pub summary: Summary,
    /// Content of the report; the caller fills in its provenance.
    pub report: ReportData,
}

/// Settings of a run beside its scenario that affect its verdict.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Choice {
    /// True if the scenario must have requirements.
    pub require: bool,
    /// Faults of the scenario that were left out.
    pub left_out: Vec<String>,
    /// Day on which the run ended, to which certificates are compared; not used if the scenario has
    /// no equipment.
    pub day: Option<Day>,
    /// Reasons why the run is no evidence, of what a person did or didn't do in it.
    pub operator: Vec<String>,
}

impl Choice {
    /// Returns the findings of these settings, for a run with or without requirements.
    fn findings(&self, requires: bool) -> Vec<Finding> {
        let mut findings = Vec::new();
        if self.require && !requires {
            findings.push(Finding::of_run(
                "the scenario requires nothing, and --require wants it to".to_owned(),
            ));
        }
        findings.extend(self.operator.iter().cloned().map(Finding::of_run));
        if requires && !self.left_out.is_empty() {
            // Limits apply with the faults; a run without them is no evidence for the limits.
            findings.push(Finding::of_run(format!(
                "--only-faults left out {} of the scenario's faults, with which its requirements are to be \
                 kept: {}",
                self.left_out.len(),
                self.left_out.join(", ")
            )));
        }
        findings
    }
}

/// Assembles the methods of a run: summary, verdict, report.
///
/// # Errors
/// If the summary can't be written as JSON.
pub fn assemble(
    scenario: &Scenario,
    seed: u64,
    primary: MethodRun,
    baseline: Option<MethodRun>,
) -> Result<Run, serde_json::Error> {
    assemble_with(scenario, seed, primary, baseline, &Choice::default())
}

/// Assembles as [`assemble`], with settings beside the scenario.
///
/// # Errors
/// If the summary can't be written as JSON.
pub fn assemble_with(
    scenario: &Scenario,
    seed: u64,
    mut primary: MethodRun,
    baseline: Option<MethodRun>,
    choice: &Choice,
) -> Result<Run, serde_json::Error> {
    let g_zz = |run: &MethodRun| {
        run.observed.convergence.last.map(|estimate| estimate.parameters.g_dependent[8])
    };
    // Under another rotation the drift has other elements of G, and no reference that is told as that of g_zz.
    let g_zz_alone = scenario.navigation.as_ref().is_none_or(|n| leaves_g_zz_alone(&n.rotation));
    let is_solution = matches!(scenario.source, SourceSpec::Solution(_));
    let references = reference(&ReferenceInput {
        latitude_rad: scenario.site.latitude_rad,
        height_m: scenario.site.height_m,
        heading_rad: scenario.motion.heading_rad(),
        angle_random_walk: scenario.imu.angle_random_walk,
        velocity_random_walk: scenario.imu.velocity_random_walk,
        calibration_s: scenario.calibration.as_ref().map(|c| c.duration_s),
        // The noise of an instrument that made a solution elsewhere isn't known.
        navigation_s: (scenario.navigation.as_ref())
            .filter(|_| !is_solution)
            .and_then(|n| n.duration_s),
        true_g_zz: primary.truth.filter(|_| g_zz_alone).map(|truth| truth.g_dependent[8]),
        estimated_g_zz: g_zz(&primary),
        baseline_estimated_g_zz: baseline.as_ref().and_then(g_zz),
    });
    let mut findings = findings(scenario, &primary, baseline.as_ref());
    findings.extend(equipment::findings(&scenario.equipment, choice.day.as_ref()));
    findings.extend(choice.findings(!scenario.requirements.is_empty()));
    let (planned, done) = primary.observed.done.planned_and_done();
    let against = NavigationContext {
        simulated: scenario.source.is_simulated(primary.navigation.is_some()),
        latitude_rad: scenario.site.latitude_rad,
        height_m: scenario.site.height_m,
        navigation_s: done.navigation_s.unwrap_or_default(),
        timing: timing(scenario, &primary),
    };
    let counterfactual = difference(scenario, &primary);
    let false_alarms = false_alarms(scenario, &primary, counterfactual.as_ref());
    let baseline_counterfactual = baseline.as_ref().and_then(|run| difference(scenario, run));
    let baseline_solution = baseline
        .as_ref()
        .map_or_else(SolutionSeries::default, |run| run.observed.drift.solution.clone());
    let filtered = |run: &MethodRun| {
        run.observed
            .charts
            .filtered
            .as_ref()
            .map_or_else(SolutionSeries::default, |f| f.errors.clone())
    };
    let calibration_errors = filtered(&primary);
    let baseline_calibration_errors =
        baseline.as_ref().map_or_else(SolutionSeries::default, filtered);
    let compared = primary.bench.compared.take();
    let output = compared.as_ref().and_then(|compared| heading_output(compared));
    if let (Some(compared), Some(heading)) = (&compared, &mut primary.observed.heading) {
        heading.complete(compared.without_heading_ns(), compared.coarsest_heading()[0]);
    }
    if let Some(navigation) = &mut primary.navigation {
        navigation.heading_output = output.map(Box::new);
    }
    let mut decision = scenario.decision.decided(&against);
    if let Some(stated) = compared.as_ref().and_then(|compared| stated(compared)) {
        decision.text += &format!(", {stated}");
    }
    let mut summary = Summary {
        schema: WITH_FINDINGS,
        octant: env!("CARGO_PKG_VERSION").to_owned(),
        numerics: Some(NUMERICS),
        scenario: scenario.title.clone(),
        seed,
        verdict: Verdict::Pass,
        reasons: Vec::new(),
        requirements: Vec::new(),
        findings: Vec::new(),
        decision: Some(decision),
        planned: Some(planned),
        done: Some(done),
        inputs: primary.bench.accounts(),
        faults: results(&primary.receipts),
        altered_streams: primary.recorder.altered_streams.as_ref().map(AlteredStreamSummary::from),
        method: primary.label.clone(),
        alignment: primary.alignment,
        calibration: primary.calibration.take(),
        navigation: primary.navigation.take(),
        followed: primary.followed.take(),
        heading: primary.observed.heading.as_ref().map(|readings| readings.score()),
        baseline: baseline.map(|run| BaselineMethod {
            planned: Some(run.observed.done.planned()),
            done: Some(run.observed.done.work()),
            label: run.label,
            alignment: run.alignment,
            calibration: run.calibration,
            navigation: run.navigation,
            followed: run.followed,
            counterfactual: baseline_counterfactual,
            stream_hash: run.recorder.stream_hash,
            faults: results(&run.receipts),
        }),
        reference: Some(references),
        false_alarms,
        counterfactual,
        allan_deviation: primary.observed.charts.at_rest.take().and_then(|at_rest| {
            AllanDeviation::of(&at_rest.record(), instrument_noise(scenario).as_ref()).map(Box::new)
        }),
        pacing: primary.bench.kept.as_ref().map(|kept| kept.pacing.clone()),
        stream_hash: primary.recorder.stream_hash.clone(),
    };
    explain_refusals(&mut summary, scenario);
    let requirements: Vec<_> = scenario.requirements.iter().map(|r| r.check.clone()).collect();
    let heading = summary.heading.clone();
    judge_by(&mut summary, &requirements, &findings, |measure| {
        let found = Found { compared: compared.as_deref(), heading: heading.as_ref(), output };
        uncertainty(scenario, measure, &against, &found)
    })?;
    summary.schema = summary.needed_schema()?;
    let report = ReportData {
        solution: primary.observed.drift.solution.clone(),
        baseline_solution,
        calibration_errors,
        baseline_calibration_errors,
        navigation_start_h: primary.observed.drift.start_h(),
        latitude_rad: Some(scenario.site.latitude_rad),
        sample_period_s: Some(scenario.sample_period_ns as f64 * 1e-9),
        covariance: primary.table.as_ref().map(|table| Box::new(table.covariance)),
        requirement_texts: requirement_texts(scenario),
        requirement_clauses: scenario.requirement_clauses(),
        heading_condition: HeadingCondition::of(scenario).words(),
        summary: summary.clone(),
        axes_of_source: FileNames::of(&scenario.source).line(),
        facts: facts(scenario),
        units: scenario.display,
        truth: primary.truth,
        events: primary.observed.measurements.events(),
        convergence: primary.observed.convergence.points,
        nis: primary.observed.measurements.nis,
        gimbals: primary.observed.gimbals.points,
        stops: stop_labels(scenario),
        dispositions: Dispositions::default(),
        provenance: ReportProvenance::default(),
    };
    Ok(Run { summary, report })
}

/// Adds to each refused calibration what its reader needs.
fn explain_refusals(summary: &mut Summary, scenario: &Scenario) {
    let explain = |calibration: &mut Option<CalibrationScore>,
                   faults: &[FaultResult],
                   twin: Option<&Counterfactual>,
                   plan: Option<&CalibrationSpec>| {
        if let (Some(calibration), Some(plan)) = (calibration, plan)
            && let Some(reason) = &calibration.refused
        {
            let health = &calibration.health;
            let run = RefusedRun { reason, health, faults, twin, scenario, plan };
            calibration.refusal_explained = explained(&run);
        }
    };
    explain(
        &mut summary.calibration,
        &summary.faults,
        summary.counterfactual.as_ref(),
        scenario.calibration.as_ref(),
    );
    if let Some(baseline) = &mut summary.baseline {
        let twin = baseline.counterfactual.as_ref();
        explain(&mut baseline.calibration, &baseline.faults, twin, scenario.baseline.as_ref());
    }
}

/// Lists the texts of a scenario's requirements by their ids.
#[must_use]
pub fn requirement_texts(scenario: &Scenario) -> BTreeMap<String, String> {
    scenario.requirements.iter().map(|r| (r.check.id.clone(), r.text.clone())).collect()
}

/// Lists the stops of a scenario's calibration with their positions, over all passes.
#[must_use]
pub fn stop_labels(scenario: &Scenario) -> Vec<StopLabel> {
    let Some(calibration) = &scenario.calibration else { return Vec::new() };
    let numbered = calibration.numbered_stops();
    let all = calibration.sequence.stops().iter().cycle().take(numbered.count);
    let label = |(stop, at): (usize, &Stop)| StopLabel {
        azimuth_deg: at.azimuth_rad.to_degrees(),
        roll_deg: at.roll_rad.to_degrees(),
        text: numbered.describe(stop),
    };
    all.enumerate().map(label).collect()
}

/// Lists the setting of a run for the head of the report.
#[must_use]
pub fn facts(scenario: &Scenario) -> Vec<(String, String)> {
    let imu = &scenario.imu;
    let mut facts = vec![
        (
            "site".to_owned(),
            format!(
                "{:.4}° latitude, {:.4}° longitude, {:.1} m",
                scenario.site.latitude_rad / DEG,
                scenario.site.longitude_rad / DEG,
                scenario.site.height_m
            ),
        ),
        (
            "motion".to_owned(),
            match &scenario.motion {
                MotionSpec::Static(_) => "static".to_owned(),
                MotionSpec::Dockside(_) => "on a moored ship".to_owned(),
            },
        ),
        (
            "sample rate".to_owned(),
            format!("{} Hz", number::plain(1e9 / scenario.sample_period_ns as f64, 6)),
        ),
        (
            "gyro random walk".to_owned(),
            format!("{:.5} deg/√h", imu.angle_random_walk / DEG_PER_SQRT_HOUR),
        ),
        (
            "accelerometer noise".to_owned(),
            format!("{:.2} µg/√Hz", imu.velocity_random_walk / MICRO_G),
        ),
    ];
    for (name, coefficient, unit, symbol) in [
        ("gyro bias instability", imu.extensions.gyro_bias_instability, DEG_PER_HOUR, "deg/h"),
        ("accelerometer bias instability", imu.extensions.accel_bias_instability, MICRO_G, "µg"),
    ] {
        if coefficient > 0.0 {
            let coefficient = number::significant(coefficient / unit, 4);
            facts.push((name.to_owned(), format!("{coefficient} {symbol}")));
        }
    }
    if matches!(scenario.source, SourceSpec::Solution(_)) {
        // The rest of the scenario is about an instrument that isn't there.
        let of_solution = ["site", "sample rate"];
        facts.retain(|(name, _)| of_solution.contains(&name.as_str()));
    }
    facts.extend(scenario.source.fact().map(|(name, fact)| (name.to_owned(), fact)));
    facts.extend(dither_fact(scenario));
    if let Some(drive) = &scenario.drive {
        let range = |axis: TableAxis| {
            let limits = drive.settings.limits.of(axis);
            let degrees = |angle_rad: f64| number::plain(angle_rad.to_degrees(), 6);
            format!("{axis} {} to {}°", degrees(limits.least_rad), degrees(limits.most_rad))
        };
        facts.push((
            "turntable".to_owned(),
            format!(
                "{}, {}, {}, {}",
                drive.port,
                drive.dialect.0,
                range(TableAxis::Azimuth),
                range(TableAxis::Roll)
            ),
        ));
    }
    facts.extend(scenario.endpoint.fact().map(|fact| ("core".to_owned(), fact)));
    facts
}

/// Renders the text for the terminal at the end of a run.
#[must_use]
pub fn text(summary: &Summary, units: &DisplayUnits) -> String {
    use std::fmt::Write as _;
    let mut out = String::new();
    let mut line = |text: String| {
        // Writing to a String can't fail.
        let _ = writeln!(out, "{text}");
    };
    line(format!("{}: {}", summary.scenario, summary.verdict.name()));
    for reason in &summary.reasons {
        line(format!("  {reason}"));
    }
    for met in summary.requirements.iter().filter(|r| r.verdict == Verdict::Pass) {
        line(format!("  {}", met.sentence()));
    }
    for fault in &summary.faults {
        line(format!("  {}", fault.sentence()));
    }
    let s = summary;
    let primary = (&s.method, &s.alignment, &s.calibration, &s.navigation, &s.followed);
    let baseline = summary.baseline.as_ref();
    let methods = std::iter::once(primary).chain(
        baseline.map(|b| (&b.label, &b.alignment, &b.calibration, &b.navigation, &b.followed)),
    );
    for (label, alignment, calibration, navigation, followed) in methods {
        line(format!("{label}, seed {}", summary.seed));
        alignment.iter().map(|alignment| alignment_line(alignment, units)).for_each(&mut line);
        if let Some(calibration) = calibration {
            let expected = match calibration.nis_expected {
                Some(_) => format!(" ({} expected)", calibration.nis_expected_words()),
                None => String::new(),
            };
            let nis =
                calibration.nis_mean.map_or("-".to_owned(), |nis| format!("{nis:.3}{expected}"));
            let worst = calibration
                .worst_normalized_error
                .filter(|_| calibration.refused.is_none())
                .map_or(String::new(), |worst| format!(", worst parameter {worst:.1} σ off"));
            line(format!(
                "  calibration {} h: NIS {nis}{worst}",
                number::plain(calibration.duration_h, 4)
            ));
            calibration.rest.iter().for_each(|rest| line(format!("  {}", rest.sentence())));
            if let Some(reason) = &calibration.refused {
                line(format!("  refused: {reason}"));
                calibration.refusal_explained.iter().for_each(|text| line(format!("    {text}")));
            }
            let solution = calibration.solution.iter();
            solution.filter_map(|solution| solution_line(solution, units)).for_each(&mut line);
        }
        if let Some(n) = navigation {
            line(format!("  navigation {} h", number::plain(n.duration_h, 4)));
            navigation_lines(n, units).into_iter().for_each(&mut line);
            followed.iter().for_each(|score| line(format!("    samples   {}", score.line())));
        }
    }
    summary.heading.iter().flat_map(heading_lines).for_each(&mut line);
    let differences = std::iter::once((&summary.method, &summary.counterfactual))
        .chain(summary.baseline.iter().map(|b| (&b.label, &b.counterfactual)));
    for (label, difference) in differences {
        let Some(difference) = difference else { continue };
        line(format!("against the twin without faults, {label}"));
        line(format!("  {}", in_words(difference)));
        for fault in &difference.faults {
            let noticed = match (&fault.noticed_by, fault.delay_s) {
                (Some(by), Some(delay_s)) => format!("noticed as {by} after {delay_s:.3} s"),
                _ => "not noticed".to_owned(),
            };
            line(format!("  {}: {noticed}", fault.id));
        }
    }
    out
}

/// Renders the parameters as a table, for methods without truth. Empty for a refused least-squares
/// calibration, whose numbers never came about.
#[must_use]
pub fn parameter_text(summary: &Summary, source: &SourceSpec) -> String {
    match &summary.calibration {
        Some(c) if c.refused.is_none() || c.estimator == "kalman" => {
            let axes = FileNames::of(source).line();
            let axes =
                axes.map_or_else(String::new, |axes| format!("  axes of the source: {axes}\n"));
            axes + &parameter_lines(&c.parameters)
        }
        _ => String::new(),
    }
}

/// Renders estimates with their σ, one per line, then the names of those that were not estimated.
#[must_use]
pub fn parameter_lines(parameters: &BTreeMap<String, ParameterScore>) -> String {
    use std::fmt::Write as _;
    let (mut out, mut left) = (String::new(), Vec::new());
    for name in NAMES {
        let Some(p) = parameters.get(name) else { continue };
        let Some(sigma) = p.sigma else {
            left.push(name);
            continue;
        };
        // As many decimals as the σ, so that both can be compared.
        let decimals = number::decimals_for(sigma, 3);
        let _ = writeln!(
            out,
            "  {name:24} {:>16} ± {} {}",
            number::fixed(p.estimate, decimals),
            number::fixed(sigma, decimals),
            p.unit
        );
    }
    // A solution that came from elsewhere has no parameters at all.
    if !out.is_empty() && !left.is_empty() {
        let _ = writeln!(out, "  not estimated: {}", left.join(" "));
    }
    out
}

/// Returns whether the mean vertical drift over the dwells of a rotation is that of g_zz alone: the
/// references of a run are closed forms for it. The case is level.
///
/// At rest the drift down by G is −g·rᵀ·G·r, where r is down in the body, so its mean has each element of
/// G with its share of the mean of r·rᵀ.
#[must_use]
pub fn leaves_g_zz_alone(rotation: &Sequence) -> bool {
    let stops = rotation.stops();
    let weights: f64 = stops.iter().map(|stop| stop.weight).sum();
    // The mean of r·rᵀ has trace 1 and no negative eigenvalue: where zz is 1, all others are 0.
    let share = stops.iter().fold(0.0, |sum, stop| {
        let down = c_cb(stop.azimuth_rad, stop.roll_rad)[(2, 2)];
        sum + stop.weight * down * down
    });
    share / weights > 1.0 - 1e-9
}
