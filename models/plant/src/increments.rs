//! True increments: the integrals of angular rate and specific force over an interval.
//!
//! Gauss-Legendre on pieces that are short against every motion involved: at the default rates the
//! error is far below the rounding of an f64. Pieces end where a gimbal's acceleration jumps.

mod state;

use crate::case::Case;
use crate::config::{Motion, PlantConfig, Vibration};
use crate::disturbed::{Active, Registry};
use crate::gimbal::{Arc, Gimbal};
use crate::kinematics::Node;
use crate::trig::{Near, rx_t, ry_t, rz_t};
use crate::vibration::shaken;
use crate::window::Frame;
use nalgebra::{Matrix3, Vector3};
use octant_sample::GimbalCommand;
use std::collections::VecDeque;

/// Nodes of the three-point rule on (−1, 1): 0 and ±√(3/5).
const GAUSS_NODE: f64 = 0.774_596_669_241_483_4;
pub(crate) const GAUSS: [(f64, f64); 3] =
    [(-GAUSS_NODE, 5.0 / 18.0), (0.0, 8.0 / 18.0), (GAUSS_NODE, 5.0 / 18.0)];

/// Nodes of the two-point rule on (−1, 1): ±√(1/3).
const GAUSS_2_NODE: f64 = 0.577_350_269_189_625_8;
const GAUSS_2: [(f64, f64); 2] = [(-GAUSS_2_NODE, 0.5), (GAUSS_2_NODE, 0.5)];
/// Largest turn or phase in a piece, rad, for which two nodes suffice: for e^{iφ} their relative
/// error is φ⁴/4320, here 1e-12 (Abramowitz and Stegun 1972, 25.4.30).
const TWO_NODES_RAD: f64 = 0.008;

/// Longest piece, s.
const PIECE_MAX_S: f64 = 0.01;
/// Pieces shorter than this are due to rounding and are skipped, s.
pub(crate) const PIECE_MIN_S: f64 = 1e-12;
/// Room for both gimbals' knots, both ends and the cut of the time skew.
const CUTS_MAX: usize = 24;

/// Integrals over an interval, in b.
#[derive(Clone, Copy, Debug, Default, serde::Serialize, serde::Deserialize)]
pub(crate) struct Increments {
    /// ∫ω_ib dt, rad.
    pub(crate) delta_theta: Vector3<f64>,
    /// ∫f dt, m/s.
    pub(crate) delta_velocity: Vector3<f64>,
}

impl Increments {
    fn add(&mut self, other: &Self) {
        self.delta_theta += other.delta_theta;
        self.delta_velocity += other.delta_velocity;
    }
}

/// Delay of the inertial data against the stamps: a queue for the whole periods, and a cut inside
/// the interval for the rest.
#[derive(Clone, Debug)]
struct Lag {
    /// Time of the cut, s after the start of the interval.
    cut_s: f64,
    /// Part of the previous interval after the cut.
    late: Increments,
    queue: VecDeque<Increments>,
}

impl octant_state::State for Lag {
    fn save(&self, to: &mut octant_state::Writer) {
        let Self { cut_s: _, late, queue } = self;
        to.value("late", late);
        for increments in queue {
            to.value("queued", increments);
        }
    }

    fn load(
        &mut self,
        from: &mut octant_state::StateReader<'_>,
    ) -> Result<(), octant_state::StateError> {
        self.late = from.value("late")?;
        for increments in &mut self.queue {
            *increments = from.value("queued")?;
        }
        Ok(())
    }
}

/// Motion of the gimbals on a stretch without a knot.
#[derive(Clone, Copy, Debug)]
struct Turn {
    roll: Arc,
    azimuth: Arc,
    /// Sine and cosine of a gimbal that rests on this stretch.
    roll_sincos: (f64, f64),
    azimuth_sincos: (f64, f64),
}

impl Turn {
    fn rests(&self) -> bool {
        self.roll.rests() && self.azimuth.rests()
    }
}

