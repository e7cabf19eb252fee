//! Strategies for messages: every bit pattern of every field.

use octant_sample::{
    Aiding, DeviceTime, GimbalAngles, GimbalCommand, Health, Mode, Navigation, Output, Parameters,
    Reference, Sample,
};
use octant_wire::message::*;
use octant_wire::{MessageKind, Text, VERSION};
use proptest::prelude::*;
use proptest::sample::select;
use proptest::strategy::ValueTree;

/// A number with any 64 bits, often a special one.
pub(crate) fn number() -> impl Strategy<Value = f64> {
    const SPECIAL: [u64; 9] = [
        0,
        1 << 63,
        0x7FF0_0000_0000_0000,
        0xFFF0_0000_0000_0000,
        0x7FF8_0000_0000_0000,
        0x7FF0_0000_0000_0001,
        0xFFFF_FFFF_FFFF_FFFF,
        1,
        0x3FF0_0000_0000_0000,
    ];
    prop_oneof![3 => any::<u64>(), 1 => select(&SPECIAL[..])].prop_map(f64::from_bits)
}

fn numbers<const N: usize>() -> impl Strategy<Value = [f64; N]> {
    proptest::collection::vec(number(), N).prop_map(|all| all.try_into().unwrap())
}

fn step() -> impl Strategy<Value = StepNumber> {
    any::<u16>().prop_map(StepNumber::new)
}

fn clock() -> impl Strategy<Value = ClockTime> {
    any::<u64>().prop_map(ClockTime::from_ns)
}

fn gimbal() -> impl Strategy<Value = GimbalAngles> {
    any::<[i32; 2]>().prop_map(|[azimuth, roll]| GimbalAngles { azimuth, roll })
}

fn text<const N: usize>() -> impl Strategy<Value = Text<N>> {
    "\\PC{0,40}".prop_map(|text| Text::fitting(&text))
}

fn hello() -> impl Strategy<Value = Message> {
    let numbers = any::<(u32, u32, u64, u16, u16, u32, [u8; 32])>();
    let choices = (select(&EndRole::ALL[..]), any::<bool>());
    (choices, numbers, text(), text()).prop_map(|((role, real_time), numbers, name, firmware)| {
        let (session, bits, sample_period_ns, window, silence_ms, shortest_period_ns, hash) =
            numbers;
        Message::Hello(Hello {
            version: VERSION,
            role,
            pacing: if real_time { StepPacing::RealTime } else { StepPacing::LockStep },
            session,
            capabilities: Capabilities::from_bits_retain(bits),
            sample_period_ns,
            limits: EndLimits { window, silence_ms, shortest_period_ns },
            configuration: hash,
            name,
            firmware,
        })
    })
}

pub(crate) fn sample() -> impl Strategy<Value = Message> {
    let numbers = any::<(bool, u64, u64, [i32; 3], [i32; 3], u16)>();
    (step(), numbers, gimbal()).prop_map(|(step, numbers, gimbal)| {
        let (aided, sequence, ns, delta_theta, delta_velocity, status) = numbers;
        let sample = Sample {
            sequence,
            device_time: DeviceTime { ns },
            delta_theta,
            delta_velocity,
            gimbal,
            status: octant_sample::Status::from_bits_retain(status),
        };
        Message::Sample(SampleMessage { step, aided, sample })
    })
}

fn aiding() -> impl Strategy<Value = Message> {
    (step(), any::<(u64, bool)>(), numbers()).prop_map(|(step, (ns, position), [a, b, c])| {
        let reference = if position {
            Reference::Position { latitude_rad: a, longitude_rad: b, height_m: c }
        } else {
            Reference::Velocity([a, b, c])
        };
        let aiding = Aiding { device_time: DeviceTime { ns }, reference };
        Message::Aiding(AidingMessage { step, aiding })
    })
}

pub(crate) fn output() -> impl Strategy<Value = Message> {
    let numbers_of = any::<(bool, u64, u64, u16, bool, u32, u32, u32)>();
    let navigation = (number(), number(), number(), numbers(), numbers());
    (step(), numbers_of, select(&Mode::ALL[..]), gimbal(), navigation, number()).prop_map(
        |(step, of, mode, target, navigation, nis)| {
            let (parameters_follow, sequence, ns, stop, moving, health, revision, computing_ns) =
                of;
            let (latitude_rad, longitude_rad, height_m, velocity_mps, q_nb) = navigation;
            let output = Output {
                sequence,
                device_time: DeviceTime { ns },
                mode,
                stop,
                moving,
                gimbal_command: GimbalCommand { target },
                navigation: Navigation {
                    latitude_rad,
                    longitude_rad,
                    height_m,
                    velocity_mps,
                    q_nb,
                },
                health: Health::from_bits_retain(health),
                nis,
                parameters_revision: revision,
            };
            Message::Output(OutputMessage { step, parameters_follow, output, computing_ns })
        },
    )
}

fn parameters() -> impl Strategy<Value = Message> {
    (step(), 0..6u8, any::<u32>(), numbers(), numbers()).prop_map(
        |(step, segment, revision, values, sigma)| {
            Message::Parameters(ParametersSegment { step, segment, revision, values, sigma })
        },
    )
}

fn restart() -> impl Strategy<Value = Message> {
    (step(), proptest::option::of(numbers())).prop_map(|(step, offset)| {
        Message::Restart(Restart { step, offset: offset.map(|all| Parameters::from_array(&all)) })
    })
}

fn heartbeat() -> impl Strategy<Value = Message> {
    (step(), select(&EndCondition::ALL[..]), any::<u8>(), clock()).prop_map(
        |(step, condition, queued, clock)| {
            Message::Heartbeat(Heartbeat { step, condition, queued, clock })
        },
    )
}

fn status() -> impl Strategy<Value = Message> {
    (step(), any::<[u32; 12]>()).prop_map(|(step, counts)| {
        Message::Status(DeviceStatus {
            step,
            steps: counts[0],
            repeated: counts[1],
            skipped: counts[2],
            aiding_missing: counts[3],
            queue_full: counts[4],
            late: counts[5],
            received: counts[6],
            lost: counts[7],
            damaged: counts[8],
            missing: counts[9],
            out_of_order: counts[10],
            unreadable: counts[11],
        })
    })
}

fn time() -> impl Strategy<Value = Message> {
    (any::<(bool, u16)>(), clock(), clock(), clock()).prop_map(
        |((reply, id), harness_sent, received, sent)| {
            if reply {
                Message::TimeReply(TimeReply { id, harness_sent, received, sent })
            } else {
                Message::TimeRequest(TimeRequest { id, harness_sent })
            }
        },
    )
}

fn bye() -> impl Strategy<Value = Message> {
    (any::<u8>(), text())
        .prop_map(|(reason, text)| Message::Bye(Bye { reason: Reason(reason), text }))
}

/// A message of any kind.
pub(crate) fn message() -> impl Strategy<Value = Message> {
    prop_oneof![
        hello(),
        sample(),
        aiding(),
        output(),
        parameters(),
        restart(),
        step().prop_map(|step| Message::End(End { step })),
        step().prop_map(|step| Message::Ready(Ready { step })),
        heartbeat(),
        status(),
        time(),
        bye(),
    ]
}

/// One message of each kind, the same in each run.
pub(crate) fn one_of_each() -> Vec<Message> {
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let mut found: Vec<Message> = Vec::new();
    let strategy = message();
    while found.len() < MessageKind::ALL.len() {
        let message = strategy.new_tree(&mut runner).unwrap().current();
        if found.iter().all(|known| known.kind() != message.kind()) {
            found.push(message);
        }
    }
    found
}
