//! Sums of sinusoids in six degrees of freedom, advanced from sample to sample by a rotation of
//! each phasor instead of a sine and cosine.

use super::kinematics::{Dof, SixDof};
use crate::config::{Dockside, Sinusoid};
use crate::course::Course;
use crate::envelope::Envelope;

/// Samples after which the phasors are computed anew from the time, before rounding errors add up.
const RESET_SAMPLES: u32 = 256;

#[derive(Clone, Copy, Debug)]
struct Component {
    amplitude: f64,
    frequency_hz: f64,
    omega: f64,
    phase_rad: f64,
    /// Sine and cosine of the phase at the middle of the present interval.
    sin: f64,
    cos: f64,
    /// Sine and cosine of the phase gained in a sample period.
    step: (f64, f64),
}

octant_state::state! {
    Component {
        values: sin, cos;
        parts: ;
        kept: amplitude, frequency_hz, omega, phase_rad, step
    }
}

impl Component {
    fn phase_at(&self, time_s: f64) -> (f64, f64) {
        let cycles = time_s * self.frequency_hz;
        let turn = 2.0 * core::f64::consts::PI * (cycles - libm::floor(cycles));
        libm::sincos(turn + self.phase_rad)
    }

    /// Sine and cosine of the phase that differs by a rotation from the phase at the middle.
    #[inline(always)]
    fn turned(&self, (s, c): (f64, f64)) -> (f64, f64) {
        (self.sin * c + self.cos * s, self.cos * c - self.sin * s)
    }

