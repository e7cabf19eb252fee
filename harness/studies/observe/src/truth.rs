//! True errors of an ensemble, carried along beside the filter's own covariance.
//!
//! Everything is linear, so sources of error add up. Random sources with zero initial mean are
//! carried by their covariance: the draws of the instrument and of its alignment, white noise, and
//! wandering biases, which are states of their own with a covariance to the errors. Sources that
//! are the same in every run are carried by their mean: given parameters, temperature, a mooring
//! offset. A sway of which only the phase is drawn is carried by the responses to a sine and to a
//! cosine, half the variance each.

use super::border::{Border, Step, sum};
use nalgebra::Vector3;
use octant_calibration::covariance::{
    Covariance, DR, DV, MOVING, PARAMETERS, PHI, STATE_COUNT, Transition,
};
use octant_calibration::filter::{FURTHER_ROW, FurtherRow, add_process_noise};
use octant_calibration::further::DRIVING_COUNT;
use octant_plant::config::Temperature;
use octant_sample::parameters::ParameterGroup;

/// Errors of all states: parameters are true − estimated, the others computed − true.
pub(super) type Errors = [f64; STATE_COUNT];

/// True properties of an ensemble.
#[derive(Clone, Debug)]
pub struct EnsembleTruth {
    /// Covariance of the errors at the start.
    pub covariance: Covariance,
    /// Mean of the errors at the start.
    pub mean: [f64; STATE_COUNT],
    /// White noise per s: of the gyros, rad²/s, and of the accelerometers, (m/s)²/s.
    pub noise: (f64, f64),
    /// 1σ of the reference, m/s or m; `None`: as the filter assumes.
    pub reference_sigma: Option<f64>,
    /// Wandering biases.
    pub wanders: Vec<Wander>,
    /// Course of the temperature; its coefficients are among the further errors.
    pub temperature: Option<Temperature>,
    /// Displacements of the instrument from the position that its reference gives: the same in
    /// every run.
    pub mooring: Vec<Swing>,
    /// Displacements with drawn phases; given phases are ignored.
    pub sway: Vec<Swing>,
    /// Part of the motion that the reference doesn't see.
    pub unseen: Unseen,
    /// Start time of the filter, s.
    pub start_s: f64,
    /// Angle by which the gimbal axes deviate from a right angle, rad.
    pub non_orthogonality_rad: f64,
    /// Errors beside the parameters.
    pub further: FurtherTruth,
}

/// Errors beside the parameters over an ensemble, SI, in the order of
/// [`FURTHER_NAMES`](octant_calibration::further::FURTHER_NAMES), without those of the gimbals: they do nothing to a
/// filter that doesn't use their angles. Gauss-Markov biases are among the [`Wander`]s.
#[derive(Clone, Debug, PartialEq)]
pub struct FurtherTruth {
    /// σ of what is drawn, each independent.
    pub sigma: [f64; DRIVING_COUNT],
    /// Values that are the same in every run.
    pub mean: [f64; DRIVING_COUNT],
    /// Effect on φ of an alignment before the start, rad.
    pub tilt: [[f64; DRIVING_COUNT]; 3],
}

impl Default for FurtherTruth {
    fn default() -> Self {
        let none = [0.0; DRIVING_COUNT];
        Self { sigma: none, mean: none, tilt: [none; 3] }
    }
}

impl FurtherTruth {
    /// Returns whether an instrument or its site has such an error.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.sigma.iter().chain(&self.mean).any(|value| *value != 0.0)
    }
}

/// Part of the motion that the reference doesn't see.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unseen {
    /// Nothing: the reference measures the instrument's motion.
    Nothing,
    /// The reference is the dock's position.
    Position,
    /// The reference is the dock's velocity.
    Velocity,
}

/// Wandering biases of one sensor triad, each axis independent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wander {
    /// Gyro or accelerometer biases.
    pub group: ParameterGroup,
    /// Variance at the start.
    pub variance: f64,
    /// Correlation time, s; infinite: a random walk.
    pub correlation_time_s: f64,
    /// Variance that is added per s.
    pub driving: f64,
}

