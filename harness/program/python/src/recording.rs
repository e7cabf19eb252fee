//! A recording as tables.

use crate::columns::Columns;
use crate::failure::{argument, input};
use crate::table::Table;
use nalgebra::{Quaternion, UnitQuaternion};
use octant_calibration::table::CalibrationTable;
use octant_earth::ellipsoid::{meridian_radius_m, transverse_radius_m};
use octant_earth::frames::phi_of;
use octant_earth::units::{ARCMIN, DEG};
use octant_recorder::Event;
use octant_recorder::reader::{Item, ReadError, Recording};
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::parameters::{NAMES, PARAMETER_COUNT, ParameterEstimate, ParameterGroup};
use octant_sample::{
    Aiding, Health, Innovation, InnovationOf, Navigation, Output, Reference, Sample, Truth,
};
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Messages of a recording by topic.
#[derive(Default)]
struct Topics {
    samples: Vec<Sample>,
    aiding: Vec<Aiding>,
    /// Outputs, each with the stamp of the source's step, ns.
    outputs: Vec<(u64, Output)>,
    /// Innovations by the number of their sample.
    innovations: BTreeMap<u64, Innovation>,
    parameters: Vec<(f64, ParameterEstimate)>,
    truths: Vec<Truth>,
    /// Time of the step, s, and the event as JSON.
    events: Vec<(f64, String)>,
    truncated: bool,
}

/// A recording that was read. Its tables are made when they are asked for.
#[pyclass(module = "octant", frozen)]
pub(crate) struct RawRecording {
    topics: Topics,
    scenario: String,
    run: BTreeMap<String, String>,
}

#[pymethods]
impl RawRecording {
    /// Reads a recording.
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let read = py.detach(|| topics(&path));
        let (topics, (scenario, run)) =
            read.map_err(|error| input(format!("failed to read {}: {error}", path.display())))?;
        Ok(Self { topics, scenario, run })
    }

    /// Makes the table of this name.
    fn table(&self, py: Python<'_>, name: &str) -> PyResult<Table> {
        let topics = &self.topics;
        let columns = py.detach(|| match name {
            "samples" => Some(topics.samples()),
            "aiding" => Some(topics.aiding()),
            "navigation" => Some(topics.navigation()),
            "innovations" => Some(topics.innovations()),
            "parameters" => Some(topics.by_parameter(|e, i| e.parameters.to_array()[i])),
            "sigma" => Some(topics.by_parameter(|e, i| e.sigma[i])),
            "truth" => Some(topics.truth()),
            "errors" => Some(topics.errors()),
            "events" => Some(topics.events()),
            _ => None,
        });
        Table::new(columns.ok_or_else(|| argument(format!("no table {name:?}")))?)
    }

    /// The resolved scenario, TOML.
    #[getter]
    fn scenario(&self) -> &str {
        &self.scenario
    }

    /// Metadata of the run.
    #[getter]
    fn run(&self) -> BTreeMap<String, String> {
        self.run.clone()
    }

    /// True if the recording ends in the middle.
    #[getter]
    fn truncated(&self) -> bool {
        self.topics.truncated
    }
}

/// Head of a recording: the resolved scenario, and the metadata of the run.
type Head = (String, BTreeMap<String, String>);

fn topics(path: &Path) -> Result<(Topics, Head), ReadError> {
    let mut recording = Recording::open(path)?;
    let mut topics = Topics::default();
    while let Some((time_ns, item)) = recording.next_item()? {
        let time_s = time_ns as f64 * 1e-9;
        match item {
            Item::Sample(sample) => topics.samples.push(sample),
            Item::Aiding(aiding) => topics.aiding.push(aiding),
            Item::Output(output) => topics.outputs.push((time_ns, output)),
            Item::Innovation(sequence, innovation) => {
                topics.innovations.insert(sequence, innovation);
            }
            Item::Parameters(_, estimate) => topics.parameters.push((time_s, *estimate)),
            Item::Truth(truth) => topics.truths.push(truth),
            Item::Event(event) => topics.events.push((time_s, text(&event))),
            Item::CleanSample(_) | Item::CleanAiding(_) | Item::Covariance(..) => {}
        }
    }
    topics.truncated = recording.truncated();
    let info = recording.info();
    let head = (info.scenario.clone(), info.run.clone());
    Ok((topics, head))
}