/// The moving body: case, gimbals, sensor block.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    period_ns: u64,
    pub(crate) period_s: f64,
    pub(crate) piece_s: f64,
    nodes: Vec<(f64, f64)>,
    pub(crate) case: Case,
    pub(crate) azimuth: Gimbal,
    pub(crate) roll: Gimbal,
    azimuth_near: Near,
    roll_near: Near,
    pub(crate) tilt_sincos: (f64, f64),
    /// Takes a vector from the inner gimbal's axes into those of the body mounted on it; `None`: the same.
    pub(crate) mounting: Option<Matrix3<f64>>,
    pub(crate) vibration: Option<Vibration>,
    pub(crate) lever_arm: Option<[Vector3<f64>; 3]>,
    /// Lever arms of the configuration, without those of faults.
    pub(crate) own_lever_arm: Option<[Vector3<f64>; 3]>,
    pub(crate) rate_at_end: Vector3<f64>,
    lag: Option<Lag>,
    constant: bool,
    /// Sine and cosine of roll and azimuth while both gimbals rest; set by the first interval at
    /// rest.
    resting_sincos: Option<Frame>,
    /// Lasting faults that have not ended.
    pub(crate) registry: Registry,
    /// Motions of faults under way.
    pub(crate) active: Option<Box<Active>>,
}

impl Body {
    pub(crate) fn new(config: &PlantConfig) -> Self {
        let period_s = config.sample_period_ns as f64 * 1e-9;
        let extensions = &config.imu.extensions;
        let table = &config.turntable;
        let mut piece_s = PIECE_MAX_S.min(0.1 / table.rate_radps);
        if let Some(vibration) = &extensions.vibration {
            piece_s = piece_s.min(1.0 / (32.0 * vibration.frequency_hz));
        }
        let mut fastest_radps = table.rate_radps;
        if let Motion::Dockside(dockside) = &config.motion {
            let shortest_s = crate::sway::shortest_period_s(dockside);
            piece_s = piece_s.min(shortest_s / 64.0);
            fastest_radps = fastest_radps.max(2.0 * core::f64::consts::PI / shortest_s);
        }
        let mut nodes = Vec::new();
        let pieces = libm::ceil(period_s / piece_s - 1e-9).max(1.0);
        let width = period_s / pieces;
        let smooth = extensions.vibration.is_none() && fastest_radps * width <= TWO_NODES_RAD;
        let rule: &[(f64, f64)] = if smooth { &GAUSS_2 } else { &GAUSS };
        for piece in 0..pieces as u64 {
            let middle = (piece as f64 + 0.5) * width;
            let scaled = |(x, w): &(f64, f64)| (middle + 0.5 * width * x, w * width);
            nodes.extend(rule.iter().map(scaled));
        }
        let gimbal = Gimbal::new(table.rate_radps, table.acceleration_radps2, table.backlash_rad);
        let shaken = extensions.vibration.is_some();
        let mut case = Case::new(&config.motion, config.site, period_s, &nodes, shaken);
        let lever_arm = (extensions.lever_arm_m != [[0.0; 3]; 3])
            .then(|| extensions.lever_arm_m.map(Vector3::from));
        if !shaken && lever_arm.is_none() && extensions.time_skew_s == 0.0 {
            case.open_windows(config.sample_period_ns, &nodes);
        }
        let constant =
            case.is_static() && extensions.vibration.is_none() && extensions.time_skew_s == 0.0;
        let mut body = Self {
            period_ns: config.sample_period_ns,
            period_s,
            piece_s,
            nodes,
            case,
            azimuth: gimbal,
            roll: gimbal,
            azimuth_near: Near::new(0.0),
            roll_near: Near::new(0.0),
            tilt_sincos: libm::sincos(table.non_orthogonality_rad),
            mounting: (table.errors.mounting_rad != [0.0; 3]).then(|| {
                octant_earth::rotation::exp(&table.errors.mounting_rad.into())
                    .inverse()
                    .to_rotation_matrix()
                    .into_inner()
            }),
            vibration: extensions.vibration,
            lever_arm,
            own_lever_arm: lever_arm,
            rate_at_end: Vector3::zeros(),
            lag: None,
            constant,
            resting_sincos: None,
            registry: Registry::default(),
            active: None,
        };
        if extensions.time_skew_s > 0.0 {
            body.fill_lag(extensions.time_skew_s);
        } else {
            body.begin(0.0);
        }
        body
    }

