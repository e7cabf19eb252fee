//! Motion, turntable, sensors and faults as a component: set points in, samples out.
//!
//! A step takes the set point first, then makes the sample of its interval: a controller's answer
//! to a sample reaches the plant at the next communication point, and acts from then on. A single
//! program with both models has the same order.

mod config;
mod error;
mod faults;
mod outputs;
pub mod table;

pub use config::config;
pub use error::{FaultError, Misplaced, PlantFailure, PlantValueError, PutError, Unplaced};
pub use faults::{Number, faults, numbers, setup};

use crate::component::ModelComponent;
use crate::table::Model;
use crate::values::CellValues;
use octant_faults::station::{Delivered, World};
use octant_faults::{FaultSpec, Station};
use octant_plant::ComparedPlant;
use octant_plant::config::PlantConfig;
use octant_sample::disturbance::Disturbed;
use octant_sample::{Epoch, GimbalAngles, GimbalCommand, Output, Truth};
use octant_state::{StateError, StateFormat};
use table::{FAULT_SLOTS, slot};

/// Start values of all parameters that make a plant with this configuration and these faults: name,
/// and a value for each element. Numbers unchanged, counts as whole numbers (exact up to 2⁵³),
/// enumerations by their values, Booleans as 0 and 1.
///
/// # Errors
/// If a motion of the ship has more sinusoids than there is room for, or a fault can't be one of the
/// plant's.
pub fn start_values(
    config: &PlantConfig,
    faults: &[FaultSpec],
) -> Result<Vec<(&'static str, Vec<f64>)>, PutError> {
    let mut values = CellValues::new(&table::MODEL);
    put(config, faults, &mut values)?;
    Ok(values.parameters(&table::MODEL))
}

/// Sets the parameters to a configuration and faults. Parameters that these don't use keep their
/// values.
///
/// # Errors
/// As [`start_values`].
pub fn put(
    config: &PlantConfig,
    faults: &[FaultSpec],
    values: &mut CellValues,
) -> Result<(), PutError> {
    config::put(config, values)?;
    faults::put(faults, config.sample_period_ns, values)?;
    Ok(())
}

/// The plant with its faults.
#[derive(Clone, Debug)]
pub struct PlantFmu {
    plant: ComparedPlant,
    period_ns: u64,
    with_truth: bool,
    faults: Option<Faults>,
    /// Kept between steps: a copy of data that has just been written waits for the stores.
    epoch: Epoch,
}

/// Faults with their indices among the parameters.
#[derive(Clone, Debug)]
struct Faults {
    station: Station,
    places: Vec<usize>,
    ids: Vec<String>,
    /// True if the faults have begun an epoch.
    begun: bool,
    /// Manual triggers that were on at the last step, by index.
    hands: [bool; FAULT_SLOTS],
}

/// The plant as the station's world.
struct Behind<'a>(&'a mut ComparedPlant);

impl World for Behind<'_> {
    fn disturbed(&mut self) -> Option<&mut dyn Disturbed> {
        Some(self.0)
    }

    fn truth(&self) -> Option<Truth> {
        Some(self.0.plant().truth())
    }
}

/// Output in place of a core's: triggers that depend on a core are not among the parameters.
const NO_OUTPUT: &Output = &Output {
    sequence: 0,
    device_time: octant_sample::DeviceTime::from_ns(0),
    mode: octant_sample::Mode::Aligning,
    stop: 0,
    moving: false,
    gimbal_command: GimbalCommand { target: GimbalAngles { azimuth: 0, roll: 0 } },
    navigation: octant_sample::Navigation {
        latitude_rad: 0.0,
        longitude_rad: 0.0,
        height_m: 0.0,
        velocity_mps: [0.0; 3],
        q_nb: [0.0; 4],
    },
    health: octant_sample::Health::empty(),
    nis: 0.0,
    parameters_revision: 0,
};

impl Faults {
    fn of(values: &CellValues, config: &PlantConfig) -> Result<Option<Self>, FaultError> {
        let made = faults::station(values, config)?;
        Ok(made.map(|(station, places)| Self {
            ids: station.ids().map(str::to_owned).collect(),
            station,
            places,
            begun: false,
            hands: [false; FAULT_SLOTS],
        }))
    }

