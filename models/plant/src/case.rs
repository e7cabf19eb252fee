//! Motion of the case: angular rate and specific force in the case frame c.
//!
//! On the ship the position is *defined* by the sums of sinusoids, as latitude, longitude and
//! height; velocity over ground and its derivative follow from it on the ellipsoid without
//! approximation, and so do transport rate, Coriolis and curvature terms:
//! `f = C_cn (v̇ + (2 ω_ie + ω_en) × v − g)` (Titterton and Weston, 2004, sec. 3.5).

use crate::config::{CaseAttitude, Dockside, Motion, Site};
use crate::sway::{SixDof, Sway};
use crate::trig::{Near, rx_t, ry_t, rz_t};
use nalgebra::Vector3;
use octant_earth::ellipsoid::{ECCENTRICITY_SQUARED, Ellipsoid, SEMI_MAJOR_AXIS_M};
use octant_earth::ellipsoid::{meridian_radius_m, normal_gravity_mps2, transverse_radius_m};

/// What the case feels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CaseMotion {
    /// ω_ic in c, rad/s.
    pub(crate) rate: Vector3<f64>,
    /// Its derivative in c, rad/s² (transport rate taken at constant latitude).
    pub(crate) acceleration: Vector3<f64>,
    /// Specific force in c, m/s².
    pub(crate) force: Vector3<f64>,
}

/// Where the case is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Whereabouts {
    pub(crate) latitude_rad: f64,
    pub(crate) longitude_rad: f64,
    pub(crate) height_m: f64,
    pub(crate) velocity_mps: Vector3<f64>,
    pub(crate) heading_rad: f64,
    pub(crate) pitch_rad: f64,
    pub(crate) roll_rad: f64,
}

/// The node of an interval at which motion is wanted.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Node {
    /// One of the regular nodes.
    Regular(usize),
    /// Seconds since the start of the interval.
    Offset(f64),
}

#[derive(Clone, Debug)]
struct Ship {
    site: Site,
    mean: CaseAttitude,
    heading_sincos: (f64, f64),
    mooring_offset_m: [f64; 3],
    /// Radii R_M + h and (R_N + h) cos L of the dock, that turn metres into latitude and longitude.
    north_m: f64,
    east_m: f64,
    latitude: Near,
    heading: Near,
    pitch: Near,
    roll: Near,
    sway: Sway,
}

#[derive(Clone, Debug)]
enum Kind {
    Static { motion: CaseMotion, site: Site, attitude: CaseAttitude },
    Ship(Box<Ship>),
}

#[derive(Clone, Debug)]
pub(crate) struct Case {
    kind: Kind,
}

fn into_case(
    v: &Vector3<f64>,
    heading: (f64, f64),
    pitch: (f64, f64),
    roll: (f64, f64),
) -> Vector3<f64> {
    rx_t(&ry_t(&rz_t(v, heading), pitch), roll)
}

impl Case {
    pub(crate) fn new(motion: &Motion, site: Site, period_s: f64, nodes_s: &[f64]) -> Self {
        let earth = Ellipsoid::at(site.latitude_rad, site.height_m);
        let kind = match motion {
            Motion::Static(attitude) => {
                let heading = libm::sincos(attitude.heading_rad);
                let pitch = libm::sincos(attitude.pitch_rad);
                let roll = libm::sincos(attitude.roll_rad);
                let up = Vector3::new(0.0, 0.0, -earth.gravity_mps2);
                let motion = CaseMotion {
                    rate: into_case(&earth.earth_rate(), heading, pitch, roll),
                    acceleration: Vector3::zeros(),
                    force: into_case(&up, heading, pitch, roll),
                };
                Kind::Static { motion, site, attitude: *attitude }
            }
            Motion::Dockside(dockside) => {
                Kind::Ship(Box::new(Ship::new(dockside, site, &earth, period_s, nodes_s)))
            }
        };
        Self { kind }
    }

