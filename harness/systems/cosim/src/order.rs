//! Order in which FMUs step, and the values they step from.

use std::fmt;
use std::str::FromStr;

/// Stepping order of a master.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum SteppingOrder {
    /// All FMUs step from the same values: those at the beginning of the step. Each connection of a
    /// loop delays by one step.
    #[default]
    Jacobi,
    /// FMUs step one after another, in this order: an FMU gets the values at the end of this step
    /// from those before it in the list, and the values at the end of the last step from the
    /// others.
    GaussSeidel(Vec<String>),
}

/// Reason why an order can't be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OrderError {
    /// The text is no order.
    #[error(
        "order is {found:?}, expected \"jacobi\", or \"gauss-seidel=\" and the names of all FMUs, \
         such as \"gauss-seidel=plant,calibrator\""
    )]
    Text {
        /// Text found.
        found: String,
    },
    /// The order names something that isn't in the system.
    #[error("the order names {found:?}, which is no FMU of the system, {known}")]
    Unknown {
        /// Name found.
        found: String,
        /// Names that exist, as a suggestion.
        known: String,
    },
    /// The order names an FMU twice.
    #[error("the order names {found:?} twice")]
    Twice {
        /// Name found.
        found: String,
    },
    /// The order leaves out FMUs.
    #[error("the order leaves out {}; expected every FMU once", .missing.join(", "))]
    Missing {
        /// Names of these FMUs.
        missing: Vec<String>,
    },
}

impl FromStr for SteppingOrder {
    type Err = OrderError;

    fn from_str(text: &str) -> Result<Self, OrderError> {
        let text = text.trim();
        if text == "jacobi" {
            return Ok(Self::Jacobi);
        }
        let names: Vec<String> = match text.strip_prefix("gauss-seidel=") {
            Some(list) => list.split(',').map(|name| name.trim().to_owned()).collect(),
            None => Vec::new(),
        };
        if names.is_empty() || names.iter().any(String::is_empty) {
            return Err(OrderError::Text { found: text.to_owned() });
        }
        Ok(Self::GaussSeidel(names))
    }
}

impl fmt::Display for SteppingOrder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Jacobi => f.write_str("jacobi"),
            Self::GaussSeidel(names) => write!(f, "gauss-seidel={}", names.join(",")),
        }
    }
}

impl SteppingOrder {
    /// Returns the indices of the FMUs in their order; each must be named once.
    ///
    /// # Errors
    /// If one is missing, unknown, or named twice.
    pub fn of(&self, names: &[&str]) -> Result<Vec<usize>, OrderError> {
        let Self::GaussSeidel(list) = self else { return Ok((0..names.len()).collect()) };
        let mut order = Vec::with_capacity(names.len());
        for name in list {
            let Some(index) = names.iter().position(|known| known == name) else {
                let known = octant_base::names::suggestion(name, names.iter().copied(), "FMUs");
                return Err(OrderError::Unknown { found: name.clone(), known: known.to_string() });
            };
            if order.contains(&index) {
                return Err(OrderError::Twice { found: name.clone() });
            }
            order.push(index);
        }
        let missing: Vec<String> = (0..names.len())
            .filter(|index| !order.contains(index))
            .map(|index| names[index].to_owned())
            .collect();
        if !missing.is_empty() {
            return Err(OrderError::Missing { missing });
        }
        Ok(order)
    }
}
