//! Compensation of the further errors that are estimated, sample by sample.
//!
//! It takes increments that the linear compensation has corrected, so that the nonlinear terms are
//! those of the true rate and force: the other order would leave their product with the parameters.
//! The product of the nonlinear terms with the linear errors themselves, 1e-8 of the input, is left.
//! The modulus of a sample's increment rectifies its noise: an axis at rest shows up to 0.8 σ of a
//! sample instead of zero, times the asymmetry.

use super::size_effect::SizeEffect;
use super::{DRIVING_COUNT, FURTHER_COUNT, FurtherGroup, TEMPERATURE_START};
use crate::config::Further;
use crate::strapdown::Strapdown;
use nalgebra::{Matrix3, Vector3};

/// Estimates in use, and the memory of their compensation.
#[derive(Clone, Debug)]
pub(crate) struct FurtherCompensation {
    /// Estimates but those that follow the temperature; Gauss-Markov biases decay with every sample.
    value: [f64; TEMPERATURE_START],
    size_effect: SizeEffect,
    /// True where a group has an estimate that isn't zero.
    sizes: bool,
    gravity: bool,
    /// Decay of the Gauss-Markov biases of gyros and accelerometers over a regular sample.
    decay: [f64; 2],
    thermometer: Option<Thermometer>,
}

/// Temperature as the core was told it, and the coefficients by which errors follow it.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Thermometer {
    /// T₀, °C; `None` before the first temperature.
    reference_c: Option<f64>,
    /// T − T₀, K.
    pub(crate) warmth_k: f64,
    /// Estimates of the coefficients.
    per_k: [f64; DRIVING_COUNT - TEMPERATURE_START],
}

impl Thermometer {
    fn triple(&self, group: FurtherGroup) -> Vector3<f64> {
        let at = group.start() - TEMPERATURE_START;
        Vector3::new(self.per_k[at], self.per_k[at + 1], self.per_k[at + 2])
    }
}

#[cfg(feature = "state")]
impl octant_state::State for FurtherCompensation {
    /// Without errors that follow the temperature the layout is that of a program that knew none.
    fn save(&self, to: &mut octant_state::Writer) {
        let Self { value, size_effect, sizes, gravity, decay: _, thermometer } = self;
        to.value("value", value);
        to.value("size_effect", size_effect);
        to.value("sizes", sizes);
        to.value("gravity", gravity);
        if let Some(thermometer) = thermometer {
            to.value("thermometer", thermometer);
        }
    }

    fn load(
        &mut self,
        from: &mut octant_state::StateReader<'_>,
    ) -> Result<(), octant_state::StateError> {
        self.value = from.value("value")?;
        self.size_effect = from.value("size_effect")?;
        self.sizes = from.value("sizes")?;
        self.gravity = from.value("gravity")?;
        if let Some(thermometer) = &mut self.thermometer {
            *thermometer = from.value("thermometer")?;
        }
        Ok(())
    }
}

impl FurtherCompensation {
    /// Makes the compensation of a filter, with all estimates zero; `None` without further states.
    pub(crate) fn new(further: &Further, sample_s: f64) -> Option<Self> {
        let decay = |group, correlation_time_s: f64| match further.of(group).sigma() {
            Some(_) => libm::exp(-sample_s / correlation_time_s),
            None => 1.0,
        };
        further.has_states().then(|| Self {
            value: [0.0; TEMPERATURE_START],
            size_effect: SizeEffect::default(),
            sizes: false,
            gravity: false,
            decay: [
                decay(FurtherGroup::GyroGaussMarkov, further.gyro_correlation_time_s),
                decay(FurtherGroup::AccelGaussMarkov, further.accel_correlation_time_s),
            ],
            thermometer: further.temperature.filter(|_| further.follows_temperature()).map(
                |temperature| Thermometer {
                    reference_c: temperature.reference_c,
                    warmth_k: 0.0,
                    per_k: [0.0; DRIVING_COUNT - TEMPERATURE_START],
                },
            ),
        })
    }

