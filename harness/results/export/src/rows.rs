//! Rows of the tables, from one recording, read from its first message to its last in bounded memory.

use super::error::ExportFailure;
use super::resample::Grid;
use super::table::{Cell, Table};
use nalgebra::{Matrix3, UnitQuaternion};
use octant_earth::rotation::{rx, rz};
use octant_earth::units::{ARCMIN, NAUTICAL_MILE_M};
use octant_recorder::Event;
use octant_recorder::message::Topic;
use octant_recorder::reader::{Item, Recording};
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::parameters::{PARAMETER_COUNT, ParameterEstimate, ParameterGroup};
use octant_sample::{
    GimbalAngles, Health, Innovation, InnovationOf, Output, Reference, Sample, Truth,
};
use octant_views::solution::{NavigationErrors, is_solution, unit_attitude};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Selection of what is exported.
#[derive(Clone, Debug)]
pub struct Choice {
    /// The recording.
    pub recording: PathBuf,
    /// Tables, in the order of [`Table::ALL`].
    pub tables: Vec<Table>,
    /// Period of the rows that are kept, ns; `None` keeps all.
    pub every_ns: Option<u64>,
    /// True values of the parameters, SI, where they are known.
    pub true_parameters: Option<[f64; PARAMETER_COUNT]>,
}

/// State at the end of reading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReadToEnd {
    /// True if the recording ends in the middle.
    pub is_truncated: bool,
    /// Time of the last message, ns.
    pub last_ns: u64,
}

/// Parts of an epoch that are joined into rows.
#[derive(Default)]
struct Epoch {
    time_ns: u64,
    last: Option<Topic>,
    clean: Option<Sample>,
    sample: Option<Sample>,
    output: Option<Output>,
    innovation: Option<Innovation>,
    truth: Option<Truth>,
}

/// Reads a recording to its end, and passes on the rows of the chosen tables in the order of time.
///
/// # Errors
/// If the recording can't be read, or `take` refuses a row.
pub fn each_row(choice: &Choice, take: &mut TakesRow<'_>) -> Result<ReadToEnd, ExportFailure> {
    let mut rows = Rows {
        grids: choice.tables.iter().map(|table| (*table, grid(*table, choice))).collect(),
        true_parameters: choice.true_parameters.as_ref(),
        cells: Vec::new(),
        take,
    };
    let mut epoch = Epoch::default();
    let end = each_item(&choice.recording, &mut |time_ns, item| {
        let topic = item.topic();
        if topic == Topic::Event {
            if let Item::Event(event) = item {
                rows.event(time_ns, &event)?;
            }
            return Ok(());
        }
        if epoch.last.is_some_and(|last| time_ns != epoch.time_ns || topic <= last) {
            rows.epoch(&epoch)?;
            epoch = Epoch::default();
        }
        epoch.last = Some(topic);
        epoch.time_ns = time_ns;
        match item {
            Item::CleanSample(sample) => epoch.clean = Some(sample),
            Item::Sample(sample) => epoch.sample = Some(sample),
            Item::Output(output) => epoch.output = Some(output),
            Item::Innovation(_, innovation) => epoch.innovation = Some(innovation),
            Item::Truth(truth) => epoch.truth = Some(truth),
            Item::Aiding(aiding) => rows.aiding(time_ns, &aiding.reference)?,
            Item::Parameters(sequence, estimate) => {
                rows.parameters(time_ns, sequence, &estimate)?;
            }
            Item::CleanAiding(_) | Item::Covariance(..) | Item::Event(_) => {}
        }
        Ok(())
    })?;
    if epoch.last.is_some() {
        rows.epoch(&epoch)?;
    }
    Ok(end)
}

/// Reads a recording to its end, and passes on its messages.
pub(crate) fn each_item(
    path: &Path,
    take: &mut dyn FnMut(u64, Item) -> Result<(), ExportFailure>,
) -> Result<ReadToEnd, ExportFailure> {
    let wrong = |source| ExportFailure::Recording { path: path.to_owned(), source };
    let mut recording = Recording::open(path).map_err(wrong)?;
    let mut end = ReadToEnd::default();
    while let Some((time_ns, item)) = recording.next_item().map_err(wrong)? {
        end.last_ns = time_ns;
        take(time_ns, item)?;
    }
    end.is_truncated = recording.truncated();
    Ok(end)
}

fn grid(table: Table, choice: &Choice) -> Grid {
    Grid::new(choice.every_ns.filter(|_| table.is_resampled()))
}

/// Takes a row of a table.
pub type TakesRow<'a> = dyn FnMut(Table, &[Cell]) -> Result<(), ExportFailure> + 'a;

struct Rows<'a> {
    grids: BTreeMap<Table, Grid>,
    true_parameters: Option<&'a [f64; PARAMETER_COUNT]>,
    cells: Vec<Cell>,
    take: &'a mut TakesRow<'a>,
}

