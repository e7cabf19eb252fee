//! `octant observe`: rank, null space, posterior σ and predicted drift, before anything is run.

mod ensemble;
mod protection;

use crate::arguments::{ScenarioArguments, load};
use crate::failure::Failure;
use crate::terminal::{print, print_json};
use clap::Args;
use octant_base::display::{DisplayUnits, UnitChoice};
use octant_base::number::significant;
use octant_calibration::config::{CoreConfig, Estimator, StaticIntervals};
use octant_calibration::covariance::{PARAMETERS, STATE_COUNT};
use octant_calibration::filter::prior_sigmas;
use octant_earth::frames::c_nc;
use octant_observe::covariance::{AnalysisError, PredictedDrift, predict, state_name};
use octant_observe::ensemble::state_unit;
use octant_observe::perfect::{self, PerfectError};
use octant_observe::static_rank;
use octant_sample::further::{FURTHER_NAMES, FurtherGroup};
use octant_sample::parameters::ParameterGroup;
use octant_scenario::{Method, MotionSpec, ParameterDistribution, Scenario};
use octant_source::configure::configurations;
use octant_verdict::Verdict;
use serde::Serialize;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    scenario: ScenarioArguments,
    /// Predict the ensemble of the scenario's draws: σ of every error, and envelopes of the drift.
    #[arg(long)]
    ensemble: bool,
    /// Compare the ensemble with the cases of this scenario in the folder of a campaign.
    #[arg(long, value_name = "DIR", requires = "ensemble")]
    against: Option<PathBuf>,
    /// Largest shift of each published parameter by a jump that the drift test doesn't notice.
    #[arg(long, conflicts_with_all = ["ensemble", "units"])]
    protection: bool,
    /// Units of errors in the tables: of position (arcmin, nmi, m, km), attitude (arcmin, deg, arcsec,
    /// mrad) and velocity (m/s, kn, cm/s), such as nmi,deg.
    #[arg(long, value_name = "UNIT,UNIT", conflicts_with = "json")]
    units: Option<UnitChoice>,
    /// Print one JSON object, in units of its own.
    #[arg(long)]
    json: bool,
}

/// Result for one method.
#[derive(Serialize)]
struct Observation {
    method: String,
    /// Rank over gyro bias, G and azimuth, from horizontal drift alone.
    rank: usize,
    unknowns: usize,
    null_space: Vec<String>,
    /// Rank with vertical drift, which shows in azimuth over time.
    rank_with_vertical: usize,
    null_space_with_vertical: Vec<String>,
    states: Vec<State>,
    drift: Vec<DriftRow>,
}

#[derive(Serialize)]
struct State {
    name: String,
    unit: &'static str,
    prior: f64,
    /// σ that the filter will believe; null where the state is not estimated.
    believed: Option<f64>,
    /// σ that it will achieve; null with further states, of which the filter's own belief alone is known.
    achieved: Option<f64>,
}

#[derive(Serialize)]
struct DriftRow {
    hours: f64,
    latitude_sigma_arcmin: f64,
    longitude_sigma_arcmin: f64,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let Arguments {
        scenario: given,
        ensemble: as_ensemble,
        against,
        protection: as_protection,
        units,
        json,
    } = arguments;
    let units = units.unwrap_or_default();
    if *as_ensemble {
        return ensemble::command(given, against.as_deref(), units, *json);
    }
    if *as_protection {
        return protection::command(given, *json);
    }
    let scenario = load(given, &[])?;
    let observations = (scenario.methods())
        .map(|method| observe(&scenario, method))
        .collect::<Result<Vec<_>, _>>()?;
    if *json {
        print_json(&observations)?;
    } else {
        let units = scenario.display.with(units);
        for observation in &observations {
            print(&text(observation, &units))?;
        }
    }
    Ok(Verdict::Pass)
}