impl Wander {
    /// Creates a first-order Gauss-Markov process in its stationary distribution.
    #[must_use]
    pub fn gauss_markov(group: ParameterGroup, sigma: f64, correlation_time_s: f64) -> Self {
        let variance = sigma * sigma;
        Self { group, variance, correlation_time_s, driving: 2.0 * variance / correlation_time_s }
    }

    /// Creates a random walk that starts at zero.
    #[must_use]
    pub fn random_walk(group: ParameterGroup, density: f64) -> Self {
        let driving = density * density;
        Self { group, variance: 0.0, correlation_time_s: f64::INFINITY, driving }
    }

    /// Returns the remaining fraction of a value after `h`, its mean fraction over that time, and
    /// the added variance.
    fn over(&self, h: f64) -> (f64, f64, f64) {
        let ratio = h / self.correlation_time_s;
        if ratio < 1e-9 {
            return (1.0, 1.0, self.driving * h);
        }
        let came = 0.5 * self.driving * self.correlation_time_s * -libm::expm1(-2.0 * ratio);
        (libm::exp(-ratio), -libm::expm1(-ratio) / ratio, came)
    }
}

/// Displacement `amplitude · sin(2π t / period + phase)` in n, m; an infinite period with a phase
/// of π/2 is an offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    /// Amplitude, north, east, down, m.
    pub amplitude_m: Vector3<f64>,
    /// Period, s.
    pub period_s: f64,
    /// Phase at time 0, rad.
    pub phase_rad: f64,
}

impl Swing {
    fn omega(&self) -> f64 {
        2.0 * core::f64::consts::PI / self.period_s
    }

    fn position(&self, t_s: f64) -> Vector3<f64> {
        self.amplitude_m * libm::sin(self.omega() * t_s + self.phase_rad)
    }

    fn velocity(&self, t_s: f64) -> Vector3<f64> {
        self.amplitude_m * (self.omega() * libm::cos(self.omega() * t_s + self.phase_rad))
    }
}

/// Response of all errors to deterministic sources.
#[derive(Clone, Debug)]
struct Answer {
    errors: Errors,
    /// Further states; zero without them.
    further: FurtherRow,
    swings: Vec<Swing>,
}

impl Answer {
    /// Starts an instrument at the position of its reference, while its true position differs.
    fn begun(mut self, start_s: f64) -> Self {
        for swing in &self.swings {
            let at = swing.position(start_s);
            (0..3).for_each(|axis| self.errors[DR + axis] -= at[axis]);
        }
        self
    }

    fn propagate(&mut self, step: &Step) {
        let driven = self.errors;
        for (i, row) in step.transition.rows.iter().enumerate() {
            self.errors[i] = row.iter().zip(&driven).map(|(a, b)| a * b).sum();
        }
        if let Some((columns, decay)) = &step.further {
            for (error, column) in self.errors.iter_mut().zip(columns) {
                *error += sum(column, &self.further);
            }
            self.further.iter_mut().zip(decay).for_each(|(value, decay)| *value *= decay);
        }
    }

    /// Updates the response; the reference is off by the motion that it does not see (`unseen`).
    fn update(&mut self, state: usize, axis: usize, gain: &Gain, unseen: Unseen, t_s: f64) {
        let off: f64 = (self.swings.iter())
            .map(|swing| match unseen {
                Unseen::Nothing => 0.0,
                Unseen::Position => -swing.position(t_s)[axis],
                Unseen::Velocity => -swing.velocity(t_s)[axis],
            })
            .sum();
        let innovation = self.errors[state] - off;
        for (error, gain) in self.errors.iter_mut().zip(&gain.errors) {
            *error -= gain * innovation;
        }
        for (value, gain) in self.further.iter_mut().zip(&gain.further) {
            *value -= gain * innovation;
        }
    }

    fn start_free(&mut self, t_s: f64) {
        for axis in 0..3 {
            let at: f64 = self.swings.iter().map(|swing| swing.position(t_s)[axis]).sum();
            self.errors[DR + axis] = -at;
        }
        self.hold_vertical();
    }

    fn hold_vertical(&mut self) {
        self.errors[DV + 2] = 0.0;
        self.errors[DR + 2] = 0.0;
    }
}

fn first_of(group: ParameterGroup) -> usize {
    PARAMETERS + group.range().start
}

