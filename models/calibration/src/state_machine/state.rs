//! The core as bytes, and back.
//!
//! The bytes hold the configuration and the changes since the start. A core is made from the
//! configuration, as by [`Core::new`], and then loads the rest; [`octant_state`] lists the bytes
//! that are refused.

use super::estimation::Estimation;
use super::{Core, kalman_of};
use crate::config::CoreConfig;
use crate::further::{DRIVING_COUNT, FURTHER_COUNT, FurtherEstimates, TEMPERATURE_START};
use crate::schedule::Cursor;
use alloc::string::ToString;
use alloc::vec::Vec;
use octant_sample::GimbalAngles;
use octant_state::{State, StateError, StateFormat, StateReader, Writer, check_below, check_count};

extern crate alloc;

/// Format of the state of a core. Raise the version when the layout changes; a test compares the
/// layout with the stored one.
pub const FORMAT: StateFormat =
    StateFormat { magic: "OCTANTCC", version: 6, what: "the state of a calibration core" };

impl Core {
    /// Appends everything that the core needs to continue bit for bit after this step: the same
    /// core gives the same bytes.
    pub fn save(&self, bytes: &mut Vec<u8>) {
        FORMAT.write(bytes, |to| {
            to.value("config", &self.config);
            to.part("core", self);
        });
    }

    /// Makes a core that continues where another was when [`Self::save`] wrote these bytes.
    ///
    /// # Errors
    /// If the bytes are not those of a core of this version, whole and unaltered. Neither this
    /// function nor the resulting core panics, whatever the bytes.
    pub fn load(bytes: &[u8]) -> Result<Self, StateError> {
        let mut from = FORMAT.read(bytes)?;
        let config: CoreConfig = from.value("config")?;
        let mut core =
            Self::new(&config).map_err(|error| StateError::value("config", error.to_string()))?;
        from.part("core", &mut core)?;
        from.end()?;
        core.tell_rest();
        Ok(core)
    }

    /// Cursor of the calibration or, `endless`, of the navigation, at an arbitrary place.
    fn cursor_of(&self, endless: bool) -> Option<Cursor> {
        let home = GimbalAngles::default();
        let (rates, sample_s) = (self.config.turntable, self.sample_s);
        if endless {
            let plan = self.config.navigation.as_ref()?;
            let (rotation, dwell_s) = (plan.rotation.clone(), plan.dwell_s);
            return Some(Cursor::new(rotation, home, rates, dwell_s, sample_s, true));
        }
        let calibration = self.config.calibration.as_ref()?;
        let dwell_s =
            crate::schedule::dwell_s(&calibration.sequence, calibration.duration_s, &rates).ok()?;
        Some(Cursor::new(calibration.sequence.clone(), home, rates, dwell_s, sample_s, false))
    }
}

/// Estimates of a range of the further states, as they are stored.
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(bound(
    serialize = "[f64; N]: serde::Serialize",
    deserialize = "[f64; N]: serde::Deserialize<'de>"
))]
struct Estimates<const N: usize> {
    value: [f64; N],
    sigma: [f64; N],
}

impl<const N: usize> Estimates<N> {
    /// Those from this place on.
    fn of(estimates: &FurtherEstimates, start: usize) -> Self {
        Self {
            value: core::array::from_fn(|k| estimates.value[start + k]),
            sigma: core::array::from_fn(|k| estimates.sigma[start + k]),
        }
    }

    fn put(&self, estimates: &mut FurtherEstimates, start: usize) {
        estimates.value[start..start + N].copy_from_slice(&self.value);
        estimates.sigma[start..start + N].copy_from_slice(&self.sigma);
    }
}

/// Estimates that are always there.
type Always = Estimates<TEMPERATURE_START>;
/// Estimates of the errors that follow the temperature.
type OfTemperature = Estimates<{ DRIVING_COUNT - TEMPERATURE_START }>;
/// Estimates of the errors of the gimbals.
type OfGimbals = Estimates<{ FURTHER_COUNT - DRIVING_COUNT }>;

/// Returns whether errors follow the temperature.
fn follows_temperature(config: &CoreConfig) -> bool {
    kalman_of(config).is_some_and(|kalman| kalman.further.follows_temperature())
}

/// Returns whether gimbal angles are measurements.
fn has_angles(config: &CoreConfig) -> bool {
    kalman_of(config).is_some_and(|kalman| kalman.further.angles.is_some())
}

/// Error for a part that exists only in other configurations.
fn unexpected(field: &'static str) -> StateError {
    StateError::value(field, "it is there, and by the configuration it can't be")
}

