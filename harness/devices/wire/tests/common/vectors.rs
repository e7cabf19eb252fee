//! The messages of the conformance vectors, by name.

use octant_sample::{
    Aiding, DeviceTime, GimbalAngles, GimbalCommand, Health, Mode, Navigation, Output, Parameters,
    Reference, Sample, Status as SampleStatus,
};
use octant_wire::message::*;
use octant_wire::{Text, VERSION};

/// Message of the vectors.
pub(crate) struct Vector {
    pub(crate) name: &'static str,
    pub(crate) sender: EndRole,
    pub(crate) message: Message,
    /// Sequence number and clock of its serial frame.
    pub(crate) sequence: u16,
    pub(crate) clock: ClockTime,
}

fn stamp(ns: u64) -> DeviceTime {
    DeviceTime { ns }
}

pub(crate) fn sample() -> Sample {
    Sample {
        sequence: 1,
        device_time: stamp(5_000_000),
        delta_theta: [17_000, -5, 0],
        delta_velocity: [0, 40, -52_600_000],
        gimbal: GimbalAngles { azimuth: 0, roll: 105_414_357 },
        status: SampleStatus::empty(),
    }
}

fn output() -> Output {
    Output {
        sequence: 123_456_789,
        device_time: stamp(617_283_945_000_000),
        mode: Mode::Calibrating,
        stop: 12,
        moving: true,
        gimbal_command: GimbalCommand {
            target: GimbalAngles { azimuth: -210_828_714, roll: 421_657_428 },
        },
        navigation: Navigation {
            latitude_rad: 0.532_325_421_858_270_4,
            longitude_rad: -2.119_123_456_789,
            height_m: 12.25,
            velocity_mps: [0.001, -0.002, 0.000_3],
            q_nb: [0.612_372_435_695_794_5, -0.0, 0.612_372_435_695_794_5, 1e-300],
        },
        health: Health::INNOVATION_REJECTED | Health::GIMBAL_SLIPPED,
        nis: f64::NAN,
        parameters_revision: 77,
    }
}

/// Special numbers that are easily changed on the way: NaN with payload, quiet and signalling,
/// infinities, minus zero, the smallest, the largest.
const SPECIAL: [u64; 10] = [
    0x7FF8_0000_DEAD_BEEF,
    0x7FF0_0000_0000_0001,
    0xFFF8_0000_0000_0000,
    0x7FF0_0000_0000_0000,
    0xFFF0_0000_0000_0000,
    0x8000_0000_0000_0000,
    0x0000_0000_0000_0001,
    0x7FEF_FFFF_FFFF_FFFF,
    0x3FF0_0000_0000_0001,
    0xFFFF_FFFF_FFFF_FFFF,
];

fn special<const N: usize>(from: usize) -> [f64; N] {
    std::array::from_fn(|i| f64::from_bits(SPECIAL[(from + i) % SPECIAL.len()]))
}

fn hellos() -> Vec<(&'static str, EndRole, Message)> {
    let harness = Hello {
        version: VERSION,
        role: EndRole::Harness,
        pacing: StepPacing::LockStep,
        session: 0x5EED_0001,
        capabilities: Capabilities::all(),
        sample_period_ns: 5_000_000,
        limits: EndLimits { window: 1, silence_ms: 2000, shortest_period_ns: 0 },
        configuration: std::array::from_fn(|i| 0x10 + i as u8),
        name: Text::fitting("octant"),
        firmware: Text::fitting("octant 0.1.0"),
    };
    let device = Hello {
        role: EndRole::Device,
        capabilities: Capabilities::LOCK_STEP | Capabilities::PARAMETERS | Capabilities::VELOCITY,
        limits: EndLimits { window: 8, silence_ms: 500, shortest_period_ns: 1_000_000 },
        configuration: [0; 32],
        name: Text::fitting("Gerät №7, full to the b"),
        firmware: Text::fitting("abcdefghijklmnopqrstuvwx"),
        ..harness
    };
    let instrument = Hello {
        role: EndRole::Instrument,
        pacing: StepPacing::RealTime,
        session: 0,
        capabilities: Capabilities::from_bits_retain(0xFFFF_FFFF),
        sample_period_ns: u64::MAX,
        limits: EndLimits { window: u16::MAX, silence_ms: u16::MAX, shortest_period_ns: u32::MAX },
        configuration: [0xFF; 32],
        name: Text::default(),
        ..device
    };
    vec![
        ("hello of a harness", EndRole::Harness, Message::Hello(harness)),
        ("hello of a device", EndRole::Device, Message::Hello(device)),
        ("hello of an instrument", EndRole::Instrument, Message::Hello(instrument)),
    ]
}

