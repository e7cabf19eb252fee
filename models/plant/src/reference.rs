//! Reference of a calibration, which aids the core.

use crate::config::{AidingKind, PlantConfig, PlantSite};
use crate::kinematics::Whereabouts;
use octant_earth::ellipsoid::Ellipsoid;
use octant_random::stream::Triad;
use octant_sample::{Aiding, DeviceTime, Reference};

#[derive(Clone, Debug)]
pub(crate) struct Aider {
    kind: AidingKind,
    period_samples: u64,
    site: PlantSite,
    north_m: f64,
    east_m: f64,
    noise: Triad,
}

impl Aider {
    pub(crate) fn new(config: &PlantConfig) -> Self {
        let earth = Ellipsoid::at(config.site.latitude_rad, config.site.height_m);
        Self {
            kind: config.aiding.kind,
            period_samples: config.aiding.period_ns / config.sample_period_ns,
            site: config.site,
            north_m: earth.meridian_radius_m,
            east_m: earth.transverse_radius_m * earth.cos_latitude,
            noise: Triad::new(config.seed, "aiding.noise"),
        }
    }

    /// Changes the noise: the kind is that of before.
    pub(crate) fn tune(&mut self, kind: AidingKind) {
        self.kind = kind;
    }

    pub(crate) fn period_samples(&self) -> u64 {
        self.period_samples
    }

    /// Makes the message at a stamp; `sample` is the number of the sample in the phase, from 0.
    pub(crate) fn measure(
        &self,
        device_time: DeviceTime,
        sample: u64,
        whereabouts: impl FnOnce() -> Whereabouts,
    ) -> Aiding {
        let noise = self.noise.at(sample);
        let reference = match self.kind {
            AidingKind::ZeroVelocity { sigma_mps } => {
                Reference::Velocity(noise.map(|n| sigma_mps * n))
            }
            AidingKind::Velocity { sigma_mps } => {
                let truth = whereabouts().velocity_mps;
                let mut velocity = noise.map(|n| sigma_mps * n);
                for (axis, value) in velocity.iter_mut().enumerate() {
                    *value += truth[axis];
                }
                Reference::Velocity(velocity)
            }
            AidingKind::DockPosition { sigma_m } => Reference::Position {
                latitude_rad: self.site.latitude_rad + sigma_m * noise[0] / self.north_m,
                longitude_rad: self.site.longitude_rad + sigma_m * noise[1] / self.east_m,
                height_m: self.site.height_m - sigma_m * noise[2],
            },
        };
        Aiding { device_time, reference }
    }
}
