//! `octant turntable`: controls a table by hand, and simulates one.

use crate::failure::Failure;
use crate::terminal::note;
use crate::terminal::{print, print_json};
use clap::{Args, Subcommand, ValueEnum};
use octant_scenario::{Scenario, TableDriver, UnitDimension, quantity_of};
use octant_turntable::simulate::listen;
use octant_turntable::{
    AxisLimits, Dialect, DriverSettings, Error, Move, TableAxis, TableLimits, TablePlan,
    TableStatus, check_port, look, move_by_hand, press, run_guard, stop_by_hand,
};
use octant_verdict::Verdict;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Duration;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Print the angles and the state of a table. Nothing is switched on or moved.
    Status {
        #[command(flatten)]
        table: Table,
        /// Print one JSON object.
        #[arg(long)]
        json: bool,
    },
    /// Home the axes; by default both, one after the other.
    Home {
        #[command(flatten)]
        table: Table,
        /// Home only this axis.
        #[arg(long)]
        axis: Option<AxisName>,
        /// Print one JSON object.
        #[arg(long)]
        json: bool,
    },
    /// Turn an axis to an angle, within the limits of a scenario.
    Goto {
        #[command(flatten)]
        table: Table,
        /// The axis.
        axis: AxisName,
        /// The angle, such as "30 deg".
        #[arg(allow_hyphen_values = true)]
        angle: String,
        /// The rate, such as "1 deg/s"; by default that of the scenario.
        #[arg(long)]
        rate: Option<String>,
        /// Print one JSON object.
        #[arg(long)]
        json: bool,
    },
    /// Stop a table at once, whichever program drives it; by default every table driven by this host.
    Stop {
        /// Port of the table, as written in the program that drives it, or a scenario with [turntable.drive].
        #[arg(value_name = "TABLE")]
        table: Option<String>,
        /// Command language of the controller: a name, or a file with a table of patterns.
        #[arg(long, value_name = "DIALECT", requires = "table")]
        dialect: Option<PathBuf>,
    },
    /// Simulate the controller of a table until interrupted.
    Simulate {
        /// tcp:HOST:PORT, or pty:LINK for a pseudo-terminal with a link to it.
        #[arg(default_value = "tcp:127.0.0.1:8000")]
        place: String,
        /// Command language of the controller: a name, or a file with a table of patterns.
        #[arg(long, value_name = "DIALECT", default_value = Dialect::BUILT_IN)]
        dialect: PathBuf,
    },
    /// Guard of a table, started by the harness with the table's port as its standard output.
    #[command(hide = true)]
    Guard,
}