fn steps() -> Vec<(&'static str, EndRole, Message)> {
    let largest = Sample {
        sequence: u64::MAX,
        device_time: stamp(u64::MAX),
        delta_theta: [i32::MAX, i32::MIN, -1],
        delta_velocity: [i32::MIN, i32::MAX, 1],
        gimbal: GimbalAngles { azimuth: i32::MIN, roll: i32::MAX },
        status: SampleStatus::from_bits_retain(0xFFFF),
    };
    let message = |number, aided, sample| {
        Message::Sample(SampleMessage { step: StepNumber::new(number), aided, sample })
    };
    let velocity = Reference::Velocity([0.001, -0.0, f64::NAN]);
    let [latitude_rad, longitude_rad, height_m] = special(0);
    let position = Reference::Position { latitude_rad, longitude_rad, height_m };
    let aiding = |number, ns, reference| {
        let aiding = Aiding { device_time: stamp(ns), reference };
        Message::Aiding(AidingMessage { step: StepNumber::new(number), aiding })
    };
    let numbers: [f64; 11] = special(0);
    let strange = Output {
        sequence: u64::MAX,
        device_time: stamp(u64::MAX),
        mode: Mode::Done,
        stop: u16::MAX,
        moving: false,
        gimbal_command: GimbalCommand {
            target: GimbalAngles { azimuth: i32::MIN, roll: i32::MAX },
        },
        navigation: Navigation {
            latitude_rad: numbers[0],
            longitude_rad: numbers[1],
            height_m: numbers[2],
            velocity_mps: [numbers[3], numbers[4], numbers[5]],
            q_nb: [numbers[6], numbers[7], numbers[8], numbers[9]],
        },
        health: Health::from_bits_retain(u32::MAX),
        nis: numbers[10],
        parameters_revision: u32::MAX,
    };
    let answer = |number, parameters_follow, output, computing_ns| {
        let step = StepNumber::new(number);
        Message::Output(OutputMessage { step, parameters_follow, output, computing_ns })
    };
    vec![
        ("sample with aiding", EndRole::Harness, message(1, true, sample())),
        ("sample of zeros", EndRole::Harness, message(0, false, Sample::default())),
        ("sample of the largest counts", EndRole::Harness, message(0x7FFF, false, largest)),
        ("sample of an instrument", EndRole::Instrument, message(2, false, sample())),
        ("aiding, velocity", EndRole::Harness, aiding(1, 5_000_000, velocity)),
        ("aiding, position", EndRole::Harness, aiding(0x7FFF, u64::MAX, position)),
        ("aiding of an instrument", EndRole::Instrument, aiding(2, 0, velocity)),
        ("output", EndRole::Device, answer(1, false, output(), 0)),
        ("output of zeros", EndRole::Device, answer(0, false, Output::default(), 0)),
        ("output of special numbers", EndRole::Device, answer(0x7FFF, true, strange, u32::MAX)),
        ("end", EndRole::Harness, Message::End(End { step: StepNumber::new(0x1234) })),
        ("ready", EndRole::Device, Message::Ready(Ready { step: StepNumber::new(0x1234) })),
    ]
}

