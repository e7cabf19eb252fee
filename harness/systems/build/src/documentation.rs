//! Builds `documentation/index.html` from the table.

use super::describe::{STEP_S, STOP_S, TOOL, has_start};
use super::prose::{self, Prose};
use super::standard::Standard;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use octant_base::number::plain;
use octant_fmu::c::CATEGORIES;
use octant_fmu::table::{
    DeclaredCausality, DeclaredQuantity, DeclaredVariability, DeclaredVariable, ElementType, Model,
    Ticks,
};

/// Builds the page.
pub(super) fn documentation(
    model: &Model,
    standard: Standard,
    icon: &str,
    has_reference: bool,
) -> String {
    let identifier = format!("{}_{}", model.stem, standard.suffix());
    let prose = prose::of(model);
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (identifier) }
                style { (PreEscaped(include_str!("documentation.css"))) }
            }
            body {
                main {
                    header {
                        div.icon { (PreEscaped(icon)) }
                        div {
                            h1 { (identifier) }
                            p.lead { (model.description) }
                            p.soft { (standard.name()) " co-simulation · " (TOOL) }
                        }
                    }
                    (contents(model, has_reference))
                    (sections(&prose, standard))
                    @if has_reference { (reference(&identifier)) }
                    h2 id="log" { "Log categories" }
                    table {
                        tbody {
                            @for (name, description) in CATEGORIES {
                                tr { td { code { (name) } } td { (description) } }
                            }
                        }
                    }
                    (variables(model, standard))
                    h2 id="licence" { "Licence" }
                    p { (env!("CARGO_PKG_LICENSE")) ": " a href="licenses/license.txt" { "licenses" } ". " (super::licences::COPYRIGHT) "." }
                }
            }
        }
    }
    .into_string()
}

/// Kinds of variables in the order of the page.
const PARTS: [(DeclaredCausality, &str, &str); 5] = [
    (DeclaredCausality::Input, "inputs", "Inputs"),
    (DeclaredCausality::Output, "outputs", "Outputs"),
    (DeclaredCausality::Parameter, "parameters", "Parameters"),
    (DeclaredCausality::CalculatedParameter, "calculated", "Calculated parameters"),
    (DeclaredCausality::Local, "local", "Local variables"),
];

fn contents(model: &Model, has_reference: bool) -> Markup {
    let has = |causality| model.variables.iter().any(|variable| variable.causality == causality);
    html! {
        nav {
            @for (id, title) in prose::SECTIONS { a href={ "#" (id) } { (title) } " " }
            @if has_reference { a href="#check" { "Check your tool" } " " }
            a href="#log" { "Log categories" } " "
            @for (causality, id, title) in PARTS {
                @if has(causality) { a href={ "#" (id) } { (title) } " " }
            }
        }
    }
}

fn sections(prose: &Prose, standard: Standard) -> Markup {
    html! {
        @for ((id, title), paragraphs) in prose::SECTIONS.into_iter().zip(prose.sections(standard)) {
            h2 id=(id) { (title) }
            @for paragraph in paragraphs { p { (paragraph) } }
        }
    }
}

fn reference(identifier: &str) -> Markup {
    let (input, result) = (format!("{identifier}_in.csv"), format!("{identifier}_ref.csv"));
    let options = format!("{identifier}_ref.opt");
    html! {
        h2 id="check" { "Check your tool" }
        p {
            "Step the FMU from 0 to " (plain(STOP_S, 3)) " s in steps of " (plain(STEP_S, 3))
            " s with its start values and the inputs of " a href=(input) { (input) }
            ", and compare the outputs with " a href=(result) { (result) }
            " (settings: " a href=(options) { (options) } "). Inputs hold from their time on, and are "
            "set before the step that begins there; outputs are got after the step that ends there. "
            "The numbers have as many digits as give back their bits. "
            "The first row has the outputs after the initialization."
        }
        p {
            "Equal to the last bit is what the same library gives in any tool that sets the inputs "
            "as they are. A tool that converts units on the way stays within 1e-9 of the largest "
            "value of each variable. Anything more is an order that differs by a sample, or an "
            "input that was interpolated."
        }
    }
}

fn variables(model: &Model, standard: Standard) -> Markup {
    html! {
        @for (causality, id, title) in PARTS {
            @let these: Vec<_> =
                model.with_slots().filter(|(_, variable)| variable.causality == causality).collect();
            @if !these.is_empty() {
                h2 id=(id) { (title) }
                div.scroll {
                    table {
                        thead {
                            tr {
                                th { "Name" } th { "Reference" } th { "Type" } th { "Unit" } th { "Range" }
                                @if has_start(these[0].1) { th { "Start" } }
                                th { "Description" }
                            }
                        }
                        tbody {
                            @for (slot, variable) in these { (row(slot, variable, standard)) }
                        }
                    }
                }
            }
        }
    }
}

