//! Reference inputs and results, with which users check their tools.
//!
//! The two models run in a closed loop with their start values, as under a master that steps FMUs
//! in parallel: outputs are passed on after both have stepped. Inputs and outputs of each model are
//! its reference. Files are named as in the FMI cross-check, `_in.csv`, `_ref.csv`, `_ref.opt`;
//! they are in the FMU's `documentation`, the one folder in which both standards allow additional
//! files and which other tools leave unchanged.

use super::archive::File;
use super::describe::{STEP_S, STOP_S};
use super::element::{list, number};
use super::standard::Standard;
use octant_fmu::component::ModelComponent;
use octant_fmu::table::{DeclaredCausality, DeclaredVariable, ElementType, Model};
use octant_fmu::values::CellValues;
use std::fmt::Write;

/// Returns whether a result has a row after so many steps: at the start, and ten times a second.
/// The effect of a measurement at a whole second is visible one step later.
fn has_row(step: usize) -> bool {
    step == 0 || step % 20 == 1
}

/// Inputs and outputs of a model.
#[derive(Clone, Debug)]
pub(super) struct Reference {
    model: &'static Model,
    /// Step count and values before each following step.
    inputs: Vec<(usize, CellValues)>,
    /// Step count and values after that many steps, where [`has_row`].
    outputs: Vec<(usize, CellValues)>,
}

impl Reference {
    /// Model of the reference.
    pub(super) fn model(&self) -> &'static Model {
        self.model
    }

    fn new(model: &'static Model) -> Self {
        Self { model, inputs: Vec::new(), outputs: Vec::new() }
    }
}

/// Runs the two models from their start values.
///
/// # Errors
/// If the start values contradict themselves, or a step is refused: a mistake in the tables.
pub(super) fn closed_loop<A: ModelComponent, B: ModelComponent>() -> Result<[Reference; 2], String>
{
    let (mut a_values, mut b_values) = (CellValues::new(A::MODEL), CellValues::new(B::MODEL));
    let mut a = A::initialize(&mut a_values).map_err(|error| error.to_string())?;
    let mut b = B::initialize(&mut b_values).map_err(|error| error.to_string())?;
    let to_b = wires(A::MODEL, B::MODEL);
    let to_a = wires(B::MODEL, A::MODEL);
    let mut references = [Reference::new(A::MODEL), Reference::new(B::MODEL)];
    let steps = (STOP_S / STEP_S).round() as usize;
    for step in 0..=steps {
        if has_row(step) {
            references[0].outputs.push((step, a_values.clone()));
            references[1].outputs.push((step, b_values.clone()));
        }
        copy(&to_b, &a_values, &mut b_values);
        copy(&to_a, &b_values, &mut a_values);
        references[0].inputs.push((step, a_values.clone()));
        references[1].inputs.push((step, b_values.clone()));
        if step == steps {
            break;
        }
        a.step(&mut a_values).map_err(|error| error.to_string())?;
        b.step(&mut b_values).map_err(|error| error.to_string())?;
    }
    Ok(references)
}

/// Pairs the slots of outputs with those of the inputs of the same names.
fn wires(from: &Model, to: &Model) -> Vec<(usize, usize)> {
    let outputs = from.with_slots().filter(|(_, v)| v.causality == DeclaredCausality::Output);
    outputs
        .filter_map(|(slot, output)| {
            let (other, input) = to.find(output.name)?;
            let same =
                input.causality == DeclaredCausality::Input && input.slots() == output.slots();
            same.then(|| (0..output.slots()).map(move |i| (slot + i, other + i)))
        })
        .flatten()
        .collect()
}

fn copy(wires: &[(usize, usize)], from: &CellValues, to: &mut CellValues) {
    for (from_slot, to_slot) in wires {
        to.cells_mut()[*to_slot] = from.cells()[*from_slot];
    }
}

/// Builds the three files for the FMU of a standard.
pub(super) fn files(reference: &Reference, standard: Standard) -> [File; 3] {
    let identifier = format!("{}_{}", reference.model.stem, standard.suffix());
    let file = |suffix: &str, text: String| {
        File::new(format!("documentation/{identifier}_{suffix}"), text)
    };
    let model = reference.model;
    let inputs = table(model, DeclaredCausality::Input, standard, &reference.inputs);
    let outputs = table(model, DeclaredCausality::Output, standard, &reference.outputs);
    let options = format!(
        "StartTime, 0\nStopTime, {}\nStepSize, {}\nRelTol, 1e-12\n",
        number(STOP_S),
        number(STEP_S)
    );
    [file("in.csv", inputs), file("ref.csv", outputs), file("ref.opt", options)]
}

/// Renders rows of values. In FMI 2.0 every element has a column; in FMI 3.0 every variable has
/// one, with its elements separated by spaces.
fn table(
    model: &Model,
    causality: DeclaredCausality,
    standard: Standard,
    rows: &[(usize, CellValues)],
) -> String {
    let these: Vec<(usize, &DeclaredVariable)> =
        model.with_slots().filter(|(_, v)| v.causality == causality).collect();
    let mut text = "\"time\"".to_owned();
    for (_, variable) in &these {
        match standard {
            Standard::Fmi2 => {
                scalar_names(variable).iter().for_each(|name| column(&mut text, name))
            }
            Standard::Fmi3 => column(&mut text, variable.name),
        }
    }
    text.push('\n');
    for (step, values) in rows {
        // Divided by 200, not multiplied by 0.005: this gives the number nearest to the exact time.
        text += &number(*step as f64 / (1.0 / STEP_S));
        for (slot, variable) in &these {
            let elements = (*slot..slot + variable.slots()).map(|s| cell(values, s, variable.kind));
            match standard {
                Standard::Fmi2 => elements.for_each(|value| {
                    text.push(',');
                    text += &value;
                }),
                Standard::Fmi3 => {
                    text.push(',');
                    text += &list(elements);
                }
            }
        }
        text.push('\n');
    }
    text
}

fn column(text: &mut String, name: &str) {
    // Writing to a String can't fail.
    let _ = write!(text, ",\"{name}\"");
}

fn cell(values: &CellValues, slot: usize, kind: ElementType) -> String {
    match kind {
        ElementType::Real => number(values.real(slot)),
        ElementType::Integer | ElementType::Enumeration(_) => values.integer(slot).to_string(),
        ElementType::Count => values.count(slot).to_string(),
        ElementType::Boolean => u8::from(values.boolean(slot)).to_string(),
        // Models with such variables have no table of values.
        ElementType::Binary(_) | ElementType::Clock(_) => String::new(),
    }
}

/// Returns `name`, or `name[1]`, `name[2]` and so on.
pub(super) fn scalar_names(variable: &DeclaredVariable) -> Vec<String> {
    match variable.elements {
        0 => vec![variable.name.to_owned()],
        count => (1..=count).map(|element| format!("{}[{element}]", variable.name)).collect(),
    }
}