fn parameters() -> Vec<(&'static str, EndRole, Message)> {
    let parameters = Parameters::from_array(&std::array::from_fn(|i| (i as f64 - 14.5) * 1e-9));
    let segments = ParametersSegment::all(StepNumber::new(200), 3, &parameters, &special(0));
    let names = [
        "parameters, segment 0",
        "parameters, segment 1",
        "parameters, segment 2",
        "parameters, segment 3",
        "parameters, segment 4",
        "parameters, segment 5",
    ];
    let mut all: Vec<_> = names
        .into_iter()
        .zip(segments)
        .map(|(name, segment)| (name, EndRole::Device, Message::Parameters(segment)))
        .collect();
    // A payload without zero bytes makes the longest stuffed frame.
    let full = Parameters::from_array(&[f64::from_bits(0x0101_0101_0101_0101); 30]);
    for (name, number, offset) in [
        ("restart", 9, None),
        ("restart with an offset", 10, Some(parameters)),
        ("restart with an offset of special numbers", 0, Some(Parameters::from_array(&special(3)))),
        ("restart without a zero", 0x0101, Some(full)),
    ] {
        let restart = Restart { step: StepNumber::new(number), offset };
        all.push((name, EndRole::Harness, Message::Restart(restart)));
    }
    all
}

fn link() -> Vec<(&'static str, EndRole, Message)> {
    let heartbeat = Heartbeat {
        step: StepNumber::new(300),
        condition: EndCondition::Stepping,
        queued: 2,
        clock: ClockTime::from_ns(1_500_000_000),
    };
    let status = DeviceStatus {
        step: StepNumber::new(300),
        steps: 1,
        repeated: 2,
        skipped: 3,
        aiding_missing: 4,
        queue_full: 5,
        late: 6,
        received: 7,
        lost: 8,
        damaged: 9,
        missing: 10,
        out_of_order: 11,
        unreadable: u32::MAX,
    };
    let request = TimeRequest { id: 0xBEEF, harness_sent: ClockTime::from_ns(1 << 40) };
    let reply = TimeReply {
        id: 0xBEEF,
        harness_sent: request.harness_sent,
        received: ClockTime::from_ns(u64::MAX),
        sent: ClockTime::from_ns(0x0123_4567_89AB_CDEF),
    };
    let bye =
        Bye { reason: Reason::CONFIGURATION, text: Text::fitting("the configuration is another") };
    let other = Bye {
        reason: Reason(200),
        text: Text::fitting("µ: forty bytes of text, to the last one!"),
    };
    vec![
        ("heartbeat of a harness", EndRole::Harness, Message::Heartbeat(Heartbeat::default())),
        ("heartbeat of a device", EndRole::Device, Message::Heartbeat(heartbeat)),
        ("heartbeat of an instrument", EndRole::Instrument, Message::Heartbeat(heartbeat)),
        ("status", EndRole::Device, Message::Status(status)),
        ("status of an instrument", EndRole::Instrument, Message::Status(DeviceStatus::default())),
        ("time request", EndRole::Harness, Message::TimeRequest(request)),
        ("time reply", EndRole::Device, Message::TimeReply(reply)),
        ("time reply of an instrument", EndRole::Instrument, Message::TimeReply(reply)),
        ("bye of a harness", EndRole::Harness, Message::Bye(bye)),
        ("bye of a device", EndRole::Device, Message::Bye(other)),
        ("bye of an instrument", EndRole::Instrument, Message::Bye(Bye::default())),
    ]
}

/// All vectors: a message for every slot, and values at their limits.
pub(crate) fn all() -> Vec<Vector> {
    let named = [hellos(), steps(), parameters(), link()].concat();
    let clocks = [0, 1_000_000_000, 0x0101_0101_0101_0101, u64::MAX];
    named
        .into_iter()
        .enumerate()
        .map(|(i, (name, sender, message))| Vector {
            name,
            sender,
            message,
            sequence: (i as u16).wrapping_mul(0x0101).wrapping_add(7),
            clock: ClockTime::from_ns(clocks[i % clocks.len()]),
        })
        .collect()
}

/// Vector of a name.
pub(crate) fn named(name: &str) -> Vector {
    all().into_iter().find(|vector| vector.name == name).unwrap_or_else(|| panic!("no {name}"))
}
