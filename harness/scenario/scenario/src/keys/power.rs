//! Keys of the supply or the relay that feeds a device.

use super::definition::Bounds;
use super::table::{At, Of, boolean, choice, integer, keys, si, text, time, within};
use crate::quantity::UnitDimension;

const fn wait() -> Of<f64> {
    time(0.0, 3600.0, "from 0 s to 1 h")
}

keys! {
    /// `[power]`.
    pub(crate) struct PowerKeys {
        port: At<String> = text(), required,
            "Port of the supply or of the relays, which speak SCPI: tcp:HOST or tcp:HOST:PORT (5025 by default), or serial:DEVICE?baud=RATE (9600 by default).";
        channel: At<Option<u32>> = integer::<u32>(1, 999), absent("the supply has one channel, or the selected one is meant"),
            "Channel of the supply, selected by its number.";
        relay: At<Option<u32>> = integer::<u32>(1, 999_999_999), absent("a supply feeds the device"),
            "Number of the relay that feeds the device, in place of a channel: closed is on.";
        voltage: At<Option<f64>> = si(&[UnitDimension::VOLTAGE], Bounds::Positive), absent("a relay has none"),
            "Voltage of the supply.";
        current_limit: At<Option<f64>> = si(&[UnitDimension::CURRENT], Bounds::Positive), absent("a relay has none"),
            "Current limit of the supply.";
        tolerance: f64 = within(&[UnitDimension::RATIO], 1e-3, 0.5, "from 0.1 % to 50 %"), "5 %",
            "Largest deviation of a measured voltage, as a share of the voltage; also the largest voltage that is off.";
        settle: f64 = wait(), "2 s",
            "How long a measured voltage may take to come to its value; then the run ends as an error of the bench.";
        rest: f64 = wait(), "1 s",
            "How long the output is off before it is switched on for the run. 0 s: a device that is on stays on.";
        lead: f64 = wait(), "0 s",
            "How long the device is on before it is greeted and the run begins.";
        reply: f64 = time(1e-3, 3600.0, "from 1 ms to 1 h"), "2 s",
            "How long a reply of the instrument is waited for.";
        remote: bool = boolean(), "false",
            "Whether SYST:REM is sent first: some supplies need it on a serial line.";
        end: bool = choice! {
                "off" => false, "switched off";
                "on" => true, "on, with its voltage";
            }, "off",
            "How the output is left when the run has ended, however it ended.";
    }
}
