//! Motion of the case: angular rate and specific force in the case frame c.
//!
//! On the ship the position is *defined* by the sums of sinusoids, as latitude, longitude and
//! height; velocity over ground and its derivative follow from it on the ellipsoid without
//! approximation, and so do transport rate, Coriolis and curvature terms:
//! `f = C_cn (v̇ + (2 ω_ie + ω_en) × v − g)` (Titterton and Weston, 2004, sec. 3.5).

use crate::config::{self, CaseAttitude, Dockside, Site};
use crate::course::Course;
use crate::disturbed::Motion;
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

impl octant_state::State for Case {
    fn save(&self, to: &mut octant_state::Writer) {
        let Self { kind, accelerations: _ } = self;
        match kind {
            Kind::Static { motion: _, site: _, attitude: _, adrift } => {
                to.value("is adrift", &adrift.is_some());
                if let Some(ship) = adrift {
                    to.part("adrift", ship);
                }
            }
            Kind::Ship(ship) => to.part("ship", ship),
        }
    }

    fn load(
        &mut self,
        from: &mut octant_state::Reader<'_>,
    ) -> Result<(), octant_state::StateError> {
        match &mut self.kind {
            Kind::Static { site, attitude, adrift, .. } => {
                *adrift = None;
                if from.value("is adrift")? {
                    let ship = adrift.insert(Box::new(Ship::at_rest(*site, *attitude)));
                    from.part("adrift", ship)?;
                }
                Ok(())
            }
            Kind::Ship(ship) => from.part("ship", ship),
        }
    }
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
    /// Inverse of R_M + h and of (R_N + h) cos L of the dock: metres to latitude and longitude.
    per_north_m: f64,
    per_east_m: f64,
    /// Whether anything asks for the angular acceleration.
    accelerations: bool,
    latitude: Near,
    heading: Near,
    pitch: Near,
    roll: Near,
    sway: Sway,
}

octant_state::state! {
    Ship {
        values: accelerations, latitude, heading, pitch, roll;
        parts: sway;
        kept: site, mean, heading_sincos, mooring_offset_m, per_north_m, per_east_m
    }
}

#[derive(Clone, Debug)]
enum Kind {
    Static {
        motion: CaseMotion,
        site: Site,
        attitude: CaseAttitude,
        /// What it is while a fault moves it.
        adrift: Option<Box<Ship>>,
    },
    Ship(Box<Ship>),
}

#[derive(Clone, Debug)]
pub(crate) struct Case {
    kind: Kind,
    /// Whether angular acceleration is wanted without disturbances too.
    accelerations: bool,
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
    /// `nodes_s`: the regular nodes, s from the start of an interval. `accelerations`: whether
    /// the angular acceleration of [`CaseMotion`] is wanted, otherwise it is zero.
    pub(crate) fn new(
        motion: &config::Motion,
        site: Site,
        period_s: f64,
        nodes_s: &[f64],
        accelerations: bool,
    ) -> Self {
        let earth = Ellipsoid::at(site.latitude_rad, site.height_m);
        let kind = match motion {
            config::Motion::Static(attitude) => {
                let heading = libm::sincos(attitude.heading_rad);
                let pitch = libm::sincos(attitude.pitch_rad);
                let roll = libm::sincos(attitude.roll_rad);
                let up = Vector3::new(0.0, 0.0, -earth.gravity_mps2);
                let motion = CaseMotion {
                    rate: into_case(&earth.earth_rate(), heading, pitch, roll),
                    acceleration: Vector3::zeros(),
                    force: into_case(&up, heading, pitch, roll),
                };
                Kind::Static { motion, site, attitude: *attitude, adrift: None }
            }
            config::Motion::Dockside(dockside) => {
                let ship = Ship::new(dockside, site, &earth, period_s, nodes_s, accelerations);
                Kind::Ship(Box::new(ship))
            }
        };
        Self { kind, accelerations }
    }

    /// A disturbance is under way: angular acceleration is wanted, and where it `moves` the case,
    /// a case at rest has to be able to.
    pub(crate) fn disturbed(&mut self, moves: bool) {
        match &mut self.kind {
            Kind::Static { adrift: Some(_), .. } if moves => {}
            Kind::Static { site, attitude, adrift, .. } => {
                *adrift = moves.then(|| Box::new(Ship::at_rest(*site, *attitude)));
            }
            Kind::Ship(ship) => ship.accelerations = true,
        }
    }

    /// None is any more.
    pub(crate) fn undisturbed(&mut self) {
        match &mut self.kind {
            Kind::Static { adrift, .. } => *adrift = None,
            Kind::Ship(ship) => ship.accelerations = self.accelerations,
        }
    }