    /// Begins and ends faults by hand.
    fn hands(&mut self, values: &CellValues) {
        for (place, id) in self.places.iter().zip(&self.ids) {
            let is_on = values.boolean(slot::FAULT_FIRE + place);
            if is_on == self.hands[*place] {
                continue;
            }
            self.hands[*place] = is_on;
            let base = place * slot::FAULT_STRIDE;
            if !values.boolean(slot::FAULT_BY_HAND + base) {
                continue;
            }
            if is_on {
                self.station.fire(id);
            } else if values.real(slot::FAULT_DURATION + base) == 0.0 {
                self.station.end(id);
            }
        }
    }
}

impl PlantFmu {
    /// Makes a step with faults: the last epoch gets its set point, which is known only now, then
    /// the next one begins.
    #[inline(never)]
    fn step_faulted(
        plant: &mut ComparedPlant,
        faults: &mut Faults,
        command: &mut GimbalCommand,
        epoch: &mut Epoch,
        values: &mut CellValues,
    ) {
        // The caller has reported the events by now.
        faults.station.told();
        if faults.begun {
            faults.station.command(command, NO_OUTPUT);
        }
        plant.command(command);
        faults.hands(values);
        faults.station.begin(NO_OUTPUT, &mut Behind(plant));
        faults.begun = true;
        plant.sample_into(&mut epoch.sample, &mut epoch.aiding);
        match faults.station.after(epoch, NO_OUTPUT, &mut Behind(plant)).delivered {
            Delivered::Untouched => outputs::put(epoch, values),
            // At most one: initialization has checked that.
            Delivered::These([one, ..]) => outputs::put(one, values),
            Delivered::These([]) => outputs::put_none(values),
        }
        outputs::put_receipts(&faults.station, &faults.places, values);
    }

    fn put_truth(&self, values: &mut CellValues) {
        outputs::put_truth(&self.plant.plant().truth(), values);
    }
}

impl ModelComponent for PlantFmu {
    const MODEL: &'static Model = &table::MODEL;

    type Error = PlantFailure;

    fn initialize(values: &mut CellValues) -> Result<Self, PlantFailure> {
        let config = config(values)?;
        let plant = ComparedPlant::new(&config)?;
        let this = Self {
            plant,
            period_ns: config.sample_period_ns,
            with_truth: values.boolean(slot::TRUTH_ENABLED),
            faults: Faults::of(values, &config)?,
            epoch: Epoch::default(),
        };
        // Before the first sample there is no measurement, and truth is that of the start.
        outputs::put(&this.epoch, values);
        outputs::put_none(values);
        this.put_truth(values);
        for place in 0..FAULT_SLOTS {
            let base = place * slot::RECEIPT_STRIDE;
            values.set_boolean(slot::FAULT_ARMED + base, false);
            values.set_boolean(slot::FAULT_ACTIVE + base, false);
            values.set_boolean(slot::FAULT_FIRED + base, false);
            values.set_count(slot::FAULT_ALTERED + base, 0);
        }
        if let Some(faults) = &this.faults {
            outputs::put_receipts(&faults.station, &faults.places, values);
        }
        Ok(this)
    }

    fn period_ns(&self) -> u64 {
        self.period_ns
    }

    fn tune(&mut self, values: &CellValues) -> Result<(), PlantFailure> {
        let config = config(values)?;
        // Kinds of faults that are multiples of the noise are those of the new noise.
        let station = match &self.faults {
            Some(faults) if setup(&config) != setup(self.plant.plant().config()) => {
                let mut bytes = Vec::new();
                faults.station.save(&mut bytes);
                let specs: Vec<FaultSpec> =
                    self::faults(values)?.into_iter().map(|(_, spec)| spec).collect();
                Some(Station::load(&specs, &setup(&config), &bytes)?)
            }
            _ => None,
        };
        self.plant.tune(&config)?;
        if let (Some(faults), Some(station)) = (&mut self.faults, station) {
            faults.station = station;
        }
        self.with_truth = values.boolean(slot::TRUTH_ENABLED);
        Ok(())
    }