    #[inline(always)]
    fn add_to(&self, dof: &mut Dof, (s, c): (f64, f64)) {
        let (sin, cos) = (self.amplitude * s, self.amplitude * c);
        dof.value += sin;
        dof.rate += self.omega * cos;
        dof.acceleration -= self.omega * self.omega * sin;
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Sway {
    components: Vec<Component>,
    /// End index of the components of each degree of freedom.
    ends: [usize; 6],
    /// Phase gained from the middle of the interval to each regular node, by node and component.
    to_node: Vec<(f64, f64)>,
    period_s: f64,
    until_reset: u32,
    /// Start of the present interval, s.
    start_s: f64,
    /// Regular nodes, s from the start of an interval.
    nodes_s: Vec<f64>,
    /// Growth and decay of the motion, where it isn't always there.
    envelope: Option<Box<Envelope>>,
    /// Motion from outside, to be given anew before every interval.
    pub(crate) course: Option<Box<Course>>,
}

octant_state::state! {
    Sway {
        values: until_reset, start_s, course;
        parts: components;
        kept: ends, to_node, period_s, nodes_s, envelope;
        check: Self::check_course
    }
}

impl Sway {
    fn check_course(&self) -> Result<(), octant_state::StateError> {
        if self.course.as_ref().is_none_or(|course| course.is_sound()) {
            return Ok(());
        }
        Err(octant_state::StateError::value("course", "it isn't made of finite numbers"))
    }
}

impl Sway {
    /// Makes a sway; `nodes_s`: the regular nodes, s from the start of an interval.
    pub(crate) fn new(dockside: &Dockside, period_s: f64, nodes_s: &[f64]) -> Self {
        let groups: [&[Sinusoid]; 6] = [
            &dockside.roll,
            &dockside.pitch,
            &dockside.yaw,
            &dockside.surge,
            &dockside.sway,
            &dockside.heave,
        ];
        let mut components = Vec::new();
        let mut ends = [0; 6];
        for (dof, group) in groups.into_iter().enumerate() {
            for sinusoid in group {
                let omega = 2.0 * core::f64::consts::PI / sinusoid.period_s;
                components.push(Component {
                    amplitude: sinusoid.amplitude,
                    frequency_hz: 1.0 / sinusoid.period_s,
                    omega,
                    phase_rad: sinusoid.phase_rad,
                    sin: 0.0,
                    cos: 0.0,
                    step: libm::sincos(omega * period_s),
                });
            }
            ends[dof] = components.len();
        }
        Self {
            to_node: to_node(&components, period_s, nodes_s),
            components,
            ends,
            period_s,
            until_reset: 0,
            start_s: 0.0,
            nodes_s: nodes_s.to_vec(),
            envelope: Envelope::of(&dockside.times),
            course: None,
        }
    }

    /// Returns whether the motion is always there.
    pub(crate) fn is_steady(&self) -> bool {
        self.envelope.is_none()
    }

    /// The same sway without a motion from outside, in intervals of another length with other nodes.
    pub(crate) fn with_nodes(&self, period_s: f64, nodes_s: &[f64]) -> Self {
        let step = |component: &Component| libm::sincos(component.omega * period_s);
        let components: Vec<_> =
            self.components.iter().map(|one| Component { step: step(one), ..*one }).collect();
        Self {
            to_node: to_node(&components, period_s, nodes_s),
            components,
            ends: self.ends,
            period_s,
            until_reset: 0,
            start_s: 0.0,
            nodes_s: nodes_s.to_vec(),
            envelope: self.envelope.clone(),
            course: None,
        }
    }

    /// Angular frequency of the fastest sinusoid, rad/s.
    pub(crate) fn fastest_radps(&self) -> f64 {
        self.components.iter().map(|component| component.omega).fold(0.0, f64::max)
    }

    /// Goes to the interval that starts at `start_s`, from any other.
    pub(crate) fn enter_anew(&mut self, start_s: f64) {
        self.until_reset = 0;
        self.enter(start_s);
    }

    /// Passes over the interval that starts at `start_s`: its regular nodes are not needed.
    #[inline]
    pub(crate) fn pass(&mut self, start_s: f64) {
        self.until_reset = 0;
        self.start_s = start_s;
    }

    /// Goes to the interval that starts at `start_s`; intervals follow one another.
    #[inline]
    pub(crate) fn enter(&mut self, start_s: f64) {
        self.start_s = start_s;
        if self.until_reset == 0 {
            self.until_reset = RESET_SAMPLES;
            for component in &mut self.components {
                (component.sin, component.cos) = component.phase_at(start_s + 0.5 * self.period_s);
            }
        } else {
            for component in &mut self.components {
                let (s, c) = component.step;
                (component.sin, component.cos) =
                    (component.sin * c + component.cos * s, component.cos * c - component.sin * s);
            }
        }
        self.until_reset -= 1;
    }

    /// Sums the components of each degree of freedom, each at the phase that `phase` gives.
    #[inline(always)]
    fn sum(&self, phase: impl Fn(usize, &Component) -> (f64, f64)) -> SixDof {
        let mut begin = 0;
        self.ends.map(|end| {
            let mut dof = Dof::default();
            for (i, component) in self.components[begin..end].iter().enumerate() {
                component.add_to(&mut dof, phase(begin + i, component));
            }
            begin = end;
            dof
        })
    }

    /// Sway at a regular node of the present interval.
    #[inline(always)]
    pub(crate) fn at_node(&self, node: usize) -> SixDof {
        let n = self.components.len();
        let to_node = &self.to_node[node * n..(node + 1) * n];
        let six = self.sum(|i, component| component.turned(to_node[i]));
        self.scaled(six, self.start_s + self.nodes_s[node])
    }

    /// Sway at `offset_s` after the start of the present interval.
    pub(crate) fn at_offset(&self, offset_s: f64) -> SixDof {
        let from_middle_s = offset_s - 0.5 * self.period_s;
        let six = self
            .sum(|_, component| component.turned(libm::sincos(component.omega * from_middle_s)));
        self.scaled(six, self.start_s + offset_s)
    }

    /// Sway with its growth and decay.
    #[inline(always)]
    fn scaled(&self, mut six: SixDof, time_s: f64) -> SixDof {
        if let Some(envelope) = &self.envelope {
            envelope.scale(&mut six, time_s);
        }
        six
    }

    /// Sway and motion from outside, if there is one, at a regular node.
    pub(crate) fn at_node_on_course(&self, node: usize) -> SixDof {
        self.on_course(self.at_node(node), self.start_s + self.nodes_s[node])
    }

    /// Sway and motion from outside, if there is one, at `offset_s` after the start of the present
    /// interval.
    pub(crate) fn at_offset_on_course(&self, offset_s: f64) -> SixDof {
        self.on_course(self.at_offset(offset_s), self.start_s + offset_s)
    }

    fn on_course(&self, mut six: SixDof, time_s: f64) -> SixDof {
        if let Some(course) = &self.course {
            course.add_to(&mut six, time_s);
        }
        six
    }

    /// Sway and motion from outside at `offset_s` after the start of an interval that was passed
    /// over.
    pub(crate) fn at_offset_passed(&self, offset_s: f64) -> SixDof {
        self.at_time(self.start_s + offset_s)
    }

    /// Sway and motion from outside at any time, s since the start.
    pub(crate) fn at_time(&self, time_s: f64) -> SixDof {
        let six = self.sum(|_, component| component.phase_at(time_s));
        self.on_course(self.scaled(six, time_s), time_s)
    }
}

/// Sine and cosine of the phase that each component gains from the middle of an interval to each node.
fn to_node(components: &[Component], period_s: f64, nodes_s: &[f64]) -> Vec<(f64, f64)> {
    let gained = |node: &f64, one: &Component| libm::sincos(one.omega * (node - 0.5 * period_s));
    nodes_s.iter().flat_map(|node| components.iter().map(move |one| gained(node, one))).collect()
}

/// Shortest period of all sinusoids, s.
pub(crate) fn shortest_period_s(dockside: &Dockside) -> f64 {
    let d = dockside;
    [&d.roll, &d.pitch, &d.yaw, &d.surge, &d.sway, &d.heave]
        .into_iter()
        .flatten()
        .fold(f64::INFINITY, |shortest, sinusoid| shortest.min(sinusoid.period_s))
}
