//! The random inputs of a scenario as standard normal components.

use crate::estimators::point::RarePoint;
use octant_sample::parameters::{NAMES, ParameterGroup};
use octant_scenario::{ParameterDistribution, Scenario};
use octant_statistics::normal;
use serde::{Deserialize, Serialize};

/// An instrument error that the scenario draws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnInput {
    /// Number among all parameters.
    parameter: usize,
    /// σ of a normal distribution, or half of the width of a uniform one, SI.
    scale: f64,
    is_uniform: bool,
}

/// The value of a component in a point.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct InputValue {
    /// Name of the parameter.
    pub name: String,
    /// Standard normal component, σ.
    pub sigmas: f64,
    /// Value of the instrument.
    pub value: f64,
    /// Its unit.
    pub unit: String,
}

/// Random inputs of a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct RareInputs {
    inputs: Vec<DrawnInput>,
}

impl RareInputs {
    /// All instrument errors that are drawn with some width.
    #[must_use]
    pub fn of(scenario: &Scenario) -> Self {
        let of_group = |(group, distribution): (&ParameterGroup, &ParameterDistribution)| {
            let (scale, is_uniform) = match distribution {
                ParameterDistribution::Normal(sigma) => (*sigma, false),
                ParameterDistribution::Uniform(half) => (*half, true),
                ParameterDistribution::Constant(_) => (0.0, false),
            };
            let parameters = if scale > 0.0 { group.range() } else { 0..0 };
            parameters.map(move |parameter| DrawnInput { parameter, scale, is_uniform })
        };
        let groups = ParameterGroup::ALL.iter().zip(&scenario.parameters);
        Self { inputs: groups.flat_map(of_group).collect() }
    }

    /// Number of components.
    #[must_use]
    pub fn len(&self) -> usize {
        self.inputs.len()
    }

    /// True if the scenario draws no instrument error.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.inputs.is_empty()
    }

    /// The scenario with the values of a point in place of its distributions, and with its noise.
    #[must_use]
    pub fn scenario(&self, scenario: &Scenario, point: &RarePoint) -> Scenario {
        let mut at = scenario.clone();
        at.seed = point.noise;
        for (input, u) in self.inputs.iter().zip(&point.u) {
            let group = ParameterGroup::of(input.parameter);
            let place = ParameterGroup::ALL.iter().position(|of| *of == group).unwrap_or(0);
            let range = group.range();
            if !matches!(at.parameters[place], ParameterDistribution::Constant(_)) {
                at.parameters[place] = ParameterDistribution::Constant(vec![0.0; range.len()]);
            }
            if let ParameterDistribution::Constant(values) = &mut at.parameters[place] {
                values[input.parameter - range.start] = input.at(*u);
            }
        }
        at
    }

    /// The values of a point, those farthest from their mean first.
    #[must_use]
    pub fn values(&self, point: &RarePoint) -> Vec<InputValue> {
        let of = |(input, u): (&DrawnInput, &f64)| {
            let group = ParameterGroup::of(input.parameter);
            InputValue {
                name: NAMES[input.parameter].to_owned(),
                sigmas: *u,
                value: input.at(*u) / group.si_per_unit(),
                unit: group.unit().to_owned(),
            }
        };
        let mut values: Vec<InputValue> = self.inputs.iter().zip(&point.u).map(of).collect();
        values.sort_by(|a, b| b.sigmas.abs().total_cmp(&a.sigmas.abs()));
        values
    }
}

impl DrawnInput {
    /// Value of a standard normal component, by the inverse of the distribution.
    fn at(&self, u: f64) -> f64 {
        if !self.is_uniform {
            return self.scale * u;
        }
        // The lower tail, because 1 − Φ of a large u would lose its digits.
        let inner = 1.0 - 2.0 * normal::cdf(-u.abs());
        self.scale * libm::copysign(inner, u)
    }
}