impl State for Core {
    fn save(&self, to: &mut Writer) {
        let Self {
            config,
            sample_s: _,
            calibration_ticks: _,
            navigation_ticks: _,
            settle_ticks: _,
            tick,
            phase_start,
            mode,
            cursor,
            monitor,
            screen,
            bridge,
            slips,
            continuity,
            block_tick,
            block_ticks: _,
            unrepaired,
            disturbed_tick,
            disturbance,
            recent,
            alignment,
            estimation,
            standstill,
            parameters,
            sigma,
            revision,
            compensation,
            further,
            strapdown,
            last_measured_tick,
            due_tick,
            nis_running,
            gimbal_disagreements,
            gimbal_tolerance: _,
            refusal,
            last_quality,
            table,
            concluded: _,
            expected_nis: _,
            innovation: _,
            gimbals,
            answered,
        } = self;
        to.value("tick", tick);
        to.value("phase_start", phase_start);
        to.value("mode", mode);
        to.value("cursor is endless", &cursor.as_ref().map(Cursor::is_endless));
        if let Some(cursor) = cursor {
            to.part("cursor", cursor);
        }
        to.part("monitor", monitor);
        to.part("screen", screen);
        to.value("bridge", bridge);
        to.value("slips", slips);
        to.part("continuity", continuity);
        to.value("block_tick", block_tick);
        to.value("unrepaired", unrepaired);
        to.value("disturbed_tick", disturbed_tick);
        to.value("disturbance", disturbance);
        to.value("recent", recent);
        to.value("aligns", &alignment.is_some());
        if let Some((alignment, _)) = alignment {
            to.part("alignment", alignment);
        }
        to.value("estimates", &!matches!(estimation, Estimation::Idle));
        to.part("estimation", estimation);
        to.value("standstill", standstill);
        to.value("parameters", parameters);
        to.value("sigma", sigma);
        to.value("revision", revision);
        to.value("compensation", compensation);
        to.value("strapdown", strapdown);
        to.value("last_measured_tick", last_measured_tick);
        to.value("due_tick", due_tick);
        to.value("nis_running", nis_running);
        to.value("gimbal_disagreements", gimbal_disagreements);
        to.value("refusal", refusal);
        to.value("last_quality", last_quality);
        to.value("table", table);
        to.value("gimbals", gimbals);
        to.value("answered", answered);
        // Last, and nothing without further states: then the bytes are those of a core that never
        // had any.
        if let Some((estimates, compensation)) = further {
            to.value("further", &Always::of(estimates, 0));
            to.part("further compensation", compensation);
            if follows_temperature(config) {
                to.value("temperature", &OfTemperature::of(estimates, TEMPERATURE_START));
            }
            if has_angles(config) {
                to.value("gimbals", &OfGimbals::of(estimates, DRIVING_COUNT));
            }
        }
    }

    fn load(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        self.tick = from.value("tick")?;
        self.phase_start = from.value("phase_start")?;
        check_count("tick", self.tick)?;
        check_below("phase_start", self.phase_start, self.tick)?;
        self.mode = from.value("mode")?;
        self.cursor = match from.value("cursor is endless")? {
            None => None,
            Some(endless) => {
                let mut cursor = self.cursor_of(endless).ok_or_else(|| unexpected("cursor"))?;
                from.part("cursor", &mut cursor)?;
                Some(cursor)
            }
        };
        from.part("monitor", &mut self.monitor)?;
        from.part("screen", &mut self.screen)?;
        self.bridge = from.value("bridge")?;
        self.slips = from.value("slips")?;
        from.part("continuity", &mut self.continuity)?;
        self.block_tick = from.value("block_tick")?;
        self.unrepaired = from.value("unrepaired")?;
        self.disturbed_tick = from.value("disturbed_tick")?;
        check_below("disturbed_tick", self.disturbed_tick, self.tick)?;
        self.disturbance = from.value("disturbance")?;
        self.recent = from.value("recent")?;
        if from.value("aligns")? {
            let (alignment, _) = self.alignment.as_mut().ok_or_else(|| unexpected("alignment"))?;
            from.part("alignment", alignment)?;
        } else {
            self.alignment = None;
        }
        if !from.value("estimates")? {
            self.estimation = Estimation::Idle;
        } else if matches!(self.estimation, Estimation::Idle) {
            return Err(unexpected("estimation"));
        }
        from.part("estimation", &mut self.estimation)?;
        self.standstill = from.value("standstill")?;
        self.parameters = from.value("parameters")?;
        self.sigma = from.value("sigma")?;
        self.revision = from.value("revision")?;
        self.compensation = from.value("compensation")?;
        self.strapdown = from.value("strapdown")?;
        self.last_measured_tick = from.value("last_measured_tick")?;
        check_below("last_measured_tick", self.last_measured_tick, self.tick)?;
        self.due_tick = from.value("due_tick")?;
        self.nis_running = from.value("nis_running")?;
        self.gimbal_disagreements = from.value("gimbal_disagreements")?;
        self.refusal = from.value("refusal")?;
        self.last_quality = from.value("last_quality")?;
        self.table = from.value("table")?;
        self.gimbals = from.value("gimbals")?;
        self.answered = from.value("answered")?;
        if let Some((estimates, compensation)) = &mut self.further {
            from.value::<Always>("further")?.put(estimates, 0);
            from.part("further compensation", compensation)?;
            if follows_temperature(&self.config) {
                from.value::<OfTemperature>("temperature")?.put(estimates, TEMPERATURE_START);
            }
            if has_angles(&self.config) {
                from.value::<OfGimbals>("gimbals")?.put(estimates, DRIVING_COUNT);
            }
        }
        Ok(())
    }
}

impl State for Estimation {
    fn save(&self, to: &mut Writer) {
        match self {
            Self::Idle => {}
            Self::Kalman(filter) => {
                to.part("filter", filter);
                if let Some(further) = filter.further_part() {
                    to.part("further states", further);
                }
                if let Some(known) = filter.known_motion_part() {
                    to.part("known motion", known);
                }
            }
            Self::LeastSquares(estimator) => to.part("least squares", estimator),
            Self::ExternalTurntable(estimator) => to.part("external turntable", estimator),
        }
    }

    fn load(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        match self {
            Self::Idle => Ok(()),
            Self::Kalman(filter) => {
                from.part("filter", filter)?;
                if let Some(further) = filter.further_part_mut() {
                    from.part("further states", further)?;
                }
                match filter.known_motion_part_mut() {
                    Some(known) => from.part("known motion", known),
                    None => Ok(()),
                }
            }
            Self::LeastSquares(estimator) => from.part("least squares", estimator),
            Self::ExternalTurntable(estimator) => from.part("external turntable", estimator),
        }
    }
}
