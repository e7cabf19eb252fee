//! Data of the slots for getting and setting, made from a model's table once.

use crate::table::{
    DeclaredCausality, DeclaredEnumeration, DeclaredVariability, ElementType, Model, Ticks,
};

/// Largest number up to which all whole numbers are exact as f64.
pub(super) const EXACT_MAX: f64 = 9_007_199_254_740_992.0;

/// Kind of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Cell {
    Real,
    Count,
    Integer,
    Enumeration,
    Boolean,
    /// Bytes, stored elsewhere.
    Binary,
    /// A clock, stored elsewhere.
    Clock,
}

/// Times at which the importer may set a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Settable {
    /// At no time.
    Never,
    /// Until the end of initialization.
    Fixed,
    /// Always.
    Always,
}

/// A slot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    pub cell: Cell,
    pub settable: Settable,
    /// True if every value is accepted, including NaN.
    pub any: bool,
    /// True for a tunable parameter, which the model takes anew.
    pub tunable: bool,
    /// True if the model computes the value.
    pub computed: bool,
    /// Number of elements of the variable that begins here; 0: none begins.
    pub elements: u16,
    /// Range; for Reals without one in the table, the largest numbers of f64.
    pub min: f64,
    pub max: f64,
    pub enumeration: Option<&'static DeclaredEnumeration>,
}

/// All slots of a model.
#[derive(Debug)]
pub(super) struct Layout {
    pub slots: Box<[Slot]>,
    /// Outputs that have cells, as slots.
    pub outputs: Box<[u32]>,
    /// The clocks.
    pub clocks: Box<[Clock]>,
    /// The binary variables.
    pub binaries: Box<[ClockedBinary]>,
}

/// A clock.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clock {
    pub slot: u32,
    pub ticks: Ticks,
}

/// A binary variable.
#[derive(Clone, Copy, Debug)]
pub(super) struct ClockedBinary {
    pub slot: u32,
    pub max_bytes: usize,
    /// Index of its clock among the clocks.
    pub clock: usize,
    pub is_input: bool,
}

impl Layout {
    pub(super) fn of(model: &Model) -> Self {
        let time = Slot {
            cell: Cell::Real,
            settable: Settable::Never,
            any: false,
            tunable: false,
            computed: false,
            elements: 1,
            min: -f64::MAX,
            max: f64::MAX,
            enumeration: None,
        };
        let (mut slots, mut outputs) = (vec![time], Vec::new());
        for (first, variable) in model.with_slots() {
            let cell = match variable.kind {
                ElementType::Real => Cell::Real,
                ElementType::Count => Cell::Count,
                ElementType::Integer => Cell::Integer,
                ElementType::Enumeration(_) => Cell::Enumeration,
                ElementType::Boolean => Cell::Boolean,
                ElementType::Binary(_) => Cell::Binary,
                ElementType::Clock(_) => Cell::Clock,
            };
            let tunable = variable.causality == DeclaredCausality::Parameter
                && variable.variability == DeclaredVariability::Tunable;
            let slot = Slot {
                cell,
                settable: match variable.causality {
                    DeclaredCausality::Parameter if tunable => Settable::Always,
                    DeclaredCausality::Input => Settable::Always,
                    DeclaredCausality::Parameter => Settable::Fixed,
                    _ => Settable::Never,
                },
                any: variable.non_finite,
                tunable,
                computed: matches!(
                    variable.causality,
                    DeclaredCausality::Output
                        | DeclaredCausality::Local
                        | DeclaredCausality::CalculatedParameter
                ),
                elements: 0,
                min: variable.min.unwrap_or(-f64::MAX),
                max: variable.max.unwrap_or(f64::MAX),
                enumeration: match variable.kind {
                    ElementType::Enumeration(of) => Some(of),
                    _ => None,
                },
            };
            slots.extend(core::iter::repeat_n(slot, variable.slots()));
            slots[first].elements = variable.slots() as u16;
            if variable.causality == DeclaredCausality::Output && !variable.is_clocked() {
                outputs.extend(first as u32..(first + variable.slots()) as u32);
            }
        }
        let clocks: Box<[(&str, Clock)]> = model
            .with_slots()
            .filter_map(|(slot, variable)| match variable.kind {
                ElementType::Clock(ticks) => {
                    Some((variable.name, Clock { slot: slot as u32, ticks }))
                }
                _ => None,
            })
            .collect();
        let binaries = model
            .with_slots()
            .filter_map(|(slot, variable)| {
                let ElementType::Binary(binary) = variable.kind else { return None };
                let clock = clocks.iter().position(|(name, _)| *name == binary.clock)?;
                Some(ClockedBinary {
                    slot: slot as u32,
                    max_bytes: binary.max_bytes,
                    clock,
                    is_input: variable.causality == DeclaredCausality::Input,
                })
            })
            .collect();
        let clocks = clocks.iter().map(|(_, clock)| *clock).collect();
        Self { slots: slots.into(), outputs: outputs.into(), clocks, binaries }
    }
}

/// Name of a slot as in FMI 2.0: `gyro.delta_theta[2]`.
pub(super) fn name(model: &Model, slot: usize) -> String {
    for (first, variable) in model.with_slots() {
        if (first..first + variable.slots()).contains(&slot) {
            return match variable.elements {
                0 => variable.name.to_owned(),
                _ => format!("{}[{}]", variable.name, slot - first + 1),
            };
        }
    }
    "time".to_owned()
}