fn row(slot: usize, variable: &DeclaredVariable, standard: Standard) -> Markup {
    let references = match (standard, variable.elements) {
        (Standard::Fmi2, count) if count > 1 => format!("{slot}–{}", slot + count - 1),
        _ => slot.to_string(),
    };
    html! {
        tr {
            td {
                code { (variable.name) @if variable.elements > 0 { "[" (variable.elements) "]" } }
                @if variable.variability == DeclaredVariability::Tunable { " " span.soft { "tunable" } }
            }
            td { (references) }
            td { (kind(variable.kind, standard)) }
            td { (unit(variable)) }
            td { (range(variable)) }
            @if has_start(variable) { td { (start(variable)) } }
            td {
                (variable.description)
                @if let ElementType::Binary(binary) = variable.kind {
                    p.soft {
                        (binary.mime_type) ", at most " (binary.max_bytes) " bytes, at the ticks of "
                        (binary.clock)
                    }
                }
                @if let ElementType::Enumeration(enumeration) = variable.kind {
                    ul {
                        @for (value, name, description) in enumeration.items {
                            li { (value) " " b { (name) } ": " (description) }
                        }
                    }
                }
            }
        }
    }
}

fn kind(kind: ElementType, standard: Standard) -> &'static str {
    match (standard, kind) {
        (Standard::Fmi2, ElementType::Real | ElementType::Count) => "Real",
        (Standard::Fmi2, ElementType::Integer | ElementType::Enumeration(_)) => "Integer",
        (Standard::Fmi3, ElementType::Real) => "Float64",
        (Standard::Fmi3, ElementType::Count) => "UInt64",
        (Standard::Fmi3, ElementType::Integer) => "Int32",
        (Standard::Fmi3, ElementType::Enumeration(_)) => "Enumeration",
        (_, ElementType::Boolean) => "Boolean",
        (_, ElementType::Binary(_)) => "Binary",
        (_, ElementType::Clock(Ticks::Triggered)) => "Clock, triggered",
        (_, ElementType::Clock(Ticks::Countdown)) => "Clock, countdown",
    }
}

/// Renders a unit, with the display unit in brackets.
fn unit(variable: &DeclaredVariable) -> Markup {
    html! {
        @if let Some(DeclaredQuantity { unit, display, .. }) = variable.quantity {
            (unit.name)
            @if let Some(display) = display { " " span.soft { "(" (display) ")" } }
        }
    }
}

/// Renders a value in the display unit.
fn displayed(variable: &DeclaredVariable, value: f64) -> String {
    match shown_in(variable) {
        Some((name, factor)) => format!("{} {name}", plain(value * factor, 6)),
        None => plain(value, 6),
    }
}

/// Returns the display unit and its factor: display units per unit.
fn shown_in(variable: &DeclaredVariable) -> Option<(&'static str, f64)> {
    let quantity = variable.quantity?;
    match quantity.display {
        Some(display) => quantity.unit.display.iter().find(|(name, _)| *name == display).copied(),
        None if quantity.unit.name == "1" => None,
        None => Some((quantity.unit.name, 1.0)),
    }
}

fn range(variable: &DeclaredVariable) -> String {
    let smallest = variable.min.map(|min| displayed(variable, min));
    let largest = variable.max.map(|max| displayed(variable, max));
    match (smallest, largest) {
        (Some(min), Some(max)) => format!("{min} to {max}"),
        (Some(min), None) => format!("from {min}"),
        (None, Some(max)) => format!("to {max}"),
        (None, None) => String::new(),
    }
}

fn start(variable: &DeclaredVariable) -> String {
    let value = |element| {
        let value = variable.start_of(element).unwrap_or(0.0);
        match variable.kind {
            ElementType::Boolean => (value != 0.0).to_string(),
            ElementType::Enumeration(enumeration) => {
                let item = enumeration.items.iter().find(|(item, ..)| f64::from(*item) == value);
                item.map_or_else(|| value.to_string(), |(_, name, _)| (*name).to_owned())
            }
            ElementType::Binary(_) | ElementType::Clock(_) => String::new(),
            _ => displayed(variable, value),
        }
    };
    let values: Vec<String> = (0..variable.slots()).map(value).collect();
    match values.split_first() {
        Some((first, rest)) if rest.iter().all(|value| value == first) => first.clone(),
        _ => values.join(", "),
    }
}