    /// Fills the lag with the increments before the first interval: gimbals at rest, ship and
    /// vibration moving as always.
    fn fill_lag(&mut self, skew_s: f64) {
        let whole = libm::floor(skew_s / self.period_s + 1e-9);
        let cut_s = (self.period_s - (skew_s - whole * self.period_s)).min(self.period_s);
        let mut queue = VecDeque::with_capacity(whole as usize);
        let mut late = Increments::default();
        let before = whole as i64 + 1;
        self.begin(-(before as f64) * self.period_s);
        for k in -before..0 {
            let start_s = k as f64 * self.period_s;
            // Before the start there are no nanoseconds of the run, and 0 stands in; with a lag
            // there are no windows.
            self.case.enter(start_s, 0);
            let early = self.integrate(start_s, 0, 0.0, cut_s);
            if k > -before {
                let mut held = late;
                held.add(&early);
                queue.push_back(held);
            }
            late = self.integrate(start_s, 0, cut_s, self.period_s);
        }
        self.lag = Some(Lag { cut_s, late, queue });
    }

    /// Computes the rate at the start, which the size effect needs.
    pub(crate) fn begin(&mut self, start_s: f64) {
        if self.lever_arm.is_some() {
            let mut before = self.clone();
            // With a lever arm there are no windows.
            before.case.enter(start_s, 0);
            let turn = before.turn(0, 0.0);
            self.rate_at_end = before.feel(start_s, 0.0, Node::Offset(0.0), &turn).0;
        }
    }

    /// Forgets the sine and cosine of gimbals at rest.
    pub(crate) fn look_again(&mut self) {
        self.resting_sincos = None;
    }

    /// Takes new set points, from `now_ns` on. Returns true if a gimbal got a new one.
    #[inline]
    pub(crate) fn command(&mut self, command: &GimbalCommand, now_ns: u64) -> bool {
        let azimuth = self.azimuth.command(command.target.azimuth, now_ns);
        let roll = self.roll.command(command.target.roll, now_ns);
        let any = azimuth || roll;
        if any {
            self.look_again();
        }
        if any && (self.active.is_some() || !self.registry.is_empty()) {
            self.set_out([azimuth, roll], now_ns);
        }
        any
    }

    /// Returns whether the increments of every interval from `start_ns` on are the same until a new
    /// command.
    #[inline]
    pub(crate) fn is_constant(&self, start_ns: u64) -> bool {
        self.constant
            && self.azimuth.rests(start_ns)
            && self.roll.rests(start_ns)
            && self.active.is_none()
    }

    /// The increments of the sample whose interval starts at `start_ns`.
    pub(crate) fn increments(&mut self, start_ns: u64) -> Increments {
        if self.active.is_some() {
            self.look_again();
            self.settle(start_ns);
        }
        let start_s = start_ns as f64 * 1e-9;
        self.case.enter(start_s, start_ns);
        let Some(cut_s) = self.lag.as_ref().map(|lag| lag.cut_s) else {
            return self.integrate(start_s, start_ns, 0.0, self.period_s);
        };
        let mut now = self.integrate(start_s, start_ns, 0.0, cut_s);
        let late = self.integrate(start_s, start_ns, cut_s, self.period_s);
        if let Some(lag) = &mut self.lag {
            now.add(&lag.late);
            lag.late = late;
            // Removing before adding keeps the queue at its length, even in a clone.
            if let Some(oldest) = lag.queue.pop_front() {
                lag.queue.push_back(now);
                now = oldest;
            }
        }
        now
    }

