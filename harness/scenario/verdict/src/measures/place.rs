//! Places of the summary, tables and numbers, of which the tree of all measures is made.

use super::need::MeasureNeed;

/// Place of the summary.
#[derive(Clone, Copy)]
pub(super) enum Place {
    Number(Number),
    /// Table with its keys. Meanings of the tables on the way to a number are parts of its meaning, and
    /// so are their needs.
    Table {
        meaning: &'static str,
        needs: &'static [MeasureNeed],
        keys: &'static [(&'static str, Place)],
    },
    /// Table with a key for each name of a set, and the same content under each.
    Each {
        meaning: &'static str,
        needs: &'static [MeasureNeed],
        names: Names,
        of: &'static Place,
    },
}

/// Number of the summary.
#[derive(Clone, Copy)]
pub(super) struct Number {
    pub(super) unit: Unit,
    /// True if it can be negative.
    pub(super) signed: bool,
    pub(super) meaning: &'static str,
    pub(super) needs: &'static [MeasureNeed],
    /// True if its limit may have the factor sec φ: an error of a heading that is found from the Earth's rate.
    pub(super) secant: bool,
}

/// Unit of a number.
#[derive(Clone, Copy)]
pub(super) enum Unit {
    /// A count or a ratio.
    One,
    /// A multiple of a standard deviation.
    Sigma,
    /// This unit.
    Named(&'static str),
    /// Unit of the parameter, or of the further state, on the way to the number.
    Parameter,
}

/// Set of names.
#[derive(Clone, Copy)]
pub(super) enum Names {
    Parameters,
    Further,
    Groups,
}

pub(super) const ARCMIN: Unit = Unit::Named("arcmin");
pub(super) const NMI: Unit = Unit::Named("nmi");
pub(super) const MPS: Unit = Unit::Named("m/s");
pub(super) const DEG: Unit = Unit::Named("deg");
pub(super) const SECOND: Unit = Unit::Named("s");
pub(super) const HOUR: Unit = Unit::Named("h");
pub(super) const MICROSECOND: Unit = Unit::Named("us");
pub(super) const G_DEPENDENT: Unit = Unit::Named("deg/h/g");

/// A magnitude: it can't be negative.
pub(super) const fn magnitude(unit: Unit, meaning: &'static str) -> Place {
    Place::Number(Number { unit, signed: false, meaning, needs: &[], secant: false })
}

/// A number that can be negative.
pub(super) const fn signed(unit: Unit, meaning: &'static str) -> Place {
    Place::Number(Number { unit, signed: true, meaning, needs: &[], secant: false })
}

/// A count, or a ratio.
pub(super) const fn count(meaning: &'static str) -> Place {
    magnitude(Unit::One, meaning)
}

/// Number with conditions of its own.
pub(super) const fn with(needs: &'static [MeasureNeed], place: Place) -> Place {
    match place {
        Place::Number(number) => Place::Number(Number { needs, ..number }),
        other => other,
    }
}

/// Number whose limit may have the factor sec φ.
pub(super) const fn over_latitude(place: Place) -> Place {
    match place {
        Place::Number(number) => Place::Number(Number { secant: true, ..number }),
        other => other,
    }
}

/// Keys of a table.
pub(super) type Keys = &'static [(&'static str, Place)];

/// Table with its keys.
pub(super) const fn table(
    meaning: &'static str,
    needs: &'static [MeasureNeed],
    keys: Keys,
) -> Place {
    Place::Table { meaning, needs, keys }
}
