//! An FMU that moves the case: a ship, or the base of a turntable. Our plant stands on it.
//!
//! The FMU has no input from the plant, so it can run ahead: by three steps, which give value, rate
//! and acceleration at each point. Between two points the motion is a quintic polynomial,
//! continuous with the next one up to the acceleration. Sensors, reference and truth all follow
//! exactly that motion.

use crate::{Epoch, Source, SourceError};
use octant_earth::ellipsoid::Ellipsoid;
use octant_fmu_bind::bind::{BindError, Binder, Bound, ChannelCell};
use octant_fmu_bind::find::ValueWay;
use octant_fmu_bind::stepper::Stepper;
use octant_fmu_host::description::Description;
use octant_plant::config::{CaseAttitude, Dockside, Motion, PlantConfig, PlantSite};
use octant_plant::course::{Course, CoursePoint};
use octant_plant::{ComparedPlant, PlantConfigError, Truth};
use octant_recorder::event::BenchRecord;
use octant_sample::disturbance::Disturbed;
use octant_sample::{GimbalCommand, NoiseIntegral};
use octant_scenario::Fmu;
use octant_scenario::channel::{Channel, case};
use std::collections::VecDeque;
use std::f64::consts::{PI, TAU};

/// Number of points from which a derivative is computed.
const STENCIL: usize = 5;

/// Weights of twelve times the first derivative at one of five points, per step.
const FIRST: [[f64; STENCIL]; STENCIL] = [
    [-25.0, 48.0, -36.0, 16.0, -3.0],
    [-3.0, -10.0, 18.0, -6.0, 1.0],
    [1.0, -8.0, 0.0, 8.0, -1.0],
    [-1.0, 6.0, -18.0, 10.0, 3.0],
    [3.0, -16.0, 36.0, -48.0, 25.0],
];

/// Weights of twelve times the second derivative, per step².
const SECOND: [[f64; STENCIL]; STENCIL] = [
    [35.0, -104.0, 114.0, -56.0, 11.0],
    [11.0, -20.0, 6.0, 4.0, -1.0],
    [-1.0, 16.0, -30.0, 16.0, -1.0],
    [-1.0, 4.0, 6.0, -20.0, 11.0],
    [11.0, -56.0, 114.0, -104.0, 35.0],
];

/// Position of the case as the FMU outputs it.
#[derive(Clone, Copy, Debug)]
enum Place {
    /// Metres north, east and down of the site.
    Metres([Option<ChannelCell>; 3]),
    /// Latitude, longitude, height.
    Geodetic([ChannelCell; 3]),
}

/// Case motion that an FMU outputs.
pub(super) struct Moving {
    stepper: Stepper,
    inputs: Bound,
    outputs: Bound,
    /// Cells of roll, pitch, yaw; the mean is used where the FMU outputs none.
    angles: [Option<ChannelCell>; 3],
    place: Place,
    mean: CaseAttitude,
    site: PlantSite,
    /// Metres per radian of latitude and of longitude.
    radii_m: [f64; 2],
    step_s: f64,
    /// Points from number `first` on.
    points: VecDeque<[f64; 6]>,
    first: u64,
    ended: bool,
}

/// Channels of a motion, bound to the FMU.
pub(super) struct Bindings {
    inputs: Bound,
    outputs: Bound,
    angles: [Option<ChannelCell>; 3],
    place: Place,
}

