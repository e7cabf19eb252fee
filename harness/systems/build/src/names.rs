//! Names of the elements of an array in FMI 2.0.

use octant_fmu::table::DeclaredVariable;

/// Returns `name`, or `name[1]`, `name[2]` and so on.
pub(super) fn scalar_names(variable: &DeclaredVariable) -> Vec<String> {
    match variable.elements {
        0 => vec![variable.name.to_owned()],
        count => (1..=count).map(|element| format!("{}[{element}]", variable.name)).collect(),
    }
}