fn observe(scenario: &Scenario, method: Method) -> Result<Observation, Failure> {
    let (_, config, _) = configurations(scenario, method, scenario.seed)
        .map_err(|error| Failure::input(format!("failed to {error}")))?;
    let Some(calibration) = &config.calibration else {
        return Err(Failure::input(
            "failed to observe: the scenario has no [procedure.calibration]",
        ));
    };
    if let Estimator::LeastSquares(least_squares) = &calibration.estimator
        && matches!(least_squares.intervals, StaticIntervals::Detected { .. })
    {
        return Err(Failure::input(
            "failed to observe: with intervals = \"detected\" no stops are commanded, so rank and \
             σ of the sequence don't apply; octant run reports the σ of the recorded data",
        ));
    }
    let mean = match &scenario.motion {
        MotionSpec::Static(mean) => *mean,
        MotionSpec::Dockside(ship) => ship.mean,
    };
    let stops: Vec<(f64, f64)> =
        calibration.sequence.stops().iter().map(|s| (s.azimuth_rad, s.roll_rad)).collect();
    let rank = |vertical| static_rank(&stops, config.site.latitude_rad, mean.heading_rad, vertical);
    let (horizontal, all) = (rank(false), rank(true));
    let truth = true_sigmas(scenario, &config);
    let c = c_nc(mean.heading_rad, mean.pitch_rad, mean.roll_rad);
    let (states, drift) = match predict(&config, &c, &truth) {
        Err(AnalysisError::Further) => {
            let states = with_further(scenario, method, &config, &truth);
            (states.map_err(|error| Failure::input(format!("failed to {error}")))?, Vec::new())
        }
        Ok(prediction) => {
            let estimated = |state: usize| match &calibration.estimator {
                Estimator::Kalman(kalman) => {
                    state < PARAMETERS
                        || kalman.estimated[ParameterGroup::of(state - PARAMETERS) as usize]
                }
                _ => true,
            };
            let states = (0..STATE_COUNT)
                .map(|state| {
                    let (unit, si) = state_unit(state);
                    State {
                        name: state_name(state),
                        unit,
                        prior: truth[state] / si,
                        believed: estimated(state).then(|| prediction.believed.sigma(state) / si),
                        achieved: Some(prediction.achieved.sigma(state) / si),
                    }
                })
                .collect();
            (states, prediction.drift.iter().map(row).collect())
        }
        // Rank and null space apply to every estimator.
        Err(AnalysisError::NotKalman) => (Vec::new(), Vec::new()),
        Err(error) => return Err(Failure::input(format!("failed to {error}"))),
    };
    Ok(Observation {
        method: scenario.method_label(method),
        rank: horizontal.rank,
        unknowns: horizontal.unknowns,
        null_space: horizontal.null_space,
        rank_with_vertical: all.rank,
        null_space_with_vertical: all.null_space,
        states,
        drift,
    })
}

/// States of a filter with further ones: what it believes at the end of its calibration.
fn with_further(
    scenario: &Scenario,
    method: Method,
    config: &CoreConfig,
    truth: &[f64; STATE_COUNT],
) -> Result<Vec<State>, PerfectError> {
    let found = perfect::run(scenario, method)?;
    let estimator = config.calibration.as_ref().map(|calibration| &calibration.estimator);
    let Some(Estimator::Kalman(kalman)) = estimator else { return Ok(Vec::new()) };
    let parameters = (PARAMETERS..STATE_COUNT).map(|state| {
        let (unit, si) = state_unit(state);
        let index = state - PARAMETERS;
        let is_estimated = kalman.estimated[ParameterGroup::of(index) as usize];
        State {
            name: state_name(state),
            unit,
            prior: truth[state] / si,
            believed: is_estimated.then(|| found.parameters[index] / si),
            achieved: None,
        }
    });
    let further = FurtherGroup::ALL.into_iter().flat_map(|group| {
        let prior = kalman.further.of(group).sigma();
        let sigmas = prior.zip(found.further).map(|(prior, found)| {
            group.range().map(move |index| State {
                name: FURTHER_NAMES[index].to_owned(),
                unit: group.unit(),
                prior: prior / group.si_per_unit(),
                believed: Some(found.sigma[index] / group.si_per_unit()),
                achieved: None,
            })
        });
        sigmas.into_iter().flatten()
    });
    Ok(parameters.chain(further).collect())
}