    /// Takes the temperature of the instrument. One that is no number changes nothing.
    pub(crate) fn feel(&mut self, temperature_c: f64) {
        let Some(thermometer) = &mut self.thermometer else { return };
        if temperature_c.is_finite() {
            let reference_c = *thermometer.reference_c.get_or_insert(temperature_c);
            thermometer.warmth_k = temperature_c - reference_c;
        }
    }

    /// T − T₀, K; `None` where no error follows the temperature.
    #[inline]
    pub(crate) fn warmth_k(&self) -> Option<f64> {
        self.thermometer.map(|thermometer| thermometer.warmth_k)
    }

    /// Takes new estimates. Errors of the gimbals are none of the sensors.
    pub(crate) fn set(&mut self, value: &[f64; FURTHER_COUNT]) {
        let (constant, rest) = value.split_at(TEMPERATURE_START);
        self.value.copy_from_slice(constant);
        if let Some(thermometer) = &mut self.thermometer {
            thermometer.per_k.copy_from_slice(&rest[..DRIVING_COUNT - TEMPERATURE_START]);
        }
        let any = |group: FurtherGroup| value[group.range()].iter().any(|value| *value != 0.0);
        self.sizes = any(FurtherGroup::AccelLever);
        self.gravity = any(FurtherGroup::Deflection) || any(FurtherGroup::GravityAnomaly);
    }

    fn triple(&self, group: FurtherGroup) -> Vector3<f64> {
        let at = group.start();
        Vector3::new(self.value[at], self.value[at + 1], self.value[at + 2])
    }

    /// Errors of the increments of an interval (Δθ, rad; Δv, m/s) by true ones, in b. `strapdown`: at
    /// the start of the interval.
    fn errors(
        &mut self,
        strapdown: &Strapdown,
        dtheta: &Vector3<f64>,
        dv: &Vector3<f64>,
        interval_s: f64,
    ) -> (Vector3<f64>, Vector3<f64>) {
        let mut theta = self.triple(FurtherGroup::GyroAsymmetry).component_mul(&dtheta.abs())
            + self.triple(FurtherGroup::GyroGaussMarkov) * interval_s;
        let squares = dv.component_mul(dv) * (1.0 / interval_s);
        let mut velocity = self.triple(FurtherGroup::AccelAsymmetry).component_mul(&dv.abs())
            + self.triple(FurtherGroup::AccelQuadratic).component_mul(&squares)
            + self.triple(FurtherGroup::AccelGaussMarkov) * interval_s;
        if let Some(thermometer) = &self.thermometer {
            let of = |bias, scale, increment: &Vector3<f64>| {
                (thermometer.triple(bias) * interval_s
                    + thermometer.triple(scale).component_mul(increment))
                    * thermometer.warmth_k
            };
            use FurtherGroup as Of;
            theta += of(Of::GyroBiasTemperature, Of::GyroScaleTemperature, dtheta);
            velocity += of(Of::AccelBiasTemperature, Of::AccelScaleTemperature, dv);
        }
        let felt = self.size_effect.step(dtheta, interval_s);
        if self.sizes {
            let arms = &self.value[FurtherGroup::AccelLever.range()];
            for axis in 0..3 {
                let arm = &arms[3 * axis..3 * axis + 3];
                velocity[axis] +=
                    felt[(axis, 0)] * arm[0] + felt[(axis, 1)] * arm[1] + felt[(axis, 2)] * arm[2];
            }
        }
        if self.gravity {
            let gravity = self.gravity_mps2(strapdown.earth().gravity_mps2);
            let lost = strapdown.c_nb().transpose() * gravity * -interval_s;
            // At the middle of the interval the body has turned by half.
            velocity += lost - dtheta.cross(&lost) * 0.5;
        }
        (theta, velocity)
    }

    /// Estimated disturbance of gravity in n, m/s².
    fn gravity_mps2(&self, normal_mps2: f64) -> Vector3<f64> {
        let xi = self.value[FurtherGroup::Deflection.start()];
        let eta = self.value[FurtherGroup::Deflection.start() + 1];
        let anomaly = self.value[FurtherGroup::GravityAnomaly.start()];
        Vector3::new(-xi * normal_mps2, -eta * normal_mps2, anomaly)
    }

