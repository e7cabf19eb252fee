//! Largest standard deviations of a calibration that is published.

use octant_sample::parameters::{NAMES, PARAMETER_COUNT, ParameterGroup};

/// Limits that the configuration gives; where it gives none, heading and tilt have that of the instrument's grade, and a
/// parameter has none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct SigmaLimits {
    /// Heading, rad.
    pub heading_rad: Option<f64>,
    /// Tilt about north and east, the larger one, rad.
    pub tilt_rad: Option<f64>,
    /// Parameters by group, in the order of [`ParameterGroup::ALL`], SI.
    pub parameters: [Option<f64>; 7],
}

/// Quantity with a limit of its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub enum UncertainQuantity {
    /// Heading.
    Heading,
    /// Tilt.
    Tilt,
    /// Parameter, by its index.
    Parameter(u8),
}

impl UncertainQuantity {
    /// Name for a sentence.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Heading => "the heading",
            Self::Tilt => "the tilt",
            Self::Parameter(index) => NAMES[usize::from(index) % PARAMETER_COUNT],
        }
    }

    fn group(self) -> Option<ParameterGroup> {
        let Self::Parameter(index) = self else { return None };
        ParameterGroup::ALL.into_iter().find(|group| group.range().contains(&usize::from(index)))
    }

    /// Key of the limit in a scenario, below `procedure.calibration.refuse_above_sigma`.
    #[must_use]
    pub fn key(self) -> &'static str {
        match self {
            Self::Heading => "heading",
            Self::Tilt => "tilt",
            Self::Parameter(_) => self.group().map_or("", ParameterGroup::name),
        }
    }

    /// Unit in which people read it.
    #[must_use]
    pub fn unit(self) -> &'static str {
        self.group().map_or("arcmin", ParameterGroup::unit)
    }

    /// The unit in SI.
    #[must_use]
    pub fn si_per_unit(self) -> f64 {
        self.group().map_or(octant_earth::units::ARCMIN, ParameterGroup::si_per_unit)
    }
}

impl SigmaLimits {
    /// Returns the first standard deviation above its limit, with both: of heading and tilt, rad, and of the parameters, SI.
    /// A standard deviation that is no number is above any limit.
    #[must_use]
    pub fn exceeded(
        &self,
        of_grade: (f64, f64),
        attitude: (f64, f64),
        parameters: &[f64; PARAMETER_COUNT],
    ) -> Option<(UncertainQuantity, f64, f64)> {
        let heading = self.heading_rad.unwrap_or(of_grade.0);
        let tilt = self.tilt_rad.unwrap_or(of_grade.1);
        let above = |sigma: f64, limit: f64| !(sigma <= limit);
        if above(attitude.0, heading) {
            return Some((UncertainQuantity::Heading, attitude.0, heading));
        }
        if above(attitude.1, tilt) {
            return Some((UncertainQuantity::Tilt, attitude.1, tilt));
        }
        for (group, limit) in ParameterGroup::ALL.into_iter().zip(self.parameters) {
            let Some(limit) = limit else { continue };
            if let Some(i) = group.range().find(|i| above(parameters[*i], limit)) {
                return Some((UncertainQuantity::Parameter(i as u8), parameters[i], limit));
            }
        }
        None
    }
}
