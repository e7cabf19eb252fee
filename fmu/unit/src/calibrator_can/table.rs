//! Table of the Calibrator on CAN: the bus, the core's outputs, and its parameters.

#[doc(hidden)]
pub mod slot;

use crate::calibrator::table as calibrator;
use crate::quantities as q;
use crate::table::{
    ClockedBinary, DeclaredVariable, ElementType, Model, Ticks, concatenated, enumerations, same,
    variables,
};

/// Largest number of bytes of a tick, in both directions.
const BYTES_MAX: usize = 65_535;

/// MIME type of the bytes in FMI-LS-BUS.
const MIME_TYPE: &str = "application/org.fmi-standard.fmi-ls-bus.can; version=\"1.0.0\"";

static RX_DATA: ClockedBinary =
    ClockedBinary { mime_type: MIME_TYPE, max_bytes: BYTES_MAX, clock: "can.Rx_Clock" };
static TX_DATA: ClockedBinary =
    ClockedBinary { mime_type: MIME_TYPE, max_bytes: BYTES_MAX, clock: "can.Tx_Clock" };

enumerations! {
    /// Action of the bus simulation on a frame that lost arbitration; values as on the bus.
    ARBITRATION_LOST "ArbitrationLost"
        "What the bus simulation does with a frame that loses the bus." {
        1 buffer "It keeps the frame and sends it when the bus is free.";
        2 discard "It throws the frame away and says so; the device sends it again.";
    }
    /// State of a CAN node; values as on the bus.
    NODE_STATE "CanNodeState" "State of a CAN node." {
        1 error_active "It takes part.";
        2 error_passive "An error counter is above 127.";
        3 bus_off "The transmit error counter is above 255: it sends nothing.";
    }
}

/// Name of the bus, with which the names of its variables begin.
pub const BUS: &str = "can";

/// Parameter that is `BusNotifications` in the standard's configuration terminal.
pub const NOTIFICATIONS: &str = "can.bus_notifications";

const RATE_MAX: f64 = u32::MAX as f64;

const LINK: [DeclaredVariable; 14] = variables! {
    input("can.Rx_Clock", ElementType::Clock(Ticks::Triggered)): "Ticks when can.Rx_Data has come.";
    input("can.Rx_Data", ElementType::Binary(&RX_DATA)):
        "Bus operations that come: the frames of the harness, and what the bus simulation says.";
    input("can.Tx_Clock", ElementType::Clock(Ticks::Countdown)):
        "Ticks when can.Tx_Data is to be taken: at once (interval 0) when an answer is there, else \
         when a status or heartbeat is due.";
    output("can.Tx_Data", ElementType::Binary(&TX_DATA)):
        "Bus operations that go: the frames of the device, its settings and its state.";
    parameter(NOTIFICATIONS, ElementType::Boolean):
        "The bus simulation confirms frames and tells of errors and lost arbitration: the device \
         has one frame at a time on the bus, and sends it until it is confirmed.";
    parameter("can.fd", ElementType::Boolean):
        "CAN FD, with another bit rate for the data; else classic CAN.";
    parameter("can.bit_rate", ElementType::Count) within(1.0, RATE_MAX) start(&[500_000.0]):
        "Bit rate, bit/s, that the bus simulation is told.";
    parameter("can.data_bit_rate", ElementType::Count) within(1.0, RATE_MAX) start(&[2_000_000.0]):
        "Bit rate of the data, bit/s, that the bus simulation is told of CAN FD.";
    parameter("can.arbitration_lost", ElementType::Enumeration(&ARBITRATION_LOST)) start(&[1.0]):
        "What the bus simulation is asked to do with a frame that loses the bus. To discard it \
         takes can.bus_notifications.";
    output("can.node_state", ElementType::Enumeration(&NODE_STATE)):
        "State of the node, as it follows from the error counters.";
    output("can.transmit_errors", ElementType::Count): "Transmit error counter.";
    output("can.receive_errors", ElementType::Count): "Receive error counter.";
    output("can.waiting", ElementType::Count): "Frames that wait for the bus, one that is on it included.";
    output("can.lost", ElementType::Count):
        "Frames that there was no room for, or that were thrown away when the node went off the \
         bus.";
};

/// Sample period, which is not that of a communication step here.
const PERIOD: [DeclaredVariable; 1] = variables! {
    parameter("imu.period_ns", ElementType::Count) of(&q::NANOSECONDS) within(1.0, 1e9) start(&[5e6]):
        "Sample period, ns, which the harness has to have as well.";
};

/// Index of the first of the Calibrator's parameters that are copied here.
const FIRST: usize = {
    // Period and stamps come first: the period is above, and stamps always come with the samples.
    let parameters = calibrator::PARAMETERS;
    let mut i = 0;
    while !same(parameters[i].name, "imu.external_stamps") {
        i += 1;
    }
    assert!(i == 1, "the period stands before the stamps, and nothing else");
    i + 1
};

const COUNT: usize =
    LINK.len() + calibrator::OUTPUTS.len() + PERIOD.len() + calibrator::PARAMETERS.len() - FIRST;

static VARIABLES: [DeclaredVariable; COUNT] =
    concatenated(&[&LINK, &calibrator::OUTPUTS, &PERIOD, calibrator::PARAMETERS.split_at(FIRST).1]);

/// The Calibrator on CAN.
pub static MODEL: Model = Model {
    name: "CalibratorCan",
    stem: "calibrator_can",
    description: "The calibration core as a device on a CAN bus (FMI-LS-BUS 1.0.0): samples and \
                  references come as the frames of octant's wire protocol, and so do gimbal commands, \
                  navigation and estimated errors go.",
    variables: &VARIABLES,
    periods_per_step: Model::ANY_STEP,
    sums_periods: false,
};

/// Cells of the Calibrator's outputs.
pub(super) const OUTPUT_SLOTS: usize = {
    let (mut slots, mut i) = (0, 0);
    while i < calibrator::OUTPUTS.len() {
        slots += calibrator::OUTPUTS[i].slots();
        i += 1;
    }
    slots
};