    /// Integrals from `from_s` to `to_s` after the start of the interval.
    fn integrate(&mut self, start_s: f64, start_ns: u64, from_s: f64, to_s: f64) -> Increments {
        let mut sum = Increments::default();
        if to_s - from_s < PIECE_MIN_S {
            return sum;
        }
        if self.active.is_some() {
            return self.integrate_disturbed(start_ns, from_s, to_s);
        }
        let is_whole = from_s == 0.0 && to_s == self.period_s;
        if let (true, Some(sincos)) = (is_whole, self.resting_sincos) {
            return self.integrate_resting(sincos);
        }
        let mut cuts = [to_s; CUTS_MAX];
        cuts[0] = from_s;
        let mut count = 1;
        for gimbal in [&self.azimuth, &self.roll] {
            if gimbal.rests(start_ns) {
                continue;
            }
            let begin = gimbal.body.seconds(start_ns);
            for knot in gimbal.body.knots() {
                let at = knot - begin;
                if at > from_s + PIECE_MIN_S && at < to_s - PIECE_MIN_S && count < CUTS_MAX - 1 {
                    cuts[count] = at;
                    count += 1;
                }
            }
        }
        if self.is_constant(start_ns) {
            // One node: exact for a constant, to the last bit.
            let turn = self.turn(start_ns, from_s);
            let weight = to_s - from_s;
            self.add_node(&mut sum, start_s, from_s, Node::Offset(from_s), weight, &turn);
        } else if count == 1 && is_whole {
            let turn = self.turn(start_ns, 0.5 * self.period_s);
            if turn.rests() && self.vibration.is_none() && self.lever_arm.is_none() {
                let sincos = [turn.roll_sincos, turn.azimuth_sincos];
                if self.azimuth.rests(start_ns) && self.roll.rests(start_ns) {
                    self.resting_sincos = Some(sincos);
                }
                return self.integrate_resting(sincos);
            }
            for index in 0..self.nodes.len() {
                let (at, weight) = self.nodes[index];
                self.add_node(&mut sum, start_s, at, Node::Regular(index), weight, &turn);
            }
        } else {
            cuts[1..count].sort_unstable_by(f64::total_cmp);
            for pair in 0..count {
                self.add_stretch(&mut sum, start_s, start_ns, cuts[pair], cuts[pair + 1]);
            }
        }
        if let Some(arms) = self.lever_arm {
            let turn = self.turn(start_ns, to_s);
            let (rate, _) = self.feel(start_s, to_s, Node::Offset(to_s), &turn);
            let change = rate - self.rate_at_end;
            self.rate_at_end = rate;
            for axis in 0..3 {
                sum.delta_velocity[axis] += change.cross(&arms[axis])[axis];
            }
        }
        sum
    }

    /// Integrals over a whole interval in which both gimbals rest: those of the case, turned once.
    fn integrate_resting(&mut self, frame: Frame) -> Increments {
        let ([roll, azimuth], tilt) = (frame, self.tilt_sincos);
        let mounting = self.mounting;
        let into_block = |v: &Vector3<f64>| {
            let inner = rz_t(&ry_t(&rx_t(v, roll), tilt), azimuth);
            mounting.map_or(inner, |mounting| mounting * inner)
        };
        if let Some((delta_theta, delta_velocity)) = self.case.integral_in(frame, into_block) {
            return Increments { delta_theta, delta_velocity };
        }
        let (mut rate, mut force) = (Vector3::zeros(), Vector3::zeros());
        for index in 0..self.nodes.len() {
            let case = self.case.motion(Node::Regular(index));
            let weight = self.nodes[index].1;
            rate += case.rate * weight;
            force += case.force * weight;
        }
        Increments { delta_theta: into_block(&rate), delta_velocity: into_block(&force) }
    }

    /// The gimbals' arcs on the stretch that holds `inside_s` after the start of the interval.
    #[inline]
    fn turn(&mut self, start_ns: u64, inside_s: f64) -> Turn {
        let roll = self.roll.body.arc(start_ns, inside_s);
        let azimuth = self.azimuth.body.arc(start_ns, inside_s);
        // Not used for a moving gimbal: each node computes its own.
        let sincos = |arc: &Arc, near: &mut Near| {
            if arc.rests() { near.sincos(arc.origin.angle) } else { (0.0, 1.0) }
        };
        Turn {
            roll_sincos: sincos(&roll, &mut self.roll_near),
            azimuth_sincos: sincos(&azimuth, &mut self.azimuth_near),
            roll,
            azimuth,
        }
    }

