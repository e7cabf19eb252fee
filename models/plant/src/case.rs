//! Motion of the case: angular rate and specific force in the case frame c.

use super::kinematics::SixDof;
use crate::config::{self, CaseAttitude, PlantSite};
use crate::course::Course;
use crate::disturbed::Motion;
use crate::kinematics::{CaseMotion, Node, Whereabouts};
use crate::ship::{Ship, into_case, with};
use crate::window::Frame;
use nalgebra::Vector3;
use octant_earth::ellipsoid::Ellipsoid;

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
        from: &mut octant_state::StateReader<'_>,
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

#[derive(Clone, Debug)]
enum Kind {
    Static {
        motion: CaseMotion,
        site: PlantSite,
        attitude: CaseAttitude,
        /// Moving case that stands in while a fault moves this one.
        adrift: Option<Box<Ship>>,
    },
    Ship(Box<Ship>),
}

#[derive(Clone, Debug)]
pub(crate) struct Case {
    kind: Kind,
    /// True if angular acceleration is needed without disturbances too.
    accelerations: bool,
}

impl Case {
    /// Makes a case. `nodes`: the regular nodes, s from the start of an interval, with their
    /// weights. `accelerations`: whether the angular acceleration of [`CaseMotion`] is needed;
    /// otherwise it is zero.
    pub(crate) fn new(
        motion: &config::Motion,
        site: PlantSite,
        period_s: f64,
        nodes: &[(f64, f64)],
        accelerations: bool,
    ) -> Self {
        let nodes_s: Vec<f64> = nodes.iter().map(|node| node.0).collect();
        let earth = Ellipsoid::at(site.latitude_rad, site.height_m);
        let kind = match motion {
            config::Motion::Static(attitude) => {
                let heading = libm::sincos(attitude.heading_rad);
                let pitch = libm::sincos(attitude.pitch_rad);
                let roll = libm::sincos(attitude.roll_rad);
                let up = Vector3::new(0.0, 0.0, -earth.gravity_mps2)
                    - site.gravity.in_n(earth.gravity_mps2);
                let motion = CaseMotion {
                    rate: into_case(&earth.earth_rate(), heading, pitch, roll),
                    acceleration: Vector3::zeros(),
                    force: into_case(&up, heading, pitch, roll),
                };
                Kind::Static { motion, site, attitude: *attitude, adrift: None }
            }
            config::Motion::Dockside(dockside) => {
                let ship = Ship::new(dockside, site, &earth, period_s, &nodes_s, accelerations);
                Kind::Ship(Box::new(ship))
            }
        };
        Self { kind, accelerations }
    }

    /// Lets rate and specific force be computed for many samples at once from here on, where that
    /// saves work. Angular acceleration is then missing unless the case is disturbed.
    pub(crate) fn open_windows(&mut self, period_ns: u64, nodes: &[(f64, f64)]) {
        if let Kind::Ship(ship) = &mut self.kind {
            ship.open_windows(period_ns, nodes);
        }
    }

    /// Prepares for a disturbance: angular acceleration is needed, and with `moves` a case at rest
    /// has to be able to move.
    pub(crate) fn disturbed(&mut self, moves: bool) {
        match &mut self.kind {
            Kind::Static { adrift: Some(_), .. } if moves => {}
            Kind::Static { site, attitude, adrift, .. } => {
                *adrift = moves.then(|| Box::new(Ship::at_rest(*site, *attitude)));
            }
            Kind::Ship(ship) => ship.accelerations = true,
        }
    }

    /// Returns to motion without disturbances.
    pub(crate) fn undisturbed(&mut self) {
        match &mut self.kind {
            Kind::Static { adrift, .. } => *adrift = None,
            Kind::Ship(ship) => ship.accelerations = self.accelerations,
        }
    }