    #[inline]
    fn step(&mut self, values: &mut CellValues) -> Result<(), PlantFailure> {
        let target = GimbalAngles::from_rad(
            values.real(slot::COMMAND_AZIMUTH),
            values.real(slot::COMMAND_ROLL),
        );
        let mut command = GimbalCommand { target };
        if let Some(faults) = &mut self.faults {
            Self::step_faulted(&mut self.plant, faults, &mut command, &mut self.epoch, values);
        } else {
            self.plant.command(&command);
            self.plant.sample_into(&mut self.epoch.sample, &mut self.epoch.aiding);
            outputs::put(&self.epoch, values);
        }
        if self.with_truth {
            self.put_truth(values);
        }
        Ok(())
    }

    fn step_further(&mut self, values: &mut CellValues) -> Result<(), PlantFailure> {
        let before = outputs::Gathered::of(values);
        self.step(values)?;
        before.add_to(values, self.period_ns);
        Ok(())
    }

    fn remark(&mut self) -> Option<String> {
        let faults = self.faults.as_mut()?;
        let occurrences = faults.station.occurrences();
        if occurrences.is_empty() {
            return None;
        }
        let one = |occurrence: &octant_faults::station::Occurrence| {
            let (id, kind) = faults.station.names().nth(occurrence.fault).unwrap_or_default();
            let what = if occurrence.begins { "sets in" } else { "has ended" };
            format!("{id} ({kind}) {what} at sample {}", occurrence.epoch)
        };
        let all: Vec<_> = occurrences.iter().map(one).collect();
        faults.station.told();
        Some(all.join("; "))
    }

    fn save(&self, bytes: &mut Vec<u8>) {
        let mut plant = Vec::new();
        self.plant.save(&mut plant);
        let mut station = Vec::new();
        if let Some(faults) = &self.faults {
            faults.station.save(&mut station);
        }
        FORMAT.write(bytes, |to| {
            to.value("plant", &plant);
            to.value("station", &station);
            let faults = self.faults.as_ref();
            to.value("begun", &faults.is_some_and(|faults| faults.begun));
            to.value("hands", &faults.map_or([false; FAULT_SLOTS], |faults| faults.hands));
        });
    }

    fn load(bytes: &[u8], values: &CellValues) -> Result<Self, PlantFailure> {
        Ok(Self::read(bytes, values)?)
    }
}

/// Format of the bytes of a Plant.
const FORMAT: StateFormat =
    StateFormat { magic: "OCTPLANT", version: 1, what: "the state of a Plant" };

impl PlantFmu {
    fn read(bytes: &[u8], values: &CellValues) -> Result<Self, StateError> {
        let mut from = FORMAT.read(bytes)?;
        let plant: Vec<u8> = from.value("plant")?;
        let station: Vec<u8> = from.value("station")?;
        let begun = from.value("begun")?;
        let hands = from.value("hands")?;
        from.end()?;
        let plant = ComparedPlant::load(&plant)?;
        let wrong = |problem: String| StateError::value("values", problem);
        let unfit = |error: FaultError| wrong(error.to_string());
        let config = config(values).map_err(|error| wrong(error.to_string()))?;
        if config != *plant.plant().config() {
            return Err(wrong("the parameters are not those that the plant was made from".into()));
        }
        let mut faults = Faults::of(values, &config).map_err(unfit)?;
        if let Some(faults) = &mut faults {
            let found = self::faults(values).map_err(unfit)?;
            let specs: Vec<FaultSpec> = found.into_iter().map(|(_, spec)| spec).collect();
            faults.station = Station::load(&specs, &setup(&config), &station)?;
            (faults.begun, faults.hands) = (begun, hands);
        } else if !station.is_empty() {
            return Err(wrong("there are no faults, and the plant had some".into()));
        }
        Ok(Self {
            period_ns: config.sample_period_ns,
            with_truth: values.boolean(slot::TRUTH_ENABLED),
            plant,
            faults,
            epoch: Epoch::default(),
        })
    }
}
