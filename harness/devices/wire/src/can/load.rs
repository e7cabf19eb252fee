//! Load of a bus: bits of frames in the worst case, and the share of the bus that traffic takes.
//!
//! A frame has stuff bits: after five equal bits follows one that differs. In the worst case there is
//! one after the first five bits and then one after each four, because a stuff bit is the first of the
//! next five.

use super::{CanVersion, Slot};
use crate::message::{EndRole, MessageKind, PARAMETERS_SEGMENTS};
use crate::traffic::Traffic;

/// Bits of a frame by the rate at which they are sent, with the three bits of intermission after it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Bits {
    /// Bits at the nominal rate: all of a classic frame, both ends of an FD frame.
    pub nominal: u32,
    /// Bits at the data rate.
    pub data: u32,
}

impl Bits {
    /// Duration, s.
    #[must_use]
    pub fn seconds(self, bus: Bus) -> f64 {
        let nominal = f64::from(self.nominal) / f64::from(bus.nominal_bps);
        let data_bps = bus.data_bps.unwrap_or(bus.nominal_bps);
        nominal + f64::from(self.data) / f64::from(data_bps)
    }
}

/// Most bits of a classic data frame with an identifier of 11 bits and this many bytes of data.
#[must_use]
pub const fn classic_bits(data_bytes: usize) -> Bits {
    // Stuffed: start 1, identifier 11, RTR 1, IDE 1, r0 1, length 4, data, CRC 15.
    let stuffed = 34 + 8 * data_bytes as u32;
    // Not stuffed: CRC delimiter 1, acknowledgement 2, end 7, intermission 3.
    Bits { nominal: stuffed + (stuffed - 1) / 4 + 13, data: 0 }
}

/// Most bits of an FD frame with bit rate switch, an identifier of 11 bits and this many bytes of data.
#[must_use]
pub const fn fd_bits(data_bytes: usize) -> Bits {
    // At the nominal rate: start 1, identifier 11, RRS 1, IDE 1, FDF 1, res 1, BRS 1, and the stuff
    // bits among them, which are most if the first run begins with the frame.
    const ARBITRATION: u32 = 17;
    let arbitration_stuff = (ARBITRATION - 1) / 4;
    // ESI 1, length 4, data. Together with the arbitration they have (all − 1) / 4 stuff bits.
    let control_and_data = 5 + 8 * data_bytes as u32;
    let stuff = (ARBITRATION + control_and_data - 1) / 4 - arbitration_stuff;
    // Stuff count 4, CRC 17 or 21, a fixed stuff bit before the first of them and after each four.
    let crc = if data_bytes <= 16 { 4 + 17 } else { 4 + 21 };
    let fixed_stuff = 1 + crc / 4;
    // CRC delimiter 1, acknowledgement 2, end 7, intermission 3.
    Bits {
        nominal: ARBITRATION + arbitration_stuff + 13,
        data: control_and_data + stuff + crc + fixed_stuff,
    }
}

/// Bit rates of a bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bus {
    /// Nominal bit rate, bit/s; with CAN FD, that of the arbitration.
    pub nominal_bps: u32,
    /// Data bit rate of CAN FD, bit/s. `None`: classic CAN.
    pub data_bps: Option<u32>,
}

/// Share of a bus that traffic takes in the worst case; 1 is all of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BusLoad {
    /// Share of the harness's messages.
    pub from_harness: f64,
    /// Share of the other ends' messages.
    pub to_harness: f64,
    /// Frames a second, in both directions.
    pub frames_per_s: f64,
}

impl BusLoad {
    /// Share in both directions: they have the bus in common.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.from_harness + self.to_harness
    }
}

