//! CAN controller of a node: frames out in order, error counters, node state.
//!
//! Without notifications it sends each frame once. With them it has one frame on the bus at a time,
//! and repeats it until it is confirmed; counters and states follow the rules in the implementers'
//! guide of FMI-LS-BUS.

use super::operation::{
    BusError, Configuration, ErrorCause, NodeState, Writer, is_format_error, transmit_bytes,
};
use octant_state::{
    State, StateError, StateReader, Writer as StateWriter, check_below, check_count,
};
use octant_wire::can::{BusFrame, CanVersion};
use std::collections::VecDeque;

/// Largest number of waiting frames: fifty outputs with parameters of classic CAN, which a working
/// bus has sent long before.
const FRAMES_MAX: usize = 8192;
/// Largest number of bytes of other waiting operations: more comes only from a peer that sends
/// nothing but nonsense, which needn't be quoted completely.
const OTHERS_MAX_BYTES: usize = 65_535;
/// Bits of the shortest frame with the pause after it: the time for which a frame that lost
/// arbitration, or was destroyed, waits before the next attempt. The bus is busy for at least that
/// time.
const RETRY_BITS: u64 = 47;
/// Number of operations on the bus after which a bus-off node returns.
const RECOVERY: u32 = 128;

/// Setup of a controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Setup {
    pub format: CanVersion,
    /// True if the bus simulation reports the result of each frame.
    pub notifications: bool,
    pub bit_rate: u32,
}

/// A controller.
#[derive(Clone, Debug)]
pub(super) struct Controller {
    setup: Setup,
    /// Operations other than frames, which are sent before the frames.
    others: Vec<u8>,
    frames: VecDeque<BusFrame>,
    /// True if the first of the frames is on the bus.
    on_bus: bool,
    /// Earliest time of the next attempt to send the first frame, ns.
    retry_ns: u64,
    state: NodeState,
    transmit_errors: u32,
    receive_errors: u32,
    /// Number of operations received from the bus since the node is off.
    heard: u32,
    /// Frames dropped for lack of room, or discarded when the node went off.
    lost: u64,
}

impl Controller {
    /// Makes a controller that has still to send its setup and its presence to the bus simulation.
    pub(super) fn new(setup: Setup, configuration: &[Configuration]) -> Self {
        let mut others = Vec::new();
        let mut to = Writer(&mut others);
        configuration.iter().for_each(|one| to.configuration(*one));
        to.status(NodeState::ErrorActive);
        Self {
            setup,
            others,
            frames: VecDeque::new(),
            on_bus: false,
            retry_ns: 0,
            state: NodeState::ErrorActive,
            transmit_errors: 0,
            receive_errors: 0,
            heard: 0,
            lost: 0,
        }
    }

    pub(super) fn format(&self) -> CanVersion {
        self.setup.format
    }

    pub(super) fn state(&self) -> NodeState {
        self.state
    }

    /// Transmit and receive error counters.
    pub(super) fn errors(&self) -> (u32, u32) {
        (self.transmit_errors, self.receive_errors)
    }

    pub(super) fn waiting(&self) -> usize {
        self.frames.len()
    }

    pub(super) fn lost(&self) -> u64 {
        self.lost
    }

    /// Queues a frame; without room, or in bus-off, it is counted as lost.
    pub(super) fn push(&mut self, frame: BusFrame) {
        if self.frames.len() >= FRAMES_MAX || self.state == NodeState::BusOff {
            self.lost += 1;
        } else {
            self.frames.push_back(frame);
        }
    }

    /// Answers bytes that are no operation with a Format Error.
    pub(super) fn refuse(&mut self, bytes: &[u8]) {
        if !is_format_error(bytes) && self.others.len() < OTHERS_MAX_BYTES / 2 {
            Writer(&mut self.others).format_error(bytes);
        }
    }

    /// Lowers the receive error counter: a frame of another node was received.
    pub(super) fn heard_frame(&mut self) {
        self.receive_errors = match self.receive_errors {
            0 => 0,
            1..=127 => self.receive_errors - 1,
            _ => 127,
        };
        self.heard_anything();
    }

    /// Removes the first frame, which another node has received.
    pub(super) fn confirmed(&mut self, id: u32) {
        if self.setup.notifications && self.is_on_bus(id) {
            self.frames.pop_front();
            self.on_bus = false;
            self.transmit_errors = self.transmit_errors.saturating_sub(1);
            self.judge();
        }
    }

    /// Repeats the first frame, which lost arbitration, later.
    pub(super) fn arbitration_lost(&mut self, id: u32, now_ns: u64) {
        if self.setup.notifications && self.is_on_bus(id) {
            self.retry(now_ns);
        }
    }