    /// Motion under disturbances, with a displacement if there is one.
    #[inline(never)]
    pub(crate) fn displaced(&mut self, time_s: f64, motion: Option<&Motion>) -> CaseMotion {
        match &mut self.kind {
            Kind::Ship(ship) | Kind::Static { adrift: Some(ship), .. } => {
                // A displaced static case has no sway of its own: its sway is zero.
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

    /// Adds a motion from outside to the sway; returns false if the case is fixed to the ground.
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
    pub(crate) fn enter(&mut self, start_s: f64, start_ns: u64) {
        if let Kind::Ship(ship) = &mut self.kind {
            ship.enter(start_s, start_ns);
        }
    }

    /// Integrals of rate and specific force over the interval, turned by `turn` into another frame;
    /// `None` without a window.
    #[inline]
    pub(crate) fn integral_in(
        &mut self,
        frame: Frame,
        turn: impl Fn(&Vector3<f64>) -> Vector3<f64>,
    ) -> Option<(Vector3<f64>, Vector3<f64>)> {
        match &mut self.kind {
            Kind::Ship(ship) => Some(ship.window_mut()?.integral_in(frame, turn)),
            Kind::Static { .. } => None,
        }
    }

    #[inline]
    pub(crate) fn motion(&mut self, node: Node) -> CaseMotion {
        match &mut self.kind {
            Kind::Static { motion, .. } => *motion,
            Kind::Ship(ship) if ship.sway.course.is_some() => ship.motion_on_course(node),
            Kind::Ship(ship) => {
                let six = match (node, ship.window()) {
                    (Node::Regular(index), Some(window)) => {
                        let (rate, force) = window.at_node(index);
                        return CaseMotion { rate, acceleration: Vector3::zeros(), force };
                    }
                    (Node::Offset(offset_s), Some(_)) => ship.sway.at_offset_passed(offset_s),
                    (Node::Regular(index), None) => ship.sway.at_node(index),
                    (Node::Offset(offset_s), None) => ship.sway.at_offset(offset_s),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{CaseAttitude, MotionTimes};
    use crate::motion::{dockside_default, dockside_iso_8728};
    use crate::trig::{rx_t, rz_t};
    use octant_earth::ellipsoid::{meridian_radius_m, transverse_radius_m};

    /// Checks the two derivatives that are written out by hand against central differences: the
    /// angular acceleration, and the velocity that follows from the position.
    #[test]
    fn derivatives_agree_with_differences() {
        let mut always = crate::motion::dockside_default(9);
        always.mean = CaseAttitude { heading_rad: 0.6, pitch_rad: 0.1, roll_rad: -0.2 };
        // Over ramps of 10 s the differences are as good as for the sinusoids: the factor's third derivative is 0.06/s³.
        let times = MotionTimes { during_s: vec![[3.0, 24.0], [25.0, 60.0]], ramp_s: 10.0 };
        let sometimes = config::Dockside { times, ..always.clone() };
        let site = PlantSite {
            latitude_rad: 0.9,
            longitude_rad: 0.2,
            height_m: 10.0,
            gravity: Default::default(),
        };
        for ship in [always, sometimes] {
            assert_derivatives(ship, site);
        }
    }

    fn assert_derivatives(ship: config::Dockside, site: PlantSite) {
        let (period_s, h) = (0.1, 1e-3);
        let mut case =
            Case::new(&config::Motion::Dockside(ship), site, period_s, &[(0.05, 0.1)], true);
        for k in 0..400 {
            let start_s = f64::from(k) * period_s;
            case.enter(start_s, 0);
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

    /// Outside of its times a case is at rest at its mean, within them it moves as one that always does.
    #[test]
    fn a_motion_is_there_at_its_times() {
        let always = dockside_default(9);
        let times = MotionTimes { during_s: vec![[20.0, 60.0], [100.0, 140.0]], ramp_s: 5.0 };
        let sometimes = config::Dockside { times, ..always.clone() };
        let site = PlantSite {
            latitude_rad: 0.9,
            longitude_rad: 0.2,
            height_m: 0.0,
            gravity: Default::default(),
        };
        let case = |ship: config::Dockside| {
            Case::new(&config::Motion::Dockside(ship), site, 0.1, &[(0.05, 0.1)], true)
        };
        let (moving, windowed) = (case(always), case(sometimes.clone()));
        for (time_s, factor) in [
            (0.0, 0.0),
            (19.9, 0.0),
            (22.5, 0.5),
            (25.0, 1.0),
            (40.0, 1.0),
            (57.5, 0.5),
            (60.0, 0.0),
            (80.0, 0.0),
            (120.0, 1.0),
            (141.0, 0.0),
        ] {
            let (all, part) = (moving.whereabouts(time_s), windowed.whereabouts(time_s));
            assert!((part.roll_rad - factor * all.roll_rad).abs() < 1e-15, "{time_s}");
            assert!((part.heading_rad - factor * all.heading_rad).abs() < 1e-15, "{time_s}");
        }
        // Nothing is interpolated across a beginning or an end.
        let mut windowed = case(sometimes);
        windowed.open_windows(5_000_000, &[(0.0025, 0.005); 8]);
        assert!(windowed.integral_in([(0.0, 1.0); 2], |v| *v).is_none());
    }

    /// Compares the motion interpolated in windows with the motion computed anew at every node:
    /// equal to the rounding of either, over many windows and across a jump in time.
    #[test]
    fn windows_are_the_motion_itself() {
        let spectrum = crate::sea::Spectrum::jonswap(0.1, 8.0, 3.3);
        let mut sea = dockside_default(5);
        sea.roll = spectrum.components(1, "roll", 30);
        sea.heave = spectrum.components(1, "heave", 30);
        let mut steep = dockside_iso_8728(2);
        steep.roll[0].amplitude = 0.5;
        let site = PlantSite {
            latitude_rad: 0.9,
            longitude_rad: 0.2,
            height_m: 10.0,
            gravity: Default::default(),
        };
        for (ship, period_ns) in [
            (dockside_default(3), 5_000_000),
            (dockside_iso_8728(4), 1_000_000),
            (steep, 5_000_000),
            (sea, 5_000_000),
            (dockside_default(1), 50_000_000),
        ] {
            let period_s = period_ns as f64 * 1e-9;
            let nodes = [(0.2 * period_s, 0.3 * period_s), (0.7 * period_s, 0.7 * period_s)];
            let nodes = if period_ns > 5_000_000 { [nodes; 4].concat() } else { nodes.to_vec() };
            let motion = config::Motion::Dockside(ship);
            let mut exact = Case::new(&motion, site, period_s, &nodes, false);
            let mut case = exact.clone();
            case.open_windows(period_ns, &nodes);
            assert!(case.integral_in([(0.0, 1.0); 2], |v| *v).is_some(), "windows are worth it");
            let times = (0..5000).chain([70_000, 70_001, 70_003]).chain(90_000..90_100);
            for sample in times {
                let start_ns = sample * period_ns;
                let start_s = start_ns as f64 * 1e-9;
                case.enter(start_s, start_ns);
                let mut sum = (Vector3::zeros(), Vector3::zeros());
                for (index, (at_s, weight)) in nodes.iter().enumerate() {
                    let found = case.motion(Node::Regular(index));
                    let off = case.motion(Node::Offset(*at_s));
                    let six = match &exact.kind {
                        Kind::Ship(ship) => ship.sway.at_time(start_s + at_s),
                        Kind::Static { .. } => unreachable!(),
                    };
                    let Kind::Ship(ship) = &mut exact.kind else { unreachable!() };
                    let true_motion = ship.motion::<true>(&six);
                    // Rates are up to 0.5 rad/s, forces 10 m/s²; a phase at 4500 s is good to 1e-12.
                    assert!((found.rate - true_motion.rate).norm() < 2e-13, "{sample}");
                    assert!((found.force - true_motion.force).norm() < 2e-12, "{sample}");
                    assert!((off.rate - true_motion.rate).norm() < 1e-15);
                    sum.0 += true_motion.rate * *weight;
                    sum.1 += true_motion.force * *weight;
                }
                // The frame changes within a window too.
                let frame = [libm::sincos((sample / 9) as f64), libm::sincos(0.3)];
                let turn = |v: &Vector3<f64>| rz_t(&rx_t(v, frame[0]), frame[1]);
                let (rate, force) = case.integral_in(frame, turn).unwrap();
                sum = (turn(&sum.0), turn(&sum.1));
                assert!((rate - sum.0).norm() < 2e-13 * period_s, "{sample}");
                assert!((force - sum.1).norm() < 2e-12 * period_s, "{sample}");
            }
        }
    }
}