    /// Subtracts the estimated errors from increments that are compensated for the parameters.
    ///
    /// A disturbance of gravity isn't one of the sensors. The strapdown adds normal gravity, and so
    /// the specific force less the disturbance gives the right velocity.
    #[inline(never)]
    pub(crate) fn apply(
        &mut self,
        strapdown: &Strapdown,
        dtheta: &Vector3<f64>,
        dv: &Vector3<f64>,
        interval_s: f64,
    ) -> (Vector3<f64>, Vector3<f64>) {
        let (theta, velocity) = self.errors(strapdown, dtheta, dv, interval_s);
        for axis in 0..3 {
            self.value[FurtherGroup::GyroGaussMarkov.start() + axis] *= self.decay[0];
            self.value[FurtherGroup::AccelGaussMarkov.start() + axis] *= self.decay[1];
        }
        (dtheta - theta, dv - velocity)
    }

    /// Adds the estimated errors to true increments: the inverse of [`Self::apply`], which it leaves
    /// unchanged.
    pub(crate) fn distort(
        &self,
        strapdown: &Strapdown,
        dtheta: &Vector3<f64>,
        dv: &Vector3<f64>,
        interval_s: f64,
    ) -> (Vector3<f64>, Vector3<f64>) {
        let (theta, velocity) = self.clone().errors(strapdown, dtheta, dv, interval_s);
        (dtheta + theta, dv + velocity)
    }
}

/// Integrals over samples by which the further states drive attitude and velocity.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct FurtherIntegrals {
    /// ∫([ω̇×] + [ω×]²) dt, 1/s.
    pub size: Matrix3<f64>,
    /// ∫|ω_i| dt, rad.
    pub turned: Vector3<f64>,
    /// ∫|f_i| dt, m/s.
    pub pushed: Vector3<f64>,
    /// ∫f_i² dt, (m/s²)² s.
    pub squared: Vector3<f64>,
    /// ∫(T − T₀) dt, K s.
    #[cfg_attr(feature = "state", serde(skip))]
    pub warmth: f64,
    /// ∫(T − T₀) ω_i dt, K rad.
    #[cfg_attr(feature = "state", serde(skip))]
    pub warm_turn: Vector3<f64>,
    /// ∫(T − T₀) f_i dt, K m/s.
    #[cfg_attr(feature = "state", serde(skip))]
    pub warm_push: Vector3<f64>,
}

impl Default for FurtherIntegrals {
    fn default() -> Self {
        Self {
            size: Matrix3::zeros(),
            turned: Vector3::zeros(),
            pushed: Vector3::zeros(),
            squared: Vector3::zeros(),
            warmth: 0.0,
            warm_turn: Vector3::zeros(),
            warm_push: Vector3::zeros(),
        }
    }
}

impl FurtherIntegrals {
    /// Adds the compensated increments of an interval, of which `size` is the size effect.
    #[inline]
    pub(crate) fn add(
        &mut self,
        size: &Matrix3<f64>,
        dtheta: &Vector3<f64>,
        dv: &Vector3<f64>,
        interval_s: f64,
    ) {
        self.size += size;
        self.turned += dtheta.abs();
        self.pushed += dv.abs();
        self.squared += dv.component_mul(dv) * (1.0 / interval_s);
    }

    /// The last three, which are stored by themselves.
    #[cfg(feature = "state")]
    pub(crate) fn warm(&self) -> (f64, Vector3<f64>, Vector3<f64>) {
        (self.warmth, self.warm_turn, self.warm_push)
    }

    /// The inverse of [`Self::warm`].
    #[cfg(feature = "state")]
    pub(crate) fn set_warm(&mut self, warm: (f64, Vector3<f64>, Vector3<f64>)) {
        (self.warmth, self.warm_turn, self.warm_push) = warm;
    }

    /// Adds an interval's increments at T − T₀.
    #[inline]
    pub(crate) fn add_warm(
        &mut self,
        warmth_k: f64,
        dtheta: &Vector3<f64>,
        dv: &Vector3<f64>,
        interval_s: f64,
    ) {
        self.warmth += warmth_k * interval_s;
        self.warm_turn += dtheta * warmth_k;
        self.warm_push += dv * warmth_k;
    }
}
