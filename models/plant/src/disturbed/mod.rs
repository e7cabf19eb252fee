//! Disturbances of the physical world by faults, realised before the sensors integrate.
//!
//! Every disturbance is a motion with its first and second derivatives: of the case against its
//! mooring, of a gimbal against its drive, of the sensor block against the gimballed body. The
//! three are composed as rigid motions, so that gyros, accelerometers, encoders and truth agree.
//! The plant takes this path only while something moves; a plant without disturbances never does.

mod body;
mod motion;
mod pulse;
mod registry;
mod shake;
mod smooth;
mod span;
mod turning;

pub(crate) use motion::Motion;
pub(crate) use registry::Registry;

use crate::gimbal::AxisState;
use pulse::{Excursion, Shock};
use shake::Shake;
use turning::{Ring, Slip};

/// All motions of faults that are under way; absent while only the configured motion takes place.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub(crate) struct Active {
    vibrations: Vec<Shake>,
    shocks: Vec<Shock>,
    sways: Vec<Shake>,
    excursions: Vec<Excursion>,
    slips: Vec<Slip>,
    rings: Vec<Ring>,
    /// Times at which the integration is cut; kept to reuse the memory.
    #[serde(skip)]
    cuts: Vec<f64>,
    /// Longest piece of the integration, s; follows from the other fields.
    #[serde(skip)]
    piece_s: f64,
}

impl Active {
    /// Number of motions under way.
    fn len(&self) -> usize {
        self.vibrations.len()
            + self.shocks.len()
            + self.sways.len()
            + self.excursions.len()
            + self.slips.len()
            + self.rings.len()
    }

    fn moves_case(&self) -> bool {
        !self.sways.is_empty() || !self.excursions.is_empty()
    }

    fn moves_block(&self) -> bool {
        !self.vibrations.is_empty() || !self.shocks.is_empty()
    }

    /// Returns whether a fault turns a gimbal against its drive.
    pub(crate) fn turns(&self, gimbal: usize) -> bool {
        self.slips.iter().any(|slip| slip.gimbal == gimbal)
            || self.rings.iter().any(|ring| ring.gimbal == gimbal)
    }

    fn end(&mut self, handle: u32, now_ns: u64) {
        let shakes = self.vibrations.iter_mut().chain(&mut self.sways);
        shakes.for_each(|shake| shake.span.end(handle, now_ns));
    }

    /// Returns whether a motion of a handle is under way.
    fn goes_on(&self, handle: u32, now_ns: u64) -> bool {
        let shakes = self.vibrations.iter().chain(&self.sways);
        shakes.filter(|shake| shake.span.handle == handle).any(|shake| !shake.is_over(now_ns))
            || self.shocks.iter().any(|shock| shock.span.handle == handle && !shock.is_over(now_ns))
            || self
                .excursions
                .iter()
                .any(|excursion| excursion.span.handle == handle && !excursion.is_over(now_ns))
            || self.slips.iter().any(|slip| slip.handle == handle && !slip.is_over(now_ns))
            || self.rings.iter().any(|ring| ring.handle == handle && !ring.is_over(now_ns))
    }

    /// Removes the motions that are over.
    fn settle(&mut self, now_ns: u64) {
        self.vibrations.retain(|vibration| !vibration.is_over(now_ns));
        self.shocks.retain(|shock| !shock.is_over(now_ns));
        self.sways.retain(|sway| !sway.is_over(now_ns));
        self.excursions.retain(|excursion| !excursion.is_over(now_ns));
        self.rings.retain(|ring| !ring.is_over(now_ns));
    }

    /// Plans the integration anew after a change of the motions.
    fn plan(&mut self, period_s: f64) {
        let shakes = self.vibrations.iter().chain(&self.sways).map(|shake| shake.piece_s);
        let shocks = self.shocks.iter().map(Shock::piece_s);
        let excursions = self.excursions.iter().map(Excursion::piece_s);
        let slips = self.slips.iter().map(Slip::piece_s);
        let rings = self.rings.iter().map(Ring::piece_s);
        let all = shakes.chain(shocks).chain(excursions).chain(slips).chain(rings);
        // The limit bounds the work of an interval at any frequency.
        self.piece_s = all.fold(f64::INFINITY, f64::min).max(period_s / 4096.0);
        // At most four knots of each motion; the rest is for both gimbals and the end of the
        // interval.
        self.cuts.reserve(4 * self.len() + 64);
    }

    /// Times after the start of the interval at which a derivative jumps.
    fn knots(&self, start_ns: u64, cuts: &mut Vec<f64>) {
        self.vibrations.iter().chain(&self.sways).for_each(|shake| shake.knots(start_ns, cuts));
        self.shocks.iter().for_each(|shock| shock.knots(start_ns, cuts));
        self.excursions.iter().for_each(|excursion| excursion.knots(start_ns, cuts));
        self.slips.iter().for_each(|slip| slip.knots(start_ns, cuts));
        self.rings.iter().for_each(|ring| ring.knots(start_ns, cuts));
    }

    fn lay(&mut self, start_ns: u64, middle_s: f64, width_s: f64, node_s: f64) {
        for shake in self.vibrations.iter_mut().chain(&mut self.sways) {
            shake.lay(start_ns, middle_s, width_s, node_s);
        }
    }

    fn advance(&mut self) {
        self.vibrations.iter_mut().chain(&mut self.sways).for_each(Shake::advance);
    }

    /// Motion of the sensor block against the gimballed body.
    fn block(&self, start_ns: u64, at_s: f64, node: Option<i8>) -> Motion {
        let mut motion = Motion::default();
        for vibration in &self.vibrations {
            motion.add(&vibration.motion(start_ns, at_s, node));
        }
        for shock in &self.shocks {
            motion.add(&shock.motion(start_ns, at_s));
        }
        motion
    }

    /// Motion of the case, if a fault moves it.
    fn case(&self, start_ns: u64, at_s: f64, node: Option<i8>) -> Option<Motion> {
        if !self.moves_case() {
            return None;
        }
        let mut motion = Motion::default();
        for sway in &self.sways {
            motion.add(&sway.motion(start_ns, at_s, node));
        }
        for excursion in &self.excursions {
            motion.add(&excursion.motion(start_ns, at_s));
        }
        Some(motion)
    }

    /// Motion of a gimbal's body against its drive.
    fn gimbal(&self, gimbal: usize, start_ns: u64, at_s: f64) -> AxisState {
        let slips = self.slips.iter().filter(|slip| slip.gimbal == gimbal);
        let rings = self.rings.iter().filter(|ring| ring.gimbal == gimbal);
        let slips = slips.map(|slip| slip.state(start_ns, at_s));
        slips.chain(rings.map(|ring| ring.state(start_ns, at_s))).fold(
            AxisState::default(),
            |sum, part| AxisState {
                angle: sum.angle + part.angle,
                rate: sum.rate + part.rate,
                acceleration: sum.acceleration + part.acceleration,
            },
        )
    }

    /// Angle by which slips under way show in the encoder of a gimbal, rad.
    pub(crate) fn seen(&self, gimbal: usize, now_ns: u64) -> f64 {
        let seen = self.slips.iter().filter(|slip| slip.gimbal == gimbal && slip.seen);
        seen.map(|slip| slip.state(now_ns, 0.0).angle).sum()
    }
}
