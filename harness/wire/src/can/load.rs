//! Whether a bus is fast enough: bits of frames in the worst case, and the share of the bus that traffic
//! takes.
//!
//! A frame has stuff bits: after five equal bits comes one that differs. In the worst case that is one
//! after the first five and then one after each four, since a stuff bit begins the next five.

use super::{Format, Slot};
use crate::message::{Kind, PARAMETERS_SEGMENTS, Role};
use crate::traffic::Traffic;

/// Bits of a frame by the rate at which they are sent, with the three bits of pause after it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Bits {
    /// At the nominal rate: all of a classic frame, the ends of an FD frame.
    pub nominal: u32,
    /// At the data rate.
    pub data: u32,
}

impl Bits {
    /// How long they take, s.
    #[must_use]
    pub fn seconds(self, bus: Bus) -> f64 {
        let nominal = f64::from(self.nominal) / f64::from(bus.nominal_bps);
        let data_bps = bus.data_bps.unwrap_or(bus.nominal_bps);
        nominal + f64::from(self.data) / f64::from(data_bps)
    }
}

/// Bits of a classic data frame with an identifier of 11 bits and so many bytes of data, at most.
#[must_use]
pub const fn classic_bits(data_bytes: usize) -> Bits {
    // Stuffed: start 1, identifier 11, RTR 1, IDE 1, r0 1, length 4, data, CRC 15.
    let stuffed = 34 + 8 * data_bytes as u32;
    // Not stuffed: CRC delimiter 1, acknowledgement 2, end 7, pause 3.
    Bits { nominal: stuffed + (stuffed - 1) / 4 + 13, data: 0 }
}

/// Bits of an FD frame with bit rate switch, an identifier of 11 bits and so many bytes of data, at
/// most.
#[must_use]
pub const fn fd_bits(data_bytes: usize) -> Bits {
    // Start 1, identifier 11, RRS 1, IDE 1, FDF 1, res 1, BRS 1: at the nominal rate, and the stuff bits
    // among them, of which there are most when the first run begins with the frame.
    const ARBITRATION: u32 = 17;
    let arbitration_stuff = (ARBITRATION - 1) / 4;
    // ESI 1, length 4, data. Together with the arbitration they have (all − 1) / 4 stuff bits.
    let control_and_data = 5 + 8 * data_bytes as u32;
    let stuff = (ARBITRATION + control_and_data - 1) / 4 - arbitration_stuff;
    // Stuff count 4, CRC 17 or 21, a fixed stuff bit before the first of them and after each four.
    let crc = if data_bytes <= 16 { 4 + 17 } else { 4 + 21 };
    let fixed_stuff = 1 + crc / 4;
    // CRC delimiter 1, acknowledgement 2, end 7, pause 3.
    Bits {
        nominal: ARBITRATION + arbitration_stuff + 13,
        data: control_and_data + stuff + crc + fixed_stuff,
    }
}

/// Bit rates of a bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bus {
    /// Bits a second; of CAN FD, of the arbitration.
    pub nominal_bps: u32,
    /// CAN FD: bits a second of the data. `None`: classic CAN.
    pub data_bps: Option<u32>,
}

/// Share of a bus that traffic takes in the worst case, 1: all of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// What the harness sends.
    pub from_harness: f64,
    /// What the other ends send.
    pub to_harness: f64,
    /// Frames a second, both ways.
    pub frames_per_s: f64,
}

impl Load {
    /// Both ways: a bus has one wire.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.from_harness + self.to_harness
    }
}

/// A bus that can't carry the traffic.
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
    /// What it would have to carry.
    pub traffic: Traffic,
    /// The load that this is.
    pub load: Load,
    /// The share that is allowed.
    pub limit: f64,
    /// Sample rate that it carries with the same other traffic.
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
    /// A bus of classic CAN.
    #[must_use]
    pub const fn classic(bps: u32) -> Self {
        Self { nominal_bps: bps, data_bps: None }
    }

    /// A bus of CAN FD.
    #[must_use]
    pub const fn fd(nominal_bps: u32, data_bps: u32) -> Self {
        Self { nominal_bps, data_bps: Some(data_bps) }
    }

    /// Format of its frames.
    #[must_use]
    pub const fn format(self) -> Format {
        if self.data_bps.is_some() { Format::Fd } else { Format::Classic }
    }

    /// How long the frames of a message take in the worst case, s. Parameters: of one segment.
    #[must_use]
    pub fn seconds(self, slot: Slot) -> f64 {
        let format = self.format();
        let mut seconds = 0.0;
        for segment in 0..slot.segments(format) {
            let bytes = slot.frame_bytes(segment, format);
            let bits = match format {
                Format::Classic => classic_bits(bytes),
                Format::Fd => fd_bits(bytes),
            };
            seconds += bits.seconds(self);
        }
        seconds
    }

    /// The load that traffic makes in the worst case.
    #[must_use]
    pub fn load(self, traffic: &Traffic) -> Load {
        let mut load = Load { from_harness: 0.0, to_harness: 0.0, frames_per_s: 0.0 };
        for (role, kind, rate_hz) in traffic.messages() {
            let messages = if kind == Kind::Parameters { PARAMETERS_SEGMENTS } else { 1 };
            for parameters in 0..messages {
                let Some(slot) = Slot::of(role, kind, parameters as u8) else { continue };
                let way = match role {
                    Role::Harness => &mut load.from_harness,
                    Role::Device | Role::Instrument => &mut load.to_harness,
                };
                *way += rate_hz * self.seconds(slot);
                load.frames_per_s += rate_hz * slot.segments(self.format()) as f64;
            }
        }
        load
    }

    /// The load, if the bus carries the traffic with no more than a share `limit` of it in use.
    ///
    /// # Errors
    /// If it can't, with the sample rate that it carries.
    pub fn carry(self, traffic: &Traffic, limit: f64) -> Result<Load, Overload> {
        let load = self.load(traffic);
        if load.share() <= limit {
            return Ok(load);
        }
        // Outputs come as often as samples, in the same proportion at another rate.
        let fixed = Traffic { samples_hz: 0.0, outputs_hz: 0.0, ..*traffic };
        let fixed = self.load(&fixed).share();
        let per_sample = (load.share() - fixed) / traffic.samples_hz;
        let fits_hz = ((limit - fixed) / per_sample).max(0.0);
        Err(Overload { bus: self, traffic: *traffic, load, limit, fits_hz })
    }
}