fn text(event: &Event) -> String {
    serde_json::to_string(event).unwrap_or_default()
}

impl Topics {
    fn samples(&self) -> Columns {
        let all = &self.samples;
        let mut columns = Columns::default();
        columns.numbers("time", "s", each(all, |s| s.device_time.seconds()));
        columns.integers("sequence", "1", each(all, |s| s.sequence as i64));
        for (axis, name) in ["x", "y", "z"].iter().enumerate() {
            let angle = |s: &Sample| f64::from(s.delta_theta[axis]) * DELTA_THETA_LSB_RAD;
            columns.numbers(&format!("delta_theta_{name}"), "rad", each(all, angle));
        }
        for (axis, name) in ["x", "y", "z"].iter().enumerate() {
            let speed = |s: &Sample| f64::from(s.delta_velocity[axis]) * DELTA_VELOCITY_LSB_MPS;
            columns.numbers(&format!("delta_velocity_{name}"), "m/s", each(all, speed));
        }
        columns.numbers("gimbal_azimuth", "deg", each(all, |s| s.gimbal.azimuth_rad() / DEG));
        columns.numbers("gimbal_roll", "deg", each(all, |s| s.gimbal.roll_rad() / DEG));
        columns.integers("status", "1", each(all, |s| i64::from(s.status.bits())));
        columns
    }

    fn aiding(&self) -> Columns {
        let all = &self.aiding;
        let velocity = |axis: usize| {
            each(all, move |aiding| match aiding.reference {
                Reference::Velocity(velocity) => Some(velocity[axis]),
                Reference::Position { .. } => None,
            })
        };
        let position = |of: fn(f64, f64, f64) -> f64| {
            each(all, move |aiding| match aiding.reference {
                Reference::Position { latitude_rad, longitude_rad, height_m } => {
                    Some(of(latitude_rad, longitude_rad, height_m))
                }
                Reference::Velocity(_) => None,
            })
        };
        let mut columns = Columns::default();
        columns.numbers("time", "s", each(all, |aiding| aiding.device_time.seconds()));
        columns.some_numbers("velocity_north", "m/s", velocity(0));
        columns.some_numbers("velocity_east", "m/s", velocity(1));
        columns.some_numbers("velocity_down", "m/s", velocity(2));
        columns.some_numbers("latitude", "deg", position(|latitude, _, _| latitude / DEG));
        columns.some_numbers("longitude", "deg", position(|_, longitude, _| longitude / DEG));
        columns.some_numbers("height", "m", position(|_, _, height| height));
        columns
    }

    fn navigation(&self) -> Columns {
        let all = &self.outputs;
        let mut columns = Columns::default();
        columns.numbers("time", "s", each(all, |(_, o)| o.device_time.seconds()));
        columns.integers("sequence", "1", each(all, |(_, o)| o.sequence as i64));
        columns.texts("mode", all.iter().map(|(_, o)| Some(o.mode.name())));
        let states = each(all, State::of);
        states_into(&mut columns, &states);
        columns.integers("stop", "1", each(all, |(_, o)| i64::from(o.stop)));
        columns.booleans("moving", each(all, |(_, o)| Some(o.moving)));
        let target = |(_, o): &(u64, Output)| o.gimbal_command.target;
        columns.numbers("command_azimuth", "deg", each(all, |o| target(o).azimuth_rad() / DEG));
        columns.numbers("command_roll", "deg", each(all, |o| target(o).roll_rad() / DEG));
        columns.integers("health", "1", each(all, |(_, o)| i64::from(o.health.bits())));
        columns
    }

