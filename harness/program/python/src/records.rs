//! Samples and answers as records of NumPy arrays: the canonical bytes, little-endian and packed.

use crate::failure::argument;
use octant_sample::canonical::{self, AIDING_BYTES, OUTPUT_BYTES};
use octant_sample::parameters::{PARAMETER_COUNT, ParameterEstimate};
use octant_sample::{
    DeviceTime, Epoch, GimbalAngles, GimbalCommand, Health, Mode, Navigation, Output, Parameters,
};
use pyo3::PyResult;

/// Bytes of a sample with its reference: kind (255: none) and three numbers.
pub(crate) const SAMPLE_BYTES: usize = canonical::SAMPLE_BYTES + 1 + 3 * 8;
/// Bytes of a command: azimuth and roll, i32.
const COMMAND_BYTES: usize = 8;
/// Bytes of an estimate: place of its output u64, 30 values and 30 sigmas.
const ESTIMATE_BYTES: usize = 8 + 2 * PARAMETER_COUNT * 8;

/// Appends the record of a sample.
pub(crate) fn sample_bytes(epoch: &Epoch, to: &mut Vec<u8>) {
    let mut bytes = [0; canonical::SAMPLE_BYTES];
    canonical::sample(&epoch.sample, &mut bytes);
    to.extend_from_slice(&bytes);
    match &epoch.aiding {
        Some(aiding) => {
            let mut bytes = [0; AIDING_BYTES];
            canonical::aiding(aiding, &mut bytes);
            to.extend_from_slice(&bytes[8..]);
        }
        None => {
            to.push(u8::MAX);
            to.extend_from_slice(&[0; 24]);
        }
    }
}

/// Appends the record of an answer.
pub(crate) fn output_bytes(output: &Output, to: &mut Vec<u8>) {
    let mut bytes = [0; OUTPUT_BYTES];
    canonical::output(output, &mut bytes);
    to.extend_from_slice(&bytes);
}

/// Takes the bytes of one field after another.
struct Fields<'a>(&'a [u8]);

impl Fields<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let (field, rest) = self.0.split_at(N);
        self.0 = rest;
        std::array::from_fn(|i| field[i])
    }

    fn f64(&mut self) -> f64 {
        f64::from_le_bytes(self.take())
    }

    fn i32(&mut self) -> i32 {
        i32::from_le_bytes(self.take())
    }

    fn command(&mut self) -> GimbalCommand {
        GimbalCommand { target: GimbalAngles { azimuth: self.i32(), roll: self.i32() } }
    }
}

fn each<'a>(
    bytes: &'a [u8],
    size: usize,
    what: &str,
) -> PyResult<impl Iterator<Item = Fields<'a>>> {
    if !bytes.len().is_multiple_of(size) {
        let found = bytes.len();
        return Err(argument(format!("{what}: found {found} bytes, expected records of {size}")));
    }
    Ok(bytes.chunks_exact(size).map(Fields))
}

/// Reads commands.
pub(crate) fn commands_of(bytes: &[u8]) -> PyResult<Vec<GimbalCommand>> {
    Ok(each(bytes, COMMAND_BYTES, "commands")?.map(|mut fields| fields.command()).collect())
}

/// Reads answers.
pub(crate) fn outputs_of(bytes: &[u8]) -> PyResult<Vec<Output>> {
    each(bytes, OUTPUT_BYTES, "answers")?.map(|mut fields| output(&mut fields)).collect()
}

fn output(fields: &mut Fields<'_>) -> PyResult<Output> {
    let sequence = u64::from_le_bytes(fields.take());
    let device_time = DeviceTime { ns: u64::from_le_bytes(fields.take()) };
    let [code] = fields.take::<1>();
    let Some(mode) = Mode::ALL.into_iter().find(|mode| *mode as u8 == code) else {
        return Err(argument(format!("answer to sample {sequence}: mode {code}, expected 0 to 4")));
    };
    let stop = u16::from_le_bytes(fields.take());
    let moving = fields.take::<1>() != [0];
    let gimbal_command = fields.command();
    let navigation = Navigation {
        latitude_rad: fields.f64(),
        longitude_rad: fields.f64(),
        height_m: fields.f64(),
        velocity_mps: std::array::from_fn(|_| fields.f64()),
        q_nb: std::array::from_fn(|_| fields.f64()),
    };
    let health = Health::from_bits_retain(u32::from_le_bytes(fields.take()));
    let nis = fields.f64();
    let parameters_revision = u32::from_le_bytes(fields.take());
    Ok(Output {
        sequence,
        device_time,
        mode,
        stop,
        moving,
        gimbal_command,
        navigation,
        health,
        nis,
        parameters_revision,
    })
}

/// Reads estimates with the places of their outputs.
pub(crate) fn estimates_of(
    bytes: &[u8],
    outputs: &[Output],
) -> PyResult<Vec<(usize, ParameterEstimate)>> {
    each(bytes, ESTIMATE_BYTES, "estimates")?
        .map(|mut fields| {
            let place = u64::from_le_bytes(fields.take()) as usize;
            let Some(output) = outputs.get(place) else {
                let most = outputs.len();
                return Err(argument(format!("estimate of answer {place}, expected 0 to {most}")));
            };
            let parameters = Parameters::from_array(&std::array::from_fn(|_| fields.f64()));
            let sigma = std::array::from_fn(|_| fields.f64());
            let revision = output.parameters_revision;
            Ok((place, ParameterEstimate { revision, parameters, sigma }))
        })
        .collect()
}
