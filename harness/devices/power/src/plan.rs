//! What feeds the device, and how it is switched.

use std::time::Duration;

/// What feeds the device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outlet {
    /// A channel of a programmable supply.
    Supply(SupplySetting),
    /// A relay, by its channel number.
    Relay(u32),
}

/// A channel of a supply with its settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupplySetting {
    /// Channel, for `INST:NSEL`; `None`: the supply has one alone, or the one that is selected is taken.
    pub channel: Option<u32>,
    /// Voltage, V.
    pub voltage_v: f64,
    /// Current limit, A.
    pub current_limit_a: f64,
    /// Largest deviation of the measured voltage, as a share of the voltage; infinite: no voltage is waited for.
    pub tolerance: f64,
}

/// Plan for the output that feeds a device.
#[derive(Clone, Debug, PartialEq)]
pub struct PowerPlan {
    /// Port, by one of the addresses of [`POWER_PORT`](crate::POWER_PORT).
    pub port: String,
    /// The output.
    pub outlet: Outlet,
    /// Time limit of a reply.
    pub reply: Duration,
    /// Time in which a measured voltage has to come to its value.
    pub settle: Duration,
    /// True if `SYST:REM` is sent first.
    pub remote: bool,
    /// Time for which the output is off before it is switched on for a run; zero: an output that is on stays on.
    pub rest: Duration,
    /// Time from switching on until the device is greeted.
    pub lead: Duration,
    /// True if the output is on in the end.
    pub end_on: bool,
}