    fn innovations(&self) -> Columns {
        let all: Vec<&Output> =
            self.outputs.iter().map(|(_, o)| o).filter(|o| o.nis.is_finite()).collect();
        let rejected = |o: &&Output| Some(o.health.contains(Health::INNOVATION_REJECTED));
        let mut columns = Columns::default();
        columns.numbers("time", "s", each(&all, |o| o.device_time.seconds()));
        columns.texts("mode", all.iter().map(|o| Some(o.mode.name())));
        columns.numbers("nis", "1", each(&all, |o| o.nis));
        columns.booleans("rejected", each(&all, rejected));
        for (of, name, unit) in
            [(InnovationOf::Velocity, "velocity", "m/s"), (InnovationOf::Position, "position", "m")]
        {
            let found = |o: &Output| self.innovations.get(&o.sequence).filter(|i| i.of == of);
            if !all.iter().any(|o| found(o).is_some()) {
                continue;
            }
            for (axis, direction) in ["north", "east", "down"].into_iter().enumerate() {
                let value = |i: &Innovation| (i.value[axis], i.sigma[axis]);
                let pairs = each(&all, |o| found(o).map_or((f64::NAN, f64::NAN), value));
                let column = |kind| format!("{name}_{direction}_{kind}");
                columns.numbers(&column("innovation"), unit, each(&pairs, |p| p.0));
                columns.numbers(&column("sigma"), unit, each(&pairs, |p| p.1));
            }
        }
        columns
    }

    fn by_parameter(&self, of: impl Fn(&ParameterEstimate, usize) -> f64) -> Columns {
        let all = &self.parameters;
        let mut columns = Columns::default();
        columns.numbers("time", "s", each(all, |(time_s, _)| *time_s));
        columns.integers("revision", "1", each(all, |(_, e)| i64::from(e.revision)));
        for (index, name) in NAMES.iter().enumerate() {
            let group = ParameterGroup::of(index);
            let si = group.si_per_unit();
            columns.numbers(name, group.unit(), each(all, |(_, e)| of(e, index) / si));
        }
        columns
    }

    fn truth(&self) -> Columns {
        let all = &self.truths;
        let mut columns = Columns::default();
        columns.numbers("time", "s", each(all, |t| t.time.seconds()));
        let states = each(all, State::of_truth);
        states_into(&mut columns, &states);
        columns.numbers("gimbal_azimuth", "deg", each(all, |t| t.gimbal_rad[0] / DEG));
        columns.numbers("gimbal_roll", "deg", each(all, |t| t.gimbal_rad[1] / DEG));
        columns
    }

    /// Errors at every output whose step has a truth: navigation minus truth.
    fn errors(&self) -> Columns {
        let mut truths = self.truths.iter().peekable();
        let mut all = Vec::with_capacity(self.truths.len());
        for (step_ns, output) in &self.outputs {
            while truths.next_if(|truth| truth.time.ns < *step_ns).is_some() {}
            if let Some(truth) = truths.peek().filter(|truth| truth.time.ns == *step_ns) {
                all.push((output, **truth));
            }
        }
        let navigation = |o: &Output| o.navigation;
        let angle = |of: fn(&Navigation, &Truth) -> f64| {
            each(&all, move |(o, t)| of(&navigation(o), t) / ARCMIN)
        };
        let mut columns = Columns::default();
        columns.numbers("time", "s", each(&all, |(o, _)| o.device_time.seconds()));
        columns.texts("mode", all.iter().map(|(o, _)| Some(o.mode.name())));
        columns.numbers("latitude", "arcmin", angle(|n, t| n.latitude_rad - t.latitude_rad));
        columns.numbers("longitude", "arcmin", angle(|n, t| n.longitude_rad - t.longitude_rad));
        let north_m = |(o, t): &(&Output, Truth)| {
            (navigation(o).latitude_rad - t.latitude_rad)
                * (meridian_radius_m(libm::sin(t.latitude_rad)) + t.height_m)
        };
        let east_m = |(o, t): &(&Output, Truth)| {
            (navigation(o).longitude_rad - t.longitude_rad)
                * (transverse_radius_m(libm::sin(t.latitude_rad)) + t.height_m)
                * libm::cos(t.latitude_rad)
        };
        columns.numbers("north", "m", each(&all, north_m));
        columns.numbers("east", "m", each(&all, east_m));
        columns.numbers("height", "m", each(&all, |(o, t)| navigation(o).height_m - t.height_m));
        for (axis, name) in ["north", "east", "down"].iter().enumerate() {
            let speed =
                |(o, t): &(&Output, Truth)| navigation(o).velocity_mps[axis] - t.velocity_mps[axis];
            columns.numbers(&format!("velocity_{name}"), "m/s", each(&all, speed));
        }
        let phi = each(&all, |(o, t)| phi_of(&rotation(o.navigation.q_nb), &rotation(t.q_nb)));
        for (axis, name) in ["north", "east", "down"].iter().enumerate() {
            columns.numbers(&format!("phi_{name}"), "arcmin", each(&phi, |p| p[axis] / ARCMIN));
        }
        columns
    }

