//! Numbers known from other sources: closed forms, matrix exponentials, an independent filter.

use super::bench::CaseBench;
use super::case::{Case, STARTED_LIMIT};
use super::error::CaseSetupError;
use super::judge::{CaseOutcome, Expectation, Known};
use super::scenarios::{BELIEVING, MOSTLY, SHORT, SPIKE, campaign};
use serde_json::Value;

const FREE_INERTIAL: &str = include_str!("../../../../fixtures/selftest/free-inertial.toml");
const OBSERVE: &str = include_str!("../../../../fixtures/selftest/observe.toml");
const LOCKSTEP: &str = include_str!("../../../../fixtures/scenarios/lockstep.toml");
const GROWTH: &str = include_str!("../../../../fixtures/golden/static_free_inertial.json");
const COVARIANCE: &str = include_str!("../../../../fixtures/golden/covariance.json");

/// Stream hash of `lockstep.toml`. It changes with the arithmetic; a deliberate change must be made
/// here too.
pub const STREAM_HASH: &str = "e6081787cfa4005269d5f51f2acdb13e0a28b5c8dd4b5f194af774c95cfe7943";

fn known(name: &str, value: f64, tolerance: f64) -> Known {
    Known { name: name.to_owned(), value, tolerance }
}

pub(super) fn cases() -> Vec<Case> {
    let numbers = |known: Vec<Known>, source| Expectation::Numbers { known, source };
    vec![
        Case {
            id: "free-inertial-growth",
            about: "A gyro error of 0.01 deg/h to the north grows over 24 h as the free-inertial \
                    system says.",
            expectation: numbers(
                growth(),
                "matrix exponential of the free-inertial system (golden/static_free_inertial.json); \
                 the tolerance is what terms of second order make",
            ),
            limit: STARTED_LIMIT,
            run: free_inertial,
        },
        Case {
            id: "g-dependent-drift",
            about: "What an uncompensated g_zz of 5e-4 deg/h/g leaves in navigation, and Schuler's \
                    period at 30.5°.",
            expectation: numbers(
                vec![
                    // 2π √(R/g) with R² = R_M R_N and Somigliana's gravity.
                    known("schuler_period_min", 84.33, 0.01),
                    known("longitude_arcmin_per_day", 0.365, 0.0005),
                    known("latitude_bound_arcmin", 0.197, 0.0005),
                ],
                "closed forms: Britting, Inertial Navigation Systems Analysis, chapter 7",
            ),
            limit: STARTED_LIMIT,
            run: drift,
        },
        Case {
            id: "observability",
            about: "Six positions don't see Gxx, Gyy and Gzz, eight see all but their sum.",
            expectation: numbers(
                vec![
                    known("eight.rank", 12.0, 0.1),
                    known("eight.unseen", 1.0, 0.1),
                    known("eight.rank_with_vertical", 13.0, 0.1),
                    known("six.rank", 10.0, 0.1),
                    known("six.unseen", 3.0, 0.1),
                ],
                "static algebra of horizontal and vertical gyro drift",
            ),
            limit: STARTED_LIMIT,
            run: ranks,
        },
        Case {
            id: "posterior-sigma",
            about: "σ of all 39 states after four hours in six and in eight positions.",
            expectation: numbers(
                sigmas(),
                "an independent filter (golden/covariance.json); 1 % of each σ",
            ),
            limit: STARTED_LIMIT,
            run: posterior,
        },
        Case {
            id: "consistent-filter",
            about: "A filter that is right has a mean normalized innovation squared of 3 on three axes.",
            expectation: numbers(
                // The mean of 14400 values of χ² with 3 degrees of freedom has σ = √(6/14400).
                vec![known("nis_mean", 3.0, 4.0 * 0.020_412)],
                "χ² with three degrees of freedom, 14400 values; the tolerance is 4 σ",
            ),
            limit: STARTED_LIMIT,
            run: consistent,
        },
        Case {
            id: "spike-believed",
            about: "A spike of 500 arcsec that the core believes moves a parameter by 122 σ.",
            expectation: numbers(
                vec![known("worst_shift_sigma", 122.0, 0.2 * 122.0)],
                "an independent filter; 20 % for what it leaves out",
            ),
            limit: STARTED_LIMIT,
            run: believed,
        },
        Case {
            id: "stream-hash",
            about: "Every sample, every aiding message and every output of ten minutes has the bits \
                    that it had where this version was made.",
            expectation: Expectation::Text {
                known: STREAM_HASH,
                source: "this version, where it was made: an operating system, processor or \
                         compiler that computes otherwise shows here",
            },
            limit: STARTED_LIMIT,
            run: stream_hash,
        },
        Case {
            id: "fifty-nine",
            about: "Zero failures in 59 runs show 95 % with a confidence of 95 %: after one, 58 are \
                    needed.",
            expectation: numbers(
                vec![known("needed", 58.0, 0.1)],
                "Clopper and Pearson: 0.95^59 < 0.05 < 0.95^58",
            ),
            limit: STARTED_LIMIT,
            run: fifty_nine,
        },
    ]
}