    pub(crate) fn is_static(&self) -> bool {
        matches!(self.kind, Kind::Static { .. })
    }

    /// Goes to the interval that starts at `start_s`.
    #[inline]
    pub(crate) fn enter(&mut self, start_s: f64) {
        if let Kind::Ship(ship) = &mut self.kind {
            ship.sway.enter(start_s);
        }
    }

    #[inline]
    pub(crate) fn motion(&mut self, node: Node) -> CaseMotion {
        match &mut self.kind {
            Kind::Static { motion, .. } => *motion,
            Kind::Ship(ship) => {
                let six = match node {
                    Node::Regular(index) => ship.sway.at_node(index),
                    Node::Offset(offset_s) => ship.sway.at_offset(offset_s),
                };
                ship.motion(&six)
            }
        }
    }

    pub(crate) fn whereabouts(&self, time_s: f64) -> Whereabouts {
        match &self.kind {
            Kind::Static { site, attitude, .. } => Whereabouts {
                latitude_rad: site.latitude_rad,
                longitude_rad: site.longitude_rad,
                height_m: site.height_m,
                velocity_mps: Vector3::zeros(),
                heading_rad: attitude.heading_rad,
                pitch_rad: attitude.pitch_rad,
                roll_rad: attitude.roll_rad,
            },
            Kind::Ship(ship) => ship.whereabouts(&ship.sway.at_time(time_s)),
        }
    }
}

impl Ship {
    fn new(
        dockside: &Dockside,
        site: Site,
        earth: &Ellipsoid,
        period_s: f64,
        nodes_s: &[f64],
    ) -> Self {
        let mean = dockside.mean;
        Self {
            site,
            mean,
            heading_sincos: libm::sincos(mean.heading_rad),
            mooring_offset_m: dockside.mooring_offset_m,
            north_m: earth.meridian_radius_m,
            east_m: earth.transverse_radius_m * earth.cos_latitude,
            latitude: Near::new(site.latitude_rad),
            heading: Near::new(mean.heading_rad),
            pitch: Near::new(mean.pitch_rad),
            roll: Near::new(mean.roll_rad),
            sway: Sway::new(dockside, period_s, nodes_s),
        }
    }

    /// North and east of a pair along and to starboard of the mean heading.
    #[inline]
    fn north_east(&self, surge: f64, sway: f64) -> (f64, f64) {
        let (s, c) = self.heading_sincos;
        (c * surge - s * sway, s * surge + c * sway)
    }

    #[inline]
    fn latitude_and_height(&self, six: &SixDof) -> (f64, f64) {
        let (north, _) = self.north_east(six[3].value, six[4].value);
        let [offset_north, _, offset_down] = self.mooring_offset_m;
        (
            self.site.latitude_rad + (offset_north + north) / self.north_m,
            self.site.height_m - offset_down - six[5].value,
        )
    }