/// Gain of the filter for the 39 errors and the further states.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gain {
    pub(super) errors: Errors,
    pub(super) further: FurtherRow,
}

/// Wandering bias with its covariance to the errors.
#[derive(Clone, Debug)]
struct Wandering {
    process: Wander,
    /// State on which it acts.
    like: usize,
    variance: f64,
    cross: Errors,
    /// Covariance to the further states, whose estimates it moves.
    further: FurtherRow,
}

/// True errors at a time.
#[derive(Clone, Debug)]
pub(super) struct TrueErrors {
    noise: (f64, f64),
    reference_variance: Option<f64>,
    unseen: Unseen,
    covariance: Covariance,
    /// Further states; `None` where neither the instrument nor the filter has any.
    border: Option<Border>,
    wanderings: Vec<Wandering>,
    mean: Answer,
    /// Responses with a variance of one half each.
    swung: Vec<Answer>,
}

impl TrueErrors {
    /// Makes the errors at the start; `bordered`: with further states.
    pub(super) fn new(truth: &EnsembleTruth, bordered: bool) -> Self {
        let wandering = |process: &Wander| {
            let process = *process;
            (0..3).map(move |axis| Wandering {
                process,
                like: first_of(process.group) + axis,
                variance: process.variance,
                cross: [0.0; STATE_COUNT],
                further: [0.0; FURTHER_ROW],
            })
        };
        let quarter = 0.5 * core::f64::consts::PI;
        let further = [0.0; FURTHER_ROW];
        let answer = |errors, swings| Answer { errors, further, swings };
        let both = |swing: &Swing| {
            let swing = *swing;
            [0.0, quarter].map(|phase_rad| {
                answer([0.0; STATE_COUNT], vec![Swing { phase_rad, ..swing }]).begun(truth.start_s)
            })
        };
        let mut mean = answer(truth.mean, truth.mooring.clone());
        mean.further[..DRIVING_COUNT].copy_from_slice(&truth.further.mean);
        Self {
            noise: truth.noise,
            reference_variance: truth.reference_sigma.map(|sigma| sigma * sigma),
            unseen: truth.unseen,
            covariance: truth.covariance.clone(),
            border: bordered.then(|| border(&truth.further)),
            wanderings: truth.wanders.iter().flat_map(wandering).collect(),
            mean: mean.begun(truth.start_s),
            swung: truth.sway.iter().flat_map(both).collect(),
        }
    }

    /// Carries everything over `h`; `force` is the specific force in n times `h`.
    pub(super) fn propagate(&mut self, step: &Step, h: f64, force: &Vector3<f64>) {
        self.covariance.propagate(&step.transition);
        if let (Some(border), Some(further)) = (&mut self.border, &step.further) {
            border.propagate(&step.transition, further, &mut self.covariance);
        }
        for wandering in &mut self.wanderings {
            wandering.propagate(step, h, &mut self.covariance, self.border.as_mut());
        }
        add_process_noise(&mut self.covariance, self.noise, h, force);
        for answer in self.answers() {
            answer.propagate(step);
        }
    }

    /// Updates with a measurement of one axis, `first` being the state of the first axis, by the
    /// filter's gain. `r` is the reference's variance that the filter assumes.
    pub(super) fn update(&mut self, first: usize, axis: usize, r: f64, gain: &Gain, t_s: f64) {
        let state = first + axis;
        let r = self.reference_variance.unwrap_or(r);
        if let Some(border) = &mut self.border {
            border.update(&self.covariance, (state, r), &gain.errors, &gain.further);
        }
        self.covariance.update_with_gain(state, r, &gain.errors);
        for wandering in &mut self.wanderings {
            let measured = wandering.cross[state];
            for (cross, gain) in wandering.cross.iter_mut().zip(&gain.errors) {
                *cross -= gain * measured;
            }
            for (cross, gain) in wandering.further.iter_mut().zip(&gain.further) {
                *cross -= gain * measured;
            }
        }
        let unseen = self.unseen;
        for answer in self.answers() {
            answer.update(state, axis, gain, unseen, t_s);
        }
    }

