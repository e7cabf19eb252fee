//! A device that a supply or a relay feeds: begun cold, cut, dipped, and left as the scenario says.

use super::EndpointError;
use octant_link::Uri;
use octant_link::harness::{Harness, SessionError, SignOfLife};
use octant_link::port::{self, Port, PortError};
use octant_power::{Outlet, PowerError, PowerOutlet, PowerPlan, PowerReading, Switching};
use octant_recorder::event::{PowerReadingRecord, PowerRecord, SwitchingRecord};
use octant_wire::message::EndRole;
use std::time::{Duration, Instant};

/// Pause between two attempts to open the port of a device that starts.
const OPEN_EVERY: Duration = Duration::from_millis(50);
/// Time in which a device that has power would answer while it is cut.
const DEAD_FOR: Duration = Duration::from_secs(1);
/// Interval in which a device is told that the harness is there, while it idles.
const ALIVE_EVERY: Duration = Duration::from_millis(100);

/// Power of a device in a run.
#[derive(Debug)]
pub(super) struct Powered {
    outlet: PowerOutlet,
    period_ns: u64,
    /// Number of the sample before which the power was cut; `None`: it is there.
    cut: Option<u64>,
    dips: u32,
    ridden_through: u32,
    /// Reading in the end.
    end: Option<PowerReading>,
}

impl Powered {
    /// Switches a device on.
    pub(super) fn begin(plan: &PowerPlan, period_ns: u64) -> Result<Self, PowerError> {
        let mut outlet = PowerOutlet::open(plan)?;
        outlet.begin()?;
        Ok(Self { outlet, period_ns, cut: None, dips: 0, ridden_through: 0, end: None })
    }

    /// Opens the port of the device, which may come only when it has started.
    pub(super) fn open_port(uri: &Uri, within: Duration) -> Result<Port, PortError> {
        let begun = Instant::now();
        loop {
            match port::open(uri, EndRole::Harness) {
                Err(_) if begun.elapsed() < within => std::thread::sleep(OPEN_EVERY),
                opened => return opened,
            }
        }
    }

    /// True while the power is cut.
    pub(super) fn is_cut(&self) -> bool {
        self.cut.is_some()
    }

    /// Cuts the power before the sample of this number.
    pub(super) fn cut(&mut self, sample: u64) -> Result<(), PowerError> {
        self.cut = Some(sample);
        self.outlet.switch(false, Some(sample))
    }

    /// Gives the power back before the sample of this number, when the host has waited as long as the cut lasts in
    /// samples, and begins a new session. A device that answers before has never lost its power.
    pub(super) fn back(&mut self, sample: u64, harness: &mut Harness) -> Result<(), EndpointError> {
        let samples = sample.saturating_sub(self.cut.unwrap_or(sample));
        self.outlet.hold(Duration::from_nanos(samples.saturating_mul(self.period_ns)))?;
        if harness.sign_of_life(DEAD_FOR)? != SignOfLife::Silence {
            return Err(EndpointError::Fed { uri: harness.name().to_owned() });
        }
        self.outlet.switch(true, Some(sample))?;
        harness.begin_again()?;
        self.cut = None;
        Ok(())
    }

    /// Lowers the voltage for a time. True: the device lost its session and has a new one.
    pub(super) fn dip(
        &mut self,
        (voltage_v, length): (f64, Duration),
        sample: u64,
        harness: &mut Harness,
    ) -> Result<bool, EndpointError> {
        let Outlet::Supply(supply) = self.outlet.plan().outlet else {
            return Err(PowerError::Relay { port: self.outlet.plan().port.clone() }.into());
        };
        if !harness.is_in_session()? {
            // Its answer afterwards would tell nothing.
            return Err(SessionError::Unsupported {
                port: harness.name().to_owned(),
                what: "replies to time requests, by which it is known whether it rode through",
            }
            .into());
        }
        self.dips += 1;
        self.outlet.lower(voltage_v, Some(sample))?;
        let begun = Instant::now();
        loop {
            let left = length.saturating_sub(begun.elapsed());
            if left.is_zero() {
                break;
            }
            self.outlet.interruptible()?;
            // A device that rides through must not take the wait for the end of the harness. One that doesn't may take its
            // port along.
            let _ = harness.keep_alive();
            std::thread::sleep(left.min(ALIVE_EVERY));
        }
        self.outlet.lower(supply.voltage_v, Some(sample))?;
        if harness.is_in_session()? {
            self.ridden_through += 1;
            return Ok(false);
        }
        harness.begin_again()?;
        Ok(true)
    }

    /// Brings the output to its end state.
    pub(super) fn end(&mut self) -> Result<(), PowerError> {
        self.outlet.end()?;
        self.end = Some(self.outlet.read()?);
        Ok(())
    }

    /// Makes the record of all switchings.
    pub(super) fn record(&self) -> PowerRecord {
        let record = power_record(&self.outlet, self.end);
        PowerRecord { dips: self.dips, ridden_through: self.ridden_through, ..record }
    }
}

/// Makes the record of all switchings of an output, and of its state in the end.
#[must_use]
pub fn power_record(outlet: &PowerOutlet, end: Option<PowerReading>) -> PowerRecord {
    let plan = outlet.plan();
    let (name, voltage_v, current_limit_a) = match plan.outlet {
        Outlet::Relay(relay) => (format!("relay {relay}"), None, None),
        Outlet::Supply(supply) => {
            let channel = supply.channel.map(|channel| format!("channel {channel}"));
            let name = channel.unwrap_or_else(|| "supply".to_owned());
            (name, Some(supply.voltage_v), Some(supply.current_limit_a))
        }
    };
    PowerRecord {
        current_limit_a,
        dips: 0,
        end: end.map(reading),
        identity: outlet.identity().to_owned(),
        outlet: name,
        port: plan.port.clone(),
        ridden_through: 0,
        switchings: outlet.switchings().iter().map(switching).collect(),
        voltage_v,
    }
}

fn reading(of: PowerReading) -> PowerReadingRecord {
    let PowerReading { on, voltage_v, current_a } = of;
    PowerReadingRecord { current_a, on, voltage_v }
}

fn switching(of: &Switching) -> SwitchingRecord {
    SwitchingRecord {
        after: reading(of.after),
        at: octant_base::utc::millis(of.at),
        before: reading(of.before),
        command: of.command.clone(),
        sample: of.sample,
    }
}