    fn events(&self) -> Columns {
        let mut columns = Columns::default();
        columns.numbers("time", "s", each(&self.events, |(time_s, _)| *time_s));
        columns.texts("event", self.events.iter().map(|(_, event)| Some(event)));
        columns
    }
}

fn each<T, U>(all: &[T], of: impl Fn(&T) -> U) -> Vec<U> {
    all.iter().map(of).collect()
}

fn rotation(q_nb: [f64; 4]) -> UnitQuaternion<f64> {
    let [w, x, y, z] = q_nb;
    UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z))
}

/// Position, velocity and attitude.
struct State {
    position: [f64; 3],
    velocity_mps: [f64; 3],
    q_nb: [f64; 4],
}

impl State {
    fn of((_, output): &(u64, Output)) -> Self {
        let Navigation { latitude_rad, longitude_rad, height_m, velocity_mps, q_nb } =
            output.navigation;
        Self { position: [latitude_rad / DEG, longitude_rad / DEG, height_m], velocity_mps, q_nb }
    }

    fn of_truth(truth: &Truth) -> Self {
        let Truth { latitude_rad, longitude_rad, height_m, velocity_mps, q_nb, .. } = *truth;
        Self { position: [latitude_rad / DEG, longitude_rad / DEG, height_m], velocity_mps, q_nb }
    }
}

fn states_into(columns: &mut Columns, states: &[State]) {
    for (i, (name, unit)) in
        [("latitude", "deg"), ("longitude", "deg"), ("height", "m")].iter().enumerate()
    {
        columns.numbers(name, unit, each(states, |state| state.position[i]));
    }
    for (axis, name) in ["north", "east", "down"].iter().enumerate() {
        let speed = each(states, |state| state.velocity_mps[axis]);
        columns.numbers(&format!("velocity_{name}"), "m/s", speed);
    }
    for (i, name) in ["w", "x", "y", "z"].iter().enumerate() {
        columns.numbers(&format!("q_nb_{name}"), "1", each(states, |state| state.q_nb[i]));
    }
}

/// Reads a calibration table, `calibration.octcal`: the covariance of the parameters with their names
/// and units. Variances are in squares and products of the units shown to users.
#[pyfunction]
pub(crate) fn read_calibration(path: PathBuf) -> PyResult<Table> {
    let wrong = |error: &dyn std::fmt::Display| {
        input(format!("failed to read {}: {error}", path.display()))
    };
    let bytes = std::fs::read(&path).map_err(|error| wrong(&error))?;
    let table = CalibrationTable::from_bytes(&bytes).map_err(|error| wrong(&error))?;
    let si: [f64; PARAMETER_COUNT] = std::array::from_fn(|i| ParameterGroup::of(i).si_per_unit());
    let mut columns = Columns::default();
    columns.texts("parameter", NAMES.iter().map(|name| Some(*name)));
    columns.texts("unit", (0..PARAMETER_COUNT).map(|i| Some(ParameterGroup::of(i).unit())));
    let estimate = table.parameters.to_array();
    columns.numbers("estimate", "", (0..PARAMETER_COUNT).map(|i| estimate[i] / si[i]).collect());
    for (column, name) in NAMES.iter().enumerate() {
        let unit = format!("{} x the row's unit", ParameterGroup::of(column).unit());
        let of = |row: usize| table.covariance[row][column] / (si[row] * si[column]);
        columns.numbers(name, &unit, (0..PARAMETER_COUNT).map(of).collect());
    }
    Table::new(columns)
}