    /// Counts a bus error, and repeats the node's own frame.
    pub(super) fn bus_error(&mut self, error: &BusError, now_ns: u64) {
        if !self.setup.notifications {
            return;
        }
        let BusError { id, cause, primary, is_sender } = *error;
        let broken = cause == ErrorCause::BrokenErrorFrame;
        if broken || !is_sender {
            self.receive_errors += if broken || primary { 8 } else { 1 };
        }
        // No node acknowledges: a passive node doesn't count this, and doesn't go off.
        let alone = self.state == NodeState::ErrorPassive && cause == ErrorCause::Acknowledgement;
        if (is_sender || broken) && !alone {
            self.transmit_errors = (self.transmit_errors + 8).min(512);
        }
        // Larger values have no meaning in any rule.
        self.receive_errors = self.receive_errors.min(255);
        if is_sender && self.is_on_bus(id) {
            self.retry(now_ns);
        }
        self.heard_anything();
    }

    fn is_on_bus(&self, id: u32) -> bool {
        self.on_bus && self.frames.front().is_some_and(|frame| u32::from(frame.id()) == id)
    }

    fn retry(&mut self, now_ns: u64) {
        self.on_bus = false;
        let wait_ns = RETRY_BITS * 1_000_000_000 / u64::from(self.setup.bit_rate.max(1));
        self.retry_ns = now_ns.saturating_add(wait_ns);
    }

    fn heard_anything(&mut self) {
        if self.state == NodeState::BusOff {
            self.heard += 1;
            if self.heard >= RECOVERY {
                (self.transmit_errors, self.receive_errors, self.heard) = (0, 0, 0);
            }
        }
        self.judge();
    }

    /// Updates the state from the counters; the bus simulation is told of each change.
    fn judge(&mut self) {
        let state = match (self.transmit_errors, self.receive_errors) {
            (256.., _) => NodeState::BusOff,
            (128.., _) | (_, 128..) => NodeState::ErrorPassive,
            _ => NodeState::ErrorActive,
        };
        if state == self.state {
            return;
        }
        self.state = state;
        Writer(&mut self.others).status(state);
        if state == NodeState::BusOff {
            self.lost += self.frames.len() as u64;
            self.frames.clear();
            self.on_bus = false;
            self.heard = 0;
        }
    }

    /// Time of the next operation to send, ns.
    pub(super) fn due_ns(&self, now_ns: u64) -> Option<u64> {
        if !self.others.is_empty() {
            return Some(now_ns);
        }
        let can_send = !self.frames.is_empty() && !self.on_bus;
        can_send.then(|| self.retry_ns.max(now_ns))
    }

    /// Takes the operations to send now, within this number of bytes.
    pub(super) fn send(&mut self, now_ns: u64, max_bytes: usize) -> Vec<u8> {
        let mut bytes = core::mem::take(&mut self.others);
        let fd = self.setup.format == CanVersion::Fd;
        let esi = self.state == NodeState::ErrorPassive;
        if self.on_bus || self.retry_ns > now_ns {
            return bytes;
        }
        while let Some(frame) = self.frames.front() {
            if bytes.len() + transmit_bytes(fd, frame.data().len()) > max_bytes {
                break;
            }
            Writer(&mut bytes).transmit(frame.id(), fd, esi, frame.data());
            if self.setup.notifications {
                self.on_bus = true;
                break;
            }
            self.frames.pop_front();
        }
        bytes
    }
}

impl State for Controller {
    fn save(&self, to: &mut StateWriter) {
        to.value("others", &self.others);
        to.value("waiting", &(self.frames.len() as u32));
        for frame in &self.frames {
            to.value("identifier", &frame.id());
            to.value("data", frame.data());
        }
        to.value("on bus", &self.on_bus);
        to.value("retry", &self.retry_ns);
        to.value("transmit errors", &self.transmit_errors);
        to.value("receive errors", &self.receive_errors);
        to.value("heard", &self.heard);
        to.value("lost", &self.lost);
        to.value("node state", &(self.state as u8));
    }

    fn load(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        self.others = from.value("others")?;
        check_below("others", self.others.len() as u64, 2 * OTHERS_MAX_BYTES as u64)?;
        let waiting: u32 = from.value("waiting")?;
        check_below("waiting", waiting.into(), FRAMES_MAX as u64)?;
        self.frames.clear();
        for _ in 0..waiting {
            let (id, data): (u16, &[u8]) = (from.value("identifier")?, from.value("data")?);
            let frame = BusFrame::new(id, self.setup.format, data);
            let frame = frame.ok_or_else(|| StateError::value("data", "it is no frame"))?;
            self.frames.push_back(frame);
        }
        self.on_bus = from.value("on bus")?;
        self.retry_ns = from.value("retry")?;
        check_count("retry", self.retry_ns)?;
        self.transmit_errors = from.value("transmit errors")?;
        self.receive_errors = from.value("receive errors")?;
        self.heard = from.value("heard")?;
        check_below("transmit errors", self.transmit_errors.into(), 1024)?;
        check_below("receive errors", self.receive_errors.into(), 255)?;
        check_below("heard", self.heard.into(), RECOVERY.into())?;
        self.lost = from.value("lost")?;
        check_count("lost", self.lost)?;
        self.state = match from.value::<u8>("node state")? {
            1 => NodeState::ErrorActive,
            2 => NodeState::ErrorPassive,
            3 => NodeState::BusOff,
            _ => return Err(StateError::value("node state", "1 to 3 is expected")),
        };
        Ok(())
    }
}
