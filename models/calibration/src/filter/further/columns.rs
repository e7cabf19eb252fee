//! Effect of the further states on attitude and velocity in one sub-step.

use crate::config::{Further, FurtherUse};
use crate::error_model::MotionInterval;
use crate::further::FurtherGroup;
use crate::further::compensation::FurtherIntegrals;
use octant_earth::ellipsoid::Ellipsoid;

/// Row length in memory, a multiple of the vector registers' width.
pub const FURTHER_ROW: usize = 40;
/// The same without the states that follow the temperature, which come last.
pub(super) const UNHEATED_ROW: usize = 28;
/// One padded row over the further states.
pub type FurtherRow = [f64; FURTHER_ROW];

/// Groups that are on.
#[derive(Clone, Copy, Debug)]
pub struct FurtherEffects([bool; 12]);

impl FurtherEffects {
    /// Makes the effects of the groups that aren't off.
    #[must_use]
    pub fn new(further: &Further) -> Self {
        Self(core::array::from_fn(|group| further.of(FurtherGroup::ALL[group]) != FurtherUse::Off))
    }

    /// The effects of all groups.
    #[must_use]
    pub fn all() -> Self {
        Self([true; 12])
    }

    pub(super) fn on(&self, group: FurtherGroup) -> bool {
        self.0[group as usize]
    }

    /// Contribution of the further states to φ (rows 0 to 2) and δv (rows 3 to 5): `−C ε`, `C ∇` and
    /// `δg`. `used`: the gyros and the accelerometers that measured; `decay`: of the Gauss-Markov
    /// biases, from the last propagation to the middle of the sub-step.
    ///
    /// The computed gravity lacks the disturbance, so that its error is the negative one:
    /// `δg = (ξ g, η g, −Δg)`. Where known motion replaced the accelerometers, gravity has no effect.
    #[must_use]
    pub fn input(
        &self,
        interval: &MotionInterval,
        integrals: &FurtherIntegrals,
        earth: &Ellipsoid,
        used: ([bool; 3], bool),
        decay: [f64; 2],
    ) -> [FurtherRow; 6] {
        let h = interval.interval_s;
        let mut input = [[0.0; FURTHER_ROW]; 6];
        for i in 0..3 {
            let c = [interval.c_nb[(i, 0)], interval.c_nb[(i, 1)], interval.c_nb[(i, 2)]];
            for axis in 0..3 {
                if used.0[axis] {
                    let phi = &mut input[i];
                    if self.on(FurtherGroup::GyroAsymmetry) {
                        phi[FurtherGroup::GyroAsymmetry.start() + axis] =
                            -c[axis] * integrals.turned[axis];
                    }
                    if self.on(FurtherGroup::GyroGaussMarkov) {
                        phi[FurtherGroup::GyroGaussMarkov.start() + axis] =
                            -c[axis] * (h * decay[0]);
                    }
                    if self.on(FurtherGroup::GyroBiasTemperature) {
                        phi[FurtherGroup::GyroBiasTemperature.start() + axis] =
                            -c[axis] * integrals.warmth;
                    }
                    if self.on(FurtherGroup::GyroScaleTemperature) {
                        phi[FurtherGroup::GyroScaleTemperature.start() + axis] =
                            -c[axis] * integrals.warm_turn[axis];
                    }
                }
                if !used.1 {
                    continue;
                }
                let dv = &mut input[3 + i];
                if self.on(FurtherGroup::AccelLever) {
                    for column in 0..3 {
                        dv[FurtherGroup::AccelLever.start() + 3 * axis + column] =
                            c[axis] * integrals.size[(axis, column)];
                    }
                }
                if self.on(FurtherGroup::AccelAsymmetry) {
                    dv[FurtherGroup::AccelAsymmetry.start() + axis] =
                        c[axis] * integrals.pushed[axis];
                }
                if self.on(FurtherGroup::AccelQuadratic) {
                    dv[FurtherGroup::AccelQuadratic.start() + axis] =
                        c[axis] * integrals.squared[axis];
                }
                if self.on(FurtherGroup::AccelGaussMarkov) {
                    dv[FurtherGroup::AccelGaussMarkov.start() + axis] = c[axis] * (h * decay[1]);
                }
                if self.on(FurtherGroup::AccelBiasTemperature) {
                    dv[FurtherGroup::AccelBiasTemperature.start() + axis] =
                        c[axis] * integrals.warmth;
                }
                if self.on(FurtherGroup::AccelScaleTemperature) {
                    dv[FurtherGroup::AccelScaleTemperature.start() + axis] =
                        c[axis] * integrals.warm_push[axis];
                }
            }
        }
        if used.1 {
            if self.on(FurtherGroup::Deflection) {
                let at = FurtherGroup::Deflection.start();
                input[3][at] = earth.gravity_mps2 * h;
                input[4][at + 1] = earth.gravity_mps2 * h;
            }
            if self.on(FurtherGroup::GravityAnomaly) {
                input[5][FurtherGroup::GravityAnomaly.start()] = -h;
            }
        }
        input
    }
}
