//! The calibration core as a device on a CAN bus: a network FMU of FMI-LS-BUS 1.0.0, low cut.
//!
//! The bus carries the frames of octant's wire protocol, as on a real bus; `README.md` of
//! octant-wire describes the device.
//!
//! | module | idea |
//! |---|---|
//! | [`table`] | its variables |
//! | `operation` | bus operations as bytes |
//! | `controller` | the CAN controller: order, confirmation, error counters |
//! | `device` | the session: hello, steps, answers |

mod controller;
mod device;
mod operation;
pub mod table;

use super::calibrator::CalibratorValueError;
use crate::calibrator;
use crate::component::{ModelComponent, Network};
use crate::table::{DeclaredCausality, DeclaredVariable, Model};
use crate::values::CellValues;
use controller::{Controller, Setup};
use device::{Changed, Device};
use octant_calibration::state_machine::CoreConfigError;
use octant_state::{StateError, StateFormat};
use octant_wire::can::{self, BusFrame, DropCause, Reassembler, ReassemblyEvent};
use octant_wire::{EndRole, Unreadable};
use operation::{ArbitrationLost, Configuration, Kind, Operation, Operations, Transmit};
use table::slot;

/// The device.
#[derive(Clone, Debug)]
pub struct CalibratorCan {
    device: Device,
    controller: Controller,
    reassembler: Reassembler,
    period_ns: u64,
    /// Variables of the Calibrator, from which the outputs of the same names are copied.
    core_values: CellValues,
    remark: Option<String>,
}

/// Longest time on the bus, ns, some seventy years: sums with it still fit.
const TIME_MAX_NS: u64 = 1 << 61;

/// Time on the bus, ns; before zero it is zero.
fn ns(time_s: f64) -> u64 {
    ((time_s * 1e9).round() as u64).min(TIME_MAX_NS)
}

/// Copies the cells of the parameters that the Calibrator has too.
fn copy_parameters(from: &CellValues, to: &mut CellValues) {
    let is_parameter = |v: &DeclaredVariable| v.causality == DeclaredCausality::Parameter;
    for (slot, variable) in table::MODEL.with_slots().filter(|(_, v)| is_parameter(v)) {
        if let Some((other, _)) = calibrator::table::MODEL.find(variable.name) {
            let cells = &from.cells()[slot..slot + variable.slots()];
            to.cells_mut()[other..other + variable.slots()].copy_from_slice(cells);
        }
    }
}

impl CalibratorCan {
    /// Makes a device from the parameters alone, as after power on and before its first message.
    fn new(values: &CellValues) -> Result<Self, CalibratorCanFailure> {
        let mut core_values = CellValues::new(&calibrator::table::MODEL);
        copy_parameters(values, &mut core_values);
        let config = calibrator::config(&core_values)?;
        let fd = values.boolean(slot::FD);
        let notifications = values.boolean(slot::NOTIFICATIONS);
        let lost = match values.integer(slot::ARBITRATION_LOST) {
            1 => ArbitrationLost::Buffer,
            _ => ArbitrationLost::Notify,
        };
        if lost == ArbitrationLost::Notify && !notifications {
            return Err(CalibratorCanFailure::Discard);
        }
        // The table limits their range.
        let rate = |slot| values.count(slot) as u32;
        let bit_rate = rate(slot::BIT_RATE);
        let mut configuration = vec![Configuration::BitRate(bit_rate)];
        if fd {
            configuration.push(Configuration::DataBitRate(rate(slot::DATA_BIT_RATE)));
        }
        configuration.push(Configuration::ArbitrationLost(lost));
        let format = if fd { can::CanVersion::Fd } else { can::CanVersion::Classic };
        let setup = Setup { format, notifications, bit_rate };
        Ok(Self {
            period_ns: config.sample_period_ns,
            device: Device::new(config)?,
            controller: Controller::new(setup, &configuration),
            reassembler: Reassembler::new(&[EndRole::Harness], format),
            core_values,
            remark: None,
        })
    }

    /// Writes the core's outputs.
    fn put_core(&mut self, values: &mut CellValues) {
        calibrator::put_outputs(self.device.output(), self.device.core(), &mut self.core_values);
        values.cells_mut()[slot::OUTPUTS..slot::OUTPUTS + table::OUTPUT_SLOTS].copy_from_slice(
            &self.core_values.cells()
                [slot::CALIBRATOR_OUTPUTS..slot::CALIBRATOR_OUTPUTS + table::OUTPUT_SLOTS],
        );
    }

    /// Writes the controller's outputs.
    fn put_controller(&self, values: &mut CellValues) {
        let (transmit, receive) = self.controller.errors();
        values.set_integer(slot::NODE_STATE, self.controller.state() as i32);
        values.set_count(slot::TRANSMIT_ERRORS, transmit.into());
        values.set_count(slot::RECEIVE_ERRORS, receive.into());
        values.set_count(slot::WAITING, self.controller.waiting() as u64);
        values.set_count(slot::LOST, self.controller.lost());
    }

