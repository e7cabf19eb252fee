//! Units of signals.

/// Quantity that a unit measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    Angle,
    AngularRate,
    Velocity,
    Acceleration,
    Time,
    Temperature,
}

/// A unit: its quantity, and its size in SI units (°C for temperatures).
pub(crate) type Unit = (Quantity, f64);

const DEGREE_RAD: f64 = core::f64::consts::PI / 180.0;
const G_MPS2: f64 = 9.806_65;

/// Units with their spellings.
const UNITS: [(&[&str], Unit); 21] = [
    (&["rad"], (Quantity::Angle, 1.0)),
    (&["mrad"], (Quantity::Angle, 1e-3)),
    (&["urad", "µrad"], (Quantity::Angle, 1e-6)),
    (&["deg", "°", "degree", "degrees"], (Quantity::Angle, DEGREE_RAD)),
    (&["arcsec"], (Quantity::Angle, DEGREE_RAD / 3600.0)),
    (&["rad/s", "rad/sec"], (Quantity::AngularRate, 1.0)),
    (&["mrad/s"], (Quantity::AngularRate, 1e-3)),
    (&["deg/s", "°/s", "deg/sec", "dps"], (Quantity::AngularRate, DEGREE_RAD)),
    (&["deg/h", "°/h"], (Quantity::AngularRate, DEGREE_RAD / 3600.0)),
    (&["m/s"], (Quantity::Velocity, 1.0)),
    (&["mm/s"], (Quantity::Velocity, 1e-3)),
    (&["m/s2", "m/s^2", "m/s²", "m/s/s"], (Quantity::Acceleration, 1.0)),
    (&["mm/s2", "mm/s^2", "mm/s²"], (Quantity::Acceleration, 1e-3)),
    (&["g"], (Quantity::Acceleration, G_MPS2)),
    (&["mg"], (Quantity::Acceleration, G_MPS2 * 1e-3)),
    (&["ug", "µg"], (Quantity::Acceleration, G_MPS2 * 1e-6)),
    (&["s", "sec"], (Quantity::Time, 1.0)),
    (&["ms"], (Quantity::Time, 1e-3)),
    (&["us", "µs"], (Quantity::Time, 1e-6)),
    (&["ns"], (Quantity::Time, 1e-9)),
    (&["degC", "°C", "C"], (Quantity::Temperature, 1.0)),
];

/// Unit of a text.
pub(crate) fn unit(text: &str) -> Option<Unit> {
    UNITS.iter().find(|(names, _)| names.contains(&text)).map(|(_, unit)| *unit)
}

/// Size of a unit in SI units, °C for temperatures.
#[must_use]
pub fn unit_si(text: &str) -> Option<f64> {
    unit(text).map(|(_, si)| si)
}

/// Names of the units of some quantities.
pub(crate) fn names(quantities: &[Quantity]) -> std::string::String {
    let of = UNITS.iter().filter(|(_, (quantity, _))| quantities.contains(quantity));
    let names: std::vec::Vec<&str> = of.map(|(names, _)| names[0]).collect();
    names.join(", ")
}
