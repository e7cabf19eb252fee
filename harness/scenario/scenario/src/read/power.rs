//! Reads the supply or the relay that feeds a device from `[power]`.

use super::reader::Reader;
use crate::error::Problem;
use crate::keys::{PowerKeys, ScenarioKeys};
use crate::model::{Scenario, SourceSpec};
use octant_faults::catalogue::{Acts, FaultKind};
use octant_faults::kinds::unit::BROWN_OUT;
use octant_power::{Outlet, PowerPlan, SupplySetting, check_power_port};
use std::time::Duration;

/// Reads `[power]`, if there is one.
pub(super) fn read(keys: &ScenarioKeys, scenario: &Scenario) -> Result<Option<PowerPlan>, Problem> {
    let Some(power) = &keys.power else { return Ok(None) };
    check_power_port(&power.port).map_err(|error| power.port.problem(error.to_string()))?;
    let is_solution = matches!(scenario.source, SourceSpec::Solution(_));
    if scenario.endpoint.device().is_none() && !is_solution {
        return Err(power.port.problem(
            "found a supply and no device that it could feed: expected a port in endpoint.uri, such as \
             serial:/dev/ttyUSB0",
        ));
    }
    let time = Duration::from_secs_f64;
    Ok(Some(PowerPlan {
        port: power.port.to_string(),
        outlet: outlet(power)?,
        reply: time(power.reply),
        settle: time(power.settle),
        remote: power.remote,
        rest: time(power.rest),
        lead: time(power.lead),
        end_on: power.end,
    }))
}

fn outlet(keys: &PowerKeys) -> Result<Outlet, Problem> {
    let Some(relay) = *keys.relay else {
        let needed = |key: &crate::keys::At<Option<f64>>| {
            let missing = || {
                key.problem("is missing: a supply needs voltage and current_limit, a relay needs its number")
            };
            key.value.ok_or_else(missing)
        };
        return Ok(Outlet::Supply(SupplySetting {
            channel: *keys.channel,
            voltage_v: needed(&keys.voltage)?,
            current_limit_a: needed(&keys.current_limit)?,
            tolerance: keys.tolerance,
        }));
    };
    let beside =
        "beside power.relay: a relay switches and sets nothing, expected one of the two alone";
    if keys.channel.is_some() {
        return Err(keys.channel.problem(format!("found a channel {beside}")));
    }
    if keys.voltage.is_some() {
        return Err(keys.voltage.problem(format!("found a voltage {beside}")));
    }
    if keys.current_limit.is_some() {
        return Err(keys.current_limit.problem(format!("found a current limit {beside}")));
    }
    Ok(Outlet::Relay(relay))
}

/// Reason why a kind can't act on the power of a device, with its key.
pub(super) fn without_power(
    kind: &FaultKind,
    scenario: &Scenario,
    table: &Reader<'_>,
) -> Option<(&'static str, String)> {
    let cuts = kind.name == BROWN_OUT.name && scenario.power.is_some();
    if kind.acts != Acts::Power && !cuts {
        return None;
    }
    let Some(power) = &scenario.power else {
        let why = "acts on the supply of a device, and there is none: expected [power]".to_owned();
        return Some(("kind", why));
    };
    if scenario.realtime.by_clock {
        let why = "waits for the supply and for the device, and samples that leave by the clock don't wait: \
                   expected realtime.pace = \"free\"";
        return Some(("kind", why.to_owned()));
    }
    if cuts {
        return None;
    }
    let Outlet::Supply(supply) = power.outlet else {
        let why = "lowers a voltage, and power.relay can only switch: expected a channel of a supply, or the \
                   kind brown-out, which switches off";
        return Some(("kind", why.to_owned()));
    };
    let dip_v = table.optional_si("voltage")?;
    // The two voltages have to differ by more than the tolerance of a measurement.
    let below_v = (supply.voltage_v * (1.0 - 2.0 * supply.tolerance) * 1e6).round() / 1e6;
    (dip_v >= below_v).then(|| {
        let why = format!(
            "found {dip_v} V, expected less than {below_v} V: power.voltage, {} V, less twice power.tolerance",
            supply.voltage_v
        );
        ("voltage", why)
    })
}