    fn frame(&mut self, transmit: &Transmit<'_>, now_ns: u64) -> Changed {
        self.controller.heard_frame();
        let format = match transmit.kind {
            Kind::Classic { remote: false } => can::CanVersion::Classic,
            Kind::Fd => can::CanVersion::Fd,
            Kind::Classic { remote: true } | Kind::Xl => return Changed(false),
        };
        // Frames of the protocol have identifiers of 11 bits.
        let id = u16::try_from(transmit.id).ok().filter(|_| !transmit.extended);
        let Some(frame) = id.and_then(|id| BusFrame::new(id, format, transmit.data)) else {
            return Changed(false);
        };
        match self.reassembler.receive(&frame) {
            Some(ReassemblyEvent::Received { message, .. }) => {
                let counters = self.reassembler.counters();
                self.device.take(&message, now_ns, counters, &mut self.controller)
            }
            Some(ReassemblyEvent::Lost(lost)) => {
                if let DropCause::Unreadable(Unreadable::NewerVersion { .. }) = lost.cause {
                    self.device.too_new(now_ns, &mut self.controller);
                }
                Changed(false)
            }
            None => Changed(false),
        }
    }
}

impl ModelComponent for CalibratorCan {
    const MODEL: &'static Model = &table::MODEL;

    type Error = CalibratorCanFailure;

    fn initialize(values: &mut CellValues) -> Result<Self, CalibratorCanFailure> {
        let mut this = Self::new(values)?;
        this.device.power_on(&mut this.controller);
        this.put_core(values);
        this.put_controller(values);
        Ok(this)
    }

    fn period_ns(&self) -> u64 {
        self.period_ns
    }

    fn tune(&mut self, values: &CellValues) -> Result<(), CalibratorCanFailure> {
        let mut core_values = self.core_values.clone();
        copy_parameters(values, &mut core_values);
        self.device.tune(calibrator::config(&core_values)?)?;
        self.core_values = core_values;
        Ok(())
    }

    /// Does nothing: the device acts only at events.
    fn step(&mut self, _: &mut CellValues) -> Result<(), CalibratorCanFailure> {
        Ok(())
    }

    fn remark(&mut self) -> Option<String> {
        self.remark.take().or_else(|| self.device.remark())
    }

    fn network(&mut self) -> Option<&mut dyn Network> {
        Some(self)
    }

    fn save(&self, bytes: &mut Vec<u8>) {
        FORMAT.write(bytes, |to| {
            to.part("device", &self.device);
            to.part("controller", &self.controller);
            to.part("reassembler", &self.reassembler);
        });
    }

    fn load(bytes: &[u8], values: &CellValues) -> Result<Self, CalibratorCanFailure> {
        let mut this = Self::new(values)?;
        this.read(bytes)?;
        Ok(this)
    }
}

impl Network for CalibratorCan {
    fn receive(&mut self, bytes: &[u8], time_s: f64, values: &mut CellValues) {
        let now_ns = ns(time_s);
        let mut changed = false;
        for operation in Operations::of(bytes) {
            match operation {
                Ok(Operation::Transmit(transmit)) => changed |= self.frame(&transmit, now_ns).0,
                Ok(Operation::Confirm { id }) => self.controller.confirmed(id),
                Ok(Operation::ArbitrationLost { id }) => {
                    self.controller.arbitration_lost(id, now_ns);
                }
                Ok(Operation::BusError(error)) => self.controller.bus_error(&error, now_ns),
                Ok(Operation::FormatError { quoted }) => {
                    let bytes = quoted.len();
                    self.remark =
                        Some(format!("a peer could not read an operation of {bytes} bytes"));
                }
                Ok(Operation::Ignored) => {}
                Err(bytes) => self.controller.refuse(bytes),
            }
        }
        if changed {
            self.put_core(values);
        }
        self.put_controller(values);
    }

    fn send(&mut self, time_s: f64, max_bytes: usize, values: &mut CellValues) -> Vec<u8> {
        let now_ns = ns(time_s);
        self.device.on_time(now_ns, self.reassembler.counters(), &mut self.controller);
        let bytes = self.controller.send(now_ns, max_bytes);
        self.put_controller(values);
        bytes
    }

    fn due_s(&self, time_s: f64) -> Option<f64> {
        let now_ns = ns(time_s);
        let due_ns = [self.controller.due_ns(now_ns), self.device.due_ns()];
        let due_ns = due_ns.into_iter().flatten().min()?;
        Some(if due_ns <= now_ns { time_s } else { due_ns as f64 * 1e-9 })
    }
}

/// Format of the bytes of a device.
const FORMAT: StateFormat =
    StateFormat { magic: "OCTCANDV", version: 1, what: "the state of a Calibrator on CAN" };

impl CalibratorCan {
    fn read(&mut self, bytes: &[u8]) -> Result<(), StateError> {
        let mut from = FORMAT.read(bytes)?;
        from.part("device", &mut self.device)?;
        from.part("controller", &mut self.controller)?;
        from.part("reassembler", &mut self.reassembler)?;
        from.end()
    }
}

/// Reason why there is no device.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CalibratorCanFailure {
    /// The values make no configuration of the core.
    #[error(transparent)]
    Value(#[from] CalibratorValueError),
    /// The core can't be made from the configuration.
    #[error(transparent)]
    Config(#[from] CoreConfigError),
    /// Frames that lose the bus would be lost.
    #[error(
        "can.arbitration_lost is discard, for which can.bus_notifications has to be true: frames \
         that lose the bus would be lost"
    )]
    Discard,
    /// The bytes are no state.
    #[error(transparent)]
    State(#[from] StateError),
}
