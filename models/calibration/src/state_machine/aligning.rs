//! The alignment that runs.

use super::judgement::CalibrationRefusal;
use crate::alignment::CoarseAlignment;
use crate::config::{Alignment, Base, CoreConfig, Kalman};
use crate::inertial_alignment::{AlignmentSigma, InertialAlignment};
use nalgebra::{UnitQuaternion, Vector3};

/// An alignment of either kind.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "no_std without alloc: there is no box to put it in")]
pub(super) enum Aligning {
    Coarse(CoarseAlignment),
    Inertial(InertialAlignment),
}

impl Aligning {
    /// Makes the alignment of a configuration, with its duration, s; `None` where the attitude is
    /// given.
    pub(super) fn new(config: &CoreConfig) -> Option<(Self, f64)> {
        match config.alignment {
            Alignment::Given { .. } => None,
            Alignment::Coarse { duration_s } => {
                Some((Self::Coarse(CoarseAlignment::new(&config.site)), duration_s))
            }
            Alignment::Inertial { duration_s } => {
                Some((Self::Inertial(InertialAlignment::new(config, duration_s)), duration_s))
            }
        }
    }

    pub(super) fn step(&mut self, dtheta: &Vector3<f64>, dv: &Vector3<f64>, interval_s: f64) {
        match self {
            Self::Coarse(alignment) => alignment.step(dtheta, dv, interval_s),
            Self::Inertial(alignment) => alignment.step(dtheta, dv, interval_s),
        }
    }

    pub(super) fn finish(&self) -> Result<UnitQuaternion<f64>, CalibrationRefusal> {
        match self {
            Self::Coarse(alignment) => alignment.finish().ok_or(CalibrationRefusal::Alignment),
            Self::Inertial(alignment) => Ok(alignment.finish()?),
        }
    }
}

/// Prior of a filter: after an alignment in the inertial frame, its attitude is as uncertain as that
/// leaves it at least, and its velocity as the base may swing.
#[must_use]
pub fn prior_after_alignment(config: &CoreConfig, kalman: &Kalman) -> Kalman {
    let mut kalman = *kalman;
    if let Alignment::Inertial { duration_s } = config.alignment {
        let found = AlignmentSigma::of(config, duration_s).attitude_rad;
        for (prior, found) in kalman.prior.attitude_rad.iter_mut().zip(found) {
            *prior = prior.max(found);
        }
        // The core starts from rest, wherever in its swing the base is.
        if let Base::Moving(motion) = config.screening.base
            && motion.jerk_mps3 > 0.0
        {
            let swing_mps = motion.force_mps2 * motion.force_mps2 / motion.jerk_mps3;
            kalman.prior.velocity_mps = kalman.prior.velocity_mps.max(swing_mps);
        }
    }
    kalman
}

#[cfg(feature = "state")]
impl octant_state::State for Aligning {
    fn save(&self, to: &mut octant_state::Writer) {
        match self {
            Self::Coarse(alignment) => octant_state::State::save(alignment, to),
            Self::Inertial(alignment) => octant_state::State::save(alignment, to),
        }
    }

    fn load(
        &mut self,
        from: &mut octant_state::StateReader<'_>,
    ) -> Result<(), octant_state::StateError> {
        match self {
            Self::Coarse(alignment) => octant_state::State::load(alignment, from),
            Self::Inertial(alignment) => octant_state::State::load(alignment, from),
        }
    }
}