fn row(drift: &PredictedDrift) -> DriftRow {
    DriftRow {
        hours: drift.hours,
        latitude_sigma_arcmin: drift.latitude_arcmin,
        longitude_sigma_arcmin: drift.longitude_arcmin,
    }
}

/// Returns the true standard deviations, from the scenario's draws. A constant counts with its
/// magnitude.
fn true_sigmas(scenario: &Scenario, config: &CoreConfig) -> [f64; STATE_COUNT] {
    let mut sigmas = [0.0; STATE_COUNT];
    if let Some(calibration) = &config.calibration
        && let Estimator::Kalman(kalman) = &calibration.estimator
    {
        // Attitude, velocity and position start with errors of the size of the prior.
        sigmas = prior_sigmas(kalman);
    }
    for group in ParameterGroup::ALL {
        let range = group.range();
        let group_sigmas = &mut sigmas[PARAMETERS..][range.clone()];
        match &scenario.parameters[group as usize] {
            ParameterDistribution::Normal(sigma) => group_sigmas.fill(*sigma),
            ParameterDistribution::Uniform(half_width) => {
                group_sigmas.fill(half_width / 3f64.sqrt())
            }
            ParameterDistribution::Constant(values) => {
                for (i, sigma) in group_sigmas.iter_mut().enumerate() {
                    *sigma = values.get(i).or(values.first()).map_or(0.0, |v| v.abs());
                }
            }
        }
    }
    sigmas
}

fn text(observation: &Observation, units: &DisplayUnits) -> String {
    use std::fmt::Write as _;
    let mut out = format!("{}\n", observation.method);
    let space = |null_space: &[String]| {
        if null_space.is_empty() { "none".to_owned() } else { null_space.join("; ") }
    };
    let _ = writeln!(
        out,
        "  gyro bias, G and azimuth by horizontal drift: rank {} of {}, unobservable: {}",
        observation.rank,
        observation.unknowns,
        space(&observation.null_space)
    );
    let _ = writeln!(
        out,
        "  with vertical drift, through the azimuth drift: rank {}, unobservable: {}",
        observation.rank_with_vertical,
        space(&observation.null_space_with_vertical)
    );
    if observation.states.is_empty() {
        let _ = writeln!(out, "  σ and drift are predicted for estimator \"kalman\" only");
    } else {
        let _ = writeln!(
            out,
            "  {:24} {:>12} {:>12} {:>12}  unit",
            "1σ at the end", "before", "believed", "achieved"
        );
    }
    for state in &observation.states {
        let figure = |value: f64| significant(value, 4);
        let believed = state.believed.map_or("-".to_owned(), figure);
        let achieved = state.achieved.map_or("-".to_owned(), figure);
        let _ = writeln!(
            out,
            "  {:24} {:>12} {:>12} {:>12}  {}",
            state.name,
            figure(state.prior),
            believed,
            achieved,
            state.unit
        );
    }
    if !observation.drift.is_empty() {
        let (latitude, longitude) = (units.latitude(), units.longitude());
        let _ = writeln!(out, "  predicted drift in navigation, 1σ, {}", latitude.name);
        let _ = writeln!(out, "  {:>8} {:>10} {:>10}", "hours", "latitude", "longitude");
        let every = (observation.drift.len() / 12).max(1);
        for row in observation.drift.iter().skip(every - 1).step_by(every) {
            let _ = writeln!(
                out,
                "  {:>8.1} {:>10.4} {:>10.4}",
                row.hours,
                latitude.of(row.latitude_sigma_arcmin),
                longitude.of(row.longitude_sigma_arcmin)
            );
        }
    }
    out
}
