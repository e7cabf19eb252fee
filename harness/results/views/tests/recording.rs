//! Recordings are read back bit for bit, with topics for other tools in them and without.

use crate::recordings::bits::bits;
use crate::recordings::epochs::{PERIOD_NS, Step, record};
use octant_recorder::reader::{self, Epochs, Recording};
use octant_recorder::{Policy, RecorderOptions, Samples, message};
use octant_sample::{
    Aiding, DeviceTime, Epoch, GimbalAngles, GimbalCommand, Health, Mode, Navigation, Output,
    Reference, Sample, Status,
};
use octant_views::about::About;
use octant_views::publishing;
use proptest::prelude::*;

fn sample() -> impl Strategy<Value = Sample> {
    (any::<[u64; 2]>(), any::<[i32; 8]>(), any::<u16>()).prop_map(|(u, i, status)| Sample {
        sequence: u[0],
        device_time: DeviceTime::from_ns(u[1]),
        delta_theta: [i[0], i[1], i[2]],
        delta_velocity: [i[3], i[4], i[5]],
        gimbal: GimbalAngles { azimuth: i[6], roll: i[7] },
        status: Status::from_bits_retain(status),
    })
}

fn aiding() -> impl Strategy<Value = Option<Aiding>> {
    (0..3, any::<u64>(), [bits(), bits(), bits()]).prop_map(|(kind, ns, v)| {
        let device_time = DeviceTime::from_ns(ns);
        match kind {
            0 => None,
            1 => Some(Aiding { device_time, reference: Reference::Velocity(v) }),
            _ => Some(Aiding {
                device_time,
                reference: Reference::Position {
                    latitude_rad: v[0],
                    longitude_rad: v[1],
                    height_m: v[2],
                },
            }),
        }
    })
}

fn output() -> impl Strategy<Value = Output> {
    (
        any::<[u64; 2]>(),
        prop::array::uniform11(bits()),
        any::<[i32; 2]>(),
        any::<u32>(),
        prop_oneof![any::<u16>(), Just(u16::MAX)],
        0..5usize,
        any::<bool>(),
    )
        .prop_map(|(u, f, i, health, stop, mode, moving)| Output {
            sequence: u[0],
            device_time: DeviceTime::from_ns(u[1]),
            mode: Mode::ALL[mode],
            stop,
            moving,
            gimbal_command: GimbalCommand { target: GimbalAngles { azimuth: i[0], roll: i[1] } },
            navigation: Navigation {
                latitude_rad: f[0],
                longitude_rad: f[1],
                height_m: f[2],
                velocity_mps: [f[3], f[4], f[5]],
                q_nb: [f[6], f[7], f[8], f[9]],
            },
            health: Health::from_bits_retain(health),
            nis: f[10],
            parameters_revision: 0,
        })
}

/// Generates steps in which some epochs were altered by a fault.
fn step() -> impl Strategy<Value = Step> {
    (sample(), sample(), aiding(), aiding(), output(), any::<bool>()).prop_map(
        |(clean, faulted, a, b, output, altered)| {
            let clean = Epoch { sample: clean, aiding: a };
            let faulted = if altered { Epoch { sample: faulted, aiding: b } } else { clean };
            Step { clean, faulted, output, parameters: None }
        },
    )
}

fn aiding_bits(aiding: Option<&Aiding>) -> Vec<u8> {
    let mut bytes = Vec::new();
    message::encode_aiding(aiding, &mut bytes);
    bytes
}

fn output_bits(output: &Output) -> [u8; octant_sample::canonical::OUTPUT_BYTES] {
    let mut bytes = [0; octant_sample::canonical::OUTPUT_BYTES];
    octant_sample::canonical::output(output, &mut bytes);
    bytes
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn what_is_written_is_read_bit_for_bit(
        steps in prop::collection::vec(step(), 1..40), block in 1usize..9, publishes in any::<bool>(),
    ) {
        let about = About { sample_period_ns: Some(PERIOD_NS), ..About::default() };
        let publishing = publishes.then(|| publishing(about, 1));
        let options = RecorderOptions {
            epochs_per_block: block,
            publishing,
            policy: Policy { samples: Samples::Full, ..Policy::default() },
            scenario: "schema = 1\n".into(),
            ..RecorderOptions::default()
        };
        let (bytes, summary) = record(&steps, &options);
        let mut epochs = Epochs::new(Recording::new(&bytes[..]).unwrap());
        for step in &steps {
            let read = epochs.next_epoch().unwrap().unwrap();
            prop_assert_eq!(read.time_ns, step.clean.sample.device_time.ns);
            prop_assert_eq!(read.sample.unwrap(), step.faulted.sample);
            prop_assert_eq!(read.clean_sample.unwrap_or(step.faulted.sample), step.clean.sample);
            prop_assert_eq!(aiding_bits(read.aiding.as_ref()), aiding_bits(step.faulted.aiding.as_ref()));
            let clean = read.clean_aiding.unwrap_or(read.aiding);
            prop_assert_eq!(aiding_bits(clean.as_ref()), aiding_bits(step.clean.aiding.as_ref()));
            prop_assert_eq!(output_bits(&read.output.unwrap()), output_bits(&step.output));
        }
        prop_assert_eq!(epochs.next_epoch().unwrap(), None);
        prop_assert!(!epochs.recording().truncated());
        let again = reader::stream_hash(Recording::new(&bytes[..]).unwrap()).unwrap();
        prop_assert_eq!(again, Some(summary.stream_hash));
    }
}
