//! What a core's filter did, measurement by measurement.

use super::backward::SmootherError;
use super::store::{Measured, Node, Row};
use crate::backward::{SmoothedCalibration, smooth};
use crate::store::Store;
use octant_calibration::Core;
use octant_calibration::config::{Calibration, CoreConfig, Estimator, Kalman, SwayNoise};
use octant_calibration::covariance::{Covariance, DR, DV, STATE_COUNT};
use octant_calibration::filter::prior_sigmas;
use octant_sample::{Aiding, InnovationOf, Sample};

/// Time within which two times are one, s: shorter than an aiding period.
const END_S: f64 = 1e-5;

/// History of a filter, taken from the core that holds it.
#[derive(Debug)]
pub struct FilterHistory {
    store: Store,
    prior: Row,
    variance: f64,
    duration_s: f64,
    node_every_s: f64,
    next_node_s: f64,
    used: u64,
    held: u64,
    begins_s: f64,
    ends_s: f64,
    /// Samples of an aiding period, and the core as it was before the last one of its calibration: with that sample both
    /// the filter and its last measurement are gone.
    period_samples: u64,
    before_end: Option<Box<Core>>,
}

fn filter_of(config: &CoreConfig) -> Result<(&Calibration, &Kalman), SmootherError> {
    let Some(calibration) = &config.calibration else {
        return Err(SmootherError::NoFilter { found: "none" });
    };
    let found = match &calibration.estimator {
        Estimator::Kalman(kalman) => return Ok((calibration, kalman)),
        Estimator::LeastSquares(_) => "least-squares",
        Estimator::ExternalTurntable(_) => "external-turntable",
    };
    Err(SmootherError::NoFilter { found })
}

impl FilterHistory {
    /// Makes an empty history for a core with this configuration, with `nodes` looks at the filter over the calibration.
    ///
    /// # Errors
    /// If the core has no filter of 39 states, or no file can be made.
    pub fn new(config: &CoreConfig, nodes: usize) -> Result<Self, SmootherError> {
        let (calibration, kalman) = filter_of(config)?;
        if kalman.further.rest.is_some() {
            return Err(SmootherError::OtherStates { found: "the attitude of a case at rest" });
        }
        if kalman.further.has_states() {
            return Err(SmootherError::OtherStates { found: "further states" });
        }
        if kalman.sway == SwayNoise::Coloured {
            return Err(SmootherError::OtherStates { found: "states of the base's sway" });
        }
        let sigma = match kalman.aiding {
            octant_calibration::config::AidingMode::Velocity { sigma_mps } => sigma_mps,
            octant_calibration::config::AidingMode::Position { sigma_m } => sigma_m,
        };
        Ok(Self {
            store: Store::new()?,
            prior: prior_sigmas(kalman),
            variance: sigma * sigma,
            duration_s: calibration.duration_s,
            node_every_s: calibration.duration_s / nodes.max(1) as f64,
            next_node_s: 0.0,
            used: 0,
            held: 0,
            begins_s: 0.0,
            ends_s: 0.0,
            period_samples: kalman.aiding_period_ns / config.sample_period_ns.max(1),
            before_end: None,
        })
    }

    /// Takes what the core's filter did in the step that the core has just made.
    ///
    /// # Errors
    /// If the file can't be written.
    pub fn watch(&mut self, core: &Core) -> Result<(), SmootherError> {
        let Some(filter) = core.filter() else { return Ok(()) };
        // A gap may take the last samples.
        if core.samples_to_end() <= self.period_samples {
            self.before_end = Some(Box::new(core.clone()));
        }
        let tally = filter.tally();
        if tally.used == self.used {
            return Ok(());
        }
        // A core that restarted counts anew.
        let restarted = tally.used < self.used;
        self.used = tally.used;
        let held = tally.held != self.held;
        self.held = tally.held;
        if held || restarted || filter.passage().is_broken() {
            // What came before a recovery tells nothing of attitude and velocity after it, and while the parameters are
            // held the gains aren't those of the covariance.
            self.store.clear()?;
            self.begins_s = filter.time_s();
            self.next_node_s = self.begins_s;
            if held {
                return Ok(());
            }
        }
        let innovation = core.innovation();
        let first = match innovation.of {
            InnovationOf::Velocity => DV,
            InnovationOf::Position => DR,
        };
        let covariance = filter.covariance();
        let time_s = filter.time_s();
        // At the end nothing follows that could tell more.
        let looked_at = time_s >= self.next_node_s && time_s < self.duration_s - END_S;
        let node = looked_at.then(|| {
            self.next_node_s += self.node_every_s
                * (1.0 + libm::floor((time_s - self.next_node_s) / self.node_every_s));
            Box::new(Node {
                covariance: rows(covariance),
                parameters: core.parameters().to_array(),
            })
        });
        let transition = &filter.passage().transition().rows;
        self.ends_s = time_s;
        self.store.push(&Measured {
            time_s,
            transition: core::array::from_fn(|i| row(&transition[i])),
            first,
            variance: self.variance,
            innovation: innovation.value,
            covariance: core::array::from_fn(|axis| row(&covariance.rows()[first + axis])),
            node,
        })?;
        Ok(())
    }

    /// Takes the last measurement, which comes with the sample that ended the calibration. Without it, where the stream ended
    /// before or the calibration was broken off, nothing changes.
    ///
    /// # Errors
    /// If the file can't be written.
    pub fn end(&mut self, sample: &Sample, aiding: Option<&Aiding>) -> Result<(), SmootherError> {
        let Some(mut core) = self.before_end.take() else { return Ok(()) };
        core.outlast();
        core.step(sample, aiding);
        self.watch(&core)
    }

    /// Prior standard deviations of all states.
    #[must_use]
    pub fn prior(&self) -> &Row {
        &self.prior
    }

    /// Number of measurements.
    #[must_use]
    pub fn len(&self) -> usize {
        self.store.len()
    }

    /// Returns whether there is no measurement.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.store.is_empty()
    }

    /// Start of the history, s of the filter's time: 0, or the end of the last recovery.
    #[must_use]
    pub fn begins_s(&self) -> f64 {
        self.begins_s
    }

    /// Time of the last measurement, s of the filter's time.
    #[must_use]
    pub fn ends_s(&self) -> f64 {
        self.ends_s
    }

    /// Smooths it.
    ///
    /// # Errors
    /// If it is too short, or can't be read.
    pub fn smooth(&mut self) -> Result<SmoothedCalibration, SmootherError> {
        smooth(&mut self.store)
    }
}

fn row(padded: &[f64]) -> Row {
    core::array::from_fn(|j| padded[j])
}

fn rows(covariance: &Covariance) -> [Row; STATE_COUNT] {
    core::array::from_fn(|i| row(&covariance.rows()[i]))
}
