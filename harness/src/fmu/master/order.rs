//! In which order FMUs step, and from which values.

use std::fmt;
use std::str::FromStr;

/// The order of a master.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Order {
    /// All FMUs step from the same values: those at the beginning of the step. What is connected in
    /// a circle is delayed by one step on each connection.
    #[default]
    Jacobi,
    /// One after another, in this order: an FMU gets from those before it in the list what they
    /// gave at the end of this step, and from the others what they gave at the end of the last.
    GaussSeidel(Vec<String>),
}

impl FromStr for Order {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        if text == "jacobi" {
            return Ok(Self::Jacobi);
        }
        let names: Vec<String> = match text.strip_prefix("gauss-seidel=") {
            Some(list) => list.split(',').map(|name| name.trim().to_owned()).collect(),
            None => Vec::new(),
        };
        if names.is_empty() || names.iter().any(String::is_empty) {
            return Err(format!(
                "order is {text:?}, expected \"jacobi\", or \"gauss-seidel=\" and the names of all \
                 FMUs, such as \"gauss-seidel=plant,calibrator\""
            ));
        }
        Ok(Self::GaussSeidel(names))
    }
}

impl fmt::Display for Order {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Jacobi => f.write_str("jacobi"),
            Self::GaussSeidel(names) => write!(f, "gauss-seidel={}", names.join(",")),
        }
    }
}

impl Order {
    /// The numbers of the FMUs in their order; every one is named once.
    ///
    /// # Errors
    /// If one is missing, unknown, or named twice.
    pub fn of(&self, names: &[&str]) -> Result<Vec<usize>, String> {
        let Self::GaussSeidel(list) = self else { return Ok((0..names.len()).collect()) };
        let mut order = Vec::with_capacity(names.len());
        for name in list {
            let Some(index) = names.iter().position(|known| known == name) else {
                let known = octant_base::names::suggestion(name, names.iter().copied(), "FMUs");
                return Err(format!(
                    "the order names {name:?}, which is no FMU of the system, {known}"
                ));
            };
            if order.contains(&index) {
                return Err(format!("the order names {name:?} twice"));
            }
            order.push(index);
        }
        let missing: Vec<&str> = (0..names.len())
            .filter(|index| !order.contains(index))
            .map(|index| names[index])
            .collect();
        if !missing.is_empty() {
            return Err(format!(
                "the order leaves out {}; expected every FMU once",
                missing.join(", ")
            ));
        }
        Ok(order)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_order_is_written_and_read() {
        let names = ["plant", "ship", "calibrator"];
        assert_eq!("jacobi".parse::<Order>().unwrap().of(&names).unwrap(), [0, 1, 2]);
        let order: Order = "gauss-seidel=calibrator, plant,ship".parse().unwrap();
        assert_eq!(order.of(&names).unwrap(), [2, 0, 1]);
        assert_eq!(order.to_string().parse::<Order>().unwrap(), order);
        for (text, expected) in [
            ("gauss-seidel=plant,ship", "leaves out calibrator"),
            ("gauss-seidel=plant,ship,ship,calibrator", "twice"),
            ("gauss-seidel=plant,ship,calibrater", "did you mean \"calibrator\"?"),
        ] {
            let error = text.parse::<Order>().unwrap().of(&names).unwrap_err();
            assert!(error.contains(expected), "{error}");
        }
        for text in ["", "gauss", "gauss-seidel=", "gauss-seidel=a,,b", "Jacobi"] {
            assert!(text.parse::<Order>().is_err(), "{text}");
        }
    }
}
