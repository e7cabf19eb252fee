//! `octant power`: looks at a supply or a relay and switches it by hand.

use crate::failure::Failure;
use crate::given::GivenOptions;
use crate::terminal::{print, print_json};
use clap::{Args, Subcommand};
use octant_base::failing::{Failing, FailureKind};
use octant_power::{Outlet, PowerError, PowerOutlet, PowerPlan, PowerReading, SupplySetting};
use octant_scenario::{Scenario, UnitDimension, quantity_of};
use octant_verdict::Verdict;
use serde_json::json;
use std::path::Path;
use std::time::Duration;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[arg(value_name = "PORT", help = octant_power::port_help())]
    port: String,
    #[command(flatten)]
    of_port: PortArguments,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
    #[command(subcommand)]
    action: Action,
}

/// Settings of a scenario's `[power]`, for a port.
#[derive(Debug, Args)]
struct PortArguments {
    /// Channel of the supply.
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u32).range(1..))]
    channel: Option<u32>,
    /// Relay in place of a channel.
    #[arg(long, value_name = "NUMBER", conflicts_with = "channel", value_parser = clap::value_parser!(u32).range(1..))]
    relay: Option<u32>,
    /// How long a reply is waited for.
    #[arg(long, value_name = "TIME", default_value = "2 s")]
    reply: String,
    /// Send SYST:REM first, which some supplies need on a serial line.
    #[arg(long)]
    remote: bool,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Print who the instrument is, its settings, and what it measures. Nothing is switched.
    Status,
    /// Switch the output on, or close the relay. With a scenario its voltage and current limit are set before.
    On,
    /// Switch the output off, or open the relay.
    Off,
    /// Set voltage and current limit of a channel. The output is not switched.
    Set {
        /// The voltage, such as "24 V".
        #[arg(long)]
        voltage: Option<String>,
        /// The current limit, such as "2 A".
        #[arg(long)]
        current_limit: Option<String>,
    },
    /// Reset the whole instrument (*RST), which switches off every output of most.
    Reset,
}

fn failure(error: &PowerError) -> Failure {
    match error.kind() {
        FailureKind::Input => Failure::input(error),
        kind => Failure::of_kind(kind, format!("failed to reach the power: {error}")),
    }
}

/// Parses a quantity above zero on the command line.
fn quantity(name: &str, text: &str, dimension: UnitDimension) -> Result<f64, Failure> {
    let found = quantity_of(text).ok().filter(|found| found.is(dimension) && found.si > 0.0);
    found.map(|found| found.si).ok_or_else(|| {
        Failure::input(format!(
            "{name}: found {text:?}, expected {} above 0 such as {:?}",
            dimension.name, dimension.example
        ))
    })
}

/// Returns the plan of an output, and whether its settings are known.
fn plan(
    port: &str,
    arguments: &PortArguments,
    given: &GivenOptions,
) -> Result<(PowerPlan, bool), Failure> {
    let PortArguments { channel, relay, reply, remote } = arguments;
    if !port.starts_with("tcp:") && !port.starts_with("serial:") && Path::new(port).is_file() {
        given.refuse::<PortArguments>(format!(
            "found the scenario {port}, whose [power] says it, expected no such option, or a port"
        ))?;
        let scenario = Scenario::load(Path::new(port), &[]).map_err(Failure::input)?;
        let plan = scenario.power.clone();
        let plan = plan.ok_or_else(|| Failure::input(format!("{port}: found no [power]")))?;
        return Ok((plan, true));
    }
    octant_power::check_power_port(port).map_err(Failure::input)?;
    let outlet = match relay {
        Some(relay) => Outlet::Relay(*relay),
        // Without settings no voltage is set or waited for.
        None => Outlet::Supply(SupplySetting {
            channel: *channel,
            voltage_v: 0.0,
            current_limit_a: 0.0,
            tolerance: f64::INFINITY,
        }),
    };
    let reply = quantity("--reply", reply, UnitDimension::TIME)?;
    let plan = PowerPlan {
        port: port.to_owned(),
        outlet,
        reply: Duration::from_secs_f64(reply.min(3600.0)),
        settle: Duration::from_secs(2),
        remote: *remote,
        rest: Duration::ZERO,
        lead: Duration::ZERO,
        end_on: false,
    };
    Ok((plan, false))
}

fn told(outlet: &mut PowerOutlet, as_json: bool) -> Result<(), Failure> {
    let settings = outlet.settings().map_err(|error| failure(&error))?;
    let PowerReading { on, voltage_v, current_a } =
        outlet.read().map_err(|error| failure(&error))?;
    if as_json {
        return print_json(&json!({
            "identity": outlet.identity(),
            "on": on,
            "set_voltage_v": settings.map(|(voltage_v, _)| voltage_v),
            "current_limit_a": settings.map(|(_, current_a)| current_a),
            "voltage_v": voltage_v,
            "current_a": current_a,
        }));
    }
    let state = if on { "on" } else { "off" };
    let mut text = format!("{}\n{state}", outlet.identity());
    if let (Some((set_v, limit_a)), Some(found_v), Some(found_a)) = (settings, voltage_v, current_a)
    {
        text += &format!(
            ", set to {set_v} V and at most {limit_a} A; measured {found_v:.3} V, {found_a:.4} A"
        );
    }
    print(&(text + "\n"))
}

pub(super) fn command(arguments: &Arguments, given: &GivenOptions) -> Result<Verdict, Failure> {
    let Arguments { port, of_port, json, action } = arguments;
    let (plan, has_settings) = plan(port, of_port, given)?;
    let bench = |error: PowerError| failure(&error);
    // Impossible requests are refused before the port is opened.
    let set = match action {
        Action::Set { voltage, current_limit } => {
            if matches!(plan.outlet, Outlet::Relay(_)) {
                return Err(failure(&PowerError::Relay { port: plan.port }));
            }
            let read = |name, text: &Option<String>, dimension| {
                text.as_deref().map(|text| quantity(name, text, dimension)).transpose()
            };
            let voltage_v = read("--voltage", voltage, UnitDimension::VOLTAGE)?;
            let limit_a = read("--current-limit", current_limit, UnitDimension::CURRENT)?;
            if voltage_v.is_none() && limit_a.is_none() {
                return Err(Failure::input(
                    "found nothing to set, expected --voltage or --current-limit",
                ));
            }
            (voltage_v, limit_a)
        }
        _ => (None, None),
    };
    let mut outlet = PowerOutlet::open(&plan).map_err(bench)?;
    match action {
        Action::Status => {}
        Action::On => {
            if has_settings {
                outlet.set().map_err(bench)?;
            }
            outlet.switch(true, None).map_err(bench)?;
        }
        Action::Off => outlet.switch(false, None).map_err(bench)?,
        // Read before the port was opened.
        Action::Set { voltage: _, current_limit: _ } => {
            outlet.set_some(set.0, set.1).map_err(bench)?
        }
        Action::Reset => outlet.dialogue().command("*RST").map_err(bench)?,
    }
    told(&mut outlet, *json)?;
    Ok(Verdict::Pass)
}
