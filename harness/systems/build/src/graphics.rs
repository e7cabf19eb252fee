//! Graphical positions of terminals and icons.

use super::element::{Element, number};

/// Builds the graphical position of a terminal.
pub(super) fn picture(place: [f64; 4]) -> Element {
    corners(Element::new("TerminalGraphicalRepresentation"), place)
        .with("defaultConnectionColor", "0 101 163")
        .with("defaultConnectionStrokeSize", "1")
        .with("iconBaseName", "terminal")
}

/// Adds the corners of a rectangle.
pub(super) fn corners(element: Element, place: [f64; 4]) -> Element {
    ["x1", "y1", "x2", "y2"]
        .into_iter()
        .zip(place)
        .fold(element, |element, (name, value)| element.with(name, number(value)))
}
