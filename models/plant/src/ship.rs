//! A moored ship: sums of sinusoids in six degrees of freedom, and the resulting motion of the
//! case.
//!
//! The position is *defined* by the sums of sinusoids, as latitude, longitude and height; velocity
//! over ground and its derivative follow from it on the ellipsoid without approximation, and so do
//! transport rate, Coriolis and curvature terms:
//! `f = C_cn (v̇ + (2 ω_ie + ω_en) × v − g)` (Titterton and Weston, 2004, sec. 3.5).

use super::kinematics::SixDof;
use crate::config::{CaseAttitude, Dockside, PlantSite};
use crate::disturbed::Motion;
use crate::kinematics::{CaseMotion, Node, Whereabouts};
use crate::sway::Sway;
use crate::trig::{Near, rx_t, ry_t, rz_t};
use crate::window::Window;
use nalgebra::Vector3;
use octant_earth::ellipsoid::{ECCENTRICITY_SQUARED, Ellipsoid, SEMI_MAJOR_AXIS_M};
use octant_earth::ellipsoid::{meridian_radius_m, normal_gravity_mps2, transverse_radius_m};

#[derive(Clone, Debug)]
pub(crate) struct Ship {
    site: PlantSite,
    mean: CaseAttitude,
    heading_sincos: (f64, f64),
    mooring_offset_m: [f64; 3],
    /// Reciprocals of R_M + h and of (R_N + h) cos L at the dock: from metres to latitude and
    /// longitude.
    per_north_m: f64,
    per_east_m: f64,
    /// True if the angular acceleration is needed.
    pub(crate) accelerations: bool,
    latitude: Near,
    heading: Near,
    pitch: Near,
    roll: Near,
    pub(crate) sway: Sway,
    /// Motion of many samples at once, where only rate and specific force are needed.
    window: Option<Box<Window>>,
}

octant_state::state! {
    Ship {
        values: accelerations, latitude, heading, pitch, roll;
        parts: sway;
        kept: site, mean, heading_sincos, mooring_offset_m, per_north_m, per_east_m, window
    }
}

pub(crate) fn into_case(
    v: &Vector3<f64>,
    heading: (f64, f64),
    pitch: (f64, f64),
    roll: (f64, f64),
) -> Vector3<f64> {
    rx_t(&ry_t(&rz_t(v, heading), pitch), roll)
}

/// Adds a displacement to a motion in six degrees of freedom.
pub(crate) fn with(mut six: SixDof, motion: &Motion) -> SixDof {
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
    /// Makes a case at rest that can be moved.
    pub(crate) fn at_rest(site: PlantSite, mean: CaseAttitude) -> Self {
        let earth = Ellipsoid::at(site.latitude_rad, site.height_m);
        Self::new(&Dockside::calm(mean), site, &earth, 1.0, &[], true)
    }

    pub(crate) fn new(
        dockside: &Dockside,
        site: PlantSite,
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
            window: None,
        }
    }

    /// Lets rate and specific force at the regular nodes be computed for many samples at once from
    /// here on, where that saves work. A course ends this.
    pub(crate) fn open_windows(&mut self, period_ns: u64, nodes: &[(f64, f64)]) {
        self.window = Window::new(&self.sway, period_ns, nodes).map(Box::new);
    }

    /// Window of the present interval; `None` if the motion isn't that of the sway alone.
    #[inline]
    pub(crate) fn window(&self) -> Option<&Window> {
        if self.sway.course.is_none() { self.window.as_deref() } else { None }
    }

    #[inline]
    pub(crate) fn window_mut(&mut self) -> Option<&mut Window> {
        if self.sway.course.is_none() { self.window.as_deref_mut() } else { None }
    }

    /// Goes to the interval that starts at a time; intervals follow one another.
    #[inline]
    pub(crate) fn enter(&mut self, start_s: f64, start_ns: u64) {
        match self.window.take() {
            Some(mut window) if self.sway.course.is_none() => {
                self.sway.pass(start_s);
                window.enter(start_ns, |six| self.feel(six));
                self.window = Some(window);
            }
            window => {
                self.window = window;
                self.sway.enter(start_s);
            }
        }
    }

    /// Rate and specific force, independent of the ship's earlier motion.
    fn feel(&self, six: &SixDof) -> (Vector3<f64>, Vector3<f64>) {
        let (latitude, height) = self.latitude_and_height(six);
        let turned = [
            libm::sincos(latitude),
            libm::sincos(self.mean.heading_rad + six[2].value),
            libm::sincos(self.mean.pitch_rad + six[1].value),
            libm::sincos(self.mean.roll_rad + six[0].value),
        ];
        let motion = self.motion_of(six, height, turned);
        (motion.rate, motion.force)
    }

    /// North and east components of components along and to starboard of the mean heading.
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

    /// Motion at a node, with the motion from outside. Not inlined, so that a ship without such a
    /// motion doesn't pay for it.
    #[inline(never)]
    pub(crate) fn motion_on_course(&mut self, node: Node) -> CaseMotion {
        let six = match node {
            Node::Regular(index) => self.sway.at_node_on_course(index),
            Node::Offset(offset_s) => self.sway.at_offset_on_course(offset_s),
        };
        self.motion::<true>(&six)
    }

    /// Motion of the case. `DISTURBED` doesn't change the result: it makes a separate copy for
    /// disturbed motion, so that the other copy is inlined into the path of every sample.
    #[inline]
    pub(crate) fn motion<const DISTURBED: bool>(&mut self, six: &SixDof) -> CaseMotion {
        let (latitude, height) = self.latitude_and_height(six);
        let turned = [
            self.latitude.sincos(latitude),
            self.heading.sincos(self.mean.heading_rad + six[2].value),
            self.pitch.sincos(self.mean.pitch_rad + six[1].value),
            self.roll.sincos(self.mean.roll_rad + six[0].value),
        ];
        self.motion_of(six, height, turned)
    }

    /// Motion of the case; `turned`: sine and cosine of latitude, heading, pitch and roll.
    #[inline(always)]
    fn motion_of(&self, six: &SixDof, height: f64, turned: [(f64, f64); 4]) -> CaseMotion {
        let [(sin_latitude, cos_latitude), heading, pitch, roll] = turned;
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
        let normal = earth.gravity_mps2;
        let gravity = Vector3::new(0.0, 0.0, normal) + self.site.gravity.in_n(normal);
        let force = acceleration + (earth_rate * 2.0 + transport).cross(&velocity) - gravity;

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

    pub(crate) fn whereabouts(&self, six: &SixDof) -> Whereabouts {
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
