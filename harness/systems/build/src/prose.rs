//! Texts of an FMU's documentation page.

use super::standard::Standard;
use octant_fmu::table::Model;

/// Anchors and titles of the sections, in their order.
pub(super) const SECTIONS: [(&str, &str); 5] = [
    ("what", "What it is"),
    ("time", "Time"),
    ("wiring", "Wiring"),
    ("values", "Values and faults"),
    ("states", "States"),
];

/// Texts that differ between the models.
pub(super) struct Prose {
    /// One step is one sample period, and values are passed as inputs and outputs.
    is_sampled: bool,
    what: &'static [&'static str],
    time: &'static [&'static str],
    wiring: &'static [&'static str],
    values: &'static [&'static str],
}

/// Returns the texts of a model.
pub(super) fn of(model: &Model) -> Prose {
    match model.stem {
        "plant" => PLANT,
        _ if model.needs_clocks() => ON_CAN,
        _ => CALIBRATOR,
    }
}

impl Prose {
    /// Returns the paragraphs of each of [`SECTIONS`].
    pub(super) fn sections(&self, standard: Standard) -> [Vec<&'static str>; 5] {
        let with = |own: &'static [&'static str], more: &[&'static str]| [own, more].concat();
        [
            self.what.to_vec(),
            match (self.is_sampled, standard) {
                (false, _) => self.time.to_vec(),
                (true, Standard::Fmi2) => with(self.time, &[TIME, TIME_2]),
                (true, Standard::Fmi3) => with(self.time, &[TIME, TIME_3]),
            },
            match (self.is_sampled, standard) {
                (false, _) => self.wiring.to_vec(),
                (true, Standard::Fmi2) => with(self.wiring, &[WIRING_2]),
                (true, Standard::Fmi3) => with(self.wiring, &[WIRING_3]),
            },
            with(self.values, &[VALUES]),
            STATES.to_vec(),
        ]
    }
}

const CALIBRATOR: Prose = Prose {
    is_sampled: true,
    what: &[
        "The calibration core of a dual-axis rotational inertial navigation system: it commands the \
         two gimbals through a sequence of positions, estimates the errors of gyros and \
         accelerometers from the samples, and navigates with what it found. It is the same code \
         as in the octant program, and gives the same bits.",
        "Its inputs are what an instrument has: increments of a sample, gimbal angles, a reference \
         velocity or position. It never sees the truth.",
    ],
    time: &[
        "One communication step is one sample period. Before the step from t(k) to t(k+1) the inputs \
         are those of the sample that ends at t(k); with imu.valid true the core steps once, and \
         its outputs hold from t(k+1) on. With imu.valid false nothing is stepped: so it is \
         before the first sample.",
    ],
    wiring: &[
        "gyro.delta_theta and accelerometer.delta_velocity are integrals over the sample's interval \
         in body axes, not rates. The core turns them into whole counts (2^-36 rad, 2^-30 m/s) and \
         carries the remainders: values that are counts already go through unchanged, and a \
         model with real-valued outputs loses nothing.",
        "gimbal_command acts on the next interval of the turntable. In a master that steps all FMUs \
         in parallel the loop closes as in the octant program; a master that steps one after the \
         other has to hand the values on by one step as well.",
    ],
    values: &["A reference that isn't finite reaches the core, which answers for it in health."],
};

const PLANT: Prose = Prose {
    is_sampled: true,
    what: &[
        "Motion of the case, two gimbals, gyros and accelerometers with their errors, the reference, \
         and faults: what the core is calibrated against. It knows the truth and says it in outputs \
         of its own.",
    ],
    time: &[
        "One communication step is one sample period. The step from t(k) to t(k+1) first takes the \
         gimbal command, then makes the sample of this interval: its outputs hold from t(k+1) on, \
         with imu.valid true. After the initialization, before the first step, imu.valid is false.",
        "A communication step of several sample periods makes as many samples. Its increments are sums \
         over all of them, imu.status has the flags of any, the reference is the last one with its age, \
         and imu.valid is false if one sample was lost. The calibrator takes no such sums.",
    ],
    wiring: &[
        "Its outputs have the names of the calibrator's inputs, and the gimbal command the other way: \
         the terminals imu, reference and gimbal_command belong together. A ship, a turntable or a \
         core of your own takes their place name by name.",
    ],
    values: &[
        "Noise comes from the seed alone: the same seed is the same noise, whatever else changes.",
    ],
};