/// Hours at which the growth is evaluated.
const HOURS: [f64; 3] = [6.0, 12.0, 24.0];

fn growth() -> Vec<Known> {
    let golden: Value = serde_json::from_str(GROWTH).unwrap_or_default();
    let rows = golden["rows"].as_array().into_iter().flatten();
    let row = rows
        .filter(|row| row["latitude_deg"] == 30.5 && row["error"] == "gyro_error_north")
        .find_map(|row| row["hours_latitude_longitude_arcmin"].as_array());
    let at = |hours: f64| {
        let point = row?.iter().find(|point| point[0].as_f64() == Some(hours))?;
        Some([
            known(&format!("latitude at {hours} h"), point[1].as_f64()?, 0.035),
            known(&format!("longitude at {hours} h"), point[2].as_f64()?, 0.035),
        ])
    };
    HOURS.into_iter().filter_map(at).flatten().collect()
}

fn free_inertial(bench: &CaseBench<'_>) -> Result<CaseOutcome, CaseSetupError> {
    let mut outcome = CaseOutcome::default();
    let ran = bench.run(FREE_INERTIAL, &[])?;
    let summary = ran.summary()?;
    let navigation = summary.navigation.as_ref().ok_or("find the navigation of the run")?;
    for hours in HOURS {
        // The series is thinned: between two of its points the error is interpolated linearly, over
        // less than two minutes of oscillations of 84 min and more.
        let after = navigation.series_hours.iter().position(|point| point[0] >= hours - 1e-4);
        let [next, before] = match after {
            Some(index) if index > 0 => {
                [navigation.series_hours[index], navigation.series_hours[index - 1]]
            }
            _ => return Err(format!("find {hours} h in the navigation of the run").into()),
        };
        let part = ((hours - before[0]) / (next[0] - before[0])).clamp(0.0, 1.0);
        for (axis, name) in [(1, "latitude"), (2, "longitude")] {
            let value = before[axis] + part * (next[axis] - before[axis]);
            outcome.numbers.insert(format!("{name} at {hours} h"), value);
        }
    }
    Ok(CaseOutcome { numbers: outcome.numbers, ..ran.into() })
}

fn drift(bench: &CaseBench<'_>) -> Result<CaseOutcome, CaseSetupError> {
    let ran = bench.run(SHORT, &["--no-twin"])?;
    let reference = ran.summary()?.reference.clone().ok_or("find the references of the run")?;
    let numbers = [
        ("schuler_period_min", reference.schuler_period_min),
        ("longitude_arcmin_per_day", reference.table_g_zz.longitude_arcmin_per_day),
        ("latitude_bound_arcmin", reference.table_g_zz.latitude_bound_arcmin),
    ];
    let numbers = numbers.map(|(name, value)| (name.to_owned(), value)).into();
    Ok(CaseOutcome { numbers, ..ran.into() })
}

/// Runs `octant observe` for both methods.
fn observed(bench: &CaseBench<'_>) -> Result<(Value, CaseOutcome), CaseSetupError> {
    bench.write("scenario.toml", OBSERVE)?;
    let said = bench.octant(&["observe", "scenario.toml", "--json"])?;
    let value = serde_json::from_str(&said.out)
        .map_err(|error| format!("read what octant observe said: {error}: {}", said.err))?;
    Ok((value, CaseOutcome { said: String::new(), ..said.into() }))
}

const METHODS: [&str; 2] = ["eight", "six"];