/// Error of a bus that can't carry the traffic.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "{bus} can't carry {:.0} samples a second: in the worst case that is {:.1} % of the bus \
     ({:.1} % there, {:.1} % back), {:.0} % are allowed; {}",
    traffic.samples_hz, 100.0 * load.share(), 100.0 * load.from_harness, 100.0 * load.to_harness,
    100.0 * limit, Advice(*fits_hz)
)]
pub struct Overload {
    /// The bus.
    pub bus: Bus,
    /// Traffic to carry.
    pub traffic: Traffic,
    /// Load that the traffic would make.
    pub load: BusLoad,
    /// Highest permitted share.
    pub limit: f64,
    /// Highest sample rate that the bus carries with the same other traffic, Hz.
    pub fits_hz: f64,
}

struct Advice(f64);

impl core::fmt::Display for Advice {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        if self.0 >= 1.0 {
            write!(f, "it carries {} a second", self.0 as u64)
        } else {
            f.write_str("it doesn't carry what goes beside the samples either")
        }
    }
}

impl core::fmt::Display for Bus {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let kbps = |bps: u32| f64::from(bps) / 1e3;
        match self.data_bps {
            None => write!(f, "classic CAN at {} kbit/s", kbps(self.nominal_bps)),
            Some(data) => {
                write!(f, "CAN FD at {} and {} kbit/s", kbps(self.nominal_bps), kbps(data))
            }
        }
    }
}

impl Bus {
    /// Bus of classic CAN.
    #[must_use]
    pub const fn classic(bps: u32) -> Self {
        Self { nominal_bps: bps, data_bps: None }
    }

    /// Bus of CAN FD.
    #[must_use]
    pub const fn fd(nominal_bps: u32, data_bps: u32) -> Self {
        Self { nominal_bps, data_bps: Some(data_bps) }
    }

    /// Format of the frames.
    #[must_use]
    pub const fn format(self) -> CanVersion {
        if self.data_bps.is_some() { CanVersion::Fd } else { CanVersion::Classic }
    }

    /// Duration of the frames of a message in the worst case, s; for parameters, of one segment.
    #[must_use]
    pub fn seconds(self, slot: Slot) -> f64 {
        let format = self.format();
        let mut seconds = 0.0;
        for segment in 0..slot.segments(format) {
            let bytes = slot.frame_bytes(segment, format);
            let bits = match format {
                CanVersion::Classic => classic_bits(bytes),
                CanVersion::Fd => fd_bits(bytes),
            };
            seconds += bits.seconds(self);
        }
        seconds
    }

    /// Load of the traffic in the worst case.
    #[must_use]
    pub fn load(self, traffic: &Traffic) -> BusLoad {
        let mut load = BusLoad { from_harness: 0.0, to_harness: 0.0, frames_per_s: 0.0 };
        for (role, kind, rate_hz) in traffic.messages() {
            let messages = if kind == MessageKind::Parameters { PARAMETERS_SEGMENTS } else { 1 };
            for parameters in 0..messages {
                let Some(slot) = Slot::of(role, kind, parameters as u8) else { continue };
                let way = match role {
                    EndRole::Harness => &mut load.from_harness,
                    EndRole::Device | EndRole::Instrument => &mut load.to_harness,
                };
                *way += rate_hz * self.seconds(slot);
                load.frames_per_s += rate_hz * slot.segments(self.format()) as f64;
            }
        }
        load
    }

    /// Load of the traffic, if it is at most `limit`.
    ///
    /// # Errors
    /// If the load is higher, with the sample rate that the bus carries.
    pub fn carry(self, traffic: &Traffic, limit: f64) -> Result<BusLoad, Overload> {
        let load = self.load(traffic);
        if load.share() <= limit {
            return Ok(load);
        }
        // Outputs are as frequent as samples, and keep their proportion at another rate.
        let fixed = Traffic { samples_hz: 0.0, outputs_hz: 0.0, ..*traffic };
        let fixed = self.load(&fixed).share();
        let per_sample = (load.share() - fixed) / traffic.samples_hz;
        let fits_hz = ((limit - fixed) / per_sample).max(0.0);
        Err(Overload { bus: self, traffic: *traffic, load, limit, fits_hz })
    }
}
