//! Renders the parameter values of a scenario for an FMI tool, as SSV and as CSV.

use super::element::number;
use super::reference::scalar_names;
use super::ssp::ParameterValues;
use octant_fmu::table::{ElementType, Model};

/// Renders a table: name in FMI 2.0, name in FMI 3.0 and element, value, unit, and the value in its
/// display unit.
pub(super) fn csv(model: &'static Model, values: &ParameterValues) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // Writing to memory can't fail; a missing header would be noticed.
    let mut row = |cells: [&str; 8]| {
        let _ = writer.write_record(cells);
    };
    row(["fmi2", "fmi3", "element", "value", "unit", "displayed", "display_unit", "description"]);
    for (name, values) in values {
        let Some((_, variable)) = model.find(name) else { continue };
        for (index, (scalar, value)) in scalar_names(variable).into_iter().zip(values).enumerate() {
            let element =
                if variable.elements == 0 { String::new() } else { (index + 1).to_string() };
            let unit = variable.quantity.map_or("", |quantity| quantity.unit.name);
            let display = variable.quantity.and_then(|quantity| {
                let name = quantity.display?;
                quantity.unit.display.iter().find(|(display, _)| *display == name)
            });
            let item = match variable.kind {
                ElementType::Enumeration(of) => of.items.iter().find(|i| f64::from(i.0) == *value),
                _ => None,
            };
            let displayed = match (display, item, variable.kind) {
                (Some((_, factor)), ..) => number(value * factor),
                (_, Some((_, item, _)), _) => (*item).to_owned(),
                (.., ElementType::Boolean) => (*value != 0.0).to_string(),
                _ => number(*value),
            };
            let display_unit = display.map_or(unit, |(name, _)| name);
            let value = number(*value);
            row([
                &scalar,
                variable.name,
                &element,
                &value,
                unit,
                &displayed,
                display_unit,
                variable.description,
            ]);
        }
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}