fn ranks(bench: &CaseBench<'_>) -> Result<CaseOutcome, CaseSetupError> {
    let (value, mut outcome) = observed(bench)?;
    for (index, name) in METHODS.into_iter().enumerate() {
        let method = &value[index];
        let mut put = |what: &str, number: Option<f64>| {
            outcome.numbers.extend(number.map(|number| (format!("{name}.{what}"), number)));
        };
        put("rank", method["rank"].as_f64());
        put("rank_with_vertical", method["rank_with_vertical"].as_f64());
        put("unseen", method["null_space"].as_array().map(|all| all.len() as f64));
    }
    Ok(outcome)
}

/// Reads σ of the independent filter, in the units of `octant observe`.
fn sigmas() -> Vec<Known> {
    let golden: Value = serde_json::from_str(COVARIANCE).unwrap_or_default();
    let rows = golden["rows"].as_array().into_iter().flatten();
    let four = rows.filter(|row| row["calibration_h"] == 4 && row["g_prior_dph_per_g"] == 0.0005);
    four.flat_map(|row| {
        let positions = row["positions"].as_str().unwrap_or("");
        let states = row["sigma"].as_object().into_iter().flatten();
        states.filter_map(move |(name, sigma)| {
            let sigma = sigma.as_f64()?;
            Some(known(&format!("{positions}.{name}"), sigma, 0.01 * sigma))
        })
    })
    .collect()
}

fn posterior(bench: &CaseBench<'_>) -> Result<CaseOutcome, CaseSetupError> {
    let (value, mut outcome) = observed(bench)?;
    for (index, positions) in METHODS.into_iter().enumerate() {
        for state in value[index]["states"].as_array().into_iter().flatten() {
            let unit = state["unit"].as_str().unwrap_or("");
            let si = match unit {
                "arcsec" => octant_earth::units::ARCSEC,
                "deg/h" => octant_earth::units::DEG_PER_HOUR,
                "ppm" => octant_earth::units::PPM,
                "deg/h/g" => octant_earth::units::DEG_PER_HOUR_PER_G,
                "ug" => octant_earth::units::MICRO_G,
                _ => 1.0,
            };
            if let (Some(name), Some(sigma)) = (state["name"].as_str(), state["believed"].as_f64())
            {
                outcome.numbers.insert(format!("{positions}.{name}"), sigma * si);
            }
        }
    }
    Ok(outcome)
}

fn consistent(bench: &CaseBench<'_>) -> Result<CaseOutcome, CaseSetupError> {
    let ran = bench.run(OBSERVE, &[])?;
    let nis = ran.summary()?.calibration.as_ref().and_then(|calibration| calibration.nis_mean);
    let numbers = nis.map(|nis| ("nis_mean".to_owned(), nis)).into_iter().collect();
    Ok(CaseOutcome { numbers, ..ran.into() })
}

fn believed(bench: &CaseBench<'_>) -> Result<CaseOutcome, CaseSetupError> {
    let ran = bench.run(SPIKE, &BELIEVING)?;
    let counterfactual = ran.summary()?.counterfactual.as_ref();
    let shift = counterfactual.and_then(|c| c.worst_shift_sigma);
    let numbers = shift.map(|shift| ("worst_shift_sigma".to_owned(), shift)).into_iter().collect();
    Ok(CaseOutcome { numbers, ..ran.into() })
}

fn stream_hash(bench: &CaseBench<'_>) -> Result<CaseOutcome, CaseSetupError> {
    let ran = bench.run(LOCKSTEP, &[])?;
    let text = ran.summary()?.stream_hash.clone();
    Ok(CaseOutcome { text, ..ran.into() })
}

fn fifty_nine(bench: &CaseBench<'_>) -> Result<CaseOutcome, CaseSetupError> {
    campaign(bench, 1, MOSTLY, "")?;
    let status = bench.octant(&["campaign", "status", "campaign", "--json"])?;
    let value: Value = serde_json::from_str(&status.out)
        .map_err(|error| format!("read the status of a campaign: {error}: {}", status.err))?;
    let needed = value["requirements"]["MOSTLY"]["needed"]["runs"].as_f64();
    let numbers = needed.map(|needed| ("needed".to_owned(), needed)).into_iter().collect();
    Ok(CaseOutcome { numbers, ..status.into() })
}