/// Binds an FMU through the mapping of a scenario.
pub(super) fn bind(description: &Description, fmu: &Fmu) -> Result<Bindings, BindError> {
    let inputs = Binder::new(description, fmu, ValueWay::In).finish()?;
    let mut b = Binder::new(description, fmu, ValueWay::Out);
    let angles = [&case::ROLL, &case::PITCH, &case::HEADING].map(|channel| b.channel(channel));
    let metres: [&'static Channel; 3] = [&case::NORTH, &case::EAST, &case::DOWN];
    let geodetic: [&'static Channel; 3] = [&case::LATITUDE, &case::LONGITUDE, &case::HEIGHT];
    let mapped = |channels: [&'static Channel; 3]| {
        channels.into_iter().find_map(|channel| fmu.mapped(channel))
    };
    if let (Some(one), Some(other)) = (mapped(metres), mapped(geodetic)) {
        b.problem_at(
            &other.at,
            format!(
                "found beside {}, expected metres or latitude, longitude, height",
                one.channel.name
            ),
        );
    }
    let by_degrees = mapped(geodetic).is_some();
    let place = if by_degrees {
        geodetic.map(|channel| b.needed(channel))
    } else {
        metres.map(|channel| b.channel(channel))
    };
    let outputs = b.finish()?;
    let angles = angles.map(|handle| outputs.cell(handle));
    let place = match (by_degrees, place.map(|handle| outputs.cell(handle))) {
        (true, [Some(latitude), Some(longitude), Some(height)]) => {
            Place::Geodetic([latitude, longitude, height])
        }
        (_, cells) => Place::Metres(cells),
    };
    Ok(Bindings { inputs, outputs, angles, place })
}

impl Moving {
    /// Creates a motion at its start. `config` is the plant that stands on it.
    pub(super) fn new(
        stepper: Stepper,
        bindings: Bindings,
        config: &PlantConfig,
        step_s: f64,
    ) -> Result<Self, SourceError> {
        let Bindings { inputs, outputs, angles, place } = bindings;
        let earth = Ellipsoid::at(config.site.latitude_rad, config.site.height_m);
        let mean = match &config.motion {
            Motion::Static(mean) => *mean,
            Motion::Dockside(ship) => ship.mean,
        };
        let mut this = Self {
            stepper,
            inputs,
            outputs,
            angles,
            place,
            mean,
            site: config.site,
            radii_m: [earth.meridian_radius_m, earth.transverse_radius_m * earth.cos_latitude],
            step_s,
            points: VecDeque::new(),
            first: 0,
            ended: false,
        };
        this.stepper.get(&mut this.outputs).map_err(|error| this.gone(error.to_string()))?;
        let point = this.point();
        this.points.push_back(point);
        Ok(this)
    }

    fn gone(&self, reason: String) -> SourceError {
        SourceError::Gone { uri: self.stepper.uri().to_owned(), reason }
    }

    /// Computes roll, pitch, yaw, north, east, down relative to the site from the FMU's last
    /// outputs. Angles are unwrapped where they would jump by a turn.
    fn point(&self) -> [f64; 6] {
        let numbers = &self.outputs.numbers;
        let mean = [self.mean.roll_rad, self.mean.pitch_rad, self.mean.heading_rad];
        let mut point = [0.0; 6];
        for axis in 0..3 {
            let angle = self.angles[axis].map_or(mean[axis], |cell| cell.read(numbers));
            let turns = match self.points.back() {
                Some(before) if (angle - before[axis]).abs() > PI => {
                    ((before[axis] - angle) / TAU).round()
                }
                _ => 0.0,
            };
            point[axis] = angle + turns * TAU;
        }
        match &self.place {
            Place::Metres(cells) => {
                for (value, cell) in point[3..].iter_mut().zip(cells) {
                    *value = cell.map_or(0.0, |cell| cell.read(numbers));
                }
            }
            Place::Geodetic([latitude, longitude, height]) => {
                point[3] = (latitude.read(numbers) - self.site.latitude_rad) * self.radii_m[0];
                point[4] = (longitude.read(numbers) - self.site.longitude_rad) * self.radii_m[1];
                point[5] = self.site.height_m - height.read(numbers);
            }
        }
        point
    }

    /// Number of the last known point.
    fn last(&self) -> u64 {
        self.first + self.points.len() as u64 - 1
    }

    /// Returns the piece from point `k` to the next; `None` if the FMU ended before.
    pub(super) fn piece(&mut self, k: u64) -> Result<Option<Course>, SourceError> {
        while !self.ended && self.last() < (k + 3).max(STENCIL as u64 - 1) {
            match self.stepper.exchange(&self.inputs, &mut self.outputs) {
                Ok(true) => {
                    let point = self.point();
                    if !point.iter().all(|value| value.is_finite()) {
                        let time_s = self.stepper.time_ns() as f64 * 1e-9;
                        return Err(self.gone(format!("at {time_s} s its motion is {point:?}")));
                    }
                    self.points.push_back(point);
                }
                Ok(false) => self.ended = true,
                Err(error) => return Err(self.gone(error.to_string())),
            }
        }
        // Two points before point `k` are kept for its derivatives.
        while self.first + 2 < k && self.points.len() > STENCIL {
            self.points.pop_front();
            self.first += 1;
        }
        if self.last() < k + 1 || self.points.len() < STENCIL {
            return Ok(None);
        }
        let start_s = k as f64 * self.step_s;
        Ok(Some(Course::between(start_s, self.step_s, &self.derived(k), &self.derived(k + 1))))
    }

    /// Computes value, rate and acceleration at a point, from two points on each side where they
    /// exist.
    fn derived(&self, k: u64) -> [CoursePoint; 6] {
        let index = (k - self.first) as usize;
        let from = index.saturating_sub(2).min(self.points.len() - STENCIL);
        let at = index - from;
        std::array::from_fn(|dof| {
            let sum = |weights: &[f64; STENCIL]| -> f64 {
                (0..STENCIL).map(|i| weights[i] * self.points[from + i][dof]).sum()
            };
            CoursePoint {
                value: self.points[index][dof],
                rate: sum(&FIRST[at]) / (12.0 * self.step_s),
                acceleration: sum(&SECOND[at]) / (12.0 * self.step_s * self.step_s),
            }
        })
    }
}

/// Configures the plant for an external motion: without sway and mean attitude of its own, because
/// the external motion includes them.
pub(super) fn on_a_course(config: &PlantConfig) -> PlantConfig {
    PlantConfig {
        motion: Motion::Dockside(Dockside::calm(CaseAttitude::default())),
        ..config.clone()
    }
}

/// The plant on a case that an FMU moves.
pub(crate) struct MovedPlant {
    plant: ComparedPlant,
    moving: Moving,
    course: Course,
    /// Number of samples in a piece; `left_in_piece` counts those left of the present one.
    samples_a_piece: u64,
    left_in_piece: u64,
    pieces: u64,
    total: u64,
    left: u64,
}

impl MovedPlant {
    /// Creates the plant at time 0.
    pub(super) fn new(
        mut moving: Moving,
        config: &PlantConfig,
        samples: u64,
        samples_a_piece: u64,
    ) -> Result<Self, SourceError> {
        let plant =
            ComparedPlant::new(&on_a_course(config)).map_err(|error| refused(&moving, &error))?;
        let Some(course) = moving.piece(0)? else {
            return Err(moving.gone("it ended within the first steps".to_owned()));
        };
        let mut this = Self {
            plant,
            moving,
            course,
            samples_a_piece,
            left_in_piece: samples_a_piece,
            pieces: 1,
            total: samples,
            left: samples,
        };
        this.follow()?;
        Ok(this)
    }

    fn follow(&mut self) -> Result<(), SourceError> {
        self.plant.follow(&self.course).map_err(|error| refused(&self.moving, &error))
    }
}

fn refused(moving: &Moving, error: &PlantConfigError) -> SourceError {
    SourceError::Use(octant_fmu_bind::stepper::UseError::Open {
        uri: moving.stepper.uri().to_owned(),
        reason: error.to_string(),
    })
}

impl Source for MovedPlant {
    fn next(&mut self, command: &GimbalCommand, epoch: &mut Epoch) -> Result<bool, SourceError> {
        if self.left == 0 {
            return Ok(false);
        }
        if self.left_in_piece == 0 {
            let Some(course) = self.moving.piece(self.pieces)? else { return Ok(false) };
            self.course = course;
            self.pieces += 1;
            self.left_in_piece = self.samples_a_piece;
            self.follow()?;
        }
        self.left_in_piece -= 1;
        self.left -= 1;
        self.plant.step_into(command, &mut epoch.sample, &mut epoch.aiding);
        Ok(true)
    }

    fn truth(&self) -> Option<Truth> {
        Some(self.plant.plant().truth())
    }

    #[inline]
    fn truth_stands(&self) -> Option<bool> {
        Some(self.plant.plant().stands())
    }

    fn known_noise(&self) -> Option<NoiseIntegral> {
        Some(self.plant.plant().white_noise())
    }

    fn temperature_c(&mut self) -> Result<Option<f64>, SourceError> {
        Ok(Some(self.plant.plant().temperature_c()))
    }

    fn samples_total(&self) -> Option<u64> {
        Some(self.total)
    }

    fn disturbed(&mut self) -> Option<&mut dyn Disturbed> {
        Some(&mut self.plant)
    }

    fn has_true_parameters(&self) -> bool {
        true
    }

    fn conclude(&mut self, _: Option<&str>) -> (Option<Box<BenchRecord>>, Option<SourceError>) {
        (None, super::ending::freed(&mut self.moving.stepper))
    }
}