const ON_CAN: Prose = Prose {
    is_sampled: false,
    what: &[
        "The calibration core of a dual-axis rotational inertial navigation system as a device on a \
         CAN bus: a network FMU of FMI-LS-BUS 1.0.0 (network abstraction, low cut). It is the same \
         code as in the octant program, and gives the same bits.",
        "The frames are those of octant's wire protocol, classic CAN or CAN FD, as a real bus carries \
         them: the harness says hello, sends samples and references, and gets outputs, parameters \
         with their standard deviations, heartbeats and status. Identifiers have 11 bits; the \
         protocol's CAN database names every signal.",
    ],
    time: &[
        "It is driven by events, and takes communication steps of any length. What comes with \
         can.Rx_Clock is taken when the event ends, and the answer is there at once: \
         can.Tx_Clock, a countdown clock, then has the interval 0. Between answers its interval \
         leads to the next status (once a second) or heartbeat. A tick at which there is nothing to \
         send has no bytes.",
        "Event mode has to be used: without it there are no clocks, and the device hears nothing. \
         There is no early return and no intermediate update.",
    ],
    wiring: &[
        "The terminal can has the four variables of the bus. Connect it to a bus simulation, or to \
         one other node. Without can.bus_notifications the device sends and forgets; with it, it has \
         one frame at a time on the bus and sends it until it is confirmed, keeps error counters, \
         tells its node state, is silent when it is off the bus, and comes back after 128 operations.",
        "At the start it tells the bus simulation its bit rates, what to do with frames that lose the \
         bus, and that it is error-active. What it can't read it quotes back in a Format Error. It \
         never sleeps: a Wakeup finds it awake. Remote, extended and CAN XL frames are none of its.",
        "The other outputs show what the core does, and are not on the bus as such.",
    ],
    values: &[
        "can.Rx_Data is set while can.Rx_Clock ticks, with at most 65535 bytes. can.Tx_Data is \
         got while can.Tx_Clock ticks, and is empty otherwise. What is more waits for the next \
         tick, which is due at once.",
    ],
};

const TIME: &str = "Time is a whole number of sample periods inside. The communication point has to be \
     the own one within half a period, and the step one period within 1e-6; else the step is \
     discarded with a reason, nothing is done and time stays where it is. 0.005 s has no exact \
     binary form: a master may add up steps or multiply, both are understood.";

const TIME_2: &str = "fmi2DoStep never returns fmi2Pending, and takes noSetFMUStatePriorToCurrentPoint as \
     it comes. The tolerance of the experiment means nothing here.";

const TIME_3: &str = "Inputs are discrete. Without event mode they are set in step mode before each step; \
     with event mode (eventModeUsed) they are set in event mode between two steps. Steps end where \
     they are asked to: there is no early return and no intermediate update.";

const WIRING_2: &str = "Elements of an array are scalars name[1], name[2] and so on. Enumerations are \
     Integers with the values given below: there are masters that can't connect an enumeration. \
     Whole numbers beyond 32 bits are Reals, exact up to 2^53.";

const WIRING_3: &str = "Vectors are arrays of fixed size.";

const VALUES: &str = "Everything is in SI units and radians; display units are for reading. Discrete inputs \
     must not be interpolated. A value that isn't finite, or not legal, is refused with a reason, \
     and the variable keeps the value that it had. Parameters that are marked as tunable can change \
     while the model runs, from the next step on.";

const STATES: [&str; 2] = [
    "The state can be kept, restored, freed, and turned into bytes and back at any communication \
     point; the bytes carry a version and a checksum, are the same on every platform, and go on \
     in another process bit for bit. Reset goes back to after the instantiation.",
    "Any number of instances live in one process, in any threads, one thread at a time for each. Wrong \
     calls get the status that the standard asks for and a line in the log, never a crash.",
];