    /// Starts navigation at the position of the reference, with height and vertical velocity held.
    pub(super) fn start_free(&mut self, t_s: f64) {
        for state in [DR, DR + 1, DR + 2, DV + 2] {
            self.forget(state);
        }
        for answer in self.answers() {
            answer.start_free(t_s);
        }
    }

    pub(super) fn hold_vertical(&mut self) {
        for state in [DV + 2, DR + 2] {
            self.forget(state);
        }
        for answer in self.answers() {
            answer.hold_vertical();
        }
    }

    fn forget(&mut self, state: usize) {
        self.covariance.reopen(state, 0.0);
        if let Some(border) = &mut self.border {
            border.forget(state);
        }
        for wandering in &mut self.wanderings {
            wandering.cross[state] = 0.0;
        }
    }

    fn answers(&mut self) -> impl Iterator<Item = &mut Answer> {
        std::iter::once(&mut self.mean).chain(&mut self.swung)
    }

    /// Returns mean and covariance of all errors.
    pub(super) fn moments(&self) -> (Errors, Covariance) {
        let mut covariance = self.covariance.clone();
        for Answer { errors, .. } in &self.swung {
            for i in 0..STATE_COUNT {
                for j in i..STATE_COUNT {
                    covariance.add(i, j, 0.5 * errors[i] * errors[j]);
                }
            }
        }
        (self.mean.errors, covariance)
    }

    /// Returns mean and σ of the further states; `None` without any. Of Gauss-Markov biases it is those of the estimates,
    /// with the sign turned.
    pub(super) fn further(&self) -> Option<[[f64; DRIVING_COUNT]; 2]> {
        let border = self.border.as_ref()?;
        let swung = |k: usize| self.swung.iter().map(move |answer| 0.5 * answer.further[k].powi(2));
        let variance = |k: usize| border.variance(k) + swung(k).sum::<f64>();
        let sigma = core::array::from_fn(|k| libm::sqrt(variance(k).max(0.0)));
        Some([core::array::from_fn(|k| self.mean.further[k]), sigma])
    }
}

/// Further states at the start, correlated with the attitude of an alignment.
fn border(truth: &FurtherTruth) -> Border {
    let mut border = Border::new(&truth.sigma);
    for (i, tilt) in truth.tilt.iter().enumerate() {
        for (k, (tilt, sigma)) in tilt.iter().zip(&truth.sigma).enumerate() {
            border.add(k, PHI + i, tilt * sigma * sigma);
        }
    }
    border
}

impl Wandering {
    /// Propagates `x⁺ = Φ x + D z + γ w`; what Φ and D do to the covariance of x is done already.
    fn propagate(
        &mut self,
        step: &Step,
        h: f64,
        covariance: &mut Covariance,
        border: Option<&mut Border>,
    ) {
        let transition: &Transition = &step.transition;
        let (decay, mean, came) = self.process.over(h);
        // White noise in the bias over the step acts on the mean half a step later, which is
        // negligible over steps that are short against the correlation time.
        let input: [f64; MOVING] = core::array::from_fn(|i| transition.rows[i][self.like] * mean);
        let mut carried = self.cross;
        for (i, row) in transition.rows.iter().enumerate() {
            carried[i] = row.iter().zip(&self.cross).map(|(a, b)| a * b).sum();
        }
        if let (Some(border), Some((columns, left))) = (border, &step.further) {
            for (carried, column) in carried.iter_mut().zip(columns) {
                *carried += sum(column, &self.further);
            }
            // The further states are carried to the end of the step, the bias not yet.
            self.further.iter_mut().zip(left).for_each(|(cross, left)| *cross *= left);
            border.add_products(&self.further, &input);
            self.further.iter_mut().for_each(|cross| *cross *= decay);
        }
        let input_of = |i: usize| if i < MOVING { input[i] } else { 0.0 };
        for k in 0..MOVING {
            for i in k..STATE_COUNT {
                let value = carried[i] * input[k]
                    + input_of(i) * carried[k]
                    + input_of(i) * input[k] * self.variance;
                covariance.add(i, k, value);
            }
        }
        for (i, cross) in self.cross.iter_mut().enumerate() {
            *cross = (carried[i] + input_of(i) * self.variance) * decay;
        }
        self.variance = self.variance * decay * decay + came;
    }
}