impl Rows<'_> {
    /// Begins a row; false if its table isn't wanted, or not at this time.
    fn begin(&mut self, table: Table, time_ns: u64) -> bool {
        if !self.grids.get_mut(&table).is_some_and(|grid| grid.keeps(time_ns)) {
            return false;
        }
        self.cells.clear();
        self.cells.push((time_ns as f64 / 1e9).into());
        true
    }

    fn put(&mut self, cell: impl Into<Cell>) {
        self.cells.push(cell.into());
    }

    fn numbers(&mut self, values: &[f64]) {
        self.cells.extend(values.iter().map(|value| Cell::from(*value)));
    }

    fn empty(&mut self, count: usize) {
        self.cells.extend(std::iter::repeat_n(Cell::Empty, count));
    }

    fn end(&mut self, table: Table) -> Result<(), ExportFailure> {
        (self.take)(table, &self.cells)
    }

    fn epoch(&mut self, epoch: &Epoch) -> Result<(), ExportFailure> {
        if (epoch.sample.is_some() || epoch.clean.is_some())
            && self.begin(Table::Samples, epoch.time_ns)
        {
            self.sample(epoch.sample.as_ref());
            self.sample(epoch.clean.as_ref());
            self.end(Table::Samples)?;
        }
        let Some(output) = &epoch.output else { return Ok(()) };
        if output.nis.is_finite() && self.begin(Table::Innovations, epoch.time_ns) {
            self.put(output.sequence);
            self.put(output.mode as u8);
            self.put(output.nis);
            self.put(output.health.contains(Health::INNOVATION_REJECTED));
            self.innovation(epoch.innovation.as_ref());
            self.end(Table::Innovations)?;
        }
        if self.begin(Table::Navigation, epoch.time_ns) {
            self.navigation(output, epoch.sample.map(|sample| sample.gimbal));
            self.truth(epoch.truth.as_ref());
            self.errors(output, epoch.truth.as_ref());
            self.end(Table::Navigation)?;
        }
        Ok(())
    }

    /// Columns of velocity, then those of position: one of them is empty, or both.
    fn innovation(&mut self, innovation: Option<&Innovation>) {
        for of in [InnovationOf::Velocity, InnovationOf::Position] {
            match innovation.filter(|innovation| innovation.of == of) {
                Some(innovation) => {
                    self.numbers(&innovation.value);
                    self.numbers(&innovation.sigma);
                }
                None => self.empty(6),
            }
        }
    }

    fn sample(&mut self, sample: Option<&Sample>) {
        let Some(sample) = sample else { return self.empty(11) };
        self.put(sample.sequence);
        self.put(sample.device_time.ns as f64 / 1e9);
        self.numbers(&sample.delta_theta.map(|count| f64::from(count) * DELTA_THETA_LSB_RAD));
        self.numbers(&sample.delta_velocity.map(|count| f64::from(count) * DELTA_VELOCITY_LSB_MPS));
        self.gimbals(Some(sample.gimbal));
        self.put(sample.status.bits());
    }

    fn gimbals(&mut self, angles: Option<GimbalAngles>) {
        self.put(angles.map(|angles| angles.azimuth_rad().to_degrees()));
        self.put(angles.map(|angles| angles.roll_rad().to_degrees()));
    }

    fn navigation(&mut self, output: &Output, gimbal: Option<GimbalAngles>) {
        let navigation = &output.navigation;
        self.put(output.sequence);
        self.put(output.mode as u8);
        self.put(output.stop);
        self.put(output.moving);
        self.numbers(&[
            navigation.latitude_rad.to_degrees(),
            navigation.longitude_rad.to_degrees(),
            navigation.height_m,
        ]);
        self.numbers(&navigation.velocity_mps);
        self.numbers(&navigation.q_nb);
        let q_nb = unit_attitude(&navigation.q_nb);
        match q_nb.zip(gimbal) {
            Some((q_nb, gimbal)) => {
                self.numbers(&of_case(&q_nb, gimbal).map(f64::to_degrees));
            }
            None => self.empty(3),
        }
        self.gimbals(gimbal);
        self.gimbals(Some(output.gimbal_command.target));
        self.put(output.nis);
        self.put(output.health.bits());
        self.put(output.parameters_revision);
    }

    fn truth(&mut self, truth: Option<&Truth>) {
        let Some(truth) = truth else { return self.empty(12) };
        self.numbers(&[
            truth.latitude_rad.to_degrees(),
            truth.longitude_rad.to_degrees(),
            truth.height_m,
        ]);
        self.numbers(&truth.velocity_mps);
        self.numbers(&truth.q_nb);
        self.numbers(&truth.gimbal_rad.map(f64::to_degrees));
    }

    fn errors(&mut self, output: &Output, truth: Option<&Truth>) {
        let Some(truth) = truth.filter(|_| is_solution(output.mode)) else {
            return self.empty(10);
        };
        let errors = NavigationErrors::of(output, truth);
        self.numbers(&[
            (output.navigation.latitude_rad - truth.latitude_rad) / ARCMIN,
            (output.navigation.longitude_rad - truth.longitude_rad) / ARCMIN,
            libm::hypot(errors.position_ned_m[0], errors.position_ned_m[1]) / NAUTICAL_MILE_M,
            -errors.position_ned_m[2],
        ]);
        self.numbers(&errors.velocity_ned_mps);
        match errors.attitude_ned_rad {
            Some(attitude) => self.numbers(&attitude.map(|angle_rad| angle_rad / ARCMIN)),
            None => self.empty(3),
        }
    }

    fn aiding(&mut self, time_ns: u64, reference: &Reference) -> Result<(), ExportFailure> {
        if !self.begin(Table::Aiding, time_ns) {
            return Ok(());
        }
        match *reference {
            Reference::Velocity(velocity_mps) => {
                self.put(0u8);
                self.numbers(&velocity_mps);
                self.empty(3);
            }
            Reference::Position { latitude_rad, longitude_rad, height_m } => {
                self.put(1u8);
                self.empty(3);
                self.numbers(&[latitude_rad.to_degrees(), longitude_rad.to_degrees(), height_m]);
            }
        }
        self.end(Table::Aiding)
    }

    fn parameters(
        &mut self,
        time_ns: u64,
        sequence: u64,
        estimate: &ParameterEstimate,
    ) -> Result<(), ExportFailure> {
        if !self.begin(Table::Parameters, time_ns) {
            return Ok(());
        }
        self.put(sequence);
        self.put(estimate.revision);
        let values = estimate.parameters.to_array();
        for (i, value) in values.iter().enumerate() {
            self.put(value / ParameterGroup::of(i).si_per_unit());
        }
        for (i, sigma) in estimate.sigma.iter().enumerate() {
            // A parameter that isn't estimated has no σ.
            self.put(
                Some(sigma / ParameterGroup::of(i).si_per_unit()).filter(|sigma| *sigma > 0.0),
            );
        }
        match self.true_parameters {
            Some(truth) => {
                for (i, (value, truth)) in values.iter().zip(truth).enumerate() {
                    self.put((value - truth) / ParameterGroup::of(i).si_per_unit());
                }
            }
            None => self.empty(PARAMETER_COUNT),
        }
        self.end(Table::Parameters)
    }

    fn event(&mut self, time_ns: u64, event: &Event) -> Result<(), ExportFailure> {
        if let Event::Fault { begins, id, kind, sample } = event
            && self.begin(Table::Faults, time_ns)
        {
            self.put(id.as_str());
            self.put(kind.as_str());
            self.put(*begins);
            self.put(*sample);
            self.end(Table::Faults)?;
        }
        if self.begin(Table::Events, time_ns) {
            let value = serde_json::to_value(event).unwrap_or_default();
            self.put(value.get("kind").and_then(serde_json::Value::as_str).unwrap_or_default());
            let detail = value.get("detail").map_or_else(String::new, ToString::to_string);
            self.put(detail.as_str());
            self.end(Table::Events)?;
        }
        Ok(())
    }
}