#[derive(Debug, Args)]
struct Table {
    #[arg(value_name = "TABLE", help = octant_turntable::port_help())]
    table: String,
    /// Command language of the controller: a name, or a file with a table of patterns.
    #[arg(long, value_name = "DIALECT")]
    dialect: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum AxisName {
    Azimuth,
    Roll,
}

impl From<AxisName> for TableAxis {
    fn from(name: AxisName) -> Self {
        match name {
            AxisName::Azimuth => Self::Azimuth,
            AxisName::Roll => Self::Roll,
        }
    }
}

fn failure(error: &Error) -> Failure {
    Failure::of_kind(error.kind_by_hand(), error)
}

/// Returns the plan of a table, and whether its limits are known.
fn plan(table: &Table, moves: bool) -> Result<(TablePlan, bool), Failure> {
    let Table { table, dialect } = table;
    plan_of(table, dialect.as_deref(), moves)
}

fn plan_of(table: &str, dialect: Option<&Path>, moves: bool) -> Result<(TablePlan, bool), Failure> {
    if table.starts_with("tcp:") || table.starts_with("serial:") {
        check_port(table).map_err(Failure::input)?;
        // Without limits no angle is commanded.
        let axis = AxisLimits {
            least_rad: f64::NEG_INFINITY,
            most_rad: f64::INFINITY,
            rate_radps: 1.0,
            acceleration_radps2: 1.0,
        };
        let dialect = dialect.unwrap_or(Path::new(Dialect::BUILT_IN));
        let plan = TablePlan {
            port: table.to_owned(),
            dialect: Dialect::load(dialect).map_err(|error| failure(&error))?,
            settings: DriverSettings {
                limits: TableLimits { axes: [axis; 2] },
                reply_within: Duration::from_millis(500),
                watchdog: None,
            },
            period: Duration::from_millis(20),
            guard: cfg!(unix).then_some(Duration::from_secs(1)),
            home: false,
            start: Duration::from_secs(120),
            tolerance_rad: 0.0,
            units: 1,
        };
        return Ok((plan, false));
    }
    if let Some(dialect) = dialect {
        return Err(Failure::input(format!(
            "--dialect {}: found a scenario, which names the dialect itself, expected no --dialect",
            dialect.display()
        )));
    }
    let scenario = Scenario::load(Path::new(table), &[]).map_err(Failure::input)?;
    let Some(drive) = &scenario.drive else {
        return Err(Failure::input(format!("{table}: found no [turntable.drive]")));
    };
    if drive.driver == TableDriver::AnotherRun && moves {
        return Err(Failure::input(format!(
            "{table}: found turntable.drive.driver = \"another run\", expected the scenario of the run that drives the table"
        )));
    }
    let plan = drive.plan(&scenario.folder).map_err(|error| failure(&error))?;
    Ok((plan, true))
}

/// Parses an angle or a rate on the command line.
fn quantity(name: &str, text: &str, dimension: UnitDimension) -> Result<f64, Failure> {
    let found = quantity_of(text).ok().filter(|quantity| quantity.is(dimension));
    found.map(|quantity| quantity.si).ok_or_else(|| {
        Failure::input(format!(
            "{name}: found {text:?}, expected {} such as {:?}",
            dimension.name, dimension.example
        ))
    })
}

fn moved(plan: &TablePlan, moves: &[Move]) -> Result<TableStatus, Failure> {
    let program = std::env::current_exe()
        .map_err(|error| Failure::bench(format!("failed to find this program: {error}")))?;
    let mut guard = octant_base::child::command(program);
    move_by_hand(plan, moves, guard.args(["turntable", "guard"])).map_err(|error| failure(&error))
}

fn told(status: &TableStatus, as_json: bool) -> Result<(), Failure> {
    let words = |value: Option<bool>, yes: &'static str, no: &'static str| {
        value.map_or("", |value| if value { yes } else { no })
    };
    if as_json {
        let axis = |axis: TableAxis| {
            let found = status.of(axis);
            json!({
                "angle_deg": found.angle_rad.to_degrees(),
                "rate_degps": found.rate_radps.map(f64::to_degrees),
                "moving": found.moving,
                "homed": found.homed,
                "enabled": found.enabled,
                "fault": found.fault,
            })
        };
        return print_json(
            &json!({ "azimuth": axis(TableAxis::Azimuth), "roll": axis(TableAxis::Roll) }),
        );
    }
    for axis in TableAxis::ALL {
        let found = status.of(axis);
        let rate = found
            .rate_radps
            .map_or(String::new(), |rate| format!("  {:.4} deg/s", rate.to_degrees()));
        let fault = match found.fault {
            Some(fault) if fault != 0 => format!(", fault {fault:#x}"),
            _ => String::new(),
        };
        print(&format!(
            "{:8} {:.5} deg{rate}{}{}{}{fault}\n",
            axis.name(),
            found.angle_rad.to_degrees(),
            words(found.moving, ", moving", ", at rest"),
            words(found.homed, ", homed", ", not homed"),
            words(found.enabled, "", ", drive off"),
        ))?;
    }
    Ok(())
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let Arguments { action } = arguments;
    match action {
        Action::Status { table, json } => {
            let (plan, _) = plan(table, false)?;
            told(&look(&plan).map_err(|error| failure(&error))?, *json)?;
        }
        Action::Home { table, axis, json } => {
            let (plan, _) = plan(table, true)?;
            let axes = axis.map_or(TableAxis::ALL.to_vec(), |axis| vec![axis.into()]);
            let moves: Vec<Move> = axes.into_iter().map(Move::Home).collect();
            told(&moved(&plan, &moves)?, *json)?;
        }
        Action::Goto { table, axis, angle, rate, json } => {
            let angle_rad = quantity("ANGLE", angle, UnitDimension::ANGLE)?;
            let rate = rate.as_deref();
            let rate = rate.map(|rate| quantity("--rate", rate, UnitDimension::ANGULAR_RATE));
            let (plan, limited) = plan(table, true)?;
            if !limited {
                return Err(Failure::input(format!(
                    "found {}, expected a scenario: its [turntable.drive] has the limits of the table",
                    table.table
                )));
            }
            let moves = [Move::Goto((*axis).into(), angle_rad, rate.transpose()?)];
            told(&moved(&plan, &moves)?, *json)?;
        }
        // A dialect requires a table.
        Action::Stop { table: None, dialect: _ } => {
            let pressed = press(None).map_err(|error| failure(&error))?;
            if pressed.is_empty() {
                return Err(Failure::bench("no program of this host drives a table"));
            }
            for one in &pressed {
                let how = if one.written { "stop sent" } else { "NOT STOPPED: its port is gone" };
                print(&format!("{}: {how}\n", one.port))?;
            }
            if pressed.iter().any(|one| !one.written) {
                return Ok(Verdict::Error);
            }
        }
        Action::Stop { table: Some(table), dialect } => {
            let (plan, _) = plan_of(table, dialect.as_deref(), false)?;
            let who = stop_by_hand(&plan.port, &plan.dialect).map_err(|error| failure(&error))?;
            print(&format!("{}: stop sent through {}\n", plan.port, who.join(", and through ")))?;
        }
        Action::Simulate { place, dialect } => {
            let dialect = Dialect::load(dialect).map_err(|error| failure(&error))?;
            let (server, name) = listen(place, dialect).map_err(|error| failure(&error))?;
            note!("octant: a simulated table listens on {name}");
            server.wait();
        }
        Action::Guard => {
            return Ok(if run_guard() { Verdict::Pass } else { Verdict::Fail });
        }
    }
    Ok(Verdict::Pass)
}
