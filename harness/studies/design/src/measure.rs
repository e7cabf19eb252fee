//! Measures that a design can minimise. Each is the root of a quadratic form of the errors at the start of
//! navigation, but for the largest error, which is predicted by draws; a form stands for it in the search.

use super::navigation::{Drift, Quadratic};
use octant_calibration::covariance::{PARAMETERS, STATE_COUNT};
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::units::NAUTICAL_MILE_M;
use octant_observe::covariance::{arcmin_m, state_name};
use octant_observe::ensemble::state_unit;

/// Quantity that a design minimises.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DesignMeasure {
    /// Position error in navigation.
    Drift(Part, Window),
    /// σ of a parameter after the calibration: an index of the 39 states.
    Sigma(usize),
}

/// Part of a position error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Latitude, arcmin.
    Latitude,
    /// Longitude, arcmin.
    Longitude,
    /// Horizontal distance, nmi.
    Radial,
}

/// Time over which a position error counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Window {
    /// Root mean square over the last three hours.
    Last,
    /// Root mean square over the whole navigation.
    Whole,
    /// At the end.
    End,
    /// Largest error over the whole navigation, as its root mean square over the draws.
    Largest,
}

const PARTS: [(Part, &str); 3] =
    [(Part::Longitude, "longitude"), (Part::Latitude, "latitude"), (Part::Radial, "radial")];
const WINDOWS: [(Window, &str); 4] = [
    (Window::Last, ""),
    (Window::Whole, ".time-rms"),
    (Window::End, ".final"),
    (Window::Largest, ".largest"),
];

impl DesignMeasure {
    /// All measures.
    pub fn all() -> impl Iterator<Item = Self> {
        let drifts = PARTS
            .iter()
            .flat_map(|(part, _)| WINDOWS.iter().map(|(window, _)| Self::Drift(*part, *window)));
        drifts.chain((PARAMETERS..STATE_COUNT).map(Self::Sigma))
    }

    /// Finds a measure by its name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|measure| measure.name() == name)
    }

    /// Its name: `longitude`, `radial.time-rms`, `sigma.g_zz`.
    #[must_use]
    pub fn name(&self) -> String {
        match self {
            Self::Sigma(state) => format!("sigma.{}", state_name(*state)),
            Self::Drift(part, window) => {
                let of = PARTS.iter().filter(|(known, _)| known == part);
                let over = WINDOWS.iter().filter(|(known, _)| known == window);
                of.zip(over).map(|((_, part), (_, window))| format!("{part}{window}")).collect()
            }
        }
    }

    /// Meaning, in a line.
    #[must_use]
    pub fn words(&self) -> String {
        let (part, window) = match self {
            Self::Sigma(state) => return format!("σ of {}", state_name(*state)),
            Self::Drift(part, window) => (part, window),
        };
        let part = match part {
            Part::Latitude => "latitude",
            Part::Longitude => "longitude",
            Part::Radial => "radial",
        };
        match window {
            Window::Last => format!("rms of the {part} error in the last 3 h of navigation"),
            Window::Whole => format!("rms of the {part} error over the whole navigation"),
            Window::End => format!("σ of the {part} error at the end of navigation"),
            Window::Largest => {
                format!("rms over the draws of the largest {part} error in navigation")
            }
        }
    }

    /// Its unit.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        match self {
            Self::Drift(Part::Radial, _) => "nmi",
            Self::Drift(..) => "arcmin",
            Self::Sigma(state) => state_unit(*state).0,
        }
    }

    /// Part of the position error whose largest value is the measure; `None` for all other measures.
    #[must_use]
    pub fn largest(&self) -> Option<Part> {
        match self {
            Self::Drift(part, Window::Largest) => Some(*part),
            _ => None,
        }
    }

    /// Returns whether it is of navigation, and the root of a quadratic form.
    pub(crate) fn is_quadratic_of_navigation(&self) -> bool {
        matches!(self, Self::Drift(..)) && self.largest().is_none()
    }

    /// Returns the form whose root is the measure, in its unit. For a largest error it is the mean square
    /// over the whole navigation.
    #[must_use]
    pub fn form(&self, drift: &Drift, earth: &Ellipsoid) -> Quadratic {
        let (part, window) = match self {
            Self::Sigma(state) => {
                let si = state_unit(*state).1;
                return Quadratic::of_state(*state).times(1.0 / (si * si));
            }
            Self::Drift(part, window) => (part, window),
        };
        let [north, east] = match window {
            Window::Last => &drift.last,
            Window::Whole | Window::Largest => &drift.whole,
            Window::End => &drift.end,
        };
        let square = |unit_m: f64| 1.0 / (unit_m * unit_m);
        let [latitude_m, longitude_m] = arcmin_m(earth);
        match part {
            Part::Latitude => north.clone().times(square(latitude_m)),
            Part::Longitude => east.clone().times(square(longitude_m)),
            Part::Radial => north.clone().plus(east, 1.0).times(square(NAUTICAL_MILE_M)),
        }
    }
}