/// Roll, pitch and heading of the case, rad: rotations about z, then y, then x take n into c.
///
/// The gimbals stand between case and body: `c_nc = c_nb · c_cbᵀ` with `c_cb = Rx(roll) · Rz(azimuth)`. Heading is
/// in 0 to 2π; pitch is in ±π/2, and there roll and heading aren't unique.
pub(crate) fn of_case(q_nb: &UnitQuaternion<f64>, gimbal: GimbalAngles) -> [f64; 3] {
    let c_nb: Matrix3<f64> = *q_nb.to_rotation_matrix().matrix();
    let c_cb = rx(gimbal.roll_rad()) * rz(gimbal.azimuth_rad());
    let c_nc = c_nb * c_cb.transpose();
    let heading = libm::atan2(c_nc[(1, 0)], c_nc[(0, 0)]);
    [
        libm::atan2(c_nc[(2, 1)], c_nc[(2, 2)]),
        -libm::asin(c_nc[(2, 0)].clamp(-1.0, 1.0)),
        if heading < 0.0 { heading + core::f64::consts::TAU } else { heading },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use octant_earth::rotation::ry;

    #[test]
    fn the_case_keeps_its_attitude_while_the_gimbals_turn() {
        let wanted: [f64; 3] = [0.02, -0.03, 4.0];
        let c_nc = rz(wanted[2]) * ry(wanted[1]) * rx(wanted[0]);
        for (azimuth, roll) in [(0.0, 0.0), (1.2, 0.0), (-2.0, 3.0), (0.5, -0.7)] {
            let gimbal = GimbalAngles::from_rad(azimuth, roll);
            let c_nb = c_nc * rx(gimbal.roll_rad()) * rz(gimbal.azimuth_rad());
            let q_nb = UnitQuaternion::from_matrix(&c_nb);
            let found = of_case(&q_nb, gimbal);
            for (found, wanted) in found.iter().zip(wanted) {
                assert!((found - wanted).abs() < 1e-9, "{found} {wanted}");
            }
        }
    }
}
