//! The result: everything that is told of a recording.

use super::analysis::{RestAnalysis, analyse};
use super::earth_rate::{EarthRateCheck, check};
use super::error::CharacteriseError;
use super::instrument::instrument_file;
use super::recording::RestingRecording;
use super::survey::{RestStretch, survey};
use super::temperature::{self, TemperatureDependence};
use super::twin::{InstrumentTwin, compare, simulate};
use octant_account::Account;
use octant_scenario::file_names::FileNames;
use serde::Serialize;

/// Version of the layout of the JSON.
pub const SCHEMA: u32 = 1;

/// Characterisation of a recording.
#[derive(Clone, Debug, Serialize)]
pub struct Characterisation {
    /// Version of the layout.
    pub schema: u32,
    /// Version of the program.
    pub octant: &'static str,
    /// Recording.
    pub recording: String,
    /// Names that its file has for the channels, in the order of the analysis; `null` where it names none.
    #[serde(serialize_with = "in_order")]
    pub names_in_file: FileNames,
    /// Words for the times of a recording that has no stamps; `null` where it has them.
    pub assumed_time: Option<String>,
    /// Sample rate, Hz.
    pub rate_hz: f64,
    /// Length of the recording, s.
    pub duration_s: f64,
    /// Time at rest, s.
    pub rest_s: f64,
    /// Gaps.
    pub gaps: u64,
    /// Samples that are flagged invalid or saturated.
    pub invalid: u64,
    /// How the recording was cut short.
    pub cut_short: Option<String>,
    /// Accounts of what was read.
    pub inputs: Vec<Account>,
    /// Attitudes and Earth's rate.
    pub earth_rate: EarthRateCheck,
    /// Biases against temperature.
    pub temperature: TemperatureDependence,
    /// Deviations, terms, spectra.
    pub analysis: RestAnalysis,
    /// The scenario with the instrument, TOML.
    pub imu: String,
    /// What the scenario can't hold.
    pub left_out: Vec<String>,
    /// The simulated twin; none where it wasn't asked for.
    pub twin: Option<InstrumentTwin>,
}

/// Characterises a recording; with a seed it simulates the twin.
///
/// # Errors
/// If the recording can't be read, moves, is too short, or has a channel that is stuck.
pub fn characterise(
    recording: &RestingRecording,
    seed: Option<u64>,
) -> Result<Characterisation, CharacteriseError> {
    let period_s = recording.period_s();
    let survey = survey(recording)?;
    let temperature = temperature::of(recording, &survey)?;
    let analysis = analyse(recording, &survey, temperature.correction())?;
    let scenario = recording.scenario();
    let file = std::path::Path::new(recording.name());
    let name =
        file.file_name().map_or_else(|| recording.name().into(), |name| name.to_string_lossy());
    let period_ns = scenario.sample_period_ns;
    let imu = instrument_file(&analysis, (period_ns, &name), Some(&temperature));
    let twin = match seed {
        Some(seed) => {
            // What the temperature explains isn't in the analysis.
            let of_twin = instrument_file(&analysis, (period_ns, &name), None);
            let twin = simulate(&of_twin.text, seed, &analysis.stretches)?;
            Some(compare(&analysis, twin, seed))
        }
        None => None,
    };
    let rest: u64 = analysis.stretches.iter().sum();
    let at_mean = |(number, stretch): (usize, &RestStretch)| {
        let mean = temperature.correction().map_or(stretch.mean, |correction| {
            correction.taken_off(&stretch.mean, correction.mean_warmer_k(number))
        });
        RestStretch { mean, ..*stretch }
    };
    let stretches: Vec<RestStretch> = survey.stretches.iter().enumerate().map(at_mean).collect();
    Ok(Characterisation {
        schema: SCHEMA,
        octant: env!("CARGO_PKG_VERSION"),
        recording: recording.name().to_owned(),
        names_in_file: recording.names().clone(),
        assumed_time: scenario.source.assumed_time(),
        rate_hz: 1.0 / period_s,
        duration_s: survey.samples as f64 * period_s,
        rest_s: rest as f64 * period_s,
        gaps: survey.gaps,
        invalid: survey.invalid,
        cut_short: survey.cut_short,
        inputs: survey.inputs,
        earth_rate: check(&stretches, &analysis, period_s),
        temperature,
        analysis,
        imu: imu.text,
        left_out: imu.left_out,
        twin,
    })
}

fn in_order<S: serde::Serializer>(names: &FileNames, serializer: S) -> Result<S::Ok, S::Error> {
    names.0.serialize(serializer)
}