    #[inline]
    fn motion(&mut self, six: &SixDof) -> CaseMotion {
        let (latitude, height) = self.latitude_and_height(six);
        let (sin_latitude, cos_latitude) = self.latitude.sincos(latitude);
        let w2 = 1.0 - ECCENTRICITY_SQUARED * sin_latitude * sin_latitude;
        let transverse = SEMI_MAJOR_AXIS_M / libm::sqrt(w2);
        let meridian = transverse * (1.0 - ECCENTRICITY_SQUARED) / w2;
        let earth = Ellipsoid {
            sin_latitude,
            cos_latitude,
            meridian_radius_m: meridian + height,
            transverse_radius_m: transverse + height,
            gravity_mps2: normal_gravity_mps2(sin_latitude, height),
        };

        let (north_rate, east_rate) = self.north_east(six[3].rate, six[4].rate);
        let (north_acc, east_acc) = self.north_east(six[3].acceleration, six[4].acceleration);
        let (latitude_rate, longitude_rate) = (north_rate / self.north_m, east_rate / self.east_m);
        let (latitude_acc, longitude_acc) = (north_acc / self.north_m, east_acc / self.east_m);
        let height_rate = -six[5].rate;
        // d/dt of v = ((R_M + h) L̇, (R_N + h) cos L λ̇, −ḣ), with dR_M/dL and the identity
        // d(R_N cos L)/dL = −R_M sin L.
        let parallel = earth.transverse_radius_m * cos_latitude;
        let velocity = Vector3::new(
            earth.meridian_radius_m * latitude_rate,
            parallel * longitude_rate,
            six[5].rate,
        );
        let meridian_slope =
            3.0 * meridian * ECCENTRICITY_SQUARED * sin_latitude * cos_latitude / w2;
        let meridian_rate = meridian_slope * latitude_rate + height_rate;
        let parallel_rate =
            height_rate * cos_latitude - earth.meridian_radius_m * sin_latitude * latitude_rate;
        let acceleration = Vector3::new(
            earth.meridian_radius_m * latitude_acc + meridian_rate * latitude_rate,
            parallel * longitude_acc + parallel_rate * longitude_rate,
            six[5].acceleration,
        );

        let earth_rate = earth.earth_rate();
        let transport = earth.transport_rate(&velocity);
        let gravity = Vector3::new(0.0, 0.0, earth.gravity_mps2);
        let force = acceleration + (earth_rate * 2.0 + transport).cross(&velocity) - gravity;

        let heading = self.heading.sincos(self.mean.heading_rad + six[2].value);
        let pitch = self.pitch.sincos(self.mean.pitch_rad + six[1].value);
        let roll = self.roll.sincos(self.mean.roll_rad + six[0].value);
        let navigation_rate = into_case(&(earth_rate + transport), heading, pitch, roll);
        let navigation_acceleration =
            into_case(&earth.transport_rate(&acceleration), heading, pitch, roll);

        // Euler rates (heading, pitch, roll) to body rates, one rotation after the other.
        let x = Vector3::x();
        let y = Vector3::y();
        let yaw = Vector3::new(0.0, 0.0, six[2].rate);
        let yaw_acc = Vector3::new(0.0, 0.0, six[2].acceleration);
        let after_pitch = ry_t(&yaw, pitch);
        let rate_1 = after_pitch + y * six[1].rate;
        let acc_1 =
            ry_t(&yaw_acc, pitch) - y.cross(&after_pitch) * six[1].rate + y * six[1].acceleration;
        let after_roll = rx_t(&rate_1, roll);
        let case_rate = after_roll + x * six[0].rate;
        let case_acc =
            rx_t(&acc_1, roll) - x.cross(&after_roll) * six[0].rate + x * six[0].acceleration;

        CaseMotion {
            rate: navigation_rate + case_rate,
            acceleration: navigation_acceleration - case_rate.cross(&navigation_rate) + case_acc,
            force: into_case(&force, heading, pitch, roll),
        }
    }

    fn whereabouts(&self, six: &SixDof) -> Whereabouts {
        let (latitude_rad, height_m) = self.latitude_and_height(six);
        let (_, east) = self.north_east(six[3].value, six[4].value);
        let (north_rate, east_rate) = self.north_east(six[3].rate, six[4].rate);
        let (sin_latitude, cos_latitude) = libm::sincos(latitude_rad);
        Whereabouts {
            latitude_rad,
            longitude_rad: self.site.longitude_rad
                + (self.mooring_offset_m[1] + east) / self.east_m,
            height_m,
            velocity_mps: Vector3::new(
                (meridian_radius_m(sin_latitude) + height_m) * north_rate / self.north_m,
                (transverse_radius_m(sin_latitude) + height_m) * cos_latitude * east_rate
                    / self.east_m,
                six[5].rate,
            ),
            heading_rad: self.mean.heading_rad + six[2].value,
            pitch_rad: self.mean.pitch_rad + six[1].value,
            roll_rad: self.mean.roll_rad + six[0].value,
        }
    }
}