    /// Motion under disturbances, with a displacement where there is one.
    #[inline(never)]
    pub(crate) fn displaced(&mut self, time_s: f64, motion: Option<&Motion>) -> CaseMotion {
        match &mut self.kind {
            Kind::Ship(ship) | Kind::Static { adrift: Some(ship), .. } => {
                // A case adrift has no sway of its own: that is zero.
                let six = ship.sway.at_time(time_s);
                ship.motion::<true>(&motion.map_or(six, |motion| with(six, motion)))
            }
            Kind::Static { motion, .. } => *motion,
        }
    }

    /// Whereabouts with a displacement.
    pub(crate) fn whereabouts_displaced(&self, time_s: f64, motion: &Motion) -> Whereabouts {
        match &self.kind {
            Kind::Ship(ship) => ship.whereabouts(&with(ship.sway.at_time(time_s), motion)),
            Kind::Static { adrift: Some(ship), .. } => {
                ship.whereabouts(&with(SixDof::default(), motion))
            }
            Kind::Static { .. } => self.whereabouts(time_s),
        }
    }

    /// A motion from outside, beside the sway; false: the case is fixed to the ground.
    pub(crate) fn follow(&mut self, course: &Course) -> bool {
        match &mut self.kind {
            Kind::Static { .. } => false,
            Kind::Ship(ship) => {
                match &mut ship.sway.course {
                    Some(present) => **present = *course,
                    none => *none = Some(Box::new(*course)),
                }
                true
            }
        }
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
            Kind::Ship(ship) if ship.sway.course.is_some() => ship.motion_on_course(node),
            Kind::Ship(ship) => {
                let six = match node {
                    Node::Regular(index) => ship.sway.at_node(index),
                    Node::Offset(offset_s) => ship.sway.at_offset(offset_s),
                };
                ship.motion::<false>(&six)
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

/// A motion in six degrees of freedom with a displacement added.
fn with(mut six: SixDof, motion: &Motion) -> SixDof {
    for axis in 0..3 {
        for (dof, jet) in [(axis, &motion.turn), (3 + axis, &motion.displacement)] {
            six[dof].value += jet[0][axis];
            six[dof].rate += jet[1][axis];
            six[dof].acceleration += jet[2][axis];
        }
    }
    six
}

impl Ship {
    /// A case at rest that can be moved.
    fn at_rest(site: Site, mean: CaseAttitude) -> Self {
        let earth = Ellipsoid::at(site.latitude_rad, site.height_m);
        let calm = Dockside {
            mean,
            roll: Vec::new(),
            pitch: Vec::new(),
            yaw: Vec::new(),
            surge: Vec::new(),
            sway: Vec::new(),
            heave: Vec::new(),
            mooring_offset_m: [0.0; 3],
        };
        Self::new(&calm, site, &earth, 1.0, &[], true)
    }

    fn new(
        dockside: &Dockside,
        site: Site,
        earth: &Ellipsoid,
        period_s: f64,
        nodes_s: &[f64],
        accelerations: bool,
    ) -> Self {
        let mean = dockside.mean;
        Self {
            site,
            mean,
            heading_sincos: libm::sincos(mean.heading_rad),
            mooring_offset_m: dockside.mooring_offset_m,
            per_north_m: 1.0 / earth.meridian_radius_m,
            per_east_m: 1.0 / (earth.transverse_radius_m * earth.cos_latitude),
            accelerations,
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
            self.site.latitude_rad + (offset_north + north) * self.per_north_m,
            self.site.height_m - offset_down - six[5].value,
        )
    }

    /// Motion at a node, with what comes from outside. Out of the way of a ship that has none of it.
    #[inline(never)]
    fn motion_on_course(&mut self, node: Node) -> CaseMotion {
        let six = match node {
            Node::Regular(index) => self.sway.at_node_on_course(index),
            Node::Offset(offset_s) => self.sway.at_offset_on_course(offset_s),
        };
        self.motion::<true>(&six)
    }

    /// `DISTURBED` changes nothing: it makes a copy of its own for who is disturbed, so that the
    /// other one is inlined where every sample passes.
    #[inline]
    fn motion<const DISTURBED: bool>(&mut self, six: &SixDof) -> CaseMotion {
        let (latitude, height) = self.latitude_and_height(six);
        let (sin_latitude, cos_latitude) = self.latitude.sincos(latitude);
        let w = 1.0 / (1.0 - ECCENTRICITY_SQUARED * sin_latitude * sin_latitude);
        let transverse = SEMI_MAJOR_AXIS_M * libm::sqrt(w);
        let meridian = transverse * (1.0 - ECCENTRICITY_SQUARED) * w;
        let earth = Ellipsoid {
            sin_latitude,
            cos_latitude,
            meridian_radius_m: meridian + height,
            transverse_radius_m: transverse + height,
            gravity_mps2: normal_gravity_mps2(sin_latitude, height),
        };

        let (north_rate, east_rate) = self.north_east(six[3].rate, six[4].rate);
        let (north_acc, east_acc) = self.north_east(six[3].acceleration, six[4].acceleration);
        let (per_north, per_east) = (self.per_north_m, self.per_east_m);
        let (latitude_rate, longitude_rate) = (north_rate * per_north, east_rate * per_east);
        let (latitude_acc, longitude_acc) = (north_acc * per_north, east_acc * per_east);
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
            3.0 * meridian * ECCENTRICITY_SQUARED * sin_latitude * cos_latitude * w;
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
        // Euler rates (heading, pitch, roll) to body rates, one rotation after the other.
        let x = Vector3::x();
        let y = Vector3::y();
        let yaw = Vector3::new(0.0, 0.0, six[2].rate);
        let after_pitch = ry_t(&yaw, pitch);
        let rate_1 = after_pitch + y * six[1].rate;
        let after_roll = rx_t(&rate_1, roll);
        let case_rate = after_roll + x * six[0].rate;
        let mut angular = Vector3::zeros();
        if self.accelerations {
            let yaw = Vector3::new(0.0, 0.0, six[2].acceleration);
            let turned =
                ry_t(&yaw, pitch) - y.cross(&after_pitch) * six[1].rate + y * six[1].acceleration;
            let of_case =
                rx_t(&turned, roll) - x.cross(&after_roll) * six[0].rate + x * six[0].acceleration;
            let transport = into_case(&earth.transport_rate(&acceleration), heading, pitch, roll);
            angular = transport - case_rate.cross(&navigation_rate) + of_case;
        }

        CaseMotion {
            rate: navigation_rate + case_rate,
            acceleration: angular,
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
                + (self.mooring_offset_m[1] + east) * self.per_east_m,
            height_m,
            velocity_mps: Vector3::new(
                (meridian_radius_m(sin_latitude) + height_m) * north_rate * self.per_north_m,
                (transverse_radius_m(sin_latitude) + height_m)
                    * cos_latitude
                    * east_rate
                    * self.per_east_m,
                six[5].rate,
            ),
            heading_rad: self.mean.heading_rad + six[2].value,
            pitch_rad: self.mean.pitch_rad + six[1].value,
            roll_rad: self.mean.roll_rad + six[0].value,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The two derivatives that are written out by hand, against central differences: the angular
    /// acceleration, and the velocity that the position implies.
    #[test]
    fn derivatives_agree_with_differences() {
        let mut ship = crate::motion::dockside_default(9);
        ship.mean = CaseAttitude { heading_rad: 0.6, pitch_rad: 0.1, roll_rad: -0.2 };
        let site = Site { latitude_rad: 0.9, longitude_rad: 0.2, height_m: 10.0 };
        let (period_s, h) = (0.1, 1e-3);
        let mut case = Case::new(&config::Motion::Dockside(ship), site, period_s, &[0.05], true);
        for k in 0..200 {
            let start_s = f64::from(k) * period_s;
            case.enter(start_s);
            let now = case.motion(Node::Regular(0));
            let (a, b) = (0.05 - h, 0.05 + h);
            let (before, after) = (case.motion(Node::Offset(a)), case.motion(Node::Offset(b)));
            let slope = (after.rate - before.rate) / (2.0 * h);
            // h²/6 of the third derivative, 0.05 rad (2π/6 s)⁴: 1e-8.
            assert!((slope - now.acceleration).norm() < 3e-8, "{slope} {}", now.acceleration);

            let here = case.whereabouts(start_s + 0.05);
            let (p, q) = (case.whereabouts(start_s + a), case.whereabouts(start_s + b));
            let (sin, cos) = libm::sincos(here.latitude_rad);
            let north = (meridian_radius_m(sin) + here.height_m)
                * (q.latitude_rad - p.latitude_rad)
                / (2.0 * h);
            let east = (transverse_radius_m(sin) + here.height_m)
                * cos
                * (q.longitude_rad - p.longitude_rad)
                / (2.0 * h);
            let down = -(q.height_m - p.height_m) / (2.0 * h);
            // h²/6 · 0.2 m (2π/6 s)³: 4e-8, and the angles' last bit, 1e-16 rad over 2 ms: 7e-7.
            assert!((Vector3::new(north, east, down) - here.velocity_mps).norm() < 1.5e-6);
        }
    }
}
