//! A stream for the tests of recordings.

use super::epochs::{PERIOD_NS, Step};
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{
    Aiding, DeviceTime, Epoch, GimbalAngles, GimbalCommand, Health, Mode, Navigation, Output,
    Parameters, Reference, Sample, Status,
};

/// Makes a stream that looks like a run: noisy counts, aiding and parameters at 1 Hz, a change of
/// mode half way.
pub(crate) fn stream(epochs: u64) -> Vec<Step> {
    let mut state = 0x9E37_79B9_7F4A_7C15u64;
    let mut noise = move |scale: i64| {
        // xorshift64*, only for bits that don't compress.
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        ((state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 32) as i64 % (2 * scale) - scale) as i32
    };
    (1..=epochs)
        .map(|k| {
            let device_time = DeviceTime::from_ns(k * PERIOD_NS);
            let sample = Sample {
                sequence: k,
                device_time,
                delta_theta: [noise(5000) + 12_000, noise(5000), noise(5000) - 20_000],
                delta_velocity: [noise(9000), noise(9000), noise(9000) - 52_000_000],
                gimbal: GimbalAngles { azimuth: (k / 1000) as i32 * 100, roll: -7 },
                status: Status::empty(),
            };
            let second = k % 200 == 0;
            let wiggle = |scale: f64, n: i32| scale * f64::from(n);
            let epoch = Epoch {
                sample,
                aiding: second.then(|| Aiding {
                    device_time,
                    reference: Reference::Velocity(std::array::from_fn(|_| {
                        wiggle(1e-6, noise(999))
                    })),
                }),
            };
            let revision = (k / 200) as u32;
            let output = Output {
                sequence: k,
                device_time,
                mode: if k > epochs / 2 { Mode::Navigating } else { Mode::Calibrating },
                stop: (k / 1000) as u16,
                moving: k % 1000 < 100,
                gimbal_command: GimbalCommand { target: GimbalAngles { azimuth: 5, roll: -5 } },
                navigation: Navigation {
                    latitude_rad: 0.53 + wiggle(1e-12, noise(99_999)),
                    longitude_rad: 2.0 + wiggle(1e-12, noise(99_999)),
                    height_m: wiggle(1e-5, noise(99_999)),
                    velocity_mps: std::array::from_fn(|_| wiggle(1e-8, noise(99_999))),
                    q_nb: std::array::from_fn(|_| 0.5 + wiggle(1e-9, noise(99_999))),
                },
                health: Health::empty(),
                nis: if second { wiggle(1e-3, noise(3000)).abs() } else { f64::NAN },
                parameters_revision: revision,
            };
            let parameters = (second).then(|| ParameterEstimate {
                revision,
                parameters: Parameters::from_array(&std::array::from_fn(|_| {
                    wiggle(1e-12, noise(999))
                })),
                sigma: std::array::from_fn(|_| wiggle(1e-12, noise(999)).abs()),
            });
            Step { clean: epoch, faulted: epoch, output, parameters }
        })
        .collect()
}