    /// Adds a stretch without a knot inside.
    fn add_stretch(&mut self, sum: &mut Increments, start_s: f64, start_ns: u64, a: f64, b: f64) {
        if b - a < PIECE_MIN_S {
            return;
        }
        let turn = self.turn(start_ns, 0.5 * (a + b));
        let pieces = libm::ceil((b - a) / self.piece_s - 1e-9).max(1.0);
        let width = (b - a) / pieces;
        for piece in 0..pieces as u64 {
            let middle = a + (piece as f64 + 0.5) * width;
            for (x, w) in GAUSS {
                let at = middle + 0.5 * width * x;
                self.add_node(sum, start_s, at, Node::Offset(at), w * width, &turn);
            }
        }
    }

    #[inline(always)]
    fn add_node(
        &mut self,
        sum: &mut Increments,
        start_s: f64,
        at: f64,
        node: Node,
        weight: f64,
        turn: &Turn,
    ) {
        let (rate, mut force) = self.feel(start_s, at, node, turn);
        if let Some(arms) = &self.lever_arm {
            for axis in 0..3 {
                force[axis] += rate.cross(&rate.cross(&arms[axis]))[axis];
            }
        }
        sum.delta_theta += rate * weight;
        sum.delta_velocity += force * weight;
    }

    /// Angular rate and specific force of the sensor block in its own axes.
    #[inline]
    fn feel(
        &mut self,
        start_s: f64,
        at: f64,
        node: Node,
        turn: &Turn,
    ) -> (Vector3<f64>, Vector3<f64>) {
        let case = self.case.motion(node);
        let (roll, roll_rate) = turn.roll.at(at);
        let (azimuth, azimuth_rate) = turn.azimuth.at(at);
        let (mut roll_sincos, mut azimuth_sincos) = (turn.roll_sincos, turn.azimuth_sincos);
        if !turn.roll.rests() {
            roll_sincos = self.roll_near.sincos(roll);
        }
        if !turn.azimuth.rests() {
            azimuth_sincos = self.azimuth_near.sincos(azimuth);
        }
        let x = Vector3::x();
        let z = Vector3::z();
        let turned = rx_t(&case.rate, roll_sincos);
        let inner = ry_t(&(turned + x * roll_rate), self.tilt_sincos);
        let turned_inner = rz_t(&inner, azimuth_sincos);
        let mut rate = turned_inner + z * azimuth_rate;
        let mut force =
            rz_t(&ry_t(&rx_t(&case.force, roll_sincos), self.tilt_sincos), azimuth_sincos);
        if let Some(mounting) = &self.mounting {
            (rate, force) = (mounting * rate, mounting * force);
        }
        let Some(vibration) = &self.vibration else {
            return (rate, force);
        };
        let outer_acceleration = rx_t(&case.acceleration, roll_sincos)
            - x.cross(&turned) * roll_rate
            + x * turn.roll.origin.acceleration;
        let mut acceleration = rz_t(&ry_t(&outer_acceleration, self.tilt_sincos), azimuth_sincos)
            - z.cross(&turned_inner) * azimuth_rate
            + z * turn.azimuth.origin.acceleration;
        if let Some(mounting) = &self.mounting {
            acceleration = mounting * acceleration;
        }
        shaken(vibration, start_s + at, &rate, &acceleration, &force)
    }

    /// True gimbal angles (azimuth, roll) at a stamp, rad.
    pub(crate) fn gimbal_rad(&self, at_ns: u64) -> [f64; 2] {
        let [azimuth, roll] = [&self.azimuth, &self.roll]
            .map(|gimbal| gimbal.body.at(gimbal.body.seconds(at_ns)).angle);
        [azimuth + self.beside(0, at_ns), roll + self.beside(1, at_ns)]
    }

    pub(crate) fn period_ns(&self) -> u64 {
        self.period_ns
    }
}
